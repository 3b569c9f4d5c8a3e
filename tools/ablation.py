#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""Runs `edged run` for every variant of one part of the method on a set of recordings, and prints a table.

Usage: ablation.py AXIS RECORDING... [--edged PATH] [--modes events fused] [--repeats 3] [--jobs 2] [--out DIR]
       [--set KEY=VALUE] [--only TEXT]

AXIS is one of those in AXES below. A repeat is the same run with events windows one per cent longer or shorter: how far
the results scatter for no reason. Runs that are in DIR/AXIS already are not done again; table.md there holds the table.
A run fails when it leaves no pose, is not Good at its end, or covers less than 80 % of the recording.
"""
import argparse
import concurrent.futures
import json
import pathlib
import shutil
import statistics
import subprocess
import sys

WINDOW = 0.35  # packets.window_per_pixel
MIN_COVERAGE = 0.8


def enhancement_variants():
    """Every edge map, used to detect, to track, or for both."""
    variants = {"none": []}
    for method in ("clahe", "canny", "laplacian", "sobel", "scharr"):
        for use, detect, track in (("detect", True, False), ("track", False, True), ("both", True, True)):
            variants[f"{method}, {use}"] = [f"enhance.method={method}", f"enhance.detect={str(detect).lower()}",
                                            f"enhance.track={str(track).lower()}"]
    return variants


AXES = {
    "enhancement": enhancement_variants(),
    "blend": {
        "none": [],
        **{f"{method} {alpha}/{beta}": [f"enhance.method={method}", "enhance.track=true", f"enhance.event_weight={alpha}",
                                        f"enhance.edge_weight={beta}"]
           for method in ("clahe", "sobel") for alpha, beta in ((0.9, 0.1), (0.7, 0.3), (0.5, 0.5), (0, 1))},
    },
    "detector": {
        "fast_harris": [],
        "fast_harris, 3 levels": ["event_tracker.detector.levels=3", "frame_tracker.detector.levels=3"],
        "shi_tomasi": ["event_tracker.detector.corners=shi_tomasi", "frame_tracker.detector.corners=shi_tomasi"],
    },
    "compensation": {
        "piecewise": ["event_frame.interpolation=piecewise"],
        "single twist": ["event_frame.interpolation=single_twist"],
        "none": ["event_frame.interpolation=none"],
        "piecewise, depth of landmarks": ["event_frame.depth=landmarks"],
        "piecewise, delta x_last": ["alignment_gain=0.5"],
    },
}


def run(options, job):
    """One run's figures; from the folder of an earlier call where there is one."""
    variant, mode, recording, repeat = job
    name = f"{pathlib.Path(recording).name}-{mode}-{variant}-{repeat}".replace(" ", "_").replace(",", "").replace("/", "_")
    folder = options.out / options.axis / name
    metrics = folder / "metrics.json"
    if not metrics.exists():
        shutil.rmtree(folder, ignore_errors=True)
        window = WINDOW * (1 + 0.01 * ((repeat + 1) // 2) * (1 if repeat % 2 else -1))
        settings = [f"packets.window_per_pixel={window:.5f}", *options.set, *AXES[options.axis][variant]]
        command = [options.edged, "run", recording, "--mode", mode, "--quiet", "--json", "--out", folder]
        for setting in settings:
            command += ["--set", setting]
        done = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False)
        if done.returncode not in (0, 4):
            sys.exit(f"ablation.py: {name}: {done.stderr.strip()}")
    figures = json.loads(metrics.read_text())
    return job, figures


def failed(figures):
    return (figures.get("ate_rmse_m") is None or figures["status"] != "good" or figures["coverage"] < MIN_COVERAGE)


def cells(runs, recordings):
    """Geometric mean, median, worst [mm] and failures. A recording counts by the median of its repeats."""
    by_recording = []
    for recording in recordings:
        errors = [1e3 * f["ate_rmse_m"] for f in runs[recording] if not failed(f)]
        if errors:
            by_recording.append(statistics.median(errors))
    all_runs = [f for recording in recordings for f in runs[recording]]
    failures = sum(failed(f) for f in all_runs)
    if not by_recording:
        return ["-", "-", "-", f"{failures}/{len(all_runs)}"]
    worst = max(1e3 * f["ate_rmse_m"] for f in all_runs if not failed(f))
    return [f"{statistics.geometric_mean(by_recording):.1f}", f"{statistics.median(by_recording):.1f}", f"{worst:.1f}",
            f"{failures}/{len(all_runs)}"]


def table(options, results):
    """Markdown: one row a variant, one group of columns a mode, then every recording by itself."""
    names = [pathlib.Path(recording).name for recording in options.recordings]
    text = f"ATE RMSE [mm], {len(names)} recordings, {options.repeats} repeats.\n\n"
    for mode in options.modes:
        text += f"| {mode} | geo. mean | median | worst | failures | {' | '.join(names)} |\n"
        text += "|---" * (5 + len(names)) + "|\n"
        for variant in options.variants:
            runs = {r: [results[variant, mode, r, k] for k in range(options.repeats)
                        if (variant, mode, r, k) in results] for r in options.recordings}
            if not all(runs.values()):
                continue
            single = []
            for recording in options.recordings:
                errors = [f"{1e3 * f['ate_rmse_m']:.1f}" if not failed(f) else "x" for f in runs[recording]]
                single.append(" ".join(errors))
            text += f"| {variant} | {' | '.join(cells(runs, options.recordings))} | {' | '.join(single)} |\n"
        text += "\n"
    return text


def show_progress(done, total):
    if sys.stderr.isatty():
        filled = 40 * done // total
        print(f"\r[{'#' * filled}{'.' * (40 - filled)}] {done}/{total}", end="" if done < total else "\n", file=sys.stderr)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("axis", choices=AXES)
    parser.add_argument("recordings", nargs="+")
    parser.add_argument("--edged", default="build/bin/edged")
    parser.add_argument("--modes", nargs="+", default=["events", "fused"])
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("runs/ablation"))
    parser.add_argument("--set", action="append", default=[], help="for every variant")
    parser.add_argument("--only", default="", help="variants whose name contains this text")
    options = parser.parse_args()
    options.variants = [v for v in AXES[options.axis] if options.only in v]
    (options.out / options.axis).mkdir(parents=True, exist_ok=True)
    jobs = [(v, m, r, k) for k in range(options.repeats) for m in options.modes for r in options.recordings
            for v in options.variants]
    results = {}
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        for job, figures in pool.map(lambda job: run(options, job), jobs):
            results[job] = figures
            show_progress(len(results), len(jobs))
            (options.out / options.axis / "table.md").write_text(table(options, results))
    print(table(options, results), end="")


if __name__ == "__main__":
    main()
