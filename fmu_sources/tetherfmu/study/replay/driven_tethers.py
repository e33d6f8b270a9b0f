"""The tethers along a measured flight: the log drives each of them, and their results are compared with the log."""

import warnings
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pandas as pd

from tetherfmu.python.models import TetherQuasiSteady
from tetherfmu.records.problems import PlausibilityWarning, StepRefused
from tetherfmu.runtime.inputs import by_name
from tetherfmu.runtime.parameters import Tether
from tetherfmu.study.measuring.start import MODELS

from .flight import EVERY, LEADS, STEP
from .log import LogError

TETHERS = dict(reversed(MODELS.items()))  # the finest one first
SEGMENTS = Tether.segments
SCALARS = (
    *("ground_tension", "kite_tension", "tether_length", "ground_elevation", "ground_azimuth", "sag"),
    *("slack_segments", "grounded_length", "kite_stiffness"),
)
FORCES = ("ground_force", "kite_force")
KEPT = (*SCALARS, *FORCES)
CHUNK = 20  # times that are flown at once: a tether that refuses all of them, 2 s, is stopped
TAUT = 1.05  # first length over the distance of the ends, at most, where a tension is measured


class Flown(NamedTuple):
    """Result of a tether along a flight: `table`, a DataFrame with a row for each of `Flight.times`; NaN where it refused.

    Columns, in addition to outputs of these names: `mean_tension`, of `ground_tension` since the row before [N];
    `air_force`, sum of end forces and weight [N]: drag, for a tether that hangs in equilibrium in the air.
    `shapes` : (rows, points, 3) [m].  `refusals` : `Refusal` of the refused steps.  `stopped` : time from
    which on nothing was tried any more [s], None if the flight is complete.
    """

    table: pd.DataFrame
    shapes: np.ndarray
    refusals: tuple
    stopped: float | None = None
    break_time: float = -1.0  # since the start [s], -1: it did not break


def finest(names):
    """The name of the finest of some tethers."""
    return min(names, key=list(TETHERS).index)


def words(name):
    """Name of a tether for people."""
    return name.replace("_", "-")


def first_length(flight, rows, lead):
    """Unstretched length [m] at the start: logged, or the length at which the tether has the measured tension."""
    start = by_name(rows[0])
    distance = float(np.linalg.norm(start["kite_position"]))
    if lead == "length":
        return float(start["winch_length"][0])
    if "ground_tension" not in flight.log.table:
        return distance
    found = flight.log.map
    options = {"winch_control": "force", "winch_start": "equilibrium", "shape_points": 0}
    rope = replace(found.tether, initial_length=distance)
    tether = TetherQuasiSteady(rope, found.environment, ground=found.ground, **options)
    still = {"kite_position": start["kite_position"], "wind_velocity": start["wind_velocity"]}
    force = float(flight.measured("ground_tension", flight.times[:1])[0])
    try:
        length = tether.initialize(**still, winch_force=force).tether_length
    except StepRefused:
        return distance
    return min(length, TAUT * distance)


def fly(flight, variant, lead, segments=SEGMENTS, **quantities):
    """`Flown` of a tether along a `Flight`.

    variant : a key of `TETHERS`.  lead : "tension", "length" or "speed", the winch input.  quantities : that override
    those of the map of the log, by name.  LogError if the log cannot drive it, or the tether cannot start.
    """
    flight.require(lead)
    rows, found = flight.inputs(lead), flight.log.map
    start = by_name(rows[0])
    given = {"winch_control": LEADS[lead], "segments": segments, "initial_shape": "quasi_steady"}  # the kite is in flight
    with warnings.catch_warnings(action="ignore", category=PlausibilityWarning):
        given["initial_length"] = first_length(flight, rows, lead)
        tether = TETHERS[variant](found.tether, found.environment, ground=found.ground, **given | quantities)
        try:
            tether.initialize(**{name: start[name] for name in ("kite_position", "kite_velocity", "wind_velocity")})
        except StepRefused as refusal:
            raise LogError(f"{type(tether).__name__} cannot start at {flight.start:g} s: {refusal}") from None
        return flown_of(tether, rows, flight.times, found)


def flown_of(tether, rows, times, found):
    """`Flown` of a tether that is initialized; rows : inputs, as many for each of the times [s] but the first."""
    first, each = tether.outputs(), round(EVERY / STEP)
    table, shapes, refusals = {name: [[getattr(first, name)]] for name in KEPT}, [first.shape[None]], []
    means, stopped = [[first.ground_tension]], None
    for begin in range(0, len(rows), each * CHUNK):
        part = rows[begin : begin + each * CHUNK]
        flown = tether.fly(part, STEP, on_refusal="skip")
        for name in KEPT:
            values = getattr(flown, name) if name in FORCES else flown.of(name)
            table[name].append(values[each - 1 :: each])
        tension = flown.of("ground_tension").reshape(-1, each)
        known = np.isfinite(tension).sum(axis=1)
        means.append(np.divide(np.nansum(tension, axis=1), known, np.full(len(known), np.nan), where=known > 0))
        shapes.append(flown.shape[each - 1 :: each])
        refusals += flown.refusals
        if len(flown.refusals) == len(part) == each * CHUNK:
            stopped = float(times[begin // each + CHUNK])
            break
    columns = {"time": times, "mean_tension": filled(means, len(times))}
    columns |= {name: filled(table[name], len(times)) for name in SCALARS}
    for end in FORCES:
        columns |= {f"{end}[{i + 1}]": values for i, values in enumerate(filled(table[end], len(times)).T)}
    made = pd.DataFrame(columns)
    weight = found.weight * made.tether_length
    air = [made[f"ground_force[{i}]"] + made[f"kite_force[{i}]"] + (weight if i == 3 else 0.0) for i in (1, 2, 3)]
    made["air_force"] = np.linalg.norm(air, axis=0)
    return Flown(made, filled(shapes, len(times)), tuple(refusals), stopped, tether.outputs().break_time)


def filled(parts, count):
    """Arrays one after the other, (count, ...), with NaN where they end before."""
    whole = np.concatenate(parts)
    return np.concatenate([whole, np.full((count - len(whole), *whole.shape[1:]), np.nan)])
