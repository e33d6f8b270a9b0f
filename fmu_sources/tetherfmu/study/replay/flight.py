"""A prepared flight: smooth motion of the kite end of the tether, and the input of the winch."""

from dataclasses import dataclass, replace

import numpy as np
import pandas as pd
from scipy.interpolate import CubicHermiteSpline
from scipy.signal import savgol_filter

from tetherfmu.runtime.inputs import COUNT, by_name

from . import checks, delays
from .log import Log
from .readings import POSITION, VELOCITY, WIND, between
from .smoothing import Smoothed, smooth

SHORTEST = 5.0  # s, a flight
EVERY = 0.1  # s between two rows of the results
TAUT = 0.01  # length over distance, minus 1, below which a tether is taut
STEP = 0.02  # communication step of the tethers [s]
EVENED = 1.0  # s, smoothing of a length that drives the winch: otherwise quanta of a log accelerate the rope
LEADS = {"tension": "force", "length": "length", "speed": "speed"}  # and how the winch is then controlled
MEASURED = {"tension": "ground_tension", "length": "tether_length", "speed": "reel_out_speed"}


@dataclass(frozen=True)
class Correction:
    """Corrections that are added to a log, so that its quantities agree; see `fitting`."""

    length: float = 0.0  # to the length [m]
    origin: tuple = (0.0, 0.0, 0.0)  # to the positions [m]
    delay: float = 0.0  # latency of the positions in the log [s]


@dataclass(frozen=True)
class Flight:
    """A part of a log, from `start` to `end` [s].

    `motion` : `Smoothed` over the times of the whole `log`, of the end of the tether, seen from the outlet of the winch.
    """

    log: Log
    motion: Smoothed
    start: float
    end: float
    correction: Correction = Correction()

    @property
    def times(self):
        """Times [s] of the results: every `EVERY` from the start on."""
        return self.start + EVERY * np.arange(1 + int((self.end - self.start) / EVERY + 1e-6))

    def part(self, start, end):
        """The part of the flight from start to end [s]; LogError if the log has no such part."""
        start, end = part_of(self.log, start, end)
        return replace(self, start=start, end=end)

    def corrected(self, correction):
        """The flight with a `Correction`."""
        return replace(self, correction=correction)

    def kite(self, time):
        """Position [m] and velocity [m/s] of the end of the tether, arrays (times, 3)."""
        curve = CubicHermiteSpline(self.log.time, self.motion.position, self.motion.velocity)
        late = np.clip(time + self.correction.delay, self.log.time[0], self.log.time[-1])
        return curve(late) + self.correction.origin, curve(late, 1)

    def measured(self, name, time):
        """A measured quantity at some times, array (times,), linear between readings; NaN where it is not known."""
        if name not in self.log.table:
            return np.full(len(time), np.nan)
        values = self.log.table[name].to_numpy()
        known = np.isfinite(values)
        own = self.log.time[known] - getattr(self.log.map.delay, name, 0.0)
        return between(time, own, values[known], self.log.map.smoothing.longest_gap)

    def length(self, time):
        """Unstretched length [m] from the winch to the kite by the log, array (times,), with its correction.

        Without a logged length the integral of the reel-out speed, from 0 at the start of the log; NaN without both.
        """
        if "tether_length" in self.log.table or not self.has_length:
            measured = self.log.map.station.length_outside(self.measured("tether_length", time))
        else:
            own = self.log.time
            speed = np.nan_to_num(self.measured("reel_out_speed", own))
            paid = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * np.diff(own))])
            measured = np.interp(time, own, paid)
        return measured + self.correction.length

    def is_taut(self, length):
        """Where a tether of this unstretched length [m], array (times,), is so taut that it is nearly straight."""
        distance = np.linalg.norm(self.kite(self.times)[0], axis=1)
        return length < (1.0 + TAUT) * distance

    @property
    def has_length(self):
        """Whether the log contains changes of the length."""
        return "tether_length" in self.log.table or "reel_out_speed" in self.log.table

    @property
    def has_whole_length(self):
        """Whether the length is known, not only its changes: it is logged, or its initial value was fitted."""
        return "tether_length" in self.log.table or (self.has_length and self.correction.length != 0.0)

    def require(self, lead):
        """LogError unless the log has the quantity that drives a winch: "tension", "length" or "speed"."""
        if MEASURED[lead] in self.log.table or (lead == "length" and self.has_whole_length):
            return
        there = ", ".join(each for each in MEASURED.values() if each in self.log.table)
        fitted = lead == "length" and self.has_length and "ground_tension" in self.log.table
        more = ", unless --fit offset finds that at the start" if fitted else ""
        raise self.log.wrong(
            f"has no {MEASURED[lead]}: the winch cannot follow the {lead}{more}; the log has {there or 'nothing to follow'}"
        )

    def wind(self, time):
        """Wind at the reference height [m/s], averaged, array (times, 3); no wind if the log has none."""
        readings = self.log.of(WIND)
        if readings is None:
            return np.zeros((len(time), 3))
        rows = max(1, round(self.log.map.smoothing.wind_mean / np.median(np.diff(self.log.time))))
        mean = pd.DataFrame(readings).rolling(rows, center=True, min_periods=1).mean().interpolate(limit_direction="both")
        return np.column_stack([np.interp(time, self.log.time, column) for column in mean.to_numpy().T])

    def signals(self):
        """Motion of the end of the tether and wind at the times of the results, a DataFrame with a column `time`."""
        position, velocity = self.kite(self.times)
        vectors = {POSITION: position, VELOCITY: velocity, WIND: self.wind(self.times)}
        columns = {name: column for names, values in vectors.items() for name, column in zip(names, values.T, strict=True)}
        return pd.DataFrame({"time": self.times} | columns)

    def inputs(self, lead, step=STEP):
        """Inputs of a tether, array (steps, INPUTS): the motion of the kite, the wind, and the winch input.

        lead : "tension", "length" or "speed".  LogError names a gap in it.
        """
        time = np.arange(round((self.times[-1] - self.start) / step)) * step + self.start
        rows = np.zeros((len(time), COUNT))
        into = by_name(rows)
        into["kite_position"][:], into["kite_velocity"][:] = self.kite(time)
        into["wind_velocity"][:] = self.wind(time)
        led = self.length(time) if lead == "length" else self.measured(MEASURED[lead], time)
        if not np.isfinite(led).all():
            gap = time[~np.isfinite(led)][0]
            raise self.log.wrong(f"{MEASURED[lead]} drives the winch and has no reading at {gap:.1f} s")
        if lead == "length":
            led = savgol_filter(led, round(EVENED / step) | 1, 3)
        into[{"tension": "winch_force", "length": "winch_length", "speed": "reel_out_speed"}[lead]][:, 0] = led
        return rows


