"""Third-party programs check the ROS messages that palpate sends and receives.

    foreign_programs.py fastdds PALPATE [PEER]      another DDS receives a hand and a cloud, and sends points
    foreign_programs.py dissected PALPATE LISTENER  tshark reads all packets on the loopback, and finds none malformed
    foreign_programs.py decoded PALPATE LISTENER    messages that tshark has captured, decoded by npm's @foxglove/cdr

Exit code 77, with the reason, if such a program is not installed.
"""

import csv
import json
import math
import os
import pathlib
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import time
import xml.etree.ElementTree as ElementTree

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from own_domain import own_domain  # noqa: E402

DOMAIN = own_domain()
MM_PER_UNIT = 2
POINTS = 2000
POSE, WRENCH, CLOUD = "geometry_msgs/msg/PoseStamped", "geometry_msgs/msg/WrenchStamped", "sensor_msgs/msg/PointCloud2"
TF = "tf2_msgs/msg/TFMessage"
TOPICS = {"rt/lab/pose": POSE, "rt/lab/proxy": POSE, "rt/lab/wrench": WRENCH, "rt/lab/cloud": CLOUD, "rt/tf": TF,
          "rt/tf_static": TF}  # fmt: skip
STANDS = [1, 2, 3, 0, 0, 1, 0]  # pose of the served cloud's frame in the frame map, with w last as in messages
ROS_POSE = [1, 2, 3, 0, 0, 0, 1]  # the same for --ros-pose: w first
CLOUD_FIELDS = [("x", 0), ("y", 4), ("z", 8), ("normal_x", 12), ("normal_y", 16), ("normal_z", 20), ("rgb", 24)]
PACKAGES = ["@foxglove/cdr@3", "@foxglove/rosmsg@5", "@foxglove/rosmsg2-serialization@3",
            "@foxglove/rosmsg-msgs-common@3"]  # fmt: skip


def skip(why):
    print(f"foreign_programs: skipped: {why}")
    sys.exit(77)


def require(is_right, what):
    if not is_right:
        sys.exit(f"foreign_programs: ERROR: {what}")


def wait_for(is_there, what, most_s=20):
    end = time.monotonic() + most_s
    while not is_there():
        require(time.monotonic() < end, what)
        time.sleep(0.02)


class Running:
    """A program that ends with the test."""

    def __init__(self, arguments, output, end=signal.SIGINT):
        self.output, self.end = pathlib.Path(output), end
        with open(output, "wb") as file:
            self.process = subprocess.Popen([str(word) for word in arguments], stdout=file, stderr=subprocess.STDOUT)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self.process.poll() is None:
            self.process.send_signal(self.end)
        self.process.wait(20)

    def said(self):
        return self.output.read_text(errors="replace")


def run(palpate, *arguments):
    done = subprocess.run([palpate, "--quiet", *map(str, arguments)], capture_output=True, text=True, timeout=60)
    require(done.returncode == 0, f"palpate {arguments[0]}: {done.stderr}{done.stdout}")


def points_of(palpate, source, folder, *options):
    """x, y and z of all points, read from a text file with all digits."""
    run(palpate, "convert", source, folder / "points.ply", "--ascii", "--force", *options)
    lines = (folder / "points.ply").read_text().splitlines()
    return [tuple(map(float, line.split()[:3])) for line in lines[lines.index("end_header") + 1 :]]


def single(number):
    return struct.unpack("<f", struct.pack("<f", number))[0]


def hand_and_cloud(palpate, folder, hears, listening):
    """Serves a cloud and runs a hand while the program `hears` receives both until it ends."""
    run(palpate, "make", "sphere", "-n", POINTS, "-o", folder / "model.ply")
    common = ["--domain", DOMAIN, "--ros", "lab", "--mm-per-unit", MM_PER_UNIT]
    serve = [palpate, "serve", folder / "model.ply", "--name", f"clay{DOMAIN}", *common,
             "--ros-parent", "map", "--ros-pose", ",".join(map(str, ROS_POSE))]  # fmt: skip
    with Running(serve, folder / "serve.log") as server:
        wait_for(lambda: "serving" in server.said(), "nothing is served: " + server.said())
        with Running(hears, folder / "heard") as hearing:
            wait_for(lambda: listening(hearing), "nobody listens: " + hearing.said())
            run(palpate, "touch", folder / "model.ply", "--backend", "cpu", "--realtime", "--duration", 1.6,
                "--ros-rate", 50, "--trace", folder / "trace.csv", *common)  # fmt: skip
            require(hearing.process.wait(20) == 0, "who listens has failed: " + hearing.said())
    with open(folder / "trace.csv", newline="") as file:
        return list(csv.DictReader(file)), hearing.said()


