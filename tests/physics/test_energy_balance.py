"""The powers of `Energy` are the rate of its energies: d/dt (kinetic + elastic + potential) = sum of powers - losses.

At any instant, with the accelerations a_i = F_i/m_i of the kernels' own node forces, the energies at the time +-dt along

    x + v dt + a dt^2/2,   v + a dt,   L + dL/dt dt,    driven ends: x + v dt

differ by 2 dt times the power; along a run, the trapezoidal rule over communication steps of length h leaves a residual
of order h^2.
"""

import numpy as np
import pytest

from audited import run
from kernels.interleaved import node_forces
from mechanics import energy as energy_of_chain
from mechanics import line_density
from tetherfmu import Environment, Solver, Tether, TetherCatenary, TetherDynamic, TetherQuasiSteady
from tetherfmu.kernels.equations import assembly, segment
from tetherfmu.kernels.equations.properties import chain_at
from tetherfmu.python import given_inputs
from tetherfmu.runtime import layout as at

WIND = (9.0, -3.0, 1.0)
NODE_WINDS = 9.0 * np.random.default_rng(9).normal(size=(8, 3))
LOAD = (20.0, -5.0, 40.0)
SECTIONS = [
    Tether(segments=3, initial_length=20.0, axial_stiffness=3e3, axial_damping=40.0),
    Tether(segments=4, initial_length=30.0, axial_stiffness=9e3, axial_damping=60.0, diameter=0.01),
]
AIR = Environment(wind_profile=2, air_density_scale_height=500.0)


def shaken(free_ends, length_of_chord=52.0):
    """Two sections with point masses at all kinds of nodes, all nodes displaced and moving, taut and slack segments."""
    model = TetherDynamic(SECTIONS, AIR, Solver(initial_shape=3), point_masses={0: 0.7, 3: 0.4, 7: 0.9}, free_ends=free_ends)
    model.initialize((0.6 * length_of_chord, 0.0, 0.8 * length_of_chord), ground_position=(0.0, 0.0, 3.0))
    moved, thrown = np.random.default_rng(7).normal(size=(2, 8, 3))
    model.initialize(positions=model.positions + 0.3 * moved, velocities=model.velocities + 4.0 * thrown)
    return model


def accelerations(model, reel_out_speed, free_ends):
    """Acceleration of every node (n + 1, 3) [m/s2] from the kernels; 0 at driven ends."""
    n, state, parameters = model.segments, model.get_state(), model._parameters
    x, v = state[at.STATE_HEADER : at.nodes_end(n)].reshape(2, -1)
    mass = np.zeros(n + 1)
    chain = chain_at(n, parameters, state[at.LENGTH], reel_out_speed, WIND)
    assembly.node_masses(chain, mass)
    force = node_forces(chain, np.full(n, segment.BY_LENGTH), x, v)
    force[-3:] += LOAD
    result = force.reshape(-1, 3) / mass[:, None]
    for end, free in zip((0, -1), free_ends, strict=True):
        result[end] *= free
    return result


@pytest.mark.parametrize("node_winds", [None, NODE_WINDS], ids=["wind", "node_winds"])
@pytest.mark.parametrize("reel_out_speed", [0.0, 3.0, -5.0])
@pytest.mark.parametrize("free_ends", [(False, False), (False, True), (True, False), (True, True)], ids=str)
def test_power_is_the_rate_of_the_energy(free_ends, reel_out_speed, node_winds):
    model = shaken(free_ends)
    if node_winds is not None:
        given_inputs.put(model._receiver, {"wind_velocity": node_winds})
    now = model.energy(reel_out_speed=reel_out_speed, wind_velocity=WIND, kite_load=LOAD)
    a = accelerations(model, reel_out_speed, free_ends)
    start = model.get_state()
    total = []
    dt = 1e-5
    for time in (-dt, dt):
        state = start.copy()
        x, v = state[at.STATE_HEADER : at.nodes_end(model.segments)].reshape(2, -1, 3)
        x += v * time + 0.5 * a * time**2
        v += a * time
        state[at.LENGTH] += reel_out_speed * time
        model.set_state(state)
        total.append(model.energy(reel_out_speed=reel_out_speed, wind_velocity=WIND, kite_load=LOAD).total)
    # third derivative of the energy: E omega^3 with omega of some 1e2 1/s, so dt^2/6 of it is 1e-4 W of 1e4 W; rounding of
    # E = 1e4 J is 2e-12 J/(2 dt) = 1e-7 W
    assert (total[1] - total[0]) / (2.0 * dt) == pytest.approx(now.power, rel=1e-6, abs=1e-2)
    assert min(now.damping_loss, now.drag_loss) > 1.0
    if reel_out_speed:
        assert min(abs(now.winch_power), abs(now.material_power)) > 1.0


