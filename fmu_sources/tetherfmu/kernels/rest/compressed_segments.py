"""A slack chain in equilibrium with compressed segments: pseudo-transient continuation with tensions of either sign.

In a fold that hangs straight down, the bottom segment lies across and is compressed by the weight of its neighbours. Its
lateral stiffness T/l is negative, and the other segments hold it. Newton's method with T > 0 reduces T by a factor in each
iteration, and finally nothing holds the segment laterally. If the chain is so stiff that the positions have not converged
by then, they never do. T may therefore change its sign here (`newton.EITHER_SIGN`).

The solution is an equilibrium, but it may be unstable, as with any compressed segment. So implicit steps of the
linear equations follow with a fixed damping c,

    (c - dF/dx) dx_next = c dx,

in which an unstable motion grows: 0 < lambda < 2 c for an eigenvalue lambda of dF/dx. If one does, the chain is moved along
it, and the search is repeated from there. Source: docs/models/numerics.md, "Initial shape".
"""

from ..compilation import kernel
from ..linear_algebra.vectors import add_scaled, get, put
from . import compliance, newton
from .rigid_body import SPRINGS, loads

MOST_TRIALS = 3  # number of equilibria to test
GROWTH_DAMPING = 10.0  # c over the load stiffness of a node
GROWTH_STEPS = 1000  # the second half shows whether a motion grows
AWAY = 0.1  # displacement from an unstable equilibrium, over the segment length


@kernel
def grows(body, load_stiffness, w):
    """Whether any small motion of the body in equilibrium grows; w.move (modified) receives this motion, with norm 1."""
    n = body.chain.n
    damping = GROWTH_DAMPING * load_stiffness
    loads(body, SPRINGS, w.tension, w.mass, w.force)
    newton.step_by_compliance(body, newton.loosest(body, load_stiffness), damping, w)  # for the records at these positions
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
    """Equilibrium from a first guess in the body [m] and w.tension [N] (both modified): (found, iterations).

    It is stable if the trials suffice.  load_stiffness : stiffness [N/m] of a node due to the loads alone.
    """
    away = AWAY * body.chain.length / body.chain.n
    is_kept, iterations = False, 0
    for _ in range(MOST_TRIALS):
        found, more = newton.relax(body, newton.EITHER_SIGN, True, load_stiffness, w)
        iterations += more
        if not found:
            break
        newton.keep(body, w)
        is_kept = True
        if not grows(body, load_stiffness, w):
            break
        for i in range(1, body.chain.n):
            put(body.x, i, add_scaled(get(body.x, i), away, get(w.move, i)))
    if is_kept:
        newton.restore(body, w)
    return is_kept, iterations
