#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""edged calib --refine: one calibration from several recordings. Usage: EDGED=path/to/edged calib_refine_test.py"""
import json
import pathlib
import shutil
import unittest

import yaml

from program import WithFlight, edged

NEVER_GOOD = 4


def longer(percent):
    """The text of a calibration with longer focal lengths."""
    def changed(text):
        calibration = yaml.safe_load(text)
        for camera in calibration["cameras"]:
            if "intrinsics" in camera:
                camera["intrinsics"][:2] = [f * (1 + percent / 100) for f in camera["intrinsics"][:2]]
        return yaml.safe_dump(calibration)
    return changed


class CalibRefine(WithFlight):
    SIMULATION = ("--duration", 10, "--seed", 2)

    def second(self):
        """Another flight with the same sensors."""
        folder = self.folder / "second"
        edged("simulate", "--duration", 10, "--seed", 3, "--out", folder, "--quiet")
        shutil.copy(self.flight / "calibration.yaml", folder / "calibration.yaml")
        return folder

    def refine(self, *args):
        out = self.folder / "better.yaml"
        out.unlink(missing_ok=True)
        result = edged("calib", "--refine", *args, "--mode", "frames", "--out", out, "--quiet", "--json")
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        return json.loads(result.stdout), yaml.safe_load(out.read_text())

    def test_recordings_add_up_to_one_calibration(self):
        wrong = self.folder / "wrong.yaml"
        text = (self.flight / "calibration.yaml").read_text()
        wrong.write_text(longer(1.0)(text))
        second = self.second()
        one, _ = self.refine(self.flight, "--calib", wrong)
        other, _ = self.refine(second, "--calib", wrong)
        both, written = self.refine(self.flight, second, "--calib", wrong)
        fx = [said["cameras"][0]["corrections"]["fx_percent"] for said in (one, other, both)]
        self.assertLess(fx[2]["sigma"], 0.8 * max(fx[0]["sigma"], fx[1]["sigma"]))
        self.assertLess(fx[2]["sigma"], min(fx[0]["sigma"], fx[1]["sigma"]))
        self.assertEqual([r["contradicts"] for r in both["recordings"]], ["", ""])
        true = yaml.safe_load(text)["cameras"][0]["intrinsics"]
        for camera in written["cameras"]:  # events and frames are behind one lens
            found = camera.get("intrinsics", true)
            for i in (0, 1):
                self.assertLess(abs(found[i] / true[i] - 1), 0.004, written)
        check = edged("calib", self.folder / "better.yaml")
        self.assertEqual(check.returncode, 0, check.stderr)

    def test_what_cannot_be_combined_is_refused(self):
        self.assert_refused(edged("calib", "--refine", self.flight), "--out FILE")
        out = self.folder / "better.yaml"
        other = self.changed("calibration.yaml", longer(0.1))
        short = ("--out", out, "--duration", 0.3, "--mode", "frames", "--quiet")
        self.assert_refused(edged("calib", "--refine", self.flight, other, *short), "give all the same one with --calib")
        self.assert_refused(edged("calib", "--refine", self.flight, "--check", self.flight, "--out", out), "excludes", code=2)
        none = edged("calib", "--refine", self.flight, *short)
        self.assertEqual(none.returncode, NEVER_GOOD, none.stdout + none.stderr)
        self.assertIn("not used", none.stdout)
        self.assertFalse(pathlib.Path(out).exists())


if __name__ == "__main__":
    unittest.main(verbosity=2)
