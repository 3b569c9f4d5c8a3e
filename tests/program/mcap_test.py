#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""results.mcap as a reader sees it that is not ours: @mcap/core for node, fetched by npm into $EDGED_NPM where that is possible,
else skipped.
Usage: EDGED=path/to/edged EDGED_NPM=folder mcap_test.py"""
import json
import os
import pathlib
import re
import shutil
import subprocess
import unittest

from program import WithFlight, edged

PACKAGES = ["@mcap/core@2.2.2", "fzstd@0.1.1", "@foxglove/schemas@2.1.0"]
LAYOUT = pathlib.Path(__file__).resolve().parents[2] / "config/foxglove/edged.json"
READER = pathlib.Path(__file__).with_name("mcap_reader.mjs")


def fetched():
    """The folder with the packages, and why there is none."""
    if not (shutil.which("node") and shutil.which("npm")):
        return None, "no node and npm (Debian: nodejs npm)"
    folder = pathlib.Path(os.environ["EDGED_NPM"])
    if not all((folder / "node_modules" / name.rpartition("@")[0] / "package.json").is_file() for name in PACKAGES):
        folder.mkdir(parents=True, exist_ok=True)
        try:
            done = subprocess.run(["npm", "install", "--prefix", folder, "--no-audit", "--no-fund", "--no-save", *PACKAGES],
                                  capture_output=True, text=True, check=False, timeout=120)
        except subprocess.TimeoutExpired:
            return None, "npm did not answer within two minutes"
        if done.returncode != 0:
            return None, f"npm could not fetch {' '.join(PACKAGES)}: {done.stderr.strip().splitlines()[0]}"
    return folder, ""


class Mcap(WithFlight):
    SIMULATION = ("--duration", 3, "--seed", 2)

    @classmethod
    def setUpClass(cls):
        cls.packages, why = fetched()
        if not cls.packages:
            raise unittest.SkipTest(why)
        super().setUpClass()

    def read(self, out):
        done = subprocess.run(["node", READER, out / "results.mcap", self.packages], capture_output=True, text=True, check=False,
                              timeout=120)
        self.assertEqual(done.returncode, 0, done.stderr)
        found = json.loads(done.stdout)
        self.assertEqual(found["problems"], [])
        for name, topic in found["topics"].items():
            self.assertEqual(topic["read"], topic["counted"], name)
            self.assertEqual(topic["encodings"], ["json", "jsonschema"], name)
        return found

    def test_every_message_is_what_its_schema_says_and_found_by_its_time(self):
        out = self.folder / "run"
        result = edged("run", self.flight, "--out", out, "--mcap", "--json", "--quiet")
        self.assertEqual(result.returncode, 0, result.stderr)
        summary = json.loads(result.stdout)
        found = self.read(out)
        topics = found["topics"]
        self.assertEqual(found["compressions"], ["zstd"])
        self.assertGreater(found["chunks"], 1)
        self.assertEqual({name: topic["schema"] for name, topic in topics.items()},
                         {"/tf": "foxglove.FrameTransforms", "/tf_static": "foxglove.FrameTransforms",
                          "/pose": "foxglove.PoseInFrame", "/path": "foxglove.PosesInFrame",
                          "/path_final": "foxglove.PosesInFrame", "/landmarks": "foxglove.PointCloud",
                          "/map": "foxglove.PointCloud", "/keyframes": "foxglove.SceneUpdate",
                          "/ground_truth": "foxglove.SceneUpdate", "/events/image": "foxglove.CompressedImage",
                          "/frames/image": "foxglove.CompressedImage", "/events/calibration": "foxglove.CameraCalibration",
                          "/frames/calibration": "foxglove.CameraCalibration", "/log": "foxglove.Log", "/stats": "edged.Stats"})
        shown = set(re.findall(r'"(/[a-z_]+(?:/image|/calibration)?)[".]', LAYOUT.read_text()))
        self.assertEqual(shown - topics.keys(), set(), "topics of the layout that are not in the file")
        self.assertEqual(topics["/stats"]["read"], summary["packets"])
        self.assertEqual(topics["/pose"]["read"], summary["poses"])
        self.assertEqual(topics["/tf"]["read"], summary["poses"])
        last = (out / "trajectory_final.tum").read_text().splitlines()[-1]
        self.assertEqual(len(topics["/path_final"]["last"]["poses"]), summary["poses"], last)
        self.assertEqual([transform["parent_frame_id"] for transform in topics["/tf"]["last"]["transforms"]], ["world", "odom"])
        self.assertEqual(found["logged"][-1], f"ended: {summary['status']}")
        facts = found["metadata"]["edged"]
        self.assertEqual(facts["version"], summary["version"])
        self.assertTrue((out / "config_resolved.yaml").read_text().endswith(facts["options"]))
        self.assertRegex(facts["options_hash"], "^[0-9a-f]{16}$")
        self.assertEqual(json.loads(found["metadata"]["metrics"]["metrics.json"]), json.loads((out / "metrics.json").read_text()))

    def test_a_run_without_a_pose_leaves_a_file_that_can_be_read_too(self):
        out = self.folder / "run"
        edged("run", self.flight, "--duration", 0.3, "--mode", "events", "--out", out, "--mcap", "--quiet")
        found = self.read(out)
        self.assertNotIn("/pose", found["topics"])
        self.assertEqual(found["logged"][-1], "ended: never good")


if __name__ == "__main__":
    unittest.main(verbosity=2)
