#!/usr/bin/env python3
"""Plots the result of `palpate bench edit`: an edited step against points in the model, and against touched points.

usage: plot_edit.py RESULT.json PICTURE.png
"""
import json
import sys

from plot_page import plt, run, save

STYLES = {"incremental": ("o", "-"), "rebuild": ("s", "--")}


def lines(costs, along, of):
    """The costs of each (value of `of`, index), sorted by `along`."""
    groups = {}
    for cost in costs:
        groups.setdefault((of(cost), cost["index"]), []).append(cost)
    return {key: sorted(group, key=along) for key, group in sorted(groups.items())}


def draw(axis, costs, along, of, label):
    keys = list(dict.fromkeys(key for key, _ in lines(costs, along, of)))
    for (key, index), line in lines(costs, along, of).items():
        marker, style = STYLES[index]
        colour = plt.get_cmap("viridis")(0.85 * keys.index(key) / max(1, len(keys) - 1))
        places = [along(cost) for cost in line]
        axis.plot(places, [cost["step_us"]["p50"] for cost in line], marker=marker, linestyle=style, color=colour,
                  label=f"{label(key)}, {index}")
        # An update that exceeds the lists ends in a full build.
        built = [cost for cost in line if index == "incremental" and cost["index_rebuilds"] > 0]
        axis.plot([along(cost) for cost in built], [cost["step_us"]["p50"] for cost in built], linestyle="none",
                  marker="o", markersize=12, markerfacecolor="none", color=colour)
    axis.set(xscale="log", yscale="log", ylabel="us, median, pose to force with the edit")
    axis.grid(alpha=0.3, which="both")
    axis.legend(loc="upper center", bbox_to_anchor=(0.5, -0.13), frameon=False, fontsize=7, ncols=3)


def main(result, picture):
    with open(result) as file:
        data = json.load(file)
    costs = data["edit"]["costs"]
    if not costs:
        sys.exit(f"{result}: nothing was measured")
    figure, (left, right) = plt.subplots(1, 2, figsize=(13, 5), sharey=True, constrained_layout=True)
    draw(left, costs, lambda cost: cost["points"], lambda cost: cost["asked"], lambda asked: f"{asked:,} touched")
    left.set(title="edited step against the size of the model", xlabel="points of the model")
    draw(right, costs, lambda cost: cost["touched"]["p50"], lambda cost: cost["points"],
         lambda points: f"{points:,} points")
    right.set(title="edited step against the size of the edit; a ring: needed full builds", xlabel="points touched")
    figure.suptitle(f"brush: {costs[0]['brush']}   "
                    + "   ".join(f"{backend}: {machine}" for backend, machine in data["machines"].items()), fontsize=9)
    save(figure, picture, dpi=80)


if __name__ == "__main__":
    run(main, __doc__)
