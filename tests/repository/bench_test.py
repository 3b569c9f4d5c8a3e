#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""The benchmarks of bench/ and tests/stress on recordings of a few seconds: that they run, go on where they stopped, and write
their tables.
Usage: EDGED=path/to/edged bench_test.py"""
import importlib.machinery
import importlib.util
import math
import os
import pathlib
import re
import shutil
import statistics
import subprocess
import sys
import tarfile
import tempfile
import types
import unittest
import unittest.mock

BENCH = pathlib.Path(__file__).resolve().parents[2] / "bench"
sys.path[:0] = [str(BENCH), str(BENCH.parent / "tests/program")]
import harness  # noqa: E402
from browser import CHROMIUM, Browser  # noqa: E402


def bench(name, *args):
    return subprocess.run([sys.executable, BENCH / name, *map(str, args)], capture_output=True, text=True, check=False,
                          timeout=500)


def script(name):
    """A benchmark as a module."""
    loader = importlib.machinery.SourceFileLoader(name, str(BENCH / name))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(name, loader))
    sys.modules[name] = module  # where dataclasses look
    loader.exec_module(module)
    return module


class Bench(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="edged_bench_"))
        self.addCleanup(shutil.rmtree, self.folder)

    def test_every_benchmark_tells_what_it_does(self):
        for name in ("ablation", "datasets", "edges", "external", "figures", "flights", "mirrors", "reading", "real", "revisits", "silence", "sim_suite", "space", "speed", "starts",
                     "tracks", "../tests/stress"):
            self.assertIn("usage", bench(name, "--help").stdout)

    def test_stress_judges_a_run_by_what_is_expected_of_its_disturbance(self):
        args = ["../tests/stress", "--cache", self.folder, "--disturbances", "imu-gap", "--modes", "fused", "--seeds", 1]
        first = bench(*args)
        self.assertIn("| imu-gap ", first.stdout, first.stderr)
        self.assertEqual(first.returncode, 1 if "Not as expected" in first.stdout else 0)
        self.assertEqual((self.folder / "table.md").read_text(), first.stdout)
        runs = {file: file.stat().st_mtime_ns for file in self.folder.rglob("metrics.json")}
        self.assertEqual(len(runs), 1)
        self.assertEqual(bench(*args).stdout, first.stdout)
        self.assertEqual({file: file.stat().st_mtime_ns for file in self.folder.rglob("metrics.json")}, runs)

    def test_space_draws_the_same_again_and_another_range_changes_no_other_value(self):
        space = script("space")
        first = space.values_of(1, 7)
        self.assertEqual(space.values_of(1, 7), first)
        self.assertNotEqual(space.values_of(2, 7), first)
        with unittest.mock.patch.dict(space.RANGES, light=space.even(2.0, 3.0)):
            other = space.values_of(1, 7)
        self.assertTrue(2.0 < other.pop("light") < 3.0)
        self.assertEqual(other, {name: value for name, value in first.items() if name != "light"})

    def test_space_shrinks_a_draw_to_the_options_with_which_it_fails_in_the_same_way(self):
        space = script("space")
        draw = space.Draw(types.SimpleNamespace(seed=1, duration=12.0), 7)

        def fly(_, folder, groups, modes, step):
            if "camera" in groups and "scene" not in groups:
                raise harness.ProgramError("these do not go together")
            return {mode: {"classes": ["lost"] if {"rest", "light"} <= set(groups) else ["late"]} for mode in modes}, 1.0

        with unittest.mock.patch.object(space, "fly", fly):
            self.assertEqual(space.shrunk(draw, self.folder, "fused", ["lost", "silent"], lambda what: None), ["rest", "light"])

    def test_space_prints_a_line_a_mode_and_keeps_what_it_has_drawn(self):
        args = ["space", "--draw", 5, "--duration", 2, "--modes", "frames", "--calibration", "hasty", "--json", self.folder / "draws.jsonl"]
        first = bench(*args)
        self.assertEqual(first.returncode, 0, first.stderr)
        self.assertRegex(first.stdout, r"draw 5, [\w -]+: edged simulate --preset \w+ --seed \d+ --duration 2 ")
        self.assertRegex(first.stdout, r"  frames: .*; edged run \S+ --mode frames --calib \S+-hasty.yaml\n")
        self.assertRegex(first.stdout, r"\| any of these +\| \d of 1, ")
        drawn = (self.folder / "draws.jsonl").read_text()
        self.assertEqual(drawn.count("\n"), 1)
        self.assertEqual(bench(*args).stdout, first.stdout)
        self.assertEqual((self.folder / "draws.jsonl").read_text(), drawn)

    def test_external_compares_sensors_and_faults_and_keeps_what_it_has_run(self):
        args = ["external", "--cache", self.folder, "--scenes", "hover", "--variants", "none", "both", "outliers", "--seeds", 1,
                "--duration", 3]
        first = bench(*args)
        self.assertEqual(first.returncode, 0, first.stderr)
        self.assertRegex(first.stdout, r"\| both, outliers \| +\d+ +\|")
        self.assertRegex(first.stdout, r"\| hover \| fused \| none +\|")
        runs = {file: file.stat().st_mtime_ns for file in self.folder.rglob("metrics.json")}
        self.assertEqual(len(runs), 3)
        self.assertEqual(bench(*args).stdout, first.stdout)
        self.assertEqual({file: file.stat().st_mtime_ns for file in self.folder.rglob("metrics.json")}, runs)

    def test_starts_prints_a_row_a_recording_and_keeps_what_it_has_run(self):
        args = ["starts", "--cache", self.folder, "--no-data", "--simulated", "room", "--duration", 4.2, "--modes", "frames",
                "--length", 3, "--least", 3]
        first = bench(*args)
        self.assertEqual(first.returncode, 0, first.stderr)
        self.assertRegex(first.stdout, r"\| room_1_4\.2s +\| frames +\| 2 +\|")
        self.assertEqual((self.folder / "table.md").read_text(), first.stdout)
        runs = {file: file.stat().st_mtime_ns for file in self.folder.rglob("metrics.json")}
        self.assertEqual(len(runs), 2)
        self.assertEqual(bench(*args).stdout, first.stdout)
        self.assertEqual({file: file.stat().st_mtime_ns for file in self.folder.rglob("metrics.json")}, runs)

    def test_starts_leaves_out_what_begins_before_the_mode_has_all_its_streams(self):
        starts = script("starts")
        options = types.SimpleNamespace(edged=None, cache=None, modes=["fused", "frames"], length=3.0, least=3.0, every=1.0)
        extent = (100.0, {"fused": (102.5, 107.0), "frames": (102.05, 106.5)})
        with unittest.mock.patch.object(starts.harness, "extent", return_value=extent):
            found = starts.pieces(options, [("late", "path", None)])
        self.assertEqual([job[3:] for job in found], [("fused", 3.0, 103.0), ("fused", 4.0, 104.0), ("frames", 2.0, 102.0),
                                                      ("frames", 3.0, 103.0)])

    def test_alarms_tells_a_false_alarm_from_what_is_true(self):
        alarms = script("alarms")
        lost, camera = ({"severity": "warning", "text": text} for text in ("lost 1 time, for 0.5 s", "camera events: its rotation"))
        metrics = {"evaluation": {"ate_m": {"mean": 0.001}, "path_length_m": 3.0}, "first_good_s": 0.4, "coverage": 0.95,
                   "status": "not to be trusted", "findings": [lost, camera]}
        self.assertEqual(alarms.alarms_of(metrics), (["warning: camera events: its rotation"], ["warning: lost 1 time, for 0.5 s"]))
        metrics["evaluation"]["ate_m"]["mean"] = 0.5
        self.assertEqual(alarms.alarms_of(metrics)[0], [])

    def test_mirrors_prints_a_row_a_mode_that_has_its_sensors_and_keeps_what_it_has_run(self):
        recording = harness.simulated(harness.DEFAULT_PROGRAM, self.folder, "room", 1, 3)
        (recording / "events.txt").unlink()
        args = ["mirrors", "--cache", self.folder / "cache", "--recordings", recording, "--repeats", 2, "--dim-frames", 0.5]
        first = bench(*args)
        self.assertEqual(first.returncode, 0, first.stderr)
        self.assertRegex(first.stdout, r"\| room_1_3s +\| frames +\|[^\n]+ of 2 +\|")
        self.assertNotRegex(first.stdout, r"\| (fused|events) +\|")
        self.assertIn("frames dimmed to 0.5", first.stdout)
        self.assertIn("--repeats 2", first.stdout)
        self.assertEqual((self.folder / "cache/table.md").read_text(), first.stdout)
        runs = {file: file.stat().st_mtime_ns for file in self.folder.rglob("metrics.json")}
        self.assertEqual(len(runs), 2)
        self.assertEqual(bench(*args).stdout, first.stdout)
        self.assertEqual({file: file.stat().st_mtime_ns for file in self.folder.rglob("metrics.json")}, runs)

    def test_mirrors_counts_runs_that_have_failed_and_holds_fused_against_its_better_part(self):
        mirrors = script("mirrors")
        good = {"evaluation": {"ate_m": {"mean": 0.01}, "path_length_m": 5.0}, "first_good_s": 1.0, "status": "good",
                "coverage": 0.9, "ate_rmse_m": 0.01, harness.LOCAL: 0.002}
        lost = {**good, "status": "lost", "ate_rmse_m": 3.0}
        twice = {**good, "ate_rmse_m": 0.02}
        self.assertAlmostEqual(mirrors.mean_error([good, {**good, "ate_rmse_m": 0.04}, lost]), 20.0)
        self.assertIsNone(mirrors.mean_error([lost]))
        self.assertAlmostEqual(mirrors.over_its_parts({"fused": [twice], "events": [good], "frames": [lost]}), 2.0)
        self.assertIsNone(mirrors.over_its_parts({"fused": [lost], "events": [good], "frames": [good]}))
        short = {**good, harness.LOCAL: None}
        self.assertAlmostEqual(mirrors.mean_error([good, {**good, harness.LOCAL: 0.008}, short, lost], harness.LOCAL), 4.0)
        by_mode = {"fused": [{**twice, harness.LOCAL: 0.001}], "events": [good], "frames": [good]}
        self.assertAlmostEqual(mirrors.over_its_parts(by_mode, harness.LOCAL), 0.5)
        self.assertIsNone(mirrors.over_its_parts({**by_mode, "fused": [short]}, harness.LOCAL))

    def test_sweep_says_how_far_chance_may_have_made_a_ratio(self):
        sweep = script("sweep")
        mean, low, high = sweep.interval([0.5, 0.5, 0.5])
        for value in (mean, low, high):
            self.assertAlmostEqual(value, 0.5)
        mean, low, high = sweep.interval([0.5, 1.0, 2.0])
        self.assertAlmostEqual(mean, 1.0)
        self.assertTrue(0.5 <= low < 0.8 and 1.25 < high <= 2.0, (low, high))
        self.assertEqual(sweep.ratio_cell([(1.0, 2.0)]), "-")

    def test_sweep_leaves_failures_out_of_ratios_and_holds_fused_against_the_better_part(self):
        sweep = script("sweep")
        good = {"evaluation": {"ate_m": {"mean": 0.01}, "path_length_m": 5.0}, "first_good_s": 1.0, "status": "good",
                "coverage": 0.9, "ate_rmse_m": 0.01, harness.LOCAL: 0.004}
        results = {(variant, mode, name): {**good, harness.LOCAL: local}
                   for variant, mode, name, local in (("yardstick", "fused", "a", 0.004), ("x", "fused", "a", 0.002),
                                                      ("x", "frames", "a", 0.002), ("x", "events", "a", 0.009),
                                                      ("x", "fused", "b", 0.003), ("x", "frames", "b", 0.002),
                                                      ("yardstick", "fused", "b", 0.004))}
        results["x", "frames", "c"] = {**good, "status": "lost"}
        keys = [[(variant, "fused", name) for name in "ab"] for variant in ("x", "yardstick")]
        self.assertEqual(sweep.pairs_of(results, *keys, harness.LOCAL), [[0.002, 0.004], [0.003, 0.004]])
        results["x", "fused", "b"]["status"] = "lost"
        self.assertEqual(sweep.pairs_of(results, *keys, harness.LOCAL), [[0.002, 0.004]])
        results["x", "fused", "b"]["status"] = "good"
        self.assertEqual(sweep.fused_row(results, "x", "abc")[2:], ["1.50 (b)", "1 of 2"])

    def test_ablation_holds_a_variant_against_the_defaults_by_the_local_error_too(self):
        ablation = script("ablation")
        usual = {"evaluation": {"ate_m": {"mean": 0.01}, "path_length_m": 5.0}, "first_good_s": 1.0, "status": "good",
                 "coverage": 0.9, "ate_rmse_m": 0.01, "mpe_percent": 0.2, harness.LOCAL: 0.004}
        runs = {("defaults", "a"): usual, ("less", "a"): {**usual, harness.LOCAL: 0.002, "ate_rmse_m": 0.02},
                ("defaults", "b"): usual, ("less", "b"): {**usual, harness.LOCAL: None},
                ("defaults", "c"): {**usual, "status": "lost"}, ("less", "c"): usual}
        results = {(variant, "fused", name): run for (variant, name), run in runs.items()}
        self.assertEqual(ablation.ratios(results, "less", "fused", "abc", harness.LOCAL), [0.5])
        self.assertEqual(ablation.ratios(results, "less", "fused", "abc", "ate_rmse_m"), [2.0, 1.0])
        self.assertEqual(ablation.row(results, "less", "fused", "abc"),
                         ["less", "3.00", "4.00", "0.0100", "0.0200", "0.200", "0.200", "0.50", "1 of 1", "1.41", "0 of 2",
                          "0 of 3"])

    def test_figures_replaces_what_stands_between_the_markers_and_nothing_else(self):
        figures = script("figures")
        text = "before\n<!-- figures: a -->\nold\n<!-- end: a -->\n\n<!-- figures: ab -->\nkept\n<!-- end: ab -->\nafter\n"
        once = figures.replaced(text, "a", "| new |\n")
        self.assertEqual(once, text.replace("\nold\n", "\n\n| new |\n\n"))
        self.assertEqual(figures.replaced(once, "a", "| new |"), once)
        for name, broken in (("b", text), ("a", text + text), ("a", text.replace("<!-- end: a -->", "")),
                             ("a", "<!-- end: a --><!-- figures: a -->")):
            with self.assertRaises(figures.MarkerError):
                figures.replaced(broken, name, "new")

    def test_figures_has_a_place_for_every_part_that_the_page_shows(self):
        figures = script("figures")
        results = (harness.ROOT / figures.RESULTS).read_text()
        for name, part in figures.PARTS.items():
            if part.columns:
                self.assertIn("new content", figures.replaced(results, name, "new content"))
        self.assertEqual(results.count("<!-- figures:"), sum(bool(part.columns) for part in figures.PARTS.values()))
        self.assertLess(len(results.encode()), 15_000)

    def test_the_page_shows_what_the_full_tables_hold(self):
        figures = script("figures")
        results, tables = (harness.ROOT / figures.RESULTS).read_text(), harness.ROOT / figures.TABLES
        for name, part in figures.PARTS.items():
            if not part.columns or not (tables / f"{name}.md").exists():
                continue
            report = (tables / f"{name}.md").read_text()
            with self.subTest(part=name):
                self.assertEqual(figures.replaced(results, name, figures.shown(part, report)), results)
                for column in part.columns:
                    self.assertRegex(report, rf"(?m)^\|.* {re.escape(column)} ")

    def test_figures_shows_of_a_report_what_measured_it_and_some_columns(self):
        figures = script("figures")
        report = ("# Title\n\nedged 1 (abc), 1 May 2026, `bench/x --jobs 2`: words\non words.\n\n"
                  "| name | mode   | ATE | worst | ATE |\n| ---  | ---    | ---: | ---: | ---: |\n"
                  "| a    | fused  | 1   | 2     | 3   |\n| a    | events | 4   | 5     | 6   |\n"
                  "| all  | fused  | 7   | 8     | 9   |\n\nMean: 1.\n\n## Every run\n\n| long |\n\n## Not as expected\n\n- one\n")
        part = figures.Part((), (), ("name", "mode", "ATE"), without=("Every run",))
        head = "edged 1 (abc), 1 May 2026, `bench/x --jobs 2`\n\n"
        rest = "\n\nMean: 1.\n\n### Not as expected\n\n- one"
        self.assertEqual(figures.shown(part, report), head + "| name | mode | ATE |\n| --- | --- | ---: |\n| a | fused | 1 |\n"
                         "| a | events | 4 |\n| all | fused | 7 |" + rest)
        part = figures.Part((), (), ("name", "ATE"), row="(?!all)", names=1, without=("Every run",))
        self.assertEqual(figures.shown(part, report), head + "| name | fused ATE | events ATE |\n| --- | ---: | ---: |\n"
                         "| a | 1 | 4 |" + rest)

    def measured_by_figures(self, name, **made):
        """The folder into which it wrote; made: the benchmark's report and table in the cache."""
        figures = script("figures")
        out, cache, part = self.folder / "out", self.folder / "cache", figures.PARTS[name]
        (out / "docs").mkdir(parents=True)
        (out / figures.RESULTS).write_text((harness.ROOT / figures.RESULTS).read_text())
        if part.table:
            (cache / part.table).parent.mkdir(parents=True, exist_ok=True)
            (cache / part.table).write_text(made["table"])
        options = types.SimpleNamespace(out=out, edged=pathlib.Path(__file__), quick=False, jobs=1, caveats="*Not committed.*\n\n")
        with unittest.mock.patch.object(figures, "run", return_value=made.get("report", "")) as run:
            figures.measure(options, name, {"EDGED_CACHE": str(cache)})
        return figures, out, run.call_args.args[0]

    def test_figures_puts_a_table_into_the_page_and_all_of_it_beside_the_others(self):
        report = "# T\n\nedged 1 (abc), 1 May 2026, `x`: y\n\n| format | read | written |\n| --- | ---: | ---: |\n| bag | 1 | 2 |\n"
        figures, out, command = self.measured_by_figures("reading", report=report)
        self.assertEqual(command, ("bench/reading",))
        self.assertEqual((out / figures.TABLES / "reading.md").read_text(), report.replace("edged", "*Not committed.*\n\nedged"))
        self.assertIn("<!-- figures: reading -->\n\n*Not committed.*\n\nedged 1 (abc), 1 May 2026, `x`\n\n| format | written |\n"
                      "| --- | ---: |\n| bag | 2 |\n\n<!-- end: reading -->", (out / figures.RESULTS).read_text())

    def test_figures_keeps_the_ablation_off_the_page(self):
        figures, out, command = self.measured_by_figures("ablation-filters", table="# Ablation\n\n| new |\n")
        self.assertIn("enhancement", command)
        self.assertEqual((out / figures.TABLES / "ablation-filters.md").read_text(), "# Ablation\n\n*Not committed.*\n\n| new |\n")
        self.assertEqual((out / figures.RESULTS).read_text(), (harness.ROOT / figures.RESULTS).read_text())

    def test_figures_refuses_a_program_that_is_not_what_is_committed(self):
        figures = script("figures")
        for version, words in (("edged 0.1.0", "names no commit"), ("edged 0.1.0 (0123abcd, changed)", "not committed"),
                               ("edged 0.1.0 (00000000)", "not in")):
            self.assertIn(words, figures.what_differs(version))
        self.assertIn("--out", bench("figures", "--quick").stderr)

    @unittest.skipUnless((pathlib.Path(harness.DEFAULT_PROGRAM).parent / "edged_camera_test").exists(), "needs the tests of the build")
    def test_real_names_what_the_data_folder_lacks_and_measures_what_it_has(self):
        self.assertIn("\nNot there: euroc_mh01, ", bench("real", "--data", self.folder, "--cache", self.folder).stdout)
        data = pathlib.Path(os.environ.get("EDGED_DATA", BENCH / "../../shared/data"))
        if not (data / "calib_april").exists():
            self.skipTest("no data")
        result = bench("real", "--data", data, "--cache", self.folder, "--only", "calib_april")
        self.assertIn("\n| April grid, 8 pairs", result.stdout)
        off = re.findall(r"[+-][\d.]+", next(line for line in result.stdout.splitlines() if "less the published" in line))
        self.assertEqual(len(off), 3)
        self.assertLess(max(abs(float(x)) for x in off), 1.0)  # px and mm off the published calibration

    def test_speed_prints_a_row_a_sensor_and_mode(self):
        result = bench("speed", "--no-data", "--sensors", "240x180@1", "--duration", 2.5, "--modes", "frames", "--repeats", 1,
                       "--cache", self.folder)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertRegex(result.stdout, r"\n\| room 240x180 +\| frames +\| [\d.]+ +\| [\d.]+ +(\| *[\d.]+ +){10}\|\n")

    def test_reading_prints_the_fastest_format_first(self):
        found = {"context": {"num_cpus": 2}, "benchmarks": [
            {"name": f"{what}_recording/{name}", "items_per_second": rate}
            for what, name, rate in (("read", "csv", 23e6), ("write", "csv", 5e6), ("read", "raw", 60e6), ("write", "raw", 8e6))]}
        with unittest.mock.patch.object(harness, "call", return_value="edged 0.1.0 (abc)\n"):
            text = script("reading").report(types.SimpleNamespace(edged=None), found)
        self.assertRegex(text, r"(?s)\| raw +\| 60 +\| 8 +\|\n\| csv +\| 23 +\| 5 ")

    def test_tracks_measures_corners_against_the_scene_of_a_simulation(self):
        if not pathlib.Path(harness.DEFAULT_PROGRAM).with_name("edged_tracks").is_file():
            self.skipTest("built without EDGED_BENCH")
        result = bench("tracks", "--cache", self.folder, "--presets", "poster", "--duration", 3, "--modes", "fused")
        self.assertEqual(result.returncode, 0, result.stderr)
        for camera in ("events", "frames"):
            self.assertIn(f"## poster, fused: {camera}", result.stdout)
        observations = script("tracks").read_tracks(next(self.folder.glob("*.csv")))
        # Errors are counted from a corner's first observation on, and a frame moves a corner by far less than a pixel.
        steps = [abs(track[1].error - track[0].error) for track in observations["frames"]]
        self.assertGreater(len(steps), 20)
        self.assertLess(statistics.median(steps), 0.2)

    def test_tracks_finds_a_clock_that_is_late_and_a_camera_that_is_turned(self):
        tracks = script("tracks")
        late_s, turn_z = 2e-3, 0.01

        def observation(k, start):
            t = 0.05 * k
            velocity = complex(60 * math.cos(3 * t + start), 40 * math.sin(2 * t))
            bearing, turned = (0.3 * math.sin(start), 0.2 * math.cos(start)), (0.2 * math.sin(t), 0.1 * t, 0.0)
            lag = -late_s * velocity
            then = tracks.rotated(turned, [0.0, 0.0, 1.0])
            off = tracks.turn(bearing, 200.0, [turn_z * (now - was) for now, was in zip((0.0, 0.0, 1.0), then)])
            return tracks.Observation(t, t, lag + off, 0j, velocity, bearing, 200.0, turned)

        systems = [tracks.normal_equations([tracks.regressors([observation(k, start) for k in range(20)])], ["late", "turn_z"])[0]
                   for start in range(30)]
        found, explained = tracks.fit(systems)
        self.assertAlmostEqual(found[0], late_s, 6)
        self.assertAlmostEqual(found[1], turn_z, 6)
        self.assertAlmostEqual(explained, 1.0, 6)

    def test_edges_places_the_edges_of_the_scene_best_where_events_have_no_errors(self):
        if not pathlib.Path(harness.DEFAULT_PROGRAM).with_name("edged_edges").is_file():
            self.skipTest("built without EDGED_BENCH")
        result = bench("edges", "--cache", self.folder, "--conditions", "room", "--duration", 4)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertRegex(result.stdout, r"(?s)Error \[px\], RMS over the edges of the scene:\n\n.*\n\| room \|")
        edges = script("edges")
        pairs = edges.read_pairs(next(self.folder.glob("*.csv")))
        error = {method: edges.rms(row["error_px"] for row in rows) for method, rows in pairs.items()}
        self.assertLess(error["exact"], 0.06)
        self.assertLess(error["exact"], 0.8 * error["scene"])
        self.assertLess(error["scene"], error["scene/16"])

    def test_a_table_is_left_as_a_page_too(self):
        text = ("# Two & more\n\nmeasured by `edged <x>`, **not** [here](a.md):\n\n| name | ATE [mm] |\n| --- | ---: |\n"
                "| *a* | 3.2 |\n| b | -- |\n\n- one\n  still one\n- two\n\n```bash\nedged | x\n```\n")
        harness.write_table(self.folder / "new/table.md", text)
        self.assertEqual((self.folder / "new/table.md").read_text(), text)
        page = (self.folder / "new/table.html").read_text()
        for piece in ("<title>Two &amp; more</title>", "<code>edged &lt;x&gt;</code>, <b>not</b> <a href=\"a.md\">here</a>",
                      '<tr><th>name</th><th class="right">ATE [mm]</th></tr>', '<tr><td><i>a</i></td><td class="right">3.2</td></tr>',
                      "<li>one\n  still one</li>\n<li>two</li>", "<pre>edged | x\n</pre>"):
            self.assertIn(piece, page)
        self.assertNotIn("http", page)
        harness.write_table(self.folder / "only.html", text)
        self.assertFalse((self.folder / "only.md").exists())

    def test_a_page_sorts_by_the_column_that_is_clicked(self):
        if not CHROMIUM:
            self.skipTest("no chromium")
        rows = "".join(f"| {name} | {value} |\n" for name, value in (("c", "10"), ("a", "*failed*"), ("b", "9.5 (2)")))
        harness.write_table(self.folder / "table.html", "| name | ATE |\n| --- | ---: |\n" + rows)
        tab = Browser(self.folder / "profile")
        self.addCleanup(tab.close)
        tab.open((self.folder / "table.html").as_uri())
        tab.wait_for("document.querySelectorAll('th').length === 2")
        names = "[...document.querySelectorAll('td:first-child')].map((cell) => cell.textContent).join('')"
        for column, order in ((1, "bca"), (1, "cba"), (0, "abc"), (0, "cba")):
            self.assertEqual(tab.value(f"(document.querySelectorAll('th')[{column}].click(), {names})"), order)
        self.assertEqual(tab.complaints, [])

    def test_figures_packs_the_trajectories_of_this_program(self):
        cache = self.folder / "sim_1"
        for run, version in (("mirrors/a", "edged 1 (abc)"), ("mirrors/b", "edged 1 (abc, changed)"), ("flights/c", "edged 1 (abc)")):
            (cache / run).mkdir(parents=True)
            (cache / run / "trajectory.tum").write_text(f"# T_W_B\n# {version}, recording x, mode fused\n0 0 0 0 0 0 0 1\n")
        archive, count = script("figures").pack_trajectories(cache, "edged 1 (abc)")
        self.assertEqual(count, 2)
        with tarfile.open(archive) as tar:
            self.assertEqual(tar.getnames(), ["flights/c/trajectory.tum", "mirrors/a/trajectory.tum"])

    def test_a_run_that_was_interrupted_is_run_again(self):
        (self.folder / "metrics.json").write_text('{"status": "interrupted"}')
        with unittest.mock.patch.object(harness, "estimate", return_value={"status": "good"}) as estimate:
            self.assertEqual(harness.estimate_once(None, "recording", "fused", self.folder), {"status": "good"})
        estimate.assert_called_once()

    def test_a_missing_program_is_one_line(self):
        result = bench("flights", "--edged", self.folder / "none")
        self.assertEqual(result.stderr.strip(), f"{self.folder / 'none'}: no such program; build it, or give --edged")

    def test_ablation_writes_a_table_and_keeps_what_it_has_run(self):
        args = ["ablation", "--out", self.folder, "--parts", "compensation", "--modes", "events", "--presets", "room",
                "--seeds", 1, "--duration", 4, "--no-mirrors"]
        first = bench(*args)
        self.assertEqual(first.returncode, 0, first.stderr)
        table = (self.folder / "table.md").read_text()
        for variant in ("defaults", "compensation none", "compensation single twist"):
            self.assertIn(f"| {variant} ", table)
        self.assertIn("3 of 3, ", first.stderr)
        runs = {file: file.stat().st_mtime_ns for file in self.folder.rglob("metrics.json")}
        self.assertEqual(len(runs), 3)
        self.assertEqual(bench(*args).returncode, 0)
        self.assertEqual({file: file.stat().st_mtime_ns for file in self.folder.rglob("metrics.json")}, runs)

    def test_flights_prints_a_row_a_flight_and_counts_failures(self):
        result = bench("flights", "--cache", self.folder, "--flights", "line", "--modes", "fused", "--duration", 4,
                       "--out", self.folder / "table.md")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("| line ", result.stdout)
        self.assertIn("| Failures ", result.stdout)
        self.assertEqual((self.folder / "table.md").read_text(), result.stdout)
        self.assertIn("<td>line</td>", (self.folder / "table.html").read_text())


if __name__ == "__main__":
    unittest.main(verbosity=2)
