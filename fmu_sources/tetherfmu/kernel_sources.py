"""The files that the kernels are made from, and a hash of them: it names the folders where compiled kernels are kept."""

import hashlib
from functools import cache
from pathlib import Path

PACKAGE = Path(__file__).resolve().parent
KERNEL_SOURCES = (  # `entry` and all that it imports
    *("atmosphere", "block_tridiagonal", "catenary", "chain", "communication", "compilation", "compliance"),
    *(
        "dynamic",
        "end_motion",
        "entry",
        "equilibrium",
        "hanging",
        "implicit_euler",
        "kernel_sources",
        "layout",
        "lines",
        "observation",
        "pairs",
    ),
    *("quasi_steady", "rosenbrock", "segment", "status", "vectors", "workspace"),
)


@cache
def source_digest(*more):
    """Hash of the sources of the kernels and of more modules of the package (names): 12 hexadecimal digits."""
    digest = hashlib.sha256()
    for name in (*KERNEL_SOURCES, *more):
        digest.update((PACKAGE / f"{name}.py").read_bytes())
    return digest.hexdigest()[:12]
