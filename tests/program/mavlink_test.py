#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""What an autopilot receives of a live run with a covered lens, read by a decoder written from MAVLink's published format: frames, poses,
silence, reset counter, answers to TIMESYNC. Usage: EDGED=path/to/edged mavlink_test.py [--latency]; the option prints the latency."""
import json
import math
import pty
import os
import select
import socket
import struct
import subprocess
import sys
import threading
import time
import unittest

from program import EDGED, WithFlight, edged

# type, name, length of an array (0: none), in the order of the definition; extensions apart.
HEARTBEAT = ("HEARTBEAT", 0, [("uint8_t", "type", 0), ("uint8_t", "autopilot", 0), ("uint8_t", "base_mode", 0), ("uint32_t", "custom_mode", 0),
                              ("uint8_t", "system_status", 0), ("uint8_t", "mavlink_version", 0)], [])
TIMESYNC = ("TIMESYNC", 111, [("int64_t", "tc1", 0), ("int64_t", "ts1", 0)], [("uint8_t", "target_system", 0), ("uint8_t", "target_component", 0)])
ODOMETRY = ("ODOMETRY", 331, [("uint64_t", "time_usec", 0), ("uint8_t", "frame_id", 0), ("uint8_t", "child_frame_id", 0),
                              *(("float", axis, 0) for axis in "xyz"), ("float", "q", 4), *(("float", "v" + axis, 0) for axis in "xyz"),
                              ("float", "rollspeed", 0), ("float", "pitchspeed", 0), ("float", "yawspeed", 0), ("float", "pose_covariance", 21),
                              ("float", "velocity_covariance", 21)],
            [("uint8_t", "reset_counter", 0), ("uint8_t", "estimator_type", 0), ("int8_t", "quality", 0)])
CODES = {"uint8_t": "B", "int8_t": "b", "uint32_t": "I", "uint64_t": "Q", "int64_t": "q", "float": "f"}


def crc(data, value=0xFFFF):
    """The catalogue's CRC-16/MCRF4XX: polynomial 0x1021 reflected, no final inversion."""
    for byte in data:
        value ^= byte
        for _ in range(8):
            value = value >> 1 ^ (0x8408 if value & 1 else 0)
    return value


class Message:
    """Fields sorted by the size of their type, the largest first; extensions after them as they are."""

    def __init__(self, name, number, fields, extensions):
        wire = sorted(fields, key=lambda field: -struct.calcsize("<" + CODES[field[0]]))
        seed = crc(f"{name} ".encode())
        for kind, field, length in wire:
            seed = crc(f"{kind} {field} ".encode() + (bytes([length]) if length else b""), seed)
        self.name, self.number, self.extra, self.fields = name, number, seed & 0xFF ^ seed >> 8, wire + extensions
        self.format = "<" + "".join(f"{length or ''}{CODES[kind]}" for kind, _, length in self.fields)

    def read(self, payload):
        values = list(struct.unpack(self.format, payload.ljust(struct.calcsize(self.format), b"\0")))
        return {name: [values.pop(0) for _ in range(length)] if length else values.pop(0) for _, name, length in self.fields}

    def frame(self, *values, sequence=0, system=1, component=1):
        payload = struct.pack(self.format, *values).rstrip(b"\0") or b"\0"
        head = struct.pack("<BBBBBBHB", len(payload), 0, 0, sequence, system, component, self.number & 0xFFFF, self.number >> 16)
        return b"\xFD" + head + payload + struct.pack("<H", crc(bytes([self.extra]), crc(head + payload)))


MESSAGES = {message.number: message for message in (Message(*definition) for definition in (HEARTBEAT, TIMESYNC, ODOMETRY))}


def read_frame(data):
    """(name, fields, sequence, system, component, length) of the first frame, and the rest; nothing may be wrong with it."""
    magic, length, incompatible, _, sequence, system, component, low, high = struct.unpack_from("<BBBBBBBHB", data)
    message = MESSAGES[low | high << 16]
    payload = data[10:10 + length]
    assert (magic, incompatible) == (0xFD, 0) and len(payload) == length, data
    assert struct.unpack_from("<H", data, 10 + length)[0] == crc(bytes([message.extra]), crc(data[1:10 + length])), "checksum"
    assert length == 1 or payload[-1], "a trailing zero was sent"
    return (message.name, message.read(payload), sequence, system, component, length), data[12 + length:]


