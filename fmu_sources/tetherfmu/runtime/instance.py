"""One running tether: the entry points of its variant, its flat arrays (`layout.py`), and what it says when it refuses.

The FMI slave and the Python API both run it.
"""

from array import array
from math import dist, inf

from . import layout as at
from . import plausibility, status
from .saved_state import check_state
from .variables import input_names, parameters_at

_KITE_MOTION = range(at.KITE_POSITION, at.KITE_VELOCITY + 3)  # places of the motion of the kite end among the inputs
OUTPUTS_AT = at.INPUTS  # first place of the outputs in `Instance.values` without wind points; the inputs are before them


def zeros(count):
    """Array of so many doubles."""
    return array("d", bytes(8 * count))


def address(doubles):
    """Address of an array, which stays as long as its length."""
    return doubles.buffer_info()[0]


class Instance:
    """A tether that is set up, started, and advanced step by step; a refused start or step keeps state and outputs.

    Parameters
    ----------
    kernels : kernel_library.Kernels
        Entry points of the variant.
    points : int
        Points of the output `shape`.
    room : int
        Places for the caller behind inputs and outputs in `values`.
    wind_points : int
        Points at which the wind is an input; 0 for none, at least 2 otherwise.

    Attributes
    ----------
    values : array
        Inputs, outputs (from `outputs_at` on) and `room` places (from `parameters_at` on), at the same address for life. The
        caller sets the inputs.
    parameters, state, before, work : array
        As `layout.py` has them; `before` is the state of before the last start or step. A `set_up` for another number of
        segments makes new arrays.
    segments : int
        0 before it is set up.
    status : int
        Status of the last start or step, see `status.py`.
    """

    def __init__(self, kernels, points, room=0, wind_points=0):
        self.kernels = kernels
        self.points = points
        self.wind_points = wind_points
        self.segments = 0
        self.status = status.OK
        self._warned = 0
        self.outputs_at, self.parameters_at = at.inputs_size(wind_points), parameters_at(points, wind_points)
        self.values = zeros(self.parameters_at + room)
        self.state = zeros(0)
        self._inputs_address = address(self.values)
        self._outputs_address = self._inputs_address + 8 * self.outputs_at

    def set_up(self, segments, parameters):
        """Take a number of segments and their parameters, see `packing`, and make the arrays; it is to be started next."""
        self.parameters = parameters
        if self.wind_points:
            parameters[at.WIND_POINTS], parameters[at.WIND_PROFILE] = self.wind_points, at.AT_NODES
        if segments != self.segments:
            self.segments = segments
            self.state = zeros(self.state_size(segments))
            self.before = zeros(len(self.state))
            self.work = zeros(self.kernels.work_size(segments))
        self._parameters_address = address(self.parameters)
        self._state_address, self._before_address = address(self.state), address(self.before)
        self._work_address = address(self.work)

    def state_size(self, segments):
        """Length of the state array of so many segments."""
        return at.state_size(segments, self.wind_points)

    def start(self):
        """Find the first shape between the ends that the inputs give. Returns what is wrong, or None."""
        outputs = self.values[self.outputs_at : self.parameters_at]
        self.before[:] = self.state
        self.status = self.kernels.initialize(
            *(self.segments, self._parameters_address, self._inputs_address, self._state_address),
            *(self.points, self._outputs_address, self._work_address),
        )
        if self.status == status.OK:
            self._warned = 0
            return None
        free = self.parameters[at.KITE_IS_FREE] != 0.0
        problem = self.sentence(self.status, 0.0, free)  # with the length that was tried
        self.state[:] = self.before
        self.values[self.outputs_at : self.parameters_at] = outputs
        return problem

    def advance(self, step):
        """Do a communication step of `step` [s] with the inputs at its start. Returns what is wrong, or None."""
        self.status = self.kernels.advance(
            *(self.segments, self._parameters_address, self._inputs_address, step, self._state_address),
            *(self._before_address, self.points, self._outputs_address, self._work_address),
        )
        return None if self.status == status.OK else self.sentence(self.status, step)

    def take_outputs(self):
        """Compute the outputs that belong to the state; returns the status."""
        return self.kernels.outputs(
            *(self.segments, self._parameters_address, self._state_address),
            *(self.points, self._outputs_address, self._work_address),
        )

    def take(self, state):
        """Continue from a state, an array of its size; there is no second warning of what was implausible in it.

        ValueError, and nothing is changed, if it says so in numbers that no state has.
        """
        check_state(state)
        self._warned |= plausibility.kinds(state)
        self.state[:] = state

    def warnings(self):
        """Sentences on what has been implausible since the start, each once."""
        if self.state[at.WARNINGS] == self._warned:  # as nearly always
            return ()
        new = plausibility.sentences(self.state, self._warned)
        self._warned |= plausibility.kinds(self.state)
        return new

    def sentence(self, result, step, free=False):
        """What a status says about a step [s] with the inputs and the unstretched length of now.

        free : whether the motion of the kite end is that of a free one at the start, which is no input.
        """
        place = status.index(result)
        name = input_names(self.wind_points)[place]
        return status.sentence(
            result,
            name=f"{name} at the start" if free and place in _KITE_MOTION else name,
            value=self.values[place],
            step=step,
            **facts_of(self.values, self.parameters, self.state[at.LENGTH], self.segments),
        )


def facts_of(inputs, parameters, length, segments):
    """What the sentence of a status may ask for, a dict; inputs, parameters : arrays.  length : unstretched now [m]."""
    longest = parameters[at.LONGEST_LENGTH]
    return {
        "reel_out_speed": inputs[at.REEL_OUT_SPEED],
        "winch_force": inputs[at.WINCH_FORCE],
        "winch_length": inputs[at.WINCH_LENGTH],
        "friction": parameters[at.WINCH_FRICTION],
        "shortest_stop": parameters[at.SHORTEST_LENGTH],
        "longest_stop": inf if longest == at.NO_STOP else longest,
        "length": length,
        "distance": dist(*(inputs[place : place + 3] for place in (at.KITE_POSITION, at.GROUND_POSITION))),
        "relative_tolerance": parameters[at.RELATIVE_TOLERANCE],
        "fixed_step": parameters[at.FIXED_STEP],
        "budget": at.ITERATION_BUDGET // segments,
    }
