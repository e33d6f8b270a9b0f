"""The entry points: the only functions that shells call. Numbers and pointers to flat arrays, nothing else.

Layout of the arrays: `layout.py`. Return values: `status.py`. These are the functions that are compiled ahead of time.
"""

from numba import carray, types

from . import dynamic
from .layout import INPUTS
from .workspace import outputs_size, parameters_size, state_size, work_size


def entry_point(signature):
    """Mark an entry point with its signature; `compilation.compile_entry_point` compiles it."""

    def mark(function):
        function.signature = signature
        return function

    return mark


_DOUBLES = types.CPointer(types.float64)
_COUNT = types.int64
_STATUS = types.int32


@entry_point(_STATUS(_COUNT, _DOUBLES, _DOUBLES, _DOUBLES, _DOUBLES))
def dynamic_initialize(n, parameters, inputs, state, work):
    """First state (modified) of a dynamic tether with n segments; see `dynamic.initialize`."""
    return dynamic.initialize(
        n,
        carray(parameters, parameters_size(n)),
        carray(inputs, INPUTS),
        carray(state, state_size(n)),
        carray(work, work_size(n)),
    )


@entry_point(_STATUS(_COUNT, _DOUBLES, _DOUBLES, types.float64, _DOUBLES, _DOUBLES))
def dynamic_advance(n, parameters, inputs, step, state, work):
    """One communication step of `step` [s] of a dynamic tether (state modified); see `dynamic.advance`."""
    return dynamic.advance(
        n,
        carray(parameters, parameters_size(n)),
        carray(inputs, INPUTS),
        step,
        carray(state, state_size(n)),
        carray(work, work_size(n)),
    )


@entry_point(_STATUS(_COUNT, _DOUBLES, _DOUBLES, _COUNT, _DOUBLES, _DOUBLES))
def dynamic_observe(n, parameters, state, shape_points, outputs, work):
    """Outputs (modified) of a dynamic tether; see `dynamic.observe`."""
    dynamic.observe(
        n,
        carray(parameters, parameters_size(n)),
        carray(state, state_size(n)),
        shape_points,
        carray(outputs, outputs_size(shape_points)),
        carray(work, work_size(n)),
    )
    return 0
