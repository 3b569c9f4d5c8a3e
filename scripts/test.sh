#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
# Installs what is missing, builds everything and runs the tests as released, but for the longest (label stress): 20
# minutes on two cores. --full, which CI runs: these as well, and before them what has threads under the thread
# sanitizer, what is not too long under those of addresses and undefined behaviour, and the public headers and the
# pipeline through clang-tidy. Ends with ctest's summary of the tests as released. Before the summary it warns of tests
# that take longer than 20 s without a reason in tests/long_tests.txt.
set -euo pipefail
cd "$(dirname "$0")/.."

began=$(date +%s)
presets=(release)
left_out=(--label-exclude stress)
tools=()
case "${1:-}" in
  "") ;;
  --full) presets=(tsan sanitize release) left_out=() tools=(clang clang-tidy libclang-rt-14-dev) ;;
  *) echo "usage: scripts/test.sh [--full]" >&2; exit 2 ;;
esac

scripts/setup.sh "${tools[@]}"
if [ "${#tools[@]}" -gt 0 ]; then scripts/tidy.sh; fi
for preset in "${presets[@]}"; do
  echo "== $preset [$(( ($(date +%s) - began) / 60 )) min]"
  if [ "$preset" = release ]; then scripts/configure.sh; else cmake --preset "$preset" >/dev/null; fi
  cmake --build --preset "$preset"
  watch=(tools/long_tests.py --since "$began")
  if [ "$preset" != release ]; then watch+=(--no-warnings); fi
  ctest --preset "$preset" --parallel "$(nproc)" "${left_out[@]}" | "${watch[@]}"
done
