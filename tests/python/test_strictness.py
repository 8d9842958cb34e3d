"""Arguments and calls of a first-time user: they work, or are refused with an error of palpate."""

from __future__ import annotations

import ctypes
import inspect
import io
import os
import signal
import subprocess
import sys
import textwrap
import threading
import time

import numpy as np
import palpate as pp
import pytest
from conftest import RADIUS, ball_arrays, press_path


def test_a_trace_is_saved_by_numpy_and_comes_back(session, ball):
    traces = [session.touch(press_path(1, 20, 5))]
    with pp.Session(ball, gpu="cpu", mm_per_unit=1, tool="pad", tool_points=4) as pad:
        traces.append(pad.touch(press_path(1, 20, 5)))
    for trace in traces:
        file = io.BytesIO()
        np.save(file, trace)
        file.seek(0)
        back = np.load(file)
        assert back.dtype.names == trace.dtype.names
        for name in trace.dtype.names:
            assert np.array_equal(back[name], trace[name]), name


def test_whatever_looks_at_a_session_finds_no_error(session, tmp_path):
    closed = pp.Session(pp.Cloud(ball_arrays(500)[0], normals=ball_arrays(500)[1]), gpu="cpu")
    closed.close()
    for name in dir(session):
        assert hasattr(session, name), name
    inspect.getmembers(session)
    inspect.getmembers(closed)
    assert session.sharing is None and session.paused is None and session.dropped_s is None and session.failure is None
    assert session.other_hands == [] and session.cameras == []
    assert session.port_energies == [] and session.parameters == {}
    assert not hasattr(closed, "points") and getattr(closed, "radius_mm", 7) == 7
    with pytest.raises(pp.ClosedError):
        closed.touch(press_path(1))


def test_an_attribute_that_would_do_nothing_is_refused(session):
    with session.live(builtin="press") as live:
        for thing, name in ((session, "max_force_N"), (session, "frction"), (session, "points"), (live, "rate")):
            with pytest.raises(pp.UnknownAttributeError, match=name) as caught:
                setattr(thing, name, 0.1)
            assert isinstance(caught.value, AttributeError) and caught.value.status == "argument"
    with pytest.raises(pp.Error, match=r"Session\(…, max_force_N=0.1\)"):
        session.max_force_N = 0.1


@pytest.mark.parametrize("call, words", [
    (lambda s: s.touch(), "touch"),
    (lambda s: s.undo("one"), "undo.*strokes.*'one'"),
    (lambda s: s.push(press_path(1), radius_mm="wide"), "radius_mm.*'wide'"),
    (lambda s: s.push(press_path(1), radius_mm=3, radius=3), "radius.*one of them"),
    (lambda s: s.push(press_path(1), size=3), "size.*radius_mm"),
    (lambda s: s.stroke(press_path(1), "paint", color=(1, 2)), "color"),
    (lambda s: s.render((10, 10, 10)), "render"),
    (lambda s: s.render("large"), "render"),
    (lambda s: s.mesh(resolution=1.5), "mesh"),
    (lambda s: s.live(path="along"), "path"),
    (lambda s: s.record(3), "file: must be a path, not 3"),
    (lambda s: pp.Session(s, gpu="cpu"), "cloud"),
    (lambda s: pp.Session.of_scene("water", mm_per_unit="one"), "Session.of_scene.*mm_per_unit must be a number"),
    (lambda s: pp.Cloud(), "Cloud"),
    (lambda s: pp.Cloud([[1, 2]]), "xyz"),
    (lambda s: pp.read(3), "file: must be a path, not 3"),
    (lambda s: pp.write("a.ply", [1]), "write.*cloud must be a Cloud"),
    (lambda s: s.cloud().attribute("rain"), "rain"),
    (lambda s: pp.Matter(3), "Matter.*scene must be a text"),
])
def test_what_does_not_fit_is_an_error_of_palpate_in_its_words(session, call, words):
    with pytest.raises(pp.Error, match=words) as caught:
        call(session)
    text = str(caught.value)
    assert "incompatible" not in text and "supported" not in text and "pybind" not in text
    assert caught.value.status == "argument"


@pytest.mark.skipif(not pp.can_simulate(), reason="this palpate was built without PALPATE_SIMULATION")
def test_scenes_refuse_in_palpates_words():
    with pp.Matter("dam", gpu="cpu") as dam:
        with pytest.raises(pp.UsageError, match="seconds"):
            dam.simulate(-1)
        with pytest.raises(pp.UsageError):
            dam.step("ten")
        with pytest.raises(pp.UnknownAttributeError):
            dam.viscosity = 3


