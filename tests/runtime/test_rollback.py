"""A saved state continues bit for bit in any order and in another process; damaged ones are refused.

After a reset, a refused step and the end, and in another flavour: `test_flavours.py`. Forged ones: `test_forged_states.py`.
"""

import multiprocessing

import pytest

from isolation import in_own_process, in_shared_process
from runtime.host import STEP, Host, blob_of, every_flavour, fly, of_every_flavour, restore, started
from tetherfmu.export.archive import SLAVES


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


def continued(folder, blobs):
    """For another process: what fresh instances fly that only get a state, by the names of their FMUs."""
    rows = {}
    for name, blob in blobs.items():
        host = Host(folder / f"{name}.fmu")
        restore(host, blob)
        rows[name] = fly(host, 20, 40)
    return rows


@every_flavour
@in_own_process
def test_in_another_process(fmu_folder):
    hosts = {name: started(fmu_folder / f"{name}.fmu") for name in SLAVES}
    for host in hosts.values():
        fly(host, 0, 20)
    blobs = {name: blob_of(host) for name, host in hosts.items()}
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        elsewhere = pool.apply(continued, (fmu_folder, blobs))
    assert elsewhere == {name: fly(host, 20, 40) for name, host in hosts.items()}


@of_every_flavour("fmu")
@in_shared_process
def test_before_and_during_initialization(fmu_folder, fmu):
    """A state that was saved before the tether was started goes back to there, with its parameters."""
    host = Host(fmu_folder / f"{fmu}.fmu")
    host.set(initial_length=525.0)
    instantiated = blob_of(host)
    host.enter_initialization(None)
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


def with_a_bit_changed(blob):
    return blob[:100] + bytes([blob[100] ^ 1]) + blob[101:]


DAMAGES = {f"cut at {end}": lambda blob, end=end: blob[:end] for end in (0, 7, 16, 55, 56, 500, -8, -1)}
DAMAGES["a bit changed"] = with_a_bit_changed


@every_flavour
@pytest.mark.parametrize("damage", DAMAGES)
@in_shared_process
def test_a_damaged_state_is_refused(fmu_folder, damage):
    host = started(fmu_folder / "TetherDynamic.fmu")
    good = blob_of(host)
    host.refuses(lambda: restore(host, DAMAGES[damage](good)), "the previous state is kept")
    assert blob_of(host) == good
    host.step(STEP)
