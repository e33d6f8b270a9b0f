"""Errors, growth and limits of the ways of coupling, as tables. Helper of `coupling_limits.py`."""

import warnings

import numpy as np
import pandas as pd
import tabulate  # noqa: F401 - of to_markdown: missing, it is to be named before the measurements, not after them

from coupling.axial_chain import AxialChain
from coupling.monolithic import exact
from coupling.mooring import mooring
from coupling.ways_of_coupling import DRIVEN, WAYS, Leg, Mass, Scene, fly, force_error, memory_at_start, started, step_driven
from first_flight.fly_your_kite import load as lift_and_drag
from tetherfmu import TetherDynamic
from tetherfmu.console.progress import now
from tetherfmu.records.problems import PlausibilityWarning, StepRefused
from tetherfmu.runtime.parameters import Environment, Tether

WIND, MASS, DURATION = np.array([8.0, 0.0, 0.0]), 10.0, 4.0  # m/s, kg, s
UPWARDS = np.array([0.58, 0.15, 0.8]) / np.linalg.norm([0.58, 0.15, 0.8])  # from the ground station to the kite
STEPS = (0.001, 0.002, 0.004, 0.008, 0.01, 0.016, 0.02, 0.04, 0.08)  # parts of the last one [s]
PRINTED = 0.02  # step of the table [s]
OF_KNOTS = 0.005  # step of the table of knots [s]
LENGTHS, MASSES = (30.0, 100.0, 300.0, 500.0), (1.0, 3.0, 10.0, 30.0, 100.0)  # of the tether [m], of the kite [kg]
GROWTH_STEPS = (0.001, 0.002, 0.004, 0.007, 0.01, 0.015)  # [s]
SAFE = {"parallel, linear": 0.1, "sequential": 0.2, "sequential, linear": 0.2, "two iterations": 0.2}  # of sqrt(M/k)
KNOT, KNOT_STEPS = 5.0, (0.001, 0.002, 0.005, 0.01, 0.02)  # [kg], parts of the last one [s]
LIFT, PLUCKED = 500.0, 0.01  # [N], [m]


def constant_force(_position, _velocity):
    """A load [N] that does not depend on the motion: then the tether is the only thing that is exchanged."""
    return np.array([110.0, 15.0, 330.0])


def scenes(duration=DURATION):
    """Kites of 10 kg on the default tether, let go at rest but out of balance, so that they oscillate along it."""
    legs = (Leg(Tether()),)
    return {
        "constant force": Scene(legs, MASS, 504.7 * UPWARDS, constant_force, WIND, duration),
        "lift and drag": Scene(legs, MASS, 504.55 * UPWARDS, lift_and_drag, WIND, duration),
    }


