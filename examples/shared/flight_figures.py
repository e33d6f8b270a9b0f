"""How does a tether look, and how hard does it pull, along a flight? Figures for the examples.

Each function takes a dict name -> `Flight` (see `circular_flight.py`). A tether has the same colour in all figures; with
several tethers, forces are also shown as differences from the first one.
"""

import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib import patheffects
from matplotlib.colors import ListedColormap
from mpl_toolkits.mplot3d import proj3d

from tetherfmu.console.colours import BLACK, COMPONENTS, GREY, GROUND, coloured

ENDS = {"kite_force": "kite", "ground_force": "ground station"}
#: colours of tensions from 0 on in all figures, legible on white and on dark paper
TENSIONS = ListedColormap(plt.get_cmap("plasma")(np.linspace(0.3, 0.78, 256)))
LEAST_RANGE = 0.02  # of an ordinate, part of its largest value
NARROWEST = 0.2  # width of an axis over that of the widest: a kite that stays above its winch would leave no room for labels


def label_ends(axes, labels):
    """Names of curves at their right ends, moved apart; labels : (height of the end in data, text, colour)."""
    low, high = axes.get_ylim()
    places = np.array(sorted((height - low) / (high - low) for height, *_ in labels))
    for k in range(1, len(places)):
        places[k] = max(places[k], places[k - 1] + 0.075)
    places -= max(0.0, places[-1] - 1.0)
    for place, (_, text, colour) in zip(places, sorted(labels, key=lambda label: label[0]), strict=True):
        axes.text(1.01, place, text, color=colour, transform=axes.transAxes, va="center", fontsize=9)


def widen(axes, name, least):
    """Widen the axis "x", "y" or "z" to a least width, on both sides."""
    low, high = getattr(axes, f"get_{name}lim")()
    if high - low < least:
        getattr(axes, f"set_{name}lim")(0.5 * (low + high - least), 0.5 * (low + high + least))


def draw_ground(axes, height):
    """The ground in a side view: a line at its height [m], with its name for the legend."""
    axes.axhline(height, color=GROUND, linewidth=2.5, label="ground", zorder=0.5)


def draw_ground_in_space(axes, height):
    """The ground in space: a plane at its height [m] across the limits of the axes."""
    x, y = np.meshgrid(axes.get_xlim(), axes.get_ylim())
    axes.plot_surface(x, y, np.full_like(x, height), color=GROUND, alpha=0.25, label="ground", zorder=0.5)


def plot_first_shape(flights, ground=None):
    """Side view of the tether at the start, in the vertical plane through ground station and kite.

    ground : its height [m]; None: there is none.
    """
    figure, axes = plt.subplots(figsize=(9.0, 4.3), layout="constrained")
    for name, flight, colour in coloured(flights):
        shape = flight.shape[0] - flight.shape[0, 0]
        distance = shape[:, :2] @ shape[-1, :2] / (np.linalg.norm(shape[-1, :2]) or 1.0)  # 0: straight above each other
        axes.plot(distance, shape[:, 2], color=colour, marker="o", markersize=3, linewidth=1.3, label=name)
    ends = distance[[0, -1]], shape[[0, -1], 2]
    axes.plot(*ends, color="gray", linewidth=0.8, label="chord")
    axes.plot(ends[0][0], ends[1][0], "s", color=BLACK, markersize=9)
    axes.plot(ends[0][1], ends[1][1], "D", color=BLACK, markersize=9)
    if ground is not None:
        draw_ground(axes, ground - flight.shape[0, 0, 2])
    axes.annotate("ground station", (ends[0][0], ends[1][0]), (10, -14), textcoords="offset points")
    axes.annotate("kite", (ends[0][1], ends[1][1]), (-10, 2), textcoords="offset points", ha="right")
    axes.set(title="Shape of the tether at the start, side view", xlabel="horizontal distance [m]", ylabel="height [m]")
    axes.set_aspect("equal")
    axes.margins(0.08)
    widen(axes, "x", 1.4 * np.ptp(axes.get_ylim()))
    widen(axes, "y", NARROWEST * np.ptp(axes.get_xlim()))
    axes.grid(alpha=0.3)
    axes.legend(loc="upper left")
    return figure


