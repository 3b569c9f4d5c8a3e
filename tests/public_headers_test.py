#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""What a user includes: every header of include/edged compiles by itself, and brings none of src/, no library but Eigen and OpenCV's core.

Environment: EDGED_BUILD, a build folder; CXX.
"""
import json
import os
import pathlib
import re
import shlex
import subprocess
import unittest

SOURCE = pathlib.Path(__file__).resolve().parent.parent
BUILD = pathlib.Path(os.environ["EDGED_BUILD"])


def include_flags():
    """As the sources of the pipeline are compiled."""
    for command in json.loads((BUILD / "compile_commands.json").read_text()):
        if "/edged_pipeline.dir/" in command["command"]:
            return re.findall(r"-(?:I|isystem) *\S+", command["command"])
    raise AssertionError(f"{BUILD}/compile_commands.json has no source of the pipeline")


def preprocess(header):
    """Compiles a file that includes it alone; all files that this reads."""
    command = [os.environ["CXX"], "-std=c++20", "-x", "c++", *shlex.split(" ".join(include_flags())), "-Wall", "-Wextra",
               "-Werror"]
    text = f'#include "edged/{header}"\n'
    done = subprocess.run([*command, "-fsyntax-only", "-"], input=text, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise AssertionError(f"edged/{header} does not compile by itself:\n{done.stderr}")
    made = subprocess.run([*command, "-M", "-"], input=text, capture_output=True, text=True, check=True).stdout
    return made.replace("\\\n", " ").split()[1:]


class PublicHeaders(unittest.TestCase):
    def test_each_compiles_by_itself_and_brings_eigen_and_opencv_core_alone(self):
        include = SOURCE / "include" / "edged"
        headers = sorted(str(p.relative_to(include)).removesuffix(".in") for p in include.rglob("*.hpp*"))
        self.assertIn("odometry.hpp", headers)
        for header in headers:
            with self.subTest(header):
                files = preprocess(header)
                ours = [f for f in files if re.search(r"/edged/[^ ]*\.hpp$", f)]
                self.assertGreaterEqual(len(ours), 1)
                self.assertEqual([f for f in ours if "/include/edged/" not in f], [], "private headers")
                foreign = [f for f in files if re.search(r"/(ceres|opengv|yaml-cpp|spdlog|fmt|nlohmann|glog)/", f)]
                self.assertEqual(foreign, [])
                beyond = [f for f in files if "/opencv2/" in f and not re.search(r"/opencv2/(core/|opencv_modules)", f)]
                self.assertEqual(beyond, [], "of OpenCV more than core")


if __name__ == "__main__":
    unittest.main()
