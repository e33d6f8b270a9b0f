"""Write small boxes of wind with programs of others: `python tests/reference/make_wind_boxes.py [DIR]`.

It needs hipersim (DTU Wind Energy, MIT: a Mann box, 16 x 4 x 8 points, written as HAWC2 reads it, and what hipersim itself
interpolates in it) and PyConTurb (J. Rinker, DTU Wind Energy, MIT: a box in TurbSim's format, 12 x 3 x 5 points, and what
PyConTurb itself reads from it), no code of this project. PyConTurb 2.7.4 needs numpy before 2.4.
"""

import sys
from contextlib import suppress
from pathlib import Path

import numpy as np
from hipersim import MannTurbulenceField
from pyconturb import gen_spat_grid, gen_turb
from pyconturb.io import bts_to_df, df_to_bts

POINTS, SPACING = (16, 4, 8), (5.0, 10.0, 8.0)  # of the Mann box [m]
ACROSS, UPWARDS = [-20.0, 0.0, 20.0], [20.0, 35.0, 50.0, 65.0, 80.0]  # of the other one [m]
LASTS, STEP = 6.0, 0.5  # [s]


def write_mann(folder):
    """mann_u.turb, mann_v.turb, mann_w.turb; mann_between.csv: places in the box [m] and the wind there [m/s]."""
    field = MannTurbulenceField.generate(
        alphaepsilon=0.3, L=30.0, Gamma=3.2, Nxyz=POINTS, dxyz=SPACING, seed=7, double_xyz=(False, False, False)
    )
    with suppress(ImportError):  # after the files are written: an input file of HAWC2 needs another package
        field.to_hawc2(folder=str(folder), basename="mann_")
    places = np.random.default_rng(1).uniform(-1.0, 2.0, (60, 3)) * np.multiply(POINTS, SPACING)
    wind = field(*places.T)
    np.savetxt(folder / "mann_between.csv", np.hstack((places, wind)), "%.12g", ",", header="x,y,z,u,v,w", comments="")


def write_turbsim(folder):
    """pyconturb.bts; pyconturb.csv: time and u, v, w at each point as PyConTurb's reader has them.

    PyConTurb 2.7.4 writes the points of a plane upwards first and reads them across first, as TurbSim writes them; so its
    reader, not its writer, is the reference for their order.
    """
    grid = gen_spat_grid(ACROSS, UPWARDS)
    turbulence = gen_turb(grid, T=LASTS, nt=round(LASTS / STEP), u_ref=9.0, z_ref=50.0, alpha=0.2, seed=3)
    df_to_bts(turbulence, grid, str(folder / "pyconturb.bts"), uzhub=(9.0, 50.0))
    bts_to_df(str(folder / "pyconturb.bts")).to_csv(folder / "pyconturb.csv", float_format="%.9g", index_label="time")


if __name__ == "__main__":
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).parent)
    write_mann(folder)
    write_turbsim(folder)
