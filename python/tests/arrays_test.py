# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""Input arrays are checked: one clear line if they do not fit."""
import numpy as np
import pytest
from support import room

import edged

EVENTS = edged.make_events([1, 2, 3], [10, 11, 12], [20, 21, 22], [True, False, True])


@pytest.fixture(name="odometry")
def an_odometry():
    return edged.Odometry(room().calibration)


def refusal(kind, call, *arguments):
    with pytest.raises(kind) as caught:
        call(*arguments)
    text = str(caught.value)
    assert len(text.splitlines()) == 1, text
    return text


def test_events_of_another_layout_are_refused_with_the_remedy(odometry):
    packed = EVENTS.astype([("t", "<i8"), ("x", "<u2"), ("y", "<u2"), ("p", "?")])
    assert packed.itemsize == 13
    assert "astype(edged.EVENT)" in refusal(TypeError, odometry.add_events, "events", packed)
    odometry.add_events("events", packed.astype(edged.EVENT))
    refusal(TypeError, odometry.add_events, "events", np.zeros((3, 4)))


def test_arrays_with_gaps_or_of_another_shape_are_refused(odometry):
    assert "contiguous" in refusal(ValueError, odometry.add_events, "events", EVENTS[::2])
    assert "contiguous" in refusal(ValueError, odometry.add_events, "events", EVENTS[::-1])
    assert "2 dimensions" in refusal(ValueError, odometry.add_events, "events", EVENTS.reshape(3, 1))
    odometry.add_events("events", EVENTS[1:])
    odometry.add_events("events", EVENTS[:0])


def test_images_of_another_kind_are_refused(odometry):
    image = np.zeros((180, 240), np.uint8)
    assert "uint8" in refusal(TypeError, odometry.add_frame, "frames", 0, image.astype(np.float32))
    assert "grey" in refusal(ValueError, odometry.add_frame, "frames", 0, np.zeros((180, 240, 3), np.uint8))
    assert "contiguous" in refusal(ValueError, odometry.add_frame, "frames", 0, image[:, ::2])
    assert "240 x 90 pixels, width x height; camera frames has 240 x 180" in refusal(ValueError, odometry.add_frame, "frames", 0, image[:90])
    odometry.add_frame("frames", np.int64(5), image)


def test_imu_samples_of_another_layout_are_refused(odometry):
    assert "make_imu" in refusal(TypeError, odometry.add_imu, np.zeros((5, 7)))
    samples = edged.make_imu([0, 1000], [[0, 0, 0.1], [0, 0, 0.2]], [[0, 0, 9.8], [0, 0, 9.9]])
    assert samples["gyro"][1, 2] == 0.2
    assert "contiguous" in refusal(ValueError, odometry.add_imu, np.repeat(samples, 2)[::2])
    odometry.add_imu(samples)
    odometry.add_imu(edged.make_imu(2000, [0, 0, 0], [0, 0, 9.81]))


def test_stamps_that_are_no_whole_numbers_are_refused(odometry):
    assert "nanoseconds" in refusal(TypeError, edged.make_events, [0.5], [1], [1], [1])
    with pytest.raises(TypeError):
        odometry.add_frame("frames", 0.5, np.zeros((180, 240), np.uint8))


def test_an_evaluation_of_no_array_names_what_it_takes():
    poses = np.empty(0, edged.POSE)
    assert "estimate: is a list; give an array of edged.POSE" in refusal(TypeError, edged.evaluate, [], poses)
    assert "truth: is a NoneType" in refusal(TypeError, edged.evaluate, poses, None)


