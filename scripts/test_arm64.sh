#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
# Builds the program for 64-bit ARM with Debian's cross compiler, runs it under qemu-user and holds its poses against
# those of the program for this machine over the first 3 s of a recording, in every mode: how many fields of states.csv
# are identical, how far the poses are apart, how long they stay within 1e-6 m. Fails if that is less than 1 s:
# docs/library.md says why it is not all of it.
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

on_arm64() { qemu-aarch64 -L "$sysroot" -E LD_LIBRARY_PATH="$libraries" "$build/bin/edged" "$@"; }

# Leaves states.csv also where the piece is too short for a good pose (4) or a verdict (5).
run() { "$@" --quiet >"$work/run.txt" 2>&1 || [ $? -eq 4 ] || [ $? -eq 5 ] || { cat "$work/run.txt"; return 1; }; }

scripts/setup.sh mmdebstrap g++-aarch64-linux-gnu qemu-user
[ -d "$sysroot" ] || make_sysroot
cmake --preset release >/dev/null
cmake --build --preset release --target edged
cmake -S . -B "$build" -G Ninja --toolchain "$PWD/cmake/aarch64-linux-gnu.cmake" -DEDGED_SYSROOT="$sysroot" \
  -DCMAKE_BUILD_TYPE=Release -DCMAKE_UNITY_BUILD=ON -DCMAKE_UNITY_BUILD_BATCH_SIZE=8 \
  -DEDGED_TESTS=OFF -DEDGED_BENCH=OFF -DEDGED_PYTHON=OFF >/dev/null
cmake --build "$build" --target edged

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
for recording in "${recordings[@]}"; do
  rig=()
  [[ $recording != *=* ]] || rig=(--rig "${recording#*=}")
  for mode in events frames fused; do
    options=("${recording%%=*}" --mode "$mode" --to "$seconds" "${rig[@]}")
    run build/release/bin/edged run "${options[@]}" --out "$work/x86"
    run on_arm64 run "${options[@]}" --out "$work/arm64"
    echo "== $(basename "${recording%%=*}") $mode"
    tools/near_bits "$work/x86" "$work/arm64" --for 1 || failed=1
    rm -rf "$work/x86" "$work/arm64"
  done
done
[ "$failed" -eq 0 ] || { echo "test_arm64: FAILED: apart by more than 1e-6 m within 1 s" >&2; exit 1; }
echo "test_arm64: all is well"
