"""How does a pumping kite fly, and what does it give? Figures for `pumping_cycle.py`."""

import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt

from shared.flight_figures import TENSIONS
from tetherfmu.console.colours import BLACK, BLUE, GREEN, VERMILLION

PANELS = (  # name of the values, factor, label, colour
    ("ground_tension", 1e-3, "force [kN]", VERMILLION),
    ("reel_out_speed", 1.0, "reel-out speed [m/s]", BLUE),
    ("power", 1e-3, "power [kW]", GREEN),
    ("tether_length", 1.0, "length [m]", BLACK),
)
SHOWN = 10  # every such row of a flight is a dot of its path


def counted(flight):
    """Rows of the whole cycles."""
    return slice(flight.bounds[0], flight.bounds[-1] + 1)


def plot_series(flight):
    """Force, reel-out speed, power and length over time; reeling in is shaded, cycles are counted from the dashed line."""
    figure, panels = plt.subplots(len(PANELS), 1, figsize=(9.0, 8.0), sharex=True, layout="constrained")
    energy = flight.values["energy"][flight.bounds]
    mean = 1e-3 * np.diff(energy[[0, -1]])[0] / (flight.time[flight.bounds[-1]] - flight.time[flight.bounds[0]])
    for axes, (name, factor, label, color) in zip(panels, PANELS, strict=True):
        axes.plot(flight.time, factor * flight.values[name], color=color, linewidth=1.0)
        is_depowered, whole = flight.values["depower"][::SHOWN] > 0.0, axes.get_xaxis_transform()
        axes.fill_between(flight.time[::SHOWN], 0, 1, is_depowered, transform=whole, color="gray", alpha=0.15)
        for row in flight.bounds:
            axes.axvline(flight.time[row], color="black", linestyle="--", linewidth=0.8)
        axes.set(ylabel=label, xlim=(0.0, flight.time[-1]))
        axes.grid(alpha=0.4)
    panels[2].axhline(mean, color=GREEN, linestyle=":")
    panels[0].set_title(f"Pumping cycles: mean {mean:.2f} kW (dotted), depowered (shaded), a cycle begins (dashed)")
    panels[-1].set_xlabel("time [s]")
    return figure


def path_of(flight):
    """Path of the kite [m], array (rows, 3)."""
    return np.transpose([flight.values[f"kite_position[{i}]"] for i in (1, 2, 3)])


def plot_path(flight):
    """Path of the kite in space, coloured by the force at the ground."""
    figure = plt.figure(figsize=(9.0, 6.5), layout="constrained")
    axes = figure.add_subplot(projection="3d")
    rows = counted(flight)
    path = path_of(flight)[rows]
    force = 1e-3 * flight.values["ground_tension"][rows]
    dots = axes.scatter(*path[::SHOWN].T, c=force[::SHOWN], cmap=TENSIONS, vmin=0.0, s=4)
    axes.plot(*np.zeros((3, 1)), "s", color="black", label="ground station")
    axes.set(title="Path of the kite, whole cycles", xlabel="x, downwind [m]", ylabel="y [m]", zlabel="z [m]")
    axes.set_aspect("equal")
    axes.locator_params(axis="y", nbins=4)
    axes.zaxis.set_rotate_label(False)
    axes.zaxis.label.set_rotation(90.0)
    axes.view_init(elev=15.0, azim=-125.0)
    axes.legend(loc="upper left")
    figure.colorbar(dots, ax=axes, label="force at the ground [kN]", shrink=0.6, pad=0.1)
    return figure
