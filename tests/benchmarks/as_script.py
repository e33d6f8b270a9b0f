"""What benchmarks share as scripts: where they find tests and the sources of pages, options, rows of CSV, quantiles."""

import argparse
import csv
import sys
from pathlib import Path

import numpy as np

TESTS = Path(__file__).resolve().parents[1]
EXAMPLES, DOCS, REFERENCE = TESTS.parent / "examples", TESTS.parent / "docs", TESTS / "reference"
sys.path[:0] = [str(TESTS), str(DOCS / "make")]


def options(about, **defaults):
    """Options of the command line by name, with what each is without it; they have the kind of that.

    about : docstring of the benchmark, which says what they mean.  False is that of a flag, a list that of an option with
    several values; of a tuple one can be chosen, the first by default.
    """
    parser = argparse.ArgumentParser(description=about, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name, default in defaults.items():
        if default is False:
            kind = {"action": "store_true"}
        elif isinstance(default, list):
            kind = {"nargs": "+", "type": type(default[0]), "default": default}
        elif isinstance(default, tuple):
            kind = {"choices": default, "default": default[0]}
        else:
            kind = {"type": type(default), "default": default}
        parser.add_argument(f"--{name.replace('_', '-')}", **kind)
    return parser.parse_args()


def print_csv(*cells):
    """Print a row, as soon as it is known; a measurement is redirected into `docs/data`."""
    csv.writer(sys.stdout, lineterminator="\n").writerow(cells)
    sys.stdout.flush()


def quantiles(values, form="11.3g"):
    """Text of their median, 90 %, 99 % and the largest one."""
    return "".join(f"{each:{form}}" for each in np.quantile(values, (0.5, 0.9, 0.99, 1.0)))
