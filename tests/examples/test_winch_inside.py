"""A pumping kite with its winch inside the tether: the power of the winch FMU, in steps in which the winch FMU fails."""

import zipfile
from importlib.util import find_spec
from types import SimpleNamespace

import numpy as np
import pytest

from fmus import winch_motor
from isolation import own_process
from power_system.kite_power_system import OWN_STEPS
from running import assert_is_drawn, run
from shared import ssp
from tetherfmu.export.build_options import BuildOptions
from tetherfmu.export.documents import OSP_FOLDER
from tetherfmu.libraries.examples import example

SHORT = "{**kite_power_system.START, 'controller.longest_length': 225.0}"  # a cycle of half a minute
POWER = """
def power(cycle):
    time, tension, speed, _ = cycle
    return numpy.trapezoid(tension * speed, time) / (time[-1] - time[0])
"""


def flown(folder, code):
    rooms = "kite_power_system, pumping_cycle, winch_inside"
    said = run(folder, f"import numpy\nfrom power_system import {rooms}\n{POWER}{code}")
    return "".join(line for line in said.splitlines(True) if "[WARNING]" not in line)


@pytest.fixture(scope="module")
def beside(dist):
    """Mean power [W] with the winch FMU, over a cycle of 150 m, in steps of 50 ms: 0.2 % from that in steps of 20 ms."""
    code = """
flight = pumping_cycle.fly(1, 0.05, "gauss_seidel")
a, b = flight.bounds
print((flight.values["energy"][b] - flight.values["energy"][a]) / (flight.time[b] - flight.time[a]))
"""
    return float(flown(dist, code))


def test_the_power_is_that_of_the_winch_fmu(dist, beside):
    """The drum follows the controller in less than half a second, of the three in which it changes over twice in 98 s."""
    inside = float(flown(dist, "print(power(winch_inside.fly(0.1, True)))"))
    assert beside > 1000.0
    assert inside == pytest.approx(beside, rel=0.01)


def by_libcosim(folder):
    """Mean power [W] over a cycle after the first reeling in, of the system structure in a folder."""
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimObserver import CosimObserver

    execution, observer = CosimExecution.from_osp_config_file(osp_path=folder), CosimObserver.create_last_value()
    assert execution.add_observer(observer)
    controller, motor = map(execution.slave_index_from_instance_name, ("controller", "motor"))
    depower, energy = (
        next(each.reference for each in execution.slave_variables(at) if each.name.decode() == name)
        for at, name in ((controller, "depower"), (motor, "energy"))
    )
    found, before = [], 0.0
    while len(found) < 2:
        assert execution.step()
        now = observer.last_real_values(controller, [depower])[0]
        if before == 1.0 > now:
            found.append((execution.status().current_time * 1e-9, observer.last_real_values(motor, [energy])[0]))
        before = now
    (begin, least), (end, most) = found
    return (most - least) / (end - begin)


@pytest.mark.skipif(find_spec("libcosimpy") is None, reason="libcosimpy is not installed")
def test_libcosim_flies_the_file_with_the_motor_in_steps_of_100_ms(tmp_path, beside):
    """Its system structure has tether and kite in steps of 20 ms, motor and controller, which are late, in longer ones."""
    assert OWN_STEPS == {"controller": 0.1, "motor": 0.1}
    given = example("power_system.kite_power_system")
    fidelities = {"standard": {"tether": given.FIDELITIES["standard"]}}
    wiring = ssp.Wiring(steps=OWN_STEPS)
    path = ssp.write("winch_inside", given.INSIDE, given.INSIDE_START, fidelities, tmp_path, BuildOptions(), wiring)
    with zipfile.ZipFile(path) as archive:
        archive.extractall(tmp_path / "extracted")
    inside = own_process(by_libcosim, folder=str(tmp_path / "extracted" / OSP_FOLDER))
    assert inside == pytest.approx(beside, rel=0.01)


def test_steps_of_100_ms_give_what_steps_of_20_ms_give(dist):
    """The controller sees up to 80 ms later where reeling in begins and ends, and so does the motor: 0.3 % of 25 s each."""
    code = f"for step in (0.02, 0.1): print(power(winch_inside.fly(step, True, {SHORT})))"
    fine, coarse = map(float, flown(dist, code).split())
    assert coarse == pytest.approx(fine, rel=0.02)


@pytest.mark.parametrize("master", ["jacobi", "gauss_seidel"])
def test_the_masters_of_the_pumping_cycle_diverge_in_100_ms(dist, master):
    assert flown(dist, f"print(winch_inside.explicit({master!r}, 0.1))").startswith("the exchange diverges after 0.")


def test_in_200_ms_the_winch_fmu_swings_and_the_winch_inside_does_not(dist):
    """The drum accelerates by no more than what the controller may ask for and a swing of the tension by half may add.

    That is 4 m/s2 and 1000 N on 300 kg; the winch FMU jerks its drum with all that its motor has, 27 m/s2.
    """
    code = f"for inside in (True, False): print(abs(numpy.diff(winch_inside.fly(0.2, inside, {SHORT})[2])).max() / 0.2)"
    inside, beside = map(float, flown(dist, code).split())
    assert inside < 4.0 + 1000.0 / 300.0
    assert beside > 20.0


def test_the_drum_and_its_controller_agree_at_rest():
    """Where the tension is the one for the speed of the drum, the motor pulls with it, less the friction."""
    motor = SimpleNamespace(**{key: value for kind in winch_motor.WinchMotor.records for key, value in vars(kind()).items()})
    for speed, depower in ((2.5, 0.0), (-3.0, 1.0)):
        tension = {0.0: 300.0 * 2.5**2, 1.0: 1800.0 * (1.0 - 3.0 / 8.0)}[depower]
        assert winch_motor.wanted_speed(tension, depower, 0.5, motor) == pytest.approx(speed)
        friction = 30.6 * speed + 122.0 * np.sign(speed)
        found = winch_motor.pull(tension, speed, depower, (100.0, 0.0, 50.0), 0.1, motor)
        assert found == pytest.approx(tension - friction, abs=0.1)  # friction fades below 5 cm/s: 0.02 N of it
        more = winch_motor.pull(tension + 100.0, speed, depower, (100.0, 0.0, 50.0), 0.1, motor)
        assert more < found  # it lets the drum go


def test_prints_and_draws(dist, tmp_path):
    """What is printed and drawn of flights, here of no real ones."""
    code = f"""
time = numpy.linspace(0.0, 100.0, 1001)
cycle = numpy.array([time, 1800.0 + 0.0 * time, 3.0 * numpy.sin(0.1 * time), 2.0 + 0.0 * time])
winch_inside.fly = lambda step, inside: cycle
winch_inside.explicit = lambda master, step: master
winch_inside.main(['--out', {str(tmp_path)!r}])
"""
    lines = flown(dist, code).splitlines()
    assert [line.partition(":")[0] for line in lines[4:-1]] == [
        f"winch {where}, {step} ms" for where in ("as an FMU", "inside the tether") for step in (20, 100, 200)
    ]
    assert all("1800 N, 2.0 tether steps" in line for line in lines[4:-1])
    assert [line.split(", ")[1] for line in lines[:4]] == 2 * ["jacobi"] + 2 * ["gauss_seidel"]
    assert_is_drawn(tmp_path / "winch_inside.png")
