#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""What is installed serves others: tests/consumer is built against it after it has been moved.

Environment: EDGED_BUILD, the build folder that is installed; CMAKE, CXX, PYTHON.
"""
import json
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[2]
CONSUMER = SOURCE / "tests" / "consumer"
TUTORIAL = SOURCE / "docs" / "tutorial.md"


def call(*command, **options):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, check=False, **options)
    if done.returncode != 0:
        raise AssertionError(f"{' '.join(map(str, command))}: exit code {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout


class Installed(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp(prefix="edged_install_"))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        first = cls.folder / "first"
        call(os.environ["CMAKE"], "--install", os.environ["EDGED_BUILD"], "--prefix", first)
        cls.prefix = cls.folder / "moved"
        first.rename(cls.prefix)
        # Only what is installed counts: not what this test was started with.
        cls.environment = {key: value for key, value in os.environ.items() if not key.startswith("EDGED_")}

    def test_the_program_runs_where_it_has_been_moved(self):
        edged = self.prefix / "bin" / "edged"
        self.assertIn("edged ", call(edged, "--version", env=self.environment))
        self.assertIn("small.onnx", call(edged, "depth", "--json", env=self.environment))
        flight = self.folder / "flight"
        call(edged, "simulate", "--duration", "1", "--out", flight, "--quiet", env=self.environment)
        self.assertIn("events", call(edged, "info", flight, "--rig", "davis240c_ecd", env=self.environment))

    def test_python_imports_it_where_it_has_been_moved(self):
        module = next(self.prefix.rglob("edged/__init__.py"), None)
        if module is None:
            self.skipTest("EDGED_PYTHON is off")
        told = call(os.environ["PYTHON"], "-B", "-c", "import edged; print(sum(1 for _ in edged.simulate(duration_s=0.1)) > 10)",
                    env={**self.environment, "PYTHONPATH": str(module.parent.parent)}, cwd=self.folder)
        self.assertEqual(told, "True\n")

    def test_where_the_module_of_python_was_not_built_the_rest_is_installed(self):
        script = pathlib.Path(os.environ["EDGED_BUILD"]) / "python" / "cmake_install.cmake"
        if not script.exists():
            self.skipTest("EDGED_PYTHON is off")
        without, prefix = self.folder / "without.cmake", self.folder / "without"
        without.write_text(re.sub(r"/_edged\.[^\"]*", "/not_built.so", script.read_text()))
        call(os.environ["CMAKE"], f"-DCMAKE_INSTALL_PREFIX={prefix}", "-P", without)
        self.assertFalse(prefix.exists())

    def test_nothing_points_back_to_the_sources(self):
        for file in sorted(path for path in self.prefix.rglob("*") if path.is_file()):
            for place in (SOURCE, pathlib.Path(os.environ["EDGED_BUILD"]).resolve()):
                self.assertNotIn(str(place).encode() + b"/", file.read_bytes(), file)

    def test_the_headers_are_the_public_ones(self):
        folders = (SOURCE / "include", SOURCE / "toolbox" / "include")
        public = {str(p.relative_to(f)).removesuffix(".in") for f in folders for p in f.rglob("*.hpp*")}
        include = self.prefix / "include"
        self.assertEqual({str(p.relative_to(include)) for p in include.rglob("*.hpp")}, public)

    def test_a_project_finds_links_and_runs_it(self):
        build = self.folder / "build"
        call(os.environ["CMAKE"], "-S", CONSUMER, "-B", build, f"-DCMAKE_PREFIX_PATH={self.prefix}", "-G", "Ninja",
             f"-DCMAKE_CXX_COMPILER={os.environ['CXX']}", env=self.environment)
        call(os.environ["CMAKE"], "--build", build, env=self.environment)
        # The library itself prints nothing, although it starts on the way.
        self.assertRegex(call(build / "sensors", env=self.environment), r"^waiting for: .*\n[0-9]+ steps\n$")
        # A program elsewhere is told where rigs are.
        rigs = {**self.environment, "EDGED_RIGS": str(self.prefix / "share" / "edged" / "rigs"),
                "EDGED_PRESETS": str(self.prefix / "share" / "edged" / "presets")}
        told = call(build / "fly", env=rigs)
        self.assertIn("Good, ", told)
        self.assertNotIn(" 0 rigs", told)
        # The poses it gets are those of the program, by the errors to the last printed digit.
        edged, flight, run = self.prefix / "bin" / "edged", self.folder / "seen", self.folder / "run"
        call(edged, "simulate", "--duration", "3", "--out", flight, "--quiet", env=self.environment)
        summary = json.loads(call(edged, "run", flight, "--mode", "frames", "--out", run, "--quiet", "--json", env=self.environment))
        (run / "poses.tum").write_text(call(build / "poses", flight, env=rigs))
        errors = [call(edged, "eval", flight / "groundtruth.txt", run / file, env=self.environment).partition("alignment")[2]
                  for file in ("trajectory.tum", "poses.tum")]
        self.assertEqual(errors[0].rpartition("next")[0], errors[1].rpartition("next")[0])
        self.assertRegex(errors[1], rf"ATE position +{1e3 * summary['ate_rmse_m']:.4f} ")

    def test_the_tutorial_builds_and_runs_as_it_stands(self):
        text, project = TUTORIAL.read_text(), self.folder / "tutorial"
        project.mkdir()
        for language, file in (("cmake", "CMakeLists.txt"), ("cpp", "my_robot.cpp"), ("yaml", "my_head.yaml")):
            listings = re.findall(rf"```{language}\n(.*?)```", text, re.DOTALL)
            self.assertTrue(listings, language)
            (project / file).write_text("\n".join(listings))
        build = project / "build"
        call(os.environ["CMAKE"], "-S", project, "-B", build, f"-DCMAKE_PREFIX_PATH={self.prefix}", "-G", "Ninja",
             f"-DCMAKE_CXX_COMPILER={os.environ['CXX']}", "-DCMAKE_CXX_FLAGS=-Wall -Wextra -Werror", env=self.environment)
        call(os.environ["CMAKE"], "--build", build, env=self.environment)
        told = call(build / "my_robot", env=self.environment, cwd=project)
        self.assertRegex(told, r"no pose: \w+")
        self.assertRegex(told, r" m/s  Good\nlens at .*, 0 events came too late\n$")

    def test_a_project_takes_it_in_as_sources(self):
        # Configured only: to build the whole method once more would take minutes.
        build = self.folder / "subdirectory"
        call(os.environ["CMAKE"], "-S", CONSUMER, "-B", build, f"-DEDGED_SOURCES={SOURCE}", "-G", "Ninja",
             f"-DCMAKE_CXX_COMPILER={os.environ['CXX']}", env=self.environment)
        targets = call(os.environ["CMAKE"], "--build", build, "--target", "help", env=self.environment)
        self.assertRegex(targets, r"(?m)^libedged_pipeline\.a:")
        self.assertNotRegex(targets, r"(?m)^edged_\w+_test:", "ours alone")

    def test_a_component_that_is_not_there_is_named(self):
        project = self.folder / "wants_more"
        project.mkdir()
        (project / "CMakeLists.txt").write_text("cmake_minimum_required(VERSION 3.25)\nproject(p LANGUAGES CXX)\n"
                                                "find_package(edged REQUIRED COMPONENTS telepathy)\n")
        def configure(folder):
            shutil.rmtree(project / "build", ignore_errors=True)
            call(os.environ["CMAKE"], "-S", project, "-B", project / "build", f"-Dedged_DIR={folder}",
                 f"-DCMAKE_CXX_COMPILER={os.environ['CXX']}", env=self.environment)
        with self.assertRaisesRegex(AssertionError, r"has no component 'telepathy'; there\s+is one, 'toolbox'"):
            configure(next(self.prefix.glob("lib*/**/edgedConfig.cmake")).parent)
        with self.assertRaisesRegex(AssertionError, r"is where edged is built, not\s+installed"):
            configure(os.environ["EDGED_BUILD"])

    def test_a_toolbox_that_was_not_asked_for_is_explained(self):
        project = self.folder / "without_component"
        project.mkdir()
        (project / "CMakeLists.txt").write_text(
            "cmake_minimum_required(VERSION 3.22)\nproject(p LANGUAGES CXX)\nfind_package(edged REQUIRED)\n"
            "add_library(p INTERFACE)\ntarget_link_libraries(p INTERFACE edged::edged)\n")
        told = call(os.environ["CMAKE"], "-S", project, "-B", project / "build", f"-DCMAKE_PREFIX_PATH={self.prefix}",
                    f"-DCMAKE_CXX_COMPILER={os.environ['CXX']}", env=self.environment)
        self.assertIn("edged::toolbox needs find_package(edged COMPONENTS toolbox)", told)


if __name__ == "__main__":
    unittest.main()
