"""Assemble the FMU of a system of tethers from its file: one library serves all systems, so that nothing is compiled."""

from contextlib import suppress
from dataclasses import replace
from html import escape
from pathlib import Path

from tetherfmu.files import system_files as files
from tetherfmu.fmi.resources import DEFAULT_OPTIONS
from tetherfmu.python.tether_system import TetherSystem
from tetherfmu.runtime.inputs import ZERO
from tetherfmu.runtime.kernel_library import SYSTEM
from tetherfmu.runtime.naming import prefixed
from tetherfmu.wiring.fmu import of_system
from tetherfmu.wiring.selection import shown, with_starts
from tetherfmu.wiring.system import in_json
from tetherfmu.wiring.system_variables import table_of

from . import evidence, lean_evidence, osp
from .archive import SLAVES, packed_with_kernels, seal, write
from .build_options import BuildOptions, chosen
from .documents import about, files_beside, page
from .native import description_fmi3, native_fmus
from .rehearsal import check_start
from .texts import filled

SLAVE = TetherSystem.__name__
ABOUT = (
    "System of dynamic segmented tethers between points, solved in one step. "
    "In: position and velocity of driven points, load on free points, reel-out speed of the lines, wind. "
    "Out: force of the lines on driven points, position and velocity of free points, tensions and shapes of the lines."
)
WINCHES = (
    "<h2>Winches</h2>\n<p>Each pays out its lines in these ratios; a line in several winches is paid out by their sum.</p>"
)
TIMES = DEFAULT_OPTIONS["step"], DEFAULT_OPTIONS["stop"]  # of the default experiment [s]


def build(path, folder, options=None, native=None, with_header=None, with_sources=False, now=str):
    """Build the FMU of a system and return its path; ValueError describes a problem of the file in one line.

    path : of the file, docs/use/systems.md has its keys.  folder : of the FMU, created if missing; the groups of
    variables for the Open Simulation Platform are written beside it.  options : `BuildOptions`, of which a table [build]
    of the file sets a part; None for the file's and one point of the shape at each node.  native : version of FMI (2 or 3)
    of an FMU without Python; None for PythonFMU's.  with_header, with_sources : of a native one, see `fmus.written`.
    now : receives a text on each slow part of the work.
    """
    options = options or BuildOptions(shape_points=None)
    now(f"starting the system of {path}")
    found, folder = read(path), Path(folder)
    system = replace(found, shape_points=options.shape_points, wind_points=options.wind_points)
    with prefixed(f"{path}: "):
        own = chosen(options.lean.over(found.build), table_of(system))
        check_start(None, {"system": in_json(system), **own})
    starts, left_out = own.get("starts", ()), own.get("left_out", ())
    table = with_starts(table_of(system), starts)
    points, lines, free = len(system.points), len(system.lines), len(system.free)
    about = f"{ABOUT} {system.name}: {lines} line{'s' * (lines > 1)} between {points} points, of which {free} free."
    now(f"flying {lines} lines with {len(table)} variables for the evidence set")
    sets = {} if starts else _evidence_of(found, table, native == 3, options.wind_points, left_out, now)
    now("writing the documents")
    files = documents(system, table, about, options.platforms, sets, native, left_out)
    now("writing the FMU")
    if native:
        wiring = of_system(system, left_out, starts)
        terminals = description_fmi3.terminals_of_system(system, wiring.shown)
        model = native_fmus.Model(system.name, about, wiring, terminals, TIMES)
        return native_fmus.written(files, model, folder, options.platforms, native, with_header, with_sources)
    folder.mkdir(parents=True, exist_ok=True)
    made = packed_with_kernels(SLAVE, None, about, SYSTEM, options.platforms, {"system": in_json(system), **own})
    made.update(files)
    seal(made)
    return write(made, folder, system.name, None)


def _evidence_of(found, table, arrays, wind_points, left_out, now=str):
    """Texts of the evidence set of a `SystemFile`, dict by file name; empty if its reference fails.

    left_out : names of omitted variables.  now : as for `build`.
    """
    words = {"model": TetherSystem.__name__, "scene": evidence.SCENES[-1], "more": ""}
    try:
        made = evidence.of_system(found, wind_points)
        if left_out:
            made = lean_evidence.of_system(made, table, frozenset(left_out))
        drums = [name for name in made.inputs if name.endswith(".winch_force")]  # which may stick, and slip
        is_sound = made.outputs and (not drums or lean_evidence.is_kept(made))
        return evidence.files(found.name, [made], arrays, now, **words) if is_sound else {}
    except ValueError:
        return {}


def read(path):
    """`SystemFile` of a file; ValueError describes a problem in one line.

    A free point without a position starts where it is in equilibrium without wind and loads, or in the origin if there is
    none: the FMU solves for it again.
    """
    found = files.load(path)
    if found.name.lower() in {name.lower() for name in SLAVES}:
        raise ValueError(f"{path}: name is {found.name!r}; it must not be that of the FMU of a single tether")
    system = TetherSystem.of(found)
    sought = [point.name for point in found.points if point.position is None]
    starts = dict.fromkeys(sought, ZERO)
    with suppress(ValueError):  # with other winds or loads there may be an equilibrium
        if sought:
            start = system.initialize().points
            starts = {name: tuple(start[name].position.tolist()) for name in sought}
    return replace(found, starts=starts)


def documents(system, table, description, platforms, sets, native, left_out):
    """All files other than the model: dict of their path in the archive to bytes.

    table : of all variables.  description : of the model.  sets : texts of the evidence set, dict by file name.
    native : as for `build`.  left_out : names of omitted variables.
    """
    body = filled(
        "system.html",
        name=system.name,
        points="\n".join(_row(point.name, "driven" if point.is_driven else "free") for point in system.points),
        lines="\n".join(_row(line.name, line.start, line.end) for line in system.lines),
        winches=_about_winches(system.winches),
        **about(description, native),
    )
    groups = osp.model_description_of_system(system, shown(table, frozenset(left_out)))
    return files_beside(system.name, page(system.name, body, table, left_out), sets, platforms, groups, native)


def _about_winches(winches):
    """Section of the page on shared winches, "" without any."""
    if not winches:
        return ""
    rows = [
        _row(each.name, f"{each.name}.{each.input}", ", ".join(f"{line}: {ratio:g}" for line, ratio in each.ratios))
        for each in winches
    ]
    head = "<tr><th>name</th><th>input</th><th>lines and ratios</th></tr>"
    return "\n".join([WINCHES, "<table>", head, *rows, "</table>"])


def _row(*cells):
    """A row of an HTML table."""
    return f"<tr>{''.join(f'<td>{escape(cell)}</td>' for cell in cells)}</tr>"
