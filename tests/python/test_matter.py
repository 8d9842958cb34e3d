"""Scenes of matter: alone, under hands by path and live; wrong use raises an error and never crashes."""

from __future__ import annotations

import gc
import json
import threading
import time

import numpy as np
import palpate as pp
import pytest

pytestmark = pytest.mark.skipif(not pp.can_simulate(), reason="this palpate was built without PALPATE_SIMULATION")

TANK = {"matter": "water", "box_mm": [80, 120, 80], "fill_mm": [80, 70, 80], "spacing_mm": 10,
        "tool": {"radius_mm": 20, "mass_kg": 0.034}}
THIN = {"matter": "water", "box_mm": [16, 16, 16], "fill_mm": [16, 16, 16], "spacing_mm": 2, "gravity_m_s2": [0, 0, 0]}


def dive(down: int = 300, rest: int = 100) -> np.ndarray:
    y = np.concatenate([np.linspace(100, 35, down), np.full(rest, 35.0)])
    return np.column_stack([np.full_like(y, 40), y, np.full_like(y, 40)])


def scene_file(folder, scene) -> str:
    file = folder / "scene.json"
    file.write_text(json.dumps(scene))
    return str(file)


@pytest.fixture
def tank(tmp_path) -> str:
    return scene_file(tmp_path, TANK)


@pytest.fixture
def water(tank):
    with pp.Session.of_scene(tank, gpu="cpu") as opened:
        yield opened


def test_matter_alone_is_stepped_and_seen_without_a_copy(tmp_path):
    with pp.Matter(scene_file(tmp_path, {**TANK, "box_mm": [120, 120, 80]}), gpu="cpu") as matter:
        before = matter.frame()
        assert before.t_s == 0 and len(before) == matter.state()["particles"] == before.moving
        matter.step(50)
        matter.simulate(0.05)
        after = matter.frame()
        assert after.t_s == pytest.approx(0.1) and "0.1 s" in repr(after)
        for view in (after.positions, after.velocities):
            assert view.shape == (len(after), 3) and view.dtype == np.float32 and not view.flags.writeable
        assert np.shares_memory(after.positions, after.positions)
        state = matter.state()
        assert state["kinetic_J"] > 0 and state["front_mm"] > before.positions[:, 0].max() + 3
        assert not state["failed"] and "threads" in state["machine"]
        kept = after.positions
        copy = kept.copy()
        matter.reset()
        assert np.array_equal(matter.frame().positions, before.positions)
    del after, matter
    gc.collect()
    assert np.array_equal(kept, copy)


def test_parameters_have_bounds_and_units(tank, water):
    with pp.Matter(tank, gpu="cpu") as matter:
        for governed in (matter, water):
            parameters = governed.parameters
            assert parameters["viscosity_Pa_s"].unit == "Pa s"
            assert parameters["gravity_y_m_s2"].value == pytest.approx(-9.81)
            governed.set("viscosity_Pa_s", 0.5)
            assert governed.parameters["viscosity_Pa_s"].value == 0.5
            with pytest.raises(pp.UsageError, match="viscosity_Pa_s"):
                governed.set("viscosity_Pa_s", float("nan"))
            with pytest.raises(pp.UsageError, match="gain"):
                governed.set("taste", 1)
            with pytest.raises(TypeError):
                governed.set("gain", "much")
            assert governed.parameters["viscosity_Pa_s"].value == 0.5


def test_a_hand_feels_water_and_time_goes_on_until_reset(water):
    first = water.touch(dive())
    assert first["contact"][-1] and first["force_N"][-1, 1] > 0.1 and (first["force_N"][0] == 0).all()
    frame = water.frame()
    assert frame.t_s == pytest.approx(first["t_s"][-1]) and frame.normals.shape == frame.positions.shape
    (energy,) = water.port_energies
    assert energy.now_J > 0 and energy.min_J > -0.005 * energy.now_J  # during the ramp of the force
    more = water.touch(dive()[-5:])
    assert more["t_s"][0] == pytest.approx(first["t_s"][-1] + 1e-3)
    water.reset()
    assert np.array_equal(water.touch(dive())["force_N"], first["force_N"])
    water.pause()
    assert water.paused
    assert (water.touch(dive())["force_N"] == 0).all()
    water.resume()
    assert not water.paused
    assert water.render((64, 48)).shape == (48, 64, 4)
    with pytest.raises(pp.UsageError):
        water.push(dive())


