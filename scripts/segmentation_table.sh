#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The effect of each segmentation method on the whole pipeline: drift, IoU, and moving points left in the
# map, on rawlogs with true poses and labels (NAME.gt).
set -eu
usage="Usage: segmentation_table.sh [-c CONFIG] [-n SCANS] [-m METHODS] [-o DIR] [-s KEY=VALUE] RAWLOG...

  -c  ini file or shipped name (kitti64.ini)
  -n  scans of each rawlog, 0 for all (0)
  -m  methods, several with spaces between (none residual network)
  -o  folder for the runs' results (./segmentation_table); an existing run is not repeated
  -s  additional setting of every run; repeatable

The programs are taken from \$DYSLAM_BIN, else from the PATH."
config=kitti64.ini
scans=0
output=segmentation_table
methods="none residual network"
settings=
while getopts c:n:m:o:s:h option; do
  case $option in
    c) config=$OPTARG ;;
    n) scans=$OPTARG ;;
    m) methods=$OPTARG ;;
    o) output=$OPTARG ;;
    s) settings="$settings --set $OPTARG" ;;
    h) echo "$usage"; exit 0 ;;
    *) echo "$usage" >&2; exit 2 ;;
  esac
done
shift $((OPTIND - 1))
[ $# -gt 0 ] || { echo "$usage" >&2; exit 2; }
bin=${DYSLAM_BIN:+$DYSLAM_BIN/}

for rawlog in "$@"; do
  name=$(basename "$rawlog" .rawlog)
  truth=${rawlog%.rawlog}.gt
  reference=$output/$name/reference
  mkdir -p "$output/$name"
  folders=
  maps=
  for method in $methods; do
    folder=$output/$name/$method
    folders="$folders $folder"
    maps="$maps $folder/map_static.ply"
    # shellcheck disable=SC2086
    grep -qs '"finished": true' "$folder/report.json" || "${bin}dyslam" -i "$rawlog" -c "$config" -o "$folder" --labels \
      --only-first-n "$scans" --set "dyseg.method=$method" $settings > "$folder.log" 2>&1 || grep -qs '"finished": true' "$folder/report.json" || {
        tail -n 3 "$folder.log" >&2
        echo "segmentation_table.sh: dyslam failed on $rawlog with $method; its output is in $folder.log" >&2
        exit 1
      }
  done
  # Every point with its true label, in the frame of the runs' maps.
  [ -f "$reference.ply" ] || "${bin}dyslam-map" -q -i "$rawlog" \
    --trajectory "${folder}/reference_tum.txt" --labels "$truth/labels" --only-first-n "$scans" \
    --keyframe-distance 1 -o "$output/$name/true_static.ply" --labelled-map "$reference.ply" > "$output/$name/reference.log"
  echo "== $name"
  # shellcheck disable=SC2086
  "${bin}dyslam-eval" run $folders
  # shellcheck disable=SC2086
  "${bin}dyslam-eval" map --reference "$reference.ply" --estimate $maps
done
