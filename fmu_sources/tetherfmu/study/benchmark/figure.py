"""Work-precision diagram: time against error, one panel per scene; our default tolerance, 1e-4, is marked."""

from pathlib import Path

from .races import COMPILED, OURS, RESTARTED, WHOLE

STYLES = {
    OURS: {"color": "C0", "marker": "o", "linewidth": 2.0},
    WHOLE: {"color": "C1", "marker": "s"},
    WHOLE + COMPILED: {"color": "C1", "marker": "s", "linestyle": "--", "markerfacecolor": "white"},
    RESTARTED: {"color": "C3", "marker": "^"},
    RESTARTED + COMPILED: {"color": "C3", "marker": "^", "linestyle": "--", "markerfacecolor": "white"},
}
TITLES = {
    "circle": "Circle, {n} segments",
    "figure of eight": "Figure of eight, {n} segments",
    "release": "Released tether, {n} segments",
}


def draw(points, path):
    """Write the diagram to a PNG file."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt
    from matplotlib.ticker import LogLocator, NullFormatter

    panels = list(dict.fromkeys((p.scene, p.segments) for p in points))
    figure, axes = plt.subplots(1, len(panels), figsize=(4.2 * len(panels), 4.2), squeeze=False, layout="constrained")
    handles = {}
    for axis, (scene, n) in zip(axes[0], panels, strict=True):
        for solver, style in STYLES.items():
            mine = [p for p in points if (p.scene, p.segments, p.solver) == (scene, n, solver)]
            if mine:
                mine.sort(key=lambda p: p.tolerance)
                x, y = [p.error for p in mine], [1e3 * p.seconds for p in mine]
                handles[solver] = axis.loglog(x, y, markersize=5, label=solver, **style)[0]
        for point in points:
            if (point.scene, point.segments, point.solver, point.tolerance) == (scene, n, OURS, 1e-4):
                place = (point.error, 1e3 * point.seconds)
                axis.annotate("default", place, (0, -7), textcoords="offset points", ha="center", va="top", fontsize=9)
        axis.set_title(TITLES[scene].format(n=n), fontsize=11)
        axis.set_xlabel("error of the node positions, rms [m]")
        axis.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axis.yaxis.set_major_formatter("{x:g}")
        axis.yaxis.set_minor_formatter(NullFormatter())
        axis.grid(which="major", color="0.9")
        axis.set_axisbelow(True)
        axis.margins(0.12)
        axis.invert_xaxis()
    axes[0, 0].set_ylabel("time for the run [ms]")
    figure.legend(
        handles.values(), handles.keys(), loc="outside lower center", ncols=len(handles), frameon=False, fontsize=9
    )
    Path(path).parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=100, metadata={"Software": None})
    plt.close(figure)
