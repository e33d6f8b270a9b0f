"""Figures of a replay: the flight over time, and shapes of its tether, from the side and from above and in space."""

from itertools import pairwise
from types import SimpleNamespace

import numpy as np
from matplotlib import colormaps
from matplotlib.cm import ScalarMappable
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from tetherfmu.console.colours import BLACK, COLOUR, GREY, GROUND, REFERENCE
from tetherfmu.libraries.examples import example
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.variants import class_name

from .comparison import SETTLED, averaged
from .driven_tethers import FORCES, TETHERS, words
from .flight import EVERY

WIDTH, DPI = 9.0, 100  # inches, and dots in each
SHARE = 0.5, 99.5  # percentiles that set the scale of an axis
MARGIN = 0.08  # of an axis beyond them
MOST_BEYOND = 0.6  # of the measured range: extension of an axis for the tethers
NEWTONS = 5000.0  # largest tension that is shown in N; above, in kN
SOME = 0.03  # of the time in which the tether is slack, above which its sag is shown
SHAPES = 10  # shapes that are drawn
BORDERS, TALLEST = (0.85, 0.2, 1.25, 0.65), 6.5  # inches: left, right, below and above the views of shapes; their height
ROOM = 5.0  # m, at least around shapes
PALE = ("#BBCCEE", "#EEEEBB", "#CCDDAA", "#FFCCCC", "#CCEEFF", "#DDDDDD")  # of phases, from the palette of Tol (2021)
LOGGED = {"color": REFERENCE, "linewidth": 3.0, "alpha": 0.8}  # looks of a measured curve
PAGE, MOMENTS = "flight.html", 200  # file of the page in space, and how many moments it shows, at most
LEADING = {"tension": "tension", "length": "length", "speed": "reel-out speed"}


def smooth(values):
    """Mean over 1 s; a gap stays a gap."""
    return np.where(np.isnan(values), np.nan, averaged(values))


def range_of(values):
    """Percentiles `SHARE` of the known values of some arrays, two numbers; 0 and 1 if there are none."""
    known = np.concatenate([np.ravel(each) for each in values] or [np.zeros(0)])
    known = known[np.isfinite(known)]
    return np.percentile(known, SHARE) if len(known) else np.array([0.0, 1.0])


def limits(times, measured, others, with_zero=False):
    """Limits of an axis for arrays (times,): measured ones, and others not far beyond them.

    Times before a tether has settled, and single peaks, do not count.
    """
    counts = times >= times[0] + SETTLED
    low, high = range_of([each[counts] for each in others])
    if any(np.isfinite(each[counts]).any() for each in measured):
        least, most = range_of([each[counts] for each in measured])
        beyond = MOST_BEYOND * (most - least)
        low, high = min(least, max(low, least - beyond)), max(most, min(high, most + beyond))
    low, high = (min(low, 0.0), max(high, 0.0)) if with_zero else (low, high)
    margin = MARGIN * (high - low) or 1.0
    return low - margin, high + margin


def draw_tension(axes, made):
    """Tension at the ground: measured, and of each tether."""
    times = made.flight.times
    measured = smooth(made.flight.measured("ground_tension", times))
    tethers = {name: smooth(each.table.mean_tension.to_numpy()) for name, each in made.flown.items()}
    low, high = limits(times, [measured], tethers.values(), with_zero=True)
    factor, unit = (1e-3, "kN") if high > NEWTONS else (1.0, "N")
    axes.plot(times, factor * measured, **LOGGED)
    for name, values in tethers.items():
        axes.plot(times, factor * values, **line_of(name))
    axes.set(ylabel=f"tension at the ground\n(mean over 1 s) [{unit}]", ylim=(factor * low, factor * high))
    if made.lead != "tension":
        notes = [*noise_in(made), *cut_off(times, tethers, low, high)]
        looks = {"facecolor": "white", "alpha": 0.8, "linewidth": 0.0, "pad": 1.5}
        place = {"textcoords": "offset points", "va": "top", "ha": "right", "fontsize": 8, "bbox": looks, "zorder": 6.0}
        axes.annotate("\n".join(notes), (1.0, 1.0), (-6, -5), "axes fraction", **place)


def noise_in(made):
    """A sentence on how much the noise of a position moves the tension of the finest tether where that is taut."""
    band = made.residuals[made.residuals.tether == made.finest[0]].band.to_numpy()
    taut, noise = np.isfinite(band) & ~made.is_slack, made.flight.log.map.smoothing.position_noise
    if taut.any():
        share = 100.0 * taut.mean()
        yield f"taut for {share:.0f} % of the time: {noise:g} m of position is then {newtons(np.median(band[taut]))}"


