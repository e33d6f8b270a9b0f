"""What does turbulence add to the pull of a tether on a flight of your own?

A kite flies a circle that is given by a function of the time, in a mean wind, and in the same wind with a box of turbulence
(TurbSim, Mann or numpy, as `docs/use/example_fmus.md`, "Turbulent wind"), which the mean wind carries past it.

    python examples/wind/own_flight.py

The tether has the wind of the box at 11 points on the straight line between its ends (`FrozenTurbulence.between`).
"""

import sys
from pathlib import Path

import numpy as np

from tetherfmu import FrozenTurbulence, MeanWind, MovingEnd, TetherDynamic, inputs_along, kite_at, open_box
from tetherfmu.console.ending import command
from tetherfmu.console.options import Parser, file
from tetherfmu.files.toml_files import WrongUse
from tetherfmu.wind.wind_boxes import WrongBox

BOX = Path(__file__).with_name("small_box.npz")
MEAN = MeanWind(8.0, reference_height=100.0, exponent=0.1)  # m/s along x
POINTS, STEP, COUNT = 11, 0.02, 2000  # of the wind, communication step [s], 40 s


def kite(time):
    """One turn in 20 s, 500 m away and downwind [m]."""
    angle = 2.0 * np.pi * time / 20.0
    return kite_at(elevation=0.5 + 0.1 * np.sin(angle), azimuth=0.2 * np.cos(angle), distance=500.0)


def fly(box=None):
    """`Flown` of the circle; box : of `open_box`, None for the mean wind alone."""
    inputs = inputs_along(COUNT, STEP, kite=MovingEnd(kite))
    times, positions = STEP * np.arange(COUNT), inputs[:, :3]
    wind = FrozenTurbulence(MEAN, box).between(times, (0.0, 0.0, 0.0), positions, POINTS)
    tether = TetherDynamic(initial_length=499.0, wind_points=POINTS, initial_shape="quasi_steady")
    tether.initialize(*MovingEnd(kite).at(0.0), wind_at=wind[0])
    return tether.fly(inputs, STEP, wind_at=wind)


@command
def main(arguments=None, prog=None):
    """Fly with and without turbulence, and print a line on each."""
    parser = Parser(prog=prog, description="fly a circle in a mean wind and in turbulent wind")
    about = "a box of TurbSim or numpy (default: a small one)"
    parser.add_argument("--box", type=file, default=BOX, metavar="FILE", help=about)
    given = parser.parse_args(arguments)
    try:
        flights = {"mean wind alone": fly(), "turbulent wind": fly(open_box(given.box))}
    except WrongBox as problem:
        raise WrongUse(str(problem)) from None
    for name, flown in flights.items():
        tension = flown.of("ground_tension")
        when = flown.time[tension.argmax()]
        print(f"{name}: mean pull at the ground {tension.mean():.0f} N, largest {tension.max():.0f} N after {when:.1f} s")


if __name__ == "__main__":
    sys.exit(main())
