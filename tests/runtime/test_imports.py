"""What an FMU ships, the folder `runtime`, imports the standard library only; its base slave imports PythonFMU as well."""

import ast
import sys
from pathlib import Path

import pytest

import tetherfmu.runtime

FOLDER = Path(tetherfmu.runtime.__file__).parent
FILES = sorted(FOLDER.glob("*.py"))


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
    """The builder copies the files of the folder, nothing above or below it (`__version__` is a name in it)."""
    relative = [(level, module) for level, module in imports(file) if level > 0 and module != "__version__"]
    assert all(level == 1 for level, _ in relative)
    assert {module for _, module in relative} <= {each.stem for each in FILES}


def test_the_folder_is_flat():
    assert len(FILES) > 10
    assert [path for path in FOLDER.rglob("*.py") if path.parent != FOLDER] == []
