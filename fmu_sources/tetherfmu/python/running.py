"""Common base of a tether and a system of tethers in the Python API: running lines and their properties."""

from __future__ import annotations

from contextlib import contextmanager
from copy import deepcopy
from pickle import PicklingError
from warnings import warn

import numpy as np

from tetherfmu.records import arguments
from tetherfmu.records.problems import PlausibilityWarning, StepRefused
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.instance import Instance
from tetherfmu.runtime.kernel_library import Kernels
from tetherfmu.runtime.limits import most_of_a_step

from . import compiled_flight


class Running:
    """Lines in an `Instance`, once they are started; a subclass has `_make`, which makes it, `get_state` and `set_state`."""

    _instance: Instance
    _runs: bool = False
    _kernels: Kernels | None = None  # kernels that replace those of the installation
    _made: tuple = ()  # attributes that `_make` makes, so anew in a copy

    def __getstate__(self):
        """Content of a copy: all attributes but the arrays, and the state if it runs."""
        kept = {name: value for name, value in vars(self).items() if name not in self._made}
        return kept, self.get_state() if self._runs else None

    def __setstate__(self, kept):
        """Be a copy."""
        attributes, state = kept
        vars(self).update(attributes)
        self._make()
        if state is not None:
            self.set_state(state)

    def __deepcopy__(self, memo):
        """An independent copy in the same state; both share their stateless kernels."""
        memo[id(self._kernels)] = self._kernels
        memo[id(self)] = other = object.__new__(type(self))
        other.__setstate__(deepcopy(self.__getstate__(), memo))
        return other

    __copy__ = deepcopy

    def __reduce_ex__(self, protocol):
        """For pickle; PicklingError if the kernels are not those of the installation."""
        if self._kernels is not None:
            raise PicklingError(
                f"this {type(self).__name__} was made with its own kernels; only without them can it be pickled"
            )
        return super().__reduce_ex__(protocol)

    @property
    def implausible(self) -> list[str]:
        """Sentences on what has been implausible since the start, each also a `PlausibilityWarning`."""
        return self._instance.said()

    @property
    def counters(self) -> dict[str, int]:
        """Work since the start: dict of accepted steps, rejected steps, and Newton iterations for shapes."""
        state, first = self._instance.state, self._instance.states_at
        iterations = sum(state[place + at.ITERATIONS] for place in first)
        return {"steps": int(state[at.STEPS]), "rejections": int(state[at.REJECTIONS]), "iterations": int(iterations)}

    @property
    def most_factorizations(self) -> int:
        """Bound on the factorizations of each line for one fixed step; 0 with adaptive steps, which have none."""
        numbers = [self._instance.parameters_of(k) for k in range(len(self._instance.lines))]
        if numbers[0][at.FIXED_STEP] == 0.0:
            return 0
        is_sought = any(each[at.WINCH_CONTROL] in at.WITH_DRUM or each[at.IS_PORTION] != 0.0 for each in numbers)
        return most_of_a_step(numbers[0][at.FIXED_STEP_METHOD] == at.BACKWARD_EULER, is_sought)

    @contextmanager
    def _all_or_nothing(self):
        """Restore inputs and parameters if the block is refused."""
        instance = self._instance
        before = instance.values[: instance.outputs_at], instance.parameters[:]
        try:
            yield
        except ValueError:
            instance.values[: instance.outputs_at], instance.parameters[:] = before
            raise

    def _refuse(self, problem):
        """StepRefused if there is a problem with a start or a step."""
        if problem:
            raise StepRefused(problem, self._instance.status)

    def _check_started(self):
        """StepRefused before `initialize`."""
        if not self._runs:
            raise StepRefused(f"this {type(self).__name__} is not initialized: call initialize first")

    def _motion(self, k=0):
        """View of the positions [m] and velocities [m/s] of the nodes of line k, array (2, segments + 1, 3)."""
        self._check_started()
        state, segments = self._instance.states_at[k], self._instance.counts[k]
        nodes = segments + 1 + int(self._instance.state[state + at.LET_GO])
        first = state + at.STATE_HEADER
        moving = np.frombuffer(self._instance.state)[first : first + 6 * nodes].reshape(2, nodes, 3)
        return moving[:, : segments + 1]

    def _warn(self, deeper=0):
        """Warn the caller of a public method of implausible behaviour, each once since the start.

        deeper : number of calls between that method and the caller of this.
        """
        for sentence in self._instance.warnings():
            warn(sentence, PlausibilityWarning, stacklevel=3 + deeper)

    def _fly(self, inputs, step, every, when, on_refusal, flown_of, winds=None):
        """Implementation of `fly`; flown_of : converts the result of `compiled_flight.fly` and the times of rows."""
        if on_refusal not in compiled_flight.ON_REFUSAL:
            names = ", ".join(map(repr, compiled_flight.ON_REFUSAL))
            raise ValueError(f"on_refusal is {on_refusal!r}; it must be one of {names}")
        every = arguments.whole("every", every)
        found = compiled_flight.fly(self._instance, inputs, step, every, when, on_refusal == "skip", winds)
        times = np.cumsum(step) if np.ndim(step) else step * np.arange(1, len(inputs) + 1)  # at the end of each step [s]
        count = len(found[0].motion[0])
        flown, refusals = flown_of(*found, times[every - 1 :: every][:count] if every else times[:0]), found[-1]
        self._warn(deeper=1)
        if refusals and on_refusal == "raise":
            ((place, problem, status),) = refusals
            raise StepRefused(f"step {place + 1} of {len(inputs)}: {problem}", status, flown)
        return flown
