"""How does the tether move along a flight? An interactive page in space, for the option --html; needs plotly."""

from html import escape
from pathlib import Path

import numpy as np
import plotly.graph_objects as go

from tetherfmu.console.colours import BLACK, GREY, GROUND, coloured

ARROW = 0.2  # length of the largest force, part of the diagonal of the scene
EYE = {"x": 1.8, "y": 1.08, "z": 0.8}  # from where the scene is seen: all of it, with the names of its axes
LONGEST = 1.7, 1.7, 1.4  # sides x, y, z of a scene as it is drawn: of longer ones not all is seen from there
DIGITS = 6  # of a place [m]: of a plane flight plotly magnifies rounding errors
HEAD = 0.18  # of an arrow, half of the length of its cone, part of its length
SHAFT = {"width": 9}  # of an arrow: wider than a tether, which it lies on if that is taut
MOST = 10_000  # points of the path of the kite
PAGE = """<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title}</title>
<style>
body {{ margin: 0; height: 100dvh; display: flex; flex-direction: column; font-family: sans-serif; }}
h1 {{ font-size: 1.2rem; margin: 0.8rem 1rem 0; }}
p {{ margin: 0.3rem 1rem 0; }}
main {{ flex: 1; min-height: 0; }}
@media (prefers-color-scheme: dark) {{
  html {{ background: #141414; }}
  body {{ filter: invert(0.92) hue-rotate(180deg); }}
}}
</style>
</head>
<body>
<h1>{title}</h1>
{note}<main>{scene}</main>
</body>
</html>
"""
NOTE = "<p>Arrows: force of the tether on the kite and on the ground station.</p>\n"
#: in a window narrower than the scene the eye goes back, until the scene fits
STEP_BACK = """
const plot = document.getElementById("{plot_id}");
const eye = plot.layout.scene.camera.eye;
const way = Math.max(1, 1.4 * plot.clientHeight / plot.clientWidth);
if (way > 1) Plotly.relayout(plot, {"scene.camera.eye": {x: way * eye.x, y: way * eye.y, z: way * eye.z}});
"""


def line(points, name, mode, colour, **options):
    """A curve in space; points : array (n, 3) [m]."""
    looks = {"line": {"width": 4, "color": colour}, "marker": {"size": 2, "color": colour}, **options}
    points = np.round(points, DIGITS)
    return go.Scatter3d(dict(zip("xyz", np.transpose(points), strict=True)), name=name, mode=mode, **looks)


def arrow(start, force, scale, colour):
    """Shaft and head of the arrow of a force [N] on a point [m]; scale [m/N]."""
    end, head = np.round((start + scale * force, HEAD * scale * force), DIGITS)
    place = dict(zip("xyz", end[:, None], strict=True)) | dict(zip("uvw", head[:, None], strict=True))
    looks = {"colorscale": [[0, colour], [1, colour]], "showscale": False, "anchor": "tip", "hoverinfo": "skip"}
    text = f"{np.linalg.norm(force):.1f} N"
    wide = {"line": {"color": colour, **SHAFT}}
    shaft = line([start, end - head], text, "lines", colour, showlegend=False, hovertemplate=text, **wide)
    return shaft, go.Cone(**place, sizemode="absolute", sizeref=2.0 * np.linalg.norm(head), **looks)


def scene(points):
    """Axes that hold all points, to scale; points : array (n, 3) [m]."""
    low, high = points.min(axis=0) - 10.0, points.max(axis=0) + 10.0
    axes = {f"{axis}axis": {"title": f"{axis} [m]", "range": [low[i], high[i]]} for i, axis in enumerate("xyz")}
    sides = (high - low) / np.cbrt(np.prod(high - low))  # as they are drawn: the volume is that of a cube
    way = max(1.0, (sides / LONGEST).max())
    eye = {axis: way * place for axis, place in EYE.items()}
    ratio = dict(zip("xyz", sides.tolist(), strict=True))
    return {
        "aspectmode": "manual",
        "aspectratio": ratio,
        "camera": {"eye": eye, "center": {"x": 0.0, "y": 0.0, "z": -0.15}},
        **axes,
    }


def plane(axes, height):
    """The ground: a plane across the axes of a `scene`, at a height [m]."""
    (west, east), (south, north) = (axes[f"{axis}axis"]["range"] for axis in "xy")
    corners = {"x": [west, east, east, west], "y": [south, south, north, north], "z": [height] * 4}
    looks = {"color": GROUND, "opacity": 0.35, "showlegend": True, "hoverinfo": "skip"}
    return go.Mesh3d(**corners, i=[0, 0], j=[1, 2], k=[2, 3], name="ground", **looks)


