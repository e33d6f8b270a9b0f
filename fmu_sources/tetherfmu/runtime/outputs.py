"""The outputs of a tether, each declared once: unit, meaning, dependencies, limits.

The `outputs` array (`layout.py`), the FMI variables, the results of the Python API and their docstring, the dependencies and
the interface page follow from this record. To add an output, declare it here as the last one and write it in the kernels.
"""

from dataclasses import dataclass, replace
from inspect import cleandoc
from math import inf, pi
from typing import Any, NamedTuple

from .dependencies import FORCE, FORM, REELING
from .limits import LARGEST_INTEGER, MAX_SEGMENTS
from .quantities import DEGREES, Quantity, places_of

Array = Any  # of numpy in the Python API, which an FMU does without
SCALAR, VECTOR, POINTS = (), (3,), ("points", 3)  # shapes of outputs
ANY, NOT_NEGATIVE, COUNTED = (-inf, inf), (0.0, inf), (0, LARGEST_INTEGER)  # minimum and maximum
OUTPUT, LOCAL = "output", "local"  # causality of FMI
KINDS = {int: "Integer", bool: "Boolean"}  # of variables, for the types of the Python API
TYPES = {kind: each.__name__ for each, kind in KINDS.items()}


@dataclass(frozen=True)
class Output:
    """A scalar, a vector or the points of the shape, which the importer reads after each step."""

    name: str  # of the FMI variable and in the Python API; its place has this name in capitals
    kind: str  # "Real", "Integer" or "Boolean"
    quantity: Quantity
    depends_on: tuple  # when initialization ends, see `dependencies`
    shape: tuple  # SCALAR, VECTOR or POINTS
    terminal: str  # of FMI 3, as of `inputs.Input`
    is_local: bool  # in FMI: to be read, not to be connected
    group: str  # of variables, see `wiring/selection.py`

    def causality(self, wind_points=0):
        """LOCAL or OUTPUT. The wind at points (`inputs.WIND_AT`) is found where they are, so the shape is connected then."""
        return LOCAL if self.is_local and not (wind_points and self.shape == POINTS) else OUTPUT

    @property
    def size(self):
        """How many numbers it has; of the shape, each of its points."""
        return self.shape[-1] if self.shape else 1


def output(
    unit, meaning, depends_on, limits=ANY, display=(), shape=SCALAR, terminal="", is_local=False, group="geometry"
) -> Any:
    """Field of the record of outputs; its name and kind are those of the field."""
    quantity = Quantity(unit, meaning, *limits, display=display)
    return Output("", "Real", quantity, depends_on, shape, terminal, is_local, group)


def force(meaning, **more) -> Any:
    """`output` for a force or a tension."""
    return output("N", meaning, FORCE, group="forces", **more)


def coupling(unit, meaning, depends_on=FORM) -> Any:
    """`output` for a coupling coefficient, at least 0."""
    return output(unit, meaning, depends_on, NOT_NEGATIVE, group="coupling")


def motion(unit, meaning, what) -> Any:
    """`output` for the position or the velocity of the kite end."""
    return output(unit, meaning, (f"kite_{what}[*]",), shape=VECTOR, terminal=f"kite.{what}", group="motion")


def counter(meaning) -> Any:
    """Field of the record for a solver statistic, which says nothing about the tether."""
    return output("", meaning, (), COUNTED, is_local=True, group="solver")


