"""How much faster are the tutorial's scenes 05 to 08 than the same equations in CasADi, integrated by CVODES?

    python tests/benchmarks/tutorial_scenes.py [--repeats 10] [--compiled] [--write]

Ten seconds of each scene with the positions of all nodes every 20 ms or 100 ms, which is also the communication step of
TetherDynamic; CVODES runs in one call with the exact sparse Jacobian. The error is the largest difference of a
coordinate from DOP853 at 1e-10. Both solvers run at a ladder of tolerances, interleaved, for at least 20 ms in each turn;
the shortest processor time counts, since other programs only add to it. A row compares times at equal error: that of
TetherDynamic at its default tolerance, between the tolerances of CVODES on logarithmic axes. The lessons take the
strain-rate damper and a row every 20 ms. `--write` also writes the table to docs/data/tutorial_scenes.csv. The exit status
is 1 if CVODES is less than five times slower in any row of the table.
"""

import argparse
import sys
import warnings
from dataclasses import dataclass, field, fields
from pathlib import Path
from time import process_time

import numpy as np
import pandas as pd
from scipy.integrate import solve_ivp

ROOT = Path(__file__).resolve().parents[2]
TABLE = ROOT / "docs" / "data" / "tutorial_scenes.csv"
sys.path[:0] = [str(ROOT / "tests"), str(ROOT / "docs" / "make"), str(ROOT / "examples" / "tutorial")]

import lessons  # noqa: E402
import tether_05  # noqa: E402
import tether_06  # noqa: E402
import tether_07  # noqa: E402
import tether_08  # noqa: E402

from benchmark import cvodes  # noqa: E402
from benchmark.races import interleaved, seconds_at  # noqa: E402
from benchmark.reference import right_hand_side  # noqa: E402
from scenes import nodes, read  # noqa: E402
from tetherfmu import PlausibilityWarning, TetherDynamic, inputs_along  # noqa: E402
from tetherfmu.files.scene_files import Wind  # noqa: E402
from tetherfmu.runtime.parameters import DEFAULT_TOLERANCE, Environment, Tether  # noqa: E402
from tetherfmu.study.measuring.tables import circumstances, markdown  # noqa: E402

DURATION, FINE, COARSE = 10.0, lessons.STEP, 0.1  # s
LADDER, EXACT = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9), 1e-10  # tolerances of CVODES and of the reference
WANTED = 5.0  # times faster
SHORTEST = 0.02  # s, of a turn
STILL, WITHOUT_AIR = np.zeros(3), {"drag_coefficient": 0.0}
SCENES = {  # options of the tether, velocity of its last node at the start, reel-out speed [m/s], wind [m/s]
    "05": (tether_05.SAME, tether_05.START[1, -1], 0.0, (0.0, 0.0, 0.0)),
    "06": (tether_06.DYNEEMA | WITHOUT_AIR, STILL, tether_06.REEL_OUT, (0.0, 0.0, 0.0)),
    "07": (tether_06.DYNEEMA, tether_07.VELOCITY, tether_06.REEL_OUT, tether_07.WIND),
    "08": (tether_08.TETHER, STILL, tether_08.REEL_OUT, tether_08.WIND),
}


