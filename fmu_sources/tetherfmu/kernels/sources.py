"""The files that the kernels are made from, and a hash of them: it names the folders where compiled kernels are kept."""

import hashlib
from functools import cache
from pathlib import Path

PACKAGE = Path(__file__).resolve().parents[1]
FROM_RUNTIME = ("layout.py", "status.py")  # what kernels import of `runtime`


@cache
def source_digest(*more):
    """Hash of the sources of the kernels and of more files of the package (paths in it): 12 hexadecimal digits."""
    kernels = sorted(path.relative_to(PACKAGE).as_posix() for path in (PACKAGE / "kernels").rglob("*.py"))
    digest = hashlib.sha256()
    for name in (*kernels, *(f"runtime/{file}" for file in FROM_RUNTIME), *more):
        digest.update(name.encode("utf-8"))
        digest.update((PACKAGE / name).read_bytes())
    return digest.hexdigest()[:12]
