"""A kite that is moved by the force of the step before is unstable beyond h = 2 kite_damping/kite_stiffness."""

import pytest

from tetherfmu import Environment, Tether, TetherDynamic


@pytest.mark.parametrize(("part", "grows"), [(0.9, False), (1.3, True)])
def test_largest_step_of_a_coupling_by_force(part, grows):
    """A kite of 10 kg on a taut tether."""
    lift, mass, length = 500.0, 10.0, 500.0
    tether = TetherDynamic(Tether(segments=1, initial_length=length, drag_coefficient=0.0), Environment(gravity=0.0))
    rest = length * (1.0 + lift / 614600.0)
    position, velocity = rest + 0.01, 0.0
    outputs = tether.initialize((0.0, 0.0, position))
    h = part * 2.0 * outputs.kite_damping / outputs.kite_stiffness
    swing = []
    for _ in range(int(5.0 / h)):
        force = outputs.kite_force[2]
        outputs = tether.step(h, (0.0, 0.0, position), (0.0, 0.0, velocity))
        acceleration = (lift + force) / mass
        position += velocity * h + 0.5 * acceleration * h * h
        velocity += acceleration * h
        swing.append(abs(position - rest))
    tenth = len(swing) // 10
    assert bool(max(swing[-tenth:]) > max(swing[:tenth])) is grows