class Autopilot(threading.Thread):
    """Receives datagrams and their times until stopped, and asks for the time ten times a second."""

    def __init__(self):
        super().__init__()
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.bind(("127.0.0.1", 0))
        self.port = self.socket.getsockname()[1]
        self.received, self.stopped = [], False
        self.start()

    def run(self):
        asked = 0
        while not self.stopped:
            if not select.select([self.socket], [], [], 0.05)[0]:
                continue
            data, sender = self.socket.recvfrom(2048)
            now = time.time()
            frame, rest = read_frame(data)
            assert not rest
            self.received.append((now, *frame))
            if now > asked + 0.1:
                self.socket.sendto(MESSAGES[111].frame(0, time.monotonic_ns(), 0, 0), sender)
                asked = now

    def stop(self):
        self.stopped = True
        self.join()
        self.socket.close()

    def of(self, name):
        return [entry for entry in self.received if entry[1] == name]


def states_of(folder):
    """Rows of states.csv as dictionaries."""
    lines = [line for line in (folder / "states.csv").read_text().splitlines() if not line.startswith("#")]
    return [dict(zip(lines[0].split(","), line.split(","))) for line in lines[1:]]


def rotation(w, x, y, z):
    return [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]


class Covered(WithFlight):
    """One live run of a flight whose lens is covered."""
    SIMULATION = ("--preset", "room", "--duration", 14, "--seed", 3, "--set", "disturbance.kind=lens-covered", "--set", "disturbance.at_s=5",
                  "--set", "disturbance.length_s=4")

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.out = cls.flight.parent / "run"
        cls.autopilot = Autopilot()
        try:
            cls.result = edged("run", cls.flight, "--live", "--mavlink", f"udp:127.0.0.1:{cls.autopilot.port}", "--mode", "frames", "--frame", "body",
                               "--out", cls.out, "--quiet", "--set", "autopilot.rate_hz=100", "autopilot.system_id=7")
        finally:
            cls.autopilot.stop()
        cls.odometry = cls.autopilot.of("ODOMETRY")

    def test_every_frame_is_sound_and_none_is_lost(self):
        self.assertIn(self.result.returncode, (0, 4, 5), self.result.stderr)
        self.assertGreater(len(self.odometry), 400)
        self.assertEqual({entry[4:6] for entry in self.autopilot.received}, {(7, 197)})
        self.assertEqual([entry[3] for entry in self.autopilot.received], [i % 256 for i in range(len(self.autopilot.received))])
        self.assertGreater(len(self.autopilot.of("HEARTBEAT")), 10)
        self.assertIn(f"{len(self.odometry)} messages of odometry", (self.out / "run.log").read_text())
        for _, _, fields, *_, length in self.odometry:
            self.assertEqual((fields["frame_id"], fields["child_frame_id"], fields["estimator_type"], length), (20, 12, 3, 233))
            self.assertAlmostEqual(sum(q * q for q in fields["q"]), 1, places=5)

    def test_silent_while_lost_with_growing_variance_before_and_a_reset_after(self):
        times = [fields["time_usec"] * 1e-6 for _, _, fields, *_ in self.odometry]
        gap, after = max((b - a, i + 1) for i, (a, b) in enumerate(zip(times, times[1:])))
        self.assertGreater(gap, 0.4)  # EKF2 has stopped its fusion by then
        before = [entry[2] for entry in self.odometry[:after]]
        self.assertEqual({fields["reset_counter"] for fields in before}, {0})
        self.assertGreaterEqual(self.odometry[after][2]["reset_counter"], 1)
        self.assertTrue(all(1 <= entry[2]["quality"] <= 100 for entry in self.odometry))
        # Good, then Degraded: lower quality, growing variances.
        self.assertGreater(max(fields["quality"] for fields in before), 50)
        self.assertLessEqual(before[-1]["quality"], 50)
        covered = [fields["pose_covariance"][0] for fields in before if fields["quality"] <= 50][-100:]
        self.assertGreater(covered[-1], 4 * covered[0])

    def test_poses_are_those_of_the_run_with_z_down(self):
        states = [row for row in states_of(self.out) if row["status"] == "Good"]
        path = [(int(row["t_ns"]) * 1e-9, [float(row[f"p{axis}_m"]) for axis in "xyz"]) for row in states]
        good = [fields for _, _, fields, *_ in self.odometry if fields["quality"] > 50 and fields["reset_counter"] == 0]

        def worst(offset):
            """Distance of the states from the message next to each in time."""
            stamps, worst_m, i = [fields["time_usec"] * 1e-6 - offset for fields in good], 0, 0
            for t, p in path:
                while i + 1 < len(stamps) and abs(stamps[i + 1] - t) <= abs(stamps[i] - t):
                    i += 1
                if abs(stamps[i] - t) < 0.006:
                    worst_m = max(worst_m, math.dist(p, (good[i]["x"], -good[i]["y"], -good[i]["z"])))
            return worst_m
        # The recording began when its first measurement was due, within the second before the first message or so.
        begin = self.odometry[0][2]["time_usec"] * 1e-6 - path[0][0]
        best = min(worst(begin + ms * 1e-3) for ms in range(-100, 101, 2))
        self.assertLess(best, 0.05)
        # The velocity in the body, turned into the world, is the change of the position.
        for a, b in zip(good[100:200], good[110:210]):
            dt = (b["time_usec"] - a["time_usec"]) * 1e-6
            R = rotation(*a["q"])
            for row, axis in zip(R, "xyz"):
                world = sum(r * a["v" + name] for r, name in zip(row, "xyz"))
                self.assertLess(abs((b[axis] - a[axis]) / dt - world), 0.5)

    def test_timesync_is_answered_by_the_clock_of_the_stamps(self):
        answers = self.autopilot.of("TIMESYNC")
        self.assertGreater(len(answers), 10)
        for now, _, fields, *_ in answers:
            self.assertLess(abs(fields["tc1"] * 1e-9 - now), 1)
            self.assertGreater(fields["ts1"], 0)
            self.assertEqual((fields["target_system"], fields["target_component"]), (1, 1))
        for now, _, fields, *_ in self.odometry:
            self.assertLess(abs(fields["time_usec"] * 1e-6 - now), 1)

    def test_the_latency_is_written_to_timing_json(self):
        stages = json.loads((self.out / "timing.json").read_text())["stages"]
        timing = next(stage for stage in stages if stage["stage"] == "autopilot")
        self.assertEqual(timing["count"], len(self.odometry))
        if LATENCY:
            late = sorted(now - fields["time_usec"] * 1e-6 for now, _, fields, *_ in self.odometry)
            print(f"from due to received: p50 {1e3 * late[len(late) // 2]:.3f} ms, p99 {1e3 * late[len(late) * 99 // 100]:.3f} ms; "
                  f"from arrival to the wire: {timing}", file=sys.stderr)