def moment(flights, k, scale, paths=None):
    """Curves of one time: of each flight the tether, its ends, and the forces that it knows, as arrows.

    paths : of points by name, arrays (rows, 3) [m], which are shown in the place of the ends.
    """
    drawn = []
    for name, flight, colour in coloured(flights):
        shape = np.asarray(flight.shape[k])
        drawn.append(line(shape, name, "lines+markers", colour))
        for field, end in (("kite_force", -1), ("ground_force", 0)):
            if getattr(flight, field, None) is not None:
                drawn += arrow(shape[end], np.asarray(getattr(flight, field)[k]), scale, colour)
    names, symbols, places = ["ground station", "kite"], ["square", "diamond"], shape[[0, -1]]
    if paths:
        names, symbols, places = list(paths), ["diamond"] * len(paths), np.array([path[k] for path in paths.values()])
    ends = {"marker": {"size": 6, "color": BLACK, "symbol": symbols}}
    named = {"text": names, "textposition": "top center", "showlegend": False}
    return [*drawn, line(places, "ends", "markers+text", BLACK, **ends, **named)]


def scale_of(flights, points):
    """Length of the arrow of a newton [m/N]."""
    fields = ("kite_force", "ground_force")
    forces = [getattr(flight, field, None) for flight in flights.values() for field in fields]
    largest = max((np.linalg.norm(force, axis=-1).max() for force in forces if force is not None), default=0.0)
    return ARROW * np.linalg.norm(np.ptp(points, axis=0)) / largest if largest > 0.0 else 0.0


def controls(frames):
    """Slider and buttons, below the scene."""
    show = {"frame": {"duration": 60, "redraw": True}, "transition": {"duration": 0}, "mode": "immediate"}
    steps = [{"label": frame.name, "method": "animate", "args": [[frame.name], show]} for frame in frames]
    buttons = [
        {"label": "Play", "method": "animate", "args": [None, {**show, "fromcurrent": True}]},
        {"label": "Pause", "method": "animate", "args": [[None], show]},
    ]
    slider = {"steps": steps, "currentvalue": {"prefix": "time [s]: ", "xanchor": "right"}, "y": 0.0, "pad": {"t": 16}}
    place = {"x": 0.0, "xanchor": "left", "y": 0.0, "yanchor": "top", "direction": "left"}
    return {"sliders": [slider], "updatemenus": [{"type": "buttons", "buttons": buttons, **place}]}


def some_of(number, most):
    """Indices of at most so many of a number of rows, evenly spaced, with the first and the last."""
    return np.linspace(0, number - 1, min(number, most)).astype(int)


def curves_of(paths):
    """Grey curves of the paths, arrays (n, 3) [m] by name, of what moves."""
    some = {name: np.asarray(path)[some_of(len(path), MOST)] for name, path in paths.items()}
    return [line(path, f"path of {name}", "lines", GREY) for name, path in some.items() if np.ptp(path, axis=0).any()]


def write_page(flights, file, path, count=100, title="Tether along a flight", ground=None, *, paths=None, note=NOTE):
    """Write a self-contained page with the tether at `count` times of the flight: a slider and a play button.

    flights : dict name -> `Flight` with the same times, or what else has `time` and `shape`; `kite_force` and `ground_force`
    are drawn as arrows where they are known.  path : array (n, 3), flown by the kite [m].  ground : its height
    [m]; None: there is none.  paths : of a system those of its points by name, a row for each time, in the place of `path`.
    note : what the arrows are, in HTML.
    """
    first = next(iter(flights.values()))
    moments = some_of(len(first.time), count)
    still = curves_of(paths or {"the kite": path})
    points = np.concatenate(
        [
            path if paths is None else paths[next(iter(paths))],
            *(np.asarray(flight.shape)[moments].reshape(-1, 3) for flight in flights.values()),
        ]
    )
    scale = scale_of(flights, points)
    frames = [go.Frame(name=f"{first.time[k]:.1f}", data=moment(flights, k, scale, paths)) for k in moments]
    axes = scene(points)
    if not paths:
        still += curves_of({"the ground station": np.asarray(first.shape)[moments, 0]})
    if ground is not None:
        still.append(plane(axes, ground))
    page = go.Figure([*frames[0].data, *still], frames=frames)
    margin = {"l": 20, "r": 20, "t": 30, "b": 110}
    legend = {"x": 0.01, "y": 0.99, "bgcolor": "rgba(255, 255, 255, 0.7)"}
    page.update_layout(scene=axes, margin=margin, legend=legend, showlegend=True, **controls(frames))
    config = {"displaylogo": False, "responsive": True, "showSendToCloud": False}
    whole = {"include_plotlyjs": True, "auto_play": False, "post_script": STEP_BACK, "default_height": "100%"}
    drawn = page.to_html(config, full_html=False, **whole)
    text = PAGE.format(title=escape(title), note=note if scale else "", scene=drawn)
    Path(file).write_text(text, encoding="utf-8")
