"""A library is named by what it is made from: each source counts for the variants that use it, and for no other."""

import ast
import os
import shutil
import subprocess
import sys

import pytest

from tetherfmu.libraries import sources
from tetherfmu.libraries.sources import PACKAGE, digest, sources_of
from tetherfmu.runtime.variants import VARIANTS


def modules_imported(path):
    """Files of the package that a file imports, by Python's own parser."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom):
            base = path.parents[node.level - 1] if node.level else PACKAGE.parent
            base = base.joinpath(*(node.module or "").split("."))
            for place in (base, *(base / alias.name for alias in node.names)):
                file = place.with_suffix(".py")
                if file.is_relative_to(PACKAGE) and file.exists():
                    yield file


@pytest.mark.parametrize("variant", VARIANTS)
def test_all_that_is_imported_counts(variant):
    found = set(sources_of(variant))
    for path in found:
        if path.suffix == ".py" and path.parent.name != "libraries":
            assert set(modules_imported(path)) <= found, path


def test_what_is_shared_and_what_is_not():
    names = {variant: {path.name for path in sources_of(variant)} for variant in VARIANTS}
    for variant in VARIANTS:
        assert {"entry_points.py", "segment.py", "layout.py", "status.py", "linking.py", f"{variant}.py"} <= names[variant]
        assert not {f"{other}.py" for other in VARIANTS if other != variant} & names[variant]
    assert {variant for variant in VARIANTS if "rosenbrock.py" in names[variant]} == {"dynamic"}
    assert {variant for variant in VARIANTS if "chord.py" in names[variant]} == {"straight", "catenary"}


@pytest.mark.parametrize(("edited", "changed"), [("quasi_steady", {"quasi_steady"}), ("segment", set(VARIANTS))])
def test_an_edit_renames_the_variants_that_use_the_file(monkeypatch, edited, changed):
    before = {variant: digest(variant) for variant in VARIANTS}
    read = sources.Path.read_text

    def with_a_line_more(path, *arguments, **options):
        return read(path, *arguments, **options) + ("# more\n" if path.stem == edited else "")

    monkeypatch.setattr(sources.Path, "read_text", with_a_line_more)
    after = {variant: digest.__wrapped__(variant) for variant in VARIANTS}
    assert {variant for variant in VARIANTS if before[variant] != after[variant]} == changed


def test_packages_beside_this_one_do_not_count(tmp_path):
    """An environment with the wheel has numba's files in the same folder, a checkout has not: the names are the same."""
    shutil.copytree(PACKAGE, tmp_path / "tetherfmu", ignore=shutil.ignore_patterns("__pycache__", "compiled"))
    for beside in ("numba/core/cgutils.py", "numba/extending.py", "math.py"):
        file = tmp_path / beside
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text("", encoding="utf-8")
    program = f"from tetherfmu.libraries.sources import digest; print(*map(digest, {VARIANTS!r}))"
    command = [sys.executable, "-S", "-c", f"import sys, math; sys.path.insert(0, {str(tmp_path)!r}); {program}"]
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    printed = subprocess.run(command, capture_output=True, text=True, check=True, env=environment).stdout
    assert printed.split() == [digest(variant) for variant in VARIANTS]
