#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""`edged show` as its users meet it: pictures, and the page that plays, in headless Chromium where there is one.
Usage: EDGED=path/to/edged show_test.py [--pictures FOLDER]; the option leaves screenshots, light and dark, narrow and wide."""
import csv
import json
import re
import shutil
import unittest

from browser import CHROMIUM, Browser, pictures_folder
from program import WithFlight, edged

PICTURES = None
TOO_WIDE = "[...document.querySelectorAll('body *')].filter(e => e.getBoundingClientRect().right > innerWidth + 0.5).length"
PRESS = "document.dispatchEvent(new KeyboardEvent('keydown', {key: '%s', bubbles: true}))"


class Show(WithFlight):
    def bare(self):
        """The recording without IMU and calibration."""
        copy = self.folder / "bare"
        shutil.copytree(self.flight, copy)
        for name in ("imu.txt", "calib.txt", "calibration.yaml"):
            (copy / name).unlink()
        return copy

    def data_of(self, page):
        return json.loads(re.search(r'id="data">(.*?)</script>', page.read_text(), re.S).group(1))

    def test_pictures_need_neither_imu_nor_calibration(self):
        out = self.folder / "pictures"
        made = edged("show", self.bare(), "--geometry", "240x180", "--duration", 1, "--window", 0.1, "--out", out, "--json", "--quiet")
        self.assertEqual((made.returncode, made.stderr), (0, ""))
        rows = list(csv.DictReader((out / "pictures.csv").open()))
        self.assertEqual(len(rows), json.loads(made.stdout)["pictures"])
        self.assertIn(len(rows), (9, 10))
        for row in rows:
            self.assertEqual((out / row["file"]).read_bytes()[1:4], b"PNG")
            self.assertEqual(int(row["end_ns"]) - int(row["begin_ns"]), 100_000_000)
        self.assertTrue((out / rows[-1]["frame"]).exists())

    def test_a_folder_has_a_bound_that_is_said(self):
        made = edged("show", self.flight, "--events", 1000, "--max-pictures", 3, "--out", self.folder / "few", "--quiet")
        self.assertEqual(made.returncode, 0)
        self.assertIn("--max-pictures", made.stdout)
        self.assertEqual(len(list((self.folder / "few").glob("events_*.png"))), 3)

    def test_a_page_holds_all_events_or_says_what_it_leaves_out(self):
        whole, small = self.folder / "whole.html", self.folder / "small.html"
        self.assertEqual(edged("show", self.flight, "--out", whole, "--quiet").returncode, 0)
        self.assertEqual(sum(p["events"] for p in self.data_of(whole)["pictures"]), self.simulated["events"])
        made = edged("show", self.flight, "--out", small, "--max-mb", 0.5, "--quiet")
        self.assertIn("--start", made.stdout)
        self.assertLess(small.stat().st_size, 700_000)
        self.assertNotRegex(whole.read_text(), r'(src|href)\s*=\s*"?(https?:)?//')

    def test_what_cannot_be_shown_is_refused_in_a_line(self):
        self.assert_refused(edged("show", self.folder, "--out", self.folder / "x.html"), str(self.folder))
        self.assert_refused(edged("show", self.flight, "--out", "/proc/x", "--quiet"), "/proc/x", "--out")
        for window in (0, 1e-10, 1e12, "nan"):
            self.assert_refused(edged("show", self.flight, "--window", window, "--out", "x.html"), "--window", code=2)

    @unittest.skipUnless(CHROMIUM, "no chromium here: apt-get install chromium")
    def test_it_plays_in_a_browser_narrow_and_wide_light_and_dark(self):
        page = self.folder / "page.html"
        self.assertEqual(edged("show", self.flight, "--out", page, "--quiet").returncode, 0)
        browser = Browser(self.folder / "profile")
        self.addCleanup(browser.close)
        for width, dark in ((360, False), (1600, False), (360, True), (1600, True)):
            browser.show(width, 900, dark)
            browser.open(page.as_uri())
            browser.wait_for("document.documentElement.dataset.ready === 'yes' && document.getElementById('events').width === 240")
            browser.value("time.point(3)")
            browser.wait_for("document.querySelector('figcaption').textContent.includes('3.0')")
            ink = "document.getElementById('events').toDataURL()"
            polarity = browser.value(ink)
            browser.value(PRESS % "p")
            self.assertNotEqual(browser.value(ink), polarity)
            self.assertEqual(browser.value(TOO_WIDE), 0)
            before = browser.value("time.cursor")
            browser.value(PRESS % ".")
            self.assertGreater(browser.value("time.cursor"), before)
            if PICTURES:
                browser.picture(PICTURES / f"show-{width}-{'dark' if dark else 'light'}.png")
        browser.value(PRESS % " ")
        self.assertEqual(browser.value("document.getElementById('play').textContent"), "Pause")
        browser.wait_for("time.cursor > 3.1")
        browser.value(PRESS % " ")
        self.assertEqual(browser.value("document.getElementById('play').textContent"), "Play")
        self.assertEqual(browser.complaints, [])


if __name__ == "__main__":
    PICTURES = pictures_folder()
    unittest.main(verbosity=2)
