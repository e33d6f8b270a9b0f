"""How much power does a kite give that pumps: figures of eight while it reels out, a depowered climb while it is reeled in?

    python examples/power_system/pumping_cycle.py --html

A tether, a kite, a flight controller and a winch are four FMUs, wired by equal names (`kite_power_system.py`). The mass of
the kite of 20 m2 is in `TetherDynamicFree`: the stiff bond between them is solved inside, so that 20 ms are short enough.
The kite needs 6 m/s of wind to climb while it is reeled in; from 11 m/s on the motor of the winch is too weak at times,
which is printed.

Two ways of exchange, both explicit. `jacobi`: all FMUs step from the same communication point; within the step each
continues its inputs linearly. `gauss_seidel`: one after the other, each with the newest outputs; those behind the tether
get inputs that belong to the end of the step already, and interpolate (`input_continuation`). The load on the kite is
delayed in both, longer in the first, so there is a longest step; it falls as the apparent wind grows
(docs/use/coupling.md). Beyond it the motion diverges within a second or two, which is detected.
"""

import sys
from contextlib import contextmanager
from pathlib import Path
from time import perf_counter
from typing import NamedTuple

import numpy as np

from tetherfmu.console.ending import command
from tetherfmu.console.options import Parser, number
from tetherfmu.console.progress import now

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # the folder of the rooms
from fmus.winch import Drum
from power_system.kite_power_system import FMUS, START, given_by, starts_for, wanted_by
from shared.fmu_tools import add_fmu, all_variables, find_fmu, variables_of
from shared.named_fmu import all_running

INTERPOLATED = 3  # of `input_continuation`
STEP = 0.02  # [s], with which both masters hold in all winds that are allowed
ROUND_OFF = 1e-9  # of a torque at its limit
LONGEST_CYCLE = 300.0  # [s]
READ = ("kite_position[1]", "kite_position[2]", "kite_position[3]", "ground_tension", "tether_length", "reel_out_speed")
READ += ("power", "energy", "depower", "kite_velocity[1]", "kite_velocity[2]", "kite_velocity[3]", "motor_torque")
SHARED = ("kite_load", "kite_position", "kite_velocity", "ground_tension", "tether_length", "reel_out_speed")  # of a tether
VELOCITY = slice(READ.index("kite_velocity[1]"), READ.index("kite_velocity[3]") + 1)
DIVERGES = 20.0  # difference of two changes of the kite's velocity in a step [m/s]; 5 at the start in 14 m/s, then below 1
FRAMES_EVERY = 0.5  # shapes for the page [s]


class Cycles(NamedTuple):
    """Pumping cycles, SI units: one row per communication point."""

    time: np.ndarray  # (rows,)
    values: dict  # name of `READ` -> (rows,)
    bounds: list  # rows where a cycle begins, and where the last one ends
    frames: list  # pairs (time, shape of the tether (points, 3))
    wall_time: float  # of all communication steps


class Part(NamedTuple):
    """An FMU of the system: value references, and places in the list of the outputs of all."""

    fmu: object
    inputs: list
    inputs_at: list
    outputs: list
    outputs_at: slice

    def receive(self, signals):
        """Set the inputs."""
        self.fmu.setReal(self.inputs, [signals[place] for place in self.inputs_at])

    def send(self, signals):
        """Read the outputs (`signals` is modified)."""
        signals[self.outputs_at] = self.fmu.getReal(self.outputs)


def jacobi(parts, signals, time, step):
    """All FMUs step from the same communication point; `signals`, the outputs of all, are those of the end afterwards."""
    for part in parts:
        part.receive(signals)
    for part in parts:
        part.fmu.doStep(time, step)
    for part in parts:
        part.send(signals)


def gauss_seidel(parts, signals, time, step):
    """One FMU after the other steps, and gives its outputs to the next."""
    for part in parts:
        part.receive(signals)
        part.fmu.doStep(time, step)
        part.send(signals)


MASTERS = {"jacobi": jacobi, "gauss_seidel": gauss_seidel}


