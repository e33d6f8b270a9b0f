"""Constant records of a tether and its surroundings. `packing.py` converts them to kernel parameters.

Each quantity: default, unit, meaning, minimum, maximum (for an enumeration its choices).
"""

from dataclasses import dataclass, replace
from functools import wraps
from math import inf, pi
from typing import ClassVar

from .enumerations import EXPLOG, LOGARITHMIC, WITH_DRUM
from .limits import MAX_SEGMENTS, MIN_SEGMENT_LENGTH
from .naming import prefixed
from .quantities import Quantity, check, checked, choice, documented, quantities, quantity

DEFAULT_TOLERANCE, LOOSEST_TOLERANCE = 1e-4, 0.1
IN_METRES = (0.0, 0.2, "diameters are in m: 4 mm are 0.004")  # usual ones, see `Quantity.usual`
IN_KG_PER_M3 = (20.0, inf, "densities are in kg/m3: 0.97 g/cm3 are 970")
OF_AIR = (0.01, 100.0, "densities are in kg/m3: 0.0012 g/cm3 or 1200 g/m3 are 1.2")
OF_THE_ATMOSPHERE = (100.0, inf, "heights are in m: 8.5 km are 8500")
IN_SECONDS = (0.0, 1.0, "steps are in s: 5 ms are 0.005")
# quantities of a tether that `packing.pack` gives to its segments: they may differ between tethers in series
PER_SEGMENT = ("segments", "diameter", "density", "axial_stiffness", "axial_damping", "drag_coefficient", "breaking_force")
ROUGHNESS_TOO_LARGE = (
    "surface_roughness is {roughness!r}; it must be less than wind_reference_height ({height!r} m) for this wind_profile"
)
GROUND_WITHOUT_GRAVITY = "ground_contact is flat; it needs a gravity above 0, for ground_sink is a depth under weight"
MASS_AND_DENSITY = "mass_per_length and density are both given; give one of them: density is mass_per_length over the area"
SCALED = ("axial_stiffness", "axial_damping")  # with the area of a tether
STOPS_CROSSED = "shortest_length is {shortest_stop!r} m; it must be less than longest_length ({longest_stop!r} m)"


def in_density(given, diameter):
    """Quantities of a tether (dict), with the density [kg/m3] in place of a `mass_per_length` [kg/m] if they have one.

    diameter [m] : if they have none.  ValueError if both are given, or the mass is outside the range that follows from
    the density range.
    """
    if "mass_per_length" not in given:
        return given
    if "density" in given:
        raise ValueError(MASS_AND_DENSITY)
    declared, diameter = dict(quantities(Tether)), given.get("diameter", diameter)
    across = pi * checked("diameter", diameter, declared["diameter"]) ** 2 / 4.0  # area [m2]
    density = declared["density"]
    allowed = replace(Tether.instead["mass_per_length"], minimum=across * density.minimum, maximum=across * density.maximum)
    try:
        mass = checked("mass_per_length", given["mass_per_length"], allowed)
    except ValueError as problem:
        raise ValueError(f"{problem} with a diameter of {diameter:g} m") from None
    return {name: value for name, value in given.items() if name != "mass_per_length"} | {"density": mass / across}


def of_material(given, tether):
    """Given quantities (dict) that replace fields of a tether, with the quantities that follow from them.

    A diameter alone scales stiffness and damping with the area; a `mass_per_length` is converted to a density. ValueError
    names a quantity out of range.
    """
    given = in_density(given, tether.diameter)
    if "diameter" not in given or all(name in given for name in SCALED):
        return given
    table = dict(quantities(Tether))
    with allowed_by(given["diameter"]):
        area = (checked("diameter", given["diameter"], table["diameter"]) / tether.diameter) ** 2
        return {name: checked(name, area * getattr(tether, name), table[name]) for name in SCALED} | given


def by_material(record):
    """Make the constructor of `Tether` (modified) complete its arguments by `of_material`; returns the record."""
    make, names = record.__init__, [name for name, _ in quantities(record)]

    @wraps(make)
    def __init__(self, *values, **named):
        first = dict(zip(names, values, strict=False))
        given = of_material(first | named, record)
        make(self, *values, **{name: value for name, value in given.items() if name in named or name not in first})

    record.__init__ = __init__
    return record


