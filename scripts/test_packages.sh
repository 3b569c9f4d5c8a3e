#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
# Builds the wheel and the Debian packages and tries them in a Debian 12 with nothing else in it: the wheel, the program
# after its own installation, the library for a program of a user, the module of Python. As root, or where a user may make namespaces (mmdebstrap picks).
# Needs the network and 4 GB under $TMPDIR, which are gone afterwards.
set -euo pipefail
cd "$(dirname "$0")/.."

# Runs in the new system, as a script of its own; packages and consumer/ lie in its /tmp/try.
inside() {
  set -euo pipefail
  step="begin"
  trap 'echo "test_packages: FAILED: $step" >&2' ERR
  export DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8
  install_them() { apt-get install -qq -y --no-install-recommends "$@" >apt.log 2>&1 || { tail -20 apt.log; return 1; }; }
  cd /tmp/try

  step="wheel: follows a flight, with nothing of the system but Python and numpy"; echo "== $step"
  install_them python3-venv python3-numpy
  python3 -m venv --system-site-packages wheel
  wheel/bin/pip install -q --no-index --no-deps ./edged-*.whl
  wheel/bin/python -c '
import edged
assert list(edged.run(edged.simulate("room", 1, end_s=5)))[-1].status == edged.Status.GOOD'
  wheel/bin/edged run sim:room:1 --to 3 --quiet --out run_wheel >wheel.txt

  step="edged: is installed with what it depends on"; echo "== $step"
  install_them ./edged_*.deb man-db
  step="edged: the program starts, and finds its rigs and networks"; echo "== $step"
  edged --version
  rigs=$(edged manual rigs)
  grep -qx davis240c_ecd <<<"$rigs"
  edged depth >depth.txt
  step="edged: man page and completion are there"; echo "== $step"
  man edged >page.txt
  grep -q "edged simulate" page.txt
  test -f /usr/share/zsh/vendor-completions/_edged && test -f /usr/share/fish/vendor_completions.d/edged.fish
  bash -c 'source /usr/share/bash-completion/completions/edged && complete -p edged' >/dev/null
  step="edged: the demo ends good"; echo "== $step"
  edged simulate --preset room --seed 1 --quiet --out flight
  edged run flight --quiet --out run
  grep -q '"status": "good"' run/metrics.json
  edged run sim:room:1 --quiet --out run_sim >sim.txt

  step="libedged-dev: is installed with what it depends on"; echo "== $step"
  install_them ./libedged-dev_*.deb g++ cmake make
  step="libedged-dev: a program of a user is built against it, and runs"; echo "== $step"
  cmake -S consumer -B consumer/build >cmake.txt 2>&1 || { cat cmake.txt; false; }
  cmake --build consumer/build
  consumer/build/sensors
  consumer/build/fly

  step="python3-edged: is installed with what it depends on"; echo "== $step"
  install_them ./python3-edged_*.deb
  step="python3-edged: follows a flight, and finds the rigs of the program"; echo "== $step"
  python3 -c '
import edged
assert "davis240c_ecd" in edged.known_rigs()
steps = list(edged.run(edged.simulate("room", 1, end_s=5)))
assert steps[-1].status == edged.Status.GOOD, steps[-1]
print(steps[-1])'

  step="all: leave nothing behind"; echo "== $step"
  apt-get purge -qq -y edged libedged-dev python3-edged >/dev/null 2>&1
  left=$(find /usr /etc /var/lib -path /var/lib/dpkg -prune -o -path '*edged*' -print)
  [ -z "$left" ] || { echo "$left"; false; }
}

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
scripts/setup.sh binutils dpkg-dev file lintian mmdebstrap patchelf python3-pip
cmake --preset package >/dev/null
cmake --build --preset package
rm -f build/package/*.deb
(cd build/package && cpack -G DEB)
# The project has no mail address, and its changelog another form.
lintian --allow-root --fail-on error,warning --suppress-tags malformed-contact,syntax-error-in-debian-changelog \
  build/package/*.deb

mkdir "$work/try"
{ declare -f inside && echo inside; } >"$work/try/inside.sh"
cp -r build/package/*.deb tests/consumer "$work/try"
/usr/bin/python3 -m pip --disable-pip-version-check wheel -q --no-deps --no-build-isolation \
  --config-settings=build-dir=build/package --config-settings=libraries=inside -w "$work/try" .
mmdebstrap --quiet --variant=apt --customize-hook="copy-in '$work/try' /tmp" \
  --customize-hook='chroot "$1" bash /tmp/try/inside.sh' bookworm /dev/null
echo "test_packages: all is well"
