"""How does the tether move along a flight? An interactive page in space, for `circular_flight.py --html`; needs plotly."""

import numpy as np
import plotly.graph_objects as go


def line(points, name, mode):
    """A curve in space; points : array (n, 3) [m]."""
    return go.Scatter3d(dict(zip("xyz", points.T, strict=True)), name=name, mode=mode, line_width=4, marker_size=2)


def scene(shapes):
    """Axes that hold all shapes, to scale; shapes : array (n, 3) of all points [m]."""
    low, high = shapes.min(axis=0) - 10.0, shapes.max(axis=0) + 10.0
    axes = {f"{axis}axis": {"title": f"{axis} [m]", "range": [low[i], high[i]]} for i, axis in enumerate("xyz")}
    return {"aspectmode": "data", **axes}


def write_page(flights, file, count=100, title="Tether of a kite that flies a circle"):
    """Write a self-contained page with the tether at `count` times of the flight: a slider and a play button.

    flights : dict name -> `Flight` with the same times, or what else has `time` and `shape`.
    """
    first = next(iter(flights.values()))
    moments = np.linspace(0, len(first.time) - 1, count).astype(int)
    frames = []
    for k in moments:
        tethers = [line(flight.shape[k], name, "lines+markers") for name, flight in flights.items()]
        frames.append(go.Frame(name=f"{first.time[k]:.1f}", data=tethers))
    shapes = np.array(first.shape)[moments]
    path = line(shapes[:, -1], "flight path", "lines")
    show = {"frame": {"duration": 60, "redraw": True}, "transition": {"duration": 0}, "mode": "immediate"}
    steps = [{"label": frame.name, "method": "animate", "args": [[frame.name], show]} for frame in frames]
    buttons = [
        {"label": "Play", "method": "animate", "args": [None, {**show, "fromcurrent": True}]},
        {"label": "Pause", "method": "animate", "args": [[None], show]},
    ]
    page = go.Figure([*frames[0].data, path], frames=frames)
    page.update_layout(
        title=title,
        showlegend=True,
        scene=scene(np.concatenate([np.array(flight.shape)[moments].reshape(-1, 3) for flight in flights.values()])),
        sliders=[{"steps": steps, "currentvalue": {"prefix": "time [s]: "}}],
        updatemenus=[{"type": "buttons", "buttons": buttons, "x": 0.0, "xanchor": "left"}],
    )
    page.write_html(file, include_plotlyjs=True)
