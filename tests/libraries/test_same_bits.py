"""Kernels compiled ahead of time give the same bits on all processors, and so do those that numba compiles just in time.

No compiler is allowed to reorder or to fuse operations.
"""

import re
import subprocess
from dataclasses import astuple, replace
from pathlib import Path

import numpy as np
import pytest

from kernels.packed import packed
from native.programs import WARNINGS, available
from scenes import CIRCLE_TETHER, REVOLUTION, circle
from tetherfmu import models
from tetherfmu.kernels.arrays import outputs_size, positions_and_velocities
from tetherfmu.kernels.equations import assembly
from tetherfmu.kernels.equations.boundary import inputs_of_step
from tetherfmu.kernels.equations.ground import without_ground
from tetherfmu.kernels.equations.properties import chain_of
from tetherfmu.kernels.rest import end_tensions, newton
from tetherfmu.kernels.rest.first_guess import guess
from tetherfmu.kernels.rest.rigid_body import Body, rigid_motion
from tetherfmu.kernels.step import power_balance, transaction
from tetherfmu.kernels.step.outputs import complete
from tetherfmu.kernels.variants import dynamic
from tetherfmu.libraries import just_in_time, ready
from tetherfmu.libraries.sources import HAS_AVX
from tetherfmu.runtime import layout as at
from tetherfmu.runtime import status
from tetherfmu.runtime.kernel_library import file_name, load, this_platform
from tetherfmu.runtime.parameters import Solver
from tetherfmu.runtime.variants import BY_NAME, VARIANTS, class_name

STEP = 0.02
LONG_STEP = 0.1  # where Python calls each kernel
ADAPTIVE = Solver(initial_shape="quasi_steady")
# `cpuid`, and `xchg`, which restores rbx; with `xor ecx, ecx` instead the processor has none of the features asked for
CPUID, NOTHING = b"\x0f\xa2\x48\x87", b"\x31\xc9\x48\x87"


def for_this_processor(variant, folder):
    """Kernels that numba compiles just in time for this very processor."""
    return just_in_time.kernels(variant)


def for_any_processor(variant, folder):
    """Kernels of the library, which is made to believe that this processor has no AVX."""
    if not this_platform().startswith("x86_64"):
        pytest.skip("one kind of processors only")
    name = file_name(variant, this_platform())
    library = (ready.folders([variant], [this_platform()])[variant] / name).read_bytes()
    assert library.count(CPUID) == 1
    (folder / name).write_bytes(library.replace(CPUID, NOTHING))
    return load(folder, variant)


def circle_inputs(step):
    """Inputs of all communication steps [s] of a whole circle with reel-out in gusts, one row for each."""
    inputs = np.zeros((round(REVOLUTION / step), at.INPUTS))
    for k, row in enumerate(inputs):
        row[at.KITE_POSITION : at.GROUND_POSITION] = np.concatenate(circle(k * step))
        row[at.REEL_OUT_SPEED : at.WIND_VELOCITY + 2] = 0.1 * np.sin(0.1 * k), 8.0 + np.sin(0.3 * k), 1.0
    return inputs


# just in time the entry points of those with nodes take a minute; of `dynamic` see `test_a_revolution_kernel_by_kernel`
JUST_IN_TIME = ("catenary", for_this_processor)


@pytest.mark.parametrize(("variant", "other"), [JUST_IN_TIME, *((variant, for_any_processor) for variant in VARIANTS)])
def test_a_revolution_bit_for_bit(variant, other, tmp_path):
    """Outputs, node positions, states and energies of a whole circle with reel-out in gusts."""
    inputs = circle_inputs(STEP)
    models_of_both = [
        getattr(models, class_name(variant))(CIRCLE_TETHER, kernels=kernels) for kernels in (None, other(variant, tmp_path))
    ]
    flights = []
    for model in models_of_both:
        model.initialize(*circle(0.0), wind_velocity=(8.0, 1.0, 0.0))
        flights.append(model.fly(inputs, STEP, every=10))
    one, two = flights
    assert len(one.outputs) == len(inputs) // 10
    assert one.outputs.tobytes() == two.outputs.tobytes()
    assert one.positions.tobytes() == two.positions.tobytes()
    states = [model.get_state() for model in models_of_both]
    assert states[0].tobytes() == states[1].tobytes()
    if BY_NAME[variant].has_nodes:
        assert models_of_both[0].energy() == models_of_both[1].energy()


