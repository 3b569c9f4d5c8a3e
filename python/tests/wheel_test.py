# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""`pip wheel` and `pip install` of the sources, from the build at hand and without a network."""
import importlib.util
import os
import pathlib
import subprocess
import sys
import zipfile

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PIP = [sys.executable, "-m", "pip", "--disable-pip-version-check"]


def run(*command, cwd=None, env=None):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False, cwd=cwd, env=env, timeout=500)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(name="wheel", scope="module")
def a_wheel(tmp_path_factory):
    if "EDGED_BUILD" not in os.environ:
        pytest.skip("EDGED_BUILD names the build")
    if importlib.util.find_spec("pip") is None:
        pytest.skip("python3-pip is not installed")
    folder = tmp_path_factory.mktemp("wheel")
    run(*PIP, "wheel", "--no-index", "--no-deps", f"--config-settings=build-dir={os.environ['EDGED_BUILD']}", "-w", folder, ROOT)
    return next(folder.glob("edged-*.whl"))


def test_the_wheel_holds_module_program_rigs_presets_and_networks(wheel):
    names = zipfile.ZipFile(wheel).namelist()
    assert {"edged/__init__.py", "edged/__init__.pyi", "edged/bin/edged", "edged/share/edged/rigs/davis240c_ecd.yaml",
            "edged/share/edged/presets/room.yaml"} <= set(names)
    assert any(name.startswith("edged/_edged.") for name in names)
    assert any(name.startswith("edged/share/edged/depth/") for name in names)


def test_an_installed_wheel_runs_away_from_the_sources(wheel, tmp_path):
    run(*PIP, "install", "--no-index", "--no-deps", "--target", tmp_path / "site", wheel)
    env = {key: value for key, value in os.environ.items() if not key.startswith("EDGED")} | {"PYTHONPATH": str(tmp_path / "site")}
    told = run(sys.executable, "-B", "-c", "import edged; print(edged.__file__, edged.known_rigs(), "
               "list(edged.run(edged.simulate('room', 1, end_s=1.2)))[-1].status)", cwd=tmp_path, env=env)
    assert str(tmp_path / "site") in told and "davis240c_ecd" in told and "Status.GOOD" in told
    assert "edged 0." in run(tmp_path / "site" / "bin" / "edged", "--version", cwd=tmp_path, env=env)
    assert "davis240c_ecd" in run(tmp_path / "site" / "edged" / "bin" / "edged", "manual", "rigs", cwd=tmp_path, env=env)
