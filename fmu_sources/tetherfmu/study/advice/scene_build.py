"""The FMU of one scene: the advised tether with the scene's values as start values, and no more variables than it needs.

`python build_fmus.py --scene FILE`. An input that is 0 all through the scene is left out, and so is an output that it does
not ask for; the description says so.
"""

from dataclasses import asdict
from typing import NamedTuple

import numpy as np
from markdown import markdown

from tetherfmu.export.archive import Trim
from tetherfmu.models import StepRefused
from tetherfmu.runtime.variables import INPUT, OUTPUT, variables
from tetherfmu.study.measuring.flown_fmu import FMUS
from tetherfmu.study.scenes.files import SceneError, load
from tetherfmu.study.scenes.standard import QUASI_STEADY_START

from .advise import advise
from .advise_text import explain
from .numbers import numbers
from .scene_report import HTML, percent

__all__ = ["SceneError", "advised"]
VECTORS = {  # outputs of the FMU that an output of a scene is made of
    "kite_force": ("kite_force",),
    "kite_direction": ("kite_force",),
    "peak_force": ("kite_force",),
    "ground_force": ("ground_force",),
    "ground_direction": ("ground_force",),
    "power": ("kite_force", "ground_tension"),
    "shape": ("shape",),
}
KEPT = ("kite_position", "kite_velocity")


class Advised(NamedTuple):
    """What to build."""

    fmu: str
    segments: int
    shape_points: int
    trim: Trim
    text: str  # the advice
    met: bool


def still(scene, step):
    """Names of the inputs that are 0 all through a scene."""
    inputs = scene.inputs(step)
    table = [variable for variable in variables("dynamic", 0) if variable.causality == INPUT]
    groups = {}
    for variable in table:
        groups.setdefault(variable.name.partition("[")[0], []).append(variable)
    return [
        variable.name
        for group, members in groups.items()
        if group not in KEPT and not np.any(inputs[:, [member.place for member in members]])
        for variable in members
    ]


def unasked(scene, shape_points):
    """Names of the outputs that a scene does not ask for."""
    asked = {name for each in scene.wanted.outputs for name in VECTORS[each]}
    table = [variable for variable in variables("dynamic", shape_points) if variable.causality == OUTPUT]
    return [variable.name for variable in table if variable.name.partition("[")[0] not in asked]


def starts(scene, config):
    """Pairs (input or parameter, start value): those of the scene."""
    first = scene.inputs(config.step)[0]
    inputs = {
        variable.name: float(first[variable.place]) for variable in variables("dynamic", 0) if variable.causality == INPUT
    }
    parameters = {**asdict(scene.tether), **asdict(scene.environment), "segments": config.segments or 1}
    parameters |= {"relative_tolerance": config.tolerance, "initial_shape": QUASI_STEADY_START}
    return [[name, value] for name, value in (inputs | parameters).items()]


def groups_of(names):
    """Names of vectors instead of their elements, in words."""
    return ", ".join(dict.fromkeys(name.partition("[")[0] for name in names)) or "none"


def advised(path, shape_points):
    """`Advised` for a scene file.

    Raises
    ------
    SceneError
        In one line: what is wrong with the file, or why its scene cannot be flown.
    """
    scene = load(path)
    try:
        advice = advise(scene)
    except StepRefused as refusal:
        raise SceneError(f"{path}: this scene cannot be flown: {refusal}") from None
    config = advice.point.config
    points = shape_points if "shape" in scene.wanted.outputs else 0
    inputs, outputs = still(scene, config.step), unasked(scene, points)
    text = explain(scene, advice, numbers(scene))
    about = (
        f"For the scene {scene.name}: expected error of {', '.join(scene.wanted.outputs)} at most "
        f"{percent(advice.expected)} at a communication step of {1e3 * config.step:g} ms. Left out: inputs that are 0 in "
        f"the scene ({groups_of(inputs)}); outputs that it does not ask for ({groups_of(outputs)})."
    )
    page = HTML.format(
        title=scene.name, body=markdown(f"# {scene.name}\n\n{about}\n\n```text\n{text}\n```", extensions=["fenced_code"])
    )
    trim = Trim(scene.name, starts(scene, config), inputs + outputs, about, config.step, page)
    return Advised(FMUS[config.variant], config.segments or 1, points, trim, text, advice.met)
