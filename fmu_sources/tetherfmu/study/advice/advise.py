"""The scene advisor: the cheapest configuration that meets what a scene asks for, and the evidence for it."""

from math import ceil, inf, sqrt
from pathlib import Path

from tetherfmu.runtime.variants import VARIANTS, class_name
from tetherfmu.study.measuring.errors import converged
from tetherfmu.study.measuring.runs import Config, implausible
from tetherfmu.study.measuring.tables import page

from .forecast import GROUPS, MARGIN, Advice, group_error, least_cost, limit
from .numbers import numbers
from .tradeoff import SEGMENTS, ladder, measure, steps

TEMPLATE = Path(__file__).with_name("advice.txt.j2")
PART_OF_CHECK = 0.125  # of the allowed error: what the finer model may be wrong by
CHECK_SEGMENTS = 1.8  # of the finer model to begin with: this over the root of the allowed error
PROBE_SEGMENTS = 11
HOPELESS = 3.0  # a communication step whose probe is wrong by so many times the allowed error is left out


def promising_steps(scene, finer):
    """Communication steps with which a dynamic tether comes near the allowed error."""
    good = []
    for step in steps(scene):
        probe = measure(scene, Config("dynamic", PROBE_SEGMENTS, 1e-4, step), finer.run.flown)
        part = probe.error(scene.wanted.outputs) / scene.wanted.allowed_error
        if part <= HOPELESS:
            good.append(step)
        if part <= 0.5:  # shorter steps cost more and are not needed ...
            break
    return good + [step for step in steps(scene) if good and step < min(good)][:1]  # ... but for the next one


def advise(scene):
    """`Advice` for a scene, checked by flying it."""
    allowed, names = scene.wanted.allowed_error, scene.wanted.outputs
    finer = converged(scene, PART_OF_CHECK * allowed, names, max(4, 2 * ceil(0.5 * CHECK_SEGMENTS / sqrt(allowed))))
    own = finer.own_error(names)
    good_steps = promising_steps(scene, finer) or steps(scene)[-1:]
    tried, good = [], []
    for least, config in sorted((least_cost(scene, c), c) for c in ladder(scene) if c.step in good_steps):
        if least >= min((point.cost for point in good), default=inf):
            break
        tried.append(measure(scene, config, finer.run.flown))
        good = [point for point in tried if point.error(names) + own <= allowed]
    chosen = min(good, key=lambda point: point.cost) if good else min(tried, key=lambda point: point.error(names))
    return Advice(chosen.config, chosen.error(names) + own, bool(good), None, chosen, finer, len(tried))


def reasons(config, found, level):
    """Why not a simpler tether, with as many segments: triples of variant, number that hurts it most, its limit."""
    for variant in VARIANTS[: VARIANTS.index(config.variant)]:
        segments = (config.segments or SEGMENTS[-1]) if variant == "quasi_steady" else 0
        simpler = Config(variant, segments, 0.0, config.step)
        errors = {group: group_error(group, simpler, found) for group in GROUPS}
        group = max(errors, key=errors.get)
        yield variant, group, limit(group, simpler, found, level)


def explain(scene, advice):
    """Lines for people: what to use, what error to expect, and why; `advice` is an `Advice`."""
    found, level = numbers(scene), scene.wanted.allowed_error * (1.0 if advice.point else MARGIN)
    facts = {"numbers": found, "reasons": list(reasons(advice.config, found, level)), "level": level}
    text = page(TEMPLATE, scene=scene, advice=advice, fmu=class_name(advice.config.variant), **facts).rstrip("\n")
    return "\n".join([text, *(f"  warning   {each}" for each in implausible(scene, advice.config.step))])
