#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""The program as a user meets it: exit codes, error lines, run folders. Usage: EDGED=path/to/edged cli_test.py"""
import json
import os
import pathlib
import random
import re
import shutil
import signal
import subprocess
import tempfile
import time
import unittest

EDGED = os.environ["EDGED"]


def edged(*args, cwd=None):
    return subprocess.run([EDGED, *map(str, args)], capture_output=True, text=True, cwd=cwd, check=False, timeout=300)


class WithFolder(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="edged_cli_"))
        self.addCleanup(shutil.rmtree, self.folder)

    def assert_refused(self, result, *words, code=3):
        """One line on stderr that holds the words, and the exit code."""
        self.assertEqual(result.returncode, code, result.stderr)
        self.assertEqual(len(result.stderr.strip().splitlines()), 1, result.stderr)
        for word in words:
            self.assertIn(word, result.stderr)


class CommandLine(WithFolder):
    def test_help_teaches_with_examples_and_exit_codes(self):
        text = edged("--help").stdout
        for word in ("simulate", "run", "eval", "config", "Exit codes", "edged run"):
            self.assertIn(word, text)
        for command in ("run", "info", "doctor", "calib", "convert", "simulate", "eval", "enhance", "depth"):
            self.assertIn("Example", edged(command, "--help").stdout)

    def test_a_wrong_command_line_is_code_2(self):
        for args in ([], ["fly"], ["run"], ["run", "x", "--mode", "sonar"], ["eval", "a"], ["config", "--what"]):
            self.assertEqual(edged(*args).returncode, 2, args)

    def test_version_names_the_program(self):
        self.assertRegex(edged("--version").stdout, r"^edged \d+\.\d+\.\d+")


class BadInput(WithFolder):
    def test_a_missing_recording(self):
        self.assert_refused(edged("run", self.folder / "nothing"), "nothing")

    def test_an_empty_folder(self):
        self.assert_refused(edged("run", self.folder), str(self.folder))

    def test_an_unknown_rig_lists_those_there_are(self):
        self.assert_refused(edged("run", self.folder, "--rig", "davis999"), "davis999", "davis240c_ecd")

    def test_an_unknown_option_suggests_the_nearest(self):
        self.assert_refused(edged("run", "sim:room", "--set", "packets.max_intervall_s=1"), "'packets.max_interval_s'")

    def test_an_option_out_of_range_names_the_range(self):
        self.assert_refused(edged("run", "sim:room", "packets.max_interval_s=-1"), "packets.max_interval_s", "0.001")

    def test_a_bad_config_file_names_file_line_and_key(self):
        file = self.folder / "bad.yaml"
        file.write_text("packets:\n  max_interval_s: soon\n")
        self.assert_refused(edged("run", "sim:room", "--config", file), f"{file}:2", "packets.max_interval_s", "soon")

    def test_an_unknown_preset_or_seed(self):
        self.assert_refused(edged("run", "sim:moon"), "moon", "room")
        self.assert_refused(edged("run", "sim:room:x"), "seed")

    def test_a_folder_that_is_no_run_is_not_overwritten(self):
        (self.folder / "thesis.tex").write_text("years of work")
        self.assert_refused(edged("run", "sim:room", "--out", self.folder), str(self.folder), "--out")
        self.assertEqual((self.folder / "thesis.tex").read_text(), "years of work")

    def test_a_trajectory_that_is_none(self):
        file = self.folder / "notes.txt"
        file.write_text("hello\n")
        self.assert_refused(edged("eval", file, file), str(file))
        self.assert_refused(edged("eval", self.folder / "none.txt", file), "none.txt")


