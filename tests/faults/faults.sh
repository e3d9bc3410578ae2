#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# The programs against faults of the machine and of files: faults.sh BIN_DIR SOURCE_DIR [CASE]
# Every case says in one line what must happen; the script fails if one does not.
set -u
bin=$(realpath "$1")
source=$(realpath "$2")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
recording=$source/rawlog/campus16.rawlog
failed=0

# slam OUTPUT [FLAGS...]: a short run without output. Only its errors are heard, in OUTPUT.err.
slam() { mkdir -p "$(dirname "$1")" && timeout 120 "$bin/dyslam" -v ERROR -i "${input:-$recording}" -c vlp16.ini -o "$@" 2>"$1.err"; }
# slam_in_background OUTPUT [FLAGS...]: waits until some scans are done and holds it there; sets `run`.
slam_in_background() {
  unset run
  timeout 120 "$bin/dyslam" -v ERROR -i "${input:-$recording}" -c vlp16.ini -o "$@" 2>"$1.err" &
  local guard=$!
  until [[ $(cat "$1/odometry_tum.txt.tmp" 2>/dev/null | wc -l) -ge ${scans:-5} ]]; do
    kill -0 "$guard" 2>/dev/null || return 1
    sleep 0.02
  done
  run=$(pgrep -P "$guard") && kill -STOP "$run"
}
go_on() { kill -CONT "$run" && wait %1; }
check() { "$@" || { echo "      not so: $*"; wrong=1; return 1; }; }
lacks() { ! grep -qs "$@"; }
no_leftovers() { [[ -z $(find "$1" -name '*.tmp' -o -name '.dyslam.lock') ]]; }
whole_results() { # of a run that came to an end, early or not
  local file
  for file in trajectory_tum.txt trajectory_kitti.txt odometry_tum.txt graph.graph graph.g2o \
    factor_graph.txt scans.csv motions.csv tracks.csv report.json; do
    check test -s "$1/$file"
  done
  check test -e "$1/tracks.txt" # perhaps there are none
  check no_leftovers "$1"
}

