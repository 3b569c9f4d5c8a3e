#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""tools/long_tests.py warns of long tests without a reason, before the summary, and changes nothing else."""
import pathlib
import subprocess
import time
import unittest

TOOL = pathlib.Path(__file__).resolve().parents[2] / "tools" / "long_tests.py"
OUTPUT = """      Start   1: Lie.IsRight
 1/3 Test   #1: Lie.IsRight ......................   Passed   19.90 sec
 2/3 Test  #20: Stress.PureRotationStaysGood .....   Passed   55.00 sec
 3/3 Test   #3: Lie.{} ..............***Failed   21.04 sec

99% tests passed, 1 tests failed out of 3
Total Test time (real) =  96.00 sec
"""


class LongTests(unittest.TestCase):
    def lines_of(self, name, *options):
        text = OUTPUT.format(name)
        made = subprocess.run([TOOL, *options], input=text, capture_output=True, text=True, check=True).stdout
        return text.splitlines(), made.splitlines()

    def test_a_long_test_without_a_reason_is_named_before_the_summary(self):
        given, made = self.lines_of("Dawdles")
        warning = [line for line in made if line.startswith("warning: ")]
        self.assertEqual(len(warning), 1)
        self.assertIn("Lie.Dawdles took 21 s", warning[0])
        self.assertEqual(made, given[:-2] + warning + given[-2:])

    def test_results_get_the_time_since_the_begin(self):
        given, made = self.lines_of("Dawdles", "--since", str(time.time() - 121), "--no-warnings")
        self.assertEqual(made, [line + "  [2 min]" if "/3 Test" in line else line for line in given])


if __name__ == "__main__":
    unittest.main()
