"""The tethers along a measured flight: each is driven by the log, and what it gives is compared with the log."""

import warnings
from dataclasses import replace

import numpy as np
import pandas as pd

from tetherfmu.models import TetherCatenary, TetherDynamic, TetherQuasiSteady, TetherStraight
from tetherfmu.results import PlausibilityWarning, StepRefused
from tetherfmu.runtime.inputs import by_name

from .flight import EVERY, LEADS, STEP
from .log import LogError

TETHERS = {each.variant: each for each in (TetherDynamic, TetherQuasiSteady, TetherCatenary, TetherStraight)}
SEGMENTS = 20
SCALARS = ("ground_tension", "kite_tension", "tether_length", "ground_elevation", "ground_azimuth", "sag")
MORE = ("slack_segments", "grounded_length", "kite_stiffness")
SHORT = 1e-3  # s, of the step that finds the first length
TAUT = 1.05  # first length over the distance of the ends, at most, where a tension is measured


class Flown:
    """What a tether gave along a flight: `table`, a DataFrame with a row for each of `Flight.times`; NaN where it refused.

    `shapes` : (rows, nodes, 3) positions of the nodes [m].  `refused` : number of communication steps that were refused, and
    `reason` that of the first.  `seconds` : wall time of its steps.
    """

    def __init__(self, table, shapes, refusals, seconds):
        self.table, self.shapes, self.seconds = table, shapes, seconds
        self.refused, self.reason = len(refusals), refusals[0].reason if refusals else ""


def first_length(flight, rows, lead):
    """Unstretched length [m] at the start: logged, or that with which the tether has the measured tension."""
    start = by_name(rows[0])
    distance = float(np.linalg.norm(start["kite_position"]))
    if lead == "length":
        return float(start["winch_length"][0])
    if "ground_tension" not in flight.log.table:
        return distance
    found = flight.log.map
    options = {"winch_control": "force", "input_continuation": "held", "shape_points": 0}
    tether = TetherQuasiSteady(replace(found.tether, initial_length=distance), found.environment, **options)
    still = {"kite_position": start["kite_position"], "wind_velocity": start["wind_velocity"]}
    force = float(flight.measured("ground_tension", flight.times[:1])[0])
    try:
        tether.initialize(**still)
        length = tether.step(SHORT, **still, winch_force=force).tether_length
    except StepRefused:
        return distance
    return min(length, TAUT * distance)


def fly(flight, variant, lead, segments=SEGMENTS, **quantities):
    """`Flown` of a tether along a `Flight`.

    variant : a key of `TETHERS`.  lead : "tension", "length" or "speed", what the winch is told.  quantities : others than
    those of the map of the log, by name.  LogError if the log cannot lead it, or the tether cannot start.
    """
    if not flight.has(lead):
        raise LogError(f"the log has no {lead} that could lead the winch")
    rows, found = flight.inputs(lead), flight.log.map
    start = by_name(rows[0])
    told = {"winch_control": LEADS[lead], "segments": segments, "initial_length": first_length(flight, rows, lead)}
    with warnings.catch_warnings(action="ignore", category=PlausibilityWarning):
        tether = TETHERS[variant](found.tether, found.environment, ground=found.ground, **told | quantities)
        try:
            tether.initialize(**{name: start[name] for name in ("kite_position", "kite_velocity", "wind_velocity")})
        except StepRefused as refusal:
            raise LogError(f"{type(tether).__name__} cannot start at {flight.start:g} s: {refusal}") from None
        first = tether.outputs()
        flown = tether.fly(rows, STEP, every=round(EVERY / STEP), peaks=True, on_refusal="skip")
    table = pd.DataFrame({"time": flight.times})
    for name in (*SCALARS, *MORE):
        table[name] = np.concatenate([[getattr(first, name)], flown.of(name)])
    for end in ("ground_force", "kite_force"):
        table[[f"{end}[{i}]" for i in (1, 2, 3)]] = np.vstack([getattr(first, end), getattr(flown, end)])
    weight = found.tether.mass_per_meter * found.environment.gravity * table.tether_length
    air = [table[f"ground_force[{i}]"] + table[f"kite_force[{i}]"] + (weight if i == 3 else 0.0) for i in (1, 2, 3)]
    table["air_force"] = np.linalg.norm(air, axis=0)  # of a tether in equilibrium in the air
    shapes = np.concatenate([first.shape[None], flown.shape])
    return Flown(table, shapes, flown.refusals, flown.seconds)