class Eval(WithFolder):
    def setUp(self):
        super().setUp()
        self.truth = self.folder / "truth.txt"
        self.truth.write_text("".join(f"{100 + 0.1 * i:.1f} {i * 0.1} {(i % 7) * 0.1} {(i % 3) * 0.2} 0 0 0 1\n"
                                      for i in range(200)))

    def test_a_trajectory_equals_itself(self):
        result = json.loads(edged("eval", self.truth, self.truth, "--json").stdout)
        self.assertLess(result["ate_rmse_m"], 1e-9)
        # Ten poses a second are too few for windows of 1 s.
        self.assertEqual([(local["window_s"], local["windows"]) for local in result["local_error"]],
                         [(1.0, 0), (3.0, 18), (10.0, 3)])
        self.assertIsNone(result["local_error"][0]["rmse_m"])
        self.assertLess(result["local_error"][1]["rmse_m"], 1e-9)
        self.assertAlmostEqual(result["scale"], 1.0)
        self.assertEqual(result["pairs"], 200)

    def test_protocols_and_windows_are_applied(self):
        self.assertEqual(json.loads(edged("eval", self.truth, self.truth, "--protocol", "P1", "--json").stdout)["window_s"],
                         [3.0, 8.0])
        custom = edged("eval", self.truth, self.truth, "--align", "yaw", "--first", "5", "--json")
        self.assertEqual(json.loads(custom.stdout)["alignment"], "position+yaw")
        table = edged("eval", self.truth, self.truth).stdout
        self.assertIn("ATE position", table)
        self.assertIn("0.00 mm over 3 s, 0.00 mm over 10 s (18, 3 windows)", table)

    def test_other_clocks_are_refused(self):
        later = self.folder / "later.txt"
        later.write_text("".join(f"{5000 + i} 0 0 {i} 0 0 0 1\n" for i in range(9)))
        self.assert_refused(edged("eval", self.truth, later), "clock")


class Calib(WithFolder):
    KALIBR = """cam0:
  T_cam_imu: [[0, -1, 0, 0], [0, 0, -1, 0], [1, 0, 0, -0.1], [0, 0, 0, 1]]
  camera_model: pinhole
  distortion_model: none
  intrinsics: [173.0, 173.0, 172.5, 129.5]
  resolution: [346, 260]
  timeshift_cam_imu: -0.003
"""

    def setUp(self):
        super().setUp()
        self.chain = self.folder / "camchain.yaml"
        self.chain.write_text(self.KALIBR)

    def test_a_rig_is_shown_with_both_directions_and_its_field_of_view(self):
        text = edged("calib", "davis240c_ecd").stdout
        for word in ("T_B_C", "T_C_B", "field of view", "t_imu = t_cam +2.400 ms", "gyro noise"):
            self.assertIn(word, text)
        shown = json.loads(edged("calib", "davis240c_ecd", "--json").stdout)
        self.assertEqual([camera["name"] for camera in shown["cameras"]], ["events", "frames"])
        self.assertEqual(shown["warnings"], [])

    def test_any_format_becomes_a_rig(self):
        self.assert_refused(edged("calib", self.chain), "cam0", "--camera cam0=events")
        rig = self.folder / "head.yaml"
        shown = edged("calib", self.chain, "--camera", "cam0=both", "--out", rig, "--json")
        self.assertAlmostEqual(json.loads(shown.stdout)["cameras"][0]["field_of_view_deg"]["horizontal"], 89.8, 1)
        again = json.loads(edged("calib", rig, "--json").stdout)
        self.assertEqual(again["name"], "head")
        self.assertEqual([camera["name"] for camera in again["cameras"]], ["events", "frames"])
        self.assertAlmostEqual(again["cameras"][0]["T_B_C"][0][3], 0.1)
        self.assertAlmostEqual(again["cameras"][0]["time_offset_s"], -0.003)
        self.assert_refused(edged("calib", self.chain, "--camera", "cam0=both", "--out", rig), "exists")

    def test_what_looks_wrong_is_said(self):
        self.chain.write_text(self.KALIBR.replace("-0.1]", "-100]"))
        result = edged("calib", self.chain, "--camera", "cam0=events")
        self.assertEqual(result.returncode, 0)
        self.assertIn("millimetres", result.stderr)
        self.chain.write_text(self.KALIBR.replace("[0, -1, 0, 0]", "[0, 1, 0, 0]"))
        self.assert_refused(edged("calib", self.chain, "--camera", "cam0=events"), "camchain.yaml:2", "mirrored")


