"""What the tethers cost: `python -m tetherfmu.study.benchmark [--quick] [--fmus DIR] [--out DIR] [--figure FILE]`.

Times of the kernels, of FMUs in FMPy and of their start, and races with CasADi + CVODES and MoorDyn, as a page, a CSV file
and a work-precision diagram. Peers come with the extra `benchmark`; those that are not installed are left out.
"""

import argparse
import importlib
import sys
import tempfile
import zipfile
from pathlib import Path

from tetherfmu.export.archive import SLAVES, build
from tetherfmu.runtime.kernel_library import this_platform
from tetherfmu.runtime.slave import KERNELS_FOLDER
from tetherfmu.study.measuring.clock import interleaved
from tetherfmu.study.measuring.tables import Table, write
from tetherfmu.study.measuring.through_fmpy import measured
from tetherfmu.study.scenes.standard import STEP, circle_scene, figure_of_eight_scene, release_scene

from .kernels import SEGMENTS, kernel_times
from .races import OURS, equal_errors, our_run, race

MOORDYN_WARM_UP = 250  # communication steps, 5 s
ABOUT_KERNELS = """\
Circle, per communication step of 20 ms: library of the FMU, called from a compiled loop, tolerance 1e-4; the least
of 15 interleaved runs of 500 steps. Work: internal steps (dynamic) or Newton iterations (the others) per
communication step."""
ABOUT_HOST = """\
Circle, per communication step of 20 ms, 20 segments: set position and velocity of the kite (6 numbers), step, get
both end forces (6 numbers). Start: instantiate to the end of the first step, new process, warm file cache, median."""
ABOUT_RACES = """\
Circle: 125.5 s, wind 8 m/s, output every 0.5 s. Figure of eight: 40 s, laps of 20 s at 40 m/s, wind 8 m/s, taut tether of
499 m, output every 0.2 s. Release: 70 m held between (0, 0, 0) and (-40, 0, -47) at rest, then
the lower end is free and the tether reels out at 0.3 m/s; 10 s, output every 0.1 s. Error: root mean square distance
of the nodes from a DOP853 solution at 1e-11 with the exact path of the kite, over all outputs. TetherDynamic (library
of the FMU) and the restarted CVODES get samples of the path every 20 ms, CVODES in one call gets its formula. CVODES:
CasADi, exact sparse Jacobian, the fastest of its linear solvers; restarts are chained inside CasADi, without Python.
Compiled C: the equations and their Jacobian through a C compiler with -O3."""
ABOUT_RATIOS = """\
Times for an error, between the measured points on logarithmic axes. For the flights it is the error of the default
tolerance 1e-4."""
ABOUT_MOORDYN = """\
Circle, wind 8 m/s, 20 segments, per communication step of 20 ms. MoorDyn flies the same tether through water as light
as air, but takes drag at nodes instead of segments; its forces differ by 1 to 4 percent. So no equal error can be
told: this is its cost at the largest stable steps, where it is within 0.002 N of its own fine steps."""


def peer(module, package):
    """A module of this package that needs a peer, or None, said in one line."""
    try:
        return importlib.import_module(f"{__package__}.{module}")
    except ModuleNotFoundError:
        print(f"{package} is not installed: its rows are left out (pip install {package})")
        return None


def fmus_in(folder):
    """Paths of all FMUs by name; those that are missing are built for this platform."""
    paths = {name: Path(folder) / f"{name}.fmu" for name in SLAVES}
    for name, path in paths.items():
        if not path.exists():
            build(name, folder, platforms=(this_platform(),))
    return paths


def unpack_libraries(paths, folder):
    """Copy the compiled libraries out of the FMUs."""
    for path in paths.values():
        with zipfile.ZipFile(path) as archive:
            for entry in archive.namelist():
                if f"/{KERNELS_FOLDER}/" in entry and not entry.endswith("/"):
                    (folder / Path(entry).name).write_bytes(archive.read(entry))


def kernel_table(libraries, quick):
    """Time of the kernels per communication step."""
    rows = []
    for what, n, seconds, count in kernel_times(
        libraries, (6, 20) if quick else SEGMENTS, 100 if quick else 500, 2 if quick else 15
    ):
        per_segment = None if what.startswith(("catenary", "straight")) else 1e9 * seconds / n
        rows.append((what, n if per_segment else "-", 1e6 * seconds, per_segment, count))
    rows.sort(key=lambda row: row[0])
    return Table("Kernels", ABOUT_KERNELS, ("what", "segments", "us per step", "ns per segment", "work"), rows)


def host_table(paths, quick):
    """Cost of the FMUs in FMPy, and their start-up time."""
    rows = []
    for name, path in paths.items():
        sets, steps, gets = measured("costs", path, 100 if quick else 3000, 1 if quick else 3)
        (start,) = measured("start", path, 1, 1 if quick else 10)
        rows.append((name, *(1e6 * each for each in (sets, steps, gets, sets + steps + gets)), 1e3 * start))
    return Table("FMUs in FMPy", ABOUT_HOST, ("FMU", "set us", "step us", "get us", "together us", "start ms"), rows)


