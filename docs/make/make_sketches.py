"""Draw the free-body sketches of docs/models/theory.md: `python docs/make/make_sketches.py`.

One SVG each of a segment, a node, rope that flows past nodes, a sheave, the drum of a winch, a segment that breaks, and a
node on the ground, with the letters of that page.
"""

from pathlib import Path

import matplotlib as mpl
import numpy as np

from make_assets import FORCE, MOTION, TETHER, WIND, arrow, canvas
from pictures import save
from tetherfmu.console.colours import GROUND

FIGURES = Path(__file__).resolve().parents[1] / "figures"
INK = "#333333"
DOT = {"marker": "o", "markersize": 9, "linestyle": "none", "zorder": 3}


def sketch(right, top):
    """An empty sketch from (0, 0) to (right, top), 0.8 inches for one unit."""
    return canvas(0.8 * right, 0.8 * top, (0.0, right, 0.0, top))


def write(axes, x, y, text, color=INK, align="left"):
    """A note, from its left, its middle or its right."""
    axes.text(x, y, text, fontsize=11, color=color, ha=align, va="center")


def line(axes, points, **style):
    """A line through points."""
    axes.plot(*np.transpose(points), **{"color": TETHER, "linewidth": 2.5, **style})


def bent(axes, centre, radius, angles, color):
    """An arrow on a circle, from one angle to another [deg]."""
    angle = np.radians(np.linspace(*angles, 40))
    points = np.add(centre, radius * np.column_stack([np.cos(angle), np.sin(angle)]))
    line(axes, points, color=color, linewidth=1.5)
    arrow(axes, points[-3], points[-1] - points[-3], color, "", (0.0, 0.0))


def segment():
    """Forces of a segment on its two nodes: tension, half of the drag, half of the weight."""
    figure, axes = sketch(7.0, 3.9)
    p, q = np.array([1.6, 1.2]), np.array([5.2, 2.7])
    e = (q - p) / np.linalg.norm(q - p)
    across = np.array([e[1], -e[0]])
    line(axes, [p, q])
    for node, sign, name in ((p, 1.0, "$p$"), (q, -1.0, "$q$")):
        axes.plot(*node, color=TETHER, **DOT)
        write(axes, *(node - 0.4 * sign * e), name, TETHER, "center")
        arrow(axes, node, 1.15 * sign * e, FORCE, "", (0.0, 0.0))
        arrow(axes, node, 0.75 * across, WIND, r"$\mathbf{F}$", 0.22 * across)
        arrow(axes, node, (0.0, -0.75), INK, "", (0.0, 0.0))
        write(axes, *(node - (0.15, 0.55)), r"$\frac{1}{2}\mu l_0\, g$", align="right")
    write(axes, *(p + 0.8 * e - 0.28 * across), r"$T\mathbf{e}$", FORCE, "center")
    write(axes, *(q - 0.8 * e - 0.28 * across), r"$-T\mathbf{e}$", FORCE, "center")
    write(axes, *(0.5 * (p + q) - 0.55 * across), r"$l = |\mathbf{r}|$", TETHER, "center")
    for height in (2.4, 2.8, 3.2):
        arrow(axes, (0.3, height), (0.9, 0.0), WIND, "", (0.0, 0.0))
    write(axes, 0.3, 3.55, r"air $\mathbf{v}_\mathrm{a}$", WIND)
    return figure


def node():
    """Forces on an inner node: both tensions, half of the drag of both segments, weight, rope that flows."""
    figure, axes = sketch(7.0, 3.6)
    left, middle, right = np.array([0.5, 0.5]), np.array([3.2, 2.1]), np.array([6.5, 3.0])
    line(axes, [left, middle, right])
    tensions = (left, r"$-T_{i-1}\mathbf{e}_{i-1}$", (-0.85, 0.15)), (right, r"$T_i\mathbf{e}_i$", (-0.3, 0.3))
    for end, text, beside in tensions:
        arrow(axes, middle, 1.4 * (end - middle) / np.linalg.norm(end - middle), FORCE, text, beside)
    axes.plot(*middle, color=TETHER, **DOT)
    arrow(axes, middle, (1.0, -0.45), WIND, r"$\mathbf{F}_{i-1} + \mathbf{F}_i$", (0.6, -0.15))
    arrow(axes, middle, (0.0, -1.2), INK, "$m_i\\,g$", (0.4, 0.0))
    arrow(axes, middle, (-0.35, 0.9), FORCE, r"$\mathbf{f}_i$", (-0.05, 0.22))
    write(axes, 0.8, 0.4, "to node $i - 1$", TETHER)
    write(axes, 5.1, 2.3, "to node $i + 1$", TETHER)
    return figure


