"""Decks of MoorDyn and CableDyn at rest, beside an independent minimization of the energy.

    python tests/benchmarks/decks.py FOLDER > decks.csv

FOLDER, as a clone of MoorDyn at v2.7.1, is searched for files with line types. CSV: path, number of lines, and the largest
differences in percent: of the force at a driven point, of this force or a thousandth of the largest one; of the place of a
free point, of the length of the longest line. Or why the file is not read.

The energy is that of elastic segments that do not push, weights in the nodes, and ground springs; Newton's method with a
damping that falls with each success brings it to its minimum, from parabolas between the points. Nothing of the package but
what the deck was made into is used.
"""

import sys
import tempfile
import tomllib
import warnings
from pathlib import Path

import numpy as np
from as_script import print_csv
from scipy.sparse import coo_matrix, diags
from scipy.sparse.linalg import spsolve

from tetherfmu import TetherSystem
from tetherfmu.files.imported import moordyn, reading

SMALL = 1e-3  # of the largest force: differences of smaller ones are relative to it


class Net:
    """Nodes and segments of a system in a table as of TOML; free points begin among their neighbours."""

    def __init__(self, table):
        self.gravity, self.ground = table["environment"]["gravity"], table.get("ground")
        self.free, lines = [name for name, each in table["points"].items() if "mass" in each], table["lines"].values()
        self.at = {name: k for k, name in enumerate(table["points"])}
        places = [np.array(each.get("position", [np.nan] * 3), float) for each in table["points"].values()]
        for _ in range(20):
            for name in self.free:
                ends = [(line, line["to"] if line["from"] == name else line["from"]) for line in lines]
                near = [places[self.at[end]] for line, end in ends if name in (line["from"], line["to"])]
                known = [each for each in near if np.isfinite(each).all()]
                places[self.at[name]] = np.mean(known, axis=0) - (0.0, 0.0, 0.1) if known else places[self.at[name]]
        masses, first, last, rest, stiff, heavy = (
            [each.get("mass", 0.0) for each in table["points"].values()],
            *([] for _ in range(5)),
        )
        for line in lines:
            a, b, count = self.at[line["from"]], self.at[line["to"]], line["segments"]
            span = np.linalg.norm(places[b] - places[a])
            sag = np.sqrt(0.375 * max(line["initial_length"] - span, 0.0) * max(span, 0.1 * line["initial_length"]))
            nodes = [a, *range(len(places), len(places) + count - 1), b]
            for s in np.arange(1, count) / count:
                places.append(places[a] + s * (places[b] - places[a]) - (0.0, 0.0, 4.0 * sag * s * (1.0 - s)))
            first, last = [*first, *nodes[:-1]], [*last, *nodes[1:]]
            rest += [line["initial_length"] / count] * count
            stiff += [line["axial_stiffness"] * count / line["initial_length"]] * count
            heavy += [line["mass_per_length"] * line["initial_length"] / count] * count
        self.first, self.last, self.rest, self.stiff = np.array(first), np.array(last), np.array(rest), np.array(stiff)
        self.places = np.array(places)
        of_lines = (np.bincount(each, np.array(heavy), len(places)) / 2.0 for each in (first, last))
        of_lines = sum(of_lines)
        self.weights = self.gravity * (of_lines + np.pad(masses, (0, len(places) - len(masses))))
        self.springs = self.gravity * of_lines / self.ground["sink"] if self.ground else 0.0 * of_lines
        self.floor = self.ground["height"] if self.ground else -np.inf
        driven = [self.at[name] for name in self.at if name not in self.free]
        self.moving = np.setdiff1d(np.arange(len(places)), driven)

    def state(self, places):
        """Energy [J], its slopes (nodes, 3) [N], and tensions [N], directions and lengths [m] of the segments."""
        apart = places[self.last] - places[self.first]
        length = np.linalg.norm(apart, axis=1)
        stretch, along = np.maximum(length - self.rest, 0.0), apart / length[:, None]
        deep = np.maximum(self.floor - places[:, 2], 0.0)
        tension = self.stiff * stretch
        slopes = np.zeros_like(places)
        np.add.at(slopes, self.first, -tension[:, None] * along)
        np.add.at(slopes, self.last, tension[:, None] * along)
        slopes[:, 2] += self.weights - self.springs * deep
        energy = 0.5 * self.stiff @ stretch**2 + self.weights @ places[:, 2] + 0.5 * self.springs @ deep**2
        return energy, slopes, (tension, along, length)

    def curvature(self, places, tension, along, length):
        """Second derivatives of the energy, sparse."""
        outer = along[:, :, None] * along[:, None, :]
        stiff = np.where(tension > 0.0, self.stiff, 0.0)
        blocks = stiff[:, None, None] * outer + (tension / length)[:, None, None] * (np.eye(3) - outer)
        rows, columns, values = [], [], []
        for a, b, sign in ((0, 0, 1), (1, 1, 1), (0, 1, -1), (1, 0, -1)):
            i, j = 3 * (self.first, self.last)[a], 3 * (self.first, self.last)[b]
            rows.append(np.broadcast_to(i[:, None, None] + np.arange(3)[:, None], blocks.shape).ravel())
            columns.append(np.broadcast_to(j[:, None, None] + np.arange(3), blocks.shape).ravel())
            values.append(sign * blocks.ravel())
        size = (3 * len(places),) * 2
        found = coo_matrix((np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))), size).tocsr()
        ground = np.zeros_like(places)
        ground[:, 2] = np.where(places[:, 2] < self.floor, self.springs, 0.0)
        return found + diags(ground.ravel())

    def at_rest(self):
        """Places of the nodes [m] and slopes of the energy there [N]; RuntimeError if no minimum is found."""
        places, damping = self.places.copy(), 1e-3 * np.median(self.stiff)
        unknown = (3 * self.moving[:, None] + np.arange(3)).ravel()
        energy, slopes, segments = self.state(places)
        for _ in range(1500):
            residual = slopes.ravel()[unknown]
            if len(unknown) == 0 or np.abs(residual).max() < 1e-9 * max(self.weights.sum(), segments[0].max()):
                return places, slopes
            matrix = self.curvature(places, *segments)[unknown][:, unknown] + diags(np.full(len(unknown), damping))
            way = -spsolve(matrix.tocsc(), residual)
            way *= min(1.0, 0.1 * self.rest.max() * 20.0 / np.abs(way).max())
            tried = places.copy()
            tried.ravel()[unknown] += way
            new = self.state(tried)
            if new[0] <= energy + 1e-12 * abs(energy):
                places, (energy, slopes, segments), damping = tried, new, max(damping / 3.0, 1e-9)
            else:
                damping *= 4.0
        raise RuntimeError("the minimum is not found")


