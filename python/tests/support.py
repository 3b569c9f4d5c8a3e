# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""What the tests of the module share. $EDGED: the program, for what must be the same."""
import csv
import json
import os
import pathlib
import subprocess

import numpy as np

import edged

ROOT = pathlib.Path(__file__).resolve().parents[2]
DATA = pathlib.Path(os.environ.get("EDGED_DATA", ROOT.parent / "shared" / "data"))


LEAVES_STATES = (0, 4, 5)  # exit codes of edged run: good, never good, not to be trusted


def program(*arguments):
    done = subprocess.run([os.environ["EDGED"], *map(str, arguments)], capture_output=True, text=True, check=False, timeout=300)
    assert done.returncode in LEAVES_STATES, done.stderr
    return done.stdout


def notebooks():
    found = sorted((ROOT / "python" / "examples").glob("*.ipynb"))
    assert found
    return found


def code_cells(notebook):
    cells = json.loads(notebook.read_text())["cells"]
    return ["".join(cell["source"]) + "\n" for cell in cells if cell["cell_type"] == "code"]


def states(folder):
    """The rows of states.csv, by column."""
    with open(folder / "states.csv", encoding="utf-8") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def numbers(row, *columns):
    return [float(row[column]) for column in columns]


def assert_same_states(steps, rows):
    """To the last bit: what is written reads back as it was."""
    assert len(steps) == len(rows) > 0
    for step, row in zip(steps, rows):
        assert step.t == int(row["t_ns"])
        assert step.status.name == row["status"].upper()
        assert step.keyframe == (row["keyframe"] == "1")
        assert [len(step.event_tracks), len(step.frame_tracks), len(step.landmarks)] == numbers(
            row, "event_tracks", "frame_tracks", "landmarks")
        for health, column in ((step.event_track_survival_rate, "event_track_survival_rate"), (step.frame_track_survival_rate, "frame_track_survival_rate")):
            assert health == (float(row[column]) if row[column] else None)
        if step.status != edged.Status.INITIALIZING:
            assert [*step.position, *step.quaternion] == numbers(row, "px_m", "py_m", "pz_m", "qx", "qy", "qz", "qw")
            assert [*step.velocity] == numbers(row, "vx_mps", "vy_mps", "vz_mps")
            assert [*step.bias_gyro] == numbers(row, "bgx_radps", "bgy_radps", "bgz_radps")
            assert [*step.bias_accel] == numbers(row, "bax_mps2", "bay_mps2", "baz_mps2")
        if step.position_covariance is not None:
            assert [*step.position_covariance[np.triu_indices(3)]] == numbers(
                row, "p_xx_m2", "p_xy_m2", "p_xz_m2", "p_yy_m2", "p_yz_m2", "p_zz_m2")
            assert [*step.velocity_covariance[np.triu_indices(3)]] == numbers(
                row, "v_xx_m2ps2", "v_xy_m2ps2", "v_xz_m2ps2", "v_yy_m2ps2", "v_yz_m2ps2", "v_zz_m2ps2")


def room(seconds=3):
    """The begin of the demo's flight, as `edged run sim:room:1 --to SECONDS` has it."""
    return edged.simulate("room", 1, end_s=seconds)
