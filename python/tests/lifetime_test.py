# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""Arrays are the library's memory, and outlive what they came from."""
import gc

import numpy as np
import pytest
from support import room

import edged


def test_the_arrays_of_a_step_outlive_it_and_what_follows():
    """As they were when the step came, after the odometry has gone on for hundreds of packets and is gone itself."""
    kept: list = []
    copies: list = []
    for step in edged.run(room(3)):
        arrays = [step.event_frame, step.frame, step.events, step.event_tracks, step.frame_tracks, step.landmarks]
        kept.append(arrays)
        copies.append([None if array is None else array.copy() for array in arrays])
    del step, arrays
    gc.collect()
    noise = [np.full(240 * 180, 77, np.uint8) for _ in range(200)]  # takes what has been freed
    assert len(noise) == 200
    assert sum(len(arrays[3]) for arrays in kept) > 100
    for arrays, copied in zip(kept, copies):
        for array, copy in zip(arrays, copied):
            assert (array is None) == (copy is None)
            assert array is None or np.array_equal(array, copy)


def test_the_arrays_of_a_measurement_outlive_the_recording():
    recording = room(0.5)
    kept = [(measurement.kind, measurement.data) for measurement in recording]
    copies = [data.copy() for _, data in kept]
    del recording
    gc.collect()
    assert {kind for kind, _ in kept} == {"events", "frame", "imu"}
    assert all(np.array_equal(data, copy) for (_, data), copy in zip(kept, copies))


def test_they_are_to_be_looked_at():
    measurement = next(m for m in room(0.5) if m.kind == "frame")
    with pytest.raises(ValueError):
        measurement.data[0, 0] = 1


def test_no_copy_is_made():
    measurement = next(m for m in room(0.5) if m.kind == "events")
    assert measurement.data.ctypes.data == measurement.data.ctypes.data
    assert np.shares_memory(measurement.data, measurement.data)
    assert measurement.data.base is measurement


def test_the_cameras_of_a_step_outlive_it():
    cameras = list(edged.run(room(3)))[-1].cameras
    gc.collect()
    assert [(name, camera.modality) for name, camera in cameras.items()] == [("events", "events"), ("frames", "frames")]
    events = cameras["events"]
    assert events.name == "events" and 0 < events.rendered <= len(events.events) and events.event_rate_hz > 0
    assert 0 < events.survival_rate <= 1 and events.image is not None and events.image.shape == (180, 240)
    tracks = cameras["frames"].tracks
    del cameras, events
    gc.collect()
    assert len(tracks) > 10 and np.isfinite(tracks["pixel"]).all()


def test_the_first_of_a_kind_has_names_of_its_own():
    for step in edged.run(room(2), "events"):
        assert list(step.cameras) == ["events"]
        assert np.array_equal(step.event_tracks["id"], step.cameras["events"].tracks["id"])
        assert step.event_track_survival_rate == step.cameras["events"].survival_rate
        assert len(step.frame_tracks) == 0 and step.frame is None and step.frame_track_survival_rate is None


def test_a_step_says_what_it_is():
    step = list(edged.run(room(3)))[-1]
    assert step.status == edged.Status.GOOD
    assert step.is_tracking
    assert step.T_W_B.shape == (4, 4)
    assert np.allclose(step.T_W_B[:3, 3], step.position)
    x, y, z, w = step.quaternion
    assert np.isclose(step.T_W_B[2, 1], 2 * (y * z + x * w))  # the order of the quaternion
    for covariance in (step.position_covariance, step.rotation_covariance, step.velocity_covariance):
        assert covariance is not None and covariance.shape == (3, 3)
    assert step.event_frame is not None and step.event_frame.shape == (180, 240)
    assert step.event_tracks["pixel"].shape == (len(step.event_tracks), 2)
    assert set(step.landmarks["id"]) & set(step.frame_tracks["id"])
    assert np.ptp(step.landmarks["p_W"], axis=0).max() > 0.5
    assert 0 < step.rendered <= len(step.events)
    assert "Good" in repr(step)
