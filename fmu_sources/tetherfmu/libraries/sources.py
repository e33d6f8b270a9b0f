"""The files that the library of a variant is made from, and their hash: it names the folder where the library is kept."""

import hashlib
import re
from functools import cache
from pathlib import Path

PACKAGE = Path(__file__).resolve().parents[1]
HAS_AVX = PACKAGE / "runtime" / "native" / "has_avx.c"  # detects the processor
# modules beside this one, how a library is made
RECIPE = ("ahead_of_time", "intermediate_code", "linking", "llvm_modules", "processors")
LONG = r'"{3}[^"\\]*(?:(?:\\.|"(?!""))[^"\\]*)*"{3}'
# a text, which may contain a #, or parts to omit: comments and empty lines
WORDS = re.compile(rf"""({LONG}|"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])*')|  #[^\n]*|#[^\n]*|\n *(?=\n|#)""", re.DOTALL)
DOCSTRING = re.compile(rf"(\A|:\n\s*|\.__doc__ = ){LONG}", re.DOTALL)
IMPORT = re.compile(r"^from (\.*)([\w.]*) import (?:\(([^)]*)\)|(.*))$", re.MULTILINE)
NAME = re.compile(r"(\w+)(?: as \w+)?")


@cache
def code_in(path):
    """Text of a file; of a Python file without comments and empty lines, and with empty docstrings.

    Thus words change no library. (A syntax tree as text would depend on the version of Python, which a wheel must not.)
    """
    text = path.read_text(encoding="utf-8")  # with any line ending
    if path.suffix != ".py":
        return text
    return DOCSTRING.sub(r'\1""""""', WORDS.sub(lambda found: found[1] or "", text).lstrip())


def imported(path):
    """Files of the package that a file imports at its top; `__init__` files contain no code.

    Other packages do not count, although numba's files are beside this package in an environment with the wheel.
    """
    for dots, module, *names in IMPORT.findall(code_in(path)):
        base = path.parents[len(dots) - 1] if dots else PACKAGE.parent
        base = base.joinpath(*module.split(".")) if module else base
        places = [base] if base.with_suffix(".py").exists() else [base / name for name in NAME.findall("".join(names))]
        files = (place.with_suffix(".py") for place in places)
        yield from (file for file in files if file.is_relative_to(PACKAGE) and file.exists())


@cache
def sources_of(variant):
    """Files that the library of a variant is made from, sorted by their place in the package."""
    found = set()
    kernels = PACKAGE / "kernels"
    waiting = [*(kernels / "variants" / f"{name}.py" for name in (variant, "tether")), kernels / "entry_points.py"]
    while waiting:
        path = waiting.pop()
        if path not in found:
            found.add(path)
            waiting.extend(imported(path))
    return sorted({*found, *(PACKAGE / "libraries" / f"{name}.py" for name in RECIPE), HAS_AVX})


@cache
def digest(variant):
    """Hash of the sources of a variant: 12 hexadecimal digits."""
    content = hashlib.sha256()
    for path in sources_of(variant):
        content.update(path.relative_to(PACKAGE).as_posix().encode("utf-8"))
        content.update(code_in(path).encode("utf-8"))
    return content.hexdigest()[:12]
