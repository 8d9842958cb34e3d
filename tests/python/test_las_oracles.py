"""LAS, LAZ and COPC compared with npm's laz-perf, copc and @loaders.gl/las, and LAS with the bytes of its records."""

from __future__ import annotations

import json
import pathlib
import struct
import subprocess

import numpy as np
import palpate as pp
import pytest

SCANS = pathlib.Path(__file__).resolve().parents[3] / "shared" / "models" / "formats"

# Records of LAS 1.4 R15, section 2.6, tables 7 to 16, without the bit fields.
OLD = [("X", "<i4"), ("Y", "<i4"), ("Z", "<i4"), ("intensity", "<u2"), ("bits", "u1"), ("class", "u1"),
       ("scan_angle_rank", "i1"), ("user_data", "u1"), ("point_source_id", "<u2")]  # fmt: skip
NEW = [("X", "<i4"), ("Y", "<i4"), ("Z", "<i4"), ("intensity", "<u2"), ("returns", "u1"), ("flags", "u1"),
       ("classification", "u1"), ("user_data", "u1"), ("scan_angle", "<i2"), ("point_source_id", "<u2"),
       ("gps_time", "<f8")]  # fmt: skip
TIME = [("gps_time", "<f8")]
COLOR, INFRARED = [("red", "<u2"), ("green", "<u2"), ("blue", "<u2")], [("near_infrared", "<u2")]
WAVE = [("wave_packet_descriptor", "u1"), ("wave_packet_offset", "<u8"), ("wave_packet_size", "<u4"),
        ("return_point_wave_location", "<f4"), ("wave_x_t", "<f4"), ("wave_y_t", "<f4"),
        ("wave_z_t", "<f4")]  # fmt: skip
FORMATS = {0: OLD, 1: OLD + TIME, 2: OLD + COLOR, 3: OLD + TIME + COLOR, 4: OLD + TIME + WAVE, 6: NEW, 7: NEW + COLOR,
           8: NEW + COLOR + INFRARED}  # fmt: skip


@pytest.fixture(scope="module")
def packages(npm):
    return npm("laz-perf@0.0.7", "copc@0.0.8", "@loaders.gl/core@4", "@loaders.gl/las@4")


def scan(name: str) -> pathlib.Path:
    if not (SCANS / name).exists():
        pytest.skip(f"no ../shared/models/formats/{name}")
    return SCANS / name


def foreign(packages, kind: str, file: pathlib.Path, tmp_path) -> tuple[object, bytes]:
    script = pathlib.Path(__file__).with_name("foreign_las.mjs")
    subprocess.run(["node", script, packages, kind, file, tmp_path / "read.bin"], check=True, timeout=60)
    said, _, rest = (tmp_path / "read.bin").read_bytes().partition(b"\n")
    return json.loads(said), rest


def header_of(file: pathlib.Path) -> dict[str, object]:
    head = file.read_bytes()[:375]
    begin, = struct.unpack_from("<I", head, 96)
    point_format, length, count = head[104] & 63, *struct.unpack_from("<HI", head, 105)
    if head[25] >= 4:
        count, = struct.unpack_from("<Q", head, 247)
    numbers = struct.unpack_from("<6d", head, 131)
    return {"begin": begin, "format": point_format, "length": length, "count": count, "scale": numbers[:3],
            "offset": numbers[3:]}  # fmt: skip


def columns_of(records: bytes, point_format: int, length: int, scale, offset) -> dict[str, np.ndarray]:
    """The columns of a file's points, under the names that palpate gives them."""
    layout = FORMATS[point_format]
    known = np.dtype(layout).itemsize
    rows = np.frombuffer(records, np.dtype([*layout, ("extra", f"V{length - known}")] if length > known else layout))
    packed = ("X", "Y", "Z", "bits", "class", "returns", "flags")
    columns = {name: rows[name] for name, _ in layout if name not in packed}
    columns["xyz"] = np.column_stack([rows[axis] * scale[i] + offset[i] for i, axis in enumerate("XYZ")])
    if "bits" in rows.dtype.names:
        bits, kind = rows["bits"], rows["class"]
        columns |= {"return_number": bits & 7, "number_of_returns": bits >> 3 & 7, "scan_direction_flag": bits >> 6 & 1,
                    "edge_of_flight_line": bits >> 7, "classification": kind & 31, "synthetic": kind >> 5 & 1,
                    "key_point": kind >> 6 & 1, "withheld": kind >> 7}  # fmt: skip
    else:
        returns, flags = rows["returns"], rows["flags"]
        columns |= {"return_number": returns & 15, "number_of_returns": returns >> 4, "synthetic": flags & 1,
                    "key_point": flags >> 1 & 1, "withheld": flags >> 2 & 1, "overlap": flags >> 3 & 1,
                    "scanner_channel": flags >> 4 & 3, "scan_direction_flag": flags >> 6 & 1,
                    "edge_of_flight_line": flags >> 7}  # fmt: skip
    return columns