def test_columns_that_do_not_fit_are_refused():
    assert "x: holds -1" in refusal(ValueError, edged.make_events, [1, 2], [-1, 5], [0, 0], [1, 1])
    assert "y: holds 65536" in refusal(ValueError, edged.make_events, [1], [1], [65536], [1])
    assert "x: dtype is float64; give whole pixels" in refusal(TypeError, edged.make_events, [1], [1.7], [0], [1])
    assert "y: its shape is (); give (2,), as t has 2 stamps" in refusal(ValueError, edged.make_events, [1, 2], [1, 2], 7, [1, 1])
    assert "p: its shape is (1,)" in refusal(ValueError, edged.make_events, [1, 2], [1, 2], [1, 2], [1])
    assert "gyro: its shape is (3,); give (2, 3)" in refusal(ValueError, edged.make_imu, [1, 2], [0, 0, 0], np.zeros((2, 3)))
    assert len(edged.make_events(np.zeros(0, np.int64), np.zeros(0, int), np.zeros(0, int), [])) == 0
    assert edged.make_events(5, 3, 2, 1).shape == (1,)


def test_arrays_that_have_been_joined_or_picked_from_fit_as_they_are(odometry):
    joined = np.concatenate([EVENTS, EVENTS[:2]])
    assert joined.dtype == edged.EVENT
    odometry.add_events("events", joined[joined["p"]])
    samples = edged.make_imu([0, 1000], np.zeros((2, 3)), np.ones((2, 3)))
    odometry.add_imu(np.concatenate([samples, samples]))


def test_any_byte_is_a_polarity():
    numbers = np.zeros(2, np.dtype({"names": ["t", "x", "y", "p"], "formats": ["<i8", "<u2", "<u2", "u1"],
                                    "offsets": [0, 8, 10, 12], "itemsize": 16}))
    numbers["p"] = 0, 200
    odometry = edged.Odometry(room().calibration)
    odometry.add_events("events", numbers)
    assert list(edged.make_events([0, 0], [1, 1], [1, 1], [-1, 1])["p"]) == [False, True]


def test_what_is_no_rotation_is_refused():
    poses = edged.make_poses([0, 1], np.zeros((2, 3)), np.zeros((2, 4)))
    assert "quaternion 0" in refusal(ValueError, edged.evaluate, poses, poses)


def test_what_a_user_can_mend_is_an_input_error(tmp_path):
    assert issubclass(edged.InputError, ValueError)
    calibration = room().calibration
    assert "davis240c_ecd" in refusal(edged.InputError, edged.Odometry, "no_such_rig")
    assert "fused" in refusal(edged.InputError, edged.Odometry, calibration, "sonar")
    assert "estimator.iterations" in refusal(edged.InputError, edged.Odometry, calibration, "fused", {"estimator.iteration": 2})
    refusal(edged.InputError, edged.Odometry, calibration, "fused", {"estimator.iterations": -1})
    refusal(edged.InputError, edged.Odometry, calibration, "fused", {"estimator.iterations": "many"})
    assert "thermometer" in refusal(edged.InputError, edged.Odometry, calibration, "fused", {}, False, {"thermometer": 1.0})
    assert "room" in refusal(edged.InputError, edged.simulate, "no_such_preset")
    refusal(edged.InputError, edged.open_recording, tmp_path)
    refusal(edged.InputError, edged.load_calibration, tmp_path / "none.yaml")


def test_rigs_are_found_by_name_and_show_their_cameras():
    assert "davis240c_ecd" in edged.known_rigs()
    calibration = edged.load_rig("davis240c_ecd")
    camera = calibration.rig["events"]
    assert (camera.name, camera.modality, camera.size) == ("events", "events", (240, 180))
    assert camera.T_B_C.shape == (4, 4)
    assert camera.pinhole[0] > 100
    assert "events" in str(calibration)


def test_a_calibration_survives_its_own_file(tmp_path):
    (tmp_path / "rig.yaml").write_text(room().calibration.to_yaml())
    again = edged.load_calibration(tmp_path / "rig.yaml")
    assert np.allclose(again.rig["frames"].T_B_C, room().calibration.rig["frames"].T_B_C, atol=1e-12)
    edged.Odometry(tmp_path / "rig.yaml")