disk_full() { # a disk that takes no file over 40 kB
  (ulimit -f 40; slam a --only-first-n 10)
  check test $? -eq 1
  check grep -q 'replay.rawlog: cannot be written' a.err
  check grep -q 'not_written' a/report.json
  check test ! -e a/replay.rawlog -a ! -e a/map_static.ply
  check test "$(wc -l <a/trajectory_tum.txt)" -eq 10
  check test -s a/graph.g2o -a -s a/factor_graph.txt -a -s a/scans.csv
  check no_leftovers a
  check test "$(wc -l <a.err)" -eq 1
}
disk_too_small_for_memory() { # files are limited to 2 MB; the swapped data need 4.6 MB
  local file
  check slam n --only-first-n 80 --set output.replay=false
  (ulimit -f 2000; slam o --only-first-n 80 --set memory.limit=1 --set output.replay=false)
  check test $? -eq 0
  for file in trajectory_tum.txt keyframes.simplemap map_static.ply graph.g2o tracks.txt; do
    check cmp "n/$file" "o/$file"
  done
  check grep -q 'temporary file for what exceeds memory.limit cannot be written' o/report.json
  check lacks 'memory.limit cannot be written' n/report.json
}
folder_removed() {
  check slam_in_background b && rm -r b
  kill -INT "$run" && go_on
  check test $? -eq 1
  check grep -q 'b: was removed during the run' b.err
  check test -s b/trajectory_tum.txt -a -s b/graph.graph -a -s b/report.json
}
terminal_lost() {
  check slam_in_background c --only-first-n 60
  kill -HUP "$run" && go_on
  check test $? -eq 1
  check grep -q 'stopped on request after [0-9]* scans, whose results are in c; continue with: dyslam --resume -o c$' c.err
  whole_results c
  check grep -q '"finished": false' c/report.json
  check timeout 120 "$bin/dyslam" -v ERROR --resume -o c
}
killed() {
  local before
  for scans in 1 4 9; do
    check slam_in_background d
    kill -KILL "$run"
    wait %1 2>/dev/null
    before=$(find d -type f ! -name '*.tmp' ! -name effective.ini ! -name .dyslam.lock)
    check test -z "$before" # nothing has its name that is not whole
    check test "$(wc -l <d/odometry_tum.txt.tmp)" -ge "$scans"
  done
  scans=5
  check slam d --only-first-n 5
  whole_results d
}
same_results() { # FOLDER OTHER: every file, but for times of the clock
  check diff -rq -x report.json -x report.html -x effective.ini "$1" "$2"
  check diff <(grep -E '"(frames|keyframes|loops|tracks|map_points|path_length_m)"' "$1/report.json") \
    <(grep -E '"(frames|keyframes|loops|tracks|map_points|path_length_m)"' "$2/report.json")
}
killed_and_resumed() { # at random moments within scans, three times in one run; RECORDING, SCANS: of another
  local count=${SCANS:-25} input=${RECORDING:-$recording}
  local flags=(--only-first-n "$count" --labels --static-scans --set labels.window=6 --set backend.mode=full)
  local often=(--set output.checkpoint_seconds=0.02) run code scans tries=0
  check slam m/run "${flags[@]}" # pictures have the name of the last folder
  for ((round = 0; round < ${ROUNDS:-1}; ++round)); do
    rm -rf n && mkdir n
    timeout 120 "$bin/dyslam" -v ERROR -i "$input" -c vlp16.ini -o n/run "${flags[@]}" "${often[@]}" 2>n.err &
    for kill in 1 2 3; do # in the second, third and last quarter
      scans=$((count * kill / 4 + RANDOM % (count / 4)))
      until [[ -e n/run/resume.state && $(cat n/run/odometry_tum.txt.tmp 2>/dev/null | wc -l) -ge $scans ]] ||
        ! kill -0 $! 2>/dev/null; do sleep 0.00$((RANDOM % 10)); done
      run=$(pgrep -P $!) && kill -KILL "$run"
      wait $! 2>/dev/null
      [[ -e n/run/resume.state ]] || break # it had ended
      tries=$((tries + 1))
      grep -q '"finished": false' n/run/report.json || check test ! -e n/run/report.json
      timeout 120 "$bin/dyslam" -v ERROR --resume -o n/run 2>n.err &
    done
    wait $! 2>/dev/null
    code=$?
    check test "$code" -eq 0 -o "$code" -eq 127
    check no_leftovers n
    same_results m/run n/run
  done
  check test "$tries" -ge $((2 * ${ROUNDS:-1}))
  echo "      killed $tries times"
}
killed_at_a_checkpoint() { # while the state is being written
  local run attempt
  for attempt in 1 2 3 4 5 6 7 8 9 10; do # until a run is met there before it ends
    rm -rf o
    timeout 120 "$bin/dyslam" -v ERROR -i "$recording" -c vlp16.ini -o o --only-first-n 25 --labels \
      --set output.checkpoint_seconds=0.001 2>o.err &
    until [[ -e o/resume.state && -e o/resume.state.tmp ]] || ! kill -0 $! 2>/dev/null; do
      :
    done
    run=$(pgrep -P $!) && kill -KILL "$run"
    wait $! 2>/dev/null
    [[ -s o/resume.state ]] && break
  done
  check test -s o/resume.state -a -s o/trajectory_tum.txt
  [[ $wrong == 0 ]] || return
  check "$bin/dyslam-eval" run o >o.out 2>o.err
  check grep -q 'o: unfinished: [0-9]* of 25 scans' o.err
  cp -r o p
  printf '\x55' | dd of=p/resume.state bs=1 seek=$(($(stat -c %s p/resume.state) / 2)) conv=notrunc 2>/dev/null
  rm -f p/.dyslam.lock && find p -type f | sort >p.before
  "$bin/dyslam" -v ERROR --resume -o p 2>p.err
  check test $? -eq 1
  check grep -q 'p/resume.state: is damaged' p.err
  check diff p.before <(find p -type f | sort)
  check timeout 120 "$bin/dyslam" -v ERROR --resume -o o
  whole_results o
  "$bin/dyslam" --resume -o o 2>o.err
  check test $? -eq 1
  check grep -q 'nothing to resume' o.err
}
input_cut_in_mid_run() {
  cp "$recording" e.rawlog
  input=e.rawlog
  check slam_in_background e
  truncate -s $(($(stat -c %s e.rawlog) / 3)) e.rawlog
  go_on
  check test $? -eq 1
  check grep -q 'e.rawlog: .*results of the .* scans before it are in e' e.err
  whole_results e
  unset input
}
links() {
  echo mine >mine
  check slam f --only-first-n 2
  ln -sf ../mine f/trajectory_tum.txt
  ln -sf ../mine f/odometry_tum.txt.tmp
  check slam f --only-first-n 2
  check grep -qx mine mine
  check test -f f/trajectory_tum.txt -a ! -L f/trajectory_tum.txt
  mkdir g && head -c 1600 /dev/zero >g/0.bin
  ln -s mine g.rawlog.tmp
  check "$bin/scans2rawlog" -q -i g -o g.rawlog >g.out 2>&1
  check grep -qx mine mine
  check test ! -e g.rawlog.tmp
}
conversion_on_a_full_disk() {
  mkdir h && echo earlier >h.rawlog
  # 300,000 points that compress badly
  python3 -c 'import array, random
array.array("f", (random.uniform(0, 50) for _ in range(1200000))).tofile(open("h/0.bin", "wb"))'
  (ulimit -f 40; "$bin/scans2rawlog" -q --force -i h -o h.rawlog >h.out 2>h.err)
  check test $? -eq 1
  check grep -q 'h.rawlog: cannot be written' h.err
  check grep -qx earlier h.rawlog
  check test ! -e h.rawlog.tmp
}
bag_on_a_full_disk() {
  check slam r --only-first-n 10
  (ulimit -f 40; "$bin/rawlog2bag" -q --run r -o r.mcap >r.out 2>r.bag.err)
  check test $? -eq 1
  check grep -q '^rawlog2bag: r.mcap: cannot be written' r.bag.err
  check test "$(wc -l <r.bag.err)" -eq 1
  check test ! -e r.mcap -a ! -e r.mcap.tmp
}
batch_on_a_full_disk() { # a disk that takes nothing
  (ulimit -f 0; timeout 120 "$bin/dyslam-batch" "$source/rawlog" -o q 2>&1; echo "code $?") | cat >q.out
  check grep -qx 'code 1' q.out
  check test "$(grep -c ': failed, .*/manifest.json: cannot be written' q.out)" -eq 2
  check grep -q 'batch.json: cannot be written' q.out
}
output_that_takes_nothing() {
  "$bin/dyslam-eval" trajectory --reference "$source/rawlog/campus16.gt/poses_tum.txt" \
    --estimate "$source/rawlog/campus16.gt/poses_tum.txt" >/dev/full 2>i.err
  check test $? -eq 1
  check grep -q 'cannot write to standard output' i.err
}
name_that_is_no_text() {
  local name=$'j\xff\x1b[2J'
  check slam "$name" --only-first-n 3
  check timeout 60 "$bin/dyslam-eval" run "$name" --json j.json >j.out 2>&1
  check python3 -c 'import json; json.load(open("j.json")); json.load(open(b"j\xff\x1b[2J/report.json"))'
}
wild_numbers() {
  printf 'step,loss\n1e16,1\n10000000000000002,1e308\n' >k.csv
  check timeout 20 "$bin/dyslam-eval" curves k.csv >k.out
  printf '\x96CObservationPointCloud\0\xff\xff\xff\xff' >k.rawlog
  (ulimit -v 20000000; input=k.rawlog slam k)
  check test $? -eq 1
  check grep -q 'k.rawlog: is not a rawlog, or is damaged in its first object' k.err
  mkdir l && printf 'FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 4000000000\nHEIGHT 1\nDATA binary\nabc' >l/0.pcd
  "$bin/scans2rawlog" -q -i l -o l.rawlog 2>l.err
  check test $? -eq 1
  check grep -q '0.pcd: is cut short: its header announces 4000000000 points' l.err
  check test ! -e l.rawlog
}