class Depth(WithFolder):
    def test_a_network_is_shown_with_its_cost(self):
        for model in ("small", "small_recurrent"):
            shown = json.loads(edged("depth", model, "--json").stdout)
            self.assertEqual(shown["name"], model)
            self.assertGreater(shown["inference_ms"], 0.0)
        text = edged("depth").stdout
        for word in ("bins", "one core", "edged depth fetch"):
            self.assertIn(word, text)

    def test_fetch_says_where_the_published_weights_go(self):
        result = edged("depth", "fetch")
        self.assertEqual(result.returncode, 0, result.stderr)
        for word in ("E2DEPTH_si_grad_loss_mixed.pth.tar", "convert_checkpoint.py", "config/depth/e2depth.onnx"):
            self.assertIn(word, result.stdout)

    def test_a_model_that_cannot_be_used_is_refused_with_the_file(self):
        self.assert_refused(edged("depth", "nonsense"), "no depth model 'nonsense'", "small")
        self.assert_refused(edged("depth", self.folder / "none.onnx"), "none.onnx", "edged depth fetch")
        file = self.folder / "broken.onnx"
        file.write_bytes(b"no network")
        self.assert_refused(edged("depth", file), "broken.json", "docs/depth_model.md")
        file.with_suffix(".json").write_text('{"name": "x", "bins": 5, "multiple": 8, "d_max_m": 10, "alpha": 3.7}')
        self.assert_refused(edged("depth", file), "broken.onnx", "cannot be used as a depth network")
        file.with_suffix(".json").write_text('{"name": "x"}')
        self.assert_refused(edged("depth", file), "broken.json", "'bins'")

    @unittest.skipIf(os.geteuid() == 0, "root may read everything")
    def test_a_model_that_may_not_be_read_is_refused(self):
        file = self.folder / "secret.onnx"
        file.with_suffix(".json").write_text('{"name": "x", "bins": 5, "multiple": 8, "d_max_m": 10, "alpha": 3.7}')
        file.write_bytes(b"")
        file.chmod(0)
        self.assert_refused(edged("depth", file), "secret.onnx")


