#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Builds the Debian packages dyslam, libdyslam-dev and dyslam-weights-noncommercial in dist/ and checks them
# with lintian:
#   scripts/build_packages.sh [-DDYSLAM_CPU=x86-64-v3 ...]      arguments are passed to cmake
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/dependencies.sh
install_packages dpkg-dev help2man lintian
preset=${PRESET:-package}
cmake --preset "$preset" -DDYSLAM_HELP_PAGES=ON "$@" >/dev/null
cmake --build --preset "$preset" ${JOBS:+-j "$JOBS"}
mkdir -p dist
rm -rf dist/*.deb "build/$preset/packages"  # of earlier versions
cpack --config "build/$preset/CPackConfig.cmake" -B "build/$preset/packages" >"build/$preset/cpack.log" ||
  { cat "build/$preset/cpack.log" >&2; exit 1; }
cp "build/$preset/packages/"*.deb dist/
lintian --fail-on error dist/*.deb
ls -l dist/*.deb
