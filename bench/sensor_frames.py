# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""Trajectories of a run as poses of another sensor: that of a data set's ground truth, or the camera of the EvSLAM challenge.
A transform is (position, quaternion xyzw); T_B_X maps points of X to the body."""
import bisect
import csv
import json
import math

import yaml
from motions import inverse, poses, product, turned

LONGEST_GAP_S = 0.2  # between states that are interpolated
IDENTITY = ([0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0])


def combined(a, b):
    """T_A_C of T_A_B and T_B_C."""
    return [x + y for x, y in zip(a[0], turned(a[1], b[0]))], product(a[1], b[1])


def inverted(a):
    q = inverse(a[1])
    return [-x for x in turned(q, a[0])], q


def of_matrix(rows):
    """Of 4x4 or 3x4 rows; the largest of the four squared components is divided by, which is safe for any rotation."""
    r = [row[:3] for row in rows[:3]]
    squares = [1 + r[0][0] - r[1][1] - r[2][2], 1 - r[0][0] + r[1][1] - r[2][2], 1 - r[0][0] - r[1][1] + r[2][2],
               1 + r[0][0] + r[1][1] + r[2][2]]
    i = max(range(4), key=squares.__getitem__)
    both, differences = (r[1][0] + r[0][1], r[2][0] + r[0][2], r[2][1] + r[1][2]), (r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1])
    q = [[squares[0], both[0], both[1], differences[0]], [both[0], squares[1], both[2], differences[1]],
         [both[1], both[2], squares[2], differences[2]], [*differences, squares[3]]][i]
    norm = math.hypot(*q)
    return [row[3] for row in rows[:3]], [x / norm for x in q]


def of_entry(entry):
    """Of what calibration files hold: px .. qw (basalt), 16 numbers in a row, in rows, or as `data`."""
    if isinstance(entry, dict) and "qw" in entry:
        return [entry[key] for key in ("px", "py", "pz")], [entry[key] for key in ("qx", "qy", "qz", "qw")]
    numbers = entry["data"] if isinstance(entry, dict) else entry
    if not isinstance(numbers[0], list):
        numbers = [numbers[i:i + 4] for i in range(0, len(numbers), 4)]
    return of_matrix(numbers)


def read_entry(file, key):
    """key: names from the outermost inwards, with dots between."""
    text = file.read_text()
    node = json.loads(text) if file.suffix == ".json" else yaml.safe_load(text.replace("%YAML:1.0", ""))
    for name in key.split("."):
        node = node[name]
    return of_entry(node)


class Rig:
    """The calibration.yaml of a run."""

    def __init__(self, file):
        self.cameras = yaml.safe_load(file.read_text())["cameras"]

    def sensor(self, name):
        """T_B_X and time offset (t_imu = t + offset) of the body, of a camera by its name, or of the first of a kind."""
        if name == "body":
            return IDENTITY, 0.0
        camera = next((c for c in self.cameras if c["name"] == name), None) or \
            next(c for c in self.cameras if c["modality"] == name)
        return of_matrix(camera["T_B_C"]), camera.get("time_offset", 0.0)


def write_of_sensor(source, target, T_F_X, later_s):
    """The TUM trajectory of sensor F as that of X, with stamps later_s later."""
    with open(target, "w", encoding="utf-8") as file:
        for t, p, q in poses(source):
            position, rotation = combined((p, q), T_F_X)
            file.write(" ".join([f"{t + later_s:.9f}", *(f"{x:.12g}" for x in [*position, *rotation])]) + "\n")


def tracked_states(folder):
    """(t, position, quaternion, velocity) of the body on the IMU clock, of each packet with a pose that counts."""
    with open(folder / "states.csv", encoding="utf-8") as file:
        rows = csv.DictReader(line for line in file if not line.startswith("#"))
        return [(1e-9 * int(row["t_ns"]), *([float(row[key]) for key in keys] for keys in (
            ("px_m", "py_m", "pz_m"), ("qx", "qy", "qz", "qw"), ("vx_mps", "vy_mps", "vz_mps"))))
            for row in rows if row["status"] in ("Good", "Degraded")]


def rotation_vector(q):
    sign = math.copysign(1.0, q[3])
    size = math.hypot(*q[:3])
    angle = 2.0 * math.atan2(size, sign * q[3])
    return [sign * x * (angle / size if size > 1e-12 else 2.0) for x in q[:3]]


def rotation(vector):
    angle = math.hypot(*vector)
    scale = math.sin(angle / 2) / angle if angle > 1e-12 else 0.5
    return [*(scale * x for x in vector), math.cos(angle / 2)]


def between(a, b, t):
    """Position (cubic), quaternion, velocity and angular velocity in the body at t, of the states before and after."""
    step = b[0] - a[0]
    s = (t - a[0]) / step
    turn = rotation_vector(product(inverse(a[2]), b[2]))
    weights = (2 * s**3 - 3 * s**2 + 1, 3 * s**2 - 2 * s**3, step * (s**3 - 2 * s**2 + s), step * (s**3 - s**2))
    position = [sum(w * x for w, x in zip(weights, values)) for values in zip(a[1], b[1], a[3], b[3])]
    return (position, product(a[2], rotation([s * x for x in turn])), [x + s * (y - x) for x, y in zip(a[3], b[3])],
            [x / step for x in turn])


def body_at(states, times, t):
    """As between; whether it is held: before the first, after the last, and in gaps the nearest state stands in, at rest."""
    k = bisect.bisect_left(times, t)
    for before, after in ((k - 1, k), (k, k + 1)):
        if 0 <= before and after < len(states) and times[before] <= t <= times[after] and times[after] - times[before] <= LONGEST_GAP_S:
            return *between(states[before], states[after], t), False
    nearest = min((i for i in (k - 1, k) if 0 <= i < len(states)), key=lambda i: abs(times[i] - t))
    return states[nearest][1], states[nearest][2], [0.0] * 3, [0.0] * 3, True


def write_evslam(folder, target, times=None, camera="events"):
    """Lines `t px py pz qx qy qz qw vx vy vz` of a run folder: pose of the camera in the world, velocity in the camera's own axes,
    on its clock, causal. times: those that the challenge asks for; without, those of the states. Number of lines, and of those
    that the nearest state stands in for."""
    T_B_C, offset = Rig(folder / "calibration.yaml").sensor(camera)
    states = tracked_states(folder)
    if not states:
        raise ValueError(f"{folder}: no pose was good")
    at = [state[0] for state in states]
    held = 0
    with open(target, "w", encoding="utf-8") as file:
        wanted = [t - offset for t in at] if times is None else times
        for t in wanted:
            p, q, v, omega, is_held = body_at(states, at, t + offset)
            held += is_held
            position, orientation = combined((p, q), T_B_C)
            x, y, z = T_B_C[0]
            lever = [omega[1] * z - omega[2] * y, omega[2] * x - omega[0] * z, omega[0] * y - omega[1] * x]
            velocity = turned(inverse(T_B_C[1]), [a + b for a, b in zip(turned(inverse(q), v), lever)])
            file.write(" ".join([f"{t:.9f}", *(f"{x:.9g}" for x in [*position, *orientation, *velocity])]) + "\n")
    return len(wanted), held


def reference_times(file):
    return [float(line.split()[0]) for line in file.read_text().splitlines() if line.strip() and not line.startswith("#")]
