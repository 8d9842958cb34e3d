"""The examples of the module's README run, with the files, devices and durations of the test."""

from __future__ import annotations

import ast
import os
import re
from pathlib import Path

import numpy as np
import palpate as pp
import pytest
from conftest import ball_arrays, own_domain, press_path

README = Path(__file__).parents[2] / "apps" / "python" / "README.md"


def example() -> str:
    """The first part of the first block of Python: up to the blank line after the writing."""
    block = re.search(r"^```python\n(.*?)^```", README.read_text(), re.S | re.M)
    assert block is not None
    return block.group(1).split("\n\nwith pp.Matter")[0]


def test_the_example_of_the_readme_runs(tmp_path, monkeypatch):
    source = example()
    assert source.startswith("import numpy as np, palpate as pp\n")
    # A scan, a device, a short time and a small resolution replace those of the reader; the rest is unchanged.
    for shown, here in (("gpu=0", 'gpu="cpu", mm_per_unit=1'), ('"openhaptics"', '"sim", builtin="press"'),
                        ("live.wait(60)", "live.wait(0.3)"), ("resolution=256", "resolution=64")):
        assert source.count(shown) == 1, shown
        source = source.replace(shown, here)
    xyz, normals = ball_arrays(20_000)
    pp.write(tmp_path / "scan.laz", pp.Cloud(xyz, normals=normals, colors=np.full((len(xyz), 3), 200, np.uint8)))
    monkeypatch.chdir(tmp_path)
    seen = {"path": press_path(1.0)}
    exec(compile(source, str(README), "exec"), seen)

    assert len(seen["t"]) == len(seen["path"]) and seen["t"]["contact"].any()
    assert 0.5 < seen["t"]["force_N"].max() < 1.5
    assert seen["img"].shape == (720, 1280, 4) and seen["img"].dtype == np.uint8
    assert seen["img"][..., :3].max() > seen["img"][..., :3].min()
    assert len(pp.read(tmp_path / "m.ply")) > 1000
    assert len(pp.read(tmp_path / "out.ply")) == 20_000  # the stroke was undone


@pytest.mark.skipif(not pp.can_simulate(), reason="this palpate was built without PALPATE_SIMULATION")
def test_the_example_of_scenes_logs_frames_and_tools_runs(ball, tmp_path, monkeypatch):
    source = "with pp.Matter" + README.read_text().split("\n\nwith pp.Matter", 1)[1].split("\n\nlan = ", 1)[0]
    # Everything smaller, and on the CPU; the folder of a depth camera is tested in test_frames.py.
    for shown, here in (('pp.Matter("dam")', 'pp.Matter("dam", gpu="cpu")'), ("simulate(0.5)", "simulate(0.01)"),
                        ('"water", hands=2', '"water", hands=2, gpu="cpu"'),
                        ("of_frames(cloud)", 'of_frames(cloud, gpu="cpu")'),
                        ("pp.Session(cloud) as r", 'pp.Session(cloud, gpu="cpu") as r'),
                        ('tool_points=16)', 'tool_points=16, gpu="cpu")'),
                        ("budget_us=500)", 'budget_us=500, gpu="cpu")'),
                        ("[cloud, cloud],", '[cloud, cloud], gpu="cpu",')):
        assert source.count(shown) == 1, shown
        source = source.replace(shown, here)
    lines = [line for line in source.splitlines() if not line.startswith("recorded = ")]
    assert len(lines) == len(source.splitlines()) - 1
    monkeypatch.chdir(tmp_path)
    xyz, normals = ball_arrays(5000)
    left = np.column_stack([np.full(20, 40.0), np.full(20, 50.0), np.linspace(60, 55, 20)])
    seen = {"pp": pp, "np": np, "cloud": ball, "path": press_path(1, 20, 5), "xyz": xyz, "normals": normals,
            "velocities": np.zeros_like(xyz), "origins": 2 * xyz[:9], "directions": -xyz[:9],
            "left": left, "right": left + [10, 0, 0]}
    exec(compile("\n".join(lines), str(README), "exec"), seen)
    assert seen["log"].ended and len(seen["log"].edits) > 0 and seen["t"].shape == (20, 2)
    assert seen["frame"].positions.shape[1] == 3
    assert seen["hits"]["found"].all() and seen["answer"].validity == "fresh"
    for name in ("film", "pad", "both"):
        seen[name].close()


@pytest.mark.skipif(not pp.can_share(), reason="this palpate was built without PALPATE_NETWORK")
def test_the_example_of_shared_sessions_runs(ball, tmp_path, monkeypatch):
    source = README.read_text().split("\n\nlan = ", 1)[1].split("\n```", 1)[0]
    source = "lan = " + source
    for shown, here in (('interface="eth0"', f"domain={own_domain()}"), ("server.wait(600)", "server.wait(0.1)"),
                        ('hand_name="anna")', 'hand_name="anna", gpu="cpu")')):
        assert source.count(shown) == 1, shown
        source = source.replace(shown, here)
    serving, joining = source.split("print(pp.discover", 1)
    xyz, normals = ball_arrays(5000)
    seen = {"pp": pp, "xyz": xyz, "normals": normals, "path": press_path(1.0)}
    monkeypatch.chdir(tmp_path)
    exec(compile(serving, str(README), "exec"), seen)
    assert len(pp.read(tmp_path / "city.ply")) == 5000
    with pp.serve(ball, "city", seen["lan"], mm_per_unit=1) as server:  # of another program, in the README
        exec(compile("print(pp.discover" + joining, str(README), "exec"), seen)
        assert server.sculptors == 1


def test_every_line_of_the_readmes_examples_is_python():
    blocks = re.findall(r"^```python\n(.*?)^```", README.read_text(), re.S | re.M)
    assert blocks
    for block in blocks:
        ast.parse(block)
