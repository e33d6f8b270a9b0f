"""Kernels compiled ahead of time give the same bits on all processors, and so do those that numba compiles just in time.

No compiler is allowed to reorder or to fuse operations.
"""

import re
import subprocess
from pathlib import Path

import numpy as np
import pytest

from native.programs import WARNINGS, available
from scenes import CIRCLE_TETHER, REVOLUTION, circle
from tetherfmu import models
from tetherfmu.libraries import just_in_time, ready
from tetherfmu.libraries.sources import HAS_AVX
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.kernel_library import file_name, load, this_platform
from tetherfmu.runtime.variants import BY_NAME, VARIANTS, class_name

STEP = 0.02
CPUID, NOTHING = b"\x0f\xa2", b"\x31\xc9"  # `xor ecx, ecx` instead: a processor that has none of the features asked for


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


# just in time `quasi_steady` takes a minute, and nearly all of its kernels are those of the start of `dynamic`
JUST_IN_TIME = [(variant, for_this_processor) for variant in VARIANTS if variant != "quasi_steady"]


@pytest.mark.parametrize(("variant", "other"), [*JUST_IN_TIME, *((variant, for_any_processor) for variant in VARIANTS)])
def test_a_revolution_bit_for_bit(variant, other, tmp_path):
    """Outputs, node positions, states and energies of a whole circle with reel-out in gusts."""
    inputs = np.zeros((round(REVOLUTION / STEP), at.INPUTS))
    for k, row in enumerate(inputs):
        row[at.KITE_POSITION : at.GROUND_POSITION] = np.concatenate(circle(k * STEP))
        row[at.REEL_OUT_SPEED : at.WIND_VELOCITY + 2] = 0.1 * np.sin(0.1 * k), 8.0 + np.sin(0.3 * k), 1.0
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


@pytest.mark.skipif(not available(), reason="needs gcc and 64-bit Linux")
def test_the_library_finds_the_processor_that_the_system_names(tmp_path):
    (tmp_path / "main.c").write_text(f'#include "{HAS_AVX}"\nint main(void) {{ return has_avx() + 2 * has_avx(); }}\n')
    subprocess.run(["gcc", *WARNINGS, "main.c", "-o", "main"], cwd=tmp_path, check=True)
    named = re.search(r"^flags\s*:.*\bavx\b", Path("/proc/cpuinfo").read_text(), flags=re.MULTILINE)
    assert subprocess.run([tmp_path / "main"], check=False).returncode == (3 if named else 0)
