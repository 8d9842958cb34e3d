#!/usr/bin/env python3
"""Times of `palpate bench select` beside Open3D's on the same points, in turns in one run, on the same threads.

    OMP_NUM_THREADS=2 python3 apps/bench/select_peers.py build/release/palpate [--points 1000000] [--rounds 5]
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import open3d as o3d


def peers(file: Path, spacing: float) -> dict[str, Callable[[], object]]:
    """Open3D's operations by the names of the bench."""
    cloud = o3d.io.read_point_cloud(str(file))
    bare = o3d.geometry.PointCloud(cloud.points)
    nearest = o3d.geometry.KDTreeSearchParamKNN(16)
    z = np.asarray(cloud.points)[:, 2]
    middle = 0.5 * (z.min() + z.max())

    def normals() -> object:
        again = o3d.geometry.PointCloud(cloud.points)
        again.estimate_normals(nearest)
        return again

    def oriented() -> object:
        again = normals()
        again.orient_normals_consistent_tangent_plane(16)
        return again

    return {
        "filter: selected points as a cloud": lambda: cloud.select_by_index(np.flatnonzero(z > middle)),
        "duplicates": lambda: o3d.geometry.PointCloud(cloud).remove_duplicated_points(),
        "subsample: 4 spacings": lambda: cloud.voxel_down_sample(4 * spacing),
        "outliers: 8 neighbours": lambda: bare.remove_statistical_outlier(8, 1.0),
        "radius outliers: 4 in 4 spacings": lambda: bare.remove_radius_outlier(4, 4 * spacing),
        "normals: 16 neighbours, not oriented": normals,
        "normals: 16 neighbours, oriented": oriented,
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--points", type=int, default=1_000_000)
    parser.add_argument("--rounds", type=int, default=5)
    options = parser.parse_args()
    threads = os.environ.get("OMP_NUM_THREADS", str(os.cpu_count()))
    ours: dict[str, list[float]] = {}
    theirs: dict[str, list[float]] = {}
    with tempfile.TemporaryDirectory() as folder:
        model, result = Path(folder) / "sculpture.ply", Path(folder) / "result.json"

        def run(*words: object) -> None:
            subprocess.run([options.program, *map(str, words), "--quiet"], check=True, stdout=subprocess.DEVNULL)

        run("make", "sculpture", "-n", options.points, "-o", model)
        run("info", model, "--json", result)
        found = peers(model, json.loads(result.read_text())["mean_spacing"])
        for _ in range(options.rounds):
            run("bench", "select", "--of", "cloud", "--models", model, "--repeat", 1, "--limit", 0, "--threads",
                threads, "--json", result)
            for record in json.loads(result.read_text())["select"]:
                ours.setdefault(record["operation"], []).append(record["time_ms"]["p50"])
            for name, peer in found.items():
                since = time.perf_counter()
                peer()
                theirs.setdefault(name, []).append(1e3 * (time.perf_counter() - since))
    print(f"{options.points} points, {threads} threads, ms, median of {options.rounds}; Open3D {o3d.__version__}")
    for name in {**ours, **theirs}:
        cells = [f"{np.median(times[name]):9.1f}" if name in times else "        –" for times in (ours, theirs)]
        print(f"{name:40} palpate {cells[0]}  Open3D {cells[1]}")


if __name__ == "__main__":
    main()
