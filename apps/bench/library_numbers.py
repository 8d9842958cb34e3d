#!/usr/bin/env python3
"""Measures the numbers in the READMEs of the library and of the Python module, and prints their tables; --write
replaces those tables. Times are of one core (time of the process, `threads` 1), so that other programs do not count.

    PYTHONPATH=build/release/python python3 apps/bench/library_numbers.py [--write]
"""

from __future__ import annotations

import argparse
import datetime
import re
import resource
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

from nearest import ball

ROOT = Path(__file__).resolve().parents[2]
SIZES = (1_000_000, 20_000)
RADIUS = 50.0  # of the ball
QUERIES, TICKS = 2000, 3000


def per_call_us(work: Callable[[], Any], calls: int) -> float:
    times = []
    for _ in range(5):
        since = time.process_time()
        work()
        times.append((time.process_time() - since) / calls * 1e6)
    return float(np.median(times))


def searches(points: int) -> dict[str, float]:
    """us of a core for each question, of a ball of so many points."""
    rng = np.random.default_rng(7)
    out = rng.normal(size=(QUERIES, 3))
    out /= np.linalg.norm(out, axis=1)[:, None]
    with pp.Session(ball(points), gpu="cpu", threads=1, mm_per_unit=1) as s:
        since = time.process_time()
        s.nearest([[0.0, 0.0, RADIUS]])
        index_us = (time.process_time() - since) * 1e6
        near = out * (RADIUS + s.radius_mm * rng.uniform(-1, 1, (QUERIES, 1)))
        aside = np.cross(out, rng.normal(size=3))
        questions: dict[str, Callable[[], Any]] = {
            "a nearest position within a support radius": lambda: s.nearest(near),
            "one from two radii of the ball away": lambda: s.nearest(3 * RADIUS * out),
            "a nearest point within a support radius": lambda: s.nearest(near, surface=False),
            "a ray from outside to the middle": lambda: s.raycast(2 * RADIUS * out, -out),
            "a ray that misses": lambda: s.raycast(2 * RADIUS * out, aside),
        }
        found = {name: per_call_us(work, QUERIES) for name, work in questions.items()}
    return {"the index of the first question": index_us, **found}


def ticks(points: int) -> dict[str, float]:
    """us of a tick in contact, of a loop in Python."""
    with pp.Session(ball(points), gpu="cpu", threads=1, mm_per_unit=1) as s:
        times = []
        for k in range(TICKS):
            hip = [0.01 * np.sin(0.01 * k), 0.0, RADIUS + max(1 - 0.01 * k, -0.5)]
            since = time.perf_counter()
            s.touch_pose(1e-3 * k, hip)
            times.append((time.perf_counter() - since) * 1e6)
        return {"a tick, median": float(np.median(times)), "a tick, p99": float(np.percentile(times, 99))}


def core_ms(program: str) -> float:
    """ms of a core of an interpreter that runs a program."""
    times = []
    for _ in range(15):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run([sys.executable, "-c", program], check=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        times.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
    return 1e3 * float(np.median(times))


def stripped_bytes(files: list[Path]) -> int:
    total = 0
    with tempfile.TemporaryDirectory() as folder:
        for file in files:
            copy = Path(folder) / file.name
            shutil.copyfile(file, copy)
            if ".so" in file.name:
                subprocess.run(["strip", copy], check=True)
            total += copy.stat().st_size
    return total


def package() -> str:
    """The cost of the Python module before it does anything."""
    folder = Path(pp.__file__).parent
    library = next(Path(line.split()[-1]) for line in Path("/proc/self/maps").read_text().splitlines()
                   if "libpalpate.so" in line)
    rows = {
        "`import palpate`, of a core, beside the interpreter's": f"{core_ms('import palpate') - core_ms(''):.0f} ms",
        "the same of `import numpy`": f"{core_ms('import numpy') - core_ms(''):.0f} ms",
        "the package, stripped": f"{stripped_bytes([f for f in folder.iterdir() if f.is_file()]) / 1e3:.0f} kB",
        "the library, stripped": f"{stripped_bytes([library]) / 1e6:.1f} MB",
    }
    head = f"| the module, {datetime.date.today()} | |\n|---|---|"
    return "\n".join([head, *(f"| {name} | {value} |" for name, value in rows.items())])


def table(measure: Callable[[int], dict[str, float]]) -> str:
    columns = [measure(points) for points in SIZES]

    def shown(us: float) -> str:
        return f"{us:.1f} us" if us < 10 else f"{us:.0f} us" if us < 1000 else f"{us / 1000:.1f} ms"

    head = f"| us of a core, {datetime.date.today()} | " + " | ".join(f"{points:,} points" for points in SIZES) + " |"
    rows = [f"| {name} | " + " | ".join(shown(column[name]) for column in columns) + " |" for name in columns[0]]
    return "\n".join([head.replace("us of", "time of"), "|---|" + "---|" * len(SIZES), *rows])


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--write", action="store_true", help="into the READMEs")
    options = parser.parse_args()
    for file, begin, measure in (
        ("haptics/library/README.md", "time of a core", lambda: table(searches)),
        ("apps/python/README.md", "time of a core", lambda: table(ticks)),
        ("apps/python/README.md", "the module", package),
    ):
        measured = measure()
        print(f"{file}\n{measured}\n")
        if not options.write:
            continue
        readme = ROOT / file
        text, count = re.subn(rf"(?m)^\| {begin}, .*\n(\|.*\n)+", measured + "\n", readme.read_text())
        if count != 1:
            print(f"library_numbers.py: {file}: {count} tables begin with '{begin}'; 1 must", file=sys.stderr)
            return 1
        changed = readme.with_suffix(".md.new")
        changed.write_text(text)
        changed.replace(readme)
    return 0


if __name__ == "__main__":
    sys.exit(main())
