#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""Run a recording and draw its path beside the truth, how well the position is known, and an event frame with its corners.

Usage: plot_run.py RECORDING [--rig NAME] [--mode MODE] [--seconds S] [--out run.png]
RECORDING: a file or a folder, or sim:PRESET. Wants python3-matplotlib.
"""
import argparse

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

import edged


def open_source(arguments):
    if arguments.recording.startswith("sim:"):
        return edged.simulate(arguments.recording[len("sim:"):], end_s=arguments.seconds)
    return edged.open_recording(arguments.recording, arguments.rig, end_s=arguments.seconds)


def positions_at(poses, stamps):
    """Linear between the poses; by whole nanoseconds from the first, as a float holds today's stamps to 256 ns."""
    t = (poses["t"] - poses["t"][0]).astype(float)
    return np.stack([np.interp((stamps - poses["t"][0]).astype(float), t, axis) for axis in poses["position"].T], axis=1)


def laid_onto(path, other):
    """`path` after the rotation and shift that bring it closest to `other` (least squares)."""
    middle, other_middle = path.mean(axis=0), other.mean(axis=0)
    u, _, vt = np.linalg.svd((path - middle).T @ (other - other_middle))
    mirror = np.diag([1, 1, np.linalg.det(u @ vt)])
    return (path - middle) @ (u @ mirror @ vt) + other_middle


def draw_path(axes, recording, steps):
    frame, truth = recording.ground_truth or ("body", None)
    path = edged.trajectory(steps, frame)
    if truth is not None:
        path = path[(path["t"] >= truth["t"][0]) & (path["t"] <= truth["t"][-1])]
        true_path = positions_at(truth, path["t"])
        ate = edged.evaluate(path, truth)["ate_m"]["rmse"]
        axes.plot(true_path[:, 0], true_path[:, 1], color="0.7", lw=4, label="truth")
        axes.set_title(f"from above, {1e3 * ate:.1f} mm off (ATE)")
        rendered = laid_onto(path["position"], true_path)
    else:
        rendered = path["position"]
        axes.set_title("from above")
    axes.plot(rendered[:, 0], rendered[:, 1], color="tab:blue", lw=1, label="estimate")
    axes.set(xlabel="x [m]", ylabel="y [m]", aspect="equal")
    axes.legend()


def draw_sigma(axes, steps):
    known = [step for step in steps if step.position_covariance is not None]
    seconds = [1e-9 * (step.t - steps[0].t) for step in known]
    sigma_mm = [1e3 * np.sqrt(np.diag(step.position_covariance)) for step in known]
    axes.plot(seconds, sigma_mm, label=["x", "y", "z"])
    axes.set(xlabel="t [s]", ylabel="sigma [mm]", title="how well the position is known, against the start", ylim=(0, None))
    axes.legend()


def draw_events(axes, step):
    axes.imshow(step.event_frame, cmap="gray")
    now, before = step.event_tracks["pixel"], step.event_tracks["previous_pixel"]
    axes.plot([before[:, 0], now[:, 0]], [before[:, 1], now[:, 1]], color="tab:orange", lw=1)
    axes.plot(now[:, 0], now[:, 1], ".", color="tab:orange", ms=4)
    axes.set(title=f"event frame at {1e-9 * step.t:.2f} s, {len(now)} corners", xticks=[], yticks=[])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("recording")
    parser.add_argument("--rig")
    parser.add_argument("--mode", default="auto")
    parser.add_argument("--seconds", type=float)
    parser.add_argument("--out", default="run.png")
    arguments = parser.parse_args()
    recording = open_source(arguments)
    steps = list(edged.run(recording, arguments.mode))
    if not any(step.is_tracking for step in steps):
        raise SystemExit(f"never got a pose: {steps[-1].waiting_for if steps else 'no packet'}")
    liveliest = max(steps, key=lambda step: step.event_rate_hz)
    figure, axes = plt.subplots(1, 2 if liveliest.event_frame is None else 3, figsize=(15, 4.5), constrained_layout=True)
    draw_path(axes[0], recording, steps)
    draw_sigma(axes[1], steps)
    if liveliest.event_frame is not None:
        draw_events(axes[2], liveliest)
    figure.savefig(arguments.out, dpi=100)
    print(f"{arguments.out}: {len(steps)} steps")


if __name__ == "__main__":
    main()
