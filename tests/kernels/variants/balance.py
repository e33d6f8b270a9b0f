"""Forces on a chain of nodes, written once more in numpy: what the kernels are checked against. Uniform air only."""

import numpy as np

VARIANTS = ("TetherDynamic", "TetherQuasiSteady", "TetherCatenary", "TetherStraight")


def line_density(tether):
    """Mass per unstretched length [kg/m]."""
    return tether.density * np.pi / 4.0 * tether.diameter**2


def weight(tether, environment):
    """Weight of the whole tether [N], vector."""
    return np.array([0.0, 0.0, -line_density(tether) * tether.initial_length * environment.gravity])


def drag_per_length(direction, air, tether, environment):
    """1/2 rho cd d |w| w [N/m], w the part of the apparent wind [m/s] across the direction; rows."""
    across = air - np.sum(air * direction, axis=-1, keepdims=True) * direction
    width = 0.5 * environment.air_density * tether.drag_coefficient * tether.diameter
    return width * np.linalg.norm(across, axis=-1, keepdims=True) * across


def segments(positions, tether):
    """Tensions [N], lengths [m] and directions of all segments; a slack one pushes with its smaller stiffness."""
    vectors = np.diff(positions, axis=0)
    lengths = np.linalg.norm(vectors, axis=1)
    strains = lengths * len(lengths) / tether.initial_length - 1.0
    stiffness = tether.axial_stiffness * np.where(strains > 0.0, 1.0, tether.slack_stiffness_ratio)
    return stiffness * strains, lengths, vectors / lengths[:, None]


def segment_drags(positions, velocities, wind, tether, environment):
    """Drag of every segment [N], array (n, 3), at the mean velocity [m/s] of its nodes."""
    _, lengths, directions = segments(positions, tether)
    air = np.asarray(wind) - 0.5 * (velocities[1:] + velocities[:-1])
    return lengths[:, None] * drag_per_length(directions, air, tether, environment)


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
    drags = segment_drags(positions, velocities, wind, tether, environment)
    mass = line_density(tether) * tether.initial_length / tether.segments
    gravity = np.array([0.0, 0.0, -environment.gravity])
    return pulls[1:] - pulls[:-1] + 0.5 * (drags[1:] + drags[:-1]) + mass * (gravity - accelerations[1:-1]), tensions
