"""What are the parts of a tether called?

A labelled diagram. Tethers.jl counts particles P1..Pn and segments S1..Sn-1 from the fixed end; here node 0 is at the
ground, node n at the kite, and segment i joins nodes i and i + 1. These replace the indices of lesson 05. The end forces
are those of the tether on what holds it, with half the weight of a segment: they point a little below their segments.
"""

import numpy as np
from lessons import STEP, Lesson, command_line, plt, timed

from tetherfmu import TetherDynamic
from tetherfmu.console.colours import BLACK, COLOUR, REFERENCE, SKY_BLUE

SEGMENTS, KITE, ARROW = 6, (80.0, 0.0, 50.0), 13.0  # -, m, m
SAG = 1.12  # length over distance


def simulate():
    """Node positions [m], and the outputs, of a tether at rest."""
    tether = TetherDynamic(segments=SEGMENTS, initial_length=SAG * np.linalg.norm(KITE), ground_height=-100.0)
    outputs = tether.initialize(KITE)
    return tether.positions[:, [0, 2]], outputs


def lesson():
    """The diagram."""
    (nodes, outputs), seconds = timed(simulate)
    figure, axes = plt.subplots(figsize=(8.0, 5.2), layout="constrained")
    axes.plot(*nodes.T, color=BLACK)
    axes.plot(*nodes[1:-1].T, "o", color=BLACK)
    axes.plot(*nodes[0], "s", color=BLACK, markersize=12)
    axes.plot(*nodes[-1], "D", color=COLOUR["dynamic"], markersize=12)
    label = {"textcoords": "offset points", "va": "center"}
    for i, node in enumerate(nodes[1:-1], start=1):
        axes.annotate(f"P{i + 1}, node {i}", node, (12, -12), **label)
    for i, middle in enumerate(0.5 * (nodes[1:] + nodes[:-1])):
        axes.annotate(f"S{i + 1}", middle, (-2, 14), color=SKY_BLUE, weight="bold", ha="right", **label)
    for node, force, name in (
        (nodes[0], outputs.ground_force, "ground_force"),
        (nodes[-1], outputs.kite_force, "kite_force"),
    ):
        tip = node + ARROW * force[[0, 2]] / np.linalg.norm(force)
        axes.annotate("", tip, node, arrowprops={"arrowstyle": "-|>", "color": COLOUR["dynamic"], "linewidth": 2.0})
        beside = {"xytext": (12, 4)} if name == "kite_force" else {"xytext": (0, -16), "ha": "right"}
        axes.annotate(f"{name}, {np.linalg.norm(force):.1f} N", tip, color=COLOUR["dynamic"], **beside, **label)
    axes.annotate("ground station\nP1, node 0", nodes[0], (-16, 0), ha="right", **label)
    axes.annotate(f"kite\nP{SEGMENTS + 1}, node {SEGMENTS}", nodes[-1], (16, 4), **label)
    axes.plot(*nodes[[0, -1]].T, color=REFERENCE, linewidth=0.6, zorder=0)
    axes.set(aspect="equal", xlim=(-30.0, 110.0), ylim=(-15.0, 60.0))
    axes.axis("off")
    answer = f"{SEGMENTS} segments join {SEGMENTS + 1} nodes, sag {outputs.sag:.1f} m"
    return Lesson(answer, figure, STEP, seconds)


main = command_line(lesson)
