#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
# Installs what is missing, builds everything and runs every test, what has threads first under the thread sanitizer; ends
# with ctest's summary of all tests as released.
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/setup.sh
for preset in tsan release; do
  echo "== $preset"
  cmake --preset "$preset" >/dev/null
  cmake --build --preset "$preset"
  ctest --preset "$preset" --parallel "$(nproc)"
done