def numbers_of(row, *names):
    return [float(row[f"{name}_{axis}"]) for name in names for axis in "xyz"]


def is_near(heard, expected, off):
    return all(abs(a - b) <= off for a, b in zip(heard, expected))


def check_hand(heard, rows, frames=False):
    """Each message of a topic equals a row of the trace, in order, in metres and newtons. `frames` adds tf."""
    metres = MM_PER_UNIT * 1e-3
    of_row = {
        "pose": lambda row: [metres * number for number in numbers_of(row, "hip")],
        "proxy": lambda row: [metres * number for number in numbers_of(row, "proxy")],
        "wrench": lambda row: numbers_of(row, "force") + [0, 0, 0],
    }
    if frames:
        of_row["tf"] = of_row["pose"]
    most_N = 0
    for topic, expected in of_row.items():
        messages = [message for message in heard if message["topic"] == topic]
        require(5 < len(messages) <= 82, f"{len(messages)} messages of {topic} were heard")
        stamps = [message["sec"] + 1e-9 * message["nanosec"] for message in messages]
        require(abs(stamps[-1] - time.time()) < 60, f"{topic} is of {stamps[-1]}")
        require(all(0.001 < b - a for a, b in zip(stamps, stamps[1:])), f"times of {topic} do not go on: {stamps}")
        at = 0
        for message in messages:
            require(message["frame"] == "lab", f"{topic} is in {message['frame']}")
            require(topic != "tf" or message["child"] == "lab/hand", f"{topic} is of {message.get('child')}")
            numbers = message["numbers"][:3] if topic != "wrench" else message["numbers"]
            while at < len(rows) and not is_near(numbers, expected(rows[at]), 1e-9):
                at += 1
            require(at < len(rows), f"{topic} {numbers} is in no row of the trace")
            if topic == "wrench":
                most_N = max(most_N, math.hypot(*numbers[:3]))
            else:
                turn = message["numbers"][3:]
                require(abs(math.hypot(*turn) - 1) < 1e-9, f"{topic} has no unit quaternion: {turn}")
    require(most_N > 0.5, f"no force was heard: {most_N} N at most")


def check_cloud(places, palpate, folder):
    expected = points_of(palpate, folder / "model.ply", folder)
    require(len(places) == len(expected) == POINTS, f"{len(places)} points were heard")
    metres = MM_PER_UNIT * 1e-3
    require(all(is_near(a, [metres * n for n in b], 1e-7) for a, b in zip(places, expected)), "points are elsewhere")


def fastdds(palpate, folder, peer=None):
    if peer is None:
        skip("there is no Fast DDS (libfastrtps-dev, libfastcdr-dev)")
    rows, said = hand_and_cloud(palpate, folder, [peer, "hear", DOMAIN, "lab", 4],
                                lambda hearing: '"topic": "cloud"' in hearing.said())  # fmt: skip
    heard = [json.loads(line) for line in said.splitlines()]
    check_hand(heard, rows)
    clouds = [message for message in heard if message["topic"] == "cloud"]
    require(clouds[0]["fields"] == [f"{name} {offset} 7 1" for name, offset in CLOUD_FIELDS], f"{clouds[0]['fields']}")
    numbers = clouds[0]["numbers"]
    check_cloud([numbers[i : i + 3] for i in range(0, len(numbers), 3)], palpate, folder)
    with Running([peer, "send", DOMAIN, "square", 60], folder / "sent", signal.SIGTERM):
        check_square(palpate, folder)
    print(f"Fast DDS has heard {len(heard)} messages, and was heard")


