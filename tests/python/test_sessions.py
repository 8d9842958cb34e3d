from __future__ import annotations

import os
import threading
import time

import numpy as np
import palpate as pp
import pytest
from conftest import RADIUS, press_path


def test_a_ball_pushes_along_its_radius_by_stiffness_times_depth(ball):
    with pp.Session(ball, gpu="cpu", mm_per_unit=1, surface="sphere", stiffness_N_per_mm=0.5) as s:
        t = s.touch(press_path(1.5))
    names = ("t_s", "hip", "proxy", "normal", "force_N", "penetration_mm", "contact", "neighbours", "fresh")
    assert t.dtype.names == names
    assert t.dtype == pp.tick_dtype and t.shape == (200,)
    assert np.array_equal(t["hip"], press_path(1.5))
    assert np.allclose(t["t_s"], np.arange(200) / 1000)
    assert not t["contact"][0] and t["contact"][-1] and t["contact"].dtype == bool and t["fresh"].all()
    last = t[-1]
    assert np.linalg.norm(last["proxy"]) == pytest.approx(RADIUS, rel=2e-4)
    assert np.linalg.norm(last["force_N"]) == pytest.approx(0.5 * last["penetration_mm"], rel=1e-6)
    assert np.allclose(last["normal"], last["proxy"] / RADIUS, atol=0.01)
    assert last["penetration_mm"] == pytest.approx(1.5, abs=0.02)
    assert (t["force_N"][~t["contact"]] == 0).all()


def test_paths_of_any_layout_are_the_same(session):
    path = press_path(1)
    first = session.touch(path)
    for same in (np.asfortranarray(path), path.tolist(), np.repeat(path, 2, axis=0)[::2]):
        assert np.array_equal(session.touch(same)["force_N"], first["force_N"])
    timed = np.column_stack([np.arange(200) / 1000, path])
    assert np.allclose(session.touch(timed)["force_N"], first["force_N"], atol=1e-9)
    for wrong in (path[:, :2], path[0], np.zeros((0, 3)), "path", timed[::-1]):
        with pytest.raises(ValueError, match="path"):
            session.touch(wrong)


def test_a_session_says_that_a_part_is_too_thin_for_its_brush(session):
    session.push(press_path(4, 150, 50), radius_mm=5)
    assert session.blocked_moves == session.blocked_edits == 0
    x, y = (each.ravel() for each in np.meshgrid(np.arange(-20, 20.5, 0.5), np.arange(-20, 20.5, 0.5)))
    sides = [np.column_stack([x, y, np.full_like(x, z)]) for z in (RADIUS, RADIUS - 0.4)]
    normals = np.repeat([[0.0, 0, 1], [0, 0, -1]], len(x), axis=0)
    with pp.Session(pp.Cloud(np.concatenate(sides), normals=normals), gpu="cpu", mm_per_unit=1) as leaf:
        leaf.push(press_path(2, 50, 100), radius_mm=5)
        assert leaf.blocked_edits > 80 and leaf.blocked_moves > 50 * leaf.blocked_edits


def test_another_surface_can_be_chosen(session):
    averaged = session.touch(press_path(1))[-1]
    curved = session.touch(press_path(1), surface="sphere")[-1]
    assert curved["penetration_mm"] > averaged["penetration_mm"]  # the averaged surface lies below a convex one
    with pytest.raises(pp.UsageError, match="velvet"):
        session.touch(press_path(1), surface="velvet")


