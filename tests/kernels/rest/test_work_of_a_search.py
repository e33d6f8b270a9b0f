"""The search for a shape has a budget of Newton iterations, well above what the hardest starts that are found need.

Starts are those of the stability map (seed, number), the hardest of 43 000 random ones: of those found and of those refused
after all methods. Only counters are compared.
"""

from contextlib import suppress
from warnings import catch_warnings

import numpy as np
import pytest

from stability import flight
from stability.points import point
from tetherfmu import StepRefused
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
