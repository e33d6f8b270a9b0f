"""Descent in a fixed step, for all lines and free points together, bounded as described in `backward_euler.py`.

The incremental potential is the sum of the line potentials. All lines of a free point use the same free flight,
with the load and mass of the whole point; each line contributes the mass of its half segment there, so that

    sum_k m_k |x - y|^2/(2 h^2) = M |x - y|^2/(2 h^2),   y = x0 + h v0 + h^2 (gravity + load/M),   M = sum_k m_k

Each iteration is a Newton iteration for all nodes, with the inner nodes of each line condensed as in `step.py`. A
shortened step applies to all lines, and the iteration ends when all have converged. The matrices are positive definite,
and so are their Schur complements at the points.
"""

from math import inf, sqrt

from tetherfmu.runtime import layout as at

from ..arrays import copy
from ..compilation import kernel
from ..equations import flow, segment
from ..equations.assembly import longest_part
from ..equations.free_points import rows_of
from ..equations.ground import has_ground
from ..equations.lines import lines_of, parameters_of, segments_of
from ..equations.properties import rest_length
from ..line import incremental_potential
from ..line.backward_euler import MOST_HALVINGS, MOST_IN_WHOLE, WHOLE
from ..line.strand_room import GOAL
from ..linear_algebra import condensed
from ..linear_algebra.vectors import dot, get, sub
from . import fixed
from .room import any_line, attempt_of, columns_of, moves, numbers_of, scratch_of

# phases of an iteration: from LATE on drum speeds change only if the lines converge with them, from HELD on the
# ground friction is frozen at the previous iteration
EARLY, LATE, HELD = 0, 1, 2
STUCK = -1.0  # in place of the step fraction: no fraction lowers Phi
LEAST_JUDGED = 0.5**MOST_HALVINGS  # a displacement that is shortened further is judged as if it were not

# --- potential and its minimum


@kernel
def does_any_flow(system, step):
    """Whether rope flows past the nodes of any line, whose flow forces change in each iteration."""
    count = 0
    for k in range(lines_of(system)):
        count += moves(system, k) and flow.flows(attempt_of(system, k, step).chain)
    return count > 0


@kernel
def potential(system, step, is_trial):
    """Phi [J] of all lines at the iterate or at the trial positions, and its rounding error [J]."""
    total, rounding = 0.0, 0.0
    for k in range(lines_of(system)):
        if moves(system, k):
            w = scratch_of(system, k)
            own, error = incremental_potential.potential(attempt_of(system, k, step), w.trial if is_trial else w.x, w)
            total += own
            rounding += error
    return total, rounding


@kernel
def condense_line(system, k, step, phase):
    """Matrix and forces of the iteration of line k, condensed to its ends; False if it is singular.

    phase : EARLY, LATE or HELD.
    """
    w, rows = scratch_of(system, k), rows_of(system, k)
    incremental_potential.linearize(attempt_of(system, k, step), w.x, phase == HELD, w)
    if not condensed.condense(rows, w.matrix, columns_of(system, k)):
        return False
    condensed.solve_inner(rows, w.matrix, w.move)
    return True


@kernel
def take_moves(system, step):
    """Copy the solved displacements of all lines (modified); returns the fraction to try."""
    taken = 1.0
    for k in range(lines_of(system)):
        if moves(system, k):
            w = scratch_of(system, k)
            copy(w.trial, w.move)
            taken = min(taken, longest_part(attempt_of(system, k, step).chain, w.move))
    return taken


@kernel
def direction(system, step, phase):
    """Newton displacement of all nodes [m], with the coordinate speeds (modified); returns the fraction to try, 0: singular.

    phase : EARLY, LATE or HELD. Late in the iteration speeds change only if the lines converge with them.
    """
    for k in range(lines_of(system)):
        if moves(system, k) and not condense_line(system, k, step, phase):
            return 0.0
    fixed.begin_moves(system, step)
    if not step.turns or phase >= LATE:
        fixed.seek(system, step.h, True)
        if not fixed.solve_with(system, step):
            return 0.0
        if not step.turns:
            return take_moves(system, step)
        if farthest(system) > 0:
            fixed.leave_speeds(system)
            return take_moves(system, step)
    if not fixed.find_moves(system, step):
        return 0.0
    return take_moves(system, step)


