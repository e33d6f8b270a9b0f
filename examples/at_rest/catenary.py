"""How well does a chain of few segments hang like the exact catenary, and what does it pull at its ends?

The kite stands still at (100, 100, 800) m, on a tether that is 5 % longer than its distance; no wind. TetherCatenary is the
exact elastic catenary, TetherQuasiSteady a chain of 5 and of 22 segments.

    python examples/at_rest/catenary.py
"""

import sys
from pathlib import Path

import numpy as np

from tetherfmu.console.colours import COLOUR, SKY_BLUE
from tetherfmu.console.ending import command
from tetherfmu.console.options import Parser
from tetherfmu.console.progress import now

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # the folder of the rooms
from at_rest.still import hold
from shared.fmu_tools import add_fmu, find_fmu, variables_of

KITE = (100.0, 100.0, 800.0)
LENGTH = 1.05 * np.linalg.norm(KITE)
TETHERS = {
    "catenary": ("TetherCatenary", 20),
    "5 segments": ("TetherQuasiSteady", 5),
    "22 segments": ("TetherQuasiSteady", 22),
}


def compare(own=None):
    """Dict name -> `Rest` of each tether; own : the file of an FMU, with its own number of segments, beside the catenary."""
    if own:
        variables_of(own)  # before others are built
    files = {name: (find_fmu(file), {"segments": n}) for name, (file, n) in TETHERS.items() if not own or name == "catenary"}
    files |= {own.stem: (own, {})} if own else {}
    return {
        name: hold(file, [{**options, "initial_length": LENGTH}], KITE, shape=True)[0]
        for name, (file, options) in files.items()
    }


def plot(rests):
    """Side view in the vertical plane through ground station and kite; how far the chains are from the catenary."""
    from shared.flight_figures import plt

    figure, (side, apart) = plt.subplots(1, 2, figsize=(10.0, 5.0), layout="constrained")
    exact = rests["catenary"].shape
    looks = dict(zip(rests, ((COLOUR["catenary"], "-"), (SKY_BLUE, "o--"), (COLOUR["quasi_steady"], ".-")), strict=False))
    for name, rest in rests.items():
        colour, style = looks[name]
        side.plot(
            np.hypot(rest.shape[:, 0], rest.shape[:, 1]), rest.shape[:, 2], style, color=colour, markersize=4, label=name
        )
        if name != "catenary":
            part, known = (np.linspace(0.0, 100.0, len(shape)) for shape in (rest.shape, exact))
            same = np.transpose([np.interp(part, known, coordinate) for coordinate in exact.T])
            distance = np.linalg.norm(rest.shape - same, axis=1)
            apart.plot(part, distance, style, color=colour, markersize=4)
            middle = len(part) // 3
            apart.annotate(name, (part[middle], distance[middle]), (4, 8), textcoords="offset points", color=colour)
    side.plot([0.0, np.hypot(*KITE[:2])], [0.0, KITE[2]], color="gray", linewidth=0.8, label="chord")
    side.legend()
    side.set(title="Tether of a kite that stands still", xlabel="horizontal distance [m]", ylabel="height [m]")
    apart.set(
        title="Distance from the exact catenary", xlabel="place on the tether, from the ground [%]", ylabel="distance [m]"
    )
    for axes in (side, apart):
        axes.grid(alpha=0.3)
    return figure


@command
def main(arguments=None):
    """Print the end forces, write the figure."""
    parser = Parser(description="compare the chain with the exact catenary")
    parser.add_out()
    add_fmu(parser)
    given = parser.parse_args(arguments)
    now("holding the tethers")
    rests = compare(given.fmu)
    for name, rest in rests.items():
        ground, kite = (", ".join(f"{part:.3f}" for part in force) for force in (rest.ground_force, rest.kite_force))
        print(f"{name}: force on the ground station ({ground}) N, on the kite ({kite}) N")
    given.out.mkdir(parents=True, exist_ok=True)
    now("drawing")
    plot(rests).savefig(given.out / "catenary.png", dpi=150)


if __name__ == "__main__":
    sys.exit(main())