def race_tables(libraries, cvodes, quick, flights=False):
    """Tables of all points, and of times at equal error; also the points. `flights`: of the two flights only."""
    if flights:
        scenes = [circle_scene(20), figure_of_eight_scene(20)]
    elif quick:
        scenes = [circle_scene(20, 2.0), figure_of_eight_scene(20, 1.0), release_scene(10, 0.5)]
    else:
        scenes = [circle_scene(20), figure_of_eight_scene(20), release_scene(10), release_scene(40)]
    points = []
    for scene in scenes:
        points += race(libraries, scene, cvodes, quick, not (quick or flights), 1 if quick else 3)
    rows = [(p.scene, p.segments, p.solver, p.tolerance, p.error, 1e3 * p.seconds, p.steps or None) for p in points]
    text = ABOUT_RACES
    if cvodes:
        worst = max(cvodes.largest_difference(scene) for scene in scenes)
        text += f" Its dy/dt differs from ours by at most {worst:.1e} of the largest at random states."
    columns = ("scene", "segments", "solver", "tolerance", "error m", "ms", "internal steps")
    tables = [Table("Work and precision", text, columns, rows)]
    if cvodes:
        tables.append(ratio_table(points))
    return tables, points


def ratio_table(points):
    """How many times faster TetherDynamic is at equal error."""
    rows = [
        (scene, n, error, OURS, name, 1e3 * ours, 1e3 * theirs, theirs / ours)
        for scene, n, error, ours, others in equal_errors(points)
        for name, theirs in others.items()
        if theirs
    ]
    return Table(
        "At equal error", ABOUT_RATIOS, ("scene", "segments", "error m", "we", "peer", "our ms", "its ms", "ratio"), rows
    )


def moordyn_table(libraries, line, quick):
    """The circle in MoorDyn at its largest stable steps, and in our tether, interleaved."""
    scene = circle_scene(20, 6.0 if quick else 40.0)
    part = 50
    flights = {f"MoorDyn {scheme}, {1000 * h:.3g} ms": line.Flight(scene, scheme, h) for scheme, h in line.SCHEMES}
    repeats = 2 if quick else 20
    jobs = {name: lambda flight=flight: flight.fly(part) for name, flight in flights.items()}
    for flight in flights.values():
        flight.fly(part if quick else MOORDYN_WARM_UP)
    short = circle_scene(20, part * STEP)
    jobs[OURS] = our_run(libraries, short, STEP, 1e-4, {})
    times, _ = interleaved(jobs, repeats)
    ours = times[OURS] / part
    rows = [(name, 1e6 * seconds / part, seconds / part / ours) for name, seconds in times.items()]
    return Table("MoorDyn", ABOUT_MOORDYN, ("solver", "us per step", "ratio"), rows)


def parse(arguments):
    """Command line options."""
    parser = argparse.ArgumentParser(prog="python -m tetherfmu.study.benchmark", description="Measure what tethers cost.")
    parser.add_argument("--quick", action="store_true", help="a few seconds, for a look whether it runs; no steady numbers")
    parser.add_argument("--flights", action="store_true", help="only the races of the two flights, without compiled C")
    parser.add_argument("--no-peers", action="store_true", help="leave out CasADi and MoorDyn")
    parser.add_argument("--fmus", metavar="DIR", help="folder of the FMUs (default: build them)")
    parser.add_argument("--out", metavar="DIR", default="benchmark", help="folder for benchmarks.md and benchmarks.csv")
    parser.add_argument("--figure", metavar="FILE", help="draw the work-precision diagram to this PNG file")
    return parser.parse_args(arguments)


def main(arguments=None):
    """Measure, print and store; returns 0."""
    options = parse(arguments)
    cvodes = None if options.no_peers else peer("cvodes", "casadi")
    line = None if options.no_peers else peer("moordyn_line", "moordyn")
    with tempfile.TemporaryDirectory() as temporary:
        libraries = Path(temporary) / "libraries"
        libraries.mkdir()
        paths = fmus_in(options.fmus or temporary)
        unpack_libraries(paths, libraries)
        tables = []
        if not options.flights:
            tables += [kernel_table(libraries, options.quick), host_table(paths, options.quick)]
        races, points = race_tables(libraries, cvodes, options.quick, options.flights)
        tables += races
        if line and not options.flights:
            tables.append(moordyn_table(libraries, line, options.quick))
    if options.figure:
        from .figure import draw

        draw(points, options.figure)
    print(write(tables, options.out, options.figure))
    return 0


if __name__ == "__main__":
    sys.exit(main())