def cut_off(times, curves, low, high):
    """A sentence on the curve that exceeds an axis most after it has settled; curves : dict of arrays (times,)."""
    known = {name: each[(times >= times[0] + SETTLED) & np.isfinite(each)] for name, each in curves.items()}
    ends = {name: (each.min(), each.max()) for name, each in known.items() if len(each)}
    beyond = {name: max(low - least, most - high) for name, (least, most) in ends.items()}
    name = max(beyond, key=beyond.get, default=None)
    if name and beyond[name] > 0.0:
        least, most = map(newtons, ends[name])
        yield f"beyond the axis: {words(name)}, {least} to {most}"


def newtons(force):
    """A force [N] with its unit, two digits."""
    size = float(f"{force:.2g}")
    return f"{1e-3 * size:g} kN" if abs(size) >= 1000.0 else f"{size:g} N"


def line_of(name):
    """Looks of the curve of a tether; the finest one lies on top."""
    place = list(TETHERS).index(name)
    return {"color": COLOUR[name], "linewidth": 1.3, "zorder": 4.0 - 0.1 * place}


def draw_length(axes, made):
    """Length of each tether minus the logged one; minus its mean where the length at the start is not known."""
    times, curves = made.flight.times, {}
    relative = not made.flight.has_whole_length
    for name, part in made.residuals.groupby("tether", sort=False):
        values = part.length.to_numpy()
        curves[name] = values - np.nanmean(values[times >= times[0] + SETTLED]) * relative
        axes.plot(times, curves[name], **line_of(name))
    axes.axhline(0.0, color=GREY, linewidth=0.8)
    about = "length minus\n∫ reel-out speed,\nless its mean [m]" if relative else "length minus\nthe log's [m]"
    axes.set(ylabel=about, ylim=limits(times, [], curves.values()))


def draw_speed(axes, made):
    """Reel-out speed: logged, and of the length that each tether has."""
    times = made.flight.times
    measured = smooth(made.flight.measured("reel_out_speed", times))
    axes.plot(times, measured, **LOGGED)
    curves = {name: smooth(np.gradient(each.table.tether_length, EVERY)) for name, each in made.flown.items()}
    for name, values in curves.items():
        axes.plot(times, values, **line_of(name))
    axes.axhline(0.0, color=GREY, linewidth=0.8)
    axes.set(ylabel="reel-out speed\n(mean over 1 s) [m/s]", ylim=limits(times, [measured], curves.values()))


def draw_height(axes, made):
    """Height of the end of the tether at the kite, and the ground."""
    axes.plot(made.flight.times, made.flight.kite(made.flight.times)[0][:, 2], color=BLACK, linewidth=1.3)
    draw_ground(axes, made)
    axes.set(ylabel="height of the end\nat the kite [m]")


def draw_sag(axes, made):
    """Sag of each tether, and the length on the ground."""
    times, curves, lying = made.flight.times, {}, False
    for name, each in made.flown.items():
        curves[name] = each.table.sag.to_numpy()
        grounded = each.table.grounded_length.to_numpy()
        if name != "straight":
            axes.plot(times, curves[name], **line_of(name))
        if np.nanmax(grounded) > 0.0:
            axes.plot(times, grounded, **line_of(name) | {"linestyle": (0, (2, 1))})
            curves[f"{name}, on the ground"], lying = grounded, True
    about = "sag (solid), length on\nthe ground (dashed) [m]" if lying else "sag [m]"
    axes.set(ylabel=about, ylim=limits(times, [], curves.values(), with_zero=True))


def draw_ground(axes, made):
    """A line for the ground, if there is one."""
    ground = made.flight.log.map.ground
    if ground.ground_contact == at.FLAT:
        axes.axhline(ground.ground_height, color=GROUND, linewidth=1.5, zorder=1.0)


def panels(made):
    """Functions that draw the relevant panels of this flight, from top to bottom."""
    table = made.flight.log.table
    found = [draw_tension]
    if made.lead == "tension" and made.flight.has_length:
        found.append(draw_length)
    if made.is_slack.mean() > SOME:
        found.append(draw_sag)
    if made.lead == "tension" and "reel_out_speed" in table:
        found.append(draw_speed)
    return [*found, draw_height]


def intervals(times, labels):
    """Triples (label, start, end) [s] of consecutive equal labels; labels : texts, array (times,), "" for none."""
    edges = np.flatnonzero(np.concatenate([[True], labels[1:] != labels[:-1], [True]]))
    for first, behind in pairwise(edges):
        if labels[first]:
            yield str(labels[first]), times[first], times[min(behind, len(times) - 1)]


