#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Every odometry method, alone and with registration to the local map, on rawlogs with ground truth: one
# table of dyslam-eval per rawlog.
set -eu
usage="Usage: odometry_table.sh [-c CONFIG] [-n SCANS] [-m METHODS] [-o DIR] [-l LENGTHS] RAWLOG...

  -c  ini file or shipped name (kitti64.ini; for 16 beams, and most lidars with 32, vlp16.ini)
  -n  scans of each rawlog, 0 for all (0)
  -m  methods, several with spaces between; NAME is the method alone, NAME+refine with the local map,
      dyseg+NAME after the network has segmented the moving points
      (dylo dylo+refine constant_velocity+refine icp_po2po icp_po2pl gicp loam_no_mapping loam zero_motion)
  -o  folder for the runs' results (./odometry_table); an existing run is not repeated
  -l  segment lengths of t_rel [m] (\"5 10 20\"); KITTI's are \"100 200 300 400 500 600 700 800\",
      which dyslam-eval tables and dyslam-eval run have by default, for drives of 100 m and more
  -h, --help

The programs are taken from \$DYSLAM_BIN, else from the PATH."
config=kitti64.ini
scans=0
output=odometry_table
lengths="5 10 20"
methods="dylo dylo+refine constant_velocity+refine icp_po2po icp_po2pl gicp loam_no_mapping loam zero_motion"
case ${1:-} in --help) echo "$usage"; exit 0 ;; esac
while getopts c:n:m:o:l:h option; do
  case $option in
    c) config=$OPTARG ;;
    n) scans=$OPTARG ;;
    m) methods=$OPTARG ;;
    o) output=$OPTARG ;;
    l) lengths=$OPTARG ;;
    h) echo "$usage"; exit 0 ;;
    *) echo "$usage" >&2; exit 2 ;;
  esac
done
shift $((OPTIND - 1))
[ $# -gt 0 ] || { echo "$usage" >&2; exit 2; }
bin=${DYSLAM_BIN:+$DYSLAM_BIN/}

for rawlog in "$@"; do
  name=$(basename "$rawlog" .rawlog)
  folders=
  for method in $methods; do
    folder=$output/$name/$method
    folders="$folders $folder"
    grep -qs '"finished": true' "$folder/report.json" && continue
    refine=none
    case $method in *+refine) refine=point_to_plane ;; esac
    segmenter=none
    case $method in dyseg+*) segmenter=network ;; esac
    name_only=${method#dyseg+}
    "${bin}dyslam" -i "$rawlog" -c "$config" -o "$folder" -v ERROR --only-first-n "$scans" \
      --set "odometry.method=${name_only%+refine}" --set "refine.method=$refine" \
      --set "dyseg.method=$segmenter" --set pipeline.tracking=false --set pipeline.mapping=false ||
      # Ends with 2, but has results, if it registered less than half of the scans.
      grep -qs '"finished": true' "$folder/report.json"
  done
  echo "$name"
  # shellcheck disable=SC2086
  "${bin}dyslam-eval" run $folders --lengths "$(echo "$lengths" | tr ' ' ',')"
  echo
done
