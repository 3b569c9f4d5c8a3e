#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
# Configures build/release. A new folder merges the sources of a module, which takes a third of the time to build; one
# that is there stays as it was configured.
set -euo pipefail
cd "$(dirname "$0")/.."
merged=()
if [ ! -e build/release/CMakeCache.txt ]; then
  merged=(-DCMAKE_UNITY_BUILD=ON)
fi
cmake --preset release "${merged[@]}" >/dev/null
