"""Communication steps that the adaptive solver abandons, against the same steps in a hundred parts, which it resolves.

python tests/benchmarks/abandoned_steps.py [--points 121 425 463 714] [--parts 100]

For points of the stability map whose winch is told a force: the length of the tether, its positions, and the tension at the
ground that is found in each part of the first step that is abandoned, adaptive and with so many fixed steps as
`limits.COARSE_WORK` gives, a tenth of them, and ten times as many. docs/models/numerics.md, "Too many internal steps", has
the result. Some 10 s of processor time.
"""

import warnings

import numpy as np
from as_script import options

from stability.flight import model_of, winch_input
from stability.points import CALLS, kite, point
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.limits import COARSE_WORK
from tetherfmu.runtime.plausibility import UNRESOLVED, kinds


def inputs(p, start, time):
    """All inputs of a point at a time [s]; start : tension at the ground at the start [N]."""
    position, velocity = kite(p, time)
    wind = p.wind * np.array((np.cos(p.wind_azimuth), np.sin(p.wind_azimuth), 0.0))
    return {"kite_position": position, "kite_velocity": velocity, "wind_velocity": wind} | winch_input(p, start, time)


def first_abandoned(p):
    """State before the first step that is abandoned, its time [s], and the tension at the ground at the start [N]."""
    model = model_of(p, 1)
    start = float(model.initialize(**inputs(p, 0.0, 0.0), reel_out_speed=p.reel_out_speed).ground_tension)
    for k in range(CALLS):
        state = model.get_state()
        model.step(p.step, **inputs(p, start, k * p.step))
        if kinds(model.get_state()) >> UNRESOLVED & 1:
            return state, k * p.step, start
    raise SystemExit(f"no step of point {p.number} is abandoned")


def flown(p, state, time, start, parts):
    """Length [m], positions [m] after a step in parts, and the tension at the ground after each [N]."""
    model = model_of(p, 1)
    model.initialize(**inputs(p, 0.0, 0.0), reel_out_speed=p.reel_out_speed)
    model.set_state(state)
    step = p.step / parts
    tensions = [float(model.step(step, **inputs(p, start, time + j * step)).ground_tension) for j in range(parts)]
    return model.get_state()[at.LENGTH], model.positions.copy(), np.array(tensions)


def compare(number, parts):
    """Print a line for each number of fixed steps."""
    p = point(1, number, at.WINCH_BY_FORCE)
    before = first_abandoned(p)
    length, positions, tensions = flown(p, *before, parts)
    ringing = np.sqrt(np.mean(tensions**2))
    for factor in (0.1, 1.0, 10.0):
        count = max(1, int(factor * COARSE_WORK / p.segments / parts)) * parts
        found, shape, pulls = flown(p._replace(fixed_step=p.step / count), *before, parts)
        away = np.linalg.norm(shape - positions, axis=1) / length
        print(
            f"point {number}, {count} fixed steps: length {found / length - 1.0:.1e}, "
            f"positions {np.sqrt(np.mean(away**2)):.1e} (largest {away.max():.1e}) of it, "
            f"tension {np.sqrt(np.mean(pulls**2)):.3g} N rms of {ringing:.3g} N"
        )


def main():
    """Compare all points."""
    given = options(__doc__, points=[121, 425, 463, 714], parts=100)
    warnings.simplefilter("ignore")
    for number in given.points:
        compare(number, given.parts)


if __name__ == "__main__":
    main()
