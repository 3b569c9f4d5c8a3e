# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""ros2 launch edged edged.launch.py rig:=head.yaml events:=/event_camera/events image:=/camera/image_raw imu:=/imu/data"""
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.conditions import IfCondition
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.substitutions import FindPackageShare

ARGUMENTS = {  # name: default (None: it must be given), what it is
    "rig": (None, "a rig that ships, or a calibration file"),
    "mode": ("fused", "events, frames or fused"),
    "events": ("events", "topic"),
    "image": ("image", "topic"),
    "imu": ("imu", "topic"),
    "base_frame": ("", "frame of the robot, e.g. base_link; empty: the IMU's"),
    "body_frame": ("body", "frame of the IMU"),
    "frame_prefix": ("", "in front of all names of frames"),
    "map_file": ("", "map of `edged run --save-map`, to relocalize in"),
    "config": ("", "YAML with further options, as of `edged ros2 --print-config`"),
    "namespace": ("", "of the node and its topics"),
    "rviz": ("false", "start rviz2, too"),
}
PARAMETERS = ("rig", "mode", "base_frame", "body_frame", "frame_prefix", "map_file")


def generate_launch_description():
    value = {name: LaunchConfiguration(name) for name in ARGUMENTS}
    declared = [DeclareLaunchArgument(name, description=what, **({} if default is None else {"default_value": default}))
                for name, (default, what) in ARGUMENTS.items()]
    node = Node(package="edged", executable="edged", name="edged", namespace=value["namespace"], output="screen",
                arguments=["ros2", "--config", value["config"]],
                parameters=[{name: value[name] for name in PARAMETERS}],
                remappings=[(topic, value[topic]) for topic in ("events", "image", "imu")])
    rviz = Node(package="rviz2", executable="rviz2", condition=IfCondition(value["rviz"]),
                arguments=["-d", PathJoinSubstitution([FindPackageShare("edged"), "rviz", "edged.rviz"])])
    return LaunchDescription([*declared, node, rviz])
