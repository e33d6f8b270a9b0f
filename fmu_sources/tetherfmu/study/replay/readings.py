"""Readings of a log, in SI units: impossible values are removed, and possible errors are doubted."""

import numpy as np
import pandas as pd

from tetherfmu.runtime.inputs import components

POSITION, VELOCITY, WIND = (components(name, 3) for name in ("kite_position", "kite_velocity", "wind_velocity"))
# largest possible magnitude of readings of a kite [m], [m/s], [N]
LARGEST = dict.fromkeys(POSITION, 2e4) | dict.fromkeys(VELOCITY, 150.0) | dict.fromkeys(WIND, 80.0)
LARGEST |= {"tether_length": 2e4, "reel_out_speed": 50.0, "ground_tension": 1e7, "airspeed": 150.0}
# a reading further than this from the median of its neighbours may be a spike; addition per 1 s
FLOOR = dict.fromkeys(POSITION, (5.0, 15.0)) | dict.fromkeys(VELOCITY, (7.0, 20.0))
FLOOR |= {"tether_length": (2.0, 5.0), "reel_out_speed": (3.0, 3.0)}
SPIKE = 8.0  # in typical distances from the median of the neighbours: minimum of a spike
NEARBY = 1.1  # s, time range of neighbours
NEIGHBOURS = 5, 111  # rows: fewest and most neighbours
OF_TENSION = 0.3  # of its 99th percentile: floor of a spike of the tension
AWAY = 20.0  # m, minimum distance at which a position of exactly 0 is invalid
COVERED = 0.5  # of the time that readings of a quantity must cover
COARSE = 3.0  # in smallest differences: a median change below this indicates few digits
HELD = 0.5  # share of rows that repeat the reading above, for a slower sensor
FEWEST = 20  # rows of a log, readings of a quantity
FROZEN = 5.0  # s, doubtful duration of a constant reading
AT_REST = 0.2  # m/s: a position, or a length, may stay the same below it
FASTEST = 150.0  # m/s, of a kite
FAR_FROM_USUAL = 5.0  # times the median of such differences, which a noisy receiver has in all rows
JUMP = 5.0, 5.0  # m, permitted difference of a position from its velocity between rows; addition per 1 s


def between(time, own, values, longest_gap):
    """Readings, interpolated linearly from their own times [s] to other times [s]; NaN outside, and in longer gaps [s]."""
    found = np.interp(time, own, values, np.nan, np.nan)
    after = np.clip(np.searchsorted(own, time), 1, len(own) - 1)
    found[own[after] - own[after - 1] > longest_gap] = np.nan
    return found


def repair(table, longest_gap, report):
    """Replace invalid readings by NaN; a line on each affected column.

    table : as of a `Log`.  longest_gap [s] : that is bridged.
    """
    leave_out_zeros(table, report)
    for names in (POSITION, VELOCITY, ("tether_length",), ("ground_tension",)):
        leave_out_held(table, names, longest_gap, report)
    for name in table.columns.drop("time"):
        leave_out_impossible(table, name, report)


def leave_out_zeros(table, report):
    """Put NaN for positions that are exactly 0 while the next ones are far away: no reading of a receiver yet."""
    position = table[[*POSITION]].to_numpy(copy=True)
    zero = ~position.any(axis=1)
    away = pd.Series(np.where(zero, np.nan, np.linalg.norm(position, axis=1)))
    nearest = np.fmin(away.ffill().to_numpy(), away.bfill().to_numpy())
    none = zero & (nearest > AWAY)
    why = f"which are 0, {AWAY:g} m or more from the next one"
    report.count("left out of kite_position", int(none.sum()), len(none), why)
    position[none] = np.nan
    table[[*POSITION]] = position


def runs_of(values):
    """First and last rows of the runs of the same readings, arrays (runs,); values : array (rows, columns)."""
    last = np.flatnonzero(np.append(np.any(np.diff(values, axis=0) != 0.0, axis=1), True))
    return np.concatenate([[0], last[:-1] + 1]), last


def leave_out_held(table, names, longest_gap, report):
    """Replace repeated readings by NaN, if most are repeated: a slower sensor or receiver, whose reading is held.

    On average they would be late by half the hold time. Runs longer than the longest gap [s] are kept.
    """
    if names[0] not in table:
        return
    values, time = table[[*names]].to_numpy(copy=True), table["time"].to_numpy()
    first, last = runs_of(values)
    held = np.repeat(time[last] - time[first] <= longest_gap, last - first + 1)
    held[first] = False
    if held.mean() > HELD and not is_coarse(values):
        name, why = names[0].partition("[")[0], "which repeat the reading above, as a slower sensor does"
        report.count(f"left out of {name}", int(held.sum()), len(held), why)
        values[held] = np.nan
        table[[*names]] = values


def is_coarse(values):
    """Whether readings, array (rows, columns), repeat because they have few digits: changes are one or two of the last."""
    for column in values.T:
        known = column[np.isfinite(column)]
        changes, differences = np.abs(np.diff(known)), np.diff(np.unique(known))
        if len(differences) and np.median(changes[changes > 0.0]) > COARSE * differences.min():
            return False
    return True


