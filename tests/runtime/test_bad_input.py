"""Bad starts are refused with a message that names the variable, the value and what is allowed; then a good one works.

Inputs and lengths of steps: `test_hostile_input.py`.
"""

import math

import pytest
from fmpy.fmi1 import FMICallException

from isolation import in_shared_process
from runtime.host import Host, every_flavour, every_flavour_and_version, of_every_flavour
from tetherfmu.export.archive import SLAVES
from tetherfmu.runtime.variants import BY_NAME


def refused(host, action):
    """Run an action that must be refused; returns what was said."""
    host.messages.clear()
    with pytest.raises(FMICallException):
        action()
    return " ".join(host.messages)


@every_flavour
@pytest.mark.parametrize(
    ("name", "value", "allowed"),
    [
        ("segments", 0, "segments is 0; it must be at least 1"),
        ("segments", 301, "at most 300"),
        ("diameter", -0.004, "at least 1e-06 m"),
        ("diameter", math.nan, "at most 10 m"),
        ("initial_length", 0.0, "at least 0.01 m"),
        ("initial_length", 0.1, "0.01 m for each"),
        ("density", 0.0, "at least 0.001 kg/m3"),
        ("axial_stiffness", math.inf, "at most 1e+12 N"),
        ("axial_damping", -1.0, "at least 0 N.s"),
        ("wind_profile", 99, "4 (explog)"),
        ("damping_law", 0, "1 (strain_rate)"),
        ("relative_tolerance", 1.0, "at most 0.1"),
        ("gravity", -9.81, "at least 0 m/s2"),
        ("kite_mass", -1.0, "at least 0 kg"),
        ("kite_mass", math.nan, "at most 1e+09 kg"),
        ("initial_kite_position[3]", math.inf, "at most 1e+09 m"),
        ("initial_kite_velocity[1]", -1e10, "at least -1e+09 m/s"),
        ("ground_position[2]", math.nan, "finite"),
        ("fixed_step", -0.01, "at least 0 s"),
        ("winch_control", 4, "3 (length)"),
        ("winch_mass", -1.0, "at least 0 kg"),
        ("winch_friction", math.inf, "at most 1e+09 N"),
    ],
)
@in_shared_process
def test_a_start_out_of_range(fmu_folder, name, value, allowed):
    host = Host(fmu_folder / "TetherDynamicFree.fmu")
    said = refused(host, lambda: host.start(**{name: value}))
    assert name in said
    assert allowed in said
    assert str(value) in said
    Host(fmu_folder / "TetherDynamicFree.fmu", "next").start().step(0.02)


TOGETHER = (
    (
        {"surface_roughness": 10.0, "wind_profile": 3},
        "surface_roughness is 10.0; it must be less than wind_reference_height",
    ),
    (
        {"ground_contact": 2, "gravity": 0.0},
        "ground_contact is flat; it needs a gravity above 0, for ground_sink is a depth under weight",
    ),
)


@of_every_flavour("fmu")
@pytest.mark.parametrize(("values", "words"), TOGETHER)
@in_shared_process
def test_parameters_that_cannot_be_together(fmu_folder, fmu, values, words):
    host = Host(fmu_folder / f"{fmu}.fmu")
    assert words in refused(host, lambda: host.start(**values))


@every_flavour_and_version
@in_shared_process
def test_a_free_kite_without_an_equilibrium(fmu_folder):
    """Refused where it is sought; what is set then can be started."""
    host = Host(fmu_folder / "TetherDynamicFree.fmu")
    crane = {"initial_length": 40.0, "segments": 8, "kite_mass": 300.0, "kite_start": 2, "axial_stiffness": 1.0}
    words = "no equilibrium was found in which the free kite is at rest"
    assert words in refused(host, lambda: host.start(**crane, wind_velocity=(100.0, 0.0, 0.0)))


@every_flavour
@in_shared_process
def test_parameters_are_fixed_after_the_start(fmu_folder):
    host = Host(fmu_folder / "TetherDynamic.fmu").start()
    host.refuses(lambda: host.set(diameter=0.01), "diameter cannot be set to 0.01 now")
    assert host.get("diameter") == 0.004
    host.step(0.02)


