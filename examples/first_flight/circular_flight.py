"""Which forces does a tether put on a kite that flies a circle, and on the ground station?

The kite flies one turn on a cone, 500 m from the ground station, on a tether 5 % longer than that. This script is the
importer: it moves the kite, and drives the tether, an FMU, step by step through FMPy.

    python examples/first_flight/circular_flight.py --wind 8 0 0 --html

Exchange. In a communication step of length h the tether gets position p and velocity v of the kite at the *start* of the
step; its outputs belong to the *end* of the step. Within the step its kite end moves on a smooth curve to the
predicted position p + v h + a h^2/2, with the acceleration a estimated from the last two velocities; the error of its forces
is of second order in h. A kite model that feels the force has only the one from the end of the step before: it gets it
one communication step late. This flight path is prescribed; with a kite model of your own, keep h well below the time in
which its motion answers to a change of the force.

Start. The tether starts turning with the kite. `--start static_equilibrium` starts it at rest while the kite already flies:
the jolt, 274 N at the ground in still air instead of 46 N, is damped out within some ten seconds.
"""

import argparse
import sys
from functools import partial
from pathlib import Path
from time import perf_counter
from typing import NamedTuple

import numpy as np

from tetherfmu.console.ending import command
from tetherfmu.console.options import Parser, file, folder, names, new_file, number
from tetherfmu.console.progress import now
from tetherfmu.files.toml_files import WrongUse
from tetherfmu.runtime.plausibility import LARGEST_STRETCH
from tetherfmu.runtime.variants import VARIANTS, class_name, variant_of
from tetherfmu.study.measuring import flight_table

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # the folder of the rooms
from shared.fmu_tools import FlightEnded, FMICallException, find_fmu, refuse_different, running, variables_of
from shared.named_fmu import NamedFmu
from shared.settings import add_settings

TETHERS = {variant: class_name(variant) for variant in reversed(VARIANTS)}  # those with driven ends
SHOWN = ("ground_force", "kite_force", "shape")  # outputs
OF_POWER = ("ground_tension", "winch_speed")  # outputs that the power at the winch is made of
FLAT, STATION = 2, 0.0  # `ground_contact`, height of the ground with it [m]
STARTS = {"static_equilibrium": 1, "quasi_steady": 2, "straight": 3}
GROUND = -50.0  # its height [m]: the station stands on a hill, and the tether hangs down to 34 m below it
DECIDED = {  # parameters that nobody can --set: what they follow from
    "initial_length": "--length",
    "initial_shape": "--start",
    "ground_contact": "--ground",
    "ground_height": "--ground",
    "winch_control": "the circle: its winch stands still",
    "winch_start": "the circle: its winch stands still",
    "end_velocities": "the circle, which gives them",
}
DISTANCE, HALF_ANGLE, TILT = 500.0, np.radians(10.0), np.radians(70.0)
TURN = np.array([[1, 0, 0], [0, np.cos(TILT), -np.sin(TILT)], [0, np.sin(TILT), np.cos(TILT)]])


class Flight(NamedTuple):
    """What a flight gave, SI units: one row per communication point, the first at the start.

    An output that the FMU does not have is None: `tetherfmu build --scene` leaves out what its scene does not ask for.
    """

    time: np.ndarray  # (rows,)
    ground_force: np.ndarray | None  # (rows, 3), of the tether on the ground station
    kite_force: np.ndarray | None  # (rows, 3), of the tether on the kite
    shape: np.ndarray | None  # (rows, points, 3), ground first, kite last
    wall_time: float  # of all communication steps
    columns: dict = {}  # noqa: RUF012 (never modified) - all outputs, and `time`, by name, arrays (rows,)
    refusal: str = ""  # why it ended early


def circle(time, rate):
    """Position [m] and velocity [m/s] of the kite: a turn at `rate` [rad/s] about an axis 20 deg above the horizon."""
    radius, cos, sin = DISTANCE * np.sin(HALF_ANGLE), np.cos(rate * time), np.sin(rate * time)
    position = TURN @ (radius * cos, radius * sin, DISTANCE * np.cos(HALF_ANGLE))
    return position, TURN @ (-radius * rate * sin, radius * rate * cos, 0.0)


