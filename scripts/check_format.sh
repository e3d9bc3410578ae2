#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Lists the C++ files that clang-format 14 would change and fails if there are any; --fix changes them.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
mode=(--dry-run --Werror)
[[ ${1:-} == --fix ]] && mode=(-i)
git ls-files -z '*.cpp' '*.h' | xargs -0 clang-format-14 --style=file "${mode[@]}"
