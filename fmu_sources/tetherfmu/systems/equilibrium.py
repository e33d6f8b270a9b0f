"""Where free points are in equilibrium: Newton's method on their positions, with lines at rest between them.

    R_p = sum over the lines at p of their force on it + m_p g + load_p = 0

The forces and their differences come from the equilibrium of each line between its two points (`kernels.equilibrium`), which
never holds itself up as a strut. A step dX solves (a I - dR/dX) dX = R. The damping a falls with |R| and grows where |R| grows
much (pseudo-time: small steps of motion against a resistance a, which end in stable equilibria only).
Source: Kelley and Keyes, Convergence analysis of pseudo-transient continuation, SIAM J. Numer. Anal. 35 (1998).
"""

import numpy as np

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.status import NO_EQUILIBRIUM

from ..results import StepRefused

ITERATIONS = 300
BALANCED = 1e-9  # residual at a point over the size of the forces of its lines
NOTICED = 1e-8  # move of a point for a difference of forces, over the shortest line
GROWTH = 2.0  # of |R| in a step that is still accepted
HARDER = 4.0  # factor of the damping after a step that is refused
SOFTER, SOFTEST = 0.5, 0.1  # largest and least factor after one in which |R| falls
FIRST_PART = 0.3  # of the shortest line, which the first step of the most loaded point is about
SPREAD = 0.01  # of the shortest line, by which guesses are moved apart


class _Balance:
    """Forces on wanted free points as a function of their positions (points, 3) [m]."""

    def __init__(self, arrays, wanted):
        self.arrays, self.wanted = arrays, wanted
        self.lines = [
            (k, [wanted.index(name) if name in wanted else None for name in (line.start, line.end)])
            for k, line in enumerate(arrays.lines)
            if line.start in wanted or line.end in wanted
        ]
        gravity = arrays.instances[0].parameters[at.GRAVITY]
        masses = np.array([arrays.point(name).mass for name in wanted])
        loads = np.array([arrays.loads[arrays.free.index(name)] for name in wanted])
        self.outer = loads - gravity * masses[:, None] * (0.0, 0.0, 1.0)
        self.lengths = {k: arrays.instances[k].parameters[at.INITIAL_LENGTH] for k, _ in self.lines}
        self.shortest = min(self.lengths.values())

    def ends(self, k, points, x):
        """Start and end of line k [m], (2, 3)."""
        row = self.arrays.rows[k]
        fixed = row[at.GROUND_POSITION : at.GROUND_POSITION + 3], row[at.KITE_POSITION : at.KITE_POSITION + 3]
        return np.array([fixed[end] if point is None else x[point] for end, point in enumerate(points)])

    def residual(self, x):
        """R of all points, and the size of the forces of and at the lines of each [N]; None if a line has no equilibrium."""
        total, size = self.outer.copy(), np.linalg.norm(self.outer, axis=1)
        for k, points in self.lines:
            forces = self.arrays.forces_at_rest(k, self.ends(k, points, x))
            if forces is None:
                return None
            for end, point in enumerate(points):
                if point is not None:
                    total[point] += forces[end]
                    size[point] += np.linalg.norm(forces, axis=1).sum()
        return total, size

    def slopes(self, x):
        """-dR/dX by differences [N/m], (3 points, 3 points); None if a line has no equilibrium nearby."""
        matrix = np.zeros((3 * len(x), 3 * len(x)))
        move = NOTICED * self.shortest
        for k, points in self.lines:
            here = self.ends(k, points, x)
            for moved, column in enumerate(points):
                for axis in range(3) if column is not None else ():
                    shift = np.zeros((2, 3))
                    shift[moved, axis] = move
                    forces = [self.arrays.forces_at_rest(k, here + sign * shift) for sign in (-1.0, 1.0)]
                    if any(each is None for each in forces):
                        return None
                    change = (forces[0] - forces[1]) / (2.0 * move)
                    for end, row in enumerate(points):
                        if row is not None:
                            matrix[3 * row : 3 * row + 3, 3 * column + axis] += change[end]
        return matrix

    def guess(self):
        """Positions [m] where all lines are springs without length that pull with the largest outer force at their length."""
        count = len(self.wanted)
        matrix, right = np.zeros((count, count)), self.outer.copy()
        for k, points in self.lines:
            ends = self.ends(k, points, right)
            for end, point in enumerate(points):
                if point is not None:
                    right[point, 2] -= 0.5 * self._weight(k)
        largest = np.linalg.norm(right, axis=1).max() or 1.0
        for k, points in self.lines:
            ends, density = self.ends(k, points, right), largest / self.lengths[k]
            for end, point in enumerate(points):
                other = points[1 - end]
                if point is not None:
                    matrix[point, point] += density
                    if other is None:
                        right[point] += density * ends[1 - end]
                    else:
                        matrix[point, other] -= density
        apart = SPREAD * self.shortest * np.array([(np.cos(k), np.sin(k), 0.0) for k in range(count)])
        return np.linalg.solve(matrix, right) + apart

    def _weight(self, k):
        """Weight of line k [N]."""
        instance = self.arrays.instances[k]
        n, p = instance.segments, np.frombuffer(instance.parameters)
        places = at.PARAMETER_SCALARS + np.arange(n)
        per_meter = p[places + at.SHARE * n] @ p[places + at.LINE_DENSITY * n]
        return p[at.GRAVITY] * per_meter * p[at.INITIAL_LENGTH]


def find(arrays, wanted):
    """Positions [m] of wanted free points in equilibrium, by name; StepRefused if it is not found.

    arrays : `Arrays` whose inputs are those of the start; the motion of its instances is modified.
    """
    free_of_driven = not any(point.is_driven for point in arrays.points)
    if free_of_driven and len(wanted) == len(arrays.free):
        raise StepRefused("no point of the system is driven or has a position: give one where it starts", NO_EQUILIBRIUM)
    balance = _Balance(arrays, wanted)
    x = _search(balance, balance.guess())
    if x is None:
        raise StepRefused(
            f"no equilibrium was found of the free points {', '.join(wanted)}; check the positions of the driven points, "
            "the loads, initial_length and axial_stiffness of the lines, or give positions where the free points start",
            NO_EQUILIBRIUM,
        )
    return dict(zip(wanted, x, strict=True))


def _search(balance, x):
    """Positions where the residual is balanced, from a guess; None if they are not found."""
    found = balance.residual(x)
    if found is None:
        return None
    residual, size = found
    damping = np.linalg.norm(residual, axis=1).max() / (FIRST_PART * balance.shortest)
    slopes = balance.slopes(x)
    for _ in range(ITERATIONS):
        if np.all(np.linalg.norm(residual, axis=1) <= BALANCED * size):
            return x
        if slopes is None:
            return None
        try:
            move = np.linalg.solve(slopes + damping * np.eye(residual.size), residual.ravel()).reshape(-1, 3)
        except np.linalg.LinAlgError:
            damping *= HARDER
            continue
        new = balance.residual(x + move) if np.abs(move).max() < 1e6 * balance.shortest else None
        change = np.inf if new is None else np.linalg.norm(new[0]) / np.linalg.norm(residual)
        if not change <= GROWTH:
            damping *= HARDER
            continue
        x, (residual, size) = x + move, new
        damping *= max(min(change * change, SOFTER), SOFTEST) if change < 1.0 else change
        slopes = balance.slopes(x)
    return None
