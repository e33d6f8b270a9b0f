"""TetherDynamicFree in FMPy: the start of the motion, and that nothing but the tether moves it."""

import numpy as np
import pytest
from fmpy.fmi1 import FMICallException

from isolation import in_shared_process
from runtime.host import Host

FMU = "TetherDynamicFree.fmu"


@in_shared_process
def test_the_motion_starts_where_the_parameters_say(fmu_folder):
    """Also when the velocities of the ends are derived: that of a free kite is no input."""
    for derived in (1, 2):
        host = Host(fmu_folder / FMU)
        host.enter_initialization(None)
        assert host.get("kite_position") == [300.0, 0.0, 400.0]
        position, velocity = [310.0, -20.0, 380.0], [1.0, 2.0, -3.0]
        host.set(initial_kite_position=position, initial_kite_velocity=velocity, end_velocities=derived)
        assert host.get("kite_position") == position
        host.fmu.exitInitializationMode()
        assert (host.get("kite_position"), host.get("kite_velocity")) == (position, velocity)
        host.step(1e-4)
        np.testing.assert_allclose(host.get("kite_position"), np.add(position, 1e-4 * np.array(velocity)), atol=1e-6)


@in_shared_process
def test_the_motion_cannot_be_set(fmu_folder):
    host = Host(fmu_folder / FMU).start()
    host.set(**{"kite_position[1]": 0.0})
    assert host.get("kite_position") == [300.0, 0.0, 400.0]
    with pytest.raises(FMICallException):
        host.step(0.02)
    host.step(0.02)


@in_shared_process
def test_a_start_without_equilibrium_keeps_the_motion_that_was(fmu_folder):
    """Read in initialization mode: what cannot be calculated is NaN; later the motion of before is there again."""
    host = Host(fmu_folder / FMU)
    host.enter_initialization(None)
    before = host.all_outputs()
    kept = {name: host.get(name) for name in ("initial_kite_position", "axial_stiffness", "air_density_scale_height")}
    host.set(initial_kite_position=(1e9, 0.0, -1e9), axial_stiffness=1e-3, air_density_scale_height=1e-3)
    assert np.isnan(host.all_outputs()).all()
    assert host.messages
    host.set(**kept)
    assert host.all_outputs() == before
