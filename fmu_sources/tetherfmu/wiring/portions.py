"""Portions of lines that run over sheaves: each is a line of its own for the kernels, between two points that follow."""

from dataclasses import replace
from typing import Any, NamedTuple

from ..runtime.inputs import wind_at_names


class Portion(NamedTuple):
    """A portion of a line, or a whole line without sheaves.

    line : the `lines.Line`.  number : from 0.  name : of the line; later
    portions have no variable names.  start, end : names of its points.  is_through : whether the line continues
    over a sheave at its end.  is_portion : whether it is only a part of the line.
    """

    line: Any
    number: int
    name: str
    start: str
    end: str
    is_through: bool
    is_portion: bool

    def wind_at_names(self, count):
        """Names of the wind at its wind points: the line numbers the points of its portions consecutively."""
        own = wind_at_names((self.number + 1) * count)[3 * self.number * count :]
        return tuple(f"{self.line.name}.{name}" for name in own)

    @property
    def tethers(self):
        """Its tethers in series: the first one of the line, which runs over all sheaves; in the last portion all of them."""
        if not self.is_through:
            return self.line.tethers
        return (replace(self.line.tethers[0], initial_length=self.line.initial_length),)

    @property
    def ends(self):
        """Pairs of the end of a tether, "ground" or "kite", and the point there."""
        return ("ground", self.start), ("kite", self.end)


def portions_of(line):
    """The `Portion` of a line in their order, a tuple."""
    stops = (line.start, *line.through, line.end)
    last = len(stops) - 2
    return tuple(
        Portion(line, k, f"{line.name}[{k + 1}]" if k else line.name, *stops[k : k + 2], k < last, last > 0)
        for k in range(last + 1)
    )


def all_portions(lines):
    """The portions of all lines, a tuple."""
    return tuple(portion for line in lines for portion in portions_of(line))


def joined(lines, values):
    """Lists of the values of the portions of each line, from the values of all portions in order."""
    given = iter(values)
    return [[next(given) for _ in portions_of(line)] for line in lines]