def error_of(way, scene, step, forces, times):
    """`force_error` of a way against the exact forces at times [s]; not a number where a tether refuses a step."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", PlausibilityWarning)  # unstable flights are part of the question
        try:
            return force_error(fly(way, scene, step), forces, step, times)
        except StepRefused:
            return np.nan


def errors(steps=STEPS, duration=DURATION):
    """Table: kite, way, step [s], error of the tether force [-], see `error_of`."""
    times, rows = np.arange(0.0, duration + 0.5 * steps[-1], steps[-1]), []
    for kite, scene in scenes(duration).items():
        now(f"solving kite and tether together: {kite}")
        forces, _ = exact(scene, times)
        for way in WAYS:
            for step in steps:
                rows.append((kite, way, step, error_of(way, scene, step, forces, times)))
    return pd.DataFrame(rows, columns=["kite", "way", "step", "error"])


def in_series(duration):
    """`Scene` of a knot of 5 kg between the ground station and a kite that stays: plucked 0.2 m along, 1 m across."""
    tethers = Tether(segments=10, initial_length=250.0), Tether(segments=10, initial_length=254.0)
    kite = 505.0 * UPWARDS
    chain = TetherDynamic(tethers, point_masses={10: KNOT})
    chain.initialize(kite, wind_velocity=WIND)
    start = chain.positions[10] + 0.2 * UPWARDS + np.array([0.0, 1.0, 0.0])
    return Scene((Leg(tethers[0]), Leg(tethers[1], tuple(kite))), KNOT, start, lambda _x, _v: np.zeros(3), WIND, duration)


def knots(steps=KNOT_STEPS, duration=0.8):
    """Table: scene, way, step [s], error of the forces on the knot [-]."""
    times, rows = np.arange(0.0, duration + 0.5 * steps[-1], steps[-1]), []
    for name, scene in (("series", in_series(duration)), ("mooring", mooring(duration))):
        now(f"solving all legs together: {name}")
        forces, _ = exact(scene, times, 1e-8)
        rows += [(name, way, step, error_of(way, scene, step, forces, times)) for way in WAYS for step in steps]
    return pd.DataFrame(rows, columns=["scene", "way", "step", "error"])


def plucked(tether, kite_mass, duration):
    """`Scene` of a kite above the ground station, weightless in still air, `PLUCKED` above where it would stay."""
    rest = tether.initial_length * (1.0 + LIFT / tether.axial_stiffness)
    up, void = np.array([0.0, 0.0, 1.0]), Environment(gravity=0.0, air_density=0.0)
    return Scene((Leg(tether),), kite_mass, (rest + PLUCKED) * up, lambda _x, _v: LIFT * up, np.zeros(3), duration, void)


def measured_growth(way, tether, kite_mass, step, duration=6.0):
    """Rate [1/s] at which an oscillation of a kite along its vertical tether, weightless in still air, grows.

    Once it is a single oscillation, x[k + 2] = a x[k + 1] + b x[k] with its |eigenvalue| sqrt(-b).
    """
    scene = plucked(tether, kite_mass, duration)
    rest = scene.position[2] - PLUCKED
    (tethers, outputs), mass, heights = started(scene, relative_tolerance=1e-8), Mass(scene), []
    memory = memory_at_start(outputs)
    for _ in range(round(duration / step)):
        outputs = step_driven(way, scene, tethers, mass, outputs, memory, step)
        heights.append(mass.position[2] - rest)
    stride = max(1, round(0.5 * np.sqrt(mass.inertia(outputs) / outputs[0].kite_stiffness) / step))
    x = np.array(heights[len(heights) // 2 :: stride])
    _, b = np.linalg.lstsq(np.column_stack([x[1:-1], x[:-2]]), x[2:], rcond=None)[0]
    return 0.5 * np.log(-b) / (stride * step)


def formula(way, tether, kite_mass, step):
    """Rate [1/s] of first order in the step: the force acts half a step late (parallel) or early (sequential).

    (+- k h/2 M/m - c)/(2 m): M the mass that the force is applied to, m that which oscillates, with a third of the tether.
    """
    k, c = tether.axial_stiffness / tether.initial_length, tether.axial_damping / tether.initial_length
    weight = tether.mass_per_length * tether.initial_length
    applied, moving = kite_mass + 0.5 * weight / tether.segments, kite_mass + weight / 3.0
    late = {"parallel": 1.0, "sequential": -1.0}.get(way, 0.0)
    return (late * 0.5 * k * step * applied / moving - c) / (2.0 * moving)


def growths(steps=GROWTH_STEPS, duration=6.0):
    """Table: way, step [s], growth rates [1/s] as measured, by the theory of the chain, by the formula."""
    tether, rows = Tether(), []
    chain = AxialChain(tether, MASS)
    for way in DRIVEN:
        for step in steps:
            theory = np.log(chain.factor(way, step)) / step
            measured = measured_growth(way, tether, MASS, step, duration)
            rows.append((way, step, measured, theory, formula(way, tether, MASS, step)))
    return pd.DataFrame(rows, columns=["way", "step", "measured", "theory", "formula"])


def limits(lengths=LENGTHS, masses=MASSES):
    """Table: length [m], kite mass [kg], way, largest stable step [s], and what `kite_stiffness` and so on say of it."""
    rows = []
    for length in lengths:
        for mass in masses:
            chain = AxialChain(Tether(initial_length=length), mass)
            simple = AxialChain(Tether(initial_length=length, segments=1), mass)
            for way in DRIVEN:
                safe = SAFE[way] * np.sqrt(chain.mass / simple.k) if way in SAFE else 2.0 * simple.c / simple.k
                rows.append((length, mass, way, chain.largest_step(way), safe))
    return pd.DataFrame(rows, columns=["length", "kite_mass", "way", "largest_step", "safe_step"])


def percent_table(table):
    """Markdown: at the step `PRINTED`, error [%] of each way for each kite."""
    mine = table[np.isclose(table.step, PRINTED)]
    wide = 100.0 * mine.pivot(index="way", columns="kite", values="error").loc[list(WAYS)]
    return wide.map(shown).to_markdown(disable_numparse=True)


def knot_table(table):
    """Markdown: at the step `OF_KNOTS`, error [%] of each way for each scene."""
    mine = table[np.isclose(table.step, OF_KNOTS)]
    wide = 100.0 * mine.pivot(index="way", columns="scene", values="error").loc[list(WAYS), list(mine.scene.unique())]
    return wide.map(shown).to_markdown(disable_numparse=True)


def shown(percent):
    """An error [%] in two digits; beyond 100 it says nothing more."""
    return f"{percent:.2g}" if percent < 99.5 else "unstable"


def limit_table(table):
    """Markdown: largest stable step [ms] of each way, a row for each length and mass."""
    wide = table.assign(ms=1e3 * table.largest_step).pivot(index=["length", "kite_mass"], columns="way", values="ms")
    wide = wide[list(DRIVEN)].rename_axis(["length [m]", "kite [kg]"]).reset_index()
    return wide.to_markdown(index=False, floatfmt=("g", "g", *(len(DRIVEN) * [".3g"])))


def rule_table(table):
    """Markdown: the rule for the step of each way, and how many times as long a step may be: smallest, largest."""
    rules = {way: f"{part:g} sqrt(M/k)" for way, part in SAFE.items()} | {"parallel": "2 c/k"}
    ratio = (table.largest_step / table.safe_step).groupby(table.way).agg(["min", "max"]).loc[list(DRIVEN)]
    rows = [(way, rules[way], f"{row['min']:.2g}", f"{row['max']:.2g}") for way, row in ratio.iterrows()]
    head = ("way", "rule", "limit over rule, smallest", "largest")
    return pd.DataFrame(rows, columns=head).to_markdown(index=False, disable_numparse=True)
