"""A system: points, lines and shared winches, and their surroundings, described once.

`TetherSystem`, system files and system FMUs contain one; an FMU stores it as JSON.
"""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields
from functools import cached_property

from ..runtime.parameters import Environment, Ground, Solver, Tether, Winch
from ..runtime.quantities import quantities
from .lines import Line, Point
from .ordering import ordered
from .winches import CONTROL, SharedWinch, carriers_of, holding

HASH_DIGITS = 8  # hexadecimal: with them the name of a system has the 15 letters that a saved state has room for


def values_of(*records):
    """Values of all quantities of records, dict by name."""
    return {name: getattr(record, name) for record in records for name, _ in quantities(record)}


@dataclass(frozen=True)
class System:
    """Consistent points, lines and shared winches, with the common quantities of all lines.

    wind_points : number of wind inputs per portion of a line; 0 for none.  shape_points : per portion; None
    is one at each node.  shares : for each winch pairs of a line and its share of the payout, see `wiring/winches.py`.
    starts : equilibrium positions [m] of free points without a position, dict by name.
    """

    name: str
    points: tuple
    lines: tuple
    environment: Environment = field(default_factory=Environment)
    solver: Solver = field(default_factory=Solver)
    ground: Ground = field(default_factory=Ground)
    winches: tuple = ()
    wind_points: int = 0
    shape_points: int | None = None
    shares: tuple = ()
    starts: Mapping = field(default_factory=dict)

    @cached_property
    def _order(self):
        free, band = ordered([point.name for point in self.points if not point.is_driven], self.lines)
        return tuple(free), band

    @property
    def free(self):
        """Names of the free points in the order of their matrix, a tuple."""
        return self._order[0]

    @property
    def band(self):
        """Band of the matrix of the free points, see `ordering.py`."""
        return self._order[1]

    @cached_property
    def free_names(self):
        """The names in `free` as a set, which is searched in the same time for any number of points."""
        return frozenset(self.free)

    @cached_property
    def carriers(self):
        """Names of the lines whose arrays contain the drums of winches, dict by the names of force-controlled winches."""
        return carriers_of(self.winches)

    def holding(self, line):
        """The shared winches that drive a line with this name."""
        return holding(self.winches, line)

    def shape_points_of(self, line):
        """Number of points in the shape of a line or a portion; in FMUs all portions of a line have as many."""
        return sum(each.segments for each in line.tethers) + 1 if self.shape_points is None else self.shape_points

    def position_of(self, point):
        """Where a point is at the start [m], None if that is to be found."""
        return point.position or self.starts.get(point.name)

    def winch_of(self, line):
        """The `Winch` of a line: its own, or one with the control of its shared winches, and the drum that it carries."""
        held = self.holding(line.name)
        carried = next((each for each in held if self.carriers.get(each.name) == line.name), None)
        return carried.drum if carried else Winch(winch_control=CONTROL[held[0].control]) if held else line.winch

    @cached_property
    def hash(self):
        """Text of 15 letters that distinguishes systems with incompatible states."""
        facts = [[(point.name, not point.is_driven) for point in self.points], list(self.free), self.band]
        facts.append([(line.name, line.start, line.end, self.shape_points_of(line)) for line in self.lines])
        if self.wind_points:
            facts.append([self.wind_points for _ in self.lines])
        if self.winches:
            facts.append([(each.name, each.input, each.ratios) for each in self.winches])
        if any(line.through for line in self.lines):
            facts.append([line.through for line in self.lines])
        return f"system_{hashlib.sha256(json.dumps(facts).encode()).hexdigest()[:HASH_DIGITS]}"


def in_json(system):
    """JSON representation of a `System`, a dict; subclass records are reduced."""
    own = {each.name for each in fields(System)}
    return {name: value for name, value in asdict(system).items() if name in own}


def system_from(given):
    """`System` of its facts."""
    kinds = {"environment": Environment, "solver": Solver, "ground": Ground}
    found = {**given, **{name: kind(**given[name]) for name, kind in kinds.items()}}
    lines = ({**each, "tether": Tether(**each["tether"]), "winch": Winch(**each["winch"])} for each in given["lines"])
    found |= {"points": tuple(Point(**each) for each in given["points"]), "lines": tuple(Line(**each) for each in lines)}
    return System(**found | {"winches": tuple(SharedWinch(**each) for each in given["winches"])})