@documented
@by_material
@dataclass(frozen=True)
class Tether:
    """A uniform tether. ValueError if a number is out of range.

    A diameter alone scales stiffness and damping with the area; those that are given stay. `mass_per_length` [kg/m] may be
    given instead of the density.

    >>> Tether(initial_length=525.0, damping_law="stretch_rate").damping_law
    2
    >>> Tether(diameter=0.008).axial_stiffness
    2458400.0
    >>> round(Tether(diameter=0.001, mass_per_length=0.14).density)
    178254
    """

    segments: int = quantity(20, "", "number of segments", 1, MAX_SEGMENTS)
    initial_length: float = quantity(505.0, "m", "initial unstretched length", MIN_SEGMENT_LENGTH, 1e5)
    diameter: float = quantity(0.004, "m", "diameter", 1e-6, 10.0, display=("mm", 1000.0), usual=IN_METRES)
    density: float = quantity(724.0, "kg/m3", "density of the tether material", 1e-3, 1e7, usual=IN_KG_PER_M3)
    axial_stiffness: float = quantity(
        614600.0, "N", "axial stiffness E A: force per strain; an FMU does not scale it with diameter", 1e-3, 1e12
    )
    axial_damping: float = quantity(
        473.0,
        "N.s",
        "damping constant times length: force per strain rate; an FMU does not scale it with diameter",
        0.0,
        1e9,
    )
    slack_stiffness_ratio: float = quantity(
        0.01, "", "stiffness of a slack segment relative to a taut one; 0: slack segments carry no force", 0.0, 1.0
    )
    slack_damping_ratio: float = quantity(
        1.0, "", "damping of a slack segment relative to a taut one; 0 if slack_stiffness_ratio is 0", 0.0, 1.0
    )
    damping_law: int = choice(
        "rate to which the damping force is proportional",
        strain_rate="strain rate (physical)",
        stretch_rate="rate of the stretched length (as in Tethers.jl, for comparison)",
    )
    drag_coefficient: float = quantity(0.958, "", "drag coefficient of a cylinder in cross flow", 0.0, 100.0)
    breaking_force: float = quantity(0.0, "N", "tension at which a segment breaks; 0: the tether never breaks", 0.0, 1e12)
    instead: ClassVar = {"mass_per_length": Quantity("kg/m", "mass per unstretched length, instead of the density", 0.0)}

    def __post_init__(self):
        check(self)

    @property
    def mass_per_length(self) -> float:
        """Mass per unstretched length [kg/m]."""
        return self.density * pi * self.diameter**2 / 4.0

    def with_diameter(self, diameter: float) -> "Tether":
        """The same material and length with another diameter [m]: stiffness and damping grow with the area.

        ValueError names the diameter if it, or what grows with it, is out of range.

        >>> Tether(axial_stiffness=1000.0).with_diameter(0.008).axial_stiffness
        4000.0
        """
        return changed(self, {"diameter": diameter})


# the same for all tethers in series
OF_THE_WHOLE_CHAIN = tuple(name for name, _ in quantities(Tether) if name not in (*PER_SEGMENT, "initial_length"))


def allowed_by(diameter):
    """ValueError that names a diameter [m], if it or a quantity that follows from it is out of range."""
    checked("diameter", diameter, dict(quantities(Tether))["diameter"])
    return prefixed(f"diameter is {diameter!r} m (4 mm are 0.004): with it ")


def changed(record, given):
    """A copy of a record with other values (dict), as by `dataclasses.replace`; of a tether by `of_material`."""
    return replace(record, **(of_material(given, record) if isinstance(record, Tether) else given))


@documented
@dataclass(frozen=True)
class Environment:
    """Air, wind profile and gravity. ValueError if a number is out of range.

    >>> Environment(wind_profile="power_law", gravity=9.82).wind_profile
    2
    """

    air_density: float = quantity(1.225, "kg/m3", "air density at z = 0", 0.0, 1e4, usual=OF_AIR)
    air_density_scale_height: float = quantity(
        0.0,
        "m",
        "0: uniform air density; otherwise it falls as exp(-z/H), H = 8550 m for the standard atmosphere",
        0.0,
        1e9,
        usual=OF_THE_ATMOSPHERE,
    )
    gravity: float = quantity(9.81, "m/s2", "gravity along -z", 0.0, 1000.0)
    wind_profile: int = choice(
        "wind profile over the height z",
        uniform="the same wind at all heights",
        power_law="(z/h)^alpha",
        logarithmic="ln(z/z0)/ln(h/z0)",
        explog="logarithmic + (logarithmic - power_law)",
    )
    wind_reference_height: float = quantity(6.0, "m", "height h at which wind_velocity is given", 1e-3, 1e5)
    wind_exponent: float = quantity(0.08163, "", "exponent alpha of the power-law wind profile", 0.0, 2.0)
    surface_roughness: float = quantity(0.0002, "m", "roughness z0 of the logarithmic wind profile", 1e-9, 100.0)

    def __post_init__(self):
        check(self)
        if self.wind_profile in (LOGARITHMIC, EXPLOG) and self.surface_roughness >= self.wind_reference_height:
            roughness, height = self.surface_roughness, self.wind_reference_height
            raise ValueError(ROUGHNESS_TOO_LARGE.format(roughness=roughness, height=height))


