"""The front of a dam that breaks, by PySPH's weakly compressible SPH in two dimensions.

Arguments: a folder for the files of PySPH, the width of the column in m, and seconds. The column is twice as high as
wide.
Prints lines "front TIME_S PLACE_M".
"""
import sys

import numpy as np
from pysph.base.kernels import WendlandQuintic
from pysph.base.utils import get_particle_array_wcsph
from pysph.solver.application import Application
from pysph.sph.scheme import WCSPHScheme

FOLDER, WIDTH, SECONDS = sys.argv[1], float(sys.argv[2]), float(sys.argv[3])
HEIGHT, TANK, SPACING, SMOOTHING = 2 * WIDTH, 6 * WIDTH, WIDTH / 20, 1.3
SOUND = 10 * np.sqrt(2 * 9.81 * HEIGHT)


def particles(name, x, y):
    return get_particle_array_wcsph(name=name, x=x, y=y, h=SMOOTHING * SPACING, m=1000 * SPACING**2, rho=1000.0)


class Dam(Application):
    def create_particles(self):
        x, y = np.mgrid[SPACING / 2:WIDTH:SPACING, SPACING / 2:HEIGHT:SPACING]
        water = particles("water", x.ravel(), y.ravel())
        beyond = 4 * SPACING
        x, y = np.mgrid[SPACING / 2 - beyond:TANK + beyond:SPACING, SPACING / 2 - beyond:2 * HEIGHT:SPACING]
        x, y = x.ravel(), y.ravel()
        wall = (x < 0) | (x > TANK) | (y < 0)
        walls = particles("walls", x[wall], y[wall])
        self.scheme.setup_properties([water, walls])
        return [water, walls]

    def create_scheme(self):
        return WCSPHScheme(["water"], ["walls"], dim=2, rho0=1000.0, c0=SOUND, h0=SMOOTHING * SPACING, hdx=SMOOTHING,
                           gy=-9.81, alpha=0.05, beta=0.0, gamma=7.0)

    def configure_scheme(self):
        self.scheme.configure_solver(kernel=WendlandQuintic(dim=2), dt=0.125 * SMOOTHING * SPACING / SOUND, tf=SECONDS,
                                     adaptive_timestep=False)

    def post_step(self, solver):
        if solver.count % 10 == 0:
            print("front", solver.t, self.particles[0].x.max() + SPACING / 2, flush=True)


Dam(fname="dam").run(["--disable-output", "--directory", FOLDER])
