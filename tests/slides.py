#!/usr/bin/env python3
"""Slides and presses over scans: how often the force changes by more than its law allows, and how often a pressing
hand loses the surface.

slides.py PROGRAM [PROGRAM...] [--models FOLDER] [--count N] [--backend NAME] [--seed N] [--beside "OPTIONS"]

Hands 3 mm deep, in virtual time: slides straight along the tangent at 20 mm/s, and presses that hold. The places are
chosen at random and judged by the points around them: thin (the other side is within 4 mm), hollow, edge or flat.
Prints a line per program and kind of place:
  jumps      tracks with a tick that changes the force by more than 60 N/s and the hand's motion
  knocks     tracks in which that exceeds the hand's motion by more than 0.3 N
  fall       the largest change in a tick beyond the hand's motion, N
  lost       tracks in which contact ends in a tick although the hand is more than 0.3 mm deep below the surface there,
             as where the surface ends, or where the hand comes out on the other side of a thin part
  turned     tracks in which the normal of a contact turns by more than a right angle in a tick
"""

import argparse
import collections
import csv
import math
import random
import struct
import subprocess
import sys
import tempfile
from pathlib import Path

MODELS = ["horse_48485", "armadillo_43243", "bunny_34834", "dragon_res3", "lion_takanawa_341989", "wild/vtkdata__shark",
          "armadillo_1037774", "dragon_437645"]
STIFFNESS, DAMPING = 0.8, 0.002  # N/mm, N s/mm; the defaults
SURFACE_N = 0.06  # in a tick of 1 ms
DEEP, CLEAR, WAY, SPEED = 3.0, 8.0, 10.0, 20.0  # mm, mm/s
COUNTED = ["jumps", "knocks", "lost", "turned"]
KINDS = ["thin", "hollow", "edge", "flat"]


def sub(a, b):
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def along(a, s, b):
    return (a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2])


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def unit(a):
    size = math.sqrt(dot(a, a))
    return (a[0] / size, a[1] / size, a[2] / size) if size > 0 else (0.0, 0.0, 0.0)


def read_ply(file):
    """Positions and normals; without normals in the file, those of its faces."""
    data = file.read_bytes()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    header = data[:end].decode("ascii", "replace").split("\n")
    count = next(int(line.split()[2]) for line in header if line.startswith("element vertex"))
    vertex = header[next(i for i, line in enumerate(header) if line.startswith("element vertex")) + 1:]
    names = []
    for line in vertex:
        if not line.startswith("property"):
            break
        names.append((line.split()[2], line.split()[1]))
    if "format ascii 1.0" in header:
        lines = data[end:].decode().split("\n")
        points = [tuple(map(float, lines[i].split()[:3])) for i in range(count)]
        normals = [(0.0, 0.0, 0.0)] * count
        for line in lines[count:]:
            face = [int(word) for word in line.split()[1:]]
            for i in range(1, len(face) - 1):
                a, b, c = face[0], face[i], face[i + 1]
                area = cross(sub(points[b], points[a]), sub(points[c], points[a]))
                for corner in (a, b, c):
                    normals[corner] = along(normals[corner], 1, area)
        return points, [unit(normal) for normal in normals]
    code = {"float": "f", "float32": "f", "double": "d", "uchar": "B", "int": "i", "uint": "I"}
    row = struct.Struct("<" + "".join(code[kind] for _, kind in names))
    at = {name: i for i, (name, _) in enumerate(names)}
    points, normals = [], []
    for values in row.iter_unpack(data[end:end + count * row.size]):
        points.append(tuple(values[at[key]] for key in ("x", "y", "z")))
        normals.append(tuple(values[at[key]] for key in ("nx", "ny", "nz")))
    return points, normals