def prepare(log, start=None, end=None):
    """`Flight` of a `Log` from start to end [s] of its time, None: all of it. LogError describes a problem."""
    checks.check(log)
    first, last = log.time[0], log.time[-1]
    start, end = part_of(log, first if start is None else start, last if end is None else end)
    position, velocity = at_end_of_tether(log)
    refuse_gaps(log, position, start, end)
    noise = log.map.smoothing
    motion = smooth(log.time, position, velocity, noise)
    rough = np.sqrt(np.nanmean((position - motion.position) ** 2))
    also = f" and velocities (noise {noise.velocity_noise:g} m/s)" if log.of(VELOCITY) is not None else ""
    changing = f"acceleration changing by {noise.acceleration_change:g} m/s2 in 1 s"
    log.report.say(
        f"smoothed: positions (noise {noise.position_noise:g} m){also}, {changing}; correction {rough:.2f} m rms, "
        f"remaining uncertainty {motion.deviation:.2f} m"
    )
    return Flight(log, motion, start, end)


def part_of(log, start, end):
    """Start and end [s] of a part of a log; LogError if the log does not have it."""
    first, last = log.time[0], log.time[-1]
    if not (first <= start and start + SHORTEST <= end <= last):
        raise log.wrong(
            f"the part from {start:g} to {end:g} s is not possible: the log has {first:g} to {last:.1f} s, and the shortest "
            f"flight is {SHORTEST:g} s"
        )
    return float(start), float(end)


def at_end_of_tether(log):
    """Position [m] and velocity [m/s] of the end of the tether, seen from the outlet, arrays (rows, 3); NaN: not known."""
    log = delays.moved_by(log, vars(log.map.delay))
    position, velocity = log.of(POSITION) - np.array(log.map.station.outlet), log.of(VELOCITY)
    if velocity is None:
        velocity = np.full_like(position, np.nan)
    if log.map.kite.end_below:
        distance = np.linalg.norm(position, axis=1, keepdims=True)
        if (nearest := np.nanmin(distance)) <= log.map.kite.end_below:
            raise log.wrong(
                f"kite.end_below is {log.map.kite.end_below:g} m, and kite_position comes as near as {nearest:.3g} m to the "
                "outlet of the winch; it must be farther away"
            )
        factor = 1.0 - log.map.kite.end_below / distance
        radial = np.sum(position * velocity, axis=1, keepdims=True) / distance
        velocity = factor * velocity + (1.0 - factor) * radial * position / distance
        position = factor * position
        log.report.say(f"moved: positions by kite.end_below = {log.map.kite.end_below:g} m towards the station")
    return position, velocity


def refuse_gaps(log, position, start, end):
    """LogError if the position is not known for too long; a line on the gaps that are bridged."""
    known = np.isfinite(position).all(axis=1)
    time = log.time[known]
    time = np.concatenate([[start], time[(time > start) & (time < end)], [end]])
    gaps, usual = np.diff(time), np.median(np.diff(log.time))
    longest = log.map.smoothing.longest_gap
    k = np.argmax(gaps)
    if gaps[k] > longest:
        row = np.searchsorted(log.time, time[k + 1])
        jump = row and log.time[row] - log.time[row - 1]
        why = f": the time jumps by {jump:.1f} s at row {log.rows[row]} of the file" if jump > longest else ""
        raise log.wrong(
            f"no position is known from {time[k]:.1f} to {time[k + 1]:.1f} s{why}; replay a part (--from, "
            f"--to), or allow it with smoothing.longest_gap (now {longest:g} s)"
        )
    bridged = gaps > 1.5 * usual
    log.report.count("bridged", int(bridged.sum()), len(gaps), f"gaps of up to {gaps[k]:.2f} s in the position")
