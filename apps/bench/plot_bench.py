#!/usr/bin/env python3
"""Plots a bench's result: time against points, one line for each method.

usage: plot_bench.py RESULT.json PICTURE.png
"""
import json
import sys

from plot_page import plt, run, save

MARKERS = {"vulkan": "o", "cuda": "s", "cpu": "^"}


def main(result, picture):
    with open(result) as file:
        data = json.load(file)
    panels = {}  # (bench, input) -> (backend, way) -> [(points, median, p99.9)]
    for record in data["records"]:
        time = record["wall_us"] or record["gpu_us"]
        if not time:
            continue
        lines = panels.setdefault((record["bench"], record["input"]), {})
        lines.setdefault((record["backend"], record["way"]), []).append((record["points"], time["p50"], time["p999"]))
    if not panels:
        sys.exit(f"{result}: nothing was measured")
    columns = min(2, len(panels))
    rows = -(-len(panels) // columns)
    figure, axes = plt.subplots(rows, columns, figsize=(7.5 * columns, 5 * rows), squeeze=False,
                                constrained_layout=True)
    for axis in axes.flat[len(panels):]:
        axis.set_axis_off()
    for axis, ((bench, what), lines) in zip(axes.flat, panels.items()):
        for number, ((backend, way), line) in enumerate(lines.items()):
            points, median, tail = zip(*sorted(line))
            colour = plt.get_cmap("tab20")(number % 20)
            axis.plot(points, median, marker=MARKERS.get(backend, "x"), color=colour, label=f"{backend} {way}")
            axis.fill_between(points, median, tail, color=colour, alpha=0.12)
        axis.set(title=f"{bench}, {what}", xlabel="points", ylabel="us, median; shade to p99.9", xscale="log",
                 yscale="log")
        axis.grid(alpha=0.3, which="both")
        axis.legend(frameon=False, fontsize=8)
    figure.suptitle("   ".join(f"{backend}: {machine}" for backend, machine in data["machines"].items()), fontsize=9)
    save(figure, picture)


if __name__ == "__main__":
    run(main, __doc__)
