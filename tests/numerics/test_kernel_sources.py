"""The list of sources that name the kernel caches is complete: what a kernel imports is in it, and nothing else."""

import ast

from tetherfmu.kernel_sources import KERNEL_SOURCES, PACKAGE


def imported(name):
    """Modules of the package that a module imports."""
    tree = ast.parse((PACKAGE / f"{name}.py").read_text(encoding="utf-8"))
    found = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and node.level == 1:
            names = [node.module] if node.module else [alias.name for alias in node.names]
            found.update(each for each in names if (PACKAGE / f"{each}.py").exists())
    return found


def test_sources_are_what_the_entry_points_import():
    closure, open_ends = set(), {"entry"}
    while open_ends:
        name = open_ends.pop()
        closure.add(name)
        open_ends |= imported(name) - closure
    assert closure == set(KERNEL_SOURCES)
