"""A servo loop of the program, the beginning and end of contacts, and messages."""

from __future__ import annotations

import threading
import time

import numpy as np
import palpate as pp
import pytest
from conftest import ball_arrays, press_path


def test_a_hand_feels_the_same_pose_by_pose_as_along_a_path(session):
    path = press_path(1)
    felt = session.touch(path)
    for i, hip in enumerate(path):
        contact = session.touch_pose(i / 1000, hip)
        assert contact.validity == "fresh" and contact.age_s == 0
        assert contact.force_N == felt[i]["force_N"].tolist()
        assert not contact.withheld
        assert contact.proxy == felt[i]["proxy"].tolist() and contact.contact == felt[i]["contact"]
    assert contact.penetration_mm == pytest.approx(felt[-1]["penetration_mm"])
    assert contact.neighbours == felt[-1]["neighbours"] and contact.torque_mNm == [0, 0, 0]
    session.lift()
    inside = session.touch_pose(1, [0.3, -0.2, 44])  # put down far inside
    assert not inside.contact and inside.force_N == [0, 0, 0]


def test_a_pose_that_cannot_be_answered_gives_no_force(session):
    session.touch_pose(0, [0, 0, 52])
    outside = session.touch_pose(0.001, [1e300, 0, 0])
    assert outside.validity == "none" and outside.force_N == [0, 0, 0] and outside.age_s < 0
    with pytest.raises(pp.UsageError, match="finite"):
        session.touch_pose(0.002, [np.nan, 0, 0])
    with pytest.raises(pp.UsageError, match="not later than"):
        session.touch_pose(0.001, [0, 0, 52])  # the time stands still
    for hip in ([1, 2], "123", None, np.zeros((3, 1)), [[0, 0, 1]]):
        with pytest.raises(TypeError, match="hip: must be three numbers"):
            session.touch_pose(0.003, hip)
    for hip in ([True, False, True], [1j, 0, 0], np.zeros(3, "M8[s]"), ["1", "2", "3"]):
        with pytest.raises(pp.UsageError, match="hip: must be real numbers"):
            session.touch_pose(0.003, hip)
    with pytest.raises(pp.UsageError, match="hips: must be real numbers"):
        session.touch_poses(0.003, np.zeros((1, 3), "M8[s]"))


def test_a_command_between_two_poses_leaves_contact_and_force(session):
    path = press_path(1)
    for i, hip in enumerate(path):
        before = session.touch_pose(i / 1000, hip)
    assert before.contact
    commands = (session.undo, session.cloud, lambda: session.set_brush("paint", yield_depth_mm=5),
                lambda: session.set_brush(None), lambda: session.set_contact(stiffness_N_per_mm=0.4))
    for k, command in enumerate(commands):
        command()
        after = session.touch_pose(1 + k / 1000, path[-1])
        assert after.contact and not after.withheld and after.penetration_mm == pytest.approx(before.penetration_mm)
    for k in range(20):  # the force changes gradually
        after = session.touch_pose(1.1 + k / 1000, path[-1])
    assert after.force_N[2] == pytest.approx(before.force_N[2] / 2, rel=0.05)


def test_a_stroke_in_progress_counts_as_one_that_can_be_undone(session):
    session.set_brush("push", radius_mm=4)
    for i, hip in enumerate(press_path(3)):
        session.touch_pose(i / 1000, hip)
    session.apply_edits()
    assert session.undo_count == 1
    assert session.undo() == 1 and session.undo_count == 0


def test_a_stroke_in_progress_is_cancelled(session):
    assert not session.cancel_stroke()
    session.set_brush("push", radius_mm=4, symmetry="x")
    before = session.cloud().positions
    for i, hip in enumerate(press_path(3)[:-20]):
        session.touch_pose(i / 1000, hip)
    assert session.cancel_stroke()
    assert session.undo_count == 0 and session.redo() == 0
    assert np.array_equal(session.cloud().positions, before)
    with pytest.raises(pp.UsageError, match="symmetry"):
        session.set_brush("push", symmetry="up")
    with pytest.raises(TypeError, match="symmetry: must be a text, not 1"):
        session.set_brush("push", symmetry=1)


def test_several_hands_are_answered_at_once(ball):
    with pp.Session(ball, gpu="cpu", mm_per_unit=1, hands=2) as s:
        for i, z in enumerate(np.linspace(52, 49, 100)):
            first, second = s.touch_poses(i / 1000, [[0, 0, z], [0, 0, -z]])
        assert first.force_N[2] > 0.5 and second.force_N[2] < -0.5
        with pytest.raises(pp.UsageError, match="hands"):
            s.touch_pose(1, [0, 0, 52])
        with pytest.raises(pp.UsageError, match="orientations"):
            s.touch_poses(1, [[0, 0, 52]] * 2, orientations=np.ones((1, 4)))


def test_with_a_budget_one_thread_sculpts_while_another_looks(ball):
    with pp.Session(ball, gpu="cpu", mm_per_unit=1, budget_us=2000) as s:
        s.set_brush("push", radius_mm=6)
        before = s.raycast([[0.3, -0.2, 90]], [[0, 0, -1]])["distance"][0]
        answers = []

        def press():
            for i, hip in enumerate(press_path(4, 300, 100)):
                answers.append(s.touch_pose(i / 1000, hip))
                time.sleep(0.0005)

        thread = threading.Thread(target=press)
        thread.start()
        while thread.is_alive():
            s.apply_edits()
            s.raycast([[0.3, -0.2, 90]], [[0, 0, -1]])
        thread.join()
        assert len(answers) == 400 and all(each.validity != "none" for each in answers)
        assert s.raycast([[0.3, -0.2, 90]], [[0, 0, -1]])["distance"][0] > before + 0.5


