"""Tables of the manual, for the tests that measure their numbers anew."""

from pathlib import Path

import numpy as np

DATA = Path(__file__).resolve().parents[1] / "docs" / "data"


def table(name):
    """Rows of numbers of a CSV file of the manual, (rows, columns)."""
    return np.loadtxt(DATA / f"{name}.csv", delimiter=",", skiprows=1)
