"""The scene advisor: the cheapest configuration that meets the requirements of a scene, with evidence.

Every flight is charged by `runs.cost`, counted work times unit costs, so that a scene always gets the same advice. The total
cost of all flights is bounded; results that are then still unknown are reported as such.
"""

from math import ceil, inf, sqrt

import numpy as np

from tetherfmu.console.progress import now
from tetherfmu.files.scene_files import flown_from, load_for_advice
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.plausibility import GROUND_IGNORED, SENTENCES, UNDER
from tetherfmu.runtime.variants import TABLE
from tetherfmu.study.measuring.errors import converged, worst
from tetherfmu.study.measuring.runs import Config, fmu_of, least_cost
from tetherfmu.study.measuring.tables import page, percent

from .configurations import CLEARLY, SEGMENTS, TOLERANCES, advice_on, ladder, measure, steps
from .fixed_step_advice import advise_fixed, explain_fixed
from .reasons import numbers, reasons

BUDGET, FAST_BUDGET = 15.0, 0.7  # of all flights for an advice [s], of the machine of costs.csv
HANDLING, HANDLING_OF_STEP = 2e-3, 1.5e-6  # overhead of a flight and of each step outside the kernel [s]
PART_OF_FINER = 0.6  # of the budget: maximum for the finer model
PART_OF_CHECK = 0.125  # of the allowed error: maximum for the finer model
CHECK_SEGMENTS = 1.8  # of the finer model to begin with: this over the root of the allowed error
CHECK_STEP = 0.017  # its communication step to begin with [s], about
FIRST_SEGMENTS = 11  # of the search
MOST_SHAKING = 0.5  # [m/s2] by noise of positions: below it is not mentioned
_, _, ANY_DEPTH = SENTENCES[GROUND_IGNORED].partition("}")  # the part of the sentence after the depth


class Search:
    """Configurations that were flown in a scene against a finer model, within a budget [s].

    Looked for is the allowed error, or if the finer model is not that good, twice its own error.
    """

    def __init__(self, scene, finer, budget):
        self.scene, self.finer, self.budget, self.left = scene, finer, budget, budget - finer.spent
        self.own = finer.own_error(scene.wanted.outputs)
        self.limit = max(scene.wanted.allowed_error, 2.0 * self.own)
        self.points, self.stopped = {}, False

    def part(self, point):
        """Error of a `Measured` over the one looked for [-], the finer model's own error included."""
        return (point.error(self.scene.wanted.outputs) + self.own) / self.limit

    def fly(self, config):
        """`part` of a configuration; infinite if it would cost too much, except the first one."""
        if config not in self.points:
            duration = self.scene.duration
            handling = HANDLING + HANDLING_OF_STEP * duration / config.step
            if self.points and handling + least_cost(self.scene, config) * duration > self.left:
                self.stopped = True
                return inf
            point = self.points[config] = measure(self.scene, config, self.finer.run.flown)
            self.left -= handling + point.cost * duration
        return self.part(self.points[config])

    def is_too_coarse(self, config):
        """Whether a tether of this kind that is not coarser in any respect was clearly wrong.

        Not for the quasi-steady tether: few segments may compensate for the omissions of its model.
        """
        return any(
            done.variant == config.variant != "quasi_steady"
            and done.segments >= config.segments
            and done.tolerance <= config.tolerance
            and done.step <= config.step
            and self.part(point) > CLEARLY
            for done, point in self.points.items()
        )

    def least_that_does(self):
        """Least cost per simulated second of a sufficient configuration [-], infinite if there is none."""
        return min((point.cost for point in self.points.values() if self.part(point) <= 1.0), default=inf)

    def refine(self):
        """Refine a coarse dynamic tether until it suffices, by more segments or shorter steps, whichever helps more."""
        segments, choices = SEGMENTS[SEGMENTS.index(FIRST_SEGMENTS) :], steps(self.scene)
        part = self.fly(Config("dynamic", segments[0], TOLERANCES[-1], choices[0]))
        while part > 1.0:
            finer = [(segments[1:], choices)] * (len(segments) > 1) + [(segments, choices[1:])] * (len(choices) > 1)
            parts = [self.fly(Config("dynamic", more[0], TOLERANCES[-1], shorter[0])) for more, shorter in finer]
            part = min(parts, default=inf)
            if part == inf:
                return
            segments, choices = finer[parts.index(part)]

    def cheaper(self):
        """Try cheaper candidates: tethers without nodes at the shortest step first, then all from the cheapest on."""
        costs = {config: least_cost(self.scene, config) for config in ladder(self.scene)}
        for variant in (each.name for each in TABLE if not each.has_nodes):
            mine = [each for each in costs if each.variant == variant and costs[each] < self.least_that_does()]
            if mine:
                self.fly(min(mine, key=lambda each: each.step))
        for config in sorted(costs, key=lambda each: (costs[each], each.tolerance)):
            if costs[config] >= self.least_that_does() or self.stopped:
                return
            if not self.is_too_coarse(config):
                self.fly(config)


