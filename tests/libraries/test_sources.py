"""A library is named by what it is made from: each source counts for the variants that use it, and for no other."""

import ast
import os
import re
import shutil
import subprocess
import sys
from io import StringIO
from tokenize import COMMENT, generate_tokens

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


WORDS = {  # what is edited in each file: what it has then
    r"\A": "# a comment\n\n",
    r"(?<=[\w)])\n": '  # another, of 2 "marks" and of \'\n',
    r'"""\n': '"""\n    # one below a docstring\n\n',
    r'(?<=:\n    """)': "In other words, \\'\\. ",
    r'(?<=\A""")': "Of something else: ",
}
EDITS = {  # what is edited in a file: its name, and the variants with another digest then
    ("(?s)(.*)", r"\1MORE = 1\n"): [("quasi_steady", {"quasi_steady"}), ("segment", set(VARIANTS)), ("sources", set())],
    (r"\b1\.0\b", "1.5"): [("catenary", {"catenary"}), ("drum", {"quasi_steady", "dynamic", "straight", "catenary"})],
    ('(?<=: ")no ', "none "): [("status", set(VARIANTS))],
    **{edit: [("dynamic", set()), ("segment", set()), ("linking", set()), ("drum", set())] for edit in WORDS.items()},
}


@pytest.mark.parametrize(("edit", "file", "changed"), [(edit, *each) for edit, all_of in EDITS.items() for each in all_of])
def test_an_edit_renames_the_variants_that_use_the_file_but_words_do_not(monkeypatch, edit, file, changed):
    before = {variant: digest(variant) for variant in VARIANTS}
    read, edited = sources.Path.read_text, []

    def with_an_edit(path, *arguments, **options):
        text = read(path, *arguments, **options)
        edited.append(path.stem == file and re.sub(*edit, text, count=1 if "MORE" in edit[1] else 0))
        return edited[-1] or text

    monkeypatch.setattr(sources.Path, "read_text", with_an_edit)
    sources.code_in.cache_clear()
    after = {variant: digest.__wrapped__(variant) for variant in VARIANTS}
    sources.code_in.cache_clear()
    assert {variant for variant in VARIANTS if before[variant] != after[variant]} == changed


def tree(text):
    """Syntax tree of Python code, with empty docstrings."""
    found = ast.parse(text)
    for node in ast.walk(found):
        if isinstance(node, ast.Module | ast.FunctionDef | ast.ClassDef) and ast.get_docstring(node) is not None:
            node.body[0].value.value = ""
        if isinstance(node, ast.Assign) and getattr(node.targets[0], "attr", "") == "__doc__":
            node.value = ast.Constant("")
    return ast.dump(found)


def test_nothing_but_words_is_left_out():
    """What the digest sees is Python code with the syntax tree of the source, docstrings apart, and has no comment."""
    for path in sources_of("system"):
        if path.suffix == ".py":
            code = sources.code_in(path)
            assert tree(code) == tree(path.read_text(encoding="utf-8")), path
            assert not [each for each in generate_tokens(StringIO(code).readline) if each.type == COMMENT], path


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
