"""Which forces does a tether put on its ends in a scene: a path, a wind, a winch, a ground, or a load that it moves?

    tetherfmu fly eight_on_a_winch --html
    python examples/first_flight/scene_flight.py examples/scenes/parked.toml --set wind.speed="12 m/s"

A scene is a file that `tetherfmu advise` and `tetherfmu sweep` read, too. The tether is an FMU, driven as in
`circular_flight.py`: in each communication step it gets the inputs that the scene has at the start of the step.
"""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

from tetherfmu.console.ending import command
from tetherfmu.console.options import Parser, setting
from tetherfmu.files.toml_files import WrongUse
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.inputs import by_name
from tetherfmu.runtime.parameters import DEFAULT_TOLERANCE, Tether
from tetherfmu.runtime.variants import DYNAMIC_FREE, class_name, variant_of

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # the folder of the rooms
from first_flight.circular_flight import add_options, co_simulate, flight_of, fly_each, outputs_of, show, with_release
from shared import cache
from shared.fmu_tools import OF_A_TETHER, constants_of, find_fmu, running, variables_of
from shared.settings import RECORD_OF, checked_value

STEP = 0.02  # communication step, where the scene does not say it [s]
IN_PLACE = {  # options of the circle: what a scene has in their place
    "length": "--set tether.initial_length=L",
    "wind": "--set 'wind.velocity=[WX, WY, WZ]'",
    "ground": "--set ground.contact=flat",
    "start": "tethers start as the scene has it",
    "rate": "--set flight.rate=G",
}
DECIDED = ("initial_shape", "end_velocities", "winch_control")  # parameters that follow from the scene


def settings_of(texts, duration=None):
    """Of texts NAME=VALUE the pairs of values of the file, and a dict of parameters that are not in it.

    duration [s] : another one than that of the scene.  WrongUse names a parameter that follows from the scene, or whose
    value is not possible.
    """
    pairs, others = [], {}
    for name, value in map(setting, texts):
        if name in DECIDED:
            raise WrongUse(f"--set: {name} follows from the scene")
        if name == "segments" or (name in RECORD_OF and RECORD_OF[name].__name__ == "Solver"):
            try:
                others[name] = checked_value(name, value)
            except ValueError as error:
                raise WrongUse(f"--set: {error}") from None
        else:
            pairs.append((name, value))
    return pairs + ([("duration", duration)] if duration else []), others


def scene_of(path, settings=(), step=None):
    """`Scene` of a file or of a name, whose inputs are those of communication steps of `step` [s]; WrongUse for a wrong one.

    settings : pairs of names and values in the place of those of the file.
    """
    from tetherfmu.files.scene_files import load  # needs the extra `study`

    scene = load(path, settings)
    step = step or scene.wanted.communication_step or STEP
    if scene.duration < step:
        raise WrongUse(f"the flight of {scene.duration:g} s is shorter than a communication step of {step:g} s")
    return replace(scene, every=step)


def fmu_of(name, place, wind_points):
    """Path of a tether FMU in a folder, or else one that is kept, with so many wind points; built if it is not there."""
    if not wind_points:
        return find_fmu(name, place)
    from tetherfmu.study.measuring.scene_fmus import fmus_in

    return fmus_in(place or cache.folder(), [variant_of(name)], wind_points)[name]


