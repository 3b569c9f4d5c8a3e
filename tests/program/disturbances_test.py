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
    changes: dict[str, typing.Callable]  # file: its lines from those of the recording
    severity: str  # of the first finding above a note; "none"; "refused": by the reader
    says: str = "."
    remedy: str = ""
    doctor: int = 0  # exit code
    run: int | None = None  # exit code; None: `doctor` alone is asked
    never: str = "camera"  # what neither may say, as it is a consequence


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


def repeats(which, seconds):
    lengths = "|".join(f"{seconds - ms / 1000:.3f}" for ms in range(3))  # samples at either end
    return rf"IMU samples that repeat a reading: {which} for ({lengths}) s from {{at}}\d+ s"


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
    "bursts_of_3": Row(bursts(3), "warning", r"\d+ IMU samples of one stamp, spread evenly", "stamp each sample", run=0),
    "bursts_of_5": Row(bursts(5), "warning", r"\d+ IMU samples of one stamp, spread evenly", "stamp each sample"),
    "bursts_of_20": Row(bursts(20), "warning", r"\d+ IMU samples of one stamp, spread evenly", "stamp each sample", run=0),
    "imu_reversed": Row(imu(lambda rows, _: rows[::-1]), "refused", "imu.txt:.* stamp goes back in time", "mend or replace the file", doctor=3, run=3),
    "all_silent_200_ms": Row(silence(0.2), "warning", r"1 IMU gaps of 0\.20\d s together, .* at {at}", "USB bus", run=0),
    "all_silent_500_ms": Row(silence(0.49), "warning", r"1 IMU gaps of 0\.49\d s together, .* at {at}", "USB bus"),
    "all_silent_900_ms": Row(silence(0.9), "error", r"1 IMU gaps of 0\.90\d s together, .* at {at}", "USB bus", doctor=3, run=5),
}


class Disturbances(WithFlight):
    SIMULATION = ("--duration", 6, "--seed", 2)

    def disturbed(self, row):
        """The recording by links, but for the files that change; without events where these stay as they are."""
        copy = self.folder / "disturbed"
        copy.mkdir()
        for file in self.flight.iterdir():
            if file.name in row.changes:
                (copy / file.name).write_text("".join(row.changes[file.name](file.read_text().splitlines(True))))
            elif file.name != "events.txt":
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
            result = edged("run", recording, "--mode", "frames", "--out", self.folder / "run", "--json", "--quiet")
            self.assert_named(row, result, row.run, lambda metrics: metrics["findings"])


for name, of_table in ROWS.items():
    setattr(Disturbances, f"test_{name}", lambda self, row=of_table: self.check(row))

if __name__ == "__main__":
    unittest.main(verbosity=2)
