"""Several hands, tools of many points, and force laws in Python."""

from __future__ import annotations

import threading
import time

import numpy as np
import palpate as pp
import pytest
from conftest import RADIUS, press_path


def from_left(depth: float) -> np.ndarray:
    z_first = press_path(depth)
    return np.column_stack([-z_first[:, 2], z_first[:, 1], z_first[:, 0]])


def test_hands_feel_at_once_what_each_feels_alone(ball):
    with pp.Session(ball, gpu="cpu", mm_per_unit=1, hands=2) as two, pp.Session(ball, gpu="cpu", mm_per_unit=1) as one:
        t = two.touch([press_path(1), from_left(2)])
        assert t.shape == (200, 2) and t.dtype == pp.tick_dtype
        assert np.array_equal(t["force_N"][:, 0], one.touch(press_path(1))["force_N"])
        assert np.array_equal(t["force_N"][:, 1], one.touch(from_left(2))["force_N"])
        assert t["force_N"][-1, 0, 2] > 0.5 and t["force_N"][-1, 1, 0] < -1
        stacked = two.touch(np.stack([press_path(1), from_left(2)]))
        assert np.array_equal(stacked["force_N"], t["force_N"])
        shorter = two.touch((press_path(1)[:50], from_left(2)))
        assert shorter.shape == (200, 2) and np.array_equal(shorter["hip"][-1, 0], press_path(1)[49])
        before = two.cloud().positions.copy()
        two.push([press_path(4), from_left(4)], radius_mm=5)
        assert two.undo() == 1 and np.array_equal(two.cloud().positions, before)


@pytest.mark.parametrize("wrong", [press_path(1), [press_path(1)], [press_path(1)] * 3, None, 7, "ab", [1, 2],
                                   [press_path(1), np.full((5, 3), np.nan)]])
def test_paths_that_are_not_for_two_hands_are_refused(ball, wrong):
    with pp.Session(ball, gpu="cpu", hands=2) as two:
        with pytest.raises(ValueError, match="path"):
            two.touch(wrong)
        assert two.touch([press_path(1), from_left(1)]).shape == (200, 2)


@pytest.mark.parametrize("options", [{"hands": 0}, {"hands": 9}, {"tool": "spoon"}, {"tool": "pad", "tool_points": 0},
                                     {"tool": "pad", "tool_points": 65}, {"tool": "ball", "tool_size_mm": -1},
                                     {"tool": "spatula", "tool_axis": (0, 0, 0)}])
def test_hands_and_tools_out_of_their_bounds_are_refused(ball, options):
    with pytest.raises(ValueError, match="hands|tool"):
        pp.Session(ball, gpu="cpu", **options)


def test_live_hands_come_in_blocks_of_all_of_them(ball):
    blocks = []
    down, aside = np.array([[0, 0, 0, 52], [0.1, 0, 0, 49]]), np.array([[0, -52, 0, 0], [0.1, -48, 0, 0]])
    with pp.Session(ball, gpu="cpu", mm_per_unit=1, hands=2) as two:
        with two.live(path=down, rate=500, others=[pp.Hand(path=aside)], on_ticks=blocks.append) as live:
            live.wait(0.6)
        ticks = np.concatenate(blocks)
        assert ticks.ndim == 2 and ticks.shape[1] == 2 and len(ticks) > 100
        assert np.array_equal(ticks["t_s"][:, 0], ticks["t_s"][:, 1])
        assert ticks["force_N"][-1, 0, 2] > 0.5 and ticks["force_N"][-1, 1, 0] < -1
        with pytest.raises(pp.UsageError, match="hands: the session has 2"):
            two.live(path=down)
        with pytest.raises(pp.UsageError, match="hands: the session has 2"):
            two.live(path=down, others=[pp.Hand(path=aside), pp.Hand(path=aside)])


@pytest.mark.skipif(not pp.can_simulate(), reason="this palpate was built without PALPATE_SIMULATION")
def test_two_hands_in_one_water(tmp_path):
    with pp.Session.of_scene("water", gpu="cpu", hands=2) as water:
        box = water.frame().positions.max(axis=0)
        still = np.tile(box * (0.25, 0.4, 0.5), (60, 1))
        height = np.linspace(box[1] + 40, box[1], 60)
        dive = np.column_stack([np.full(60, box[0] * 0.7), height, np.full(60, box[2] / 2)])
        t = water.touch([still, dive])
        assert t.shape == (60, 2) and len(water.port_energies) == 2


def test_a_pad_gives_torques(ball):
    aside = press_path(2) + (8, 0, 0)
    with pp.Session(ball, gpu="cpu", mm_per_unit=1, tool="pad", tool_size_mm=10) as padded:
        t = padded.touch(aside)
    assert t.dtype == pp.tool_tick_dtype and t["torque_mNm"].shape == (200, 3)
    assert np.linalg.norm(t["torque_mNm"][-1]) > 0.1 and (t["torque_mNm"][0] == 0).all()
    assert t["hip"][-1] == pytest.approx(aside[-1])


def test_a_law_in_python_is_refused_unless_it_is_allowed(ball):
    with pytest.raises(TypeError, match="allow_python_law"):
        pp.Session(ball, gpu="cpu", law=lambda tick: (0, 0, 0))
    for wrong in (3.5, object(), True):
        with pytest.raises(TypeError):
            pp.Session(ball, gpu="cpu", law=wrong, allow_python_law=True)


