"""Number of segments and tolerance of a system of tethers, from runs against a finer one.

With F of a system, R of the finer one, rms over the output times after `settled`, the error of a force is

    rms |F - R| / rms |R|

for the force of all lines on each driven point, and for the force of each line on the points at its ends. A force below
`LEAST` of the largest one counts as that large. Step times are counted work times unit costs, as in
`measuring/runs.py`.
"""

from dataclasses import replace
from functools import partial
from typing import NamedTuple

import numpy as np
import pandas as pd

from tetherfmu.console.progress import now
from tetherfmu.files.scene_files import NO_ADVICE, SceneError, flown_from
from tetherfmu.records.problems import StepRefused
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.parameters import DEFAULT_TOLERANCE
from tetherfmu.study.measuring.errors import TOLERANCE, even_part, refined, rms, settled, size
from tetherfmu.study.measuring.runs import FIXED, UNITS, Run
from tetherfmu.study.measuring.system_flights import file_of, load
from tetherfmu.study.measuring.tables import page

from . import scene_advice as of_scenes
from .configurations import TOLERANCES, Measured, advice_on

WHOLE = 4  # of `SystemConfig.parts`: the segments of the file
PARTS = (1, 2, 4, 8, 16)  # of candidates
LEAST = 0.01  # of the largest force: a smaller one counts as so large


class SystemConfig(NamedTuple):
    """A configuration of a system."""

    segments: int  # of each line, in quarters of the segments in the file
    tolerance: float  # 0 with fixed steps
    step: float  # communication step [s]

    @property
    def factor(self):
        """Segments over those in the file."""
        return self.segments / WHOLE

    def words(self):
        """For people."""
        tolerance = f", tolerance {self.tolerance:g}" if self.tolerance else ""
        return f"{self.factor:g} times the segments of the file{tolerance}, communication step {1e3 * self.step:.3g} ms"


def forces_of(flown, found):
    """Forces of a `SystemFlown` [N], arrays (rows, 3), dict by point and line, and its longest wave time [s].

    found : `SystemFile` of the system.
    """
    forces = {each.name: flown.points[each.name].force for each in found.points if each.is_driven}
    for line in found.lines:
        for point, place in ((line.start, at.GROUND_FORCE), (line.end, at.KITE_FORCE)):
            forces[f"{line.name} at {point}"] = flown.outputs[line.name][:, place : place + 3]
    return forces, max(float(outputs[0, at.WAVE_TIME]) for outputs in flown.outputs.values())


def errors(flight, found, reference):
    """Relative errors [-] of forces against a reference, both from `forces_of`; dict by name."""
    (mine, _), (right, wave_time) = found, reference
    first = settled(flight, wave_time)
    sizes = {name: rms(size(each[first:])) for name, each in right.items()}
    least = LEAST * max(sizes.values())
    return {name: rms(size((mine[name] - right[name])[first:])) / max(sizes[name], least) for name in right}


def cost(flight, config, calls, work, row="dynamic"):
    """Kernel time [s] of communication steps and their work, of the machine of costs.csv; row : of that table."""
    counts = flight.segments_of_lines(config.factor).values()
    each = np.array([len(counts), sum(counts)])
    return float(UNITS.loc[row].to_numpy() @ np.concatenate([calls * each, work * each]))


def run(flight, config, exact=False):
    """`Run` of a configuration, with `forces_of` as `flown`, and its cost [s]; StepRefused if it refuses a step.

    exact : run as a reference, with adaptive steps regardless of the file.
    """
    fixed = 0.0 if exact else flight.found.solver.fixed_step
    solver = replace(flight.found.solver, relative_tolerance=config.tolerance, fixed_step=fixed)
    system, flown = flight.fly(flight.segments_of_lines(config.factor), solver, config.step, exact)
    counted, calls = system.counters, flight.calls(config.step)
    work = counted["iterations"] if fixed else counted["steps"] + counted["rejections"]
    found = Run(forces_of(flown, flight.found), work, calls, tuple(system.implausible))
    return found, cost(flight, config, calls, work, FIXED if fixed else "dynamic")


def measure(flight, config, reference):
    """`Measured` of a configuration against the forces of a reference; its cost is per simulated second."""
    try:
        found, spent = run(flight, config)
    except StepRefused as refusal:
        return Measured(config, {}, 0, 0, 0.0, 0.0, str(refusal))
    return Measured(config, errors(flight, found.flown, reference), found.calls, found.work, 0.0, spent / flight.flown_time)