def test_floats_of_0_to_255_are_the_same_colours_as_floats_of_0_to_1():
    xyz, normals = ball_arrays(100)
    bytes_ = np.arange(300).reshape(100, 3).astype(np.uint8)
    expected = pp.Cloud(xyz, colors=bytes_).colors
    for colors in (bytes_.astype(float), bytes_.astype(np.float32), bytes_ / 255):
        assert np.array_equal(pp.Cloud(xyz, colors=colors).colors, expected)
    dark = np.zeros((100, 3))
    dark[7] = (0.5, 1, 0)
    assert pp.Cloud(xyz, colors=dark).colors[7, 1] == 255
    for wrong in (np.nan, np.inf, -1.0, 256.0, 65535.0):
        colors = bytes_ / 255
        colors[3, 1] = wrong
        with pytest.raises(pp.UsageError, match="colors: row 3: green"):
            pp.Cloud(xyz, colors=colors)


def test_rows_under_a_mask_are_refused_and_not_taken(session):
    xyz, normals = ball_arrays(100)
    path = np.ma.masked_less(press_path(1), 0)
    hidden = np.ma.array(xyz, mask=xyz > 49)
    for call in (lambda: pp.Cloud(hidden), lambda: pp.Cloud(xyz, normals=np.ma.array(normals, mask=normals > 0.9)),
                 lambda: pp.Cloud(xyz, colors=np.ma.array(normals, mask=normals < 0)), lambda: session.touch(path)):
        with pytest.raises(pp.UsageError, match="masked"):
            call()
    assert np.array_equal(pp.Cloud(np.ma.array(xyz)).xyz, pp.Cloud(xyz).xyz)


def test_doubles_come_back_as_doubles_wherever_they_are(tmp_path):
    for offset in (0, 4877754.178):
        xyz, normals = ball_arrays(500)
        xyz = xyz + offset
        cloud = pp.Cloud(xyz, normals=normals)
        assert cloud.xyz.dtype == np.float64 and np.allclose(cloud.xyz, xyz, rtol=0, atol=1e-4)
        with pp.Session(cloud, gpu="cpu") as s:
            assert s.cloud().xyz.dtype == np.float64 and np.array_equal(s.cloud().xyz, cloud.xyz)
    whole = pp.Cloud(np.arange(30, dtype=float).reshape(10, 3))
    assert whole.xyz.dtype == np.float64


def test_a_scale_that_nobody_gave_is_told_once_and_lengths_may_be_the_objects_own():
    xyz, normals = ball_arrays(5_000)
    cloud = pp.Cloud(2 * xyz, normals=normals)  # 200 units across
    path = 2 * press_path(5, 60, 10)
    with pp.Session(cloud, gpu="cpu") as s:
        told = [line for line in s.messages if "mm_per_unit" in line]
        assert len(told) == 1 and "0.500083 mm" in told[0]
        s.push(path, radius=8 / s.mm_per_unit, yield_depth=0.5 / s.mm_per_unit)
        own = s.cloud().xyz
        s.undo()
        s.push(path, radius_mm=8, yield_depth_mm=0.5)
        assert np.allclose(s.cloud().xyz, own) and len([line for line in s.messages if "mm_per_unit" in line]) == 1
    with pp.Session(cloud, gpu="cpu", mm_per_unit=1) as s:
        assert s.messages == []


def test_stop_and_close_within_on_ticks_end_a_session_in_order(session, ball):
    for end in ("stop", "close"):
        with pp.Session(ball, gpu="cpu", mm_per_unit=1) as s:
            heard, inside = [], threading.Event()

            def on_ticks(block):
                assert not inside.is_set(), "called within itself"
                inside.set()
                heard.append(block)
                live.stop() if end == "stop" else s.close()
                inside.clear()

            with s.live(builtin="press", on_ticks=on_ticks) as live:
                assert live.wait(30)
            assert heard and not live.running
            if end == "stop":
                times = np.concatenate(heard)["t_s"]
                assert np.allclose(np.diff(times), np.round(np.diff(times), 3))
                assert s.touch(press_path(1, 10, 5)).shape == (15,)


def interrupted(call, after_s: float) -> float:
    """Seconds from Ctrl+C during the call to its KeyboardInterrupt; calls again if the call ended before."""
    for _ in range(20):
        struck, ended = [], False

        def strike() -> None:
            struck.append(time.monotonic())
            os.kill(os.getpid(), signal.SIGINT)

        timer = threading.Timer(after_s, strike)
        timer.start()
        with pytest.raises(KeyboardInterrupt):
            call()
            ended = True
            timer.join()
        if not ended:
            return time.monotonic() - struck[0]
    raise AssertionError(f"always ended within {after_s} s")


SOON = 2.0  # seconds on a busy machine; 0.2 on an idle one


