"""Each call without memory or file descriptors: an error in words within its time, and the session is as it was."""

from __future__ import annotations

import json
import os
import subprocess
import sys

import pytest

CHILD = """
import ctypes, gc, json, os, resource, sys, time
import numpy as np
import palpate as pp
from conftest import ball_arrays, press_path

limit, call, folder = sys.argv[1:4]
xyz, normals = ball_arrays(50_000)
path, asked = press_path(1.5, 40, 5), xyz[:2_000] * 1.5
file, made = os.path.join(folder, "ball.ply"), os.path.join(folder, "made.ply")
cloud = pp.Cloud(xyz, normals=normals)
pp.write(file, cloud)
s = pp.Session(cloud, gpu="cpu", mm_per_unit=1)
def opened():
    with pp.Session(cloud, gpu="cpu", mm_per_unit=1):
        pass
def lived():
    with s.live(path=path) as live:
        live.wait(0.05)
calls = {
    "Cloud": lambda: pp.Cloud(xyz, normals=normals),
    "read": lambda: pp.read(file),
    "write": lambda: pp.write(made, cloud),
    "Session": opened,
    "touch": lambda: s.touch(path),
    "push": lambda: s.push(path, radius_mm=4),
    "undo": lambda: s.undo(),
    "cloud": lambda: s.cloud(),
    "rows": lambda: s.rows(),
    "nearest": lambda: s.nearest(asked),
    "raycast": lambda: s.raycast(asked, -asked),
    "mesh": lambda: s.mesh(resolution=128),
    "live": lived,
    "serve": lambda: pp.serve(cloud, "ball", pp.Network(domain=int(sys.argv[4])), mm_per_unit=1).close(),
}
s.push(path, radius_mm=4)  # something to undo
if limit != "memory" and call not in ("read", "Session", "live", "serve"):
    calls[call]()  # Python has then imported what it needs
gc.collect()
before = {"memory": resource.RLIMIT_AS, "files": resource.RLIMIT_NOFILE}[limit]
if limit == "memory":
    with open("/proc/self/statm") as statm:
        used = int(statm.read().split()[0]) * resource.getpagesize()
    ctypes.CDLL(None).malloc_trim(0)
    resource.setrlimit(before, (used + (1 << 20), resource.RLIM_INFINITY))
elif limit == "files":
    hard = resource.getrlimit(before)[1]
    resource.setrlimit(before, (3, hard))
told, kind = "", ""
since = time.monotonic()
try:
    calls[call]()
except (pp.Error, MemoryError, OSError) as error:
    kind, told = type(error).__name__, str(error)
took = time.monotonic() - since
if limit == "memory":
    resource.setrlimit(before, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))
elif limit == "files":
    resource.setrlimit(before, (min(1024, hard), hard))
ticks = s.touch(path)
print(json.dumps({"kind": kind, "told": told, "took_s": took, "contact": bool(ticks["contact"].any()),
                  "finite": bool(np.isfinite(ticks["force_N"]).all())}))
"""

CALLS = ["Cloud", "read", "write", "Session", "touch", "push", "undo", "cloud", "rows", "nearest", "raycast", "mesh",
         "live", "serve"]
# Calls that cannot do without; all others may succeed as well.
NEEDS = {"memory": {"Session", "live"}, "files": {"read", "write"}}
LONGEST_S = 20


@pytest.mark.parametrize("limit", ["memory", "files"])
@pytest.mark.parametrize("call", CALLS)
def test_a_call_beyond_a_limit_says_so_and_leaves_the_session_as_it_was(tmp_path, limit, call):
    import palpate as pp
    from own_domain import own_domain

    if call == "serve" and not pp.can_share():
        pytest.skip("this palpate was built without PALPATE_NETWORK")
    if call == "serve" and limit == "memory":
        pytest.skip("the DDS library ends the program where it gets no memory")
    folders = [*sys.path, os.path.dirname(__file__)]
    child = subprocess.run(
        [sys.executable, "-c", CHILD, limit, call, str(tmp_path), str(own_domain())],
        env={**os.environ, "PYTHONPATH": os.pathsep.join(folder for folder in folders if folder)},
        capture_output=True, text=True, timeout=100, check=False,
    )
    assert child.returncode == 0, f"{child.returncode}: {child.stderr[-2000:]}"
    told = json.loads(child.stdout.splitlines()[-1])
    assert told["took_s"] < LONGEST_S, told
    assert told["contact"] and told["finite"], told
    if call in NEEDS[limit]:
        assert told["kind"], told
    if told["kind"] == "Error":
        assert len(told["told"].split()) >= 4, told
