#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""report.html as its readers meet it: made by the program, opened in headless Chromium where there is one.
Usage: EDGED=path/to/edged report_test.py [--pictures FOLDER]; the option leaves screenshots, light and dark, narrow and wide."""
import html
import json
import re
import shutil
import subprocess
import time
import unittest

from browser import CHROMIUM, Browser, pictures_folder
from program import WithFlight, edged

PICTURES = None

# A page around the report, as a window narrower than 500 px cannot be had; what it finds becomes its text.
PROBE = """<!DOCTYPE html><title>probe</title><body style="margin:0"><iframe src="%s" style="width:%dpx;height:%dpx;border:0"></iframe>
<pre id="found" hidden></pre><script>
const frame = document.querySelector('iframe');
const wait = () => new Promise(done => setTimeout(done, 60));
const key = (element, name) => element.dispatchEvent(new frame.contentWindow.KeyboardEvent('keydown', {key: name, bubbles: true, cancelable: true}));
async function probe() {
  const page = frame.contentDocument, root = page.documentElement, found = {};
  const ink = canvas => canvas.toDataURL();
  const blank = canvas => Object.assign(page.createElement('canvas'), {width: canvas.width, height: canvas.height}).toDataURL() === ink(canvas);
  frame.contentWindow.requestAnimationFrame = draw => setTimeout(draw, 0);  // headless, nothing is shown and none comes
  const span = () => page.getElementById('span').textContent;
  found.ready = root.dataset.ready;
  found.theme = root.dataset.theme;
  found.title = page.title;
  found.width = frame.contentWindow.innerWidth;
  found.too_wide = [...page.querySelectorAll('body *')].filter(e => !e.closest('.scroll, pre') && e.getBoundingClientRect().right > found.width + 0.5).map(e => e.tagName + '.' + e.className);
  found.facts = Object.fromEntries([...page.querySelectorAll('.facts div')].map(e => [e.children[0].textContent, e.children[1].textContent]));
  found.says = [...page.querySelectorAll('.says')].map(e => e.textContent);
  const plots = [...page.querySelectorAll('.plot canvas')], path = page.getElementById('path');
  found.plots = plots.length;
  await wait();
  found.blank = plots.filter(blank).length;
  // In colours of their own, where they are seen beside each other.
  root.style.setProperty('--truth', '#ff00ff'); root.style.setProperty('--run0', '#00ff00');
  for (let k = 0; k < 3; ++k) page.getElementById('theme').click();
  const inked = (canvas, is, width = canvas.width) => {
    const copy = Object.assign(page.createElement('canvas'), {width, height: canvas.height}).getContext('2d', {willReadFrequently: true});
    copy.drawImage(canvas, 0, 0);
    const p = copy.getImageData(0, 0, width, canvas.height).data;
    let n = 0;
    for (let i = 0; i < p.length; i += 4) n += p[i + 3] > 60 && is(p[i], p[i + 1], p[i + 2]);
    return n;
  };
  found.cut = plots.filter(canvas => inked(canvas, () => true, 1)).map(canvas => canvas.ariaLabel);  // an axis whose labels reach the left edge
  found.truth_px = plots.slice(0, 6).map(canvas => inked(canvas, (r, g, b) => Math.min(r, b) > g + 60));
  found.estimate_px = plots.slice(0, 6).map(canvas => inked(canvas, (r, g, b) => g > Math.max(r, b) + 60));
  root.removeAttribute('style');
  for (let k = 0; k < 3; ++k) page.getElementById('theme').click();
  const pictures = [...page.querySelectorAll('.pair > .card')].find(card => card.querySelector('.shots'));
  found.empty = pictures ? (pictures.getBoundingClientRect().bottom - pictures.lastChild.getBoundingClientRect().bottom) / pictures.clientHeight : 0;
  found.spans = [span()];
  plots[0].focus();
  key(plots[0], 'ArrowRight'); await wait(); found.spans.push(span());
  key(plots[0], '+'); await wait(); found.spans.push(span());
  key(plots[0], 'Home'); await wait(); found.spans.push(span());
  found.cursors = [...page.querySelectorAll('.cursor')].filter(e => e.style.display === 'block').length;
  const inks = [ink(path)];
  for (const name of ['ArrowLeft', 'ArrowUp', '+', 't']) { key(path, name); inks.push(ink(path)); }
  found.views = new Set(inks).size;
  const slider = page.getElementById('scrubber'), image = page.querySelector('.shots img');
  slider.value = slider.min; slider.dispatchEvent(new Event('input')); const first = image.src;
  slider.value = slider.max; slider.dispatchEvent(new Event('input')); await wait();
  found.pictures_change = image.src !== first && image.naturalWidth > 100;
  key(plots[0], 'Escape');
  page.getElementById('theme').click();
  found.switched = root.dataset.theme;
  page.getElementById('theme').click();
  found.switched_again = root.dataset.theme;
  page.getElementById('theme').click();
  found.unlabelled = [...page.querySelectorAll('canvas, button, input, img')].filter(e => !(e.getAttribute('aria-label') || e.textContent || e.alt || e.closest('label'))).length;
  document.getElementById('found').textContent = JSON.stringify(found);
}
frame.addEventListener('load', () => setTimeout(probe, 100));
</script></body>
"""


class Page(WithFlight):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.run_folder = cls.flight.parent / "room-fused"
        made = edged("run", cls.flight, "--out", cls.run_folder, "--json", "--quiet", "--set", "packets.max_interval_s=0.03")
        assert made.returncode == 0, made.stderr
        cls.metrics = json.loads(made.stdout)

    def data_of(self, page):
        return json.loads(re.search(r'id="data">(.*?)</script>', page.read_text(), re.S).group(1))

    def test_every_run_leaves_one_that_needs_no_network(self):
        page = self.run_folder / "report.html"
        text = page.read_text()
        self.assertLess(page.stat().st_size, 5_000_000)
        self.assertNotRegex(text, r'(src|href)\s*=\s*"?(https?:)?//')
        self.assertEqual(self.data_of(page)["runs"][0]["metrics"], self.metrics)
        self.assertEqual(self.data_of(page)["runs"][0]["evaluation"]["ate_rmse_m"], self.metrics["ate_rmse_m"])

    def test_the_command_writes_the_same_page_again(self):
        out = self.folder / "page.html"
        made = edged("report", self.run_folder, "--out", out)
        self.assertEqual((made.returncode, made.stdout.strip()), (0, str(out)), made.stderr)
        self.assertEqual(out.read_text(), (self.run_folder / "report.html").read_text())

    def test_only_a_page_is_replaced(self):
        bag = self.folder / "flight.bag"
        bag.write_bytes(b"#ROSBAG V2.0\n")
        self.assert_refused(edged("report", self.run_folder, "--out", bag), str(bag), "exists")
        self.assertEqual(bag.read_bytes(), b"#ROSBAG V2.0\n")

    def test_what_is_no_run_is_refused_in_a_line(self):
        self.assert_refused(edged("report", self.flight), str(self.flight), "not a run folder", "edged run")
        self.assert_refused(edged("report", self.folder / "none"), "none", "not found")
        self.assert_refused(edged("report", self.run_folder, "--out", self.folder / "no" / "x.html"), "x.html", "--out")
        self.assert_refused(edged("report", self.run_folder, "--truth", self.folder / "none.txt"), "none.txt")
        broken = self.folder / "broken"
        shutil.copytree(self.run_folder, broken)
        (broken / "album.json").write_text('{"changes": 3}')
        self.assert_refused(edged("report", broken), "broken", "json")

    def probe(self, page, width, dark=False):
        """What the page holds and does at that width; no word of it on the console."""
        if not CHROMIUM:
            self.skipTest("no chromium here: apt-get install chromium")
        around = self.folder / "around.html"
        around.write_text(PROBE % (html.escape(page.as_uri()), width, 900))
        flags = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--hide-scrollbars", "--enable-logging=stderr",
                 "--allow-file-access-from-files", f"--user-data-dir={self.folder / 'profile'}",
                 f"--blink-settings=preferredColorScheme={0 if dark else 1}"]
        done = subprocess.run([CHROMIUM, *flags, f"--window-size={max(width, 500)},900", "--virtual-time-budget=8000", "--dump-dom",
                               around.as_uri()], capture_output=True, text=True, check=False, timeout=180)
        self.assertEqual([line for line in done.stderr.splitlines() if "CONSOLE" in line], [])
        found = re.search(r'<pre id="found" hidden="">(.*?)</pre>', done.stdout, re.S)
        self.assertTrue(found and found.group(1), done.stderr[-2000:])
        if PICTURES:
            name = f"{page.stem}-{width}-{'dark' if dark else 'light'}.png"
            around.write_text(PROBE % (html.escape(page.as_uri()), width, 5200))
            subprocess.run([CHROMIUM, *flags, f"--window-size={max(width, 500)},5200", "--virtual-time-budget=8000",
                            f"--screenshot={PICTURES / name}", around.as_uri()], capture_output=True, check=True, timeout=180)
        return json.loads(html.unescape(found.group(1)))

    def assert_works(self, found, width, theme):
        self.assertEqual((found["ready"], found["theme"], found["width"]), ("yes", theme, width))
        self.assertEqual(found["too_wide"], [])
        self.assertGreaterEqual(found["plots"], 20)
        self.assertEqual(found["blank"], 0)
        self.assertLess(found["empty"], 0.2)  # of the camera card
        self.assertEqual(found["cut"], [])
        whole, with_cursor, zoomed, back = found["spans"]
        self.assertTrue("cursor" in with_cursor and with_cursor.startswith(whole))
        self.assertNotEqual(zoomed.split(",")[0], whole)
        self.assertEqual(back.split(",")[0], whole)
        self.assertEqual(found["cursors"], found["plots"])  # linked
        self.assertEqual(found["views"], 5)  # each key shows the path from elsewhere
        self.assertTrue(found["pictures_change"])
        self.assertEqual((found["switched"], found["switched_again"]), ("light", "dark"))
        self.assertEqual(found["unlabelled"], 0)

    def test_it_works_in_a_browser_narrow_and_wide_light_and_dark(self):
        page = self.run_folder / "report.html"
        for width, dark in ((360, False), (1600, False), (360, True), (1600, True)):
            found = self.probe(page, width, dark)
            self.assert_works(found, width, "dark" if dark else "light")
            self.assertEqual(found["says"], [self.metrics["verdict"]])
            facts = found["facts"]
            self.assertEqual(float(facts["ATE (RMSE)"].split()[0]), round(1e3 * self.metrics["ate_rmse_m"], 2))
            self.assertEqual(facts["path"], f"{self.metrics['evaluation']['path_length_m']:.2f} m (true)")
            self.assertEqual(facts["duration"], f"{self.metrics['duration_s']:.1f} s")
            self.assertEqual(facts["losses"], "none")
            self.assertEqual(facts["poses, keyframes"], f"{self.metrics['poses']}, {self.metrics['keyframes']}")

    def test_ground_truth_is_seen_beside_the_estimate_that_it_agrees_with(self):
        found = self.probe(self.run_folder / "report.html", 1400)
        for truth, estimate in zip(found["truth_px"], found["estimate_px"]):
            self.assertGreater(estimate, 200)
            self.assertGreater(truth, estimate)

    def test_its_links_save_the_trajectories(self):
        if not CHROMIUM:
            self.skipTest("no chromium here: apt-get install chromium")
        saved = self.folder / "saved"
        browser = Browser(self.folder / "profile")
        self.addCleanup(browser.close)
        browser.call("Page.setDownloadBehavior", behavior="allow", downloadPath=str(saved))
        browser.open((self.run_folder / "report.html").as_uri())
        browser.wait_for("document.documentElement.dataset.ready === 'yes'")
        for name in ("trajectory.tum", "trajectory_final.tum"):
            browser.value(f"[...document.querySelectorAll('.downloads a')].find(e => e.textContent === '{name}').click()")
            file, until = saved / f"room-fused-{name}", time.monotonic() + 30
            while not file.exists() and time.monotonic() < until:
                time.sleep(0.1)
            self.assertEqual(file.read_bytes(), (self.run_folder / name).read_bytes())
        self.assertEqual(browser.value("downloads({trajectories: {'long.tum': null}}).textContent"),
                         "Save: long.tum (in the run folder: too large for this page)")
        self.assertEqual(browser.value("[tickText(400, 100), tickText(4000, 1000)]"), ["400", "4k"])
        self.assertEqual(browser.complaints, [])

    def test_dense_points_and_voxels_are_shown_as_the_boxes_say(self):
        if not CHROMIUM:
            self.skipTest("no chromium here: apt-get install chromium")
        out = self.folder / "run"
        made = edged("run", self.flight, "--mode", "frames", "--dense", "--occupancy", self.folder / "space", "--out", out, "--quiet")
        self.assertEqual(made.returncode, 0, made.stderr)
        points, voxels = (int((out / name).read_bytes().split(b"element vertex ")[1].split()[0]) for name in ("dense.ply", "voxels.ply"))
        self.assertGreater(min(points, voxels), 100)
        browser = Browser(self.folder / "profile")
        self.addCleanup(browser.close)
        browser.show(1400, 900)
        browser.open((out / "report.html").as_uri())
        browser.wait_for("document.documentElement.dataset.ready === 'yes'")
        self.assertEqual(browser.value("document.getElementById('drawn').textContent"),
                         f"{points} of {points} dense points are in this page. {voxels} of {voxels} occupied voxels are in this page.")
        view = "document.getElementById('path').toDataURL()"
        seen = [browser.value(view)]
        for box in ("dense points", "occupied voxels", "coloured by height", "fit the map"):
            browser.value(f"[...document.querySelectorAll('label')].find(e => e.textContent === '{box}').click()")
            seen.append(browser.value(view))
            if PICTURES:
                browser.picture(PICTURES / f"space-{len(seen)}.png")
        self.assertEqual(len(set(seen)), 4)  # voxels have no other colour than that of their height
        self.assertEqual(browser.complaints, [])

    def test_damaged_points_are_refused_in_a_line(self):
        broken = self.folder / "broken"
        shutil.copytree(self.run_folder, broken)
        (broken / "dense.ply").write_bytes(b"ply\nformat binary_little_endian 1.0\nelement vertex 9\n")
        self.assert_refused(edged("report", broken), "dense.ply", "damaged", "run it again")

    def test_several_runs_stand_side_by_side(self):
        second, out = self.folder / "room-events", self.folder / "both.html"
        edged("run", self.flight, "--mode", "events", "--out", second, "--quiet")
        shutil.copy(self.run_folder / "trajectory.tum", self.folder / "other.tum")
        made = edged("report", self.run_folder, second, self.folder / "other.tum", "--out", out)
        self.assertEqual(made.returncode, 0, made.stderr)
        found = self.probe(out, 1000)
        self.assert_works(found, 1000, "light")
        self.assertEqual(len(found["says"]), 3)
        self.assertIn("other.tum", found["title"])

    def test_names_are_text(self):
        page = self.folder / "page.html"
        shutil.copytree(self.run_folder, self.folder / "run")
        metrics = dict(self.metrics, recording="<img src=x onerror=alert(1)></script><script>throw 1</script>&{{css}}")
        (self.folder / "run" / "metrics.json").write_text(json.dumps(metrics))
        self.assertEqual(edged("report", self.folder / "run", "--out", page).returncode, 0)
        self.assertIn(metrics["recording"], self.probe(page, 800)["title"])

    def test_a_run_without_truth_or_without_an_end_is_shown(self):
        bare, killed = self.folder / "bare", self.folder / "killed"
        flight = self.folder / "flight"
        shutil.copytree(self.flight, flight)
        (flight / "groundtruth.txt").unlink()
        self.assertIn(edged("run", flight, "--out", bare, "--quiet").returncode, (0, 5))
        found = self.probe(bare / "report.html", 700)
        self.assertEqual(found["facts"]["ATE (RMSE)"], "no ground truth to compare with")
        self.assertIn("(estimated)", found["facts"]["path"])
        shutil.copytree(bare, killed)
        for name in ("metrics.json", "timing.json", "report.html", "groundtruth.tum", "calibration_found.yaml"):
            (killed / name).unlink(missing_ok=True)
        self.assertEqual(edged("report", killed).returncode, 0)
        self.assertIn("ended before", self.probe(killed / "report.html", 700)["says"][0])

    def test_a_run_without_any_pose_is_shown(self):
        out = self.folder / "short"
        self.assertEqual(edged("run", "sim:room:2", "--to", "0.2", "--out", out, "--quiet").returncode, 4)
        found = self.probe(out / "report.html", 700)
        self.assertEqual(found["says"], [json.loads((out / "metrics.json").read_text())["verdict"]])
        self.assertEqual(found["facts"]["first good pose"], "never")


if __name__ == "__main__":
    PICTURES = pictures_folder()
    unittest.main(verbosity=2)
