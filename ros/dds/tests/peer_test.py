#!/usr/bin/python3
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""`edged ros2` beside a driver and a subscriber on Fast DDS (peer.cpp), over the loopback interface: what arrives, how
near it is to the offline result, late and killed peers, several nodes and domains, loss, QoS that does not fit.

Wants $EDGED and $EDGED_ROS2_PEER.
"""
import itertools
import json
import math
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "tests/program"))
from program import EDGED, ate_m, output_of  # noqa: E402

PEER = os.environ["EDGED_ROS2_PEER"]
SECONDS = 4


def edged(*args):
    return output_of(*args, codes=(0, 5))


def poses(file):
    """{stamp in whole microseconds: numbers}"""
    rows = [line.split() for line in pathlib.Path(file).read_text().splitlines() if not line.startswith("#")]
    return {round(1e6 * float(row[0])): [float(x) for x in row[1:8]] for row in rows}


def largest_difference(a, b):
    """Of positions [m] and quaternions, which may have either sign."""
    return max(max(abs(x - y) for x, y in zip(p, q)) for t, p in a.items() if t in b for q in [closest(p, b[t])])


def closest(pose, other):
    same = sum(x * y for x, y in zip(pose[3:], other[3:])) > 0
    return other if same else other[:3] + [-x for x in other[3:]]


def transformed(pose, point):
    """The point [m] of a frame with that pose."""
    (x, y, z), q, w = pose[:3], pose[3:6], pose[6]
    cross = lambda a, b: [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    turned = [2 * c for c in cross(q, point)]
    return [a + b + w * c + d for a, b, c, d in zip((x, y, z), point, turned, cross(q, turned))]


class Node:
    """`edged ros2`; nothing is shed while a loaded machine is slow."""

    def __init__(self, test, *args, domain=None, name="edged"):
        env = dict(os.environ, ROS_DOMAIN_ID=str(domain or test.domain))
        self.error = open(test.folder / f"{name}.err", "w+")
        self.process = subprocess.Popen(
            [EDGED, "ros2", "--rig", test.recording / "calibration.yaml", "--node", name, "--set", "max_age_s=3600",
             *map(str, args)], stdout=subprocess.PIPE, stderr=self.error, text=True, env=env)
        test.addCleanup(self.kill)
        deadline = time.monotonic() + 20
        while "velocity from" not in self.log():
            test.assertIsNone(self.process.poll(), self.log())
            test.assertLess(time.monotonic(), deadline)
            time.sleep(0.05)

    def log(self):
        with open(self.error.name) as file:
            return file.read()

    def kill(self):
        if self.process.poll() is None:
            self.process.kill()
        self.process.communicate()
        self.error.close()

    def end(self):
        """Ctrl-C: {counter: value}."""
        self.process.send_signal(signal.SIGINT)
        out, _ = self.process.communicate(timeout=60)
        assert self.process.returncode == 0, self.log()
        self.status = out.splitlines()[0]
        return dict(line.strip().rsplit(": ", 1) for line in out.splitlines()[1:])


class PeerOnFastDds(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        temporary = tempfile.TemporaryDirectory(prefix="edged_ros2_")
        cls.addClassCleanup(temporary.cleanup)
        cls.base = pathlib.Path(temporary.name)
        cls.recording = cls.base / "flight"
        edged("simulate", "--preset", "room", "--duration", SECONDS, "--out", cls.recording, "--quiet")
        edged("run", cls.recording, "--frame", "body", "--quiet", "--out", cls.base / "offline")
        cls.offline = cls.base / "offline" / "trajectory.tum"
        cls.truth = cls.recording / "groundtruth.txt"
        cls.numbers = iter(range(100))

    def setUp(self):
        number = next(self.numbers)
        self.domain = 1 + (os.getpid() + number) % 100
        self.folder = self.base / str(number)
        self.folder.mkdir()
        os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
        os.environ["ROS_DOMAIN_ID"] = str(self.domain)

    def start_peer(self, recording, name, **options):
        return subprocess.Popen([PEER, str(recording), str(self.folder / name),
                                 *(f"{key}={value}" for key, value in options.items())])

    def peer(self, recording, name, **options):
        self.assertEqual(self.start_peer(recording, name, **options).wait(timeout=60), 0)
        return json.loads((self.folder / f"{name}.json").read_text())

    def test_all_arrives_and_all_that_is_published_can_be_read(self):
        node = Node(self, "--set", "publish_px4=true", "--set", "occupancy.voxel_m=0.05", "--set", "occupancy.period_s=1")
        seen = self.peer(self.recording, "peer")
        counters = node.end()
        self.assertEqual(counters.get("/events messages missed"), None)
        self.assertEqual(counters["/imu messages"], str(1000 * SECONDS + 1))
        ours, offline = poses(self.folder / "peer.tum"), poses(self.offline)
        self.assertGreaterEqual(len(ours), len(offline) - 2)  # the last ones come after Ctrl-C
        difference = largest_difference(ours, offline)
        online_ate, offline_ate = ate_m(self.truth, self.folder / "peer.tum"), ate_m(self.truth, self.offline)
        print(f"{len(ours)} poses, {difference:.1e} from those offline; ATE {online_ate:.5f} m, offline {offline_ate:.5f} m")
        self.assertLess(difference, 1e-6)  # the digits of the file
        self.assertLess(online_ate, 1.1 * offline_ate)
        self.check_fields(seen)
        self.check_px4(seen["/fmu/in/vehicle_visual_odometry"], poses(self.folder / "peer.prediction.tum"))

    def check_fields(self, seen):
        for topic, what in seen.items():
            self.assertGreater(what["count"], 0, topic)
            self.assertTrue(what["last"]["complete"], topic)
        last = {topic: what["last"] for topic, what in seen.items()}
        odometry = last["~/odometry"]
        self.assertEqual((odometry["frame"], odometry["child"]), ("odom", "body"))
        self.assertGreater(odometry["pose_covariance"][0], 0)
        self.assertGreater(odometry["twist_covariance"][35], 0)
        self.assertAlmostEqual(sum(x * x for x in odometry["pose"][3:]), 1, 9)
        self.assertEqual(last["~/pose"]["frame"], "map")
        self.assertEqual(last["~/pose"]["pose_covariance"], odometry["pose_covariance"])
        self.assertEqual(seen["~/pose"]["count"], seen["~/odometry"]["count"])
        self.assertGreater(seen["~/prediction"]["count"], 10 * seen["~/odometry"]["count"])
        self.assertGreater(len(last["~/path"]["poses"]), 5 * SECONDS)
        cloud = last["~/landmarks"]
        self.assertEqual([field["name"] for field in cloud["fields"]], ["x", "y", "z", "id"])
        self.assertEqual(cloud["bytes"], cloud["width"] * cloud["point_step"])
        grid, cells = last["~/occupancy"], last["~/occupancy"]["cells"]
        self.assertEqual((grid["frame"], round(grid["resolution"], 6), grid["origin"][2:]), ("map", 0.05, [0, 0, 0, 0, 1]))
        self.assertEqual(10**9 * grid["load_time_s"] + grid["load_time_ns"], grid["stamp_ns"])
        self.assertEqual((sum(cells.values()), cells["others"]), (grid["width"] * grid["height"], 0))
        self.assertGreater(cells["free"], 100)
        print(f"grid of {grid['width']} x {grid['height']}: {cells}")
        voxels = last["~/octomap"]
        self.assertEqual((voxels["frame"], voxels["binary"], voxels["id"], voxels["resolution"]), ("map", True, "OcTree", 0.05))
        self.assertEqual(voxels["stamp_ns"], grid["stamp_ns"])
        self.assertGreater(voxels["bytes"], 1000)
        for camera in ("events", "frames"):
            image = last[f"~/tracks/{camera}"]
            self.assertEqual(image["bytes"], 3 * image["width"] * image["height"])
            self.assertEqual((image["encoding"], image["frame"]), ("bgr8", camera))
        to_odom, to_body = last["/tf"]["transforms"]
        self.assertEqual([to_odom["frame"], to_odom["child"], to_body["frame"], to_body["child"]], ["map", "odom", "odom", "body"])
        self.assertEqual(to_body["pose"], odometry["pose"])
        self.assertEqual({t["child"] for t in last["/tf_static"]["transforms"]}, {"events", "frames"})
        diagnostics = last["/diagnostics"]
        self.assertEqual(diagnostics["name"], "edged: odometry")
        self.assertTrue(diagnostics["message"].startswith("Good"), diagnostics["message"])
        self.assertEqual(diagnostics["values"]["/imu messages"], str(1000 * SECONDS + 1))

    def test_poses_are_continuous_in_odom_while_the_map_moves_it_and_those_of_the_base(self):
        flight, map_file, mapped = (self.folder / name for name in ("flight", "room.map", "mapped"))
        edged("simulate", "--preset", "room", "--duration", 10, "--out", flight, "--quiet")
        edged("run", flight, "--frame", "body", "--quiet", "--out", mapped, "--save-map", map_file)
        node = Node(self, "--set", f"map_file={map_file}", "--set", "base_frame=base_link")
        later = 6  # in the map the flight begins away from its origin
        seen = self.peer(flight, "peer", base="base_link", **{"from": later})
        node.end()
        self.assertRegex(node.log(), r"the map has moved the pose by 0\.\d+ m")
        tree = [(t["frame"], t["child"]) for t in seen["/tf"]["last"]["transforms"]]
        self.assertEqual(tree, [("map", "odom"), ("odom", "base_link")])
        self.assertEqual(seen["~/odometry"]["last"]["child"], "base_link")
        in_odom, in_map = poses(self.folder / "peer.odom.tum"), poses(self.folder / "peer.tum")
        self.assertEqual(in_odom.keys(), in_map.keys())
        of_body = poses(mapped / "trajectory.tum")
        steps = [(t, next_t) for t, next_t in itertools.pairwise(sorted(in_odom)) if t in of_body and next_t in of_body]
        self.assertGreater(len(steps), 20)
        step = lambda path, t, next_t: math.dist(path[t][:3], path[next_t][:3])
        jumps = [step(in_map, *times) for times in steps]
        self.assertGreater(max(jumps), 0.05)
        speed_mps = 1.5  # of the preset, at most, and of the base, which swings by 0.2 m
        for (t, next_t), jump in zip(steps, jumps):
            self.assertLess(step(in_odom, t, next_t), speed_mps * 1e-6 * (next_t - t) + 1e-3)
        last = max(set(in_map) & set(of_body))
        offset = transformed(in_map[last], [0.2, 0.0, 0.0])
        print("the body in the loaded map, and where that was made:", offset, of_body[last][:3])
        self.assertLess(math.dist(offset, of_body[last][:3]), 0.05)

    def asked(self, node, what):
        """A request after the recording, and the end of the log."""
        before = len(node.log())
        self.peer("none", "asked", ask=what, listen=0.5)
        return node.log()[before:]

    def test_requests_save_and_load_the_map_and_start_anew(self):
        node, flight, map_file = Node(self), self.folder / "flight", self.folder / "lab.map"
        edged("simulate", "--preset", "room", "--duration", 11, "--out", flight, "--quiet")
        self.assertIn(f"save_map {map_file}: not done: no keyframe has left the window yet", self.asked(node, f"save_map:{map_file}"))
        self.peer(flight, "peer", ask="reset", ask_at=1)
        rows = [[1e-6 * t, *pose] for t, pose in sorted(poses(self.folder / "peer.tum").items())]
        self.assertIn("reset: the estimate starts again, in a new map", node.log())
        self.assertEqual(node.log().count("Initializing"), 2)
        before, start = next(pair for pair in itertools.pairwise(rows) if pair[1][0] - pair[0][0] > 0.3)
        self.assertLess(start[0] - before[0], 1.0)
        self.assertRegex(self.asked(node, f"save_map:{map_file}"), r"done: \d+ keyframes, \d+\.\d MB")
        self.assertIn("keyframes", edged("map", "info", map_file))
        self.assertIn("not done: cannot be written", self.asked(node, "save_map:/nowhere/lab.map"))
        self.assertIn("the body is searched in this map", self.asked(node, f"load_map:{map_file}"))
        self.assertIn("not done: cannot be read", self.asked(node, "load_map:/nowhere/lab.map"))
        node.end()

    def test_the_estimate_goes_on_when_the_clock_of_the_stamps_is_set(self):
        for by in (100, 0.05, -2):
            node = Node(self, name=f"set{len(str(by))}")
            self.peer(self.recording, "peer", node=f"set{len(str(by))}", set_at=2.5, set_by=by)
            node.end()
            self.assertIn(f"/events: the clock of the stamps was set by {by:+.3f} s: the estimate continues", node.log())
            self.assertNotIn("numbers are missing", node.log())
            rows = [[float(x) for x in line.split()] for line in (self.folder / "peer.tum").read_text().splitlines()]
            offline = [[t, *pose] for t, pose in poses(self.offline).items()]
            self.assertGreater(len(rows), len(offline) - 5)
            self.assertLess(largest_difference(*({i: row[1:] for i, row in enumerate(path)} for path in (rows, offline))), 1e-6)
            self.assertAlmostEqual(rows[-1][0] - by, 1e-6 * offline[len(rows) - 1][0], 5)

    def test_what_it_waits_for_is_logged_within_6_s_and_what_no_node_has_is_refused(self):
        node = Node(self)
        time.sleep(6)
        self.assertIn("waiting: no packet yet; nothing received on /events; nothing received on /image; nothing received on /imu",
                      node.log())
        node.end()
        rig = ["--rig", "davis240c_ecd"]
        for args, message in (([*rig, "-r", "evnts:=/e"], "remapping /evnts:=/e: there is no topic /evnts, but "),
                              (["--ros-args", "-p", "rigg:=x"], "rigg"),
                              (["--ros-args", "--params-file", "/nowhere.yaml"], "--params-file /nowhere.yaml: cannot be read")):
            done = subprocess.run([EDGED, "ros2", *args], capture_output=True, text=True, timeout=20)
            self.assertEqual(done.returncode, 3, done.stderr)
            self.assertIn(message, done.stderr)

    def test_it_takes_the_arguments_of_launch(self):
        parameters = self.folder / "params.yaml"
        parameters.write_text("/**:\n  ros__parameters:\n    mode: frames\n    path_step_s: 0.5\n"
                              "other:\n  ros__parameters: {mode: events}\n"
                              "robot:\n  edged:\n    ros__parameters: {base_frame: base_link, map: {enabled: false}}\n")
        config = output_of("ros2", "--ros-args", "-r", "__ns:=/robot", "--params-file", parameters, "-p", "path_step_s:=0.25",
                           "--log-level", "info", "--print-config")
        for line in ("mode: frames ", "path_step_s: 0.25 ", 'base_frame: "base_link" '):
            self.assertIn("\n" + line, config)

    def test_no_pose_is_sent_and_the_log_says_why_while_the_robot_is_not_described(self):
        node = Node(self, "--set", "base_frame=base_link")
        seen = self.peer(self.recording, "peer")
        node.end()
        self.assertEqual((seen["~/odometry"]["count"], seen["~/prediction"]["count"], seen["/tf"]["count"]), (0, 0, 0))
        self.assertIn("no transform from base_link to body on /tf_static", seen["/diagnostics"]["last"]["message"])
        self.assertEqual(node.log().count("no transform from base_link to body on /tf_static"), 1)

    def check_px4(self, seen, predictions):
        """The same states as ~/prediction, with z and y turned round."""
        last = seen["last"]
        print("px4: from the IMU sample to here, median and 99 %: {:.2f}, {:.2f} ms".format(*seen["delay_ms"]))
        self.assertGreater(seen["count"], 20 * SECONDS)
        self.assertEqual((last["pose_frame"], last["velocity_frame"]), (2, 3))  # FRD, BODY_FRD
        self.assertGreaterEqual(last["timestamp"], last["timestamp_sample"])
        self.assertLess(abs(last["timestamp_sample"] - 1e6 * time.time()), 60e6)
        x, y, z = last["position"]
        w, qx, qy, qz = last["q"]
        pose = min(predictions.values(), key=lambda p: abs(p[0] - x) + abs(p[1] + y) + abs(p[2] + z))
        for ours, theirs in zip([x, -y, -z, qx, -qy, -qz, w], closest([x, -y, -z, qx, -qy, -qz, w], pose)):
            self.assertAlmostEqual(ours, theirs, delta=1e-5)
        for name in ("position_variance", "orientation_variance", "velocity_variance"):
            self.assertGreater(min(last[name]), 0, name)
        self.assertEqual(last["reset_counter"], 0)
        self.assertTrue(51 <= last["quality"] <= 100, last["quality"])

    def test_a_late_joiner_and_a_second_node_get_the_same_and_another_domain_nothing(self):
        # A grid of the first keyframe alone, kept for those who come later.
        nodes = [Node(self), Node(self, "--set", "occupancy.voxel_m=0.1", "--set", "occupancy.period_s=3600", name="second")]
        other_domain = Node(self, domain=self.domain % 100 + 101, name="other")
        # At half its speed: what comes late on a loaded machine still finds half of it.
        first = self.start_peer(self.recording, "peer", nodes=2, rate=0.5)
        time.sleep(SECONDS)
        late = self.start_peer("none", "late", listen=3, node="second")
        self.assertEqual(first.wait(timeout=60), 0)
        self.assertEqual(late.wait(timeout=60), 0)
        for node in nodes:
            self.assertNotIn("/events messages missed", node.end())
        self.assertNotIn("/events messages", other_domain.end())
        all_poses, late_poses = poses(self.folder / "peer.tum"), poses(self.folder / "late.tum")
        self.assertGreater(len(late_poses), 10)
        self.assertLess(len(late_poses), len(all_poses))
        self.assertLess(largest_difference(late_poses, all_poses), 1e-12)
        seen = json.loads((self.folder / "late.json").read_text())
        self.assertGreater(seen["/tf_static"]["count"], 0)
        self.assertEqual((seen["~/occupancy"]["count"], seen["~/octomap"]["count"]), (1, 1))

    def test_a_driver_that_is_killed_and_started_again_is_survived(self):
        node = Node(self)
        killed = self.start_peer(self.recording, "killed")
        time.sleep(SECONDS / 2 + 0.5)
        killed.kill()
        killed.wait()
        seen = self.peer(self.recording, "peer", **{"from": SECONDS / 2 + 1})
        counters = node.end()
        self.assertGreater(int(counters["/imu messages"]), 300 * SECONDS)
        self.assertGreater(seen["/diagnostics"]["count"], 0)

    def test_a_loss_of_1_percent_is_counted_and_the_error_stays(self):
        node = Node(self)
        self.peer(self.recording, "peer", skip=100)
        counters = node.end()
        self.assertGreater(int(counters["/events messages missed"]), 5 * SECONDS)
        self.assertIn("/events: numbers are missing", node.log())
        self.assertEqual(node.log().count("/events: numbers are missing"), 1)
        self.assertLess(ate_m(self.truth, self.folder / "peer.tum"), 2 * ate_m(self.truth, self.offline))

    def test_packets_lost_by_the_network_are_counted_or_sent_again(self):
        node, asking = Node(self), Node(self, "--set", "reliable=true", name="asking")
        self.peer(self.recording, "peer", reliable=1, loss=1, nodes=2)
        counters, all_counters = node.end(), asking.end()
        sent = 1000 * SECONDS + 1
        lost = {topic: int(counters.get(f"{topic} messages lost by the transport", 0))
                for topic in ("/events", "/imu", "/image")}
        print("lost:", lost)
        self.assertAlmostEqual(int(counters["/imu messages"]) + lost["/imu"], sent, delta=3)  # not the first and last ones
        self.assertTrue(0.003 * sent < lost["/imu"] < 0.03 * sent)
        self.assertIn("/imu: messages were lost on the way", node.log())
        self.assertLess(ate_m(self.truth, self.folder / "peer.tum"), 2 * ate_m(self.truth, self.offline))
        self.assertEqual(all_counters["/imu messages"], str(sent))
        self.assertNotIn("lost", asking.log())

    def test_two_cameras_of_each_kind_give_the_poses_of_the_offline_run(self):
        flight = self.folder / "stereo"
        edged("simulate", "--preset", "room", "--duration", 2, "--baseline", "0.1", "--out", flight, "--quiet")
        edged("run", flight, "--frame", "body", "--quiet", "--out", self.folder / "offline")
        cameras = ("--set", "cameras=events,events2,frames,frames2")
        self.recording, recording = flight, self.recording
        node = Node(self, *cameras)
        self.recording = recording
        listener = self.start_peer("none", "peer", listen=4)
        deadline = time.monotonic() + 20
        while not (self.folder / "peer.ready").exists():
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.05)
        edged("play", flight, "--ros2", "--wait", "--quiet")
        self.assertEqual(listener.wait(timeout=60), 0)
        node.end()
        ours, offline = poses(self.folder / "peer.tum"), poses(self.folder / "offline" / "trajectory.tum")
        self.assertGreater(len(ours), len(offline) - 5)
        self.assertLess(largest_difference(ours, offline), 1e-6)

    def test_a_recording_is_played_at_twice_its_speed_without_a_loss(self):
        flight = self.folder / "sensors"
        edged("simulate", "--duration", 2, "--set", "height.rate_hz=25", "--set", "velocity.rate_hz=25", "--out", flight,
              "--quiet")
        node = Node(self, "--set", "delays.external_s=0.2")
        done = subprocess.run([EDGED, "play", flight, "--ros2", "--wait", "--rate", "2", "--quiet"], capture_output=True,
                              text=True, check=True, timeout=60)
        time.sleep(1)
        counters = node.end()
        self.assertEqual(done.stdout.split()[1], counters["/events events"])
        self.assertNotIn("dropped", done.stdout)
        self.assertEqual(counters["/imu messages"], "2001")
        self.assertGreater(int(counters["/height messages"]), 40)
        self.assertGreater(int(counters["/velocity messages"]), 40)

    def test_reliable_drivers_are_read_and_a_qos_that_does_not_fit_is_named(self):
        node = Node(self)
        self.peer(self.recording, "peer", reliable=1, interfaces=2)
        self.assertEqual(node.end()["/imu messages"], str(1000 * SECONDS + 1))
        asking = Node(self, "--set", "reliable=true", name="asking")
        deaf = self.start_peer(self.recording, "deaf")
        deadline = time.monotonic() + 15
        while "/imu: a publisher is best effort" not in asking.log():
            self.assertLess(time.monotonic(), deadline, asking.log())
            time.sleep(0.1)
        deaf.kill()
        deaf.wait()
        self.assertIn("/imu: a publisher is best effort", asking.log())


if __name__ == "__main__":
    unittest.main(verbosity=2)