def draw_components(axes, time, force):
    """Components and magnitude of a force over time."""
    columns = [*force.T, np.linalg.norm(force, axis=1)]
    for column, colour in zip(columns, COMPONENTS.values(), strict=True):
        axes.plot(time, column, color=colour, linewidth=1.4)
    labels = zip(columns, COMPONENTS.items(), strict=True)
    with_room(axes)
    label_ends(axes, [(column[-1], name, colour) for column, (name, colour) in labels])


def draw_magnitudes(axes, flights, field):
    """Magnitude of a force of several flights over time."""
    ends = []
    for name, flight, colour in coloured(flights):
        magnitude = np.linalg.norm(getattr(flight, field), axis=1)
        axes.plot(flight.time, magnitude, color=colour, linewidth=1.3)
        ends.append((magnitude[-1], name, colour))
    with_room(axes)
    label_ends(axes, ends)


def draw_differences(axes, flights, field):
    """Size of the difference of a force from that of the first flight, over time."""
    first, *others = coloured(flights)
    largest = 0.0
    for _, flight, colour in others:
        rows = min(len(flight.time), len(first[1].time))
        difference = np.linalg.norm(getattr(flight, field)[:rows] - getattr(first[1], field)[:rows], axis=1)
        axes.semilogy(flight.time[:rows], difference, color=colour, linewidth=1.3)
        largest = max(largest, difference.max())
    if largest > 0.0:
        axes.set_ylim(1e-3 * largest, 2.0 * largest)


def ticks_in_space(axes):
    """As many ticks on each axis in space as there is room for."""
    spans = {name: np.ptp(getattr(axes, f"get_{name}lim")()) for name in "xyz"}
    for name, span in spans.items():
        axes.locator_params(axis=name, nbins=max(2, round(6.0 * span / max(spans.values()))))
    if spans["z"] > 3.0 * max(spans["x"], spans["y"]):
        axes.zaxis.labelpad = 14.0


def with_room(axes):
    """Let the ordinate show no less than `LEAST_RANGE` of what it shows: rounding errors are no signal."""
    low, high = axes.get_ylim()
    middle, least = 0.5 * (low + high), LEAST_RANGE * max(abs(low), abs(high))
    if high - low < least:
        axes.set_ylim(middle - 0.5 * least, middle + 0.5 * least)


def label_in_space(axes, points, apart=11.0):
    """Names beside points in space, dict name -> (3,) [m], moved apart where they would overlap.

    apart : least distance of two lines of text, in points of a page.
    """
    figure = axes.figure
    figure.draw_without_rendering()  # the projection is that of the layout
    pixels, taken = figure.dpi / 72.0, []
    seen = {name: proj3d.proj_transform(*place, axes.get_proj())[:2] for name, place in points.items()}
    corners = {name: axes.transData.transform(place) / pixels for name, place in seen.items()}
    halo = [patheffects.withStroke(linewidth=2.0, foreground="white")]
    for name, (across, up) in sorted(corners.items(), key=lambda each: -each[1][1]):
        width, height = 0.6 * 8.0 * len(name) + 8.0, up
        while any(abs(height - y) < apart and x - width < across < x + far for x, y, far in taken):
            height -= 1.0
        taken.append((across, height, width))
        offset = {"xytext": (6.0, height - up), "textcoords": "offset points", "va": "center"}
        axes.annotate(name, seen[name], **offset, fontsize=8, path_effects=halo, zorder=100)


def known_ends(flights):
    """Dict field -> name of the ends whose force all flights have."""
    return {field: end for field, end in ENDS.items() if all(getattr(each, field) is not None for each in flights.values())}


