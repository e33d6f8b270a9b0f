"""How much does a tether pull at its ends, in which wind and with how much slack, and which model is enough?

The kite stands still at (300, 0, 400) m, 500 m from the ground station, in a wind from 0 to 25 m/s along x. Every tether
FMU, and several lengths around 500 m. The dynamic tether is in its static equilibrium.

    python examples/forces_over_wind_and_slack.py
"""

import sys
from pathlib import Path

import numpy as np
from circular_flight import TETHERS
from fmu_tools import add_fmu, find_fmu
from still import hold

from tetherfmu.console.colours import BLACK, BLUE, REFERENCE, SKY_BLUE, VERMILLION
from tetherfmu.console.ending import command
from tetherfmu.console.options import Parser, folder
from tetherfmu.console.progress import now

KITE = (300.0, 0.0, 400.0)
SLACKS = (-0.002, 0.0, 0.01, 0.05)
SLACK_COLOURS = (BLACK, VERMILLION, BLUE, SKY_BLUE)
WINDS = np.linspace(0.0, 25.0, 26)


def survey(files=None, slacks=SLACKS, winds=WINDS):
    """Dict name of the tether -> forces [N], array (slacks, winds, 2): magnitude at the ground station and at the kite.

    files : dict name of the tether -> FMU, None: those in dist/.  slacks [-], winds [m/s].
    """
    files = files or {name: find_fmu(file) for name, file in TETHERS.items()}
    distance = np.linalg.norm(KITE)
    cases = [{"initial_length": distance * (1.0 + slack), "wind": (wind, 0.0, 0.0)} for slack in slacks for wind in winds]
    forces = {}
    for name, file in files.items():
        rests = hold(file, cases, KITE)
        magnitudes = [[np.linalg.norm(rest.ground_force), np.linalg.norm(rest.kite_force)] for rest in rests]
        forces[name] = np.reshape(magnitudes, (len(slacks), len(winds), 2))
    return forces


def plot(forces, slacks=SLACKS, winds=WINDS):
    """Force at both ends over the wind, a colour for each slack and a line style for each tether."""
    from flight_figures import plt

    figure, panels = plt.subplots(1, 2, figsize=(10.0, 5.5), sharey=True, layout="constrained")
    styles = {"dynamic": "-", "quasi_steady": "o", "catenary": "--", "straight": ":"}
    for end, (axes, title) in enumerate(zip(panels, ("ground station", "kite"), strict=True)):
        for number, slack in enumerate(slacks):
            for name, values in forces.items():
                options = {"markersize": 3, "markevery": 2, "color": SLACK_COLOURS[number]}
                axes.semilogy(winds, values[number, :, end], styles.get(name, "-"), **options)
            axes.plot([], [], color=SLACK_COLOURS[number], label=f"{100 * slack:+.1f} % slack")
        for name in forces:
            axes.plot([], [], styles.get(name, "-"), markersize=3, color=REFERENCE, label=name)
        axes.set(title=f"Force on the {title}", xlabel="wind [m/s]", ylabel="force [N]")
        axes.grid(alpha=0.4, which="both")
    panels[1].legend(loc="upper left", bbox_to_anchor=(1.01, 1.0))
    return figure


@command
def main(arguments=None):
    """Print the forces in the strongest wind, write the figure."""
    parser = Parser(description="Force of a tether over wind and slack.")
    parser.add_argument("--out", type=folder, default=Path("plots"), metavar="DIR", help="of the figure (default: plots)")
    add_fmu(parser)
    given = parser.parse_args(arguments)
    now(f"holding {1 if given.fmu else len(TETHERS)} tethers in {len(WINDS)} winds")
    forces = survey({given.fmu.stem: given.fmu} if given.fmu else None)
    for name, values in forces.items():
        at_the_kite = ", ".join(
            f"{force:.0f} N at {100 * slack:+.1f} %" for force, slack in zip(values[:, -1, 1], SLACKS, strict=True)
        )
        print(f"{name}: on the kite in {WINDS[-1]:.0f} m/s {at_the_kite} slack")
    given.out.mkdir(parents=True, exist_ok=True)
    now("drawing")
    plot(forces).savefig(given.out / "forces_over_wind_and_slack.png", dpi=150)


if __name__ == "__main__":
    sys.exit(main())
