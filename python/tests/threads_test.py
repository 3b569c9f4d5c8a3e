# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""A thread a sensor, one that estimates, and a controller beside."""
import threading
import time

import numpy as np
from support import room

import edged


def test_measurements_from_threads_give_the_same_bits_as_in_order():
    recording = room(2)
    measurements = list(recording)
    expected = [step.position for step in edged.run(room(2))]
    odometry = edged.Odometry(recording.calibration, delays={"events": 10.0, "frames": 10.0, "imu": 10.0})

    def driver(kind):
        for measurement in measurements:
            if measurement.kind == kind:
                odometry.add(measurement)

    threads = [threading.Thread(target=driver, args=(kind,)) for kind in ("events", "frame", "imu")]
    for thread in threads:
        thread.start()
    steps: list[edged.Step] = []
    while any(thread.is_alive() for thread in threads):
        steps += odometry
        odometry.newest_state()
    odometry.finish()
    steps += odometry
    assert np.array_equal([step.position for step in steps], expected)
    assert odometry.newest_state() is not None


def test_several_threads_may_ask_for_steps():
    """Each step goes to one of them."""
    recording = room(1)
    expected = len(list(edged.run(room(1))))
    odometry = recording.odometry()
    for measurement in recording:
        odometry.add(measurement)
    odometry.finish()
    got = []
    threads = [threading.Thread(target=lambda: got.extend(odometry)) for _ in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(got) == expected
    assert len({step.t for step in got}) == expected


def test_other_threads_run_while_it_estimates():
    """A counter beside: with the GIL held it would stand still within next()."""
    recording = room(1.5)
    odometry = recording.odometry()
    for measurement in recording:
        odometry.add(measurement)
    odometry.finish()
    counted, done = [0], threading.Event()

    def count():
        while not done.is_set():
            counted[0] += 1

    thread = threading.Thread(target=count)
    thread.start()
    during = 0
    while True:
        before = counted[0]
        step = odometry.next()
        during = max(during, counted[0] - before)
        if step is None:
            break
    done.set()
    thread.join()
    assert during > 0


def test_a_million_events_a_second_pass(capsys):
    """Two seconds of them in packets of 1 ms: all are taken. How long that takes is reported, not judged."""
    odometry = edged.Odometry(room().calibration, "events")
    rng = np.random.default_rng(1)
    packets = []
    for ms in range(2000):
        t = ms * 1_000_000 + np.arange(1000) * 1000
        packets.append(edged.make_events(t, rng.integers(0, 240, 1000), rng.integers(0, 180, 1000), rng.integers(0, 2, 1000)))
    spent = 0.0
    for events in packets:
        begin = time.perf_counter()
        odometry.add_events("events", events)
        spent += time.perf_counter() - begin
    assert odometry.counters["events_outside"] == odometry.counters["no_room"] == 0
    with capsys.disabled():
        print(f"\n2 s of a million events a second: {1e3 * spent:.1f} ms in add_events, {50 * spent:.2f} % of the time")
