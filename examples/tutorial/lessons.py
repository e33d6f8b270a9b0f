"""What the lessons of the tutorial share: options, times, figures, animations.

Each lesson is a file with a function `lesson` that returns a `Lesson`; `command_line` makes a command of it.
"""

import os
import sys
import warnings
from importlib import import_module
from pathlib import Path
from time import perf_counter, process_time
from typing import NamedTuple

import numpy as np

from tetherfmu import PlausibilityWarning
from tetherfmu.console.colours import BLACK, COLOUR, GROUND, SKY_BLUE
from tetherfmu.console.ending import command
from tetherfmu.console.options import Parser
from tetherfmu.console.progress import now
from tetherfmu.files.toml_files import WrongUse


@command
def find_libraries():
    """Import what the lessons need besides numpy; if something is missing, one line says how to install it."""
    for name in ("matplotlib", "scipy"):
        import_module(name)


if status := find_libraries():
    sys.exit(status)
sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # the folder of the rooms

import matplotlib  # noqa: E402
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.animation import FuncAnimation, HTMLWriter, PillowWriter  # noqa: E402
from matplotlib.ticker import LogLocator, NullLocator  # noqa: E402

STEP = 0.02  # communication step, and time between two rows of a motion [s]
DURATION = 10.0  # of most lessons [s]
TIMES = STEP * np.arange(501)  # of the rows of such a motion [s]
TOLERANCE = 1e-6  # relative, of the lessons by hand
GRAVITY = 9.81  # m/s2
WIDE, MEDIUM, TALL = (8.0, 3.8), (8.0, 4.6), (8.0, 5.2)  # sizes of figures [inch]
SOLVER_COLOUR = {"solve_ivp without events": SKY_BLUE, "solve_ivp with events": BLACK, "TetherDynamic": COLOUR["dynamic"]}
DPI = 90
FRAMES_PER_SECOND = 10
CLOCK = perf_counter if os.name == "nt" else process_time  # processor time, which Windows counts in 16 ms
plt.rcParams["axes.titlesize"] = "medium"


class Movie(NamedTuple):
    """What an animation shows."""

    positions: np.ndarray  # of the nodes [m], (rows, nodes, 3), a row every STEP
    title: str
    in_space: bool = False  # otherwise from the side: x and z
    speed: float = 1.0  # times real time
    ground: float | None = None  # its height [m], in a view from the side


class Lesson(NamedTuple):
    """What a lesson found."""

    answer: str  # in a few words
    figure: object  # of matplotlib
    simulated: float  # time that was simulated [s]
    seconds: float  # time that it took [s]
    movie: Movie | None = None


def timed(function, *arguments, repeats=2, **options):
    """What a function returns, and its shortest time [s] of some calls (the first one may have to load something)."""
    seconds = []
    for _ in range(repeats):
        started = CLOCK()
        result = function(*arguments, **options)
        seconds.append(CLOCK() - started)
    return result, min(seconds)


def timed_from_here(tether, flight, repeats):
    """`timed` for a function of a tether that moves it: each call begins with the state that the tether has now."""
    state = tether.get_state()

    def run():
        tether.set_state(state)
        return flight(tether)

    return timed(run, repeats=repeats)


def race(solvers, tolerances, exact, repeats):
    """Computing times [s] and largest errors [m] of functions of a tolerance: dict name -> array (tolerances, 2)."""
    found = {}
    for name, solver in solvers.items():
        runs = (timed(solver, tolerance, repeats=repeats) for tolerance in tolerances)
        found[name] = np.array([(seconds, np.abs(motion - exact).max()) for motion, seconds in runs])
    return found


def follow(tether, duration, **inputs):
    """Node positions [m] of a tether while it moves for `duration` [s] with constant inputs, array (rows, nodes, 3)."""
    positions = [tether.positions]
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "a segment is stretched", PlausibilityWarning)  # the springs of the first lessons
        for _ in range(round(duration / STEP)):
            tether.step(STEP, **inputs)
            positions.append(tether.positions)
    return np.array(positions)


