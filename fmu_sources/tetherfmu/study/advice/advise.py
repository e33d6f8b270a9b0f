"""The scene advisor: the cheapest configuration that meets what a scene asks for, and the evidence for it.

`python -m tetherfmu.study advise SCENE`. It flies the scene with a finer model, then tries the configurations in the order
of what they cost at least, and takes the cheapest whose error against the finer model, plus the finer model's own error, is
allowed. `--fast` flies nothing but a coarse quasi-steady tether: see `forecast`.
"""

from math import ceil, inf, sqrt
from pathlib import Path
from typing import NamedTuple

from tetherfmu.runtime.variants import VARIANTS, class_name
from tetherfmu.study.measuring.converged import Reference, converged
from tetherfmu.study.measuring.runs import Config
from tetherfmu.study.measuring.tables import page, percent

from .forecast import GROUPS, MARGIN, group_error, least_cost, limit
from .numbers import numbers
from .tradeoff import SEGMENTS, Measured, ladder, measure, steps

TEMPLATE = Path(__file__).with_name("advice.txt.j2")
PART_OF_CHECK = 0.125  # of the allowed error: what the finer model may be wrong by
CHECK_SEGMENTS = 1.8  # of the finer model to begin with: this over the root of the allowed error
PROBE_SEGMENTS = 11
MEANINGS = {
    "weight": "weight/tension",
    "drag": "drag/tension",
    "slack": "length/distance - 1",
    "wave": "wave time x rate of the force",
}
HOPELESS = 3.0  # a communication step whose probe is wrong by so many times the allowed error is left out


class Advice(NamedTuple):
    """What to use."""

    point: Measured  # the advised configuration with its errors against the finer model
    finer: Reference
    expected: float  # error to expect: that against the finer model plus the finer model's own
    met: bool  # whether it is allowed
    tried: int  # configurations that were flown


def finer_model(scene):
    """The model to check with: refined until its own error is an eighth of the allowed one."""
    allowed = scene.wanted.allowed_error
    segments = 2 * ceil(0.5 * CHECK_SEGMENTS / sqrt(allowed))
    return converged(scene, PART_OF_CHECK * allowed, scene.wanted.outputs, max(4, segments))


def promising_steps(scene, finer):
    """Communication steps with which a dynamic tether comes near the allowed error."""
    allowed, names = scene.wanted.allowed_error, scene.wanted.outputs
    good = []
    for step in steps(scene):
        probe = measure(scene, Config("dynamic", PROBE_SEGMENTS, 1e-4, step), finer.run.flown)
        if probe.error(names) <= HOPELESS * allowed:
            good.append(step)
        if probe.error(names) <= 0.5 * allowed:  # shorter steps cost more and are not needed ...
            break
    return good + [step for step in steps(scene) if good and step < min(good)][:1]  # ... but for the next one


def advise(scene):
    """`Advice` for a scene, checked by flying it."""
    allowed, names = scene.wanted.allowed_error, scene.wanted.outputs
    finer = finer_model(scene)
    own = finer.own_error(names)
    good_steps = promising_steps(scene, finer) or steps(scene)[-1:]
    candidates = sorted((least_cost(scene, c), c) for c in ladder(scene) if c.step in good_steps)
    tried, good = [], []
    for least, config in candidates:
        if least >= min((point.cost for point in good), default=inf):
            break
        point = measure(scene, config, finer.run.flown)
        tried.append(point)
        if point.error(names) + own <= allowed:
            good.append(point)
    chosen = min(good, key=lambda point: point.cost) if good else min(tried, key=lambda point: point.error(names))
    return Advice(chosen, finer, chosen.error(names) + own, bool(good), len(tried))


def reason(config, found, level):
    """Words: why a tether is not enough, by the number that hurts it most."""
    group = max(GROUPS, key=lambda each: group_error(each, config, found))
    most = limit(group, config, found, level)
    value = f"{MEANINGS[group]} is {getattr(found, group):.2g}"
    if most == inf:
        return f"{value}, which never makes it wrong by {percent(level)}"
    return f"{value}; it makes it wrong by {percent(level)} from {most:.2g} on"


def reasons(config, found, level):
    """Why not a simpler tether, with as many segments: words by variant."""
    segments = {"quasi_steady": config.segments or SEGMENTS[-1]}
    simpler = VARIANTS[: VARIANTS.index(config.variant)]
    return {each: reason(Config(each, segments.get(each, 0), 0.0, config.step), found, level) for each in simpler}


def fast_enough(scene, point):
    """Words: whether it is as fast as asked, if that is asked."""
    asked = scene.wanted.real_time_factor
    enough = "as asked" if point.host_cost * asked <= 1.0 else "NOT as fast as asked"
    return f": {enough} ({asked:g} times)" if asked else ""


def explain(scene, advice):
    """Lines for people: what to use, what error to expect, and why; `advice` is an `Advice` or a `forecast.Fast`."""
    checked, allowed = isinstance(advice, Advice), scene.wanted.allowed_error
    config = advice.point.config if checked else advice.forecast.config
    found, level = (numbers(scene), allowed) if checked else (advice.numbers, MARGIN * allowed)
    facts = {"scene": scene, "advice": advice, "checked": checked, "config": config, "fmu": class_name(config.variant)}
    facts |= {"numbers": found, "meanings": MEANINGS, "reasons": reasons(config, found, level)}
    if checked:
        facts["speed"] = fast_enough(scene, advice.point)
    else:
        facts["counted"] = [f"{name} {percent(error)}" for name, error in advice.forecast.errors.items() if error > 1e-4]
    return page(TEMPLATE, **facts).rstrip("\n")
