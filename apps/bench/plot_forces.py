#!/usr/bin/env python3
"""Plots the trace of a touch session: force and penetration over time.

usage: plot_forces.py TRACE.csv FORCES.png
"""
import csv
import os
import sys

from plot_page import plt, run, save


def main(trace, picture):
    with open(trace, newline="") as file:
        rows = list(csv.DictReader(file))
    if not rows:
        sys.exit(f"{trace}: no ticks to plot")
    column = lambda name: [float(row[name]) for row in rows]
    time = column("t_s")
    force = [column(f"force_{axis}") for axis in "xyz"]
    size = [sum(f * f for f in at) ** 0.5 for at in zip(*force)]

    figure, (top, bottom) = plt.subplots(2, 1, sharex=True, figsize=(10, 6), height_ratios=[2, 1],
                                         constrained_layout=True)
    for axis, values, colour in zip("xyz", force, ("#c44e52", "#55a868", "#4c72b0")):
        top.plot(time, values, color=colour, linewidth=1, label=f"force {axis}")
    top.plot(time, size, color="black", linewidth=1.8, label="magnitude")
    top.set_ylabel("force, N")
    top.legend(loc="upper left", frameon=False)
    top.grid(alpha=0.3)
    bottom.fill_between(time, column("penetration_mm"), color="#8172b2", alpha=0.5)
    bottom.set_ylabel("HIP behind\nproxy, mm")
    bottom.set_xlabel("time, s")
    bottom.grid(alpha=0.3)
    top.set_title(f"{os.path.basename(trace)}: {len(rows)} ticks, peak force {max(size):.2f} N")
    save(figure, picture)


if __name__ == "__main__":
    run(main, __doc__)