class Recordings(WithFolder):
    """info, doctor and convert on one generated recording."""

    @classmethod
    def setUpClass(cls):
        cls.shared = pathlib.Path(tempfile.mkdtemp(prefix="edged_cli_"))
        cls.addClassCleanup(shutil.rmtree, cls.shared)
        cls.flight = cls.shared / "flight"
        made = edged("simulate", "--preset", "handheld-fast", "--duration", 3, "--out", cls.flight, "--quiet")
        assert made.returncode == 0, made.stderr

    def changed(self, name, change):
        """The recording with one of its files changed."""
        copy = self.folder / "changed"
        shutil.copytree(self.flight, copy)
        (copy / name).write_text(change((copy / name).read_text()))
        return copy

    def test_info_counts_what_is_there(self):
        found = json.loads(edged("info", self.flight, "--json").stdout)
        self.assertEqual(found["events"]["count"], len((self.flight / "events.txt").read_text().splitlines()))
        self.assertEqual(found["frames"]["count"], len((self.flight / "images.txt").read_text().splitlines()))
        self.assertEqual((found["events"]["width"], found["events"]["height"]), (240, 180))
        self.assertAlmostEqual(found["imu"]["mean_accel"], 10.5, delta=1.0)
        text = edged("info", self.flight).stdout
        for word in ("events", "no gaps", "highest rate", "hot pixels", "noise", "ground truth"):
            self.assertIn(word, text)

    def test_a_piece_holds_what_lies_between_its_bounds(self):
        whole = json.loads(edged("info", self.flight, "--json").stdout)
        begin = whole["imu"]["begin_ns"]
        for name in ("flight", "part.h5", "part.bag"):
            recording = self.flight if name == "flight" else self.folder / name
            if recording != self.flight:
                self.assertEqual(edged("convert", self.flight, recording, "--quiet").returncode, 0)
            rig = ["--calib", self.flight / "calibration.yaml"]
            piece = json.loads(edged("info", recording, *rig, "--from", 1, "--to", 1.5, "--json").stdout)
            for stream, slack in (("events", 1), ("frames", 100), ("imu", 3)):  # [ms] clocks differ by 2.4 ms
                self.assertGreaterEqual(piece[stream]["begin_ns"] - begin, 1e9 - 3e6, f"{name} {stream}")
                self.assertLess(piece[stream]["begin_ns"] - begin, 1e9 + 1e6 * slack, f"{name} {stream}")
                self.assertLess(piece[stream]["end_ns"] - begin, 1.5e9, f"{name} {stream}")
                self.assertGreater(piece[stream]["end_ns"] - begin, 1.5e9 - 1e6 * slack - 3e6, f"{name} {stream}")
        converted = self.folder / "piece"
        self.assertEqual(edged("convert", self.flight, converted, "--from", 1, "--to", 1.5, "--quiet").returncode, 0)
        self.assertEqual(json.loads(edged("info", converted, "--json").stdout)["events"]["count"], piece["events"]["count"])

    def test_bounds_that_hold_nothing_are_refused(self):
        self.assert_refused(edged("info", self.flight, "--from", 2, "--to", 1), "--from 2", "--to")
        self.assert_refused(edged("run", self.flight, "--from", 60, "--out", self.folder / "run"), "--from 60", "3.0")
        self.assertEqual(edged("info", self.flight, "--from", -1).returncode, 2)

    def test_dimmed_frames_are_dark_whoever_reads_them(self):
        bright = json.loads(edged("info", self.flight, "--json").stdout)["frames"]
        dark = json.loads(edged("info", self.flight, "--dim-frames", 0.06, "--json").stdout)["frames"]
        self.assertEqual(dark["count"], bright["count"])
        self.assertAlmostEqual(dark["mean_brightness"], 0.06 * bright["mean_brightness"], delta=0.5)
        folder = self.folder / "dark"
        self.assertEqual(edged("convert", self.flight, folder, "--dim-frames", 0.06, "--quiet").returncode, 0)
        self.assertEqual(json.loads(edged("info", folder, "--json").stdout)["frames"]["mean_brightness"],
                         dark["mean_brightness"])

    def test_the_doctor_finds_a_healthy_recording_healthy(self):
        result = edged("doctor", self.flight)
        self.assertEqual(result.returncode, 0, result.stdout)
        self.assertIn("0 errors, 0 warnings", result.stdout)
        for camera in ("events", "frames"):
            self.assertRegex(result.stdout, rf"camera {camera}: t_imu = t_cam .* by its turning")
            self.assertRegex(result.stdout, rf"camera {camera}: its rotation agrees with the gyro to [0-3]\.")

    def test_the_doctor_names_wrong_units_with_the_remedy(self):
        def in_degrees_and_g(text):
            lines = []
            for line in text.splitlines():
                t, *v = line.split()
                lines.append(" ".join([t] + [str(float(x) / 9.80665) for x in v[:3]] +
                                      [str(float(x) * 57.29578) for x in v[3:]]))
            return "\n".join(lines) + "\n"
        result = edged("doctor", self.changed("imu.txt", in_degrees_and_g))
        self.assertEqual(result.returncode, 3)
        self.assertRegex(result.stdout, r"error +accelerometer in g.*\n.*9.80665")
        self.assertRegex(result.stdout, r"error +gyro in deg/s.*\n.*pi / 180")

    def test_the_doctor_names_swapped_columns_of_the_imu_and_blames_no_unit(self):
        def swapped(text):
            return "".join(" ".join([t, *v[3:], *v[:3]]) + "\n" for t, *v in (line.split() for line in text.splitlines()))
        result = edged("doctor", self.changed("imu.txt", swapped))
        self.assertEqual(result.returncode, 3)
        self.assertRegex(result.stdout, r"error +gyro and accelerometer are swapped.*\n.*t ax ay az gx gy gz")
        self.assertIn("\n1 errors, ", result.stdout)

    def test_the_doctor_names_a_gyro_with_negated_axes(self):
        def negated(text):
            return "".join(" ".join([t, *v[:3], *(str(-float(x)) for x in v[3:])]) + "\n"
                           for t, *v in (line.split() for line in text.splitlines()))
        result = edged("doctor", self.changed("imu.txt", negated))
        self.assertEqual(result.returncode, 3)
        self.assertRegex(result.stdout, r"error +camera frames: the gyro turns the other way.*\n.*sign")

    def test_the_doctor_counts_everything_that_it_prints(self):
        lines = (self.flight / "imu.txt").read_text().splitlines()
        broken = self.changed("imu.txt", lambda text: "\n".join(lines[:100] + ["x y z"] + lines[100:]) + "\n")
        result = edged("doctor", broken)
        self.assertEqual(result.stderr, "")
        self.assertRegex(result.stdout, r"warning +.*imu.txt:101")
        self.assertEqual(result.stdout.count("\nwarning "), 1)
        self.assertIn("0 errors, 1 warnings", result.stdout)

    def test_the_doctor_tells_what_it_saw_of_a_recording_that_breaks_off(self):
        broken = self.changed("imu.txt", lambda text: text + "x y z\n" * 2000)
        result = edged("doctor", broken)
        self.assertEqual(result.returncode, 3)
        self.assertRegex(result.stdout, r"error +.*imu.txt:\d+.*damaged")
        self.assertIn("IMU at 1000 Hz", result.stdout)

    def test_the_doctor_names_a_calibration_that_contradicts_the_gyro(self):
        rig = self.folder / "turned.yaml"
        text = (self.flight / "calibration.yaml").read_text()

        def quarter_turn(match):  # about the body's x: y' = -z, z' = y
            x, y, z, last = match.group(0).splitlines()
            minus_z = ", ".join(str(-float(v)) for v in z[z.index("[") + 1:-1].split(","))
            return "\n".join([x, f"      - [{minus_z}]", y, last])

        text = re.sub(r"(?: +- \[[^\]]*\]\n){3} +- \[0, 0, 0, 1\]", quarter_turn, text)
        rig.write_text(text.replace("time_offset: 0.002400000", "time_offset: 0.030"))
        result = edged("doctor", self.flight, "--calib", rig)
        self.assertEqual(result.returncode, 3, result.stdout + result.stderr)
        self.assertRegex(result.stdout, r"error +camera frames: its rotation to the IMU contradicts the gyro by (8[5-9]|9[0-5])\.\d deg \+- \d\.\d deg")
        self.assertRegex(result.stdout, r"warning +camera frames: t_imu = t_cam .*\n.*set time_offset")

    def test_convert_there_and_back_keeps_every_event(self):
        for name in ("out.raw", "out.dat"):
            target = self.folder / name
            result = edged("convert", self.flight, target, "--quiet")
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertIn("left out", result.stdout)
            back = self.folder / (name + "_back")
            self.assertEqual(edged("convert", target, back, "--format", "ecd", "--quiet").returncode, 0)
            self.assertEqual((back / "events.txt").read_text(), (self.flight / "events.txt").read_text())
            self.assert_refused(edged("convert", self.flight, target, "--quiet"), "is there already")

    def test_a_converted_recording_gives_the_same_run_to_the_last_bit(self):
        states = {}
        for name in ("flight.bag", "flight.mcap", "flight"):
            recording = self.flight if name == "flight" else self.folder / name
            if name != "flight":
                self.assertEqual(edged("convert", self.flight, recording, "--quiet").returncode, 0)
            run = self.folder / ("run_" + name)
            result = edged("run", recording, "--calib", self.flight / "calibration.yaml", "--out", run, "--quiet")
            self.assertEqual(result.returncode, 0, result.stderr)
            states[name] = (run / "states.csv").read_text()
        self.assertEqual(states["flight.bag"], states["flight"])
        self.assertEqual(states["flight.mcap"], states["flight"])

    def test_convert_lists_the_formats_where_it_does_not_know_one(self):
        self.assert_refused(edged("convert", self.flight, self.folder / "a.xyz"), "`.xyz`", "raw (.raw)")


