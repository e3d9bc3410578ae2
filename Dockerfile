# SPDX-License-Identifier: BSD-3-Clause
# The programs on Debian 12, for any system with Docker or Podman:
#   docker build -t dyslam .
#   docker run --rm -u "$(id -u):$(id -g)" -v "$PWD:/data" dyslam dyslam -i drive.mcap -o out
FROM debian:12 AS build
WORKDIR /dyslam
COPY scripts/dependencies.sh scripts/
RUN bash -c 'set -e; . scripts/dependencies.sh; install_packages ca-certificates dpkg-dev help2man lintian'
COPY . .
RUN scripts/build_packages.sh

FROM debian:12
RUN --mount=type=bind,from=build,source=/dyslam/dist,target=/dist \
    apt-get update -qq && \
    DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends /dist/dyslam_*.deb >/dev/null && \
    rm -rf /var/lib/apt/lists/*
WORKDIR /data
CMD ["dyslam", "--help"]
