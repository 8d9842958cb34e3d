from __future__ import annotations

import gc
import os
import pickle
import weakref

import numpy as np
import palpate as pp
import pytest
from conftest import ball_arrays


def test_float32_is_kept_bit_by_bit_and_shown_without_copying():
    xyz = ball_arrays(500)[0].astype(np.float32)
    cloud = pp.Cloud(xyz)
    assert len(cloud) == 500
    assert np.array_equal(cloud.xyz, xyz) and cloud.xyz.dtype == np.float32
    assert np.shares_memory(cloud.xyz, cloud.positions)
    assert np.shares_memory(cloud.positions, cloud.positions)
    assert not np.shares_memory(cloud.xyz, xyz)
    assert cloud.normals is None and cloud.colors is None


def test_doubles_far_away_keep_their_last_bit():
    xyz = ball_arrays(300)[0] + [4.5e6, -3e5, 1234.5]
    cloud = pp.Cloud(xyz)
    assert cloud.xyz.dtype == np.float64
    assert np.array_equal(cloud.xyz, xyz)
    assert np.linalg.norm(np.array(cloud.origin) - xyz.mean(axis=0)) < 200
    for found, truth in zip(cloud.bounds, (xyz.min(axis=0), xyz.max(axis=0))):
        assert np.allclose(found, truth, rtol=0, atol=1e-4)


@pytest.mark.parametrize("turn", [lambda a: a[::-1], lambda a: a[::3], np.asfortranarray, lambda a: a.tolist()])
def test_arrays_of_any_layout_are_the_same_points(turn):
    xyz, normals = ball_arrays(300)
    cloud = pp.Cloud(turn(xyz), normals=turn(normals))
    assert np.array_equal(cloud.xyz, np.asarray(turn(xyz)))
    assert np.allclose(cloud.normals, np.asarray(turn(normals)), atol=1e-6)


def test_whole_numbers_are_places_too():
    assert np.array_equal(pp.Cloud([[1, 2, 3], [4, 5, 6]]).xyz, [[1, 2, 3], [4, 5, 6]])


@pytest.mark.parametrize("colors", [
    np.array([[255, 0, 51]], np.uint8),
    np.array([[65535, 0, 13107]], np.uint16),
    np.array([[1, 0, 0.2]], np.float32),
    np.array([[1, 0, 0.2]]),
    np.array([[255, 0, 51, 7]], np.uint8),
    np.array([[65535, 0, 13107, 0]], np.uint16),
    np.array([[1, 0, 0.2, 0.5]]),
])
def test_colors_of_each_type_are_the_same_bytes(colors):
    cloud = pp.Cloud(np.zeros((1, 3)), colors=colors)
    assert cloud.colors.tolist() == [[255, 0, 51, 255]]


def test_views_cannot_be_written_to_and_keep_their_cloud():
    xyz, normals = ball_arrays(100)
    cloud = pp.Cloud(xyz, normals=normals, colors=np.zeros((100, 3), np.uint8))
    for view in (cloud.positions, cloud.normals, cloud.colors, cloud.xyz):
        with pytest.raises(ValueError):
            view[0, 0] = 1
    kept = cloud.normals
    before = kept.copy()
    gone = weakref.ref(cloud) if hasattr(cloud, "__weakref__") else None
    del cloud
    gc.collect()
    [pp.Cloud(np.ones((100, 3))) for _ in range(50)]
    assert np.array_equal(kept, before)
    assert gone is None or gone() is not None


@pytest.mark.parametrize("wrong", [
    np.ones((5, 3), complex), np.ones((5, 3), bool), np.array([["1", "2", "3"]]), np.array([[b"1", b"2", b"3"]]),
])
def test_what_is_no_real_number_is_refused_although_numpy_would_cast_it(session, wrong):
    for call in (lambda: pp.Cloud(wrong), lambda: session.touch(wrong), lambda: session.nearest(wrong)):
        with pytest.raises(ValueError, match="must be real numbers, not of the type"):
            call()


def test_names_of_files_are_those_of_the_system(tmp_path):
    cloud = pp.Cloud(np.eye(3))
    for name in (os.fsdecode(b"\xff\xfe.ply"), "x" * 251 + ".ply", "\N{SNOWMAN}.ply"):
        pp.write(tmp_path / name, cloud)
        assert len(pp.read(tmp_path / name)) == 3
        assert sorted(os.listdir(tmp_path)) == [name]
        os.remove(tmp_path / name)
    with pytest.raises(pp.Error, match="cannot be read"):
        pp.read(tmp_path / os.fsdecode(b"\xff.ply"))
    for call in (lambda: pp.read("a\0b.ply"), lambda: pp.write("a\0b.ply", cloud)):
        with pytest.raises(pp.UsageError, match="contains a NUL"):
            call()


@pytest.mark.parametrize("wrong", [np.zeros(3), np.zeros((3, 2)), np.zeros((2, 3, 1)), "points", [["a", "b", "c"]]])
def test_what_is_no_array_of_points_is_refused(wrong):
    with pytest.raises(ValueError, match="xyz"):
        pp.Cloud(wrong)


def test_other_arrays_have_a_row_for_each_point():
    with pytest.raises(ValueError, match="normals"):
        pp.Cloud(np.zeros((5, 3)), normals=np.zeros((4, 3)))
    with pytest.raises(ValueError, match="colors"):
        pp.Cloud(np.zeros((5, 3)), colors=np.zeros((5, 2)))
    with pytest.raises(TypeError, match="whole numbers"):
        pp.Cloud(np.zeros((5, 3)), colors=np.zeros((5, 3), np.complex128))
    with pytest.raises(pp.UsageError, match="row 2"):
        pp.Cloud([[0, 0, 0], [1, 1, 1], [np.nan, 0, 0]])


