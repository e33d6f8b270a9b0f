"""A tether that turns about its held end with omega, without gravity and air; its outer end is free.

elastic rod    r(X) = sin(kappa X)/(kappa cos(kappa L)),  T = EA (cos(kappa X)/cos(kappa L) - 1),  kappa = omega sqrt(mu/EA)
inextensible   T = 1/2 mu omega^2 (L^2 - r^2), the limit for small kappa L
chain          k (l_i - l0) = omega^2 sum_(j > i) m_j r_j, of which the part 1/(4 n^2) of the largest T is missing
"""

import numpy as np
import pytest

from audited import VOID, held, run
from mechanics import line_density, node_masses
from tetherfmu import Solver, Tether, TetherDynamic

LENGTH, OMEGA = 100.0, 2.0
EA = 614600.0
KAPPA = OMEGA * np.sqrt(line_density(Tether()) / EA)


def outer_radius(tether):
    """Distance [m] of the outer end of the turning chain: its equations of equilibrium are linear."""
    n = tether.segments
    spring = EA / (LENGTH / n)
    matrix = np.diag(node_masses(tether)[1:] * OMEGA**2 - spring * np.append(np.full(n - 1, 2.0), 1.0))
    matrix += spring * (np.eye(n, k=1) + np.eye(n, k=-1))
    return np.linalg.solve(matrix, np.append(np.zeros(n - 1), -EA))[-1]


def turned(n, turns=1.0):
    """Tensions [N] of all segments after some turns, those of the rod and of the inextensible line, and the residual."""
    tether = Tether(segments=n, initial_length=LENGTH)
    model = TetherDynamic(tether, VOID, Solver(relative_tolerance=1e-6, initial_shape=2), free_ends=(False, True))
    radius = outer_radius(tether)
    model.initialize((radius, 0.0, 0.0), (0.0, OMEGA * radius, 0.0))
    result = run(model, held(), 2.0 * np.pi / OMEGA / 300, round(300 * turns))
    tension = EA * (np.linalg.norm(np.diff(model.positions, axis=0), axis=1) * n / LENGTH - 1.0)
    middle = LENGTH * (np.arange(n) + 0.5) / n
    rod = EA * (np.cos(KAPPA * middle) / np.cos(KAPPA * LENGTH) - 1.0)
    inextensible = 0.5 * line_density(tether) * OMEGA**2 * (LENGTH**2 - middle**2)
    return tension, rod, inextensible, np.abs(result.residual).max() / result.turnover


@pytest.mark.parametrize("n", [10, 100])
def test_tension_after_a_turn(n):
    tension, rod, inextensible, residual = turned(n)
    # discretization, exactly 1/(4 n^2) = 2.5e-5 at n = 100, and the solver: 1.6e-5
    np.testing.assert_allclose(tension, rod, rtol=0, atol=(0.25 / n**2 * 1.05 + 2e-5) * rod[0])
    assert rod[0] - tension[0] == pytest.approx(-0.25 / n**2 * rod[0], abs=2e-5 * rod[0])
    # stretching by 3e-4 on average carries the mass outwards: (kappa L)^2 5/12 of it
    np.testing.assert_allclose(rod, inextensible, rtol=0, atol=3e-4 * rod[0])
    assert residual < 1e-6  # nothing is exchanged