def test_a_gain_set_while_live_is_felt_at_once(water):
    timed = np.array([[0, 40, 100, 40], [0.3, 40, 35, 40]])
    live = water.live(path=timed, rate=500)
    time.sleep(0.8)
    plain = live.read_ticks()["force_N"][-100:, 1].max()
    water.set("gain", 4)
    time.sleep(0.3)
    gained = live.read_ticks()["force_N"][-100:, 1].max()
    one = water.frame()
    time.sleep(0.1)
    two = water.frame()
    live.stop()
    assert plain > 0.05 and gained > 1.5 * plain
    assert two.t_s > one.t_s and not np.array_equal(two.positions, one.positions)


def test_matter_that_diverges_raises_by_path_and_live(tmp_path):
    wild = np.array([[8, 16 if k % 4 < 2 else 0, 8] for k in range(1000)], dtype=float)
    with pp.Session.of_scene(scene_file(tmp_path, THIN), gpu="cpu") as thin:
        with pytest.raises(pp.Error, match="diverged") as caught:
            thin.touch(wild)
        assert caught.value.status == "simulation" and thin.failure == "has diverged"
        with pytest.raises(pp.Error, match="diverged"):
            thin.touch(wild[:3])
        thin.reset()
        thin.touch(wild[:3])
        assert thin.failure is None
        live = thin.live(path=np.tile(wild, (20, 1)))
        with pytest.raises(pp.Error, match="diverged") as caught:
            live.wait(20)
        assert caught.value.status == "simulation"
        with pytest.raises(pp.Error, match="diverged"):
            live.stop()


def test_a_soft_body_is_pressed_and_shaped(tmp_path):
    soft = {"matter": "soft", "box_mm": [120, 120, 120], "fill_mm": [60, 40, 60], "spacing_mm": 10, "young_Pa": 2e4}
    press = np.column_stack([np.full(300, 60.0), np.maximum(34, 48 - 0.07 * np.arange(300)), np.full(300, 60.0)])
    with pp.Session.of_scene(scene_file(tmp_path, soft), gpu="cpu") as jelly:
        felt = jelly.touch(press)
        assert felt["contact"][-1] and felt["force_N"][-1, 1] > 0.05
        jelly.push(press, radius_mm=15)
        assert jelly.undo_count == 1 and jelly.undo() == 1 and jelly.undo_count == 0
        with pytest.raises(pp.UsageError, match="carve"):
            jelly.carve(press)


@pytest.mark.parametrize("wrong", ["lava", "", "no.json", "nothing.ply in water"])
def test_scenes_that_are_not_there(wrong):
    with pytest.raises(pp.Error):
        pp.Session.of_scene(wrong, gpu="cpu")
    with pytest.raises(pp.Error):
        pp.Matter(wrong, gpu="cpu")


def test_what_is_no_scene_and_no_cloud_is_refused(ball):
    for wrong in (None, 3, b"water", ball.xyz):
        with pytest.raises(TypeError):
            pp.Session(wrong, gpu="cpu")
        with pytest.raises(TypeError):
            pp.Session.of_scene(wrong, gpu="cpu")
    with pp.Session(ball, gpu="cpu") as still:
        for call in (still.frame, still.pause, still.reset, lambda: still.set("gain", 1)):
            with pytest.raises(pp.Error) as caught:
                call()
            assert caught.value.status == "state"


def test_after_the_end_everything_is_an_error(tank):
    session, matter = pp.Session.of_scene(tank, gpu="cpu"), pp.Matter(tank, gpu="cpu")
    session.close()
    matter.close()
    matter.close()
    for call in (session.frame, session.reset, lambda: session.set("gain", 1), matter.step, matter.frame, matter.reset,
                 matter.state, lambda: matter.set("gain", 1), lambda: matter.parameters):
        with pytest.raises(pp.Error) as caught:
            call()
        assert caught.value.status == "handle"
    for seconds in (-1, float("nan"), float("inf")):
        with pytest.raises(ValueError):
            matter.simulate(seconds)
    with pytest.raises(TypeError):
        matter.step(-1)


def test_threads_step_one_scene_and_wait_for_one_another(tank):
    with pp.Matter(tank, gpu="cpu") as matter, pp.Matter(tank, gpu="cpu") as alone:
        threads = [threading.Thread(target=lambda: [matter.step() for _ in range(10)]) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        alone.step(40)
        assert np.array_equal(matter.frame().positions, alone.frame().positions)
