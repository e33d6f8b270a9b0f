"""What the FMUs of the examples share: variables from declarations, inputs along a step, steps that are refused, states.

A model declares inputs, outputs and records of parameters, and computes first and next outputs from plain numbers. Its
inputs belong to the start of a communication step and its outputs to the end, as those of a tether. `input_continuation` is
how the inputs go on within the step:

    linear        on from their last to their present value
    held          as they are
    interpolated  from their last to their present value: for an importer that gives inputs of the end of the step
"""

from array import array
from dataclasses import dataclass, replace
from itertools import chain
from math import isfinite, nan
from types import SimpleNamespace

from tetherfmu.fmi.base_slave import BaseSlave
from tetherfmu.fmi.resources import options_in
from tetherfmu.runtime import layout, saved_state, status
from tetherfmu.runtime.limits import SHORTEST_LAST_STEP
from tetherfmu.runtime.quantities import Quantity, check, checked, quantity
from tetherfmu.runtime.saved_state import STEPPING, SavedState
from tetherfmu.wiring.variables import Variable, parameters_of

LINEAR, HELD, INTERPOLATED = 1, 2, 3


class Refused(ValueError):
    """Why a model cannot do a step, or cannot start."""


@dataclass(frozen=True)
class Coupling:
    """How the inputs of a model continue within a communication step."""

    input_continuation: int = quantity(
        LINEAR,
        "",
        "continuation of the inputs within a step",
        choices={
            "linear": "extrapolated linearly from their last two values",
            "held": "held as they are",
            "interpolated": "interpolated from the last to the present value, for importers that give inputs of the end of "
            "the step",
        },
    )

    def __post_init__(self):
        check(self)


def scalar(causality, name, unit, meaning, *limits, start=None, depends_on=(), kind="Real"):
    """A list of one variable; limits : minimum and maximum."""
    return [Variable(name, causality, kind, Quantity(unit, meaning, *limits), 0, start, depends_on)]


def vector(causality, name, unit, meaning, start=(None, None, None), depends_on=()):
    """Three variables, x, y and z."""
    named = ((f"{name}[{i}]", f"{meaning}, {axis}") for i, axis in enumerate("xyz", start=1))
    return [
        Variable(each, causality, "Real", Quantity(unit, text), 0, first, depends_on)
        for (each, text), first in zip(named, start, strict=True)
    ]


def names(*variables):
    """Names of all variables of some lists, for `depends_on`."""
    return tuple(variable.name for each in variables for variable in each)


