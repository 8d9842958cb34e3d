"""Each call without memory, file descriptors or threads: an error in words in time, and the session is as it was."""

from __future__ import annotations

import json
import os
import subprocess
import sys

import pytest

CHILD = """
import ctypes, gc, json, os, resource, sys, time
from pathlib import Path
import numpy as np
import palpate as pp
from conftest import ball_arrays, press_path

limit, call, folder = sys.argv[1:4]
os.chdir(folder)
xyz, normals = ball_arrays(50_000)
path, asked = press_path(1.5, 40, 5), xyz[:2_000] * 1.5
file, made, log = "ball.ply", "made.ply", "log"
cloud = pp.Cloud(xyz, normals=normals)
pp.write(file, cloud)
s = pp.Session(cloud, gpu="cpu", mm_per_unit=1)
def threads_of_user():
    count = 0
    for status in Path("/proc").glob("[0-9]*/status"):
        try:
            words = dict(line.split(":", 1) for line in status.read_text().splitlines())
        except OSError:  # it has ended
            continue
        if int(words["Uid"].split()[0]) == os.getuid():
            count += int(words["Threads"])
    return count
def opened():
    with pp.Session(cloud, gpu="cpu", mm_per_unit=1):
        pass
def lived():
    with s.live(path=path) as live:
        live.wait(0.05)
by_law = pp.Session(cloud, gpu="cpu", mm_per_unit=1, law=lambda given: given.force_N, allow_python_law=True)
def lived_by_law():
    with by_law.live(path=path) as live:
        live.wait(0.05)
unedited = pp.Session(cloud, gpu="cpu", mm_per_unit=1)
def recorded():
    unedited.record(log)
    unedited.touch(path)
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
    "mesh": lambda: s.mesh(resolution=32),
    "live": lived,
    "law": lived_by_law,
    "record": recorded,
    "serve": lambda: pp.serve(cloud, "ball", pp.Network(domain=int(sys.argv[4])), mm_per_unit=1).close(),
}
s.push(path, radius_mm=4)  # something to undo
if limit != "memory" and call not in ("read", "Session", "live", "law", "record", "serve"):
    calls[call]()  # Python has then imported what it needs
gc.collect()
before = {"memory": resource.RLIMIT_AS, "files": resource.RLIMIT_NOFILE, "threads": resource.RLIMIT_NPROC}[limit]
if limit == "memory":
    with open("/proc/self/statm") as statm:
        used = int(statm.read().split()[0]) * resource.getpagesize()
    ctypes.CDLL(None).malloc_trim(0)
    room = 24 << 20 if call == "serve" else 1 << 20  # a server's first thread exists, and DDS has too little
    resource.setrlimit(before, (used + room, resource.RLIM_INFINITY))
elif limit == "files":
    hard = resource.getrlimit(before)[1]
    resource.setrlimit(before, (3, hard))
elif limit == "threads":
    if os.getuid() == 0:  # the limit does not apply to root
        os.chmod(".", 0o777)
        os.setuid(65534)
    hard = resource.getrlimit(before)[1]
    room = 4 if call == "serve" else 0  # fewer than DDS needs
    resource.setrlimit(before, (threads_of_user() + room, hard))
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
elif limit == "threads":
    resource.setrlimit(before, (hard, hard))
ticks = s.touch(path)
print(json.dumps({"kind": kind, "told": told, "took_s": took, "contact": bool(ticks["contact"].any()),
                  "finite": bool(np.isfinite(ticks["force_N"]).all())}))
"""

CALLS = ["Cloud", "read", "write", "Session", "touch", "push", "undo", "cloud", "rows", "nearest", "raycast", "mesh",
         "live", "law", "record", "serve"]
# Calls that cannot do without; all others may succeed as well.
NEEDS = {"memory": {"Session", "live", "law", "serve"}, "files": {"read", "write", "record"},
         "threads": {"Session", "live", "law", "serve"}}
LONGEST_S = 20


@pytest.mark.parametrize("limit", ["memory", "files", "threads"])
@pytest.mark.parametrize("call", CALLS)
def test_a_call_beyond_a_limit_says_so_and_leaves_the_session_as_it_was(tmp_path, limit, call):
    import palpate as pp
    from own_domain import own_domain

    if call == "serve" and not pp.can_share():
        pytest.skip("this palpate was built without PALPATE_NETWORK")
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
        assert len(told["told"].split()) >= 3, told
