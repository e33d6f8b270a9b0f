"""Broken or released lines at the beginning and end of an entry point; the law is in `equations/torn.py`.

A line is released at the beginning of the first step in which its input `release` is true.
"""

from tetherfmu.runtime import layout as at
from tetherfmu.runtime import plan_layout as places
from tetherfmu.runtime import plausibility as limits
from tetherfmu.runtime.status import OK, RELEASED_WITHOUT_MASS

from ..compilation import kernel
from ..equations import parts, torn
from ..equations.free_points import is_at_point, point_at
from ..equations.lines import inputs_of, lines_of, motion_of, parameters_of, segments_of, state_of, with_states
from ..equations.properties import chain_of, point_mass_in, property_of, rest_length
from ..equations.ropes import first_of, goes_on, is_freed, is_portion
from ..linear_algebra.vectors import dot, get
from ..notes import note


@kernel
def mark_freed(system, k, freed):
    """Write into the plan (modified) whether line k was released."""
    system.plan[places.PLAN_HEADER + places.LINE_NUMBERS * k + places.FREED] = freed


@kernel
def tear(system, k, s):
    """Part line k in its parameters (modified) at segment s."""
    n, freed = segments_of(system, k), 1 if is_freed(system, k) else 0
    if not is_portion(system, k):
        torn.tear(n, s, parameters_of(system, k))
    elif 0 < s < n - freed - 1:  # in each state that is not forged
        parts.divide(n, freed, state_of(system, k), parameters_of(system, k))


@kernel
def mend(system, k):
    """Undo `tear` (parameters modified)."""
    parts.unite(segments_of(system, k), parameters_of(system, k))
    torn.mend(segments_of(system, k), parameters_of(system, k))


@kernel
def fit(system):
    """Adapt parameters and plan (modified) of all lines to their states."""
    for k in range(lines_of(system)):
        if torn.has_let_go(state_of(system, k)):
            torn.add_segment(segments_of(system, k), parameters_of(system, k))
            mark_freed(system, k, 1)
        broken = state_of(system, k)[at.TORN_SEGMENT]
        if 1.0 <= broken <= segments_of(system, k):
            tear(system, k, int(broken) - 1)
            parts.brake(parameters_of(system, first_of(system, k)))


@kernel
def unfit(system):
    """Restore parameters and plan (modified) of the whole lines."""
    for k in range(lines_of(system)):
        mend(system, k)
        parts.release_brake(parameters_of(system, k))
        if is_freed(system, k):
            torn.remove_segment(segments_of(system, k) - 1, parameters_of(system, k))
            mark_freed(system, k, 0)


@kernel
def has_rope(system, k, end):
    """Whether line k reaches its start (end 0) or its end (1): not after its release."""
    return end == 0 or not is_freed(system, k)


@kernel
def can_let_go(system, k):
    """Whether the support of the last end of line k can exist without it: it is driven, has mass, or holds another line."""
    n, parameters = segments_of(system, k), parameters_of(system, k)
    if not is_at_point(system, k, 1):
        return parameters[at.KITE_IS_FREE] == 0.0 or point_mass_in(parameters, n, n) > torn.NO_MASS
    count = 0
    for j in range(lines_of(system)):
        own, n = parameters_of(system, j), segments_of(system, j)
        for end in range(2):
            if point_at(system, j, end) == point_at(system, k, 1):
                count += point_mass_in(own, n, n * end) > torn.NO_MASS or (
                    has_rope(system, j, end) and not (j == k and end == 1)
                )
    return count > 0


@kernel
def energy_of_driven_node(system, k):
    """Kinetic energy [J] of the half segment at a driven last end of line k, which stays with the line; free ends: 0."""
    n, parameters, (_, v) = segments_of(system, k), parameters_of(system, k), motion_of(system, k)
    if is_at_point(system, k, 1) or parameters[at.KITE_IS_FREE] != 0.0:
        return 0.0
    chain = chain_of(n, parameters, state_of(system, k))
    return 0.25 * property_of(chain, n - 1, at.LINE_DENSITY) * rest_length(chain, n - 1) * dot(get(v, n), get(v, n))


@kernel
def is_released(system, k):
    """Whether a finite input releases line k; a rope has the input at its first portion, and is released at its last."""
    return not goes_on(system, k) and 0.0 < abs(inputs_of(system, first_of(system, k))[at.RELEASE]) <= at.LARGEST_INPUT


@kernel
def let_go(system, before):
    """Release the lines (modified) whose input requests it for the first time; a status.

    The states `before` (modified) get their additional nodes, too.
    """
    for k in range(lines_of(system)):
        state = state_of(system, k)
        if is_released(system, k) and not torn.has_let_go(state):
            if not can_let_go(system, k):
                system.plan[places.STATUS_LINE] = k
                return RELEASED_WITHOUT_MASS
            n = segments_of(system, k)
            state[at.TORN_ENERGY] -= energy_of_driven_node(system, k)
            torn.add_node(n, state)
            torn.add_node(n, state_of(with_states(system, before), k))
            broken = int(parameters_of(system, k)[at.TORN_NOW])
            mend(system, k)
            torn.add_segment(n, parameters_of(system, k))
            mark_freed(system, k, 1)
            if broken > 0:
                tear(system, k, broken - 1)
            state[at.LET_GO], state[at.LET_GO_AT] = 1.0, state[at.CLOCK]
    return OK


@kernel
def begin(system, before):
    """`fit` and `let_go` at the beginning of a step, with a copy of the states `before` (both modified); a status."""
    fit(system)
    return let_go(system, before)


@kernel
def end(system):
    """`unfit` at the end of a step (modified). If a release was rolled back, its additional node is removed."""
    for k in range(lines_of(system)):
        if is_freed(system, k) and not torn.has_let_go(state_of(system, k)):
            torn.remove_node(segments_of(system, k) - 1, state_of(system, k))
    unfit(system)


@kernel
def refuse(system):
    """Note in the state (modified) of a tether without release that its input `release` has no effect; returns OK."""
    release = system.inputs[at.RELEASE]
    note(system.state, limits.IDLE_RELEASE, release * release, 0.0)
    return OK
