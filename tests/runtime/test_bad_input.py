"""What is wrong or implausible is said in the same words, with the same digits, by all flavours and in both languages.

What is refused names the variable, the value and what is allowed; a warning is given once since a start, and the step is
done. Hostile numbers on every variable: `test_hostile_input.py`.
"""

import math
import re
from typing import NamedTuple

import pytest
from fmpy.fmi1 import FMICallException

from isolation import in_shared_process
from runtime.host import STEP, Host, of_every_flavour
from tetherfmu.export.archive import SLAVES

NOTHING = {}
EVERY = tuple(SLAVES)
LINES, WITH_NODES, WITHOUT_WAVES, WITH_WAVES, FREE = EVERY[:2], EVERY[2:], EVERY[:3], EVERY[3:], EVERY[4:]
BY_FORCE = {"winch_control": 2}


class Case(NamedTuple):
    """Start values, words that are said, inputs of a step and its size [s]."""

    start: dict
    words: str
    inputs: dict = NOTHING
    step: float = STEP


REFUSED = {  # for these tethers
    EVERY: [
        Case({"segments": 0}, "segments is 0; it must be at least 1"),
        Case({"segments": 301}, "segments is 301; it must be at least 1 and at most 300"),
        Case({"diameter": -0.004}, "diameter is -0.004; it must be at least 1e-06 m"),
        Case({"diameter": math.nan}, "diameter is nan; it must be at least 1e-06 m and at most 10 m"),
        Case({"initial_length": 0.0}, "initial_length is 0.0; it must be at least 0.01 m"),
        Case({"density": 1e-320}, "density is 1e-320; it must be at least 0.001 kg/m3"),
        Case({"axial_stiffness": math.inf}, "axial_stiffness is inf; it must be at least 0.001 N and at most 1e+12 N"),
        Case({"axial_stiffness": 1.2345678901234567e300}, "axial_stiffness is 1.2345678901234567e+300; it must be"),
        Case({"axial_damping": -1.0}, "axial_damping is -1.0; it must be at least 0 N.s"),
        Case({"wind_profile": 99}, "wind_profile is 99; it must be one of 1 (uniform), 2 (power_law), 3 (logarithmic), 4 "),
        Case({"wind_profile": 3, "surface_roughness": 10.1}, "is 10.1; it must be less than wind_reference_height (6.0"),
        Case({"damping_law": 0}, "damping_law is 0; it must be one of 1 (strain_rate), 2 (stretch_rate)"),
        Case({"damping_law": 3}, "damping_law is 3; it must be one of 1 (strain_rate), 2 (stretch_rate)"),
        Case({"relative_tolerance": 0.1 + 1e-16}, "relative_tolerance is 0.1000000000000001; it must be at least 0"),
        Case({"gravity": -9.81}, "gravity is -9.81; it must be at least 0 m/s2"),
        Case({"gravity": 123456789012345680.0}, "gravity is 1.2345678901234568e+17; it must be at least 0 m/s2"),
        Case({"fixed_step": -0.01}, "fixed_step is -0.01; it must be at least 0 s"),
        Case({"ground_contact": 2, "gravity": 0.0}, "ground_contact is flat; it needs a gravity above 0, for ground_sink i"),
        Case({"ground_sink": 1e-7}, "ground_sink is 1e-07; it must be at least 1e-06 m"),
        Case({"winch_control": 4}, "winch_control is 4; it must be one of 1 (speed), 2 (force), 3 (length)"),
        Case({"winch_mass": -1.0}, "winch_mass is -1.0; it must be at least 0 kg"),
        Case({"winch_friction": math.inf}, "winch_friction is inf; it must be at least 0 N and at most 1e+09 N"),
        Case({"shortest_length": 510.1, "longest_length": 510.1}, "is 510.1 m; it must be less than longest_length (510."),
        Case({**BY_FORCE, "shortest_length": 505.5}, "give an initial_length between 505.5 m and inf m"),
        Case({**BY_FORCE, "shortest_length": 505.5, "longest_length": 600.0}, "between 505.5 m and 600 m"),
        Case({**BY_FORCE, "winch_friction": 0.1}, "winch_force is -0.30000000000000004 N; it must be at least minus "
             "winch_friction, which is 0.1 N", {"winch_force": -0.1 - 0.2}),
        Case({"ground_position[2]": math.nan}, "the input ground_position[2] is nan; it must be a finite number"),
        Case({}, "the input wind_velocity[1] is nan; it must be a finite number", {"wind_velocity[1]": math.nan}),
        Case({}, "the input ground_position[2] is -inf; it must be a finite number", {"ground_position[2]": -math.inf}),
        Case({}, "the input ground_velocity[3] is 1000000000.0000002", {"ground_velocity[3]": 1.0000000000000002e9}),
        Case({}, "the input reel_out_speed is 1e+16; it must be a finite number", {"reel_out_speed": 1e16}),
        Case({}, "the reel_out_speed -505.0 m/s over a step of 1.0 s would leave segments", {"reel_out_speed": -505.0}, 1.0),
        Case({}, "the communication step is 0.0 s; it must be greater than 0", step=0.0),
        Case({}, "the communication step is -0.30000000000000004 s; it must be greater than 0", step=-0.1 - 0.2),
        Case({}, "the communication step is 1e+22 s; it must be", step=1e22),
    ],
    LINES: [Case({**BY_FORCE, "longest_length": 400.0}, "give an initial_length between 0.01 m and 400 m")],
    WITH_NODES: [
        Case({**BY_FORCE, "longest_length": 400.0}, "give an initial_length between 0.2 m and 400 m"),
        Case({"initial_length": 0.1}, "initial_length is 0.1 m for 20 segments; it must be at least 0.01 m for each"),
    ],
    WITHOUT_WAVES: [
        Case({**BY_FORCE, "initial_length": 490.0}, "no unstretched length was found at which the tether pulls with "
             "winch_force (1000000000.0 N)", {"winch_force": 1e9}),
    ],
    WITH_WAVES: [
        Case({"fixed_step": 1e-5}, "each internal step of fixed_step 1e-05 s); use a longer fixed_step or", step=1e5),
        Case({"fixed_step": 1e-300}, "each internal step of fixed_step 1e-300 s); use a longer fixed_step or a shorter"),
    ],
    FREE: [
        Case({"kite_mass": math.nan}, "kite_mass is nan; it must be at least 0 kg and at most 1e+09 kg"),
        Case({"initial_kite_position[3]": math.inf}, "initial_kite_position[3] is inf; it must be at least -1e+09 m and"),
        Case({"initial_kite_velocity[1]": -1e10}, "initial_kite_velocity[1] is -10000000000.0; it must be at least -1e+0"),
        Case({"kite_start": 2, "kite_mass": 300.0, "initial_length": 40.0, "segments": 8, "axial_stiffness": 1.0,
              "wind_velocity": (100.0, 0.0, 0.0)}, "no equilibrium was found in which the free kite is at rest"),
    ],
}  # fmt: skip
CANNOT_BREAK = "breaking_force is 5000 N and has no effect: this tether cannot break; the dynamic one can"
STIFF = {"axial_stiffness": 1e8}
SAID = {  # in the same way, warnings; without words nothing is said
    EVERY: [
        Case({"initial_length": 100.0}, "a segment is stretched by 400 %; from 5 % on, most ropes break; check kite_position"
             " (initial_kite_position of a free kite end)"),
        Case({**STIFF, "diameter": 4.0}, "diameter is 4 m, more than 0.2 m; diameters are in m: 4 mm are 0.004"),
        Case({**STIFF, "diameter": 0.2}, ""),
        Case({"shortest_length": 505.5, "longest_length": 600.0}, "is set and has no effect: winch_control is not 2 (force"),
        Case({**BY_FORCE, "winch_mass": 1.0, "initial_length": 499.0}, "", {"winch_force": -20.1}),  # it may push
        Case({**BY_FORCE, "winch_mass": 1e-3, "initial_length": 700.0}, "the winch runs at", {"winch_force": 2e3}, 0.1),
        Case({"winch_control": 3, "initial_length": 551.3}, "the length that the winch follows is 51.3 m longer than the"),
    ],
    LINES + WITH_WAVES: [Case({"initial_length": 123.456}, "the ground end moves at", {"ground_velocity[1]": 5e5})],
    EVERY[1:]: [Case({"initial_length": 560.0}, "below ground_height with both ends above it; set ground_contact to 2 (")],
    WITHOUT_WAVES: [
        Case({"breaking_force": 5e3}, CANNOT_BREAK),
        Case({}, "a communication step is 100000 s long, more than 10 s; steps are in s: 20 ms are 0.02", step=1e5),
    ],
    WITH_WAVES: [
        Case({"breaking_force": 5e3}, ""),
        Case({"fixed_step": 1e-3, "fixed_step_method": 2}, "additional axial_damping of 615 N.s"),  # E A h
        Case({"fixed_step": 1e-3}, ""),
        Case({**BY_FORCE, "initial_length": 490.0}, "the winch runs at", {"winch_force": 1e9}),
    ],
}  # fmt: skip
FRONT = re.compile(r"^(tether: )?(fmi[23]\w+: )?")  # names of the instance and of the call