def test_a_live_hand_takes_commands_of_several_threads(ball):
    blocks, raised = [], []
    with pp.Session(ball, gpu="cpu", mm_per_unit=1) as s:
        s.set_brush("push", radius_mm=5)
        s.set_brush(None)
        with s.live(path=np.array([[0, 0, 0, 52], [0.1, 0, 0, 48.5]]), rate=500, on_ticks=blocks.append) as live:
            live.wait(0.3)
            begun = len(blocks)

            def repeat(command):
                try:
                    for i in range(10):
                        command(i)
                except pp.Error as error:
                    raised.append(error)

            def other_brush(i):
                s.set_brush("push", radius_mm=4 + 0.1 * i) if i % 2 else s.set_brush(None)

            commands = [other_brush, lambda i: s.undo() if i % 2 else s.redo(), lambda i: s.cloud()]
            threads = [threading.Thread(target=repeat, args=(command,)) for command in commands]
            for thread in threads:
                thread.start()
            for thread in threads:
                thread.join()
            live.wait(0.1)
        assert not raised
        ticks = np.concatenate(blocks[begun:])
        if (np.diff(ticks["t_s"]) < 0.04).all():  # the machine did not stall
            assert (np.linalg.norm(ticks["force_N"], axis=1) > 0).all()
        s.undo(1000)


def test_a_short_name_of_a_live_law_is_not_lost(ball):
    with pp.Session(ball, gpu="cpu", mm_per_unit=1) as s:
        with pytest.raises(pp.Error, match="no.so"):
            s.live(path=np.array([[0, 0, 0, 51], [0.05, 0, 0, 49]]), law="./no.so:law")


def test_a_law_in_python_says_the_force_of_each_tick(ball):
    seen = []

    def half(tick: pp.LawInput):
        seen.append((tick.t_s, tick.dt_s, tick.hip, tick.proxy, tick.normal, tick.neighbours, tick.fresh))
        return [f / 2 for f in tick.force_N]

    with pp.Session(ball, gpu="cpu", mm_per_unit=1, law=half, allow_python_law=True) as s:
        t = s.touch(press_path(1))
    assert t["force_N"][-1, 2] == pytest.approx(0.4 * t["penetration_mm"][-1], rel=1e-3)
    assert len(seen) == t["contact"].sum()
    t_s, dt_s, hip, proxy, normal, neighbours, fresh = seen[-1]
    assert t_s == t["t_s"][-1] and dt_s == pytest.approx(1e-3) and hip == pytest.approx(list(t["hip"][-1]))
    assert proxy == pytest.approx(list(t["proxy"][-1])) and normal == pytest.approx(list(t["normal"][-1]))
    assert neighbours == t["neighbours"][-1] and fresh


@pytest.mark.parametrize("answer", [None, (1, 2), "abc", (0, 0, float("nan")), (float("inf"), 0, 0)])
def test_a_law_that_gives_no_force_is_an_error_and_its_force_zero(ball, answer):
    with pp.Session(ball, gpu="cpu", mm_per_unit=1, law=lambda tick: answer, allow_python_law=True) as s:
        for _ in range(2):
            with pytest.raises((TypeError, ValueError), match="law"):
                s.touch(press_path(1))


def test_what_a_law_raises_comes_out_by_path_and_live(ball):
    def fails(tick):
        raise KeyError("mine")

    with pp.Session(ball, gpu="cpu", mm_per_unit=1, law=fails, allow_python_law=True) as s:
        with pytest.raises(KeyError, match="mine"):
            s.touch(press_path(1))
        live = s.live(path=np.array([[0, 0, 0, 51], [0.05, 0, 0, 49]]))
        time.sleep(0.3)
        assert (live.read_ticks()["force_N"] == 0).all()
        with pytest.raises(KeyError, match="mine"):
            live.stop()


def test_a_live_law_in_python_is_felt_and_a_late_one_fades(ball):
    slow = threading.Event()

    def upwards(tick):
        if slow.is_set():
            time.sleep(0.2)
        return (0, 0, 1.25)

    timed = np.array([[0, 0, 0, 51], [0.05, 0, 0, 49]])
    with pp.Session(ball, gpu="cpu", mm_per_unit=1) as s:
        live = s.live(path=timed, rate=500, law=upwards, allow_python_law=True)
        time.sleep(0.5)
        prompt = live.read_ticks()
        assert prompt["force_N"][-50:, 2].max() == pytest.approx(1.25)
        slow.set()
        time.sleep(0.15)
        live.read_ticks()
        time.sleep(0.35)
        late = live.read_ticks()
        assert late["contact"].all() and (late["force_N"][:, 2] == 0).any()  # after 50 ms a force is zero
        assert live.late_laws > 50
        live.stop()
        assert len(s.touch(press_path(1))) == 200


def test_a_session_with_a_live_law_in_python_can_be_forgotten(ball):
    s = pp.Session(ball, gpu="cpu", mm_per_unit=1, law=lambda tick: (0, 0, 1), allow_python_law=True)
    s.live(path=np.array([[0, 0, 0, 51], [0.05, 0, 0, 49]]))
    time.sleep(0.1)
    s.close()
    with pytest.raises(pp.Error):
        s.touch(press_path(1))
    assert RADIUS == 50
