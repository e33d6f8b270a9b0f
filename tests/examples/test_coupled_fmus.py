"""Examples that couple FMUs: a balloon on three legs, the iterated master; and the study of coupling from end to end."""

import re

import numpy as np
import pytest

from coupling import mooring, ways_of_coupling
from coupling.monolithic import exact
from running import EXAMPLES, assert_is_drawn, run, run_python, run_without


def numbers(said):
    return np.array([line.split() for line in said.splitlines()], dtype=float)


def test_a_mooring_of_fmus_is_that_of_the_python_api(fmu_folder):
    """Both compute the same exchange; the loads are summed in another order, which moves the last digits."""
    code = """
from coupling import mooring, ways_of_coupling
scene = mooring.mooring(0.1)
forces, positions = mooring.fly(scene, *map(circular_flight.find_fmu, ("TetherDynamicFree", "TetherDynamic")), 0.002)
expected = ways_of_coupling.fly("free end, linear", scene, 0.002)
print(abs(forces - expected.forces).max(), abs(positions - expected.positions).max(), len(forces))
"""
    ((force, position, count),) = numbers(run(fmu_folder, code))
    assert force < 1e-6
    assert position < 1e-9
    assert count == 51


def test_the_mooring_pulls_as_the_whole_system(fmu_folder):
    """The rule allows steps of 4 ms; at 2 ms the forces are within 1 %. Least and largest pulls are those of all steps."""
    said = run(fmu_folder, "from coupling import mooring; mooring.main(['--quick'])")
    assert re.search(r"^at rest: knot at \(.+\) m, legs pull with \d+, \d+, \d+ N$", said, re.M)
    assert float(re.search(r"error of the forces: (\S+) %", said)[1]) < 1.0
    printed = re.findall(r"legs pull with (\d+) to (\d+), (\d+) to (\d+), (\d+) to (\d+) N, knot then", said)
    assert len(printed) == 4
    low, high = np.array(printed, dtype=float).reshape(4, 3, 2).transpose(2, 0, 1)
    forces = np.linalg.norm(exact(mooring.mooring(0.2), np.arange(0.0, 0.2001, 0.001), 1e-8)[0], axis=2)
    np.testing.assert_allclose(high.max(axis=0), forces.max(axis=0), rtol=0.01)
    np.testing.assert_allclose(low.min(axis=0), forces.min(axis=0), rtol=0.03)


def test_the_mooring_starts_in_balance():
    """Winches that do not turn: the balloon stays, and the pulls stay what they are."""
    scene = mooring.mooring(0.2)
    still = scene._replace(legs=tuple(leg._replace(reel_out_speed=0.0) for leg in scene.legs))
    flown = ways_of_coupling.fly("free end, linear", still, 0.002)
    np.testing.assert_allclose(flown.positions, np.tile(scene.position, (101, 1)), rtol=0.0, atol=1e-5)
    np.testing.assert_allclose(flown.forces, np.tile(flown.forces[0], (101, 1, 1)), rtol=0.0, atol=0.1)


ITERATED = """
from coupling import iterated_master as master
iterated = [circular_flight.find_fmu(name) for name in ("FlyingKite", "TetherDynamic")]
free = [circular_flight.find_fmu(name) for name in ("PointMassKite", "TetherDynamicFree")]
"""


def test_an_iterated_master_agrees_with_the_free_end(dist):
    """Two ways, two pairs of FMUs, one motion: at 10 ms within 0.1 %; Aitken's method needs fewer tether steps."""
    code = """
fine = master.fly_free(*free, 0.002, 0.4)
for improve in master.NEXT_GUESS.values():
    flown = master.fly_iterated(*iterated, 0.01, 0.4, 1e-4, improve)
    print(master.error(flown, fine), flown.tether_steps)
print(master.error(master.fly_free(*free, 0.01, 0.4), fine), 1)
"""
    aitken, fixed_point, newton, free = numbers(run(dist, ITERATED + code))
    assert max(aitken[0], fixed_point[0], newton[0], free[0]) < 0.001
    assert aitken[1] < newton[1] <= fixed_point[1]


def test_an_iterated_master_gives_up_in_words(dist):
    code = """
try:
    master.fly_iterated(*iterated, 0.02, 0.4, 1e-15)
except RuntimeError as error:
    print(error)
"""
    said = run(dist, ITERATED + code)
    assert re.search(r"^kite and tether differ by \S+ N after 30 iterations at \S+ s: take a shorter step$", said, re.M)


def test_the_study_of_coupling_runs_from_end_to_end(tmp_path):
    done = run_python(EXAMPLES / "coupling" / "coupling_limits.py", "--quick", "--out", tmp_path)
    assert done.returncode == 0, done.stderr
    assert len(re.findall(r"^\| way", done.stdout, re.M)) == 3
    for name in ("errors", "growth", "limits"):
        assert_is_drawn(tmp_path / "figures" / f"coupling_{name}.png")
    assert len(list(tmp_path.glob("data/coupling_*.csv"))) == 4


@pytest.mark.parametrize("example", ["mooring.py", "iterated_master.py"])
def test_a_wrong_step_is_refused_in_one_line(example):
    done = run_python(EXAMPLES / "coupling" / example, "--step", "-1")
    assert done.returncode == 2
    assert re.fullmatch(r".+--step: '-1' is not possible; it must be .+\n", done.stderr)


@pytest.mark.parametrize(
    ("example", "package", "extra"), [("mooring", "scipy", "examples"), ("coupling_limits", "tabulate", "study")]
)
def test_a_missing_package_is_named_in_one_line(example, package, extra):
    done = run_without(package, f"coupling.{example}")
    assert done.returncode == 2
    assert done.stderr == f'{package} is not installed: pip install "tetherfmu[{extra}]"\n'
