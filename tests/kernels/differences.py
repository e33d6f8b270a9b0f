"""Central differences, and block tridiagonal matrices as full ones, for tests of derivatives."""

import numpy as np


def differences(function, point, step):
    """Derivatives of a function by all components of an array, which are those of the last axis."""
    point = np.asarray(point, float)
    shifts = step * np.eye(point.size).reshape(-1, *point.shape)
    pairs = [(np.asarray(function(point + each)), np.asarray(function(point - each))) for each in shifts]
    return np.stack([(ahead - back) / (2.0 * step) for ahead, back in pairs], axis=-1)


def assert_close(found, expected):
    """Equal to 1e-6 of the largest entry: truncation h^2 F''' and rounding eps F/h of the differences are below it."""
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-6 * np.abs(expected).max())


def full(n, matrix):
    """A `block_tridiagonal.Matrix` of n + 1 nodes."""
    found = np.zeros((3 * (n + 1), 3 * (n + 1)))
    for i in range(n + 1):
        rows = slice(3 * i, 3 * i + 3)
        for k, blocks in ((i, matrix.diagonal), (i - 1, matrix.lower), (i + 1, matrix.upper)):
            if 0 <= k <= n:
                found[rows, 3 * k : 3 * k + 3] = blocks[9 * i : 9 * i + 9].reshape(3, 3)
    return found
