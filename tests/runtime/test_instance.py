"""One running tether on flat arrays, without FMI: a refusal keeps what was, what the caller has stays."""

from math import nan

import pytest

from tetherfmu.libraries.ready import kernels
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.instance import Instance, address
from tetherfmu.runtime.parameters import Environment, Solver, Tether
from tetherfmu.runtime.variants import VARIANTS
from tetherfmu.wiring.packing import pack_records
from tetherfmu.wiring.variables import line_of_tether

POINTS, ROOM, STEP = 5, 3, 0.02
KITE = (300.0, 0.0, 400.0)
THIN_AIR = Environment(air_density_scale_height=1.0)
UNDER_GROUND = (300.0, 0.0, -4000.0)  # there the density exp(-z/H) exceeds all numbers
every_variant = pytest.mark.parametrize("variant", VARIANTS)


def set_inputs(instance, kite=KITE, wind=(8.0, 1.0, 0.0), velocity=(-4.0, 19.0, 1.0)):
    for place, vector in ((at.KITE_POSITION, kite), (at.KITE_VELOCITY, velocity), (at.WIND_VELOCITY, wind)):
        for k in range(3):
            instance.values[place + k] = vector[k]


def set_up(instance, environment=THIN_AIR, **changes):
    tether = Tether(**{"initial_length": 505.0, "segments": 6, **changes})
    segments, parameters = pack_records(instance.kernels, (tether,), environment, Solver())
    instance.set_up((segments,), parameters)


def running(variant, **changes):
    instance = Instance(kernels(variant), (line_of_tether(POINTS),), room=ROOM)
    set_up(instance, **changes)
    set_inputs(instance)
    assert instance.start() is None
    return instance


def outputs(instance):
    return instance.values[instance.outputs_at : instance.parameters_at].tobytes()


def flown(instance, steps=5, velocity=(-4.0, 19.0, 1.0)):
    """Outputs and states after each of some steps along a line."""
    rows = []
    for k in range(steps):
        set_inputs(instance, kite=[KITE[i] + k * STEP * velocity[i] for i in range(3)])
        assert instance.advance(STEP) is None
        rows.append((outputs(instance), instance.state.tobytes()))
    return rows


@every_variant
def test_a_refused_step_keeps_state_and_outputs(variant):
    """Refused for an input, or when it is done but its outputs are out of the range of numbers."""
    instance, twin = running(variant), running(variant)
    assert flown(instance) == flown(twin)
    before = instance.state.tobytes(), outputs(instance)
    for kite, words in (((nan, 0.0, 0.0), r"the input kite_position[1] is nan"), (UNDER_GROUND, "kite_position, ")):
        set_inputs(instance, kite=kite)
        assert words in instance.advance(STEP)
        assert (instance.state.tobytes(), outputs(instance)) == before
    assert "the communication step is -1.0 s" in instance.advance(-1.0)
    assert (instance.state.tobytes(), outputs(instance)) == before
    assert flown(instance) == flown(twin)


@every_variant
def test_a_refused_start_keeps_state_and_outputs(variant):
    instance = running(variant)
    flown(instance)
    before = instance.state.tobytes(), outputs(instance)
    for kite in ((nan, 0.0, 0.0), UNDER_GROUND):
        set_inputs(instance, kite=kite)
        assert instance.start()
        assert (instance.state.tobytes(), outputs(instance)) == before


def test_outputs_out_of_the_range_of_numbers():
    """The straight line finds it when it computes the outputs: they are not kept, those of before are."""
    instance = running("straight")
    before = outputs(instance)
    set_inputs(instance, kite=UNDER_GROUND)
    assert "an output is not a finite number after a step of 0.02 s" in instance.advance(STEP)
    assert outputs(instance) == before
    assert "an output is not a finite number" in instance.start()
    assert outputs(instance) == before


@every_variant
def test_a_refused_first_start_gives_no_outputs(variant):
    instance = Instance(kernels(variant), (line_of_tether(POINTS),), room=ROOM)
    set_up(instance)
    set_inputs(instance, kite=UNDER_GROUND)
    assert instance.start()
    assert not any(outputs(instance))
    assert not any(instance.state)


@every_variant
def test_started_and_set_up_again(variant):
    """Any number of starts with other parameters, other segments too; the values stay at their address."""
    instance = running(variant)
    place = address(instance.values)
    for changes in ({"segments": 9}, {"diameter": 0.003}, {"segments": 2, "initial_length": 510.0}, {}):
        set_up(instance, **changes)
        set_inputs(instance)
        assert instance.start() is None
        assert flown(instance) == flown(running(variant, **changes))
    assert address(instance.values) == place


@every_variant
def test_room_of_the_caller_is_left_alone(variant):
    instance = running(variant)
    assert len(instance.values) == at.INPUTS + at.outputs_size(POINTS) + ROOM
    instance.values[-ROOM:] = type(instance.values)("d", [1.0, 2.0, 3.0])
    flown(instance)
    set_inputs(instance, kite=UNDER_GROUND)
    assert instance.advance(STEP)
    assert instance.values[-ROOM:].tolist() == [1.0, 2.0, 3.0]