def check_square(palpate, folder):
    """The peer's points, read as a still cloud and felt frame by frame: 41 x 31 points on z = 2 + x / 4."""
    expected = [(single(0.005) * (i % 41), single(0.005) * (i // 41)) for i in range(31 * 41)]
    points = points_of(palpate, "ros:/square", folder, "--domain", DOMAIN)
    require(len(points) == 31 * 41, f"{len(points)} points have come")
    require(all(is_near(a, (*b, 2 + b[0] / 4), 1e-6) for a, b in zip(points, expected)), "they are elsewhere")
    hand = (0.1, 0.075, 2.03)
    depth_mm = 1000 * (hand[2] - 2 - hand[0] / 4) / math.sqrt(1 + 1 / 16)
    (folder / "path.csv").write_text(f"t_s,x,y,z\n0,0.1,0.075,1.9\n0.3,0.1,0.075,{hand[2]}\n1,0.1,0.075,{hand[2]}\n")
    run(palpate, "touch", "--live", "ros:/square", "--realtime", "--backend", "cpu", "--path", folder / "path.csv",
        "--stiffness", 0.4, "--domain", DOMAIN, "--trace", folder / "felt.csv")  # fmt: skip
    with open(folder / "felt.csv", newline="") as file:
        forces = [numbers_of(row, "force") for row in csv.DictReader(file) if float(row["t_s"]) > 0.8]
    out = [n / math.sqrt(1 + 1 / 16) for n in (0.25, 0, -1)]
    require(len(forces) > 50, "nothing was felt")
    for force in forces:
        require(is_near(force, [0.4 * depth_mm * n for n in out], 0.02), f"{force} N at a depth of {depth_mm} mm")


def captured(palpate, folder, listener):
    """The file of tshark's capture of the loopback, and the trace of the hand."""
    if shutil.which("tshark") is None:
        skip("there is no tshark")
    first = 7400 + 250 * DOMAIN
    wire = folder / "wire.pcapng"
    capture = ["tshark", "-q", "-i", "lo", "-f", f"udp portrange {first}-{first + 100}", "-w", wire]
    with Running(capture, folder / "tshark.log") as tshark:
        end = time.monotonic() + 20
        while "Capture started" not in tshark.said():
            if tshark.process.poll() is not None or time.monotonic() > end:
                skip("tshark cannot capture here: " + tshark.said())
            time.sleep(0.02)
        rows, _ = hand_and_cloud(palpate, folder, [listener, DOMAIN, "lab", 2.5],
                                 lambda hearing: "listening" in hearing.said())  # fmt: skip
        time.sleep(0.3)  # until tshark has written the last packets
    return wire, rows


def tshark_reads(wire, *arguments):
    # tshark recognises RTPS by its content here; by port number it would take some packets for those of games.
    command = ["tshark", "-r", wire, "-o", "udp.try_heuristic_first:TRUE", *arguments]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60)
    require(done.returncode == 0, "tshark: " + done.stderr)
    return done.stdout


def columns(*names):
    return ["-T", "fields", *(word for name in names for word in ("-e", name))]


def dissected(palpate, folder, listener):
    wire, _ = captured(palpate, folder, listener)
    text = tshark_reads(wire, *columns("frame.protocols", "_ws.malformed", "_ws.expert.severity"))
    packets = [line.split("\t") for line in text.splitlines()]
    others = [protocols for protocols, *_ in packets if not protocols.endswith(":rtps")]
    require(len(packets) > 100 and not others, f"of {len(packets)} packets some are no RTPS: {others}")
    warning = 0x600000  # PI_WARN; an error is more
    severities = [[int(severity) for severity in packet[2].split(",") if severity] for packet in packets]
    wrong = [packet for packet, all_of in zip(packets, severities) if packet[1] or max(all_of, default=0) >= warning]
    require(not wrong, f"malformed packets: {wrong}")
    # Samples that only palpate writes, whole or in fragments, identified by the earlier discovery of its writers.
    samples = "(rtps.sm.id == 0x15 || rtps.sm.id == 0x16) && rtps.sm.wrEntityId.entityKind == 0x03"
    seen = set()
    for line in tshark_reads(wire, "-Y", samples, *columns("rtps.param.topicName", "rtps.param.typeName")).splitlines():
        topics, types = line.split("\t")
        seen |= set(zip(topics.split(","), types.split(",")))
    for topic, message in TOPICS.items():
        package, _, name = message.split("/")
        expected = (topic, f"{package}::msg::dds_::{name}_")
        require(expected in seen, f"{expected} is not among {seen}")
    print(f"tshark has read {len(packets)} packets, none malformed, with all {len(TOPICS)} topics")


def payloads(wire):
    """Topic and bytes of each sample, including its encapsulation, as tshark finds them in the packets."""
    text = tshark_reads(wire, "-Y", "rtps.sm.id == 0x15 || rtps.sm.id == 0x16", "-T", "pdml")
    fragments = {}
    for part in ElementTree.fromstring(text).iter("field"):
        if part.get("name") != "rtps.sm.id":
            continue
        shown = {field.get("name"): field.get("show") for field in part.iter("field")}
        topic = shown.get("rtps.param.topicName")
        whole = part.find(".//field[@show='serializedData']")  # includes the encapsulation, unlike issueData
        if topic not in TOPICS:
            continue
        if shown["rtps.sm.id"] == "0x15" and "rtps.issueData" in shown:  # excludes discovery
            yield topic, whole.get("value")
        elif shown["rtps.sm.id"] == "0x16":
            sample = fragments.setdefault((topic, shown["rtps.sm.seqNumber"]), {})
            begin = 4 + 4 + int(shown["rtps.octets_to_inline_qos"])
            number = int(shown["rtps.data_frag.number"])
            if number in sample:  # sent again
                continue
            sample[number] = part.get("value")[2 * begin :]
            data = "".join(sample[number] for number in sorted(sample))
            if len(data) == 2 * int(shown["rtps.data_frag.sample_size"]):
                yield topic, data


def installing(folder):
    """Starts npm, which fetches the packages in the background."""
    if shutil.which("node") is None or shutil.which("npm") is None:
        skip("there is no node with npm")
    command = ["npm", "install", "--prefix", folder, "--no-audit", "--no-fund", "--ignore-scripts", *PACKAGES]
    return Running(command, folder / "npm.log", signal.SIGTERM)


def finish(npm):
    try:
        code = npm.process.wait(40)
    except subprocess.TimeoutExpired:
        skip("npm's packages do not come within 40 seconds")
    if code != 0:
        skip("npm's packages cannot be had: " + npm.said().strip()[-300:])


def decoded(palpate, folder, listener):
    with installing(folder) as npm:
        wire, rows = captured(palpate, folder, listener)
        finish(npm)
    samples = list(payloads(wire))
    lines = "".join(json.dumps({"type": TOPICS[topic], "bytes": data}) + "\n" for topic, data in samples)
    script = pathlib.Path(__file__).with_name("decode_cdr.mjs")
    done = subprocess.run(["node", script, folder], input=lines, capture_output=True, text=True, timeout=60)
    require(done.returncode == 0, "node: " + done.stderr)
    messages = [json.loads(line) for line in done.stdout.splitlines()]
    require(len(messages) == len(samples), f"{len(messages)} of {len(samples)} samples were decoded")
    heard = [in_one_list(topic.split("/")[-1], message) for (topic, _), message in zip(samples, messages)]
    check_hand(heard, rows, frames=True)
    stands = [message for message in heard if message["topic"] == "tf_static"]
    expected = {"numbers": STANDS, "frame": "map", "child": "lab"}
    require(len(stands) == 1 and stands[0].items() >= expected.items(), f"the cloud's frame: {stands}")
    clouds = [message for message in messages if "point_step" in message]
    require(len(clouds) == 1 and clouds[0]["height"] == 1 and clouds[0]["is_dense"] is True, f"{len(clouds)} clouds")
    fields = [{"name": name, "offset": offset, "datatype": 7, "count": 1} for name, offset in CLOUD_FIELDS]
    require(clouds[0]["fields"] == fields, f"fields of the cloud: {clouds[0]['fields']}")
    data = bytes.fromhex(clouds[0]["data"])
    require(len(data) == clouds[0]["row_step"] == 28 * clouds[0]["width"], f"{len(data)} bytes of points")
    check_cloud([point[:3] for point in struct.iter_unpack("<7f", data)], palpate, folder)
    print(f"@foxglove/cdr has decoded {len(messages)} messages as they were sent")


def in_one_list(topic, message):
    if "transforms" in message:
        require(len(message["transforms"]) == 1, f"transforms of {topic}: {message}")
        message = message["transforms"][0]
    stamp = message["header"]["stamp"]
    parts = message.get("pose") or message.get("wrench") or message.get("transform") or {}
    numbers = [number for part in parts.values() for number in part.values()]
    return {"topic": topic, "sec": stamp["sec"], "nanosec": stamp.get("nanosec", stamp.get("nsec")),
            "frame": message["header"]["frame_id"], "child": message.get("child_frame_id"),
            "numbers": numbers}  # fmt: skip


PROGRAMS = {"fastdds": fastdds, "dissected": dissected, "decoded": decoded}


def main():
    if len(sys.argv) < 3 or sys.argv[1] not in PROGRAMS:
        sys.exit(__doc__)
    with tempfile.TemporaryDirectory() as folder:
        PROGRAMS[sys.argv[1]](sys.argv[2], pathlib.Path(folder), *sys.argv[3:])


if __name__ == "__main__":
    main()