def test_contacts_are_told_where_they_begin_and_end(session):
    told = []
    session.on_contact(lambda event: told.append((event.begins, event.hand, event.t_s, event.normal[2], event.force_N)))
    felt = session.touch(np.vstack([press_path(1), press_path(1)[::-1]]))
    changes = np.flatnonzero(np.diff(felt["contact"].astype(int))) + 1
    assert [each[0] for each in told] == [True, False] and len(changes) == 2
    assert [each[2] for each in told] == felt["t_s"][changes].tolist()
    assert told[0][3] > 0.99 and told[0][4] == felt["force_N"][changes[0]].tolist()
    told.clear()
    for i, hip in enumerate(press_path(1)):
        contact = session.touch_pose(i / 1000, hip)
        assert bool(told) == contact.contact  # before touch_pose() returns
    session.on_contact(None)
    session.lift()
    assert len(told) == 1


@pytest.mark.parametrize("kind", [ValueError, TypeError, RuntimeError])
def test_an_exception_at_a_contact_ends_the_force_with_a_sentence(session, kind):
    def broken(event):
        raise kind("no bell")

    session.on_contact(broken)
    with pytest.raises(kind, match="^no bell$") as caught:
        for i, hip in enumerate(press_path(1)):
            session.touch_pose(i / 1000, hip)
    assert caught.type is kind
    with pytest.raises(pp.Error, match=f"on_contact: its function has raised {kind.__name__}: no bell.*no force"):
        session.touch_pose(1, [0.3, -0.2, 49])
    with pytest.raises(pp.Error, match="on_contact: its function has raised"):
        session.touch(press_path(1))
    session.on_contact(None)
    felt = session.touch_pose(1.001, [0.3, -0.2, 49])
    assert felt.validity == "fresh" and repr(felt).startswith("<palpate.Contact: fresh, ")
    with pytest.raises(pp.ArgumentTypeError, match="a function"):
        session.on_contact(3)


def test_a_contact_function_cannot_call_its_session(session):
    raised = []

    def asks(event):
        try:
            session.undo()
        except pp.Error as error:
            raised.append(error.status)

    session.on_contact(asks)
    session.touch(press_path(1))
    assert raised == ["state", "state"]


def test_a_live_contact_is_told_on_the_thread_that_reads(session):
    told = []
    session.on_contact(lambda event: told.append((event.begins, threading.current_thread().name)))
    with session.live(path=[[0, 0, 0, 52], [0.1, 0, 0, 49]], on_ticks=lambda ticks: None) as live:
        end = time.monotonic() + 20
        while not told and time.monotonic() < end:
            live.wait(0.05)
    assert told == [(True, "palpate ticks"), (False, "palpate ticks")]


def test_an_exception_at_a_live_contact_ends_the_session_without_force(session):
    def broken(event):
        raise ValueError("no bell")

    session.on_contact(broken)
    live = session.live(path=[[0, 0, 0, 52], [0.1, 0, 0, 49]])
    end = time.monotonic() + 20
    with pytest.raises(ValueError, match="no bell"):
        while time.monotonic() < end:
            live.read_ticks()
            time.sleep(0.02)
    assert not live.running
    assert any("no bell" in line for line in session.messages)
    live.stop()
    with pytest.raises(pp.Error, match="no force until on_contact"):
        session.live(builtin="press")


def test_an_exception_in_on_ticks_ends_the_live_session(session):
    def broken(ticks):
        raise ValueError("full")

    live = session.live(builtin="press", on_ticks=broken)
    with pytest.raises(ValueError, match="full"):
        live.wait(20)
    end = time.monotonic() + 20
    while session._live_running() and time.monotonic() < end:
        time.sleep(0.01)
    assert not session._live_running()
    live.stop()


def test_messages_are_passed_on_with_their_level(ball, capfd):
    heard = []
    bare = pp.Cloud(ball.xyz)
    with pp.Session(bare, gpu="cpu", on_message=lambda level, text: heard.append((level, text))) as s:
        assert [text for _, text in heard] == s.messages
        assert any(level == "note" and "normals are estimated" in text for level, text in heard)
    with pytest.raises(pp.ArgumentTypeError, match="on_message"):
        pp.Session(bare, gpu="cpu", on_message=3)
    assert capfd.readouterr() == ("", "")


def test_ticks_that_would_exceed_their_budget_are_bridged_and_counted():
    xyz, normals = ball_arrays(200_000)
    with pp.Session(pp.Cloud(xyz, normals=normals), gpu="cpu", mm_per_unit=1, radius_mm=30, budget_us=50) as s:
        assert s.bridged_ticks == s.thinned_ticks == 0
        answers = [s.touch_pose(1e-3 * i, (0, 0, 53 - 0.1 * i)) for i in range(80)]
        held = sum(each.validity == "held" for each in answers)
        assert held > 40 and s.bridged_ticks == held and 0 < s.thinned_ticks <= held
        assert answers[-1].contact and answers[-1].force_N[2] > 0.5
