#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
# From a fresh machine to a result: installs, builds, simulates a flight, estimates it, and prints how good that was.
# Quick when run again. Usage: scripts/demo.sh [PRESET] [SEED]
set -euo pipefail
cd "$(dirname "$0")/.."
preset=${1:-room}
seed=${2:-1}

scripts/setup.sh
scripts/configure.sh
cmake --build --preset release --target edged

edged=build/release/bin/edged
flight=build/demo/${preset}_$seed
# A flight of an earlier build may come from another simulator: make it again.
if [ ! -f "$flight/complete" ] || [ "$edged" -nt "$flight/complete" ]; then
  rm -rf "$flight"
  echo "simulating a flight ..."
  "$edged" simulate --preset "$preset" --seed "$seed" --out "$flight"
  touch "$flight/complete"
fi
echo "estimating it from events, frames and IMU ..."
"$edged" run "$flight" --force --out "build/demo/run_${preset}_$seed"
