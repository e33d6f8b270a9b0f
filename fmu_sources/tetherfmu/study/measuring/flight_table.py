"""Results of a flight: a table of outputs, power and payout, and a summary in lines.

Columns are a dict of arrays (rows,) by the names of variables (docs/use/interface.md), in a system with the name of a line,
point or winch before a dot; `time` is the first. Each row is a communication point, the first one the start.

    power    tension where the tether leaves the winch times winch speed [W]; positive while the tether pulls rope out
    payout   unstretched length minus its initial value [m]

The power of a shared winch uses the sum of its tensions times their ratios.
"""

import csv
import math

import numpy as np

from tetherfmu.files.toml_files import WrongUse
from tetherfmu.runtime.naming import meant
from tetherfmu.runtime.outputs import BY_NAME, PLACES
from tetherfmu.wiring.selection import own_name
from tetherfmu.wiring.system_variables import OF_A_LINE, OF_PORTIONS, OF_SHEAVES

AT_WINCH = ("ground_tension", "tension_from")  # of a tether, of a line
DERIVED = {"power": "W", "payout": "m"}  # columns that are no outputs of an FMU, and their units
SHOWN = (*AT_WINCH, "kite_tension", "tension_to", "peak_tension", *DERIVED)  # rows of a summary
OF_A_POINT = {what: f"kite_{what}" for what in ("position", "velocity", "force")}  # outputs of a tether with their units
STILL = 1e-3  # a winch that turns slower neither reels out nor in [m/s]
SHOWN_DIGITS, MEAN_DIGITS = 5, 3  # of the largest number in a row of a summary, and at least of the mean
DIGITS = "%.10g"  # of a number in a CSV file
ROUNDING = 1e-9  # of times [s], and of a mean, part of the largest value


def with_power(columns, winches=()):
    """Columns with `power` and `payout` where they can be known; winches : of a system, `SharedWinch`."""
    found = dict(columns)
    for name, values in columns.items():
        before, own = name[: len(name) - len(own_name(name))], own_name(name)
        if own in AT_WINCH and f"{before}winch_speed" in columns:
            found[f"{before}power"] = values * columns[f"{before}winch_speed"]
        if own == "tether_length":
            found[f"{before}payout"] = values - values[0]
    for winch in winches:
        pull = sum(ratio * columns[f"{line}.tension_from"] for line, ratio in winch.lines.items())
        found[f"{winch.name}.power"] = pull * columns[f"{winch.name}.winch_speed"]
    return found


def of_system(time, start, flown):
    """Columns of a flight of a system at these times [s], from its `SystemOutputs` at the start and its `SystemFlown`."""
    found = {"time": time}

    def put(name, first, rows):
        values = np.concatenate([np.asarray(first, float)[None], rows])
        parts = [f"{name}[{i + 1}]" for i in range(values.shape[1])] if values.ndim > 1 else [name]
        found.update(zip(parts, np.atleast_2d(values.T), strict=True))

    for point, rows in flown.points.items():
        for what in rows._fields:
            put(f"{point}.{what}", getattr(start.points[point], what), getattr(rows, what))
    for line, rows in flown.outputs.items():
        for name, own in OF_A_LINE.items():
            put(f"{line}.{own}", getattr(start.lines[line], name), rows[:, PLACES[name]])
        if portions := flown.portions.get(line):
            for field, name in zip(portions._fields, (*OF_PORTIONS, *OF_SHEAVES), strict=True):
                put(f"{line}.{name}", getattr(start.portions[line], field), getattr(portions, field))
    for winch, rows in flown.winches.items():
        for what in rows._fields:
            put(f"{winch}.{what}", getattr(start.winches[winch], what), getattr(rows, what))
    return found


def since(columns, begin):
    """Rows of columns from a time on [s]; WrongUse if there are none."""
    time = columns["time"]
    if begin > time[-1] + ROUNDING:
        raise WrongUse(f"--from is {begin:g} s; it must be at most the end of the flight, {time[-1]:g} s")
    return {name: values[time >= begin - ROUNDING] for name, values in columns.items()}


def chosen(columns, names):
    """Columns with these names: of a variable, a vector, or all lines and points; None: all but shapes."""
    if names is None:
        return {name: values for name, values in columns.items() if not own_name(name).startswith("shape")}
    found = {"time": columns["time"]}
    for text in names:
        known = {name: vector_of(name) for name in columns}
        mine = [name for name, vector in known.items() if text in (name, vector, own_name(vector))]
        if not mine:
            raise WrongUse(f"--outputs: this flight has no {text}{meant(text, {*known.values(), *map(own_name, known)})}")
        found |= {name: columns[name] for name in mine}
    return found