def labels_of(made, name):
    """Labels of the log at the times of a flight, array (times,) of texts; None if it has none."""
    part = made.residuals[made.residuals.tether == made.finest[0]]
    return part[name].fillna("").astype(str).str.strip().to_numpy() if name in part else None


def shade_phases(all_axes, made):
    """Shade the phases of the log; returns patches for a legend."""
    labels = labels_of(made, "phase")
    if labels is None:
        return []
    found = list(intervals(made.flight.times, labels))
    if len({label for label, _, _ in found}) < 2:
        return []
    colours = dict(zip(sorted({label for label, _, _ in found}), PALE, strict=False))
    for label, start, end in found:
        for axes in all_axes:
            axes.axvspan(start, end, color=colours.get(label, "white"), alpha=0.6, linewidth=0.0, zorder=0.0)
    return [Patch(color=colour, alpha=0.6, label=label) for label, colour in colours.items()]


def mark_cycles(all_axes, made):
    """A line where a cycle begins, with its name above."""
    labels = labels_of(made, "cycle")
    if labels is None or len(set(labels)) < 2:
        return
    for label, start, _ in intervals(made.flight.times, labels):
        for axes in all_axes:
            axes.axvline(start, color="0.45", linewidth=0.8, linestyle=":", zorder=1.0)
        place = {"xytext": (2, -3), "xycoords": ("data", "axes fraction"), "textcoords": "offset points"}
        all_axes[0].annotate(f"cycle {label}", (start, 1.0), **place, va="top", fontsize=8)


def flight_figure(made, name):
    """Figure of a `Replay` over time, with the name of its log."""
    drawn = panels(made)
    figure = Figure(figsize=(WIDTH, 1.6 + 1.9 * len(drawn)), layout="constrained")
    all_axes = figure.subplots(len(drawn), 1, sharex=True, squeeze=False)[:, 0]
    for axes, draw in zip(all_axes, drawn, strict=True):
        draw(axes, made)
        axes.grid(alpha=0.3)
    times = made.flight.times
    all_axes[-1].set(xlabel="time [s]", xlim=(times[0], times[-1]))
    patches = shade_phases(all_axes, made)
    mark_cycles(all_axes, made)
    if patches:
        place = {"loc": "outside lower center", "ncols": len(patches), "frameon": False}
        figure.legend(handles=patches, title="phase of the log", **place)
    add_legend(all_axes[0], made)
    figure.suptitle(f"{name}: the winch follows the measured {LEADING[made.lead]}", fontsize=11)
    figure.align_ylabels(all_axes)
    return figure


def add_legend(axes, made):
    """Legend of the curves, above the uppermost axes."""
    lines = axes.plot([], [], **LOGGED, label="measured") if "ground_tension" in made.flight.log.table else []
    for name in made.flown:
        lines += axes.plot([], [], **line_of(name), label=words(name))
    axes.legend(handles=lines, loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=len(lines), frameon=False)


def side_view(shapes):
    """Distance along the ground towards the kite, and height [m], of points (rows, points, 3); two arrays (rows, points)."""
    towards = shapes[:, -1, :2]
    towards = towards / np.maximum(np.linalg.norm(towards, axis=1, keepdims=True), 1e-9)
    return np.einsum("rpk,rk->rp", shapes[:, :, :2], towards), shapes[:, :, 2]


def moments(shapes):
    """Rows of shapes, about `SHAPES` of those that are known, evenly spaced, the first and the last among them."""
    known = np.flatnonzero(np.isfinite(shapes).all(axis=(1, 2)))
    return known[np.unique(np.linspace(0, len(known) - 1, SHAPES).round().astype(int))]


