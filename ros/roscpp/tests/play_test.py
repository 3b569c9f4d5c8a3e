#!/usr/bin/python3
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""A mirror as a bag, played in real time to the node as the launch file starts it: what comes in, what comes out, how
near it is to the truth, how it ends. Wants $EDGED, $ROS_PACKAGE_PATH, $EDGED_SOURCE_DIR, and the recordings (else 77).
"""
import json
import os
import pathlib
import signal
import socket
import subprocess
import sys
import tarfile
import tempfile
import time
import unittest
import xmlrpc.client

import rosbag

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "tests/program"))
from program import ate_m, output_of  # noqa: E402

NAME = "mirror_poster"
RIG = "davis240c_ecd"
INPUTS = {"/dvs/events": 0, "/camera/image_raw": 0, "/imu/data": 0}
OUTPUTS = ["/edged/odometry", "/edged/prediction", "/edged/pose", "/edged/path", "/edged/landmarks",
           "/edged/tracks/frames", "/edged/tracks/events", "/tf", "/tf_static", "/diagnostics"]
SOURCE = pathlib.Path(os.environ["EDGED_SOURCE_DIR"])
ARCHIVE = pathlib.Path(os.environ.get("EDGED_DATA", SOURCE.parent / "shared" / "data")) / "mirror" / (NAME + ".tar.xz")
if not ARCHIVE.exists():
    print(f"no data: {ARCHIVE}")
    sys.exit(77)


def free_port():
    with socket.socket() as s:
        s.bind(("localhost", 0))
        return s.getsockname()[1]


def wait_for(what, condition, timeout_s=60):
    end = time.monotonic() + timeout_s
    while not condition():
        assert time.monotonic() < end, f"waited {timeout_s} s for {what}"
        time.sleep(0.1)


class Session:
    """A master, the node from its launch file, and a recorder of what it publishes; one run of the bag."""

    def __init__(self, folder):
        self.folder = folder
        port = free_port()
        self.environment = dict(os.environ, ROS_MASTER_URI=f"http://localhost:{port}", ROS_HOSTNAME="localhost",
                                ROS_HOME=str(folder / "home"), ROS_LOG_DIR=str(folder / "log"))
        self.environment["ROS_PACKAGE_PATH"] += ":/usr/share"
        self.master = xmlrpc.client.ServerProxy(f"http://localhost:{port}")
        self.core = self.start("core", "roscore", "-p", str(port))
        wait_for("the master", self.master_answers)
        self.launch = self.start("launch", "roslaunch", "edged_ros", "edged.launch", f"rig:={RIG}")
        self.recorder = self.start("record", "rosbag", "record", "-O", folder / "out.bag", *OUTPUTS, "__name:=recorder")
        wait_for("the node and the recorder", lambda: self.subscribed("/edged", INPUTS)
                 and self.subscribed("/recorder", OUTPUTS))

    def start(self, name, *command):
        with open(self.folder / f"{name}.txt", "w") as out:
            return subprocess.Popen([*map(str, command)], stdout=out, stderr=subprocess.STDOUT, env=self.environment)

    def text(self, name):
        return (self.folder / f"{name}.txt").read_text()

    def master_answers(self):
        try:
            return self.master.getPid("/test")[0] == 1
        except OSError:
            return False

    def subscribed(self, node, topics):
        _, _, (_, subscribers, _) = self.master.getSystemState("/test")
        return set(topics) <= {topic for topic, nodes in subscribers if node in nodes}

    def play(self, bag):
        """The player drops what its queues do not hold, unseen."""
        subprocess.run(["rosbag", "play", "--quiet", "--queue=100000", "--wait-for-subscribers", bag, "--topics", *INPUTS],
                       env=self.environment, check=True, stdout=subprocess.DEVNULL)
        time.sleep(3)

    def interrupt_node(self):
        _, _, uri = self.master.lookupNode("/test", "/edged")
        with xmlrpc.client.ServerProxy(uri) as node:
            _, _, pid = node.getPid("/test")
        os.kill(pid, signal.SIGINT)
        self.launch.wait(timeout=60)

    def end(self):
        for process in (self.recorder, self.launch, self.core):
            if process.poll() is None:
                process.send_signal(signal.SIGINT)
                process.wait(timeout=60)
        self.master("close")()


def write_tum(file, odometry):
    with open(file, "w") as out:
        for message in odometry:
            p, q = message.pose.pose.position, message.pose.pose.orientation
            print(f"{message.header.stamp.to_nsec() / 1e9:.9f}", p.x, p.y, p.z, q.x, q.y, q.z, q.w, file=out)


class PlayedMirror(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        temporary = tempfile.TemporaryDirectory(prefix="edged_ros1_")
        cls.addClassCleanup(temporary.cleanup)
        cls.folder = pathlib.Path(temporary.name)
        with tarfile.open(ARCHIVE) as archive:
            archive.extractall(cls.folder)
        recording, bag = cls.folder / NAME, cls.folder / "in.bag"
        cls.truth = recording / "groundtruth_body.txt"
        converted = output_of("convert", recording, bag)
        cls.events = int(converted.split(" events")[0].split()[-1])
        with rosbag.Bag(bag) as b:
            cls.sent = {topic: b.get_message_count(topic) for topic in INPUTS}
        output_of("run", bag, "--rig", RIG, "--frame", "body", "--quiet", "--out", cls.folder / "offline")
        cls.session = Session(cls.folder)
        cls.addClassCleanup(cls.session.end)
        cls.session.play(bag)
        cls.session.interrupt_node()
        cls.session.end()
        cls.published = {topic: [] for topic in OUTPUTS}
        with rosbag.Bag(cls.folder / "out.bag") as b:
            for topic, message, _ in b.read_messages():
                cls.published[topic].append(message)
        cls.health = cls.published["/diagnostics"][-1].status[0]
        cls.counts = {value.key: value.value for value in cls.health.values}
        print(json.dumps(cls.counts, indent=1), {topic: len(all) for topic, all in cls.published.items()})

    def test_everything_that_was_sent_is_accounted_for(self):
        for topic, count in self.sent.items():
            self.assertEqual(int(self.counts[f"{topic} messages"]), count)
            self.assertEqual(self.counts[f"{topic} messages unreadable"], "0")
        self.assertEqual(int(self.counts["/dvs/events events"]), self.events)
        for key in ("no room", "of an unknown camera", "impossible stamps", "events outside the image", "frames unfit",
                    "packets dropped, IMU away too long", "IMU samples not finite", "IMU samples late"):
            self.assertEqual(self.counts[key], "0", key)

    def test_odometry_is_as_near_to_the_truth_as_offline(self):
        offline = ate_m(self.truth, self.folder / "offline" / "trajectory.tum")
        for topic in ("/edged/pose", "/edged/odometry", "/edged/prediction"):
            file = self.folder / "online.tum"
            write_tum(file, self.published[topic])
            online = ate_m(self.truth, file)
            print(f"ATE {topic} {1e3 * online:.2f} mm, offline {1e3 * offline:.2f} mm")
            self.assertLess(online, 1.5 * offline, topic)

    def test_poses_come_with_every_packet_and_every_imu_sample(self):
        odometry, prediction = self.published["/edged/odometry"], self.published["/edged/prediction"]
        self.assertGreater(len(odometry), 0.9 * int(self.counts["packets"]))
        self.assertGreater(len(prediction), 0.9 * self.sent["/imu/data"])
        self.assertEqual(len(self.published["/edged/pose"]), len(odometry))
        self.assertGreater(prediction[-1].header.stamp, odometry[0].header.stamp)
        self.assertGreater(odometry[-1].pose.covariance[0], 0)

    def test_frames_landmarks_images_and_path_fit_one_another(self):
        frames = {(t.header.frame_id, t.child_frame_id) for topic in ("/tf", "/tf_static")
                  for m in self.published[topic] for t in m.transforms}
        self.assertEqual(frames, {("map", "odom"), ("odom", "body"), ("body", "events"), ("body", "frames")})
        for topic in ("/edged/landmarks", "/edged/path"):
            self.assertEqual(self.published[topic][-1].header.frame_id, "map")
        self.assertGreater(self.published["/edged/landmarks"][-1].width, 10)
        self.assertGreater(len(self.published["/edged/path"][-1].poses), 100)
        for camera in ("events", "frames"):
            image = self.published[f"/edged/tracks/{camera}"][-1]
            self.assertEqual((image.header.frame_id, image.width, image.height), (camera, 240, 180))

    def test_node_says_that_it_is_good_and_ends_cleanly_when_interrupted(self):
        self.assertTrue(self.health.message.startswith("Good"), self.health.message)
        self.assertEqual(self.health.hardware_id, RIG)
        self.assertIn("[edged-1] process has finished cleanly", self.session.text("launch"))


if __name__ == "__main__":
    unittest.main(verbosity=2)
