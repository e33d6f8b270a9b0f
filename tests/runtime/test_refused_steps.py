"""A refused step ends a simulation with its sentence on the screen, or the master goes on; no host repeats it for ever.

Statuses: FMI 2.0.5, 4.2.2, keeps fmi2Discard for a part of a step that was done, which FMPy repeats from where it has led.
"""

import math
import os
import tempfile
from contextlib import contextmanager
from ctypes import CDLL, byref, c_double, c_int, c_size_t, c_uint, c_void_p
from functools import partial
from importlib.util import find_spec

import numpy as np
import pytest
from fmpy import simulate_fmu
from fmpy.fmi1 import FMICallException

from isolation import in_own_process, in_shared_process, own_process
from runtime import clients
from runtime.host import STEP, Host, blob_of, every_flavour_and_version, restore

FORCE, STOP = 2, 1.0  # control of the winch; end of the simulations [s]
REFUSED = {  # name of a case: parameters, inputs of the step, what is said of it
    "pushes": ({"winch_control": FORCE}, {"winch_force": -100.0}, "winch_force is -100.0 N; it must be at least"),
    "no number": ({}, {"wind_velocity[2]": math.nan}, "the input wind_velocity[2] is nan; it must be a finite number"),
    "reels in": ({}, {"reel_out_speed": -1e5}, "the reel_out_speed -100000.0 m/s over a step of 0.0"),
}
cases = pytest.mark.parametrize("case", REFUSED)


@contextmanager
def screen():
    """What this process, its libraries included, writes to the standard streams: a list of one text, afterwards."""
    said = []
    with tempfile.TemporaryFile() as file:
        kept = [os.dup(stream) for stream in (1, 2)]
        try:
            for stream in (1, 2):
                os.dup2(file.fileno(), stream)
            yield said
        finally:
            for stream, before in zip((1, 2), kept, strict=True):
                os.dup2(before, stream)
                os.close(before)
            file.seek(0)
            said.append(file.read().decode())


def simulated(path, case):
    """What FMPy's `simulate_fmu` makes of a step that is refused after 0.1 s: its last time or error, and the screen."""
    parameters, inputs, _ = REFUSED[case]
    times, values = np.array([0.0, 0.1, 0.1, STOP]), {name: [0.0, 0.0, bad, bad] for name, bad in inputs.items()}
    if Host(path).version == 3:  # FMPy sets arrays as a whole there
        (name,) = values
        columns = np.zeros((len(times), 3))
        columns[:, 1] = values[name]
        values = {"wind_velocity": columns} if "[" in name else values
    kinds = [("time", float), *((name, float, np.shape(column)[1:]) for name, column in values.items())]
    signal = np.zeros(len(times), kinds)
    signal["time"] = times
    for name, column in values.items():
        signal[name] = column
    with screen() as said:
        try:
            result = simulate_fmu(str(path), stop_time=STOP, output_interval=STEP, start_values=parameters, input=signal)
            ended = float(result["time"][-1])
        except FMICallException as error:
            ended = str(error)
    return ended, said[0]


@every_flavour_and_version
@cases
def test_simulate_fmu_ends_with_the_sentence(fmu_folder, case):
    """Native FMUs raise; PythonFMU's library knows one answer, with which FMPy ends early."""
    ended, said = own_process(simulated, path=fmu_folder / "TetherDynamic.fmu", case=case)
    assert REFUSED[case][2] in said
    if "native_fmi3" in fmu_folder.name:
        assert ended == "fmi3DoStep failed with status 2 (discard)."
    elif "native" in fmu_folder.name:
        assert ended == "fmi2DoStep failed with status 3 (error)."
    else:
        assert ended == pytest.approx(0.1, abs=STEP)


@every_flavour_and_version
@cases
@in_shared_process
def test_repeated_and_restored(fmu_folder, case):
    """A refused step changes nothing: the next one is that of a twin, bit for bit, and so is one from a saved state."""
    parameters, bad, sentence = REFUSED[case]
    host, twin = (Host(fmu_folder / "TetherDynamic.fmu").start(**parameters) for _ in range(2))
    for each in (host, twin):
        each.step(STEP)
    (name, wrong), good = next(iter(bad.items())), host.get(next(iter(bad)))
    saved = blob_of(host)
    host.set(**{name: wrong})
    for _ in range(2):
        before = blob_of(host)
        with pytest.raises(FMICallException):
            host.step(STEP)
        assert sentence in host.messages[-1]
        assert blob_of(host) == before
    host.set(**{name: good})
    host.step(STEP)
    twin.step(STEP)
    assert blob_of(host) == blob_of(twin)
    restore(host, saved)
    host.time -= STEP
    host.step(STEP)
    assert blob_of(host) == blob_of(twin)


@pytest.mark.parametrize("fmu_folder", ["native", "native_fmi3"], indirect=True)
@in_shared_process
def test_statuses_of_native_fmus(fmu_folder):
    """A scene that is warned of, as a tether below the ground, and an odd tolerance and time: OK from each call."""
    host = Host(fmu_folder / "TetherDynamic.fmu")
    calls = []
    host.fmu.fmiCallLogger = calls.append
    host.start(tolerance=-1.0, initial_length=130.0, **{"kite_position[1]": 100.0, "kite_position[3]": 20.0})
    for host.time in (0.0, 5.0):
        host.step(STEP)
    assert {call.rpartition(" -> ")[2] for call in calls} == {"OK"}
    said = " ".join(host.messages)
    for words in ("the importer's tolerance -1.0 is not used", "below ground_height", "the communication point is 5.0 s"):
        assert words in said
    with pytest.raises(FMICallException):
        host.step(STEP, reel_out_speed=-1e5)
    assert calls[-1].endswith("-> DISCARD" if host.version == 3 else "-> ERROR")


