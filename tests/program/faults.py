# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""Wrong calibrations and recordings that a run must tell: each a file of the recording and a change of its text."""
import math
import re

from program import with_imu, with_transform

DEG = 57.29578
G = 9.80665


def scaled(factor, v):
    return [factor * x for x in v]


def quarter_turn(rows):
    """About the body's x: y' = -z, z' = y."""
    x, y, z, last = rows
    return [x, scaled(-1, z), y, last]


def millimetres(rows):
    return [row[:3] + [1000 * row[3]] for row in rows[:3]] + [rows[3]]


def inverse(rows):
    R, t = [row[:3] for row in rows[:3]], [row[3] for row in rows[:3]]
    return [[R[j][i] for j in range(3)] + [-sum(R[j][i] * t[j] for j in range(3))] for i in range(3)] + [rows[3]]


def turned(degrees):
    """T_B_C with the camera turned about its y axis."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return with_transform(lambda rows: [[c * a - s * z, b, s * a + c * z, t] for a, b, z, t in rows[:3]] + [rows[3]])


def late(seconds):
    """time_offset of the first camera, or of both."""
    return lambda text: re.sub(r"time_offset: (\S+)", lambda match: f"time_offset: {float(match.group(1)) + seconds}", text)


# Those after which no result may be trusted, in any mode.
NOT_TRUSTED = {
    "quarter turn": ("calibration.yaml", with_transform(quarter_turn)),
    "millimetres": ("calibration.yaml", with_transform(millimetres)),
    "clocks 100 s apart": ("imu.txt", with_imu(lambda t, a, g: (t + 100, a, g))),
    "gyro in degrees": ("imu.txt", with_imu(lambda t, a, g: (t, a, scaled(DEG, g)))),
    "accelerometer in g": ("imu.txt", with_imu(lambda t, a, g: (t, scaled(1 / G, a), g))),
    "all axes negated": ("imu.txt", with_imu(lambda t, a, g: (t, scaled(-1, a), scaled(-1, g)))),
    "one axis negated": ("imu.txt", with_imu(lambda t, a, g: (t, [-a[0], *a[1:]], [-g[0], *g[1:]]))),
    "two axes negated": ("imu.txt", with_imu(lambda t, a, g: (t, [-a[0], -a[1], a[2]], [-g[0], -g[1], g[2]]))),
    "accelerometer's axes": ("imu.txt", with_imu(lambda t, a, g: (t, [-a[0], *a[1:]], g))),
}
# Those of which a warning is enough, by runs that have frames.
TOLD = {
    "accelerometer negated": ("imu.txt", with_imu(lambda t, a, g: (t, scaled(-1, a), g))),
    "gyro 1.1": ("imu.txt", with_imu(lambda t, a, g: (t, a, scaled(1.1, g)))),
    "inverse near identity": ("calibration.yaml", with_transform(inverse)),
    "turned by 5 deg": ("calibration.yaml", turned(5)),
}
