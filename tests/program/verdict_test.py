#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""What a run says of its own result: calibrations and recordings that contradict it. Usage: EDGED=path/to/edged verdict_test.py"""
import json
import pathlib
import re
import unittest

import faults
from program import WithFlight, edged, with_imu

MODES = ("events", "frames", "fused")


class Verdict(WithFlight):
    def run_it(self, recording, mode, *args):
        out = self.folder / "run"
        result = edged("run", recording, "--mode", mode, "--out", out, "--force", "--quiet", *args)
        self.assertTrue((out / "metrics.json").is_file(), result.stderr)
        return result, json.loads((out / "metrics.json").read_text())

    def assert_one_verdict(self, result, metrics):
        """Table, page, log and metrics.json have the same words."""
        folder = pathlib.Path(metrics["folder"])
        said = re.search(r"verdict +(.*\n(?: {20,}.*\n)*)", result.stdout).group(1)
        self.assertEqual(" ".join(said.split()), metrics["verdict"])
        data = json.loads(re.search(r'id="data">(.*?)</script>', (folder / "report.html").read_text(), re.S).group(1))
        self.assertEqual(data["runs"][0]["metrics"], metrics)
        self.assertIn(f"verdict: {metrics['verdict']}\n", (folder / "run.log").read_text())

    def assert_not_trusted(self, fault, text, remedy):
        """In every mode: said on the way or at the end, in metrics.json and by the exit code, with what to do."""
        recording = self.changed(*faults.NOT_TRUSTED[fault])
        for mode in MODES:
            with self.subTest(mode=mode):
                result, metrics = self.run_it(recording, mode)
                self.assertEqual(result.returncode, 5, result.stdout + result.stderr)
                self.assertNotIn(metrics["status"], ("good", "degraded"))
                self.assertFalse(metrics["trusted"])
                errors = [f for f in metrics["findings"] if f["severity"] == "error"]
                self.assertTrue(any(re.search(text, f["text"]) and re.search(remedy, f["remedy"]) for f in errors), errors)
                self.assertRegex(result.stdout, text)
                self.assertRegex(result.stdout, r"verdict +the result is not to be trusted: .*\n( {20,}.*\n)* +next +edged doctor ")
                self.assert_one_verdict(result, metrics)
                self.assertEqual(metrics["next"], f"edged doctor {recording}")

    def test_a_healthy_recording_raises_no_finding(self):
        for mode in MODES:
            result, metrics = self.run_it(self.flight, mode)
            self.assertEqual((result.returncode, metrics["status"], result.stderr), (0, "good", ""))
            self.assertEqual((metrics["findings"], metrics["trusted"]), ([], True))
            self.assertEqual(metrics["next"], f"open {metrics['folder']}/report.html")
            self.assertEqual(metrics["verdict"], "nothing contradicts the result")
            self.assert_one_verdict(result, metrics)

    def test_a_camera_mounted_a_quarter_turn_off(self):
        self.assert_not_trusted("quarter turn", r"contradicts the gyro|off the calibration", r"axis|edged calib")

    def test_a_lever_arm_in_millimetres(self):
        self.assert_not_trusted("millimetres", "millimetres", "divide that of T_B_C by 1000")

    def test_clocks_that_are_100_s_apart(self):
        self.assert_not_trusted("clocks 100 s apart", "clocks of the sensors do not overlap", "one clock")

    def test_a_gyro_in_degrees(self):
        self.assert_not_trusted("gyro in degrees", "gyro.* deg/s", "pi / 180")

    def test_an_accelerometer_in_g(self):
        self.assert_not_trusted("accelerometer in g", "accelerometer in g", "9.80665")

    def test_an_imu_that_itself_is_wrong_and_no_calibration_is_blamed(self):
        """A dead sensor, another clock, a gap: `doctor` and `run` say the same, and no camera is blamed for it."""
        begin = float((self.flight / "imu.txt").read_text().split()[0])
        dead = [0.0, 0.0, 0.0]
        cases = {"gyro is constant zero": with_imu(lambda t, a, g: (t, a, dead)),
                 "accelerometer does not change": with_imu(lambda t, a, g: (t, [0.0, 0.0, faults.G], g)),
                 "gyro: its y axis does not change": with_imu(lambda t, a, g: (t, a, [g[0], 0.0, g[2]])),
                 r"the IMU covers \d+\.\d s, the other sensors \d+\.\d s: its clock runs at 2\.0":
                     with_imu(lambda t, a, g: (begin + 2 * (t - begin), a, g)),
                 r"1 IMU gaps of 0\.8": lambda text: "".join(
                     line + "\n" for line in text.splitlines() if not 1.2 < float(line.split()[0]) - begin < 2.0)}
        for text, change in cases.items():
            with self.subTest(text=text):
                recording = self.changed("imu.txt", change)
                self.assertRegex(edged("doctor", recording).stdout, rf"error +{text}")
                result, metrics = self.run_it(recording, "frames")
                errors = [f["text"] for f in metrics["findings"] if f["severity"] == "error"]
                self.assertTrue(any(re.search(text, error) for error in errors), errors)
                self.assertNotIn("camera frames:", "".join(errors))
                self.assertFalse(metrics["trusted"])
                self.assertIn(result.returncode, (4, 5))

    def test_imu_samples_that_no_sensor_gives_are_gaps_and_named_with_their_time(self):
        rows = [line.split() for line in (self.flight / "imu.txt").read_text().splitlines()]
        first = round(1.2 * len(rows) / (float(rows[-1][0]) - float(rows[0][0])))  # sample after 1.2 s

        def with_gyro(count, change):
            return lambda _: "".join(" ".join(row[:4] + (change(row[4:]) if first <= i < first + count else row[4:])) + "\n"
                                     for i, row in enumerate(rows))
        at = rf"{float(rows[first][0]):.2f}\d s"
        for text, change in {rf"99 IMU samples that repeat a reading: gyro for 0\.099 s from {at}":
                                 with_gyro(100, lambda _: rows[first][4:]),
                             rf"1 IMU samples beyond what a sensor measures: the first at {at}":
                                 with_gyro(1, lambda g: ["1e300", *g[1:]]),
                             rf"1 IMU samples far from both neighbours: the first at {at}":
                                 with_gyro(1, lambda g: [g[0], "6.0", g[2]])}.items():
            with self.subTest(text=text):
                recording = self.changed("imu.txt", change)
                self.assertRegex(edged("doctor", recording).stdout, rf"warning +{text}")
                _, metrics = self.run_it(recording, "frames")
                self.assertTrue(any(re.search(text, f["text"]) for f in metrics["findings"]), metrics["findings"])
                self.assertTrue(any(kind.startswith("IMU samples") for kind in metrics["repairs"]), metrics["repairs"])

    def test_an_imu_clock_that_is_corrected(self):
        begin = float((self.flight / "imu.txt").read_text().split()[0])
        fast = self.changed("imu.txt", with_imu(lambda t, a, g: (begin + 2 * (t - begin), a, g)))
        result, metrics = self.run_it(fast, "frames", "--imu-clock-rate", "2")
        self.assertEqual((result.returncode, metrics["findings"]), (0, []), result.stdout)

    def test_imu_axes_that_are_negated(self):
        for fault in ("all axes negated", "one axis negated"):
            self.assert_not_trusted(fault, "as if its axes were mirrored|contradicts the gyro", "right-handed|axis")
        self.assert_not_trusted("two axes negated", r"contradicts the gyro|off the calibration", "axis|edged calib")

    def test_an_accelerometer_with_other_axes_than_the_gyro(self):
        self.assert_not_trusted("accelerometer's axes", "gravity does not rotate in its axes", r"\(-x, y, z\)")

    def assert_said(self, fault, severity, text, remedy):
        recording = self.changed(*faults.TOLD[fault])
        for mode in ("frames", "fused"):
            with self.subTest(mode=mode):
                _, metrics = self.run_it(recording, mode)
                said = [f for f in metrics["findings"] if f["severity"] == severity and re.search(text, f["text"])]
                self.assertTrue(said, metrics["findings"])
                self.assertRegex(said[0]["remedy"], remedy)

    def test_an_accelerometer_of_which_the_sign_alone_is_wrong(self):
        self.assert_said("accelerometer negated", "error", "accelerometer: camera .* moves opposite to it", "multiply it by -1")

    def test_a_gyro_that_reads_a_tenth_too_much(self):
        self.assert_said("gyro 1.1", "warning", r"the gyro reads (9|10|11)\.\d % .* too much", r"divide the gyro by 1\.(09|1)")

    def test_a_transform_near_identity_that_points_the_other_way(self):
        self.assert_said("inverse near identity", "warning", "the inverse fits", "T_C_B")

    def test_a_rotation_that_the_run_has_corrected_is_no_reason_for_distrust(self):
        result, metrics = self.run_it(self.changed(*faults.TOLD["turned by 5 deg"]), "fused")
        self.assertEqual((result.returncode, metrics["status"]), (0, "good"), result.stdout)
        self.assertTrue(any("off the calibration" in f["text"] for f in metrics["findings"]), metrics["findings"])
        self.assertNotIn("more than a run can correct", result.stdout)
        self.assert_one_verdict(result, metrics)

    def test_cameras_that_start_after_the_chosen_piece_have_one_remedy(self):
        def after_5_s(text):
            return "".join(f"{5 + float(t):.9f} {rest}" for t, rest in (line.split(" ", 1) for line in text.splitlines(True)))
        recording = self.changed("events.txt", after_5_s)
        (recording / "images.txt").write_text(after_5_s((recording / "images.txt").read_text()))
        result, metrics = self.run_it(recording, "fused", "--duration", 2)
        self.assertEqual((result.returncode, [f["remedy"] for f in metrics["findings"]]), (4, ["use --start 4.9"]), result.stdout)
        self.assertEqual(metrics["verdict"], "never good: cameras start at 5.0 s")
        self.assertEqual(metrics["next"], f"edged run {recording} --from 4.9 --duration 2")
        checked = edged("doctor", recording, "--duration", 2, "--quiet")
        self.assertIn("cameras start at 5.0 s\n           -> use --start 4.9\n1 error, ", checked.stdout)

    def test_frames_that_never_come_are_missed(self):
        result, metrics = self.run_it(self.changed("images.txt", lambda text: text.replace("frame_", "gone_")), "fused")
        self.assertEqual((result.returncode, metrics["status"]), (5, "not to be trusted"), result.stdout)
        self.assertIn("no frames: the mode needs them, and the recording has none", result.stdout)

    def test_a_run_without_a_start_says_what_it_waited_for_and_what_to_do(self):
        flight = self.folder / "short"
        edged("simulate", "--duration", 0.2, "--out", flight, "--quiet")
        result, metrics = self.run_it(flight, "fused", "--calib", flight / "calibration.yaml")
        self.assertEqual((result.returncode, metrics["status"]), (4, "never good"))
        self.assertIn("rest", metrics["waiting_for"])
        self.assertEqual(metrics["next"], f"edged doctor {flight} --calib {flight / 'calibration.yaml'}")
        self.assertIn(metrics["next"], result.stdout)
        self.assertIn("never good: it waited for rest", result.stdout)
        self.assertRegex(" ".join(result.stdout.split()), r"the attitude is in states.csv, tilt to \d+\.\d deg")

    def test_scale_at_the_start_and_ten_seconds_later(self):
        _, metrics = self.run_it(self.flight, "fused")
        self.assertLess(abs(metrics["scale_error_at_first_good"]), 0.1)
        self.assertIsNone(metrics["scale_error_10s_later"])  # it is over before

    def test_the_calibration_found_comes_with_its_sigma(self):
        _, metrics = self.run_it(self.flight, "frames")
        found = metrics["calibration"][0]
        self.assertGreater(found["rotation_sigma_deg"], 0.0)
        self.assertLess(found["rotation_sigma_deg"], 2.5)  # the prior's, inflated
        self.assertLess(found["rotation_off_deg"], 3 * found["rotation_sigma_deg"])
        self.assertLess(abs(found["time_offset_ms"] - found["given_time_offset_ms"]), 3 * found["time_offset_sigma_ms"])
        self.assertFalse([f for f in metrics["findings"] if "differs from the calibration" in f["text"]])

    def test_weak_rotation_makes_no_shutter_a_rolling_one(self):
        _, metrics = self.run_it("sim:room:7:duration_s=120", "frames", "--duration", 8)
        self.assertEqual(metrics["findings"], [])

    def test_a_focal_length_3_percent_off_is_told_with_what_to_do(self):
        def longer(match):
            fx, fy, rest = match.group(1, 2, 3)
            return f"intrinsics: [{1.03 * float(fx)}, {1.03 * float(fy)},{rest}]"
        recording = self.changed("calibration.yaml", lambda text: re.sub(r"intrinsics: \[([\d.]+), ([\d.]+),(.*)\]", longer, text))
        _, metrics = self.run_it(recording, "frames")
        said = [f for f in metrics["findings"] if "differs from the calibration by" in f["text"]]
        self.assertTrue(said, metrics["findings"])
        self.assertRegex(said[0]["text"], r"camera frames: .*\bfx -\d\.\d+ \+- 0\.\d+ %")
        self.assertIn("calibration_found.yaml", said[0]["remedy"])

    def test_cameras_of_other_names_are_taken_where_there_is_one_of_a_kind(self):
        def renamed(text):
            return text.replace('name: "events"', "name: cam1").replace('name: "frames"', "name: cam0")
        chain = self.folder / "chain.yaml"
        chain.write_text(renamed((self.flight / "calibration.yaml").read_text()))
        bag = self.folder / "flight.bag"
        self.assertEqual(edged("convert", self.flight, bag, "--quiet").returncode, 0)
        _, right = self.run_it(self.flight, "fused")
        result, metrics = self.run_it(bag, "fused", "--calib", chain)
        self.assertEqual((result.returncode, metrics["status"]), (0, "good"), result.stdout)
        said = result.stderr.strip().splitlines()
        self.assertEqual(len(said), 2, result.stderr)
        self.assertIn("camera 'cam1' of the calibration is taken for the recording's 'events'", said[0])
        self.assertIn("camera 'cam0' of the calibration is taken for the recording's 'frames'", said[1])
        for key in ("poses", "keyframes", "ate_rmse_m"):
            self.assertAlmostEqual(metrics[key], right[key], 9, key)

    def test_a_calibration_in_the_formats_of_the_makers_gives_the_same_run(self):
        camera = json.loads(edged("calib", self.flight, "--json").stdout)["cameras"][0]
        (fx, fy, cx, cy), (width, height) = camera["intrinsics_px"], camera["resolution_px"]
        K, D = [fx, 0, cx, 0, fy, cy, 0, 0, 1], camera["coefficients"]
        pose, clock = sum(camera["T_C_B"], []), camera["time_offset_s"]
        dv = {"version": "2.0",
              "cameras": {"C0": {"name": "DAVIS240C_1", "resolution": [width, height], "focalLength": [fx, fy],
                                 "principalPoint": [cx, cy], "distortionModel": "radialTangential",
                                 "distortionCoefficients": D,
                                 "transformationToC0": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]}},
              "imus": {"S0": {"timeOffsetMicros": 1e6 * clock, "transformationToC0": pose}}}

        def matrix(name, values, rows):
            numbers = " ".join(map(repr, values))
            return (f'<{name} type_id="opencv-matrix"><rows>{rows}</rows><cols>{len(values) // rows}</cols><dt>d</dt>'
                    f"<data>{numbers}</data></{name}>")
        xml = ('<?xml version="1.0"?><opencv_storage><DAVIS240C_1>' + matrix("camera_matrix", K, 3) +
               matrix("distortion_coefficients", D, 1) + f"<image_width>{width}</image_width><image_height>{height}"
               "</image_height></DAVIS240C_1><type>camera</type>" + matrix("transformation_cam_imu", pose, 4) +
               f"<time_offset_cam_imu>{clock!r}</time_offset_cam_imu></opencv_storage>")
        own = self.folder / "own.yaml"  # without the noise of the IMU, which the makers' files do not tell
        own.write_text(re.sub(r"imu:\n(  .*\n)*", "", (self.flight / "calibration.yaml").read_text()))
        lens = self.folder / "intrinsics.json"
        lens.write_text(json.dumps({"type": "pinhole", "width": width, "height": height, "K": K, "D": D}))
        head = self.folder / "head.yaml"
        self.assertIn("fill in what reads FILL_IN", edged("calib", lens, "--out", head).stdout)
        self.assert_refused(edged("run", self.flight, "--calib", head, "--mode", "events"), "head.yaml", "T_B_C")
        text = head.read_text().replace("time_offset: 0.0", f"time_offset: {clock!r}")
        for row in camera["T_B_C"][:3]:
            text = text.replace("[FILL_IN, FILL_IN, FILL_IN, FILL_IN]", str(row), 1)
        head.write_text(text)
        for name, content, mode in (("calibration.json", json.dumps(dv), "frames"), ("calibration.xml", xml, "frames"),
                                    ("head.yaml", text, "events")):
            with self.subTest(name=name):
                (self.folder / name).write_text(content)
                _, right = self.run_it(self.flight, mode, "--calib", own)
                result, metrics = self.run_it(self.flight, mode, "--calib", self.folder / name)
                self.assertEqual((result.returncode, metrics["status"]), (0, "good"), result.stdout + result.stderr)
                self.assertAlmostEqual(metrics["ate_rmse_m"], right["ate_rmse_m"], delta=0.1 * right["ate_rmse_m"])  # the last digits differ

    def test_cameras_that_could_be_either_are_refused_with_both_lists(self):
        text = (self.flight / "calibration.yaml").read_text()
        chain = self.folder / "chain.yaml"
        chain.write_text(text.replace('name: "events"', "name: cam0").replace('name: "frames"', "name: cam1")
                         .replace("modality: events", "modality: frames"))
        result = edged("run", self.flight, "--calib", chain, "--mode", "frames", "--out", self.folder / "run", "--quiet")
        self.assertEqual(result.returncode, 3, result.stdout)
        for words in ("events (events), frames (frames)", "cam0 (frames), cam1 (frames)", "several are of frames",
                      "edged calib"):
            self.assertIn(words, result.stderr)


if __name__ == "__main__":
    unittest.main(verbosity=2)
