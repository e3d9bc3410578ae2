# SPDX-License-Identifier: BSD-3-Clause
# The Debian 12 packages that DySLAM needs; sourced by the scripts that build.
PACKAGES=(
  build-essential cmake ninja-build ccache
  libmrpt-dev mrpt-apps libeigen3-dev libtbb-dev libceres-dev libpcl-dev libopencv-dev liboctomap-dev
  libembree-dev libtorch-dev libfastrtps-dev libcli11-dev libpcap-dev nlohmann-json3-dev
  libssl-dev libsqlite3-dev libdeflate-dev libisal-dev liblz4-dev libzstd-dev libbz2-dev librosbag-storage-dev
  libgtest-dev
  python3-numpy xz-utils
)

# Installs the missing packages of this list and of the arguments, with sudo if not root. Prints nothing
# if all are installed.
install_packages() {
  local missing=() package
  for package in "${PACKAGES[@]}" "$@"; do
    dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'install ok installed' || missing+=("$package")
  done
  ((${#missing[@]})) || return 0
  local sudo=()
  ((EUID == 0)) || sudo=(sudo)
  echo "Installing: ${missing[*]}"
  "${sudo[@]}" apt-get update -qq
  "${sudo[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null ||
    { echo "These are packages of Debian 12; on another system: docker build -t dyslam . (doc/install.md)" >&2; return 1; }
}
