#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Every sensor of dyslam-sim in every world, with the default settings: unregistered scans, t_rel and the
# error at the end, one table row per recording.
set -eu
usage="Usage: sensor_table.sh [-s SEEDS] [-t SECONDS] [-w WORLDS] [-k SENSORS] [-o DIR] [-l LENGTHS]

  -s  seeds of the simulated worlds (21)
  -t  seconds of each recording (5)
  -w  worlds (urban campus highway tunnel)
  -k  sensors (HDL64E VLS128 OS1-128 OS1-64 PANDAR64 OS1-32 VLP32C XT32 HDL32E VLP16 AVIA)
  -o  folder for recordings and runs (./sensor_table); existing ones are kept
  -l  segment lengths of t_rel [m] (5,10,20)

The programs are taken from \$DYSLAM_BIN, else from the PATH."
seeds=21
seconds=5
worlds="urban campus highway tunnel"
sensors="HDL64E VLS128 OS1-128 OS1-64 PANDAR64 OS1-32 VLP32C XT32 HDL32E VLP16 AVIA"
output=sensor_table
lengths=5,10,20
while getopts s:t:w:k:o:l:h option; do
  case $option in
    s) seeds=$OPTARG ;;
    t) seconds=$OPTARG ;;
    w) worlds=$OPTARG ;;
    k) sensors=$OPTARG ;;
    o) output=$OPTARG ;;
    l) lengths=$OPTARG ;;
    h) echo "$usage"; exit 0 ;;
    *) echo "$usage" >&2; exit 2 ;;
  esac
done
shift $((OPTIND - 1))
[ $# -eq 0 ] || { echo "$usage" >&2; exit 2; }
bin=${DYSLAM_BIN:+$DYSLAM_BIN/}
mkdir -p "$output"

echo "| sensor | world | seed | unregistered | t_rel % | end m |"
echo "|---|---|---|---|---|---|"
for seed in $seeds; do
  for world in $worlds; do
    for sensor in $sensors; do
      run=$output/$sensor-$world-$seed
      columns=1024
      [ "$sensor" = AVIA ] && columns=0
      [ -f "$run.rawlog" ] || "${bin}dyslam-sim" -q --world "$world" --sensor "$sensor" --seed "$seed" \
        --traffic 0.3 --seconds "$seconds" --columns "$columns" --no-flow -o "$run.rawlog" > "$run.log"
      # A run that registered less than half of its scans ends with 2 but has results.
      grep -qs '"finished": true' "$run/report.json" || "${bin}dyslam" -i "$run.rawlog" -o "$run" -q > "$run.log" 2>&1 \
        || grep -qs '"finished": true' "$run/report.json" || {
          tail -n 3 "$run.log" >&2
          echo "sensor_table.sh: dyslam failed on $run.rawlog; its output is in $run.log" >&2
          exit 1
        }
      "${bin}dyslam-eval" trajectory --reference "$run.gt/poses_tum.txt" --estimate "$run/trajectory_tum.txt" \
        --lengths "$lengths" --align first --csv "$run/trajectory.csv" > /dev/null
      awk -F, -v sensor="$sensor" -v world="$world" -v seed="$seed" '
        FNR == 1 { for (i = 1; i <= NF; ++i) column[FILENAME, $i] = i }
        FNR > 1 && FILENAME ~ /scans.csv$/ { ++scans; lost += $column[FILENAME, "registered"] == 0 }
        FNR == 2 && FILENAME ~ /trajectory.csv$/ {
          t_rel = $column[FILENAME, "t_rel [%]"]; end = $column[FILENAME, "end [m]"] }
        function cell(value) { return value == "" ? "-" : sprintf("%.2f", value) }
        END { printf "| %s | %s | %s | %d of %d | %s | %s |\n", sensor, world, seed, lost, scans, cell(t_rel), cell(end) }
        ' "$run/scans.csv" "$run/trajectory.csv"
    done
  done
done
