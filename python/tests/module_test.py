# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""What a user of the module meets beside the odometry: messages, reprs, sensor files, checks and run folders."""
import logging
import os
import pathlib
import shutil
import subprocess
import sys

import numpy as np
import pytest
from support import program, room

import edged

SOURCE = pathlib.Path(__file__).resolve().parents[1]


def import_from(folder):
    done = subprocess.run([sys.executable, "-B", "-c", "import edged"], capture_output=True, text=True, check=False,
                          env={**os.environ, "PYTHONPATH": str(folder)})
    return done.stderr.splitlines()[-1]


def test_where_the_compiled_part_is_missing_the_message_says_what_to_run(tmp_path):
    message = import_from(SOURCE)
    assert message.startswith("ImportError: edged: the compiled part is not built")
    assert "--target edged_python" in message and "pip install" in message
    shutil.copytree(SOURCE / "edged", tmp_path / "edged")
    (tmp_path / "edged" / "_edged.cpython-399-x86_64-linux-gnu.so").touch()
    assert "which is for another Python than this 3." in import_from(tmp_path)


def test_rigs_of_the_build_are_found_without_a_variable():
    done = subprocess.run([sys.executable, "-B", "-c", "import edged; print(edged.known_rigs())"], capture_output=True, text=True,
                          check=True, env={key: value for key, value in os.environ.items() if key != "EDGED_RIGS"})
    assert "davis240c_ecd" in done.stdout


def test_a_camera_that_the_calibration_lacks_is_refused():
    odometry = edged.Odometry("davis240c_ecd", "events")
    events = edged.make_events([1], [2], [3], [True])
    with pytest.raises(edged.InputError, match="add_events: no camera 'event'; of events the calibration has: events"):
        odometry.add_events("event", events)
    with pytest.raises(edged.InputError, match="add_events: no camera 'frames'"):
        odometry.add_events("frames", events)
    with pytest.raises(edged.InputError, match="add_frame: no camera 'image'; of frames the calibration has: frames"):
        odometry.add_frame("image", 1, np.zeros((180, 240), np.uint8))
    odometry.add_frame("frames", 1, np.zeros((180, 240), np.uint8))  # the mode leaves it out
    assert odometry.counters["unused_camera"] == 1


def test_messages_name_arguments_of_python(tmp_path):
    (tmp_path / "events.txt").write_text("".join(f"{0.001 * i:.6f} {i % 200} 5 1\n" for i in range(2000)))
    with pytest.raises(edged.InputError, match=r"geometry=\(WIDTH, HEIGHT\)") as error:
        edged.open_recording(tmp_path / "events.txt", cameras="first").odometry("events")
    assert "--" not in str(error.value)


def test_what_is_printed_says_what_it_is():
    flight = room(0.2)
    assert repr(flight) == "<edged.Recording 'room' (simulator) of events, frames, imu>"
    assert repr(flight.info) == "<edged.RecordingInfo 'room' (simulator) of events, frames, imu>"
    assert repr(flight.calibration) == "<edged.Calibration 'simulator' of events, frames>"
    assert repr(flight.calibration.rig["events"]) == "<edged.Camera 'events' events 240x180>"
    assert repr(flight.info.cameras[1]) == "<edged.RecordedCamera 'frames' frames>"
    odometry = flight.odometry("events")
    assert repr(odometry) == "<edged.Odometry of events>"
    assert repr(odometry.final_trajectory()) == "<edged.FinalTrajectory 0 poses, 0 keyframes>"
    assert repr(next(flight)).startswith("<edged.Measurement ")


@pytest.fixture(name="pair", scope="module")
def a_stereo_recording(tmp_path_factory):
    folder = tmp_path_factory.mktemp("pair") / "pair"
    program("simulate", "--duration", 2, "--baseline", 0.1, "--out", folder, "--quiet")
    return folder


def test_a_stereo_recording_is_run_as_by_the_program(pair, tmp_path):
    metrics = edged.write_run(pair, tmp_path / "run", mode="frames")
    flight = edged.open_recording(pair)
    assert [camera.name for camera in flight.info.cameras] == ["events", "events2", "frames", "frames2"]
    steps = list(edged.run(flight, "frames"))
    assert set(steps[-1].cameras) == {"frames", "frames2"}
    assert sum(step.is_tracking for step in steps) == metrics["poses"] > 0
    one = edged.open_recording(pair, cameras="first").odometry("frames")
    assert set(one.rig) == {"frames"}


def test_an_imu_may_come_from_another_file(pair, tmp_path):
    with pytest.raises(TypeError, match="unexpected keyword argument 'imux'; there are rig "):
        edged.open_recording(pair, imux="imu.txt")  # type: ignore[call-arg]
    lines = (pair / "imu.txt").read_text().splitlines(keepends=True)
    (tmp_path / "half.txt").write_text("".join(lines[::2]))
    count = lambda recording: sum(m.kind == "imu" for m in recording)
    assert count(edged.open_recording(pair, imu=tmp_path / "half.txt")) == (count(edged.open_recording(pair)) + 1) // 2


def test_the_clock_of_an_imu_is_corrected(pair, tmp_path):
    lines = [line.split(" ", 1) for line in (pair / "imu.txt").read_text().splitlines(keepends=True)]
    (tmp_path / "ahead.txt").write_text("".join(f"{float(t) + 100:.9f} {rest}" for t, rest in lines))
    stamps = lambda recording: [m.t for m in recording if m.kind == "imu"]
    ahead = lambda offset: edged.open_recording(pair, imu=tmp_path / "ahead.txt", imu_time_offset=offset)
    assert stamps(ahead(-100.0)) == stamps(edged.open_recording(pair))
    assert len(list(edged.run(ahead(-100), "frames"))) > 5
    with pytest.raises(edged.InputError, match="the turn rates of camera .* and gyro do not determine it"):
        ahead("auto")
    with pytest.raises(edged.InputError, match="give auto, or seconds"):
        ahead("soon")


def test_a_run_logs_what_contradicts_its_recording(pair, tmp_path, caplog):
    rows = [line.split() for line in (pair / "imu.txt").read_text().splitlines()]
    head = "t[s],ax[m/s^2],ay[m/s^2],az[m/s^2],gx[rad/s],gy[rad/s],gz[rad/s]\n"
    (tmp_path / "weak.txt").write_text(head + "".join(",".join([*row[:1], *(str(float(x) / 2) for x in row[1:4]), *row[4:]]) + "\n" for row in rows))
    with caplog.at_level(logging.WARNING, logger="edged"):
        for _ in edged.run(edged.open_recording(pair, imu=tmp_path / "weak.txt"), "frames"):
            pass
    assert any("accelerometer with a mean of 4.8" in record.message for record in caplog.records), caplog.text


def test_a_run_folder_is_written_by_the_program(tmp_path):
    metrics = edged.write_run("sim:room:1", tmp_path / "run", {"estimator.iterations": 4}, to=2.5)
    assert metrics["status"] == "good"
    assert (tmp_path / "run" / "report.html").stat().st_size > 10_000
    assert "iterations: 4" in (tmp_path / "run" / "config_resolved.yaml").read_text()
    with pytest.raises(edged.InputError, match="no such file"):
        edged.write_run(tmp_path / "nothing")
