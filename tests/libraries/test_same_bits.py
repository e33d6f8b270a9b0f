"""Kernels compiled ahead of time give the same bits on all processors, and so do those that numba compiles just in time.

No compiler is allowed to reorder or to fuse operations.
"""

import gzip
import re
import subprocess
from functools import cache
from pathlib import Path

import llvmlite.binding as llvm
import numpy as np
import pytest

from kernels import make_code_late  # noqa: F401 (done by the import: numba is faster)
from native.programs import WARNINGS, available
from scenes import CIRCLE_TETHER, REVOLUTION, circle
from tetherfmu.libraries import just_in_time, ready
from tetherfmu.libraries.ahead_of_time import CODE
from tetherfmu.libraries.sources import HAS_AVX
from tetherfmu.python import models
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.kernel_library import PROTOTYPES, Kernels, file_name, load, this_platform, verbs
from tetherfmu.runtime.parameters import Solver
from tetherfmu.runtime.variants import BY_NAME, VARIANTS, class_name

STEP = 0.02
SOLVERS = {  # Newton's method finds the start; the solver of a dynamic tether
    "adaptive": Solver(initial_shape="quasi_steady"),
    "fixed step": Solver(initial_shape="quasi_steady", fixed_step=0.01),
}
# `cpuid`, and `xchg`, which restores rbx; with `xor ecx, ecx` instead the processor has none of the features asked for
CPUID, NOTHING = b"\x0f\xa2\x48\x87", b"\x31\xc9\x48\x87"


def by_numba(variant, folder):
    """Kernels that numba compiles just in time for this very processor."""
    return just_in_time.kernels(variant)


def for_this_processor(variant, folder):
    """Kernels that LLVM compiles just in time for this very processor, from what numba has written."""
    addresses = {verb: engine_of(variant).get_function_address(f"{variant}_{verb}") for verb in verbs(variant)}
    return Kernels(*(getattr(PROTOTYPES, verb)(address) for verb, address in addresses.items()))


@cache
def engine_of(variant):
    """LLVM's engine with the kernels of a variant, whose code lives as long as it does."""
    written = ready.folders([variant], [this_platform()])[variant] / CODE
    text = re.sub('"target-(cpu|features)"="[^"]*"', "", gzip.decompress(written.read_bytes()).decode())
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    kind = {"cpu": llvm.get_host_cpu_name(), "features": llvm.get_host_cpu_features().flatten()}
    machine = llvm.Target.from_default_triple().create_target_machine(**kind, opt=1, jit=True)
    engine = llvm.create_mcjit_compiler(llvm.parse_assembly(text), machine)
    engine.finalize_object()
    return engine


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


# numba needs a minute for the entry points of those with nodes
EACH = [
    ("straight", by_numba, "adaptive"),
    *(("dynamic", for_this_processor, solver) for solver in SOLVERS),
    *((variant, for_any_processor, "adaptive") for variant in VARIANTS),
]


@pytest.mark.parametrize(("variant", "other", "solver"), EACH)
def test_a_revolution_bit_for_bit(variant, other, solver, tmp_path):
    """Outputs, node positions, states and energies of a whole circle with reel-out in gusts, from the same start."""
    inputs = circle_inputs(STEP)
    models_of_both = [
        getattr(models, class_name(variant))(CIRCLE_TETHER, solver=SOLVERS[solver], kernels=kernels)
        for kernels in (None, other(variant, tmp_path))
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


@pytest.mark.skipif(not available(), reason="needs gcc and 64-bit Linux")
def test_the_library_finds_the_processor_that_the_system_names(tmp_path):
    (tmp_path / "main.c").write_text(f'#include "{HAS_AVX}"\nint main(void) {{ return has_avx() + 2 * has_avx(); }}\n')
    subprocess.run(["gcc", *WARNINGS, "main.c", "-o", "main"], cwd=tmp_path, check=True)
    named = re.search(r"^flags\s*:.*\bavx\b", Path("/proc/cpuinfo").read_text(), flags=re.MULTILINE)
    assert subprocess.run([tmp_path / "main"], check=False).returncode == (3 if named else 0)
