#!/usr/bin/env bash
# Installs what is needed (Debian 12), builds the two programs that it runs, runs the main job on a bundled
# recording, and prints the error table and where the results are.
#   ./demo.sh [rawlog/street64.rawlog] [SETTINGS.ini]        # without an ini the settings fit the sensor
# The rest is built by `cmake --build --preset release`, or by ./test.sh with the tests.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
source scripts/dependencies.sh
rawlog=${1:-rawlog/street64.rawlog}
[[ -e $rawlog ]] || { echo "demo.sh: $rawlog: no such file in $PWD" >&2; exit 1; }
install_packages
config=(${2:+-c "$2"})
out=out/$(basename "$rawlog" .rawlog)
echo "Building dyslam and dyslam-eval in build/release"
cmake --preset release >/dev/null
cmake --build --preset release --target dyslam dyslam-eval
bin=build/release/bin
"$bin/dyslam" -i "$rawlog" "${config[@]}" -o "$out" --labels
"$bin/dyslam-eval" run "$out"
echo
echo "The run in a browser:      $out/report.html"
echo "Picture of the trajectory: $out/trajectory.png"
echo "Static map:                $out/map_static.ply   (any point cloud viewer)"
echo "Replay:                    RawLogViewer $out/replay.rawlog"
echo "3D scene:                  SceneViewer3D $out/map.3Dscene"
