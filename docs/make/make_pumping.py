"""Draw docs/figures/pumping.svg, .gif and .png, a pumping cycle: `python docs/make/make_pumping.py`.

The cycle is the first whole one of examples/power_system/pumping_cycle.py. The animations are for screens and start again at
their end: that of the site follows its theme, the other is for README.md. The still picture is for print.
"""

import sys
from pathlib import Path

import matplotlib
import numpy as np
from PIL import Image

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.colors import to_hex, to_rgb
from matplotlib.lines import Line2D
from mpl_toolkits.mplot3d.proj3d import proj_transform

from pictures import colours_of_tensions, save_moving
from tetherfmu.console.colours import BLACK, GREY, VERMILLION

DOCS = Path(__file__).resolve().parents[1]
sys.path.append(str(DOCS.parent / "examples"))
FIGURES = DOCS / "figures"
SIZE, DOTS = (7.6, 3.5), 110  # of the animation [in], [1/in]
SHOWN_FOR = 60  # a frame [ms]
TINTS = (1.0, 0.75, 0.5, 0.25)  # of a colour on white, for edges
PRINTED, IN_PRINT = 300, 9  # dots per inch, shapes
LIMITS = {"x": (0.0, 330.0), "y": (-110.0, 110.0), "z": (0.0, 265.0)}  # of the space that is shown [m]


def cycle():
    """Times in a cycle [s], shapes (frames, points, 3), tension at the ground station [kN], whether it is depowered."""
    from power_system.pumping_cycle import fly

    flight = fly(cycles=1, frames=True)
    first, last = flight.time[flight.bounds]
    frames = [(time, shape) for time, shape in flight.frames if first <= time < last]
    times, shapes = np.array([time for time, _ in frames]), np.array([shape for _, shape in frames])
    rows = np.rint(times / flight.time[0]).astype(int) - 1
    force, depowered = (flight.values[name][rows] for name in ("ground_tension", "depower"))
    return times - first, shapes, 1e-3 * force, depowered > 0.0


def space(figure, place, shapes, colours):
    """Axes in space with the ground station and the path of the kite; the bar of the colours is at its right."""
    axes = figure.add_subplot(place, projection="3d")
    axes.plot(*shapes[:, -1].T, color=GREY, linewidth=0.8, alpha=0.6)
    axes.plot([0.0], [0.0], [0.0], "s", color=BLACK, markersize=5)
    axes.set(xlabel="x, downwind [m]", ylabel="y [m]", zlabel="z [m]", **{f"{name}lim": LIMITS[name] for name in LIMITS})
    axes.set_box_aspect([np.ptp(limits) for limits in LIMITS.values()], zoom=1.12)
    axes.set(xticks=range(0, 301, 100), yticks=(-100, 0, 100), zticks=range(0, 201, 100))
    axes.tick_params(labelsize=8, pad=0)
    axes.zaxis.set_rotate_label(False)
    axes.zaxis.label.set_rotation(90.0)
    axes.view_init(elev=14.0, azim=-118.0)
    figure.colorbar(colours, ax=axes, label="tension [kN]", shrink=0.75, pad=0.0)
    return axes