def each_of(table):
    """Each tether with each case for it."""
    return pytest.mark.parametrize(
        ("name", "case"), [(name, case) for names in table for case in table[names] for name in names]
    )


def told(host, case):
    """Whether the start or the step is refused; and what is said, without what PythonFMU's library says of its own."""
    host.messages.clear()
    refused = False
    try:
        host.start(**case.start)
        host.step(case.step, **case.inputs)
    except FMICallException:
        refused = True
    said = [FRONT.sub("", text).replace("%%", "%") for text in host.messages if "PyObject" not in text]  # printf formats
    return refused, said


@each_of(REFUSED)
@in_shared_process
def test_refused(fmu_folder, native_folder, fmi3_folder, name, case):
    """Then a good start works."""
    said = []
    for folder in (fmu_folder, native_folder, fmi3_folder):
        refused, texts = told(Host(folder / f"{name}.fmu"), case)
        assert refused
        said.append(texts)
        Host(folder / f"{name}.fmu", "next").start().step(STEP)
    assert said[0] == said[1] == said[2]
    assert case.words in " ".join(said[0])


@each_of(SAID)
@in_shared_process
def test_said(fmu_folder, native_folder, fmi3_folder, name, case):
    """Again after a reset."""
    found = []
    for folder in (fmu_folder, native_folder, fmi3_folder):
        host = Host(folder / f"{name}.fmu")
        found.append(told(host, case))
        host.fmu.reset()
        host.time = 0.0
        assert told(host, case) == found[-1]
    assert found[0] == found[1] == found[2]
    refused, said = found[0]
    assert not refused
    assert [case.words in text for text in said].count(True) == bool(case.words), said


@of_every_flavour("fmu")
@in_shared_process
def test_a_force_that_is_refused_does_not_count(fmu_folder, fmu):
    """A winch without mass cannot push beyond its friction; nor does its force go there by extrapolation."""
    start = {**BY_FORCE, "winch_friction": 20.0, "initial_length": 499.0, "gravity": 0.0}
    host, twin = (Host(fmu_folder / f"{fmu}.fmu").start(**start) for _ in range(2))
    with pytest.raises(FMICallException):
        host.step(STEP, winch_force=-20.1)
    for force in (100.0, 10.0, -19.0):
        host.step(STEP, winch_force=force)
        twin.step(STEP, winch_force=force)
    assert host.all_outputs() == twin.all_outputs()
