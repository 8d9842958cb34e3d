"""Calls that mypy must refuse: exactly the lines marked `# wrong` (types.sh). It is not run."""

from __future__ import annotations

import numpy as np
import palpate as pp


def misspelt(cloud: pp.Cloud) -> None:
    path = np.zeros((10, 3))
    session = pp.Session(cloud, surface="sharp", tool="pad")
    session.stroke(path, "push", radius_mm=4, resample=False)
    session.set_brush(None)
    session.render(color="height", color_map="turbo")
    session.mesh(surface="density")
    session.live(builtin="press")
    pp.Session(cloud, surface="shrap")  # wrong
    pp.Session(cloud, tool="padd")  # wrong
    pp.Session(cloud, speed=2)  # wrong
    pp.Session.of_frames(cloud, stable_row=True)  # wrong
    pp.Session.of_scene("water", backend="gpu")  # wrong
    pp.Session.join("mine", timeout_s="3")  # wrong
    pp.Hand(builtin="pres")  # wrong
    session.touch(path, surface="sphree")  # wrong
    session.stroke(path, "psuh")  # wrong
    session.stroke(path, "push", raduis_mm=4)  # wrong
    session.stroke(path, "push", radius_mm="4")  # wrong
    session.set_brush("crave")  # wrong
    session.render(color="z", color_map="viridsi")  # wrong
    session.mesh(surface="densty")  # wrong
    session.live(builtin="slied")  # wrong
