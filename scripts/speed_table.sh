#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Time and memory of a run by points per scan, objects in view and length: one table row per simulated
# recording.
set -eu
usage="Usage: speed_table.sh [-k SENSORS] [-t TRAFFIC] [-l SECONDS] [-c INI] [-o DIR]

  -k  sensors (VLP16 OS1-32 OS1-64 HDL64E OS1-128)
  -t  traffic densities (0.4)
  -l  seconds of the recordings (10)
  -c  settings (automatic for the sensor)
  -o  folder for recordings and runs (./speed_table); existing recordings are kept

Recordings are urban, seed 31. The programs are taken from \$DYSLAM_BIN, else from the PATH. Times depend on
the machine: run no other programs."
sensors="VLP16 OS1-32 OS1-64 HDL64E OS1-128"
traffic=0.4
lengths=10
settings=
output=speed_table
while getopts k:t:l:c:o:h option; do
  case $option in
    k) sensors=$OPTARG ;;
    t) traffic=$OPTARG ;;
    l) lengths=$OPTARG ;;
    c) settings=$OPTARG ;;
    o) output=$OPTARG ;;
    h) echo "$usage"; exit 0 ;;
    *) echo "$usage" >&2; exit 2 ;;
  esac
done
shift $((OPTIND - 1))
[ $# -eq 0 ] || { echo "$usage" >&2; exit 2; }
bin=${DYSLAM_BIN:+$DYSLAM_BIN/}
mkdir -p "$output"

# Runs the program and prints the row: row RUN SENSOR TRAFFIC COMMAND...
row() {
  python3 - "$@" <<'PY'
import json, resource, subprocess, sys
run, sensor, traffic = sys.argv[1:4]
code = subprocess.run(sys.argv[4:]).returncode
if code not in (0, 2):  # 2: less than half of the scans were registered, with results
    sys.exit("speed_table.sh: dyslam failed: " + " ".join(sys.argv[4:]))
used = resource.getrusage(resource.RUSAGE_CHILDREN)
report = json.load(open(run + "/report.json"))
scans = report["frames"]
table = [line.split(",") for line in open(run + "/scans.csv").read().splitlines()]
points = sum(int(row[table[0].index("points")]) for row in table[1:]) / scans
objects = (len(open(run + "/tracks.csv").readlines()) - 1) / scans
stages = dict.fromkeys(["preprocess", "dyseg", "refine", "tracking", "backend", "hindsight", "map"], 0)
for name, value in report["stage_ms"].items():
    if name.split(".")[0] in stages:
        stages[name.split(".")[0]] += value
wall, cpu = report["run_time_s"] / scans, (used.ru_utime + used.ru_stime) / scans
print("| {} | {} | {} | {:.0f} | {:.1f} | {} | {:.1f} | {:.1f} | {:.0f} |".format(
    sensor, traffic, scans, points, objects, " | ".join("{:.1f}".format(value) for value in stages.values()),
    1e3 * wall, 1e3 * cpu, used.ru_maxrss / 1024), flush=True)
PY
}

echo "| sensor | traffic | scans | points | objects | preprocess | dyseg | refine | tracking | backend | hindsight | map | wall | CPU | memory |"
echo "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|"
for seconds in $lengths; do
  for share in $traffic; do
    for sensor in $sensors; do
      run=$output/$sensor-$share-$seconds
      [ -f "$run.rawlog" ] || "${bin}dyslam-sim" -q --world urban --sensor "$sensor" --seed 31 --traffic "$share" \
        --seconds "$seconds" --no-flow -o "$run.rawlog" > "$run.log"
      rm -rf "$run"
      row "$run" "$sensor" "$share" "${bin}dyslam" -i "$run.rawlog" -o "$run" -v ERROR ${settings:+-c "$settings"}
    done
  done
done
