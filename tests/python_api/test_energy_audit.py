"""The audit of energies takes whatever has `step` and `energy`: here a mass that is lifted, with a formula for its motion.

A force F [N] along z lifts a mass m: v = v0 + a t and z = z0 + v0 t + a t^2 / 2 with a = F/m - g. Its power F v is linear in
time, so that the trapezoidal rule of the audit is exact.
"""

from dataclasses import fields

import pytest

from tetherfmu import Energy, EnergyAudit

MASS, GRAVITY, STEP, STEPS = 3.0, 9.81, 0.1, 50  # [kg], [m/s2], [s]


class Lift:
    """A mass that starts at rest; `reported` : part of its power that it reports."""

    def __init__(self, reported):
        self.height = self.speed = self.force = 0.0
        self.reported = reported

    def step(self, step, kite_load):
        self.force = kite_load
        acceleration = kite_load / MASS - GRAVITY
        self.height += self.speed * step + 0.5 * acceleration * step**2
        self.speed += acceleration * step
        return self.height

    def energy(self, kite_load=None):
        force = self.force if kite_load is None else kite_load
        known = {
            "kinetic": 0.5 * MASS * self.speed**2,
            "potential": MASS * GRAVITY * self.height,
            "kite_power": self.reported * force * self.speed,
        }
        return Energy(**{field.name: known.get(field.name, 0.0) for field in fields(Energy)})


def lifted(reported):
    """The audit after the lift, the height [m] and the work of the force [J] by F z, for a force that alternates."""
    audit, height, work = EnergyAudit(Lift(reported)), 0.0, 0.0
    for k in range(STEPS):
        force, before = (60.0, 45.0)[k % 2], height
        height = audit.step(STEP, kite_load=force)
        work += force * (height - before)
    return audit, height, work


def test_no_energy_from_nowhere():
    audit, height, work = lifted(reported=1.0)
    assert height > 50.0
    assert audit.work["kite_power"] == pytest.approx(work, rel=1e-12)  # exact but for rounding, as the next
    assert abs(audit.residual) < 1e-12 * work


def test_power_that_is_not_reported_is_found():
    audit, _, work = lifted(reported=0.9)
    assert audit.residual == pytest.approx(0.1 * work, rel=1e-10)