class Config(WithFolder):
    def test_every_option_is_described(self):
        options = json.loads(edged("config", "--json").stdout)
        self.assertGreater(len(options), 10)
        for option in options:
            self.assertTrue(option["effect"], option["key"])
            self.assertIn(option["key"], edged("config", option["key"]).stdout)

    def test_the_printed_yaml_is_a_valid_config(self):
        file = self.folder / "all.yaml"
        file.write_text(edged("config", "--yaml").stdout)
        # A recording that is not there: the config has been read before it is looked for.
        self.assert_refused(edged("run", self.folder / "nothing", "--config", file), "nothing")


class Run(WithFolder):
    """On one short simulated flight."""

    @classmethod
    def setUpClass(cls):
        cls.work = pathlib.Path(tempfile.mkdtemp(prefix="edged_run_"))
        cls.flight = cls.work / "flight"
        result = edged("simulate", "--duration", "5", "--seed", "2", "--out", cls.flight, "--json", "--quiet")
        assert result.returncode == 0, result.stderr
        cls.simulated = json.loads(result.stdout)

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.work)

    def test_simulate_says_what_it_wrote_and_does_not_overwrite(self):
        self.assertGreater(self.simulated["events"], 10000)
        with open(self.flight / "events.txt", encoding="ascii") as events:
            self.assertEqual(sum(1 for _ in events), self.simulated["events"])
        self.assert_refused(edged("simulate", "--duration", "1", "--out", self.flight, "--quiet"), str(self.flight))

    def test_a_run_leaves_a_complete_folder_and_the_same_bytes_twice(self):
        a, b = self.folder / "a", self.folder / "b"
        result = edged("run", self.flight, "--out", a, "--json", "--quiet")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(result.stderr, "")
        summary = json.loads(result.stdout)
        self.assertEqual(summary, json.loads((a / "metrics.json").read_text()))
        for key in ("ate_rmse_m", "local_error_1s_m", "local_error_3s_m", "local_error_10s_m", "mpe_percent", "scale",
                    "alignment", "poses", "keyframes", "coverage", "real_time_factor", "cpu_s_per_s", "peak_rss_mb", "status"):
            self.assertIn(key, summary)
        self.assertLess(summary["ate_rmse_m"], 0.1)
        for name in ("trajectory_euroc.csv", "states.csv", "config_resolved.yaml", "timing.json", "run.log"):
            self.assertGreater((a / name).stat().st_size, 0, name)
        # Again, from the options the first run resolved.
        again = edged("run", self.flight, "--out", b, "--config", a / "config_resolved.yaml", "--quiet")
        self.assertEqual(again.returncode, 0, again.stderr)
        self.assertEqual((a / "trajectory.tum").read_bytes(), (b / "trajectory.tum").read_bytes())
        self.assertIn("mean position error", again.stdout)
        self.assertIn("local error", again.stdout)
        # The file says what metrics.json says.
        evaluated = json.loads(edged("eval", self.flight / "groundtruth.txt", a / "trajectory.tum", "--json").stdout)
        self.assertAlmostEqual(evaluated["ate_rmse_m"], summary["ate_rmse_m"], places=9)
        self.assertEqual([local["windows"] for local in evaluated["local_error"]],
                         [local["windows"] for local in summary["evaluation"]["local_error"]])

    def test_every_mode_runs_into_its_default_folder(self):
        for mode in ("events", "frames"):
            result = edged("run", self.flight, "--mode", mode, cwd=self.folder)
            self.assertIn(result.returncode, (0, 4), result.stderr)
            self.assertTrue((self.folder / "runs" / f"flight-{mode}" / "metrics.json").is_file())

    def test_a_live_run_takes_as_long_as_the_recording_and_uses_all_of_it(self):
        out = self.folder / "live"
        result = edged("run", self.flight, "--out", out, "--live", "--json", "--quiet", "--set", "depth.source=fused",
                       "live.max_age_s=3600")
        self.assertEqual(result.returncode, 0, result.stderr)
        live = json.loads(result.stdout)
        self.assertGreaterEqual(live["wall_s"], 4.9)
        latency = live["live"]["latency_s"]
        self.assertEqual(sorted(latency.values()), [latency[key] for key in ("p50", "p95", "p99", "max")])
        self.assertEqual(live["live"]["shed"], {"events": 0, "frames": 0, "packets": 0})
        self.assertGreater(live["live"]["queue_peak"]["events"], 0)
        edged("run", self.flight, "--out", self.folder / "run", "--quiet", "--set", "depth.source=fused")
        offline = json.loads((self.folder / "run" / "metrics.json").read_text())
        self.assertNotIn("live", offline)
        self.assertEqual((live["packets"], live["repairs"]), (offline["packets"], offline["repairs"]))
        self.assert_refused(edged("run", "sim:room", "--live"), "--live", "edged simulate")

    def test_the_output_frame_can_be_chosen(self):
        out = self.folder / "body"
        edged("run", self.flight, "--out", out, "--frame", "body", "--quiet")
        self.assertIn("body (IMU)", (out / "trajectory.tum").read_text().splitlines()[0])
        self.assert_refused(edged("run", self.flight, "--frame", "left", "--out", out), "left")

    def test_without_a_good_pose_the_code_is_4(self):
        flight = self.folder / "short"
        edged("simulate", "--duration", "0.2", "--out", flight, "--quiet")
        result = edged("run", flight, "--out", self.folder / "run", "--json", "--quiet")
        self.assertEqual(result.returncode, 4, result.stderr)
        self.assertIsNone(json.loads(result.stdout)["ate_rmse_m"])
        self.assertIsNone(json.loads(result.stdout)["local_error_3s_m"])
        self.assertEqual(json.loads(result.stdout)["status"], "never good")

    def test_an_error_on_the_way_leaves_complete_files_of_what_came_before(self):
        damaged, out = self.folder / "damaged", self.folder / "run"
        shutil.copytree(self.flight, damaged)
        with open(damaged / "events.txt", "a", encoding="ascii") as events:
            events.write("x" * 2_000_000)
        self.assert_refused(edged("run", damaged, "--out", out, "--quiet"), "events.txt")
        metrics = json.loads((out / "metrics.json").read_text())
        self.assertEqual(metrics["status"], "broken off")
        self.assertGreater(metrics["poses"], 0)
        self.assertTrue((out / "states.csv").read_text().endswith("\n"))
        self.assertIn("events.txt", (out / "run.log").read_text())

    def test_enhance_draws_every_step_and_a_sheet(self):
        result = edged("enhance", self.flight, "--at", "3", "--out", self.folder, "--quiet", "--set", "enhance.erosion_px=3")
        self.assertEqual(result.returncode, 0, result.stderr)
        names = sorted(file.name.partition("_")[2] for file in self.folder.iterdir())
        for step in ("events_without_compensation", "event_frame_motion_compensated", "gaussian_blur", "clahe",
                     "sharpened_paper", "sharpened_unsharp", "edges_canny", "edges_laplacian", "edges_sobel",
                     "edges_scharr", "eroded_sobel", "blend_with_scharr"):
            self.assertIn(f"{step}.png", names)
        self.assertNotIn("eroded_canny.png", names)
        self.assertTrue((self.folder / "sheet.png").is_file())

    def test_enhance_wants_a_time_with_events(self):
        out = self.folder / "steps"
        self.assert_refused(edged("enhance", self.flight, "--at", "77", "--out", out, "--quiet"), "77", "0 to 5")
        self.assert_refused(edged("enhance", self.flight, "--at", "-1", "--out", out, "--quiet"), "-1")
        self.assert_refused(edged("enhance", self.flight, "--at", "0", "--out", out, "--quiet"), "no events", "--at")
        self.assertFalse(out.exists())

    def test_contradicting_options_are_refused_with_the_reason(self):
        self.assert_refused(edged("run", self.flight, "--out", self.folder / "run", "enhance.method=canny",
                                  "enhance.erosion_px=3"), "enhance.erosion_px", "one pixel wide")

    def assert_readable(self, out):
        """What a run wrote until it ended anyhow: complete lines, times that increase. Returns the number of poses."""
        states = (out / "states.csv").read_text()
        self.assertTrue(states == "" or states.endswith("\n"))
        lines = [line for line in states.splitlines() if not line.startswith("#")]
        columns = [line.split(",") for line in lines]
        self.assertEqual([len(row) for row in columns], [len(columns[0])] * len(columns) if columns else [])
        stamps = [int(row[0]) for row in columns[1:]]
        self.assertEqual(stamps, sorted(set(stamps)))
        poses = sum(row[1] in ("Good", "Degraded") for row in columns[1:])
        self.assertTrue((out / "run.log").read_text().endswith("\n"))
        for name in ("trajectory.tum", "trajectory_euroc.csv"):
            trajectory = (out / name).read_text()
            self.assertTrue(trajectory.endswith("\n") or trajectory == "")
            if poses > 2:
                evaluated = edged("eval", self.flight / "groundtruth.txt", out / name, "--json")
                self.assertEqual(evaluated.returncode, 0, evaluated.stderr)
                self.assertAlmostEqual(json.loads(evaluated.stdout)["pairs"], poses, delta=2)
        for name in ("metrics.json", "timing.json"):
            if (out / name).exists():
                json.loads((out / name).read_text())
        return poses

    def test_killed_at_any_moment_what_was_written_is_readable(self):
        chance = random.Random(7)
        poses = []
        for trial in range(8):
            out = self.folder / f"run{trial}"
            process = subprocess.Popen([EDGED, "run", self.flight, "--out", out, "--quiet"], stdout=subprocess.DEVNULL)
            lines = chance.randrange(300)  # of about 300
            states = out / "states.csv"
            while process.poll() is None and (not states.exists() or states.read_bytes().count(b"\n") < lines):
                time.sleep(0.005)
            time.sleep(chance.uniform(0.0, 0.05))
            process.kill()
            self.assertIn(process.wait(timeout=60), (0, -signal.SIGKILL))
            poses.append(self.assert_readable(out))
        self.assertGreater(max(poses), 50)
        # The last one's folder takes the next run.
        self.assertEqual(edged("run", self.flight, "--out", out, "--quiet").returncode, 0)
        self.assertTrue((out / "metrics.json").is_file())

    def test_ctrl_c_leaves_complete_files(self):
        out = self.folder / "run"
        process = subprocess.Popen([EDGED, "run", "sim:room:4", "--out", out, "--quiet"], stdout=subprocess.DEVNULL)
        while not (out / "run.log").exists() and process.poll() is None:
            time.sleep(0.02)
        time.sleep(0.5)
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.wait(timeout=60), 130)
        self.assertEqual(json.loads((out / "metrics.json").read_text())["status"], "interrupted")
        self.assertTrue((out / "states.csv").read_text().endswith("\n"))


if __name__ == "__main__":
    unittest.main(verbosity=2)
