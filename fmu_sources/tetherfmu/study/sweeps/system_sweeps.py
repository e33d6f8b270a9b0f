"""Sweeps of systems of tethers: what their files can vary, their outputs, and a flight with varied values."""

from dataclasses import replace
from typing import NamedTuple
from warnings import catch_warnings

import numpy as np

from tetherfmu.files.driven import WINCH
from tetherfmu.files.settings import ELEMENT, OF_THE_WIND
from tetherfmu.files.system_files import KEYS_OF_A_LINE, KEYS_OF_A_POINT, KEYS_OF_A_WINCH
from tetherfmu.files.toml_files import TABLE_OF_GROUND, keys_of
from tetherfmu.files.winds import Wind
from tetherfmu.python.tether_system import TetherSystem
from tetherfmu.records.problems import PlausibilityWarning
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.inputs import ZERO
from tetherfmu.runtime.naming import meant_or_all
from tetherfmu.runtime.parameters import Environment, Solver
from tetherfmu.study.measuring import flight_table
from tetherfmu.study.measuring.system_flights import SystemFlight, Wanted, driven_by, read, with_values
from tetherfmu.wiring.lines import Point
from tetherfmu.wiring.selection import own_name
from tetherfmu.wiring.system_variables import table_of
from tetherfmu.wiring.variables import OUTPUT
from tetherfmu.wiring.winches import SharedWinch

from .varied import unit_in_series, unit_of_field

USUAL = ("tension_from", "tension_to", *flight_table.DERIVED)  # outputs, of all lines; the derived ones where a winch turns
COST = 1e-6  # of a step, for each segment, about [s]
TABLES = {"environment": Environment, "solver": Solver, "ground": TABLE_OF_GROUND, "wind": Wind, "wanted": Wanted}
WORST = ("peak_tension", "slack_segments", "broken")  # outputs of which the largest of all lines counts
FORCED = ("reel_out_speeds", "winch_forces", "winch_lengths")  # series of winches


class SystemConfig(NamedTuple):
    """How the flights of a system are computed."""

    step: float  # communication step [s]

    def words(self):
        """For people."""
        return f"dynamic tethers, communication step {1e3 * self.step:g} ms"


def unit_in(flight):
    """Function of the name of a value of the file of a `SystemFlight`: its unit, as `varied.unit_of`."""
    found = flight.found
    named = {"points": found.points, "lines": found.lines, "winches": found.winches}
    named = {section: [each.name for each in listed] for section, listed in named.items()}
    keys = {"points": KEYS_OF_A_POINT, "lines": (*KEYS_OF_A_LINE, "material"), "winches": KEYS_OF_A_WINCH}
    series = {f"{name}.{what}": facts for name, own in driven_by(found).items() for what, facts in own.items()}
    series["wind_velocity"] = ("m/s", 3)

    def unit(name):
        if name in OF_THE_WIND:
            return OF_THE_WIND[name]
        if name.startswith("series."):
            return unit_in_series(name, series)
        element = ELEMENT.fullmatch(name)
        section, *owner, last = (element[1] if element else name).split(".")
        if section == "loads" and not owner:
            known, kind = found.free, None
        elif section in named and len(owner) == 1:
            if owner[0] not in named[section]:
                raise ValueError(f"{section} has no {owner[0]}{meant_or_all(owner[0], named[section])}")
            kind = {"points": Point, "winches": SharedWinch}.get(section) or KEYS_OF_A_LINE.get(last)
            known = keys[section]
        elif (section in TABLES and not owner) or name == "duration":
            kind = TABLES.get(section, SystemFlight)
            known = ["duration"] if name == "duration" else keys_of(kind)
        else:
            every = [*TABLES, "duration", "loads.NAME", "series", *(f"{each}.NAME" for each in named)]
            raise ValueError(f"a system has no {name}; its values are in {', '.join(every)}")
        if last not in known:
            raise ValueError(f"a system has no {name}{meant_or_all(last, known)}")
        if kind is None:
            return "N" if element and section == "loads" else None
        return unit_of_field(kind, last, bool(element))

    return unit


def outputs_of(flight, names, varied):
    """Names of the outputs of a `SystemFlight` that names mean: of one, or of all lines and points; None: `USUAL`.

    varied : names of varied values.  ValueError names an unknown one.
    """
    found = flight.found
    known = known_outputs(flight)
    if names is not None:
        chosen = [[each for each in known if name in (each, flight_table.vector_of(each), own_name(each))] for name in names]
        every = dict.fromkeys([*known, *map(own_name, known)])
        for name, own in zip(names, chosen, strict=True):
            if not own:
                raise ValueError(f"there is no output {name!r}{meant_or_all(str(name), every)}")
        return tuple(dict.fromkeys(each for own in chosen for each in own))
    turned = {name for what in FORCED for name in flight.series.get(what, {})} | {each.name for each in found.winches}
    turned |= {each.name for each in found.lines if each.reel_out_speed or each.winch.winch_control != at.WINCH_BY_SPEED}
    turned |= {name.split(".")[1] for name in varied if name.count(".") > 1 and name.split(".")[2] in WINCH}
    listed = [f"{each.name}.{own}" for each in found.lines for own in USUAL[:2]]
    named = [each.name for each in (*found.lines, *found.winches) if each.name in turned]
    return (*listed, *(f"{name}.{own}" for name in named for own in flight_table.DERIVED))


def known_outputs(flight):
    """Names of the scalar outputs of a `SystemFlight`, derived ones included; no shapes."""
    found = flight.found
    found = replace(found, starts={each.name: ZERO for each in found.points if each.position is None})
    names = [each.name for each in table_of(found) if each.causality == OUTPUT]
    names = [name for name in names if "." in name and not own_name(name).startswith("shape")]
    derived = (f"{each.name}.{own}" for each in (*found.lines, *found.winches) for own in flight_table.DERIVED)
    return [*dict.fromkeys([*names, *derived])]


def flown(task, values):
    """Columns of a flight of a `statistics.Task` with these values, without the start, and of all lines together.

    ValueError or StepRefused if there is none.
    """
    flight = read(with_values(task.table, values), task.folder, task.name)
    system, step = TetherSystem.of(flight.found), task.config.step
    count = round(flight.duration / step)
    time = step * np.arange(count + 1)
    with catch_warnings(action="ignore", category=PlausibilityWarning):  # each flight would repeat the same
        start = flight.start(system)
        found = system.fly(count, step, **flight.given(time[:-1]))
    columns = flight_table.with_power(flight_table.of_system(time, start, found), system.winches)
    columns = {name: values[1:] for name, values in columns.items()}
    every = {own: np.array([columns[f"{line.name}.{own}"] for line in system.lines]) for own in (*WORST, "break_time")}
    first = np.where(every["broken"] > 0, every["break_time"], np.inf).min(axis=0)
    return columns | {own: every[own].max(axis=0) for own in WORST} | {"break_time": first}


def cost_of(flight, config):
    """Work of a flight, about [s]."""
    return COST * flight.duration / config.step * sum(flight.segments_of_lines(1.0).values())
