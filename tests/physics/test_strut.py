"""A slack tether straight above or below its station hangs folded; it never stands on its end.

The fold of an inextensible line of the weight w per length, with its ends a distance d one above the other, hangs (L - d)/2
under the lower end: each end carries the weight of its own branch,

    lower end  w (L - d)/2,   upper end  w (L + d)/2,   both downwards

A chain has the fold in one of its segments: its end forces are those within the weight of a segment, w L/n. In a stable
equilibrium dF/dx of the free nodes has no positive eigenvalue; one is zero, a turn about the line of the ends.
"""

import numpy as np
import pytest

from audited import VOID
from balance import slope_of_springs
from mechanics import line_density
from tetherfmu import Environment, Tether, TetherCatenary, TetherDynamic, TetherQuasiSteady, TetherStraight

CHAINS = [TetherDynamic, TetherQuasiSteady]
DISTANCE = 500.0
WEIGHT = line_density(Tether()) * 9.81  # [N/m]


def slack_tether(slack, n=20):
    """A tether of which the part `slack` is longer than the distance of its ends."""
    return Tether(segments=n, initial_length=DISTANCE / (1.0 - slack))


def folded(tether, up):
    """Vertical forces [N] on the ground end and on the kite."""
    lower = -0.5 * WEIGHT * (tether.initial_length - DISTANCE)
    upper = -0.5 * WEIGHT * (tether.initial_length + DISTANCE)
    return (lower, upper) if up > 0 else (upper, lower)


@pytest.mark.parametrize("model", CHAINS)
@pytest.mark.parametrize("up", [1.0, -1.0], ids=["kite above", "kite below"])
@pytest.mark.parametrize("n", [5, 10, 20, 50, 100])
@pytest.mark.parametrize("slack", [0.0, 1e-3, 0.01, 0.05, 0.3, 0.6, 0.9])
def test_hangs_folded(model, up, n, slack):
    tether = slack_tether(slack, n)
    tether_model = model(tether)
    outputs = tether_model.initialize((0.0, 0.0, up * DISTANCE))
    forces = outputs.ground_force[2], outputs.kite_force[2]
    segment = WEIGHT * tether.initial_length / n
    np.testing.assert_allclose(forces, folded(tether, up), rtol=0, atol=segment)
    assert max(forces) <= 0.0  # nobody is pushed up
    # what is left of the turn about the vertical is the error of the solver; a strut has 0.07 N/m and far more
    assert np.linalg.eigvalsh(slope_of_springs(tether_model.positions, tether)[3:-3, 3:-3]).max() < 1e-5


@pytest.mark.parametrize("up", [1.0, -1.0], ids=["kite above", "kite below"])
@pytest.mark.parametrize("n", [5, 20, 100])
@pytest.mark.parametrize("slack", [1e-3, 0.01, 0.3, 0.9])
@pytest.mark.parametrize("aside", [(1e-9, 0.0), (-1e-6, 0.0), (0.0, 1e-6)])
def test_the_same_beside_the_vertical(up, n, slack, aside):
    tether = slack_tether(slack, n)
    exact = TetherQuasiSteady(tether).initialize((0.0, 0.0, up * DISTANCE))
    beside = TetherQuasiSteady(tether).initialize((*aside, up * DISTANCE))
    weight = WEIGHT * tether.initial_length
    for name in ("ground_force", "kite_force"):
        a, b = getattr(exact, name), getattr(beside, name)
        # 1e-6 m times some 0.1 N/m; the side to which the fold opens is another
        np.testing.assert_allclose(b[2], a[2], rtol=0, atol=1e-6 * weight)
        np.testing.assert_allclose(np.hypot(b[0], b[1]), np.hypot(a[0], a[1]), rtol=0, atol=1e-6 * weight)


@pytest.mark.parametrize("wind", [0.0, 1.0, 5.0, 20.0])
@pytest.mark.parametrize("up", [1.0, -1.0], ids=["kite above", "kite below"])
@pytest.mark.parametrize("n", [5, 20, 100])
@pytest.mark.parametrize("slack", [0.0, 0.01, 0.3, 0.9])
@pytest.mark.parametrize("aside", [0.0, 1e-6])
def test_dynamic_and_quasi_steady_agree(wind, up, n, slack, aside):
    """At the start, and after ten steps of the dynamic tether from there: it is at rest."""
    tether, kite, air = slack_tether(slack, n), (aside, 0.0, up * DISTANCE), (0.0, wind, 0.0)
    expected = TetherQuasiSteady(tether).initialize(kite, wind_velocity=air)
    model = TetherDynamic(tether)
    model.initialize(kite, wind_velocity=air)
    for _ in range(10):
        outputs = model.step(0.02, kite, (0.0, 0.0, 0.0), wind_velocity=air)
    size = np.linalg.norm(expected.kite_force)
    np.testing.assert_allclose(outputs.ground_force, expected.ground_force, rtol=0, atol=1e-6 * size)
    np.testing.assert_allclose(outputs.kite_force, expected.kite_force, rtol=0, atol=1e-6 * size)