def test_files_go_and_come_back(tmp_path):
    xyz, normals = ball_arrays(200)
    cloud = pp.Cloud(xyz.astype(np.float32), normals=normals)
    for name in ("ball.ply", "ball.pcd", "ball.npy"):
        pp.write(tmp_path / name, cloud)
        assert np.array_equal(pp.read(tmp_path / name).xyz, cloud.xyz)
        pp.write(str(tmp_path / name), cloud, backup=True)
        assert (tmp_path / (name + ".bak")).exists()
    assert ".las" in pp.formats_read() and ".ply" in pp.formats_written()
    with pytest.raises(pp.UsageError):
        pp.write(tmp_path / "ball.xlsx", cloud)


def test_a_file_that_lies_is_an_error_with_its_line(tmp_path):
    file = tmp_path / "bad.ply"
    file.write_text("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
                    "property float z\nend_header\n1 two 3\n")
    with pytest.raises(pp.Error) as caught:
        pp.read(file)
    assert caught.value.file == str(file) and caught.value.line == 8 and caught.value.status == "file"
    with pytest.raises(pp.Error) as caught:
        pp.read(tmp_path / "none.ply")
    assert caught.value.line is None and not isinstance(caught.value, ValueError)


def test_attributes_of_a_file_are_views(tmp_path):
    file = tmp_path / "scan.ply"
    file.write_text("ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n"
                    "property ushort intensity\nend_header\n0 0 0 17\n1 2 3 60000\n")
    cloud = pp.read(file)
    assert cloud.attributes == ["intensity"]
    intensity = cloud.attribute("intensity")
    assert intensity.dtype == np.uint16 and intensity.tolist() == [17, 60000]
    assert not intensity.flags.writeable
    with pytest.raises(KeyError):
        cloud.attribute("echo")


def test_repr_says_what_there_is():
    xyz, normals = ball_arrays(1000)
    assert repr(pp.Cloud(xyz, normals=normals)).startswith("<palpate.Cloud of 1000 points, normals, 99.")


def test_normals_that_are_zero_are_those_of_the_nearest_point_or_refused():
    xyz, normals = ball_arrays(1000)
    few = normals.copy()
    few[::20] = 0
    assert np.einsum("ij,ij->i", pp.Cloud(xyz, normals=few).normals, normals).min() > 0.95
    for lost in (slice(0, 101), slice(None)):
        many = normals.copy()
        many[lost] = 0
        with pytest.raises(pp.UsageError, match="normals: are zero for more than a tenth of the points"):
            pp.Cloud(xyz, normals=many)
    assert pp.Cloud(np.zeros((0, 3)), normals=np.zeros((0, 3))).normals is None


@pytest.mark.parametrize("offset", [0.0, 4.5e6])
def test_a_pickled_cloud_has_the_same_points(offset, tmp_path):
    xyz, normals = ball_arrays(400)
    colors = np.random.default_rng(1).integers(0, 256, size=(400, 3), dtype=np.uint8)
    for cloud in (pp.Cloud(xyz + offset), pp.Cloud(xyz.astype(np.float32), normals=normals, colors=colors)):
        again = pickle.loads(pickle.dumps(cloud))
        assert again.xyz.dtype == cloud.xyz.dtype and np.array_equal(again.xyz, cloud.xyz)
        assert (again.normals is None) == (cloud.normals is None) and (again.colors is None) == (cloud.colors is None)
        if cloud.normals is not None:
            assert np.allclose(again.normals, cloud.normals, atol=1e-6) and np.array_equal(again.colors, cloud.colors)
    rows = np.column_stack([xyz + offset, np.arange(400)])
    np.savetxt(tmp_path / "scan.txt", rows, header="x y z intensity", fmt="%.17g", comments="")
    scan = pp.read(tmp_path / "scan.txt")
    assert scan.attributes == ["intensity"]
    again = pickle.loads(pickle.dumps(scan))
    assert np.array_equal(again.xyz, scan.xyz) and again.attributes == scan.attributes
    assert np.array_equal(again.attribute("intensity"), scan.attribute("intensity"))


def test_a_cloud_says_what_of_its_file_it_does_not_keep(tmp_path):
    assert pp.Cloud(ball_arrays(10)[0]).lost == []
    header = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    points = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
    (tmp_path / "points.ply").write_text(header + "end_header\n" + points)
    assert pp.read(tmp_path / "points.ply").lost == []
    faces = "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
    (tmp_path / "mesh.ply").write_text(header + faces + points + "3 0 1 2\n")
    assert any("face" in line for line in pp.read(tmp_path / "mesh.ply").lost)


def test_clouds_meshes_and_matter_have_pictures_for_notebooks(session):
    nothing = pp.Cloud(np.empty((0, 3)))
    pictures = [each._repr_png_() for each in (session.cloud(), session.mesh(resolution=16), nothing)]
    if pp.can_simulate():
        with pp.Matter("dam", gpu="cpu") as matter:
            pictures.append(matter._repr_png_())
    drawn = [picture for picture in pictures if picture is not None]
    assert all(picture.startswith(b"\x89PNG") for picture in drawn)
    assert pictures[2] is None and (len(drawn) == len(pictures) - 1 or not pp.gpus())
