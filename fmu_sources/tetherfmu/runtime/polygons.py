"""Detects polygonal input paths of an end, from importers that interpolate linearly between widely spaced rows.

If a step is 1/m of the row spacing, its displacement equals the one before, except for every m-th step, which is a corner.
The criterion: `CORNERS` corners in a row, always after the same number of steps, at least 2, with only rounding differences
in between. Smooth motion, noise and staircases never satisfy it. A motion whose corners agree with the given velocities is
intended.
"""

from math import dist, hypot

from . import layout as at

CORNERS = 8  # in a row
ROUNDING = 1e-11  # of a position, part of its magnitude
BENT = 1e-6  # a corner: relative change of the displacement; between this and rounding it is undecided
JUDGED = 400  # steps with motion, after which nothing is looked for any more
ALIKE = 1e-9  # steps with a smaller relative difference are equal

SENTENCE = (
    "{name} comes in polygons: it has a corner in every step number {period}, and is straight in between, as if rows were "
    "interpolated linearly; each corner jerks the tether: let the communication step be the spacing of the rows"
)


class Watch:
    """Looks at the positions of an end, step by step; `is_over` when it need look no more."""

    def __init__(self):
        self.is_over, self._judged = False, 0
        self.forget()

    def forget(self):
        """Begin anew, as after a saved state."""
        self._before, self._way, self._step = None, None, 0.0
        self._straight, self._period, self._corners = 0, 0, 0

    def period(self, position, velocity, step):
        """The number of steps from corner to corner, once it is known, and before that 0.

        position [m], velocity [m/s] : of the end at the start of the step [s], three numbers each.
        """
        before, way, last, straight = self._before, self._way, self._step, self._straight
        self._before, self._step, self._way = position, step, None
        if before is None:
            return 0
        now = self._way = tuple(new - old for new, old in zip(position, before, strict=True))
        length = hypot(*now)
        if length == 0.0 or way is None:
            return 0
        self._judged += 1
        self.is_over = self._judged > JUDGED
        bend, size = dist(now, way), hypot(*position)
        if abs(step - last) > ALIKE * step or (bend > ROUNDING * size and bend <= BENT * length):
            self._straight = self._corners = self._period = 0
        elif bend <= ROUNDING * size:
            self._straight = straight + 1
        else:
            explained = dist(now, tuple(last * each for each in velocity)) <= BENT * length
            regular = straight > 0 and straight + 1 == self._period and not explained
            self._corners, self._period, self._straight = (self._corners + 1 if regular else 0), straight + 1, 0
        self.is_over = self.is_over or self._corners >= CORNERS
        return self._period if self._corners >= CORNERS else 0


class Watched(Watch):
    """Checks the kite end of an `Instance` of one tether, whose steps it runs."""

    def __init__(self, instance):
        super().__init__()
        self._instance, self._found = instance, 0

    def advance(self, step):
        """One communication step [s]. Returns the problem, or None."""
        values = self._instance.values
        position, velocity = (tuple(values[first : first + 3]) for first in (at.KITE_POSITION, at.KITE_VELOCITY))
        self._found = self.period(position, velocity, step)
        return self._instance.advance(step)

    def sentences(self, name):
        """Messages after the last step about an input with this name, a tuple."""
        found, self._found = self._found, 0
        return (SENTENCE.format(name=name, period=found),) if found else ()
