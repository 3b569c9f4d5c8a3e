# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""The examples, and the listing of docs/python.md, run."""
import pathlib
import re
import subprocess
import sys

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
EXAMPLES = ROOT / "python" / "examples"


def run(*command, cwd):
    done = subprocess.run([sys.executable, "-B", *map(str, command)], capture_output=True, text=True, check=False, cwd=cwd,
                          timeout=300)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_arrays_of_ones_own_are_followed(tmp_path):
    lines = run(EXAMPLES / "follow.py", 3, cwd=tmp_path).splitlines()
    assert "INITIALIZING" in lines[0]
    assert "GOOD" in lines[-2]
    assert re.fullmatch(r"\d+ packets; left out: .*", lines[-1])


def test_a_run_is_drawn(tmp_path):
    pytest.importorskip("matplotlib", reason="python3-matplotlib is not installed (scripts/setup.sh leaves it out: it is large)")
    run(EXAMPLES / "plot_run.py", "sim:room", "--seconds", 4, cwd=tmp_path)
    assert (tmp_path / "run.png").read_bytes().startswith(b"\x89PNG")


def test_the_listing_of_the_documentation_runs(tmp_path):
    listings = re.findall(r"```python\n(.*?)```", (ROOT / "docs" / "python.md").read_text(), re.DOTALL)
    assert listings
    for number, listing in enumerate(listings):
        (tmp_path / f"listing{number}.py").write_text(listing)
        assert "Good" in run(tmp_path / f"listing{number}.py", cwd=tmp_path)
