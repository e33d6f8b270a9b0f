"""Pumping cycles of four FMUs: a coarse step and both masters give the power of a fine one; what is printed and drawn."""

import re

import numpy as np
import pytest

from running import assert_is_drawn, run

SHORT = "{**kite_power_system.START, 'longest_length': 225.0}"  # a cycle of half a minute
REPORT = r"(cycle 1|all): (\d+\.\d\d) s, mean power (\d+) W, mean force (\d+) N, peak force (\d+) N\n"


def flown(folder, code):
    said = run(folder, f"import numpy\nfrom power_system import kite_power_system, pumping_cycle\n{code}")
    return "".join(line for line in said.splitlines(True) if "has no effect" not in line)  # lengths of the winch beside it


def test_coarse_steps_give_the_power_of_fine_ones(dist):
    """Mean power, mean force and duration of a whole cycle: 20 ms with both masters against 4 ms, within 2 %."""
    code = f"""
for step, master in ((0.02, "jacobi"), (0.02, "gauss_seidel"), (0.004, "jacobi")):
    flight = pumping_cycle.fly(1, step, master, {SHORT})
    a, b = flight.bounds
    duration, energy = flight.time[b] - flight.time[a], flight.values["energy"]
    print((energy[b] - energy[a]) / duration, flight.values["ground_tension"][a:b].mean(), duration)
"""
    jacobi, gauss_seidel, fine = np.array([line.split() for line in flown(dist, code).splitlines()], dtype=float)
    assert fine[0] > 1000.0
    np.testing.assert_allclose(jacobi, fine, rtol=0.02)
    np.testing.assert_allclose(gauss_seidel, fine, rtol=0.02)


def test_the_start_is_no_jolt(dist):
    """In the first five seconds the tether pulls no more than in the cycles, and is never slack."""
    code = """
with pumping_cycle.system(kite_power_system.START, "jacobi") as (parts, signals, places, _):
    for k in range(250):
        pumping_cycle.jacobi(parts, signals, 0.02 * k, 0.02)
        print(signals[places["ground_tension"]])
"""
    tension = np.array(flown(dist, code).split(), dtype=float)
    assert 1000.0 < tension.min() < tension.max() < 3600.0
    assert np.abs(np.diff(tension)).max() < 300.0  # of one step


def test_prints_draws_and_animates(dist, tmp_path):
    options = ["--cycles", "1", "--html", "--out", str(tmp_path)]
    said = flown(dist, f"kite_power_system.START['longest_length'] = 225.0\npumping_cycle.main({options!r})")
    found = re.fullmatch(2 * REPORT + r"\d+ times real time\n(?:.+\n){3}", said)
    assert found, said
    one, whole = found.groups()[1:5], found.groups()[6:]
    assert one == whole
    _, power, mean, peak = map(float, one)
    assert 1000.0 < power < 5000.0
    assert mean < peak < 4000.0
    for name in ("pumping_path.png", "pumping_series.png"):
        assert_is_drawn(tmp_path / name)
    page = (tmp_path / "pumping_cycle.html").read_text(encoding="utf-8")
    assert "Pumping kite" in page
    assert "<script src=" not in page


@pytest.mark.parametrize("wind", [10, 14])
def test_a_step_that_is_too_long_is_named_as_the_cause(dist, wind, tmp_path):
    """Not too little wind, nor what an FMU refuses in the end; half of the step is advised, and holds over a cycle."""
    options = ["--wind", str(wind), "--step", "0.03", "--out", str(tmp_path)]
    advised = ["--wind", str(wind), "--step", "0.015", "--cycles", "1", "--out", str(tmp_path)]
    code = f"""
import contextlib, sys
kite_power_system.START["longest_length"] = 225.0
with contextlib.redirect_stderr(sys.stdout):
    print("status", pumping_cycle.main({options!r}))
    print("status", pumping_cycle.main({advised!r}))
"""
    said = flown(dist, code)
    causes = r"the exchange diverges after \d\.\d s: .+; take --step 0\.015 or --master gauss_seidel, .+"
    assert re.search(rf"^{causes}\nstatus 1\n(?:.+\n)*status 0$", said, re.M), said
    assert "more wind" not in said
    assert ("the motor of the winch is too weak for this wind: for " in said) is (wind == 14)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"wind_velocity[1]": float("nan")}, "wind_velocity[1] is nan; it must be a finite number"),
        ({"torque_limit": 1.0, "maximum_length": 250.0}, "the winch is jammed: tether_length is"),
        ({"wind_velocity[1]": 0.0}, "the kite came down after"),
        ({"wind_velocity[1]": 5.0}, "it needs more wind"),
        ({"kite_mass": -1.0}, "kite_mass is -1.0; it must be at least 0 kg"),
    ],
    ids=["nan", "jammed", "no_wind", "little_wind", "mass"],
)
def test_what_cannot_fly_ends_in_words(dist, changes, words):
    code = f"""
import contextlib, sys
from tetherfmu.console.ending import command
nan = float("nan")
changed = {{**kite_power_system.START, **{changes!r}}}
with contextlib.redirect_stderr(sys.stdout):
    print("status", command(lambda: pumping_cycle.fly(1, 0.02, "jacobi", changed) and None)())
"""
    said = flown(dist, code)
    assert words in said
    assert "status 1" in said
    assert "Traceback" not in said
