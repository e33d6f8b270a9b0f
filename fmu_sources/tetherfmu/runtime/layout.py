"""Place of each number in the flat arrays that shells and kernels exchange.

All arrays contain 64-bit floats. Three-vectors occupy three consecutive places (x, y, z).

=============  ======================================================================
`parameters`   scalars of the whole chain, then one array per segment property
`inputs`       values that the importer sets before a communication step
`state`        everything needed to continue: saving a tether is saving this array
`outputs`      values that the importer reads after a communication step, then the shape
`work`         scratch space of the kernels; its content is undefined between calls
=============  ======================================================================

The kernels freeze these numbers.
"""

from . import inputs, outputs
from .enumerations import *  # noqa: F403 - for those who look for them here, as the kernels do
from .limits import (  # noqa: F401 - likewise
    COARSE_WORK,
    DEEPEST_START,
    ITERATION_BUDGET,
    LARGEST_INPUT,
    LARGEST_INTEGER,
    LONGEST_STEP,
    MAX_SEGMENTS,
    MAX_WIND_POINTS,
    MIN_SEGMENT_LENGTH,
    NO_STOP,
    SHORTEST_PART,
    WORK_BUDGET,
)
from .parameters import PER_SEGMENT, RECORDS, FreeKite
from .quantities import quantities

# parameters: first the scalars in the order of their records: GRAVITY is the place of gravity; quantities with
# one number per segment or node are not there
_FOR_EACH = (*PER_SEGMENT, "kite_mass")
_SCALARS = [name for record in (*RECORDS, FreeKite) for name, _ in quantities(record) if name not in _FOR_EACH]
globals().update({name.upper(): place for place, name in enumerate(_SCALARS)})
# then numbers that are not tether parameters
GROUND_IS_FREE = len(_SCALARS)
KITE_IS_FREE = GROUND_IS_FREE + 1
CALM_LAYER = GROUND_IS_FREE + 2  # thickness [m] of a layer above z = 0, 0 but in `kernels/rest/homotopy.py`
WIND_POINTS = GROUND_IS_FREE + 3  # number of points with a wind input, 0 for none
# of a broken or released line while a kernel runs, see `kernels/equations/torn.py`
TORN_NOW = GROUND_IS_FREE + 4  # number of the segment without load, from 1 on; 0 for none
WHOLE_STIFFNESS, WHOLE_DAMPING, WHOLE_DRAG_WIDTH = TORN_NOW + 1, TORN_NOW + 2, TORN_NOW + 3  # its earlier values
WHOLE_CONTROL = TORN_NOW + 4  # `winch_control` before the winch was braked
CAN_BREAK = TORN_NOW + 5  # 1 if any segment has a breaking force
WINCH_IS_BRAKED = TORN_NOW + 6  # 1 if the line, or another portion of its rope, broke
# of a portion that broke while a kernel runs, see `kernels/equations/parts.py`
IS_PARTED = TORN_NOW + 7  # 1 if it is in two parts, each with the rope of its own end
FIRST_ENDS, SECOND_BEGINS = TORN_NOW + 8, TORN_NOW + 9  # nodes where the first part ends and the second one begins
REST_BETWEEN = TORN_NOW + 10  # unstretched length in neither part [m]
FIRST_PASSING = TORN_NOW + 11  # 1 if it has a first part, else 0
WHOLE_SHARE, WHOLE_DENSITY = TORN_NOW + 12, TORN_NOW + 13  # earlier values of all its segments
# of a portion of a line over sheaves, see `kernels/points/room.py`; the sheave is at its end
IS_PORTION = TORN_NOW + 14  # 1 for the first portion, 2 for later ones, else 0
BEHIND_SHEAVE = 2.0
ROUNDED_STOP = 1e-6  # of its length: how far below the shortest one it may have stopped
GIVEN_PORTION = IS_PORTION + 1  # its unstretched length at the start [m]; 0: as the tensions at rest share the line
SHEAVE_MASS = IS_PORTION + 2  # J/r2 [kg]
SHEAVE_FRICTION = IS_PORTION + 3  # Coulomb friction of the rope on the sheave [-]
SHEAVE_EFFICIENCY = IS_PORTION + 4  # tension on the incoming side over tension on the other side [-]
# of a line with a force-controlled winch and sheaves or shared winches, see `kernels/points/coordinates.py`
MOST_HOLDERS = 3  # largest number of winches that drive a line
HELD_BY = IS_PORTION + 5  # numbers of the lines with the drums that drive it, from 1 on; 0 for none
HELD_RATIO = HELD_BY + MOST_HOLDERS  # rope of it for each metre that those drums pay out [-]
PULLS_BACK = HELD_RATIO + MOST_HOLDERS  # 1 if the drum that it carries may need a force below 0, as a ratio of it is
# of a line whose sections or point masses divide it, see `kernels/packing.py`
LENGTH_BEYOND = PULLS_BACK + 1  # unstretched length beyond the section at the winch, which reeling keeps [m]; else 0
LEAST_LENGTH = LENGTH_BEYOND + 1  # unstretched length of the line whose shortest segments are MIN_SEGMENT_LENGTH [m]
PARAMETER_SCALARS = LEAST_LENGTH + 1
# then one array of n numbers per property of a segment, in this order ...
SHARE = 0  # of the section at the winch, which alone changes its length [-]; 0 beyond it
STIFFNESS = 1  # E A [N]
DAMPING = 2  # damping constant times length [N s]
LINE_DENSITY = 3  # mass per unstretched length [kg/m]
DRAG_WIDTH = 4  # drag coefficient times diameter [m]
STRENGTH = 5  # breaking force [N]; 0: unbreakable
OFFSET = 6  # unstretched length beyond the section at the winch [m]; 0 in it
SEGMENT_PROPERTIES = 7
# ... then the n + 1 extra point masses of the nodes [kg] ...
# ... and last the wind at the nodes [m/s]: n + 1 numbers along x, along y, along z, read if WIND_PROFILE is AT_NODES