def sheave():
    """Forces of a rope on its sheave: the tensions where it comes and where it leaves."""
    figure, axes = sketch(7.0, 3.4)
    centre, radius, leaves = np.array([3.0, 1.9]), 0.75, np.radians(60.0)
    way = np.array([np.sin(leaves), -np.cos(leaves)])  # of the rope that leaves
    off = np.add(centre, radius * np.array([np.cos(leaves), np.sin(leaves)]))
    come = np.add(centre, (-radius, 0.0))
    axes.add_patch(mpl.patches.Circle(centre, radius, facecolor="#dddddd", edgecolor=INK))
    axes.plot(*centre, color=INK, **DOT)
    angle = np.linspace(np.pi, leaves, 40)
    wrapped = np.add(centre, radius * np.column_stack([np.cos(angle), np.sin(angle)]))
    line(axes, [(come[0], 0.1), *wrapped, off + 3.2 * way])
    arrow(axes, come, (0.0, -1.3), FORCE, "$T_-$", (-0.35, 0.2))
    arrow(axes, off, 1.4 * way, FORCE, "$T_+$", (0.15, 0.3))
    write(axes, *(centre - (0.0, 0.35)), r"$m_\psi$", align="center")
    bent(axes, centre, 1.0, (150.0, 95.0), MOTION)
    write(axes, 2.55, 3.1, r"$\dot{\psi} > 0$", MOTION)
    bent(axes, centre, 1.0, (-150.0, -30.0), INK)
    write(axes, 3.95, 1.05, r"friction, $\tau = e^{\mu_\psi\vartheta}$")
    write(axes, 2.05, 0.25, r"$\dot{\psi}_2$ of this portion", MOTION, "right")
    write(axes, 5.0, 1.9, r"$\dot{\psi}_1$ of the next one", MOTION)
    return figure


def winch():
    """Forces at the rim of a drum: the rope against motor, damping and friction."""
    figure, axes = sketch(7.0, 3.2)
    centre, radius = np.array([3.0, 1.3]), 0.9
    top = np.add(centre, (0.0, radius))
    axes.add_patch(mpl.patches.Circle(centre, radius, facecolor="#dddddd", edgecolor=INK))
    axes.plot(*centre, color=INK, **DOT)
    write(axes, *(centre - (0.0, 0.3)), r"$m_W$", align="center")
    line(axes, [top, np.add(top, (3.2, 0.0))])
    arrow(axes, np.add(top, (0.5, 0.0)), (1.3, 0.0), FORCE, "$T$", (0.0, 0.28))
    friction = r"$W_\mathrm{f}\,\mathrm{sign}\,\dot{L}$"
    for down, length, text in ((0.0, 1.3, "$W$"), (0.35, 0.9, r"$c_W\dot{L}$"), (0.7, 0.7, friction)):
        rim = top - (np.sqrt(radius**2 - (radius - down) ** 2), down)
        arrow(axes, rim, (-length, 0.0), INK, "", (0.0, 0.0))
        write(axes, *(rim - (length + 0.1, 0.0)), text, align="right")
    bent(axes, centre, 1.15, (-20.0, -75.0), MOTION)
    write(axes, 4.25, 0.6, r"$\dot{L} > 0$: reels out", MOTION)
    return figure


