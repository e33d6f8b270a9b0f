"""The entry points: the only functions that shells call. Numbers and pointers to flat arrays, nothing else.

Each variant has three: initialize, advance, observe. Layout of the arrays: `layout.py`; return values: `status.py`. They are
the functions that are compiled ahead of time, so each is written out: one that came from a factory could not be cached.
"""

from numba import carray, types

from tetherfmu.kernels.communication.inputs import check_outputs
from tetherfmu.kernels.variants import dynamic, lines, quasi_steady
from tetherfmu.runtime.layout import INPUTS

from .arrays import outputs_size, parameters_size, state_size, work_size

_DOUBLES = types.CPointer(types.float64)
_COUNT = types.int64
_INITIALIZE = types.int32(_COUNT, _DOUBLES, _DOUBLES, _DOUBLES, _DOUBLES)
_ADVANCE = types.int32(_COUNT, _DOUBLES, _DOUBLES, types.float64, _DOUBLES, _DOUBLES)
_OBSERVE = types.int32(_COUNT, _DOUBLES, _DOUBLES, _COUNT, _DOUBLES, _DOUBLES)


def _entry_point(signature):
    """Mark an entry point with its signature; `compilation.compile_entry_point` compiles it."""

    def mark(function):
        function.signature = signature
        return function

    return mark


@_entry_point(_INITIALIZE)
def dynamic_initialize(n, parameters, inputs, state, work):
    """First state (modified) of a dynamic tether; see `dynamic.initialize`."""
    return dynamic.initialize(
        n,
        carray(parameters, parameters_size(n)),
        carray(inputs, INPUTS),
        carray(state, state_size(n)),
        carray(work, work_size(n)),
    )


@_entry_point(_ADVANCE)
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


@_entry_point(_OBSERVE)
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
    return check_outputs(carray(outputs, outputs_size(shape_points)))


@_entry_point(_INITIALIZE)
def quasi_steady_initialize(n, parameters, inputs, state, work):
    """First state (modified) of a quasi-steady tether; see `quasi_steady.initialize`."""
    return quasi_steady.initialize(
        n,
        carray(parameters, parameters_size(n)),
        carray(inputs, INPUTS),
        carray(state, state_size(n)),
        carray(work, work_size(n)),
    )


@_entry_point(_ADVANCE)
def quasi_steady_advance(n, parameters, inputs, step, state, work):
    """One communication step of `step` [s] of a quasi-steady tether (state modified); see `quasi_steady.advance`."""
    return quasi_steady.advance(
        n,
        carray(parameters, parameters_size(n)),
        carray(inputs, INPUTS),
        step,
        carray(state, state_size(n)),
        carray(work, work_size(n)),
    )


@_entry_point(_OBSERVE)
def quasi_steady_observe(n, parameters, state, shape_points, outputs, work):
    """Outputs (modified) of a quasi-steady tether; see `quasi_steady.observe`."""
    quasi_steady.observe(
        n,
        carray(parameters, parameters_size(n)),
        carray(state, state_size(n)),
        shape_points,
        carray(outputs, outputs_size(shape_points)),
        carray(work, work_size(n)),
    )
    return check_outputs(carray(outputs, outputs_size(shape_points)))


@_entry_point(_INITIALIZE)
def catenary_initialize(n, parameters, inputs, state, work):
    """First state (modified) of a catenary; see `lines.initialize_catenary`."""
    return lines.initialize_catenary(
        n,
        carray(parameters, parameters_size(n)),
        carray(inputs, INPUTS),
        carray(state, state_size(n)),
        carray(work, work_size(n)),
    )


@_entry_point(_ADVANCE)
def catenary_advance(n, parameters, inputs, step, state, work):
    """One communication step of `step` [s] of a catenary (state modified); see `lines.advance_catenary`."""
    return lines.advance_catenary(
        n,
        carray(parameters, parameters_size(n)),
        carray(inputs, INPUTS),
        step,
        carray(state, state_size(n)),
        carray(work, work_size(n)),
    )


@_entry_point(_OBSERVE)
def catenary_observe(n, parameters, state, shape_points, outputs, work):
    """Outputs (modified) of a catenary; see `lines.observe_catenary`."""
    lines.observe_catenary(
        n,
        carray(parameters, parameters_size(n)),
        carray(state, state_size(n)),
        shape_points,
        carray(outputs, outputs_size(shape_points)),
        carray(work, work_size(n)),
    )
    return check_outputs(carray(outputs, outputs_size(shape_points)))


@_entry_point(_INITIALIZE)
def straight_initialize(n, parameters, inputs, state, work):
    """First state (modified) of a straight line; see `lines.initialize_straight`."""
    return lines.initialize_straight(
        n,
        carray(parameters, parameters_size(n)),
        carray(inputs, INPUTS),
        carray(state, state_size(n)),
        carray(work, work_size(n)),
    )


@_entry_point(_ADVANCE)
def straight_advance(n, parameters, inputs, step, state, work):
    """One communication step of `step` [s] of a straight line (state modified); see `lines.advance_straight`."""
    return lines.advance_straight(
        n,
        carray(parameters, parameters_size(n)),
        carray(inputs, INPUTS),
        step,
        carray(state, state_size(n)),
        carray(work, work_size(n)),
    )


@_entry_point(_OBSERVE)
def straight_observe(n, parameters, state, shape_points, outputs, work):
    """Outputs (modified) of a straight line; see `lines.observe_straight`."""
    lines.observe_straight(
        n,
        carray(parameters, parameters_size(n)),
        carray(state, state_size(n)),
        shape_points,
        carray(outputs, outputs_size(shape_points)),
        carray(work, work_size(n)),
    )
    return check_outputs(carray(outputs, outputs_size(shape_points)))
