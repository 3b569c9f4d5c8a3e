# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""The examples, and the listings of docs/python.md and docs/tutorial.md, run."""
import json
import pathlib
import re
import subprocess
import sys

import pytest
from support import code_cells, notebooks

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


@pytest.fixture
def matplotlib(monkeypatch):
    pytest.importorskip("matplotlib", reason="python3-matplotlib is not installed (scripts/setup.sh leaves it out: it is large)")
    monkeypatch.setenv("MPLBACKEND", "Agg")


@pytest.mark.usefixtures("matplotlib")
def test_a_run_is_drawn(tmp_path):
    run(EXAMPLES / "plot_run.py", "sim:room", "--seconds", 4, cwd=tmp_path)
    assert (tmp_path / "run.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize("notebook", notebooks(), ids=lambda path: path.stem)
def test_a_notebook_runs_up_to_its_plots(notebook, tmp_path):
    (tmp_path / "notebook.py").write_text("".join(cell for cell in code_cells(notebook) if "matplotlib" not in cell))
    told = re.search(r"(\d+) poses, ([\d.]+) mm off", run(tmp_path / "notebook.py", cwd=tmp_path))
    assert told and int(told[1]) > 80 and float(told[2]) < 20


@pytest.mark.usefixtures("matplotlib")
@pytest.mark.parametrize("notebook", notebooks(), ids=lambda path: path.stem)
def test_a_notebook_draws_its_plots(notebook, tmp_path):
    (tmp_path / "notebook.py").write_text("".join(code_cells(notebook)) + "plt.savefig('plot.png')\n")
    run(tmp_path / "notebook.py", cwd=tmp_path)
    assert (tmp_path / "plot.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize("notebook", notebooks(), ids=lambda path: path.stem)
def test_a_notebook_is_small_and_without_outputs(notebook):
    cells = [cell for cell in json.loads(notebook.read_text())["cells"] if cell["cell_type"] == "code"]
    assert all(cell["outputs"] == [] and cell["execution_count"] is None for cell in cells)
    assert notebook.stat().st_size < 10_000


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