@contextmanager
def system(start, master, fmus=FMUS, tether=None):
    """FMUs that run: a list of `Part`, the outputs of all, their places by name, and a function to call for Ctrl-C.

    start : dict of start values, set in each FMU that has the name; that of "kite.wing_area" in the kite only.
    master : of `MASTERS`.  tether : path of its FMU, if it is another one.
    """
    files = [tether if tether and name == "tether" else find_fmu(fmu) for name, fmu in fmus.items()]
    with all_running(files) as (opened, stop_if_pressed):
        tables = [each.variables.description.modelVariables for each in opened]
        given = [name for table in tables for name in given_by(table)]
        places = {name: place for place, name in enumerate(given)}
        parts, signals = [], [0.0] * len(given)
        for name, each, table in zip(fmus, opened, tables, strict=True):
            own = {key.removeprefix(f"{name}."): value for key, value in start.items() if key.startswith(f"{name}.")}
            behind = master == "gauss_seidel" and name != "tether"
            begin(each.fmu, table, start | own | ({"input_continuation": INTERPOLATED} if behind else {}))
            parts.append(part_of(each.fmu, table, places))
        for part in (*parts, *parts):  # the second time with the first steering
            part.receive(signals)
            part.send(signals)
        for part in parts:
            part.fmu.exitInitializationMode()
        yield parts, signals, places, stop_if_pressed


def part_of(fmu, variables, places):
    """`Part` of an FMU; places : of all outputs, by their names."""
    reference = {variable.name: variable.valueReference for variable in variables}
    gets, gives = wanted_by(variables, places), given_by(variables)
    at = slice(places[gives[0]], places[gives[0]] + len(gives))
    references = [[reference[name] for name in names] for names in (gets, gives)]
    return Part(fmu, references[0], [places[name] for name in gets], references[1], at)


def begin(fmu, variables, start):
    """Enter initialization mode and set the start values that an FMU has."""
    fmu.setupExperiment(startTime=0.0)
    fmu.enterInitializationMode()
    for variable, value in starts_for(variables, start):
        set_value = fmu.setReal if variable.type == "Real" else fmu.setInteger
        set_value([variable.valueReference], [value])


def fly(cycles=2, step=STEP, master="jacobi", start=START, frames=False, tether=None):
    """Fly until so many whole cycles are done after the first reeling in; `Cycles`.

    step [s] : communication step.  master : of `MASTERS`.  start : start values.  frames : whether to keep shapes.
    tether : path of an FMU with a free kite end, None: that of `find_fmu`.
    """
    from tqdm import tqdm

    exchange, rows, bounds, kept = MASTERS[master], [], [], []
    with system(start, master, tether=tether) as (parts, signals, places, stop_if_pressed):
        read, depower = [places[name] for name in READ], places["depower"]
        shape = all_variables(tether or find_fmu(FMUS["tether"])).of("shape") if frames else []
        every, wall_time = max(1, round(FRAMES_EVERY / step)), 0.0
        with tqdm(total=cycles + 1, desc="pumping", unit="cycle", disable=None, leave=False) as bar:
            while len(bounds) <= cycles:
                before, began = signals[depower], perf_counter()
                exchange(parts, signals, len(rows) * step, step)
                wall_time += perf_counter() - began
                rows.append([signals[place] for place in read])
                stop_if_pressed()
                if frames and len(rows) % every == 0:
                    kept.append((len(rows) * step, np.reshape(parts[0].fmu.getReal(shape), (-1, 3))))
                if before == 1.0 > signals[depower]:  # powered again: a new cycle begins
                    bounds.append(len(rows) - 1)
                    bar.update()
                check(rows, bounds, step, master)
    values = dict(zip(READ, np.transpose(rows), strict=True))
    return Cycles(step * np.arange(1, len(rows) + 1), values, bounds, kept, wall_time)


def check(rows, bounds, step, master):
    """RuntimeError if the exchange diverges, if the kite has come down, or if no cycle ends."""
    time = len(rows) * step
    jump = np.linalg.norm(np.diff([row[VELOCITY] for row in rows[-3:]], n=2, axis=0))
    if jump > DIVERGES:
        other = "" if master == "gauss_seidel" else " or --master gauss_seidel, which allows longer ones"
        raise RuntimeError(
            f"the exchange diverges after {time:.1f} s: a step of {1e3 * step:g} ms delays the load on the kite too long "
            f"for this wind; take --step {min(0.5 * step, STEP):g}{other}"
        )
    if rows[-1][2] < 0.0:
        raise RuntimeError(f"the kite came down after {time:.1f} s; it needs more wind")
    if time - (bounds[-1] if bounds else 0) * step > LONGEST_CYCLE:
        raise RuntimeError(
            f"no cycle has ended for {LONGEST_CYCLE:g} s; the kite needs more wind, or shorter lengths to fly between"
        )


