"""The dynamic tether on a flat ground against MoorDyn: a drop, a lift, a drag over the ground.

Scenes, laws and settings: benchmarks/moordyn_ground.py, which wrote the files. MoorDyn is a peer: where it differs, its damper
at the ground does, which acts in full as soon as a node touches, and pulls at nodes that leave. The allowed differences are
those which MoorDyn has from itself with half of that damping; its time step is converged (1e-3 N). Without motion both laws
are the same.
"""

import numpy as np
import pytest

from benchmarks.moordyn_ground import COLUMNS, FRICTION, SCENES, TETHER, ours
from mechanics import line_density
from scenes import read

WEIGHT = 9.81 * line_density(TETHER)  # [N/m]
NODES = [name for name in COLUMNS if name[0] in "xz"]


@pytest.fixture(scope="module")
def flown():
    """Columns by scene: ours with steps of 5 ms, and MoorDyn's."""
    found = {name: dict(zip(COLUMNS, ours(name, 0.005)[0].T, strict=True)) for name in SCENES}
    return {name: (columns, read(f"moordyn_{name}.csv")) for name, columns in found.items()}


def rms(found, right, rows=slice(None)):
    return np.sqrt(np.mean((found[rows] - right[rows]) ** 2))
