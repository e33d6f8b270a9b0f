"""Implausible values: limit and warning of each; the numbers are not changed.

The kernels note it in the state (`layout.WARNINGS`), see `kernels/step/plausibility.py`.
"""

from . import layout as at
from .limits import DEEPEST_START, STIFF

LARGEST_STRETCH = 1.05  # length of a segment over its unstretched length [-]; ropes of Dyneema break near 1.04
LARGEST_ACCELERATION = 9810.0  # of an end [m/s2]: 1000 times gravity
FASTEST = 340.0  # an end [m/s]: about the speed of sound at the ground
JUDGED_WAY = 0.5  # displacement of an end over which positions and velocities are compared [m]: far above their noise
LARGEST_RESIDUE = 0.5  # part of it that the velocities need not account for [-]; it is 1 if they are 0
SLACK = 0.99  # distance of the ends over the length, below which a tether is slack as a whole [-]
LEAST_RESISTANCE = 0.1  # tension over the force of a winch that reels in, below which hardly more than inertia resists [-]
LARGEST_EXCESS = 0.05  # of a length that the winch follows over the distance of the ends, part of the distance [-]
SHALLOW = 0.01  # of the length: how far below the ground a tether without ground contact may hang [-]
UNDER = DEEPEST_START  # the ground, where there is ground contact [m]
NEARBY = 10.0  # such an excess that nobody need hear of [m]: loads are set down, and drones land near their winch
LARGEST_PART_OF_DAMPING = 0.1  # E A h of backward Euler with fixed steps h over the damping of a segment [-]
MOST_OFF_CHORD = 0.05  # largest relative difference between the load on a catenary's shape and along its chord [-]
MOST_FALLBACKS = 0.01  # part of the last 1000 fixed steps that may be of lower order [-]
LARGEST_JUMP = 1e-3  # largest distance of the first step from the initialization, over the length [-]
MOST_OFF_BALANCE = 0.2  # largest difference of the initial tension from the force of a massless winch, relative [-]
STANDARD_GRAVITY = 9.81  # [m/s2] for the weight of a tether
LONGEST_USUAL_STEP = 10.0  # [s]
FASTEST_WINCH = 50.0  # [m/s]: several times as fast as winches of kites, cranes and gliders are
STATE_IMPOSSIBLE = "contains impossible numbers"

STRETCH, GROUND_ACCELERATION, KITE_ACCELERATION, GROUND_SPEED, KITE_SPEED, GROUND_RESIDUE, KITE_RESIDUE = range(7)
STIFF_AND_SLACK, WINCH_REELS_IN_SLACK, WINCH_TOO_LONG, GROUND_IGNORED, END_UNDER_GROUND = range(7, 12)
FIXED_STEP_DAMPS, FIXED_STEP_UNCONVERGED, UNRESOLVED, LOAD_OFF_CHORD, STIFF_STEP = range(12, 17)
FALLBACK_AT_STOP, FALLBACK_ON_GROUND, FALLBACK_HARD = range(17, 20)
GROUND_JUMP, KITE_JUMP, LENGTH_JUMP, STARTED_AT_REST, WINCH_OFF_BALANCE, FAST_WINCH, SLACK_PRESSES = range(20, 27)
LONG_STEP = 27
IDLE_REEL_OUT_SPEED, IDLE_WINCH_FORCE, IDLE_WINCH_LENGTH, IDLE_VELOCITY, IDLE_WIND, IDLE_DRUM = range(28, 34)
BROKE, IDLE_RELEASE, SLACK_AT_SHEAVE = range(34, at.WARNING_KINDS)