def ground():
    """Forces on a node in the ground: both tensions, weight, normal force, friction."""
    figure, axes = sketch(7.0, 3.6)
    surface, node = 2.1, np.array([3.2, 1.3])
    axes.axhspan(0.0, surface, color=GROUND, alpha=0.15, linewidth=0)
    line(axes, [(0.0, surface), (7.0, surface)], color=GROUND, linewidth=1.5)
    write(axes, 0.1, surface + 0.2, r"$z = z_\mathrm{g}$", GROUND)
    left, right = np.array([0.5, 1.35]), np.array([6.0, 3.1])
    line(axes, [left, node, right])
    for end, text in ((left, r"$T_{i-1}$"), (right, "$T_i$")):
        arrow(axes, node, 1.3 * (end - node) / np.linalg.norm(end - node), FORCE, text, (0.0, 0.28))
    axes.plot(*node, color=TETHER, **DOT)
    arrow(axes, node, (0.0, 1.4), INK, "$N$", (0.0, 0.2))
    arrow(axes, node, (0.0, -0.85), INK, "$m_i\\,g$", (0.42, 0.1))
    arrow(axes, node - (0.0, 0.15), (-0.9, 0.0), INK, r"$\mu_\mathrm{g} N$", (-0.35, -0.1))
    arrow(axes, np.add(node, (0.35, -0.3)), (0.8, 0.0), MOTION, r"$\mathbf{v}_\mathrm{t}$", (0.25, 0.0))
    line(axes, [np.add(node, (0.3, 0.0)), (6.0, node[1])], color=INK, linewidth=0.8, linestyle=":")
    axes.annotate("", (5.5, node[1]), (5.5, surface), arrowprops={"arrowstyle": "<->", "color": INK, "lw": 0.8})
    write(axes, 5.65, 0.5 * (node[1] + surface), r"$z_\mathrm{g} - z$")
    return figure


def flow():
    """Rope that a winch pays out flows past the nodes, less and less of it."""
    figure, axes = sketch(7.0, 3.3)
    nodes = np.array([(0.8, 0.6), (2.1, 1.75), (3.8, 2.45), (6.1, 2.7)])
    line(axes, nodes)
    axes.add_patch(mpl.patches.Circle(nodes[0] - (0.14, -0.17), 0.2, facecolor="#dddddd", edgecolor=INK, zorder=4))
    for i, node in enumerate(nodes):
        axes.plot(*node, color=TETHER, **DOT)
        if i < len(nodes) - 1:
            way = (nodes[i + 1] - node) / np.linalg.norm(nodes[i + 1] - node)
            side = 0.22 * np.array([way[1], -way[0]])
            arrow(axes, node + side, 1.1 * (1.0 - i / 3.0) * way, MOTION, "", (0.0, 0.0))
    write(axes, 1.85, 0.75, r"$\eta_0\dot{L} = \dot{L}$ at the winch", MOTION)
    write(axes, 2.95, 1.55, r"$\eta_i\dot{L}$ past node $i$", MOTION)
    write(axes, 6.9, 2.3, r"$\eta_n = 0$", MOTION, "right")
    arrow(axes, nodes[1], (-0.4, 0.75), FORCE, r"$\mathbf{f}_i$", (-0.05, 0.22))
    write(axes, 6.1, 3.0, "kite", TETHER, "center")
    return figure


def breaking():
    """A segment that has broken: both nodes keep their masses, and the end recoils behind an elastic wave."""
    figure, axes = sketch(7.0, 3.0)
    heights = {"before": 2.3, "after": 0.9}
    nodes = np.array([0.5, 1.9, 3.3, 4.7, 6.1])
    for text, height in heights.items():
        write(axes, 0.05, height + 0.45, text, TETHER)
        axes.plot(nodes, np.full(5, height), color=TETHER, **DOT)
    line(axes, [(0.5, 2.3), (6.1, 2.3)])
    for node, way in ((nodes[3], 1.0), (nodes[4], -1.0)):
        arrow(axes, (node, 2.3), (0.55 * way, 0.0), FORCE, "", (0.0, 0.0))
    write(axes, 5.4, 2.65, r"$T_j = F_b$", FORCE, "center")
    line(axes, [(0.5, 0.9), (4.7, 0.9)])
    arrow(axes, (4.7, 0.9), (-0.9, 0.0), MOTION, "", (0.0, 0.0))
    write(axes, 4.6, 0.5, r"$v = T/\sqrt{EA\,\mu}$", MOTION, "center")
    arrow(axes, (3.0, 1.3), (-1.2, 0.0), WIND, "", (0.0, 0.0))
    write(axes, 2.4, 1.6, r"wave $\sqrt{EA/\mu}$", WIND, "center")
    write(axes, 6.1, 0.5, r"$\frac{1}{2}\mu l_0$ each", align="center")
    return figure


def main():
    """Draw all of them."""
    mpl.rcParams["mathtext.fontset"] = "cm"
    for draw in (segment, node, flow, sheave, winch, breaking, ground):
        save(draw(), FIGURES / f"sketch_{draw.__name__}")


if __name__ == "__main__":
    main()
