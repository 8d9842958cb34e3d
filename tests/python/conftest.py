"""A ball with a known surface, and paths into it."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import palpate as pp
import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from own_domain import own_domain  # noqa: E402, F401 (the tests take it from here)

RADIUS = 50.0


def pytest_configure(config: pytest.Config) -> None:
    config.addinivalue_line("markers", "full: costs more than the quick tier allows")


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """The labels of labels.hpp: the quick tier skips tests marked full; PALPATE_TESTS_ONLY runs one label."""
    only = os.environ.get("PALPATE_TESTS_ONLY", "")
    if only:
        chosen = [item for item in items if only == "full" and item.get_closest_marker("full")]
        config.hook.pytest_deselected(items=[item for item in items if item not in chosen])
        items[:] = chosen
    elif os.environ.get("PALPATE_TESTS_TIER") != "full":
        for item in items:
            if item.get_closest_marker("full"):
                item.add_marker(pytest.mark.skip(reason="skipped: only in the full tier (PALPATE_TESTS_TIER=full)"))


def pytest_sessionfinish(session: pytest.Session) -> None:
    if os.environ.get("PALPATE_TESTS_ONLY") and session.exitstatus == pytest.ExitCode.NO_TESTS_COLLECTED:
        session.exitstatus = pytest.ExitCode.OK  # no test of this file has that label


def ball_arrays(count: int = 20_000) -> tuple[np.ndarray, np.ndarray]:
    """Evenly distributed on a sphere (Fibonacci lattice), float64, with exact normals."""
    i = np.arange(count)
    z = 1 - (2 * i + 1) / count
    r = np.sqrt(1 - z * z)
    turn = 2 * np.pi * i / 1.618033988749895
    normals = np.column_stack([r * np.cos(turn), r * np.sin(turn), z])
    return RADIUS * normals, normals


def press_path(depth: float, down: int = 100, rest: int = 100) -> np.ndarray:
    """Along z from 2 above the ball to `depth` below its surface, and at rest there; a row for each tick."""
    z = np.concatenate([np.linspace(RADIUS + 2, RADIUS - depth, down), np.full(rest, RADIUS - depth)])
    return np.column_stack([np.full_like(z, 0.3), np.full_like(z, -0.2), z])


@pytest.fixture
def ball() -> pp.Cloud:
    xyz, normals = ball_arrays()
    return pp.Cloud(xyz, normals=normals)


@pytest.fixture
def session(ball: pp.Cloud):
    with pp.Session(ball, gpu="cpu", mm_per_unit=1) as opened:
        yield opened


@pytest.fixture(scope="session")
def npm(tmp_path_factory):
    """Installs packages of npm in a folder of their own; if that fails the test is skipped with the reason."""

    def install(*packages: str):
        if shutil.which("node") is None or shutil.which("npm") is None:
            pytest.skip("node and npm are not installed")
        folder = tmp_path_factory.mktemp("npm")
        command = ["npm", "install", "--prefix", str(folder), "--no-audit", "--no-fund", "--ignore-scripts", *packages]
        try:
            done = subprocess.run(command, capture_output=True, text=True, timeout=90)
        except subprocess.TimeoutExpired:
            pytest.skip("npm's packages could not be downloaded within 90 seconds")
        if done.returncode != 0:
            pytest.skip("npm's packages cannot be installed: " + done.stderr.strip()[-300:])
        return folder

    return install