_ACCELERATION = (
    "the {end} end is accelerated by {value:.3g} m/s2, more than 1000 times gravity; check {end}_position and "
    "{end}_velocity for jumps and wrong units"
)
_SPEED = "the {end} end moves at {value:.3g} m/s, faster than sound; check its motion and the units"
_JUMP = (
    "the first step begins {value:.3g} m from where the initialization put the {end} end; set {end}_position before the "
    "initialization ends"
)
_IDLE = "{name} is {{value:.6g}} and has no effect: {why}"
_FALLBACK = (
    "{{percent:.2g}} % of the last 1000 fixed steps fell back to backward Euler, because {reason}; "
    "fallback_steps counts them; use a shorter fixed_step, or adaptive steps"
)
_RESIDUE = (
    "{end}_velocity contradicts {end}_position: it does not account for {percent:.0f} % of the displacement of the "
    "{end} end; set it to the rate of {end}_position, or end_velocities to 2 (derived)"
)
SENTENCES = {
    STRETCH: (
        "a segment is stretched by {strain:.3g} %; from {allowed:.3g} % on, most ropes break; check "
        "kite_position (initial_kite_position of a free kite end), ground_position, initial_length, reel_out_speed, "
        "winch_force, winch_length, diameter and axial_stiffness, and their units"
    ),
    GROUND_ACCELERATION: _ACCELERATION,
    KITE_ACCELERATION: _ACCELERATION,
    GROUND_SPEED: _SPEED,
    KITE_SPEED: _SPEED,
    GROUND_RESIDUE: _RESIDUE,
    KITE_RESIDUE: _RESIDUE,
    STIFF_AND_SLACK: (
        "a segment with an axial_stiffness of {value:.3g} N is slack; above {stiff:.0e} N a tether that goes slack and taut "
        "again rings, and its tensions then lie far above and below their mean; set axial_stiffness to at most {stiff:.0e} "
        "N, which is as good as inextensible, or fixed_step to a few ms, which damps the ringing"
    ),
    WINCH_REELS_IN_SLACK: (
        "the winch pulls with {value:.3g} N at a slack tether and reels it in faster and faster; check initial_length, the "
        "positions of the ends, the sign of winch_force and winch_mass, or give the winch more winch_damping"
    ),
    WINCH_TOO_LONG: (
        "the length that the winch follows is {value:.3g} m longer than the distance of the ends, by more than {excess:.3g} "
        "%; unless the tether is to hang slack, check winch_length (initial_length where it is 0 at the start) and the "
        "positions of the ends for wrong units and offsets"
    ),
    GROUND_IGNORED: (
        "the tether hangs {value:.3g} m below ground_height with both ends above it; set ground_contact to 2 (flat) to let "
        "it lie on the ground, or ground_height to where the ground is"
    ),
    END_UNDER_GROUND: (
        "a driven end of the tether is {value:.3g} m below ground_height, where the ground does not support it; check "
        "kite_position, ground_position and ground_height"
    ),
    FIXED_STEP_DAMPS: (
        "backward Euler with this fixed_step damps like an additional axial_damping of {value:.3g} N.s, more than {part:g} "
        "% of what the tether has; set fixed_step_method to 1 (second_order), or use a shorter fixed_step"
    ),
    FIXED_STEP_UNCONVERGED: (
        "a fixed step of {value:.3g} s was ended at its bound on factorizations before it converged; its work is bounded, "
        "but its result may be inaccurate; check the inputs for jumps, or use a shorter fixed_step"
    ),
    UNRESOLVED: (
        "the relative_tolerance asks for more internal steps than a communication step may have; it was done with fixed "
        "steps of {value:.3g} s, which damp faster axial waves; use a shorter communication step, a larger "
        "relative_tolerance, fewer segments, more axial_damping, less axial_stiffness, or a fixed_step of your own"
    ),
    LOAD_OFF_CHORD: (
        "the load on the shape of the catenary differs by {percent:.2g} % from the load along its chord, so "
        "its forces may be "
        "wrong by more than {off:g} %; use the quasi-steady tether, or a shorter tether_length"
    ),
    STIFF_STEP: (
        "fixed steps of {value:.3g} s are too long for the axial oscillation of a tether with an "
        "axial_stiffness from {stiff:.0e} N on: its tension oscillates too little, or not at all; use a "
        "shorter fixed_step, or adaptive "
        "steps"
    ),
    FALLBACK_AT_STOP: _FALLBACK.format(reason="the drum of the winch came to rest or to a stop"),
    FALLBACK_ON_GROUND: _FALLBACK.format(reason="the tether met the ground too fast for them"),
    FALLBACK_HARD: _FALLBACK.format(reason="they did not converge, or gained energy"),
    GROUND_JUMP: _JUMP,
    KITE_JUMP: _JUMP,
    LENGTH_JUMP: (
        "the first step asks for a winch_length that is {value:.3g} m from the length of the start; set winch_length before "
        "the initialization ends"
    ),
    STARTED_AT_REST: (
        "no shape was found that moves with its ends, so the tether starts at rest (static_equilibrium) while they move; "
        "its first tensions contain this jump"
    ),
    WINCH_OFF_BALANCE: (
        "the tether pulls with {value:.3g} N at the start, more than {off_balance:g} % off from winch_force, which a winch "
        "without winch_mass removes abruptly; set winch_start to 2 (equilibrium), or another initial_length"
    ),
    FAST_WINCH: (
        "the winch runs at {value:.3g} m/s, more than {fastest:g} m/s; speeds of a winch are in m/s: check reel_out_speed, "
        "winch_force and winch_length for mm/s, m/min and revolutions per minute"
    ),
    SLACK_PRESSES: (
        "a slack segment presses its ends apart with {value:.3g} N, more than the tether weighs; a rope cannot do that: set "
        "slack_damping_ratio (and slack_stiffness_ratio) to less, or use more segments"
    ),
    LONG_STEP: "a communication step is {value:g} s long, more than {long:g} s; steps are in s: 20 ms are 0.02",
    IDLE_REEL_OUT_SPEED: _IDLE.format(name="reel_out_speed", why="winch_control is not 1 (speed)"),
    IDLE_WINCH_FORCE: _IDLE.format(name="winch_force", why="winch_control is not 2 (force)"),
    IDLE_WINCH_LENGTH: _IDLE.format(name="winch_length", why="winch_control is not 3 (length)"),
    IDLE_VELOCITY: _IDLE.format(name="the velocity of an end", why="end_velocities is 2 (derived)"),
    IDLE_WIND: _IDLE.format(name="wind_velocity", why="wind_at gives the wind"),
    IDLE_DRUM: (
        "a parameter of the drum (winch_start, winch_mass, winch_damping, winch_friction or longest_length) is set and has "
        "no effect: winch_control is not 2 (force)"
    ),
    BROKE: (
        "segment {segment:.0f}, counted from the winch, broke {time:.6g} s after the start under {value:.6g} N; from then "
        "on the tether keeps its length, and no other segment breaks"
    ),
    IDLE_RELEASE: _IDLE.format(name="release", why="this tether cannot let go; the dynamic one can"),
    SLACK_AT_SHEAVE: (
        "the tension at a sheave is {value:.3g} N below 0; a rope without tension leaves its sheave, which is not modelled: "
        "check the lengths and loads of the portions beside it"
    ),
}
_END = dict.fromkeys((GROUND_ACCELERATION, GROUND_SPEED, GROUND_RESIDUE, GROUND_JUMP), "ground")


