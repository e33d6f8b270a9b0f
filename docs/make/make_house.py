"""Draw docs/figures/house.svg: the rooms of the package on their floors; `python docs/make/make_house.py`.

The floors are those of the import contract in pyproject.toml, the words are first sentences of the sources. A test reads the
imports (`arrows`): they all point downwards.
"""

import ast
import re
import tomllib
from functools import cache
from pathlib import Path
from textwrap import fill

from pictures import save

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "fmu_sources" / "tetherfmu"
FIGURE = ROOT / "docs" / "figures" / "house.svg"
ALONE, SHARED, BETWEEN = 0.28, 0.62, 0.06  # heights of a floor with one room and with several, and between floors [inch]
LEFT, RIGHT, NAMES = 0.1, 8.55, 1.3  # of the rooms, width of the names [inch]
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


def words(module, end):
    """What a module does: its docstring up to a sign of `end` that ends a clause."""
    path = PACKAGE / module.replace(".", "/")
    path = path / "__init__.py" if path.is_dir() else path.with_suffix(".py")
    text = " ".join(ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))).split())
    return re.split(f"[{end}](?: |$)", text.replace("`", ""))[0]


def colour(room):
    """Colour of a room: what is compiled, what every FMU has, all else."""
    return "#dceaf7" if room.startswith("kernels") else "#f3ead7" if room in SHIPPED else "#eeeeee"


def draw(path):
    """Draw the house."""
    from matplotlib.figure import Figure
    from matplotlib.patches import FancyBboxPatch

    levels = floors()
    heights = [ALONE if len(rooms) == 1 else SHARED for rooms in levels]
    total = sum(heights) + BETWEEN * (len(levels) + 1)
    figure = Figure(figsize=(9.0, total))
    axis = figure.add_axes((0.0, 0.0, 1.0, 1.0), xlim=(0.0, 9.0), ylim=(-total, 0.0))
    axis.axis("off")
    top = -BETWEEN
    for rooms, height in zip(levels, heights, strict=True):
        width = (RIGHT - LEFT + BETWEEN) / len(rooms) - BETWEEN
        for k, room in enumerate(rooms):
            left = LEFT + k * (width + BETWEEN)
            shape = "round,pad=0,rounding_size=0.04"
            axis.add_patch(FancyBboxPatch((left, top - height), width, height, shape, fc=colour(room), ec="#555555"))
            module = ROOMS_OF_FILES.get(room, (room,))[-1]
            axis.text(
                left + 0.08, top - 0.5 * ALONE, module.removeprefix("kernels."), va="center", fontsize=10, weight="bold"
            )
            if len(rooms) == 1:
                axis.text(left + NAMES, top - 0.5 * ALONE, words(module, ".;"), va="center", fontsize=8.5)
            else:
                text = fill(words(module, ".;" if len(rooms) == 2 else ".:;"), int(15 * width))
                axis.text(left + 0.08, top - ALONE, text, va="top", fontsize=8.5, linespacing=1.1)
        top -= height + BETWEEN
    style = {"arrowstyle": "-|>", "color": "#1f5a92", "lw": 1.6}
    axis.annotate("", (8.8, -total + BETWEEN), (8.8, -BETWEEN), arrowprops=style)
    axis.text(8.67, -0.5 * total, "imports", rotation=90, ha="center", va="center", fontsize=10)
    save(figure, path)


if __name__ == "__main__":
    draw(FIGURE)
