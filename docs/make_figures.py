"""Draw docs/figures/circle.png: the tether along one turn of the example; `python docs/make_figures.py`."""

import sys
from pathlib import Path

DOCS = Path(__file__).resolve().parent
sys.path.append(str(DOCS.parent / "examples"))


def main():
    """Fly the circle of the example with `TetherDynamic.fmu` and draw its shapes."""
    from circular_flight import find_fmu, fly
    from flight_figures import plot_shapes

    folder = DOCS / "figures"
    folder.mkdir(exist_ok=True)
    flights = {"TetherDynamic": fly(find_fmu("TetherDynamic"), length=525.0)}
    plot_shapes(flights).savefig(folder / "circle.png", dpi=90)


if __name__ == "__main__":
    main()
