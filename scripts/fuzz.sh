#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Runs the fuzzers of all readers (or of the given ones) and prints a table: fuzz.sh RUNS SEED [PARSER...]
# Build them first: cmake --preset fuzz && cmake --build --preset fuzz. Findings are in build/fuzz/found.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
[[ $# -ge 2 ]] || { echo "Usage: fuzz.sh RUNS SEED [PARSER...]" >&2; exit 2; }
runs=$1
seed=$2
shift 2
failed=0
fuzzed=0
bin=$PWD/build/fuzz/bin
found=$PWD/build/fuzz/found
work=$(mktemp -d /dev/shm/dyslam_fuzz.XXXXXX)
trap 'rm -rf "$work"' EXIT
mkdir -p "$found"
"$bin/fuzz_seeds" "$work/seeds"
echo "| parser | inputs | seconds | result |"
echo "|---|---|---|---|"
for fuzzer in "$bin"/fuzz_*; do
  name=${fuzzer##*/fuzz_}
  [[ $name == seeds ]] && continue
  [[ $# -gt 0 && " $* " != *" $name "* ]] && continue
  fuzzed=$((fuzzed + 1))
  mkdir -p "$work/corpus"
  result=nothing
  nice -n 19 "$fuzzer" -runs="$runs" -seed="$seed" -max_len=20000 -timeout=5 -rss_limit_mb=2000 -malloc_limit_mb=1000 \
    -artifact_prefix="$found/$name-" -print_final_stats=1 "$work/corpus" "$work/seeds/$name" \
    $( [[ -d tests/fuzz/corpus/$name ]] && echo "tests/fuzz/corpus/$name") >"$work/log" 2>&1 || { result="found: see build/fuzz/found/$name.log"; failed=1; }
  cp "$work/log" "$found/$name.log"
  done_runs=$(sed -n 's/^stat::number_of_executed_units: *//p' "$work/log")
  seconds=$(sed -n 's/^Done .* in \([0-9]*\) second.*/\1/p' "$work/log")
  echo "| $name | ${done_runs:-?} | ${seconds:-?} | $result |"
  rm -rf "$work/corpus"
done
((fuzzed)) || { echo "fuzz.sh: no parser of that name; there are: $(cd "$bin" && ls fuzz_* | sed 's/^fuzz_//' | tr '\n' ' ')" >&2; exit 2; }
exit "$failed"
