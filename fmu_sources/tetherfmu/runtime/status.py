"""Status codes of the kernels, and the sentence for each of them.

A kernel returns one 32-bit number: the code in the low byte, above it an index (of an input or of a parameter).
"""

from . import limits, parameters, quantities

OK = 0
INPUT_NOT_FINITE = 1
STEP_NOT_POSITIVE = 2
REELED_TOO_SHORT = 3
STEP_BUDGET_SPENT = 4
STEP_TOO_SMALL = 5
STATE_NOT_FINITE = 6
NO_EQUILIBRIUM = 7
FIXED_STEPS_TOO_MANY = 8
OUTPUT_NOT_FINITE = 9
# of parameters
PARAMETER_OUT_OF_RANGE = 10
PARAMETER_NOT_WHOLE = 11
ROUGHNESS_TOO_LARGE = 12
NOT_THE_SAME_IN_SERIES = 13
SEGMENTS_TOO_MANY = 14
SEGMENTS_TOO_SHORT = 15
# of the winch
WINCH_TOO_SHORT = 16
STOPS_CROSSED = 17
START_BEYOND_STOP = 18
WINCH_PUSHES = 19
NO_LENGTH = 20
# of the ground
GROUND_WITHOUT_GRAVITY = 21
# of a system
NO_EQUILIBRIUM_OF_POINT = 22
NO_POINT_IS_GIVEN = 23
# of a free kite
NO_EQUILIBRIUM_OF_KITE = 24
# of a start
NO_BALANCE_AT_START = 25
KITE_AND_WINCH_SOUGHT = 26
START_UNDER_GROUND = 27
# of a released line
RELEASED_WITHOUT_MASS = 28
# of lines over sheaves, and of lines whose winch is controlled by force in a system with these or with shared winches
SHEAVES_WITH_STRETCH_RATE = 29
SHEAVES_THAT_BREAK = 30
NO_SHARES = 31
ROPE_RUNS_OFF = 32
NO_BALANCE_OF_DRUMS = 33
# of the wind
UNKNOWN_WIND_LAW = 34

