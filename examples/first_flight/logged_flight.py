"""Which forces does a tether put on a kite along a flight from a log, and on the ground station?

The log is a CSV file. Its header row names the time [s] and inputs of the FMU, as `kite_position[1]` [m]; z is up.

    python examples/first_flight/logged_flight.py examples/scenes/logged_flight.csv --length 220.3 --html

Ends. Between the rows the ends of the tether follow smooth curves through their positions. Their velocities are those of the
file or, where it has none, of the curves; so the tether starts in flight, without a jolt. It is driven as in
`circular_flight.py`.

Winch. It follows the speed, the unstretched length or the force that the file has a column for. With a length the tether
starts with the first one. With a force it follows from the balance at the winch, from the start on or from --length on.
Otherwise set the length with --length.

Everything else is as the FMU has it; unless it was built otherwise, the winch stands still and there is no wind. Build one
for your tether (`tetherfmu build TetherDynamic --diameter 0.008`), or set parameters for this flight only
(`--set drag_coefficient=1.1`).
"""

import sys
from pathlib import Path

import numpy as np

from tetherfmu.console.ending import command
from tetherfmu.console.options import Parser
from tetherfmu.files.toml_files import WrongUse
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.inputs import by_name
from tetherfmu.runtime.parameters import Tether, Winch

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # the folder of the rooms
from first_flight.circular_flight import (
    FLAT,
    STARTS,
    add_options,
    co_simulate,
    flight_of,
    fly_each,
    outputs_of,
    show,
    with_release,
)
from shared.fmu_tools import running, variables_of
from shared.named_fmu import NamedFmu
from shared.settings import add_settings, setting_but

LOG = "FLIGHT.csv"
ROUNDING = 1e-6  # of a duration [s], from a log in Unix time
DECIDED = {  # parameters that nobody can --set: what they follow from
    "winch_start": f"--length or the columns of {LOG}",
    "initial_length": f"--length or the columns of {LOG}",
    "initial_shape": "--start",
    "ground_contact": "--ground",
    "winch_control": f"the columns of {LOG}",
    "end_velocities": f"{LOG}: its curves have velocities",
}
setting = setting_but(DECIDED)  # of the option --set
COLUMNS = (
    "CSV file with the columns time, kite_position[1], kite_position[2] and kite_position[3]; optional columns are "
    "kite_velocity, ground_position, ground_velocity, wind_velocity and release, and one of reel_out_speed, winch_length, "
    "winch_force"
)


def scene_of(path, length=None, wind=None, duration=None, step=0.02):
    """The flight of a CSV file as a `Scene` whose inputs are those of communication steps of `step` [s].

    length [m] : of the tether, unstretched, where the file has none.  wind [m/s] : where the file has none, three numbers.
    duration [s] : None for all of the flight.  WrongUse says in one line what is missing, or given twice.
    """
    from tetherfmu.files.scene_files import Scene, Wind  # needs the extra `study`
    from tetherfmu.files.series import Series

    try:
        flight = Series(Path(path))
    except ValueError as error:
        raise WrongUse(str(error)) from None
    for problem in problems(flight, length, wind, duration):
        raise WrongUse(f"{path}: {problem}")
    air = flight.wind or Wind(tuple(wind or (0.0, 0.0, 0.0)))
    try:
        tether, winch = tether_and_winch(flight, length)
        scene = Scene(Path(path).stem, duration or flight.duration, flight, tether, wind=air, winch=winch, every=step)
    except ValueError as error:
        raise WrongUse(f"{path}: {error}") from None
    if scene.count == 0:
        raise WrongUse(f"the flight of {scene.duration:g} s is shorter than a communication step of {step:g} s")
    return scene


def tether_and_winch(flight, length):
    """`Tether` and `Winch` of a flight; without any length [m] the one at which the force of the winch is in balance."""
    if length is None and flight.initial_length is None:
        start = flight.motion(0.0)
        distance = float(np.linalg.norm(start.kite - start.ground))  # where the search begins
        return Tether(initial_length=distance), Winch(winch_start="equilibrium")
    return Tether(initial_length=flight.initial_length if length is None else length), Winch()


def problems(flight, length, wind, duration):
    """What is missing beside the file of a flight, or given there and by an option, texts."""
    if flight.has_length and length is not None:
        yield f"has a column of the length, which begins with {flight.initial_length:g} m; omit --length"
    if not flight.has_length and not flight.has_force and length is None:
        yield "has no column winch_length (or tether_length); give the unstretched length at the start with --length"
    if flight.wind and wind is not None:
        yield "has columns of wind_velocity; omit --wind"
    if duration and duration > flight.duration + ROUNDING:
        yield f"has a flight of {flight.duration:g} s; --duration is {duration:g} s, it must be at most that"


