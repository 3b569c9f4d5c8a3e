# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""Recordings as iterables."""
import logging
import shutil

import numpy as np
import pytest
from support import program, room

import edged


@pytest.fixture(name="flight", scope="module")
def a_flight(tmp_path_factory):
    folder = tmp_path_factory.mktemp("flight") / "flight"
    program("simulate", "--duration", 1, "--out", folder, "--quiet")
    return folder


def test_a_recording_gives_its_measurements_in_order(flight):
    recording = edged.open_recording(flight)
    assert (recording.info.format, recording.info.has_imu) == ("ecd", True)
    measurements = list(recording)
    assert {m.kind for m in measurements} == {"events", "frame", "imu"}
    stamps = [m.t for m in measurements]
    assert stamps == sorted(stamps)
    events = np.concatenate([m.data for m in measurements if m.kind == "events"])
    assert events.dtype == edged.EVENT
    assert len(events) > 1000  # it is at rest
    assert (np.diff(events["t"]) >= 0).all()
    assert all(m.data.shape == (180, 240) for m in measurements if m.kind == "frame")
    assert np.concatenate([m.data for m in measurements if m.kind == "imu"])["accel"].shape[1] == 3
    assert not list(recording)  # once


def test_several_cameras_of_a_kind_are_read_where_they_are_asked_for(flight, tmp_path):
    for camera in ("events", "images"):
        shutil.copy(flight / f"{camera}.txt", tmp_path / f"{camera}2.txt")
        shutil.copy(flight / f"{camera}.txt", tmp_path / f"{camera}.txt")
    shutil.copytree(flight / "images", tmp_path / "images")
    names = lambda recording: [camera.name for camera in recording.info.cameras]
    assert names(edged.open_recording(tmp_path)) == ["events", "frames"]
    assert names(edged.open_recording(tmp_path, cameras=["events2", "frames2"])) == ["events2", "frames2"]
    both = edged.open_recording(tmp_path, cameras="all")
    assert [(c.name, c.kind, c.sensor) for c in both.info.cameras[:2]] == [("events", "events", (240, 180)),
                                                                           ("events2", "events", (240, 180))]
    assert {m.camera for m in both if m.kind == "frame"} == {"frames", "frames2"}
    with pytest.raises(edged.InputError, match="'all'"):
        edged.open_recording(tmp_path, cameras="both")
    assert names(edged.simulate("room", 1, 0.1, baseline_m=0.1)) == ["events", "events2", "frames", "frames2"]


def test_ground_truth_comes_as_poses(flight):
    truth = edged.open_recording(flight).ground_truth
    assert truth
    frame, poses = truth
    assert frame == "events"
    assert poses.dtype == edged.POSE
    assert np.allclose(np.linalg.norm(poses["quaternion"], axis=1), 1)
    assert len(poses) > 100


def test_a_piece_of_a_recording_is_read(flight):
    stamps = [m.t for m in edged.open_recording(flight, begin_s=0.2, end_s=0.4) if m.kind == "frame"]
    assert stamps
    assert max(stamps) - min(stamps) < 0.2e9


def test_damage_is_repaired_counted_and_logged_to_python(flight, tmp_path, caplog):
    damaged = tmp_path / "damaged"
    damaged.mkdir()
    for file in flight.iterdir():
        (damaged / file.name).symlink_to(file)
    text = (flight / "imu.txt").read_text().splitlines()
    (damaged / "imu.txt").unlink()
    (damaged / "imu.txt").write_text("\n".join(text[:50] + ["what is this"] + text[51:]) + "\n")
    recording = edged.open_recording(damaged)
    with caplog.at_level(logging.INFO, logger="edged"):
        assert sum(m.kind == "imu" for m in recording) >= len(text) - 5
    assert sum(recording.repairs.values()) > 0, recording.repairs


def test_what_cannot_be_repaired_is_one_line(flight, tmp_path):
    cut = tmp_path / "cut.bag"
    cut.write_bytes(b"#ROSBAG V2.0\n" + bytes(100))
    with pytest.raises(edged.InputError) as caught:
        list(edged.open_recording(cut))
    assert "cut.bag" in str(caught.value)
    assert len(str(caught.value).splitlines()) == 1
    with pytest.raises(edged.InputError, match="time_unit"):
        edged.open_recording(flight, time_unit="fortnights")  # type: ignore[arg-type]


def test_a_recording_without_calibration_says_what_to_give(flight, tmp_path):
    bare = tmp_path / "bare"
    bare.mkdir()
    for name in ("events.txt", "imu.txt"):
        (bare / name).symlink_to(flight / name)
    with pytest.raises(edged.InputError, match="rig=NAME"):
        next(edged.run(edged.open_recording(bare)))
    with pytest.raises(edged.InputError, match="frames"):
        next(edged.run(edged.open_recording(bare, rig="davis240c_ecd"), "fused"))
    edged.open_recording(bare, rig=edged.load_rig("davis240c_ecd")).odometry()


def test_simulations_have_options_and_names():
    assert "room" in edged.simulator_presets()
    recording = edged.simulate("room", 3, 0.3, {"imu.rate_hz": 400})
    assert recording.info.format == "simulator"
    assert sum(m.kind == "imu" for m in recording) > 100
    assert room().ground_truth[0] == "body"
