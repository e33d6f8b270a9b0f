"""The inputs of a tether, each declared once, in the order of the `inputs` array.

The places of the array (`layout.py`), the FMI variables, the arguments of the Python API, the columns of flights, the scales
of directional derivatives and the terminals of FMI 3 are made from this table.
"""

from dataclasses import dataclass

from .quantities import places_of

EVERY_TETHER, DRIVEN_KITE, FREE_KITE = "every tether", "driven kite", "free kite"  # who has an input
# the unit in which a directional derivative measures a change of an input; see `scale_of` in native/derivatives.c
SEGMENT_LENGTH, SEGMENT_PER_STEP, FAST_WIND, STIFFNESS = SCALES = (
    "SEGMENT_LENGTH",  # unstretched, of a segment [m]
    "SEGMENT_PER_STEP",  # speed [m/s] of one segment length per step, at most the speed of a fast end
    "FAST_WIND",  # speed [m/s]
    "STIFFNESS",  # E A of the first segment [N]
)
OF_UNITS = {"m/s": SEGMENT_PER_STEP, "N": STIFFNESS}  # scales
FAST_END_SPEED, FAST_WIND_SPEED = 100.0, 1000.0  # [m/s]
KITE_AT_START = (300.0, 0.0, 400.0)  # [m]
ZERO = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Input:
    """A scalar or a vector that the importer sets before each step."""

    name: str  # of the FMI variable, of the argument in Python; its place has this name in capitals
    unit: str
    meaning: str
    terminal: str = ""  # FMI 3 terminal and name there
    start: tuple = (0.0,)  # as many numbers as it has
    of: str = EVERY_TETHER  # or DRIVEN_KITE, FREE_KITE
    kind: str = "Real"  # or "Boolean": 0 or 1 in the array
    own_group: str = ""  # group of one without terminal

    @property
    def scale(self):
        """One of `SCALES`, by its unit."""
        return FAST_WIND if self.terminal.startswith("wind") else OF_UNITS.get(self.unit, SEGMENT_LENGTH)

    @property
    def size(self):
        """How many numbers it has."""
        return len(self.start)

    @property
    def group(self):
        """Group of variables, see `wiring/selection.py`: the group of its terminal, of both ends "motion"."""
        terminal = self.terminal.partition(".")[0]
        return self.own_group or ("motion" if terminal in ("kite", "ground") else terminal)


INPUT_TABLE = (
    Input("kite_position", "m", "position of the kite attachment point", "kite.position", KITE_AT_START, DRIVEN_KITE),
    Input("kite_velocity", "m/s", "velocity of the kite attachment point", "kite.velocity", ZERO, DRIVEN_KITE),
    Input("ground_position", "m", "position of the ground end", "ground.position", ZERO),
    Input("ground_velocity", "m/s", "velocity of the ground end", "ground.velocity", ZERO),
    Input(
        "reel_out_speed",
        "m/s",
        "rate of change of the unstretched length (winch_control = speed; otherwise at the start only); positive pays out",
        "winch.reel_out_speed",
    ),
    Input("wind_velocity", "m/s", "wind at wind_reference_height", "wind.velocity", ZERO),
    Input(
        "kite_load",
        "N",
        "external force on the kite: aerodynamics, control; excludes its weight",
        "kite.load",
        ZERO,
        FREE_KITE,
    ),
    Input(
        "winch_force",
        "N",
        "pulling force of the winch (winch_control = force; from the first step on); positive reels in",
        "winch.force",
    ),
    Input(
        "winch_length",
        "m",
        "set point of the unstretched length (winch_control = length); 0 until it is set: initial_length",
        "winch.length",
    ),
    Input(
        "release",
        "",
        "the tether permanently lets go of the kite at the start of the first step with true (dynamic tethers only)",
        kind="Boolean",
        own_group="breaking",
    ),
)
# with the build option --wind-points: the wind at each point, after the inputs of the table
_OF_POINTS = "points on the tether at equal unstretched spacing, ground first: wind, linear in between"
WIND_AT = Input("wind_at", "m/s", _OF_POINTS, "wind.at", ZERO)
# inputs and parameters that then have no effect
WITHOUT_EFFECT = ("wind_velocity", "wind_profile", "wind_reference_height", "wind_exponent", "surface_roughness")
BY_NAME = {each.name: each for each in INPUT_TABLE}
COUNT = sum(each.size for each in INPUT_TABLE)  # of numbers in the array
PLACES = places_of(INPUT_TABLE)


def components(name, size):
    """FMI names of a variable: its own of a scalar, with indices from 1 of a vector."""
    return (name,) if size == 1 else tuple(f"{name}[{i}]" for i in range(1, size + 1))


def wind_at_names(wind_points):
    """FMI names of the wind at this number of points, by place."""
    return tuple(f"{WIND_AT.name}[{k},{i}]" for k in range(1, wind_points + 1) for i in (1, 2, 3))


def inputs_of(kite_is_free):
    """The inputs of a tether with a free or a driven kite end in the order of its FMI variables: kite inputs first."""
    wanted = (EVERY_TETHER, FREE_KITE if kite_is_free else DRIVEN_KITE)
    listed = [each for each in INPUT_TABLE if each.of in wanted]
    return sorted(listed, key=lambda each: each.of == EVERY_TETHER)


def by_name(rows):
    """Columns of inputs by name, dict of views (..., size of the input) into an array of numpy (..., COUNT)."""
    return {each.name: rows[..., PLACES[each.name] : PLACES[each.name] + each.size] for each in INPUT_TABLE}
