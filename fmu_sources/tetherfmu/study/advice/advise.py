"""The scene advisor: the cheapest configuration that meets what a scene asks for, and the evidence for it.

`python -m tetherfmu.study advise SCENE`. It flies the scene with a finer model, then tries the configurations in the order
of what they cost at least, and takes the cheapest whose error against the finer model, plus the finer model's own error, is
allowed. `--fast` flies nothing but a coarse quasi-steady tether: see `forecast`.
"""

from math import ceil, sqrt
from typing import NamedTuple

from tetherfmu.study.measuring.converged import Reference, converged
from tetherfmu.study.measuring.runs import Config

from .forecast import least_cost
from .tradeoff import Point, ladder, measure, steps

PART_OF_CHECK = 0.125  # of the allowed error: what the finer model may be wrong by
CHECK_SEGMENTS = 1.8  # of the finer model to begin with: this over the root of the allowed error
PROBE_SEGMENTS = 11
HOPELESS = 3.0  # a communication step whose probe is wrong by so many times the allowed error is left out


class Advice(NamedTuple):
    """What to use."""

    point: Point  # the advised configuration with its errors against the finer model
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
        probe = measure(scene, Config("dynamic", PROBE_SEGMENTS, 1e-4, step), finer.run)
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
    best = closest = None
    tried = 0
    for least, config in candidates:
        if best and least >= best.cost:
            break
        point = measure(scene, config, finer.run)
        tried += 1
        if point.error(names) + own <= allowed and (best is None or point.cost < best.cost):
            best = point
        if closest is None or point.error(names) < closest.error(names):
            closest = point
    chosen = best or closest
    return Advice(chosen, finer, chosen.error(names) + own, best is not None, tried)
