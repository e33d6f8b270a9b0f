"""Drums on one segment that goes slack and snaps taut: how far is the adaptive solver from DOP853, at each tolerance?

    python tests/benchmarks/bouncing_drums.py [--count N]

Random scenes of 20 to 300 m without air, 3 s, between the ground and a kite that is driven at a constant velocity, or free
with a mass of 1 to 100 kg; drums of 1 to 300 kg. The equations are those of tests/drums.py with their transitions as events;
nodes have the masses kite + mu L/2. Printed are errors of the tension, the largest of a flight over the largest tension.
"""

import argparse
import warnings
from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_ivp

from tetherfmu import Environment, Solver, Tether, TetherDynamic, TetherDynamicFree, Winch

G, STEP, STEPS = 9.81, 0.02, 150
TOLERANCES = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7)
MOST_TRANSITIONS = 1000


class Scene(NamedTuple):
    """Kite at the start [m], [m/s], its mass [kg], its load [N] (None: driven), the tether, its drum, W [N]."""

    x: np.ndarray
    v: np.ndarray
    mass: float
    load: np.ndarray | None
    tether: Tether
    drum: Winch
    force: float


def scene(seed, free):
    """`Scene` with a free kite, or with a driven one."""
    random = np.random.default_rng(seed)
    length, force = random.uniform(20.0, 300.0), random.uniform(50.0, 800.0)
    out = np.array((0.6, 0.0, 0.8))
    damping, ratio = float(random.choice((0.0, 473.0))), float(random.choice((0.0, 0.01)))
    tether = Tether(segments=1, initial_length=length, axial_damping=damping, slack_stiffness_ratio=ratio)
    friction = float(random.choice((0.0, random.uniform(1.0, 20.0))))
    drum = Winch(winch_control="force", winch_mass=10.0 ** random.uniform(0.0, 2.5), winch_damping=friction)
    x, mass = out * length * random.uniform(0.98, 1.005), 10.0 ** random.uniform(0.0, 2.0)
    load = out * force * random.uniform(0.9, 1.1) + np.array((0.0, 0.0, mass * G)) if free else None
    velocity = np.zeros(3) if free else random.uniform(-1.0, 1.0, 3)
    return Scene(x, velocity, mass, load, tether, drum, force)


def exact(flown):
    """Tension [N] at each communication point, or None after too many transitions; and their number."""
    tether, drum = flown.tether, flown.drum
    density = tether.density * np.pi / 4.0 * tether.diameter**2

    def tension(y, is_taut):
        distance, length = np.sqrt(y[:3] @ y[:3]), y[6]
        stiffness = tether.axial_stiffness / length * (1.0 if is_taut else tether.slack_stiffness_ratio)
        strain_rate = (y[:3] @ y[3:6] / distance - y[7] * distance / length) / length
        return stiffness * (distance - length) + tether.axial_damping * strain_rate

    def slope(_, y, is_taut):
        pull, gain = tension(y, is_taut), np.zeros(3)
        if flown.load is not None:
            gain = (flown.load - pull * y[:3] / np.sqrt(y[:3] @ y[:3])) / (flown.mass + 0.5 * density * y[6]) - (0, 0, G)
        turn = (pull - flown.force - drum.winch_damping * y[7]) / drum.winch_mass
        return np.concatenate((y[3:6], gain, (y[7], turn)))

    def stretch(_, y, is_taut):
        return np.sqrt(y[:3] @ y[:3]) - y[6]

    stretch.terminal = True
    times = STEP * np.arange(STEPS + 1)
    time, y, rows, transitions = 0.0, np.concatenate((flown.x, flown.v, (tether.initial_length, 0.0))), [], -1
    is_taut = stretch(time, y, None) > 0.0
    while len(rows) < len(times) and transitions < MOST_TRANSITIONS:
        stretch.direction = -1.0 if is_taut else 1.0
        options = {"rtol": 1e-11, "atol": 1e-12, "events": stretch, "args": (is_taut,), "t_eval": times[len(rows) :]}
        part = solve_ivp(slope, (time, times[-1]), y, "DOP853", **options)
        rows += [tension(each, is_taut) for each in np.reshape(part.y, (len(y), -1)).T]  # none within a short part
        if part.status == 1:
            time, y = part.t_events[0][0], part.y_events[0][0]
        is_taut, transitions = not is_taut, transitions + 1
    return np.array(rows) if len(rows) == len(times) else None, transitions


def tensions(flown, tolerance):
    """Tension [N] of the package at each communication point."""
    free, options = flown.load is not None, {"winch": flown.drum, "solver": Solver(relative_tolerance=tolerance)}
    model, air = TetherDynamicFree if free else TetherDynamic, Environment(air_density=0.0)
    kite = {"kite_mass": flown.mass} if free else {}
    tether, told = model(flown.tether, air, **options, **kite), {"winch_force": flown.force}
    if free:
        told["kite_load"] = flown.load
        rows = [tether.initialize(positions=(np.zeros(3), flown.x), **told)]
    else:
        rows = [tether.initialize(flown.x, flown.v, **told)]
    for k in range(STEPS):
        ends = {} if free else {"kite_position": flown.x + k * STEP * flown.v, "kite_velocity": flown.v}
        rows.append(tether.step(STEP, **ends, **told))
    return np.array([row.ground_tension for row in rows])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=40)
    count = parser.parse_args().count
    warnings.simplefilter("ignore")
    for free in (False, True):
        found = []
        for seed in range(count):
            flown = scene(seed, free)
            wanted, transitions = exact(flown)
            if wanted is not None and transitions > 0:
                found.append([np.abs(tensions(flown, each) - wanted).max() / np.abs(wanted).max() for each in TOLERANCES])
        print(f"{'free' if free else 'driven'} kite: {len(found)} scenes that go over the transition, error in %")
        for tolerance, errors in zip(TOLERANCES, np.transpose(found), strict=True):
            numbers = "".join(f"{100.0 * each:11.2g}" for each in np.quantile(errors, (0.5, 0.9, 1.0)))
            print(f"  {tolerance:g}: median, 90 %, largest {numbers}", flush=True)


if __name__ == "__main__":
    main()
