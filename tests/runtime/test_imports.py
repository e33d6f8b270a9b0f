"""What an FMU ships, `runtime`, `wiring` and `fmi`, imports the standard library only; its base slave imports PythonFMU as well."""

import ast
import sys

import pytest

from tetherfmu.export.archive import SHIPPED
from tetherfmu.libraries.sources import PACKAGE

FILES = [path for folder in SHIPPED for path in sorted((PACKAGE / folder).rglob("*.py"))]


def imports(file):
    """Pairs (level, module) of all imports of a file, those within functions too; of `from . import a, b` each name."""
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from ((0, alias.name) for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            yield node.level, node.module
        elif isinstance(node, ast.ImportFrom):
            yield from ((node.level, alias.name) for alias in node.names)


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.name)
def test_imports_the_standard_library_only(file):
    allowed = sys.stdlib_module_names | ({"pythonfmu"} if file.name == "base_slave.py" else set())
    absolute = {module.split(".")[0] for level, module in imports(file) if level == 0}
    assert absolute <= allowed


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.name)
def test_relative_imports_stay_inside(file):
    """In a room itself, and in those below it: `runtime`, `wiring`, `fmi`."""
    below = SHIPPED[: SHIPPED.index(file.parent.name) + 1]
    for level, module in imports(file):
        if level > 0:
            inside = file.parents[level - 1].relative_to(PACKAGE) / module.split(".")[0]
            assert inside.parts[0] in below
            assert PACKAGE / inside.with_suffix(".py") in FILES or PACKAGE / inside / "__init__.py" in FILES


def test_the_folders_are_flat():
    assert len(FILES) > 10
    assert {path.parent for path in FILES} == {PACKAGE / folder for folder in SHIPPED}
