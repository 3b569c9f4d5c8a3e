# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""Height and velocity sensors."""
import numpy as np
import pytest
from support import room

import edged

WITH: dict[str, float] = {"height.rate_hz": 25, "velocity.rate_hz": 50}


def test_a_recording_gives_the_samples_of_its_sensors_in_order():
    recording = edged.simulate("room", 1, duration_s=1, options=WITH)
    assert recording.info.external == ["height", "velocity"]
    measurements = list(recording)
    stamps = [m.t for m in measurements]
    assert stamps == sorted(stamps)
    heights = [m for m in measurements if m.kind == "height"]
    velocities = [m for m in measurements if m.kind == "velocity"]
    assert (len(heights), len(velocities)) == (25, 50)
    assert heights[0].camera is None
    assert heights[0].data.shape == (2, 1) and heights[0].data[1, 0] == 0.1
    assert velocities[0].data.shape == (2, 3) and (velocities[0].data[1] == 0.05).all()


def test_samples_are_taken_counted_and_refused_where_they_cannot_be():
    recording = room(1.5)
    odometry = recording.odometry()
    for m in recording:
        odometry.add(m)
        if m.kind == "frame":
            odometry.add_height(m.t, 1.0, 0.1)
            odometry.add_height(m.t, float("nan"))
            odometry.add_velocity(m.t, np.array([0.1, 0.0, 0.2]), 0.1)
            odometry.add_velocity(m.t, [0.1, 0.0, 0.2], [0.1, float("inf"), 0.1])
        for _ in odometry:
            pass
    odometry.finish()
    list(odometry)
    counters = odometry.counters
    assert counters["height_in_packets"] + counters["velocity_in_packets"] > 20
    assert counters["external_unfit"] > 10
    with pytest.raises(edged.InputError, match="add_velocity: values must be 3 numbers"):
        odometry.add_velocity(0, [1.0, 2.0])


def test_without_samples_nothing_changes():
    plain, same = (list(edged.simulate("room", 1, end_s=1, options=options)) for options in (dict[str, float](), WITH))
    same = [m for m in same if m.kind not in ("height", "velocity")]

    def of(kind, measurements):
        return np.concatenate([m.data for m in measurements if m.kind == kind])

    for kind in ("events", "imu"):
        assert (of(kind, plain) == of(kind, same)).all()
