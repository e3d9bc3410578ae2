#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The tables of a split: simulates its eleven drives, runs every method on them and prints odometry, moving
# points, absolute errors and times in Markdown.
set -eu
usage="Usage: split_tables.sh [-s SPLIT] [-k DRIVES] [-t SECONDS] [-m METHODS] [-l LENGTHS] [-o DIR]

  -s  validation or test (validation); test is evaluated once per release
  -k  numbers of the drives, several with spaces between (00 01 02 03 04 05 06 07 08 09 10)
  -t  at most this many seconds of each drive, 0 for all (0)
  -m  methods, several with spaces between (dyslam network causal dylo dylo+refine gicp loam
      loam_no_mapping icp_po2po icp_po2pl): dyslam is the whole pipeline, causal the same without
      hindsight, network the segmentation network without motion prior; a scan matcher is alone, with
      +refine before registration to the local map
  -l  segment lengths of t_rel [m] (100,200,300,400,500,600,700,800)
  -o  folder for recordings, runs and tables.md (./split_tables); existing ones are kept

Settings are the automatic ones for the sensor. The programs are taken from \$DYSLAM_BIN, else from the PATH. Times
depend on the machine: run no other programs."
split=validation
drives="00 01 02 03 04 05 06 07 08 09 10"
seconds=0
methods="dyslam network causal dylo dylo+refine gicp loam loam_no_mapping icp_po2po icp_po2pl"
lengths=100,200,300,400,500,600,700,800
output=split_tables
while getopts s:k:t:m:l:o:h option; do
  case $option in
    s) split=$OPTARG ;;
    k) drives=$OPTARG ;;
    t) seconds=$OPTARG ;;
    m) methods=$OPTARG ;;
    l) lengths=$OPTARG ;;
    o) output=$OPTARG ;;
    h) echo "$usage"; exit 0 ;;
    *) echo "$usage" >&2; exit 2 ;;
  esac
done
shift $((OPTIND - 1))
[ $# -eq 0 ] || { echo "$usage" >&2; exit 2; }
bin=${DYSLAM_BIN:+$DYSLAM_BIN/}
recordings=$output/drives
runs=$output/runs
mkdir -p "$recordings" "$runs"

# The settings of a method, as flags of dyslam.
settings() {
  alone="--set dyseg.method=none --set pipeline.tracking=false --set pipeline.mapping=false"
  case $1 in
    dyslam) echo "--labels" ;;
    causal) echo "--labels --set labels.hindsight=false --set pipeline.mapping=false" ;;
    network) echo "--labels --set labels.hindsight=false --set dyseg.method=network --set dyseg_network.search=global" \
      "--set pipeline.tracking=false --set pipeline.mapping=false" ;;
    *+refine) echo "--set odometry.method=${1%+refine} $alone" ;;
    *) echo "--set odometry.method=$1 --set refine.method=none $alone" ;;
  esac
}

for drive in $drives; do
  name=${split}_$drive
  rawlog=$recordings/$name.rawlog
  limit=
  [ "$seconds" = 0 ] || limit="--seconds $seconds"
  # shellcheck disable=SC2086
  [ -f "$rawlog" ] || "${bin}dyslam-sim" -q --benchmark "$recordings" --split "$split" --only "$name" $limit >&2
  for method in $methods; do
    run=$runs/$name/$method
    grep -qs '"finished": true' "$run/report.json" && continue
    mkdir -p "$runs/$name"
    # A run that registered less than half of its scans ends with 2 but has results.
    # shellcheck disable=SC2046
    "${bin}dyslam" -i "$rawlog" -o "$run" -v ERROR --set output.replay=false --set output.page=false \
      $(settings "$method") > "$run.log" 2>&1 || grep -qs '"finished": true' "$run/report.json" || {
        tail -n 3 "$run.log" >&2
        echo "split_tables.sh: dyslam failed on $rawlog with $method; its output is in $run.log" >&2
        exit 1
      }
  done
done
"${bin}dyslam-eval" tables "$runs" --lengths "$lengths" --markdown "$output/tables.md"
