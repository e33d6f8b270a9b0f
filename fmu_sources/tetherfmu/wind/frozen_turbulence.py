"""Frozen turbulence: a box of wind that the mean wind carries past the points of a tether.

    v(x, t) = U(z) e + R u(q),   q = R^T (x - o) - U t (1, 0, 0),   U(z) = U (z/h)^alpha

e direction of the mean wind, R rotates the axes of the box into space (e, left of it, up), o origin of the box at
t = 0, u its fluctuations, trilinear between the grid points. The whole box moves with the mean wind U at the
reference height h. A gust arrives at the distance d downwind d/U later.

A TurbSim box contains its mean wind: within its heights its numbers are the wind, and it moves with its own U. Beyond
them v = box + U(z) - U(z of the row that was read).

Outside. Periodic: the box is repeated along, across and upwards, n points on n spacings; the wind is also interpolated
between the last plane and the next first one. Refused: a sentence names the point outside. A box that its file declares
not periodic ends along the wind: a point beyond its ends is refused, unless the box is explicitly repeated.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from math import cos, sin
from typing import NamedTuple
from warnings import catch_warnings, warn

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tetherfmu.runtime.quantities import check, quantity

from .wind_boxes import LARGEST_SPACING, LARGEST_SPEED, MOST_POINTS, Box, WrongBox, open_box

PERIODIC, REFUSED, REPEATED = 1, 2, 3  # `outside`
OUTSIDE = {
    "periodic": "repeats the box in all directions, but refuses the step beyond the end of a file that is not periodic",
    "refused": "refuses the step",
    "repeated": "repeats the box in all directions, whatever its file says",
}
MAKE_IT_PERIODIC, REPEAT = 'make it periodic (in TurbSim UsableTime = "ALL")', "(outside = 3; in Python repeated=True)"
EDGE = 1e-9  # of a spacing: rounding at the faces of a box
BOTH = np.array((0, 1))[:, None, None]  # offsets from the lower to both neighbouring points
AXES = ("along the wind", "across the wind", "upwards")
SPAN = 10_000  # points per read from a box


class MeanWind(NamedTuple):
    """The mean wind: U [m/s] at the height h [m], direction in which it blows [rad, from x to y], exponent alpha [-].

    >>> MeanWind(8.0, reference_height=6.0, exponent=0.1).direction
    0.0
    """

    speed: float
    direction: float = 0.0
    reference_height: float = 10.0
    exponent: float = 0.0


@dataclass(frozen=True)
class Reading:
    """Interpretation of a box: treatment of points outside, and the grid of a Mann box, which its files lack."""

    outside: int = quantity(PERIODIC, "", "behaviour outside the box", choices=OUTSIDE)
    points_along: int = quantity(0, "", "of a Mann box: number of points along the wind, 0 for other files", 0, MOST_POINTS)
    points_across: int = quantity(0, "", "of a Mann box: number of points across the wind", 0, MOST_POINTS)
    points_upwards: int = quantity(0, "", "of a Mann box: number of points upwards", 0, MOST_POINTS)
    spacing_along: float = quantity(0.0, "m", "of a Mann box: spacing of its points along the wind", 0.0, LARGEST_SPACING)
    spacing_across: float = quantity(0.0, "m", "of a Mann box: spacing of its points across the wind", 0.0, LARGEST_SPACING)
    spacing_upwards: float = quantity(0.0, "m", "of a Mann box: spacing of its points upwards", 0.0, LARGEST_SPACING)

    __post_init__ = check


def turbulence(file, reading, mean, origin):
    """`FrozenTurbulence` of a file (None: the mean wind alone), interpreted by a `Reading`; WrongBox if it is invalid.

    mean : `MeanWind`.  origin : of the box [m], (3,).
    """
    points = (reading.points_along, reading.points_across, reading.points_upwards)
    spacing = (reading.spacing_along, reading.spacing_across, reading.spacing_upwards)
    box = open_box(file, points, spacing) if file else None
    with catch_warnings(action="ignore"):  # whoever reads it passes `doubts` on
        return FrozenTurbulence(mean, box, origin, reading.outside != REFUSED, reading.outside == REPEATED)


def profile(mean, height):
    """U(z) [m/s] at heights [m] (any shape); 0 at and below z = 0, unless it is uniform (alpha = 0)."""
    if mean.exponent == 0.0:
        return np.full(np.shape(height), mean.speed)
    return mean.speed * (np.maximum(height, 0.0) / mean.reference_height) ** mean.exponent


class FrozenTurbulence:
    """Wind at any point and time, from a box of turbulence that the mean wind carries along.

    Parameters
    ----------
    mean : MeanWind
        A box that contains a mean wind replaces its speed and height.
    box : wind.wind_boxes.Box or None
        Result of `open_box`; None: the mean wind only.
    origin : (3,) array
        Of the box [m].
    periodic : bool
        Whether the box is repeated in all directions; along the wind only if its file does not say that it is not periodic.
        Otherwise WrongBox names a point outside.
    repeated : bool
        Whether a periodic box is repeated along the wind, whatever its file says; a warning names the jump.

    Examples
    --------
    Wind at 11 points between the ends of a tether, at the start of each of 50 communication steps, for `fly`:

    >>> from tetherfmu import TetherDynamic, inputs_along
    >>> wind = FrozenTurbulence(MeanWind(8.0, exponent=0.1))
    >>> tether = TetherDynamic(wind_points=11)
    >>> at_points = wind.between([0.0], (0.0, 0.0, 0.0), (300.0, 0.0, 400.0), 11)
    >>> start = tether.initialize(wind_at=at_points[0])
    >>> flown = tether.fly(inputs_along(50, 0.02), 0.02, wind_at=np.repeat(at_points, 50, axis=0))
    """

    def __init__(
        self,
        mean: MeanWind,
        box: Box | None = None,
        origin: ArrayLike = (0.0, 0.0, 0.0),
        periodic: bool = True,
        repeated: bool = False,
    ):
        if box and box.mean:
            mean = mean._replace(speed=box.mean[0], reference_height=box.mean[1])
        self.mean, self.box, self.periodic, self.repeated = mean, box, periodic, repeated
        for doubt in self.doubts():
            warn(doubt, stacklevel=2)
        c, s = cos(mean.direction), sin(mean.direction)
        self._turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])  # R
        if box:
            self._first = (self._turn.T @ origin + box.first)[:, None]
            self._spacing = np.array(box.spacing)[:, None]
            self._points, self._strides = np.array(box.points)[:, None], np.array(box.strides)[:, None]
            self._offset, self._scale = np.array(box.offset)[:, None], np.array(box.scale)[:, None]
            self._rows = np.zeros(box.points[2])  # mean wind in each row of the box
            if box.mean:
                self._rows += profile(mean, self._first[2] + box.spacing[2] * np.arange(box.points[2]))

    def doubts(self) -> Iterator[str]:
        """Sentences on a box that is repeated although its file declares it not periodic."""
        if self.box and self.box.has_seam and self.periodic and self.repeated:
            length = self.box.points[0] * abs(self.box.spacing[0])
            yield (
                f"{self.box.file} says that it is not periodic, but it is repeated: the wind jumps every {length:.4g} m, or "
                f"{length / self.mean.speed:.4g} s; {MAKE_IT_PERIODIC}"
            )

    def at(self, time: float | NDArray, points: NDArray) -> NDArray:
        """Wind [m/s], array (K, 3), at a time [s], or one for each point (K,), and at points [m], array (K, 3).

        WrongBox if a point is outside a box that is not periodic, or if the box has an impossible number there.
        """
        if not self.box:
            wind = np.zeros((3, len(points)))
            wind[0] = profile(self.mean, points[:, 2])
            return (self._turn @ wind).T
        carried = self._turn.T @ points.T
        carried[0] -= self.mean.speed * time
        place = (carried - self._first) / self._spacing  # in spacings from the first point
        if not self.periodic or (self.box.has_seam and not self.repeated):
            self._refuse_outside(place, points, time)
        before = np.floor(place)
        part = place - before
        around = (before.astype(np.int64) + BOTH) % self._points
        shares = np.array((1.0 - part, part))
        wind = self._interpolated(around * self._strides, shares)
        wind[0] += self._mean_beyond(points[:, 2], place[2], around[:, 2], shares[:, 2])
        return (self._turn @ wind).T

    def between(self, time: ArrayLike, ground: ArrayLike, kite: ArrayLike, count: int) -> NDArray:
        """Wind [m/s] at points of equal distance from the ground end to the kite end, array (times, count, 3).

        time [s] (times,).  ground, kite : ends [m], (3,) or (times, 3).  count : of points. WrongBox as of `at`.
        """
        time, share = np.asarray(time, dtype=float), np.linspace(0.0, 1.0, count)[:, None]
        ground, kite = (np.broadcast_to(np.asarray(end, dtype=float), (len(time), 3))[:, None] for end in (ground, kite))
        found, span = np.empty((len(time), count, 3)), max(1, SPAN // count)
        for first in range(0, len(time), span):
            part = slice(first, first + span)
            points = ground[part] + share * (kite[part] - ground[part])
            found[part] = self.at(np.repeat(time[part], count), points.reshape(-1, 3)).reshape(points.shape)
        return found

    def _interpolated(self, ends, shares):
        """Trilinear velocity in the axes of the box (3, K).

        ends : index contributions of each axis for the lower and upper points (2, 3, K).
        shares : of both (2, 3, K).
        """
        number = ends[:, None, None, 0] + ends[None, :, None, 1] + ends[None, None, :, 2]  # (2, 2, 2, K)
        share = shares[:, None, None, 0] * shares[None, :, None, 1] * shares[None, None, :, 2]
        number, share = number.reshape(8, -1), share.reshape(8, -1)
        with np.errstate(invalid="ignore"):
            stored = np.einsum("cpk,pk->ck", np.array([each[number] for each in self.box.components], dtype=float), share)
        velocity = (stored - self._offset) / self._scale
        worst = velocity.ravel()[np.abs(velocity).argmax()]  # the first that is no number, if there is one
        if not abs(worst) <= LARGEST_SPEED:
            raise WrongBox(
                f"{self.box.file} has a wind of {worst:g} m/s; it must be at most {LARGEST_SPEED:g} m/s: is the file "
                "damaged, or of another kind?"
            )
        return velocity

    def _mean_beyond(self, height, place, rows, shares):
        """Mean wind [m/s] to be added to the box (K,); 0 within the heights of a box that contains it.

        rows : lower and upper (2, K).  shares : of both (2, K).
        """
        beyond = profile(self.mean, height)
        if self.box.mean:
            beyond -= (self._rows[rows] * shares).sum(axis=0)
            beyond[(place >= 0.0) & (place <= self.box.points[2] - 1)] = 0.0
        return beyond

    def _refuse_outside(self, place, points, time):
        """WrongBox if a place is outside, of a periodic box along the wind; one at a face is put onto it (modified)."""
        axes = slice(0, 1 if self.periodic else 3)
        last = self._points[axes] - 1
        place = place[axes]
        outside = (place < -EDGE) | (place > last + EDGE)
        if outside.any():
            axis, point = np.argwhere(outside)[0]
            when = np.broadcast_to(time, len(points))[point]
            travelled = self.mean.speed * when if axis == 0 else 0.0
            ends = self._first[axis, 0] + travelled + np.array((0, last[axis, 0])) * self._spacing[axis, 0]
            where = self._first[axis, 0] + travelled + place[axis, point] * self._spacing[axis, 0]
            why = (
                f". The file says that it is not periodic: {MAKE_IT_PERIODIC}, or repeat it {REPEAT}"
                if self.periodic
                else ""
            )
            named = ", ".join(f"{x:g}" for x in points[point])
            raise WrongBox(
                f"{self.box.file} does not reach the point ({named}) m at {when:g} s: {AXES[axis]} it is at {where:g} m; "
                f"the box is from {ends.min():g} to {ends.max():g} m; move its origin, use a larger box or a periodic one"
                f"{why}"
            )
        np.clip(place, 0.0, last, out=place)
