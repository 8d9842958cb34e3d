"""Session logs: recorded, read into arrays, and replayed bit by bit."""

from __future__ import annotations

import gc
import os
import subprocess
import time

import numpy as np
import palpate as pp
import pytest
from conftest import press_path


@pytest.fixture
def recorded(session, tmp_path):
    file = tmp_path / "a.session"
    session.record(file)
    return file, session.push(press_path(4, 150, 50), radius_mm=5)


def test_a_recorded_stroke_is_read_as_arrays(recorded):
    file, t = recorded
    log = pp.read_recording(file)
    assert len(log.ticks) == 200 and log.ended and log.missing == [] and log.points == 20_000
    assert "200 ticks" in repr(log) and log.lost_ticks == 0 and log.merged_edits == 0
    for name in ("t_s", "force_N", "proxy", "contact", "fresh", "neighbours"):
        assert np.array_equal(log.ticks[name], t[name]), name
    scale, offset = log.map
    assert np.array_equal(scale * log.ticks["device"] + offset, t["hip"])
    assert log.ticks["valid"].all() and log.ticks["contact"].dtype == bool
    assert 0 < log.ticks["edits"][-1] <= len(log.edits)  # the edits of the last answer follow it
    assert set(log.edits.dtype.names) == {"point", "parent", "position", "normal", "color", "gone"}
    assert log.header["config"]["brush"]["radius_mm"] == 5
    ticks = log.ticks
    assert not ticks.flags.writeable and np.shares_memory(ticks, log.ticks)
    forces = ticks["force_N"].copy()
    del log
    gc.collect()
    assert np.array_equal(ticks["force_N"], forces)


def test_a_recorded_session_comes_out_the_same_to_the_last_bit(recorded, ball):
    file, t = recorded
    again = pp.replay(file, ball)
    assert again.identical and again.compared == again.ticks == 200 and again.points == 0
    assert again.first_difference_s is None and again.recorded_edits_agree and again.reason == ""
    with pytest.raises(pp.Error, match="does not exist"):
        pp.replay(file)
    with pytest.raises(pp.UsageError, match="^cloud: has .* points, the model of the session had"):
        pp.replay(file, pp.Cloud(ball.xyz[:-1]))
    with pytest.raises(pp.UsageError, match="^cloud: its points differ"):
        pp.replay(file, pp.Cloud(ball.xyz + 1e-3))
    for settings, words in (({"threads": -1}, "threads must be a whole number of 0 or more, not -1"),
                            ({"threads": "x"}, "threads must be a whole number"),
                            ({"tolerance": "x"}, "tolerance must be a number"),
                            ({"cloud": 5}, "cloud must be a Cloud")):
        with pytest.raises(pp.UsageError, match=words):
            pp.replay(file, **settings)


def test_a_log_that_is_cut_off_says_why_its_end_is_not_compared(recorded, ball, tmp_path):
    whole = recorded[0].read_bytes()
    cut = tmp_path / "cut.session"
    cut.write_bytes(whole[:-1])
    again = pp.replay(cut, ball)
    assert not again.identical and again.points is None and again.force_ticks == again.edit_ticks == 0
    assert "end of the session" in again.reason


def test_the_program_runs_again_what_python_recorded(recorded, ball, tmp_path):
    program = os.environ.get("PALPATE_PROGRAM")
    if not program:
        pytest.skip("the program is not built")
    file, _ = recorded
    model = tmp_path / "ball.ply"
    with pp.Session(ball, gpu="cpu", mm_per_unit=1) as fresh:
        pp.write(model, fresh.cloud())
    cloud = pp.read(model)
    with pp.Session(cloud, gpu="cpu", mm_per_unit=1) as session:
        session.record(file)
        session.push(press_path(4, 150, 50), radius_mm=5)
    done = subprocess.run([program, "replay", str(file)], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stdout + done.stderr


def test_a_live_session_is_recorded(session, tmp_path, ball):
    file = tmp_path / "live.session"
    session.record(file)
    with session.live(path=np.array([[0, 0, 0, 52], [0.1, 0, 0, 49]]), rate=250):
        time.sleep(0.4)
        session.record(tmp_path / "later.session")  # ends the first log, and begins in contact
        time.sleep(0.2)
    for each, least in (file, 30), (tmp_path / "later.session", 10):
        log = pp.read_recording(each)
        assert len(log.ticks) > least and log.ended and log.header["config"]["realtime"]
        assert pp.replay(each, ball).force_ticks == 0


def test_what_cannot_be_recorded_or_read_is_refused(session, ball, tmp_path):
    session.push(press_path(4, 150, 50), radius_mm=5)
    with pytest.raises(pp.Error, match="edited"):
        session.record(tmp_path / "b.session")
    with pp.Session(ball, gpu="cpu", law=lambda tick: (0, 0, 0), allow_python_law=True) as lawful:
        with pytest.raises(pp.Error, match="law"):
            lawful.record(tmp_path / "b.session")
    for content in (b"", b"palplog", os.urandom(5000)):
        (tmp_path / "c.session").write_bytes(content)
        with pytest.raises(pp.Error) as caught:
            pp.read_recording(tmp_path / "c.session")
        assert caught.value.file and "c.session" in caught.value.file
        with pytest.raises(pp.Error):
            pp.replay(tmp_path / "c.session")
    for wrong in (None, 3, [1]):
        with pytest.raises(TypeError):
            pp.read_recording(wrong)