def vector_of(name):
    """Name of the vector that an element belongs to."""
    return name.partition("[")[0]


def beside_one_another(columns):
    """Columns of several flights with the same steps, dict by name, as one: NaN where one of them has ended."""
    time = max((each["time"] for each in columns.values()), key=len)
    found = {"time": time}
    for name, each in columns.items():
        rest = np.full(len(time) - len(each["time"]), np.nan)
        found |= {f"{name}.{own}": np.concatenate([values, rest]) for own, values in each.items() if own != "time"}
    return found


def write_csv(columns, path):
    """Write columns to a CSV file: a header of names, SI units."""
    with path.open("w", encoding="utf-8", newline="") as file:
        csv.writer(file, lineterminator="\n").writerow(columns)
        np.savetxt(file, np.column_stack([*columns.values()]).astype(float), fmt=DIGITS, delimiter=",")


def unit_of(own):
    """Unit of an output of a tether, a line, a point or a winch, or of a derived column."""
    own = vector_of(own)
    names = {line: tether for tether, line in OF_A_LINE.items()} | OF_A_POINT
    if own in OF_PORTIONS | OF_SHEAVES:
        return (OF_PORTIONS | OF_SHEAVES)[own][0]
    return DERIVED.get(own) or BY_NAME[names.get(own, own)].quantity.unit


def phases(speed):
    """Masks of the rows in which a winch with this speed [m/s] reels out and in, by name."""
    return {"out": speed > STILL, "in": speed < -STILL}


def summary(columns):
    """Lines of text: mean, least and largest values with times; power by phase; slack; breaks."""
    time, rows, notes = columns["time"], [], []
    for name, values in columns.items():
        own = own_name(name)
        if own in SHOWN and (own not in DERIVED or np.any(values)):
            rounding = 1e-12 * np.abs(values).max()  # the first of equal ones
            low, high = np.argmax(values <= values.min() + rounding), np.argmax(values >= values.max() - rounding)
            mean, least, largest = alike(values.mean(), values.min(), values.max())
            when = [f"{time[k]:.6g} s" if least != largest else "" for k in (low, high)]
            rows.append((f"{name} [{unit_of(own)}]", mean, least, when[0], largest, when[1]))
        before = name[: len(name) - len(own)]
        if own == "power" and np.any(values):
            notes += phases_in_words(before, values, columns[f"{before}winch_speed"])
        if own == "slack_segments" and np.any(values > 0):
            share, first = 100.0 * np.mean(values > 0), time[np.argmax(values > 0)]
            notes.append(f"{before}slack: a segment at least {share:.3g} % of the time, first at {first:.6g} s")
        if own == "broken" and values[-1]:
            when = columns.get(f"{before}break_time")
            notes.append(f"{before}broken or let go{f' at {when[-1]:.6g} s' if when is not None else ''}")
    return [*aligned([("", "mean", "least", "at", "largest", "at"), *rows]), *notes] if rows else notes


def phases_in_words(before, power, speed):
    """A line on the mean power in the phases of a winch; before : prefix of its names."""
    parts = [
        f"{power[rows].mean():.5g} W reeling {phase} ({100.0 * rows.mean():.3g} % of the time)"
        for phase, rows in phases(speed).items()
        if rows.any()
    ]
    return [f"{before}power: {', '.join(parts)}"] if parts else []


def alike(mean, low, high):
    """Texts of numbers with as many decimals as five digits of the largest one have; of a small mean three of its own."""
    size = max(abs(low), abs(high))
    decimals = decimals_of(size, SHOWN_DIGITS)
    own = max(decimals, decimals_of(mean, MEAN_DIGITS)) if abs(mean) > ROUNDING * size else decimals
    return [f"{round(float(each), n) + 0.0:.{n}f}" for each, n in ((mean, own), (low, decimals), (high, decimals))]


def decimals_of(number, digits):
    """Number of decimals for so many significant digits."""
    return max(0, digits - 1 - math.floor(math.log10(abs(number)))) if number else 0


def aligned(rows):
    """Lines of a table, the first column to the left, numbers to the right."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return [
        "  ".join(
            cell.rjust(width) if k else cell.ljust(width) for k, (cell, width) in enumerate(zip(row, widths, strict=True))
        )
        for row in rows
    ]
