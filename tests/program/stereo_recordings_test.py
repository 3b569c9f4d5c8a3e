#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""Two cameras of each kind: simulate, convert, info, doctor, run and its outputs. Usage: EDGED=path/to/edged stereo_recordings_test.py"""
import json
import math
import pathlib
import re
import unittest

from program import WithFlight, edged

CAMERAS = ("events", "events2", "frames", "frames2")
ALL = "cameras=" + ",".join(CAMERAS)


class StereoRecordings(WithFlight):
    SIMULATION = ("--duration", 2, "--seed", 2, "--baseline", 0.1)

    def converted(self, name):
        target = self.folder / name
        result = edged("convert", self.flight, target, "--quiet")
        self.assertEqual(result.returncode, 0, result.stderr)
        return target

    def run_bits(self, recording, *options):
        """The rows of the trajectory and of the states of a run."""
        out = self.folder / ("run_" + pathlib.Path(recording).name + "".join(options).replace("=", "_"))
        edged("run", recording, "--calib", self.flight, *options, "--out", out, "--quiet")
        poses = [line for line in (out / "trajectory.tum").read_text().splitlines() if not line.startswith("#")]
        self.assertGreater(len(poses), 20, recording)
        return poses, (out / "states.csv").read_text()

    def test_every_container_gives_the_poses_of_the_folder_bit_by_bit(self):
        folder = self.run_bits(self.flight)
        for name in ("a.bag", "a.mcap", "a.h5", "copy"):
            self.assertEqual(self.run_bits(self.converted(name)), folder, name)

    def test_cameras_whose_views_overlap_are_all_used(self):
        every = self.run_bits(self.flight)
        self.assertEqual(self.run_bits(self.flight, "--set", ALL), every)
        self.assertNotEqual(self.run_bits(self.flight, "--set", "cameras=events,frames"), every)

    def calibration_with(self, cameras, turned):
        """The calibration of the flight with other rows of R_B_C of these cameras."""
        lines = (self.flight / "calibration.yaml").read_text().splitlines()
        for name in cameras:
            begin = lines.index(f'  - name: "{name}"')
            rows = next(i for i in range(begin, len(lines)) if "T_B_C" in lines[i]) + 1
            for i in range(rows, rows + 3):
                *row, t = (float(cell) for cell in lines[i][lines[i].index("[") + 1:lines[i].index("]")].split(","))
                lines[i] = f"      - [{', '.join(f'{cell:.16g}' for cell in (*turned(*row), t))}]"
            del lines[rows + 4]  # q_B_C
        made = self.folder / "turned.yaml"
        made.write_text("\n".join(lines) + "\n")
        return made

    def test_a_run_says_once_which_topics_it_takes_for_which_cameras(self):
        bag = self.converted("a.bag")
        rear = self.calibration_with(("events2", "frames2"), lambda x, y, z: (-x, y, -z))
        for calib, used in ((self.flight, "frames,frames2"), (rear, "frames")):
            out = self.folder / "run"
            result = edged("run", bag, "--calib", calib, "--mode", "frames", "--out", out, "--force", "--quiet")
            self.assertEqual(result.stderr.count("topics of frames are the cameras frames, frames2 in the order"), 1, result.stderr)
            calibrated = json.loads((out / "metrics.json").read_text())["calibration"]
            self.assertEqual(",".join(camera["camera"] for camera in calibrated), used)

    def test_a_bent_rig_is_told_and_corrected(self):
        c, s = math.cos(math.radians(1.0)), math.sin(math.radians(1.0))
        bent = self.calibration_with(("frames2",), lambda x, y, z: (x * c + y * s, y * c - x * s, z))  # about the camera's z axis
        for calib, told in ((bent, True), (self.flight, False)):
            result = edged("run", self.flight, "--calib", calib, "--mode", "frames", "--out", self.folder / "bent", "--force",
                           "--quiet")
            self.assertEqual(result.returncode, 0, result.stdout)
            self.assertEqual(bool(re.search(r"cameras frames and frames2: their pose to each other is (0\.9|1\.0)\d deg",
                                            result.stdout)), told, result.stdout)

    def test_info_lists_all_cameras_and_doctor_checks_them(self):
        for name in (self.flight, self.converted("a.bag"), self.converted("a.aedat4")):
            found = json.loads(edged("info", name, "--json", "--quiet").stdout)
            self.assertEqual(tuple(found["cameras"]), CAMERAS, name)
            self.assertEqual(found["cameras"]["events2"]["kind"], "events")
            self.assertGreater(found["cameras"]["events2"]["count"], 1000)
            self.assertEqual(found["cameras"]["frames2"]["count"], found["frames"]["count"])
            self.assertIn("frames2 (frames)", edged("info", name, "--quiet").stdout)
            doctor = edged("doctor", name, "--calib", self.flight, "--quiet").stdout
            for camera in CAMERAS:
                self.assertIn(f"camera {camera}", doctor, name)
        one = json.loads(edged("info", self.flight, "--cameras", "events2", "--json", "--quiet").stdout)
        self.assertNotIn("cameras", one)
        self.assertEqual(one["events"]["count"], found["cameras"]["events2"]["count"])

    def test_kalibr_topics_assign_the_topics_of_a_bag(self):
        bag = self.converted("a.bag")
        camchain = "".join(
            f"cam{i}:\n  camera_model: pinhole\n  intrinsics: [200, 200, 120, 90]\n  distortion_model: none\n"
            f"  distortion_coeffs: []\n  resolution: [240, 180]\n  rostopic: {topic}\n"
            f"  T_cam_imu: [[1, 0, 0, {-0.1 * i}], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]\n"
            for i, topic in enumerate(("/dvs2/events", "/dvs/events", "/camera/image_raw", "/camera2/image_raw")))
        calib = self.folder / "camchain.yaml"
        calib.write_text(camchain)
        found = json.loads(edged("info", bag, "--calib", calib, "--json", "--quiet").stdout)
        self.assertEqual({name: camera["stream"] for name, camera in found["cameras"].items()},
                         {"cam0": "/dvs2/events", "cam1": "/dvs/events", "cam2": "/camera/image_raw",
                          "cam3": "/camera2/image_raw"})
        run = edged("run", bag, "--calib", calib, "--to", 0.2, "--out", self.folder / "chain", "--quiet")
        self.assertIn("no IMU noise; defaults are used: `edged calib FILE --imu imu.yaml --out head.yaml` adds it", run.stderr)
        calib.write_text(camchain.replace("/dvs2/events", "/dvs/events"))
        self.assert_refused(edged("info", bag, "--calib", calib, "--quiet"), "/dvs/events", "two cameras, cam0 and cam1")
        self.assert_refused(edged("info", bag, "--quiet", "--topic", "events=/dvs/events", "--topic", "events=/dvs2/events"),
                            "events is /dvs/events already")
        self.assert_refused(edged("info", bag, "--quiet", "--rig", "davis240c_ecd"), "several topics for one role",
                            "/dvs/events, /dvs2/events")

    def test_a_format_of_one_camera_takes_the_one_that_is_named(self):
        for options, name in ((), "events.txt"), (("--cameras", "events2"), "events2.txt"):
            target = self.folder / (name + ".csv")
            result = edged("convert", self.flight, target, "--quiet", *options)
            self.assertEqual(result.returncode, 0, result.stderr)
            rows = [line for line in target.read_text().splitlines() if line[0].isdigit()]
            self.assertEqual(len(rows), len((self.flight / name).read_text().splitlines()))
        self.assert_refused(edged("convert", self.flight, self.folder / "two.raw", "--cameras", "events,events2", "--quiet"),
                            "one event camera, not both events and events2")

    def test_a_run_shows_the_images_of_all_cameras(self):
        out = self.folder / "run"
        edged("run", self.flight, "--set", ALL, "--out", out, "--mcap", "--quiet")
        pictures = json.loads((out / "album.json").read_text())["pictures"]
        self.assertTrue(any("events2" in picture.get("others", {}) for picture in pictures))
        self.assertTrue(any("frames2" in picture.get("others", {}) for picture in pictures))
        self.assertIn('"camera frames2"', (out / "report.html").read_text())
        topics = (out / "results.mcap").read_bytes()
        for topic in (b"/events/image", b"/events2/image", b"/frames2/image", b"/frames2/calibration"):
            self.assertIn(topic, topics)

    def test_show_shows_the_camera_that_is_named(self):
        out = self.folder / "pictures"
        result = edged("show", self.flight, "--cameras", "events2,frames2", "--out", out, "--quiet", "--json")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertGreater(json.loads(result.stdout)["pictures"], 10)
        self.assert_refused(edged("show", self.flight, "--cameras", "events,events2", "--out", self.folder / "two", "--quiet"),
                            "--cameras events,events2", "one camera of a kind")


if __name__ == "__main__":
    unittest.main(verbosity=2)
