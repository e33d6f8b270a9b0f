"""Does the advisor keep its word? Its advice, measured against a finer reference than the one it used itself."""

from dataclasses import replace
from typing import NamedTuple

from tetherfmu.models import StepRefused
from tetherfmu.study.measuring.converged import converged
from tetherfmu.study.measuring.runs import Config

from .advise import advise
from .forecast import fast_advice
from .tradeoff import LEVELS, REFERENCE_ERROR, measure

NAMES = ("kite_force",)


class Verdict(NamedTuple):
    """An advice, and what is true; errors are of `kite_force` [-], infinite if the tether refused a step."""

    scene: str
    allowed: float
    config: Config
    expected: float  # by the advisor
    error: float  # against the finer reference
    cost: float  # time per simulated second [-]
    claimed: bool  # whether the advisor says that it is met
    fast_config: Config  # of `--fast`
    fast_error: float
    own_error: float  # of the finer reference

    @property
    def met(self):
        """Whether the advised configuration meets what was asked."""
        return self.claimed and self.error <= self.allowed

    @property
    def fast_met(self):
        """The same of the fast advice."""
        return self.fast_error <= self.allowed


def asking(scene, allowed):
    """The scene, asking for the force on the kite within an allowed error."""
    return replace(scene, wanted=replace(scene.wanted, outputs=NAMES, allowed_error=allowed))


def verdict(scene, reference):
    """`Verdict` on the advice for a scene."""
    advice, fast = advise(scene), fast_advice(scene)
    config, fast_config = advice.point.config, fast.forecast.config
    point, fast_point = (measure(scene, each, reference.run.flown) for each in (config, fast_config))
    return Verdict(
        scene.name,
        scene.wanted.allowed_error,
        config,
        advice.expected,
        point.error(NAMES),
        point.cost,
        advice.met,
        fast_config,
        fast_point.error(NAMES),
        reference.own_error(NAMES),
    )


def unseen(scene):
    """`Verdict` on a scene with the error that it asks for; None if no reference can be flown."""
    target = min(REFERENCE_ERROR, 0.1 * scene.wanted.allowed_error)
    try:
        return verdict(scene, converged(scene, target, NAMES))
    except StepRefused:
        return None


def at_all_levels(scene, reference):
    """Verdicts on a scene for each of the levels of the trade-off study."""
    return [verdict(asking(scene, level), reference) for level in LEVELS]
