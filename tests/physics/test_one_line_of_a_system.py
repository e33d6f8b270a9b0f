"""A line between driven points of a system is `TetherDynamic`: the same arithmetic in other arrays, with the same events.

In fixed steps to the last bit, with adaptive ones within 1e-10; several of them side by side know nothing of each other.
"""

import numpy as np
import pytest

from solvers import METHODS, with_each_solver
from tetherfmu import Environment, Ground, Line, Point, Solver, Tether, TetherDynamic, TetherSystem, Winch

pytestmark = pytest.mark.filterwarnings("ignore::tetherfmu.PlausibilityWarning")  # drums at the extremes
STEP, WIND = 0.02, (8.0, 1.0, 0.0)
TETHER, ON_GROUND = Tether(segments=6, initial_length=100.2), Ground(ground_contact="flat")
SECTIONS = (Tether(segments=3, initial_length=60.1), Tether(segments=2, initial_length=40.1, diameter=0.008))
DRUMS = {
    "mass": {"winch_mass": 20.0, "winch_damping": 5.0},
    "no mass": {"winch_damping": 30.0},
    "no drum": {},
    "friction": {"winch_mass": 20.0, "winch_friction": 60.0},
    "friction, no mass": {"winch_friction": 60.0},
    "stops": {"winch_mass": 5.0, "shortest_length": 100.1, "longest_length": 100.3},
    "stops, no mass": {"shortest_length": 100.1, "longest_length": 100.3},
}
DRUMS = {name: Winch(winch_control="force", **drum) for name, drum in DRUMS.items()}
CASES = {  # tethers, winch, and what else the system has
    "speed": (TETHER, Winch(), {}),
    "static start": (TETHER, Winch(), {"solver": {"initial_shape": "static_equilibrium"}}),
    "on the ground": (Tether(segments=6, initial_length=125.0), Winch(), {"ground": ON_GROUND}),
    "length": (TETHER, Winch(winch_control="length"), {}),
    "sections": (SECTIONS, Winch(), {}),
    "sections on a drum": (SECTIONS, DRUMS["mass"], {}),
    **{name: (TETHER, drum, {}) for name, drum in DRUMS.items()},
    **{f"{name}, 1 segment": (Tether(segments=1, initial_length=100.2), drum, {}) for name, drum in DRUMS.items()},
}


def kite(time):
    """Position and velocity on a circle that grows."""
    c, s, grown = np.cos(time / 3.0), np.sin(time / 3.0), 1.0 + 0.006 * time
    x, v = np.array((60.0 * c, 60.0 * s, 80.0)), np.array((-20.0 * s, 20.0 * c, 0.0))
    return grown * x, grown * v + 0.006 * x


def both(tether, winch, solver, place, velocity=(0.0, 0.0, 0.0), speed=0.0, ground=None):
    """The same line as a system and as a `TetherDynamic`, started."""
    points, more = [Point("ground", (0.0, 0.0, 0.0)), Point("kite", place, velocity)], {"ground": ground or Ground()}
    single = TetherDynamic(tether, Environment(), solver, winch, **more)
    system = TetherSystem(points, [Line("line", "ground", "kite", tether, speed, winch)], solver=solver, **more)
    single.initialize(kite_position=place, kite_velocity=velocity, reel_out_speed=speed, wind_velocity=WIND)
    system.initialize(WIND)
    return system, single


def assert_equal(system, single, within=0.0):
    """Motion, forces, drum, work and warnings of both are the same."""
    found, wanted = system.outputs(), single.outputs()
    np.testing.assert_allclose(system.positions["line"], single.positions, rtol=0, atol=within)
    np.testing.assert_allclose(system.velocities["line"], single.velocities, rtol=0, atol=100.0 * within)
    names = (
        "tether_length",
        "winch_speed",
        "ground_force",
        "kite_force",
        "ground_tension",
        "peak_tension",
        "grounded_length",
    )
    for name in names:
        np.testing.assert_allclose(getattr(found.lines["line"], name), getattr(wanted, name), rtol=within, atol=within)
    energy, account = system.energy(), single.energy()
    assert (energy.total, energy.power) == pytest.approx((account.total, account.power), rel=max(within, 1e-12))
    assert system.counters == single.counters
    assert found.solver_iteration_limit == wanted.solver_iteration_limit
    said = "; ".join(system.implausible).replace("the line line: ", "").replace("its end at kite", "the kite end")
    assert said.replace("kite.", "kite_") == "; ".join(single.implausible)


@with_each_solver(0.01)
@pytest.mark.parametrize("case", CASES)
def test_one_line_is_the_dynamic_tether(case, solver):
    tether, winch, more = CASES[case]
    if "solver" in more:
        solver = Solver(fixed_step=solver.fixed_step, fixed_step_method=solver.fixed_step_method, **more["solver"])
    system, single = both(tether, winch, solver, *kite(0.0), 0.3, more.get("ground"))
    lengths = []
    for time in STEP * np.arange(60):
        x, v = kite(time)
        told = {"winch_length": 100.2 + 0.4 * np.sin(time), "winch_force": 400.0 + 150.0 * np.sin(6.0 * time)}
        told = {name: value for name, value in told.items() if name.endswith(CONTROLS[winch.winch_control])}
        wanted = single.step(STEP, kite_position=x, kite_velocity=v, **told)
        system.step(STEP, {"kite": x}, {"kite": v}, **{f"{name}s": {"line": value} for name, value in told.items()})
        lengths.append(wanted.tether_length)
    assert_equal(system, single, 1e-10 if solver.fixed_step == 0.0 else 0.0)
    assert np.ptp(lengths) > 0.15
    assert system.counters["steps"] == 120 or solver.fixed_step == 0.0


