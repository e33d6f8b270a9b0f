"""No kernel divides by zero, or makes a number that is none, in flight: a host may let the processor trap both.

A child process flies random tethers of a variant through its compiled library with `feenableexcept` of glibc: a trap ends it
with SIGFPE, and the last line that it has printed is the flight. With a division by the damping of a tether without waves,
as it was, every flight of the quasi-steady one ends at its start. Other systems have no such function.
"""

import os
import platform
import signal
import subprocess
import sys
import warnings
from ctypes import CDLL
from pathlib import Path

import numpy as np
import pytest

from tetherfmu import StepRefused
from tetherfmu.libraries import ready
from tetherfmu.python import models
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.kernel_library import Kernels
from tetherfmu.runtime.variants import EVERY_VARIANT, class_name, library_of

INVALID, DIVISION_BY_ZERO, ALL = 0x01, 0x04, 0x3D  # FE_INVALID, FE_DIVBYZERO, FE_ALL_EXCEPT of x86-64
FLIGHTS, STEPS = 40, 10
PROFILES = ("uniform", "power_law", "logarithmic", "explog")


def trapping(function, mathematics):
    """The function of a library, with traps while it runs."""

    def call(*arguments):
        mathematics.feclearexcept(ALL)
        mathematics.feenableexcept(INVALID | DIVISION_BY_ZERO)
        try:
            return function(*arguments)
        finally:
            mathematics.fedisableexcept(ALL)
            mathematics.feclearexcept(ALL)

    return call


def direction(random):
    """A random direction; often straight up, or along an axis."""
    vector = random.normal(size=3) if random.random() < 0.7 else random.permutation([0.0, 0.0, 1.0])
    return vector / np.linalg.norm(vector)


def fly(variant, kernels, random):
    """One random flight: slack, taut or both ends together; with wind, speed, gravity, reeling, or without."""
    distance = random.choice([0.0, 10.0, 300.0], p=[0.1, 0.3, 0.6])
    segments = int(random.choice([1, 2, 5, 20]))
    tether = getattr(models, class_name(variant))(
        kernels=kernels,
        segments=segments,
        initial_length=max(distance, 5.0) * random.choice([0.99, 1.0, 1.01, 1.5]),
        axial_damping=random.choice([0.0, 473.0]),
        slack_stiffness_ratio=random.choice([0.0, 0.01]),
        drag_coefficient=random.choice([0.0, 0.958]),
        gravity=random.choice([1.6, 9.81]),
        air_density=random.choice([0.0, 1.225]),
        wind_profile=str(random.choice(PROFILES)),
        end_velocities=str(random.choice(["given", "derived"])),
        fixed_step=random.choice([0.0, 0.01]),
    )
    still = random.random() < 0.4
    velocity, wind = (0.0 * direction(random) if still else 10.0 * direction(random) for _ in range(2))
    kite, reeling = distance * direction(random), random.choice([0.0, 0.5])
    is_derived = tether._parameters[at.END_VELOCITIES] == at.DERIVED
    kite_velocity = {} if variant == "dynamic_free" or is_derived else {"kite_velocity": velocity}
    start = velocity if kite_velocity or variant == "dynamic_free" else None
    try:
        tether.initialize(kite, start, reel_out_speed=reeling, wind_velocity=wind)
        for k in range(STEPS):
            position = {} if variant == "dynamic_free" else {"kite_position": kite + 0.02 * k * velocity}
            tether.step(0.02, **position, **kite_velocity)
        if tether.segments > 1:
            tether.energy()
    except StepRefused:
        pass  # what has no equilibrium is refused without a trap, too


def child(variant):
    """Fly, and say which flight comes next."""
    mathematics = CDLL("libm.so.6")
    compiled = ready.kernels(library_of(variant))
    kernels = Kernels(*(trapping(each, mathematics) if each else None for each in compiled))
    warnings.simplefilter("ignore")
    for seed in range(FLIGHTS):
        print(seed, flush=True)
        fly(variant, kernels, np.random.default_rng(seed))


@pytest.mark.skipif(
    sys.platform != "linux" or platform.libc_ver()[0] != "glibc" or platform.machine() != "x86_64",
    reason="needs feenableexcept of glibc on x86-64",
)
@pytest.mark.parametrize("variant", EVERY_VARIANT)
def test_no_trap(variant):
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([*map(str, sys.path), str(Path(models.__file__).parents[1])])}
    run = subprocess.run(
        [sys.executable, __file__, variant], env=environment, capture_output=True, text=True, timeout=600, check=False
    )
    assert run.returncode != -signal.SIGFPE, f"trap in flight {run.stdout.split()[-1]}"
    assert run.returncode == 0, run.stderr
    assert run.stdout.split()[-1] == str(FLIGHTS - 1)


if __name__ == "__main__":
    child(sys.argv[1])
