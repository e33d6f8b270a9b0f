"""The block tridiagonal solver against numpy on the full matrix."""

import numpy as np
import pytest

from tetherfmu.kernels.linear_algebra.block_tridiagonal import Matrix, factorize, solve
from tetherfmu.kernels.rest.hanging_chain import solve_symmetric


@pytest.mark.parametrize(("first", "last"), [(0, 5), (1, 4), (1, 5), (0, 2), (2, 3), (2, 2)])
def test_solves_the_full_system(first, last):
    rng = np.random.default_rng(1)
    blocks = rng.normal(size=(3, 6, 3, 3))
    diagonal, lower, upper = blocks
    diagonal += 8.0 * np.eye(3)  # far from singular, so that only rounding is left
    count = last - first + 1
    full = np.zeros((3 * count, 3 * count))
    for i in range(count):
        full[3 * i : 3 * i + 3, 3 * i : 3 * i + 3] = diagonal[first + i]
        if i > 0:
            full[3 * i : 3 * i + 3, 3 * i - 3 : 3 * i] = lower[first + i]
            full[3 * i - 3 : 3 * i, 3 * i : 3 * i + 3] = upper[first + i - 1]
    b = rng.normal(size=18)
    expected = np.linalg.solve(full, b[3 * first : 3 * last + 3])
    matrix = Matrix(*(np.ascontiguousarray(part).ravel() for part in blocks))
    assert factorize(first, last, matrix)
    solve(first, last, matrix, b)
    np.testing.assert_allclose(b[3 * first : 3 * last + 3], expected, rtol=1e-12)


@pytest.mark.parametrize("bad", [0.0, np.nan, np.inf])
@pytest.mark.parametrize("row", range(4))
def test_singular_pivot_is_reported(bad, row):
    diagonal = np.tile(np.eye(3), (4, 1, 1)).ravel()
    diagonal[9 * row : 9 * row + 9] = bad
    assert not factorize(0, 3, Matrix(diagonal, np.zeros(36), np.zeros(36)))


def test_symmetric_three_by_three():
    rng = np.random.default_rng(2)
    half = rng.normal(size=(3, 3))
    matrix = half @ half.T + np.eye(3)
    b = rng.normal(size=3)
    found = solve_symmetric(tuple(matrix[np.triu_indices(3)]), tuple(b))
    np.testing.assert_allclose(found, np.linalg.solve(matrix, b), rtol=1e-12)
