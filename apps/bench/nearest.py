#!/usr/bin/env python3
"""Times of Session.nearest(), with and without the surface, and of raycast(), beside nanoflann and SciPy's cKDTree:
same points, same queries, one thread, in turns in one run; the median of the rounds.

    PYTHONPATH=build/release/python python3 apps/bench/nearest.py [MODEL...] [--queries 20000] [--rounds 10]
"""

from __future__ import annotations

import argparse
import ctypes
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import palpate as pp
from numpy.typing import NDArray

Search = Callable[[NDArray[Any]], Any]
HERE = Path(__file__).parent


def ball(count: int) -> pp.Cloud:
    """Even points of a ball of 100 mm."""
    i = np.arange(count) + 0.5
    z, angle = 1 - 2 * i / count, i * np.pi * (3 - np.sqrt(5))
    out = np.column_stack([np.sqrt(1 - z * z) * np.cos(angle), np.sqrt(1 - z * z) * np.sin(angle), z])
    return pp.Cloud(50 * out, normals=out)


def nanoflann(points: NDArray[np.float32], folder: Path) -> Search | None:
    compiler, library = shutil.which("c++"), folder / "peer.so"
    built = compiler and subprocess.run(
        [compiler, "-std=c++20", "-O3", "-DNDEBUG", "-shared", "-fPIC", HERE / "nearest_peer.cpp", "-o", library],
        capture_output=True,
    )
    if not built or built.returncode != 0:
        print("nearest.py: without nanoflann, which needs a C++ compiler and libnanoflann-dev", file=sys.stderr)
        return None
    peer = ctypes.CDLL(str(library))
    peer.peer_make.restype = ctypes.c_void_p
    tree = ctypes.c_void_p(peer.peer_make(points.ctypes.data_as(ctypes.c_void_p), ctypes.c_size_t(len(points))))

    def search(asked: NDArray[Any]) -> NDArray[np.uint32]:
        rows = np.empty(len(asked), np.uint32)
        peer.peer_nearest(tree, asked.ctypes.data_as(ctypes.c_void_p), ctypes.c_size_t(len(asked)),
                          rows.ctypes.data_as(ctypes.c_void_p))
        return rows

    return search


def scipy(points: NDArray[np.float32]) -> Search | None:
    try:
        from scipy.spatial import cKDTree
    except ImportError:
        print("nearest.py: without SciPy (python3-scipy)", file=sys.stderr)
        return None
    tree = cKDTree(points)
    return lambda asked: tree.query(asked, workers=1)[1]


def measure(name: str, cloud: pp.Cloud, queries: int, rounds: int, folder: Path) -> bool:
    """Prints the times of one cloud; False if nearest points differ from nanoflann's."""
    points = np.ascontiguousarray(cloud.positions)
    rng = np.random.default_rng(5)
    spacing = np.linalg.norm(points.max(0) - points.min(0)) / np.sqrt(len(points))
    normals = cloud.normals
    with pp.Session(cloud, gpu="cpu", threads=1) as session:
        found = session.nearest(points[:1] + cloud.origin)  # makes the index
        assert found["found"][0]
        print(f"{name}: {len(points)} points, {queries} queries, one thread")
        print(f"us of the processor a query, p50 of {rounds} rounds")
        right = True
        farthest = 0.2 * float(np.sqrt(len(points)))
        for where, far in (("within 5 spacings", 5.0), ("up to a fifth of the model away", farthest)):
            chosen = rng.integers(len(points), size=queries)
            aside = rng.normal(size=(queries, 3))
            aside *= far * spacing * rng.random((queries, 1)) / np.linalg.norm(aside, axis=1)[:, None]
            asked = np.ascontiguousarray(points[chosen] + aside, dtype=np.float32)
            along = -aside if normals is None else -normals[chosen]
            of_file = asked.astype(np.float64) + cloud.origin
            searches: dict[str, Search | None] = {
                "nearest(surface=False)": lambda _, at=of_file: session.nearest(at, surface=False)["row"],
                "nanoflann": nanoflann(points, folder),
                "SciPy cKDTree": scipy(points),
                "nearest()": lambda _, at=of_file: session.nearest(at)["row"],
                "raycast()": lambda _, at=of_file, to=along: session.raycast(at, to)["row"],
            }
            present = {name: search for name, search in searches.items() if search}
            times: dict[str, list[float]] = {name: [] for name in present}
            rows: dict[str, Any] = {}
            for _ in range(rounds):
                for name_of, search in present.items():
                    since = time.process_time()
                    rows[name_of] = search(asked)
                    times[name_of].append((time.process_time() - since) / queries * 1e6)
            print(f"  {where}: " + ", ".join(f"{n} {np.median(t):.2f}" for n, t in times.items()))
            if "nanoflann" in rows:
                both = ("nanoflann", "nearest(surface=False)")
                apart = [np.linalg.norm(points[rows[each]] - asked, axis=1) for each in both]
                right = right and np.allclose(*apart, rtol=1e-5)
        return right


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("models", nargs="*", help="files; without any, a ball of 400,000 points")
    parser.add_argument("--queries", type=int, default=20_000)
    parser.add_argument("--rounds", type=int, default=10)
    options = parser.parse_args()
    clouds = [(Path(file).name, pp.read(file)) for file in options.models] or [("ball", ball(400_000))]
    with tempfile.TemporaryDirectory() as folder:
        right = [measure(name, cloud, options.queries, options.rounds, Path(folder)) for name, cloud in clouds]
    return 0 if all(right) else 1


if __name__ == "__main__":
    sys.exit(main())
