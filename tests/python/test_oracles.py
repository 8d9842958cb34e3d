"""Files compared with those of other programs that read and write them, bit by bit."""

from __future__ import annotations

import shutil
import subprocess

import numpy as np
import palpate as pp
import pytest
from conftest import ball_arrays


def cloud_of(count: int, *, doubles: bool = False) -> pp.Cloud:
    xyz, normals = ball_arrays(max(count, 1))
    xyz, normals = xyz[:count], normals[:count]
    colors = np.arange(3 * count, dtype=np.uint8).reshape(count, 3)
    places = xyz + [4.5e6, -3e5, 1234.5] if doubles else xyz.astype(np.float32)
    return pp.Cloud(places, normals=normals.astype(np.float32), colors=colors)


def same_bits(a: np.ndarray, b: np.ndarray) -> bool:
    return a.dtype == b.dtype and a.shape == b.shape and a.tobytes() == b.tobytes()


@pytest.mark.parametrize("doubles", [False, True])
@pytest.mark.parametrize("count", [1, 2, 3, 1000, 70_000])
def test_numpy_reads_what_is_written(tmp_path, count, doubles):
    cloud = cloud_of(count, doubles=doubles)
    pp.write(tmp_path / "a.npy", cloud)
    rows = np.load(tmp_path / "a.npy")
    assert rows.dtype.names == ("x", "y", "z", "nx", "ny", "nz", "red", "green", "blue")
    assert same_bits(np.column_stack([rows[n] for n in "xyz"]), cloud.xyz)
    assert same_bits(np.column_stack([rows[n] for n in ("nx", "ny", "nz")]), cloud.normals)
    assert same_bits(np.column_stack([rows[n] for n in ("red", "green", "blue")]), cloud.colors[:, :3].copy())
    pp.write(tmp_path / "a.npz", cloud)
    with np.load(tmp_path / "a.npz") as archive:
        assert sorted(archive.files) == ["colors", "normals", "xyz"]
        assert same_bits(archive["xyz"], cloud.xyz)
        assert same_bits(archive["normals"], cloud.normals)
        assert same_bits(archive["colors"], cloud.colors[:, :3].copy())


@pytest.mark.parametrize("save", [np.savez, np.savez_compressed])
@pytest.mark.parametrize("kind", ["<f4", ">f4", "<f8", ">f8"])
@pytest.mark.parametrize("count", [1, 2, 5, 1000, 70_000])
def test_what_numpy_writes_is_read(tmp_path, count, kind, save):
    xyz, normals = ball_arrays(count)
    xyz = xyz.astype(kind)
    normals = normals.astype("<f4")
    colors = np.full((count, 3), 7, np.uint8)  # compressed to a few bits
    weight = np.arange(count, dtype=np.int32)
    save(tmp_path / "a.npz", xyz=xyz, normals=normals, colors=colors, Weight=weight)
    cloud = pp.read(tmp_path / "a.npz")
    native = xyz.astype(xyz.dtype.newbyteorder("="))
    assert np.array_equal(cloud.xyz, native)
    assert np.allclose(cloud.normals, normals, rtol=0, atol=1e-7)
    assert same_bits(cloud.colors[:, :3].copy(), colors)
    assert cloud.attributes == ["Weight"] and same_bits(cloud.attribute("Weight").copy(), weight)
    for order in "CF":
        np.save(tmp_path / "a.npy", np.asarray(xyz, order=order))
        assert np.array_equal(pp.read(tmp_path / "a.npy").xyz, native)


def test_arrays_that_are_packed_into_hardly_anything_are_read(tmp_path):
    for count in range(1, 60):
        np.savez_compressed(tmp_path / "a.npz", xyz=np.zeros((count, 3), np.float32))
        assert np.array_equal(pp.read(tmp_path / "a.npz").xyz, np.zeros((count, 3), np.float32))


def test_pcl_reads_and_writes_the_same_points(tmp_path):
    convert = shutil.which("pcl_convert_pcd_ascii_binary")
    if not convert:
        pytest.skip("pcl-tools is not installed")
    cloud = cloud_of(3000)
    pp.write(tmp_path / "a.pcd", cloud)
    for kind in ("1", "2"):  # binary, and compressed
        subprocess.run([convert, "a.pcd", "b.pcd", kind], cwd=tmp_path, check=True, stdout=subprocess.DEVNULL)
        back = pp.read(tmp_path / "b.pcd")
        assert same_bits(back.xyz.copy(), cloud.xyz.copy())
        assert same_bits(back.colors[:, :3].copy(), cloud.colors[:, :3].copy())


