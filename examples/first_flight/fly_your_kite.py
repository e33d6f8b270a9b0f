"""How does a kite of your own fly on a tether? The shortest closed loop: a kite in Python, a tether FMU.

    python examples/first_flight/fly_your_kite.py

The FMU moves the kite, a point mass at the end of its tether: it gets the load on the kite and gives its motion. The load is
lift and drag in the wind, with round numbers of a soft kite for the coefficients; put in your own. The kite rises until its
tether points where lift, drag and weight together point, atan((lift - weight)/drag) above the horizon, and a little less for
the weight of the tether.
"""

import sys
from pathlib import Path

import numpy as np

from tetherfmu.console.ending import command
from tetherfmu.console.options import Parser

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # the folder of the rooms
from shared.fmu_tools import add_fmu, find_fmu, running, variables_of

STEP, COUNT = 0.02, 3000  # communication step [s], one minute
WIND, MASS, AREA, LIFT, DRAG = np.array([8.0, 0.0, 0.0]), 10.0, 10.0, 0.7, 0.15  # m/s, kg, m2, coefficients
START = {"kite_mass": MASS, "initial_length": 200.0, "initial_kite_position[1]": 160.0, "initial_kite_position[3]": 120.0}


def load(position, velocity):
    """Lift and drag of the kite [N]: drag along the apparent wind, lift across it, away from the ground station."""
    wind = WIND - velocity
    across = position - (position @ wind) / (wind @ wind) * wind
    lift = LIFT * np.linalg.norm(wind) * across / np.linalg.norm(across)
    return 0.5 * 1.225 * AREA * np.linalg.norm(wind) * (DRAG * wind + lift)


def fly(fmu_file):
    """Fly; array with a row of time [s], position [m], velocity [m/s] and tension [N] for each communication step."""
    variables, rows = variables_of(fmu_file, free=True), []
    loads, motion = variables.of("kite_load"), variables.of("kite_position", "kite_velocity")
    found = motion + variables.of("kite_tension")
    with running(fmu_file, variables.description) as (fmu, stop_if_pressed):
        fmu.setupExperiment(startTime=0.0)
        fmu.setReal([variables.reference[name] for name in START], START.values())
        fmu.enterInitializationMode()
        fmu.setReal(variables.of("wind_velocity"), WIND)
        fmu.exitInitializationMode()
        for k in range(COUNT):
            x, v = np.split(np.array(fmu.getReal(motion)), 2)  # 1. Where the kite is, and how fast, at the start of a step.
            fmu.setReal(loads, load(x, v))  # 2. The load on it.
            fmu.doStep(k * STEP, STEP)  # 3. The tether moves it to the end of the step.
            rows.append([(k + 1) * STEP, *fmu.getReal(found)])
            stop_if_pressed()
    return np.array(rows)


@command
def main(arguments=None):
    """Print where the kite is and how hard it pulls, every ten seconds."""
    parser = Parser(description="Fly a kite of your own in a closed loop.")
    add_fmu(parser, "dist/TetherDynamicFree.fmu")
    given = parser.parse_args(arguments)
    for time, x, y, z, *_, tension in fly(given.fmu or find_fmu("TetherDynamicFree"))[499::500]:
        elevation = np.degrees(np.arctan2(z, np.hypot(x, y)))
        print(f"{time:3.0f} s: {elevation:4.1f} deg above the horizon, pulls with {tension:3.0f} N")


if __name__ == "__main__":
    sys.exit(main())
