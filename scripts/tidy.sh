#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
# Runs clang-tidy on the pipeline and, through it, on the public headers: two minutes on two cores. A warning is an error.
set -euo pipefail
cd "$(dirname "$0")/.."

# Each source by itself, and the library alone; nothing is built.
cmake -S . -B build/tidy -G Ninja -DCMAKE_EXPORT_COMPILE_COMMANDS=ON -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON \
  -DEDGED_TOOLBOX=OFF -DEDGED_APPS=OFF -DEDGED_PYTHON=OFF -DEDGED_TESTS=OFF -DEDGED_BENCH=OFF >/dev/null
find src/edged/pipeline -name '*.cpp' ! -name '*_test.cpp' -print0 | sort -z |
  xargs -0 -n 1 -P "$(nproc)" clang-tidy -p build/tidy --quiet --warnings-as-errors='*' 2>&1 |
  { grep -v ' warnings\? generated\.$' || true; }
