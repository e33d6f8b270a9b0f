"""Saved states with a right checksum and wrong numbers: refused in words, or harmless. No number in them is trusted."""

import math
import struct
import zlib
from contextlib import suppress
from itertools import product

import pytest
from fmpy.fmi1 import FMICallException

from bounds import most_work
from isolation import in_shared_process
from runtime.host import Host, blob_of, count_of, every_flavour, of_every_flavour, restore
from runtime.test_hostile_input import ALLOWED, COUNTERS, watched
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.saved_state import FACTS, HEADER

FIRST = HEADER.size + FACTS.size  # byte where the values begin, doubles all
TOLERANCE = FIRST - 16  # byte of the last but one of the facts
WRONG = (math.nan, math.inf, -1.0, 0.5, 1e300)


def places_of(host):
    """Byte of a number in a state: of variables, of facts and of what is in the array of the tether."""
    state = FIRST + 8 * count_of(host)
    of_tether = {"a node": at.STATE_HEADER + 4, "warnings": at.WARNINGS, "given derivatives": at.GIVEN_DERIVATIVES}
    return {
        **{name: FIRST + 8 * reference for name, reference in host.reference.items()},
        **{name: state + 8 * place for name, place in of_tether.items()},
        "tolerance": TOLERANCE,
        "time": TOLERANCE + 8,
        "end of the variant's name": HEADER.size + 8,
    }


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
    """Refused: the state of before stays. Taken: outputs are finite, and a step is done or refused, with bounded work.

    Outputs follow from the state of the tether: what is stored of them does not count.
    """
    host, good = flying(fmu_folder / f"{fmu}.fmu")
    outputs, slack = host.all_outputs(), host.get("slack_segments")
    stored = {FIRST + 8 * reference for reference in (*host.real_outputs, host.reference["slack_segments"])}
    taken = set()
    for place in range(TOLERANCE, len(good), 8):
        for value in WRONG:
            if refused(host, forged(good, place, value)):
                assert blob_of(host) == good, (place, value)
                continue
            taken.add(place)
            if place in stored:
                assert (host.all_outputs(), host.get("slack_segments")) == (outputs, slack)
            before = work_of(host)
            try:
                watched(lambda: host.fmu.doStep(0.06, 0.02))
            except FMICallException:
                assert any(words in host.messages[-1] for words in ALLOWED), host.messages
            segments = host.get("segments")
            assert segments * (work_of(host) - before) <= most_work(segments)
            assert not refused(host, good)
    assert stored <= taken
    assert 100 < len(taken) < (len(good) - TOLERANCE) // 8  # values and counters that may be any number; not all of them


REFUSED = [  # positions that no tether has, integers and sets of bits that are none
    *(("tolerance", value, f"has the tolerance {value}; it must be from 0 to 0.0001") for value in WRONG),
    *(("time", value, f"has the time {value} s; it must be a finite number") for value in (math.inf, -math.inf)),
    ("segments", 2.0, "is damaged"),
    *(("segments", value, "") for value in (1e9, math.nan)),
    *((name, value, "") for name in ("a node", "damping_law", "given derivatives") for value in (math.nan, 1e300)),
    *(("warnings", value, "contains impossible numbers") for value in (*WRONG, 2.0**at.WARNING_KINDS)),
]


@every_flavour
@pytest.mark.parametrize(("name", "value", "words"), REFUSED)
@in_shared_process
def test_refused_in_words(fmu_folder, name, value, words):
    host, good = flying(fmu_folder / "TetherDynamic.fmu")
    blob = forged(good, places_of(host)[name], value)
    host.refuses(lambda: restore(host, blob), f"the FMU state that was set {words}")
    assert blob_of(host) == good
    host.step(0.02)


@every_flavour
@in_shared_process
def test_a_name_with_something_behind_it(fmu_folder):
    """Of the variant: nothing follows the zero behind "straight"."""
    host, good = flying(fmu_folder / "TetherStraight.fmu")
    blob = forged(good, places_of(host)["end of the variant's name"], 256 * 5e-324)
    host.refuses(lambda: restore(host, blob), "belongs to another tether FMU")


@of_every_flavour("fmu", ["TetherDynamicFree"], ["TetherDynamicFree"])
@in_shared_process
def test_a_state_of_before_the_start(fmu_folder, fmu):
    """It cannot kill what reads integers, and of the motion in it nothing is read."""
    host, twin = (Host(fmu_folder / f"{fmu}.fmu") for _ in range(2))
    places, good = places_of(host), blob_of(host)
    for name, value in product(("kite_position[1]", "kite_velocity[2]"), (math.nan, 1e300)):
        restore(host, forged(good, places[name], value))
        assert all(map(math.isfinite, host.all_outputs()))
    for each in (host, twin):
        each.start().step(0.02)
    assert host.all_outputs() == twin.all_outputs()
    restore(host, good)
    for name in ("slack_segments", "segments", "damping_law"):
        with suppress(FMICallException):
            restore(host, forged(blob_of(host), places[name], math.nan))
        assert isinstance(host.get(name), int)
