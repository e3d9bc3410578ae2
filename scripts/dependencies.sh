# SPDX-License-Identifier: BSD-3-Clause
# The one list of what DySLAM needs from Debian 12; sourced by demo.sh, test.sh and .ci/run.
PACKAGES=(
  build-essential cmake ninja-build ccache
  libmrpt-dev mrpt-apps libeigen3-dev libtbb-dev libceres-dev libpcl-dev libopencv-dev liboctomap-dev
  libembree-dev libtorch-dev libcli11-dev libpcap-dev nlohmann-json3-dev
  libssl-dev libsqlite3-dev libdeflate-dev libisal-dev liblz4-dev libzstd-dev libbz2-dev librosbag-storage-dev
  libgtest-dev
  python3-numpy xz-utils
)

# Installs what is missing of these and of the arguments, with sudo where we are not root. Quiet when there
# is nothing to do.
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
  DEBIAN_FRONTEND=noninteractive "${sudo[@]}" apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
}
