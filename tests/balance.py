"""Balance of forces on a chain of nodes, written once more in numpy: what the kernels are checked against."""

import numpy as np

from mechanics import drags, line_density

VARIANTS = ("TetherDynamic", "TetherQuasiSteady", "TetherCatenary", "TetherStraight")


def segments(positions, tether):
    """Tensions [N], lengths [m] and directions of all segments; a slack one pushes with its smaller stiffness."""
    vectors = np.diff(positions, axis=0)
    lengths = np.linalg.norm(vectors, axis=1)
    strains = lengths * len(lengths) / tether.initial_length - 1.0
    stiffness = tether.axial_stiffness * np.where(strains > 0.0, 1.0, tether.slack_stiffness_ratio)
    return stiffness * strains, lengths, vectors / lengths[:, None]


def turning(positions, kite_velocity):
    """Velocities [m/s] and accelerations [m/s2] of nodes that turn about the origin and stretch with the kite (the last)."""
    kite = positions[-1]
    spin = np.cross(kite, kite_velocity) / (kite @ kite)
    stretching = kite @ kite_velocity / (kite @ kite)
    return np.cross(spin, positions) + stretching * positions, np.cross(spin, np.cross(spin, positions))


def residual(positions, kite_velocity, wind, tether, environment):
    """Force [N] that is missing for the equilibrium of every inner node, array (n - 1, 3); and the tensions [N]."""
    tensions, _, directions = segments(positions, tether)
    velocities, accelerations = turning(positions, kite_velocity)
    pulls = tensions[:, None] * directions
    drag = drags(positions, velocities, wind, tether, environment)
    mass = line_density(tether) * tether.initial_length / tether.segments
    gravity = np.array([0.0, 0.0, -environment.gravity])
    return pulls[1:] - pulls[:-1] + 0.5 * (drag[1:] + drag[:-1]) + mass * (gravity - accelerations[1:-1]), tensions


def rounding(positions, tensions, tether):
    """Largest missing force [N] of an equilibrium that was found.

    1e-9 of the largest tension, and the rounding of the segments' stretch, 1e-14 EA/l0 |x|: 8 sqrt(n) eps, twice what
    usually remains; a chain with a slack segment is nearly singular, and Newton's method stalls there.
    """
    stiffness = tether.axial_stiffness * tether.segments / tether.initial_length
    return 1e-9 * np.abs(tensions).max() + 1e-14 * stiffness * np.abs(positions).max()


def slope_of_segments(stiffnesses):
    """dF/dx [N/m] of all nodes, (3 n + 3, 3 n + 3), from the stiffnesses of the segments, (n, 3, 3)."""
    n = len(stiffnesses)
    total = np.zeros((n + 1, 3, n + 1, 3))
    for s, block in enumerate(stiffnesses):
        for p, q in ((s, s + 1), (s + 1, s)):
            total[p, :, p] -= block
            total[p, :, q] += block
    return total.reshape(3 * n + 3, 3 * n + 3)


def slope_of_springs(positions, tether):
    """dF/dx [N/m] of all nodes at rest in still air: k e e + T/l (1 - e e) of each segment."""
    tension, length, e = segments(positions, tether)
    rest = tether.initial_length / len(e)
    k = tether.axial_stiffness / rest * np.where(length > rest, 1.0, tether.slack_stiffness_ratio)
    along, across = e[:, :, None] * e[:, None, :], (tension / length)[:, None, None]
    return slope_of_segments(k[:, None, None] * along + across * (np.eye(3) - along))


def growth(positions, wind, tether, environment):
    """Largest real part [N/m] of an eigenvalue of dF/dx of the inner nodes; below 0 the equilibrium is stable."""
    total, change = slope_of_springs(positions, tether), 1e-6 * tether.initial_length / tether.segments
    for j in range(3, positions.size - 3):
        moved = np.where(np.arange(positions.size) == j, 0.5 * change, 0.0).reshape(positions.shape)
        ahead, back = (drags(x, np.zeros_like(x), wind, tether, environment) for x in (positions + moved, positions - moved))
        felt = 0.5 * (ahead - back).ravel() / change
        total[3:, j] += felt
        total[:-3, j] += felt
    return np.linalg.eigvals(total[3:-3, 3:-3]).real.max()
