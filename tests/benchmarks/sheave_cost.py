"""What a sheave costs: lines over a sheave beside the same lines that end there, whose winches reel as fast; as a table.

    python tests/benchmarks/sheave_cost.py [--fixed-step H] [--rounds 7]

The scenes of examples/systems, 2 s in communication steps of 20 ms; the hoist hauls in its rope. The columns: processor time
with a sheave over that without of an internal step, of a communication step of the kernels, and of one of the native FMU in
FMPy with all inputs and the tensions. Smallest of several flights that take turns. Fixed step [s]; 0: adaptive.
"""

import tempfile
import tomllib
from json import dumps
from pathlib import Path
from time import process_time

import numpy as np
import pandas as pd
from as_script import EXAMPLES, options
from fmpy import extract

from runtime.host import Host, reals_of
from tetherfmu import TetherSystem
from tetherfmu.export import system_fmus
from tetherfmu.python import compiled_flight
from tetherfmu.study.measuring.tables import circumstances, markdown

STEP, STEPS, SPEED = 0.02, 100, 0.4  # [s], communication steps, at which the hoist hauls in [m/s]
SCENES = {"two_fall_hoist": -SPEED, "atwood": 0.0, "clothes_line": 0.0}  # speed of the winch
COUNTED = "steps", "rejections"
OF_SHEAVES = ("from", "to", "through", "initial_length", "initial_portions")
OF_SHEAVES += ("sheave_mass", "sheave_friction", "sheave_efficiency")


def without_sheaves(data, lengths):
    """Tables of the system file whose only line ends at its sheave; lengths : of its portions at the start [m]."""
    ((name, line),) = data["lines"].items()
    others = {key: value for key, value in line.items() if key not in OF_SHEAVES}
    ends, lines = (line["from"], *line["through"], line["to"]), {}
    for k, length in enumerate(lengths):
        start, end = ends[k : k + 2]
        if "mass" in data["points"][start]:  # the winch is where the line is held
            start, end = end, start
        lines[f"{name}{k}"] = {"from": start, "to": end, "initial_length": float(length), **others}
    return {**data, "lines": lines}


class Case:
    """A system that flies in Python and as a native FMU.

    data : tables of its file.  speeds : of lines, a reel-out speed for each step [m/s].
    """

    def __init__(self, data, path, speeds):
        tables = {f"{kind}.{name}": own for kind in ("points", "lines") for name, own in data[kind].items()}
        tables["solver"] = data["solver"]
        heads = {name: "".join(f"{key} = {dumps(value)}\n" for key, value in own.items()) for name, own in tables.items()}
        path.write_text(f'name = "{path.stem}"\n' + "".join(f"[{name}]\n{text}" for name, text in heads.items()), "utf-8")
        self.system, self.speeds = TetherSystem.from_file(path), speeds
        self.first = self.system.initialize()
        self.start = self.system.get_state()
        self.fmu = extract(str(system_fmus.build(path, path.parent, native=2)))

    def fly(self, every=0):
        """Fly in Python."""
        self.system.set_state(self.start)
        return self.system.fly(STEPS, STEP, reel_out_speeds=self.speeds, every=every)

    def drive(self):
        """Processor time [s] of all steps in FMPy."""
        host = Host(self.fmu).start()
        inputs = [host.reference[name] for name in reals_of(host, "input")]
        outputs = [reference for name, reference in host.reference.items() if name.endswith("_tension")]
        values = host.fmu.getReal(inputs)
        rows = np.tile(values, (STEPS, 1))
        for name, speeds in self.speeds.items():
            rows[:, inputs.index(host.reference[f"{name}.reel_out_speed"])] = speeds
        rows, began = rows.tolist(), process_time()
        for k, row in enumerate(rows):
            host.fmu.setReal(inputs, row)
            host.fmu.doStep(k * STEP, STEP)
            host.fmu.getReal(outputs)
        taken = process_time() - began
        host.free()
        return taken

    def costs(self):
        """Processor time [us] of an internal step, of a communication step, and of one in FMPy."""
        seconds = self.fly().seconds
        steps = sum(self.system.counters[name] for name in COUNTED)
        return 1e6 * np.array((seconds / steps, seconds / STEPS, self.drive() / STEPS))


def measured(name, fixed_step, folder, rounds):
    """A row of the table."""
    data = tomllib.loads((EXAMPLES / "systems" / f"{name}.toml").read_text("utf-8")) | {"solver": {"fixed_step": fixed_step}}
    (line,) = data["lines"]
    speeds = {line: SCENES[name] * np.minimum(1.0, np.arange(STEPS) / 50.0)}
    over = Case(data, folder / f"{name}.toml", speeds)
    flown = over.fly(every=1).portions[line].length
    lengths = over.first.portions[line].length
    rates = np.gradient(np.vstack([lengths, flown]), STEP, axis=0)[1:]
    ends = Case(
        without_sheaves(data, lengths), folder / f"{name}_ends.toml", {f"{line}{k}": r for k, r in enumerate(rates.T)}
    )
    found = np.full((2, 3), np.inf)
    for _ in range(rounds):
        found = np.minimum(found, [over.costs(), ends.costs()])
    kinds = ("internal step", "communication step", "in FMPy")
    return {"scene": name} | {
        f"{kind} [us]": f"{a:.1f}/{b:.1f} = {a / b:.2f}" for kind, a, b in zip(kinds, *found, strict=True)
    }


def main():
    """Print the table."""
    given = options(__doc__, rounds=7, fixed_step=0.0)
    compiled_flight.perf_counter = process_time  # other work on the machine does not count
    with tempfile.TemporaryDirectory() as folder:
        rows = [measured(name, given.fixed_step, Path(folder), given.rounds) for name in SCENES]
    print(f"{markdown(pd.DataFrame(rows))}\n\n{circumstances()}")


if __name__ == "__main__":
    main()
