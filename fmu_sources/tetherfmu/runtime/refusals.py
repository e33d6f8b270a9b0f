"""Sentences of an FMU on calls that it refuses or warns of; `status.py` and `plausibility.py` have the kernels' sentences.

The PythonFMU slave fills them in with `str.format`, the native one with the same names (`native/messages.c`).
"""

from .plausibility import STATE_IMPOSSIBLE  # noqa: F401

PHASES = ("before the initialization", "in initialization mode", "after the initialization", "after the termination")

CANNOT_BE_SET_UP = "the experiment cannot be set up {phase}"
CANNOT_BE_ENTERED = "initialization mode cannot be entered {phase}"
CANNOT_BE_LEFT = "initialization mode cannot be left {phase}"
CANNOT_BE_TERMINATED = "the FMU cannot be terminated {phase}"
NO_STEP_NOW = "a step cannot be done {phase}"
START_NOT_FINITE = "the start time is {start}; it must be a finite number"
STOP_BEFORE_START = "the stop time is {stop} s; it must not be before the start time of {start} s"
TOLERANCE_NOT_USED = "the importer's tolerance {tolerance} is not used; it must be greater than 0"
TIME_NOT_FINITE = "the communication point is {time}; it must be a finite number"
TIME_JUMPS = "the communication point is {time} s, the last step ended at {end} s; the FMU continues from there"
JUMP_OF_STEP, JUMP_OF_TIME = 1e-3, 1e-9  # parts of step and time: tolerance of communication points without a warning
STEP_REFUSED = "the step from {time} s is refused: {problem}"
PAST_THE_END = "a step of {step} s from {time} s would go beyond the stop time of {stop} s"

CANNOT_BE_READ = "value reference {reference} ({name}) cannot be read: it is not a variable of this type"
CANNOT_BE_SET = "value reference {reference} ({name}) cannot be set to {value}: it is not an input or parameter of this type"
UNKNOWN_VARIABLE = "no variable of this FMU"  # the name of any other value reference
IS_FIXED = "{name} cannot be set to {value} now; it is fixed when the initialization ends"
NOT_AFTER_THE_END = "{name} cannot be set to {value} after the termination"

STATE_REFUSED = "the FMU state that was set {problem}; the previous state is kept"
NO_STATE = "is not a tether state, or comes from another version"
STATE_DAMAGED = "is damaged"
STATE_OF_ANOTHER = "belongs to another tether FMU"
STATE_WRONG_TOLERANCE = "has the tolerance {tolerance}; it must be from 0 to {largest}"
STATE_WRONG_TIME = "has the time {time} s; it must be a finite number"
STATE_OTHER_CONSTANT = "has {value!r} for {name}, which is {expected!r} in this FMU and cannot be set"
STATE_WRONG_PARAMETER = "has a wrong parameter ({problem})"
NO_INTEGER = "{name} is {value}; it must be an integer"

# of the native FMU only: PythonFMU's library lets no slave answer these
IS_NULL = "the argument {argument} is NULL"
WRONG_TOKEN = "the guid or token is {token}; this FMU has {expected}"
NO_CO_SIMULATION = "this FMU is for co-simulation only"
NOT_OFFERED = "this FMU does not offer {what}; see the capability flags of its model description"
NO_SUCH_CATEGORY = "no log category is called {category}"
WRONG_COUNT = "{count} values were passed for variables that have {needed}"
NO_CONTINUOUS_INPUT = "value reference {reference} ({name}) cannot be used here: it is not a continuous input"
NO_CONTINUOUS_OUTPUT = "value reference {reference} ({name}) has no derivative: it is not a continuous output"
WRONG_ORDER = "the order of the derivative of {name} is {order}; it must be 1"
SHARED_DERIVATIVE = "the derivative of {name} cannot be used: it turns a line that another winch turns, too"
WRONG_DERIVATIVE = "the derivative of {name} is {value}; it must be a finite number of at most {largest} in magnitude"
WRONG_SEED = "the seed has {value}; it must be a finite number of at most {largest} in magnitude"
NOTHING_TO_DIFFERENTIATE = "there is no derivative: no step has been done since the start or since a state was set"
NO_DERIVATIVE = "there is no derivative: with other inputs the step is refused, or needs other internal steps"
NO_FMU_STATE = "this is not a state of this FMU"
SHORT_BUFFER = "the buffer has {count} bytes; the state has {needed}"
NO_MEMORY = "there is not enough memory"
