"""Python and the program give the same contact, on the CPU and on a GPU."""

from __future__ import annotations

import os
import subprocess

import numpy as np
import palpate as pp
import pytest
from conftest import ball_arrays, press_path


@pytest.mark.parametrize("gpu", ["cpu", 0])
@pytest.mark.parametrize("surface", ["average", "sharp"])
def test_a_path_is_felt_as_the_program_feels_it(tmp_path, gpu, surface):
    program = os.environ.get("PALPATE_PROGRAM")
    if not program:
        pytest.skip("the program is not built")
    xyz, normals = ball_arrays(5_000)
    pp.write(tmp_path / "ball.ply", pp.Cloud(xyz.astype(np.float32), normals=normals.astype(np.float32)))
    path = press_path(1.5, 60, 40)
    rows = np.column_stack([np.arange(len(path)) / 1000, path])
    np.savetxt(tmp_path / "path.csv", rows, delimiter=",", header="t_s,x,y,z", comments="", fmt="%.17g")
    where = ["--backend", "cpu"] if gpu == "cpu" else ["--backend", "vulkan", "--gpu", str(gpu)]
    subprocess.run(
        [program, "touch", "ball.ply", "--path", "path.csv", "--trace", "trace.csv", "--surface", surface, "--quiet",
         *where],
        cwd=tmp_path, check=True, stdout=subprocess.DEVNULL)
    trace = np.genfromtxt(tmp_path / "trace.csv", delimiter=",", names=True)
    with pp.Session(pp.read(tmp_path / "ball.ply"), gpu=gpu, surface=surface) as session:
        felt = session.touch(rows)
    assert len(felt) == len(trace) == 100
    assert np.array_equal(felt["contact"], trace["contact"] == 1) and felt["contact"].sum() > 20
    assert np.array_equal(felt["neighbours"], trace["neighbours"])
    for name in ("hip", "proxy", "normal"):
        for k, axis in enumerate("xyz"):
            assert np.allclose(felt[name][:, k], trace[f"{name}_{axis}"], rtol=0, atol=1e-5)
    for k, axis in enumerate("xyz"):
        assert np.allclose(felt["force_N"][:, k], trace[f"force_{axis}"], rtol=0, atol=1e-5)
    assert np.allclose(felt["penetration_mm"], trace["penetration_mm"], rtol=0, atol=1e-5)


def test_a_gpu_and_the_cpu_feel_the_same_and_sculpt_alike(ball):
    ends = []
    for gpu in ("cpu", 0):
        with pp.Session(ball, gpu=gpu, mm_per_unit=1) as session:
            assert session.backend == ("cpu" if gpu == "cpu" else "vulkan")
            felt = session.touch(press_path(1, 60, 40))
            session.push(press_path(4, 40, 20), radius_mm=5)
            dented = session.touch(press_path(1, 60, 40))
            assert session.undo() == 1
            assert np.array_equal(session.cloud().xyz, ball.xyz)
            ends.append((felt["force_N"][-1], dented["force_N"][-1]))
    assert np.allclose(ends[0][0], ends[1][0], atol=2e-3)
    assert np.allclose(ends[0][1], ends[1][1], atol=0.1)
