"""Rows of a CSV file on the standard output, as soon as they are known; a measurement is redirected into `docs/data`."""

import csv
import sys


def print_csv(*cells):
    """Print one row."""
    csv.writer(sys.stdout, lineterminator="\n").writerow(cells)
    sys.stdout.flush()
