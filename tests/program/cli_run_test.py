#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""simulate and run on one short flight: run folders, live runs, interrupted ones.
Usage: EDGED=path/to/edged cli_run_test.py"""
import json
import pathlib
import random
import resource
import shutil
import signal
import subprocess
import time
import unittest
import zipfile

from program import EDGED, WithFlight, ate_m, edged


class Run(WithFlight):
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
        self.assertLessEqual(max(map(len, again.stdout.splitlines()[1:])), 80)  # the first names the folder
        self.assertGreater((a / "pace.csv").stat().st_size, 1000)
        # The file says what metrics.json says.
        evaluated = json.loads(edged("eval", self.flight / "groundtruth.txt", a / "trajectory.tum", "--json").stdout)
        self.assertEqual(evaluated["ate_rmse_m"], summary["ate_rmse_m"])
        self.assertEqual([local["windows"] for local in evaluated["local_error"]],
                         [local["windows"] for local in summary["evaluation"]["local_error"]])

        final = json.loads(edged("eval", self.flight / "groundtruth.txt", a / "trajectory_final.tum", "--json").stdout)
        self.assertAlmostEqual(final["ate_rmse_m"], summary["final_not_causal"]["ate_rmse_m"], places=9)
        self.assertEqual(final["pairs"], evaluated["pairs"])
        self.assertIn("final, not causal", again.stdout)
        for name in ("trajectory_final.tum", "keyframes.csv", "map.ply"):
            self.assertEqual((a / name).read_bytes(), (b / name).read_bytes(), name)

    def test_the_poses_of_a_camera_are_final_when_they_are_published(self):
        whole, broken_off = self.folder / "whole", self.folder / "broken_off"
        edged("run", self.flight, "--mode", "frames", "--out", whole, "--quiet")
        process = subprocess.Popen([EDGED, "run", self.flight, "--mode", "frames", "--live", "--out", broken_off, "--quiet",
                                    "--set", "live.max_age_s=3600"])
        trajectory = broken_off / "trajectory.tum"
        while not trajectory.exists() or trajectory.read_text().count("\n") < 30:
            time.sleep(0.05)
        process.kill()
        process.wait()
        lines = trajectory.read_text().splitlines()
        self.assertEqual((whole / "trajectory.tum").read_text().splitlines()[:len(lines)], lines)

    def test_a_number_that_is_not_finite_is_refused(self):
        for flags in (["--duration", "inf"], ["--occupancy", "x", "--occupancy-voxel", "nan"], ["--export", "x", "--export-hz=nan"],
                      ["--occupancy", "x", "--occupancy-heights", "0", "inf"]):
            self.assert_refused(edged("run", self.flight, *flags), "is not a finite number", code=2)

    def test_an_option_without_its_value_takes_no_other_for_it(self):
        self.assert_refused(edged("run", self.flight, "--occupancy", "--dense", "x"), "a value is missing before --dense", code=2)

    def test_a_simulation_takes_options_of_the_simulator(self):
        run = edged("run", "sim:room:3:duration_s=2,frames.rate_hz=10", "--json", "--quiet", "--out", self.folder / "run")
        metrics = json.loads(run.stdout)
        self.assertEqual((metrics["seed"], round(metrics["duration_s"])), (3, 2))
        first = json.loads(edged("run", "sim:room:duration_s=1.5", "--json", "--quiet", "--out", self.folder / "first").stdout)
        self.assertEqual(round(first["duration_s"], 1), 1.5)
        self.assert_refused(edged("run", "sim:room:x"), "option 'seed' is 'x'")

    def test_a_piece_is_not_called_repaired(self):
        run = edged("run", self.flight, "--duration", 2, "--quiet", "--out", self.folder / "piece")
        self.assertNotIn("repaired", run.stdout)
        self.assertEqual(json.loads((self.folder / "piece" / "metrics.json").read_text())["repairs"], {})

    def test_a_broken_picture_is_told_in_our_words(self):
        broken = self.folder / "broken"
        shutil.copytree(self.flight, broken)
        for number, change in ((3, lambda b: b[:200] + b"x" * 60 + b[260:]), (5, lambda b: b[:len(b) // 2])):
            picture = broken / "images" / f"frame_{number:08}.png"
            picture.write_bytes(change(picture.read_bytes()))
        found = edged("info", broken, "--quiet")
        self.assertEqual([line for line in found.stderr.splitlines() if not line.startswith("edged: ")], [])
        self.assertIn("frame_00000003.png: image unreadable", found.stderr)
        self.assertRegex(found.stdout, r"image unreadable\D+2|2\D+image unreadable")

    def test_without_a_map_the_final_path_has_the_same_times_and_a_smaller_error(self):
        out = self.folder / "run"
        result = edged("run", self.flight, "--out", out, "--quiet", "--frame", "body", "map.enabled=false")
        self.assertEqual(result.returncode, 0, result.stderr)
        causal, final = ((out / name).read_text().splitlines() for name in ("trajectory.tum", "trajectory_final.tum"))
        self.assertIn("; causal", causal[0])
        self.assertIn("; final", final[0])
        stamps = lambda lines: [line.split()[0] for line in lines if not line.startswith("#")]
        self.assertEqual(stamps(causal), stamps(final))
        errors = [ate_m(self.flight / "groundtruth.txt", out / name) for name in ("trajectory.tum", "trajectory_final.tum")]
        self.assertLess(errors[1], errors[0])
        cost = json.loads((out / "metrics.json").read_text())["final_cost"]
        self.assertLess(cost["after"], cost["before"])
        keyframes = (out / "keyframes.csv").read_text().splitlines()
        self.assertEqual(len(keyframes), 2)
        self.assertTrue(keyframes[1].startswith("t_ns,px_m,"))
        self.assertIn("element vertex 0\n", (out / "map.ply").read_text())

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
        self.assertEqual(live["live"]["shed"], {"events": 0, "unread": 0, "frames": 0, "packets": 0})
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

    def test_an_earlier_run_stays_unless_it_may_be_replaced(self):
        out = self.folder / "run"
        piece = ("run", self.flight, "--out", out, "--quiet", "--duration", 0.5)
        edged(*piece)
        before = {file: file.read_bytes() for file in out.iterdir()}
        again = edged(*piece, "--json")
        self.assertEqual(json.loads(again.stdout)["folder"], f"{out}-2")
        self.assertIn(f"{out}-2 (--force replaces)", again.stderr)
        self.assertEqual({file: file.read_bytes() for file in out.iterdir()}, before)
        self.assertEqual(json.loads(edged(*piece, "--json", "--force").stdout)["folder"], str(out))
        self.assertNotEqual((out / "run.log").read_bytes(), before[out / "run.log"])

    def test_a_second_recording_is_refused_with_the_loop_that_runs_both(self):
        refused = edged("run", self.flight, "other.bag", "--out", self.folder / "new")
        self.assert_refused(refused, f"for r in {self.flight} other.bag; do edged run", code=2)
        self.assertFalse((self.folder / "new").exists())

    def test_without_a_good_pose_the_code_is_4(self):
        flight = self.folder / "short"
        edged("simulate", "--duration", "0.2", "--out", flight, "--quiet")
        result = edged("run", flight, "--out", self.folder / "run", "--json", "--quiet", "--archive")
        self.assertEqual(result.returncode, 4, result.stderr)
        self.assert_archived(self.folder / "run")
        self.assertEqual(json.loads(result.stdout)["archive"], str(self.folder / "run.zip"))
        self.assertIsNone(json.loads(result.stdout)["ate_rmse_m"])
        self.assertIsNone(json.loads(result.stdout)["local_error_3s_m"])
        self.assertEqual(json.loads(result.stdout)["status"], "never good")

    def test_an_error_on_the_way_leaves_complete_files_of_what_came_before(self):
        damaged, out = self.folder / "damaged", self.folder / "run"
        shutil.copytree(self.flight, damaged)
        with open(damaged / "events.txt", "a", encoding="ascii") as events:
            events.write("x" * 2_000_000)
        self.assert_refused(edged("run", damaged, "--out", out, "--quiet", "--archive"), "events.txt")
        self.assert_archived(out)
        metrics = json.loads((out / "metrics.json").read_text())
        self.assertEqual(metrics["status"], "broken off")
        self.assertGreater(metrics["poses"], 0)
        self.assertTrue((out / "states.csv").read_text().endswith("\n"))
        self.assertIn("events.txt", (out / "run.log").read_text())
        # Frames alone: nobody reads them.
        frames = self.folder / "frames"
        result = edged("run", damaged, "--mode", "frames", "--out", frames, "--quiet")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(json.loads((frames / "metrics.json").read_text())["repairs"], {})

    def test_contradicting_options_are_refused_with_the_reason(self):
        self.assert_refused(edged("run", self.flight, "--out", self.folder / "run", "enhance.method=canny",
                                  "expert.enhance.erosion_px=3"), "expert.enhance.erosion_px", "one pixel wide")

    def test_cameras_are_chosen_by_name_and_others_than_there_are_refused_with_a_list(self):
        listed = "events (events), frames (frames), events2 (events), frames2 (frames)"
        for wrong, reason in (("events2,cam9", "no 'cam9'"), ("frames,frames2,frames", "twice"), ("events,events2", "names no frame camera")):
            self.assert_refused(edged("run", "sim:room:1", "--mode", "fused", "--out", self.folder / "run", f"cameras={wrong}"),
                                reason, listed if "2" in wrong else "")
        self.assertFalse((self.folder / "run").exists())
        lines = {}
        for cameras in ("events,frames", "events,events2,frames,frames2"):
            out = self.folder / cameras
            result = edged("run", "sim:room:1", "--to", "2", "--out", out, "--quiet", f"cameras={cameras}")
            self.assertIn(result.returncode, (0, 4, 5), result.stderr)
            self.assertIn(f'cameras: "{cameras}"', (out / "config_resolved.yaml").read_text().replace("'", '"'))
            lines[cameras] = (out / "states.csv").read_text()
        out = self.folder / "first"
        edged("run", "sim:room:1", "--to", "2", "--out", out, "--quiet")
        self.assertEqual((out / "states.csv").read_text(), lines["events,frames"])
        self.assertNotEqual(*lines.values())

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
        self.assertEqual(edged("run", self.flight, "--out", out, "--force", "--quiet").returncode, 0)
        self.assertTrue((out / "metrics.json").is_file())

    def test_ctrl_c_and_a_terminal_that_is_closed_leave_complete_files(self):
        for recording, ending, code in (("sim:room:4", signal.SIGINT, 130), ("sim:room:4", signal.SIGHUP, 129),
                                        (self.flight, signal.SIGINT, 130)):
            out = self.folder / f"run_{pathlib.Path(recording).name}_{code}"
            process = subprocess.Popen([EDGED, "run", recording, "--out", out, "--quiet", "--mcap", "--archive"],
                                       stdout=subprocess.DEVNULL)
            states = out / "states.csv"
            while process.poll() is None and (not states.exists() or states.read_bytes().count(b"\n") < 20):
                time.sleep(0.002)
            process.send_signal(ending)
            self.assertEqual(process.wait(timeout=60), code)
            self.assertEqual(json.loads((out / "metrics.json").read_text())["status"], "interrupted")
            self.assertTrue((out / "states.csv").read_text().endswith("\n"))
            self.assertTrue((out / "results.mcap").read_bytes().endswith(b"\x89MCAP0\r\n"))
            self.assert_archived(out)

    def assert_archived(self, out):
        """The archive beside the folder holds all of it."""
        with zipfile.ZipFile(f"{out}.zip") as archive:
            self.assertEqual({name: archive.read(name) for name in archive.namelist()},
                             {f"{out.name}/{file.name}": file.read_bytes() for file in out.iterdir()})

    def test_an_archive_that_cannot_be_written_is_refused_before_the_run(self):
        out, there = self.folder / "run", self.folder / "there.zip"
        for file in (there, self.folder / "there.zip.part", self.folder / "run.zip"):
            file.write_text("of somebody")
        piece = ("run", self.flight, "--duration", 0.3, "--quiet", "--out", out)
        self.assert_refused(edged(*piece, f"--archive={there}"), str(there), "exists already", "--force")
        self.assert_refused(edged(*piece, f"--archive={self.folder}"), "is a folder")
        self.assert_refused(edged(*piece, f"--archive={self.folder}/none/a.zip"), "none/a.zip: cannot be written")
        self.assert_refused(edged(*piece, "--archive"), f"{out}.zip", "exists already")
        self.assertEqual(there.read_text(), "of somebody")
        self.assertFalse(out.exists())
        edged(*piece, f"--archive={there}", "--force")
        with zipfile.ZipFile(there) as archive:
            self.assertIn("run/report.html", archive.namelist())
        self.assertEqual((self.folder / "there.zip.part").read_text(), "of somebody")
        self.assertEqual(len(list(self.folder.iterdir())), 4)

    def test_a_full_disk_is_told_in_one_line(self):
        # Files of at most 20 kB stand for it.
        limit = (resource.RLIMIT_FSIZE, (20_000, 20_000))
        result = subprocess.run([EDGED, "run", self.flight, "--out", self.folder / "run", "--quiet"], capture_output=True,
                                text=True, check=False, restore_signals=False, preexec_fn=lambda: resource.setrlimit(*limit))
        self.assert_refused(result, str(self.folder), "is the disk full?")

    def test_a_disk_that_fills_during_a_run_leaves_complete_files_and_names_them(self):
        limit = (resource.RLIMIT_FSIZE, (60_000, 60_000))  # states.csv is larger, trajectory.tum is not
        result = subprocess.run([EDGED, "run", self.flight, "--out", self.folder / "run", "--quiet"], capture_output=True,
                                text=True, check=False, restore_signals=False, preexec_fn=lambda: resource.setrlimit(*limit))
        self.assert_refused(result, "states.csv: cannot be written", f"{self.folder}/run holds complete, up to then: trajectory.tum, ",
                            "metrics.json; correct the cause and run again, with --force")
        self.assertNotIn("states.csv, ", result.stderr)
        self.assertEqual(len((self.folder / "run" / "trajectory.tum").read_text().splitlines()[-1].split()), 8)


if __name__ == "__main__":
    unittest.main(verbosity=2)