def given_inputs(flight, has_wind):
    """Names of the inputs that a tether gets along a flight; the others keep the start values of its FMU."""
    has_ground = "ground_position[1]" in flight.columns
    is_given = {
        "kite_position": True,
        "kite_velocity": True,
        "ground_position": has_ground,
        "ground_velocity": has_ground,
        "reel_out_speed": flight.has_length or flight.has_force or "reel_out_speed" in flight.columns,
        "winch_length": flight.has_length,
        "winch_force": flight.has_force,
        "wind_velocity": has_wind,
    }
    return [name for name, given in is_given.items() if given]


def parameters_of(scene, start="quasi_steady", ground=False):
    """Dict name -> value of the parameters that a scene and two options decide.

    start : a key of `STARTS`.  ground : whether a flat ground, where the ground station is at first, carries the tether.
    """
    from tetherfmu.study.measuring.runs import winch

    found = {"initial_length": scene.tether.initial_length, "initial_shape": STARTS[start]}
    found |= {name: winch(scene)[name] for name in ("winch_control", "winch_start")} | {"end_velocities": at.GIVEN}
    if ground:
        found |= {"ground_contact": FLAT, "ground_height": float(scene.flight.motion(0.0).ground[2])}
    return found


def fly(fmu_file, scene, inputs, parameters):
    """Fly a scene with a tether FMU; returns the `Flight`.

    scene : of `scene_of`.  inputs : names of those that the tether gets, see `given_inputs`.  parameters : dict name ->
    value, an integer where the parameter of the FMU is one.
    """
    step, columns = scene.every, by_name(scene.inputs(scene.every))
    rows = np.hstack([columns[name] for name in inputs]).tolist()
    variables = variables_of(fmu_file)
    outputs = outputs_of(variables)
    moved = variables.of(*inputs)
    with running(fmu_file, variables.description) as (fmu, stop_if_pressed):
        fmu.setupExperiment(startTime=0.0)
        NamedFmu(variables, fmu).set(**variables.completed(parameters))
        fmu.enterInitializationMode()
        motion = with_release(fmu, variables, rows, columns["release"])
        given, wall_time = co_simulate(fmu, moved, outputs, motion, step, len(rows), stop_if_pressed)
        fmu.terminate()
    return flight_of(step * np.arange(len(rows) + 1), given, outputs, wall_time)


def parser_of(prog, circle=False):
    """Parser of the command line.

    circle : whether it is that of `tetherfmu fly`, where the file may be left out, or be a scene.
    """
    what = "a circle, a scene, or the flight of a CSV file," if circle else "the flight of a CSV file"
    parser = Parser(prog=prog, description=f"fly a kite along {what} and plot its tether")
    option = parser.add_argument
    length, duration = f"required if {LOG} has no length column", f"default: all of {LOG}"
    about = "start value of an FMU parameter; may be repeated (default: from the FMU)"
    if circle:
        scene = "a scene or a system, by its file (TOML) or a name from --list, or a"
        option("log", nargs="?", metavar="FLIGHT", help=f"{scene} {COLUMNS} (default: fly the circle)")
        option("--list", action="store_true", help="list the included scenes and systems, and exit")
        length, duration = f"{length}; default on the circle: 525", "default: all of FLIGHT, one turn on the circle"
        about = f"{about}; with a scene also any value of its file, such as tether.diameter='5 mm'"
    else:
        option("log", metavar=LOG, help=COLUMNS)
    add_options(parser, rate=circle, length=length, wind=f"default: from {LOG}, or none", duration=duration)
    add_settings(parser, None if circle else DECIDED, about)
    parser.set_defaults(length=None, rate=None, wind=None, **({"start": None, "step": None} if circle else {}))
    return parser


def say_noise(path, flight):
    """Say on stderr if the kite is shaken by what is hardly its motion."""
    from tetherfmu.study.advice.scene_advice import MOST_SHAKING

    if flight.shaking > MOST_SHAKING:
        print(
            f"{path}: the positions scatter by about {flight.scatter:.2g} m from row to row, which shakes the kite with "
            f"{flight.shaking:.2g} m/s2; smooth each column of positions first",
            file=sys.stderr,
        )


@command
def main(arguments=None, prog=None):
    """Fly, print a line on each flight, write the figures, print where they are."""
    given = parser_of(prog).parse_args(arguments)
    scene = scene_of(given.log, given.length, given.wind, given.duration, given.step)
    say_noise(given.log, scene.flight)
    for doubt in scene.doubts():
        print(f"{given.log}: {doubt}", file=sys.stderr)
    inputs = given_inputs(scene.flight, scene.flight.wind or given.wind is not None)
    parameters = parameters_of(scene, given.start, given.ground) | dict(given.settings)
    flights = fly_each(given, lambda fmu_file: fly(fmu_file, scene, inputs, parameters), parameters)
    title = f"Tether along the flight of {Path(given.log).name}"
    show(flights, given, scene.name, title, parameters["ground_height"] if given.ground else None)


if __name__ == "__main__":
    sys.exit(main())