class KernelByKernel:
    """The dynamic tether by kernels compiled just in time, most of which the tests in `kernels/` compile anyway.

    state : as in the library.  It starts in quasi-steady motion, which Newton's method with stiffnesses must find at once.
    """

    def __init__(self, tether, solver, inputs):
        self.n = n = tether.segments
        self.parameters = packed(tether, solver=solver)
        self.state, self.work = np.zeros(at.state_size(n)), np.zeros(dynamic.work_size(n))
        assert transaction.start(n, self.parameters, inputs, self.state) == status.OK
        x, v = positions_and_velocities(n, self.state)
        body = Body(chain_of(n, self.parameters, self.state), *rigid_motion(n, x, v), x, v, without_ground(), x, False)
        ends = v.reshape(-1, 3)[[0, -1]]
        w = newton.workspace(n, self.work)
        assembly.node_masses(body.chain, w.mass)
        found, self.state[at.ITERATIONS] = newton.relax(body, newton.STIFFNESSES, False, guess(body, False, w), w)
        assert found
        end_tensions.store(body, self.state, w)
        v.reshape(-1, 3)[[0, -1]] = ends
        assert transaction.commit_start(n, self.parameters, status.OK, self.state) == status.OK

    def step(self, step, inputs):
        before, n = self.state.copy(), self.n
        given = inputs_of_step(self.parameters, inputs, step, before)
        transaction.remember(self.parameters, inputs, given, self.state)
        found = dynamic.advance(n, self.parameters, given, before, self.state, self.work)
        assert transaction.commit(n, self.parameters, found, before, self.state) == status.OK

    def outputs(self):
        outputs = np.zeros(outputs_size(self.n + 1))
        dynamic.outputs_of(self.n, self.parameters, self.state, self.n + 1, outputs, self.work)
        assert complete(self.n, self.state, outputs) == status.OK
        return outputs

    def energies(self, inputs):
        energies = np.zeros(power_balance.size(self.n))
        _, v = positions_and_velocities(self.n, self.state)
        power_balance.balance(self.n, self.parameters, self.state, v, inputs, energies, self.work)
        return energies


@pytest.mark.parametrize("solver", [ADAPTIVE, replace(ADAPTIVE, fixed_step=0.05)], ids=["adaptive", "fixed step"])
def test_a_revolution_kernel_by_kernel(solver):
    """The dynamic tether: state and outputs after the start and after each step of a whole circle, energies at the end."""
    inputs = circle_inputs(LONG_STEP)
    one = models.TetherDynamic(CIRCLE_TETHER, solver=solver)
    one.initialize(*circle(0.0), wind_velocity=inputs[0, at.WIND_VELOCITY : at.WIND_VELOCITY + 3])
    two = KernelByKernel(CIRCLE_TETHER, solver, inputs[0])
    size = len(two.state)
    assert one.get_state()[:size].tobytes() == two.state.tobytes()
    for k, row in enumerate(inputs):
        flown = one.fly(row[None], LONG_STEP)
        two.step(LONG_STEP, row)
        assert one.get_state()[:size].tobytes() == two.state.tobytes(), f"states differ after step {k + 1}"
        assert flown.outputs.tobytes() == two.outputs().tobytes(), f"outputs differ after step {k + 1}"
    assert one.counters["steps"] >= len(inputs)
    reeling, wind = inputs[-1, at.REEL_OUT_SPEED], inputs[-1, at.WIND_VELOCITY : at.WIND_VELOCITY + 3]
    expected = astuple(one.energy(reel_out_speed=reeling, wind_velocity=wind))
    np.testing.assert_array_equal(two.energies(inputs[-1])[: len(expected)], expected)


@pytest.mark.skipif(not available(), reason="needs gcc and 64-bit Linux")
def test_the_library_finds_the_processor_that_the_system_names(tmp_path):
    (tmp_path / "main.c").write_text(f'#include "{HAS_AVX}"\nint main(void) {{ return has_avx() + 2 * has_avx(); }}\n')
    subprocess.run(["gcc", *WARNINGS, "main.c", "-o", "main"], cwd=tmp_path, check=True)
    named = re.search(r"^flags\s*:.*\bavx\b", Path("/proc/cpuinfo").read_text(), flags=re.MULTILINE)
    assert subprocess.run([tmp_path / "main"], check=False).returncode == (3 if named else 0)
