# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""How far off the poses of a run are in the frame of a map that another run has made."""
import bisect
import math

import numpy as np


def read_poses(file):
    """Seconds and positions of a trajectory in TUM's format."""
    rows = np.loadtxt(file, comments="#", ndmin=2)
    return rows[:, 0], rows[:, 1:4]


def position_pairs(folder, since=-math.inf):
    """Positions of the estimate of a run from then on, and the truth at its times."""
    (t, p), (truth_t, truth_p) = read_poses(folder / "trajectory.tum"), read_poses(folder / "groundtruth.tum")
    places = np.array([min(bisect.bisect_left(truth_t, x), len(truth_t) - 1) for x in t])
    use = t >= since
    return p[use], truth_p[places][use]


def errors_in_map(first, second, since=-math.inf):
    """Distances of the poses of a second run, from then on, from the truth, which the first run ties to its map [m]."""
    p, truth = position_pairs(first)
    middle, truth_middle = p.mean(axis=0), truth.mean(axis=0)
    u, _, v = np.linalg.svd((truth - truth_middle).T @ (p - middle))
    rotation = u @ np.diag([1.0, 1.0, np.sign(np.linalg.det(u @ v))]) @ v
    p, truth = position_pairs(second, since)
    return np.linalg.norm((p - middle) @ rotation.T + truth_middle - truth, axis=1)
