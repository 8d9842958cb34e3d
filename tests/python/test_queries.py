"""Nearest positions, ray casts, rows, and several clouds in one session."""

from __future__ import annotations

import os
import signal
import threading
import time

import numpy as np
import palpate as pp
import pytest
from conftest import RADIUS, ball_arrays, press_path


def directions(count: int) -> np.ndarray:
    rng = np.random.default_rng(7)
    towards = rng.normal(size=(count, 3))
    return towards / np.linalg.norm(towards, axis=1)[:, None]


def test_nearest_positions_and_rays_meet_the_ball(ball):
    out = directions(500)
    with pp.Session(ball, gpu="cpu", mm_per_unit=1, surface="sphere") as s:
        for found in (s.nearest(80 * out), s.raycast(80 * out, -3 * out)):
            assert found.dtype.names == ("position", "normal", "distance", "row", "cloud", "found", "behind")
            assert found["found"].all() and not found["behind"].any() and (found["cloud"] == 0).all()
            assert np.allclose(found["distance"], 30, atol=0.01)
            assert np.allclose(found["position"], RADIUS * out, atol=0.02)
            assert np.allclose(found["normal"], out, atol=0.01)
            assert np.linalg.norm(ball.xyz[found["row"]] - found["position"], axis=1).max() < 1
        assert s.raycast(np.zeros((1, 3)), [[0, 0, 5]])["behind"][0]
        missed = s.raycast([[0, 80, 90], [0, 0, 90]], [[0, 0, -1], [0, 0, 1]])
        assert not missed["found"].any() and not missed["distance"].any()
        assert not s.nearest([[0, 0, 80]], max_distance=29)["found"][0]
        assert len(s.nearest(np.zeros((0, 3)))) == 0
        single = s.nearest((80 * out[:3]).astype(np.float32)[::-1])
        assert np.allclose(single["distance"], 30, atol=0.01)


def test_the_nearest_points_themselves_are_those_of_a_search_through_all(ball):
    with pp.Session(ball, gpu="cpu", mm_per_unit=1) as s:
        asked = directions(200) * np.linspace(20, 300, 200)[:, None]
        found = s.nearest(asked, surface=False)
        apart = np.linalg.norm(asked[:, None, :] - ball.xyz[None, :, :], axis=2)
        assert np.allclose(found["distance"], apart.min(axis=1), atol=1e-4)
        assert found["found"].all() and not found["behind"].any()
        assert np.allclose(found["position"], ball.xyz[found["row"]], atol=1e-4)
        assert np.allclose(found["normal"], ball.normals[found["row"]], atol=1e-6)
        assert not s.nearest([[0, 0, 80]], max_distance=29, surface=False)["found"][0]


def test_ctrl_c_ends_a_search_of_many_positions(session):
    asked = np.tile(directions(1000) * 80, (400, 1))
    timer = threading.Timer(0.2, lambda: os.kill(os.getpid(), signal.SIGINT))
    timer.start()
    since = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        session.nearest(asked)
    assert time.monotonic() - since < 5
    assert session.nearest(asked[:1])["found"][0]  # the session is as it was


def test_queries_that_cannot_be_answered_are_refused(session):
    for wrong in ([[0, np.nan, 0]], [[0, 0]], "there"):
        with pytest.raises(ValueError, match="positions"):
            session.nearest(wrong)
    with pytest.raises(ValueError, match="directions: row 1: is 0"):
        session.raycast(np.ones((2, 3)), [[0, 0, 1], [0, 0, 0]])
    with pytest.raises(ValueError, match="directions"):
        session.raycast(np.ones((2, 3)), [[0, 0, 1]])
    with pytest.raises(ValueError, match="max_distance"):
        session.nearest(np.ones((2, 3)), max_distance=-1)


def test_rows_say_what_a_stroke_has_changed(session, ball):
    assert not session.rows()["changed"].any()
    session.push(press_path(5, 150, 50), radius_mm=6)
    rows, now = session.rows(), session.cloud()
    assert len(rows) == len(now)
    kept = rows["cloud"] == 0
    moved = (now.xyz[kept] != ball.xyz[rows["row"][kept]]).any(axis=1)
    assert np.array_equal(moved, rows["changed"][kept]) and moved.sum() > 20
    assert (rows["cloud"][~kept] == -1).all() and rows["changed"][~kept].all()


def test_several_clouds_are_felt_as_one_and_read_back_each_in_its_own_frame(ball):
    half = np.sqrt(0.5)
    poses = [None, pp.Pose(position=(200, 10, -5), orientation=(half, half, 0, 0))]  # z becomes -y

    def placed(p):
        return np.column_stack([200 + p[:, 0], 10 - p[:, 2], -5 + p[:, 1]])

    with pp.Session(ball, gpu="cpu", mm_per_unit=1) as alone:
        expected = alone.touch(press_path(1.5))[-1]
    with pp.Session.of_clouds([ball, ball], gpu="cpu", mm_per_unit=1, poses=poses) as s:
        assert s.points == 2 * len(ball)
        first, second = s.touch(press_path(1.5))[-1], s.touch(placed(press_path(1.5)))[-1]
        assert np.allclose(first["proxy"], expected["proxy"], atol=1e-4)
        assert np.allclose(second["proxy"], placed(expected["proxy"][None])[0], atol=1e-4)
        assert second["force_N"][1] == pytest.approx(-expected["force_N"][2], rel=1e-3)
        s.push(placed(press_path(5, 150, 50)), radius_mm=6, resample=False)
        rows = s.rows()
        changed = rows[rows["changed"]]
        assert len(changed) > 20 and (changed["cloud"] == 1).all()
        assert (ball.xyz[changed["row"], 2] > 40).all()
        hits = s.raycast([[0, 0, 90], [200, 90, -5]], [[0, 0, -1], [0, -1, 0]])
        assert hits["cloud"].tolist() == [0, 1] and hits["row"][0] < 30 and hits["row"][1] > len(ball) - 30
    with pytest.raises(pp.UsageError, match="poses: 1 are given for 2 clouds"):
        pp.Session.of_clouds([ball, ball], poses=[None])
    with pytest.raises(pp.UsageError, match="clouds: 0: its orientation"):
        pp.Session.of_clouds([ball], gpu="cpu", poses=[pp.Pose(orientation=(1, 1, 0, 0))])
    with pytest.raises(pp.ArgumentTypeError, match="a list of Cloud"):
        pp.Session.of_clouds([ball, 3])
    with pytest.raises(pp.UsageError, match="is empty"):
        pp.Session.of_clouds([])


def test_a_soft_body_is_hit_where_it_is_and_water_has_no_surface():
    if not pp.can_simulate():
        pytest.skip("built without water, sand and soft bodies")
    with pp.Session.of_scene("jelly", gpu="cpu") as jelly:
        points = jelly.frame().positions
        middle = (points.min(axis=0) + points.max(axis=0)) / 2
        above = [[middle[0], middle[1], points[:, 2].max() + 10]]
        hit = jelly.raycast(above, [[0, 0, -1]])[0]
        assert hit["found"] and hit["distance"] == pytest.approx(10, abs=3)
        with pytest.raises(pp.Error, match="move"):
            jelly.rows()
    with pp.Session.of_scene("water", gpu="cpu") as water:
        with pytest.raises(pp.Error, match="no surface"):
            water.nearest([[0, 0, 0]])


def test_a_sparse_cloud_has_no_surface():
    xyz, normals = ball_arrays(4)
    with pp.Session(pp.Cloud(xyz, normals=normals), gpu="cpu", radius_mm=1) as s:
        assert not s.nearest([[0, 0, 60]])["found"][0]