@every_flavour
@in_shared_process
def test_reeling_in_to_nothing(fmu_folder):
    host = Host(fmu_folder / "TetherDynamic.fmu").start()
    said = refused(host, lambda: host.step(1.0, reel_out_speed=-505.0))
    assert "reel_out_speed -505.0" in said
    assert host.get("tether_length") == 505.0
    host.step(0.02, reel_out_speed=0.0)


STOPS = (
    (
        {"shortest_length": 510.0, "longest_length": 510.0},
        "shortest_length is 510.0 m; it must be less than longest_length (510.0 m)",
    ),
    (
        {"shortest_length": 505.5, "longest_length": 600.0},
        "is 505.0 m at the start, beyond a stop of the winch; give an initial_length between 505.5 m and 600 m",
    ),
    ({"shortest_length": 505.5}, "give an initial_length between 505.5 m and inf m"),
    ({"longest_length": 400.0}, "give an initial_length between 0.2 m and 400 m"),
)


@of_every_flavour("fmu")
@pytest.mark.parametrize(("stops", "words"), STOPS)
@in_shared_process
def test_stops_of_a_winch(fmu_folder, fmu, stops, words):
    """0 is no stop; with nodes the shortest length is that of the shortest segments."""
    if words.endswith("400 m") and not BY_NAME[SLAVES[fmu]].has_nodes:
        words = words.replace("0.2 m", "0.01 m")
    host = Host(fmu_folder / f"{fmu}.fmu")
    assert words in refused(host, lambda: host.start(winch_control=2, **stops))
    if "beyond" in words:
        Host(fmu_folder / f"{fmu}.fmu", "next").start(**stops).step(0.02)  # with speed control there are none


@of_every_flavour("fmu")
@in_shared_process
def test_a_winch_without_mass_cannot_push(fmu_folder, fmu):
    """Beyond its friction; nor by a derivative, nor does its force go there by extrapolation."""
    host = Host(fmu_folder / f"{fmu}.fmu").start(winch_control=2, winch_friction=20.0, initial_length=499.0, gravity=0.0)
    twin = Host(fmu_folder / f"{fmu}.fmu").start(winch_control=2, winch_friction=20.0, initial_length=499.0, gravity=0.0)
    said = refused(host, lambda: host.step(0.02, winch_force=-20.1))
    assert "winch_force is -20.1 N" in said
    assert "at least minus winch_friction, which is 20.0 N" in said
    assert "give a winch_mass" in said
    for force in (100.0, 10.0, -19.0):
        host.step(0.02, winch_force=force)
        twin.step(0.02, winch_force=force)
    assert host.all_outputs() == twin.all_outputs()
    Host(fmu_folder / f"{fmu}.fmu", "next").start(winch_control=2, winch_mass=1.0).step(0.02, winch_force=-20.1)


@every_flavour
@in_shared_process
def test_damaged_state_is_refused(fmu_folder):
    host = Host(fmu_folder / "TetherDynamic.fmu").start()
    blob = bytearray(host.fmu.serializeFMUstate(host.fmu.getFMUState()))
    blob[100] ^= 1
    host.refuses(lambda: host.fmu.setFMUState(host.fmu.deSerializeFMUstate(bytes(blob))), "is damaged")
    host.step(0.02)


@every_flavour
@in_shared_process
def test_state_of_another_tether_is_refused(fmu_folder):
    host = Host(fmu_folder / "TetherQuasiSteady.fmu").start()
    other = Host(fmu_folder / "TetherDynamic.fmu").start()
    blob = other.fmu.serializeFMUstate(other.fmu.getFMUState())
    host.refuses(lambda: host.fmu.setFMUState(host.fmu.deSerializeFMUstate(blob)), "belongs to another tether FMU")
    host.step(0.02)


@every_flavour
@in_shared_process
def test_more_fixed_steps_than_the_budget(fmu_folder):
    host = Host(fmu_folder / "TetherDynamic.fmu").start(fixed_step=1e-300)
    said = refused(host, lambda: host.step(0.02))
    assert "fixed_step 1e-300 s" in said
