"""Verdict on one point of the stability map, from its flight and the flight of its refinement.

The words are explained on the page (`page.md.j2`). Also stable: a point whose refinement is refused (error: none).
Hanging: a call took longer than `LONGEST_CALL` of the processor, or the process of the point was ended for taking too long.

Error: root mean square difference of both end forces over root mean square of the refined ones plus the weight.
"""

from typing import NamedTuple

import numpy as np

from .flight import LINE_DENSITY, fly

HELD, FORBIDDEN = ("converged", "stable"), ("wrong", "crashed", "hanging")
VERDICTS = (*HELD, "refused", *FORBIDDEN)
CONVERGED = 0.01
LONGEST_CALL = 2.0  # [s]


class Verdict(NamedTuple):
    """What came of a point."""

    verdict: str  # a word of `VERDICTS`
    error: float | None = None  # [-]
    refusal: str = ""  # its name
    calls: int = 0  # communication steps done, the start included
    tension_ratio: float = 0.0  # largest tension over its bound [-]
    speed_ratio: float = 0.0  # largest speed over its bound [-]
    work: float = 0.0  # segments times internal steps
    longest: float = 0.0  # call [s]


def difference(point, flight, refined):
    """Error of a flight [-] against its refinement, inf beyond all numbers; None where the refinement has only the start.

    Two flights without any force have no error.
    """
    count = min(len(flight.forces), len(refined.forces))
    if count < 2:
        return None
    a, b = flight.forces[:count], refined.forces[:count]
    size = np.sqrt(np.mean(b**2)) + LINE_DENSITY * point.length * point.gravity
    error = np.sqrt(np.mean((a - b) ** 2))
    return float(np.nan_to_num(error / size, nan=np.inf)) if error else 0.0


def judge(point):
    """Fly a point, and its refinement where that makes sense; returns its `Verdict`."""
    flight = fly(point)
    calls, ratios = len(flight.forces), (float(flight.peak / flight.bound), float(flight.fastest / flight.speed_bound))
    error = None
    if flight.longest > LONGEST_CALL:
        verdict = "hanging"
    elif not flight.finite or max(ratios) > 1.0:
        verdict = "wrong"
    elif flight.refusal:
        verdict = "refused"
    else:
        error = difference(point, flight, fly(point, refinement=2, calls=calls - 1, most_work=np.inf))
        verdict = "converged" if error is not None and error <= CONVERGED else "stable"
    return Verdict(verdict, error, flight.refusal, calls, *ratios, flight.work, flight.longest)