def fly(fmu_file, scene, others=()):
    """Fly a scene of `scene_of` with a tether FMU; returns the `Flight`.

    others : dict of parameters that no scene has.  An FMU may lack parameters, and inputs that stay as they are, as those of
    `tetherfmu build --scene` do; WrongUse if it has other values for them, and if it does not say which, a line on stderr.
    """
    from tetherfmu.study.measuring.runs import Config, parameters_of
    from tetherfmu.study.measuring.scene_fmus import inputs_of

    step, variables = scene.every, variables_of(fmu_file, scene.kite_is_free)
    parameters = parameters_of(scene, Config("dynamic", Tether.segments, DEFAULT_TOLERANCE, step)) | dict(others)
    without = {"wind_velocity"} if scene.wind_points else set()
    if parameters["end_velocities"] == at.DERIVED:
        without |= {"kite_velocity", "ground_velocity"}
    table = inputs_of(scene, step)
    vectors = {name: name.partition("[")[0] for name in table}
    moving = {vectors[name] for name in table if table[name].nunique() > 1}
    built_in = {each for each in vectors.values() if each not in moving and not variables.those_of(each)}
    without |= built_in
    constants = constants_of(fmu_file)
    check_constants(fmu_file, constants, parameters | table.iloc[0].to_dict())
    rows = table[[name for name, vector in vectors.items() if vector not in without]].to_numpy().tolist()
    moved = variables.of(*(each for each in dict.fromkeys(vectors.values()) if each not in without))
    outputs = outputs_of(variables)
    released = by_name(scene.inputs(step))["release"] if scene.flight.has_release else None
    with running(fmu_file, variables.description) as (fmu, stop_if_pressed):
        fmu.setupExperiment(startTime=0.0)
        parameters |= {"wind_profile": at.UNIFORM} if scene.wind_points else {}
        built_in |= set_parameters(variables, fmu, parameters)
        fmu.enterInitializationMode()
        motion = with_release(fmu, variables, rows, released)
        found, wall_time = co_simulate(fmu, moved, outputs, motion, step, len(rows), stop_if_pressed)
        fmu.terminate()
    if built_in and not constants:
        print(f"{fmu_file} keeps the values it was built with: {', '.join(sorted(built_in))}", file=sys.stderr)
    return flight_of(step * np.arange(len(rows) + 1), found, outputs, wall_time)


def check_constants(fmu_file, constants, values):
    """WrongUse if an FMU has another one of its constants for one of these values; both dicts by name."""
    for name, constant in constants.items():
        if name == "relative_tolerance":
            constant = constant or DEFAULT_TOLERANCE  # which 0 stands for
        if name in values and not np.isclose(values[name], constant, rtol=1e-9, atol=0.0):  # 12 digits of `build --scene`
            raise WrongUse(
                f"{fmu_file} has {name} = {constant:g} and no variable for it; it is {values[name]:g} in this scene: build "
                f"an FMU with it (--set {name}={values[name]:g}), or one that has the variable"
            )


def set_parameters(variables, fmu, parameters):
    """Set parameters of an FMU (modified), dict by name; names of those that it does not have, a set."""
    kinds = {each.name: each.type for each in variables.description.modelVariables}
    for name, value in parameters.items():
        if name not in kinds:
            continue
        is_real = kinds[name] in ("Real", "Float64")
        put = fmu.setReal if is_real else fmu.setInteger
        put([variables.reference[name]], [float(value) if is_real else int(value)])
    return {name for name in parameters if name not in kinds}


def names_of(scene, tether):
    """Names of the FMUs that can fly a scene, None for those of --tether; WrongUse if that one cannot."""
    if scene.flight.has_release and tether not in (None, "dynamic"):
        raise WrongUse(f"--tether is {tether}; {scene.name} lets its tether go, which dynamic tethers can")
    if not scene.kite_is_free:
        return None
    if tether not in (None, "dynamic"):
        raise WrongUse(f"--tether is {tether}; the free end of {scene.name} is moved by TetherDynamicFree only")
    return [class_name(DYNAMIC_FREE.name)]


def run(given):
    """Fly the scene that the options name, print a line on each flight, write the figures, print where they are."""
    pairs, others = settings_of(given.settings, given.duration)
    scene = scene_of(given.log, pairs, given.step)
    names = names_of(scene, given.tether)

    def find(name, place):
        return fmu_of(name, place, scene.wind_points)

    flights = fly_each(given, lambda fmu_file: fly(fmu_file, scene, others), OF_A_TETHER, names, find)
    ground = scene.ground.ground_height if scene.ground.ground_contact == at.FLAT else None
    show(flights, given, scene.name, f"Tether in the scene {scene.name}", ground)


@command
def main(arguments=None, prog=None):
    """Fly, print a line on each flight, write the figures, print where they are."""
    parser = Parser(prog=prog, description="fly a scene and plot its tether")
    parser.add_argument("log", metavar="SCENE", help="scene file (TOML), or a name of tetherfmu fly --list")
    add_options(parser, of_a_circle=False)
    option, about = parser.add_argument, "a value of the scene, or a parameter of the FMU; may be repeated"
    option("--set", dest="settings", action="append", default=[], metavar="NAME=VALUE", help=about)
    parser.set_defaults(step=None)
    run(parser.parse_args(arguments))


if __name__ == "__main__":
    sys.exit(main())