def candidates(flight, finest):
    """Configurations with fewer segments than the finest one, in order of cost; the file's first."""
    solver, step = flight.found.solver, flight.wanted.communication_step
    tolerances = (0.0,) if solver.fixed_step else TOLERANCES
    own = SystemConfig(WHOLE, 0.0 if solver.fixed_step else solver.relative_tolerance or DEFAULT_TOLERANCE, step)
    found = [SystemConfig(n, each, step) for n in PARTS if n < finest.segments for each in tolerances]
    known = {(*flight.segments_of_lines(each.factor).values(), each.tolerance): each for each in (*found, own)}
    return [own, *(each for each in known.values() if each != own)]  # lines of few segments make some equal


def advise(flight, budget=of_scenes.BUDGET):
    """`Advice` for a `SystemFlight`, the configuration of the file first; its flights cost about the budget at most [s]."""
    allowed = flight.wanted.allowed_error
    most = WHOLE * at.MAX_SEGMENTS // max(line.tether.segments for line in flight.found.lines)
    first = SystemConfig(min(2 * WHOLE, most), TOLERANCE, even_part(flight.every, of_scenes.CHECK_STEP))
    limits = of_scenes.PART_OF_CHECK * allowed, None, of_scenes.PART_OF_FINER * budget
    finer = refined(partial(run, flight, exact=True), partial(errors, flight), first, most, *limits)
    own, left, points = finer.own_error(), budget - finer.spent, []
    listed = candidates(flight, finer.config)
    for config in listed:
        calls = flight.calls(config.step)
        if points and cost(flight, config, calls, calls) > left:
            break
        points.append(measure(flight, config, finer.run.flown))
        left -= points[-1].cost * flight.flown_time
    good = [each for each in points if each.error() + own <= allowed]
    chosen = min(good, key=lambda each: each.cost) if good else min(points, key=lambda each: each.error())
    return advice_on(chosen, points, finer, flight.wanted, stopped=len(points) < len(listed))


def table(flight, advice):
    """Configuration with its segments, tolerance, error and where it is largest, and step time relative to the file's."""
    rows, own = [], advice.points[0].cost
    for each in advice.points:
        counts = flight.segments_of_lines(each.config.factor)
        row = {"segments": ", ".join(f"{name} {count}" for name, count in counts.items())}
        row["tolerance"] = f"{each.config.tolerance:g}" if each.config.tolerance else "-"
        largest = max(each.errors, key=each.errors.get) if each.errors else f"refused: {each.refused}"
        row |= {"error [%]": 100.0 * each.error(), "largest at": largest}
        rows.append(row | {"step time": each.cost / own if each.cost and own else np.nan})  # none if it is refused
    return pd.DataFrame(rows)


def explain(flight, advice):
    """Lines of text: recommendation, expected error, and the other runs."""
    counts = flight.segments_of_lines(advice.point.config.factor)
    facts = {"counts": counts, "table_of_points": table(flight, advice), "part_of_check": of_scenes.PART_OF_CHECK}
    return page("advice/system.txt.j2", flight=flight, advice=advice, **facts).rstrip("\n")


def advised(path, settings=(), budget=of_scenes.BUDGET):
    """`SystemFlight` of the file (Path) of a system, its `Advice`, and lines for people; arguments as of `advise`."""
    flight = load(path, settings)
    if flight.has_release:
        raise SceneError(f"{path}: {NO_ADVICE}")
    now(f"flying {flight.found.name} with candidates and a finer one")
    with flown_from(path, "system"):
        advice = advise(flight, budget)
    return flight, advice, explain(flight, advice)


def start_values(flight, advice):
    """Start values of the FMU of a system according to the advice: pairs of a parameter and its value."""
    config = advice.point.config
    counts = flight.segments_of_lines(config.factor)
    tolerance = [("relative_tolerance", config.tolerance)] if config.tolerance else []
    return (*((f"{name}.segments", count) for name, count in counts.items()), *tolerance)


def run_command(options):
    """Print the advice for the file of a system, or of a scene; returns 1 if nothing meets its requirements."""
    path, is_system = file_of(options.scene)
    if not is_system:
        return of_scenes.run(options)
    _, advice, text = advised(path, options.settings, of_scenes.FAST_BUDGET if options.fast else of_scenes.BUDGET)
    print(text)
    return 0 if advice.met else 1
