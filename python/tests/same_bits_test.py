# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""The module gives what the program gives."""
import json

import numpy as np
import pytest
from support import DATA, assert_same_states, program, room, states

import edged


def assert_nearly_the_same(mine, told):
    assert type(mine) is type(told)
    if isinstance(mine, dict):
        assert list(mine) == list(told)
        for key in mine:
            assert_nearly_the_same(mine[key], told[key])
    elif isinstance(mine, list):
        assert len(mine) == len(told)
        for one, other in zip(mine, told):
            assert_nearly_the_same(one, other)
    else:
        assert mine == pytest.approx(told, rel=1e-9, abs=1e-12)


@pytest.mark.parametrize("mode", ["fused", "events", "frames"])
def test_a_simulated_flight_has_the_states_of_the_program(tmp_path, mode):
    program("run", "sim:room:1", "--to", 3, "--mode", mode, "--quiet", "--out", tmp_path / "run")
    assert_same_states(list(edged.run(room(), mode)), states(tmp_path / "run"))


def test_options_and_arrays_of_ones_own_give_the_states_of_the_program(tmp_path):
    program("run", "sim:room:1", "--to", 2, "--set", "estimator.iterations=2", "--set", "packets.max_interval_s=0.03", "--quiet",
            "--out", tmp_path / "run")
    recording = room(2)
    odometry = edged.Odometry(recording.calibration, "fused", {"estimator.iterations": 2, "packets.max_interval_s": 0.03},
                              in_order=True)
    steps: list[edged.Step] = []
    for measurement in recording:
        data = measurement.data.copy()
        if measurement.kind == "events":
            odometry.add_events(measurement.camera, data)
        elif measurement.kind == "frame":
            odometry.add_frame(measurement.camera, measurement.t, data)
        else:
            odometry.add_imu(data)
        data[:] = np.zeros(1, data.dtype)  # what has been added is the library's own
        steps += odometry
    odometry.finish()
    steps += odometry
    assert_same_states(steps, states(tmp_path / "run"))


def test_a_recording_on_disk_has_the_states_of_the_program(tmp_path):
    flight = tmp_path / "flight"
    program("simulate", "--duration", 2, "--out", flight, "--quiet")
    program("run", flight, "--quiet", "--out", tmp_path / "run")
    assert_same_states(list(edged.run(edged.open_recording(flight))), states(tmp_path / "run"))


@pytest.mark.parametrize("path, rig, mode, end_s", [("mirror/mirror_fast.h5", "davis240c_ecd", "fused", 3),
                                                    ("euroc_mh01", None, "frames", 7)])
def test_a_recording_of_others_has_the_states_of_the_program(tmp_path, path, rig, mode, end_s):
    if not (DATA / path).exists():
        pytest.skip(f"no {DATA / path}")
    with_rig = ["--rig", rig] if rig else []
    program("run", DATA / path, *with_rig, "--mode", mode, "--to", end_s, "--quiet", "--out", tmp_path / "run")
    assert_same_states(list(edged.run(edged.open_recording(DATA / path, rig, end_s=end_s), mode)), states(tmp_path / "run"))


def test_an_evaluation_has_the_numbers_of_the_program(tmp_path):
    flight = tmp_path / "flight"
    program("simulate", "--duration", 6, "--out", flight, "--quiet")
    program("run", flight, "--mode", "frames", "--quiet", "--out", tmp_path / "run")
    recording = edged.open_recording(flight)
    assert recording.ground_truth
    frame, truth = recording.ground_truth
    estimate = edged.trajectory(edged.run(recording, "frames"), frame)
    told = json.loads(program("eval", flight / "groundtruth.txt", tmp_path / "run" / "trajectory.tum", "--json", "--protocol", "P4"))
    for about_files in ("ground_truth_columns", "estimate_columns", "ground_truth_time_offset"):
        del told[about_files]
    mine = edged.evaluate(estimate, truth, "P4")
    assert mine["ate_m"]["rmse"] < 0.05
    metrics = json.loads((tmp_path / "run" / "metrics.json").read_text())["evaluation"]
    assert edged.evaluate(estimate, truth)["ate_m"]["rmse"] == pytest.approx(metrics["ate_m"]["rmse"], rel=1e-12)
    # Quaternions are normalised as often as they are taken in: the last digits are rounded otherwise.
    assert_nearly_the_same(mine, told)
    written = edged.read_trajectory(tmp_path / "run" / "trajectory.tum")
    assert np.array_equal(written["t"], estimate["t"])
    assert np.allclose(written["position"], estimate["position"], rtol=0, atol=1e-14)
