"""Make `moorpy_touchdown.csv` anew and compare: `python tests/reference/make_moorpy_touchdown.py [--write]`.

200 lines on a flat seabed by the catenary of MoorPy (pip install moorpy): the equations of Jonkman (2007), section 2.6. End
A is on the seabed or `height_a` above it, end B at `height_b`, not lower. Columns:

    span, length, stiffness, weight    horizontal distance [m], unstretched length [m], EA [N], weight per length [N/m]
    friction                           coefficient; MoorPy has none where both ends are above the seabed
    horizontal_a, vertical_a, ...      force of the line on the ends [N], horizontal towards the other end, vertical up
    lying                              unstretched length on the seabed [m]
    profile                            MoorPy's number: 0 on the seabed, 2 touches down, 3 friction holds all before A,
                                       4 slack, 5 slack between two ends above, 6 (its "U") touches down between two

Lines are drawn at random until there are enough of each kind, see `WANTED`; those that MoorPy only approximates (negative
numbers) or refuses are left out. A second run with a tolerance 100 times as large says how exact the numbers are.
"""

import argparse
import contextlib
import sys
import warnings
from pathlib import Path

import numpy as np

FILE = Path(__file__).resolve().parent / "moorpy_touchdown.csv"
COLUMNS = (
    *("span", "height_a", "height_b", "length", "stiffness", "weight", "friction"),
    *("horizontal_a", "vertical_a", "horizontal_b", "vertical_b", "lying", "profile"),
)
WANTED = {
    "without friction": 50,
    "with friction": 40,
    "friction holds all": 30,
    "nearly taut": 15,
    "slack": 15,
    "slack between two": 10,
    "on the seabed, taut": 15,
    "on the seabed, slack": 5,
    "between two": 20,
}
TOLERANCE = 1e-11  # of the length: error of the ends
SEED = 29


def draw(random):
    """Span, heights, length, EA, weight and friction of a line."""
    length = 10.0 ** random.uniform(1.0, 3.0)
    weight = 10.0 ** random.uniform(-1.5, 2.0)
    stiffness = weight * length * 10.0 ** random.uniform(1.5, 6.0)
    friction = random.choice([0.0, random.uniform(0.01, 0.5), random.uniform(0.5, 2.0)])
    place = random.uniform()
    if place < 0.1:
        part = random.choice([1.0 + 10.0 ** random.uniform(-6.0, -2.0), random.uniform(0.5, 1.0)])
        return part * length, 0.0, 0.0, length, (stiffness, weight, friction)
    high = length * 10.0 ** random.uniform(-2.0, -0.1)
    low = high * random.uniform() if place > 0.8 else 0.0
    shortest, longest = length - high - low, np.sqrt(max(0.0, length**2 - (high - low) ** 2))
    span = shortest + (longest - shortest) * random.uniform(-0.1, 1.0)
    return max(span, 0.01 * length), low, high, length, (stiffness, weight, 0.0 if low > 0.0 else friction)


def solve(line, tolerance):
    """Forces on both ends, length on the seabed and profile of a line by MoorPy; None where it only approximates."""
    from moorpy.Catenary import catenary
    from moorpy.helpers import CatenaryError

    span, low, high, length, (stiffness, weight, friction) = line
    try:
        with contextlib.redirect_stdout(None), warnings.catch_warnings(action="ignore"):
            line = span, high - low, length, stiffness, weight
            found = catenary(*line, CB=-low if low else friction, Tol=tolerance * length, MaxIter=500)
    except CatenaryError:
        return None
    profile = {"U": 6}.get(found[4]["ProfileType"], found[4]["ProfileType"])
    return (*map(float, found[:4]), float(found[4]["LBot"]), profile) if profile in range(7) else None


def kind_of(line, result):
    """Key of `WANTED` of a line that touches the seabed, else None."""
    length, friction = line[3], line[4][2]
    lying, profile = result[4:]
    if profile == 0:
        return "on the seabed, taut" if result[2] != 0.0 else "on the seabed, slack"
    if profile in (4, 5):
        return "slack" if profile == 4 else "slack between two"
    if profile == 6:
        return "between two"
    if not 0.0 < lying < length or line[1] > 0.0:
        return None
    if lying < 0.05 * length:
        return "nearly taut"
    return "friction holds all" if profile == 3 else "with friction" if friction else "without friction"


def make():
    """Rows of the file, and the largest difference of a number of the looser run over the largest force or the length."""
    random, left, rows, differences, approximated = np.random.default_rng(SEED), dict(WANTED), [], [], 0
    while any(left.values()):
        line = draw(random)
        result = solve(line, TOLERANCE)
        if result is None:
            approximated += 1
            continue
        kind = kind_of(line, result)
        if not left.get(kind):
            continue
        left[kind] -= 1
        rows.append((*line[:4], *line[4], *result))
        looser = solve(line, 100.0 * TOLERANCE)
        if looser is not None:
            largest = max(map(abs, result[:4])) or 1.0
            change = np.subtract(looser[:5], result[:5]) / (*[largest] * 4, line[3])
            differences.append(np.abs(change).max())
    print(f"left out: {approximated}; without a looser run: {len(rows) - len(differences)}")
    return np.array(rows, dtype=float), max(differences)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--write", action="store_true", help="write the file instead of comparing")
    given = parser.parse_args()
    sys.breakpointhook = lambda: None  # MoorPy stops in the debugger where it raises an error
    rows, difference = make()
    print(f"{len(rows)} lines; with 100 times the tolerance {difference:.1e} of the largest force or of the length")
    if given.write:
        np.savetxt(FILE, rows, delimiter=",", header=",".join(COLUMNS), comments="", fmt="%.17g")
        return
    stored = np.genfromtxt(FILE, delimiter=",", skip_header=1)
    scale = np.maximum(np.abs(stored), 1e-12 * np.abs(stored).max(axis=1, keepdims=True))
    print(f"largest relative difference from the stored file: {(np.abs(rows - stored) / scale).max():.1e}")


if __name__ == "__main__":
    main()
