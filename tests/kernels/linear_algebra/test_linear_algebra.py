"""The solvers of linear equations against numpy on the full matrix."""

from itertools import product

import numpy as np
import pytest

from tetherfmu.kernels.linear_algebra import profile
from tetherfmu.kernels.linear_algebra.block_tridiagonal import Matrix, factorize, solve
from tetherfmu.kernels.linear_algebra.point_blocks import add_to_block, factorize_definite, matrix_size, solve_definite
from tetherfmu.kernels.linear_algebra.profile import Profile


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


@pytest.mark.parametrize("w", [0, 1, 2])
def test_definite_matrix_of_points(w):
    rng, count = np.random.default_rng(2), 5
    near = np.kron(abs(np.subtract.outer(range(count), range(count))) <= w, np.ones((3, 3)))
    whole = near * rng.normal(size=(15, 15)) + 15.0 * np.eye(15)
    for matrix, is_definite in ((whole, True), (whole - 100.0 * np.diag(np.arange(15) == 7), False)):
        blocks, b = np.zeros(matrix_size(count, w)), rng.normal(size=15)
        for p, q in product(range(count), repeat=2):
            if abs(p - q) <= w:
                add_to_block(count, w, p, q, tuple(matrix[3 * p : 3 * p + 3, 3 * q : 3 * q + 3].ravel()), blocks)
        assert factorize_definite(count, w, blocks) == is_definite
        if is_definite:
            found = b.copy()
            solve_definite(count, w, blocks, found)
            np.testing.assert_allclose(found, np.linalg.solve(matrix, b), rtol=1e-12)


def in_profile(matrix, first):
    """`Profile` of a matrix whose row and column i begin at first[i]."""
    m = len(first)
    entries = int(sum(i + 1 - begin for i, begin in enumerate(first)))
    made = Profile(np.array(first, float), np.zeros(m), np.zeros(entries), np.zeros(entries))
    assert profile.begin(made, m) == entries
    for i, j in product(range(m), repeat=2):
        if first[max(i, j)] <= min(i, j):
            profile.add_entry(made, i, j, matrix[i, j])
    return made


@pytest.mark.parametrize("held", [None, 0, 3, 6])
@pytest.mark.parametrize("first", [[0, 0, 0, 0, 0, 0, 0], [0, 1, 1, 2, 0, 4, 3], [0, 1, 2, 3, 4, 5, 6]])
def test_matrix_with_a_profile(first, held):
    """What is held has the row of the unit matrix."""
    rng, rows = np.random.default_rng(3), np.arange(7)
    lowest = np.minimum.outer(rows, rows)
    within = np.array(first)[np.maximum.outer(rows, rows)] <= lowest
    matrix, b, found = within * rng.normal(size=(7, 7)) + 8.0 * np.eye(7), rng.normal(size=7), np.zeros(7)
    stored = in_profile(matrix, first)
    if held is not None:
        profile.hold_row(stored, 7, held)
        matrix[held] = rows == held
    assert profile.factorize(stored, 7)
    profile.solve(stored, 7, b, found)
    np.testing.assert_allclose(found, np.linalg.solve(matrix, b), rtol=1e-12)


@pytest.mark.parametrize("bad", [0.0, np.nan])
def test_singular_matrix_with_a_profile(bad):
    assert not profile.factorize(in_profile(np.diag([1.0, bad, 1.0]), [0, 0, 1]), 3)