def curve(axes, x, y, text="", at=-1, side="right", shift=0.0, **style):
    """A curve with its name beside the point with the index `at`; shift : of the name upwards, in points."""
    (line,) = axes.plot(x, y, **style)
    offset, across, up = {"right": ((5, shift), "left", "center"), "above": ((0, 5 + shift), "center", "bottom")}[side]
    where = {"xytext": offset, "textcoords": "offset points", "ha": across, "va": up}
    axes.annotate(text, (x[at], y[at]), color=line.get_color(), **where)


def panels(rows=1, columns=1, size=None, **options):
    """A figure and its axes, with a light grid and without boxes."""
    size = size or (WIDE if rows == 1 else TALL)
    figure, found = plt.subplots(rows, columns, figsize=size, layout="constrained", **options)
    for axes in np.ravel(found):
        tidy(axes)
    return figure, found


def tidy(axes):
    """A light grid and no box."""
    axes.grid(alpha=0.3)
    axes.spines[["top", "right"]].set_visible(False)


def over_time(title, above_label, below_label="", **options):
    """A figure with two panels over time, one above the other, with the labels of their values."""
    figure, (above, below) = panels(2, sharex=True, **options)
    above.set(title=title, ylabel=above_label)
    below.set(xlabel="time [s]", ylabel=below_label)
    return figure, above, below


def compare(axes, product, by_hand):
    """Largest difference of a coordinate over time [mm]; product, by_hand : motions [m], array (rows, nodes, 3)."""
    curve(axes, TIMES, 1e3 * np.abs(product - by_hand).max(axis=(1, 2)), color=COLOUR["dynamic"])
    axes.set(xlabel="time [s]", ylabel="TetherDynamic against\nsolve_ivp [mm]")


def draw_motion(axes, positions, every, title, color=BLACK, labelled=True):
    """Side views of a motion, one for each `every` rows, the earlier the paler.

    labelled : with nodes, and with the time beside the last one.
    """
    nodes = {"marker": "o", "markersize": 3} if labelled else {}
    for row in range(0, len(positions), every):
        x, _, z = positions[row].T
        axes.plot(x, z, color=color, alpha=0.15 + 0.85 * row / len(positions), **nodes)
        if labelled:
            axes.annotate(f"{row * STEP:.0f} s", (x[-1], z[-1]), (0, -12), textcoords="offset points", ha="center")
    axes.set(xlabel="x [m]", title=title, aspect="equal")
    if labelled:
        axes.margins(0.12)


def beside_motion(positions, every, title):
    """A figure with side views of a motion, one for each `every` rows, and the axes to its right."""
    figure, (left, right) = panels(1, 2, size=MEDIUM, width_ratios=(2, 3))
    draw_motion(left, positions, every, title)
    left.set(ylabel="height [m]")
    return figure, right


def draw_race(title, runs):
    """Figure of what `race` found, error over computing time on logarithmic axes."""
    figure, axes = panels()
    for name, values in runs.items():
        curve(axes, *(values * (1e3, 1.0)).T, name, marker="o", markersize=4, color=SOLVER_COLOUR[name])
    axes.set(xscale="log", yscale="log", xlabel="computing time [ms]", ylabel="largest error [m]", title=title)
    axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.xaxis.set_major_formatter("{x:g}")
    axes.xaxis.set_minor_locator(NullLocator())
    return figure


