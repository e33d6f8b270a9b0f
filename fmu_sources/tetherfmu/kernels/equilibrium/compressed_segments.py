"""A slack chain in equilibrium with compressed segments: pseudo-transient continuation with tensions of either sign.

In a fold that hangs straight up and down, the segment at the bottom stands across and is compressed by the weight of its
neighbours. Its stiffness across, T/l, is below zero, and the others hold it. Newton's method in `newton.py` keeps T above
zero: there T falls by a factor in each iteration, and in the end nothing holds the segment across. If the chain is so stiff
that the positions have not come to rest by then, they never do.

Here T may change its sign, while it falls to a part of its size. What is found is an equilibrium, but it may be unstable,
as it may be with any compressed segment. So implicit steps of the linear equations are made from it with a fixed damping c,

    (c - dF/dx) dx_next = c dx,

in which an unstable motion grows: 0 < lambda < 2 c for an eigenvalue lambda of dF/dx. If one does, the chain is moved along
it, and sought again from there. Source: docs/models/numerics.md, "Initial shape".
"""

from math import inf

from ..compilation import kernel
from ..equations import assembly
from ..linear_algebra.vectors import add_scaled, get, put
from . import compliance, newton
from .rigid_body import SPRINGS, loads

SLOWEST_GROWTH = 5.0  # a compression grows to no more than this times its size in one iteration
MOST_TRIALS = 3  # equilibria that are looked at
GROWTH_DAMPING = 10.0  # c over the stiffness that the loads alone give a node
GROWTH_STEPS = 1000  # of which the second half shows whether a motion grows
AWAY = 0.1  # how far an unstable equilibrium is left, over the length of a segment


@kernel
def change_tensions(taken, w):
    """Change w.tension [N] (modified) by a part of the way to w.aim, through zero only at a part of its size."""
    for s in range(len(w.tension)):
        now = w.tension[s]
        lowest = -newton.SLOWEST_SLACKENING * now if now > 0.0 else SLOWEST_GROWTH * now
        w.tension[s] = max(now + taken * (w.aim[s] - now), lowest)


@kernel
def relax(body, load_stiffness, w):
    """Pseudo-transient continuation from the positions of the body [m] and w.tension [N] (both modified).

    load_stiffness : stiffness [N/m] that the loads alone give a node, the first pseudo-damping. Returns (found, iterations).
    """
    n = body.chain.n
    damping = load_stiffness
    loosest = newton.LOOSEST * load_stiffness * body.chain.length / n
    for iteration in range(newton.MOST_PSEUDO_STEPS):
        loads(body, SPRINGS, w.tension, w.mass, w.force)
        residual = newton.residual_norm(n, w.force)
        if residual <= newton.smallest_residual(body, w):
            return True, iteration
        if not residual < inf or not newton.step_by_compliance(body, loosest, damping, w):
            return False, iteration
        taken = assembly.longest_part(body.chain, w.move)
        change_tensions(taken, w)
        damping = newton.changed_damping(damping, newton.move_nodes(body, taken, w), 0.0, load_stiffness)
    return False, newton.MOST_PSEUDO_STEPS


@kernel
def grows(body, load_stiffness, w):
    """Whether any small motion of the body in equilibrium grows; it is left in w.move, of the norm 1 (modified)."""
    n = body.chain.n
    damping = GROWTH_DAMPING * load_stiffness
    loosest = newton.LOOSEST * load_stiffness * body.chain.length / n
    loads(body, SPRINGS, w.tension, w.mass, w.force)
    newton.step_by_compliance(body, loosest, damping, w)  # for the records of where the body is
    for k in range(3, 3 * n):
        w.move[k] = (k * k) % 7 - 3.0  # a motion without any symmetry
    growth = 1.0
    for step in range(GROWTH_STEPS):
        size = newton.residual_norm(n, w.move)
        if step > GROWTH_STEPS // 2:
            growth *= size
        for k in range(3, 3 * n):
            w.force[k] = damping / size * w.move[k]
        compliance.solve(body, damping, w)
    size = newton.residual_norm(n, w.move)
    for k in range(3, 3 * n):
        w.move[k] /= size
    return not growth * size <= 1.0


@kernel
def find(body, load_stiffness, w):
    """Stable equilibrium from a first guess in the body [m] and w.tension [N] (both modified): (found, iterations).

    load_stiffness : see `relax`.
    """
    away = AWAY * body.chain.length / body.chain.n
    iterations = 0
    for _ in range(MOST_TRIALS):
        found, more = relax(body, load_stiffness, w)
        iterations += more
        if not found:
            return False, iterations
        if not grows(body, load_stiffness, w):
            return True, iterations
        for i in range(1, body.chain.n):
            put(body.x, i, add_scaled(get(body.x, i), away, get(w.move, i)))
    return False, iterations
