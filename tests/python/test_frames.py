"""Clouds that move frame by frame, as a program says."""

from __future__ import annotations

import threading
import time

import numpy as np
import palpate as pp
import pytest
from conftest import RADIUS, ball_arrays

STAND = np.tile([0.3, -0.2, RADIUS + 1], (100, 1))


@pytest.fixture
def moving():
    xyz, normals = ball_arrays(5000)
    with pp.Session(pp.Cloud(xyz, normals=normals), gpu="cpu", mm_per_unit=1, surface="sphere", moving=True) as opened:
        yield opened, xyz, normals


def test_frames_are_felt_from_their_time_on(moving):
    s, xyz, normals = moving
    s.add_frame(0.05, xyz + (0, 0, 1.5), normals)
    s.add_frame(0.15, (xyz + (0, 0, 2.5)).astype(np.float32), np.asfortranarray(normals))
    t = s.touch(STAND)
    assert not t["contact"][49] and t["contact"][52] and t["penetration_mm"][-1] == pytest.approx(0.5, rel=0.1)
    t = s.touch(STAND)
    assert t["t_s"][0] == pytest.approx(0.1) and t["penetration_mm"][-1] == pytest.approx(1.5, rel=0.1)
    frame = s.frame()
    assert frame.t_s == 0.15 and frame.positions[:, 2].max() == pytest.approx(RADIUS + 2.5, rel=1e-3)
    assert (frame.velocities == 0).all() and s.render((64, 48)).shape == (48, 64, 4)


def test_frames_come_from_another_thread_while_it_is_live(moving):
    s, xyz, normals = moving

    def film():
        for k in range(1, 21):
            s.add_frame(0.02 * k, xyz + (0, 0, -4 + 0.3 * k), normals, np.tile([0, 0, 0.1], (5000, 1)))
            time.sleep(0.02)

    s.add_frame(5, xyz - (0, 0, 4), normals)
    live = s.live(path=np.column_stack([[0.0], STAND[:1]]), rate=500)
    camera = threading.Thread(target=film)
    camera.start()
    camera.join()
    time.sleep(0.3)
    t = live.take()
    live.stop()
    assert not t["contact"][3] and t["contact"][-1] and t["penetration_mm"][-1] == pytest.approx(1, rel=0.25)


def test_what_is_no_frame_is_refused(moving, ball):
    s, xyz, normals = moving
    s.add_frame(0.01, xyz + (0, 0, 1.5), normals)
    bad = xyz.copy()
    bad[7, 1] = np.nan
    for t_s, places, facing, velocities in (
        (0.01, xyz, normals, None), (float("nan"), xyz, normals, None), (1, xyz[:, :2], normals, None), (1, bad, normals, None),
        (1, xyz, normals[:-1], None), (1, xyz, normals, bad), (1, xyz, normals, normals[:3]), (1, xyz[:0], normals[:0], None),
        (1, "abc", normals, None), (1, np.vstack([xyz, xyz]), np.vstack([normals, normals]), None),
    ):
        with pytest.raises(ValueError):
            s.add_frame(t_s, places, facing, velocities)
    with pytest.raises(TypeError):
        s.add_frame("soon", xyz, normals)
    assert s.touch(STAND)["penetration_mm"][-1] == pytest.approx(0.5, rel=0.1)
    with pytest.raises(pp.UsageError, match="sculpted"):
        s.push(STAND)
    with pp.Session(ball, gpu="cpu") as still:
        with pytest.raises(pp.Error) as caught:
            still.add_frame(1, xyz, normals)
        assert caught.value.status == "state"
    s.close()
    with pytest.raises(pp.Error) as caught:
        s.add_frame(1, xyz, normals)
    assert caught.value.status == "handle"
    for wrong in ({"most_points": 9}, {"keeps_points": True}):
        with pytest.raises(ValueError, match="moving"):
            pp.Session(ball, gpu="cpu", **wrong)
    with pytest.raises(ValueError, match="moving"):
        pp.Session("water", gpu="cpu", moving=True)
