#!/usr/bin/env bash
# Remakes share/dyslam/report/page.html from libs/report/web; needs Node.js 18 or later and npm's registry.
# Only who changes the page needs it: the product is part of the repository.
#   scripts/build_report_page.sh [--check]      --check: fails if the page is not what the sources give
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../libs/report/web"
npm ci --silent --no-audit --no-fund
node build.mjs "$@"
