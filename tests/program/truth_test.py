#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""Ground truth as it comes: sparse, late, longer than the run, unreadable. Usage: EDGED=path/to/edged truth_test.py"""
import json
import re
import shutil
import unittest

import yaml

from program import WithFlight, edged


def lines_of(text):
    return [line for line in text.splitlines(True) if not line.startswith("#")]


def shifted(seconds):
    """Every stamp of a file that begins its lines with one."""
    return lambda text: "".join(f"{float(t) + seconds:.9f} {rest}" for t, rest in
                                (line.split(" ", 1) for line in lines_of(text)))


def rounded(value):
    """Numbers to nine digits: sums are rounded differently where poses were written in between."""
    if isinstance(value, dict):
        return {key: rounded(item) for key, item in value.items()}
    if isinstance(value, list):
        return [rounded(item) for item in value]
    return float(f"{value:.9g}") if isinstance(value, float) else value


class Truth(WithFlight):
    SIMULATION = ("--duration", 8, "--seed", 3)

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.out = cls.flight.parent / "run"
        made = edged("run", cls.flight, "--mode", "frames", "--start", 1, "--duration", 6.5, "--out", cls.out, "--json", "--quiet")
        assert made.returncode == 0, made.stderr
        cls.metrics = json.loads(made.stdout)
        cls.truth = cls.flight / "groundtruth.txt"

    def evaluated(self, truth):
        file = self.folder / "truth.txt"
        file.write_text(truth)
        result = edged("eval", file, self.out / "trajectory.tum", "--json")
        self.assertEqual(result.returncode, 0, result.stderr)
        return json.loads(result.stdout)

    def data_of(self, page):
        return json.loads(re.search(r'id="data">(.*?)</script>', page.read_text(), re.S).group(1))["runs"][0]

    def test_page_metrics_and_eval_have_the_same_numbers_where_the_truth_is_longer_than_the_run(self):
        shown = self.data_of(self.out / "report.html")
        self.assertEqual(shown["metrics"], self.metrics)
        self.assertEqual(rounded(shown["evaluation"]), rounded(self.metrics["evaluation"]))
        evaluated = json.loads(edged("eval", self.truth, self.out / "trajectory.tum", "--protocol", "P3", "--json").stdout)
        for key in ("ate_rmse_m", "scale", "path_length_m", "mpe_percent", "duration_s"):
            self.assertAlmostEqual(evaluated[key], self.metrics["evaluation"][key], 7, key)
        for ours, theirs in zip(evaluated["local_error"], self.metrics["evaluation"]["local_error"]):
            self.assertEqual(ours["windows"], theirs["windows"])
            if ours["windows"]:
                self.assertAlmostEqual(ours["rmse_m"], theirs["rmse_m"], 7)

    def test_the_error_is_right_at_any_rate_of_the_truth(self):
        lines = lines_of(self.truth.read_text())  # 200 Hz
        dense = self.evaluated("".join(lines))["ate_rmse_m"]
        for hz in (1, 2, 5, 20):
            sparse = self.evaluated("".join(lines[::200 // hz]))
            self.assertEqual(sparse["in_ground_truth_gaps"], 0)
            self.assertAlmostEqual(sparse["ate_rmse_m"], dense, delta=0.4 * dense, msg=f"{hz} Hz")

    def test_a_truth_that_is_late_is_said_to_be(self):
        recording = self.changed("groundtruth.txt", shifted(0.05))
        out = self.folder / "late"
        result = edged("run", recording, "--mode", "frames", "--out", out, "--quiet")
        metrics = json.loads((out / "metrics.json").read_text())
        self.assertRegex(metrics["findings"][0]["text"], r"ground truth: its stamps are (49|50|51)\.\d ms late: with that offset the ATE")
        offset = metrics["ground_truth_time_offset"]
        self.assertAlmostEqual(offset["offset_s"], 0.05, delta=0.001)
        self.assertLess(offset["ate_rmse_m"], 0.3 * metrics["ate_rmse_m"])
        self.assertEqual(len(metrics["findings"]), 1, "the covariance is not blamed")
        self.assertIn("ms late", result.stdout)
        # The final trajectory has the calibration that the run found, as has its own comparison of stamps.
        evaluated = edged("eval", recording / "groundtruth.txt", out / "trajectory_final.tum").stdout
        self.assertRegex(evaluated, r"time offset +\+(49|50)\.\d ms fits best")
        self.assertRegex(evaluated, r"next +add -0\.0(49|50)\d s to the stamps")

    def test_a_run_whose_truth_cannot_be_read_warns_first_and_writes_everything(self):
        recording = self.changed("groundtruth.txt", lambda text: "what is this\n" * 500)
        out = self.folder / "run"
        result = edged("run", recording, "--mode", "frames", "--duration", 3, "--out", out, "--quiet")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("ground truth cannot be used", result.stderr)
        log = (out / "run.log").read_text()
        self.assertLess(log.index("ground truth cannot be used"), log.index("started"))
        for name in ("metrics.json", "report.html", "map.ply", "trajectory.tum"):
            self.assertGreater((out / name).stat().st_size, 0, name)
        metrics = json.loads((out / "metrics.json").read_text())
        self.assertIsNone(metrics["ate_rmse_m"])
        self.assertTrue(metrics["findings"][0]["text"].startswith("ground truth: cannot be used: "))

    def test_a_truth_of_a_camera_that_the_mode_does_not_use_is_compared_with(self):
        rig = yaml.safe_load((self.flight / "calibration.yaml").read_text())
        calib, out = self.folder / "rig.yaml", self.folder / "run"
        for camera in rig["cameras"]:
            camera["name"] = f"my_{camera['name']}"
        for cameras, known in ((rig["cameras"], True), ([c for c in rig["cameras"] if c["modality"] == "frames"], False)):
            calib.write_text(yaml.safe_dump({**rig, "cameras": cameras}))
            result = edged("run", self.flight, "--calib", calib, "--mode", "frames", "--to", 3, "--json", "--force", "--out", out)
            self.assertEqual(result.returncode, 0, result.stderr)
            metrics = json.loads(result.stdout)
            self.assertEqual(metrics["ate_rmse_m"] is not None, known)
            self.assertEqual([f["text"] for f in metrics["findings"] if "ground truth" in f["text"]], [] if known else
                             [f"ground truth: cannot be used: {self.flight.name}: is of camera 'events', which calibration {rig['name']} lacks"])

    def test_a_truth_from_another_file_is_compared_with(self):
        truth = self.folder / "mocap.tum"
        shutil.copy(self.flight / "groundtruth.txt", truth)
        blind = self.folder / "blind"
        shutil.copytree(self.flight, blind, ignore=shutil.ignore_patterns("groundtruth.txt"))
        own = json.loads(edged("run", self.flight, "--to", 3, "--json", "--quiet", "--out", self.folder / "own").stdout)
        # Without a truth of its own a folder of this format has the poses of the body.
        given = edged("run", blind, "--to", 3, "--truth", truth, "--json", "--quiet", "--out", self.folder / "given")
        given = json.loads(given.stdout)
        self.assertEqual(own["poses"], given["poses"])
        self.assertIsNotNone(given["ate_rmse_m"])
        self.assertLess(abs(given["ate_rmse_m"] - own["ate_rmse_m"]), 0.02)
        replaced = json.loads(edged("run", self.flight, "--to", 3, "--truth", truth, "--json", "--quiet", "--out", self.folder / "replaced").stdout)
        self.assertEqual(own["ate_rmse_m"], replaced["ate_rmse_m"])
        self.assert_refused(edged("run", blind, "--truth", self.folder / "nothing"), "nothing")

    def test_an_estimate_outside_its_covariance_is_a_finding_everywhere(self):
        def curved(text):  # an estimate that is half a metre off, as the truth is another
            return "".join(f"{t} {float(x) + 0.02 * (float(t) - 1) ** 2:.9f} {rest}" for t, x, rest in
                           (line.split(" ", 2) for line in lines_of(text)))
        out = self.folder / "off"
        result = edged("run", self.changed("groundtruth.txt", curved), "--mode", "frames", "--out", out, "--quiet")
        metrics = json.loads((out / "metrics.json").read_text())
        self.assertEqual((result.returncode, metrics["status"]), (5, "not to be trusted"), result.stdout)
        self.assertRegex(metrics["verdict"], r"the result is not to be trusted: ground truth: the estimate is outside 3 sigma")
        self.assertEqual(self.data_of(out / "report.html")["metrics"]["verdict"], metrics["verdict"])
        self.assertIn("outside 3 sigma", result.stdout)
        self.assertIn("of another sensor: run with `--frame SENSOR`", re.sub(r"\s+", " ", result.stdout))


if __name__ == "__main__":
    unittest.main(verbosity=2)
