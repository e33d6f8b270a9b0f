"""The solvers of linear equations against numpy on the full matrix."""

from itertools import product

import numpy as np
import pytest

from tetherfmu.kernels.linear_algebra import profile
from tetherfmu.kernels.linear_algebra.block_tridiagonal import Matrix, factorize, solve
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


@pytest.mark.parametrize("pivot", [None, 0, 7, 14])
def test_definite_matrix_with_a_profile(pivot):
    """Blocks of points in a row; one negative number on the diagonal."""
    rng, whole = np.random.default_rng(2), np.zeros((15, 15))
    stored = in_profile(whole, [3 * max(0, i // 3 - 1) for i in range(15)])
    for p, q in product(range(5), repeat=2):
        if abs(p - q) <= 1:
            block = rng.normal(size=(3, 3)) + 15.0 * (p == q) * np.eye(3)
            whole[3 * p : 3 * p + 3, 3 * q : 3 * q + 3] = block
            profile.add_block(stored, 3 * p, 3 * q, tuple(block.ravel()))
    if pivot is not None:
        profile.add_entry(stored, pivot, pivot, -100.0)
    assert profile.factorize_definite(stored, 15) == (pivot is None)
    if pivot is None:
        b, found = rng.normal(size=15), np.zeros(15)
        profile.solve_definite(stored, 15, b, found)
        np.testing.assert_allclose(found, np.linalg.solve(whole, b), rtol=1e-12)
        profile.clear(stored, 15)
        assert not np.concatenate([stored.lower, stored.upper]).any()


@pytest.mark.parametrize("bad", [0.0, np.nan])
def test_singular_matrix_with_a_profile(bad):
    assert not profile.factorize(in_profile(np.diag([1.0, bad, 1.0]), [0, 0, 1]), 3)
