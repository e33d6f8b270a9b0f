"""Does the advisor keep its word? Its advice, measured against a finer reference than the one it used itself."""

from dataclasses import replace
from typing import NamedTuple

from tetherfmu.models import StepRefused
from tetherfmu.study.measuring.converged import converged

from .advise import Advice, advise
from .forecast import fast_advice
from .tradeoff import LEVELS, REFERENCE_ERROR, Measured, measure

NAMES = ("kite_force",)


class JudgedAdvice(NamedTuple):
    """An advice for the force on the kite, and what is true."""

    scene: str
    allowed: float  # error [-]
    advice: Advice  # without its finer model
    point: Measured  # the advised configuration against a finer reference than the advisor's own
    fast: Measured  # the configuration of the fast advice against the same
    own_error: float  # of that reference

    @property
    def met(self):
        """Whether the advice says so and its configuration meets what was asked."""
        return self.advice.met and self.point.error(NAMES) <= self.allowed

    @property
    def fast_met(self):
        """Whether the configuration of the fast advice meets it."""
        return self.fast.error(NAMES) <= self.allowed


def asking(scene, allowed):
    """The scene, asking for the force on the kite within an allowed error."""
    return replace(scene, wanted=replace(scene.wanted, outputs=NAMES, allowed_error=allowed))


def judged(scene, reference):
    """`JudgedAdvice` on the advice for a scene."""
    advice = advise(scene)._replace(finer=None)
    configs = advice.point.config, fast_advice(scene).forecast.config
    points = (measure(scene, config, reference.run.flown) for config in configs)
    return JudgedAdvice(scene.name, scene.wanted.allowed_error, advice, *points, reference.own_error(NAMES))


def unseen(scene):
    """`JudgedAdvice` on a scene with the error that it asks for; None if no reference can be flown."""
    target = min(REFERENCE_ERROR, 0.1 * scene.wanted.allowed_error)
    try:
        return judged(scene, converged(scene, target, NAMES))
    except StepRefused:
        return None


def at_all_levels(scene, reference):
    """`JudgedAdvice` on a scene for each of the levels of the trade-off study."""
    return [judged(asking(scene, level), reference) for level in LEVELS]