def shapes_figure(made, name):
    """Figure of the shapes of the finest tether at some times: in the vertical plane through the kite, and from above."""
    variant, flown = made.finest
    rows = moments(flown.shapes)
    shapes, kite = flown.shapes[rows], made.flight.kite(made.flight.times)[0]
    along, height = side_view(shapes)
    side = along, height, np.linalg.norm(kite[:, :2], axis=1), kite[:, 2]
    above = shapes[:, :, 0], shapes[:, :, 1], kite[:, 0], kite[:, 1]
    boxes = [[box(np.append(x, path_x)), box(np.append(y, path_y))] for x, y, path_x, path_y in (side, above)]
    figure, all_axes, below = views(np.ptp(boxes, axis=2))
    for axes, view, (x_limits, y_limits) in zip(all_axes, (side, above), boxes, strict=True):
        draw_shapes(axes, *view)
        axes.set(xlim=x_limits, ylim=y_limits)
    draw_ground(all_axes[0], made)
    all_axes[0].set(xlabel="along the ground, towards the kite [m]", ylabel="height [m]")
    all_axes[1].set(xlabel="east [m]", ylabel="north [m]")
    for axes, title in zip(all_axes, ("from the side", "from above"), strict=True):
        axes.set_title(title, fontsize=10)
    add_scale(figure, below, made.flight.times[rows])
    title, top = f"{name}: the {words(variant)} tether at {len(rows)} times", 1.0 - 0.1 / figure.get_figheight()
    figure.suptitle(title, fontsize=11, y=top, va="top")
    return figure


def views(sizes):
    """A figure with two axes of the same scale side by side, and axes below them for a scale of colours.

    sizes : widths and heights of both [m], array (2, 2).
    """
    widths, heights = np.transpose(sizes)
    left, right, bottom, top = BORDERS
    inches = min((WIDTH - 2.0 * left - right) / widths.sum(), TALLEST / heights.max())
    height = bottom + inches * heights.max() + top
    figure, start, all_axes = Figure(figsize=(WIDTH, height)), left, []
    for width, tall in inches * sizes:
        all_axes.append(figure.add_axes((start / WIDTH, bottom / height, width / WIDTH, tall / height)))
        start += width + left
    below = figure.add_axes((left / WIDTH, 0.48 / height, 1.0 - (left + right) / WIDTH, 0.15 / height))
    return figure, all_axes, below


def box(values):
    """Limits of an axis [m] that has all values and the station, with room around them."""
    low, high = min(np.nanmin(values), 0.0), max(np.nanmax(values), 0.0)
    room = max(MARGIN * (high - low), ROOM)
    return low - room, high + room


def draw_shapes(axes, x, y, path_x, path_y):
    """Shapes, arrays (rows, points) [m], a colour for each row, with the path of the kite, arrays (times,), behind."""
    axes.plot(path_x, path_y, color=GREY, linewidth=0.8, zorder=1.0)
    for colour, one, other in zip(colours_of(len(x)), x, y, strict=True):
        axes.plot(one, other, color=colour, linewidth=1.6)
        axes.plot(one[-1], other[-1], "o", color=colour, markersize=5)
    axes.plot(0.0, 0.0, "s", color=BLACK, markersize=6)
    axes.grid(alpha=0.3)


def colours_of(count):
    """Colours for shapes one after the other, from dark to light, array (count, 4)."""
    return colormaps["viridis"](np.linspace(0.0, 0.92, count))


def add_scale(figure, axes, times):
    """Colour scale of time, in separate axes."""
    count = len(times)
    colours = ScalarMappable(BoundaryNorm(np.arange(count + 1) - 0.5, count), ListedColormap(colours_of(count)))
    scale = figure.colorbar(colours, cax=axes, orientation="horizontal", ticks=range(count))
    axes.set_xticklabels([f"{time:.1f}" for time in times])
    axes.tick_params(length=0)
    scale.set_label("time [s]")


def write(made, place, name):
    """Write all figures to a folder; returns their paths."""
    figures = {"flight.png": flight_figure(made, name), "shapes.png": shapes_figure(made, name)}
    for file, figure in figures.items():
        figure.savefig(place / file, dpi=DPI, metadata={"Software": None})
    return [place / file for file in figures]


def drawing():
    """The module that draws pages; ModuleNotFoundError without plotly."""
    return example("shared.flight_page")


def seen(flown):
    """Times [s], shapes [m] and end forces [N] of a `runs.Flown`, where its tether did not refuse."""
    table, known = flown.table, np.isfinite(flown.shapes).all(axis=(1, 2))
    forces = {end: table[[f"{end}[{i}]" for i in (1, 2, 3)]].to_numpy()[known] for end in FORCES}
    return SimpleNamespace(time=table.time.to_numpy()[known], shape=flown.shapes[known], **forces)


def write_page(made, place, name):
    """Write the page of the finest tether of a `Replay` to a folder; returns its path."""
    variant, flown = made.finest
    ground, path = made.flight.log.map.ground, made.flight.kite(made.flight.times)[0]
    height = ground.ground_height if ground.ground_contact == at.FLAT else None
    title = f"Tether along the flight of {name}"
    drawing().write_page({class_name(variant): seen(flown)}, place / PAGE, path, MOMENTS, title, height)
    return place / PAGE