class Lines(WithFlight):
    SIMULATION = ("--duration", 4, "--seed", 2)

    def run_to(self, url, *args):
        return edged("run", self.flight, "--live", "--mavlink", url, "--mode", "frames", "--quiet", "--out", self.folder / "run", *args)

    def test_a_serial_line_carries_the_same_frames(self):
        master, device = pty.openpty()
        self.addCleanup(os.close, master)
        data = b""
        process = subprocess.Popen([EDGED, "run", str(self.flight), "--live", "--mavlink", f"serial:{os.ttyname(device)}:921600", "--mode", "frames", "--quiet",
                                    "--out", str(self.folder / "run")], stdout=subprocess.DEVNULL)
        while process.poll() is None:
            if select.select([master], [], [], 0.05)[0]:
                data += os.read(master, 65536)
        os.close(device)
        names = []
        while data:
            frame, data = read_frame(data)
            names.append(frame[0])
        self.assertEqual(process.returncode, 0)
        self.assertGreater(names.count("ODOMETRY"), 50)
        self.assertGreaterEqual(names.count("HEARTBEAT"), 3)

    def test_an_autopilot_that_is_not_there_is_reported_once_and_costs_nothing_else(self):
        nobody = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        nobody.bind(("127.0.0.1", 0))
        url = f"udp:127.0.0.1:{nobody.getsockname()[1]}"
        nobody.close()
        result = self.run_to(url, "--json")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(result.stderr.count("a message was not sent: Connection refused"), 1, result.stderr)
        self.assertRegex(result.stderr, r"[1-9]\d* not accepted")

    def test_what_cannot_work_is_refused_in_one_line(self):
        self.assert_refused(self.run_to("udp:14550"), "MAVLink", "udp:127.0.0.1:14550")
        self.assert_refused(self.run_to("serial:/dev/nothing:921600"), "plugged in")
        self.assert_refused(self.run_to("udp:127.0.0.1:14550", "--set", "autopilot.axes=forward=x up=x"), "autopilot.axes", "forward=x up=z")
        self.assert_refused(edged("run", self.flight, "--mavlink", "udp:127.0.0.1:14550", "--quiet", "--out", self.folder / "run"), "--live")
        self.assertFalse((self.folder / "run").exists())


LATENCY = "--latency" in sys.argv
if __name__ == "__main__":
    unittest.main(argv=[arg for arg in sys.argv if arg != "--latency"])