CONTROLS = {Winch(winch_control=name).winch_control: name for name in ("speed", "force", "length")}
HARD = {  # fewest iterations of the worst step of 0.1 s
    "line": (Tether(segments=100, initial_length=20.0, axial_stiffness=1e7, axial_damping=0.0), Winch(), 500),
    "drum": (
        Tether(segments=60, initial_length=140.0, axial_stiffness=1e7, axial_damping=0.0),
        Winch(winch_control="force", winch_mass=0.1, winch_friction=5.0, shortest_length=20.0),
        100,
    ),
}


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("kind", HARD)
def test_hard_steps_are_bounded_as_those_of_a_tether(kind, method):
    """Slack, stiff and undamped in a hurricane, a drum that is reeled in at once: some steps do not come to rest."""
    tether, winch, least = HARD[kind]
    solver = Solver(fixed_step=0.1, fixed_step_method=method, initial_shape="straight")
    system, single = both(tether, winch, solver, (6.0, 0.0, 8.0) if kind == "line" else (60.0, 0.0, 80.0))
    most = 0
    for k in range(30):
        wind, told = (60.0, 30.0 * (-1) ** k, 0.0), {"winch_force": 4000.0 * (k % 2)} if kind == "drum" else {}
        single.step(0.1, wind_velocity=wind, **told)
        before = system.counters["iterations"]
        system.step(0.1, wind_velocity=wind, **{f"{name}s": {"line": value} for name, value in told.items()})
        most = max(most, system.counters["iterations"] - before)
        assert_equal(system, single)
    assert (
        least < most <= system.outputs().solver_iteration_limit == system.most_factorizations == single.most_factorizations
    )


def test_drums_side_by_side_have_their_events():
    """Two pairs of lines between the same driven points; steps and pieces are common."""
    solver = Solver(relative_tolerance=1e-7, initial_shape="static_equilibrium")
    place, velocity = np.array((60.0, 0.0, 80.0)), np.array((1.0, 2.0, 0.0))
    kinds = {"a": "friction", "b": "stops", "c": "friction, no mass", "d": "stops, no mass"}
    drums = {name: DRUMS[kind] for name, kind in kinds.items()}
    singles = {name: TetherDynamic(TETHER, solver=solver, winch=winch) for name, winch in drums.items()}
    for single in singles.values():
        single.initialize(kite_position=place, kite_velocity=velocity, wind_velocity=WIND)
    lines = [Line(name, "ground", "kite", TETHER, 0.0, winch) for name, winch in drums.items()]
    system = TetherSystem([Point("ground", (0.0, 0.0, 0.0)), Point("kite", place, velocity)], lines, solver=solver)
    system.initialize(WIND)
    rested = dict.fromkeys(singles, 0)
    for time in STEP * np.arange(60):
        x = place + time * velocity
        forces = {name: 400.0 + 150.0 * np.sin(6.0 * time + number) for number, name in enumerate(singles)}
        found = system.step(STEP, {"kite": x}, {"kite": velocity}, winch_forces=forces).lines
        for name, single in singles.items():
            wanted = single.step(STEP, kite_position=x, kite_velocity=velocity, winch_force=forces[name])
            rested[name] += wanted.winch_speed == 0.0
            # both have 1e-7 of a segment of 17 m in each of some 300 steps, at other times
            assert found[name].tether_length == pytest.approx(wanted.tether_length, abs=5e-6)
    assert min(rested.values()) > 0


@with_each_solver(0.02)
@pytest.mark.parametrize("is_turned", [False, True])
def test_two_lines_at_a_point_without_mass_are_one_line(is_turned, solver):
    """Adaptive steps err by 1e-10 of a segment of 12.6 m, some 1000 times; iterations end at 1e-6, converging quadratically.

    Without reeling, which would let rope begin at the point instead of flowing past it.
    """
    method = {"fixed_step": solver.fixed_step, "fixed_step_method": solver.fixed_step_method}
    solver = Solver(relative_tolerance=1e-10, initial_shape="static_equilibrium", **method)
    single = TetherDynamic(Tether(segments=8, initial_length=101.0), solver=solver)
    place, velocity = np.array((60.0, 0.0, 80.0)), np.array((1.0, 2.0, 0.0))
    single.initialize(kite_position=place, kite_velocity=velocity, wind_velocity=WIND)
    halves = [Tether(segments=n, initial_length=n * 101.0 / 8) for n in (3, 5)]
    points = [Point("ground", (0.0, 0.0, 0.0)), Point("knot", single.positions[3], mass=0.0), Point("kite", place, velocity)]
    ends = [("ground", "knot"), ("knot", "kite")]
    lines = [Line(f"line{k}", *(reversed(ends[k]) if is_turned else ends[k]), halves[k]) for k in range(2)]
    system = TetherSystem(points, lines, solver=solver)
    system.initialize(WIND)
    for time in STEP * np.arange(100):
        single.step(STEP, kite_position=place + time * velocity, kite_velocity=velocity)
        system.step(STEP, positions={"kite": place + time * velocity}, velocities={"kite": velocity})
    lower, upper = (system.positions[line.name][:: -1 if is_turned else 1] for line in lines)
    within = 1e-6 if solver.fixed_step else 1e-9
    np.testing.assert_allclose(np.concatenate([lower, upper[1:]]), single.positions, rtol=0, atol=within)