def test_the_force_can_be_set_while_the_session_is_open(ball):
    with pp.Session(ball, gpu="cpu", mm_per_unit=1, surface="sphere", stiffness_N_per_mm=0.4) as session:
        before = np.linalg.norm(session.touch(press_path(1))["force_N"][-1])
        session.set_contact(stiffness_N_per_mm=0.8)
        after = np.linalg.norm(session.touch(press_path(1))["force_N"][-1])
        assert after == pytest.approx(2 * before, rel=0.01)
        session.set_contact(max_force_N=0.5)
        assert np.linalg.norm(session.touch(press_path(1))["force_N"][-1]) == pytest.approx(0.5, rel=0.01)
        session.set_contact(surface="average", max_force_N=3)
        assert np.linalg.norm(session.touch(press_path(1))["force_N"][-1]) == pytest.approx(after, rel=0.1)
        with pytest.raises(pp.UsageError, match="stiffness"):
            session.set_contact(stiffness_N_per_mm=-1)


def test_strokes_change_the_points_and_undo_gives_back_every_bit(session, ball):
    before = session.cloud().xyz.copy()
    assert np.array_equal(before, ball.xyz)
    t = session.push(press_path(4, 150, 50), radius_mm=5)
    assert len(t) == 200 and session.undo_count == 1
    after = session.cloud().xyz
    assert len(after) != len(before) or not np.array_equal(after, before)
    assert session.undo() == 1 and session.undo() == 0 and session.redo_count == 1
    assert np.array_equal(session.cloud().xyz, before)
    assert session.redo() == 1
    assert np.array_equal(session.cloud().xyz, after)
    session.undo()
    session.carve(press_path(4, 150, 50), radius_mm=5, strength=1)
    assert session.cloud().positions[:, 2].max() < RADIUS
    session.stroke(press_path(6, 150, 50), "paint", radius_mm=5, color=(10, 200, 30))
    assert session.cloud().colors is not None
    with pytest.raises(TypeError, match="radius_mm"):
        session.push(press_path(1), size=3)
    with pytest.raises(pp.UsageError, match="push, carve"):
        session.stroke(press_path(1), "scrub")


def test_a_cloud_of_a_session_outlives_it(ball):
    with pp.Session(ball, gpu="cpu") as s:
        cloud = s.cloud()
    view = cloud.positions
    with pytest.raises(pp.Error) as caught:
        s.touch(press_path(1))
    assert caught.value.status == "handle"
    assert "closed" in repr(s)
    s.close()
    assert np.array_equal(view, ball.positions)


def test_what_a_session_is(session, ball):
    assert session.points == len(ball) and session.mm_per_unit == 1 and session.rate_Hz == 1000
    assert session.radius_mm == pytest.approx(4 * session.spacing_mm, rel=0.2)
    assert session.backend == "cpu" and session.machine in repr(session)
    assert session.messages == []
    bare = pp.Cloud(ball.positions[::10])
    with pp.Session(bare, gpu="cpu") as s:
        assert "normals are estimated" in s.messages[0]
        assert s.mm_per_unit == pytest.approx(1, rel=0.01)  # the longest side becomes 100 mm


@pytest.mark.parametrize("options", [{"rate_Hz": 0}, {"mm_per_unit": -1}, {"surface": "velvet"}, {"friction": -1},
                                     {"law": "nothing"}])
def test_options_out_of_their_bounds_are_refused(ball, options):
    with pytest.raises(pp.UsageError):
        pp.Session(ball, gpu="cpu", **options)


def test_a_gpu_that_is_not_there_is_an_error_that_names_those_that_are(ball):
    with pytest.raises(pp.Error) as caught:
        pp.Session(ball, gpu="no such chip")
    assert caught.value.status == "gpu"
    assert all(name in str(caught.value) for name in pp.gpus())


def test_a_force_law_is_compiled_and_never_python(ball):
    law = os.environ["PALPATE_OWN_LAW"]
    with pp.Session(ball, gpu="cpu", mm_per_unit=1, law=law + ":half_as_stiff") as s:
        last = s.touch(press_path(1))[-1]
    assert last["force_N"][2] == pytest.approx(0.4 * last["penetration_mm"], rel=1e-3)
    import ctypes
    address = ctypes.cast(ctypes.CDLL(law).half_as_stiff, ctypes.c_void_p).value
    with pp.Session(ball, gpu="cpu", mm_per_unit=1, law=address) as s:
        assert s.touch(press_path(1))[-1]["force_N"][2] == last["force_N"][2]
    with pytest.raises(TypeError, match="Python"):
        pp.Session(ball, gpu="cpu", law=lambda *_: (0, 0, 0))


