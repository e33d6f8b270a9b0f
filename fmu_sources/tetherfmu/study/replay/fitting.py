"""Corrections that reconcile length and position of a log: found on one part, judged on another."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.stats import t as student

from . import delays
from .driven_tethers import SEGMENTS, fly
from .flight import SHORTEST, Correction
from .log import LogError

AT_START = "length at 0 s of the log m"  # meaning of the offset if the log has no length, but the speed
NAMES = {"offset": "length offset m", "origin": ("origin east m", "origin north m", "origin up m"), "delay": "delay s"}
BLOCKS = 20  # blocks of the part, for the uncertainty
CONFIDENCE = 0.95  # probability that all intervals are valid
PULLED = 3.0  # tension over the weight of the tether, below which it hangs or lies: sag makes 0.5 % of the length there
SETTLED = 2.0  # s from the start, after which the tether has forgotten it
FEWEST = 100  # rows of a taut tether
ROUNDS = 6  # of Gauss and Newton, at most
SMALL = 0.05  # of the half width of its interval: a step of a number after which it is found
LARGEST = 0.9999  # correlation of two indistinguishable columns


@dataclass(frozen=True)
class Fit:
    """Result of a fit: `correction`, and by name its numbers with the half widths of their intervals, dict of pairs.

    All intervals are valid with the probability `CONFIDENCE`.  `rms` : residual on the part of the fit [m].
    """

    correction: Correction
    found: dict
    rms: float
    start: float
    end: float

    def __str__(self):
        """The numbers with their intervals."""
        numbers = ", ".join(f"{name} {value:+.3g} ± {half:.2g}" for name, (value, half) in self.found.items())
        return f"fitted from {self.start:.1f} to {self.end:.1f} s: {numbers}; residual {self.rms:.2f} m rms"


def fit(flight, wanted=("offset",), segments=SEGMENTS):
    """`Fit` of a taut part of a `Flight`: some of "offset", "origin" and "delay". segments : of the tether.

    The dynamic tether follows the measured tension along the logged positions. Its length minus the logged one is, to first
    order, offset - u d - tau u v with the direction u of the kite, its velocity v, the error d of the origin and the delay
    tau of the positions: least squares, repeated from the corrected positions until convergence. Intervals come from the
    jackknife over `BLOCKS` consecutive parts, since position errors are correlated over seconds (Kunsch, Annals of
    Statistics 17, 1989). LogError if the tether is never taut, or if the part cannot distinguish two of them.
    """
    refuse_unknown_length(flight, wanted)
    names = [name for each in wanted for name in np.atleast_1d(NAMES[each])]
    values = np.zeros(len(names))
    if NAMES["delay"] in names:  # far from the right one the residual has minima of its own
        values[names.index(NAMES["delay"])] = delays.of_position(flight.log)
    for _ in range(ROUNDS):
        rest, columns, taut = residual(flight.corrected(correction_of(names, values)), wanted, segments)
        refuse_alike(columns[taut], names)
        step, half = jackknife(columns[taut], rest[taut])
        values, rest = values + step, rest - columns @ step
        if abs(delay := correction_of(names, values).delay) > delays.RANGE:
            allowed = f"{delay:.3g} s would fit; at most {delays.RANGE:g} s is allowed"
            raise LogError(f"no delay can be fitted on this part of the flight: {allowed}")
        if np.all(np.abs(step) <= SMALL * half) or names == [NAMES["offset"]]:  # which the tether does not feel
            break
    correction = correction_of(names, values)
    if "tether_length" not in flight.log.table:
        names[names.index(NAMES["offset"])] = AT_START
    found = {name: (float(value), float(width)) for name, value, width in zip(names, values, half, strict=True)}
    return Fit(correction, found, float(np.sqrt(np.mean(rest[taut] ** 2))), flight.start, flight.end)


def refuse_unknown_length(flight, wanted):
    """LogError unless a log has data for a fit."""
    if not flight.has_length:
        raise flight.log.wrong("has neither tether_length nor reel_out_speed: nothing can be fitted")
    if "tether_length" not in flight.log.table and "offset" not in wanted:
        raise flight.log.wrong(
            f"has no tether_length: {', '.join(wanted)} can be fitted only with offset, then the length at the start"
        )


def test(found, flight):
    """A sentence on the quality of a `Fit` on the part of a `Flight` after the part of the fit."""
    start = max(flight.start, found.end)
    if flight.end - start < SHORTEST:
        return "not tested: the fit used the whole flight"
    part = flight.part(start, flight.end).corrected(found.correction)
    try:
        rest, _, taut = residual(part, ("offset",))
    except LogError:
        return f"not tested: the tether is nowhere taut from {start:.1f} to {flight.end:.1f} s"
    mean, scatter = rest[taut].mean(), rest[taut].std()
    stiffness = flight.log.map.tether.axial_stiffness / part.length(part.times)[taut].mean()
    force = 1e-3 * stiffness * np.hypot(mean, scatter)
    return (
        f"tested from {start:.1f} to {flight.end:.1f} s: mean error of the length {mean:+.2f} m, scatter {scatter:.2f} m; "
        f"at {1e-3 * stiffness:.3g} kN/m this is equivalent to {force:.3g} kN"
    )


def correction_of(names, values):
    """`Correction` of the numbers of `NAMES`."""
    known = dict(zip(names, values, strict=True))
    origin = tuple(float(known.get(name, 0.0)) for name in NAMES["origin"])
    return Correction(float(known.get(NAMES["offset"], 0.0)), origin, float(known.get(NAMES["delay"], 0.0)))


def residual(flight, wanted, segments=SEGMENTS):
    """Length of the tether minus the logged one [m], (times,), minus its derivatives, (times, numbers), where it is taut.

    LogError if it is nowhere taut.
    """
    time = flight.times
    length = fly(flight, "dynamic", "tension", segments, shape_points=0).table.tether_length.to_numpy()
    position, velocity = flight.kite(time)
    distance = np.linalg.norm(position, axis=1)
    direction = position / distance[:, None]
    rest = length - flight.length(time)
    slopes = {"offset": np.ones((len(time), 1)), "origin": -direction}
    slopes["delay"] = -np.sum(direction * velocity, axis=1, keepdims=True)
    pulled = flight.measured("ground_tension", time) > PULLED * flight.log.map.weight * distance
    taut = np.isfinite(rest) & flight.is_taut(length) & pulled
    there = time + flight.correction.delay  # beyond the ends of the log the kite is at rest
    taut[(time < time[0] + SETTLED) | (there < flight.log.time[0] + SETTLED) | (there > flight.log.time[-1])] = False
    if taut.sum() < FEWEST:
        part = f"from {flight.start:g} to {flight.end:g} s"
        raise flight.log.cannot_fly(f"the tether is nowhere taut {part}: nothing can be fitted")
    return rest, np.hstack([slopes[each] for each in wanted]), taut


def refuse_alike(columns, names):
    """LogError if two numbers affect the residual equally on this part."""
    scaled = columns / np.maximum(np.linalg.norm(columns, axis=0), 1e-12)
    alike = np.abs(np.triu(scaled.T @ scaled, 1))
    if alike.size and alike.max() > LARGEST:
        one, other = (names[k] for k in np.unravel_index(alike.argmax(), alike.shape))
        raise LogError(
            f"this part of the flight cannot distinguish {one} from {other}: fit one of them, or a part with more motion"
        )


def jackknife(columns, rest):
    """Least squares of columns x = rest, and the half widths of intervals of x, two arrays (numbers,)."""
    edges = np.linspace(0, len(rest), BLOCKS + 1).astype(int)
    squares = [columns[i:j].T @ columns[i:j] for i, j in pairwise(edges)]
    rights = [columns[i:j].T @ rest[i:j] for i, j in pairwise(edges)]
    whole, right = np.sum(squares, axis=0), np.sum(rights, axis=0)
    best = np.linalg.lstsq(whole, right)[0]
    without = np.array([np.linalg.lstsq(whole - a, right - b)[0] for a, b in zip(squares, rights, strict=True)])
    deviation = np.sqrt((BLOCKS - 1) / BLOCKS * np.sum((without - without.mean(axis=0)) ** 2, axis=0))
    quantile = student.ppf(1.0 - 0.5 * (1.0 - CONFIDENCE) / len(best), BLOCKS - 1)
    return best, quantile * deviation