def finer_model(scene, budget):
    """`Reference` that an advice is measured against, within a budget [s]."""
    allowed = scene.wanted.allowed_error
    first = max(4, 2 * ceil(0.5 * CHECK_SEGMENTS / sqrt(allowed)))
    while first > 4 and 4.0 * least_cost(scene, Config("dynamic", first, 0.0, CHECK_STEP)) * scene.duration > budget:
        first = max(4, 2 * (first // 4))
    return converged(scene, PART_OF_CHECK * allowed, scene.wanted.outputs, first, CHECK_STEP, budget)


def advise(scene, budget=BUDGET):
    """`Advice` for a scene, by flying it; its flights cost about the budget at most [s]."""
    search = Search(scene, finer_model(scene, PART_OF_FINER * budget), budget)
    search.refine()
    search.cheaper()
    points = list(search.points.values())
    good = [point for point in points if search.part(point) <= 1.0]
    chosen = min(good, key=lambda point: point.cost) if good else min(points, key=search.part)
    how = {"stopped": search.stopped, "budget": budget}
    return advice_on(chosen, points, search.finer, scene.wanted, scene.wanted.outputs, **how)


def is_of_ground(sentence):
    """Whether a sentence of `Run.implausible` equals the one of `hanging`, with any depth."""
    return sentence.endswith(ANY_DEPTH)


def lying(flown):
    """A text on the part of the tether on the ground in a flight; empty if none ever is."""
    lengths, lies = flown.of("tether_length"), flown.of("grounded_length")
    if not lies.any():
        return ""
    most = np.argmax(lies)
    return (
        f"the tether lies on the ground during {percent(np.mean(lies > 0.0))} of the flight, with up to {lies[most]:.3g} m "
        f"of its {lengths[most]:.3g} m"
    )


def hanging(scene, flown):
    """Sentences on a tether that hangs below a ground without contact while both of its ends are above."""
    if scene.ground.ground_contact == at.FLAT:
        return
    depth = scene.ground.ground_height - flown.shape[..., 2]
    below = np.where((depth[:, [0, -1]] <= 0.0).all(axis=1), depth.max(axis=1), 0.0)
    if below.max() > UNDER:
        yield (
            f"the tether hangs up to {below.max():.3g} m below ground.height, during {percent(np.mean(below > 0.0))} of the "
            'flight; with contact = "flat" in the table [ground] it lies on the ground'
        )


def explain(scene, advice):
    """Lines of text: recommendation, expected error, and reasons; `advice` is an `Advice`."""
    config, found = advice.point.config, numbers(scene, advice.finer.run.flown if scene.kite_is_free else None)
    finer, names = advice.finer.run, scene.wanted.outputs
    warnings = [*hanging(scene, finer.flown), *(line for line in finer.implausible if not is_of_ground(line))]
    simpler = () if scene.kite_is_free else reasons(config, found, scene.wanted.allowed_error)
    flown = sorted(advice.points, key=lambda point: point.error(names), reverse=True)
    best = {point.config.variant: point for point in flown}  # the last of each: that with the least error
    why_not = [(*each, best.get(each[0])) for each in simpler]
    facts = {"numbers": found, "reasons": why_not, "worst": worst, "lying": lying(finer.flown), "warnings": warnings}
    facts |= {"fmu": fmu_of(scene, config), "part_of_check": PART_OF_CHECK, "fast_budget": FAST_BUDGET}
    facts["most_shaking"] = MOST_SHAKING
    return page("advice/advice.txt.j2", scene=scene, advice=advice, **facts).rstrip("\n")


def advise_in_words(scene, budget=BUDGET):
    """`Advice` for a scene, of fixed steps where they are wanted, and its lines for people."""
    if not scene.wanted.fixed:
        advice = advise(scene, budget)
        return advice, explain(scene, advice)
    finer = finer_model(scene, PART_OF_FINER * budget)
    advice = advise_fixed(scene, finer, budget - finer.spent)
    return advice, explain_fixed(scene, advice)


def run(options):
    """Print the advice for a scene file; returns 1 if nothing meets its requirements."""
    scene = load_for_advice(options.scene, options.settings)
    if not options.fast:
        now(f"flying {scene.name} with candidates and a finer model")
    with flown_from(options.scene):
        advice, text = advise_in_words(scene, FAST_BUDGET if options.fast else BUDGET)
    print(text)
    return 0 if advice.met else 1
