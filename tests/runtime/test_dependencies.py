"""The dependencies that the model description declares are true, in both directions.

In initialization mode every input and parameter is changed, one at a time, in several scenes. An output that changes must
declare the dependency; a declared dependency must be seen in one of the scenes, but for the few with a reason below.
"""

from itertools import product

import pytest

from isolation import in_shared_process
from runtime.host import Host
from scenes import kite_at_start, kite_inputs
from tetherfmu.export.archive import SLAVES

ROUNDING = 1e-10  # a change below this part of the value is rounding: n segments in series add up to L/EA for each n
KITE = (300.0, 70.0, 400.0), (3.0, 12.0, -2.0)  # position, velocity
SCENE = {  # nothing at zero, nothing along an axis, all that a wind profile reads
    "ground_position": (3.0, -2.0, 5.0),
    "ground_velocity": (0.3, 0.2, -0.1),
    "reel_out_speed": 0.4,
    "wind_velocity": (8.0, 1.0, 0.5),
    "segments": 7,
    "wind_profile": 4,
    "wind_exponent": 0.2,
    "surface_roughness": 0.1,
    "air_density_scale_height": 8550.0,
    "winch_length": 507.0,
}
# taut; 2 mm less than the distance of the ends, 499.418 m, and more; slack
LENGTHS = (495.0, 499.416, 499.5, 520.0)
ON_GROUND = {"ground_contact": 2, "ground_friction": 0.2, "longest_length": 0.0}
LENGTHS_ON_GROUND = (630.0, 650.0, 700.0, 800.0)  # the tether touches it, of chains the last one
OF_CATENARY = (2000.0,)  # which the wind carries longer
SHAPES, LAWS = (1, 2, 3), (1, 2)
IN_BALANCE = (200.0, 2000.0)  # forces of the winch that find the length [N]
IN_BALANCE_ON_GROUND = (8.0, 15.0)
LIMITING = ("fixed_step", "fixed_step_method", "winch_control")  # what counts for the work of a step
BALANCE = ("winch_start", "winch_force", "winch_damping", "winch_friction", "longest_length")
OF_LENGTH = ("tether_length", "kite_end_mass", "kite_stiffness", "kite_damping")
STEADY = ("ground_elevation", "ground_azimuth", "sag", "shape", "grounded_length", "kite_position")
AT_REST = {
    "kite_start": 2,
    "kite_load": (110.0, 60.0, 400.0),
    "initial_length": 505.0,
    "winch_length": 507.0,
    "initial_shape": 1,
}
LIES = {  # and slides until its tether is taut
    "ground_contact": 2,
    "ground_height": -300.0,
    "initial_kite_position": (200.0, 100.0, -299.9),
    "kite_load": (110.0, 60.0, 20.0),
}
CHAINS = ("TetherQuasiSteady", "TetherDynamic", "TetherDynamicFree")


def not_seen(fmu, output, known):
    """Whether a declared dependency cannot be seen in these scenes."""
    name = output.partition("[")[0]
    if name == "solver_iterations":
        return True  # a count, which may be the same by chance
    if name == "slack_segments":
        return True  # a whole number, which few inputs change in these scenes
    if known == "shortest_length":  # as longest_length, which is seen
        return True
    if name == "kite_position" and known in (*BALANCE, "damping_law"):  # no length is in balance where a free kite rests
        return True
    if name in OF_LENGTH and (known.startswith("kite_") or known in ("ground_contact", "slack_stiffness_ratio")):
        return True  # which a length in balance depends on as tension and shape do
    if fmu not in CHAINS:
        return False
    # where a kite rests moves with the ground end; where the search begins counts in its rounding, and on the ground
    if known.startswith(("initial_kite_position", "ground_position")) and name in ("kite_position", "shape"):
        return True
    # no segment is in compression here: that takes air which blows a slack tether back on itself (theory, "Initial shape")
    return known == "slack_stiffness_ratio" and (fmu == "TetherQuasiSteady" or name in STEADY)


def other_value(host, known):
    """Another allowed value of an input or parameter."""
    value = host.get(known.name)
    if known.declaredType is not None:
        numbers = [int(item.value) for item in known.declaredType.items]
        return numbers[(numbers.index(value) + 1) % len(numbers)]
    if known.type == "Boolean":
        return not value
    if known.type == "Integer":
        return value + 2
    if known.name == "slack_damping_ratio":
        return 0.5
    return 1.01 * value + 0.05


