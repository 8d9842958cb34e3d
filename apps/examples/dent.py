# Reads a model, feels and dents it, and saves it: dent.py MODEL OUT
import sys

import numpy as np
import palpate as pp

cloud = pp.read(sys.argv[1])
with pp.Session(cloud, gpu="cpu") as session:
    low, high = cloud.bounds
    x, y = (low[0] + high[0]) / 2, (low[1] + high[1]) / 2
    depth = np.linspace(high[2] + 0.5, high[2] - 4, 150)
    way = np.column_stack([np.full(150, x), np.full(150, y), depth])
    felt = session.touch(way)
    session.push(way, radius_mm=8)
    pp.write(sys.argv[2], session.cloud())
print(f"{pp.__version__}: {np.linalg.norm(felt['force_N'], axis=1).max():.3f} N")
