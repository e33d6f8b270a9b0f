"""Work-precision diagram: time against error, one panel per scene; our default tolerance, 1e-4, is marked."""

from math import ceil

from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter

from tetherfmu.console.colours import BLACK, COLOUR, REFERENCE

from .races import COMPILED, DEFAULT, OURS, RESTARTED, WHOLE

COLUMNS = 2  # of panels
IN_C = {"linestyle": "--", "markerfacecolor": "white"}
STYLES = {
    OURS: {"color": COLOUR["dynamic"], "marker": "o", "linewidth": 2.0},
    WHOLE: {"color": REFERENCE, "marker": "s"},
    WHOLE + COMPILED: {"color": REFERENCE, "marker": "s", **IN_C},
    RESTARTED: {"color": BLACK, "marker": "^"},
    RESTARTED + COMPILED: {"color": BLACK, "marker": "^", **IN_C},
}
TITLES = {"circle": "Circle", "figure of eight": "Figure of eight", "release": "Released tether"}


def draw(runs, path):
    """Write the diagram of a table of races to a PNG file (Path)."""
    panels = list(runs.groupby(["scene", "segments"], sort=False))
    rows, handles = ceil(len(panels) / COLUMNS), {}
    figure = Figure(figsize=(5.2 * COLUMNS, 4.0 * rows + 0.4), layout="constrained")
    for place, ((scene, n), mine) in enumerate(panels, 1):
        axis = figure.add_subplot(rows, COLUMNS, place)
        for solver, theirs in mine.sort_values("tolerance").groupby("solver", sort=False):
            handles[solver] = axis.loglog(theirs.error, 1e3 * theirs.seconds, markersize=5, **STYLES[solver])[0]
        for each in mine[(mine.solver == OURS) & (mine.tolerance == DEFAULT)].itertuples():
            place = each.error, 1e3 * each.seconds
            axis.annotate("default", place, (0, -7), textcoords="offset points", ha="center", va="top", fontsize=9)
        axis.set_title(f"{TITLES[scene]}, {n} segments", fontsize=11)
        axis.set(xlabel="error of the node positions, rms [m]", axisbelow=True)
        axis.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axis.yaxis.set_major_formatter("{x:g}")
        axis.yaxis.set_minor_formatter(NullFormatter())
        axis.grid(which="major", color="0.9")
        axis.margins(0.12)
        axis.invert_xaxis()
    figure.supylabel("time for the run [ms]", fontsize=10)
    shown = {solver: handles[solver] for solver in STYLES if solver in handles}
    figure.legend(shown.values(), shown.keys(), loc="outside lower center", ncols=3, frameon=False, fontsize=9)
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=100, metadata={"Software": None})