def facts(kind):
    """Constant values in the sentence of a kind."""
    return {
        "end": _END.get(kind, "kite"),
        "allowed": 100.0 * (LARGEST_STRETCH - 1.0),
        "stiff": STIFF,
        "excess": 100.0 * LARGEST_EXCESS,
        "off": 100.0 * MOST_OFF_CHORD,
        "part": 100.0 * LARGEST_PART_OF_DAMPING,
        "off_balance": 100.0 * MOST_OFF_BALANCE,
        "fastest": FASTEST_WINCH,
        "long": LONGEST_USUAL_STEP,
    }


def bits(number, count):
    """A number of a state as a set of so many bits; ValueError for an invalid number."""
    if not (0.0 <= number < 1 << count and number == int(number)):
        raise ValueError(STATE_IMPOSSIBLE)
    return int(number)


def kinds(state):
    """Kinds that were implausible since the start of a state, a set of bits; ValueError for an impossible number."""
    return bits(state[at.WARNINGS], at.WARNING_KINDS)


def worst(states, warned):
    """For states (dict), sets of bits of the notes for which each is the worst state, except bits in `warned`."""
    found = dict.fromkeys(states, 0)
    for kind in SENTENCES:
        values = {k: state[at.WARNED_VALUES + kind] for k, state in states.items() if kinds(state) >> kind & 1}
        if values and not warned >> kind & 1:
            found[max(values, key=values.get)] |= 1 << kind
    return found


def sentences(state, new):
    """Sentences on implausible behaviour since the start of a state, for kinds with a bit in `new`."""
    return [
        sentence.format(
            **facts(kind),
            value=state[at.WARNED_VALUES + kind],
            percent=100.0 * state[at.WARNED_VALUES + kind],
            segment=state[at.TORN_SEGMENT],
            time=state[at.TORN_AT],
            strain=100.0 * (state[at.WARNED_VALUES + kind] - 1.0),
        )
        for kind, sentence in SENTENCES.items()
        if new >> kind & 1
    ]
