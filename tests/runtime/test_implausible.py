"""An FMU says once since its start what is implausible: not in a state that has said it, again after reset."""

import pytest

from isolation import in_shared_process
from runtime.host import STEP, Host, blob_of, count_of, every_flavour, of_every_flavour, restore
from scenes import circle, kite_at_start, kite_inputs
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.variants import VARIANTS, class_name

every_fmu = of_every_flavour("fmu")
every_driven_fmu = of_every_flavour("fmu", tuple(map(class_name, VARIANTS)))
STRETCHED, CONTRADICTS = "a segment is stretched by 400 %; from 5 % on", "kite_velocity contradicts kite_position"


def fly(host, begin, end, factor=0.0):
    """Steps on the circle with a wrong velocity; returns the messages."""
    host.messages.clear()
    for k in range(begin, end):
        position, velocity = circle(k * STEP)
        host.time = k * STEP
        host.step(STEP, **kite_inputs(host.name, position, factor * velocity))
    return host.messages[:]


def started(path, length=525.0, **values):
    host = Host(path)
    return host.start(initial_length=length, ground_height=-100.0, **kite_at_start(host.name, circle(0.0)[0]), **values)


@every_fmu
@in_shared_process
def test_a_kite_at_500_m_on_a_tether_of_100_m(fmu_folder, fmu):
    host = started(fmu_folder / f"{fmu}.fmu", 100.0)
    assert len(host.messages) == 1
    assert STRETCHED in host.messages[0].replace("%%", "%")  # a message is a printf format
    assert "initial_kite_position" in host.messages[0]  # what a free kite end has instead of an input
    assert not any("stretched" in message for message in fly(host, 0, 20, 1.0))


@every_driven_fmu
@in_shared_process
def test_once_in_flight_and_again_after_reset(fmu_folder, fmu):
    host = started(fmu_folder / f"{fmu}.fmu")
    assert host.messages == []
    assert len(fly(host, 0, 40)) == 1
    assert CONTRADICTS in host.messages[0]
    assert fly(host, 40, 80) == []
    host.fmu.reset()
    host.start(initial_length=525.0, ground_height=-100.0, kite_position=circle(0.0)[0])
    assert len(fly(host, 0, 40)) == 1


@every_driven_fmu
@in_shared_process
def test_states(fmu_folder, fmu):
    """A state that has said it says nothing anywhere; one of before says it once, but not twice in one instance."""
    path = fmu_folder / f"{fmu}.fmu"
    host = started(path)
    before = blob_of(host)
    assert len(fly(host, 0, 20)) == 1
    after = blob_of(host)
    for blob, begin in ((after, 20), (before, 0), (after, 20)):
        restore(host, blob)
        assert fly(host, begin, 40) == []
    for blob, begin, count in ((after, 20, 0), (before, 0, 1)):
        another = Host(path, "another")
        restore(another, blob)
        assert len(fly(another, begin, 40)) == count


@every_fmu
@in_shared_process
def test_nothing_is_said_of_what_is_plausible(fmu_folder, fmu):
    """A flight; a first start in initialization mode with other ends; a kite that waits elsewhere before the first step."""
    host = Host(fmu_folder / f"{fmu}.fmu")
    host.fmu.setupExperiment(startTime=0.0)
    host.fmu.enterInitializationMode()
    host.set(initial_length=100.0)
    assert host.get("kite_tension") > 1e5  # stretched by 400 %
    host.set(initial_length=525.0, ground_height=-100.0, **kite_at_start(fmu, *circle(0.0)))
    host.fmu.exitInitializationMode()
    assert host.messages == []
    assert fly(host, 0, 100, 1.0) == []
    derived = started(fmu_folder / f"{fmu}.fmu", end_velocities=2)
    assert fly(derived, 0, 100) == []


@every_flavour
@in_shared_process
def test_backward_euler_that_damps_more_than_a_tenth(fmu_folder):
    """At the start, E A h of 614600 N and 1 ms; the default method says nothing."""
    path = fmu_folder / "TetherDynamic.fmu"
    said = started(path, fixed_step=1e-3, fixed_step_method=2).messages
    assert ["additional axial_damping of 615 N.s" in message for message in said] == [True]
    assert started(path, fixed_step=1e-3).messages == []


@every_flavour
@pytest.mark.parametrize("value", [float("nan"), float("inf"), -1.0, 0.5, 2.0**at.WARNING_KINDS])
@in_shared_process
def test_a_forged_note_is_refused(fmu_folder, value):
    from tetherfmu.runtime import layout as at
    from tetherfmu.runtime.saved_state import from_bytes, to_bytes

    host = started(fmu_folder / "TetherStraight.fmu")
    saved = from_bytes(blob_of(host), "straight", count_of(host))
    saved.state[at.WARNINGS] = value
    host.refuses(lambda: restore(host, to_bytes(saved)), "the FMU state that was set contains impossible numbers")


@every_fmu
@in_shared_process
def test_a_diameter_in_millimetres_is_named(fmu_folder, fmu):
    """Once at each start, not in initialization mode, and not from 0.2 m down."""
    said = "diameter is 4 m, more than 0.2 m; diameters are in m: 4 mm are 0.004"
    host = Host(fmu_folder / f"{fmu}.fmu")
    for length in (525.0, 530.0):
        host.start(initial_length=length, diameter=4.0, axial_stiffness=1e12, **kite_at_start(host.name, circle(0.0)[0]))
        assert sum(said in message for message in host.messages) == 1
        assert not any(said in message for message in fly(host, 0, 5, 1.0))
        host.fmu.reset()
        host.messages.clear()
    host.start(diameter=0.2, axial_stiffness=1e12, **kite_at_start(host.name, circle(0.0)[0]))
    assert not any("diameter is" in message for message in host.messages)


@of_every_flavour("fmu", ["TetherDynamic", "TetherQuasiSteady"], ["TetherCatenary"])
@in_shared_process
def test_what_cannot_break_says_so(fmu_folder, fmu):
    host = started(fmu_folder / f"{fmu}.fmu", breaking_force=5e3)
    cannot = "breaking_force is 5000 N and has no effect: this tether cannot break; the dynamic one can"
    assert [cannot in message for message in host.messages] == ([] if fmu == "TetherDynamic" else [True])
    host.messages.clear()
    host.step(STEP)
    assert host.messages == []
