"""Draw the figures of examples and of tables: `python docs/make/make_figures.py`, or the named ones, such as `landing`."""

import csv
import sys
from functools import partial
from importlib import import_module
from pathlib import Path
from tempfile import TemporaryDirectory

import pandas as pd

from pictures import as_svg, save

DOCS = Path(__file__).resolve().parents[1]
FIGURES, DATA = DOCS / "figures", DOCS / "data"
sys.path += [str(DOCS.parent / "examples"), str(DOCS.parent / "tests" / "benchmarks")]
WIND = (8.0, 0.0, 0.0)
EXAMPLES = {  # module, its options, and its figures: name that it writes -> name in the manual
    "breaking_tether": ("ground.breaking_tether", [], {}),
    "constant_tension": ("cranes.constant_tension", [], {}),
    "four_drones": ("systems.four_drones", [], {"four_drones_7s": "four_drones"}),
    "force_spectrum": ("wind.force_spectrum", [], {}),
    "hoist": ("systems.hoist", [], {}),
    "hoisting": ("cranes.hoisting", [], {}),
    "kite_on_circle": ("learning.steered_circle", [], {}),
    "landing": ("ground.landing", [], {}),
    "pumping_cycle": (
        "power_system.pumping_cycle",
        ["--cycles", "2"],
        {"pumping_path": "pumping_path", "pumping_series": "pumping_series"},
    ),
    "set_down": ("cranes.set_down", [], {}),
    "sheaves": ("systems.sheaves", [], {}),
    "turbulence": ("wind.turbulence", [], {}),
    "steered_kite": ("systems.steered_kite", [], {}),
    "two_kites": ("systems.two_kites", [], {}),
    "winch_inside": ("power_system.winch_inside", [], {}),
    "y_bridle": ("systems.y_bridle", [], {}),
}


def of_example(name):
    """Run an example, and take its figures."""
    module, options, figures = EXAMPLES[name]
    with TemporaryDirectory() as folder, as_svg():
        import_module(module).main([*options, "--out", folder])
        for written, shown in (figures or {name: name}).items():
            (Path(folder) / f"{written}.svg").replace(FIGURES / f"{shown}.svg")


def circle():
    """The circle of the example in wind."""
    from first_flight.circular_flight import find_fmu, fly

    draw_beside(fly(find_fmu("TetherDynamic"), length=525.0, wind=WIND), 20, "circle", (12.0, 5.2))


def first_flight():
    """The figure of eight that the README flies first."""
    from first_flight.scene_flight import find_fmu, fly, scene_of

    draw_beside(fly(find_fmu("TetherDynamic"), scene_of("eight_on_a_winch")), 12, "first_flight", (8.6, 4.4))


def draw_beside(flight, count, name, size):
    """Shapes in space at the left, so many of them, forces over time at the right; size of the figure [in]."""
    from shared.flight_figures import ENDS, draw_components, draw_shapes, plt, times_of

    figure = plt.figure(figsize=size, layout="constrained")
    grid = figure.add_gridspec(2, 2, width_ratios=(1.25, 1.0))
    space = figure.add_subplot(grid[:, 0], projection="3d")
    flights = {"TetherDynamic": flight}
    colours = times_of(flights)
    draw_shapes(space, flights, count, colours)
    space.legend(loc="upper left", frameon=False)
    figure.colorbar(colours, ax=space, label="time [s]", shrink=0.6, pad=0.02, location="left")
    for row, (field, end) in enumerate(ENDS.items()):
        axes = figure.add_subplot(grid[row, 1])
        draw_components(axes, flight.time, getattr(flight, field))
        axes.set(ylabel="force [N]", xlim=flight.time[[0, -1]])
        axes.set_title(f"Force of the tether on the {end}", fontsize="medium" if size[0] < 10.0 else "large")
        axes.grid(alpha=0.3)
        axes.tick_params(labelbottom=row == len(ENDS) - 1)
    axes.set_xlabel("time [s]")
    save(figure, FIGURES / name)


def coupling():
    """The figures of `examples/coupling/coupling_limits.py`, from its tables."""
    from coupling.coupling_figures import DRAWN

    for name, draw in DRAWN.items():
        save(draw(pd.read_csv(DATA / f"coupling_{name}.csv")), FIGURES / f"coupling_{name}")


def fixed_steps():
    """The figure of `tests/benchmarks/fixed_steps.py`, from its table."""
    from fixed_steps import draw

    names = {"solver": "method", "error, median": "error: median [%]", "largest force, 95 %": "largest force: 95 % [%]"}
    table = pd.read_csv(DATA / "fixed_steps_by_step.csv").rename(columns=names | {"time of a scene": "time of a scene [ms]"})
    numbers = [name for name in table if name.endswith("]")]
    table[numbers] = table[numbers].map(lambda text: float(text.split()[0]))
    with as_svg():
        draw(table, FIGURES / "fixed_steps")


def work_precision():
    """The figure of `make_benchmarks.py`, from its table."""
    from benchmark.races import draw

    columns = ["table", "scene", "segments", "solver", "tolerance", "error", "ms"]
    with (DATA / "benchmarks.csv").open(encoding="utf-8", newline="") as file:
        rows = [row[: len(columns)] for row in csv.reader(file) if row and row[0] == "Work and precision"]
    table = pd.DataFrame(rows, columns=columns).astype(dict.fromkeys(["segments", "tolerance", "error", "ms"], float))
    with as_svg():
        draw(table.assign(segments=table.segments.astype(int), seconds=1e-3 * table.ms), FIGURES / "work_precision")


DRAWN = {
    **{name: partial(of_example, name) for name in EXAMPLES},
    **{each.__name__: each for each in (circle, coupling, first_flight, fixed_steps, work_precision)},
}


def main(names):
    """Draw the figures of these names, all if there are none."""
    for name in names or DRAWN:
        print(name)
        DRAWN[name]()


if __name__ == "__main__":
    main(sys.argv[1:])
