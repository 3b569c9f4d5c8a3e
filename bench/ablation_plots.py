# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""The plots of bench/ablation: every variant against the defaults, and the paper's figure of the filters."""
import itertools
import statistics

import matplotlib
import numpy as np

import harness

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402 (the backend first)

FILTER_FIGURE = "mirror_boxes"  # the recording of the paper's figure
MAX_GAP_S = 0.05  # between two poses of the truth that a pose is compared with


def draw(options, results, found, folders):
    """Writes all plots into options.out; their paths."""
    files = [options.out / "variants.png"]
    variants_figure(options, results, found, folders).savefig(files[0], dpi=110)
    folder = next((folder for folder, _ in folders if folder.name == FILTER_FIGURE), folders[0][0])
    filters = [name for name in found if name == "defaults" or name.startswith("enhancement ") and " + " not in name]
    for mode in options.modes:
        files.append(options.out / f"filters_{folder.name}_{mode}.png")
        filter_figure(options, folder, mode, filters).savefig(files[-1], dpi=110)
    pyplot.close("all")
    return files


def variants_figure(options, results, found, folders):
    """Local error of every variant over that of the defaults: a dot a recording, a bar for their geometric mean."""
    others = [variant for variant in found if variant != "defaults"]
    figure, axes = pyplot.subplots(1, len(options.modes), sharey=True, squeeze=False, layout="constrained",
                                   figsize=(3.5 + 4.5 * len(options.modes), 1.5 + 0.24 * max(4, len(others))))
    for axis, mode in zip(axes[0], options.modes):
        for height, variant in enumerate(others):
            ratios = []
            for folder, rig in folders:
                run, usual = results[variant, mode, folder.name], results["defaults", mode, folder.name]
                failed = bool(harness.failure(run))
                if not harness.scored([usual], harness.LOCAL) or not failed and run[harness.LOCAL] is None:
                    continue
                ratio = run[harness.LOCAL] / usual[harness.LOCAL] if not failed else 4.0
                axis.plot(np.clip(ratio, 0.25, 4.0), height, "x" if failed else ("o" if rig else "."), markersize=5,
                          color="tab:red" if failed else ("tab:orange" if rig else "tab:blue"), alpha=0.7)
                ratios += [] if failed else [ratio]
            if ratios:
                axis.plot([statistics.geometric_mean(ratios)] * 2, [height - 0.35, height + 0.35], "k", linewidth=2)
        axis.axvline(1.0, color="grey", linewidth=0.8)
        axis.set(xscale="log", xlim=(0.24, 4.2), title=mode, xlabel="local error over 3 s / that of the defaults")
        axis.set_xticks([0.25, 0.5, 1.0, 2.0, 4.0], labels=["0.25", "0.5", "1", "2", "4"])
        axis.minorticks_off()
        axis.grid(axis="x", alpha=0.3)
        axis.set_ylim(-0.6, len(others) - 0.4)
        axis.invert_yaxis()
    axes[0][0].set_yticks(range(len(others)), labels=others, fontsize=8)
    figure.suptitle("blue: own simulator, orange: mirrors, bar: geometric mean, cross: failed")
    return figure


def filter_figure(options, folder, mode, filters):
    """x, y and z against ground truth and the error over time, one curve a filter; the rest as by default."""
    from_file = np.loadtxt(folder / "groundtruth.txt", usecols=(0, 1, 2, 3))
    figure, axes = pyplot.subplots(4, 1, sharex=True, figsize=(9, 10), layout="constrained")
    for axis, values, name in zip(axes, from_file.T[1:], "xyz"):
        axis.plot(from_file[:, 0], values, "k", linewidth=1.5, label="ground truth")
        axis.set_ylabel(f"{name} [m]")
    axes[3].set(ylabel="error [m]", xlabel="time [s]")
    styles = itertools.cycle(["-", "--"])
    for variant, style in zip(filters, styles):
        file = options.runs / folder.name / mode / harness.file_name(variant) / "trajectory.tum"
        poses = np.loadtxt(file, usecols=(0, 1, 2, 3), ndmin=2)
        aligned = align(poses, from_file) if len(poses) > 2 else None
        if aligned is None:
            continue
        times, positions, errors = aligned
        label = f"{options.usual['enhancement']} (default)" if variant == "defaults" else variant.split(" ", 1)[1]
        for axis, values in zip(axes, [*positions.T, errors]):
            axis.plot(times, values, style, linewidth=0.9, label=f"{label}: {np.sqrt(np.mean(errors**2)):.4f} m")
    axes[3].legend(fontsize=8, title="ATE RMSE", ncols=2)
    figure.suptitle(f"{folder.name}, {mode}: enhancement of the event frames; black: ground truth")
    return figure


def align(poses, truth):
    """(times, positions, errors) of an estimate moved onto the truth, position and attitude but not scale, as the
    program's own evaluation; None without a time in common."""
    t = poses[:, 0]
    after = np.searchsorted(truth[:, 0], t).clip(1, len(truth) - 1)
    near = (t >= truth[0, 0]) & (t <= truth[-1, 0]) & (truth[after, 0] - truth[after - 1, 0] < MAX_GAP_S)
    t, estimate = t[near], poses[near, 1:]
    if len(t) < 3:
        return None
    target = np.column_stack([np.interp(t, truth[:, 0], truth[:, 1 + i]) for i in range(3)])
    middle, target_middle = estimate.mean(axis=0), target.mean(axis=0)
    u, _, vt = np.linalg.svd((target - target_middle).T @ (estimate - middle))
    rotation = u @ np.diag([1, 1, np.sign(np.linalg.det(u @ vt))]) @ vt
    moved = (estimate - middle) @ rotation.T + target_middle
    return t, moved, np.linalg.norm(moved - target, axis=1)
