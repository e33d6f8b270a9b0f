"""What given derivatives of inputs are worth, and what directional derivatives cost: native FMUs in FMPy.

    python tests/benchmarks/derivatives.py

A flight of 6 s in which all inputs change (`tests/native/flights.py`), 20 segments, tolerance 1e-6: root mean square error
of the forces on ground and kite (`TetherDynamicFree`: on the ground, and of the position of the kite) over that of their
values, against steps of 1 ms at 1e-8 with estimates. Then the time for a directional derivative over that for a step (six
inputs, the step, six outputs), medians of the processor's time. Last how many derivatives are refused in random flights
whose reel-out speed jumps in every step: there are up to 200 internal steps in one.
"""

import tempfile
from pathlib import Path
from statistics import median
from time import process_time

import numpy as np
import pandas as pd
from as_script import TESTS  # noqa: F401 (the tests are found)
from fmpy import extract
from fmpy.fmi1 import FMICallException

from native.flights import flown
from runtime.host import Host
from scenes import circle, kite_at_start
from tetherfmu.export.archive import SLAVES
from tetherfmu.export.native import native_fmus as native
from tetherfmu.study.measuring.tables import circumstances, markdown

STEPS, FINE = (0.1, 0.05, 0.02, 0.01), 0.001  # s
WAYS = {"held": (False, {"input_continuation": 2}), "estimated": (False, {}), "given": (True, {})}
COUNT, ROUNDS = 200, 15


def errors(path):
    """Rows of the first table."""
    fine = flown(path, FINE, given=False, tolerance=1e-8)
    size = np.sqrt(np.mean(fine**2))
    for way, (given, start) in WAYS.items():
        found = (np.sqrt(np.mean((flown(path, step, given, **start) - fine) ** 2)) / size for step in STEPS)
        numbers = {f"{1e3 * step:g} ms": f"{100.0 * error:.2g} %" for step, error in zip(STEPS, found, strict=True)}
        yield {"FMU": path.stem, "rate of reel-out and load": way, **numbers}


def references(host):
    """Value references of the motion of the kite, and of the forces on ground and kite."""
    vectors = ("kite_position", "kite_velocity"), ("ground_force", "kite_force")
    return [[host.reference[f"{name}[{i}]"] for name in names for i in (1, 2, 3)] for names in vectors]


def cost(path):
    """Time for a directional derivative over that for a step on the circle [-]."""
    host = Host(path).start(**kite_at_start(path.stem, *circle(0.0)))
    inputs, outputs = references(host)
    shares = []
    for round_ in range(ROUNDS):
        began = process_time()
        for k in range(COUNT):
            time = 0.02 * (round_ * COUNT + k)
            host.fmu.setReal(inputs, np.ravel(circle(time)))
            host.fmu.doStep(time, 0.02)
            host.fmu.getReal(outputs)
        stepped = process_time()
        for _ in range(COUNT):
            host.fmu.getDirectionalDerivative(outputs, inputs[:1], [1.0])
        shares.append((process_time() - stepped) / (stepped - began))
    return median(shares)


def refused(path, flights=60, steps=40):
    """How many derivatives of the force on the kite are refused, and how many were asked for."""
    failed = asked = 0
    folder = extract(str(path))
    for seed in range(flights):
        random = np.random.default_rng(seed)
        length, step, rate = random.uniform(50.0, 800.0), random.choice((0.01, 0.02, 0.05, 0.1)), random.uniform(0.0, 0.3)
        up = np.abs(random.normal(size=3)) + 0.1
        up *= length * random.uniform(0.7, 1.02) / np.linalg.norm(up)
        across = np.cross(up, (0.0, 0.0, 1.0))
        across *= np.linalg.norm(up) / np.linalg.norm(across)

        def kite(time, up=up, across=across, rate=rate):
            c, s = np.cos(rate * time), np.sin(rate * time)
            return {"kite_position": c * up + s * across, "kite_velocity": rate * (c * across - s * up)}

        host = Host(folder).start(initial_length=length, initial_shape=2, wind_velocity=(8.0, 0.0, 0.0), **kite(0.0))
        inputs, outputs = references(host)
        for k in range(steps):
            host.step(step, **kite(k * step), reel_out_speed=0.5 * random.normal())
            for each in inputs:
                asked += 1
                try:
                    host.fmu.getDirectionalDerivative(outputs, [each], [1.0])
                except FMICallException:
                    failed += 1
        host.free()
    return failed, asked


def main(folder):
    """Print both tables."""
    paths = {name: native.build(name, folder) for name in SLAVES}
    print(circumstances(), markdown(pd.DataFrame([row for path in paths.values() for row in errors(path)])), sep="\n\n")
    driven = {name: path for name, path in paths.items() if name != "TetherDynamicFree"}
    costs = [{"FMU": name, "derivative over step": cost(path)} for name, path in driven.items()]
    print("", markdown(pd.DataFrame(costs)), sep="\n")
    failed, asked = refused(paths["TetherDynamic"])
    print(f"\nTetherDynamic: {failed} of {asked} derivatives are refused")


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as temporary:
        main(Path(temporary))
