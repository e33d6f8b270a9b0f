"""Where free points are in equilibrium: Newton's method on their positions, with lines at rest between them.

    R_p = sum over the lines at p of their force on it + m_p g + load_p = 0

The forces and their differences come from the equilibrium of each line between its two points (`kernels.equilibrium`),
which never holds itself up as a strut. But for drag, R is the fall of a potential. A step dX solves (a I - dR/dX) dX = R
with a damping a that makes the matrix positive definite, so that the potential falls along dX; the step ends before it rises
much.
Source: Nocedal and Wright, Numerical Optimization, 2nd ed., section 3.4 (Newton's method with a modified Hessian).
"""

import numpy as np

from tetherfmu.results import StepRefused
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.status import NO_EQUILIBRIUM

ITERATIONS = 300
BALANCED = 1e-9  # residual at a point over the size of the forces of its lines
NOTICED = 1e-8  # move of a point for a difference of forces, over the shortest line
HARDER, SOFTER = 2.0, 0.2  # factor of the damping after a part of a move; after a whole one
LARGEST_DAMPING = 60  # doublings of the damping
OVERSHOT = 0.5  # rise of the potential at the end of a move over its fall at the start
SHORTEST_PART, LONGEST_PART, TRIALS = 0.1, 0.9, 12  # of a move for the next trial; how many
PULLS = 1.0, 0.3  # of the springs of the guesses: the weaker, the more stretched are the lines
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

    def guess(self, pull):
        """Positions [m] where all lines are springs without length.

        They pull with `pull` times the largest outer force at their length.
        """
        count = len(self.wanted)
        matrix, right = np.zeros((count, count)), self.outer.copy()
        for k, points in self.lines:
            for point in points:
                if point is not None:
                    right[point, 2] -= 0.5 * self._weight(k)
        largest = np.linalg.norm(right, axis=1).max() or 1.0
        for k, points in self.lines:
            ends, density = self.ends(k, points, right), pull * largest / self.lengths[k]
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
    x = next((found for found in (_search(balance, balance.guess(pull)) for pull in PULLS) if found is not None), None)
    if x is None:
        raise StepRefused(
            f"no equilibrium was found of the free points {', '.join(wanted)}; check the positions of the driven points, "
            "the loads, initial_length and axial_stiffness of the lines, or give positions where the free points start",
            NO_EQUILIBRIUM,
        )
    return dict(zip(wanted, x, strict=True))


def _search(balance, x):
    """Positions where the residual is balanced, from a guess; None if they are not found."""
    found, damping = balance.residual(x), None
    for _ in range(ITERATIONS):
        if found is None:
            return None
        residual, size = found
        sizes = np.linalg.norm(residual, axis=1)
        if np.all(sizes <= BALANCED * size):
            return x
        slopes = balance.slopes(x)
        if slopes is None:
            return None
        damping = sizes.max() / (FIRST_PART * balance.shortest) if damping is None else damping
        move, damping = _direction(slopes, residual, damping)
        part, found = _along(balance, x, move, residual)
        x = x + part * move
        damping *= SOFTER if part == 1.0 else HARDER
    return None


def _direction(slopes, residual, damping):
    """Move [m] along which the potential falls, and the damping [N/m] that it took."""
    for _ in range(LARGEST_DAMPING):
        matrix = slopes + damping * np.eye(residual.size)
        if np.linalg.eigvalsh(0.5 * (matrix + matrix.T))[0] > 0.0:
            break
        damping *= HARDER
    return np.linalg.solve(matrix, residual.ravel()).reshape(-1, 3), damping


def _along(balance, x, move, residual):
    """Part of a move [-] after which the potential does not rise much again, and the residual there; secant steps."""
    start, part, found = np.sum(residual * move), 1.0, None
    for _ in range(TRIALS):
        found = balance.residual(x + part * move)
        slope = -np.inf if found is None else np.sum(found[0] * move)
        if slope >= -OVERSHOT * start:
            break
        part *= min(max(start / (start - slope), SHORTEST_PART), LONGEST_PART)
    return part, found
