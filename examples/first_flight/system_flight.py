"""Which forces do the lines of a system put on its points: a hoist with two winches, drones that carry a load, a bridle?

    tetherfmu fly hoist --set lines.rope_left.reel_out_speed=-0.1 --html
    python examples/first_flight/system_flight.py examples/systems/two_kites.toml --wind 8 0 0

The file says where the points are (docs/use/systems.md has its keys). Driven points stay there, or go straight on with their
`velocity`; free points go where lines, weight and wind take them; each line is paid out at its `reel_out_speed`. The system
is that of the Python API, whose numbers are those of its FMU.
"""

import sys
from dataclasses import replace
from pathlib import Path
from warnings import catch_warnings

import numpy as np

from tetherfmu import TetherSystem
from tetherfmu.console.colours import BLACK, coloured
from tetherfmu.console.ending import command
from tetherfmu.console.options import Parser, folder, number, setting
from tetherfmu.console.progress import now
from tetherfmu.files.toml_files import WrongUse
from tetherfmu.files.winds import Wind
from tetherfmu.records.problems import PlausibilityWarning, StepRefused
from tetherfmu.runtime import layout as at
from tetherfmu.study.measuring import flight_table

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # the folder of the rooms
from first_flight.circular_flight import Flight, add_results, report

COUNT, MOST_STEPS = 12, 1_000_000  # shapes that are drawn, communication steps whose rows are kept
OPTIONS = {"wind": "wind", "duration": "duration", "step": "wanted.communication_step"}  # and what --set has for them
IN_PLACE = {  # options of the circle: what a system has in their place
    "length": "--set lines.NAME.initial_length=L",
    "ground": "--set ground.contact=flat",
    "start": "its lines start as the solver of its file says",
    "rate": "its points go straight on with their velocity",
    "fmu": "it is flown by the Python API; tetherfmu build --system makes its FMU",
    "fmus": "it is flown by the Python API",
}
NOTE = "<p>Arrows: forces of the lines on their points.</p>\n"


def read(path, settings=()):
    """`SystemFlight` of a file (Path), and its `TetherSystem`; WrongUse says in one line what is wrong with it.

    settings : pairs of keys of the file, or of the flight, and values in their place.
    """
    from tetherfmu.study.measuring.system_flights import load  # needs the extra `study`, as `fly`

    flight = load(path, settings)
    found = flight.found
    try:
        options = {"winches": found.winches}
        return flight, TetherSystem(found.points, found.lines, found.environment, found.solver, found.ground, **options)
    except ValueError as error:
        raise WrongUse(f"{path}: {error}") from None


def fly(flight, system, wind=None, duration=None, step=None):
    """Fly a system of `read`: by name a `Flight` of each line, its start as ground end; positions of points; columns.

    wind [m/s] : at the reference height.  duration, step [s] : of the flight and of a communication step.  None : those of
    the `SystemFlight`, which has loads, too. Rows are those of `Flight`, the first at the start.
    """
    duration, step = duration or flight.duration, step or flight.wanted.communication_step
    count = round(duration / step)
    if count == 0:
        raise WrongUse(f"the flight of {duration:g} s is shorter than a communication step of {step:g} s")
    if count > MOST_STEPS:
        raise WrongUse(f"the flight of {duration:g} s has {count} communication steps; it may have {MOST_STEPS} at most")
    time = step * np.arange(count + 1)
    if wind is not None:
        others = {what: own for what, own in flight.series.items() if what != "wind_velocity"}
        flight = replace(flight, wind=Wind(tuple(wind)), series=others)
    with catch_warnings(action="ignore", category=PlausibilityWarning):  # `run` says them
        start = flight.start(system)
        flown, refusal = until_refused(system, count, step, flight.given(time[:-1]))
    time, flights = time[: 1 + len(next(iter(flown.outputs.values())))], {}
    for name, nodes in flown.positions.items():
        first, rows = start.lines[name], flown.outputs[name]
        forces = (np.vstack([getattr(first, end), rows[:, place : place + 3]]) for end, place in ENDS.items())
        shape = np.concatenate([first.shape[None], nodes]) if len(first.shape) == nodes.shape[1] else None
        flights[name] = Flight(time, *forces, shape, flown.seconds, refusal=refusal)
    places = {name: np.vstack([start.points[name].position, each.position]) for name, each in flown.points.items()}
    return flights, places, flight_table.with_power(flight_table.of_system(time, start, flown), system.winches)


def until_refused(system, count, step, given):
    """Fly a `TetherSystem` until all steps are done, or one is refused: its `SystemFlown`, and why it ended early or "".

    StepRefused if it is the first one.
    """
    try:
        return system.fly(count, step, **given), ""
    except StepRefused as refusal:
        if not refusal.flown or not len(next(iter(refusal.flown.outputs.values()))):
            raise
        return refusal.flown, str(refusal)


ENDS = {"ground_force": at.GROUND_FORCE, "kite_force": at.KITE_FORCE}


def summary(line, flight):
    """One line on a `Line` of a system: largest forces at its ends."""
    start, end = (np.linalg.norm(getattr(flight, each), axis=1).max() for each in ENDS)
    return f"{line.name}: |{line.start}| {start:.1f} N, |{line.end}| {end:.1f} N at most"


