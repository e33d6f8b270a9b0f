"""How well does a chain of 22 segments hang like the exact elastic catenary?

The kite stands still at (100, 100, 800) m on a tether 5 % longer than that. TetherCatenary is the closed form,
TetherQuasiSteady the chain in equilibrium: the start of the quasi-steady set, which needs no simulation.
"""

import numpy as np
from lessons import MEDIUM, STEP, Lesson, command_line, curve, panels, timed

from tetherfmu import TetherCatenary, TetherQuasiSteady
from tetherfmu.console.colours import COLOUR

KITE, SLACK, POINTS = (100.0, 100.0, 800.0), 0.05, 22 * 6 + 1


def hang(model, segments=22):
    """Outputs of a tether at rest, its shape at POINTS equal arc lengths, or at its nodes."""
    points = POINTS if model is TetherCatenary else segments + 1
    return model(segments=segments, shape_points=points).initialize(KITE, slack=SLACK)


def side(shape):
    """Horizontal distance from the ground station and height [m], array (2, points)."""
    return np.array([np.hypot(shape[:, 0], shape[:, 1]), shape[:, 2]])


def lesson():
    """Both shapes, and the chain's distance from the catenary at its nodes."""
    exact, (chain, seconds) = hang(TetherCatenary), timed(hang, TetherQuasiSteady)
    figure, (left, right) = panels(1, 2, size=MEDIUM, width_ratios=(2, 3))
    curve(left, *side(exact.shape), "catenary", at=50, color=COLOUR["catenary"])
    curve(
        left, *side(chain.shape), "22 segments", at=15, marker="o", markersize=3, linestyle="", color=COLOUR["quasi_steady"]
    )
    left.set(xlabel="horizontal distance [m]", ylabel="height [m]", title="Side view, not to scale")
    for segments in (5, 11, 22):
        nodes = hang(TetherQuasiSteady, segments).shape
        at_nodes = TetherCatenary(segments=segments).initialize(KITE, slack=SLACK).shape
        distance = np.linalg.norm(nodes - at_nodes, axis=1)
        fade = {"color": COLOUR["quasi_steady"], "alpha": 0.3 + 0.7 * segments / 22}
        curve(right, np.linspace(0.0, 1.0, segments + 1), distance, f"{segments} segments", at=1, **fade)
    right.set(xlabel="arc length over length, ground to kite", ylabel="[m]", title="Distance of the nodes from the catenary")
    miss = np.linalg.norm(chain.kite_force - exact.kite_force)
    answer = f"force on the kite {np.linalg.norm(chain.kite_force):.2f} N, {miss:.2f} N off the catenary"
    return Lesson(answer, figure, STEP, seconds)


main = command_line(lesson)
