#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
# Installs what is missing of the compiler and libraries, from Debian's packages alone. Quick when all is there.
# Usage: scripts/setup.sh [FURTHER_PACKAGE ...]
set -euo pipefail

packages=(
  g++ cmake ninja-build pkg-config git python3 ca-certificates xz-utils clang-format doxygen
  libopencv-dev libopencv-contrib-dev libeigen3-dev  # contrib: aruco, for the tags of calibration targets
  libceres-dev libopengv-dev
  zlib1g-dev libpng-dev libturbojpeg0-dev libyaml-cpp-dev libcli11-dev libcpp-httplib-dev libspdlog-dev libfmt-dev nlohmann-json3-dev
  libbz2-dev liblz4-dev libzstd-dev libsqlite3-dev libtinyxml2-dev libzip-dev libflatbuffers-dev
  libhdf5-dev libblosc-dev liblzf-dev liboctomap-dev
  cyclonedds-dev                                           # topics of ROS 2
  cyclonedds-tools libfastrtps-dev libfastcdr-dev          # their tests
  pybind11-dev python3-dev python3-numpy python3-pip python3-pytest python3-yaml mypy
  python3-rosbag libgtest-dev libgmock-dev libbenchmark-dev
  "$@"
)

if ! command -v dpkg-query >/dev/null; then
  echo "setup: this is no Debian; install what these packages hold: ${packages[*]}" >&2
  exit 1
fi

missing=()
for package in "${packages[@]}"; do
  status=$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null || true)
  [ "$status" = installed ] || missing+=("$package")
done
[ ${#missing[@]} -eq 0 ] && exit 0

as_root=()
if [ "$(id -u)" -ne 0 ]; then
  if ! command -v sudo >/dev/null; then
    echo "setup: needs root or sudo to install: ${missing[*]}" >&2
    exit 1
  fi
  as_root=(sudo)
fi

echo "setup: installing ${missing[*]}"
export DEBIAN_FRONTEND=noninteractive
"${as_root[@]}" apt-get update -q
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends "${missing[@]}"