class ModelSlave(BaseSlave):
    """An FMU of the examples. A model sets the attributes, and has `first` and `next`."""

    inputs = ()
    outputs = ()  # lists of variables
    records = ()  # classes of parameters; their quantities are looked up in `self.parameters`
    left_out = ()  # parameters in them that this model does not have
    vectors = ()  # lists of further parameters
    memory = 0  # numbers that it keeps beside its outputs

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        given = [variable for each in self.inputs for variable in each]
        found = [variable for each in self.outputs for variable in each]
        self._classes = (*self.records, Coupling)
        known = [each for each in parameters_of(self._classes) if each.name not in self.left_out]
        known += [variable for each in self.vectors for variable in each]
        options = options_in(self.resources)
        starts = dict(options.get("starts", ()))
        listed = enumerate((*given, *found, *known))
        table = [replace(each, start=starts.get(each.name, each.start), place=k) for k, each in listed]
        self._limited = [(k, each) for k, each in enumerate(given) if each.quantity.range() != "a finite number"]
        # places in `values`: inputs, outputs, parameters; then, of the last step, inputs and length; what the model keeps
        declared, last_step = len(table), len(table) + len(given)
        self._given, self._computed = slice(0, len(given)), slice(len(given), len(given) + len(found))
        self._parameters_at, self._last_inputs = slice(self._computed.stop, declared), slice(declared, last_step)
        self._last_step, self._memory = last_step, slice(last_step + 1, last_step + 1 + self.memory)
        self.declare(table, array("d", bytes(8 * self._memory.stop)), options)
        self._warned = set()
        self._sentences = []

    # --- what a model has

    def first(self, inputs):
        """Outputs and memory (tuples) at the start."""
        raise NotImplementedError

    def next(self, begin, end, step, outputs, memory):
        """Outputs and memory (tuples) at the end of a step [s], from the inputs at its begin and end (lists).

        outputs, memory : of the end of the step before. Refused says why the step cannot be done.
        """
        raise NotImplementedError

    def warn(self, sentence):
        """Warn after this step, once since the start."""
        if sentence not in self._warned:
            self._warned.add(sentence)
            self._sentences.append(sentence)

    # --- what `BaseSlave` asks for

    def start(self):
        """Check parameters and inputs, and compute the first outputs. Returns what is wrong, or None."""
        try:
            self.parameters = self._parameters(self.values)
        except ValueError as error:
            return str(error)
        inputs = list(self.values[self._given])
        problem = self._problem_of_inputs(inputs) or self._taken(lambda: self.first(inputs))
        if not problem:
            self._remember(inputs, 0.0)
        return problem

    def advance(self, step):
        """One communication step [s]. Returns what is wrong, with nothing changed, or None."""
        if not (isfinite(step) and 0.0 < step <= layout.LONGEST_STEP):
            return status.sentence(status.STEP_NOT_POSITIVE, step=step)
        inputs = list(self.values[self._given])
        problem = self._problem_of_inputs(inputs)
        if problem:
            return problem
        begin, end = self._along(inputs, self.values[self._last_inputs], self.values[self._last_step], step)
        outputs, memory = self.values[self._computed], self.values[self._memory]
        problem = self._taken(lambda: self.next(begin, end, step, outputs, memory))
        if not problem:
            self._remember(inputs, step)
        return problem

    def _remember(self, inputs, step):
        """Keep the inputs and the length [s] of a step for the next one."""
        self.values[self._last_inputs] = array("d", inputs)
        self.values[self._last_step] = step

    def _along(self, inputs, last, last_step, step):
        """Inputs at the begin and at the end of a step."""
        continuation = self.parameters.input_continuation
        if continuation == HELD:
            return inputs, inputs
        if continuation == INTERPOLATED:
            return list(last), inputs
        ratio = step / max(last_step, SHORTEST_LAST_STEP * step) if last_step > 0.0 else 0.0  # held in the first step
        return inputs, [now + (now - before) * ratio for now, before in zip(inputs, last, strict=True)]

    def _problem_of_inputs(self, inputs):
        for k, value in enumerate(inputs):
            if not -layout.LARGEST_INPUT <= value <= layout.LARGEST_INPUT:  # also if it is no number
                return status.sentence(status.INPUT_NOT_FINITE, name=self.table[k].name, value=value)
        for k, variable in self._limited:
            if not variable.quantity.allows(inputs[k]):
                return f"the input {variable.name} is {inputs[k]}; it must be {variable.quantity.range()}"
        return None

    def _taken(self, compute):
        """Take the outputs and the memory that a model computes. Returns what is wrong, with nothing taken, or None."""
        try:
            outputs, memory = compute()
        except Refused as problem:
            return str(problem)
        except (ArithmeticError, ValueError):  # of the functions of `math`
            outputs, memory = (nan,), ()
        if not all(map(isfinite, (*outputs, *memory))):
            return f"the motion overflowed; check the inputs {', '.join(self._large())}"
        self.values[self._computed] = array("d", outputs)
        self.values[self._memory] = array("d", memory)
        return None

    def _large(self):
        """The three largest inputs, in words."""
        order = sorted(range(self._given.stop), key=lambda k: -abs(self.values[k]))
        return [f"{self.table[k].name} = {self.values[k]:g}" for k in order[:3]]

    def warnings(self):
        """Warnings of the last step, taken away."""
        said, self._sentences = self._sentences, []
        return said

    # --- parameters and state

    def _parameters(self, values):
        """All parameters by name; ValueError names one that is out of range."""
        found = {}
        for variable, number in zip(self.table[self._parameters_at], values[self._parameters_at], strict=True):
            value = checked(variable.name, number, variable.quantity)
            found[variable.name] = int(value) if variable.kind != "Real" else value
        for record in self._classes:
            record(**{name: found[name] for name in record.__dataclass_fields__ if name in found})
        return SimpleNamespace(**found)

    def state_to_bytes(self):
        """The whole state as bytes."""
        return saved_state.to_bytes(SavedState(type(self).__name__, self.phase, 0, 0.0, self.time, self.values, array("d")))

    def state_from_bytes(self, blob):
        """Go back to a state; ValueError, with nothing changed, if it is none of this model."""
        saved = saved_state.from_bytes(blob, type(self).__name__, len(self.values), lambda segments: 0)
        for variable, value in zip(self.table, saved.values, strict=False):
            if variable.kind != "Real" and not abs(value) <= layout.LARGEST_INTEGER:
                raise ValueError(f"has a wrong number ({variable.name} is {value}; it must be an integer)")
        if saved.phase >= STEPPING:
            computed = saved.values[self._computed], saved.values[self._last_step :]
            if not all(map(isfinite, chain(*computed))):
                raise ValueError("has numbers that no model has")
            try:
                self.parameters = self._parameters(saved.values)
            except ValueError as error:
                raise ValueError(f"has a wrong parameter ({error})") from None
        self.phase, self.time = saved.phase, saved.time
        self.values[:] = saved.values