def forces(figure, place, times, force, depowered):
    """Axes with the force of the cycle over time, where it is depowered in grey."""
    axes = figure.add_subplot(place)
    axes.fill_between(
        times, 0.0, 1.0, depowered, transform=axes.get_xaxis_transform(), color="gray", alpha=0.15, linewidth=0
    )
    axes.text(times[depowered][len(times[depowered]) // 2], 3.6, "reel in", ha="center")
    axes.text(times[~depowered].mean(), 3.6, "reel out", ha="center")
    axes.set(xlabel="time [s]", ylabel="tension at the ground station [kN]", xlim=(0.0, times[-1]), ylim=(0.0, 4.0))
    axes.grid(alpha=0.3)
    axes.plot(times, force, color=GREY, linewidth=0.8)
    return axes


def drawn(cycle, count=None):
    """Figure of a cycle, and what the animation changes in it: tether, its shadow, path and force so far, present force.

    count : of shapes that the still picture shows; None: one, which the animation moves.
    """
    times, shapes, force, depowered = cycle
    figure = plt.figure(figsize=SIZE, layout="constrained")
    grid = figure.add_gridspec(1, 2, width_ratios=(1.5, 1.0))
    colours = plt.cm.ScalarMappable(plt.Normalize(0.0, 3.5), cmap=colours_of_tensions())
    axes = space(figure, grid[0], shapes, colours)
    beside = forces(figure, grid[1], times, force, depowered)
    if count:
        for k in np.linspace(0, len(times), count, endpoint=False).astype(int):
            axes.plot(*shapes[k].T, color=colours.to_rgba(force[k]), linewidth=1.8)
            axes.plot(*shapes[k, -1:].T, "D", color=BLACK, markersize=3)
        beside.plot(times, force, color=VERMILLION, linewidth=1.4)
        return figure, colours, None
    moved = [axes.plot([], [], [], color=GREY, linewidth=1.0, alpha=0.5)[0]]
    moved += [axes.plot([], [], [], color=VERMILLION, linewidth=1.2)[0], axes.plot([], [], [], linewidth=2.6)[0]]
    moved += [axes.plot([], [], [], "D", color=BLACK, markersize=5)[0]]
    return figure, colours, [*moved, *beside.plot([], [], color=VERMILLION), *beside.plot([], [], "o", color=VERMILLION)]


def frame(figure, colours, moved, cycle, k):
    """Picture of the frame k of the animation."""
    times, shapes, force, _ = cycle
    shadow, path, tether, kite, so_far, now = moved
    shadow.set_data_3d(*shapes[k, :, :2].T, np.zeros(len(shapes[k])))
    path.set_data_3d(*shapes[max(0, k - 20) : k + 1, -1].T)
    tether.set_data_3d(*shapes[k].T)
    tether.set_color(colours.to_rgba(force[k]))
    kite.set_data_3d(*shapes[k, -1:].T)
    so_far.set_data(times[: k + 1], force[: k + 1])
    now.set_data(times[k : k + 1], force[k : k + 1])
    figure.canvas.draw()
    return Image.fromarray(np.asarray(figure.canvas.buffer_rgba())[..., :3])


def animate(cycle, path):
    """Write the animation."""
    figure, colours, moved = drawn(cycle)
    figure.set_dpi(DOTS)
    frame(figure, colours, moved, cycle, 0)
    figure.set_layout_engine("none")  # nothing but the tether moves
    pictures = [frame(figure, colours, moved, cycle, k) for k in range(len(cycle[0]))]
    pictures = [each.quantize(palette=palette(colours), dither=Image.Dither.NONE) for each in pictures]
    pictures[0].save(path, save_all=True, append_images=pictures[1:], duration=SHOWN_FOR, loop=0, optimize=True)


def move(cycle, path):
    """Write the animation as an SVG file."""
    times, shapes, force, _ = cycle
    figure, colours, _ = drawn(cycle)
    figure.canvas.draw()  # before the axes in space are projected
    in_space, beside = figure.axes[0], figure.axes[-1]

    def projected(points):
        """Places in the plane of the picture of points in space, array (frames, points, 3)."""
        return np.stack(proj_transform(*np.moveaxis(points, -1, 0).reshape(3, -1), in_space.get_proj())[:2], -1).reshape(
            *points.shape[:-1], 2
        )

    def line(axes, **style):
        return axes.add_artist(Line2D([0.0], [0.0], **style))

    shades = [to_hex(colours.to_rgba(each)) for each in force]
    tether, dot = line(in_space, color=shades[0], linewidth=2.6), {"linewidth": 6.0, "solid_capstyle": "round"}
    trail = np.maximum(np.arange(len(times))[:, None] - np.arange(20, -1, -1), 0)
    now = np.stack([times, force], axis=-1)[:, None].repeat(2, axis=1)
    moving = {
        line(in_space, color=GREY, linewidth=1.0, alpha=0.5): projected(shapes * (1.0, 1.0, 0.0)),
        line(in_space, color=VERMILLION, linewidth=1.2): projected(shapes[trail, -1]),
        tether: projected(shapes),
        line(in_space, color=BLACK, **dot): projected(shapes[:, [-1, -1]]),
        line(beside, color=VERMILLION, **dot): now,
    }
    save_moving(figure, moving, 1e-3 * SHOWN_FOR * len(times), path, {tether: shades})


def palette(colours):
    """Picture with the colours of the animation: greys, and tints of the colours of a tension and of its curve."""
    greys = np.linspace(0.0, 1.0, 20)[:, None] * np.ones(3)
    strong = np.vstack([colours.cmap(np.linspace(0.0, 1.0, 40))[:, :3], to_rgb(VERMILLION)])
    tints = np.vstack([1.0 - tint * (1.0 - strong) for tint in TINTS])
    picture = Image.new("P", (1, 1))
    picture.putpalette(np.rint(255.0 * np.vstack([greys, tints])).astype(np.uint8).tobytes())
    return picture


def main():
    """Fly, write all of them."""
    flown = cycle()
    drawn(flown, IN_PRINT)[0].savefig(FIGURES / "pumping.png", dpi=PRINTED, metadata={"Software": None})
    animate(flown, FIGURES / "pumping.gif")
    move(flown, FIGURES / "pumping")


if __name__ == "__main__":
    main()
