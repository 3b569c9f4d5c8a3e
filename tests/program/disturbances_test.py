#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""One simulated recording, disturbed in many ways: the cause that `doctor` and `run` name, with its time and remedy, and
their exit codes. Usage: EDGED=path/to/edged disturbances_test.py [-k PATTERN]"""
import dataclasses
import json
import os
import random
import re
import typing
import unittest

from program import WithFlight, edged

AT = 3.0  # s into the recording: where a disturbance begins
GYRO, ACCEL = (4, 5, 6), (1, 2, 3)  # columns of imu.txt


@dataclasses.dataclass
class Row:
    """A disturbance, and what both must say of it. {at} in a pattern is the time at which it begins, to 0.1 s."""
    changes: dict[str, typing.Callable | str]  # file: its lines from those of the recording, or the file that takes its place
    severity: str  # of the first finding above a note; "none"; "refused": by the reader
    says: str = "."
    remedy: str = ""
    doctor: int = 0  # exit code
    run: int | None = None  # exit code; None: `doctor` alone is asked
    never: str = "camera|covariance"  # what neither may say, as it is a consequence
    mode: str = "frames"  # of the run


def imu(change):
    """change(rows of numbers, index of the sample at AT)"""
    def changed(lines):
        rows = [[float(v) for v in line.split()] for line in lines]
        rows = change(rows, next(i for i, row in enumerate(rows) if row[0] >= rows[0][0] + AT))
        return [" ".join([f"{row[0]:.9f}", *map(repr, row[1:])]) + "\n" for row in rows]
    return {"imu.txt": changed}


def held(columns, seconds, value=None):
    """These columns repeat their reading, or have this one."""
    def change(rows, first):
        reading = rows[first][:]
        for row in rows[first:]:
            if row[0] < reading[0] + seconds:
                for column in columns:
                    row[column] = reading[column] if value is None else value
        return rows
    return imu(change)


def one_reading(column, value):
    def change(rows, first):
        rows[first][column] = value
        return rows
    return imu(change)


def spikes(rows, first):
    draw = random.Random(1)
    for i in draw.sample(range(first, len(rows) - 10), 40):
        rows[i][5] += draw.choice((-1, 1)) * draw.uniform(3, 8)
    return rows


def bursts(size):
    """So many samples have the stamp of their last."""
    def change(rows, _):
        stamps = [row[0] for row in rows]
        return [[stamps[min(i - i % size + size, len(rows)) - 1], *row[1:]] for i, row in enumerate(rows)]
    return imu(change)


def clipped(rows, _):
    most = 0.5 * max(abs(row[5]) for row in rows)
    return [row[:4] + [max(-most, min(most, v)) for v in row[4:]] for row in rows]


def silence(seconds):
    """No sensor has a measurement."""
    def without(lines):
        return [line for line in lines if not AT < float(line.split()[0]) - 0.01 < AT + seconds]
    return {name: without for name in ("imu.txt", "images.txt", "events.txt")}


def truth(change):
    """change(poses from AT on, each [t, x, y, z, qx, qy, qz, qw])"""
    def changed(lines):
        rows = [[float(v) for v in line.split()] for line in lines if not line.startswith("#")]
        change([row for row in rows if row[0] >= AT])
        return [" ".join(map(repr, row)) + "\n" for row in rows]
    return {"groundtruth.txt": changed}


def frozen(poses):
    for pose in poses[:200]:
        pose[1:] = poses[0][1:]


def flipped(poses):
    for pose in poses[100:150]:
        x, y, z, w = pose[4:]
        pose[1:] = [pose[1] + 0.2, *pose[2:4], -y, x, w, -z]  # a half turn about z


def zero(poses):
    for pose in poses[:200]:
        pose[1:] = [0, 0, 0, 0, 0, 0, 1]


def millimetres(poses):
    for pose in poses[:200]:
        pose[1:4] = [1000 * v for v in pose[1:4]]


def calibration(pattern, change):
    """The numbers of each match, by change(number)."""
    def changed(text):
        return re.sub(pattern, lambda m: m[1] + re.sub(r"[-\d.e]+", lambda n: repr(change(float(n[0]))), m[2]), text)
    return {"calibration.yaml": lambda lines: [changed("".join(lines))]}


def half(focal_length):
    return focal_length / 2


def exchanged(one, other):
    """Each camera has the images of the other."""
    return {f"{name}.txt": lambda lines, to=to: [re.sub(r"images2?/", f"{to}/", line) for line in lines]
            for name, to in ((one, other), (other, one))}


def events(change):
    """Their pixels; None leaves an event out."""
    def changed(lines):
        for t, x, y, p in map(str.split, lines):
            if pixel := change(int(x), int(y)):
                yield f"{t} {pixel[0]} {pixel[1]} {p}\n"
    return {"events.txt": changed}


def repeats(which, seconds):
    lengths = "|".join(f"{seconds - ms / 1000:.3f}" for ms in range(3))  # samples at either end
    return rf"IMU samples that repeat a reading: {which} for ({lengths}) s from {{at}}\d+ s"


LENS, MOUNTING = "it agrees with the gyro only with another lens:", "rotation (to|of)|mounted|off the calibration"
ONE_AT = r"the first at {at}\d+ s"
ROWS = {
    "clean": Row({}, "none", run=0),
    "gyro_repeats_50_ms": Row(held(GYRO, 0.05), "warning", repeats("gyro", 0.05), "driver repeats"),
    "gyro_repeats_200_ms": Row(held(GYRO, 0.2), "warning", repeats("gyro", 0.2), "driver repeats", run=0),
    "gyro_repeats_600_ms": Row(held(GYRO, 0.6), "error", repeats("gyro", 0.6), "driver repeats", doctor=3, run=5),
    "gyro_repeats_999_ms": Row(held(GYRO, 0.999), "error", repeats("gyro", 0.999), "driver repeats", doctor=3, run=5),
    "gyro_axis_repeats": Row(held(GYRO[:1], 0.999), "error", repeats("gyro's x axis", 0.999), "driver repeats", doctor=3),
    "imu_repeats_600_ms": Row(held(GYRO + ACCEL, 0.6), "error", repeats("gyro and accelerometer", 0.6), "driver repeats", doctor=3),
    "imu_repeats_999_ms": Row(held(GYRO + ACCEL, 0.999), "error", repeats("gyro and accelerometer", 0.999), "driver repeats", doctor=3, run=5),
    "accelerometer_repeats": Row(held(ACCEL, 0.999), "error", repeats("accelerometer", 0.999), "driver repeats", doctor=3, run=5),
    "gyro_zero": Row(held(GYRO, 1.0, 0.0), "error", repeats("gyro", 1.0), "driver repeats", doctor=3, run=5),
    "gyro_clipped": Row(imu(clipped), "error", "IMU samples at the end of the range: gyro", "larger range", doctor=3, run=5),
    "one_sample_of_5000_rad_s": Row(one_reading(4, 5000.0), "warning", "1 IMU samples beyond what .*: " + ONE_AT, "driver or the cable"),
    "one_sample_of_1e4_m_s2": Row(one_reading(1, 1e4), "warning", "1 IMU samples beyond what .*: " + ONE_AT, "driver or the cable"),
    "one_sample_of_1e300": Row(one_reading(4, 1e300), "warning", "1 IMU samples beyond what .*: " + ONE_AT, "driver or the cable", run=0),
    "spikes": Row(imu(spikes), "warning", r"(3\d|40) IMU samples far from both neighbours: the first at \d", "driver or the cable", run=0),
    "bursts_of_3": Row(bursts(3), "warning", r"\d+ IMU samples with equal stamps, spread evenly", "stamp each sample", run=0),
    "bursts_of_5": Row(bursts(5), "warning", r"\d+ IMU samples with equal stamps, spread evenly", "stamp each sample"),
    "bursts_of_20": Row(bursts(20), "warning", r"\d+ IMU samples with equal stamps, spread evenly", "stamp each sample", run=0),
    "imu_late": Row(imu(lambda rows, _: [[row[0] + 0.15, *row[1:]] for row in rows]), "error",
                    r"camera frames: t_imu = t_cam \+15\d\.\d ms", r"set time_offset of this camera to 0\.15", doctor=3, run=5, never="rotation (to|of)|truth"),
    "accelerometer_turned": Row(imu(lambda rows, _: [[row[0], -row[2], row[1], *row[3:]] for row in rows]), "error",
                                "accelerometer: gravity does not rotate in its axes", r"\(y, -x, z\) would fit", doctor=3, run=5),
    "accelerometer_4_percent": Row(imu(lambda rows, _: [[row[0], *(1.04 * v for v in row[1:4]), *row[4:]] for row in rows]), "warning",
                                   r"accelerometer: it reads 10\.\d\d m/s\^2 at rest", "calibrate it at rest in six attitudes"),
    "noise_too_large": Row(calibration(r"((?:gyro|accel)_noise: )(\S+)", lambda n: 1000 * n), "error",
                           r"gyro: calibrated noise of 0\.12 .* 0\.0001\d* at rest", "density", doctor=3, run=5, never="scale"),
    "noise_too_small": Row(calibration(r"((?:gyro|accel)_noise: )(\S+)", lambda n: n / 1000), "warning",
                           r"accelerometer: calibrated noise of 4e-06 .* 0\.00\d* at rest", "density", run=0),
    "focal_length_halved": Row(calibration(r"(intrinsics: \[)([\d.]+, [\d.]+)", half), "error", f"camera frames: {LENS} a focal length near 199 px",
                               "calibration of this lens", doctor=3, run=5, never=MOUNTING),
    "focal_length_doubled": Row(calibration(r"(intrinsics: \[)([\d.]+, [\d.]+)", lambda n: 2 * n), "error", f"camera frames: {LENS} a focal length near 199 px",
                                "calibration of this lens", doctor=3, run=5, never=MOUNTING),
    "radtan_as_equidistant": Row({"calibration.yaml": lambda lines: ["".join(lines).replace("radtan", "equidistant").replace(", 0]\n    T", "]\n    T")]},
                                 "error", f"camera frames: ({LENS} its coefficients fit as radtan|differs from the calibration by k1)",
                                 "calibration of this lens", doctor=3, run=5, never=MOUNTING),
    "images_thrice": Row({"images.txt": lambda lines: [f"{float(t) + k:.6f} {name}\n" for t, name in map(str.split, lines)
                                                       for k in (0, 0.01, 0.02)]}, "warning", r"6\d % of the frames repeat the image before", "remove the repeated ones", run=0),
    "truth_frozen": Row(truth(frozen), "warning", r"ground truth: the same pose for 0\.99\d s from {at}", "remove the wrong poses", run=0, never="covariance"),
    "truth_flipped": Row(truth(flipped), "warning", r"ground truth: 2 jumps, the first at 3\.500 s by 0\.2\d m and 180 deg", "remove the wrong poses", run=0),
    "truth_zero": Row(truth(zero), "warning", r"ground truth: the same pose for 0\.99\d s from {at}", "remove the wrong poses", run=0),
    "truth_in_millimetres": Row(truth(millimetres), "warning", r"ground truth: 2 jumps, the first at {at}", "remove the wrong poses", run=0),
    "events_halved": Row(events(lambda x, y: (x // 2, y // 2)), "error", "calibrated for 240 x 180 px, recorded 120 x 90 only", "resolution", doctor=3, run=5, never="frames:", mode="fused"),
    "events_of_a_region": Row(events(lambda x, y: (x - 60, y - 45) if 60 <= x < 180 and 45 <= y < 135 else None), "error",
                              "calibrated for 240 x 180 px, recorded 120 x 90 only", "resolution", doctor=3, run=5, never="frames:", mode="fused"),
    "events_moved": Row(events(lambda x, y: (x - 20, y - 10) if x >= 20 and y >= 10 else None), "error", "events: they match the edges of the frames only if", "driver or the converter", doctor=3, run=5, mode="fused"),
    "events_upside_down": Row(events(lambda x, y: (239 - x, 179 - y)), "error", "events: they match the edges of the frames only if turned by 180 deg", "driver or the converter", doctor=3, run=5, mode="fused"),
    "events_reflected": Row(events(lambda x, y: (239 - x, y)), "error", "events: they match the edges of the frames only if mirrored left to right", "driver or the converter", doctor=3, run=5, mode="fused"),
    "imu_reversed": Row(imu(lambda rows, _: rows[::-1]), "refused", "imu.txt:.* stamp goes back in time", "repair or replace the file", doctor=3, run=3),
    "all_silent_200_ms": Row(silence(0.2), "warning", r"1 IMU gaps of 0\.20\d s together, .* at {at}", "USB bus", run=0),
    "all_silent_500_ms": Row(silence(0.49), "warning", r"1 IMU gaps of 0\.49\d s together, .* at {at}", "USB bus"),
    "all_silent_900_ms": Row(silence(0.9), "error", r"1 IMU gaps of 0\.90\d s together, .* at {at}", "USB bus", doctor=3, run=5),
}


ROWS_OF_TWO = {
    "two_clean": Row({}, "none", run=0),
    "two_exchanged": Row(exchanged("images", "images2"), "error", "cameras frames and frames2: their images match only if exchanged", "exchange their topics", doctor=3, run=5,
                         never="rig|differs|covariance"),
    "two_clean_by_events": Row({"events.txt": "events.txt", "events2.txt": "events2.txt"}, "none", run=0, mode="events"),
    "two_exchanged_by_events": Row({"events.txt": "events2.txt", "events2.txt": "events.txt"}, "error",
                                   "cameras events and events2: their images match only if exchanged", "exchange their topics", doctor=3, run=5,
                                   never="rig|differs|covariance", mode="events"),
}


ROWS_OF_A_FISHEYE = {
    "fisheye_clean": Row({}, "none", run=0),
    "equidistant_as_radtan": Row({"calibration.yaml": lambda lines: ["".join(lines).replace("equidistant", "radtan")]}, "error",
                                 f"camera frames: {LENS} its coefficients fit as equidistant", "calibration of this lens", doctor=3, run=5, never=MOUNTING),
}


class Disturbed(WithFlight):
    SIMULATION = ("--duration", 6, "--seed", 2)

    def disturbed(self, row):
        """The recording by links, but for the files that change; without events where these stay as they are."""
        copy = self.folder / "disturbed"
        copy.mkdir()
        for file in self.flight.iterdir():
            if isinstance(other := row.changes.get(file.name), str):
                os.symlink(self.flight / other, copy / file.name)
            elif file.name in row.changes:
                (copy / file.name).write_text("".join(row.changes[file.name](file.read_text().splitlines(True))))
            elif not file.name.startswith("events"):
                os.symlink(file, copy / file.name)
        return copy

    def assert_named(self, row, result, code, findings_of):
        self.assertEqual(result.returncode, code, result.stdout + result.stderr)
        if row.severity == "refused":
            return self.assertRegex(result.stderr, f"{row.says}.*{row.remedy}")
        begin_s = AT + float((self.flight / "imu.txt").read_text().split(maxsplit=1)[0])
        says = row.says.format(at=re.escape(f"{begin_s:.2f}"[:-1]))
        bad = [f for f in findings_of(json.loads(result.stdout)) if f["severity"] in ("warning", "error")]
        self.assertEqual(bad[0]["severity"] if bad else "none", row.severity, bad)
        self.assertFalse([f for f in bad if re.search(row.never, f["text"])], bad)
        if bad:
            named = [f for f in bad if re.search(says, f["text"]) and re.search(row.remedy, f["remedy"])]
            self.assertTrue(named, f"{says}: {bad}")

    def check(self, row):
        recording = self.disturbed(row)
        self.assert_named(row, edged("doctor", recording, "--json", "--quiet"), row.doctor, lambda findings: findings)
        if row.run is not None:
            result = edged("run", recording, "--mode", row.mode, "--out", self.folder / "run", "--json", "--quiet")
            self.assert_named(row, result, row.run, lambda metrics: metrics["findings"])
            if row.severity != "refused":
                self.assertEqual(json.loads(result.stdout)["trusted"], row.run == 0)


class Disturbances(Disturbed):
    pass


class DisturbancesOfTwoCameras(Disturbed):
    SIMULATION = (*Disturbed.SIMULATION, "--baseline", 0.1)


class DisturbancesOfAFisheye(Disturbed):
    SIMULATION = (*Disturbed.SIMULATION, "--preset", "fisheye")


def add_tests(of_class, rows):
    for name, of_table in rows.items():
        setattr(of_class, f"test_{name}", lambda self, row=of_table: self.check(row))


add_tests(Disturbances, ROWS)
add_tests(DisturbancesOfTwoCameras, ROWS_OF_TWO)
add_tests(DisturbancesOfAFisheye, ROWS_OF_A_FISHEYE)

if __name__ == "__main__":
    unittest.main(verbosity=2)
