"""Running lines, one tether or a system: the entry points, their flat arrays, and their refusal messages.

The FMI slaves and the Python API run them. Arrays: `plan_layout.py`.
"""

import re
from array import array
from functools import reduce
from math import dist, inf
from operator import or_
from typing import NamedTuple

from . import layout as at
from . import plan_layout as places
from . import plausibility, status
from .saved_state import check_state

OF_ALL_LINES = (  # the same pairs for a sentence about all lines of a system
    ("kite_position, ground_position", "POINT.position"),
    ("kite_position", "POINT.position"),
    ("the kite_load", "a load (POINT.load)"),
)
_KITE_MOTION = range(at.KITE_POSITION, at.KITE_VELOCITY + 3)  # places of the motion of the kite end among the inputs


def zeros(count):
    """Array of `count` doubles."""
    return array("d", bytes(8 * count))


def address(numbers):
    """Address of an array, which stays as long as its length."""
    return numbers.buffer_info()[0]


def renamed(said, words):
    """A sentence with other words, pairs; where several fit, the first one counts, and names with a dot stay."""
    own = dict(words)
    pattern = f"(?<![\\w.])(?:{'|'.join(map(re.escape, own))})"
    return re.sub(pattern, lambda found: own[found[0]], said) if own else said


class RunningLine(NamedTuple):
    """Constant properties of a running line."""

    name: str  # in messages; "" of a tether alone
    inputs: tuple  # names of its inputs by their places
    shape_points: int
    wind_points: int = 0  # number of points with a wind input; 0 for none, at least 2 otherwise
    start_point: int = places.DRIVEN  # number of the free point at its start
    end_point: int = places.DRIVEN
    is_through: bool = False  # whether it continues over a sheave at its end as the next line
    is_portion: bool = False  # whether it is a portion of such a line
    may_carry_drum: bool = False  # whether it may carry a drum that is shared or used with sheaves
    words: tuple = ()  # pairs of a phrase about a tether and its replacement in the system

    @property
    def outputs_size(self):
        """Length of its outputs."""
        return at.outputs_size(self.shape_points, self.is_portion)


