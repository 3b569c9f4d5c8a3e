#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
# Runs clang-tidy on the pipeline and, through it, on the public headers: two minutes on two cores. A warning is an error.
# Usage: scripts/tidy.sh BUILD_FOLDER; it must be configured, without a unity build.
set -euo pipefail
cd "$(dirname "$0")/.."

find src/edged/pipeline -name '*.cpp' ! -name '*_test.cpp' -print0 | sort -z |
  xargs -0 -n 1 -P "$(nproc)" clang-tidy -p "$1" --quiet --warnings-as-errors='*' 2>&1 |
  { grep -v ' warnings\? generated\.$' || true; }