@every_flavour_and_version
@in_shared_process
def test_values_that_cannot_be_read(fmu_folder):
    """NaN, and the smallest integer: importers that do not look at statuses have shown zeros."""
    host = Host(fmu_folder / "TetherDynamic.fmu")
    host.enter_initialization(None)
    host.set(diameter=-1.0)
    read = partial(read_anyway, host)
    for _ in range(2):
        assert np.isnan(read("kite_tension")).all()
        assert read("slack_segments") == -(2**31)
        assert "diameter is -1.0; it must be at least 1e-06 m" in host.messages[-1]
    host.set(diameter=0.004)
    assert read("kite_tension") > 0.0
    assert read("slack_segments") >= 0
    unknown = 10**6
    host.reference["unknown"] = unknown
    host.kind["unknown"] = host.REAL
    host.sizes["unknown"] = []
    assert np.isnan(read("unknown"))
    assert f"value reference {unknown} (no variable of this FMU) cannot be read" in host.messages[-1]


def read_anyway(host, name):
    """The number that a call leaves, whatever its status is."""
    value = c_double(0.0) if host.kind[name] == host.REAL else c_int(0)
    rest = (c_size_t(1),) if host.version == 3 else ()
    function = CDLL(host.fmu.dll._name)[f"fmi{host.version}Get{host.kind[name]}"]
    function(c_void_p(host.fmu.component), byref(c_uint(host.reference[name])), c_size_t(1), byref(value), *rest)
    return value.value


@pytest.mark.parametrize("fmu_folder", ["native", "native_fmi3"], indirect=True)
@in_own_process
def test_the_first_refusal_is_written_where_logging_is_off(fmu_folder):
    """Once, with the name of the instance; not where the importer has turned logging on."""
    path = fmu_folder / "TetherDynamic.fmu"
    host = Host(path)
    for logging, times in ((False, 1), (True, 0), (False, 0)):
        with screen() as said:
            debug = host.fmu.fmi3SetDebugLogging if host.version == 3 else host.fmu.fmi2SetDebugLogging
            debug(host.fmu.component, logging, 0, None)
            for _ in range(3):
                host.messages.clear()
                with pytest.raises(FMICallException):
                    host.step(STEP)
                assert len(host.messages) == 1
        sentence = f"tether: fmi{host.version}DoStep: a step cannot be done before the initialization\n"
        assert said[0] == times * sentence


@pytest.mark.parametrize("fmu_folder", ["pythonfmu", "native"], indirect=True)
@pytest.mark.parametrize("case", ["no number", "reels in"])  # libcosim sets no enumerations, and so no winch_control
def test_libcosim_stops(fmu_folder, case):
    pytest.importorskip("libcosimpy", reason="libcosimpy has no wheel for this platform or this Python")
    done, said = own_process(stepped_by_libcosim, path=fmu_folder / "TetherDynamic.fmu", case=case)
    assert done == [True, True, False]
    assert REFUSED[case][2] in said


def stepped_by_libcosim(path, case):
    """Whether libcosim has done two steps and one that is refused, and the screen."""
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimManipulator import CosimManipulator
    from libcosimpy.CosimSlave import CosimLocalSlave

    inputs = REFUSED[case][1]
    references, _, _ = clients.variables(path)
    execution = CosimExecution.from_step_size(round(STEP * 1e9))
    slave = execution.add_local_slave(CosimLocalSlave(str(path), "tether"))
    override = CosimManipulator.create_override()
    assert execution.add_manipulator(override)
    with screen() as said:
        done = [execution.step(), execution.step()]
        for name, value in inputs.items():
            assert override.slave_real_values(slave, [references[name]], [value])
        done.append(execution.step())
    return done, said[0]


@pytest.mark.skipif(find_spec("ecospy") is None, reason="ecospy is for 64-bit Linux")
@every_flavour_and_version
def test_ecos_goes_on(fmu_folder):
    """It does not look at statuses; the sentence is on the screen, and it goes on from where the last step ended."""
    lengths, said = own_process(stepped_by_ecos, path=fmu_folder / "TetherDynamic.fmu")
    assert REFUSED["reels in"][2] in said
    assert lengths == pytest.approx([505.0 + STEP, 505.0 + STEP, 505.0 + 2.0 * STEP], rel=1e-12)


def stepped_by_ecos(path):
    """Lengths of the tether after a step, one that is refused, and a step that reels out at 1 m/s; the screen."""
    client, lengths = clients.ecos(), []
    with client.EcosSimulationStructure() as structure, screen() as said:
        structure.add_model("tether", str(path))
        with client.EcosSimulation(structure=structure, step_size=STEP) as simulation:
            assert simulation.init()
            for speed in (1.0, -1e5, 1.0):
                simulation.set_real("tether::reel_out_speed", speed)
                simulation.step()
                lengths.append(simulation.get_real("tether::tether_length"))
            simulation.terminate()
    return lengths, said[0]
