"""A soft tether of kilometres that drag stretches to several times its length has an equilibrium, and it is found.

Points of the stability map (seed 1) whose start was refused. Each must be in balance by the formulas of `balance.py`, from
its node positions alone:

    T_i e_i - T_(i-1) e_(i-1) + half drags + m g - m omega x (omega x r) = 0,   v = omega x r + s r
"""

import numpy as np
import pytest

from balance import residual
from stability.points import kite, point
from tetherfmu import Environment, StepRefused, Tether, TetherQuasiSteady
from tetherfmu.kernels.rest import homotopy, newton

# iterations of the searches at the levels 1, 1/2, 1/4, 1/8 (two at each, one with a perturbation), and of the rise to 1
SEARCH = 2 * (newton.MOST_ITERATIONS + newton.MOST_PSEUDO_STEPS)
MOST_WORK = 4 * 2 * SEARCH + homotopy.MOST_LEVELS * 2 * newton.MOST_ITERATIONS


def start(number):
    """Start of a quasi-steady tether at a point of the map: arguments of `residual`, and the outputs."""
    chosen = point(1, number)
    tether = Tether(segments=chosen.segments, initial_length=chosen.length, axial_stiffness=chosen.axial_stiffness)
    air = Environment(gravity=chosen.gravity)
    position, velocity = kite(chosen, 0.0)
    wind = chosen.wind * np.array((np.cos(chosen.wind_azimuth), np.sin(chosen.wind_azimuth), 0.0))
    model = TetherQuasiSteady(tether, air)
    outputs = model.initialize(position, velocity, wind_velocity=wind)
    return model.positions, velocity, wind, tether, air, outputs


# stretched 1.2 to 6.9 times, wind 0 to 59 m/s, 5 to 277 segments; three of them from the pace 1/4
@pytest.mark.parametrize("number", [4843, 2209, 3568, 8010, 9803, 4381, 14563, 18629])
def test_found_and_in_balance(number):
    positions, velocity, wind, tether, air, outputs = start(number)
    missing, tensions = residual(positions, velocity, wind, tether, air)
    # 1e-12 of the forces is where Newton's method stops; 100 times that for the other order of sums
    assert np.abs(missing).max() < 1e-10 * tensions.max()
    assert tensions.min() > 0.0
    assert outputs.solver_iterations <= MOST_WORK


# 40 m/s of kite and 34 m/s of wind on 6.6 km of 1.9 kN: the equilibria end at two thirds of these speeds
@pytest.mark.parametrize("number", [13717, 13967])
def test_where_drag_runs_away_there_is_none(number):
    with pytest.raises(StepRefused, match="axial_stiffness"):
        start(number)
