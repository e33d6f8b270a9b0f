"""How much does a tether pull at its ends, in which wind and with how much slack, and which model is enough?

The kite stands still at (300, 0, 400) m, 500 m from the ground station, in a wind from 0 to 25 m/s along x. Every tether
FMU, and several lengths around 500 m. The dynamic tether is in its static equilibrium.

    python examples/at_rest/forces_over_wind_and_slack.py
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
from first_flight.circular_flight import TETHERS
from shared.fmu_tools import add_fmu, find_fmu, variables_of

KITE = (300.0, 0.0, 400.0)
SLACKS = (-0.002, 0.0, 0.01, 0.05)
WINDS = np.linspace(0.0, 25.0, 26)


def survey(files=None, slacks=SLACKS, winds=WINDS):
    """Dict name of the tether -> forces [N], array (slacks, winds, 2): magnitude at the ground station and at the kite.

    files : dict name of the tether -> FMU, None: those of `find_fmu`.  slacks [-], winds [m/s].
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
    """Force on the kite over the wind, a column for each slack; below how far it is from that of the first tether.

    At rest the quasi-steady tether is the dynamic one: its difference is too small to be seen.
    """
    from shared.flight_figures import plt

    figure, panels = plt.subplots(
        2, len(slacks), figsize=(3.4 * len(slacks), 6.5), sharex=True, squeeze=False, layout="constrained"
    )
    first = next(iter(forces))
    for number, (upper, lower) in enumerate(panels.T):
        lower.set_ylim(1e-3, 3e3)  # first, so that matplotlib does not warn of a difference that is 0 everywhere
        for name, values in forces.items():
            looks = {"color": COLOUR.get(name, SKY_BLUE), "linewidth": 1.5, "label": name.replace("_", "-")}
            upper.plot(winds, values[number, :, 1], **looks)
            if name != first:
                lower.semilogy(winds, np.abs(values - forces[first])[number, :, 1], **looks)
        upper.set(title=f"{100 * slacks[number]:+.1f} % slack", ylim=(0.0, None))
        lower.set(xlabel="wind [m/s]")
        for axes in (upper, lower):
            axes.grid(alpha=0.3)
    panels[0, 0].set_ylabel("force on the kite [N]")
    panels[1, 0].set_ylabel(f"difference from {first} [N]")
    panels[0, -1].legend(frameon=False)
    return figure


@command
def main(arguments=None):
    """Print the forces in the strongest wind, write the figure."""
    parser = Parser(description="compute the force of a tether over wind and slack")
    parser.add_out()
    add_fmu(parser, "all, in dist/ or else in a cache of yours; with one beside the dynamic tether")
    given = parser.parse_args(arguments)
    files = None
    if given.fmu:
        variables_of(given.fmu)  # before another one is built
        files = {"dynamic": find_fmu("TetherDynamic"), given.fmu.stem: given.fmu}
    now(f"holding {len(files or TETHERS)} tethers in {len(WINDS)} winds")
    forces = survey(files)
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
