"""Draw the three small pictures of README.md: `python docs/make/make_small_pictures.py`.

A crane (examples/cranes/set_down.py), a bridle (examples/systems/y_bridle.py), and the flight of the first file of
examples/flights, flown again with `TetherQuasiSteady`, whose winch holds the measured tension.
"""

import csv
import sys
from pathlib import Path

import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt

from pictures import colours_of_tensions, save
from tetherfmu import TetherQuasiSteady
from tetherfmu.console.colours import BLACK, BLUE, GREY, VERMILLION
from tetherfmu.runtime.inputs import COUNT, by_name

DOCS = Path(__file__).resolve().parents[1]
EXAMPLES = DOCS.parent / "examples"
sys.path.append(str(EXAMPLES))
LOG = EXAMPLES / "flights" / "kitepower_20191008_0012.csv"
ROPE = {"diameter": 0.010, "density": 724.0, "axial_stiffness": 3.84e6, "drag_coefficient": 1.1}  # of this flight
SIZE = (3.4, 2.8)  # of each picture [in]
STEP, KILOGRAM = 0.1, 9.81  # of the log [s]; its unit of force [N]
SHAPES = 14  # of the tether in the picture of the flight


def saved(figure, name):
    """Write a picture."""
    save(figure, DOCS / "figures" / f"small_{name}")
    plt.close(figure)


def crane():
    """Tension at the winch while the load is set down and taken up, with two speeds."""
    from cranes.set_down import fly

    figure, axes = plt.subplots(figsize=SIZE, layout="constrained")
    for speed, colour in ((1.0, VERMILLION), (0.25, BLUE)):
        time, _, pull, _ = fly(speed)
        axes.plot(time, 1e-3 * pull, color=colour, linewidth=1.2, label=f"hoist {speed:g} m/s")
    axes.set(xlabel="time [s]", ylabel="tension at the winch [kN]", title="A load is set down, then lifted")
    axes.legend(loc="upper left", frameon=False)
    axes.grid(alpha=0.3)
    saved(figure, "crane")


def bridle():
    """Tensions of a kite's tether and of both lines of its bridle."""
    from systems.y_bridle import COLOURS, GROUND_TENSION, fly

    time, flown = fly()
    figure, axes = plt.subplots(figsize=SIZE, layout="constrained")
    for name, colour in COLOURS.items():
        label = name.replace("bridle_", "").replace("main", "tether")
        axes.plot(time, 1e-3 * flown.outputs[name][:, GROUND_TENSION], color=colour, label=label)
    axes.set(xlabel="time [s]", ylabel="tension [kN]", ylim=(0.0, 2.9), title="A kite rolls on its bridle")
    axes.legend(loc="upper left", frameon=False, ncols=3, columnspacing=1.0, handlelength=1.5)
    axes.grid(alpha=0.3)
    saved(figure, "bridle")


def flown_again():
    """Path of the kite [m], measured tension [N], and nodes of a tether with this tension (rows, nodes, 3)."""
    with LOG.open(encoding="utf-8", newline="") as file:
        log = list(csv.DictReader(file))
    names = ("kite_pos_east", "kite_pos_north", "kite_height")
    path = np.array([[float(row[name]) for name in names] for row in log])
    force = KILOGRAM * np.array([float(row["ground_tether_force"]) for row in log])
    rows = np.zeros((len(log), COUNT))
    columns = by_name(rows)
    columns["kite_position"][:], columns["winch_force"][:] = path, force[:, None]
    driven = {"winch_control": "force", "end_velocities": "derived", "input_continuation": "held"}
    tether = TetherQuasiSteady(winch_start="equilibrium", **ROPE, **driven)
    tether.initialize(kite_position=path[0], winch_force=force[0])
    return path, force, tether.fly(rows, STEP).positions


def flight():
    """The path in space, coloured by the measured tension, and shapes of the tether."""
    path, force, shapes = flown_again()
    figure = plt.figure(figsize=SIZE, layout="constrained")
    axes = figure.add_subplot(projection="3d")
    for k in np.linspace(0, len(shapes), SHAPES, endpoint=False).astype(int):
        axes.plot(*shapes[k].T, color=GREY, linewidth=0.7)
    dots = axes.scatter(*path[::3].T, c=1e-3 * force[::3], cmap=colours_of_tensions(), s=2)
    axes.plot([0.0], [0.0], [0.0], "s", color=BLACK, markersize=4)
    axes.set(zlabel="up [m]", title="A measured flight")
    axes.set_xlabel("east [m]", labelpad=-4.0)
    axes.set_ylabel("north [m]", labelpad=-6.0)
    axes.set_box_aspect([np.ptp(limits) for limits in (axes.get_xlim(), axes.get_ylim(), axes.get_zlim())], zoom=0.85)
    axes.locator_params(nbins=4)
    axes.tick_params(labelsize=7, pad=-3)
    figure.colorbar(dots, ax=axes, label="measured tension [kN]", shrink=0.75, pad=0.15)
    saved(figure, "flight")


def main():
    """Draw all three."""
    crane()
    bridle()
    flight()


if __name__ == "__main__":
    main()
