#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""Runs the program on simulated flights and prints median and worst errors of each mode.

Usage: sim_suite.py [--edged PATH] [--presets room,poster] [--seeds 5] [--duration 20] [--jobs 2] [--set KEY=VALUE]
[--json FILE]. Exits 1 when a run failed: no good pose, lost at some time, not good at its end, or off by a tenth of its
path.
"""
import argparse
import concurrent.futures
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile

MODES = ("events", "frames", "fused")
ROOT = pathlib.Path(__file__).resolve().parent.parent


def call(arguments):
    return subprocess.run([str(a) for a in arguments], check=False, capture_output=True, text=True)


def fly(options, preset, seed):
    """One recording, run in every mode; the summaries, or what went wrong, by mode."""
    with tempfile.TemporaryDirectory(prefix="edged_suite_") as folder:
        recording = pathlib.Path(folder) / "recording"
        simulated = call([options.edged, "simulate", "--preset", preset, "--seed", seed, "--duration", options.duration,
                          "--out", recording, "--quiet"])
        if simulated.returncode != 0:
            sys.exit(f"simulate {preset} {seed}: {simulated.stderr.strip()}")
        runs = {}
        for mode in options.modes:
            run = call([options.edged, "run", recording, "--mode", mode, "--out", pathlib.Path(folder) / mode, "--json",
                        "--quiet", *options.set])
            runs[mode] = json.loads(run.stdout) if run.stdout.startswith("{") else {"error": run.stderr.strip()}
        return runs


def failure(run):
    """Why a run counts as failed, or ''."""
    if "error" in run:
        return run["error"]
    if run["ate_rmse_m"] is None:
        return run["status"]
    if run["times_lost"] > 0 or run["status"] != "good":
        return f"{run['status']}, lost {run['times_lost']} times"
    if run["mpe_percent"] > 10.0:
        return f"{run['mpe_percent']:.1f} % of the path"
    return ""


def row(preset, mode, runs):
    """One line of the table, and the failures behind it."""
    failures = [f"{preset} {seed} {mode}: {why}" for seed, run in runs if (why := failure(run))]
    scored = [run for _, run in runs if run.get("ate_rmse_m") is not None]
    if not scored:
        return f"{preset:<11}{mode:<8}" + "-".rjust(10), failures
    cells = []
    for key, factor, digits in (("ate_rmse_m", 1e3, 1), ("mpe_percent", 1, 3)):
        values = [factor * run[key] for run in scored]
        cells += [f"{statistics.median(values):.{digits}f}", f"{max(values):.{digits}f}"]
    scale = [100.0 * abs(run["scale"] - 1.0) for run in scored]
    cells += [f"{statistics.median(scale):.2f}", f"{max(scale):.2f}"]
    cells += [f"{min(run['coverage'] for run in scored):.3f}",
              f"{statistics.median(run['cpu_s_per_s'] for run in scored):.2f}", f"{len(failures)}/{len(runs)}"]
    return f"{preset:<11}{mode:<8}" + "".join(cell.rjust(10) for cell in cells), failures


def parse():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--edged", default=os.environ.get("EDGED", ROOT / "build" / "release" / "bin" / "edged"))
    parser.add_argument("--presets", default="room,poster,dark", help="comma separated")
    parser.add_argument("--modes", default=",".join(MODES), help="comma separated")
    parser.add_argument("--seeds", type=int, default=5, help="1 to this")
    parser.add_argument("--duration", type=float, default=20.0, help="[s]")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--set", action="append", default=[], help="option of every run, KEY=VALUE; may be repeated")
    parser.add_argument("--json", help="file for all summaries")
    options = parser.parse_args()
    options.presets, options.modes = options.presets.split(","), options.modes.split(",")
    return options


def main():
    options = parse()
    flights = [(preset, seed) for preset in options.presets for seed in range(1, options.seeds + 1)]
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        results = dict(zip(flights, pool.map(lambda flight: fly(options, *flight), flights)))
    print(f"{options.seeds} seeds x {options.duration:g} s; median and worst\n"
          f"{'preset':<11}{'mode':<8}{'ATE [mm]':>10}{'worst':>10}{'mean [%]':>10}{'worst':>10}{'scale [%]':>10}"
          f"{'worst':>10}{'least cov':>10}{'cpu s/s':>10}{'failed':>10}")
    failures = []
    for preset in options.presets:
        for mode in options.modes:
            line, failed = row(preset, mode, [(seed, results[preset, seed][mode]) for p, seed in flights if p == preset])
            failures += failed
            print(line)
    print("\n".join(failures))
    if options.json:
        pathlib.Path(options.json).write_text(
            json.dumps([{"preset": p, "seed": s, "runs": runs} for (p, s), runs in results.items()], indent=1) + "\n")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
