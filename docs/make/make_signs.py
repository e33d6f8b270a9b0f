"""Draw docs/figures/signs.svg: both ends of the tether with frame, forces and signs; `python docs/make/make_signs.py`."""

from pathlib import Path

import numpy as np

from make_assets import FORCE, MOTION, TETHER, arrow, draw_kite, draw_station, plt
from pictures import save

FIGURE = Path(__file__).resolve().parents[1] / "figures" / "signs.svg"
DIRECTION = np.array([np.cos(np.radians(40.0)), np.sin(np.radians(40.0))])  # from the ground end to the kite
BLACK = "#333333"


def panel(axes, title):
    """An empty panel of the sketch."""
    axes.set(xlim=(-0.55, 1.75), ylim=(-0.6, 1.25), aspect="equal")
    axes.axis("off")
    axes.text(-0.52, 1.17, title, fontsize=14, weight="bold", va="center")


def write(axes, x, y, text, color=BLACK, size=12):
    """A note in a panel, from its left."""
    axes.text(x, y, text, fontsize=size, color=color, va="center")


def draw_ground_end(axes):
    """Ground end: frame, force on the station, direction of the tether, sense of reeling."""
    panel(axes, "Ground end")
    frame = np.array([-0.45, -0.42])
    arrow(axes, frame, (0.28, 0.0), BLACK, "x", (0.06, 0.0))
    arrow(axes, frame, (0.0, 0.28), BLACK, "z", (0.0, 0.06))
    write(axes, -0.4, -0.33, "y: away from you", size=10)
    axes.plot(*np.array([[0.15, 0.0], [0.75, 0.0]]).T, color=BLACK, linewidth=0.8, linestyle=":")
    axes.plot(*np.array([[0.0, 0.0], 1.45 * DIRECTION]).T, color=TETHER, linewidth=2.5)
    draw_station(axes, np.array([0.0, 0.0]), 0.2)
    arrow(axes, (0.0, 0.0), 0.7 * DIRECTION, FORCE, "", (0.0, 0.0))
    write(axes, -0.52, 0.74, "ground_force:", FORCE)
    write(axes, -0.52, 0.63, "of the tether on", FORCE)
    write(axes, -0.52, 0.52, "the ground station", FORCE)
    angle = np.linspace(0.0, np.radians(40.0), 30)
    axes.plot(0.5 * np.cos(angle), 0.5 * np.sin(angle), color=BLACK, linewidth=0.8)
    write(axes, 0.54, 0.14, "ground_elevation > 0")
    write(axes, 0.36, -0.14, "ground_tension > 0: the tether pulls")
    arrow(axes, 1.05 * DIRECTION + (0.06, -0.07), 0.3 * DIRECTION, MOTION, "", (0.0, 0.0))
    write(axes, 0.94, 0.53, "reel_out_speed > 0:", MOTION)
    write(axes, 0.94, 0.42, "the tether gets longer", MOTION)
    write(axes, 0.36, -0.32, "here ground_force[1] > 0", FORCE)
    write(axes, 0.36, -0.43, "and ground_force[3] > 0", FORCE)


def draw_kite_end(axes):
    """Kite end: force on the kite, its velocity, the load on a free kite end."""
    panel(axes, "Kite end")
    kite = np.array([0.75, 0.6])
    axes.plot(*np.array([kite - 1.45 * DIRECTION, kite]).T, color=TETHER, linewidth=2.5)
    draw_kite(axes, kite, 0.3)
    arrow(axes, kite, -0.65 * DIRECTION, FORCE, "", (0.0, 0.0))
    write(axes, 0.36, 0.13, "kite_force: of the tether on the kite", FORCE)
    write(axes, 0.36, 0.01, "kite_tension > 0: the tether pulls")
    arrow(axes, kite, (0.5, -0.08), MOTION, "", (0.0, 0.0))
    write(axes, 1.08, 0.43, "kite_velocity", MOTION)
    load = "#2e8b8b"
    arrow(axes, kite + 0.2 * DIRECTION, 0.25 * DIRECTION, load, "", (0.0, 0.0))
    write(axes, 0.8, 1.13, "kite_load: on a free kite", load)
    write(axes, 0.8, 1.02, "end, without its weight", load)
    arrow(axes, (-0.4, 0.65), (0.0, -0.3), BLACK, "", (0.0, 0.0))
    write(axes, -0.35, 0.5, "gravity, along -z")
    write(axes, 0.36, -0.21, "here kite_force[1] < 0", FORCE)
    write(axes, 0.36, -0.32, "and kite_force[3] < 0", FORCE)


def draw(path):
    """Both panels, one below the other: narrow enough to be read on a phone."""
    figure, (ground, kite) = plt.subplots(2, 1, figsize=(5.2, 7.6), layout="constrained")
    draw_ground_end(ground)
    draw_kite_end(kite)
    save(figure, path)


if __name__ == "__main__":
    draw(FIGURE)