def leave_out_impossible(table, name, report):
    """Put NaN for readings that no kite has, and for spikes."""
    values, time = table[name].to_numpy(copy=True), table["time"].to_numpy()
    with np.errstate(invalid="ignore"):
        impossible = np.abs(values) > LARGEST[name]
        if name == "tether_length":
            impossible |= values <= 0.0
    leave_out(values, impossible, name, time, report, "impossible for a kite")
    there = time[np.isfinite(values)]
    step = float(np.median(np.diff(there))) if len(there) > 1 else 1.0
    leave_out(values, spikes_of(values, floor_of(name, values, step), step), name, time, report, "spikes")
    table[name] = values


def leave_out(values, which, name, time, report, why):
    """Replace some readings by NaN, with a line on the time of the first one."""
    if which.any():
        k = int(np.argmax(which))
        first = f"from {time[k]:.1f} s on ({values[k]:.4g})"
        report.say(f"left out of {name}: {which.sum()} of {len(which)} rows, {first}: {why}")
        values[which] = np.nan


def floor_of(name, values, step):
    """Distance from the median of the neighbours below which a reading is no spike; None: there are no spikes."""
    if name == "ground_tension":
        return OF_TENSION * np.nanpercentile(np.abs(values), 99.0) if np.isfinite(values).any() else None
    floor, grows = FLOOR.get(name, (None, 0.0))
    return floor if floor is None else floor + grows * step


def spikes_of(values, floor, step):
    """Which readings lie far from the median of their neighbours (Hampel 1974), array (rows,) of bool.

    step : time between two readings [s].  The first and the last ones have neighbours on one side only: not judged.
    """
    found, known = np.zeros(len(values), bool), np.isfinite(values)
    if floor is None:
        return found
    near = int(np.clip(round(NEARBY / step), *NEIGHBOURS)) // 2 * 2 + 1
    readings = pd.Series(values[known])
    distance = (readings - readings.rolling(near, center=True).median()).abs()
    typical = 1.4826 * distance.rolling(5 * near, center=True, min_periods=1).median()
    found[known] = distance > np.maximum(SPIKE * typical, floor)
    return found


def is_covered(time, known, longest_gap):
    """Whether enough readings are known for most of the time; missing rows of the log do not count."""
    steps, rows = np.diff(time[known]), np.diff(time)
    return known.sum() >= FEWEST and steps[steps <= longest_gap].sum() >= COVERED * rows[rows <= longest_gap].sum()


def judge_frozen(table, report):
    """Doubt readings that stay the same to the last digit for long although something moves."""
    time = table["time"].to_numpy()
    for names in (POSITION, ("tether_length",), ("ground_tension",)):
        if names[0] not in table:
            continue
        values = table[[*names]].to_numpy()
        first, last = runs_of(values)
        frozen = np.flatnonzero(time[last] - time[first] > FROZEN)
        long = [(first[k], last[k]) for k in frozen if moves(table, names, slice(first[k], last[k] + 1))]
        if long:
            i, j = max(long, key=lambda pair: time[pair[1]] - time[pair[0]])
            name, shown_values = names[0].partition("[")[0], ", ".join(f"{each:g}" for each in values[i])
            report.doubt(f"{name} reads {shown_values} from {time[i]:.1f} to {time[j]:.1f} s without any change")


def moves(table, names, rows):
    """Whether the rest of a log contradicts, or cannot confirm, that a reading stays the same in some rows."""
    others = {POSITION: VELOCITY, ("tether_length",): ("reel_out_speed",)}.get(names, (None,))
    if others[0] in table:
        speed = np.linalg.norm(table[[*others]].to_numpy()[rows], axis=1)
        return not np.nanmean(np.append(speed, AT_REST)) < AT_REST
    if names != ("tether_length",):
        return True
    distance = np.linalg.norm(table[[*POSITION]].to_numpy()[rows], axis=1)
    return bool(np.nanmax(distance) - np.nanmin(distance) > FLOOR[POSITION[0]][0]) if np.isfinite(distance).any() else True


def judge_jumps(table, report):
    """Doubt positions between which no kite can fly, and steps of position or length that their speeds do not explain."""
    allowed = JUMP if VELOCITY[0] in table else (JUMP[0], FASTEST)
    judge_steps(table, POSITION, VELOCITY, allowed, report)
    if "reel_out_speed" in table and "tether_length" in table:
        judge_steps(table, ("tether_length",), ("reel_out_speed",), FLOOR["tether_length"], report)


def judge_steps(table, names, speeds, allowed, report):
    """Doubt steps of a reading that exceed the allowed ones, (m, m/s), plus those that known speeds explain."""
    table = table[["time", *names, *(name for name in speeds if name in table)]].dropna()
    steps = np.diff(table[[*names]].to_numpy(), axis=0)
    time, speed = np.diff(table["time"].to_numpy()), np.zeros((len(table), 1))
    if speeds[0] in table:
        speed = table[[*speeds]].to_numpy()
    way = np.linalg.norm(steps - 0.5 * (speed[1:] + speed[:-1]) * time[:, None], axis=1)
    jumps = np.flatnonzero(way > allowed[0] + allowed[1] * time + FAR_FROM_USUAL * np.median(way)) if len(way) else []
    if len(jumps):
        k = jumps[0]
        name, speed = (each[0].partition("[")[0] for each in (names, speeds))
        why, at = f", which {speed} does not explain" * (speeds[0] in table), table["time"].iloc[k]
        report.doubt(f"{name} jumps {len(jumps)} times, first by {way[k]:.3g} m at {at:.1f} s{why}")
