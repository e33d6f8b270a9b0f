"""Many instances, many cycles, many steps: memory, open files and sys.path do not grow."""

import gc
import math
import sys
from pathlib import Path

import numpy as np
import pytest

from isolation import in_own_process
from runtime.host import Host, of_every_flavour
from scenes import circle, kite_inputs

LINUX = pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="memory and open files are read from /proc")
PAGE = 4096
of_both_kinds = pytest.mark.parametrize("fmu", ["TetherCatenary", "TetherDynamicFree"])  # of kernels, which allocate nothing


def resident():
    """Memory of this process [bytes]."""
    gc.collect()
    return PAGE * int(Path("/proc/self/statm").read_text().split()[1])


def open_files():
    return len(list(Path("/proc/self/fd").iterdir()))


@LINUX
@of_both_kinds
@in_own_process
def test_1000_cycles(fmu_folder, fmu):
    """Instantiate, step, free: below 2.5 MB (PythonFMU itself keeps about 1.2 kB per instance), no path, no file."""
    host = Host(fmu_folder / f"{fmu}.fmu")
    for cycle in range(1050):
        if cycle == 50:
            before = (open_files(), list(sys.path))
            memory = resident()
        host.start()
        host.step(0.02)
        host.fmu.terminate()
        host.free()
        host.fmu.instantiate()
        host.time = 0.0
    assert resident() - memory < 2.5e6
    assert (open_files(), list(sys.path)) == before


@LINUX
@of_both_kinds
@in_own_process
def test_many_steps(fmu_folder, fmu):
    """Steps of 1 to 50 ms on the circle, states taken and freed: no growth after the first 10000, all outputs finite.

    Allowed: 250 kB for 50 000 steps, 5 bytes each; nothing that is allocated has less than 16.
    """
    laps = 60
    host = Host(fmu_folder / f"{fmu}.fmu").start(segments=3, fixed_step=0.025)
    moving = kite_inputs(fmu, *circle(0.0))
    kite = [host.reference[f"{name}[{i}]"] for name in moving for i in (1, 2, 3)]
    outputs = [host.reference[f"kite_force[{i}]"] for i in (1, 2, 3)] + [host.reference["sag"]]
    steps = np.random.default_rng(1).uniform(0.001, 0.05, 1000).tolist()
    path = [np.ravel(list(kite_inputs(fmu, *circle(time)).values())).tolist() for time in np.cumsum([0.0, *steps[:-1]])]
    time, state = 0.0, None
    for lap in range(laps):
        if lap == 10:
            memory = resident()
        if state:  # from the end of the path back to its start, as a rollback would do
            host.fmu.setFMUState(state)
            host.fmu.freeFMUState(state)
        state = host.fmu.getFMUState()
        for step, motion in zip(steps, path, strict=True):
            host.fmu.setReal(kite, motion)
            host.fmu.doStep(time, step)
            assert all(map(math.isfinite, host.fmu.getReal(outputs)))
            time += step
        time -= sum(steps)
    assert resident() - memory < 250e3


@of_every_flavour("fmu")
@in_own_process
def test_100_live_instances_are_independent(fmu_folder, fmu):
    """Each with its own length, stepped in turn, equals the one that is stepped alone."""
    folder = Host(fmu_folder / f"{fmu}.fmu").folder
    lengths = np.linspace(480.0, 560.0, 100)

    def started(length):
        return Host(folder).start(initial_length=length, segments=5)

    def fly(host, k):
        host.step(0.02, **kite_inputs(fmu, *circle(0.02 * k)))

    hosts = [started(length) for length in lengths]
    for k in range(10):
        for host in hosts:
            fly(host, k)
    together = [host.all_outputs() for host in hosts]
    for host in hosts:
        host.free()
    for length, expected in zip(lengths[::9], together[::9], strict=True):
        alone = started(length)
        for k in range(10):
            fly(alone, k)
        assert alone.all_outputs() == expected