@dataclass
class Race:
    """A scene as `cvodes` and `right_hand_side` read it."""

    tether: Tether
    reel_out_speed: float
    wind: Wind
    positions: np.ndarray  # of the nodes at the start [m], (nodes, 3)
    velocities: np.ndarray  # [m/s]
    environment: Environment = field(default_factory=Environment)
    kite_is_free: bool = True

    @property
    def start(self):
        """Positions, then velocities of the nodes that move, one flat array."""
        return np.concatenate([self.positions[1:].ravel(), self.velocities[1:].ravel()])

    def moving(self, states):
        """Positions of the nodes that move, array (rows, coordinates), of such arrays in columns."""
        return np.array(states).T[:, : len(self.start) // 2]


def race(name, law):
    """The scene with a number and a damping law."""
    options, velocity, reel_out_speed, wind = SCENES[name]
    known = {each.name for each in fields(Tether)}
    tether = Tether(**{key: value for key, value in options.items() if key in known}, damping_law=law)
    positions = nodes(read(f"tether_{name}.csv"), tether.segments)[0]
    share = np.linspace(0.0, 1.0, tether.segments + 1)[:, None]
    return Race(tether, reel_out_speed, Wind(wind), positions, share * velocity)


def our_run(scene, every):
    """TetherDynamic as a function that returns the positions of the moving nodes."""
    model = TetherDynamic(scene.tether, free_ends=(False, True))
    constant = {"reel_out_speed": scene.reel_out_speed, "wind_velocity": scene.wind.velocity}
    model.initialize(positions=scene.positions, velocities=scene.velocities, **constant)
    start, inputs = model.get_state(), inputs_along(round(DURATION / every), every, **constant)

    def run():
        model.set_state(start)
        return model.fly(inputs, every, outputs=False).positions[:, 1:].reshape(len(inputs), -1)

    return run


def their_run(scene, times, tolerance, compiled):
    """CVODES as a function that returns the positions of the moving nodes."""
    start, run = scene.start, cvodes.integrator(scene, True, times, tolerance, compiled)
    return lambda: scene.moving(run(x0=start)["xf"])


def runs(scene, every, repeats, compiled):
    """Table of solver, tolerance, error [m] and seconds of all runs."""
    times = every * np.arange(1, round(DURATION / every) + 1)
    exact = solve_ivp(right_hand_side(scene), (0.0, DURATION), scene.start, "DOP853", times, rtol=EXACT, atol=0.1 * EXACT)
    jobs = {("TetherDynamic", DEFAULT_TOLERANCE): our_run(scene, every)}
    for name in ("CVODES", "compiled") if compiled else ("CVODES",):
        jobs |= {(name, tolerance): their_run(scene, times, tolerance, name == "compiled") for tolerance in LADDER}
    seconds, found = interleaved(jobs, repeats, min, process_time, SHORTEST)
    rows = [(*job, np.abs(found[job] - scene.moving(exact.y)).max(), seconds[job]) for job in jobs]
    return pd.DataFrame(rows, columns=("solver", "tolerance", "error", "seconds"))


def compare(name, law, every, repeats, compiled):
    """A row of the table."""
    table = runs(race(name, law), every, repeats, compiled)
    ours = table.iloc[0]
    row = {"scene": name, "damper": law.replace("_", " "), "every s": every, "error m": ours.error}
    row["TetherDynamic ms"] = 1e3 * ours.seconds
    for solver, theirs in table[1:].groupby("solver"):
        seconds = seconds_at(theirs, ours.error)
        row |= {f"{solver} ms": 1e3 * seconds, f"{solver}: times slower": seconds / ours.seconds}
    return row


def main():
    """Print the table; returns the exit status."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--repeats", type=int, default=10, metavar="N", help="timed runs of each solver (default: 10)")
    parser.add_argument("--compiled", action="store_true", help="CVODES also with its equations as compiled C")
    parser.add_argument("--write", action="store_true", help="write docs/data/tutorial_scenes.csv")
    given = parser.parse_args()
    if given.compiled and not cvodes.COMPILER:
        parser.error("--compiled needs gcc or cc")
    warnings.simplefilter("ignore", PlausibilityWarning)  # the springs of 05 stretch more than any tether may
    laws = {name: ("strain_rate",) if name == "05" else ("strain_rate", "stretch_rate") for name in SCENES}
    cases = [(name, law, every) for every in (FINE, COARSE) for name in SCENES for law in laws[name]]
    table = pd.DataFrame([compare(*case, given.repeats, given.compiled) for case in cases])
    print(circumstances(), markdown(table), sep="\n\n")
    if given.write:
        table.to_csv(TABLE, index=False, float_format="%.3g")
    return int(not (table["CVODES: times slower"] >= WANTED).all())


if __name__ == "__main__":
    sys.exit(main())