def summary(flight):
    """A line on each cycle, and one on all: mean power at the drum, mean and peak force, times real time."""
    lines, energy, force = [], flight.values["energy"], flight.values["ground_tension"]
    pairs = [*zip(flight.bounds, flight.bounds[1:], strict=False), (flight.bounds[0], flight.bounds[-1])]
    for k, (a, b) in enumerate(pairs, start=1):
        name = f"cycle {k}" if k < len(pairs) else "all"
        duration = flight.time[b] - flight.time[a]
        mean, forces = (energy[b] - energy[a]) / duration, force[a:b]
        force_text = f"mean force {forces.mean():.0f} N, peak force {forces.max():.0f} N"
        lines.append(f"{name}: {duration:.2f} s, mean power {mean:.0f} W, {force_text}")
    if np.any(beyond := np.abs(flight.values["motor_torque"]) >= Drum().torque_limit * (1.0 - ROUND_OFF)):
        seconds = beyond.sum() * flight.time[0]
        lines.append(
            f"the motor of the winch is too weak for this wind: for {seconds:.2g} s of {flight.time[-1]:.1f} s it pulls "
            f"with all it can, {Drum().torque_limit / Drum().drum_radius:.0f} N, and the reel-out speed is not as wanted"
        )
    return "\n".join([*lines, f"{flight.time[-1] / flight.wall_time:.0f} times real time"])


def parse(arguments, prog):
    """Command line options."""
    parser = Parser(prog=prog, description="fly a kite in pumping cycles, and plot path, force, speed, power and length")
    option = parser.add_argument
    option("--cycles", type=number(1, 1000, whole=True), default=2, metavar="N", help="number of whole cycles (default: 2)")
    option(
        "--step", type=number(1e-4, 0.1, "s"), default=STEP, metavar="H", help=f"communication step [s] (default: {STEP:g})"
    )
    parser.add_choice("--master", MASTERS, default="jacobi", help="way of exchange (default: jacobi)")
    about = "wind at 10 m [m/s], 6 to 14: in less the kite comes down (default: 8)"
    option("--wind", type=number(6.0, 14.0, "m/s"), default=8.0, metavar="W", help=about)
    option(
        "--segments", type=number(1, 300, whole=True), default=10, metavar="N", help="segments of the tether (default: 10)"
    )
    parser.add_out("the figures")
    option("--html", action="store_true", help="also write an animated page (needs plotly)")
    add_fmu(parser, "TetherDynamicFree, in dist/ or else in a cache of yours")
    return parser.parse_args(arguments)


@command
def main(arguments=None, prog=None):
    """Fly, print a line on each cycle, write the figures, print where they are."""
    given = parse(arguments, prog)
    if given.html:
        from shared.flight_page import write_page  # before the flight, which would be in vain without plotly
    from power_system.pumping_figures import path_of, plot_path, plot_series

    if given.fmu:
        variables_of(given.fmu, free=True).of(*SHARED)  # before others are built
    start = START | {"wind_velocity[1]": given.wind, "segments": given.segments}
    flight = fly(given.cycles, given.step, given.master, start, given.html, given.fmu)
    print(summary(flight))
    given.out.mkdir(parents=True, exist_ok=True)
    now("drawing")
    written = [given.out / "pumping_path.png", given.out / "pumping_series.png"]
    for path, plot in zip(written, (plot_path, plot_series), strict=True):
        plot(flight).savefig(path, dpi=150)
    if given.html:
        written.append(given.out / "pumping_cycle.html")
        shown = {"tether": Frames(*zip(*flight.frames, strict=True))}
        write_page(shown, written[-1], path_of(flight), len(flight.frames), "Pumping kite")
    print("\n".join(map(str, written)))


class Frames(NamedTuple):
    """What the page shows: times, and shapes of the tether (points, 3)."""

    time: tuple
    shape: tuple


if __name__ == "__main__":
    sys.exit(main())
