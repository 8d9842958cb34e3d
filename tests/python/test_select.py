from __future__ import annotations

import numpy as np
import palpate as pp
import pytest


def scan(count: int = 4000) -> pp.Cloud:
    rng = np.random.default_rng(3)
    xyz = rng.random((count, 3)) * [10, 10, 0.1] + [637000, 849000, 0]
    xyz[7] += [0, 0, 5]
    return pp.Cloud(xyz, colors=(rng.random((count, 3)) * 255).astype(np.uint8))


def test_a_condition_is_a_mask_like_numpys():
    cloud = scan()
    x, _, z = cloud.xyz.T
    red = cloud.colors[:, 0]
    mask = cloud.select("z > 0.05 & red >= 128 || x < 637001")
    assert mask.dtype == bool and mask.shape == (4000,)
    assert np.array_equal(mask, (z > 0.05) & (red >= 128) | (x < 637001))
    assert not cloud.select("z > 99").any()
    assert np.array_equal(cloud.field("z * 2 + 1"), z * 2 + 1)


def test_a_masked_cloud_keeps_all_that_its_points_have(tmp_path):
    cloud = scan()
    mask = cloud.select("z > 0.05")
    some = cloud[mask]
    assert np.array_equal(some.xyz, cloud.xyz[mask]) and np.array_equal(some.colors, cloud.colors[mask])
    assert len(cloud[~mask]) + len(some) == 4000
    assert len(cloud[np.zeros(4000, bool)]) == 0
    labelled = cloud.prepared(set=["int64 id = 9007199254740993", "uint8 label = 3 if z > 0.05"])
    assert labelled.attribute("id").dtype == np.int64 and labelled.attribute("id")[0] == 9007199254740993
    assert np.array_equal(labelled.attribute("label"), np.where(mask, 3, 0))
    pp.write(tmp_path / "a.las", labelled)
    again = pp.read(tmp_path / "a.las")
    assert np.array_equal(again[again.select("label == 3 && id == 9007199254740993")].xyz, again.xyz[mask])


def test_cleaning_gives_masks_and_clouds():
    cloud = scan()
    outliers = cloud.outliers()
    assert outliers[7] and outliers.sum() < 900
    scipy = pytest.importorskip("scipy.spatial")
    near = scipy.cKDTree(cloud.positions.astype(float)).query(cloud.positions.astype(float), 9)[0][:, 1:].mean(1)
    assert np.array_equal(outliers, near > near.mean() + near.std(ddof=1))
    assert np.array_equal(cloud.outliers(8, 3.0), near > near.mean() + 3 * near.std(ddof=1))
    twice = pp.Cloud(np.concatenate([cloud.xyz, cloud.xyz[:10]]))
    assert np.flatnonzero(twice.duplicates()).tolist() == list(range(4000, 4010))
    small = cloud.subsample(1000, mm_per_unit=1000)
    cells = {tuple(cell) for cell in np.floor(cloud.xyz).astype(int)}
    assert len(small) == len(cells) and {tuple(cell) for cell in np.floor(small.xyz).astype(int)} == cells
    assert {tuple(p) for p in small.xyz} <= {tuple(p) for p in cloud.xyz}
    part = cloud.prepared(crop=[[637002, 849002, -1], [637004, 849005, 9]], random=50, seed=2)
    assert len(part) == 50 and part.bounds[1][0] <= 637004


def sphere() -> np.ndarray:
    i = np.arange(5000) + 0.5
    z, angle = 1 - 2 * i / 5000, i * np.pi * (3 - np.sqrt(5))
    return np.column_stack([np.sqrt(1 - z * z) * np.cos(angle), np.sqrt(1 - z * z) * np.sin(angle), z])


def test_holes_are_closed_and_an_axis_set_upright():
    out = sphere()
    holed = out[np.linalg.norm(out - [1, 0, 0], axis=1) > 0.15]
    cloud = pp.Cloud(20 * holed, normals=holed)
    closed = cloud.prepared(fill_holes_mm=9, mm_per_unit=1)
    assert np.array_equal(closed.xyz[:len(holed)], cloud.xyz)
    new = closed.xyz[len(holed):]
    assert len(new) == pytest.approx(5000 - len(holed), abs=5)
    assert np.allclose(np.linalg.norm(new, axis=1), 20, atol=0.01)
    assert len(cloud.prepared(fill_holes_mm=3, mm_per_unit=1)) == len(holed)
    upright = cloud.prepared(upright="y")
    assert np.ptp(upright.xyz[:, 2] - cloud.xyz[:, 1]) < 1e-4


def test_computed_fields_are_those_of_a_sphere():
    out = sphere()
    ball = pp.Cloud(20 * out, normals=out)
    assert np.median(ball.field("curvature", mm_per_unit=1)) == pytest.approx(1 / 20, rel=0.02)
    assert np.median(ball.field("density", mm_per_unit=1)) == pytest.approx(5000 / (4 * np.pi * 400), rel=0.08)
    assert np.allclose(ball.field("height", up="-y"), -ball.xyz[:, 1])


@pytest.mark.parametrize("call, said", [
    (lambda c: c.select("z >"), "column 4: a value is expected after '>'; fields: x, y, z"),
    (lambda c: c.field("wax"), "column 1: unknown field 'wax'"),
    (lambda c: c.prepared(were="z > 1"), "unknown key 'were'; did you mean 'where'?"),
    (lambda c: c.prepared(where=3), "prepare.where: is 3, not a text"),
    (lambda c: c.prepared(set=["z = x >"]), "column 7: a number is expected"),
    (lambda c: c.outliers(0), "neighbours: is 0; it must be at least 1"),
    (lambda c: c.outliers(2000), "prepare.outlier_neighbours"),
    (lambda c: c.field("z", up="up"), "up: unknown axis 'up'"),
    (lambda c: c.field("z", mm_per_unit=-1), "mm_per_unit: -1"),
    (lambda c: c[np.zeros(3, bool)], "count: is 3, but the cloud has 4000 points"),
])
def test_what_is_wrong_is_said(call, said):
    with pytest.raises(pp.UsageError) as error:
        call(scan())
    assert said in str(error.value)


@pytest.mark.parametrize("mask", [[1, 2], np.zeros(4000), np.zeros((4000, 1), bool)])
def test_only_booleans_are_masks(mask):
    with pytest.raises(pp.ArgumentTypeError):
        scan()[np.asarray(mask)]
