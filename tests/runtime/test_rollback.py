"""A saved state continues bit for bit in any order and in another process; damaged and forged ones are refused.

After a reset, a refused step and the end, and in another flavour: `test_flavours.py`.
"""

import math
import multiprocessing
from contextlib import suppress

import pytest
from fmpy.fmi1 import FMICallException

from isolation import in_own_process, in_shared_process
from runtime.host import STEP, Host, blob_of, count_of, every_flavour, fly, of_every_flavour, restore, started
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.saved_state import from_bytes, to_bytes


def continue_from(path, blob, begin, end):
    """For another process: a fresh instance that only gets the state."""
    host = Host(path)
    restore(host, blob)
    return fly(host, begin, end)


@of_every_flavour("fmu")
@in_shared_process
def test_at_every_communication_point_in_any_order(fmu_folder, fmu):
    host = started(fmu_folder / f"{fmu}.fmu")
    blobs, rows = [], []
    for k in range(30):
        blobs.append(blob_of(host))
        rows += fly(host, k, k + 1)
    for k in (29, 3, 17, 0, 11, 28, 0, 5):
        restore(host, blobs[k])
        assert blob_of(host) == blobs[k]
        assert fly(host, k, 30) == rows[k:]


@of_every_flavour("fmu")
@in_own_process
def test_in_another_process(fmu_folder, fmu):
    path = fmu_folder / f"{fmu}.fmu"
    host = started(path)
    fly(host, 0, 20)
    blob = blob_of(host)
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        elsewhere = pool.apply(continue_from, (path, blob, 20, 40))
    assert fly(host, 20, 40) == elsewhere


@of_every_flavour("fmu")
@in_shared_process
def test_before_and_during_initialization(fmu_folder, fmu):
    """A state that was saved before the tether was started goes back to there, with its parameters."""
    host = Host(fmu_folder / f"{fmu}.fmu")
    host.set(initial_length=525.0)
    instantiated = blob_of(host)
    host.fmu.setupExperiment(startTime=0.0)
    host.fmu.enterInitializationMode()
    host.set(initial_length=530.0)
    initializing = blob_of(host)
    host.fmu.exitInitializationMode()
    longer = host.all_outputs()
    restore(host, instantiated)
    host.start()
    assert host.get("tether_length") == 525.0
    restore(host, initializing)
    host.fmu.exitInitializationMode()
    assert host.all_outputs() == longer


@every_flavour
@in_shared_process
def test_size_of_a_state(fmu_folder):
    """Header 56 bytes, all values, 251 numbers of the tether and 6 of each node, with room for one more."""
    host = started(fmu_folder / "TetherDynamic.fmu")
    values = len({v.valueReference for v in host.description.modelVariables})
    kite_load, kite_motion = 3, 6  # have places among the inputs and the outputs but no variables in this FMU
    assert len(blob_of(host)) == 56 + 8 * (values + kite_load + kite_motion + 251 + 6 * 22)


@every_flavour
@pytest.mark.parametrize("kept", [0, 7, 16, 55, 56, 500, -8, -1])
@in_shared_process
def test_truncated_state(fmu_folder, kept):
    host = started(fmu_folder / "TetherDynamic.fmu")
    before = host.all_outputs()
    host.refuses(lambda: restore(host, blob_of(host)[:kept]), "the previous state is kept")
    assert host.all_outputs() == before
    host.step(STEP)


@every_flavour
@in_shared_process
def test_forged_state(fmu_folder):
    """A state with a valid checksum but parameters that do not fit its nodes is refused as well."""
    import struct
    import zlib

    host = started(fmu_folder / "TetherDynamic.fmu")
    blob = bytearray(blob_of(host))
    place = 56 + 8 * host.reference["segments"]
    for segments, words in ((19.0, "is damaged"), (1e9, "segments is"), (math.nan, "segments is")):
        blob[place : place + 8] = struct.pack("<d", segments)
        blob[12:16] = struct.pack("<I", zlib.crc32(blob[16:]))
        host.refuses(lambda: restore(host, bytes(blob)), words)
    host.step(STEP)


def forged(host, place, value):
    """The state of now with another number at a value reference, or at a negative place of the state array."""
    saved = from_bytes(blob_of(host), "dynamic", count_of(host))
    (saved.values if place >= 0 else saved.state)[place] = value
    return to_bytes(saved)


@every_flavour
@pytest.mark.parametrize("value", [math.nan, math.inf, 1e300, 0.5])
@in_shared_process
def test_forged_outputs_are_computed_anew(fmu_folder, value):
    """Outputs follow from the state: what is stored of them does not count, also not of Integer ones."""
    host, twin = (started(fmu_folder / "TetherDynamic.fmu") for _ in range(2))
    fly(host, 0, 5)
    outputs, slack = host.all_outputs(), host.get("slack_segments")
    for place in (*host.real_outputs, host.reference["slack_segments"]):
        restore(host, forged(host, place, value))
    assert (host.all_outputs(), host.get("slack_segments")) == (outputs, slack)
    fly(twin, 0, 5)
    assert fly(host, 5, 10) == fly(twin, 5, 10)


ROOM = 6  # numbers at the end of a state, for a node more
SETS = {"warnings": at.WARNINGS - at.state_size(20), "given derivatives": at.GIVEN_DERIVATIVES - at.state_size(20)}


@every_flavour
@pytest.mark.parametrize("name", ["a node", "segments", "damping_law", *SETS])
@pytest.mark.parametrize("value", [math.nan, 1e300])
@in_shared_process
def test_forged_states_are_refused(fmu_folder, name, value):
    """Positions that no tether has, and integers and sets of bits that are none; the state of before continues."""
    host, twin = (started(fmu_folder / "TetherDynamic.fmu") for _ in range(2))
    fly(host, 0, 5)
    fly(twin, 0, 5)
    blob = forged(host, SETS.get(name) or host.reference.get(name, -4 - ROOM), value)
    host.refuses(lambda: restore(host, blob), "the FMU state that was set")
    assert fly(host, 5, 10) == fly(twin, 5, 10)


@every_flavour
@in_shared_process
def test_a_forged_state_of_before_the_start_cannot_kill_what_reads_integers(fmu_folder):
    host = Host(fmu_folder / "TetherDynamic.fmu")
    for name in ("slack_segments", "segments", "damping_law"):
        with suppress(FMICallException):
            restore(host, forged(host, host.reference[name], math.nan))
        assert isinstance(host.get(name), int)