class Cloud:
    def __init__(self, file):
        points, self.normals = read_ply(file)
        self.low = [min(p[axis] for p in points) for axis in range(3)]
        self.high = [max(p[axis] for p in points) for axis in range(3)]
        self.scale = 100 / max(high - low for high, low in zip(self.high, self.low))  # as palpate's, mm per unit
        self.points = [tuple(self.scale * value for value in p) for p in points]
        self.cells = collections.defaultdict(list)
        for i, p in enumerate(self.points):
            self.cells[self.cell(p)].append(i)

    @staticmethod
    def cell(p):
        return (math.floor(p[0] / 2), math.floor(p[1] / 2), math.floor(p[2] / 2))

    def near(self, p, reach):
        low, high = self.cell(along(p, -reach, (1, 1, 1))), self.cell(along(p, reach, (1, 1, 1)))
        for x in range(low[0], high[0] + 1):
            for y in range(low[1], high[1] + 1):
                for z in range(low[2], high[2] + 1):
                    for i in self.cells.get((x, y, z), ()):
                        way = sub(self.points[i], p)
                        if dot(way, way) < reach * reach:
                            yield i, way

    def kind(self, p, n):
        reach, bend, count = 4.0, 0.0, 0
        for i, way in self.near(p, reach):
            facing = dot(self.normals[i], n)
            depth = -dot(way, n)
            aside = math.sqrt(max(0.0, dot(way, way) - depth * depth))
            if facing < -0.3 and 0 < depth < 4 and aside < 1:
                return "thin"
            if facing > -0.2:
                bend += dot(way, n) / reach
                count += 1
        bend /= max(count, 1)
        return "hollow" if bend > 0.08 else "edge" if bend < -0.12 else "flat"

    def is_free(self, p, n):
        """Whether the way out along the normal is free."""
        steps = (1, 2, 3, 4.5, 6, 7, CLEAR)
        return all(next(self.near(along(p, s, n), min(1.5, 0.7 * s)), None) is None for s in steps)


