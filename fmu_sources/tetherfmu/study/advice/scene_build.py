"""The FMU of one scene: the advised tether with the scene's values as start values, and no more variables than it needs."""

from dataclasses import replace

from tetherfmu.export.archive import SLAVES
from tetherfmu.export.build_options import BuildOptions, Purpose
from tetherfmu.files.lean import Lean
from tetherfmu.files.scene_files import flown_from, load_for_advice
from tetherfmu.study.measuring.flight_table import vector_of
from tetherfmu.study.measuring.runs import fmu_of, parameters_of
from tetherfmu.study.measuring.scene_fmus import inputs_of
from tetherfmu.study.measuring.tables import percent
from tetherfmu.wiring.system_variables import inputs_at
from tetherfmu.wiring.variables import CALCULATED, variables

from .scene_advice import advise_in_words
from .scene_report import body

VECTORS = {  # outputs of the FMU that an output of a scene is made of, where they are not the one of its name
    "kite_direction": {"kite_force"},
    "peak_force": {"kite_force"},
    "ground_direction": {"ground_force"},
    "power": {"kite_force", "ground_tension", "winch_speed"},
}
KEPT = inputs_at("kite", "winch")  # never omitted: the motion or load of the kite, and inputs for any `winch_control`
DIGITS = 12  # of start values: more are rounding


def needed(scene, inputs, table):
    """Names of the inputs that are nonzero in a scene, and of the calculated variables that it requires: two tuples.

    Vector elements have the name of the vector.  inputs : from `fmus.inputs_of`.  table : of the
    variables of its FMU.
    """
    moved = inputs.any().groupby(vector_of).transform("any")
    asked = set().union(*(VECTORS.get(each, {each}) for each in scene.wanted.outputs))
    asked |= set(KEPT)  # where they are outputs
    outputs = [variable.name for variable in table if variable.causality in CALCULATED]
    moving = dict.fromkeys(vector_of(name) for name in inputs if vector_of(name) in KEPT or moved[name])
    return tuple(moving), tuple(dict.fromkeys(vector_of(name) for name in outputs if vector_of(name) in asked))


def rounded(value):
    """A start value without the digits that are rounding."""
    return float(f"{value:.{DIGITS}g}") if isinstance(value, float) else value


def advised(path, shape_points, platforms, given=Lean()):  # noqa: B008 (a constant)
    """The advice for a scene file as text, whether it meets the requirements, the name of the FMU and its `BuildOptions`.

    shape_points : of the output `shape`, if the scene requires it.  platforms : as in `BuildOptions`.  given : `Lean`, whose
    lists override those of the file, which override the needs of the scene; its start values are settings of the scene.
    SceneError describes a problem of the file in one line, or why its scene fails.
    """
    scene = load_for_advice(path, given.starts)
    with flown_from(path):
        advice, text = advise_in_words(scene)
    config = advice.point.config
    points = shape_points if "shape" in scene.wanted.outputs else 0
    inputs = inputs_of(scene, config.step)
    name = fmu_of(scene, config)
    variant = SLAVES[name]
    table = variables(variant, points, wind_points=scene.wind_points)
    moving, asked = needed(scene, inputs, table)
    fixed = {"fixed_step": config.fixed_step} if scene.wanted.fixed else {}
    found = inputs.iloc[0].to_dict() | parameters_of(scene, config) | fixed
    starts = tuple((name, rounded(value)) for name, value in found.items())
    lean = replace(given, starts=()).over(scene.build.over(Lean(moving, asked, None, starts)))
    options = BuildOptions(config.segments or 1, points, platforms, lean, None, scene.wind_points)
    missing = ", ".join(dict.fromkeys(map(vector_of, lean.left_out(table)))) or "none"
    about = (
        f"For the scene {scene.name}: expected error of {', '.join(scene.wanted.outputs)} at most "
        f"{percent(advice.expected)} at a communication step of {1e3 * config.step:g} ms. Left out, and constant where it "
        f"is an input: {missing}."
    )
    page = body(f"# {scene.name}\n\n{about}\n\n```text\n{text}\n```")
    purpose = Purpose(scene.name, about, config.step, rounded(scene.duration), page)
    return f"{text}\n{about}", advice.met, name, replace(options, purpose=purpose)
