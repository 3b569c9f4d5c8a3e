#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""Feed arrays of your own and print poses: events as columns, frames as images, IMU as rows. Here they come from a simulated
flight; put yours in `sensors`.

Usage: follow.py [SECONDS]
"""
import sys

import numpy as np

import edged

BATCH_NS = 10_000_000


def sensors(seconds):
    """The calibration; columns t, x, y, p of events; frames as (t, image); columns t, gyro, accel of the IMU."""
    flight = edged.simulate("room", seed=1, end_s=seconds + 0.1)
    data: dict[str, list] = {"events": [], "frame": [], "imu": []}
    for measurement in flight:
        if measurement.kind == "imu" or measurement.t < 1e9 * seconds:  # a packet needs IMU samples beyond its end
            data[measurement.kind].append((measurement.t, measurement.data))
    events, imu = (np.concatenate([array for _, array in data[kind]]) for kind in ("events", "imu"))
    return (flight.calibration, (events["t"], events["x"], events["y"], events["p"]), data["frame"],
            (imu["t"], imu["gyro"], imu["accel"]))


def report(steps):
    for step in steps:
        if step.is_tracking:
            x, y, z = step.position
            print(f"{1e-9 * step.t:7.3f} s  {x:7.3f} {y:7.3f} {z:7.3f} m  {len(step.landmarks):3} landmarks  {step.status.name}")
        else:
            print(f"{1e-9 * step.t:7.3f} s  {step.status.name}: {step.waiting_for or step.lost_because}")


def main():
    calibration, events, frames, imu = sensors(float(sys.argv[1]) if len(sys.argv) > 1 else 4.0)
    events, imu = edged.make_events(*events), edged.make_imu(*imu)
    odometry = edged.Odometry(calibration, "fused")
    end = max(events["t"][-1], imu["t"][-1])
    # In batches, as from drivers; these may have a thread each.
    for begin in range(0, int(end) + 1, BATCH_NS):
        for add, array in ((odometry.add_imu, imu), (lambda part: odometry.add_events("events", part), events)):
            first, last = np.searchsorted(array["t"], [begin, begin + BATCH_NS])
            add(array[first:last])
        while frames and frames[0][0] < begin + BATCH_NS:
            odometry.add_frame("frames", *frames.pop(0))
        report(odometry)
    odometry.finish()
    report(odometry)
    left_out = {name: count for name, count in odometry.counters.items() if count and name != "packets"}
    print(f"{odometry.counters['packets']} packets; left out: {left_out or 'nothing'}")


if __name__ == "__main__":
    main()
