#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""The live page as its viewers meet it: `edged run --serve` with one that listens, one that never reads, and headless Chromium
where there is one. Usage: EDGED=path/to/edged live_page_test.py [--pictures FOLDER]; the option leaves screenshots."""
import base64
import contextlib
import json
import re
import signal
import socket
import subprocess
import threading
import time
import unittest
import urllib.error
import urllib.request

from browser import CHROMIUM, Browser, pictures_folder
from program import EDGED, WithFlight, edged

PICTURES = None
FACTS = "Object.fromEntries([...document.querySelectorAll('.facts div')].map(e => [e.children[0].textContent, e.children[1].textContent]))"
TOO_WIDE = "[...document.querySelectorAll('body *')].filter(e => !e.closest('.scroll, pre') && e.getBoundingClientRect().right > innerWidth + 0.5).length"


def get(url):
    with urllib.request.urlopen(url, timeout=30) as answer:
        return answer.read(), answer.headers


class Listener(threading.Thread):
    """Reads /events until the program says that the run is over; `fetch` is asked for then, as a browser would."""

    def __init__(self, url, fetch=()):
        super().__init__()
        self.url, self.fetch, self.updates, self.end, self.fetched = url, fetch, [], None, {}
        self.start()

    def run(self):
        with urllib.request.urlopen(self.url + "events", timeout=60) as stream:
            kind = "message"
            for line in stream:
                if line.startswith(b"event: "):
                    kind = line[7:].strip().decode()
                elif line.startswith(b"data: ") and kind == "message":
                    self.updates.append(json.loads(line[6:]))
                elif line.startswith(b"data: "):
                    self.end = json.loads(line[6:])
                    self.fetched = {name: get(self.url + name)[0] for name in self.fetch}
                    return


class LivePage(WithFlight):
    @contextlib.contextmanager
    def serving(self, *args):
        """The program with a page at the url; it is over when the block has been left. A slow machine leaves nothing out."""
        process = subprocess.Popen([EDGED, "run", str(self.flight), "--serve=0", "--quiet", "--json", "--out", str(self.folder / "run"),
                                    "--set", "live.max_age_s=3600", *map(str, args)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        try:
            line = process.stderr.readline()
            found = re.fullmatch(r"edged: watch at (http://127\.0\.0\.1:\d+/)\n", line)
            self.assertTrue(found, line)
            yield process, found.group(1)
            self.stdout, self.stderr = process.communicate(timeout=60)
        finally:
            process.kill()
            process.communicate()
        self.assertEqual(self.stderr, "")

    def metrics(self):
        return json.loads((self.folder / "run" / "metrics.json").read_text())

    def test_who_listens_is_told_all_in_order_and_at_the_end_what_metrics_json_says(self):
        with self.serving("--live") as (process, url):
            listener = Listener(url, ["report.html"])
            listener.join()
        self.assertEqual(process.returncode, 0)
        metrics = self.metrics()
        self.assertEqual((listener.end, json.loads(self.stdout)), (metrics, metrics))
        self.assertEqual(listener.fetched["report.html"], (self.folder / "run" / "report.html").read_bytes())
        updates = listener.updates
        self.assertGreater(len(updates), 5)
        times = [update["t"] for update in updates]
        self.assertEqual(times, sorted(times))
        rows = {"t": [], "x": []}
        for update in updates:
            self.assertEqual(update["rows_from"], len(rows["t"]))
            for name, values in rows.items():
                values += update["rows"][name]
        self.assertEqual(rows["t"], sorted(set(rows["t"])))
        self.assertEqual(len(rows["t"]), metrics["packets"])
        self.assertEqual(sum(x is not None for x in rows["x"]), metrics["poses"])
        for name in ("poses", "keyframes", "packets", "coverage", "first_good_s", "times_lost", "duration_s"):
            self.assertEqual(updates[-1]["progress"][name], metrics[name], name)
        self.assertTrue(any(update.get("map") for update in updates))
        self.assertEqual(updates[-1]["changes"][-1]["status"], "Good")

    def test_dense_points_come_while_it_goes_on_each_once(self):
        with self.serving("--live", "--mode", "frames", "--dense") as (_, url):
            listener = Listener(url)
            listener.join()
        told = 0
        for dense in [update["dense"] for update in listener.updates if "dense" in update]:
            self.assertEqual((dense["halved"], dense["from"]), (0, told))
            told += len(base64.b64decode(dense["grey"]))
            self.assertEqual(len(base64.b64decode(dense["xyz"])), 6 * len(base64.b64decode(dense["grey"])))
            self.assertLessEqual(told, dense["all"])
        self.assertGreater(told, 1000)

    def test_occupied_voxels_come_while_it_goes_on(self):
        with self.serving("--live", "--mode", "frames", "--occupancy", self.folder / "space") as (_, url):
            listener = Listener(url)
            listener.join()
        voxels = [update["voxels"] for update in listener.updates if "voxels" in update]
        self.assertGreater(len(voxels), 0)
        self.assertEqual(len(base64.b64decode(voxels[-1]["xyz"])), 6 * voxels[-1]["all"])
        self.assertEqual(voxels[-1]["edge_m"], 0.05)

    def test_the_rows_are_those_of_the_report(self):
        with self.serving("--live", "--duration", 2) as (_, url):
            listener = Listener(url)
            listener.join()
        page = (self.folder / "run" / "report.html").read_text()
        rows = json.loads(re.search(r'id="data">(.*?)</script>', page, re.S).group(1))["runs"][0]["rows"]
        told = listener.updates[0]["rows"]
        self.assertEqual({name for name in rows if not re.match("true_|error_m|rotation_error", name)}, set(told))
        for name in ("t", "status", "yaw", "vx", "bgx", "event_tracks", "depth", "sigma3_x"):  # positions are laid onto the truth there
            self.assertEqual(rows[name][:len(told[name])], told[name], name)

    def test_the_same_bits_with_and_without(self):
        edged("run", self.flight, "--quiet", "--out", self.folder / "alone")
        with self.serving() as (_, url):
            Listener(url, ["report.html"]).join()
        self.assertIn("live page: at most 1 viewers at once", (self.folder / "run" / "run.log").read_text())
        for name in ("states.csv", "trajectory.tum"):
            self.assertEqual((self.folder / "run" / name).read_bytes(), (self.folder / "alone" / name).read_bytes())

    def test_one_who_never_reads_and_one_who_never_asks_hold_up_nothing(self):
        with self.serving("--live", "--duration", 2) as (process, url):
            address = ("127.0.0.1", int(re.search(r"\d+(?=/$)", url).group(0)))
            with socket.socket() as deaf, socket.create_connection(address):
                deaf.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1)
                deaf.connect(address)
                deaf.sendall(b"GET /events HTTP/1.1\r\nHost: x\r\n\r\n")
                listener = Listener(url)
                listener.join()
                process.wait(timeout=30)
        self.assertEqual(listener.updates[-1]["progress"]["packets"], self.metrics()["packets"])
        self.assertIn("live page: at most 2 viewers at once", (self.folder / "run" / "run.log").read_text())

    def test_pictures_are_there_for_those_who_ask(self):
        with self.serving("--live", "--duration", 3) as (_, url):
            with self.assertRaises(urllib.error.HTTPError) as refused:
                get(url + "report.html")
            self.assertEqual(refused.exception.code, 404)
            page, headers = get(url)
            self.assertIn("text/html", headers["Content-Type"])
            self.assertIn(b"new EventSource", page)
            listener = Listener(url, ["frame.jpg", "events.jpg"])
            listener.join()
        for name in ("frame.jpg", "events.jpg"):
            self.assertEqual(listener.fetched[name][:3], b"\xff\xd8\xff")

    def test_ctrl_c_is_told_and_leaves_complete_files(self):
        with self.serving("--live") as (process, url):
            listener = Listener(url, ["report.html"])
            while not listener.updates:
                time.sleep(0.01)
            process.send_signal(signal.SIGINT)
            listener.join()
        self.assertEqual(process.returncode, 130)
        self.assertEqual(listener.end["status"], "interrupted")
        self.assertEqual(listener.end, self.metrics())
        self.assertIn(b"interrupted", listener.fetched["report.html"])

    def test_what_cannot_be_served_is_refused_in_a_line(self):
        with socket.socket() as taken:
            taken.bind(("127.0.0.1", 0))
            taken.listen()
            port = taken.getsockname()[1]
            self.assert_refused(edged("run", self.flight, f"--serve={port}", "--out", self.folder / "run"), "--serve", str(port),
                                "in use", "--serve=0")
        self.assertFalse((self.folder / "run").exists())
        self.assert_refused(edged("run", self.flight, "--serve=192.0.2.1:8000"), "--serve", "192.0.2.1:8000")
        self.assert_refused(edged("run", self.flight, "--serve=eighty"), "--serve", "'eighty'", "--serve=8765", code=2)
        self.assert_refused(edged("run", self.flight, "--serve=70000"), "--serve", "70000", code=2)
        self.assert_refused(edged("run", self.flight, self.flight, "--serve"), "--serve", "one recording", code=2)
        self.assert_refused(edged("run", self.flight, "--serve", "9000"), "--serve=PORT", code=2)

    def watch(self, browser, width, dark):
        browser.show(width, 900, dark)
        browser.wait_for(f"innerWidth === {width} && document.documentElement.dataset.theme === '{'dark' if dark else 'light'}'")
        self.assertEqual(browser.value(TOO_WIDE), 0)
        if PICTURES:
            over = browser.value("document.getElementById('live') === null")
            browser.picture(PICTURES / f"{'over' if over else 'live'}-{width}-{'dark' if dark else 'light'}.png")

    @unittest.skipUnless(CHROMIUM, "no chromium here: apt-get install chromium")
    def test_a_browser_shows_it_while_it_goes_on_and_keeps_the_report(self):
        browser = Browser(self.folder / "profile")
        self.addCleanup(browser.close)
        views = [(width, dark) for width in (360, 1600) for dark in (False, True)]
        browser.show(1600, 900)
        with self.serving("--live", "--dense") as (_, url):
            browser.open(url)
            browser.wait_for("document.querySelector('.says')?.textContent === 'Running, with a good pose.'")
            browser.wait_for("/^[1-9].* dense points/.test(document.getElementById('drawn').textContent)")
            browser.wait_for("document.querySelectorAll('.shot img').length === 2 && [...document.images].every(i => i.naturalWidth > 100)")
            before = browser.value(FACTS)
            self.assertGreaterEqual(browser.value("document.querySelectorAll('.plot canvas').length"), 20)
            for width, dark in views:
                self.watch(browser, width, dark)
            browser.wait_for(f"{FACTS}.time !== '{before['time']}'")
        browser.wait_for("document.getElementById('live') === null && document.querySelector('.says') !== null")
        metrics, facts = self.metrics(), browser.value(FACTS)
        self.assertIn("nothing contradicts the result", browser.value("document.querySelector('.says').textContent"))
        self.assertEqual(float(facts["ATE (RMSE)"].split()[0]), round(1e3 * metrics["ate_rmse_m"], 2))
        self.assertEqual(facts["duration"], f"{metrics['duration_s']:.1f} s")
        self.assertEqual(facts["poses, keyframes"], f"{metrics['poses']}, {metrics['keyframes']}")
        self.assertEqual(facts["coverage"], f"{100 * metrics['coverage']:.1f} % of the time Good")
        self.assertIn("report.html", browser.value("document.getElementById('footer').textContent"))
        for width, dark in views:
            self.watch(browser, width, dark)
        self.assertEqual(browser.complaints, [])

    @unittest.skipUnless(CHROMIUM, "no chromium here: apt-get install chromium")
    def test_a_browser_says_when_the_program_is_gone(self):
        browser = Browser(self.folder / "profile")
        self.addCleanup(browser.close)
        with self.serving("--live") as (process, url):
            browser.open(url)
            browser.wait_for("document.querySelector('.facts div') !== null")
            process.kill()
        browser.wait_for("document.querySelector('.says').textContent.includes('does not answer')")
        self.assertIn("time", browser.value(FACTS))


if __name__ == "__main__":
    PICTURES = pictures_folder()
    unittest.main(verbosity=2)
