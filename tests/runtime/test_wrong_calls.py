"""Calls in the wrong phase and of unknown variables: a message at once, the next step refused, then all is as before."""

import math

import pytest
from fmpy.fmi1 import FMICallException

from isolation import in_shared_process
from runtime.host import Host, blob_of, every_flavour, of_every_flavour
from scenes import kite_at_start, kite_inputs
from tetherfmu.export.archive import SLAVES
from tetherfmu.runtime.variants import BY_NAME


def step_is_refused(host, words):
    with pytest.raises(FMICallException):
        host.fmu.doStep(host.time, 0.02)
    assert words in host.messages[-1], host.messages


@of_every_flavour("fmu")
@in_shared_process
def test_getters_before_initialization(fmu_folder, fmu):
    """Inputs and parameters have their start values, outputs are finite."""
    host = Host(fmu_folder / f"{fmu}.fmu")
    (kite, _) = kite_at_start(fmu, None)
    assert host.get(kite) == [300.0, 0.0, 400.0]
    assert host.get("initial_length") == 505.0
    assert host.get("segments") == 20
    assert all(map(math.isfinite, host.all_outputs()))


UNKNOWN = 4711
OF_KINDS = {"Real": 1.0, "Integer": 1, "Boolean": True, "String": "x"}


def set_unknown(host, kind):
    getattr(host.fmu, f"set{kind}")([UNKNOWN], [OF_KINDS[kind]])


CALLS = {  # after the start: what is called, and words of the refusal
    **{f"get{kind}": (lambda host, kind=kind: getattr(host.fmu, f"get{kind}")([UNKNOWN]), "4711") for kind in OF_KINDS},
    **{f"set{kind}": (lambda host, kind=kind: set_unknown(host, kind), "4711") for kind in OF_KINDS},
    "output": (lambda host: host.set(sag=1.0), "cannot be set"),
    "parameter": (lambda host: host.set(diameter=0.01), "diameter cannot be set to 0.01 now"),
    "kind": (lambda host: host.fmu.getReal([host.reference["segments"]]), "not a variable of this type"),
    "experiment": (lambda host: host.fmu.setupExperiment(startTime=0.0), "the experiment cannot be set up after the init"),
}


@every_flavour
@pytest.mark.parametrize("name", CALLS)
@in_shared_process
def test_calls_that_cannot_be(fmu_folder, name):
    """All is as before."""
    host, twin = (Host(fmu_folder / "TetherDynamic.fmu").start() for _ in range(2))
    call, words = CALLS[name]
    host.refuses(lambda: call(host), words)
    host.step(0.02)
    twin.step(0.02)
    assert blob_of(host) == blob_of(twin)


@every_flavour
@in_shared_process
def test_phases(fmu_folder):
    host = Host(fmu_folder / "TetherDynamic.fmu")
    step_is_refused(host, "a step cannot be done before the initialization")
    host.refuses(host.fmu.exitInitializationMode, "initialization mode cannot be left before the initialization")
    host.fmu.enterInitializationMode()
    step_is_refused(host, "a step cannot be done in initialization mode")
    host.fmu.exitInitializationMode()
    host.step(0.02)
    outputs = host.all_outputs()
    host.refuses(host.fmu.enterInitializationMode, "initialization mode cannot be entered after the initialization")
    assert host.all_outputs() == outputs
    host.step(0.02)
    before, wind = host.all_outputs(), host.get("wind_velocity")
    host.fmu.terminate()
    step_is_refused(host, "a step cannot be done after the termination")
    words = "wind_velocity[1] cannot be set to 5.0 after the termination"
    host.refuses(lambda: host.set(**{"wind_velocity[1]": 5.0}), words)
    assert (host.all_outputs(), host.get("wind_velocity")) == (before, wind)
    host.refuses(host.fmu.terminate, "the FMU cannot be terminated after the termination")
    host.fmu.reset()
    host.start()
    host.time = 0.0
    host.step(0.02)
    assert host.all_outputs() == outputs


@every_flavour
@in_shared_process
def test_time_that_jumps(fmu_folder):
    """Nothing depends on time: a step from another point is done, with one warning; NaN and infinity are refused."""
    host, twin = Host(fmu_folder / "TetherDynamic.fmu").start(), Host(fmu_folder / "TetherDynamic.fmu").start()
    host.messages.clear()
    for time in (0.0, 5.0, 1.0):
        host.fmu.doStep(time, 0.02)
        twin.step(0.02)
    assert host.all_outputs() == twin.all_outputs()
    assert ["5.0 s" in message for message in host.messages] == [True]
    for time in (math.nan, math.inf):
        host.time = time
        step_is_refused(host, f"the communication point is {time}")


@of_every_flavour("fmu")
@in_shared_process
def test_kite_at_the_ground_station_and_kite_teleported(fmu_folder, fmu):
    """Both ends at one point, from the start and in flight; then 1 km away within a step. Done or refused in words.

    A free kite is not led there in flight but gets a load as large as that place is far.
    """
    for place in ((0.0, 0.0, 0.0), (1300.0, 0.0, 400.0), (300.0, 0.0, -600.0)):
        host = Host(fmu_folder / f"{fmu}.fmu").start()
        before = host.all_outputs()
        try:
            host.step(0.02, **kite_inputs(fmu, place, (0.0, 0.0, 0.0)))
        except FMICallException:
            assert host.messages
            assert host.all_outputs() == before
        host.set(**kite_inputs(fmu, (300.0, 0.0, 400.0), (0.0, 0.0, 0.0)))
        host.fmu.doStep(0.02, 0.02)
        assert all(map(math.isfinite, host.all_outputs()))
        fresh = Host(host.folder, "fresh").start(**kite_at_start(fmu, place))
        assert all(map(math.isfinite, fresh.all_outputs()))


@of_every_flavour("fmu")
@in_shared_process
def test_reeled_in_to_zero(fmu_folder, fmu):
    """The tether can be reeled in until its segments have 1 cm, no farther; then it can be paid out again.

    The ends are 5 cm apart: where it is stretched many times over, the dynamic tether is refused for its work first.
    """
    place = kite_at_start(fmu, (0.03, 0.0, 0.04))
    host = Host(fmu_folder / f"{fmu}.fmu").start(**place, initial_length=0.6, segments=5)
    for _ in range(100):
        try:
            host.step(0.02, reel_out_speed=-0.5)
        except FMICallException:
            break
    assert "stop reeling in earlier" in host.messages[-1]
    nodes = 5 if BY_NAME[SLAVES[fmu]].has_nodes else 1
    assert host.get("tether_length") == pytest.approx(0.01 * nodes, abs=0.0101)
    host.step(0.02, reel_out_speed=0.5)


@every_flavour
@pytest.mark.parametrize(
    ("start", "stop", "words"),
    [
        (1.0, 0.5, "the stop time is 0.5 s; it must not be before the start time of 1.0 s"),
        (0.0, math.nan, "the stop time is nan s"),
        (math.nan, None, "the start time is nan; it must be a finite number"),
        (-math.inf, 1.0, "the start time is -inf"),
    ],
)
@in_shared_process
def test_times_of_the_experiment(fmu_folder, start, stop, words):
    """Said when the experiment is set up, not with the first step; then it can be set up well."""
    host = Host(fmu_folder / "TetherDynamic.fmu")
    host.refuses(lambda: host.fmu.setupExperiment(startTime=start, stopTime=stop), words)
    host.fmu.setupExperiment(startTime=1.0, stopTime=1.0 + (stop is None))
    host.fmu.enterInitializationMode()
    host.fmu.exitInitializationMode()
