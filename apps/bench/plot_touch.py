#!/usr/bin/env python3
"""Draws the result of `palpate bench touch` on one page, with a panel for each measured quantity.

usage: plot_touch.py RESULT.json PICTURE.png
"""
import json
import sys

from plot_page import plt, run, save

STYLES = ["-", "--", ":", "-."]


def colours(names):
    return {name: plt.get_cmap("tab10")(k % 10) for k, name in enumerate(dict.fromkeys(names))}


def label(judgement):
    return f"{judgement['subject']}, {judgement['surface']}, {judgement['backend']}"


class Page:
    """The judgements, and one colour for each shape and one line style for each surface."""

    def __init__(self, touch):
        self.touch = touch
        self.judgements = touch["judgements"]
        self.plain = [j for j in self.judgements if j["condition"] in ("clean", "scan")]
        self.colour = colours(j["subject"] for j in self.judgements)
        ways = dict.fromkeys((j["surface"], j["backend"]) for j in self.judgements)
        self.style = {way: STYLES[k % len(STYLES)] for k, way in enumerate(ways)}

    def look(self, judgement):
        way = (judgement["surface"], judgement["backend"])
        return {"color": self.colour[judgement["subject"]], "linestyle": self.style[way], "label": label(judgement)}

    def direction(self, axis):
        for judgement in self.plain:
            slides = judgement["slides"]
            axis.plot([s["speed_mm_per_s"] for s in slides], [s["M1_angle_deg"]["p95"] for s in slides], marker="o",
                      **self.look(judgement))
        axis.set(title="M1: force direction against speed", xlabel="mm/s", ylabel="degrees off, p95", xscale="log")
        axis.set_yscale("symlog", linthresh=0.01)
        axis.set_ylim(bottom=0)
        return self.plain

    def depth(self, axis):
        for judgement in self.plain:
            slides = judgement["slides"]
            axis.plot([s["speed_mm_per_s"] for s in slides], [100 * s["M3_force_relative_rms"] for s in slides],
                      marker="o", **self.look(judgement))
        axis.set(title="M3: force against true depth", xlabel="mm/s", ylabel="relative RMS, %", xscale="log")
        axis.set_yscale("symlog", linthresh=0.1)
        axis.set_ylim(bottom=0)
        return self.plain

    def noise(self, axis):
        lines = {}
        for judgement in self.judgements:
            name, estimated = judgement["condition"], judgement["condition"].endswith("estimated")
            if not name.startswith("noise-") and name not in ("clean", "estimated"):
                continue
            share = float(name.split("-")[1]) if name.startswith("noise-") else 0.0
            line = label(judgement) + (", estimated" if estimated else "")
            slide = min(judgement["slides"], key=lambda s: abs(s["speed_mm_per_s"] - 50))
            lines.setdefault(line, (judgement, []))[1].append((share, slide["M1_angle_deg"]["p95"]))
        lines = {name: line for name, line in lines.items() if len(line[1]) > 1}
        for name, (judgement, places) in lines.items():
            marker = "s" if name.endswith("estimated") else "o"
            axis.plot(*zip(*sorted(places)), marker=marker, **(self.look(judgement) | {"label": name}))
        axis.set(title="M1 against noise, 50 mm/s", xlabel="deviation, spacings (squares: normals estimated)",
                 ylabel="degrees off, p95")
        axis.set_yscale("symlog", linthresh=0.01)
        axis.set_ylim(bottom=0)
        return lines

    def slide(self, axis):
        drawn = [j for j in self.plain if j["slide_N"]["felt"]]
        for judgement in drawn:
            axis.plot(judgement["slide_N"]["felt"], linewidth=1, **self.look(judgement))
        if drawn:
            axis.plot(drawn[0]["slide_N"]["true"], color="black", linewidth=0.8, label="true, " + drawn[0]["subject"])
        axis.set(title="force along the first slide, 50 mm/s", xlabel="ms", ylabel="N")
        return drawn

    def plates(self, axis):
        lines = {}
        for plate in self.touch["M5_plates"]:
            name = f"{plate['surface']}, {plate['backend']}, {plate['speed_mm_per_s']:g} mm/s"
            lines.setdefault(name, []).append((plate["thickness_over_radius"], 100 * plate["through_share"]))
        for name, places in lines.items():
            axis.plot(*zip(*sorted(places)), marker="o", label=name)
        axis.set(title="M5: pushed through a plate of two sides", xlabel="thickness / R", ylabel="%", ylim=(-3, 103))
        return lines

    def stability(self, axis):
        lines = {}
        for entry in self.touch.get("M9_stability", []):
            name = f"{entry['surface']}, delay {entry['delay_ms']:g} ms, passivity {entry['passivity']}"
            lines.setdefault(name, []).append((entry["damping_N_s_per_mm"], entry["largest_stiffness_N_per_mm"]))
        for name, places in lines.items():
            axis.plot(*zip(*sorted(places)), marker="o", label=name)
        axis.set(title="M9: stable below the line", xlabel="damping, N s/mm", ylabel="stiffness, N/mm")
        return lines


def main(result, picture):
    with open(result) as file:
        data = json.load(file)
    page = Page(data["touch"])
    panels = (page.direction, page.depth, page.noise, page.slide, page.plates, page.stability)
    wanted = [panel for panel in panels if panel(plt.figure().subplots())]
    if not wanted:
        sys.exit(f"{result}: nothing was measured")
    columns = min(3, len(wanted))
    figure, axes = plt.subplots(-(-len(wanted) // columns), columns, figsize=(16, 12), squeeze=False,
                                constrained_layout=True)
    for axis in axes.flat[len(wanted):]:
        axis.set_axis_off()
    for axis, panel in zip(axes.flat, wanted):
        panel(axis)
        axis.grid(alpha=0.3, which="both")
        axis.legend(loc="upper center", bbox_to_anchor=(0.5, -0.13), frameon=False, fontsize=6.5, ncols=3)
    figure.suptitle("   ".join(f"{backend}: {machine}" for backend, machine in data["machines"].items()), fontsize=9)
    save(figure, picture)


if __name__ == "__main__":
    run(main, __doc__)
