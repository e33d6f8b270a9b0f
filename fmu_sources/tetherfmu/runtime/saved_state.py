"""A saved state as bytes: header, facts, all FMI values, and the state array once the tether is initialized.

Its content is checked before use: a checksum can be right and the numbers wrong.
"""

import struct
import zlib
from array import array
from math import isfinite, isinf
from sys import float_info
from typing import NamedTuple

from . import layout as at
from . import refusals
from .parameters import DEFAULT_TOLERANCE
from .plausibility import bits

MAGIC = b"tether18"  # with the version
HEADER = struct.Struct("<8sII")  # magic, length and checksum of what follows
FACTS = struct.Struct("<16sIIdd")  # the first five of `SavedState`
BEFORE, INITIALIZING, STEPPING, TERMINATED = range(4)  # phases of an instance; from STEPPING on it has a state array

NOT_NEGATIVE, A_STEP = (0.0, float_info.max), (0.0, at.LONGEST_STEP)
STATE_RANGES = {  # smallest and largest number at a place of the state array; all of its numbers are finite
    at.LENGTH: (at.SHORTEST_PART * at.MIN_SEGMENT_LENGTH, float_info.max),
    at.SOLVER_STEP: NOT_NEGATIVE,
    at.SOLVER_ERROR: NOT_NEGATIVE,
    at.LAST_STEP: A_STEP,
    at.LONGEST_SO_FAR: A_STEP,
    **{at.CORRECTIONS_LEFT + k: A_STEP for k in range(3)},
    **{at.PAST_TIMES + k: NOT_NEGATIVE for k in range(at.MOST_PAST)},
    at.STEPS: NOT_NEGATIVE,
    at.REJECTIONS: NOT_NEGATIVE,
    at.ITERATIONS: NOT_NEGATIVE,
    at.TORN_SEGMENT: (0.0, at.MAX_SEGMENTS),
    at.LET_GO: (0.0, 1.0),
    at.TORN_AT: NOT_NEGATIVE,
    at.LET_GO_AT: NOT_NEGATIVE,
    at.CLOCK: NOT_NEGATIVE,
    at.RUN_OFF: (0.0, 15.0),
    **{place: NOT_NEGATIVE for place in range(at.SECOND_PART, at.END_LUMP + 1)},
    **{at.WARNED_VALUES + kind: NOT_NEGATIVE for kind in range(at.WARNING_KINDS)},
}


class SavedState(NamedTuple):
    """All that an instance needs to continue, bit for bit."""

    variant: str
    phase: int  # one of the four above
    segments: int
    tolerance: float  # the importer's, 0 for none
    time: float  # [s], NaN before the first step
    values: array  # all FMI values
    state: array  # empty before STEPPING


def to_bytes(saved):
    """The record as bytes."""
    body = FACTS.pack(saved.variant.encode(), *saved[1:5]) + saved.values.tobytes() + saved.state.tobytes()
    return HEADER.pack(MAGIC, len(body), zlib.crc32(body)) + body


def from_bytes(blob, variant, count, state_size=at.state_size):
    """The record from bytes of `to_bytes`.

    variant : of the FMU that reads.  count : number of its FMI values.  state_size : function of the number of segments, the
    length of the state array.  ValueError describes a problem of the bytes.
    """
    smallest = HEADER.size + FACTS.size
    if not isinstance(blob, bytes) or len(blob) < smallest or not blob.startswith(MAGIC):
        raise ValueError(refusals.NO_STATE)
    _, length, checksum = HEADER.unpack_from(blob)
    if length != len(blob) - HEADER.size or zlib.crc32(blob[HEADER.size :]) != checksum:
        raise ValueError(refusals.STATE_DAMAGED)
    name, phase, segments, tolerance, time = FACTS.unpack_from(blob, HEADER.size)
    numbers = count + (state_size(segments) if phase >= STEPPING else 0)
    if name.rstrip(b"\0") != variant.encode() or phase > TERMINATED or len(blob) != smallest + 8 * numbers:
        raise ValueError(refusals.STATE_OF_ANOTHER)
    if not 0.0 <= tolerance <= DEFAULT_TOLERANCE:
        raise ValueError(refusals.STATE_WRONG_TOLERANCE.format(tolerance=tolerance, largest=DEFAULT_TOLERANCE))
    if isinf(time):
        raise ValueError(refusals.STATE_WRONG_TIME.format(time=time))
    doubles = array("d", blob[smallest:])
    return SavedState(variant, phase, segments, tolerance, time, doubles[:count], doubles[count:])


def check_state(state):
    """ValueError if a state array has numbers that no tether has."""
    possible = all(map(isfinite, state))
    if not (possible and all(lowest <= state[place] <= highest for place, (lowest, highest) in STATE_RANGES.items())):
        raise ValueError(refusals.STATE_IMPOSSIBLE)
    bits(state[at.WARNINGS], at.WARNING_KINDS)
    bits(state[at.GIVEN_DERIVATIVES], at.INPUTS)