@kernel
def farthest(system):
    """Number of lines that have not converged, with the trial positions as displacements [m]."""
    count = 0
    for k in range(lines_of(system)):
        if moves(system, k):
            count += is_far(system, k, scratch_of(system, k).trial, 1.0)
    return count


@kernel
def descend(system, step, before, phase):
    """One iteration of all lines (modified) from Phi = `before` [J], inf if unknown.

    phase : EARLY, LATE or HELD.  Returns Phi [J] and the step fraction: STUCK, or inf if a matrix is singular.
    """
    taken = direction(system, step, phase)
    if taken == 0.0:
        return before, inf
    if (
        (step.turns and fixed.has_changed(system))
        or before == inf
        or step.kind != WHOLE
        or has_ground(parameters_of(system, 0))
        or does_any_flow(system, step)
    ):
        before, _ = potential(system, step, False)
    return go_along(system, step, taken, before)


@kernel
def try_part(system, taken):
    """Trial positions [m] (modified) after a fraction of the displacement."""
    for k in range(lines_of(system)):
        if moves(system, k):
            w = scratch_of(system, k)
            for i in range(len(w.move)):
                w.trial[i] = w.x[i] + taken * w.move[i]


@kernel
def is_limp(system, k):
    """Whether slack segments of line k do not push."""
    return parameters_of(system, k)[at.SLACK_STIFFNESS_RATIO] == 0.0


is_any_limp = any_line(is_limp)


@kernel
def go_along(system, step, taken, before):
    """Move all lines (modified) by this fraction, halved until Phi decreases; returns the results of `descend`.

    In a whole step, near the transition of a stiff segment that does not push, only a small fraction may lower Phi.
    """
    most = MOST_IN_WHOLE if step.kind == WHOLE and is_any_limp(system) else MOST_HALVINGS
    judged = LEAST_JUDGED * taken
    for _ in range(most + 1):
        try_part(system, taken)
        now, rounding = potential(system, step, True)
        if now <= before + rounding:
            take_trial(system)
            return now, max(taken, judged)
        taken *= 0.5
    return before, STUCK


@kernel
def take_trial(system):
    """Accept the trial positions as iterate (modified)."""
    for k in range(lines_of(system)):
        if moves(system, k):
            w = scratch_of(system, k)
            copy(w.trial, w.x)


@kernel
def is_unconverged(system, k, taken):
    """Whether this fraction of the last displacement moves a node of line k further than the convergence limit."""
    return is_far(system, k, scratch_of(system, k).move, taken)


@kernel
def is_far(system, k, move, taken):
    """Whether this fraction of any displacement [m] of line k does."""
    square = 0.0
    for i in range(segments_of(system, k) + 1):
        square = max(square, dot(get(move, i), get(move, i)))
    return taken * sqrt(square) > numbers_of(system, k)[GOAL]


@kernel
def unconverged_lines(system, taken):
    """Number of lines that have not converged."""
    count = 0
    for k in range(lines_of(system)):
        if moves(system, k):
            count += is_unconverged(system, k, taken)
    return count


@kernel
def holds(system, step):
    """Whether all springs still have the mode for which the matrix was built."""
    for k in range(lines_of(system)):
        if moves(system, k):
            w, chain = scratch_of(system, k), attempt_of(system, k, step).chain
            for s in range(chain.n):
                r, rest = sub(get(w.x, s + 1), get(w.x, s)), rest_length(chain, s)
                if segment.beyond_rest(r, rest) * w.held[s] < 0.0:
                    return False
    return True


@kernel
def rests_on_ground(system, step):
    """Whether ground support and friction of all nodes are unchanged since the last iteration."""
    for k in range(lines_of(system)):
        if moves(system, k) and has_ground(parameters_of(system, k)):
            w = scratch_of(system, k)
            if not incremental_potential.rests_on_ground(attempt_of(system, k, step), w.x, w):
                return False
    return True
