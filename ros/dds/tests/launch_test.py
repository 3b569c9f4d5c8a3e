#!/usr/bin/python3
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""The launch file and what is installed for ROS 2, without ROS: Debian has no package of `launch`, so its classes are
replaced by such that keep their arguments, and the command that launch_ros makes of them is run.

Wants $EDGED and $EDGED_BUILD, the folder of the build.
"""
import importlib.util
import os
import pathlib
import subprocess
import sys
import tempfile
import types
import unittest
import xml.etree.ElementTree

EDGED = os.environ["EDGED"]
ROOT = pathlib.Path(__file__).resolve().parents[3]


class Kept:
    def __init__(self, *args, **named):
        self.args, self.named = args, named


def launched():
    """The description, with classes of launch that do nothing."""
    modules = {"launch": ("LaunchDescription",), "launch.actions": ("DeclareLaunchArgument",),
               "launch.conditions": ("IfCondition",), "launch.substitutions": ("LaunchConfiguration", "PathJoinSubstitution"),
               "launch_ros": (), "launch_ros.actions": ("Node",), "launch_ros.substitutions": ("FindPackageShare",)}
    for name, classes in modules.items():
        module = types.ModuleType(name)
        for kind in classes:
            setattr(module, kind, type(kind, (Kept,), {}))
        sys.modules[name] = module
    spec = importlib.util.spec_from_file_location("edged_launch", ROOT / "ros/dds/launch/edged.launch.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.generate_launch_description().args[0]


class Launch(unittest.TestCase):
    def command(self, folder, **given):
        """That of launch_ros.actions.Node: arguments, then those of ROS, parameters in a file."""
        *declared, node, _ = launched()
        values = {argument.args[0]: given.get(argument.args[0], argument.named.get("default_value")) for argument in declared}
        text = lambda value: values[value.args[0]] if isinstance(value, Kept) else value
        file = pathlib.Path(folder) / "launch_params.yaml"
        lines = [f"    {name}: '{text(value)}'" for name, value in node.named["parameters"][0].items()]
        file.write_text("\n".join(["/**:", "  ros__parameters:", *lines]) + "\n")
        remappings = [part for topic, to in node.named["remappings"] for part in ("-r", f"{topic}:={text(to)}")]
        return [EDGED, *map(text, node.named["arguments"]), "--ros-args", "-r", f"__node:={node.named['name']}",
                "--params-file", str(file), *remappings]

    def test_the_program_takes_the_command_of_the_launch_file(self):
        with tempfile.TemporaryDirectory() as folder:
            command = self.command(folder, rig="davis240c_ecd", mode="frames", imu="/imu/data", base_frame="base_link")
            done = subprocess.run([*command, "--print-config"], capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stderr)
            for line in ('rig: "davis240c_ecd" ', "mode: frames ", 'base_frame: "base_link" ', 'body_frame: "body" '):
                self.assertIn("\n" + line, "\n" + done.stdout)

    def test_what_is_not_given_and_has_no_default_is_the_rig_alone(self):
        *declared, _, _ = launched()
        self.assertEqual([one.args[0] for one in declared if "default_value" not in one.named], ["rig"])

    def test_the_package_is_found_where_it_is_installed(self):
        package = xml.etree.ElementTree.parse(ROOT / "package.xml").getroot()
        self.assertEqual((package.findtext("name"), package.findtext("export/build_type")), ("edged", "ament_cmake"))
        version = subprocess.run([EDGED, "--version"], capture_output=True, text=True, check=True).stdout.split()[1]
        self.assertEqual(package.findtext("version"), version)
        with tempfile.TemporaryDirectory() as prefix:
            subprocess.run(["cmake", "--install", os.environ["EDGED_BUILD"], "--prefix", prefix, "--component", "ros2"],
                           check=True, stdout=subprocess.DEVNULL)
            installed = {str(path.relative_to(prefix)) for path in pathlib.Path(prefix).rglob("*") if not path.is_dir()}
            self.assertLessEqual({"share/ament_index/resource_index/packages/edged", "share/edged/package.xml",
                                  "share/edged/launch/edged.launch.py", "share/edged/rviz/edged.rviz", "lib/edged/edged"}, installed)
            for shell in ("sh", "bash"):
                script = f". share/edged/local_setup.{shell}; . share/edged/local_setup.{shell}; echo $AMENT_PREFIX_PATH"
                found = subprocess.run([shell, "-uc", script], cwd=prefix, capture_output=True, text=True, check=True, env={
                    "AMENT_PREFIX_PATH": "/opt/ros/jazzy", "COLCON_CURRENT_PREFIX": prefix, "PATH": os.environ["PATH"]})
                self.assertEqual(found.stdout.strip(), f"{prefix}:/opt/ros/jazzy")  # once
            self.assertEqual(os.readlink(pathlib.Path(prefix) / "lib/edged/edged"), "../../bin/edged")


if __name__ == "__main__":
    unittest.main(verbosity=2)
