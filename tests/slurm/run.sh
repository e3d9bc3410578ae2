#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# dyslam-batch on a real Slurm of this machine against dyslam-batch without: the same bytes, though tasks
# are killed and requeued on the way. Twenty short recordings, cut from the bundled one. Needs root and
# Debian's slurm-wlm and munge, which it installs.
#   tests/slurm/run.sh [build/release/bin] [folder for everything]
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
source "$here/../../scripts/dependencies.sh"
source "$here/cluster.sh"
install_packages slurm-wlm munge
bin=$(realpath "${1:-$here/../../build/release/bin}")
work=${2:-$(mktemp -d)}
mkdir -p "$work"
work=$(realpath "$work")
count=${COUNT:-20}
scans=${SCANS:-6}
trap 'code=$?; stop_cluster; exit $code' EXIT
SECONDS=0

# Recordings of $scans scans with true poses, each of a world of its own.
mkdir -p "$work/in"
for shard in 1 2; do
  "$bin/dyslam-sim" --world campus --sensor VLP16 --columns 450 --compact --no-flow --no-stops -q --count "$count" \
    --seconds "$(awk "BEGIN {print $scans / 10}")" --shard "$shard/2" -o "$work/in" >/dev/null
done
(($(ls "$work"/in/*.rawlog | wc -l) == count)) || { echo "dyslam-sim --shard did not write $count recordings" >&2; exit 1; }
# So that a task lasts until it is killed, a few recordings are longer.
cp "$here"/../../rawlog/campus16.rawlog "$work/in/long1.rawlog"
cp "$here"/../../rawlog/campus16.rawlog "$work/in/long2.rawlog"
total=$((count + 2))
echo "$total recordings after $SECONDS s"

options=(--set dyseg.method=residual --labels)
"$bin/dyslam-batch" "$work/in" "${options[@]}" -o "$work/local" -q >"$work/local.txt"
echo "local batch ended after $SECONDS s"

start_cluster "$work/cluster" "$(nproc)"
echo "Slurm runs after $SECONDS s"
submitted=$("$bin/dyslam-batch" "$work/in" "${options[@]}" -o "$work/slurm" --slurm)
echo "$submitted"
array=$(sed -E 's/.* in job ([0-9]+),.*/\1/' <<<"$submitted")
gather=$(sed -E 's/.*; job ([0-9]+) gathers.*/\1/' <<<"$submitted")

# The first long recording: its dyslam-batch is killed, the task asks to be queued again. The second is
# requeued by Slurm, as at preemption.
pid_of() { pgrep -f "^$bin/dyslam-batch .*--shard $1/" | head -1; }
started() { [[ -n $(pid_of "$1") ]] && compgen -G "${TMPDIR:-/tmp}/dyslam.*/$2/log.txt" >/dev/null; }
task_of() { grep -n "/$1.rawlog" "$work/slurm/slurm/recordings.txt" | cut -d: -f1; }
first=$(task_of long1) second=$(task_of long2)
wait_for 300 started "$first" long1
kill -9 "$(pid_of "$first")"
echo "killed dyslam-batch of task $first after $SECONDS s"
wait_for 300 started "$second" long2
scontrol requeue "${array}_$second"
echo "requeued task $second after $SECONDS s"

ended() { scontrol show job "$gather" | grep -Eq 'JobState=(COMPLETED|FAILED|CANCELLED)'; }
wait_for 600 ended
scontrol show job "$gather" | grep -q 'JobState=COMPLETED' || { cat "$work/slurm/slurm/gather.log" >&2; exit 1; }
echo "all jobs ended after $SECONDS s"
for task in "$first" "$second"; do
  scontrol show job "${array}_$task" | grep -Eq 'Restarts=[1-9]' || { echo "task $task was not queued again" >&2; exit 1; }
done

# All but what holds times: the figures of speed, the log, the manifest.
different=$(diff -rq -x report.json -x report.html -x log.txt -x manifest.json "$work/local" "$work/slurm" |
  grep -Ev 'Only in .*/slurm: slurm$|/(index.html|batch.json|table.txt|table.csv|table.json) ' || true)
[[ -z $different ]] || { echo "$different" >&2; exit 1; }
[[ $(ls "$work/slurm" | grep -cE '^(campus|long)') == "$total" ]] || { echo "results are missing" >&2; exit 1; }
[[ -z $(find "${TMPDIR:-/tmp}" -maxdepth 1 -name 'dyslam.*' -newer "$work/local.txt") ]] || echo "note: scratch folders are left"
tail -1 "$work/slurm/slurm/gather.log"
echo "same bytes in $(find "$work/slurm" -type f -not -path "$work/slurm/slurm/*" | wc -l) files; $SECONDS s in all"
