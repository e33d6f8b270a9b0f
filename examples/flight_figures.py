"""How does a tether look, and how hard does it pull, along a flight? Figures for the examples.

Each function takes a dict name -> `Flight` (see `circular_flight.py`); a tether has the same line style in all figures.
"""

import matplotlib
import numpy as np

from tetherfmu.console.colours import BLACK, COLOUR, REFERENCE, SKY_BLUE, VERMILLION
from tetherfmu.runtime.variants import variant_of

matplotlib.use("Agg")
import matplotlib.pyplot as plt

COMPONENTS = {"x": SKY_BLUE, "y": REFERENCE, "z": BLACK, "magnitude": VERMILLION}


def styled(flights):
    """Triples (name, flight, line style)."""
    return zip(flights, flights.values(), ("-", "--", "-.", ":"), strict=False)


def colour_of(name):
    """Colour of a tether by the name of its FMU."""
    try:
        return COLOUR[variant_of(name)]
    except ValueError:  # one that is called otherwise
        return COLOUR["dynamic"]


def plot_first_shape(flights):
    """Side view of the tether at the start, in the vertical plane through ground station and kite."""
    figure, axes = plt.subplots(figsize=(9.0, 4.3), layout="constrained")
    for name, flight, style in styled(flights):
        shape = flight.shape[0] - flight.shape[0, 0]
        distance = shape[:, :2] @ shape[-1, :2] / np.linalg.norm(shape[-1, :2])
        axes.plot(distance, shape[:, 2], style, marker="o", markersize=4, color=colour_of(name), label=name)
    ends = distance[[0, -1]], shape[[0, -1], 2]
    axes.plot(*ends, color=REFERENCE, linewidth=0.8, label="chord")
    axes.plot(ends[0][0], ends[1][0], "s", color="black", markersize=9, label="ground station")
    axes.plot(ends[0][1], ends[1][1], "D", color=BLACK, markersize=9, label="kite")
    axes.set(title="First shape of the tether, side view", xlabel="horizontal distance [m]", ylabel="height [m]")
    axes.set_aspect("equal")
    axes.grid(alpha=0.4)
    axes.legend()
    return figure


def plot_forces(flights):
    """Components of the forces on the kite and on the ground station over the flight."""
    first = next(iter(flights.values()))
    ends = {"kite_force": "kite", "ground_force": "ground station"}
    ends = {field: end for field, end in ends.items() if getattr(first, field) is not None}
    size = {"figsize": (9.0, 1.0 + 3.0 * len(ends))}
    figure, panels = plt.subplots(len(ends), 1, sharex=True, squeeze=False, layout="constrained", **size)
    panels = panels[:, 0]
    for axes, (field, title) in zip(panels, ends.items(), strict=True):
        for name, flight, style in styled(flights):
            force = getattr(flight, field)
            columns = [*force.T, np.linalg.norm(force, axis=1)]
            for column, (component, color) in zip(columns, COMPONENTS.items(), strict=True):
                axes.plot(flight.time, column, style, color=color, label=component if style == "-" else None)
            axes.plot([], [], style, color="gray", label=name)
        axes.set(title=f"Force of the tether on the {title}", ylabel="force [N]", xlim=flight.time[[0, -1]])
        axes.grid(alpha=0.4)
    panels[0].legend(loc="upper left", bbox_to_anchor=(1.01, 1.0))
    panels[-1].set_xlabel("time [s]")
    return figure


def plot_shapes(flights, count=20):
    """`count` shapes of the tether in space with the flight path; coloured by time, or by tether if there are several."""
    figure = plt.figure(figsize=(9.0, 6.0), layout="constrained")
    axes = figure.add_subplot(projection="3d")
    colors = plt.cm.ScalarMappable(plt.Normalize(0.0, max(flight.time[-1] for flight in flights.values())))
    for name, flight, style in styled(flights):
        for k in np.linspace(0, len(flight.time) - 1, count, endpoint=False).astype(int):
            color = colors.to_rgba(flight.time[k]) if len(flights) == 1 else colour_of(name)
            axes.plot(*flight.shape[k].T, style, color=color, linewidth=1.2, label=name if k == 0 else None)
    axes.plot(*flight.shape[:, -1].T, color=REFERENCE, linewidth=2.0, label="flight path")
    axes.plot(*flight.shape[0, :1].T, "s", color="black", label="ground station")
    axes.set(title="Tether along the flight", xlabel="x [m]", ylabel="y [m]", zlabel="z [m]")
    axes.set_box_aspect([np.ptp(limits) for limits in (axes.get_xlim(), axes.get_ylim(), axes.get_zlim())], zoom=1.15)
    axes.locator_params(axis="x", nbins=4)
    axes.view_init(elev=20.0, azim=-40.0)
    axes.legend(loc="upper left")
    if len(flights) == 1:
        figure.colorbar(colors, ax=axes, label="time [s]", shrink=0.6, pad=0.08)
    return figure
