"""The advice in words: what to use, why, and what error to expect."""

from tetherfmu.study.measuring.flown_fmu import FMUS
from tetherfmu.study.measuring.runs import VARIANTS, Config

from .forecast import GROUPS, MARGIN, fast_advice, group_error, limit
from .scene_report import NAMES, factor, percent
from .tradeoff import SEGMENTS

MEANINGS = {
    "weight": "weight/tension",
    "drag": "drag/tension",
    "slack": "length/distance - 1",
    "wave": "wave time x rate of the force",
}


def use(config):
    """Lines: the FMU and its settings."""
    lines = [f"  use       {FMUS[config.variant]}.fmu"]
    if config.segments:
        lines.append(f"            segments = {config.segments}")
    if config.tolerance:
        lines.append(f"            relative_tolerance = {config.tolerance:g}")
    return [*lines, f"            communication step {1e3 * config.step:g} ms"]


def numbers_of(found):
    """Line: the dimensionless numbers."""
    values = [f"{meaning} {getattr(found, group):.2g}" for group, meaning in MEANINGS.items()]
    return f"  numbers   {', '.join(values)}, stretch {found.stretch:.2g}"


def reason(config, found, level):
    """Words: why a tether is not enough, by the number that hurts it most."""
    group = max(GROUPS, key=lambda each: group_error(each, config, found))
    most = limit(group, config, found, level)
    value = f"{MEANINGS[group]} is {getattr(found, group):.2g}"
    if most == float("inf"):
        return f"{value}, which never makes it wrong by {percent(level)}"
    return f"{value}; it makes it wrong by {percent(level)} from {most:.2g} on"


def reasons(config, found, level):
    """Lines: why not a simpler tether, with as many segments."""
    lines = []
    for variant in VARIANTS[: VARIANTS.index(config.variant)]:
        segments = 0 if variant in ("straight", "catenary") else config.segments or SEGMENTS[-1]
        text = reason(Config(variant, segments, 0.0, config.step), found, level)
        lines.append(f"  {'why not' if not lines else '':9} {NAMES[variant]}: {text}")
    return lines


def speed(scene, point):
    """Line: how fast that is, and whether it is as fast as asked."""
    asked = scene.wanted.real_time_factor
    text = f"  speed     {factor(point.cost)} times real time in the kernel, about {factor(point.host_cost)} through FMPy"
    if asked:
        enough = "as asked" if point.host_cost * asked <= 1.0 else "NOT as fast as asked"
        text += f": {enough} ({asked:g} times)"
    return text


def explain(scene, advice, found):
    """The checked advice, lines for people."""
    wanted, config = scene.wanted, advice.point.config
    lines = [f"Scene {scene.name}: {', '.join(wanted.outputs)} within {percent(wanted.allowed_error)}"]
    if not advice.met:
        lines.append("No configuration reaches that; the closest is")
    own, error = advice.finer.own_error(wanted.outputs), advice.point.error(wanted.outputs)
    expect = (
        f"  expect    an error of at most {percent(advice.expected)}: {percent(error)} measured against "
        f"{advice.finer.config.words()}, itself wrong by less than {percent(own)}; {advice.tried} configurations tried"
    )
    more = [numbers_of(found), *reasons(config, found, wanted.allowed_error), speed(scene, advice.point)]
    return "\n".join([*lines, *use(config), expect, *more])


def explain_fast(scene, advice=None):
    """The advice from numbers alone, lines for people; `advice` is that of `fast_advice`."""
    advice = advice or fast_advice(scene)
    allowed, chosen = scene.wanted.allowed_error, advice.forecast
    lines = [f"Scene {scene.name}: kite_force within {percent(allowed)}, from its numbers alone, not checked"]
    if not advice.met:
        lines.append("No configuration is forecast to reach half of that; the closest is")
    parts = ", ".join(f"{group} {percent(error)}" for group, error in chosen.errors.items() if error > 1e-4)
    expect = f"  expect    an error of about {percent(chosen.error)}: {parts or 'nothing above 0.01 %'}"
    return "\n".join(
        [
            *lines,
            *use(chosen.config),
            expect,
            numbers_of(advice.numbers),
            *reasons(chosen.config, advice.numbers, MARGIN * allowed),
        ]
    )