def plot_forces(flights):
    """Forces on the kite and on the ground station over the flight.

    One flight: their components. Several: their magnitudes, and at the right how far each is from the first flight.
    """
    ends = known_ends(flights)
    columns = 1 if len(flights) == 1 else 2
    figure, panels = plt.subplots(
        len(ends),
        columns,
        figsize=(4.0 + 4.5 * columns, 1.0 + 3.0 * len(ends)),
        sharex=True,
        squeeze=False,
        layout="constrained",
    )
    for line, (field, end) in zip(panels, ends.items(), strict=True):
        if columns == 1:
            for flight in flights.values():
                draw_components(line[0], flight.time, getattr(flight, field))
        else:
            draw_magnitudes(line[0], flights, field)
            draw_differences(line[1], flights, field)
            line[1].set(title=f"Difference from {next(iter(flights))}, {end}", ylabel="size of the difference [N]")
        line[0].set(title=f"Force of the tether on the {end}", ylabel="force [N]")
    first = next(iter(flights.values()))
    for axes in panels.flat:
        axes.set_xlim(first.time[[0, -1]])
        axes.grid(alpha=0.3)
    for axes in panels[-1]:
        axes.set_xlabel("time [s]")
    return figure


def draw_shapes(axes, flights, count, colours, ground=None):
    """`count` shapes of each tether in space, with the path of the kite; colours : of times, for a single flight.

    ground : its height [m]; None: there is none.
    """
    for name, flight, own in coloured(flights):
        for k in np.linspace(0, len(flight.time) - 1, count, endpoint=False).astype(int):
            colour = colours.to_rgba(flight.time[k]) if len(flights) == 1 else own
            axes.plot(*flight.shape[k].T, color=colour, linewidth=1.2, label=name if k == 0 and len(flights) > 1 else None)
    axes.plot(*flight.shape[:, -1].T, color=BLACK, linewidth=1.8, label="path of the kite")
    axes.plot(*flight.shape[0, :1].T, "s", color=BLACK, label="ground station")
    if np.ptp(flight.shape[:, 0], axis=0).any():
        axes.plot(*flight.shape[:, 0].T, color=GREY, linewidth=1.8, label="path of the ground station")
    least = NARROWEST * max(np.ptp(limits) for limits in (axes.get_xlim(), axes.get_ylim(), axes.get_zlim()))
    for name in "xyz":
        widen(axes, name, least)
    if ground is not None:
        draw_ground_in_space(axes, ground)
    axes.set(xlabel="x [m]", ylabel="y [m]", zlabel="z [m]")
    axes.set_box_aspect([np.ptp(limits) for limits in (axes.get_xlim(), axes.get_ylim(), axes.get_zlim())], zoom=1.15)
    axes.locator_params(axis="x", nbins=4)
    if np.ptp(axes.get_ylim()) < 0.5 * np.ptp(axes.get_zlim()):
        axes.locator_params(axis="y", nbins=4)
    axes.view_init(elev=20.0, azim=-40.0)


def times_of(flights):
    """Colours of the times of some flights."""
    latest = max(flight.time[-1] for flight in flights.values())
    return plt.cm.ScalarMappable(plt.Normalize(0.0, latest), cmap="viridis")


def plot_shapes(flights, count=20, ground=None):
    """`count` shapes of the tether in space; coloured by time, or, a third as many, by tether if there are several.

    ground : its height [m]; None: there is none.
    """
    figure = plt.figure(figsize=(9.0, 6.0), layout="constrained")
    axes = figure.add_subplot(projection="3d")
    colours = times_of(flights)
    draw_shapes(axes, flights, count if len(flights) == 1 else max(1, count // 3), colours, ground)
    axes.set_title("Tether along the flight")
    axes.legend(loc="upper left")
    if len(flights) == 1:
        figure.colorbar(colours, ax=axes, label="time [s]", shrink=0.6, pad=0.08)
    return figure
