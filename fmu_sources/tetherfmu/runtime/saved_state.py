"""A saved state as bytes: header, facts, all FMI values, and the state array once the tether is initialized."""

import struct
import zlib
from array import array
from typing import NamedTuple

from . import layout as at
from .refusals import NO_STATE, STATE_DAMAGED, STATE_OF_ANOTHER

MAGIC = b"tether07"  # with the version
HEADER = struct.Struct("<8sII")  # magic, length and checksum of what follows
FACTS = struct.Struct("<16sIIdd")  # the first five of `SavedState`
BEFORE, INITIALIZING, STEPPING, TERMINATED = range(4)  # phases of an instance; from STEPPING on it has a state array


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
    """The record in bytes of `to_bytes`.

    variant : of the FMU that reads.  count : number of its FMI values.  state_size : function of the number of segments, the
    length of the state array.  ValueError says what is wrong with the bytes.
    """
    smallest = HEADER.size + FACTS.size
    if not isinstance(blob, bytes) or len(blob) < smallest or not blob.startswith(MAGIC):
        raise ValueError(NO_STATE)
    _, length, checksum = HEADER.unpack_from(blob)
    if length != len(blob) - HEADER.size or zlib.crc32(blob[HEADER.size :]) != checksum:
        raise ValueError(STATE_DAMAGED)
    name, phase, segments, tolerance, time = FACTS.unpack_from(blob, HEADER.size)
    numbers = count + (state_size(segments) if phase >= STEPPING else 0)
    if name.rstrip(b"\0") != variant.encode() or phase > TERMINATED or len(blob) != smallest + 8 * numbers:
        raise ValueError(STATE_OF_ANOTHER)
    doubles = array("d", blob[smallest:])
    return SavedState(variant, phase, segments, tolerance, time, doubles[:count], doubles[count:])