def values(host, outputs):
    """Values of some outputs, read by one call for each type."""
    found = {}
    for kind, get in (("Real", host.fmu.getReal), ("Integer", host.fmu.getInteger), ("Boolean", host.fmu.getBoolean)):
        names = [name for name in outputs if host.kind[name] == kind]
        found |= zip(names, get([host.reference[name] for name in names]), strict=True)
    return [found[name] for name in outputs]


def see_dependencies(host, knowns, outputs):
    """Set of (output, known) that were seen in a scene."""
    before = values(host, outputs)
    seen = set()
    for known in knowns:
        value = host.get(known.name)
        host.set(**{known.name: other_value(host, known)})
        after = values(host, outputs)
        host.set(**{known.name: value})
        for name, old, new in zip(outputs, before, after, strict=True):
            if abs(new - old) > ROUNDING * max(1.0, abs(old)):
                seen.add((name, known.name))
    assert values(host, outputs) == before
    return seen


@pytest.mark.parametrize("fmu", list(SLAVES))
@in_shared_process
def test_initial_dependencies_are_true(fmu_folder, fmu):
    host = Host(fmu_folder / f"{fmu}.fmu")
    host.fmu.setupExperiment(startTime=0.0)
    host.fmu.enterInitializationMode()
    unknowns = host.description.initialUnknowns
    declared = {(each.variable.name, known.name) for each in unknowns for known in each.dependencies}
    outputs = [each.variable.name for each in unknowns]
    knowns = [each for each in host.description.modelVariables if each.causality in ("input", "parameter")]
    seen = set()
    host.set(**kite_at_start(fmu, *KITE), **SCENE)
    for length, shape, law in product(LENGTHS, SHAPES, LAWS):
        host.set(initial_length=length, initial_shape=shape, damping_law=law)
        seen |= see_dependencies(host, knowns, outputs)
    host.set(winch_control=3, initial_shape=1)
    for length in LENGTHS:
        host.set(winch_length=length)
        seen |= see_dependencies(host, [each for each in knowns if each.name.startswith("winch_")], outputs)
    host.set(winch_control=2, initial_length=505.0, longest_length=600.0)  # a winch with its length between two stops
    seen |= see_dependencies(host, knowns, outputs)
    for force, shape, law in product(IN_BALANCE, SHAPES, LAWS):  # which finds the length
        host.set(winch_start=2, winch_force=force, initial_shape=shape, damping_law=law)
        seen |= see_dependencies(host, knowns, outputs)
    host.set(winch_start=1, fixed_step=0.01)
    seen |= see_dependencies(host, [each for each in knowns if each.name in LIMITING], outputs)
    host.set(fixed_step=0.0, **ON_GROUND)
    lying = [each for each in knowns if each.name != "kite_start"]  # what a kite in the air does there is found below
    lengths = LENGTHS_ON_GROUND + (OF_CATENARY if fmu == "TetherCatenary" else ())
    for length, control, shape in product(lengths, (1, 3), (1, 2)):
        host.set(ground_height=4.9 if length >= LENGTHS_ON_GROUND[-1] else 3.0)
        host.set(initial_shape=shape, initial_length=length, winch_length=length + 5.0, winch_control=control)
        seen |= see_dependencies(host, lying, outputs)
    host.set(winch_control=2, winch_start=2)
    for force in IN_BALANCE_ON_GROUND:
        host.set(winch_force=force)
        seen |= see_dependencies(host, lying, outputs)
    host.set(winch_start=1)
    if fmu == "TetherDynamicFree":
        for contact, control in product(({"ground_contact": 1}, LIES), (1, 3)):
            host.set(**{**AT_REST, **contact, "winch_control": control})
            seen |= see_dependencies(host, knowns, outputs)
    assert not seen - declared, sorted(seen - declared)[:20]
    unseen = sorted(pair for pair in declared - seen if not not_seen(fmu, *pair))
    assert not unseen, unseen[:20]
    assert not [each for each in host.messages if "winch_start" not in each], host.messages  # of a kite that is sought, too
    host.fmu.exitInitializationMode()
    host.close()


@pytest.mark.parametrize("fmu", list(SLAVES))
@in_shared_process
def test_outputs_do_not_follow_an_input_before_the_next_step(fmu_folder, fmu):
    """ModelStructure says that outputs depend on no input between two steps."""
    host = Host(fmu_folder / f"{fmu}.fmu").start()
    host.step(0.02)
    before = host.all_outputs()
    vectors = {name: value for name, value in SCENE.items() if f"{name}[1]" in host.reference}
    host.set(reel_out_speed=0.4, **kite_inputs(fmu, *KITE), **vectors)
    assert host.all_outputs() == before
    host.close()