def test_pictures_are_arrays_with_the_ball_in_the_middle(session):
    img = session.render((160, 120), background=(255, 0, 255))
    assert img.shape == (120, 160, 4) and img.dtype == np.uint8
    behind = (img[:, :, :3] == (255, 0, 255)).all(axis=2)
    assert behind[0, 0] and behind[-1, -1] and not behind[60, 80]
    above = session.render((160, 120), eye=(0, 0, 150), target=(0, 0, 0), up=(0, 1, 0), background=(255, 0, 255))
    assert not np.array_equal(above, img)
    low = session.render((160, 120), color="y", color_map="red-blue", color_range="1000,2000").astype(int)
    assert low[60, 80, 0] > low[60, 80, 2] + 20
    clear = session.render((160, 120), transparent=True)
    assert clear[0, 0, 3] == 0 and clear[60, 80, 3] == 255
    ortho = session.render((160, 120), projection="orthographic", ortho_height=200, transparent=True)
    covered = (ortho[:, :, 3] > 127).sum()  # a ball of 50 in a picture 200 high
    assert covered == pytest.approx(np.pi * (RADIUS / 200 * 120) ** 2, rel=0.05)
    seen = [session.render((160, 120), side=side, color="normal") for side in ("front", "back", "top", "isometric")]
    assert all(not np.array_equal(a, b) for i, a in enumerate(seen) for b in seen[:i])
    lit = session.render((160, 120), material="metal", occlusion="on", cavity="on", ground="off", transparent=True)
    assert not np.array_equal(lit, clear)
    with pytest.raises(pp.UsageError, match="ortho_height"):
        session.render((16, 12), ortho_height=3)
    assert session._repr_png_().startswith(b"\x89PNG")
    with pytest.raises(pp.UsageError):
        session.render((0, 120))
    for size in [(100_000, 100_000), (2**32 - 1, 2**32 - 1), (16, 16_385)]:  # the second exceeds any memory
        with pytest.raises(pp.UsageError, match="size: .* pixels is not between 1 and 16384"):
            session.render(size)
    with pytest.raises(pp.UsageError, match="plaid"):
        session.render((16, 12), color="plaid")


def test_a_mesh_is_closed_and_as_large_as_the_ball(session, tmp_path):
    mesh = session.mesh(resolution=32)
    assert mesh.closed and "closed" in repr(mesh)
    a, b, c = (mesh.vertices[mesh.triangles[:, k]].astype(float) for k in range(3))
    volume = np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6
    assert volume == pytest.approx(4 / 3 * np.pi * RADIUS**3, rel=0.02)
    assert not mesh.triangles.flags.writeable and mesh.normals.shape == mesh.vertices.shape
    mesh.save(tmp_path / "m.ply")
    assert len(pp.read(tmp_path / "m.ply")) == len(mesh.vertices)


def test_others_run_while_a_session_works(session):
    running = threading.Event()
    count = 0

    def work():
        nonlocal count
        while not running.is_set():
            count += 1
            time.sleep(0.001)

    thread = threading.Thread(target=work)
    thread.start()
    session.touch(np.repeat(press_path(1), 60, axis=0))
    running.set()
    thread.join()
    assert count > 3


