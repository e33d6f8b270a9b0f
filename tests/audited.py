"""Runs with an energy audit: what every extreme scenario does beside its own claim."""

from collections import namedtuple

import numpy as np

from tetherfmu import EnergyAudit, Environment

VOID = Environment(gravity=0.0, air_density=0.0)

Run = namedtuple("Run", "times outputs residual turnover energies")
Run.__doc__ = """What came of a run, one row per communication step.

times [s], outputs, residual : energy from nowhere [J], see `EnergyAudit`. turnover : largest of the energies and of the work
of each power [J], what a residual is compared with. energies : `Energy` after each step.
"""


def run(model, inputs, step, count):
    """Step an initialized model `count` times by `step` [s] with inputs(time) -> dict; a `Run`."""
    audit = EnergyAudit(model)
    times, outputs, residual, energies = [], [], [], []
    for k in range(count):
        outputs.append(audit.step(step, **inputs(k * step)))
        times.append((k + 1) * step)
        residual.append(audit.residual)
        energies.append(audit.now)
    held = max(energy.kinetic + energy.elastic for energy in energies)
    turnover = max(held, *(abs(work) for work in audit.work.values()))
    return Run(np.array(times), outputs, np.array(residual), turnover, energies)


def held(**inputs):
    """Inputs that do not change."""
    return lambda time: inputs
