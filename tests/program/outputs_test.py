#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""Outputs that cannot be written: refused at the start, and at the end no loss to the others; the line that names the next step.
Usage: EDGED=path/to/edged outputs_test.py"""
import json
import os
import resource
import signal
import subprocess
import unittest

from program import EDGED, WithFlight, edged


class Outputs(WithFlight):
    SIMULATION = ("--duration", 3, "--seed", 2)

    def test_what_cannot_be_written_is_refused_at_the_start_with_its_option(self):
        nowhere, taken = self.folder / "no" / "file", self.folder / "folder"
        taken.mkdir()
        for place in (nowhere, taken):
            run = self.folder / "run"
            self.assert_refused(edged("run", self.flight, "--save-map", place, "--out", run, "--quiet"), str(place), "--save-map")
            self.assertFalse(run.exists())
            self.assert_refused(edged("calib", "--check", self.flight, "--out", place, "--quiet"), str(place), "--out")
        self.assert_refused(edged("show", self.flight, "--out", self.folder / "no" / "page.html", "--quiet"), "page.html", "--out")
        self.assert_refused(edged("run", self.flight, "--out", self.flight / "imu.txt" / "x", "--quiet"), "--out")

    def test_an_output_replaces_neither_a_recording_nor_a_pipe(self):
        bag, pipe, run = self.folder / "flight.bag", self.folder / "pipe", self.folder / "run"
        bag.write_bytes(b"#ROSBAG V2.0\n")
        os.mkfifo(pipe)
        for place, reason in ((bag, "exists, and is not a file that"), (pipe, "pipe")):
            self.assert_refused(edged("run", self.flight, "--save-map", place, "--out", run, "--quiet"), str(place), reason, "--save-map")
            self.assert_refused(edged("report", self.flight, "--out", place), str(place), reason, "--out")
        self.assertFalse(run.exists())
        self.assertEqual(bag.read_bytes(), b"#ROSBAG V2.0\n")

    def run_with_files_up_to(self, most, *options):
        """Of the flight into the folder `run`; a file cannot have more bytes."""
        def limit():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (most, most))
        return subprocess.run([EDGED, "run", str(self.flight), "--mode", "frames", "--out", str(self.folder / "run"), "--quiet", *options],
                              capture_output=True, text=True, check=False, timeout=300, preexec_fn=limit)

    def test_a_disk_that_is_full_at_one_output_costs_no_other(self):
        out = self.folder / "run"
        result = self.run_with_files_up_to(150_000)  # album and report are larger, tables and trajectories are not
        self.assertEqual(result.returncode, 3, result.stdout + result.stderr)
        self.assertRegex(result.stderr, r"/run/\S+: cannot be written; is the disk full\?")
        self.assertRegex(result.stdout, r"not written +\S*/run/")
        self.assertRegex(result.stdout, r"verdict +nothing contradicts the result")
        self.assertEqual(json.loads((out / "metrics.json").read_text())["status"], "good")
        for name in ("trajectory.tum", "trajectory_final.tum", "states.csv", "keyframes.csv"):
            self.assertGreater((out / name).stat().st_size, 0, name)
        self.assertEqual([name for name in os.listdir(out) if name.endswith(".part")], [])

    def test_what_a_full_disk_cut_short_neither_stays_nor_is_the_next_step(self):
        out = self.folder / "run"
        edged("run", self.flight, "--mode", "frames", "--out", out, "--quiet")
        (out / "notes").write_bytes(os.urandom(100_000))  # which is packed as well
        (out / "report.html.part").write_text("of a run that was killed")
        result = self.run_with_files_up_to(70_000, "--force", "--archive")
        self.assertIn("groundtruth.tum: cannot be written", result.stderr)
        self.assertIn("run.zip: cannot be written", result.stderr)
        self.assertNotRegex(result.stdout, r"\n  archive ")
        self.assertRegex(result.stdout, rf"\n  next +make room, then edged report {out}\n$")
        self.assertFalse({"groundtruth.tum", "report.html", "report.html.part"} & set(os.listdir(out)))
        self.assertEqual(os.listdir(self.folder), ["run"])
        self.assertEqual(edged("report", out).returncode, 0)

    def test_a_map_without_keyframes_is_not_kept(self):
        the_map = self.folder / "room.map"
        result = edged("run", self.flight, "--mode", "frames", "--duration", 0.8, "--save-map", the_map, "--out", self.folder / "run",
                       "--json", "--quiet")
        summary = json.loads(result.stdout)
        self.assertEqual((result.returncode, summary["map"]["saved"]), (3, ""), summary["findings"])
        self.assertEqual((summary["status"], summary["trusted"]), ("good", True), "the trajectory is none the worse")
        self.assertRegex(" ".join(summary["unwritten"]), f"^--save-map {the_map}: not written, as no keyframe has left the window")
        self.assertFalse(the_map.exists())

    def test_the_table_names_what_was_written_and_joins_no_columns(self):
        table = edged("run", self.flight, "--mode", "frames", "--dense", "--export", "scene", "--occupancy", "space", "--out", "run", "--quiet",
                      cwd=self.folder).stdout
        for name, files in (("dense depth", "dense.ply"), ("export", "scene/  .* images, sparse/0"), ("occupancy", "space/  .*map.pgm")):
            self.assertRegex(" ".join(table.split("\n")), f"  {name} .*{files}")
        self.assertRegex(table, r"dense depth +\d+ keyframes?  +\d+ % of")

    def test_every_command_ends_with_the_next_step(self):
        out = self.folder / "run"
        last = lambda *args: edged(*args).stdout.splitlines()[-1]  # noqa: E731
        self.assertEqual(last("info", self.flight, "--quiet").split(), ["next", "edged", "doctor", str(self.flight)])
        self.assertEqual(last("doctor", self.flight, "--quiet").split(), ["next", "edged", "run", str(self.flight)])
        self.assertEqual(last("run", self.flight, "--mode", "frames", "--out", out, "--quiet").split()[0], "next")
        self.assertEqual(last("eval", self.flight / "groundtruth.txt", out / "trajectory.tum").split()[:3], ["next", "edged", "report"])
        self.assertIn("--check", last("calib", self.flight))
        self.assertEqual(last("calib", "--check", self.flight, "--quiet").split()[:2], ["next", "edged"])


if __name__ == "__main__":
    unittest.main(verbosity=2)