# inputs and outputs in the order of their tables: KITE_FORCE is the place of kite_force; OUTPUT_ is the prefix of
# an output with the name of an input
globals().update({name.upper(): place for name, place in inputs.PLACES.items()})
INPUTS = inputs.COUNT
for _name, _place in outputs.PLACES.items():
    globals()[f"{'OUTPUT_' if _name in inputs.PLACES else ''}{_name.upper()}"] = _place
SHAPE = outputs.PLACES["shape"]  # the last one: its size is a build option
# after the shape, for a portion of a line over sheaves: its length, the tensions at its ends, and for the sheave at
# its end the passed rope and the speed
PORTION_LENGTH, PORTION_TENSION_FROM, PORTION_TENSION_TO, SHEAVE_PAYOUT, SHEAVE_RATE, PORTION_OUTPUTS = range(6)

# after the inputs of the table, with wind points: the wind at each of them [m/s]

# state: header, then node positions, then node velocities, then room for the additional node of a released line;
# with wind points the winds there at the end of the last step [m/s], then their derivatives set for the next
# step [m/s2]
WARNING_KINDS = 37
MOST_PAST, PAST_SIZE = 12, 7  # past positions that a state keeps, and numbers of each
LENGTH = 0  # unstretched [m]
REELING = 1  # rate of the unstretched length at the end of the last step [m/s]
WIND = 2  # wind of the last step [m/s]
SOLVER_STEP = 5  # internal step that the solver would try next [s], 0 before the first
SOLVER_ERROR = 6  # error estimate of the last accepted step, for the PI rule; else `step_control.UNRESOLVED`
LAST_STEP = 7  # last communication step [s], 0 before the first
# inputs with estimated rates, at the start of the last communication step: velocities of the kite end
# and of the ground end, for a free end see `places_of_load`; load; reel-out speed, winch force, unused
LAST_RATED = 8
LAST_KITE_VELOCITY, LAST_GROUND_VELOCITY = LAST_RATED, LAST_RATED + 3
LAST_REEL_OUT_SPEED, LAST_WINCH_FORCE = LAST_RATED + 9, LAST_RATED + 10
# their rates over about a quarter of the longest step, used in place of the last one after a much shorter step
RECENT_RATES = LAST_RATED + 12
STEPS = RECENT_RATES + 12  # internal steps accepted since the start
REJECTIONS = STEPS + 1  # internal steps rejected since the start
ITERATIONS = STEPS + 2  # Newton iterations for shapes in equilibrium since the start
GROUND_TENSION_VECTOR = 35  # [N] of the catenary, and of a chain in equilibrium if positions do not determine it, else 0
KITE_TENSION_VECTOR = 38  # the same at the kite of a chain; force on the kite of a catenary
MISSING_TENSION = 41  # [N] of the same chain: error of the largest tension from positions
LYING_LENGTH = MISSING_TENSION  # of the catenary: unstretched length on the ground [m]
LAST_KITE_POSITION = 42  # input at the start of the last communication step
LAST_GROUND_POSITION = 45
KITE_RESIDUE = 48  # displacement [m] of the kite that its velocities do not explain, and two numbers, see `plausibility.py`
GROUND_RESIDUE = 53
WARNINGS = 58  # sum of 2**k, k of all that was implausible since the start, see `runtime/plausibility.py`
WARNED_VALUES = 59  # for each k the value that was, 0 without
LAST_WINCH_LENGTH = WARNED_VALUES + WARNING_KINDS  # input at the start of the last communication step [m]
LONGEST_SO_FAR = LAST_WINCH_LENGTH + 1  # longest communication step since the start [s]
# remaining correction times [s] of the ground end, the kite end and the length, see `end_motion.py`
CORRECTIONS_LEFT = LONGEST_SO_FAR + 1
FALLBACKS = CORRECTIONS_LEFT + 3  # fixed steps of lower order than requested, since the start
RECENT_FALLBACKS = FALLBACKS + 1  # part of about the last 1000 fixed steps that they are [-]
PEAK_SO_FAR = FALLBACKS + 2  # largest tension [N] after the internal steps but the last of the last communication step
ACCELERATION = FALLBACKS + 3  # rate of REELING at the end of the last step [m/s2]
TENSION_AT_DRUM = FALLBACKS + 4  # [N], where the rope leaves a drum that feels its flow; 0 of other winches
TORN_SEGMENT = FALLBACKS + 5  # number of the broken segment, from 1 on; 0 for none
LET_GO = TORN_SEGMENT + 1  # 1 after the release of the last end: the line then has one more node
TORN_AT, LET_GO_AT = TORN_SEGMENT + 2, TORN_SEGMENT + 3  # times [s] of breaking and of release since the start; 0 before
TORN_ENERGY = TORN_SEGMENT + 4  # energy [J] lost by breaking and release: spring energy of the broken segment
CLOCK = TORN_SEGMENT + 5  # time since the start [s]
GIVEN_DERIVATIVES = TORN_SEGMENT + 6  # sum of 2**k over the inputs k with derivatives set for the next step
INPUT_DERIVATIVES = GIVEN_DERIVATIVES + 1  # those derivatives [1/s times the unit of the input], in the order of the inputs
# of a portion of a line over sheaves, else 0; the sheave is at its end
PAYOUT = INPUT_DERIVATIVES + INPUTS  # rope that has run over the sheave since the start [m]
SHEAVE_SPEED = PAYOUT + 1  # rate of it [m/s]
SHEAVE_ACCELERATION = PAYOUT + 2  # rate of that [m/s2]
TENSION_FROM = PAYOUT + 3  # at its start and at its end [N]
TENSION_TO = PAYOUT + 4
START_ACCELERATION = PAYOUT + 5  # of the free points where it begins and ends, at a sheave [m/s2]; else 0
END_ACCELERATION = PAYOUT + 8
# of the drum on a line, see `kernels/points/coordinates.py`, else 0: payout since the start [m]
DRUM_PAYOUT = PAYOUT + 11
DRUM_SPEED = PAYOUT + 12  # rate of it [m/s]
DRUM_ACCELERATION = PAYOUT + 13  # rate of that [m/s2]
# of a portion that broke or has a loose end, see `kernels/equations/parts.py`: what ran off; unstretched length of its
# second part [m]; rope lumped where it broke at the ends of both parts, and at loose ends [m]
RUN_OFF, SECOND_PART, FIRST_LUMP, SECOND_LUMP, START_LUMP, END_LUMP = range(PAYOUT + 14, PAYOUT + 20)
# past values of quantities known by positions only, the latest first, see `kernels/equations/past.py`: times between
# successive values [s], then for each the kite position, the ground position and the length input of the winch [m]
PAST_TIMES = PAYOUT + 20
PAST_VALUES = PAST_TIMES + MOST_PAST
STATE_HEADER = PAST_VALUES + PAST_SIZE * MOST_PAST

