#!/usr/bin/python3
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""What ROS's own library (Debian's python3-rosbag) makes of a bag; for tests.

bag_oracle.py dump BAG                     every message: topic, type, bytes
bag_oracle.py fields BAG                   every message decoded by the definition in the bag, whose md5 sum is checked
bag_oracle.py rewrite BAG OUT COMPRESSION  the messages into a new bag (none, bz2, lz4)
"""
import sys

import genpy.dynamic
import rosbag


def dump(path):
    with rosbag.Bag(path) as bag:
        for topic, (kind, data, *_), _ in bag.read_messages(raw=True):
            print(topic, kind, data.hex())


def numbers(message, names):
    return ",".join(repr(getattr(message, name)) for name in names)


def describe(kind, m):
    if kind in ("dvs_msgs/EventArray", "prophesee_event_msgs/EventArray"):
        return f"width={m.width} height={m.height} events={len(m.events)}"
    if kind == "event_camera_msgs/EventPacket":
        return f"{m.encoding} width={m.width} height={m.height} seq={m.seq} time_base={m.time_base} bytes={len(m.events)}"
    if kind == "sensor_msgs/Image":
        return f"{m.encoding} {m.width}x{m.height} step={m.step} first={m.data[0]}"
    if kind == "sensor_msgs/Imu":
        return f"gyro={numbers(m.angular_velocity, 'xyz')} accel={numbers(m.linear_acceleration, 'xyz')}"
    if kind == "geometry_msgs/TransformStamped":
        transform = m.transform
        return (f"{m.header.frame_id} {m.child_frame_id} {numbers(transform.translation, 'xyz')} "
                f"{numbers(transform.rotation, 'wxyz')}")
    if kind == "sensor_msgs/CameraInfo":
        return f"{m.width}x{m.height} {m.distortion_model} K={m.K[0]!r} D={len(m.D)}"
    raise SystemExit(f"unknown type {kind}")


def fields(path):
    with rosbag.Bag(path) as bag:
        for connection in bag._get_connections():
            own = genpy.dynamic.generate_dynamic(connection.datatype, connection.msg_def)[connection.datatype]
            if own._md5sum != connection.md5sum:
                raise SystemExit(f"{connection.datatype}: md5 {connection.md5sum}, of its definition {own._md5sum}")
        for topic, message, _ in bag.read_messages():
            print(topic, f"header.stamp={message.header.stamp.to_nsec()}", describe(message._type, message))


def rewrite(path, out, compression):
    with rosbag.Bag(path) as bag, rosbag.Bag(out, "w", compression=compression, chunk_threshold=4096) as new:
        for topic, message, stamp in bag.read_messages(raw=True):
            new.write(topic, message, stamp, raw=True)


if sys.argv[1] != "--version":
    {"dump": dump, "fields": fields, "rewrite": rewrite}[sys.argv[1]](*sys.argv[2:])
