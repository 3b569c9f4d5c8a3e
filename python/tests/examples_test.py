# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""The examples, and the listings of docs/python.md and docs/tutorial.md, run."""
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


def listings_of(page, language):
    found = re.findall(rf"```{language}\n(.*?)```", (ROOT / "docs" / page).read_text(), re.DOTALL)
    assert found
    return found


def test_the_tutorial_runs_as_it_stands(tmp_path):
    (tmp_path / "my_head.yaml").write_text("\n".join(listings_of("tutorial.md", "yaml")))
    (tmp_path / "tutorial.py").write_text("\n".join(listings_of("tutorial.md", "python")))
    told = run(tmp_path / "tutorial.py", cwd=tmp_path).splitlines()
    assert "no pose: " in told[0]
    assert told[1].endswith(", GOOD")
    assert re.fullmatch(r"\d{2,} landmarks; left out: {}", told[-1])


def test_the_listing_of_the_documentation_runs(tmp_path):
    for number, listing in enumerate(listings_of("python.md", "python")):
        (tmp_path / f"listing{number}.py").write_text(listing)
        assert "Good" in run(tmp_path / f"listing{number}.py", cwd=tmp_path)
