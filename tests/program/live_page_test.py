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
# The empty share of the height of the camera card.
EMPTY = "(card => (card.getBoundingClientRect().bottom - card.lastChild.getBoundingClientRect().bottom) / card.clientHeight)(document.querySelector('.shots').parentNode)"
# What the camera card says before its first picture.
UNFILLED = ("(empty => (document.body.append(empty), [getComputedStyle(empty, '::before').content, empty.remove()][0]))"
            "(Object.assign(document.createElement('div'), {className: 'shots'}))")
TOO_WIDE = "[...document.querySelectorAll('body *')].filter(e => !e.closest('.scroll, pre') && e.getBoundingClientRect().right > innerWidth + 0.5).length"


def address_of(url):
    return "127.0.0.1", int(re.search(r"\d+(?=/$)", url).group(0))


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
    def serving(self, *args, warning=""):
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
        self.assertRegex(self.stderr, f"^{warning}$")

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
            address = address_of(url)
            with socket.socket() as deaf, socket.create_connection(address):
                deaf.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1)
                deaf.connect(address)
                deaf.sendall(b"GET /events HTTP/1.1\r\nHost: localhost\r\n\r\n")
                listener = Listener(url)
                listener.join()
                process.wait(timeout=30)
        self.assertEqual(listener.updates[-1]["progress"]["packets"], self.metrics()["packets"])
        self.assertIn("live page: at most 2 viewers at once", (self.folder / "run" / "run.log").read_text())

    def test_one_who_asks_byte_by_byte_does_not_hold_up_the_end(self):
        def drip(process, connection):
            with contextlib.suppress(OSError):
                connection.sendall(b"GET / HTTP/1.1\r\nX: ")
                while process.poll() is None:
                    connection.sendall(b"x")
                    time.sleep(0.3)

        with self.serving("--live", "--mode", "frames", "--duration", 1) as (process, url):
            connections = [socket.create_connection(address_of(url)) for _ in range(3)]
            for connection in connections:
                threading.Thread(target=drip, args=(process, connection)).start()
            process.wait(timeout=30)
        for connection in connections:
            connection.close()

    def test_what_is_sent_and_what_is_for_another_host_is_refused(self):
        def status(url, request):
            with socket.create_connection(address_of(url)) as connection:
                connection.sendall(request.encode())
                return int(connection.recv(100).split()[1])

        with self.serving("--live", "--duration", 2) as (_, url):
            for host, expected in (("localhost", 200), (url[7:-1], 200), ("[::1]:80", 200), ("192.168.1.2:8765", 200),
                                   ("evil.example:8765", 403), ("127.0.0.1.evil.example", 403), ("", 403)):
                self.assertEqual(status(url, f"GET / HTTP/1.1\r\nHost: {host}\r\n\r\n"), expected, host)
            self.assertEqual(status(url, "GET / HTTP/1.0\r\n\r\n"), 403)
            for method in ("POST", "PUT", "DELETE"):  # before the body has come
                self.assertEqual(status(url, f"{method} /events HTTP/1.1\r\nHost: localhost\r\nContent-Encoding: gzip\r\n"
                                             "Content-Length: 1000000000\r\n\r\n"), 405, method)

    def test_what_it_is_too_slow_for_is_told(self):
        with self.serving("--live", "--set", "live.max_age_s=0.001", warning="(edged: warning: too slow for .*\n)+") as (_, url):
            listener = Listener(url)
            listener.join()
        told = listener.updates[-1]["progress"]["overload"]
        self.assertRegex(told, r"^\d+ % of the (events|frames) dropped$")
        for finding in self.metrics()["findings"]:
            self.assertNotIn("bus", finding["remedy"])
            if finding["text"].startswith("live: "):
                self.assertIn(told, finding["text"])

    def test_too_little_memory_is_told_in_a_line(self):
        for megabytes in range(200, 400, 20):
            result = subprocess.run(["bash", "-c", f'ulimit -v {1024 * megabytes}; exec "$0" "$@"', EDGED, "run", str(self.flight), "--serve=0", "--mode",
                                     "frames", "--duration", "0.5", "--quiet", "--out", str(self.folder / "run"), "--force"],
                                    capture_output=True, text=True, check=False, timeout=60)
            self.assertNotIn("terminate", result.stderr, megabytes)
            if "threads" in result.stderr:
                self.assert_refused(result, "--serve", "ulimit")

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
        self.assertLess(browser.value(EMPTY), 0.2)
        if PICTURES:
            over = browser.value("document.getElementById('live') === null")
            browser.picture(PICTURES / f"{'over' if over else 'live'}-{width}-{'dark' if dark else 'light'}.png")

    @unittest.skipUnless(CHROMIUM, "no chromium here: apt-get install chromium")
    def test_a_browser_shows_it_while_it_goes_on_and_keeps_the_report(self):
        browser = Browser(self.folder / "profile")
        self.addCleanup(browser.close)
        views = [(width, dark) for width in (360, 1600) for dark in (False, True)]
        browser.show(1600, 900)
        self.flight = self.folder / "long"  # the first dense points come after some four seconds
        edged("simulate", "--duration", 10, "--seed", 2, "--out", self.flight, "--quiet")
        with self.serving("--live", "--dense") as (_, url):
            browser.open(url)
            browser.wait_for("document.querySelector('.says')?.textContent === 'Running, with a good pose.'")
            self.assertEqual(browser.value(UNFILLED), '"No picture yet."')
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
    def test_a_browser_says_that_it_is_too_slow(self):
        browser = Browser(self.folder / "profile")
        self.addCleanup(browser.close)
        browser.show(1400, 900)
        with self.serving("--live", "--set", "live.max_age_s=0.001", warning="(edged: warning: too slow for .*\n)+") as (_, url):
            browser.open(url)
            browser.wait_for("/ Too slow: [1-9][0-9]* % of the (events|frames) dropped[.]$/.test(document.querySelector('.says')?.textContent)")
            self.assertNotEqual(browser.value("document.getElementById('live').style.getPropertyValue('--verdict')"), "var(--good)")
            for width in (390, 1400):
                self.watch(browser, width, False)

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
