# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""Maps as bytes, and the final trajectory."""
import pytest

import edged


def follow(recording, the_map=None):
    odometry = edged.Odometry(recording.calibration, "frames", in_order=True)
    if the_map is not None:
        odometry.load_map(the_map)
        assert odometry.awaiting_relocalization and odometry.save_map() is None
    steps: list[edged.Step] = []
    for measurement in recording:
        odometry.add(measurement)
        steps += odometry
    odometry.finish()
    return odometry, steps + list(odometry)


def test_a_map_of_one_odometry_is_gone_on_in_by_another():
    first, steps = follow(edged.simulate("room", 5, duration_s=9))
    known = first.final_trajectory()
    assert len(known.poses) == sum(step.is_tracking for step in steps)
    assert known.points.shape[1] == 3 and len(known.points) > 15 * len(known.keyframes) > 0
    second, steps = follow(edged.simulate("room", 5, duration_s=9, begin_s=4), first.save_map())
    assert not second.awaiting_relocalization and any(step.relocalized for step in steps)
    assert (second.final_trajectory().keyframes["t"] < 0).any()
    with pytest.raises(edged.InputError, match="before the first pose"):
        second.load_map(first.save_map())


def test_a_map_that_is_only_localized_in_never_changes():
    first, _ = follow(edged.simulate("room", 5, duration_s=9))
    the_map = first.save_map()
    recording = edged.simulate("room", 5, duration_s=9, begin_s=4)
    assert recording.calibration
    odometry = edged.Odometry(recording.calibration, "frames", {"map.localize_only": True}, in_order=True)
    odometry.load_map(the_map)
    steps: list[edged.Step] = []
    for measurement in recording:
        odometry.add(measurement)
        steps += odometry
    localized = next(i for i, step in enumerate(steps) if step.relocalized)
    assert not any(step.is_tracking for step in steps[:localized]) and all(step.is_tracking for step in steps[localized:])
    assert odometry.save_map() == the_map


def test_what_is_no_map_is_refused():
    odometry = edged.Odometry("davis240c_ecd")
    with pytest.raises(edged.InputError, match="no map"):
        odometry.load_map(b"garbage")
    with pytest.raises(TypeError):
        odometry.load_map(3)  # type: ignore[arg-type]
