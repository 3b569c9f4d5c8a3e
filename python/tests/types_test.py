# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""mypy finds nothing in stub, examples, notebooks and tests, and its stubtest no difference between stub and module.
Settings: pyproject.toml."""
import importlib.util
import pathlib
import subprocess
import sys

import pytest
from support import code_cells, notebooks

ROOT = pathlib.Path(__file__).resolve().parents[2]
# pybind11's classes have a metaclass and an __init__ that takes anything.
OF_EVERY_CLASS = r"edged\.[A-Z][a-z]\w+(\.__init__)?" + "\n"


@pytest.fixture(autouse=True)
def mypy_is_there():
    if importlib.util.find_spec("mypy") is None:
        pytest.fail("mypy is missing: scripts/setup.sh installs it, or apt-get install mypy", pytrace=False)


def check(*command):
    done = subprocess.run([sys.executable, "-B", "-m", *map(str, command)], capture_output=True, text=True, check=False,
                          cwd=ROOT, timeout=300)
    assert done.returncode == 0, done.stdout + done.stderr


def test_types_fit_in_stub_examples_notebooks_and_tests(tmp_path):
    programs = []
    for notebook in notebooks():
        programs.append(tmp_path / f"{notebook.stem}.py")
        programs[-1].write_text("".join(code_cells(notebook)))
    check("mypy", "--cache-dir", tmp_path / "cache", "python/edged", "python/examples", "python/tests", *programs)


def test_stub_and_module_have_the_same_names_arguments_and_defaults(tmp_path):
    (tmp_path / "allowed").write_text(OF_EVERY_CLASS)
    check("mypy.stubtest", "edged", "--mypy-config-file", "pyproject.toml", "--allowlist", tmp_path / "allowed")