@documented
@dataclass(frozen=True)
class Solver:
    """How the motion is computed. ValueError if a number is out of range.

    >>> Solver(relative_tolerance=1e-5, initial_shape="straight").initial_shape
    3
    """

    relative_tolerance: float = quantity(
        0.0, "", "solver tolerance; 0: 1e-4, or the importer's tolerance if it is tighter", 0.0, LOOSEST_TOLERANCE
    )
    fixed_step: float = quantity(
        0.0,
        "s",
        "internal solver step; 0: adaptive; otherwise fixed, with bounded work (real time)",
        0.0,
        1e3,
        usual=IN_SECONDS,
    )
    fixed_step_method: int = choice(
        "method of fixed steps",
        second_order="order 2",
        backward_euler="order 1, damps like an additional axial_damping of E A fixed_step",
    )
    initial_shape: int = choice(
        "initial shape",
        2,
        static_equilibrium="at rest, even if the ends move",
        quasi_steady="moving with its ends, without a start-up jump (equals static_equilibrium if the ends rest)",
        straight="straight line between the ends",
    )
    end_velocities: int = choice(
        "source of the end velocities",
        given="from the inputs",
        derived="derived from the positions over the last step (the velocity inputs are ignored)",
    )
    input_continuation: int = choice(
        "extrapolation of reel_out_speed, winch_force and kite_load within a step",
        linear="linear, from the last two values",
        held="held constant",
    )

    def __post_init__(self):
        check(self)


@documented
@dataclass(frozen=True)
class Winch:
    """The winch at the ground end: what controls it, and its drum. ValueError if a number is out of range.

    >>> Winch(winch_control="length").winch_control
    3
    """

    winch_control: int = choice(
        "quantity that controls the winch: speed, force or length",
        speed="it pays out at reel_out_speed",
        force="it pulls with winch_force, and the tension turns its drum",
        length="it pays out or reels in to winch_length",
    )
    winch_start: int = choice(
        "force control: initial unstretched length",
        given="initial_length",
        equilibrium="the length that balances winch_force (the search starts at initial_length)",
    )
    winch_mass: float = quantity(
        0.0,
        "kg",
        "force control: inertia of drum and motor at the rope, J/r2; 0: without damping and friction the tension at the "
        "winch is winch_force at every instant",
        0.0,
        1e9,
    )
    winch_damping: float = quantity(0.0, "N.s/m", "force control: viscous friction of the drum", 0.0, 1e9)
    winch_friction: float = quantity(0.0, "N", "force control: dry friction of the drum", 0.0, 1e9)
    shortest_length: float = quantity(
        0.0,
        "m",
        "force control: shortest unstretched length, where the drum stops; 0: 1 cm per segment",
        0.0,
        1e6,
    )
    longest_length: float = quantity(
        0.0, "m", "force control: longest unstretched length, where the drum stops; 0: no limit", 0.0, 1e6
    )

    def __post_init__(self):
        check(self)
        if 0.0 < self.longest_length <= self.shortest_length:
            shortest, longest = self.shortest_length, self.longest_length
            raise ValueError(STOPS_CROSSED.format(shortest_stop=shortest, longest_stop=longest))

    def check_effect(self):
        """ValueError if a quantity of the drum is not its default, and has no effect with this `winch_control`."""
        for name, _ in quantities(self):
            idle = name != "winch_control" and self.winch_control not in WITH_DRUM
            if idle and getattr(self, name) != getattr(Winch, name):
                raise ValueError(f"{name} is {getattr(self, name)!r} and has no effect: winch_control is not 2 (force)")


@documented
@dataclass(frozen=True)
class Ground:
    """The ground under a tether. ValueError if a number is out of range.

    >>> Ground(ground_contact="flat", ground_height=-4.0).ground_contact
    2
    """

    ground_contact: int = choice(
        "ground under the tether",
        none="no ground: the tether hangs freely",
        flat="a plane at ground_height supports the tether and a free kite",
    )
    ground_height: float = quantity(0.0, "m", "z of the ground", -1e5, 1e5)
    ground_friction: float = quantity(0.5, "", "friction coefficient of the tether on the ground", 0.0, 10.0)
    ground_sink: float = quantity(
        0.002, "m", "penetration depth of the tether under its own weight; sets the ground stiffness", 1e-6, 1.0
    )

    def __post_init__(self):
        check(self)


@documented
@dataclass(frozen=True)
class FreeKite:
    """The mass at a free kite end, and how it starts. ValueError if a number is out of range.

    >>> FreeKite(kite_mass=25.0).kite_mass
    25.0
    """

    kite_mass: float = quantity(10.0, "kg", "point mass at the kite end, in addition to half of the last segment", 0.0, 1e9)
    kite_start: int = choice(
        "start of the kite",
        given="at initial_kite_position with initial_kite_velocity",
        equilibrium="at rest where the tether, its weight and kite_load are in equilibrium (the search starts at "
        "initial_kite_position)",
    )

    def __post_init__(self):
        check(self)


RECORDS = (Tether, Environment, Solver, Winch, Ground)  # in the order of quantities in the kernel `pack`
QUANTITIES_OF_TETHER = len(quantities(Tether))  # how many quantities each of the tethers in series has


def numbers_of(tethers, environment, solver, winch=Winch(), ground=Ground()):
    """The quantities of records in the order of the kernel `pack`, a list."""
    return [
        getattr(record, name) for record in (*tethers, environment, solver, winch, ground) for name, _ in quantities(record)
    ]
