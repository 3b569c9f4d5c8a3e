#!/usr/bin/python3
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""The sums by which ROS 1 knows the types that the node sends and reads: those of the definitions that Debian installs.

Usage: definitions_test.py SOURCE_DIR
"""
import pathlib
import re
import sys

import genmsg
from genmsg import msg_loader

SHARE = pathlib.Path("/usr/share")


def main():
    table = (pathlib.Path(sys.argv[1]) / "toolbox/edged/io/ros/definitions.cpp").read_text()
    ours = dict(re.findall(r'Fields\{"(\w+/\w+)", "([0-9a-f]{32})"', table))
    search_path = {folder.parent.name: [str(folder)] for folder in SHARE.glob("*/msg")}
    checked = 0
    for name, md5 in ours.items():
        package, message = name.split("/")
        file = SHARE / package / "msg" / f"{message}.msg"
        if not file.exists():  # of drivers, which Debian has not
            continue
        context = genmsg.MsgContext.create_default()
        spec = msg_loader.load_msg_from_file(context, str(file), name)
        msg_loader.load_depends(context, spec, search_path)
        assert genmsg.compute_md5(context, spec) == md5, name
        checked += 1
    assert checked > 8, checked
    print(f"{checked} definitions are those of ROS")


if __name__ == "__main__":
    main()
