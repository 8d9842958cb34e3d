#!/usr/bin/env python3
"""Whole jobs from file to file beside CloudCompare's command line, in turns: seconds, of the clock and of all cores.

    python3 apps/bench/jobs.py build/release/palpate [--points 1000000] [--rounds 3]

A job reads a binary PLY file, does one thing, and writes another one. CloudCompare (Debian's package cloudcompare) runs
without a display. Both programs are given the same points and parameters; `left` are the points of their results, which
differ where a method does (which point of a cell stays, on which side of a limit a point counts).
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import subprocess
import tempfile
import time
from pathlib import Path

import numpy as np


def points_in(file: Path) -> int:
    with file.open("rb") as opened:
        for line in opened:
            if line.startswith(b"element vertex"):
                return int(line.split()[2])
    raise ValueError(f"{file} has no vertices")


def timed(command: list[str]) -> tuple[float, float]:
    """Seconds of the clock, and of all cores."""
    before, since = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    environment = {**os.environ, "QT_QPA_PLATFORM": "offscreen"}
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env=environment)
    wall, after = time.perf_counter() - since, resource.getrusage(resource.RUSAGE_CHILDREN)
    return wall, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--points", type=int, default=1_000_000)
    parser.add_argument("--rounds", type=int, default=3)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        model, ours, theirs = folder / "model.ply", folder / "ours.ply", folder / "theirs.ply"
        subprocess.run([options.program, "make", "sculpture", "-n", str(options.points), "-o", str(model), "--quiet"],
                       check=True)
        read = [options.program, "info", str(model), "--json", str(folder / "info.json"), "--quiet"]
        subprocess.run(read, check=True, stdout=subprocess.DEVNULL)
        spacing = json.loads((folder / "info.json").read_text())["mean_spacing"]
        cell = f"{4 * spacing:.6f}"
        box = "-1000,-1000,0:1000,1000,1000"
        jobs = {
            "crop to a box": (["--crop", box], ["-CROP", "-1000:-1000:0:1000:1000:1000"]),
            "statistical outliers, 8 neighbours, 1 sigma": (["--outliers"], ["-SOR", "8", "1.0"]),
            "subsample to 4 spacings": (["--subsample", cell, "--mm-per-unit", "1"], ["-SS", "SPATIAL", cell]),
            "a tenth at random": (["--random", str(options.points // 10)],
                                  ["-SS", "RANDOM", str(options.points // 10)]),
            "normals, oriented": (["--normals", "estimate", "--force"],
                                  ["-OCTREE_NORMALS", cell, "-ORIENT", "PLUS_Z", "-ORIENT_NORMS_MST", "6"]),
        }
        print(f"{options.points} points, {os.cpu_count()} cores; median of {options.rounds}")
        for job, (own, peer) in jobs.items():
            times: list[tuple[float, ...]] = []
            for _ in range(options.rounds):
                for file in (ours, theirs):
                    file.unlink(missing_ok=True)
                first = timed([options.program, "convert", str(model), str(ours), *own, "--quiet"])
                second = timed(["CloudCompare", "-SILENT", "-AUTO_SAVE", "OFF", "-O", str(model), *peer,
                                "-C_EXPORT_FMT", "PLY", "-PLY_EXPORT_FMT", "BINARY_LE", "-SAVE_CLOUDS", "FILE",
                                str(theirs)])
                times.append(first + second)
            wall, cpu, their_wall, their_cpu = np.median(times, axis=0)
            left = (points_in(ours), points_in(theirs))
            print(f"{job:44} palpate {wall:6.2f} s ({cpu:6.2f})  CloudCompare {their_wall:6.2f} s ({their_cpu:6.2f})"
                  f"  left {left[0]}, {left[1]}")


if __name__ == "__main__":
    main()