def require_same(cloud: pp.Cloud, columns: dict[str, np.ndarray], order: np.ndarray | slice = slice(None)) -> None:
    """`order`: index of the cloud's point for each row of the columns."""
    columns = dict(columns)
    assert np.array_equal(np.asarray(cloud.xyz, float)[order], columns.pop("xyz"))
    if "red" in columns:
        colors = np.column_stack([columns.pop(name) for name in ("red", "green", "blue")])
        wide = colors.max(initial=0) > 255
        if cloud.colors is None:
            assert not colors.any()
        else:
            assert np.array_equal(cloud.colors[order, :3], colors >> 8 if wide else colors)
    for name, column in columns.items():
        if name in cloud.attributes:
            assert np.array_equal(cloud.attribute(name)[order], column), name
        else:  # palpate leaves out columns that are zero for all points
            assert not column.any(), name


@pytest.mark.parametrize("name", ["simple.las", "simple1_3.las", "test1_4.las", "extrabytes.las"])
def test_las_is_what_its_bytes_say(name):
    file = scan(name)
    head = header_of(file)
    records = file.read_bytes()[head["begin"] :][: head["length"] * head["count"]]
    cloud = pp.read(file)
    assert len(cloud) == head["count"]
    require_same(cloud, columns_of(records, head["format"], head["length"], head["scale"], head["offset"]))


@pytest.mark.parametrize("name", ["1_4_w_evlr.laz", "autzen_trim.laz", "ellipsoid.laz", "plane.laz", "simple.laz"])
def test_laz_perf_decodes_the_same_points(packages, tmp_path, name):
    file = scan(name)
    head = header_of(file)
    said, records = foreign(packages, "laz", file, tmp_path)
    cloud = pp.read(file)
    assert said["count"] == len(cloud) > 0
    require_same(cloud, columns_of(records, said["format"], said["length"], head["scale"], head["offset"]))


def test_copc_decodes_the_same_points(packages, tmp_path):
    file = scan("simple.copc.laz")
    head = header_of(file)
    said, records = foreign(packages, "copc", file, tmp_path)
    columns = columns_of(records, said["format"], said["length"], head["scale"], head["offset"])
    cloud = pp.read(file)
    assert said["count"] == len(cloud) > 0
    # copc gives the nodes of the octree in another order; no two points of this file share position and time.
    theirs = np.lexsort([*columns["xyz"].T, columns["gps_time"]])
    ours = np.lexsort([*np.asarray(cloud.xyz).T, cloud.attribute("gps_time")])
    require_same(cloud, {name: column[theirs] for name, column in columns.items()}, ours)


@pytest.mark.parametrize("name", ["simple.las", "simple.laz"])
def test_loaders_gl_reads_the_same_points(packages, tmp_path, name):
    said, values = foreign(packages, "loaders", scan(name), tmp_path)
    kinds = {"Float64Array": np.float64, "Float32Array": np.float32, "Uint16Array": np.uint16, "Uint8Array": np.uint8}
    arrays, at = {}, 0
    for array in said:
        kind = np.dtype(kinds[array["kind"]])
        arrays[array["name"]] = np.frombuffer(values, kind, array["length"], at)
        at += kind.itemsize * array["length"]
    assert at == len(values)
    cloud = pp.read(scan(name))
    assert np.array_equal(np.asarray(cloud.xyz, float), arrays["POSITION"].reshape(-1, 3))
    assert np.array_equal(cloud.attribute("intensity"), arrays["intensity"])
    assert np.array_equal(cloud.attribute("classification"), arrays["classification"])
    assert np.array_equal(cloud.colors[:, :3], arrays["COLOR_0"].reshape(-1, 4)[:, :3])


@pytest.mark.parametrize(
    "name", ["1_4_w_evlr.laz", "autzen_trim.laz", "ellipsoid.laz", "simple.copc.laz", "test1_4.las"])
def test_laz_perf_decodes_what_is_written(packages, tmp_path, name):
    cloud = pp.read(scan(name))
    written = tmp_path / "written.laz"
    pp.write(written, cloud)
    head = header_of(written)
    said, records = foreign(packages, "laz", written, tmp_path)
    assert said["count"] == len(cloud)
    columns = columns_of(records, said["format"], said["length"], head["scale"], head["offset"])
    require_same(pp.read(written), columns)
    # The written points equal the original ones: positions within 0.51 of the file's step.
    assert np.abs(columns["xyz"] - np.asarray(cloud.xyz)).max() <= 0.51 * max(head["scale"])
    for attribute in ("intensity", "classification", "return_number", "gps_time", "point_source_id"):
        if attribute in cloud.attributes:
            assert np.array_equal(columns[attribute], cloud.attribute(attribute)), attribute
