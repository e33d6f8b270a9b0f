"""The entry points: the only functions that shells call. Numbers and pointers to flat arrays, nothing else.

Each variant has three: initialize, advance, observe. Layout of the arrays: `layout.py`; return values: `status.py`. They are
the functions that are compiled ahead of time, so each is written out: one that came from a factory could not be cached.
"""

from numba import carray, types

from tetherfmu.runtime.layout import INPUTS

from .arrays import outputs_size, parameters_size, state_size, work_size
from .compilation import view
from .variants import catenary, dynamic, quasi_steady, straight

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


@view
def _chain_arrays(n, parameters, state, work):
    """The parameters, the state and the work as arrays."""
    return carray(parameters, parameters_size(n)), carray(state, state_size(n)), carray(work, work_size(n))


@_entry_point(_INITIALIZE)
def dynamic_initialize(n, parameters, inputs, state, work):
    """First state (modified) of a dynamic tether; see `dynamic.initialize`."""
    p, s, w = _chain_arrays(n, parameters, state, work)
    return dynamic.initialize(n, p, carray(inputs, INPUTS), s, w)


@_entry_point(_ADVANCE)
def dynamic_advance(n, parameters, inputs, step, state, work):
    """One communication step of `step` [s] of a dynamic tether (state modified); see `dynamic.advance`."""
    p, s, w = _chain_arrays(n, parameters, state, work)
    return dynamic.advance(n, p, carray(inputs, INPUTS), step, s, w)


@_entry_point(_OBSERVE)
def dynamic_observe(n, parameters, state, shape_points, outputs, work):
    """Outputs (modified) of a dynamic tether; see `dynamic.observe`."""
    p, s, w = _chain_arrays(n, parameters, state, work)
    return dynamic.observe(n, p, s, shape_points, carray(outputs, outputs_size(shape_points)), w)


@_entry_point(_INITIALIZE)
def quasi_steady_initialize(n, parameters, inputs, state, work):
    """First state (modified) of a quasi-steady tether; see `quasi_steady.initialize`."""
    p, s, w = _chain_arrays(n, parameters, state, work)
    return quasi_steady.initialize(n, p, carray(inputs, INPUTS), s, w)


@_entry_point(_ADVANCE)
def quasi_steady_advance(n, parameters, inputs, step, state, work):
    """One communication step of `step` [s] of a quasi-steady tether (state modified); see `quasi_steady.advance`."""
    p, s, w = _chain_arrays(n, parameters, state, work)
    return quasi_steady.advance(n, p, carray(inputs, INPUTS), step, s, w)


@_entry_point(_OBSERVE)
def quasi_steady_observe(n, parameters, state, shape_points, outputs, work):
    """Outputs (modified) of a quasi-steady tether; see `quasi_steady.observe`."""
    p, s, w = _chain_arrays(n, parameters, state, work)
    return quasi_steady.observe(n, p, s, shape_points, carray(outputs, outputs_size(shape_points)), w)


@_entry_point(_INITIALIZE)
def catenary_initialize(n, parameters, inputs, state, work):
    """First state (modified) of a catenary; see `catenary.initialize`."""
    p, s, w = _chain_arrays(n, parameters, state, work)
    return catenary.initialize(n, p, carray(inputs, INPUTS), s, w)


@_entry_point(_ADVANCE)
def catenary_advance(n, parameters, inputs, step, state, work):
    """One communication step of `step` [s] of a catenary (state modified); see `catenary.advance`."""
    p, s, w = _chain_arrays(n, parameters, state, work)
    return catenary.advance(n, p, carray(inputs, INPUTS), step, s, w)


@_entry_point(_OBSERVE)
def catenary_observe(n, parameters, state, shape_points, outputs, work):
    """Outputs (modified) of a catenary; see `catenary.observe`."""
    p, s, w = _chain_arrays(n, parameters, state, work)
    return catenary.observe(n, p, s, shape_points, carray(outputs, outputs_size(shape_points)), w)


@_entry_point(_INITIALIZE)
def straight_initialize(n, parameters, inputs, state, work):
    """First state (modified) of a straight line; see `straight.initialize`."""
    p, s, w = _chain_arrays(n, parameters, state, work)
    return straight.initialize(n, p, carray(inputs, INPUTS), s, w)


@_entry_point(_ADVANCE)
def straight_advance(n, parameters, inputs, step, state, work):
    """One communication step of `step` [s] of a straight line (state modified); see `straight.advance`."""
    p, s, w = _chain_arrays(n, parameters, state, work)
    return straight.advance(n, p, carray(inputs, INPUTS), step, s, w)


@_entry_point(_OBSERVE)
def straight_observe(n, parameters, state, shape_points, outputs, work):
    """Outputs (modified) of a straight line; see `straight.observe`."""
    p, s, w = _chain_arrays(n, parameters, state, work)
    return straight.observe(n, p, s, shape_points, carray(outputs, outputs_size(shape_points)), w)