NO_TENSION = -1e300  # [N]: the PEAK_SO_FAR of no internal step
NEVER, AT_ROWS, ALWAYS = 0, 1, 2  # when `fly` computes outputs


def parameters_size(segments):
    """Length of the `parameters` array [-] of a tether with this number of segments: room for one more."""
    return PARAMETER_SCALARS + SEGMENT_PROPERTIES * (segments + 1) + 4 * (segments + 2)


def node_winds_at(segments):
    """First place of the wind at the nodes in the `parameters` array of a tether with this number of segments."""
    return PARAMETER_SCALARS + SEGMENT_PROPERTIES * segments + segments + 1


def inputs_size(wind_points):
    """Length of the `inputs` array [-] for this number of wind points."""
    return INPUTS + 3 * wind_points


def nodes_end(segments):
    """Place after the nodes in the `state` array of a tether that has not been released."""
    return STATE_HEADER + 6 * (segments + 1)


def state_size(segments, wind_points=0):
    """Length of the `state` array [-] for these numbers of segments and wind points.

    With room for one more node.
    """
    return STATE_HEADER + 6 * (segments + 2) + 6 * wind_points


def outputs_size(shape_points, is_portion=False):
    """Length of the `outputs` array [-] with this number of shape points, also of a portion of a line over sheaves."""
    return SHAPE + 3 * shape_points + (PORTION_OUTPUTS if is_portion else 0)
