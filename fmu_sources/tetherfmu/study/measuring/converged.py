"""The reference of a scene: the dynamic tether, refined in space and in time until its own error is small enough.

It is the only run that knows the mean reel-out speed of each step and the wind of its middle (`Scene.inputs`, exact).
"""

from functools import cache
from typing import NamedTuple

from .errors import errors, worst
from .runs import Config, Run, run

FIRST_SEGMENTS, MOST_SEGMENTS = 16, 256
LONGEST_STEP, SHORTEST_STEP = 0.004, 0.00025  # communication step [s], about
TOLERANCE = 1e-6


class Reference(NamedTuple):
    """A reference run and what is known of it."""

    config: Config
    run: Run
    space: dict  # change of each output against half of the segments
    time: dict  # change of each output against the double communication step and ten times the tolerance

    def own_error(self, names):
        """Bound of its own error in some outputs: both changes together; each is larger than what is left."""
        return worst(self.space, names) + worst(self.time, names)


def step_of(scene, wanted):
    """The longest step, not longer than wanted [s], of which an output interval is an even multiple."""
    parts = 2
    while scene.every / parts > wanted * (1.0 + 1e-9):
        parts += 2
    return scene.every / parts


def converged(scene, target, names, first_segments=FIRST_SEGMENTS):
    """`Reference` of a scene, refined until its `own_error` is at most `target` [-], or until the finest allowed.

    names : outputs that count, of `scenes.files.OUTPUTS`.  first_segments : to begin with; doubled as needed.
    """
    n, step = first_segments, step_of(scene, LONGEST_STEP)

    @cache
    def fly(segments, h, tolerance):
        return run(scene, Config("dynamic", segments, tolerance, h), exact=True)

    while True:
        finest = fly(n, step, TOLERANCE)
        space = errors(scene, fly(n // 2, step, TOLERANCE).flown, finest.flown)
        time = errors(scene, fly(n, 2.0 * step, 10.0 * TOLERANCE).flown, finest.flown)
        in_space, in_time = worst(space, names), worst(time, names)
        finer = 2 * n <= MOST_SEGMENTS, step / 2.0 >= SHORTEST_STEP
        if in_space + in_time <= target or not any(finer):
            return Reference(Config("dynamic", n, TOLERANCE, step), finest, space, time)
        if (in_space >= in_time and finer[0]) or not finer[1]:
            n *= 2
        else:
            step /= 2.0
