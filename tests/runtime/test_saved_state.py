"""A saved state reads back to the same numbers; any damage is found and named, and nothing but ValueError comes of it."""

import struct
from array import array
from math import nan, pi

import pytest

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.saved_state import (
    BEFORE,
    FACTS,
    HEADER,
    INITIALIZING,
    STEPPING,
    TERMINATED,
    SavedState,
    from_bytes,
    to_bytes,
)

VALUES = array("d", [1.5, -0.0, nan, 5e-324, 1e308, pi])
SEGMENTS = 3
STATE = array("d", [0.1 * k for k in range(at.state_size(SEGMENTS))])


def saved(phase=STEPPING):
    return SavedState("quasi_steady", phase, SEGMENTS, 1e-5, 0.3, VALUES, STATE if phase >= STEPPING else array("d"))


def read(blob, variant="quasi_steady", count=6):
    return from_bytes(blob, variant, count)


@pytest.mark.parametrize("phase", [BEFORE, INITIALIZING, STEPPING, TERMINATED])
def test_round_trip(phase):
    again = read(to_bytes(saved(phase)))
    assert again[:5] == saved(phase)[:5]
    assert again.values.tobytes() == VALUES.tobytes()  # signs of zero and NaN too
    assert again.state.tobytes() == saved(phase).state.tobytes()
    assert to_bytes(again) == to_bytes(saved(phase))


def test_layout_of_the_bytes():
    """Magic, length and checksum (16 bytes), facts (40 bytes), then doubles: it never changes under this magic."""
    blob = to_bytes(saved())
    assert len(blob) == 56 + 8 * (len(VALUES) + len(STATE))
    assert struct.unpack_from("<8sI", blob) == (b"tether18", len(blob) - 16)
    assert struct.unpack_from("<16sIIdd", blob, 16) == (b"quasi_steady".ljust(16, b"\0"), STEPPING, SEGMENTS, 1e-5, 0.3)
    assert (HEADER.size, FACTS.size) == (16, 40)


def test_every_byte_is_guarded():
    blob = to_bytes(saved())
    for place in range(len(blob)):
        damaged = bytearray(blob)
        damaged[place] ^= 1 << place % 8
        with pytest.raises(ValueError, match=r"is not a tether state" if place < 8 else r"^is damaged$"):
            read(bytes(damaged))


def test_every_length_is_guarded():
    blob = to_bytes(saved())
    for length in range(len(blob)):
        with pytest.raises(ValueError, match=r"^is not a tether state, or comes from another version$|^is damaged$"):
            read(blob[:length])
    with pytest.raises(ValueError, match=r"^is damaged$"):
        read(blob + b"\0")


@pytest.mark.parametrize("blob", [None, 5, "tether05" * 10, bytearray(to_bytes(saved())), b""])
def test_what_is_no_state(blob):
    with pytest.raises(ValueError, match="is not a tether state"):
        read(blob)


def test_of_another_tether():
    blob = to_bytes(saved())
    for other in ({"variant": "dynamic"}, {"variant": "quasi"}, {"count": len(VALUES) - 1}, {"count": len(VALUES) + 1}):
        with pytest.raises(ValueError, match="belongs to another tether FMU"):
            read(blob, **other)
    for forged in ({"phase": TERMINATED + 1}, {"segments": SEGMENTS + 1}, {"segments": 2**32 - 1}, {"phase": BEFORE}):
        with pytest.raises(ValueError, match="belongs to another tether FMU"):
            read(to_bytes(saved()._replace(**forged)))
