"""Balance of forces on a chain of nodes, written once more in numpy: what the kernels are checked against."""

import numpy as np

from mechanics import drags, line_density

VARIANTS = ("TetherDynamic", "TetherQuasiSteady", "TetherCatenary", "TetherStraight")


def weight(tether, environment):
    """Weight of the whole tether [N], vector."""
    return np.array([0.0, 0.0, -line_density(tether) * tether.initial_length * environment.gravity])


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
