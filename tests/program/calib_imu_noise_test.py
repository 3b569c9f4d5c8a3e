#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""edged calib --imu-noise: the Allan deviation of an IMU at rest. Usage: EDGED=path/to/edged calib_imu_noise_test.py"""
import json
import random
import unittest

import yaml

from program import WithFolder, edged

RATE_HZ, GYRO, ACCEL = 100.0, 2e-3, 1e-2  # noise per sqrt(Hz)


class CalibImuNoise(WithFolder):
    def recording(self, seconds, turn=0.0, dead=False):
        """A folder with an IMU alone; it turns by that rate [rad/s] in the last 10 s."""
        chance = random.Random(4)
        folder = self.folder / "rest"
        folder.mkdir(exist_ok=True)
        scale = RATE_HZ ** 0.5
        with open(folder / "imu.txt", "w", encoding="utf-8") as file:
            for i in range(int(seconds * RATE_HZ)):
                t = i / RATE_HZ
                accel = [ACCEL * scale * chance.gauss(0, 1) + g for g in (0.1, -0.2, 9.8)]
                gyro = [0.0 if dead else 0.01 + GYRO * scale * chance.gauss(0, 1) for _ in range(3)]
                gyro[1] += turn if t > seconds - 10 else 0.0
                print(f"{t:.4f}", *(f"{value:.7f}" for value in accel + gyro), file=file)
        return folder

    def test_noise_is_found_and_written_for_calib(self):
        out = self.folder / "imu.yaml"
        done = edged("calib", self.recording(120), "--imu-noise", "--out", out, "--quiet")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("the random walk shows in an hour or more", done.stdout)
        written = yaml.safe_load(out.read_text())
        self.assertAlmostEqual(written["gyroscope_noise_density"], GYRO, delta=0.06 * GYRO)
        self.assertAlmostEqual(written["accelerometer_noise_density"], ACCEL, delta=0.06 * ACCEL)
        self.assertEqual(written["update_rate"], RATE_HZ)
        told = json.loads(edged("calib", self.recording(120), "--imu-noise", "--json", "--quiet").stdout)
        self.assertEqual([axis["axis"] for axis in told["axes"]][0], "gyro x")
        self.assertGreater(len(told["axes"][0]["allan_deviation"]), 8)

    def test_what_is_no_rest_is_refused(self):
        self.assert_refused(edged("calib", self.recording(90, turn=0.3), "--imu-noise"), "the IMU moves 8")
        self.assert_refused(edged("calib", self.recording(20), "--imu-noise"), "record 60 s at rest")
        self.assert_refused(edged("calib", self.recording(90, dead=True), "--imu-noise"), "gyro x does not change")
        self.assert_refused(edged("calib", "--imu-noise"), "--imu-noise requires FILE", code=2)


if __name__ == "__main__":
    unittest.main()
