# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""What the tests of the program as a user meets it share: calls of $EDGED, folders that go away, a simulated flight."""
import json
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest

EDGED = os.environ["EDGED"]

# The transform of the first camera in our own format; the second is behind the same lens.
TRANSFORM = re.compile(r"(?: +- \[[^\]]*\]\n){3} +- \[0, 0, 0, 1\]")


def edged(*args, cwd=None):
    return subprocess.run([EDGED, *map(str, args)], capture_output=True, text=True, cwd=cwd, check=False, timeout=300)


def output_of(*args, codes=(0,)):
    """What it prints, if it ends with one of these exit codes."""
    done = edged(*args)
    assert done.returncode in codes, done.stderr
    return done.stdout


def ate_m(truth, trajectory):
    return json.loads(output_of("eval", truth, trajectory, "--json"))["ate_rmse_m"]


class WithFolder(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="edged_cli_"))
        self.addCleanup(shutil.rmtree, self.folder)

    def assert_refused(self, result, *words, code=3):
        """One line on stderr that holds the words, and the exit code."""
        self.assertEqual(result.returncode, code, result.stderr)
        self.assertEqual(len(result.stderr.strip().splitlines()), 1, result.stderr)
        for word in words:
            self.assertIn(word, result.stderr)


class WithFlight(WithFolder):
    """One short simulated flight for all tests of the class."""
    SIMULATION = ("--duration", 5, "--seed", 2)

    @classmethod
    def setUpClass(cls):
        shared = pathlib.Path(tempfile.mkdtemp(prefix="edged_cli_"))
        cls.addClassCleanup(shutil.rmtree, shared)
        cls.flight = shared / "flight"
        made = edged("simulate", *cls.SIMULATION, "--out", cls.flight, "--json", "--quiet")
        assert made.returncode == 0, made.stderr
        cls.simulated = json.loads(made.stdout)

    def changed(self, name, change):
        """The recording with one of its files changed."""
        copy = self.folder / "changed"
        shutil.rmtree(copy, ignore_errors=True)
        shutil.copytree(self.flight, copy)
        (copy / name).write_text(change((copy / name).read_text()))
        return copy


def with_transform(change):
    """Changes the rows of T_B_C in the text of a calibration."""
    def replaced(match):
        rows = [[float(v) for v in line[line.index("[") + 1:line.index("]")].split(",")]
                for line in match.group(0).splitlines()]
        return "\n".join(f"      - [{', '.join(map(str, row))}]" for row in change(rows))
    return lambda text: TRANSFORM.sub(replaced, text)


def with_imu(change):
    """change(t, accel, gyro) of every line of imu.txt."""
    def line(text):
        t, *v = map(float, text.split())
        t, accel, gyro = change(t, v[:3], v[3:])
        return " ".join([f"{t:.9f}", *map(repr, accel + gyro)])
    return lambda text: "\n".join(map(line, text.splitlines())) + "\n"