must() { # CASE "what must happen"
  [[ -n ${only:-} && ${only:-} != "$1" ]] && return
  cases=$((cases + 1))
  wrong=0
  scans=5
  local begin=$SECONDS
  "$1" 2>&1
  [[ $wrong == 0 ]] && echo "ok    $1: $2 ($((SECONDS - begin)) s)" || { echo "WRONG $1: $2"; failed=1; }
}
only=${3:-}
cases=0
must disk_full "the files that fit are whole, one line names the others, exit code 1"
must folder_removed "what is written at the end is in a new folder, and the user is told"
must terminal_lost "the run ends as by Ctrl-C, with all results of the scans so far"
must killed "no incomplete file has its final name; the next run takes the folder over"
must killed_and_resumed "the resumed run gives the same bytes as one that was not interrupted"
must killed_at_a_checkpoint "the state before it is whole; a damaged one is an error and nothing is removed"
must input_cut_in_mid_run "all results of the scans before the cut, and the reason"
must links "files that links point to stay as they are"
must disk_too_small_for_memory "memory grows instead, the results are the same, a warning says so"
must conversion_on_a_full_disk "the earlier file stays, nothing half is left, exit code 1"
must bag_on_a_full_disk "nothing half is left, exit code 1"
must batch_on_a_full_disk "every recording is a failure that names the file, exit code 1"
must output_that_takes_nothing "a full standard output is an error"
must name_that_is_no_text "a folder name that is not UTF-8 still gives valid JSON"
must wild_numbers "counts and steps that cannot be are refused at once, without memory"
((cases)) || { echo "no case $only" >&2; exit 2; }
exit $failed
