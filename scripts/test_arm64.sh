#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
# Builds the program for 64-bit ARM with Debian's cross compiler, runs it under qemu-user and holds its poses against
# those of the program for this machine over the first 3 s of a recording, in every mode: how many fields of states.csv
# are identical, how far the poses are apart, how long they stay within 1e-6 m. Once with the optical flow of its own
# OpenCV, once with this machine's played back (tests/arm64/flow_tape.cpp), which leaves what our code makes different.
# Fails if the poses part within 1 s, or played back within 2 s: docs/library.md says why they do at all.
# Usage: scripts/test_arm64.sh [RECORDING[=RIG] ...]; without any: a simulated flight, and mirror_poster where
# $EDGED_DATA (../shared/data) has it. The arm64 libraries (0.7 GB) lie in a folder of their own, gone afterwards;
# EDGED_SYSROOT=FOLDER keeps them there for the next time, EDGED_ARM64_BUILD=FOLDER the build.
set -euo pipefail
cd "$(dirname "$0")/.."

seconds=3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
sysroot=$(realpath -m "${EDGED_SYSROOT:-$work/root}")
build=$(realpath -m "${EDGED_ARM64_BUILD:-$work/build}")
libraries=$sysroot/usr/lib/aarch64-linux-gnu

# The libraries that scripts/setup.sh installs, unpacked only: nothing in there is run, so that nothing is set up.
make_sysroot() {
  local packages
  packages=$(sed -n '/^packages=(/,/^)/p' scripts/setup.sh | grep -oE '(lib|zlib|nlohmann)[a-z0-9+-]*-dev' |
    grep -vE 'gtest|gmock|benchmark' | paste -sd,)
  mmdebstrap --quiet --variant=extract --arch=arm64 --include="$packages" \
    --dpkgopt='path-exclude=/usr/share/*' --dpkgopt='path-include=/usr/share/cmake*' \
    --dpkgopt='path-include=/usr/share/eigen3*' --dpkgopt='path-include=/usr/share/pkgconfig*' \
    --dpkgopt='path-exclude=/usr/lib/*/libopencv_*.a' --dpkgopt='path-exclude=/usr/lib/*/libLLVM*' \
    --dpkgopt='path-exclude=/usr/lib/*/dri/*' --dpkgopt='path-exclude=/usr/lib/*/gconv/*' bookworm "$sysroot.part"
  # What the packages' own scripts would have done: of several BLAS one is chosen, ATLAS, as on a Debian with these.
  local part=$sysroot.part/usr/lib/aarch64-linux-gnu name
  for name in libblas.so libblas.so.3 liblapack.so liblapack.so.3; do ln -s "atlas/$name" "$part/$name"; done
  # Ceres names its libraries by absolute paths.
  sed -i "s#;/usr/lib/#;$sysroot/usr/lib/#g" "$part/cmake/Ceres/CeresTargets.cmake"
  mv "$sysroot.part" "$sysroot"
}

# The optical flow goes onto the tape here, and comes from it there if it is played.
here() { EDGED_FLOW_TAPE=$work/tape LD_PRELOAD=$work/tape_x86.so build/release/bin/edged "$@"; }
on_arm64() { qemu-aarch64 -L "$sysroot" -E LD_LIBRARY_PATH="$libraries" "$build/bin/edged" "$@"; }
played_on_arm64() {
  qemu-aarch64 -L "$sysroot" -E LD_LIBRARY_PATH="$libraries" -E EDGED_FLOW_TAPE="$work/tape" \
    -E LD_PRELOAD="$work/tape_arm64.so" "$build/bin/edged" "$@"
}

# Leaves states.csv also where the piece is too short for a good pose (4) or a verdict (5).
run() { "$@" --quiet >"$work/run.txt" 2>&1 || [ $? -eq 4 ] || [ $? -eq 5 ] || { cat "$work/run.txt"; return 1; }; }

scripts/setup.sh mmdebstrap g++-aarch64-linux-gnu qemu-user
[ -d "$sysroot" ] || make_sysroot
cmake --preset release >/dev/null
cmake --build --preset release --target edged
cmake -S . -B "$build" -G Ninja --toolchain "$PWD/cmake/aarch64-linux-gnu.cmake" -DEDGED_SYSROOT="$sysroot" \
  -DCMAKE_BUILD_TYPE=Release -DCMAKE_UNITY_BUILD=ON \
  -DEDGED_TESTS=OFF -DEDGED_BENCH=OFF -DEDGED_PYTHON=OFF >/dev/null
cmake --build "$build" --target edged
tape=(-std=c++20 -O2 -Wall -shared -fPIC tests/arm64/flow_tape.cpp -o)
c++ -isystem /usr/include/opencv4 "${tape[@]}" "$work/tape_x86.so"
aarch64-linux-gnu-g++ --sysroot="$sysroot" -isystem "$sysroot/usr/include/opencv4" "${tape[@]}" "$work/tape_arm64.so"

recordings=("$@")
if [ $# -eq 0 ]; then
  # Made here: the simulator's own sines and roots may end in another bit over there.
  build/release/bin/edged simulate --preset room --seed 1 --duration "$seconds" --quiet --out "$work/room"
  recordings=("$work/room")
  packed=${EDGED_DATA:-../shared/data}/mirror/mirror_poster.tar.xz
  if [ -f "$packed" ]; then
    tar -xJf "$packed" -C "$work"
    recordings+=("$work/mirror_poster=davis240c_ecd")
  fi
fi

failed=0
# Runs what the arguments say and compares it with the run here; leaves a line of the table.
hold_against_here() {
  local name=$1 least_s=$2 near
  shift 2
  run "$@" --out "$work/arm64"
  near=$(tools/near_bits "$work/x86" "$work/arm64" --for "$least_s") || failed=1
  { echo "$name: ${near%%$'\n'*}"; grep flow_tape "$work/run.txt" || true; } | tee -a "$work/table.txt"
  rm -rf "$work/arm64"
}
for recording in "${recordings[@]}"; do
  rig=()
  [[ $recording != *=* ]] || rig=(--rig "${recording#*=}")
  for mode in events frames fused; do
    options=("${recording%%=*}" --mode "$mode" --to "$seconds" "${rig[@]}")
    name="$(basename "${recording%%=*}") $mode"
    rm -rf "$work/x86" "$work/tape"
    run here run "${options[@]}" --out "$work/x86"
    hold_against_here "$name, flow of its own" 1 on_arm64 run "${options[@]}"
    hold_against_here "$name, flow played back" 2 played_on_arm64 run "${options[@]}"
  done
done
printf '\narm64 against x86-64, %s s at %s:\n' "$seconds" "$(git describe --always --dirty)"
cat "$work/table.txt"
[ "$failed" -eq 0 ] || { echo "test_arm64: FAILED: poses part too soon" >&2; exit 1; }
echo "test_arm64: all is well"
