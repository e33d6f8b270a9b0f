"""Random sessions of legal and illegal calls, as `runtime/test_any_call_order.py` has them for tethers."""

import math

import pytest
from hypothesis import HealthCheck, settings
from hypothesis.stateful import run_state_machine_as_test

from isolation import in_own_process
from runtime.host import Host
from runtime.test_any_call_order import session

INPUTS = {
    "PointMassKite": {"kite_velocity[3]": (-3.0, 0.0, 3.0), "kite_position[1]": (299.0, 300.5)},
    "FlyingKite": {"kite_force[1]": (-30.0, 0.0, 3.0), "wind_velocity[1]": (-20.0, 0.0, 8.0)},
    "Winch": {"ground_tension": (0.0, 1000.0), "set_speed": (-1.0, 1.0)},
    "FlightController": {"heading": (0.0, 1.0), "tether_length": (100.0, 400.0)},
    "TurbulentWind": {"kite_position[2]": (-20.0, 40.0), "shape[3,1]": (0.0, 90.0)},
}
PARAMETER = {
    "PointMassKite": "wing_area",
    "FlyingKite": "kite_mass",
    "Winch": "drum_radius",
    "FlightController": "elevation",
    "TurbulentWind": "mean_speed",
}


@pytest.mark.parametrize("name", list(INPUTS))
@in_own_process
def test_random_sessions(example_folder, name):
    other = Host(example_folder / "KiteOnPath.fmu").start()
    states = [other.fmu.serializeFMUstate(other.fmu.getFMUState())]
    parameters = {PARAMETER[name]: (0.2, 0.5)}, {PARAMETER[name]: (-1.0, math.nan, 1e300)}
    machine = session(Host(example_folder / f"{name}.fmu").folder, states, INPUTS[name], *parameters)
    options = settings(
        max_examples=30,
        stateful_step_count=30,
        deadline=None,
        derandomize=True,
        database=None,
        suppress_health_check=list(HealthCheck),
    )
    run_state_machine_as_test(machine, settings=options)
