# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""Poses of files, quaternions, and the walks that several benchmarks simulate."""
import bisect
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


def errors_since(folder, at):
    """(time [s], position error [m]) of a run once its last pose half a second before `at` is aligned with the truth; nothing
    where there is none."""
    estimate, truth = poses(folder / "trajectory.tum"), poses(folder / "groundtruth.tum")
    times = [pose[0] for pose in truth]

    def true_pose(t):
        after = min(max(bisect.bisect_left(times, t), 1), len(truth) - 1)
        (t0, p0, q0), (t1, p1, q1) = truth[after - 1], truth[after]
        share = (t - t0) / (t1 - t0)
        return [a + share * (b - a) for a, b in zip(p0, p1)], q0 if share < 0.5 else q1

    before = [pose for pose in estimate if pose[0] < at - 0.5]
    if not before:
        return []
    t0, p0, q0 = before[-1]
    true_p0, true_q0 = true_pose(t0)
    rotation = product(true_q0, inverse(q0))
    return [(t, math.dist(turned(rotation, minus(p, p0)), minus(true_pose(t)[0], true_p0))) for t, p, _ in estimate]


def looking(yaw, pitch, roll):
    """The orientation of a camera that looks along x, with y downwards, before these turns."""
    ahead = [-0.5, 0.5, -0.5, 0.5]
    return product([0, 0, math.sin(yaw / 2), math.cos(yaw / 2)], product([0, math.sin(pitch / 2), 0, math.cos(pitch / 2)],
                   product([math.sin(roll / 2), 0, 0, math.cos(roll / 2)], ahead)))


def write_poses(file, rows):
    file.write_text("".join(" ".join(f"{x:.9f}" for x in row) + "\n" for row in rows))


def sway(t, phase):
    """Of a walk: to the side and upwards [m], yaw, pitch and roll."""
    return (0.12 * math.sin(1.1 * t + phase[0]), 0.04 * math.sin(7.5 * t + phase[1]),
            0.2 * math.sin(0.7 * t + phase[2]), 0.06 * math.sin(1.9 * t + phase[3]), 0.04 * math.sin(2.3 * t + phase[4]))


def walk(file, seed):
    """Poses of a camera that is carried straight ahead along x, looking there, with the sway of a walk (TUM, 100 Hz)."""
    phase = [2.4 * seed + k for k in range(5)]
    rows = []
    for i in range(int(100 * (WALK_S + 2.0))):
        t = 0.01 * i
        side, up, *turns = sway(t, phase)
        rows.append([t, WALK_MPS * t, side, up, *looking(*turns)])
    write_poses(file, rows)


def smoothed(values, width):
    """Moving average over `width` samples, three times: corners become curves."""
    for _ in range(3):
        sums = [0.0]
        for value in values:
            sums.append(sums[-1] + value)
        half = width // 2
        ends = [(max(0, i - half), min(len(values), i + half + 1)) for i in range(len(values))]
        values = [(sums[b] - sums[a]) / (b - a) for a, b in ends]
    return values


def walk_along(file, seed, corners, mps, turn_s=1.0, rest_s=2.0):
    """Poses of a camera that is carried along straight legs between these corners, looking ahead, with the sway of a walk
    (TUM, 50 Hz), after a rest. Corners are cut in about turn_s. The duration [s]."""
    hz = 50
    phase = [2.4 * seed + k for k in range(5)]
    x, y, heading = ([value] * int(rest_s * hz) for value in (*corners[0], None))
    last = None
    for (xa, ya), (xb, yb) in zip(corners, corners[1:]):
        direction = math.atan2(yb - ya, xb - xa)
        if last is not None:
            direction = last + math.remainder(direction - last, 2 * math.pi)
        n = round(math.hypot(xb - xa, yb - ya) / mps * hz)
        x += [xa + (xb - xa) * i / n for i in range(n)]
        y += [ya + (yb - ya) * i / n for i in range(n)]
        heading += [direction] * n
        last = direction
    heading = [next(h for h in heading if h is not None) if h is None else h for h in heading]
    x, y, heading = (smoothed(values, int(turn_s * hz)) for values in (x, y, heading))
    rows = []
    for i, (px, py, yaw) in enumerate(zip(x, y, heading)):
        t = i / hz
        side, up, turn, pitch, roll = (min(1.0, max(0.0, t - 0.5 * rest_s)) * s for s in sway(t, phase))
        rows.append([t, px - side * math.sin(yaw), py + side * math.cos(yaw), up, *looking(yaw + turn, pitch, roll)])
    write_poses(file, rows)
    return math.floor(len(x) / hz - 1.0)