def co_simulate(fmu, inputs, outputs, motion, step, count, stop_if_pressed):
    """Initialize the tether and do `count` communication steps; returns rows of outputs and the wall time [s].

    inputs : value references of what the tether is given, as position and velocity of the kite.  outputs : what is read,
    `fmu_tools.Outputs`.  motion : function of k, values of the inputs at the start of step k.  stop_if_pressed : for Ctrl-C.
    """
    fmu.setReal(inputs, motion(0))
    fmu.exitInitializationMode()
    rows = [outputs.read(fmu)]
    started = perf_counter()
    for k in range(count):
        # 1. The kite at the start of the step. A kite model would move here, under the force in rows[-1].
        given = motion(k)
        # 2. The tether gets it, and goes to the end of the step; FMPy raises if it refuses the step.
        fmu.setReal(inputs, given)
        try:
            fmu.doStep(k * step, step)
        except FMICallException as error:
            error.flown = step * np.arange(k + 1), np.array(rows), outputs, perf_counter() - started
            raise
        # 3. Its forces and its shape at the end of the step, the time (k + 1) step.
        rows.append(outputs.read(fmu))
        stop_if_pressed()
    return np.array(rows), perf_counter() - started


def fly(
    fmu_file,
    length=525.0,
    rate=0.05,
    wind=(0.0, 0.0, 0.0),
    step=0.02,
    duration=None,
    start="quasi_steady",
    *,
    ground=False,
    parameters=(),
):
    """Fly the circle with a tether FMU; returns the `Flight`.

    length [m] : of the tether, unstretched.  rate [rad/s] : of the turn.  wind [m/s].  step [s] : communication step.
    duration [s] : None for one turn.  start : a key of `STARTS`, how the tether is at the start.
    ground : whether a flat ground at the height of the ground station carries the tether.
    parameters : pairs (name, value) of others of the FMU.
    """
    duration = duration or 2.0 * np.pi / rate
    count = round(duration / step)
    if count == 0:
        raise WrongUse(f"the flight of {duration:g} s is shorter than a communication step of {step:g} s")

    def motion(k):
        return np.concatenate(circle(k * step, rate))

    variables = variables_of(fmu_file)
    inputs, outputs = variables.of("kite_position", "kite_velocity"), outputs_of(variables)
    with running(fmu_file, variables.description) as (fmu, stop_if_pressed):
        fmu.setupExperiment(startTime=0.0)
        fmu.setReal(variables.of("initial_length", "ground_height"), [length, STATION if ground else GROUND])
        fmu.setInteger(variables.of("initial_shape"), [STARTS[start]])
        if ground:
            fmu.setInteger(variables.of("ground_contact"), [FLAT])
        NamedFmu(variables, fmu).set(**variables.completed(dict(parameters)))
        fmu.enterInitializationMode()
        if any(wind):
            fmu.setReal(variables.of("wind_velocity"), wind)  # an input that is set once stays
        rows, wall_time = co_simulate(fmu, inputs, outputs, motion, step, count, stop_if_pressed)
        fmu.terminate()
    return flight_of(step * np.arange(count + 1), rows, outputs, wall_time)


def with_release(fmu, variables, rows, released):
    """Function of k, values of the inputs at the start of step k, which first lets the tether go where that is asked for.

    rows : of the inputs.  released : whether it is let go, of each row; None: never.
    """
    reference = [] if released is None or not np.any(released) else variables.of("release")

    def motion(k):
        if reference and released[k]:
            fmu.setBoolean(reference, [True])
        return rows[k]

    return motion


def outputs_of(variables):
    """`fmu_tools.Outputs` of an FMU; WrongUse if it has none that a `Flight` has a field for."""
    if not variables.those_of(*SHOWN):
        raise WrongUse(f"{variables.file} has none of the outputs {', '.join(SHOWN)}")
    return variables.outputs(SHOWN)


def shortened(flight, refusal):
    """A `Flight` that ended early, with the reason; RuntimeError if it has no step."""
    if len(flight.time) < 2:
        raise RuntimeError(refusal)
    return flight._replace(refusal=f"{refusal}; the results end at {flight.time[-1]:.6g} s")


def raise_refusal(flights):
    """RuntimeError if one of the flights, dict by name, ended early."""
    for flight in flights.values():
        if flight.refusal:
            raise RuntimeError(flight.refusal)


def flight_of(time, rows, outputs, wall_time):
    """`Flight` of the values of its outputs, array (rows, values)."""
    columns = {"time": time, **dict(zip(outputs.names, rows.T, strict=True))}
    vectors = {name: [column for each, column in columns.items() if each.partition("[")[0] == name] for name in SHOWN}
    found = {name: np.stack(each, -1).reshape(len(rows), -1, 3) for name, each in vectors.items() if each}
    ground, kite = (found[name][:, 0] if name in found else None for name in SHOWN[:2])
    return Flight(time, ground, kite, found.get("shape"), wall_time, flight_table.with_power(columns))


