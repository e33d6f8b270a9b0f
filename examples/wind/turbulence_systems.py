"""Which FMUs make a circle and a parked kite in turbulence, how are they wired, how do they start? For the SSP files.

The wind FMU gets the points of the tether and gives the wind there back (`wind_at`); the kite has the wind at its place. So
the points are those of the end of the step before, and the wind is that of then: a loop over one communication step, which
is far shorter than what the box resolves (8 m/s carry it 0.16 m in 20 ms).

Variables of the same name belong together, but for those in `RENAMED`. The box is small, so that the file is: one from
TurbSim or a Mann generator takes its place through the parameter `file` of the wind.
"""

from io import BytesIO
from math import cos, radians, sin

import numpy as np

from wind.box_of_turbulence import velocity

POINTS = 21  # of the tether: those of TurbulentWind
BOX = "resources/box.npz"  # in the FMU of the wind
GRID, SPACING, DEVIATION, LENGTH = (96, 24, 48), (10.0, 10.0, 10.0), 1.2, 40.0  # points, [m], [m/s], scale of eddies [m]
DISTANCE, ELEVATION = 300.0, radians(68.0)  # of the parked kite [m], [rad]
AIR = {"file": BOX, "mean_speed": 8.0, "wind_reference_height": 10.0, "wind_exponent": 0.14, "wind_points": 2}
CIRCLE = {"wind": "TurbulentWind", "kite": "KiteOnPath", "tether": "TetherDynamic"}  # instance: FMU
CIRCLE_START = AIR | {
    "distance": DISTANCE,
    "elevation": radians(30.0),
    "azimuth": 0.0,
    "half_width": radians(15.0),
    "rate": 0.3,
    "initial_length": 0.997 * DISTANCE,
    "initial_shape": 2,
}
PARKED = {"wind": "TurbulentWind", "tether": "TetherDynamicFree", "kite": "PointMassKite", "controller": "FlightController"}
PARKED_START = AIR | {
    "initial_length": 0.999 * DISTANCE,
    "kite_mass": 19.6,
    "initial_kite_position[1]": DISTANCE * cos(ELEVATION),
    "initial_kite_position[3]": DISTANCE * sin(ELEVATION),
    "elevation": ELEVATION,  # of a figure of eight that is hardly more than a point
    "half_width": radians(2.0),
    "half_height": radians(1.0),
    "longest_length": 1e5,  # it never reels in
}
PARKED_START |= {
    name.removeprefix("initial_"): value for name, value in PARKED_START.items() if name.startswith("initial_kite_")
}
RENAMED = {"kite.wind_velocity": "kite_wind", "tether.wind_velocity": ""}  # input of an instance: output that it gets


def box():
    """The box of turbulence, bytes of an .npz file."""
    file = BytesIO()
    np.savez(file, velocity=velocity(DEVIATION, points=GRID, spacing=SPACING, length=LENGTH), spacing=SPACING)
    return file.getvalue()
