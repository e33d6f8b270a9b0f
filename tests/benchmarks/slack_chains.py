"""What a slack tether of many segments remembers: its sensitivity, and what a tolerance leaves.

    python tests/benchmarks/slack_chains.py [--segments N ...]

The evidence sets of the winch by length and by force (`export/evidence.py`), flown at 1e-10, and again with the inner
nodes starting 1e-10 m elsewhere (normal distribution): how many times as far they are apart, at most. Then flights at 1e-6
and 1e-8 against that at 1e-10: largest error of a position, and of `kite_tension`, largest and median of
a flight, over its largest value.
"""

import warnings

import numpy as np
from as_script import options

from tetherfmu import Tether, TetherDynamic
from tetherfmu.export import evidence

FINEST, MOVED = 1e-10, 1e-10  # tolerance, [m]


def flight(kind, segments, tolerance, moved=0.0):
    """Node positions [m] and `kite_tension` [N] at each communication point."""
    tether = Tether(segments=segments)
    given = evidence.winch_set(kind, TetherDynamic, tether)
    flown = given.model(tolerance)
    rows = [flown.initialize(**given.scene[0])]
    if moved:
        x = flown.positions.copy()
        x[1:-1] += moved * np.random.default_rng(1).normal(size=(segments - 1, 3))
        rows = [flown.initialize(positions=x, velocities=np.zeros_like(x), **given.scene[0])]
    positions = [flown.positions.copy()]
    for inputs in given.scene[:-1]:
        rows.append(flown.step(evidence.STEP, **inputs))
        positions.append(flown.positions.copy())
    return np.array(positions), np.array([row.kite_tension for row in rows])


def main():
    warnings.simplefilter("ignore")
    for segments in options(__doc__, segments=[20, 60, 120, 300]).segments:
        for kind in evidence.GIVEN:
            x, tension = flight(kind, segments, FINEST)
            elsewhere, _ = flight(kind, segments, FINEST, MOVED)
            print(f"{segments} segments, by {kind}: {np.abs(elsewhere - x).max() / MOVED:.2g} times as far apart")
            for tolerance in (1e-6, 1e-8):
                at, pulls = flight(kind, segments, tolerance)
                errors = 100.0 * np.abs(pulls - tension) / np.abs(tension).max()
                part = f"kite_tension {errors.max():.2g} %, median {np.median(errors):.1g} %"
                print(f"  {tolerance:g}: positions {np.abs(at - x).max():.2g} m, {part}", flush=True)


if __name__ == "__main__":
    main()