class Instance:
    """Lines that are set up, started, and advanced step by step; a refused start or step keeps states and outputs.

    kernels : `kernel_library.Kernels`.  lines : tuple of `RunningLine`.  free : names of the free points, a tuple.
    band : of their matrix, see `wiring/ordering.py`.  room : places for the caller after inputs and outputs in `values`.

    values : array of inputs, outputs (from `outputs_at` on) and `room` places (from `parameters_at` on), at a fixed
    address. The caller sets the inputs.
    plan, parameters, state, before, work : arrays; `before` contains the states before the last start or step. A `set_up`
    for other numbers of segments makes new ones.
    counts, segments : of each line, a tuple, and of all together; empty and 0 before they are set up.
    status : of the last start or step, see `status.py`.
    """

    def __init__(self, kernels, lines, free=(), band=0, room=0):
        self.kernels, self.lines, self.free = kernels, lines, free
        self.plan = array("q", bytes(8 * places.plan_size(len(lines))))
        self.plan[places.LINES], self.plan[places.FREE_POINTS], self.plan[places.BAND] = len(lines), len(free), band
        for row, line in zip(self._rows(), lines, strict=True):
            self.plan[row + places.START_POINT], self.plan[row + places.END_POINT] = line.start_point, line.end_point
            self.plan[row + places.SHAPE_POINTS] = line.shape_points
            self.plan[row + places.WIND_POINTS], self.plan[row + places.THROUGH] = line.wind_points, line.is_through
            self.plan[row + places.DRUM] = line.may_carry_drum
        self.outputs_at = sum(at.inputs_size(line.wind_points) for line in lines) + 3 * len(free)
        self.parameters_at = self.outputs_at + sum(line.outputs_size for line in lines)
        self.values, self.state = zeros(self.parameters_at + room), zeros(0)
        self.counts, self.segments, self.status = (), 0, status.OK
        self._warned, self._portions = [0] * len(lines), [[]]  # the latter of each line that may run over sheaves
        for k, line in enumerate(lines):
            self._portions[-1].append(k)
            if not line.is_through and k + 1 < len(lines):
                self._portions.append([])

    def _rows(self):
        """First places of the lines in the plan."""
        return range(places.PLAN_HEADER, len(self.plan), places.LINE_NUMBERS)

    def set_up(self, counts, parameters, sought=()):
        """Set segments and parameters of all lines, see `packing`, and allocate the arrays; a start must follow.

        sought : pairs of a place in the plan and whether the free point there is sought.
        """
        self.parameters = parameters
        if counts != self.counts:
            self.counts, self.segments = counts, sum(counts)
            for row, segments in zip(self._rows(), counts, strict=True):
                self.plan[row + places.SEGMENTS] = segments
            self.kernels.complete(address(self.plan))
            self.state, self.before = zeros(self.plan[places.STATE_SIZE]), zeros(self.plan[places.STATE_SIZE])
            self.work = zeros(self.plan[places.WORK_SIZE])
            self.states_at = [self.plan[row + places.STATE_AT] for row in self._rows()]
        for place, is_sought in sought:
            self.plan[place] = is_sought
        for row, line in zip(self._rows(), self.lines, strict=True):
            if line.wind_points:
                first = self.plan[row + places.PARAMETERS_AT]
                parameters[first + at.WIND_POINTS], parameters[first + at.WIND_PROFILE] = line.wind_points, at.AT_NODES
        inputs = address(self.values)
        self._fixed = address(self.plan), address(parameters), inputs
        self._changing = *map(address, (self.state, self.before)), inputs + 8 * self.outputs_at, address(self.work)
        self._found = self._changing[0], *self._changing[2:]

    def state_size(self, segments):
        """Length of the state array for this total number of segments."""
        empty = sum(at.state_size(0, line.wind_points) for line in self.lines)
        return empty + at.state_size(segments) - at.state_size(0)

    def parameters_of(self, k):
        """View of the parameters of line k and all later ones."""
        return memoryview(self.parameters)[self.plan[self._rows()[k] + places.PARAMETERS_AT] :]

    def inputs_at(self, k):
        """First place of the inputs of line k among the values."""
        return sum(at.inputs_size(line.wind_points) for line in self.lines[:k])

    def state_of(self, k):
        """Copy of the state of line k."""
        return self.state[slice(*(*self.states_at, len(self.state))[k : k + 2])]

    def start(self):
        """Find the initial shapes between the input ends. Returns the problem, or None."""
        values = self.values[: self.parameters_at]
        self.before[:] = self.state
        self.status = self.kernels.initialize(*self._fixed, *self._found)
        if self.status == status.OK:
            self._warned = [0] * len(self.lines)
            return None
        problem = self.sentence(self.status, 0.0, at_start=True)  # with the length that was tried
        self.state[:] = self.before
        self.values[: self.parameters_at] = values
        return problem

    def advance(self, step):
        """Do a communication step of `step` [s] with the inputs at its start. Returns the problem, or None."""
        self.status = self.kernels.advance(*self._fixed, step, *self._changing)
        return None if self.status == status.OK else self.sentence(self.status, step)

    def take_outputs(self):
        """Compute the outputs that belong to the states; returns the status."""
        return self.kernels.outputs(*self._fixed, *self._found)

    def take(self, state):
        """Continue from states, an array of their size; implausible behaviour noted in them causes no second warning.

        ValueError, with no change, if its notes contain invalid numbers.
        """
        own = [state[first:end] for first, end in zip(self.states_at, (*self.states_at[1:], len(state)), strict=True)]
        for each in own:
            check_state(each)
        self._warned = [warned | plausibility.kinds(each) for warned, each in zip(self._warned, own, strict=True)]
        self.state[:] = state

    def warnings(self):
        """Sentences on implausible behaviour since the start, each once per line, with the name of its worst portion."""
        said = []
        for portions in self._portions:
            if any(self.state[self.states_at[k] + at.WARNINGS] != self._warned[k] for k in portions):
                said += self._said_of(portions, [self._warned[k] for k in portions])
                for k in portions:
                    self._warned[k] |= plausibility.kinds(self.state_of(k))
        return said

    def said(self):
        """All of these sentences since the start."""
        return [each for portions in self._portions for each in self._said_of(portions, [0])]

    def _said_of(self, portions, warned):
        """Of the portions of a line, a list, the unreported notes; warned : sets of bits."""
        states = {k: self.state_of(k) for k in portions}
        worst = plausibility.worst(states, reduce(or_, warned))
        return [self._about(k, each) for k in portions for each in plausibility.sentences(states[k], worst[k])]

    def _about(self, k, said):
        """A sentence on line k."""
        line = self.lines[k]
        return f"the line {line.name}: {renamed(said, line.words)}" if line.name else said

    def sentence(self, result, step, at_start=False):
        """Message of a status about a step [s] with the current inputs and unstretched lengths."""
        about, place = self.plan[places.STATUS_LINE], status.index(result)
        if status.code(result) == status.NO_EQUILIBRIUM_OF_POINT:
            return status.sentence(result, name=self.free[place])
        if about == places.ALL_LINES and status.code(result) == status.INPUT_NOT_FINITE:
            first = self.outputs_at + 3 * (place - len(self.free))
            return status.sentence(result, name=f"{self.free[place]}.load", value=self.values[first : first + 3].tolist())
        k = max(about, 0)
        line, parameters = self.lines[k], self.parameters_of(k)
        inputs = self.values[self.inputs_at(k) :]
        name = line.inputs[place] if place < len(line.inputs) else ""
        if at_start and not line.name and parameters[at.KITE_IS_FREE] != 0.0 and place in _KITE_MOTION:
            name = f"{name} at the start"  # which is no input
        segments = self.segments if about == places.ALL_LINES else self.counts[k]
        facts = facts_of(inputs, parameters, self.state[self.states_at[k] + at.LENGTH], segments)
        said = status.sentence(result, name=name, value=inputs[place], step=step, **facts)
        if about == places.ALL_LINES and line.name:
            return renamed(said, OF_ALL_LINES)
        return self._about(k, said)


def facts_of(inputs, parameters, length, segments):
    """Values for the sentence of a status, a dict; inputs, parameters : arrays.  length : unstretched now [m]."""
    longest = parameters[at.LONGEST_LENGTH]
    return {
        "reel_out_speed": inputs[at.REEL_OUT_SPEED],
        "winch_force": inputs[at.WINCH_FORCE],
        "winch_length": inputs[at.WINCH_LENGTH],
        "friction": parameters[at.WINCH_FRICTION],
        "ground_height": parameters[at.GROUND_HEIGHT],
        "shortest_stop": parameters[at.SHORTEST_LENGTH],
        "least_length": parameters[at.LEAST_LENGTH],
        "longest_stop": inf if longest == at.NO_STOP else longest,
        "length": length,
        "distance": dist(*(inputs[place : place + 3] for place in (at.KITE_POSITION, at.GROUND_POSITION))),
        "relative_tolerance": parameters[at.RELATIVE_TOLERANCE],
        "fixed_step": parameters[at.FIXED_STEP],
        "budget": at.ITERATION_BUDGET // segments,
    }
