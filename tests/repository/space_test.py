#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""Twenty draws of bench/space, fused: no more of them fail than when these limits were set.
Usage: EDGED=path/to/edged space_test.py"""
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

SPACE = pathlib.Path(__file__).resolve().parents[2] / "bench" / "space"
SEED, DRAWS = 1000, 20
# The most draws of each class: what was counted, and one.
LIMITS = {"never good": 4, "late": 2, "lost": 1, "silent": 3, "scale": 2, "crashed": 0}


class Space(unittest.TestCase):
    def test_no_more_draws_fail_than_before(self):
        with tempfile.TemporaryDirectory(prefix="edged_space_test_") as folder:
            file = pathlib.Path(folder) / "draws.jsonl"
            done = subprocess.run([sys.executable, SPACE, "--seed", str(SEED), "--draws", str(DRAWS), "--modes", "fused",
                                   "--json", file], capture_output=True, text=True, check=False)
            self.assertEqual(done.returncode, 0, done.stderr)
            draws = [json.loads(line) for line in file.read_text().splitlines()]
        self.assertEqual(len(draws), DRAWS)
        for name, most in LIMITS.items():
            failed = sorted(draw["draw"] for draw in draws if name in draw["runs"]["fused"]["classes"])
            with self.subTest(failure=name):
                self.assertLessEqual(len(failed), most, f"draws {failed} of bench/space --seed {SEED}")


if __name__ == "__main__":
    unittest.main()
