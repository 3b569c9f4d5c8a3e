# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""Calibrations of simulated recordings with errors of given size."""
import math
import random

import yaml

# Focal lengths [share], centre [px], k1 [share], rotation [deg], time offset [s], position [m]; each number with a sign of chance.
SIZES = {"exact": None, "careful": (0.005, 1.0, 0.03, 0.5, 1e-3, 5e-3), "hasty": (0.01, 2.0, 0.06, 1.5, 4e-3, 10e-3)}


def rotation_by(axis, degrees):
    """Rodrigues' formula; axis of length 1."""
    x, y, z = axis
    s, c = math.sin(math.radians(degrees)), math.cos(math.radians(degrees))
    return [[c + x * x * (1 - c), x * y * (1 - c) - z * s, x * z * (1 - c) + y * s],
            [y * x * (1 - c) + z * s, c + y * y * (1 - c), y * z * (1 - c) - x * s],
            [z * x * (1 - c) - y * s, z * y * (1 - c) + x * s, c + z * z * (1 - c)]]


def perturbed(calibration, size, chance):
    """In place, and what was added to each number of SIZES in the units of `corrections` in metrics.json. Events and frames
    behind one lens have one error."""
    focal, centre, distortion, degrees, time_s, position = size
    sign = lambda: chance.choice((-1.0, 1.0))
    signs = [sign() for _ in range(12)]
    turn = rotation_by([s / math.sqrt(3) for s in signs[:3]], degrees)
    added = {}
    for camera in calibration["cameras"]:
        added[camera["name"]] = off = {}
        if "same_as" in camera:
            added[camera["name"]] = added[camera["same_as"]]
            continue
        f = camera["intrinsics"]
        off["fx_percent"], off["fy_percent"] = 100 * signs[3] * focal, 100 * signs[4] * focal
        off["cx_px"], off["cy_px"] = signs[5] * centre, signs[6] * centre
        camera["intrinsics"] = [f[0] * (1 + signs[3] * focal), f[1] * (1 + signs[4] * focal), f[2] + off["cx_px"],
                                f[3] + off["cy_px"]]
        if camera.get("coefficients"):
            off["k1"] = signs[7] * distortion * camera["coefficients"][0]
            camera["coefficients"][0] += off["k1"]
        camera.pop("q_B_C", None)  # the rotation to the last bit
        T = camera["T_B_C"]
        R = [[sum(T[i][k] * turn[k][j] for k in range(3)) for j in range(3)] for i in range(3)]
        for i, axis in enumerate("xyz"):
            off[f"{axis}_mm"] = 1e3 * signs[8 + i] * position
            T[i] = [*R[i], T[i][3] + signs[8 + i] * position]
        camera["time_offset"] = camera.get("time_offset", 0.0) + signs[11] * time_s
    return added


def write(recording, size, n, file):
    """Writes the calibration of a recording with the errors of that size and number; returns what was added to each camera."""
    chance = random.Random(f"{recording.name} {size} {n}")
    calibration = yaml.safe_load((recording / "calibration.yaml").read_text())
    added = perturbed(calibration, SIZES[size], chance) if SIZES[size] else {c["name"]: {} for c in calibration["cameras"]}
    file.write_text(yaml.safe_dump(calibration))
    return added
