"""Draw docs/figures/house.svg: the rooms of the package, their floors and their imports; `python docs/make/make_house.py`.

The floors are those of the import contract in pyproject.toml, the arrows are read from the import statements of the sources.
"""

import ast
import tomllib
from functools import cache
from pathlib import Path
from textwrap import fill

from pictures import save

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "fmu_sources" / "tetherfmu"
FIGURE = ROOT / "docs" / "figures" / "house.svg"
FLOOR = 1.15  # height of a floor [inch]
APART = ("check", "console")  # rooms at the right
SHIPPED = ("fmi", "wiring", "runtime")  # rooms that every FMU has
ROOMS_OF_FILES = {  # modules that stand beside the folders
    "commands": ("__main__", "commands"),
    "kernels.entry_points": ("kernels.entry_points",),
    "kernels": ("kernels.arrays", "kernels.compilation"),
}


def named(layer):
    """Room of a name in the import contract."""
    return next((room for room, modules in ROOMS_OF_FILES.items() if layer in modules), layer)


@cache
def floors():
    """Floors from the top: list of lists of rooms, from the layers of the import contract."""
    contracts = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["importlinter"]["contracts"]
    layers = {
        contract.get("containers", ["tetherfmu"])[0]: contract["layers"] for contract in contracts if "layers" in contract
    }
    found = []
    for layer in layers["tetherfmu"]:
        names = [name.strip().removeprefix("tetherfmu.") for name in layer.split("|")]
        if names == ["kernels"]:
            found += [[f"kernels.{name.strip()}" for name in each.split("|")] for each in layers["tetherfmu.kernels"]]
        else:
            found.append(names)
    rooms = [list(dict.fromkeys(map(named, names))) for names in found]
    return [floor for k, floor in enumerate(rooms) if k == 0 or floor != rooms[k - 1]]


def room_of(module):
    """Room of a module such as "tetherfmu.kernels.equations.segment"; None for the package itself."""
    name = module.removeprefix("tetherfmu").removeprefix(".")
    rooms = [room for floor in floors() for room in floor]
    listed = {layer: room for room, layers in ROOMS_OF_FILES.items() for layer in layers}
    parts = name.split(".")
    starts = [".".join(parts[:k]) for k in range(len(parts), 0, -1)]
    return next((listed.get(start, start) for start in starts if start in listed or start in rooms), None)


def imported(path):
    """Modules of the package that a file imports, also those that are imported inside of functions."""
    package = ["tetherfmu", *path.relative_to(PACKAGE).parent.parts]
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom):
            base = ".".join(package[: len(package) - node.level + 1]) if node.level else ""
            origin = ".".join(part for part in (base, node.module) if part)
            if origin.split(".")[0] == "tetherfmu":
                yield from (f"{origin}.{alias.name}" for alias in node.names)


@cache
def arrows():
    """Imports between rooms: set of pairs (from, to)."""
    found = set()
    for path in PACKAGE.rglob("*.py"):
        own = room_of(".".join(path.relative_to(PACKAGE.parent).with_suffix("").parts))
        found |= {(own, room_of(module)) for module in imported(path)}
    return {(start, end) for start, end in found if start and end and start != end}


def without_detours(pairs):
    """The arrows that do not follow from others: import over one room implies that over two."""

    def reaches(start, end, left_out):
        ways = [b for a, b in pairs if a == start and (a, b) != left_out]
        return any(b == end or reaches(b, end, left_out) for b in ways)

    return {pair for pair in pairs if not reaches(*pair, pair)}


def contents(room):
    """What is in a room: its folders and modules, one line."""
    if room == "kernels.entry_points":
        return "segments  pack  complete  initialize  advance  outputs  fly  energy, for each library"
    if room == "kernels.packing":
        return "pack  count_segments"
    if room in ROOMS_OF_FILES and room != "commands":
        return "  ".join(name.rpartition(".")[2] for name in ROOMS_OF_FILES[room])
    folder = PACKAGE / room.replace(".", "/")
    folders = sorted(path.parent.name for path in folder.glob("*/__init__.py"))
    return "  ".join([*folders, *sorted(path.stem for path in folder.glob("[a-z]*.py"))])


def box(floor, rooms, k):
    """Left, bottom, width of the box of a room; `check` and `console` stand apart, and nothing is in the way of an arrow."""
    if rooms[k] in APART:
        return 0.86, -floor - 0.3, 0.14
    if len(rooms) == 1 and rooms[k] in ("wiring", "runtime"):
        return 0.0, -floor - 0.3, 1.0
    shared = [room for room in rooms if room not in APART]
    sizes = [75 + len(contents(room)) for room in shared]
    unit, place = (0.83 - 0.01 * len(shared)) / sum(sizes), shared.index(rooms[k])
    return sum(sizes[:place]) * unit + 0.01 * place, -floor - 0.3, sizes[place] * unit


def draw(path):
    """Draw the house."""
    from matplotlib.figure import Figure
    from matplotlib.patches import FancyBboxPatch

    levels = floors()
    figure = Figure(figsize=(9.0, FLOOR * len(levels)), layout="constrained")
    axis = figure.add_subplot()
    places = {}
    for level, rooms in enumerate(levels):
        for k, room in enumerate(rooms):
            left, bottom, width = box(level, rooms, k)
            middle = places[room] = left + 0.5 * width
            colour = "#dceaf7" if room.startswith("kernels") else "#f3ead7" if room in SHIPPED else "#eeeeee"
            shape = FancyBboxPatch((left, bottom), width, 0.6, "round,pad=0,rounding_size=0.01", fc=colour, ec="#555555")
            axis.add_patch(shape)
            axis.text(middle, -level + 0.18, room, ha="center", va="center", fontsize=12, weight="bold")
            text = fill(contents(room), int(140 * width))
            axis.text(middle, -level - 0.08, text, ha="center", va="center", fontsize=8.2, linespacing=1.1)
    heights = {room: -level for level, rooms in enumerate(levels) for room in rooms}
    style = {"arrowstyle": "-|>", "color": "#1f5a92", "shrinkA": 0, "shrinkB": 0, "lw": 1.3}
    for start, end in sorted(without_detours(arrows())):
        x = places[end] if len(levels[-heights[end]]) > 1 else min(places[start], 0.93)
        axis.annotate("", (x, heights[end] + 0.3), (x, heights[start] - 0.3), arrowprops=style, zorder=0)
    axis.set_xlim(-0.005, 1.005)
    axis.set_ylim(-len(levels) + 0.65, 0.35)
    axis.axis("off")
    save(figure, path)


if __name__ == "__main__":
    draw(FIGURE)
