"""Devices in a hand: their axes, and what their users agreed to."""

from __future__ import annotations

import json
import os
import subprocess
import threading
import time
from pathlib import Path

import numpy as np
import palpate as pp
import pytest


@pytest.fixture
def desk(tmp_path, monkeypatch):
    """A Haply service whose hand rests 40 mm above the middle, and taps from there down to 26 mm once a session ticks:
    one that began with the hand inside the ball would feel it from there. Yields the folder of the settings.
    """
    service = subprocess.Popen([os.environ["PALPATE_HAPLY_SERVICE"]], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                               text=True)
    monkeypatch.setenv("PALPATE_HAPLY_CONFIG", service.stdout.readline().strip())
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    yield tmp_path
    service.communicate(timeout=30)


def taps(session, **options):
    ticks, begun = [], threading.Event()

    def keep(block):
        ticks.append(block.copy())
        begun.set()

    signal = Path(os.environ["PALPATE_HAPLY_CONFIG"]).with_name("taps")
    signal.unlink(missing_ok=True)
    live = session.live("haply", on_ticks=keep, **options)
    assert begun.wait(30)
    signal.touch()
    time.sleep(3)
    live.stop()
    t = np.concatenate(ticks)
    felt = t[(t["t_s"] > 1.5) & (t["contact"] != 0) & (t["penetration_mm"] > 0.5)]
    assert len(felt) > 20
    # A stall of the machine makes the force ramp up again: it is never stiffer, but may be softer.
    stiffness = np.median(np.linalg.norm(felt["force_N"], axis=1) / felt["penetration_mm"])
    return 0.6 * np.abs(t["hip"]).max(axis=0), stiffness


def test_a_session_uses_what_the_user_of_a_device_agreed_to(desk, ball):
    with pp.Session(ball, gpu="cpu", mm_per_unit=0.6) as session:
        (_, up_mm, towards_mm), stiffness = taps(session)
        assert up_mm == pytest.approx(40, abs=1) and towards_mm < 2 and 0.5 < stiffness < 0.85
        agreed = {"model": "Inverse3 049D", "stiffness_N_per_mm": 0.3, "axes": "z,x,y"}
        (desk / "palpate").mkdir()
        (desk / "palpate" / "devices.json").write_text(json.dumps({"version": 1, "devices": {"haply:049D": agreed}}))
        (_, up_mm, towards_mm), stiffness = taps(session)
        assert up_mm < 2 and towards_mm == pytest.approx(40, abs=1) and 0.1 < stiffness < 0.32
        (_, up_mm, towards_mm), stiffness = taps(session, axes="x,y,z")
        assert up_mm == pytest.approx(40, abs=1) and towards_mm < 2 and 0.1 < stiffness < 0.32


def test_axes_that_make_no_sense_are_refused(desk, ball):
    with pp.Session(ball, gpu="cpu", mm_per_unit=0.6) as session:
        with pytest.raises(ValueError, match="'x,y' is not a permutation"):
            session.live("haply", axes="x,y")
        with pytest.raises(ValueError, match="the device path is not in a hand"):
            session.live(builtin="press", axes="x,z,-y")