def animation(movie):
    """Animation of a movie, with the way of the last node."""
    every = round(movie.speed / (FRAMES_PER_SECOND * STEP))
    rows = np.arange(0, len(movie.positions), every)
    axis = (0, 1, 2) if movie.in_space else (0, 2)
    points = movie.positions[:, :, axis].transpose(0, 2, 1)  # (rows, coordinates, nodes)
    figure = plt.figure(figsize=(4.5, 4.5))  # a layout engine would double the time of a frame
    axes = figure.add_subplot(projection="3d" if movie.in_space else None)
    low, high = points.min(axis=(0, 2)), points.max(axis=(0, 2))
    margin = 0.05 * (high - low).max()
    limits = dict(zip(("xlim", "ylim", "zlim"), zip(low - margin, high + margin, strict=True), strict=False))
    axes.set(**limits, **dict(zip(("xlabel", "ylabel", "zlabel"), [f"{'xyz'[i]} [m]" for i in axis], strict=False)))
    axes.set_aspect("equal")
    if movie.ground is not None:
        axes.axhline(movie.ground, color=GROUND, linewidth=2.5, zorder=0.5)
    (way,) = axes.plot(*points[0, :, -1:], color="lightgray")
    (chain,) = axes.plot(*points[0], "o-", color="black", markersize=4)

    def draw(row):
        for line, data in ((way, points[: row + 1, :, -1].T), (chain, points[row])):
            line.set_data_3d(*data) if movie.in_space else line.set_data(*data)
        axes.set_title(f"{movie.title}, {row * STEP:4.1f} s")

    return FuncAnimation(figure, draw, frames=rows, interval=1e3 * every * STEP / movie.speed, repeat=False)


def save_movie(film, name, given):
    """Write an animation as GIF, or as a page that keeps its frames in a folder; returns the paths."""
    if film is None:
        print(f"{name} has no animation", file=sys.stderr)
        return []
    now(f"drawing the frames of {name}")
    rate = round(1e3 / film.event_source.interval)
    writers = {}
    if given.animate:
        writers[given.out / f"{name}.gif"] = PillowWriter(rate)
    if given.save_frames:
        writers[given.out / f"{name}.html"] = HTMLWriter(rate, embed_frames=False, default_mode="once")
    for path, writer in writers.items():
        film.save(path, writer, dpi=DPI)
    return [*writers, *([given.out / f"{name}_frames"] if given.save_frames else [])]


def choose_backend(show):
    """Make figures without a display unless they are shown; WrongUse if they cannot be shown here."""
    if not show:
        matplotlib.use("Agg")
    elif plt.get_backend().lower() in ("agg", "cairo", "pdf", "pgf", "ps", "svg", "template"):
        raise WrongUse(f"--show needs a display and a library for windows; matplotlib has only {plt.get_backend()} here")


def parse(arguments, prog, about):
    """Command line options of a lesson."""
    parser = Parser(prog=prog, description=about.partition("\n")[0])
    option = parser.add_argument
    parser.add_out()
    option("--show", action="store_true", help="open figure and animation in windows")
    option("--animate", action="store_true", help="write the animation as GIF (of 05, 06, 08, 11 and 12)")
    option("--save-frames", action="store_true", help="write the animation as HTML page with its frames in a folder")
    return parser.parse_args(arguments)


def command_line(lesson, module=None):
    """Function of (arguments, prog) that runs a lesson, prints its answer and writes what it draws.

    If the lesson's file is the script that Python runs, the function is called at once and its status ends the program.

    module : of the lesson, None: where it is defined.
    """
    module = module or sys.modules[lesson.__module__]
    name = Path(module.__file__).stem

    @command
    def main(arguments=None, prog=None):
        given = parse(arguments, prog, module.__doc__)
        choose_backend(given.show)
        now(f"running {name}")
        found = lesson()
        given.out.mkdir(parents=True, exist_ok=True)
        written = [given.out / f"{name}.png"]
        found.figure.savefig(written[0], dpi=DPI)
        save = given.animate or given.save_frames
        film = animation(found.movie) if found.movie and (given.show or save) else None  # lives as long as its window
        if save:
            written += save_movie(film, name, given)
        print(f"{name}: {found.answer}; {speed(found)} ({', '.join(map(str, written))})")
        if given.show:
            plt.show()
        plt.close("all")

    if lesson.__module__ == "__main__":
        sys.exit(main())
    return main


def speed(found):
    """How long it took, in words."""
    return f"{found.simulated:.3g} s in {1e3 * found.seconds:.3g} ms, {found.simulated / found.seconds:.3g} times real time"
