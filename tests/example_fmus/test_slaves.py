"""What every FMU of the examples does in a host: a valid description, rollback, refusals in words, equal bytes."""

import math
import shutil

import pytest
from fmpy import read_model_description
from fmpy.fmi1 import FMICallException
from fmpy.validation import validate_fmu

from example_fmus.example_slaves import example_fmus
from isolation import in_own_process, in_shared_process
from runtime.host import Host, blob_of, restore

every_example = pytest.mark.parametrize("name", list(example_fmus.SLAVES))
BLOWING = {"wind_velocity": (8.0, 1.0, 0.0), "kite_force": (-100.0, 0.0, -150.0), "ground_tension": 900.0, "depower": 0.3}


def fly(host, begin, end):
    """Outputs of steps with inputs that move."""
    rows = []
    for k in range(begin, end):
        host.time = 0.02 * k
        moving = {"steering": 0.5 * math.sin(0.3 * k), "heading": 0.1 * k, "set_speed": math.sin(0.1 * k)}
        host.step(0.02, **{each: value for each, value in (moving | BLOWING).items() if is_input(host, each)})
        rows.append(host.all_outputs())
    return rows


def is_input(host, name):
    causality = {variable.name: variable.causality for variable in host.description.modelVariables}
    return causality.get(name, causality.get(f"{name}[1]")) == "input"


@every_example
def test_fmpy_finds_no_problem(example_folder, name):
    assert validate_fmu(str(example_folder / f"{name}.fmu")) == []


@every_example
def test_variables_are_described(example_folder, name):
    description = read_model_description(str(example_folder / f"{name}.fmu"))
    assert all(variable.description for variable in description.modelVariables)
    outputs = [variable.name for variable in description.modelVariables if variable.causality == "output"]
    assert [unknown.variable.name for unknown in description.initialUnknowns] == outputs
    assert description.coSimulation.canGetAndSetFMUstate
    assert description.coSimulation.canSerializeFMUstate


@every_example
def test_the_same_bytes_again(example_folder, tmp_path, name):
    assert example_fmus.build(name, tmp_path).read_bytes() == (example_folder / f"{name}.fmu").read_bytes()


@every_example
@in_shared_process
def test_rollback_is_exact(example_folder, name):
    """A state restored continues bit for bit, in another instance and after a reset too."""
    path = example_folder / f"{name}.fmu"
    host, other = Host(path).start(), Host(path, "other").start()
    fly(host, 0, 5)
    blob = blob_of(host)
    rows = fly(host, 5, 20)
    host.fmu.reset()
    for each in (host, other):
        restore(each, blob)
        assert blob_of(each) == blob
        assert fly(each, 5, 20) == rows


@every_example
@in_shared_process
def test_refused_steps_and_states_change_nothing(example_folder, name):
    host, twin = (Host(example_folder / f"{name}.fmu").start() for _ in range(2))
    fly(host, 0, 5)
    fly(twin, 0, 5)
    for step in (0.0, -0.02, math.nan, math.inf):
        with pytest.raises(FMICallException):
            host.fmu.doStep(host.time, step)
        assert f"the communication step is {step} s; it must be greater than 0" in host.messages[-1]
    inputs = [variable for variable in host.description.modelVariables if variable.causality == "input"]
    for variable in inputs:
        good = host.get(variable.name)
        host.set(**{variable.name: math.nan})
        with pytest.raises(FMICallException):
            host.fmu.doStep(host.time, 0.02)
        assert f"the input {variable.name} is nan; it must be a finite number" in host.messages[-1]
        host.set(**{variable.name: good})
    for damaged in (blob_of(host)[:-1], b"", b"x" * 200):
        restore(host, damaged)
        assert "the previous state is kept" in host.messages[-1]
        with pytest.raises(FMICallException):
            host.fmu.doStep(host.time, 0.02)
    assert blob_of(host) == blob_of(twin)
    assert fly(host, 5, 10) == fly(twin, 5, 10)


@every_example
@in_shared_process
def test_parameters_out_of_range_are_named(example_folder, name):
    host = Host(example_folder / f"{name}.fmu")
    parameter = next(v for v in host.description.modelVariables if v.causality == "parameter" and v.min is not None)
    with pytest.raises(FMICallException):
        host.start(**{parameter.name: -1e30})
    assert f"{parameter.name} is -1e+30; it must be at least" in "".join(host.messages)


@in_shared_process
def test_all_in_one_process_with_a_tether(example_folder, fmu_folder):
    """Different classes with different helpers under the same names: each runs its own."""
    paths = [*(example_folder / f"{name}.fmu" for name in example_fmus.SLAVES), fmu_folder / "TetherStraight.fmu"]
    alone = [fly(Host(path).start(), 0, 5) for path in paths]
    hosts = [Host(path).start() for path in paths]
    assert [fly(host, 0, 5) for host in reversed(hosts)] == alone[::-1]


@in_own_process
def test_a_kite_after_the_folder_of_another_has_vanished(example_folder):
    first = Host(example_folder / "PointMassKite.fmu", own_folder=True).start()
    shutil.rmtree(first.folder)
    second = Host(example_folder / "FlyingKite.fmu").start()
    first.step(0.02)
    second.step(0.02)
    assert second.get("kite_position[1]") != 0.0
