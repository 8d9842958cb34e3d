#!/usr/bin/env python3
"""Whole jobs from file to file beside the command lines of other programs, in turns: seconds, of the clock and of all
cores.

    xvfb-run -a python3 apps/bench/jobs.py build/release/palpate [--points 1000000] [--rounds 3]
                                                                [--splat-transform PROGRAM]

A job reads a binary PLY file, does one thing, and writes another one. The others are CloudCompare and MeshLab (Debian's
packages cloudcompare and meshlab; the latter needs a display), and for splat scenes splat-transform (the package
@playcanvas/splat-transform of npm, by the authors of SuperSplat). All are given the same points and parameters; `left`
are the points of their results, which differ where a method does (which point of a cell stays, on which side of a limit
a point counts, what an outlier is). A program that is not there is left out, and named.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import shutil
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


def script(file: Path, *filters: tuple[str, ...]) -> str:
    """A MeshLab script; each filter is a name and the attributes of all its parameters."""
    lines = ["<!DOCTYPE FilterScript>", "<FilterScript>"]
    for name, *parameters in filters:
        lines += [f'<filter name="{name}">', *(f"<Param {each}/>" for each in parameters), "</filter>"]
    file.write_text("\n".join([*lines, "</FilterScript>"]))
    return str(file)


def write_splats(file: Path, count: int) -> None:
    """Gaussians in a cube of 2000 units, with all harmonics of degree three."""
    names = ["x", "y", "z", "nx", "ny", "nz", *(f"f_dc_{k}" for k in range(3)), *(f"f_rest_{k}" for k in range(45)),
             "opacity", *(f"scale_{k}" for k in range(3)), *(f"rot_{k}" for k in range(4))]
    values = np.random.default_rng(1).standard_normal((count, len(names))).astype("<f4")
    values[:, :3] = np.random.default_rng(2).uniform(-1000, 1000, (count, 3))
    header = ["ply", "format binary_little_endian 1.0", f"element vertex {count}",
              *(f"property float {name}" for name in names), "end_header"]
    file.write_bytes("\n".join(header).encode() + b"\n" + values.tobytes())


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--points", type=int, default=1_000_000)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--splat-transform", default="splat-transform")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        model, splats, ours, theirs = (folder / f"{file}.ply" for file in ("model", "splats", "ours", "theirs"))
        subprocess.run([options.program, "make", "sculpture", "-n", str(options.points), "-o", str(model), "--quiet"],
                       check=True)
        write_splats(splats, options.points // 4)
        read = [options.program, "info", str(model), "--json", str(folder / "info.json"), "--quiet"]
        subprocess.run(read, check=True, stdout=subprocess.DEVNULL)
        spacing = json.loads((folder / "info.json").read_text())["mean_spacing"]
        cell, tenth = f"{4 * spacing:.6f}", str(options.points // 10)
        box = "-1000,-1000,0:1000,1000,1000"

        def cloud_compare(*words: str) -> list[str]:
            return ["CloudCompare", "-SILENT", "-AUTO_SAVE", "OFF", "-O", str(model), *words, "-C_EXPORT_FMT", "PLY",
                    "-PLY_EXPORT_FMT", "BINARY_LE", "-SAVE_CLOUDS", "FILE", str(theirs)]

        def meshlab(*filters: tuple[str, ...]) -> list[str]:
            steps = script(folder / f"{len(list(folder.glob('*.mlx')))}.mlx", *filters)
            return ["meshlabserver", "-i", str(model), "-o", str(theirs), "-m", "vn", "vc", "-s", steps]

        remove = ("Delete Selected Vertices",)
        below = ("Conditional Vertex Selection", 'type="RichString" name="condSelect" value="z &lt; 0"')
        outliers = ("Select Outliers", 'type="RichDynamicFloat" name="PropThreshold" value="0.8" min="0" max="1"',
                    'type="RichInt" name="KNearest" value="8"')
        cells = ("Clustered Vertex Sampling", f'type="RichAbsPerc" name="Threshold" value="{cell}" min="0" max="2000"',
                 'type="RichEnum" name="Sampling" value="1" enum_val0="Average" enum_val1="Closest" '
                 'enum_cardinality="2"', 'type="RichBool" name="Selected" value="false"')
        normals = ("Compute normals for point sets", 'type="RichInt" name="K" value="16"',
                   'type="RichInt" name="smoothIter" value="0"', 'type="RichBool" name="flipFlag" value="false"',
                   'type="RichPoint3f" name="viewPos" x="0" y="0" z="0"')
        jobs = {
            "crop to a box": (model, ["--crop", box],
                              [cloud_compare("-CROP", "-1000:-1000:0:1000:1000:1000"),
                               meshlab(below, remove)]),
            "statistical outliers, 8 neighbours, 1 sigma": (
                model, ["--outliers"], [cloud_compare("-SOR", "8", "1.0"), meshlab(outliers, remove)]),
            "subsample to 4 spacings": (model, ["--subsample", cell, "--mm-per-unit", "1"],
                                        [cloud_compare("-SS", "SPATIAL", cell), meshlab(cells)]),
            "a tenth at random": (model, ["--random", tenth], [cloud_compare("-SS", "RANDOM", tenth)]),
            "normals, oriented": (
                model, ["--normals", "estimate", "--force"],
                [cloud_compare("-OCTREE_NORMALS", cell, "-ORIENT", "PLUS_Z", "-ORIENT_NORMS_MST", "6"),
                 meshlab(normals)]),
            "splats: cut to a box": (
                splats, ["--crop", box],
                [[options.splat_transform, "-w", str(splats), "-B", "-1000,-1000,0,1000,1000,1000", str(theirs)]]),
        }
        print(f"{options.points} points, {options.points // 4} splats, {os.cpu_count()} cores; "
              f"median of {options.rounds}")
        for job, (read_from, own, peers) in jobs.items():
            times: dict[str, list[tuple[float, float]]] = {}
            left: dict[str, int] = {}
            for _ in range(options.rounds):
                for command in [[options.program, "convert", str(read_from), str(ours), *own, "--quiet"], *peers]:
                    program = Path(command[0]).name
                    ours.unlink(missing_ok=True)
                    theirs.unlink(missing_ok=True)
                    if not shutil.which(command[0]):
                        left[program] = -1
                        continue
                    times.setdefault(program, []).append(timed(command))
                    left[program] = points_in(ours if command[0] == options.program else theirs)
            print(job)
            for program, count in left.items():
                if count < 0:
                    print(f"  {program:16} is not installed")
                    continue
                wall, cpu = np.median(times[program], axis=0)
                print(f"  {program:16} {wall:6.2f} s ({cpu:6.2f})  left {count}")


if __name__ == "__main__":
    main()
