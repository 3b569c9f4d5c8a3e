#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""--imu-time-offset: an IMU whose clock has an epoch of its own. Usage: EDGED=path/to/edged imu_clock_test.py"""
import json
import os
import pathlib
import re
import shutil
import unittest

from program import WithFlight, edged, with_imu

DATA = pathlib.Path(os.environ.get("EDGED_DATA", pathlib.Path(__file__).resolve().parents[3] / "shared/data"))
AHEAD = 1000.25  # of the IMU's clock [s]


class ImuClock(WithFlight):
    SIMULATION = ("--duration", 8, "--seed", 2)

    def shifted(self):
        return self.changed("imu.txt", with_imu(lambda t, a, g: (t + AHEAD, a, g)))

    def run_it(self, recording, *args, mode="fused"):
        result = edged("run", recording, "--mode", mode, "--out", self.folder / "run", "--force", "--quiet", "--json", *args)
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        return json.loads(result.stdout)

    def test_auto_finds_it_and_the_run_refines_it_as_with_the_exact_one(self):
        recording = self.shifted()
        found = self.run_it(recording, "--imu-time-offset", "auto")
        self.assertEqual((found["status"], found["findings"]), ("good", []))
        off_ms = 1e3 * (found["imu_clock"]["offset_s"] + AHEAD)
        self.assertLess(abs(off_ms), 2.0)
        self.assertIn("IMU clock: -1000.2", (self.folder / "run" / "run.log").read_text())
        self.assertIn("--imu-time-offset auto", found["next"] + edged("doctor", recording, "--imu-time-offset", "auto").stdout)
        exact = self.run_it(recording, "--imu-time-offset", -AHEAD)
        self.assertNotIn("imu_clock", exact)
        for one, other in zip(found["calibration"], exact["calibration"], strict=True):
            self.assertLess(abs(one["time_offset_ms"] - off_ms - other["time_offset_ms"]), 1.0, one["camera"])

    def test_the_exact_one_gives_the_result_of_one_clock(self):
        shifted = self.run_it(self.shifted(), "--imu-time-offset", -AHEAD)
        straight = self.run_it(self.flight)
        self.assertAlmostEqual(shifted["ate_rmse_m"], straight["ate_rmse_m"], 9)
        self.assertEqual(shifted["poses"], straight["poses"])

    def test_events_and_a_csv_of_a_microcontroller(self):
        recording, csv = self.shifted(), self.folder / "imu.csv"
        (recording / "imu.txt").rename(csv)
        shutil.rmtree(recording / "images")
        (recording / "images.txt").unlink()
        with_names = "t[s],ax[m/s^2],ay[m/s^2],az[m/s^2],gx[rad/s],gy[rad/s],gz[rad/s]\n" + csv.read_text().replace(" ", ",")
        csv.write_text(with_names)
        self.assert_refused(edged("run", recording, "--imu", csv), "is on another clock", "--imu-time-offset auto")
        found = self.run_it(recording, "--imu", csv, "--imu-time-offset", "auto", mode="events")
        self.assertLess(abs(found["imu_clock"]["offset_s"] + AHEAD), 0.03)
        self.assertEqual(found["status"], "good")
        calibrated = edged("calib", recording / "calibration.yaml", "--check", recording, "--imu", csv, "--mode", "events",
                           "--imu-time-offset", "auto", "--json")
        self.assertIn(calibrated.returncode, (0, 5), calibrated.stderr)

    def test_a_part_is_counted_from_the_first_stamp_of_one_clock(self):
        found = self.run_it(self.shifted(), "--imu-time-offset", -AHEAD, "--from", 2, "--to", 5)
        self.assertAlmostEqual(found["duration_s"], 3.0, delta=0.1)

    def test_conversion_brings_all_to_one_clock(self):
        out = self.folder / "one_clock"
        self.assertEqual(edged("convert", self.shifted(), out, "--imu-time-offset", -AHEAD).returncode, 0)
        first = [float((folder / "imu.txt").read_text().split()[0]) for folder in (out, self.flight)]
        self.assertAlmostEqual(*first, 6)

    def test_rotation_that_does_not_determine_it_is_refused(self):
        still = self.changed("imu.txt", with_imu(lambda t, a, g: (t + AHEAD, a, [0.0, 0.0, 0.1])))
        self.assert_refused(edged("run", still, "--imu-time-offset", "auto", "--quiet"), "--imu-time-offset auto", "do not change enough",
                            "turn the camera by hand", "or give the seconds")
        rows = [line.split() for line in (self.flight / "imu.txt").read_text().splitlines()]
        other = self.changed("imu.txt", lambda _: "".join(
            " ".join(row[:4] + last[4:]) + "\n" for row, last in zip(rows, reversed(rows))))
        self.assert_refused(edged("doctor", other, "--imu-time-offset", "auto", "--quiet"), "do not determine it")

    def test_what_cannot_be_determined_says_what_is_missing(self):
        recording = self.shifted()
        self.assert_refused(edged("run", recording, "--imu-time-offset", "soon"), "--imu-time-offset soon", "auto, or seconds")
        (recording / "calibration.yaml").unlink()
        self.assert_refused(edged("doctor", recording, "--imu-time-offset", "auto"), "--calib")

    @unittest.skipUnless((DATA / "euroc_mh01").exists(), "no data")
    def test_a_real_flight_has_it_found_to_a_millisecond(self):
        folder = self.folder / "mav0"
        shutil.copytree(DATA / "euroc_mh01/mav0/imu0", folder / "imu0", copy_function=shutil.copyfile)
        for part in ("cam0", "body.yaml"):
            (folder / part).symlink_to((DATA / "euroc_mh01/mav0" / part).resolve())
        samples = folder / "imu0/data.csv"
        head, *rows = samples.read_text().splitlines()
        shifted = (f"{int(t) + round(1e9 * AHEAD)},{rest}" for t, rest in (row.split(",", 1) for row in rows))
        samples.write_text("\n".join([head, *shifted]) + "\n")
        found = re.search(r"IMU clock: (\S+) s", edged("doctor", self.folder, "--imu-time-offset", "auto", "--quiet").stdout)
        self.assertLess(abs(float(found.group(1)) + AHEAD), 1e-3)

    @unittest.skipUnless((DATA / "formats/davis240c_imu_rotdisk.aedat").exists(), "no data")
    def test_a_real_recording_of_a_disc_that_turns_steadily_is_refused(self):
        recording, lens = self.folder / "disc", self.folder / "lens.yaml"
        self.assertEqual(edged("convert", DATA / "formats/davis240c_imu_rotdisk.aedat", recording).returncode, 0)
        samples = recording / "imu.txt"
        samples.write_text(with_imu(lambda t, a, g: (t + AHEAD, a, g))(samples.read_text()))
        lens.write_text((self.flight / "calibration.yaml").read_text())
        self.assert_refused(edged("doctor", recording, "--calib", lens, "--imu-time-offset", "auto", "--quiet"), "do not determine it")


if __name__ == "__main__":
    unittest.main()
