#!/usr/bin/env bash
# Installs what is needed (Debian 12), builds everything and runs every test; arguments go to ctest:
#   ./test.sh -L odometry        the tests of one module
# Set DYSLAM_DATA to a folder of real recordings to run the tests that need them, and
# DYSLAM_DATA_REQUIRED=1 to have them fail where it lacks what they need.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
source scripts/dependencies.sh
install_packages
preset=${PRESET:-ci}
cmake --preset "$preset" >/dev/null
cmake --build --preset "$preset"
ctest --preset "$preset" -j "$(nproc)" "$@"
