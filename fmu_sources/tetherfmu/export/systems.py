"""Assemble the FMU of a system of tethers from its file: one library serves all systems, so that nothing is compiled."""

from dataclasses import asdict
from html import escape
from pathlib import Path

from tetherfmu.fmi.resources import DEFAULT_OPTIONS
from tetherfmu.fmi.system_variables import Line, Point, Structure, table_of
from tetherfmu.fmi.wiring import of_system
from tetherfmu.runtime.inputs import ZERO
from tetherfmu.runtime.kernel_library import SYSTEM
from tetherfmu.runtime.layout import START_AT_REST, START_GIVEN
from tetherfmu.runtime.quantities import quantities
from tetherfmu.systems import files
from tetherfmu.systems.ordering import ordered
from tetherfmu.systems.tether_system import TetherSystem

from . import evidence, osp
from .archive import SLAVES, packed_with_kernels, seal, write
from .documents import about, files_beside, page
from .native import description_fmi3, fmus
from .texts import filled

SLAVE = TetherSystem.__name__
ABOUT = (
    "System of dynamic segmented tethers between points, solved in one step. "
    "In: position and velocity of driven points, load on free points, reel-out speed of the lines, wind. "
    "Out: force of the lines on driven points, position and velocity of free points, tensions and shapes of the lines."
)
TIMES = DEFAULT_OPTIONS["step"], DEFAULT_OPTIONS["stop"]  # of the default experiment [s]


def build(path, folder, platforms, shape_points=None, native=None, with_header=False, with_sources=False, wind_points=0):
    """Build the FMU of a system and return its path; ValueError says in one line what is wrong with the file.

    path : of the file, docs/use/systems.md has its keys.  folder : where the FMU goes, made if missing; the groups of
    variables for the Open Simulation Platform are written beside it.  platforms : as in `BuildOptions`.  shape_points : of
    each line, 0 for none; None for one at each node.  native : version of FMI (2 or 3) of an FMU without Python; None for
    PythonFMU's.  with_header, with_sources : of a native one, see `fmus.written`.  wind_points : of each line, 0 for none.
    """
    found, positions = read(path)
    structure, folder = structure_from(found, positions, shape_points, wind_points), Path(folder)
    points, lines, free = len(structure.points), len(structure.lines), len(structure.free)
    about = f"{ABOUT} {structure.name}: {lines} line{'s' * (lines > 1)} between {points} points, of which {free} free."
    sets = _evidence_of(found, native == 3, wind_points)
    if native:
        wiring, terminals = of_system(structure), description_fmi3.terminals_of_system(structure)
        model = fmus.Model(structure.name, about, wiring, terminals, TIMES)
        files = documents(structure, about, platforms, sets, native)
        return fmus.written(files, model, folder, platforms, native, with_header, with_sources)
    folder.mkdir(parents=True, exist_ok=True)
    made = packed_with_kernels(SLAVE, None, about, SYSTEM, platforms, {"system": asdict(structure)})
    made.update(documents(structure, about, platforms, sets))
    seal(made)
    return write(made, folder, structure.name, None)


def _evidence_of(found, arrays, wind_points):
    """Texts of the evidence set of a `SystemFile`, dict by file name; empty if its reference cannot be flown."""
    words = {"model": TetherSystem.__name__, "scene": evidence.SCENES[-1], "more": ""}
    try:
        return evidence.files(found.name, [evidence.of_system(found, wind_points)], arrays, **words)
    except ValueError:
        return {}


def read(path):
    """`SystemFile` of a file, and the positions of all points at the start [m], dict by name.

    A free point without a position gets the one where it is in equilibrium without wind and loads, or that of the origin if
    there is none: the FMU seeks it anew. ValueError says in one line what is wrong.
    """
    found = files.load(path)
    if found.name.lower() in {name.lower() for name in SLAVES}:
        raise ValueError(f"{path}: name is {found.name!r}; it must not be that of the FMU of a single tether")
    system = TetherSystem(found.points, found.lines, found.environment, found.solver, found.ground)
    places = {point.name: point.position for point in found.points}
    if None in places.values():
        try:
            start = system.initialize().points
            found_at = {name: tuple(start[name].position.tolist()) for name in places}
        except ValueError:  # with other winds or loads there may be an equilibrium
            found_at = dict.fromkeys(places, ZERO)
        places = {name: place or found_at[name] for name, place in places.items()}
    return found, places


def structure_from(found, positions, shape_points=None, wind_points=0):
    """`Structure` of a `SystemFile` whose points start at these positions [m]; shape_points, wind_points : as in `build`."""
    free, band = ordered([point.name for point in found.points if not point.is_driven], found.lines)
    points, lines = [], []
    for each in found.points:
        start = START_GIVEN if each.position else START_AT_REST  # where it is sought
        points.append(Point(each.name, each.mass, positions[each.name], each.velocity, start))
    for each in found.lines:
        starts = values_of(each.tether, each.winch) | {"reel_out_speed": each.reel_out_speed}
        shown = each.tether.segments + 1 if shape_points is None else shape_points
        lines.append(Line(each.name, each.start, each.end, starts, shown, wind_points))
    starts = values_of(found.environment, found.solver, found.ground)
    return Structure(found.name, tuple(points), tuple(lines), tuple(free), band, starts)


def values_of(*records):
    """Values of all quantities of records, dict by name."""
    return {name: getattr(record, name) for record in records for name, _ in quantities(record)}


def documents(structure, description, platforms, sets, native=None):
    """All files beside the model: dict of their path in the archive to bytes.

    description : of the model.  sets : texts of the evidence set, dict by file name.  native : as in `build`.
    """
    table = table_of(structure)
    body = filled(
        "system.html",
        name=structure.name,
        points="\n".join(_row(point.name, "free" if point.is_free else "driven") for point in structure.points),
        lines="\n".join(_row(line.name, line.start, line.end) for line in structure.lines),
        **about(description, native),
    )
    groups = osp.model_description_of_system(structure, table)
    return files_beside(structure.name, page(structure.name, body, table), sets, platforms, groups, native)


def _row(*cells):
    """A row of an HTML table."""
    return f"<tr>{''.join(f'<td>{escape(cell)}</td>' for cell in cells)}</tr>"
