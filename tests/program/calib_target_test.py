#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""edged calib --target: a calibration from a recording of a target, what it writes, and what it refuses.
Usage: EDGED=path/to/edged calib_target_test.py [--pictures FOLDER]; the option leaves screenshots of the page."""
import json
import math
import signal
import socket
import struct
import subprocess
import threading
import time
import unittest

import yaml

from browser import CHROMIUM, Browser, pictures_folder
from program import EDGED, WithFlight, WithFolder, edged

PICTURES = None
GRID = ("--target", "aprilgrid", "--rows", 3, "--columns", 4, "--size", 80)


def packets_of(aedat4):
    """The file as a server sends it: without its magic line and the table at its end."""
    data = aedat4.read_bytes().split(b"\r\n", 1)[1]
    end = 4 + struct.unpack_from("<I", data)[0]
    while end + 8 <= len(data) and 0 <= struct.unpack_from("<i", data, end)[0] < 8:
        end += 8 + struct.unpack_from("<i", data, end + 4)[0]
    return data[:end]


class FromARecording(WithFlight):
    SIMULATION = ("--preset", "calibration-target", "--duration", 13, "--seed", 2)

    def assert_true(self, cameras, factor_of_events):
        truth = yaml.safe_load((self.flight / "calibration.yaml").read_text())["cameras"]
        for camera in cameras:
            wanted = next(c for c in truth if c["name"] == camera["name"])
            # A third of a good recording: the limits are twice those of bench/target.
            factor = 2 * (factor_of_events if camera["name"] == "events" else 1)
            found = [p["value"] for p in camera["parameters"]]
            fx, fy, cx, cy = wanted["intrinsics"]
            self.assertLess(max(abs(found[0] / fx - 1), abs(found[1] / fy - 1)), 1e-3 * factor, camera["name"])
            self.assertLess(math.hypot(found[2] - cx, found[3] - cy), 0.2 * factor, camera["name"])
            overlap = abs(sum(a * b for a, b in zip(wanted["q_B_C"], camera["q_B_C"])))
            self.assertLess(math.degrees(2 * math.acos(min(1.0, overlap))), 0.05 * factor, camera["name"])
            self.assertLess(math.dist([row[3] for row in wanted["T_B_C"][:3]], camera["p_B_C_m"]), 2e-3 * factor, camera["name"])
            self.assertLess(abs(camera["time_offset_s"] - wanted["time_offset"]), 2e-4 * factor, camera["name"])

    def test_frames_and_events_are_calibrated_to_the_imu_at_once(self):
        out = self.folder / "head.yaml"
        result = edged("calib", self.flight, *GRID, "--out", out, "--json", "--quiet")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        said = json.loads(result.stdout)
        self.assertEqual([c["name"] for c in said["cameras"]], ["events", "frames"])
        self.assert_true(said["cameras"], 2)
        read = json.loads(edged("calib", out, "--json").stdout)
        self.assertTrue(read["has_extrinsics"])
        self.assertEqual(read["imu"]["gyro_noise"], 1.2e-4)  # of the recording
        self.assertEqual(read["cameras"][1]["intrinsics_px"], [p["value"] for p in said["cameras"][1]["parameters"][:4]])
        page = (self.folder / "head.html").read_text()
        data = json.loads(page.split('<script type="application/json" id="data">')[1].split("</script>")[0])
        self.assertGreater(len(data["cameras"][1]["residuals"]), 1000)
        self.assertEqual(len(data["cameras"][1]["cells"]["corners"]), 48)
        if CHROMIUM:
            self.assert_legible(self.folder / "head.html")

    def assert_legible(self, page):
        """Narrow and wide, light and dark: nothing sticks out, no name is broken within, images are as wide as their plots."""
        browser = Browser(self.folder / "profile")
        self.addCleanup(browser.close)
        for width, dark in ((390, False), (390, True), (1400, False), (1400, True)):
            theme = "dark" if dark else "light"
            browser.show(width, 900, dark)
            browser.open(page.as_uri())
            browser.wait_for(f"innerWidth === {width} && document.documentElement.dataset.theme === '{theme}'")
            self.assertEqual(browser.value("[...document.querySelectorAll('body *')].filter(e => e.getBoundingClientRect().right > innerWidth + 0.5)"
                                           ".map(e => e.tagName + '.' + e.className)"), [])
            self.assertLess(browser.value("Math.max(...[...document.querySelectorAll('td.key')].filter(e => !e.textContent.includes(' '))"
                                          ".map(e => e.clientHeight))"), 35)  # one line
            self.assertEqual(browser.value("[...document.querySelectorAll('canvas')].map(e => (100 * e.clientHeight / e.clientWidth).toFixed(0))"),
                             6 * ["75"])
            if PICTURES:
                browser.picture(PICTURES / f"target-{width}-{theme}.png")
        self.assertEqual(browser.complaints, [])

    def test_other_formats_hold_the_same(self):
        options = (self.flight, *GRID, "--mode", "frames", "--to", 8, "--quiet")
        for form, name in (("kalibr", "camchain.yaml"), ("opencv", "lens.yaml")):
            out = self.folder / name
            result = edged("calib", *options, "--format", form, "--out", out)
            self.assertEqual((result.returncode, result.stderr), (0, ""))
            read = json.loads(edged("calib", out, "--camera", "frames=frames", "--json").stdout)
            self.assertEqual(read["has_extrinsics"], form == "kalibr")
            self.assertAlmostEqual(read["cameras"][0]["intrinsics_px"][0], 199.37, delta=0.5)

    def test_an_imu_with_a_clock_of_its_own_is_brought_to_that_of_the_cameras(self):
        def later(text):
            return "".join(f"{float(t) + 812.25:.9f} {rest}" for t, rest in (line.split(" ", 1) for line in text.splitlines(True)))
        recording = self.changed("imu.txt", later)
        result = edged("calib", recording, *GRID, "--mode", "frames", "--imu-time-offset", "auto", "--json", "--quiet")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        said = json.loads(result.stdout)
        self.assertLess(abs(said["imu_clock"]["offset_s"] + 812.25), 0.02)
        # What the search leaves is the time offset of the camera.
        said["cameras"][0]["time_offset_s"] += -812.25 - said["imu_clock"]["offset_s"]
        self.assert_true(said["cameras"], 2)

    def test_a_live_camera_is_calibrated_once_it_is_ended(self):
        recording = self.folder / "flight.aedat4"
        self.assertEqual(edged("convert", self.flight, recording, "--quiet").returncode, 0)
        server = self.enterContext(socket.create_server(("127.0.0.1", 0)))
        options = (f"tcp://127.0.0.1:{server.getsockname()[1]}", *GRID, "--mode", "frames", "--json")
        with subprocess.Popen([EDGED, "calib", *map(str, options)], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              text=True) as program:
            shown = []
            reader = threading.Thread(target=lambda: shown.extend(program.stderr))
            reader.start()
            client, _ = server.accept()
            with client:
                client.sendall(packets_of(recording))
                time.sleep(2)
                program.send_signal(signal.SIGINT)
                said = json.loads(program.stdout.read())
                reader.join()
        self.assertEqual(program.returncode, 0, shown)
        self.assert_true(said["cameras"], 2)
        self.assertIn("target in frames ", "".join(shown))

    def test_what_is_missing_is_told(self):
        result = edged("calib", self.flight, "--target", "checkerboard", "--mode", "frames", "--to", 2, "--quiet")
        self.assert_refused(result, "camera frames: the target is in 0 of", "check --target and its rows and columns")
        result = edged("calib", self.flight, *GRID, "--mode", "frames", "--from", 2, "--to", 3.5, "--quiet")
        self.assert_refused(result, "camera frames", "record")


class ATarget(WithFolder):
    def test_is_printed(self):
        for kind in ("checkerboard", "aprilgrid", "charuco"):
            for ending, begin in ((".svg", b"<svg"), (".pdf", b"%PDF-1.4")):
                file = self.folder / (kind + ending)
                result = edged("calib", "--target", kind, "--print-target", file)
                self.assertEqual((result.returncode, result.stderr), (0, ""))
                self.assertTrue(file.read_bytes().startswith(begin))

    def test_that_is_impossible_is_refused(self):
        print_to = ("--print-target", self.folder / "target.svg")
        self.assert_refused(edged("calib", "--target", "checkerboard", "--columns", 8, *print_to), "180 degrees")
        self.assert_refused(edged("calib", "--target", "aprilgrid", "--ratio", 1.5, *print_to), "ratio 1.5")
        self.assert_refused(edged("calib", "--target", "charuco", "--print-target", "target.png"), ".svg or .pdf")
        self.assert_refused(edged("calib", *print_to), "--print-target requires --target", code=2)
        self.assert_refused(edged("calib", "davis240c_ecd", "--rows", 5), "--rows requires --target", code=2)
        self.assert_refused(edged("calib", "davis240c_ecd", "--mode", "frames"),
                            "--mode requires --check, --refine, --target or --imu-noise", code=2)


if __name__ == "__main__":
    PICTURES = pictures_folder()
    unittest.main()