def differences(table, path):
    """Those of forces and of places from the independent minimum [%]."""
    net = Net(table)
    system = TetherSystem.from_file(path)
    start = system.initialize(positions=dict.fromkeys(net.free))
    places, slopes = net.at_rest()
    pulls = {name: -slopes[k] for name, k in net.at.items() if name not in net.free}
    least = SMALL * max(np.linalg.norm(each) for each in pulls.values())
    forces = [
        np.linalg.norm(start.points[name].force - each) / max(np.linalg.norm(each), least) for name, each in pulls.items()
    ]
    longest = max(line["initial_length"] for line in table["lines"].values())
    away = [np.linalg.norm(start.points[name].position - places[net.at[name]]) / longest for name in net.free]
    return 100.0 * max(forces), 100.0 * max(away, default=0.0)


def main():
    """Write the table."""
    warnings.simplefilter("ignore")
    root = Path(sys.argv[1])
    print_csv("path", "lines", "force %", "place %", "not read, or not compared")
    for path in sorted(each for each in root.rglob("*") if each.suffix in (".txt", ".dat") and each.is_file()):
        if not moordyn.HAS_IT.search(path.read_text(encoding="utf-8", errors="replace")):
            continue
        name = path.relative_to(root).as_posix()
        try:
            text = reading.imported(path)[1]
        except ValueError as problem:
            print_csv(name, "", "", "", problem)
            continue
        with tempfile.TemporaryDirectory() as folder:
            made = Path(folder) / "made.toml"
            made.write_text(text, encoding="utf-8")
            table = tomllib.loads(text)
            try:
                found = [f"{each:.4f}" for each in differences(table, made)]
            except RuntimeError as problem:
                found = ["", "", problem]
        print_csv(*(name, len(table["lines"]), *found, "")[:5])


if __name__ == "__main__":
    main()
