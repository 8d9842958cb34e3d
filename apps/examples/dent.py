# Reads a model, feels and dents it where it is nearest to its top, and saves it: dent.py MODEL OUT
import sys

import numpy as np
import palpate as pp

if len(sys.argv) != 3:
    sys.exit("usage: dent.py MODEL OUT")
cloud = pp.read(sys.argv[1])
with pp.Session(cloud, gpu="cpu") as session:
    low, high = np.array(cloud.bounds)
    found = session.nearest([(*(low + high)[:2] / 2, 2 * high[2] - low[2])])[0]
    depth_mm = np.linspace(-2, 3, 150)
    way = found["position"] - np.outer(depth_mm / session.mm_per_unit, found["normal"])
    felt = session.touch(way)
    session.push(way, radius_mm=8)
    pp.write(sys.argv[2], session.cloud())
print(f"{pp.__version__}: {np.linalg.norm(felt['force_N'], axis=1).max():.3f} N")