class Outputs(NamedTuple):
    """Outputs of a tether at an instant, SI units; docs/use/interface.md has their full meaning.

    The points of the shape begin at the ground.

    Examples
    --------
    >>> from tetherfmu import TetherStraight
    >>> TetherStraight(initial_length=510.0, segments=4).initialize().shape.shape
    (5, 3)
    """

    ground_force: Array = force("force of the tether on the ground station", shape=VECTOR, terminal="ground.force")
    kite_force: Array = force("force of the tether on the kite", shape=VECTOR, terminal="kite.force")
    ground_tension: float = force(
        "tension of the first segment; with winch_control = force the tension where the tether leaves the winch"
    )
    kite_tension: float = force("tension of the last segment")
    max_tension: float = force("largest tension of the tether, in its segments or where it leaves a drum or sheave")
    tether_length: float = output(
        "m", "current unstretched length", FORM, NOT_NEGATIVE, terminal="winch.tether_length", group="winch"
    )
    ground_elevation: float = output(
        "rad", "elevation at which the tether leaves the ground end", FORM, (-pi / 2.0, pi / 2.0), DEGREES
    )
    ground_azimuth: float = output(
        "rad",
        "azimuth at which the tether leaves the ground end, from the x axis, anti-clockwise seen from above",
        FORM,
        (-pi, pi),
        DEGREES,
    )
    slack_segments: int = output("", "number of segments shorter than their unstretched length", FORM, (0, MAX_SEGMENTS))
    kite_end_mass: float = coupling("kg", "tether mass lumped at the kite end")
    kite_stiffness: float = coupling("N/m", "axial stiffness of the tether at the kite end, with all segments taut")
    kite_damping: float = coupling(
        "N.s/m", "axial damping of the tether at the kite end, with all segments taut", (*FORM, "axial_damping")
    )
    winch_speed: float = output(
        "m/s", "current reel-out speed, whatever controls the winch", REELING, terminal="winch.speed", group="winch"
    )
    grounded_length: float = output(
        "m", "unstretched length in contact with the ground, 0 without ground_contact", FORM, NOT_NEGATIVE, group="ground"
    )
    wave_time: float = coupling("s", "travel time of a transverse wave over the tether", FORCE)
    sag: float = output("m", "largest distance of the tether from its chord", FORM, NOT_NEGATIVE)
    solver_steps: int = counter("internal steps of the solver since the start")
    solver_rejections: int = counter("rejected internal steps of the solver since the start")
    solver_iterations: int = counter("Newton iterations since the start, for shapes and fixed steps")
    shape: Array = output(
        "m",
        "points on the tether at equal unstretched length",
        FORM,
        shape=POINTS,
        terminal="wind.shape",
        is_local=True,
        group="shape",
    )
    kite_position: Array = motion("m", "position of the kite attachment point", "position")
    kite_velocity: Array = motion("m/s", "velocity of the kite attachment point", "velocity")
    solver_iteration_limit: int = counter(
        "bound on the iterations of the last communication step with its fixed steps (before the first: of one fixed "
        "step); 0 with adaptive steps, which have no bound"
    )
    fallback_steps: int = counter("fixed steps since the start that fell back to backward Euler")
    peak_tension: float = force(
        "largest tension of all segments since the last communication point, over all internal steps"
    )
    broken: bool = output(
        "", "whether the tether has broken or has been released (dynamic tethers only)", (), group="breaking"
    )
    break_time: float = output("s", "time of the break or release since the start; -1: not yet", (), group="breaking")


def _declared(record):
    """The outputs that the fields of a record declare; the record (modified) then has them no longer as defaults."""
    declared = record._field_defaults
    record._field_defaults, record.__new__.__defaults__ = {}, None
    for name, each in declared.items():
        yield replace(each, name=name, kind=KINDS.get(record.__annotations__[name], "Real"))


def _documented(record, table):
    """Add to the docstring of the record a section with type, meaning and unit of each output."""
    lines = [cleandoc(record.__doc__), "", "Attributes", "----------"]
    for each in table:
        numbers = TYPES.get(each.kind, "float")
        size = f"({', '.join(map(str, each.shape))}{',' * (len(each.shape) == 1)}) array" if each.shape else numbers
        unit = f" [{each.quantity.unit}]" if each.quantity.unit else ""
        lines += [f"{each.name} : {size}", f"    {each.quantity.meaning}{unit}"]
    record.__doc__ = "\n".join(lines)


OUTPUT_TABLE = tuple(_declared(Outputs))
_documented(Outputs, OUTPUT_TABLE)
BY_NAME = {each.name: each for each in OUTPUT_TABLE}
COUNTERS = tuple(each.name for each in OUTPUT_TABLE if each.is_local and each.shape == SCALAR)
# of the array, where the shape is last because its size is a build option, and of the FMI variables
ARRAY_ORDER = sorted(OUTPUT_TABLE, key=lambda each: each.shape == POINTS)
PLACES = places_of(ARRAY_ORDER)
