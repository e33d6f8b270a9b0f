"""The advice in words."""

from .flown_fmu import FMUS
from .scene_report import percent


def explain(scene, advice):
    """Lines for people: what to use, what to expect."""
    config, wanted = advice.point.config, scene.wanted
    names = ", ".join(wanted.outputs)
    lines = [f"Scene {scene.name}: {names} within {percent(wanted.allowed_error)}"]
    if not advice.met:
        lines.append("No configuration reaches that; the closest is")
    lines.append(f"  use       {FMUS[config.variant]}.fmu")
    if config.segments:
        lines.append(f"            segments = {config.segments}")
    if config.tolerance:
        lines.append(f"            relative_tolerance = {config.tolerance:g}")
    lines.append(f"            communication step {1e3 * config.step:g} ms")
    own, found = advice.finer.own_error(wanted.outputs), advice.point.error(wanted.outputs)
    lines.append(
        f"  expect    an error of at most {percent(advice.expected)}: {percent(found)} measured against "
        f"{advice.finer.config.words()}, which is wrong by at most {percent(own)}"
    )
    return "\n".join(lines)