def summary(name, flight):
    """One line on a flight: largest forces, communication steps, times real time."""
    forces = {"|ground|": flight.ground_force, "|kite|": flight.kite_force}
    largest = [f"{end} {np.linalg.norm(force, axis=1).max():.1f} N" for end, force in forces.items() if force is not None]
    count, speed = len(flight.time) - 1, flight.time[-1] / flight.wall_time
    at_most = f"{', '.join(largest)} at most; " if largest else ""
    return f"{name}: {at_most}{count} steps; {speed:.0f} times real time"


def tether(text):
    """A variant of the tether by any of its names, or "all"."""
    try:
        return text if text == "all" else variant_of(text, VARIANTS, ", or all")
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


def parse(arguments, prog):
    """Command line options."""
    parser = Parser(prog=prog, description="fly a kite on a circle and plot its tether")
    add_options(parser)
    add_settings(parser, DECIDED, "start value of a parameter of the FMU; may be repeated (default: those of the FMU)")
    return parser.parse_args(arguments)


def about(length, rate, wind):
    """What the circle is, and what its forces are, in one line; arguments as of `fly`."""
    speed = rate * DISTANCE * np.sin(HALF_ANGLE)
    air = f"wind of {np.linalg.norm(wind):g} m/s" if any(wind) else "still air"
    line = f"circle: {DISTANCE:g} m away at {speed:.3g} m/s in {air}, on a tether of {length:g} m"
    strain = DISTANCE / length - 1.0
    said = " that sags: it pulls with its weight and drag only" if strain < 0.0 else ""
    if strain > LARGEST_STRETCH - 1.0:
        said = f", stretched by {100.0 * strain:.3g} %, where any rope is broken"
    return f"{line}{said}. Taut flights: tetherfmu fly --list"


def add_options(
    parser, rate=True, length="default: 525", wind="default: none", duration="default: one turn", *, of_a_circle=True
):
    """Add what can be chosen for a flight.

    rate : whether that of the turn can be, too.  length, wind, duration : what holds of them unless they are given.
    of_a_circle : whether length, wind, start and ground can be chosen; a scene has its own.
    """
    option = parser.add_argument
    allowed = ", ".join(TETHERS)
    option("--tether", type=tether, metavar="NAME", help=f"tether FMU: {allowed}, or all (default: dynamic)")
    option("--fmu", type=file, metavar="FILE", help="your own tether FMU instead, for FMI 2 or 3")
    about = "folder of the tether FMUs, built there if missing (default: dist/, or else your cache)"
    option("--fmus", type=folder, metavar="DIR", help=about)
    option("--step", type=number(1e-6, 1e3, "s"), default=0.02, metavar="H", help="communication step [s] (default: 0.02)")
    option("--duration", type=number(1e-6, 1e6, "s"), metavar="T", help=f"duration of the flight [s] ({duration})")
    if of_a_circle:
        add_circle(parser, rate, length, wind)
    parser.add_out("the figures")
    option("--html", action="store_true", help="also write an interactive page (needs plotly)")
    add_results(parser)


def add_results(parser):
    """Add what can be chosen for the results."""
    option = parser.add_argument
    option("--csv", type=new_file, metavar="FILE", help="also write the outputs as a table (CSV, SI units)")
    about = "columns of --csv: variables or vectors, separated by commas (default: all but shape)"
    option("--outputs", type=names, metavar="NAME,...", help=about)
    about = "time before which table and summary leave out all [s] (default: 0)"
    option("--from", dest="begin", type=number(0.0, unit="s"), default=0.0, metavar="T", help=about)


def report(columns, given):
    """Print what people report of flights, and write the table that the options ask for.

    columns : of each flight, dict by name.
    """
    if given.outputs and not given.csv:
        raise WrongUse("--outputs chooses columns of --csv; it requires --csv")
    columns = {name: flight_table.since(each, given.begin) for name, each in columns.items()}
    for name, each in columns.items():
        for line in (*([f"{name}:"] if len(columns) > 1 else []), *flight_table.summary(each)):
            print(f"  {line}")
    if given.csv:
        found = next(iter(columns.values()))
        if len(columns) > 1:
            found = flight_table.beside_one_another(columns)
        flight_table.write_csv(flight_table.chosen(found, given.outputs), given.csv)
        print(given.csv)


def add_circle(parser, rate, length, wind):
    """Add what can be chosen for a circle or a log; arguments as of `add_options`."""
    option = parser.add_argument
    option(
        "--length",
        type=number(1e-3, 1e5, "m"),
        default=525.0,
        metavar="L",
        help=f"unstretched length of the tether [m] ({length})",
    )
    if rate:
        about = "turn rate [rad/s] (default: 0.05)"
        option("--rate", type=number(1e-9, 1e3, "rad/s"), default=0.05, metavar="G", help=about)
    option(
        "--wind",
        type=number(unit="m/s"),
        nargs=3,
        default=[0.0] * 3,
        metavar=("WX", "WY", "WZ"),
        help=f"wind at the reference height [m/s] ({wind})",
    )
    about = "initial shape of the tether (default: quasi_steady)"
    parser.add_choice("--start", STARTS, default="quasi_steady", help=about)
    option("--ground", action="store_true", help="flat ground at station height supports the tether")