def test_threads_share_a_session_and_wait_for_one_another(session):
    results = []
    threads = [threading.Thread(target=lambda: results.append(session.touch(press_path(1))[-1]["force_N"][2]))
               for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(results) == 4 and len(set(results)) == 1


def test_live_ticks_come_in_blocks_while_python_does_what_it_likes(session):
    blocks = []
    timed = np.array([[0, 0, 0, 52], [0.1, 0, 0, 49]])
    with session.live(path=timed, rate=500, on_ticks=lambda b: blocks.append((threading.get_ident(), b))) as live:
        assert live.running and "running" in repr(live)
        assert live.wait(0.5) is False
        with pytest.raises(pp.Error) as caught:
            session.touch(press_path(1))
        assert caught.value.status == "state"
        picture = session.render((64, 48))
        assert picture.shape == (48, 64, 4)
        with pytest.raises(pp.Error):
            live.read_ticks()
    assert not live.running
    ticks = np.concatenate([block for _, block in blocks])
    assert len(ticks) > 50 and len(blocks) > 1
    assert (np.diff(ticks["t_s"]) > 0).all()
    assert ticks["contact"][-1] and ticks["force_N"][-1, 2] > 0.3
    assert blocks[0][1].dtype == pp.live_tick_dtype and ticks["valid"][-1] and not ticks["withheld"][-1]
    assert (ticks["age_s"][ticks["fresh"]] == 0).all() and (ticks["torque_mNm"] == 0).all()
    assert {thread for thread, _ in blocks} != {threading.get_ident()}
    assert len(session.touch(press_path(1))) == 200


def test_a_live_tick_says_that_its_force_is_withheld(session):
    with session.live(path=np.array([[0, 0, 0, 52], [0.05, 0, 0, 49]]), rate=500) as live:
        live.set_forces(False)
        end = time.monotonic() + 10
        inside = np.empty(0, pp.live_tick_dtype)
        while len(inside) < 20 and time.monotonic() < end:
            ticks = live.read_ticks()
            inside = np.concatenate([inside, ticks[ticks["contact"]]])
    assert inside["withheld"][-1] and inside["fresh"][-1] and (inside["force_N"][-1] == 0).all()


def test_ticks_of_the_last_interval_reach_on_ticks(session):
    blocks = []
    live = session.live(path=press_path(1), rate=500, on_ticks=blocks.append, interval_s=600)
    assert live.wait(0.2) is False
    live.stop()
    assert len(blocks) == 1 and len(blocks[0]) > 10


def test_live_ticks_can_be_taken_and_sculpt(session):
    before = session.cloud().xyz.copy()
    session.set_brush("push", radius_mm=5)
    timed = np.array([[0, 0, 0, 52], [0.1, 0, 0, 46], [0.3, 0, 0, 46], [0.4, 0, 0, 60]])
    live = session.live(path=timed, rate=500)
    time.sleep(0.6)
    assert len(live.read_ticks()) > 50
    live.set_forces(False)
    live.stop()
    session.set_brush(None)
    assert not np.array_equal(session.cloud().xyz, before)
    session.undo(100)
    assert np.array_equal(session.cloud().xyz, before)


def test_what_goes_wrong_on_ticks_is_raised_where_it_is_waited_for(session):
    def fail(block):
        raise KeyError("mine")

    live = session.live(path=press_path(1), on_ticks=fail)
    with pytest.raises(KeyError, match="mine"):
        live.wait(20)
    live.stop()
    with pytest.raises(pp.UsageError, match="glass"):
        session.live("mouse-of-glass")


def test_an_interpreter_ends_although_something_is_live(tmp_path):
    import subprocess
    import sys
    program = tmp_path / "forgets.py"
    program.write_text(
        "import sys; sys.path.insert(0, %r)\n"
        "import numpy as np, palpate as pp\nfrom conftest import ball_arrays, press_path\n"
        "xyz, normals = ball_arrays(2000)\n"
        "s = pp.Session(pp.Cloud(xyz, normals=normals), gpu='cpu', mm_per_unit=1)\n"
        "live = s.live(path=press_path(1), on_ticks=lambda b: None)\nlive.wait(0.1)\nprint('over')\n"
        % os.path.dirname(__file__))
    done = subprocess.run([sys.executable, program], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0 and done.stdout == "over\n", done.stderr


def test_python_is_light_to_import():
    import subprocess
    import sys
    program = "import sys; import palpate; print('numpy' in sys.modules, palpate.__version__)"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=60)
    assert done.stdout.split()[0] == "False", done.stdout + done.stderr
    assert done.stdout.split()[1].count(".") == 2


def test_layers_of_strokes_slide_after_the_fact(ball):
    with pp.Session(ball, gpu="cpu", mm_per_unit=1) as session:
        session.open_layer("dent")
        session.push(press_path(3), radius_mm=5)
        made = session.cloud().positions
        assert session.layer("dent")[:2] == (1.0, False) and session.layer("dent")[2] > 10
        session.slide_layer("dent", 0)
        assert np.array_equal(session.cloud().positions, ball.positions)
        for step in (0.2, 0.5, 1):
            session.slide_layer("dent", step, continues=True)
        assert np.array_equal(session.cloud().positions, made)
        session.hide_layer("dent")
        assert session.layer("dent")[1] and np.array_equal(session.cloud().positions, ball.positions)
        assert session.undo() == 1 and np.array_equal(session.cloud().positions, made)
        assert session.undo() == 1 and np.array_equal(session.cloud().positions, made)
        session.merge_layer("dent")
        for wrong in ("dent", "other"):
            with pytest.raises(pp.UsageError, match=f"named '{wrong}'"):
                session.slide_layer(wrong, 0)
        session.open_layer("dent")
        session.close_layer()
        with pytest.raises(pp.UsageError, match="not between -1 and 2"):
            session.slide_layer("dent", 3)


def test_masks_hide_and_lock_points_of_a_session(ball):
    with pp.Session(ball, gpu="cpu", mm_per_unit=1) as session:
        top = ball.positions[:, 2] > 0
        session.set_mask("hidden", top)
        assert not session.touch(press_path(1))["contact"].any()
        assert np.array_equal(session.mask("hidden"), top) and session.mask("hidden").dtype == bool
        assert len(session.cloud()) == len(ball)
        assert session.undo() == 1 and not session.mask("hidden").any()
        assert session.touch(press_path(1))["contact"].any()
        session.remove_points(top)
        assert np.array_equal(session.cloud().positions, ball.positions[~top])
        assert session.undo() == 1
        session.move_points(top, offset=(0, 0, 500), rotation=(0, 0, 0, 1), scale=2)
        moved = session.cloud().positions
        assert np.allclose(moved[top], ball.positions[top] * (-2, -2, 2) + (0, 0, 500), atol=1e-3)
        assert np.array_equal(moved[~top], ball.positions[~top])
        assert session.undo() == 1 and np.array_equal(session.cloud().positions, ball.positions)
        session.set_mask("locked", np.ones(len(ball), dtype=bool))
        session.push(press_path(3), radius_mm=5)
        assert np.array_equal(session.cloud().positions, ball.positions)
        session.set_mask("lock_weights", top.astype(np.uint8) * 200)
        assert np.array_equal(session.mask("lock_weights"), top * 200)
        assert session.mask("lock_weights").dtype == np.uint8 and not session.mask("locked").any()
        session.soften_lock(5)
        soft = session.mask("lock_weights")
        assert ((soft > 0) & (soft < 200)).sum() > 100
        session.push(press_path(3), radius_mm=5, accumulate=True)
        assert not np.array_equal(session.cloud().positions, ball.positions)
        with pytest.raises(pp.UsageError, match="a uint8 for each point"):
            session.set_mask("lock_weights", top)
        session.set_contact(hand_gain=0.5)
        with pytest.raises(pp.UsageError, match="hand_gain"):
            session.set_contact(hand_gain=0)
        for wrong in (top[:-1], top.astype(np.uint8), np.zeros((len(ball), 2), dtype=bool)):
            with pytest.raises(pp.UsageError, match="mask"):
                session.set_mask("hidden", wrong)
