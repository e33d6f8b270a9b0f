"""Parameters of a chain for tests that call kernels directly."""

import numpy as np

from tetherfmu import Environment, Solver
from tetherfmu.libraries.ready import kernels
from tetherfmu.wiring.packing import pack_records


def packed(tether, environment=Environment(), solver=Solver(), free_ends=(False, False), masses=()):  # noqa: B008
    """The `parameters` array of a chain of one tether, with point masses: pairs (node, mass [kg])."""
    _, parameters = pack_records(
        kernels("dynamic"), (tether,), environment, solver, free_ends=free_ends, point_masses=masses
    )
    return np.array(parameters)
