"""The type hashes of ROS's messages (REP-2016, RIHS01), from their published definitions: SHA-256 of JSON.

Prints a line for each message. Compares them with published hashes of some, and, if given, with the types of an IDL
file and the hashes in a C++ file:

    ros_type_hashes.py haptics/sharing/ros.idl haptics/sharing/ros_messages.cpp
"""

import hashlib
import json
import re
import sys

# type_description_interfaces/msg/FieldType.
IDS = {"uint8": 3, "int32": 6, "uint32": 7, "float64": 11, "boolean": 15, "string": 17}
NESTED, ARRAY, UNBOUNDED_SEQUENCE = 1, 48, 144

# A message a line: its name, then its fields as in ROS's own files.
DEFINITIONS = """
builtin_interfaces/msg/Time: int32 sec, uint32 nanosec
std_msgs/msg/String: string data
std_msgs/msg/Header: builtin_interfaces/msg/Time stamp, string frame_id
geometry_msgs/msg/Point: float64 x, float64 y, float64 z
geometry_msgs/msg/Vector3: float64 x, float64 y, float64 z
geometry_msgs/msg/Quaternion: float64 x, float64 y, float64 z, float64 w
geometry_msgs/msg/Pose: geometry_msgs/msg/Point position, geometry_msgs/msg/Quaternion orientation
geometry_msgs/msg/PoseStamped: std_msgs/msg/Header header, geometry_msgs/msg/Pose pose
geometry_msgs/msg/Transform: geometry_msgs/msg/Vector3 translation, geometry_msgs/msg/Quaternion rotation
geometry_msgs/msg/TransformStamped: \
std_msgs/msg/Header header, string child_frame_id, geometry_msgs/msg/Transform transform
tf2_msgs/msg/TFMessage: geometry_msgs/msg/TransformStamped[] transforms
geometry_msgs/msg/Wrench: geometry_msgs/msg/Vector3 force, geometry_msgs/msg/Vector3 torque
geometry_msgs/msg/WrenchStamped: std_msgs/msg/Header header, geometry_msgs/msg/Wrench wrench
sensor_msgs/msg/PointField: string name, uint32 offset, uint8 datatype, uint32 count
sensor_msgs/msg/PointCloud2: std_msgs/msg/Header header, uint32 height, uint32 width, \
sensor_msgs/msg/PointField[] fields, boolean is_bigendian, uint32 point_step, uint32 row_step, uint8[] data, \
boolean is_dense
sensor_msgs/msg/Image: std_msgs/msg/Header header, uint32 height, uint32 width, string encoding, \
uint8 is_bigendian, uint32 step, uint8[] data
sensor_msgs/msg/RegionOfInterest: \
uint32 x_offset, uint32 y_offset, uint32 height, uint32 width, boolean do_rectify
sensor_msgs/msg/CameraInfo: std_msgs/msg/Header header, uint32 height, uint32 width, string distortion_model, \
float64[] d, float64[9] k, float64[9] r, float64[12] p, uint32 binning_x, uint32 binning_y, \
sensor_msgs/msg/RegionOfInterest roi
"""
# By message: its fields as (name, type).
MESSAGES = {
    message: [tuple(reversed(field.split())) for field in fields.split(",")]
    for message, fields in (line.split(":") for line in DEFINITIONS.split("\n") if line)
}
PUBLISHED = {
    "tf2_msgs/msg/TFMessage": "RIHS01_e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087",
    "std_msgs/msg/String": "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18",
    "sensor_msgs/msg/Image": "RIHS01_d31d41a9a4c4bc8eae9be757b0beed306564f7526c88ea6a4588fb9582527d47",
    "sensor_msgs/msg/CameraInfo": "RIHS01_b3dfd68ff46c9d56c80fd3bd4ed22c7a4ddce8c8348f2f59c299e73118e7e275",
}


def element_of(type_name):
    return type_name.partition("[")[0]


