"""What remains when Python ends: threads in calls of palpate, and sessions in cycles."""

from __future__ import annotations

import gc
import subprocess
import sys
import weakref

import palpate as pp
import pytest
from conftest import press_path

BUSY = """
import sys, threading, time
import numpy as np
import palpate as pp

rng = np.random.default_rng(1)
xyz = rng.normal(size=(5_000, 3))
xyz /= np.linalg.norm(xyz, axis=1)[:, None]
cloud = pp.Cloud(50 * xyz, normals=xyz)
pp.write(sys.argv[2], cloud)
session = pp.Session(cloud, gpu="cpu", mm_per_unit=1, allow_python_law=True, law=lambda given: given.force_N)
path = np.tile([[0, 0, 49.0]], (40, 1))
calls = {
    "touch": lambda: session.touch(path),
    "nearest": lambda: session.nearest(60 * xyz[:500]),
    "read": lambda: pp.read(sys.argv[2]),
}
call = calls[sys.argv[1]]
call()

def work():
    while True:
        call()

threading.Thread(target=work, daemon=True).start()
time.sleep(0.1)
"""


@pytest.mark.parametrize("call", ["touch", "nearest", "read"])
def test_a_daemon_thread_in_a_call_does_not_abort_the_interpreter_at_its_end(tmp_path, call):
    for _ in range(4):
        ended = subprocess.run(
            [sys.executable, "-c", BUSY, call, str(tmp_path / "ball.ply")], capture_output=True, text=True, timeout=60
        )
        assert ended.returncode == 0 and not ended.stderr, ended.stderr


@pytest.mark.parametrize("through", ["on_contact", "on_message", "law"])
def test_a_session_whose_function_uses_it_is_collected(ball, through):
    class Holder:
        def hear(self, *_):
            return [0, 0, self.session.points * 0]

    holder = Holder()
    words = {"on_message": holder.hear} if through == "on_message" else {}
    if through == "law":
        words = {"law": holder.hear, "allow_python_law": True}
    holder.session = pp.Session(ball, gpu="cpu", mm_per_unit=1, **words)
    if through == "on_contact":
        holder.session.on_contact(holder.hear)
    seen = weakref.ref(holder.session)
    del holder, words
    gc.collect()
    assert seen() is None


def test_a_session_that_has_been_looked_at_by_the_collector_works_on(ball):
    begins = []
    with pp.Session(ball, gpu="cpu", mm_per_unit=1) as session:
        session.on_contact(lambda event: begins.append(event.begins))
        gc.collect()
        session.touch(press_path(1))
    assert begins == [True, False]
