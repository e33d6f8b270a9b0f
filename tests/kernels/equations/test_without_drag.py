"""A chain without air or without width takes loops of its own; they leave out the drag and nothing else."""

import numpy as np
import pytest

from kernels.chain_problem import ChainProblem
from kernels.interleaved import interleaved, node_forces
from tetherfmu.kernels.equations import assembly, segment
from tetherfmu.kernels.equations.properties import chain_at, has_drag
from tetherfmu.runtime import layout as at

WIDTH = at.PARAMETER_SCALARS + at.DRAG_WIDTH * ChainProblem.SEGMENTS  # place of that of the first segment
NEARLY_NO_AIR = 1e-100  # kg/m3: the drag is there, and beneath the last digit of every force


def problem_without(density=None, widths=None):
    """The chain problem with another air density [kg/m3], or other drag widths of its segments [m]."""
    problem = ChainProblem()
    if density is not None:
        problem.parameters[at.AIR_DENSITY] = density
    if widths is not None:
        problem.parameters[WIDTH : WIDTH + problem.n] = widths
    return problem


def chain_of(problem):
    return chain_at(problem.n, problem.parameters, problem.length, 1.5, problem.wind)


def forces(problem):
    return node_forces(chain_of(problem), np.full(problem.n, segment.BY_LENGTH), problem.x, problem.v)


def derivatives(problem):
    """Records and modes of all segments."""
    w, rate = problem.of_rosenbrock, np.zeros_like(problem.x)
    assembly.linearize(
        chain_of(problem), interleaved(problem.x), interleaved(problem.v), w.modes, w.segments, w.records, rate
    )
    return np.concatenate([w.records, w.modes, rate])


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({}, True),
        ({"density": 0.0}, False),
        ({"density": NEARLY_NO_AIR}, True),
        ({"widths": 0.0}, False),
        ({"widths": [0.0, 0.0, 0.0, 0.02]}, True),
    ],
)
def test_when_there_is_drag(changes, expected):
    assert has_drag(chain_of(problem_without(**changes))) == expected


@pytest.mark.parametrize("changes", [{"density": 0.0}, {"widths": 0.0}])
@pytest.mark.parametrize("found", [forces, derivatives])
def test_no_drag_is_the_limit_of_little_drag(found, changes):
    without = found(problem_without(**changes))
    np.testing.assert_allclose(without, found(problem_without(NEARLY_NO_AIR)), rtol=0, atol=1e-60)
    assert np.abs(found(ChainProblem()) - without).max() > 0.01  # while drag is no small thing here


def test_one_wide_segment_has_its_drag_on_its_two_nodes():
    wide, all_wide = problem_without(widths=[0.0, 0.0, 0.02, 0.0]), problem_without(widths=0.02)
    bare = forces(problem_without(widths=0.0))
    drag, of_all = (forces(problem) - bare for problem in (wide, all_wide))
    drag = drag.reshape(-1, 3)
    assert not drag[[0, 1, 4]].any()
    np.testing.assert_allclose(drag[2], drag[3], rtol=1e-9)  # half of it on each
    assert np.linalg.norm(of_all) > np.linalg.norm(drag) > 0.0