def count_of(type_name):
    """Length of an array; 0: not an array."""
    return int(type_name.partition("[")[2].rstrip("]") or 0)


def field_type(type_name):
    element = element_of(type_name)
    several = ARRAY if count_of(type_name) else UNBOUNDED_SEQUENCE if type_name.endswith("[]") else 0
    return {
        "type_id": IDS.get(element, NESTED) + several,
        "capacity": count_of(type_name),
        "string_capacity": 0,
        "nested_type_name": "" if element in IDS else element,
    }


def description_of(message):
    fields = [{"name": name, "type": field_type(type_name)} for name, type_name in MESSAGES[message]]
    return {"type_name": message, "fields": fields}


def referenced_by(message):
    found = set()
    for _, type_name in MESSAGES[message]:
        element = element_of(type_name)
        if element not in IDS:
            found |= {element} | referenced_by(element)
    return found


def hash_of(message):
    described = {
        "type_description": description_of(message),
        "referenced_type_descriptions": [description_of(other) for other in sorted(referenced_by(message))],
    }
    text = json.dumps(described, ensure_ascii=True, allow_nan=False, separators=(", ", ": "), sort_keys=False)
    return "RIHS01_" + hashlib.sha256(text.encode()).hexdigest()


# Names of the types in IDL.
IDL_NAMES = {"uint8": "octet", "int32": "long", "uint32": "unsigned long", "float64": "double"}


def idl_of(type_name):
    element = element_of(type_name)
    name = IDL_NAMES.get(element, element)
    if "/" in element:
        package, _, message = element.split("/")
        name = f"{package}::msg::dds_::{message}_"
    if count_of(type_name):
        return f"{name}[{count_of(type_name)}]"
    return f"sequence<{name}>" if type_name.endswith("[]") else name


def fields_in_idl(text):
    """By message: its fields as (name, type), as in MESSAGES, but with IDL types."""
    found, package = {}, None
    text = re.sub(r"//[^\n]*", "", text)
    for match in re.finditer(r"module (\w+) \{ module msg|struct (\w+)_ \{([^}]*)\}", text):
        if match[1]:
            package = match[1]
            continue
        fields = []
        for field in filter(None, (field.strip() for field in match[3].split(";"))):
            type_name, names, count = re.fullmatch(r"(.*?)\s+(\w+(?:,\s*\w+)*)(\[\d+\])?", field, re.S).groups()
            if re.fullmatch(r"(sequence<)?\w+_>?", type_name):  # of the same package
                type_name = re.sub(r"(\w+_)\b", rf"{package}::msg::dds_::\1", type_name)
            fields += [(name.strip(), type_name + (count or "")) for name in names.split(",")]
        found[f"{package}/msg/{match[2]}"] = fields
    return found


def complaints(idl, code):
    in_idl = fields_in_idl(idl)
    for message, fields in MESSAGES.items():
        if message != "std_msgs/msg/String" and in_idl.get(message) != [(name, idl_of(kind)) for name, kind in fields]:
            yield f"{message} is otherwise in the IDL: {in_idl.get(message)}"
    known = {message.split("/")[2]: hash_of(message) for message in MESSAGES}
    in_code = re.findall(r"rosTypeOf<Ros(\w+)>\(\).*?(RIHS01_\w+)", code, re.S)
    if not in_code:
        yield "the code has no hashes"
    for name, type_hash in in_code:
        if known.get(name) != type_hash:
            yield f"the code has another hash of {name}"


def main():
    for message in MESSAGES:
        print(message, hash_of(message))
    wrong = [f"{message} has another hash" for message, known in PUBLISHED.items() if hash_of(message) != known]
    if len(sys.argv) == 3:
        with open(sys.argv[1]) as idl, open(sys.argv[2]) as code:
            wrong += complaints(idl.read(), code.read())
    print("\n".join(wrong), file=sys.stderr, end="\n" if wrong else "")
    return bool(wrong)


if __name__ == "__main__":
    sys.exit(main())
