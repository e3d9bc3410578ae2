#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Rebuilds share/dyslam/report/page.html from libs/report/web; needs Node.js 18 or later and npm's registry.
# Only needed after changes of the page: the product is part of the repository.
#   scripts/build_report_page.sh [--check]      --check: fails if the page differs from its sources
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../libs/report/web"
npm ci --silent --no-audit --no-fund
node build.mjs "$@"
