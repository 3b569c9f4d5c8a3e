#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""edged calib --check: calibrations that fit, that do not, and of which nobody can tell. Usage: EDGED=path/to/edged calib_check_test.py"""
import json
import re
import unittest

from faults import late, turned
from program import WithFlight, edged, with_imu

FITS, UNDETERMINED, DOES_NOT_FIT = 0, 4, 5


class CalibCheck(WithFlight):
    SIMULATION = ("--duration", 12, "--seed", 2)

    def check(self, *args):
        result = edged("calib", "--check", *args, "--quiet", "--json")
        self.assertEqual(result.stderr, "")
        return result.returncode, json.loads(result.stdout)

    def test_a_true_calibration_fits(self):
        code, said = self.check(self.flight)
        self.assertEqual((code, said["verdict"]), (FITS, "fits"), said)
        self.assertEqual([c["verdict"] for c in said["cameras"]], ["fits", "fits"])

    def test_a_clock_that_is_5_ms_off_is_told_with_what_to_write(self):
        true = float(re.search(r"time_offset: (\S+)", (self.flight / "calibration.yaml").read_text()).group(1))
        for off in (-0.005, 0.005):
            code, said = self.check(self.changed("calibration.yaml", late(off)))
            self.assertEqual((code, said["verdict"]), (DOES_NOT_FIT, "does not fit"), said)
            for camera in said["cameras"]:
                written = re.search(r"its clock is [\d.]+ ms \+- [\d.]+ ms off; write `time_offset: ([\d.]+)`", camera["why"])
                self.assertTrue(written, camera)
                self.assertAlmostEqual(float(written.group(1)), true, delta=0.002)

    def test_a_camera_turned_by_3_degrees_is_told_and_mended(self):
        wrong = self.folder / "wrong.yaml"
        wrong.write_text(turned(3)((self.flight / "calibration.yaml").read_text()))
        mended = self.folder / "mended.yaml"
        result = edged("calib", wrong, "--check", self.flight, "--out", mended, "--quiet")
        self.assertEqual(result.returncode, DOES_NOT_FIT, result.stdout)
        self.assertRegex(result.stdout, r"events +does not fit: .*its rotation to the IMU is [23]\.\d deg \+- \d\.\d deg off")
        self.assertRegex(result.stdout, r"calibration does not fit: see events, frames\nnext ")
        code, said = self.check(self.flight, "--calib", mended)
        self.assertEqual(code, FITS, said)

    def test_too_little_motion_is_no_verdict(self):
        code, said = self.check(self.flight, "--duration", 1.2)
        self.assertEqual((code, said["verdict"]), (UNDETERMINED, "cannot be determined"), said)
        self.assertIn("--duration", said["why"])
        still = self.folder / "still"
        edged("simulate", "--duration", 6, "--set", "motion.rest_s=5", "--out", still, "--quiet")
        code, said = self.check(still)
        self.assertEqual((code, said["verdict"]), (UNDETERMINED, "cannot be determined"), said)

    def test_units_and_sizes_that_are_wrong_do_not_fit(self):
        in_g = with_imu(lambda t, a, g: (t, [x / 9.80665 for x in a], g))
        code, said = self.check(self.changed("imu.txt", in_g), "--duration", 3)
        self.assertEqual(code, DOES_NOT_FIT, said)
        self.assertIn("accelerometer in g", said["why"])
        result = edged("calib", "mvsec", "--check", self.flight, "--duration", 3, "--quiet")
        self.assertEqual(result.returncode, DOES_NOT_FIT, result.stdout + result.stderr)
        self.assertIn("calibrated for 346 x 260 px, recorded 240 x 180", result.stdout)

    def test_what_goes_with_check_is_refused_without(self):
        self.assert_refused(edged("calib", "davis240c_ecd", "--duration", 3), "--check", code=2)
        self.assert_refused(edged("calib", "davis240c_ecd", "--check", "x", "--rig", "mvsec"), "excludes", code=2)
        self.assert_refused(edged("calib", "--check", self.folder / "nothing"), "nothing")


if __name__ == "__main__":
    unittest.main(verbosity=2)
