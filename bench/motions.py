# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""Poses of files, quaternions, and the walk down a corridor that several benchmarks simulate."""
import math

WALK_S, WALK_MPS = 40.0, 0.6


def poses(file):
    """(t, position, quaternion xyzw) of a TUM file."""
    rows = [[float(x) for x in line.split()] for line in file.read_text().splitlines() if not line.startswith("#")]
    return [(row[0], row[1:4], row[4:8]) for row in rows]


def product(a, b):
    (ax, ay, az, aw), (bx, by, bz, bw) = a, b
    return [aw * bx + ax * bw + ay * bz - az * by, aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw, aw * bw - ax * bx - ay * by - az * bz]


def inverse(q):
    return [-q[0], -q[1], -q[2], q[3]]


def turned(q, v):
    return product(product(q, [*v, 0.0]), inverse(q))[:3]


def minus(a, b):
    return [x - y for x, y in zip(a, b)]


def walk(file, seed):
    """Poses of a camera that is carried straight ahead along x, looking there, with the sway of a walk (TUM, 100 Hz)."""
    phase = [2.4 * seed + k for k in range(5)]
    lines = []
    for i in range(int(100 * (WALK_S + 2.0))):
        t = 0.01 * i
        p = [WALK_MPS * t, 0.12 * math.sin(1.1 * t + phase[0]), 0.04 * math.sin(7.5 * t + phase[1])]
        yaw, pitch, roll = 0.2 * math.sin(0.7 * t + phase[2]), 0.06 * math.sin(1.9 * t + phase[3]), 0.04 * math.sin(2.3 * t + phase[4])
        ahead = [-0.5, 0.5, -0.5, 0.5]  # of a camera that looks along x, with y downwards
        q = product([0, 0, math.sin(yaw / 2), math.cos(yaw / 2)], product([0, math.sin(pitch / 2), 0, math.cos(pitch / 2)],
                    product([math.sin(roll / 2), 0, 0, math.cos(roll / 2)], ahead)))
        lines.append(" ".join(f"{x:.9f}" for x in [t, *p, *q]) + "\n")
    file.write_text("".join(lines))
