"""Draw the free-body sketches of docs/models/theory.md: `python docs/make/make_sketches.py`.

One SVG each of a segment, the drum of a winch, a node on the ground, and rope that flows past nodes, with the letters of
that page.
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


def main():
    """Draw all of them."""
    mpl.rcParams["mathtext.fontset"] = "cm"
    for draw in (segment, winch, ground, flow):
        save(draw(), FIGURES / f"sketch_{draw.__name__}")


if __name__ == "__main__":
    main()
