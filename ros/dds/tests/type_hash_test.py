#!/usr/bin/python3
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""Type hashes of ROS 2 (REP-2016) from messages.idl: those of the program, and those that are published.

Usage: type_hash_test.py SOURCE_DIR [--print]
"""
import hashlib
import json
import pathlib
import re
import sys

SIMPLE = {"int8": 2, "uint8": 3, "int16": 4, "uint16": 5, "int32": 6, "uint32": 7, "int64": 8, "uint64": 9, "float": 10,
          "double": 11, "boolean": 15, "octet": 16, "string": 17}
NESTED, BOUNDED_STRING, ARRAY, SEQUENCE = 1, 21, 48, 144
# As ROS 2 publishes them.
PUBLISHED = {
    "sensor_msgs/msg/Imu": "7d9a00ff131080897a5ec7e26e315954b8eae3353c3f995c55faf71574000b5b",
    "sensor_msgs/msg/Image": "d31d41a9a4c4bc8eae9be757b0beed306564f7526c88ea6a4588fb9582527d47",
    "sensor_msgs/msg/CompressedImage": "15640771531571185e2efc8a100baf923961a4d15d5569652e6cb6691e8e371a",
    "sensor_msgs/msg/PointCloud2": "9198cabf7da3796ae6fe19c4cb3bdd3525492988c70522628af5daa124bae2b5",
    "nav_msgs/msg/Odometry": "3cc97dc7fb7502f8714462c526d369e35b603cfc34d946e3f2eda2766dfec6e0",
    "nav_msgs/msg/Path": "1957a5bb3cee5da65c4e52e52b65a93df227efce4c20f8458b36e73066ca334b",
    "geometry_msgs/msg/PoseWithCovarianceStamped": "26432f9803e43727d3c8f668d1fdb3c630f548af631e2f4e31382371bfea3b6e",
    "tf2_msgs/msg/TFMessage": "e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087",
    "diagnostic_msgs/msg/DiagnosticArray": "5a8a36efb05fb25070fa0fb3810290c0e6cd4862b54a8fb975a1ee8dc55a333e",
    "event_camera_msgs/msg/EventPacket": "d6fa176260b1f37e5a40845305315e150a0f18191241eb64f407442aa29844aa",
    "rmw_dds_common/msg/ParticipantEntitiesInfo": "91a0593bacdcc50ea9bdcf849a938b128412cc1ea821245c663bcd26f83c295e",
}


def field_type(text, array):
    """The type of a field as the hash has it."""
    kind = {"type_id": 0, "capacity": 0, "string_capacity": 0, "nested_type_name": ""}
    sequence = re.fullmatch(r"sequence<(.*)>", text)
    text = sequence.group(1) if sequence else text
    bounded = re.fullmatch(r"string<(\d+)>", text)
    if bounded:
        kind["type_id"], kind["string_capacity"] = BOUNDED_STRING, int(bounded.group(1))
    elif text in SIMPLE:
        kind["type_id"] = SIMPLE[text]
    else:
        kind["type_id"], kind["nested_type_name"] = NESTED, ros_name(text)
    if sequence:
        kind["type_id"] += SEQUENCE
    elif array:
        kind["type_id"] += ARRAY
        kind["capacity"] = int(array)
    return kind


def ros_name(dds_name):
    package, name = re.fullmatch(r"(\w+)::msg::dds_::(\w+)_", dds_name).groups()
    return f"{package}/msg/{name}"


def read_types(idl):
    """{ROS name: [(field, type)]} of all structs."""
    idl = re.sub(r"//[^\n]*", "", idl)
    types, package = {}, None
    for module, struct, body in re.findall(r"module (\w+) \{ module msg|struct (\w+)_ \{(.*?)\};", idl, re.DOTALL):
        if module:
            package = module
            continue
        fields = re.findall(r"([\w:<>]+) (\w+)(?:\[(\d+)\])?;", body)
        types[f"{package}/msg/{struct}"] = [(name, field_type(kind, array)) for kind, name, array in fields]
    return types


def nested(types, name, found):
    for _, kind in types[name]:
        inner = kind["nested_type_name"]
        if inner and inner not in found:
            found.add(inner)
            nested(types, inner, found)
    return found


def type_hash(types, name):
    def description(of):
        return {"type_name": of, "fields": [{"name": field, "type": kind} for field, kind in types[of]]}

    whole = {"type_description": description(name),
             "referenced_type_descriptions": [description(inner) for inner in sorted(nested(types, name, set()))]}
    return hashlib.sha256(json.dumps(whole).encode()).hexdigest()


def main():
    root = pathlib.Path(sys.argv[1])
    types = read_types((root / "ros/dds/tests/messages.idl").read_text())
    if "--print" in sys.argv:
        for name in types:
            print(f'    MessageType{{"{name.replace("/msg/", "/")}", "{type_hash(types, name)}"}},')
        return
    source = (root / "ros/dds/names.cpp").read_text()
    ours = {name.replace("/", "/msg/"): value
            for name, value in re.findall(r'MessageType\{"([\w/]+)",\s*"([0-9a-f]{64})"\}', source)}
    assert len(ours) > 10, ours
    wrong = [f"{name}: {value}, from the IDL {type_hash(types, name)}" for name, value in ours.items()
             if value != type_hash(types, name)]
    wrong += [f"{name}: published {value}, from the IDL {type_hash(types, name)}" for name, value in PUBLISHED.items()
              if value != type_hash(types, name)]
    assert not wrong, "\n".join(wrong)
    print(f"{len(ours)} hashes of the program, {len(PUBLISHED)} published ones")


if __name__ == "__main__":
    main()