SENTENCES = {
    OK: "done",
    INPUT_NOT_FINITE: "the input {name} is {value}; it must be a finite number, at most {largest:g} in magnitude",
    STEP_NOT_POSITIVE: "the communication step is {step} s; it must be greater than 0 and at most {longest:g} s",
    REELED_TOO_SHORT: (
        "the reel_out_speed {reel_out_speed} m/s over a step of {step} s would leave segments shorter than "
        "{shortest} m (tether_length {length} m, at least {least_length:.6g} m); stop reeling in earlier or use fewer "
        "segments"
    ),
    STEP_BUDGET_SPENT: (
        "the solver needs more than its budget of internal steps for a communication step of {step} s; use a shorter "
        "communication step, a larger relative_tolerance, fewer segments, more axial_damping, less axial_stiffness or a "
        "fixed_step"
    ),
    STEP_TOO_SMALL: (
        "the solver cannot reach the relative_tolerance {relative_tolerance} with any internal step; the motion of an "
        "end (kite_position, ground_position) or the kite_load jumps too far in this step of {step} s, or the tolerance is "
        "too small"
    ),
    STATE_NOT_FINITE: "the motion overflowed in a step of {step} s; check the inputs and parameters",
    NO_EQUILIBRIUM: (
        "no equilibrium was found between the given ends, {distance:.6g} m apart; check kite_position, ground_position, "
        "which are in m, wind_velocity, the length (tether_length {length} m) and axial_stiffness: drag may stretch a soft "
        "tether without end"
    ),
    FIXED_STEPS_TOO_MANY: (
        "a communication step of {step} s needs more than {budget} iterations "
        f"(2 to {limits.WORST_WORK} for each internal step of "
        "fixed_step {fixed_step} s); use a longer fixed_step or a shorter communication step"
    ),
    OUTPUT_NOT_FINITE: (
        "an output is not a finite number after a step of {step} s; check kite_position, wind_velocity and "
        "air_density_scale_height"
    ),
    PARAMETER_OUT_OF_RANGE: quantities.OUT_OF_RANGE,
    PARAMETER_NOT_WHOLE: quantities.NOT_WHOLE,
    ROUGHNESS_TOO_LARGE: parameters.ROUGHNESS_TOO_LARGE,
    NOT_THE_SAME_IN_SERIES: "{name} must be the same for all tethers in series",
    SEGMENTS_TOO_MANY: "segments is {in_all!r} in all; it must be at most {most}",
    SEGMENTS_TOO_SHORT: (
        "initial_length is {length!r} m for {segments!r} segments; it must be at least {shortest} m for each"
    ),
    WINCH_TOO_SHORT: (
        "the winch_length {winch_length} m over a step of {step} s would leave segments shorter than {shortest} m "
        "(tether_length {length} m, at least {least_length:.6g} m); give the length to be paid out, or use fewer segments"
    ),
    STOPS_CROSSED: parameters.STOPS_CROSSED,
    GROUND_WITHOUT_GRAVITY: parameters.GROUND_WITHOUT_GRAVITY,
    START_BEYOND_STOP: (
        "the unstretched length is {length} m at the start, beyond a stop of the winch; give an initial_length between "
        "{shortest_stop:.6g} m and {longest_stop:.6g} m, or another shortest_length or longest_length"
    ),
    WINCH_PUSHES: (
        "winch_force is {winch_force} N; it must be at least minus winch_friction, which is {friction} N, also "
        "at the end of a step of {step} s with a given derivative: a winch without winch_mass cannot push a "
        "tether; give "
        "a winch_mass"
    ),
    NO_LENGTH: (
        "no unstretched length was found at which the tether pulls with winch_force ({winch_force} N) in a step of "
        "{step} s (tether_length {length} m); give the winch a winch_mass, winch_damping or a longest_length, or set "
        "input_continuation to 2 (held) where winch_force jumps"
    ),
    NO_EQUILIBRIUM_OF_POINT: (
        "no equilibrium was found for the free point {name}; check the positions of the driven points, the loads, "
        "initial_length and axial_stiffness of the lines, or give a position where it starts"
    ),
    NO_POINT_IS_GIVEN: "no point of the system is driven or has a position: give one where it starts",
    NO_EQUILIBRIUM_OF_KITE: (
        "no equilibrium was found in which the free kite is at rest; check kite_load, kite_mass, wind_velocity, the length "
        "(tether_length {length} m) and axial_stiffness, give an initial_kite_position closer to it, or set kite_start to 1 "
        "(given)"
    ),
    NO_BALANCE_AT_START: (
        "no unstretched length was found at which the tether between the given ends, {distance:.6g} m apart, pulls with "
        "winch_force, {winch_force} N; a longer tether pulls with its own weight and drag at least: check winch_force and "
        "the positions of the ends, or set winch_start to 1 (given)"
    ),
    KITE_AND_WINCH_SOUGHT: (
        "winch_start is 2 (equilibrium) and a free end starts in equilibrium, too, which exists at any length: "
        "set winch_start to 1 (given), or give the end a position"
    ),
    START_UNDER_GROUND: (
        "{name} is {value} m, more than {under:g} m below ground_height ({ground_height} m); a free end cannot start under "
        "the ground"
    ),
    RELEASED_WITHOUT_MASS: (
        "release is true, but the released end has no mass: give it one (kite_mass; in a system the mass of the point)"
    ),
    SHEAVES_WITH_STRETCH_RATE: (
        "damping_law is 2 (stretch_rate) for a line over sheaves, or with force control beside such lines or at a winch "
        "that holds several; it must be 1 (strain_rate)"
    ),
    ROPE_RUNS_OFF: (
        "the end of the rope reached a sheave in a step of {step} s in which it broke or changed its speed, or the portion "
        "behind the sheave has one segment only; use a shorter step or more segments"
    ),
    SHEAVES_THAT_BREAK: "breaking_force is given for a line over sheaves; it must have at least 3 segments to break",
    NO_SHARES: (
        "no lengths of the portions were found at which each sheave has equal tensions on both sides, and, with "
        "winch_start 2 (equilibrium), the line pulls with winch_force; give them as initial_portions, set winch_start to 1 "
        "(given), or check the positions of the points, the loads, winch_force and initial_length"
    ),
    NO_BALANCE_OF_DRUMS: (
        "no lengths of the lines that its winch holds were found at which the sum of their tensions times their ratios is "
        "{name}, {value} N, with winch_start 2 (equilibrium) and all lines and points in equilibrium at rest; ropes pull "
        "with their own weight and drag at least, and a load on a single line pulls alike at any length: check winch_force, "
        "the ratios and positions of points, or set winch_start to 1 (given)"
    ),
    UNKNOWN_WIND_LAW: "{name} is {value!r}, which is not a wind law: see kernels/equations/air.py",
}

LIMITS = {  # in the sentences
    "under": limits.DEEPEST_START,
    "largest": limits.LARGEST_INPUT,
    "longest": limits.LONGEST_STEP,
    "shortest": limits.MIN_SEGMENT_LENGTH,
    "most": limits.MAX_SEGMENTS,
}


def code(status):
    """Code [-] of a kernel's return value."""
    return status & 0xFF


def index(status):
    """Index [-] that a kernel's return value carries (0 without one)."""
    return status >> 8


def sentence(status, **facts):
    """Message of a status, with the facts that its sentence needs."""
    return SENTENCES[code(status)].format(**LIMITS, **facts)
