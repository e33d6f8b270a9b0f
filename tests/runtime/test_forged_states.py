"""Saved states with a right checksum and wrong numbers: refused in words, or harmless. No number in them is trusted."""

import math
import struct
import zlib

import pytest
from fmpy.fmi1 import FMICallException

from bounds import most_work
from isolation import in_shared_process
from runtime.host import Host, blob_of, every_flavour, of_every_flavour, restore
from runtime.test_hostile_input import ALLOWED, COUNTERS, watched
from tetherfmu.runtime.saved_state import FACTS, HEADER

FIRST = HEADER.size + FACTS.size  # byte where the values begin, doubles all
TOLERANCE, TIME = FIRST - 16, FIRST - 8  # the last two of the facts
WRONG = (math.nan, math.inf, -1.0, 1e300)


def forged(blob, place, value):
    """A state with another double at a byte, and the checksum that belongs to it."""
    changed = bytearray(blob)
    struct.pack_into("<d", changed, place, value)
    struct.pack_into("<I", changed, HEADER.size - 4, zlib.crc32(changed[HEADER.size :]))
    return bytes(changed)


def flying(path):
    """A tether of few segments after some steps, and its state."""
    host = Host(path).start(segments=3, initial_length=525.0)
    for _ in range(3):
        host.step(0.02, wind_velocity=(5.0, 1.0, 0.0))
    return host, blob_of(host)


def work_of(host):
    """Internal steps and iterations so far; all outputs are finite."""
    assert all(map(math.isfinite, host.all_outputs()))
    return sum(map(host.get, COUNTERS))


def refused(host, blob):
    """Whether a state is refused in words."""
    host.messages.clear()
    try:
        restore(host, blob)
    except FMICallException:
        assert host.native
    said = [message for message in host.messages if "the FMU state that was set" in message]
    assert len(said) == len(host.messages)
    return bool(said)


@of_every_flavour("fmu")
@in_shared_process
def test_every_number_is_refused_or_harmless(fmu_folder, fmu):
    """Refused: the state of before stays. Taken: outputs are finite, and a step is done or refused, with bounded work."""
    host, good = flying(fmu_folder / f"{fmu}.fmu")
    taken = set()
    for place in range(TOLERANCE, len(good), 8):
        for value in WRONG:
            if refused(host, forged(good, place, value)):
                assert blob_of(host) == good, (place, value)
                continue
            taken.add(place)
            before = work_of(host)
            try:
                watched(lambda: host.fmu.doStep(0.06, 0.02))
            except FMICallException:
                assert any(words in host.messages[-1] for words in ALLOWED), host.messages
            segments = host.get("segments")
            assert segments * (work_of(host) - before) <= most_work(segments)
            assert not refused(host, good)
    assert 100 < len(taken) < (len(good) - TOLERANCE) // 8  # values and counters that may be any number; not all of them


@every_flavour
@pytest.mark.parametrize(
    ("place", "value", "words"),
    [
        *((TOLERANCE, value, f"has the tolerance {value}; it must be from 0 to 0.0001") for value in WRONG),
        *((TIME, value, f"has the time {value} s; it must be a finite number") for value in (math.inf, -math.inf)),
    ],
)
@in_shared_process
def test_tolerance_and_time(fmu_folder, place, value, words):
    host, good = flying(fmu_folder / "TetherDynamic.fmu")
    host.refuses(lambda: restore(host, forged(good, place, value)), f"the FMU state that was set {words}")
    assert blob_of(host) == good
    host.step(0.02)


@every_flavour
@in_shared_process
def test_a_name_with_something_behind_it(fmu_folder):
    """Of the variant: nothing follows the zero behind "straight"."""
    host, good = flying(fmu_folder / "TetherStraight.fmu")
    (number,) = struct.unpack_from("<d", good, HEADER.size + 8)
    assert number == 0.0
    host.refuses(lambda: restore(host, forged(good, HEADER.size + 8, 256 * 5e-324)), "belongs to another tether FMU")