@pytest.mark.parametrize("ending", ["ply", "pcd", "xyz"])
def test_open3d_reads_the_same_points(tmp_path, ending):
    open3d = pytest.importorskip("open3d", reason="Open3D is not installed")
    xyz = ball_arrays(3000)[0].astype(np.float32)
    pp.write(tmp_path / f"a.{ending}", pp.Cloud(xyz))
    read = np.asarray(open3d.io.read_point_cloud(str(tmp_path / f"a.{ending}")).points)
    assert same_bits(read.astype(np.float32), xyz)


@pytest.fixture(scope="module")
def splat_transform(npm):
    return npm("@playcanvas/splat-transform@3") / "node_modules" / ".bin" / "splat-transform"


def test_splat_transform_reads_the_same_gaussians(tmp_path, splat_transform):
    cloud = cloud_of(3000)
    pp.write(tmp_path / "a.3dgs.ply", cloud)
    command = ["node", splat_transform, "-w", tmp_path / "a.3dgs.ply", tmp_path / "a.csv"]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, timeout=60)
    rows = np.genfromtxt(tmp_path / "a.csv", delimiter=",", names=True)
    assert same_bits(np.column_stack([rows[n] for n in "xyz"]).astype(np.float32), cloud.xyz.copy())
    # The view-independent colour (Kerbl 2023: the first harmonic), and the disc's short axis along the normal.
    colors = 255 * (0.5 + 0.28209479177387814 * np.column_stack([rows[f"f_dc_{i}"] for i in range(3)]))
    assert np.abs(colors - cloud.colors[:, :3]).max() < 0.01
    w, x, y, z = (rows[f"rot_{i}"] for i in range(4))
    axis = np.column_stack([2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)])
    assert np.abs(np.abs((axis * cloud.normals).sum(1)) - 1).max() < 1e-5
    assert (rows["scale_2"] < rows["scale_0"] - 1).all() and np.array_equal(rows["scale_0"], rows["scale_1"])


def test_splat_transform_rotates_harmonics_and_levelling_rotates_them_back(tmp_path, splat_transform):
    random = np.random.default_rng(2)
    names = [*"xyz", "f_dc_0", "f_dc_1", "f_dc_2", *(f"f_rest_{k}" for k in range(45)), "opacity",
             "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"]
    flat = np.zeros(2400, [(name, "<f4") for name in names])
    flat["x"], flat["y"] = np.arange(2400) % 40 - 20, np.arange(2400) // 40 - 30
    for name in names[3:51]:
        flat[name] = random.normal(0, 0.3, 2400)
    flat["opacity"], flat["scale_0"], flat["scale_1"], flat["scale_2"], flat["rot_0"] = 3, -0.3, -0.5, -1.6, 1

    def read(file):
        head, body = file.read_bytes().split(b"end_header\n", 1)
        of_file = [line.split()[-1] for line in head.decode().splitlines() if line.startswith("property")]
        return np.frombuffer(body, [(name, "<f4") for name in of_file])

    head = "".join(f"property float {name}\n" for name in names)
    (tmp_path / "flat.ply").write_bytes(
        f"ply\nformat binary_little_endian 1.0\nelement vertex 2400\n{head}end_header\n".encode() + flat.tobytes())
    command = ["node", splat_transform, "-w", tmp_path / "flat.ply", "-r", "20,0,0", tmp_path / "tilted.ply"]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=60)
    pp.write(tmp_path / "level.ply", pp.read(tmp_path / "tilted.ply").prepared(level=True, up="z"))
    flat, tilted, level = (rows[np.argsort(rows["f_dc_0"])]
                           for rows in (flat, read(tmp_path / "tilted.ply"), read(tmp_path / "level.ply")))
    off = [max(np.abs(rows[name] - flat[name]).max() for name in names[6:51]) for rows in (tilted, level)]
    assert off[0] > 0.5  # rotated
    assert off[1] < 1e-3  # and back, as far as the plane is found
