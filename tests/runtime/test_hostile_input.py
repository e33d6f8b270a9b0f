"""Hostile numbers on every input, parameter and step: refused in words or computed, with bounded work, always finite.

A watchdog ends the process if a call hangs.
"""

import faulthandler
import math

from fmpy.fmi1 import FMICallException

from bounds import most_work
from isolation import in_shared_process
from runtime.host import Host, names_of, of_every_flavour, reals_of
from scenes import kite_inputs
from tetherfmu.export.archive import SLAVES

HANGS = 600.0  # seconds; a call that spends all of its budget takes about one
COUNTERS = ("solver_steps", "solver_rejections", "solver_iterations")
HUGE = (1e300, 1e160, 1e30, 1e12, 1e9, 1e6, 1e3)
TINY = (5e-324, 1e-300, 1e-160, 1e-12)
HOSTILE = [math.nan, math.inf, *(sign * value for value in (*HUGE, *TINY) for sign in (1.0, -1.0)), 0.0]
STEPS = (0.0, -0.0, -0.02, math.nan, math.inf, -math.inf, 5e-324, 1e-300, 1e-12, 1e-6, 1.0, 1e6, 1e300)
ALLOWED = ("must be", "check ", "needs more", "cannot reach", "stop reeling", "use a")


def watched(action):
    """Run one call; the process ends with a traceback if it hangs."""
    faulthandler.dump_traceback_later(HANGS, exit=True)
    try:
        return action()
    finally:
        faulthandler.cancel_dump_traceback_later()


def outcome(host, action):
    """ "done", or what was said when it was refused."""
    host.messages.clear()
    try:
        watched(action)
    except FMICallException:
        said = " ".join(host.messages)
        assert any(words in said for words in ALLOWED), said
        return said
    return "done"


def assert_sound(host):
    """All outputs are finite; a start and the step after it have taken no more work than each of them may."""
    assert all(math.isfinite(value) for value in host.all_outputs())
    segments = host.get("segments")
    assert segments * sum(map(host.get, COUNTERS)) <= 2 * most_work(segments)


@of_every_flavour("fmu")
@in_shared_process
def test_every_input(fmu_folder, fmu):
    """From the same state each time; a refused step keeps it, a step that was done can be followed by a good one."""
    host = Host(fmu_folder / f"{fmu}.fmu").start()
    host.step(0.02)
    state = host.fmu.getFMUState()
    before = host.all_outputs()
    for name in reals_of(host, "input"):
        for value in HOSTILE:
            host.fmu.setFMUState(state)
            said = outcome(host, lambda name=name, value=value: host.step(0.02, **{name: value}))
            assert_sound(host)
            if said != "done":
                assert host.all_outputs() == before, (name, value)
            if not abs(value) <= 1e9:
                assert name in said, (name, value, said)
                assert str(value) in said
            if not math.isfinite(value):
                assert f"the step from {host.time} s is refused: the input {name} is {value}; it must be a finite" in said


@of_every_flavour("fmu")
@in_shared_process
def test_every_length_of_step(fmu_folder, fmu):
    host = Host(fmu_folder / f"{fmu}.fmu").start()
    host.step(0.02)
    state = host.fmu.getFMUState()
    before = host.all_outputs()
    for speed in (0.0, 40.0):
        for step in STEPS:
            host.fmu.setFMUState(state)
            host.set(**kite_inputs(fmu, (300.0, 0.0, 400.0), (speed, 0.0, 0.0)))
            said = outcome(host, lambda step=step: host.fmu.doStep(0.02, step))
            assert_sound(host)
            if said != "done":
                assert host.all_outputs() == before, step
                assert f"{step} s" in said
            if not 0.0 < step <= 1e6:
                assert "must be greater than 0" in said


@of_every_flavour("fmu", ["TetherDynamicFree"], SLAVES)  # native ones start five times faster
@in_shared_process
def test_every_parameter(fmu_folder, fmu):
    """A hostile parameter is refused at the end of initialization, or the tether starts and steps."""
    first = Host(fmu_folder / f"{fmu}.fmu")
    for name in names_of(first, "parameter"):
        for value in HOSTILE:
            host = Host(first.folder)
            if host.kind[name] != "Real":
                if not abs(value) < 2**31:
                    continue  # does not fit into an Integer: no importer can pass it
                value = int(value)
            said = outcome(host, lambda host=host, name=name, value=value: host.start(**{name: value}))
            if said != "done":
                assert name in said or "equilibrium" in said, (name, value, said)
                continue
            assert_sound(host)
            outcome(host, lambda host=host: host.step(0.02, **kite_inputs(fmu, (300.0, 0.0, 400.0), (1.0, 0.0, 0.0))))
            assert_sound(host)
            host.free()
