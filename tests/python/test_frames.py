"""Clouds that move frame by frame, supplied by a program."""

from __future__ import annotations

import json
import struct
import threading
import time
import zlib

import numpy as np
import palpate as pp
import pytest
from conftest import RADIUS, ball_arrays

STAND = np.tile([0.3, -0.2, RADIUS + 1], (100, 1))


@pytest.fixture
def moving():
    xyz, normals = ball_arrays(5000)
    with pp.Session.of_frames(pp.Cloud(xyz, normals=normals), "cpu", 1, surface="sphere") as opened:
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
    t = live.read_ticks()
    live.stop()
    assert not t["contact"][3] and t["contact"][-1] and t["penetration_mm"][-1] == pytest.approx(1, rel=0.25)


def test_what_is_no_frame_is_refused(moving, ball):
    s, xyz, normals = moving
    s.add_frame(0.01, xyz + (0, 0, 1.5), normals)
    bad = xyz.copy()
    bad[7, 1] = np.nan
    for t_s, places, facing, velocities in (
        (0.01, xyz, normals, None), (float("nan"), xyz, normals, None), (1, xyz[:, :2], normals, None),
        (1, bad, normals, None), (1, xyz, normals[:-1], None), (1, xyz, normals, bad), (1, xyz, normals, normals[:3]),
        (1, xyz[:0], normals[:0], None),
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
    with pytest.raises(ValueError, match="max_points: 9 are fewer"):
        pp.Session.of_frames(ball, gpu="cpu", max_points=9)
    for wrong in ({"max_points": 9}, {"stable_rows": True}):
        with pytest.raises(TypeError, match="there is no argument"):
            pp.Session(ball, gpu="cpu", **wrong)


def write_recording(folder) -> str:
    """A wall half a metre away that comes a millimetre nearer with each of ten frames, 100 per second (Redwood)."""
    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    (folder / "depth").mkdir()
    for i in range(10):
        row = b"\0" + struct.pack(">H", 25_000 - 50 * i) * 40
        (folder / "depth" / f"{i:04}.png").write_bytes(
            b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 40, 30, 16, 0, 0, 0, 0))
            + chunk(b"IDAT", zlib.compress(row * 30)) + chunk(b"IEND", b""))
    (folder / "intrinsics.json").write_text(json.dumps(
        {"width": 40, "height": 30, "fx": 100, "fy": 100, "cx": 19.5, "cy": 14.5, "depth_scale": 50_000, "fps": 100}))
    return str(folder)


def test_a_recorded_depth_camera_is_felt(tmp_path, ball):
    folder = write_recording(tmp_path)
    stand = np.tile([0, 0, 0.4975], (120, 1))
    with pp.Session.of_stream(folder, gpu="cpu", mm_per_unit=1000) as s:
        assert s.mm_per_unit == 1000 and s.points == 1200
        t = s.touch(stand)
        assert not t["contact"][15] and t["contact"][60]
        assert t["penetration_mm"][-1] > t["penetration_mm"][60] + 1
        assert 0.4905 < s.frame().positions[:, 2].max() < 0.4925  # from the last frames
        with pytest.raises(pp.UsageError):
            s.push(stand)
    with pp.Session.of_stream(folder, gpu="cpu", mm_per_unit=1000, speed=0.1, loop=True) as slow:
        assert not slow.touch(stand)["contact"].any()
    with pytest.raises(pp.UsageError, match="speed"):
        pp.Session.of_stream(folder, gpu="cpu", speed=-1)
    with pytest.raises(ValueError, match="speed"):
        pp.Session(ball, gpu="cpu", speed=2)
    (tmp_path / "empty").mkdir()
    with pytest.raises(pp.Error) as caught:
        pp.Session.of_stream(tmp_path / "empty", gpu="cpu")
    assert caught.value.status == "file"
