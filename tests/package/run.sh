#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# The Debian packages of dist/, which scripts/build_packages.sh makes, used as a user does.
#   tests/package/run.sh               unpacked into a clean folder, on this machine's libraries (seconds)
#   tests/package/run.sh --root DIR    apt install in a bare Debian 12 that debootstrap makes in DIR (minutes;
#                                      about 3 GB; needs root and the network)
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
dist=$(realpath "${DIST:-$here/../../dist}")
packages=("$dist"/dyslam_*.deb)
[[ -f ${packages[0]} ]] || { echo "no package dyslam in $dist: run scripts/build_packages.sh" >&2; exit 1; }
[[ ${#packages[@]} == 1 ]] || { echo "several packages dyslam in $dist: ${packages[*]##*/}" >&2; exit 1; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
fail() { echo "$*" >&2; exit 1; }

if [[ ${1:-} == --root ]]; then
  source "$here/../../scripts/dependencies.sh"
  PACKAGES=()
  install_packages debootstrap
  root=${2:?give a folder}
  mirror=${MIRROR:-http://deb.debian.org/debian}
  [[ -e $root/etc/debian_version ]] || debootstrap --variant=minbase bookworm "$root" "$mirror" >"$work/debootstrap.log" ||
    { tail -5 "$work/debootstrap.log" >&2; exit 1; }
  cp "${packages[0]}" "$root/tmp/"
  for file in /etc/apt/apt.conf.d/*proxy* /etc/apt/sources.list.d/*; do
    [[ -f $file ]] && install -D "$file" "$root$file"
  done
  in_root() { chroot "$root" env -i PATH=/usr/bin:/bin:/usr/sbin:/sbin HOME=/root DEBIAN_FRONTEND=noninteractive "$@"; }
  mountpoint -q "$root/proc" || mount -t proc proc "$root/proc"
  trap 'umount "$root/proc" || true; rm -rf "$work"' EXIT
  in_root apt-get update -qq 2>"$work/apt.log"
  in_root apt-get install -y -qq --no-install-recommends "/tmp/$(basename "${packages[0]}")" >"$work/apt.log" 2>&1 ||
    { tail -5 "$work/apt.log" >&2; exit 1; }
  examples=/usr/share/doc/dyslam/examples
  run() { in_root "$@"; }
  out=/tmp/result
  seen=$root$out
else
  dpkg -x "${packages[0]}" "$work/prefix"
  examples=$work/prefix/usr/share/doc/dyslam/examples
  run() { local program=$1; shift; "$work/prefix/usr/bin/$program" "$@"; }
  out=$work/result
  seen=$out
fi

run dyslam -i "$examples/campus16.rawlog" -c vlp16.ini --only-first-n 30 --labels -o "$out"
run dyslam -i "$examples/street64.rawlog" --only-first-n 10 -o "$out.64" -v ERROR
run dyslam-eval run "$out" "$out.64"
for file in report.html map_static.ply trajectory_tum.txt labels/000029.label; do
  [[ -s $seen/$file ]] || fail "$file is missing"
done
grep -q 'method.*network' "$seen.64/report.json" || fail "64 beams without the network: $(grep method "$seen.64/report.json")"

# The weights for non-commercial use are in a package of their own.
[[ $(dpkg -c "${packages[0]}") != **/dyseg.safetensors* ]] || fail "dyseg.safetensors in the package dyslam"
for weights in dylo dyseg; do
  [[ $(dpkg -c "$dist"/dyslam-weights-noncommercial_*.deb) == *models/$weights.safetensors* ]] || fail "no $weights.safetensors"
done

[[ $(dpkg -c "${packages[0]}") == */dyslam/libdyslam-window.so* ]] || fail "no module for --window"
[[ $(dpkg -c "${packages[0]}") == */dyslam/libdyslam-ros2.so* ]] || fail "no module for topics of ROS 2"

# The networks are there twice, and the plain ones run, too.
[[ $(dpkg -c "${packages[0]}") == *x86-64-v3/libdyslam-networks.so* ]] || fail "no networks for machines with AVX2"
if [[ -d $work/prefix ]]; then
  DYSLAM_CPU=baseline run dyslam -i "$examples/street64.rawlog" --only-first-n 10 -o "$out.plain" -v ERROR
  grep -q 'method.*network' "$out.plain/report.json" || fail "DYSLAM_CPU=baseline: no network"
fi

# Every program has a man page and completion, and they name its flags.
contents=$(dpkg -c "${packages[0]}")
dpkg -x "${packages[0]}" "$work/unpacked"
for program in "$work"/unpacked/usr/bin/*; do
  name=$(basename "$program")
  page=$(zcat "$work/unpacked/usr/share/man/man1/$name.1.gz" | tr -d '\\')
  [[ $page == *--help* ]] || fail "$name.1 does not name --help"
  bash -c "source '$work/unpacked/usr/share/bash-completion/completions/$name' && complete -p $name" >/dev/null
done
echo "packages: good"
