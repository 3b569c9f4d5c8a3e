#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
# Installs what ROS 1 needs (60 MB of Debian packages), builds the node and tries it: its translation, then a mirror
# played to it in real time, which wants the recordings (CONTRIBUTING.md) and a machine that does nothing else.
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/setup.sh libroscpp-dev libtopic-tools-dev python3-genmsg \
  ros-std-msgs ros-geometry-msgs ros-nav-msgs ros-sensor-msgs ros-diagnostic-msgs ros-tf2-msgs \
  python3-roslaunch python3-rosmaster python3-rosbag rosout
cmake --preset release -B build/ros1 -DEDGED_ROS1=ON -DEDGED_PYTHON=OFF -DEDGED_BENCH=OFF >/dev/null
cmake --build build/ros1 --target edged edged_node edged_ros1_test
ctest --test-dir build/ros1 --label-regex ros1 --no-tests=error --output-on-failure