def places(cloud, count, rng):
    """Positions, normals and tangents, as many of each kind as there are."""
    chosen = {kind: [] for kind in KINDS}
    for _ in range(4000):
        if all(len(each) >= (count + 3) // 4 for each in chosen.values()):
            break
        i = rng.randrange(len(cloud.points))
        p, n = cloud.points[i], unit(cloud.normals[i])
        if n == (0, 0, 0):
            continue
        kind = cloud.kind(p, n)
        if len(chosen[kind]) >= (count + 3) // 4 or not cloud.is_free(p, n):
            continue
        angle = rng.uniform(0, 2 * math.pi)
        u = unit(cross(n, (1, 0, 0) if abs(n[0]) < 0.7 else (0, 1, 0)))
        v = cross(n, u)
        chosen[kind].append((kind, p, n, along(tuple(math.cos(angle) * c for c in u), math.sin(angle), v)))
    return [each for kind in KINDS for each in chosen[kind]]


def path_over(cloud, where):
    """Keys in mm, and for each place the times between which the hand is pressed in."""
    keys, spans, t = [], [], 0.0
    away = tuple(cloud.scale * high + 100 for high in cloud.high)
    for number, (_, p, n, tangent) in enumerate(where):
        keys += [(t, away), (t + 0.1, away)]
        t += 0.1 + 0.001  # farther in a tick than a path is traced
        out, deep = along(p, CLEAR, n), along(p, -DEEP, n)
        pressed = t + 0.06 + (CLEAR + DEEP) / 60
        keys += [(t, out), (t + 0.06, out), (pressed, deep), (pressed + 0.05, deep)]
        left = pressed + 0.05 + (WAY / SPEED if number % 4 else 0.3)
        there = along(deep, WAY if number % 4 else 0, tangent)
        keys.append((left, there))
        spans.append((t + 0.015, left))
        back = left + 0.2
        keys.append((back, along(there, CLEAR + DEEP, n)))
        t = back + 0.001
    return keys, spans


def played(program, file, cloud, keys, args):
    with tempfile.TemporaryDirectory() as folder:
        path, trace = Path(folder) / "path.csv", Path(folder) / "trace.csv"
        with open(path, "w") as out:
            print("t_s,x,y,z", file=out)
            for t, p in keys:
                print(f"{t:.3f}," + ",".join(repr(value / cloud.scale) for value in p), file=out)
        subprocess.run([program, "touch", file, "--path", path, "--trace", trace, "--backend", args.backend,
                        *args.beside.split()], check=True, stdout=subprocess.DEVNULL)
        with open(trace) as rows:
            next(rows)
            return [tuple(map(float, row)) for row in csv.reader(rows)]


def judged(rows, cloud, span):
    result = {"jumps": 0, "knocks": 0, "fall": 0.0, "lost": 0, "turned": 0}
    first, last = (round(1000 * t) for t in span)
    # The hand may have been put on another surface on its way to the place.
    first = next((i for i in range(first, last) if not rows[i][14] and not any(rows[i][10:13])), last)
    for i in range(first + 2, last):
        row, before, earlier = rows[i], rows[i - 1], rows[i - 2]
        scaled = [tuple(cloud.scale * value for value in each[1:4]) for each in (row, before, earlier)]
        way, way_before = sub(scaled[0], scaled[1]), sub(scaled[1], scaled[2])
        turn = sub(way, way_before)
        if not earlier[14]:
            turn = way  # the damper begins with the second tick of a contact
        hand = STIFFNESS * math.sqrt(dot(way, way)) + DAMPING * 1000 * math.sqrt(dot(turn, turn))
        change = sub(row[10:13], before[10:13])
        fall = math.sqrt(dot(change, change)) - hand
        result["fall"] = max(result["fall"], fall)
        result["knocks"] |= fall > 0.3
        result["jumps"] |= fall > SURFACE_N + 1e-4
        deep = cloud.scale * dot(sub(before[4:7], row[1:4]), before[7:10])
        result["lost"] |= bool(before[14]) and not row[14] and deep > 0.3
        result["turned"] |= bool(before[14]) and bool(row[14]) and dot(row[7:10], before[7:10]) < 0
    return result


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("programs", nargs="+")
    parser.add_argument("--models", type=Path, default=Path(__file__).resolve().parents[2] / "shared" / "models")
    parser.add_argument("--count", type=int, default=200, help="slides and presses, over all models")
    parser.add_argument("--backend", default="cpu")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--beside", default="", metavar="OPTIONS", help="more options of touch, as '--edit push'")
    parser.add_argument("--only", nargs="+", metavar="NAME", help="these models of the folder")
    parser.add_argument("--list", action="store_true", help="name each track with a fault")
    args = parser.parse_args()
    if not args.models.is_dir():
        sys.exit(f"{args.models}: no such folder; name that of the models with --models")
    names = args.only or MODELS
    totals = {program: {kind: collections.Counter() for kind in KINDS} for program in args.programs}
    falls = collections.defaultdict(float)
    for name in names:
        file = args.models / f"{name}.ply"
        cloud = Cloud(file)
        where = places(cloud, args.count // len(names), random.Random(f"{args.seed} {name}"))
        if not where:
            print(f"{name}: no place that a hand reaches along the normal")
            continue
        keys, spans = path_over(cloud, where)
        for program in args.programs:
            rows = played(program, file, cloud, keys, args)
            for number, ((kind, p, _, _), span) in enumerate(zip(where, spans)):
                result = judged(rows, cloud, span)
                totals[program][kind].update({"tracks": 1, **{key: result[key] for key in COUNTED}})
                falls[program, kind] = max(falls[program, kind], result["fall"])
                if args.list and any(result[key] for key in COUNTED):
                    how = "slide" if number % 4 else "press"
                    print(f"{program} {name} {number} {kind} {how} from {span[0]:.3f} s: {result}")
    for program in args.programs:
        print(f"{program}, {args.backend}")
        print(f"  {'place':8} {'tracks':>6} " + " ".join(f"{key:>6}" for key in COUNTED) + f" {'fall, N':>8}")
        for name, kinds in [*((kind, [kind]) for kind in KINDS), ("all", KINDS)]:
            total = sum((totals[program][kind] for kind in kinds), collections.Counter())
            print(f"  {name:8} {total['tracks']:6} " + " ".join(f"{total[key]:6}" for key in COUNTED) +
                  f" {max(falls[program, kind] for kind in kinds):8.3f}")


if __name__ == "__main__":
    main()
