"""Which FMUs make a kite power system, how are they wired, how do they start? For `pumping_cycle.py` and the SSP files.

Variables of the same name belong together: an input gets the output of that name. What no output gives is set once, in each
FMU that has it.
"""

from math import cos, radians, sin

from fmus.winch import Drum

ELEVATION, DISTANCE, SPEED = radians(30.0), 200.0, 15.0  # of the kite at the start [rad], [m], [m/s]
FMUS = {  # instance: FMU, in the order in which they depend on each other
    "tether": "TetherDynamicFree",
    "kite": "PointMassKite",
    "controller": "FlightController",
    "winch": "Winch",
}
START = {  # of every FMU that has the name: the kite flies across the wind, on a tether that pulls with some 2 kN
    "wind_velocity[1]": 8.0,
    "wind_profile": 2,
    "wind_reference_height": 10.0,
    "wind_exponent": 0.15,
    "kite_mass": 19.6,
    "segments": 10,
    "initial_shape": 2,
    "initial_length": 0.99625 * DISTANCE,
    "initial_kite_position[1]": DISTANCE * cos(ELEVATION),
    "initial_kite_position[3]": DISTANCE * sin(ELEVATION),
    "initial_kite_velocity[2]": SPEED,
    "initial_heading": radians(-90.0),
    "initial_speed": 2.5,
}
START |= {name.removeprefix("initial_"): value for name, value in START.items() if name.startswith("initial_kite_")}
START |= {"heading": START["initial_heading"], "tether_length": START["initial_length"]}  # for importers that connect late
INSIDE = {name: fmu for name, fmu in FMUS.items() if name != "winch"} | {"motor": "WinchMotor"}  # the drum in the tether
BY_FORCE = 2  # of `winch_control`
INSIDE_START = START | {
    "winch_control": BY_FORCE,
    "winch_mass": Drum().inertia / Drum().drum_radius ** 2,
    "winch_damping": Drum().viscous_friction,
    "winch_friction": Drum().coulomb_friction,
    "reel_out_speed": START["initial_speed"],
    "winch_speed": START["initial_speed"],
}
OWN_STEPS = {"controller": 0.1, "motor": 0.1}  # [s], of what may take longer steps than tether and kite
FIDELITIES = {  # what differs: name, and values for the tether
    "coarse": {"segments": 3, "relative_tolerance": 1e-3},
    "standard": {"segments": 10, "relative_tolerance": 1e-4},
    "fine": {"segments": 30, "relative_tolerance": 1e-6},
}
CIRCLE = {"kite": "KiteOnPath", "tether": "TetherDynamic"}  # the circular flight as a system of two FMUs
CIRCLE_START = {
    "initial_length": 525.0,
    "initial_shape": 2,
    "wind_velocity[1]": 8.0,
}


def given_by(variables):
    """Names of the outputs of an FMU that another one can get; variables : as FMPy describes them."""
    return [v.name for v in variables if v.causality == "output" and v.type == "Real"]


def wanted_by(variables, given):
    """Names of the inputs of an FMU that are among the given names."""
    return [v.name for v in variables if v.causality == "input" and v.name in given]


def starts_for(variables, start):
    """Values of those start values that an FMU has, as pairs (variable, value)."""
    return [(v, start[v.name]) for v in variables if v.name in start and v.causality in ("input", "parameter")]