def test_ctrl_c_ends_what_takes_long_and_keeps_what_was_done(ball, tmp_path):
    xyz, normals = ball_arrays(200_000)
    large, long = pp.Cloud(xyz), press_path(4, 100, 120_000)
    assert interrupted(lambda: pp.Session(large, gpu="cpu"), 0.05) < SOON
    pp.write(tmp_path / "ball.xyz", large)
    assert interrupted(lambda: pp.read(tmp_path / "ball.xyz"), 0.03) < SOON

    again = tmp_path / "again.xyz"

    def write() -> None:
        again.unlink(missing_ok=True)
        pp.write(again, large)

    for earlier in range(20):  # a file whose writing was interrupted is either missing or complete
        assert interrupted(write, 0.03 - 0.0014 * earlier) < SOON
        if not again.exists():
            break
        assert len(pp.read(again)) == len(large)
    assert not list(tmp_path.glob("*again*"))
    with pp.Session(ball, gpu="cpu", mm_per_unit=1) as s:
        assert interrupted(lambda: s.touch(long), 0.05) < SOON
        assert interrupted(lambda: s.push(long, radius_mm=5), 1) < SOON
        assert s.undo_count == 1 and s.undo() == 1
        assert np.array_equal(s.cloud().xyz, ball.xyz)
        assert s.touch(press_path(1))["contact"][-1]


@pytest.mark.skipif(not pp.can_simulate(), reason="this palpate was built without PALPATE_SIMULATION")
def test_ctrl_c_ends_a_simulation_after_its_step():
    with pp.Matter("dam", gpu="cpu") as dam:
        assert interrupted(lambda: dam.simulate(1000), 0.2) < SOON
        before = dam.state()["t_s"]
        dam.step(2)
        assert dam.state()["t_s"] == pytest.approx(before + 0.002)


def test_ctrl_c_ends_a_mesh_on_a_software_driver():
    xyz, normals = ball_arrays(20_000)
    with pp.Session(pp.Cloud(xyz, normals=normals), gpu="cpu") as s:
        s.mesh(resolution=8)  # compiles its shaders
        assert interrupted(lambda: s.mesh(resolution=700), 0.5) < SOON
        assert s.mesh(resolution=16).closed


PROGRAM_THAT_STOPS = """
    import palpate as pp, numpy as np
    cloud = pp.Cloud(np.random.default_rng(1).normal(size=(2000, 3)))
    s = pp.Session(cloud, gpu="cpu")
    live = s.live(builtin="press", on_ticks=lambda block: {what})
    live._thread.join(30)
    print("ended", live.running)
"""


@pytest.mark.parametrize("what", ["live.stop()", "s.close()"])
def test_a_program_that_stops_within_on_ticks_ends_in_order(what):
    program = textwrap.dedent(PROGRAM_THAT_STOPS).format(what=what)
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0 and done.stdout == "ended False\n" and done.stderr == "", done


def test_a_law_that_asks_its_own_session_is_told_so(ball):
    def law(told):
        s.undo_count
        return told.force_N

    with pp.Session(ball, gpu="cpu", mm_per_unit=1, law=law, allow_python_law=True) as s:
        with pytest.raises(pp.Error, match="its own session") as caught:
            s.touch(press_path(1, 30, 5))
        assert caught.value.status == "state"
        with pytest.raises(pp.Error, match="its own session"):
            with s.live(path=press_path(1, 30, 500)) as live:
                live.wait(0.5)


@pytest.mark.parametrize("gpu", ["cpu", "gpu"])
def test_a_session_after_fork_is_an_error_and_does_not_hang(ball, gpu):
    named = os.environ.get("PALPATE_GPU", "0") if gpu == "gpu" else "cpu"
    with pp.Session(ball, gpu=named, mm_per_unit=1) as s:
        s.touch(press_path(1, 10, 5))
        child = os.fork()
        if child == 0:
            signal.alarm(20)
            status = 1
            try:
                s.touch(press_path(1, 10, 5))
            except pp.Error as error:
                status = 0 if error.status == "state" and "fork" in str(error) else 2
            s.close()
            os._exit(status)
        assert os.waitpid(child, 0)[1] == 0
        assert s.touch(press_path(1, 10, 5)).shape == (15,)


def test_a_live_session_is_closed_in_a_forked_child_without_an_error(ball):
    with pp.Session(ball, gpu="cpu", mm_per_unit=1) as s, s.live(path=press_path(1, 10, 5)) as live:
        child = os.fork()
        if child == 0:
            signal.alarm(20)
            status = 1
            try:
                s.close()
                status = 0
            finally:
                os._exit(status)
        assert os.waitpid(child, 0)[1] == 0 and live.running
