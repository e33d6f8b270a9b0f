"""Draw the pictures that every FMU carries: its icon and the figure of its page; `python docs/make/make_assets.py`."""

from pathlib import Path

import matplotlib as mpl
import numpy as np

mpl.use("Agg")
from matplotlib import pyplot as plt

ASSETS = Path(__file__).resolve().parents[2] / "fmu_sources" / "tetherfmu" / "export" / "assets"
TETHER, KITE, WIND, FORCE, MOTION = "#1f4e79", "#c0392b", "#2e8b8b", "#c0392b", "#7d5ba6"
NODES = 7


def sagging(points):
    """A sagging curve from (0, 0) to (1, 1), array (points, 2)."""
    x = np.linspace(0.0, 1.0, points)
    return np.column_stack([x, np.sinh(1.6 * x) / np.sinh(1.6)])


def canvas(width, height, limits):
    """Figure without axes; limits : (left, right, bottom, top) of the drawing."""
    figure = plt.figure(figsize=(width, height))
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set(xlim=limits[:2], ylim=limits[2:], aspect="equal")
    axes.axis("off")
    return figure, axes


def draw_kite(axes, position, size):
    """A kite: a bent wing above the point where the tether ends."""
    angle = np.linspace(np.radians(20.0), np.radians(160.0), 40)
    outer = np.column_stack([np.cos(angle), np.sin(angle)])
    inner = 0.72 * outer[::-1] + (0.0, 0.02)
    axes.fill(*(position + size * (np.vstack([outer, inner]) - (0.0, 0.15))).T, color=KITE, linewidth=0)
    for tip in (outer[0], outer[-1]):
        end = position + size * (0.9 * tip - (0.0, 0.15))
        axes.plot(*np.column_stack([position, end]), color="0.35", linewidth=0.8)


def draw_station(axes, position, size):
    """A ground station: a winch on the ground."""
    left, right = position[0] - size, position[0] + size
    top = position[1] - 0.1 * size
    axes.fill(
        [left, right, 0.6 * right + 0.4 * position[0], 0.6 * left + 0.4 * position[0]],
        [top - size, top - size, top, top],
        color="0.3",
        linewidth=0,
    )
    axes.add_patch(plt.Circle(position, 0.38 * size, color="0.55"))


def arrow(axes, start, step, color, text, offset):
    """An arrow with a name beside its head."""
    end = np.add(start, step)
    axes.annotate(
        "", xy=end, xytext=start, arrowprops={"arrowstyle": "-|>", "color": color, "lw": 2.0, "mutation_scale": 16}
    )
    axes.text(*np.add(end, offset), text, color=color, fontsize=11, ha="center", va="center")


def draw_icon():
    """Icon `model.png`, 200 x 200 points."""
    figure, axes = canvas(2.0, 2.0, (-0.3, 1.5, -0.38, 1.42))
    axes.plot(*sagging(60).T, color=TETHER, linewidth=3.0)
    draw_station(axes, np.array([0.0, 0.0]), 0.2)
    draw_kite(axes, np.array([1.0, 1.0]), 0.42)
    figure.savefig(ASSETS / "model.png", dpi=100, transparent=True, metadata={"Software": None})


def draw_figure():
    """Figure of the interface: frame, ends, forces, wind, and the chain of nodes."""
    figure, axes = canvas(7.2, 4.5, (-0.75, 1.75, -0.3, 1.2625))
    scale = (1.0, 0.9)
    axes.plot(*(sagging(60) * scale).T, color=TETHER, linewidth=1.0, alpha=0.4)
    nodes = sagging(NODES) * scale
    axes.plot(*nodes.T, "o-", color=TETHER, linewidth=2.0, markersize=7)
    draw_station(axes, nodes[0], 0.11)
    draw_kite(axes, nodes[-1], 0.22)
    along = (nodes[1] - nodes[0]) / np.linalg.norm(nodes[1] - nodes[0])
    arrow(axes, nodes[0], 0.3 * along, FORCE, "ground_force", (0.25, -0.05))
    along = (nodes[-2] - nodes[-1]) / np.linalg.norm(nodes[-2] - nodes[-1])
    arrow(axes, nodes[-1], 0.34 * along, FORCE, "kite_force", (0.2, 0.0))
    arrow(axes, nodes[-1], (0.33, -0.02), MOTION, "kite_velocity", (0.16, 0.06))
    axes.text(nodes[-1][0] + 0.06, nodes[-1][1] - 0.08, "kite_position", color=MOTION, fontsize=11)
    axes.text(0.2, -0.05, "ground_position, ground_velocity,\nreel_out_speed", color=MOTION, fontsize=11, va="top")
    for height in (0.55, 0.75, 0.95):
        arrow(
            axes, (-0.6, height), (0.22 + 0.12 * height, 0.0), WIND, "wind_velocity" if height == 0.95 else "", (0.0, 0.08)
        )
    arrow(axes, nodes[3], (0.0, -0.17), "0.4", "weight", (0.13, 0.02))
    arrow(axes, nodes[3], (0.22, 0.0), WIND, "drag", (0.08, 0.0))
    middle = 0.5 * (nodes[2] + nodes[3])
    axes.annotate(
        "segment: spring and damper",
        xy=middle,
        xytext=(-0.3, 0.36),
        fontsize=10,
        color=TETHER,
        ha="center",
        arrowprops={"arrowstyle": "-", "color": TETHER, "lw": 0.8},
    )
    axes.annotate(
        "node: mass",
        xy=nodes[4],
        xytext=(0.36, 0.66),
        fontsize=10,
        color=TETHER,
        ha="center",
        arrowprops={"arrowstyle": "-", "color": TETHER, "lw": 0.8},
    )
    for step, name in (((0.22, 0.0), "x"), ((0.0, 0.22), "z"), ((0.12, 0.09), "y")):
        arrow(axes, (-0.6, -0.15), step, "0.2", name, np.multiply(step, 0.2))
    figure.savefig(ASSETS / "figure.png", dpi=100, metadata={"Software": None})


def main():
    """Draw both pictures."""
    ASSETS.mkdir(exist_ok=True)
    draw_icon()
    draw_figure()


if __name__ == "__main__":
    main()
