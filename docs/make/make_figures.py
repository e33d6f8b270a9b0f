"""Draw docs/figures/circle.png, shapes and forces along one turn of the example; `python docs/make/make_figures.py`."""

import sys
from pathlib import Path

DOCS = Path(__file__).resolve().parents[1]
sys.path.append(str(DOCS.parent / "examples"))
WIND = (8.0, 0.0, 0.0)


def draw(flight, path):
    """Shapes in space at the left, forces over time at the right."""
    from shared.flight_figures import ENDS, draw_components, draw_shapes, plt, times_of

    figure = plt.figure(figsize=(12.0, 5.2), layout="constrained")
    grid = figure.add_gridspec(2, 2, width_ratios=(1.25, 1.0))
    space = figure.add_subplot(grid[:, 0], projection="3d")
    flights = {"TetherDynamic": flight}
    colours = times_of(flights)
    draw_shapes(space, flights, 20, colours)
    space.legend(loc="upper left", frameon=False)
    figure.colorbar(colours, ax=space, label="time [s]", shrink=0.6, pad=0.02, location="left")
    for row, (field, end) in enumerate(ENDS.items()):
        axes = figure.add_subplot(grid[row, 1])
        draw_components(axes, flight.time, getattr(flight, field))
        axes.set(title=f"Force of the tether on the {end}", ylabel="force [N]", xlim=flight.time[[0, -1]])
        axes.grid(alpha=0.3)
        axes.tick_params(labelbottom=row == len(ENDS) - 1)
    axes.set_xlabel("time [s]")
    figure.savefig(path, dpi=90, metadata={"Software": None})


def main():
    """Fly the circle of the example with `TetherDynamic.fmu` in wind and draw it."""
    from first_flight.circular_flight import find_fmu, fly

    folder = DOCS / "figures"
    folder.mkdir(exist_ok=True)
    draw(fly(find_fmu("TetherDynamic"), length=525.0, wind=WIND), folder / "circle.png")


if __name__ == "__main__":
    main()
