"""How exactly a start in equilibrium is known: one line moved aside, and the same line as two with a knot without mass.

    python tests/benchmarks/shifted_starts.py

A slack line of 60 m, 12 segments, hangs in wind between two points that are 44 m apart. Moved aside by up to 30 m, it has
the same shape, but other rounding errors; halved by a free point without mass, it is the same line. Largest differences of
node positions.
"""

import numpy as np

from tetherfmu import Line, Point, Tether, TetherDynamic, TetherSystem
from tetherfmu.study.measuring.tables import circumstances

TOP, END, WIND = np.array((0.0, 0.0, 50.0)), np.array((30.0, 10.0, 20.0)), (8.0, 1.0, 0.0)
STIFFNESSES = (Tether().axial_stiffness, 1e4)  # [N]
SHIFTS = 40


def shape(stiffness, shift):
    """Node positions of the line [m] where its ends are moved by `shift` [m], moved back."""
    single = TetherDynamic(Tether(segments=12, initial_length=60.0, axial_stiffness=stiffness))
    single.initialize(ground_position=TOP + shift, kite_position=END + shift, wind_velocity=WIND)
    return single.positions - shift


def halved(stiffness):
    """Node positions of the line [m] as two lines at a free point without mass, which is found."""
    half = Tether(segments=6, initial_length=30.0, axial_stiffness=stiffness)
    lines = [Line("a", "top", "knot", half), Line("b", "knot", "end", half)]
    system = TetherSystem([Point("top", TOP), Point("knot", mass=0.0), Point("end", END)], lines)
    system.initialize(WIND)
    return np.concatenate([system.positions["a"], system.positions["b"][1:]])


def main():
    """Print the table."""
    rng = np.random.default_rng(0)
    print("| axial stiffness N | the line moved aside differs by m | as two lines m |\n|---|---|---|")
    for stiffness in STIFFNESSES:
        still = shape(stiffness, np.zeros(3))
        moved = max(np.abs(shape(stiffness, (*rng.uniform(-30.0, 30.0, 2), 0.0)) - still).max() for _ in range(SHIFTS))
        print(f"| {stiffness:g} | {moved:.1g} | {np.abs(halved(stiffness) - still).max():.1g} |")
    print(circumstances())


if __name__ == "__main__":
    main()
