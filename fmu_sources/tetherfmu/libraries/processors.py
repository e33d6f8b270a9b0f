"""Kernels for two kinds of x86-64 processors in one object file: for those with AVX, and for all others.

An instruction of AVX names a place of its own for the result, so that fewer numbers are moved about: a step takes some 7 %
less. The operations and their order are the same, and so are the numbers, to the last bit. At the first call the entry
points ask for the kind of the processor (`runtime/native/has_avx.c`).
"""

import re
import tempfile
from pathlib import Path

from tetherfmu.libraries.linking import compile_c
from tetherfmu.libraries.sources import HAS_AVX

ARCHITECTURE = "x86_64"
KINDS = ("plain", "avx")
ENTRY_POINT = """
declare {returned} @{name}.plain({kinds})
declare {returned} @{name}.avx({kinds})

define {returned} @{name}({arguments}) {{
  %answer = call i32 @has_avx()
  %has_avx = icmp ne i32 %answer, 0
  %chosen = select i1 %has_avx, ptr @{name}.avx, ptr @{name}.plain
  %result = tail call {returned} %chosen({arguments})
  ret {returned} %result
}}
"""


def for_both_kinds(module, names):
    """A module with all functions of an optimized one twice, and with entry points that choose.

    names : of the entry points, which return a number.
    """
    import llvmlite.binding as llvm

    text = str(module)
    target = "\n".join(re.findall(r"^target .*$", text, flags=re.MULTILINE))
    entry_points = [_entry_point(module.get_function(name)) for name in names]
    both = llvm.parse_assembly("".join([target, "\ndeclare hidden i32 @has_avx()\n", *entry_points]))
    for kind, version in zip(KINDS, (text, _with_avx(text)), strict=True):
        part = llvm.parse_assembly(version)
        for name in names:
            part.get_function(name).name = f"{name}.{kind}"
        both.link_in(part)
        for name in names:
            both.get_function(f"{name}.{kind}").linkage = "internal"
    return both


def _entry_point(function):
    """Intermediate code of an entry point that chooses, of the type of a function."""
    returned, kinds = re.fullmatch(r"(\w+) \((.*)\)", str(function.global_value_type)).groups()
    arguments = ", ".join(f"{kind} %{place}" for place, kind in enumerate(kinds.split(", ")))
    return ENTRY_POINT.format(name=function.name, returned=returned, kinds=kinds, arguments=arguments)


def _with_avx(text):
    """Intermediate code of which LLVM makes instructions of AVX."""
    return re.sub(r"^(attributes #\d+ = \{.*) \}$", r'\1 "target-features"="+avx" }', text, flags=re.MULTILINE)


def what_asks(platform):
    """Object files (list of bytes) that the entry points need on a platform, to ask for the kind of the processor."""
    if not platform.startswith(ARCHITECTURE):
        return []
    with tempfile.TemporaryDirectory() as folder:
        return [compile_c(Path(folder), HAS_AVX, platform, ("-Os", "-fPIC", "-fvisibility=hidden"))]
