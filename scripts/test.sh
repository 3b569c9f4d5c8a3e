#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
# Installs what is missing, builds everything and runs every test, first what has threads under the thread sanitizer
# and what is not too long under those of addresses and undefined behaviour; ends with ctest's summary of all tests as
# released.
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/setup.sh
for preset in tsan sanitize release; do
  echo "== $preset"
  cmake --preset "$preset" >/dev/null
  cmake --build --preset "$preset"
  ctest --preset "$preset" --parallel "$(nproc)"
done
