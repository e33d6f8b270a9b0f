"""What a replay was like: its finest tether, whether that was slack, and its errors for people."""

import numpy as np

from .runs import TETHERS

SLACK = 0.01  # length of the tether over the distance of its ends, minus 1, from which on it is slack
SOME = 0.1  # of the time, from which on a slack tether counts


def words(name):
    """Name of a tether for people."""
    return name.replace("_", "-")


def finest(made):
    """The name of the finest tether of a `Replay`, and its `runs.Flown`."""
    return min(made.flown.items(), key=lambda each: list(TETHERS).index(each[0]))


def is_slack(made):
    """Whether the finest tether is slack for some of the time, or lies anywhere on the ground."""
    table, distance = finest(made)[1].table, np.linalg.norm(made.flight.kite(made.flight.times)[0], axis=1)
    return bool(
        np.nanquantile(table.tether_length / distance, 1.0 - SOME) > 1.0 + SLACK or table.grounded_length.max() > 0.0
    )


def rounded(errors):
    """A table of errors, see `comparison.errors`, for people: lengths to 1 cm, tensions to three digits, and to 0.1 N."""
    table = errors.copy()
    for head in table.columns:
        if head.endswith(" m"):
            table[head] = table[head].round(2)
        elif head.endswith(" N"):
            table[head] = table[head].map(lambda force: round(float(f"{force:.3g}"), 1))
    return table