def draw(flights, places, ground):
    """Two figures by name: the lines in space along the flight, and the forces at the ends of each over time.

    ground : its height [m], where there is one.
    """
    from shared.flight_figures import NARROWEST, draw_ground_in_space, label_in_space, plt, ticks_in_space, widen, with_room

    shapes = plt.figure(figsize=(9.0, 6.0), layout="constrained")
    space = shapes.add_subplot(projection="3d")
    for name, flight, colour in coloured(flights):
        for k in np.linspace(0, len(flight.time) - 1, COUNT).astype(int):
            space.plot(*flight.shape[k].T, color=colour, linewidth=1.2, label=name if k == 0 else None)
    for path in places.values():
        space.plot(*path.T, color=BLACK, linewidth=1.8)
    least = NARROWEST * max(np.ptp(limits) for limits in (space.get_xlim(), space.get_ylim(), space.get_zlim()))
    for axis in "xyz":
        widen(space, axis, least)
    if ground is not None:
        draw_ground_in_space(space, ground)
    space.set(xlabel="x [m]", ylabel="y [m]", zlabel="z [m]", title="Lines and points along the flight")
    space.set_box_aspect([np.ptp(limits) for limits in (space.get_xlim(), space.get_ylim(), space.get_zlim())], zoom=0.92)
    ticks_in_space(space)
    space.legend(loc="upper left")
    label_in_space(space, {name: path[0] for name, path in places.items()})
    forces, panels = plt.subplots(2, 1, figsize=(8.5, 7.0), sharex=True, layout="constrained")
    for axes, field, end in zip(panels, ENDS, ("start", "end"), strict=True):
        for name, flight, colour in coloured(flights):
            axes.plot(flight.time, np.linalg.norm(getattr(flight, field), axis=1), color=colour, linewidth=1.3, label=name)
        axes.set(title=f"Force of each line at its {end}", ylabel="force [N]")
        axes.grid(alpha=0.3)
        with_room(axes)
    panels[0].legend(fontsize=8)
    panels[1].set_xlabel("time [s]")
    return {"shapes": shapes, "forces": forces}


def run(given):
    """Fly the system that the options name, print a line on each of its lines, write the figures, print where they are."""
    if getattr(given, "tether", None) not in (None, "dynamic"):
        raise WrongUse(f"--tether is {given.tether}; the lines of a system are dynamic")
    if given.html:
        import shared.flight_page  # noqa: F401 - before the flight, which would be in vain without plotly
    settings = list(map(setting, given.settings))
    for option, key in OPTIONS.items():
        if getattr(given, option) and any(name.startswith(key) for name, _ in settings):
            raise WrongUse(f"--{option} and --set {key} are both given; give one of them")
    flight, system = read(Path(given.log), settings)
    found = flight.found
    now(f"flying {given.log}")
    try:
        flights, places, columns = fly(flight, system, given.wind, given.duration, given.step)
    except StepRefused as refusal:
        raise WrongUse(f"{given.log}: this system cannot be flown: {refusal}") from None
    for sentence in system.implausible:
        print(f"{found.name}: {sentence}", file=sys.stderr)
    for line in found.lines:
        print(summary(line, flights[line.name]))
    seconds, time = flights[line.name].wall_time, flights[line.name].time
    print(f"{found.name}: {len(time) - 1} steps; {time[-1] / seconds:.0f} times real time")
    report({found.name: columns}, given)
    given.out.mkdir(parents=True, exist_ok=True)
    now("drawing")
    ground = found.ground.ground_height if found.ground.ground_contact == at.FLAT else None
    for name, figure in draw(flights, places, ground).items():
        path = given.out / f"{name}.png"
        figure.savefig(path, dpi=150)
        print(path)
    if given.html:
        from shared.flight_page import write_page

        path = given.out / f"{found.name}.html"
        write_page(flights, path, None, title=f"Lines of {found.name}", ground=ground, paths=places, note=NOTE)
        print(path)
    if refusal := flights[line.name].refusal:
        raise WrongUse(f"{given.log}: {refusal}; the results end at {time[-1]:.6g} s")


@command
def main(arguments=None, prog=None):
    """Fly, print a line on each line, write the figures, print where they are."""
    parser = Parser(prog=prog, description="fly a system of tethers and plot its lines")
    option = parser.add_argument
    option("log", metavar="SYSTEM", help="file of a system (TOML)")
    wind = {"type": number(unit="m/s"), "nargs": 3, "metavar": ("WX", "WY", "WZ")}
    option("--wind", **wind, help="wind at the reference height [m/s] (default: none)")
    option("--step", type=number(1e-6, 1e3, "s"), metavar="H", help="communication step [s] (default: 0.02)")
    option("--duration", type=number(1e-6, 1e6, "s"), metavar="T", help="of the flight [s] (default: 20)")
    about = "a value of the file, such as lines.rope.reel_out_speed=0.1, or wind.velocity and loads.NAME; may be repeated"
    option("--set", dest="settings", action="append", default=[], metavar="NAME=VALUE", help=about)
    option("--out", type=folder, default=Path("plots"), metavar="DIR", help="folder of the figures (default: plots)")
    option("--html", action="store_true", help="also write an interactive page (needs plotly)")
    add_results(parser)
    run(parser.parse_args(arguments))


if __name__ == "__main__":
    sys.exit(main())