@pytest.mark.parametrize("model", [*CHAINS, TetherCatenary, TetherStraight])
@pytest.mark.parametrize("direction", [(0, 0, 1), (0, 0, -1), (1, 0, 0), (0, 1, 0), (0.6, 0, 0.8), (0.48, 0.6, 0.64)])
@pytest.mark.parametrize("slack", [1e-3, 0.1, 0.9])
def test_no_load_no_force(model, direction, slack):
    outputs = model(slack_tether(slack), VOID).initialize(DISTANCE * np.array(direction))
    # positions round off at 500 m * 1e-16, EA/l0 = 2.5e4 N/m multiplies that, and the solver takes 18 of it for zero
    np.testing.assert_allclose((outputs.ground_force, outputs.kite_force), 0.0, atol=1e-7)


def test_leaves_towards_x_or_y():
    """The direction depends on nothing but that of the tether: two starts are equal, and the fold opens in that plane."""
    for kite, across in (((0.0, 0.0, 500.0), 1), ((500.0, 0.0, 0.0), 2), ((0.0, 500.0, 0.0), 2)):
        models = [TetherDynamic(slack_tether(0.1), Environment() if kite[2] else VOID) for _ in range(2)]
        for model in models:
            model.initialize(kite)
        np.testing.assert_array_equal(models[0].positions, models[1].positions)
        assert models[0].outputs().sag > 20.0
        np.testing.assert_array_equal(models[0].positions[:, across], 0.0)


def paid_out(model, up, seconds, **solver):
    """Vertical forces (steps, 2) [N] of a tether that is taut between ends at rest, and paid out by 1 m/s for 5 s."""
    tether_model = model(initial_length=499.5, **solver)
    kite, step = (0.0, 0.0, up * DISTANCE), 0.02
    tether_model.initialize(kite)
    forces = []
    for k in range(round(seconds / step)):
        out = tether_model.step(step, kite, (0.0, 0.0, 0.0), reel_out_speed=1.0 if k < 250 else 0.0)
        forces.append((out.ground_force[2], out.kite_force[2]))
    return np.array(forces)


HUNG = folded(Tether(initial_length=504.5), 1.0)
SEGMENT = WEIGHT * 504.5 / 20


@pytest.mark.parametrize("up", [1.0, -1.0], ids=["kite above", "kite below"])
def test_quasi_steady_leaves_the_strut_at_once(up):
    forces = paid_out(TetherQuasiSteady, up, 6.0)[:, :: round(up)]
    assert forces[25:].max() <= 0.0  # after 0.5 m it is slack
    np.testing.assert_allclose(forces[-1], HUNG, rtol=0, atol=SEGMENT)


@pytest.mark.parametrize("up", [1.0, -1.0], ids=["kite above", "kite below"])
@pytest.mark.parametrize("fixed_step", [0.0, 0.005], ids=["adaptive", "fixed"])
def test_dynamic_buckles_in_flight(up, fixed_step):
    forces = paid_out(TetherDynamic, up, 30.0, fixed_step=fixed_step)[:, :: round(up)]
    # it swings for long; a strut pushes with 32 N for ever
    assert forces[400:].max() < 0.0
    np.testing.assert_allclose(forces[-500:].mean(axis=0), HUNG, rtol=0, atol=SEGMENT)


@pytest.mark.parametrize("model", CHAINS)
def test_kite_flies_to_straight_above(model):
    """In 5 s from 50 m aside, where it stops; the tether is slack all the time, 505 m for 500 to 502.5 m."""
    tether_model = model()
    tether_model.initialize((50.0, 0.0, DISTANCE), (-20.0, 0.0, 0.0))
    forces = []
    for k in range(1500):
        t = min(0.02 * k, 5.0)
        kite = (50.0 - 20.0 * t + 2.0 * t * t, 0.0, DISTANCE)
        out = tether_model.step(0.02, kite, (-20.0 + 4.0 * t, 0.0, 0.0))
        forces.append((out.ground_force[2], out.kite_force[2]))
    forces = np.array(forces)
    expected = folded(Tether(), 1.0)
    np.testing.assert_allclose(forces[-500:].mean(axis=0), expected, rtol=0, atol=WEIGHT * 505.0 / 20)
    assert forces[-500:].max() <= 1.0


@pytest.mark.parametrize("model", CHAINS)
def test_what_presses_more_than_it_weighs_is_told(model):
    """One segment a tenth too long presses as a spring: s EA (L - l)/L, 558.7 N, where the tether weighs 49 N."""
    tether = model(tether=Tether(segments=1, initial_length=550.0))
    force = tether.initialize(kite_position=(300.0, 0.0, 400.0)).kite_force
    assert np.linalg.norm(force) == pytest.approx(0.01 * 614600.0 * 50.0 / 550.0, rel=0.06)  # and its weight
    with pytest.warns(UserWarning, match=r"slack segment presses its ends apart with 55\d N"):
        tether.step(0.02)