def report_missing(fmu_file, flight, html):
    """Say on stderr which outputs an FMU does not have; WrongUse if the page needs them."""
    missing = [name for name in SHOWN if getattr(flight, name) is None]
    unknown = [name for name in OF_POWER if name not in flight.columns]
    if len(unknown) == 1:  # an FMU without both was built for other things
        print(f"{fmu_file} has no output {' and no '.join(unknown)}: no power", file=sys.stderr)
    if html and "shape" in missing:
        raise WrongUse(f"{fmu_file} has no output shape, which --html shows; build it with --shape-points 21")
    if missing:
        print(f"{fmu_file} has no output {' and no '.join(missing)}: not shown", file=sys.stderr)


def write_figures(flights, folder, ground=None):
    """Write three figures to a folder; returns their paths, none if matplotlib is missing.

    ground : its height [m], where there is one.
    """
    try:
        from shared.flight_figures import plot_first_shape, plot_forces, plot_shapes
    except ImportError:
        print("no figures: they need matplotlib (pip install matplotlib)", file=sys.stderr)
        return []
    drawn = {
        "first_shape": partial(plot_first_shape, ground=ground),
        "forces": plot_forces,
        "shapes": partial(plot_shapes, ground=ground),
    }
    if any(flight.shape is None for flight in flights.values()):
        del drawn["first_shape"], drawn["shapes"]
    if all(flight.kite_force is None and flight.ground_force is None for flight in flights.values()):
        del drawn["forces"]
    paths = [folder / f"{name}.png" for name in drawn]
    for path, plot in zip(paths, drawn.values(), strict=True):
        plot(flights).savefig(path, dpi=150)
    return paths


def fly_each(given, fly, parameters, names=None, find=find_fmu):
    """Fly each FMU that the options `given` ask for, and print a line on each; returns a dict name -> `Flight`.

    fly : function of the path of an FMU, its `Flight`.  parameters : names of those that are set; WrongUse if the tethers
    differ in others.  names : of the FMUs; None: those of --tether.  find : function of a name and the folder of --fmus, the
    path of an FMU.
    """
    if given.fmu and (given.fmus or given.tether):
        raise WrongUse("--fmu is the one FMU that is flown; it excludes --tether and --fmus")
    if given.html:
        import shared.flight_page  # noqa: F401 - before the flight, which would be in vain without plotly
    names = names or (TETHERS.values() if given.tether == "all" else [TETHERS[given.tether or "dynamic"]])
    flights, fmu_files = {}, [given.fmu] if given.fmu else [find(name, given.fmus) for name in names]
    if len(fmu_files) > 1:
        refuse_different(fmu_files, parameters)
    for fmu_file in fmu_files:
        now(f"flying {fmu_file}")
        try:
            flight = fly(fmu_file)
        except FlightEnded as end:
            flight = shortened(flight_of(*end.flown), str(end))
        report_missing(fmu_file, flight, given.html)
        flights[fmu_file.stem] = flight
        print(summary(fmu_file.stem, flight))
    return flights


def show(flights, given, name, title, ground):
    """Report the flights, write the figures, with the option --html the page of this name and title, too, and print where.

    ground : its height [m]; None: there is none.
    """
    report({name: flight.columns for name, flight in flights.items()}, given)
    given.out.mkdir(parents=True, exist_ok=True)
    now("drawing")
    written = write_figures(flights, given.out, ground)
    if given.html:
        from shared.flight_page import write_page

        written.append(given.out / f"{name}.html")
        path = next(iter(flights.values())).shape[:, -1]
        write_page(flights, written[-1], path, title=title, ground=ground)
    for path in written:
        print(path)
    raise_refusal(flights)


@command
def main(arguments=None, prog=None):
    """Fly, print a line on each flight, write the figures, print where they are."""
    given = parse(arguments, prog)
    scene = given.length, given.rate, given.wind, given.step, given.duration, given.start
    print(about(*scene[:3]))
    more = {"ground": given.ground, "parameters": given.settings}
    flights = fly_each(given, lambda fmu_file: fly(fmu_file, *scene, **more), dict(given.settings))
    title = "Tether of a kite that flies a circle"
    show(flights, given, "circular_flight", title, STATION if given.ground else None)


if __name__ == "__main__":
    sys.exit(main())
