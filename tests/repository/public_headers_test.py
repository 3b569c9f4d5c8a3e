#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""What a user includes: every header of include/edged and toolbox/include/edged compiles by itself, with these two folders
alone, and brings no private one, no library but Eigen and OpenCV's core. They are what is installed.

Environment: EDGED_BUILD, a build folder; CXX.
"""
import functools
import json
import os
import pathlib
import re
import shlex
import subprocess
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(os.environ["EDGED_BUILD"])


FOLDERS = [SOURCE / "include", SOURCE / "toolbox" / "include"]


def include_flags():
    """Of the libraries as the sources of the pipeline are compiled, of ours the public ones."""
    for command in json.loads((BUILD / "compile_commands.json").read_text()):
        if "/edged_pipeline.dir/" in command["command"]:
            libraries = re.findall(r"-isystem *\S+", command["command"])
            return libraries + [f"-I{folder}" for folder in [*FOLDERS, BUILD / "include"]]
    raise AssertionError(f"{BUILD}/compile_commands.json has no source of the pipeline")


@functools.cache
def preprocess(header):
    """Compiles a file that includes it alone; all files that this reads."""
    command = [os.environ["CXX"], "-std=c++20", "-x", "c++", *shlex.split(" ".join(include_flags())), "-Wall", "-Wextra",
               "-Werror"]
    text = f'#include "edged/{header}"\n'
    done = subprocess.run([*command, "-fsyntax-only", "-MD", "-MF", "-", "-"], input=text, capture_output=True, text=True,
                          check=False)
    if done.returncode != 0:
        raise AssertionError(f"edged/{header} does not compile by itself:\n{done.stderr}")
    return done.stdout.replace("\\\n", " ").split()[1:]


def public_headers(folder):
    return sorted(str(p.relative_to(folder / "edged")).removesuffix(".in") for p in folder.rglob("*.hpp*"))


class PublicHeaders(unittest.TestCase):
    def test_each_compiles_by_itself_and_brings_eigen_and_opencv_core_alone(self):
        headers = [header for folder in FOLDERS for header in public_headers(folder)]
        self.assertLessEqual({"odometry.hpp", "io/calibration.hpp", "sim/simulator.hpp"}, set(headers))
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

    def test_the_method_needs_none_of_the_toolbox(self):
        for header in public_headers(FOLDERS[0]):
            self.assertNotRegex("\n".join(preprocess(header)), r"/toolbox/", header)


if __name__ == "__main__":
    unittest.main()