def test_energies_are_those_of_the_formula():
    tether = Tether(segments=9, initial_length=50.0)
    model = TetherDynamic(tether, solver=Solver(initial_shape=3), free_ends=(True, True))
    model.initialize((30.0, 0.0, 41.0), (3.0, 4.0, 5.0))
    now = model.energy()
    assert now.total == pytest.approx(energy_of_chain(model.positions, model.velocities, tether), rel=1e-12)  # rounding
    assert now.kinetic > 1.0
    assert now.elastic > 1.0
    assert now.potential > 1.0


def test_balance_closes_along_a_flight():
    """Of a kite that circles, climbs, reels and drags a tether. The trapezoidal rule has order 2."""

    def inputs(time):
        phase = 2.0 * time
        return {
            "kite_position": (60.0 + 8.0 * np.cos(phase), 8.0 * np.sin(phase), 50.0 + 4.0 * np.sin(phase)),
            "kite_velocity": (-16.0 * np.sin(phase), 16.0 * np.cos(phase), 8.0 * np.cos(phase)),
            "ground_position": (0.0, 2.0 * time, 0.0),
            "ground_velocity": (0.0, 2.0, 0.0),
            "reel_out_speed": 1.5 * np.cos(phase),
            "wind_velocity": (8.0, np.sin(phase), 0.0),
        }

    residuals, tether = [], Tether(segments=6, initial_length=80.0, axial_stiffness=1e4)
    for step in (0.004, 0.002, 0.001):
        model = TetherDynamic(tether, AIR, Solver(relative_tolerance=1e-8))
        model.initialize(**inputs(0.0))
        flown = run(model, inputs, step, round(1.0 / step))
        residuals.append(np.abs(flown.residual).max())
    # held inputs jump between steps, which the audit sees on both sides
    np.testing.assert_allclose(-np.diff(np.log2(residuals)), 2.0, atol=0.4)
    assert residuals[-1] < 2e-4 * flown.turnover


@pytest.mark.parametrize("law", [1, 2], ids=["strain_rate", "stretch_rate"])
def test_damping_loss_while_reeling(law):
    """At strain epsilon, 2 m/s are paid out and the kite leaves at 1 m/s, so the strain falls: loss = damper force times

    dl/dt - (1 + epsilon) dL/dt,   damper force = D/L times that (strain_rate), or D/L dl/dt (stretch_rate)

    The second is below 0: the law of Tethers.jl makes energy out of nothing.
    """
    tether = Tether(segments=5, initial_length=50.0, damping_law=law)
    model = TetherDynamic(tether, Environment(gravity=0.0, air_density=0.0), Solver(initial_shape=2))
    model.initialize((50.05, 0.0, 0.0), (1.0, 0.0, 0.0), reel_out_speed=2.0)
    rate = 1.0 - 1.001 * 2.0
    expected = 473.0 / 50.0 * rate * {1: rate, 2: 1.0}[law]
    assert model.energy().damping_loss == pytest.approx(expected, rel=1e-9)  # rounding


@pytest.mark.parametrize("reel_out_speed", [8.0, -8.0])
def test_winches_and_material_make_a_drum(reel_out_speed):
    """A tether straight up from its drum: winch_power + material_power = -T_ground dL/dt, though neither alone is that."""
    tether = Tether(segments=50, initial_length=500.0, axial_damping=0.0)
    model = TetherDynamic(tether)
    out = model.initialize((0.0, 0.0, 500.3))
    now = model.energy(reel_out_speed=reel_out_speed)
    drum = -out.ground_force[2] * reel_out_speed
    # strains of 6e-4 are left out of the formula
    assert now.winch_power + now.material_power == pytest.approx(drum, rel=2e-3)
    lifted = 0.5 * line_density(tether) * 9.81 * 500.0 * reel_out_speed
    assert now.material_power == pytest.approx(lifted, rel=0.01)  # and it brings elastic energy, 1 W
    assert abs(lifted) > 0.05 * abs(drum)


def test_steady_circle_of_the_quasi_steady_tether():
    """A rigidly turning tether keeps its energy: what the kite does on it goes into the air."""
    model = TetherQuasiSteady(Tether(initial_length=200.0), Environment(gravity=0.0))
    model.initialize((200.5, 0.0, 0.0), (0.0, 30.0, 0.0))
    now = model.energy()
    assert now.kite_power == pytest.approx(now.drag_loss, rel=1e-6)  # tolerance of the equilibrium, 1e-9 of the forces
    assert now.drag_loss > 100.0


def test_a_line_without_nodes_has_no_energy():
    model = TetherCatenary()
    model.initialize()
    with pytest.raises(ValueError, match="TetherCatenary"):
        model.energy()
