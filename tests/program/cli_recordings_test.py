#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""info, doctor and convert on one generated recording. Usage: EDGED=path/to/edged cli_recordings_test.py"""
import json
import math
import re
import resource
import shutil
import subprocess
import unittest
import zipfile

from program import EDGED, WithFlight, edged


class Recordings(WithFlight):
    SIMULATION = ("--preset", "handheld-fast", "--duration", 3)

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

    def test_a_piece_is_given_by_its_end_or_by_its_duration(self):
        by_end = edged("info", self.flight, "--from", 1, "--to", 1.5, "--json").stdout
        self.assertEqual(edged("info", self.flight, "--start", 1, "--duration", 0.5, "--json").stdout, by_end)
        self.assertEqual(edged("info", self.flight, "--to", 2, "--duration", 1).returncode, 2)

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
            self.assertRegex(result.stdout, rf"camera {camera}: t_imu = t_cam .* from its rotation rate")
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
        self.assertIn("\n1 error, ", result.stdout)

    def test_the_doctor_names_a_gyro_with_negated_axes(self):
        def negated(text):
            return "".join(" ".join([t, *v[:3], *(str(-float(x)) for x in v[3:])]) + "\n"
                           for t, *v in (line.split() for line in text.splitlines()))
        result = edged("doctor", self.changed("imu.txt", negated))
        self.assertEqual(result.returncode, 3)
        self.assertRegex(result.stdout, r"error +camera frames: the gyro rotates the other way.*\n.*sign")

    def test_the_doctor_counts_everything_that_it_prints(self):
        lines = (self.flight / "imu.txt").read_text().splitlines()
        broken = self.changed("imu.txt", lambda text: "\n".join(lines[:100] + ["x y z"] + lines[100:]) + "\n")
        result = edged("doctor", broken)
        self.assertEqual(result.stderr, "")
        self.assertRegex(result.stdout, r"warning +.*imu.txt:101")
        self.assertEqual(result.stdout.count("\nwarning "), 1)
        self.assertIn("0 errors, 1 warning", result.stdout)

    def test_late_copies_of_imu_samples_are_left_out_and_counted_however_many(self):
        lines = (self.flight / "imu.txt").read_text().splitlines()
        copies = [f"{float(t) - 0.005:.9f} {rest}" for t, rest in (line.split(" ", 1) for line in lines)]
        result = edged("info", self.changed("imu.txt", lambda _: "\n".join(sum(zip(lines, copies), ())) + "\n"), "--json")
        self.assertRegex(result.stderr, r"imu\.txt:2: stamp goes back in time")
        found = json.loads(result.stdout)
        self.assertEqual(found["imu"]["count"], len(lines))
        self.assertEqual(found["repairs"]["imu: out of order, dropped"], len(lines))

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

    def test_a_calibration_of_the_frames_of_a_davis_is_told_with_the_command_that_gives_events_the_lens(self):
        frames, head = self.folder / "frames.yaml", self.folder / "head.yaml"
        text = (self.flight / "calibration.yaml").read_text()
        frames.write_text(text[:text.index('  - name: "events"')] + text[text.index('  - name: "frames"'):])
        self.assert_refused(edged("run", self.flight, "--calib", frames, "--quiet"), "--camera frames=both", "--mode frames")
        told = edged("doctor", self.flight, "--calib", frames)
        self.assertRegex(told.stdout, r"warning +the calibration has no camera of the events\n.*--camera frames=both .*--mode frames")
        self.assertEqual(edged("calib", frames, "--camera", "frames=both", "--out", head).returncode, 0)
        self.assertIn("0 errors, 0 warnings", edged("doctor", self.flight, "--calib", head).stdout)

    def test_the_next_step_without_a_calibration_is_to_make_one(self):
        bag = self.folder / "flight.bag"
        edged("convert", self.flight, bag, "--duration", 1, "--quiet")
        self.assertRegex(edged("doctor", bag).stdout, rf"next +edged calib --target .*, then edged doctor {bag} --calib head.yaml\n$")
        self.assert_refused(edged("run", bag, "--quiet"), "holds intrinsics only", "--rig NAME", "`edged calib --target` makes")

    def test_a_full_disk_ends_a_conversion_with_one_line(self):
        # Files of at most 20 kB stand for it.
        limit = (resource.RLIMIT_FSIZE, (20_000, 20_000))
        for name in ("full.h5", "full.bag", "full.aedat4", "full.mcap", "full"):
            target = self.folder / name
            result = subprocess.run([EDGED, "convert", self.flight, target, "--quiet"], capture_output=True, text=True, check=False,
                                    restore_signals=False, preexec_fn=lambda: resource.setrlimit(*limit))
            self.assert_refused(result, str(target), "cannot be written")
            self.assertFalse(target.exists(), name)

    def test_convert_there_and_back_keeps_every_event(self):
        for name in ("out.raw", "out.dat"):
            target = self.folder / name
            result = edged("convert", self.flight, target, "--quiet")
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertIn("dropped, as", result.stdout)
            back = self.folder / (name + "_back")
            self.assertEqual(edged("convert", target, back, "--format", "ecd", "--quiet").returncode, 0)
            self.assertEqual((back / "events.txt").read_text(), (self.flight / "events.txt").read_text())
            self.assert_refused(edged("convert", self.flight, target, "--quiet"), "exists already")

    def test_a_converted_recording_gives_the_same_run_to_the_last_bit(self):
        calib = ("--calib", self.flight / "calibration.yaml")
        states, trajectory = {}, {}
        for name in ("flight", "flight.bag", "flight.mcap", "flight.h5", "flight.aedat4"):
            recording = self.flight if name == "flight" else self.folder / name
            if name != "flight":
                self.assertEqual(edged("convert", self.flight, recording, *calib, "--quiet").returncode, 0)
            run = self.folder / ("run_" + name)
            result = edged("run", recording, *calib, "--out", run, "--quiet")
            self.assertEqual(result.returncode, 0, result.stderr)
            states[name] = (run / "states.csv").read_text()
            trajectory[name] = (run / "trajectory.tum").read_text()
        self.assertIn("camera 'events'", trajectory["flight"].splitlines()[0])
        for name in ("flight.bag", "flight.mcap", "flight.h5"):
            self.assertEqual(states[name], states["flight"], name)
            self.assertEqual(trajectory[name], trajectory["flight"], name)
        # AEDAT4 holds the IMU in single precision, which a flight amplifies; frame and stamps are the same.
        rows = {name: [[float(v) for v in line.split()] for line in text.splitlines() if not line.startswith("#")]
                for name, text in trajectory.items() if name in ("flight", "flight.aedat4")}
        self.assertEqual(trajectory["flight.aedat4"].splitlines()[0], trajectory["flight"].splitlines()[0])
        self.assertEqual([row[0] for row in rows["flight.aedat4"]], [row[0] for row in rows["flight"]])
        self.assertLess(max(math.dist(a[1:4], b[1:4]) for a, b in zip(rows["flight.aedat4"], rows["flight"])), 0.01)

    def test_without_ground_truth_the_trajectory_is_of_the_body_whatever_the_container(self):
        calib = ("--calib", self.flight / "calibration.yaml")
        alone, bag = self.folder / "alone", self.folder / "alone.bag"
        shutil.copytree(self.flight, alone)
        (alone / "groundtruth.txt").unlink()
        self.assertEqual(edged("convert", alone, bag, *calib, "--quiet").returncode, 0)
        for recording in (alone, bag):
            run = self.folder / ("run_" + recording.name)
            self.assertEqual(edged("run", recording, *calib, "--out", run, "--quiet").returncode, 0)
            self.assertIn("T_W_B of the body", (run / "trajectory.tum").read_text().splitlines()[0])

    def test_an_imu_in_a_file_of_its_own_gives_the_same_run_to_the_last_bit(self):
        alone = self.folder / "alone"
        alone.mkdir()
        for name in ("events.txt", "images.txt", "images"):
            (alone / name).symlink_to(self.flight / name)
        named = self.folder / "imu.csv"
        rows = [line.split() for line in (self.flight / "imu.txt").read_text().splitlines()]
        named.write_text("time [s],gyro_x (rad/s),gyro_y,gyro_z,acc_x [m/s^2],acc_y,acc_z\n" +
                         "".join(",".join([r[0], *r[4:7], *r[1:4]]) + "\n" for r in rows))
        states = []
        for recording, imu in ((self.flight, ()), (alone, ("--imu", self.flight / "imu.txt")), (alone, ("--imu", named))):
            run = self.folder / f"run{len(states)}"
            result = edged("run", recording, *imu, "--calib", self.flight / "calibration.yaml", "--out", run, "--quiet")
            self.assertEqual(result.returncode, 0, result.stderr)
            states.append((run / "states.csv").read_bytes())
        self.assertEqual(states[1], states[0])
        self.assertEqual(states[2], states[0])
        self.assertIn("gyro 2,3,4 [rad/s]", edged("info", alone, "--imu", named).stdout)
        self.assert_refused(edged("info", alone, "--imu", alone / "events.txt"), "events.txt", "gx[rad/s]")

    def test_height_and_velocity_are_read_from_folders_and_flags_listed_judged_and_converted(self):
        flight = self.folder / "with_sensors"
        settings = ("--set", "height.rate_hz=25", "--set", "velocity.rate_hz=20", "--set", "velocity.gap_at_s=0.5", "--set",
                    "velocity.gap_s=0.6")
        made = edged("simulate", "--duration", 2, *settings, "--out", flight, "--quiet")
        self.assertIn("50 height samples, 28 velocity samples", made.stdout, made.stderr)
        info = json.loads(edged("info", flight, "--json").stdout)
        self.assertEqual((info["height"]["count"], info["velocity"]["count"], info["velocity"]["gaps"]), (50, 28, 1))
        self.assertAlmostEqual(info["height"]["noise"], 0.1, delta=0.04)
        self.assertIn("noise 0.1", edged("info", flight).stdout.replace("0.09", "0.1").replace("0.11", "0.1"))
        self.assertIn("velocity at 20 Hz, 1 gaps of", edged("doctor", flight).stdout)
        named = self.folder / "baro.csv"
        rows = [line.split() for line in (flight / "height.txt").read_text().splitlines()[1:]]
        named.write_text("height [mm],t [s]\n" + "".join(f"{1000 * float(r[1])},{r[0]}\n" for r in rows))
        by_flag = json.loads(edged("info", self.flight, "--height", named, "--to", 1, "--json").stdout)
        self.assertEqual(by_flag["height"]["count"], 25)
        self.assertAlmostEqual(by_flag["height"]["least"][0], min(float(r[1]) for r in rows[:25]), places=6)
        copy = self.folder / "copy"
        self.assertEqual(edged("convert", flight, copy, "--quiet").returncode, 0)
        for name in ("height.txt", "velocity.txt"):
            self.assertEqual((copy / name).read_text(), (flight / name).read_text())
        converted = edged("convert", flight, self.folder / "flight.bag", "--quiet")
        self.assertIn("dropped, as bag cannot store them: 50 height samples, 28 velocity samples", converted.stdout)

    def test_a_damaged_height_file_is_mended_or_refused_with_its_remedy(self):
        damaged = self.folder / "baro.txt"
        damaged.write_text("0.1 1.5\n0.2 nonsense\n0.3 1.6\n")
        repairs = json.loads(edged("info", self.flight, "--height", damaged, "--json").stdout)["repairs"]
        self.assertEqual(repairs["height: unreadable line"], 1)
        damaged.write_text("t,altitude\n0.1,1.5\n")
        self.assert_refused(edged("info", self.flight, "--height", damaged), "baro.txt:1:", "t[s],height[m]")
        damaged.write_text("1000.1 1.5\n1000.2 1.5\n")
        self.assert_refused(edged("run", self.flight, "--height", damaged), "baro.txt", "another clock")

    def test_a_run_with_height_and_velocity_counts_them_and_shows_them(self):
        flight = self.folder / "with_sensors"
        settings = ("--set", "height.rate_hz=25", "--set", "velocity.rate_hz=20")
        self.assertEqual(edged("simulate", "--duration", 3, *settings, "--out", flight, "--quiet").returncode, 0)
        out = self.folder / "run"
        self.assertEqual(edged("run", flight, "--out", out, "--quiet").returncode, 0)
        external = json.loads((out / "metrics.json").read_text())["external"]
        self.assertEqual({name: counts["samples"] for name, counts in external.items()}, {"height": 75, "velocity": 60})
        for counts in external.values():
            self.assertGreater(counts["used"], 0.6 * counts["samples"])
            self.assertEqual((counts["rejected"], counts["late"]), (0, 0))
        self.assertIn('"external":{"height":{"t":', (out / "report.html").read_text().replace(" ", ""))

    def test_a_zip_of_csv_files_is_read_like_their_folder(self):
        loose = self.folder / "loose"
        loose.mkdir()
        self.assertEqual(edged("convert", self.flight, loose / "events.csv", "--quiet").returncode, 0)
        shutil.copy(self.flight / "imu.txt", loose)
        shutil.copy(self.flight / "calibration.yaml", loose)
        (loose / "notes.csv").write_text("who,when\nme,now\n")
        (loose / "camchain.yaml").write_text("cam0: {}\n")
        (loose / "frames").mkdir()
        (loose / "frames" / "0.png").write_bytes(b"")
        alike = []
        for recording, top in ((loose, ""), (self.folder / "top.zip", ""), (self.folder / "below.zip", "head/")):
            if recording != loose:
                with zipfile.ZipFile(recording, "w", zipfile.ZIP_DEFLATED) as archive:
                    for file in loose.rglob("*"):
                        archive.write(file, top + str(file.relative_to(loose)))
            result = edged("info", recording, "--json", "--quiet")
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertIn("not read: camchain.yaml, frames/, notes.csv (a calibration only where --calib names it)", result.stderr)
            shown = json.loads(result.stdout)
            self.assertEqual([s["role"] for s in shown["streams"] if s["role"]], ["imu"])
            alike.append((shown["events"], shown["imu"]["count"], edged("doctor", recording, "--quiet").returncode))
        self.assertEqual(alike[1], alike[0])
        self.assertEqual(alike[2], alike[0])
        raw = self.folder / "raw.zip"
        self.assertEqual(edged("convert", self.flight, self.folder / "events.raw", "--round", "--quiet").returncode, 0)
        with zipfile.ZipFile(raw, "w") as archive:
            archive.write(self.folder / "events.raw", "events.raw")
        self.assert_refused(edged("info", raw), "raw.zip/events.raw", "unpack it")

    def test_pictures_are_read_wherever_their_list_says(self):
        for place in ("./images/", ""):
            recording = self.changed("images.txt", lambda text, place=place: text.replace("images/", place))
            if not place:
                for image in (recording / "images").iterdir():
                    image.rename(recording / image.name)
                (recording / "images").rmdir()
            result = edged("info", recording, "--quiet")
            self.assertEqual((result.returncode, result.stderr), (0, ""))

    def test_convert_lists_the_formats_where_it_does_not_know_one(self):
        self.assert_refused(edged("convert", self.flight, self.folder / "a.xyz"), "`.xyz`", "raw (.raw)")


if __name__ == "__main__":
    unittest.main(verbosity=2)
