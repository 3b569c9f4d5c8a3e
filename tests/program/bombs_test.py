#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""Small files that unpack to gigabytes cost neither memory nor a crash. Usage: EDGED=path/to/edged bombs_test.py"""
import os
import random
import resource
import sqlite3
import struct
import subprocess
import unittest
import zipfile
import zlib

from program import EDGED, WithFolder

MOST_BYTES = 1 << 30  # of memory
GIB = 1 << 30


def zstd_of_zeros(size):
    """A frame of blocks of 128 kB that repeat one byte."""
    block = 1 << 17
    last = size // block - 1
    return (b"\x28\xb5\x2f\xfd\x00\x38" +  # a window of 128 kB, nothing said of size or checksum
            b"".join(((block << 3) | (1 << 1) | (i == last)).to_bytes(3, "little") + b"\x00" for i in range(last + 1)))


def mcap_of_chunks(chunk_bytes, stated_bytes):
    def record(op, content):
        return bytes([op]) + struct.pack("<Q", len(content)) + content

    def text(content):
        return struct.pack("<I", len(content)) + content
    packed, magic, t = zstd_of_zeros(chunk_bytes), b"\x89MCAP0\r\n", 10**18
    chunk = record(6, struct.pack("<QQQI", t, t + 10**9, stated_bytes, 0) + text(b"zstd") + struct.pack("<Q", len(packed)) + packed)
    data = magic + record(1, text(b"ros2") + text(b"")) + 20 * chunk + record(15, bytes(4))
    summary = (record(3, struct.pack("<H", 1) + text(b"sensor_msgs/msg/Imu") + text(b"ros2msg") + text(b"")) +
               record(4, struct.pack("<HH", 0, 1) + text(b"/imu") + text(b"cdr") + text(b"")) +
               record(11, struct.pack("<QHIIIIQQ", 20, 1, 1, 0, 0, 20, t, t + 10**9) + text(struct.pack("<HQ", 0, 20))))
    return data + summary + record(2, struct.pack("<QQI", len(data), 0, 0)) + magic


def png_of_texts(count):
    def part(name, content):
        return struct.pack(">I", len(content)) + name + content + struct.pack(">I", zlib.crc32(name + content))
    text = zlib.compress(bytes(7_900_000), 9)  # the library takes 8 MB
    return (b"\x89PNG\r\n\x1a\n" + part(b"IHDR", struct.pack(">IIBBBBB", 240, 180, 8, 0, 0, 0, 0)) +
            b"".join(part(b"zTXt", b"%d\0\0" % i + text) for i in range(count)) +
            part(b"IDAT", zlib.compress(bytes(241 * 180))) + part(b"IEND", b""))


class Bombs(WithFolder):
    def memory_of(self, *args):
        """Bytes that the program takes at most. Its exit code is that of any bad recording."""
        with subprocess.Popen([EDGED, *map(str, args)], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as child:
            _, status, usage = os.wait4(child.pid, 0)
            child.returncode = os.waitstatus_to_exitcode(status)
        self.assertIn(child.returncode, (0, 3, 4), args)
        return 1024 * usage.ru_maxrss

    def assert_costs_little(self, recording, *of_run):
        for command in ("info", "doctor", "run"):
            out = ("--out", self.folder / "run", "--force", *of_run) if command == "run" else ()
            used = self.memory_of(command, recording, "--rig", "davis240c_ecd", "--quiet", *out)
            self.assertLess(used, MOST_BYTES, f"{command} {recording}")

    def test_chunks_of_a_bag(self):
        bag = self.folder / "bag.mcap"
        for chunk_bytes, stated_bytes in ((GIB, GIB), (GIB, 1000), (GIB // 4, GIB // 4)):
            bag.write_bytes(mcap_of_chunks(chunk_bytes, stated_bytes))
            self.assertLess(bag.stat().st_size, 700_000)
            self.assert_costs_little(bag)

    def test_a_limit_that_is_too_low_is_told_in_one_line(self):
        bag, limit = self.folder / "bag.mcap", (resource.RLIMIT_AS, (GIB // 4, GIB // 4))
        bag.write_bytes(mcap_of_chunks(GIB // 4, GIB // 4))
        result = subprocess.run([EDGED, "info", str(bag)], capture_output=True, text=True, check=False, timeout=300,
                                preexec_fn=lambda: resource.setrlimit(*limit))
        self.assert_refused(result, "there is too little memory", "ulimit -v")

    def test_texts_in_a_picture(self):
        recording = self.folder / "pictures"
        (recording / "images").mkdir(parents=True)
        (recording / "images" / "a.png").write_bytes(png_of_texts(200))
        (recording / "images.txt").write_text("1.0 images/a.png\n1.1 images/a.png\n")
        (recording / "imu.txt").write_text("".join(f"{1 + 0.005 * i:.3f} 0 0 9.8 0 0 0\n" for i in range(40)))
        self.assert_costs_little(recording)

    def test_text_in_an_archive(self):
        lines = b"1.000000 10 10 1\n" * 60_000
        with zipfile.ZipFile(self.folder / "flight.zip", "w", zipfile.ZIP_DEFLATED) as archive:
            with archive.open("events.txt", "w", force_zip64=True) as events:
                for _ in range(GIB // len(lines)):
                    events.write(lines)
            archive.writestr("imu.txt", "".join(f"{1 + 0.005 * i:.3f} 0 0 9.8 0 0 0\n" for i in range(40)))
        self.assert_costs_little(self.folder / "flight.zip")

    def test_events_of_one_stamp(self):
        draw = random.Random(1)
        lines = "".join(f"1.01 {draw.randint(1, 4)} 9 1\n" for _ in range(1_000_000)).encode()
        with zipfile.ZipFile(self.folder / "flight.zip", "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
            with archive.open("events.txt", "w", force_zip64=True) as events:
                for _ in range(40):  # 640 MB in memory
                    events.write(lines)
            archive.writestr("imu.txt", "".join(f"{1 + 0.005 * i:.3f} 0 0 9.8 0 0 0\n" for i in range(40)))
        self.assert_costs_little(self.folder / "flight.zip", "--mode", "events")

    def test_a_view_without_end(self):
        bag = sqlite3.connect(self.folder / "bag.db3")
        bag.execute("CREATE TABLE topics(id INTEGER, name TEXT, type TEXT, serialization_format TEXT)")
        bag.execute("INSERT INTO topics VALUES(1, '/imu', 'sensor_msgs/msg/Imu', 'cdr')")
        bag.execute("CREATE VIEW messages AS WITH RECURSIVE n(i) AS (VALUES(1) UNION ALL SELECT i + 1 FROM n) "
                    "SELECT i AS id, 1 AS topic_id, i AS timestamp, zeroblob(100) AS data FROM n")
        bag.commit()
        bag.close()
        self.assert_costs_little(self.folder / "bag.db3")


if __name__ == "__main__":
    unittest.main(verbosity=2)
