"""Derivatives by steps that are done again with other inputs, by save and restore."""

import numpy as np

from runtime.host import restore


def differences(host, before, step, given, outputs, changes):
    """Derivatives of outputs after the last step, from the state `before` it, array (outputs, inputs).

    given : the inputs with which it was done.  changes : of single inputs, by name; central differences over the change
    and over half of it are extrapolated.
    """
    start = host.time - step
    used = {name: host.get(name) for name in changes}

    def values(name, value):
        restore(host, before)
        host.time = start
        host.step(step, **{**given, name: value})
        return np.array([host.get(each) for each in outputs])

    def central(name, change):
        return (values(name, used[name] + change) - values(name, used[name] - change)) / (2.0 * change)

    return np.stack([(4.0 * central(k, 0.5 * c) - central(k, c)) / 3.0 for k, c in changes.items()], axis=1)


def assert_columns_agree(found, expected, tolerance):
    """Of each input the largest derivative counts."""
    np.testing.assert_allclose(found / np.abs(expected).max(axis=0), expected / np.abs(expected).max(axis=0), 0.0, tolerance)
