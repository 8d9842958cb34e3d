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

MESSAGES = {
    "builtin_interfaces/msg/Time": [("sec", "int32"), ("nanosec", "uint32")],
    "std_msgs/msg/String": [("data", "string")],
    "std_msgs/msg/Header": [("stamp", "builtin_interfaces/msg/Time"), ("frame_id", "string")],
    "geometry_msgs/msg/Point": [("x", "float64"), ("y", "float64"), ("z", "float64")],
    "geometry_msgs/msg/Vector3": [("x", "float64"), ("y", "float64"), ("z", "float64")],
    "geometry_msgs/msg/Quaternion": [("x", "float64"), ("y", "float64"), ("z", "float64"), ("w", "float64")],
    "geometry_msgs/msg/Pose": [
        ("position", "geometry_msgs/msg/Point"),
        ("orientation", "geometry_msgs/msg/Quaternion"),
    ],
    "geometry_msgs/msg/PoseStamped": [("header", "std_msgs/msg/Header"), ("pose", "geometry_msgs/msg/Pose")],
    "geometry_msgs/msg/Transform": [
        ("translation", "geometry_msgs/msg/Vector3"),
        ("rotation", "geometry_msgs/msg/Quaternion"),
    ],
    "geometry_msgs/msg/TransformStamped": [
        ("header", "std_msgs/msg/Header"),
        ("child_frame_id", "string"),
        ("transform", "geometry_msgs/msg/Transform"),
    ],
    "tf2_msgs/msg/TFMessage": [("transforms", "geometry_msgs/msg/TransformStamped[]")],
    "geometry_msgs/msg/Wrench": [("force", "geometry_msgs/msg/Vector3"), ("torque", "geometry_msgs/msg/Vector3")],
    "geometry_msgs/msg/WrenchStamped": [("header", "std_msgs/msg/Header"), ("wrench", "geometry_msgs/msg/Wrench")],
    "sensor_msgs/msg/PointField": [
        ("name", "string"),
        ("offset", "uint32"),
        ("datatype", "uint8"),
        ("count", "uint32"),
    ],
    "sensor_msgs/msg/PointCloud2": [
        ("header", "std_msgs/msg/Header"),
        ("height", "uint32"),
        ("width", "uint32"),
        ("fields", "sensor_msgs/msg/PointField[]"),
        ("is_bigendian", "boolean"),
        ("point_step", "uint32"),
        ("row_step", "uint32"),
        ("data", "uint8[]"),
        ("is_dense", "boolean"),
    ],
    "sensor_msgs/msg/Image": [
        ("header", "std_msgs/msg/Header"),
        ("height", "uint32"),
        ("width", "uint32"),
        ("encoding", "string"),
        ("is_bigendian", "uint8"),
        ("step", "uint32"),
        ("data", "uint8[]"),
    ],
    "sensor_msgs/msg/RegionOfInterest": [
        ("x_offset", "uint32"),
        ("y_offset", "uint32"),
        ("height", "uint32"),
        ("width", "uint32"),
        ("do_rectify", "boolean"),
    ],
    "sensor_msgs/msg/CameraInfo": [
        ("header", "std_msgs/msg/Header"),
        ("height", "uint32"),
        ("width", "uint32"),
        ("distortion_model", "string"),
        ("d", "float64[]"),
        ("k", "float64[9]"),
        ("r", "float64[9]"),
        ("p", "float64[12]"),
        ("binning_x", "uint32"),
        ("binning_y", "uint32"),
        ("roi", "sensor_msgs/msg/RegionOfInterest"),
    ],
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
