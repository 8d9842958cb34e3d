"""Devices in a hand: their axes, and what their users agreed to."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import palpate as pp
import pytest


@pytest.fixture
def service(tmp_path, monkeypatch):
    """A Haply service whose hand rests 40 mm above the middle, and taps from there down to 26 mm once a session ticks:
    one that began with the hand inside the ball would feel it from there.
    """
    process = subprocess.Popen([os.environ["PALPATE_HAPLY_SERVICE"]], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                               text=True)
    monkeypatch.setenv("PALPATE_HAPLY_CONFIG", process.stdout.readline().strip())
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    yield process
    if process.poll() is None:
        process.communicate(timeout=30)


@pytest.fixture
def desk(service, tmp_path):
    """The folder of the user's settings, with a service."""
    return tmp_path


def stiffness_at_rest(t):
    """The most of a hand at rest, where nothing is damped, N/mm."""
    moves = np.flatnonzero((np.diff(t["hip"], axis=0) != 0).any(axis=1)) + 1
    index = np.arange(len(t))
    last_move = np.concatenate(([0], moves))[np.searchsorted(moves, index, side="right")]
    felt = t[(index - last_move >= 20) & (t["contact"] != 0) & (t["penetration_mm"] > 0.5)]
    return (np.linalg.norm(felt["force_N"], axis=1) / felt["penetration_mm"]).max(initial=0)


def taps(session, stiffness, **options):
    """Farthest right, up and towards, mm, and stiffness_at_rest(). The hand goes on until it has felt 0.95 of a
    stiffness, which takes longer on a machine that stalls, since the force then ramps up again, and for two more taps,
    so that it would feel more.
    """
    ticks, begun = [], threading.Event()

    def keep(block):
        ticks.append(block.copy())
        begun.set()

    signal = Path(os.environ["PALPATE_HAPLY_CONFIG"]).with_name("taps")
    signal.unlink(missing_ok=True)
    live = session.live("haply", on_ticks=keep, **options)
    assert begun.wait(30)
    signal.touch()
    end = time.monotonic() + 30
    while stiffness_at_rest(np.concatenate(ticks[:])) < 0.95 * stiffness and time.monotonic() < end:
        time.sleep(0.1)
    time.sleep(1.2)
    live.stop()
    t = np.concatenate(ticks)
    return 0.6 * np.abs(t["hip"]).max(axis=0), stiffness_at_rest(t)


def test_a_session_uses_what_the_user_of_a_device_agreed_to(desk, ball):
    with pp.Session(ball, gpu="cpu", mm_per_unit=0.6) as session:
        (_, up_mm, towards_mm), stiffness = taps(session, 0.8)
        assert up_mm == pytest.approx(40, abs=1) and towards_mm < 2 and stiffness == pytest.approx(0.8, abs=0.05)
        agreed = {"model": "Inverse3 049D", "stiffness_N_per_mm": 0.3, "axes": "z,x,y"}
        (desk / "palpate").mkdir()
        (desk / "palpate" / "devices.json").write_text(json.dumps({"version": 1, "devices": {"haply:049D": agreed}}))
        (_, up_mm, towards_mm), stiffness = taps(session, 0.3)
        assert up_mm < 2 and towards_mm == pytest.approx(40, abs=1) and stiffness == pytest.approx(0.3, abs=0.02)
        (_, up_mm, towards_mm), stiffness = taps(session, 0.3, axes="x,y,z")
        assert up_mm == pytest.approx(40, abs=1) and towards_mm < 2 and stiffness == pytest.approx(0.3, abs=0.02)


def test_axes_that_make_no_sense_are_refused(desk, ball):
    with pp.Session(ball, gpu="cpu", mm_per_unit=0.6) as session:
        with pytest.raises(ValueError, match="'x,y' is not a permutation"):
            session.live("haply", axes="x,y")
        with pytest.raises(ValueError, match="the device path is not in a hand"):
            session.live(builtin="press", axes="x,z,-y")


ENDS = """
import os, sys, threading, time
from pathlib import Path
import numpy as np
import palpate as pp
from conftest import ball_arrays

xyz, normals = ball_arrays()
session = pp.Session(pp.Cloud(xyz, normals=normals), gpu="cpu", mm_per_unit=0.6)
begun, felt, count = threading.Event(), threading.Event(), 0
def heard(ticks):
    global count
    begun.set()
    count += int((np.linalg.norm(ticks["force_N"], axis=1) > 0.3).sum())
    if count > 50:
        felt.set()
live = session.live("haply", on_ticks=heard)
assert begun.wait(30)
Path(os.environ["PALPATE_HAPLY_CONFIG"]).with_name("taps").touch()
assert felt.wait(30)
if sys.argv[1] == "fork":
    child = os.fork()
    if child == 0:
        sys.exit(0)  # with everything that an interpreter does at its end
    assert os.waitpid(child, 0)[1] == 0
    count = 0
    felt.clear()
    assert felt.wait(30)  # the parent's session goes on
if sys.argv[1] == "exit":
    sys.exit(3)
if sys.argv[1] == "raise":
    raise RuntimeError("ends here")
"""


@pytest.mark.parametrize(("how", "code"), [("end", 0), ("exit", 3), ("raise", 1), ("fork", 0)])
def test_an_interpreter_that_ends_with_a_live_session_takes_the_force_with_it(service, how, code):
    folders = [*sys.path, os.path.dirname(__file__)]
    ended = subprocess.run([sys.executable, "-c", ENDS, how], capture_output=True, text=True, timeout=100, check=False,
                           env={**os.environ, "PYTHONPATH": os.pathsep.join(folder for folder in folders if folder)})
    assert ended.returncode == code, ended.stderr
    most_N, last_N, _, _ = map(float, service.communicate(timeout=30)[0].split())
    assert most_N > 0.2 and last_N == 0
