"""Hard starts of the stability map (seed, number).

budget     of Newton iterations, well above what the hardest starts that are found need: of 43 000 random ones, of those
           found and of those refused after all methods. Only counters are compared.
stretched  soft tethers of kilometres that drag stretches to several times their length, once refused (seed 1): in balance by
           the formulas of `balance.py`, from their node positions alone
"""

from contextlib import suppress
from warnings import catch_warnings

import numpy as np
import pytest

from balance import residual
from stability import flight
from stability.points import kite, point
from tetherfmu import Environment, StepRefused, Tether, TetherQuasiSteady
from tetherfmu.kernels.rest import homotopy, newton
from tetherfmu.kernels.rest.solve import BUDGET
from tetherfmu.runtime import layout as at
from tetherfmu.runtime import status
from tetherfmu.study.measuring.runs import UNWARNED

FOUND = ((11, 95909), (11, 12935), (7, 3011))
REFUSED = ((11, 12727), (11, 94455))


def work_of_start(seed, number):
    """Status of the start of a quasi-steady tether on the ground, and segments times Newton iterations of its search."""
    start = point(seed, number, ground=True)._replace(variant="quasi_steady")
    model = flight.model_of(start, 1)
    instance, seen = model._instance, []
    initialize = instance.kernels.initialize

    def watched(*arguments):  # the state of a start that is refused is not kept
        result = initialize(*arguments)
        seen.append((status.code(result), instance.state[at.ITERATIONS] * start.segments))
        return result

    instance.kernels = instance.kernels._replace(initialize=watched)
    wind = start.wind * np.array((np.cos(start.wind_azimuth), np.sin(start.wind_azimuth), 0.0))
    with suppress(StepRefused), catch_warnings(**UNWARNED):
        model.initialize(**flight.ends(start, 0, start.step), wind_velocity=wind, reel_out_speed=start.reel_out_speed)
    return seen[-1]


@pytest.mark.parametrize(("seed", "number"), FOUND)
def test_the_hardest_starts_need_less_than_half_of_the_budget(seed, number):
    found, work = work_of_start(seed, number)
    assert found == status.OK
    assert 5e5 < work < 0.5 * BUDGET


@pytest.mark.parametrize(("seed", "number"), REFUSED)
def test_what_has_no_equilibrium_is_refused_within_the_budget(seed, number):
    found, work = work_of_start(seed, number)
    assert found == status.NO_EQUILIBRIUM
    assert 1e6 < work <= BUDGET


# --- stretched

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
