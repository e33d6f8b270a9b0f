"""Points and lines of a system, also over sheaves: user specifications, as constant records with their checks.

The Python API, files, FMUs and C tables read these.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

from ..runtime import layout as at
from ..runtime.naming import LONGEST_NAME, meant_or_all, names_checked, prefixed, shortened
from ..runtime.parameters import FreeKite, Tether, Winch
from ..runtime.quantities import Quantity, checked, quantities, quantity
from ..runtime.sheaves import SHEAVE_QUANTITIES

Vector = tuple[float, float, float]
LENGTH = Quantity("m", "a portion", minimum=0.0)
MASS = dict(quantities(FreeKite))["kite_mass"]


def given_in(form, unit="", default=None):
    """Field of a record without quantity: its form in files, "vector", "numbers", "list" or "names", and its unit."""
    return field(default=default, metadata={"form": form, "unit": unit})


def first_input(unit, meaning):
    """Field of a record for an input at the start."""
    return quantity(0.0, unit, meaning, -at.LARGEST_INPUT, at.LARGEST_INPUT)


def check_inputs(record, *names):
    """ValueError unless inputs at the start are allowed."""
    for name, declared in quantities(record):
        if name in names and not declared.allows(getattr(record, name)):
            raise ValueError(
                f"{record.name}.{name} is {getattr(record, name)!r}; it must be finite and at most {at.LARGEST_INPUT:g} in "
                "magnitude"
            )


def record_of(model, given, kind):
    """A record of this kind; TypeError for anything else."""
    if not isinstance(given, kind):
        name = kind.__name__
        an = "an" if name == "Environment" else "a"
        raise TypeError(f"{name.lower()} is {given!r}; it must be {an} {name}, as in {model}(..., {name.lower()}={name}())")
    return given


def vector(name: str, value: Sequence[float]) -> Vector:
    """Three finite numbers; ValueError otherwise."""
    try:
        found = (
            () if isinstance(value, str) or any(isinstance(each, Iterable) for each in value) else tuple(map(float, value))
        )
    except (TypeError, ValueError):
        found = ()
    if len(found) != 3:
        raise ValueError(f"{name} is {value!r}; it must be three numbers")
    if not all(abs(each) <= at.LARGEST_INPUT for each in found):  # NaN is not
        raise ValueError(f"{name} is {value!r}; its numbers must be finite and at most {at.LARGEST_INPUT:g} in magnitude")
    return found


def checked_name(kind: str, name: str) -> None:
    """TypeError or ValueError unless this is a name for a point, a line or a system."""
    if not isinstance(name, str):
        raise TypeError(f"the name of a {kind} is {name!r}; it must be a text")
    if not (name.isidentifier() and name.isascii() and len(name) <= LONGEST_NAME):
        raise ValueError(
            f"the name of a {kind} is {shortened(name)}; it must be letters from a to z, digits and underscores, no digit "
            f"first, at most {LONGEST_NAME} of them"
        )


@names_checked
@dataclass(frozen=True)
class Point:
    """A point where lines begin and end: driven by its inputs, or free with a mass. ValueError if a number is wrong.

    Parameters
    ----------
    name : str
        Letters, digits and underscores.
    position, velocity : (3,) array
        At the start [m], [m/s].  A free point without position (None) starts where it is in equilibrium.
    mass : float or None
        None: driven. Otherwise the point is free, with this mass [kg], at least 0, beside the halves of the segments that
        meet there. Gravity acts on it.

    Examples
    --------
    >>> Point("knot", (0.0, 0.0, 90.0), mass=2.0).is_driven
    False
    """

    name: str
    position: Sequence[float] | None = given_in("vector", "m")
    velocity: Sequence[float] = given_in("vector", "m/s", (0.0, 0.0, 0.0))
    mass: float | None = field(default=None, metadata={"quantity": MASS})

    def __post_init__(self):
        checked_name("point", self.name)
        if self.position is None and self.is_driven:
            raise ValueError(f"the point {self.name} is driven (it has no mass); give its position")
        if self.position is not None:
            object.__setattr__(self, "position", vector(f"{self.name}.position", self.position))
        object.__setattr__(self, "velocity", vector(f"{self.name}.velocity", self.velocity))
        if not self.is_driven:
            with prefixed(f"the point {self.name}: "):
                checked("mass", self.mass, MASS)

    @property
    def is_driven(self) -> bool:
        """Whether it follows its inputs."""
        return self.mass is None


@names_checked
@dataclass(frozen=True)
class Line:
    """A tether from one point to another. ValueError if a name or a number is wrong.

    Parameters
    ----------
    name : str
        Letters, digits and underscores.
    start, end : str
        Names of two points. The winch is at the start.
    tether : Tether
        A sequence of them is joined in series, from the start to the end; the winch changes the length of the first, which
        alone runs over sheaves: the others hang beyond the last one, where their joint stops.
    reel_out_speed : float
        Rate of the unstretched length [m/s] at the start; positive pays out.
    winch : Winch
        How the winch at the start of the line is controlled, and its drum.
    through : sequence of str
        Points over whose sheaves the line runs, in their order; between two of them is a portion, which has the segments of
        the tether, while `initial_length` is that of the whole line. A point may come more than once, not twice in a row.
    initial_portions : sequence of float or None
        Unstretched lengths of the portions at the start [m], which add up to `initial_length`.  None: each sheave starts
        with the same tension on both sides.
    sheave_mass : float or sequence of float
        J/r2 of each sheave, or of all [kg].
    sheave_friction : float or sequence of float
        Coulomb friction of the rope on the sheave [-]: it resists up to exp(friction * wrap angle) times the other tension.
    sheave_efficiency : float or sequence of float
        Ratio of the incoming to the outgoing tension [-], instead of friction.

    Examples
    --------
    >>> Line("bridle", "knot", "kite", Tether(segments=4, initial_length=12.0)).tether.segments
    4
    """

    name: str
    start: str
    end: str
    tether: Tether | Sequence[Tether] = Tether()  # noqa: RUF009 (a constant record)
    reel_out_speed: float = first_input("m/s", "at the start; positive pays out")
    winch: Winch = Winch()  # noqa: RUF009
    through: Sequence[str] = given_in("names", default=())
    initial_portions: Sequence[float] | None = given_in("list", "m")
    sheave_mass: float | Sequence[float] = given_in("numbers", "kg", 0.0)
    sheave_friction: float | Sequence[float] = given_in("numbers", default=0.0)
    sheave_efficiency: float | Sequence[float] = given_in("numbers", default=1.0)

    def __post_init__(self):
        checked_name("line", self.name)
        record_of("Line", self.winch, Winch).check_effect()
        check_sheaves(self)
        for point in (self.start, *self.through, self.end):
            if not isinstance(point, str):
                raise TypeError(f"the line {self.name} goes to {point!r}; it must be the name of a point")
        if self.start == self.end and not self.through:
            raise ValueError(f"the line {self.name} goes from the point {self.start} to itself; it needs two points")
        check_inputs(self, "reel_out_speed")

    @property
    def tethers(self) -> tuple[Tether, ...]:
        """Its tethers in series, a sequence also for a single one."""
        return tuple(self.tether) if isinstance(self.tether, list | tuple) else (self.tether,)

    @property
    def initial_length(self) -> float:
        """Unstretched length at the start [m], of all its tethers."""
        return sum(each.initial_length for each in self.tethers)


def numbers_in(line, name):
    """One number of each sheave of a line, a tuple; ValueError for another count, or if one is not allowed."""
    given, declared = getattr(line, name), SHEAVE_QUANTITIES[name]
    many = isinstance(given, Iterable) and not isinstance(given, str) and getattr(given, "ndim", 1) > 0
    found = tuple(given) if many else (given,) * len(line.through)
    if len(found) != len(line.through):
        raise ValueError(
            f"{line.name}.{name} has {len(found)} numbers; it must be one, or one for each of {len(line.through)}"
        )
    for each in found:
        if not declared.allows(each):
            raise ValueError(f"{line.name}.{name} is {each!r}; it must be {declared.range()}")
    return tuple(map(float, found))


def check_sheaves(line):
    """ValueError if sheaves of a line are inconsistent; arguments without effect are refused."""
    if isinstance(line.through, str):
        raise ValueError(f'{line.name}.through is {line.through!r}; it must be a list of names of points, as ["block"]')
    object.__setattr__(line, "through", tuple(line.through))
    if not line.through:
        for name in ("initial_portions", *SHEAVE_QUANTITIES):
            default = getattr(Line, name)
            if getattr(line, name) is not default and getattr(line, name) != default:
                raise ValueError(
                    f"{line.name}.{name} is {getattr(line, name)!r} and has no effect: {line.name} runs through no point"
                )
        return
    stops = (line.start, *line.through, line.end)
    twice = next((a for a, b in pairwise(stops) if a == b), None)
    if twice is not None:
        raise ValueError(f"the line {line.name} goes from the point {twice} to itself; there must be another point between")
    numbers = {name: numbers_in(line, name) for name in SHEAVE_QUANTITIES}
    if any(a > 0.0 and b != 1.0 for a, b in zip(numbers["sheave_friction"], numbers["sheave_efficiency"], strict=True)):
        raise ValueError(f"{line.name}.sheave_friction and {line.name}.sheave_efficiency are both given; give one of them")
    if line.initial_portions is not None:
        check_portions(line)


def check_portions(line):
    """ValueError unless the given portions match the line."""
    given, whole, count = tuple(line.initial_portions), line.initial_length, len(line.through) + 1
    if len(given) != count or not all(LENGTH.allows(each) and each > 0.0 for each in given):
        raise ValueError(f"{line.name}.initial_portions is {list(given)!r}; it must be {count} lengths above 0")
    least, beyond = at.MIN_SEGMENT_LENGTH * line.tethers[0].segments, whole - line.tethers[0].initial_length
    if min(*given[:-1], given[-1] - beyond) < least:
        raise ValueError(
            f"{line.name}.initial_portions is {list(given)!r}; each must be at least {least:g} m, "
            f"{at.MIN_SEGMENT_LENGTH:g} m for each of its {line.tethers[0].segments} segments"
            + (f", and the last one {beyond:g} m more for the tethers beyond the first" if beyond else "")
        )
    if abs(sum(given) - whole) > 1e-9 * whole:
        raise ValueError(
            f"{line.name}.initial_portions add up to {sum(given):.9g} m; it must be initial_length, {whole!r} m"
        )


def sheave_numbers(portion):
    """Arguments of `packing.put_sheaves` from a `Portion`."""
    if not portion.is_portion:
        return None
    line, k = portion.line, portion.number
    given = line.initial_portions[k] if line.initial_portions is not None else 0.0
    own = [numbers_in(line, name)[k] for name in SHEAVE_QUANTITIES] if portion.is_through else [0.0, 0.0, 1.0]
    return [at.BEHIND_SHEAVE if k else 1.0, given, *own]


def sheaves_of(line):
    """Start values of the sheaves of a line that runs over some, and of its portions, a dict by name."""
    given = line.initial_portions or (0.0,) * (len(line.through) + 1)
    return {"initial_portions": tuple(given), **{name: numbers_in(line, name) for name in SHEAVE_QUANTITIES}}


def check_system(points: Sequence[Point], lines: Sequence[Line]) -> None:
    """ValueError, in words, unless points and lines fit together; they may be several systems that no line joins."""
    if not lines:
        raise ValueError("a system needs at least one line")
    names = [each.name for each in (*points, *lines)]
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise ValueError(f"the name {twice} is given twice; each point and each line needs a name of its own")
    known = [point.name for point in points]
    for line in lines:
        for end in (line.start, *line.through, line.end):
            if end not in known:
                raise ValueError(
                    f"the line {line.name} goes to the point {end}, which does not exist{meant_or_all(end, known)}"
                )
    used = {end for line in lines for end in (line.start, *line.through, line.end)}
    idle = [name for name in known if name not in used]
    if idle:
        raise ValueError(f"no line goes to the point {idle[0]}; each point must be at a line")
