"""Kernels for two kinds of x86-64 processors in one object file: with AVX, and for all others.

An AVX instruction has a separate operand for the result, so fewer numbers are moved: steps are about 7 %
faster. The operations and their order are the same, and so are the numbers, to the last bit. On the first call the entry
points detect the processor (`runtime/native/has_avx.c`). Functions called once per run exist once, for all.
"""

import re
import tempfile
from pathlib import Path

from tetherfmu.libraries.linking import compile_c
from tetherfmu.libraries.sources import HAS_AVX

ARCHITECTURE = "x86_64"
KINDS = ("plain", "avx")
ONCE = ("_segments", "_pack", "_complete", "_initialize")  # how the names of such entry points end
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
    """A module with the functions of an optimized one twice, and with entry points that select.

    names : of the entry points, which return a number; those of `ONCE` are unchanged.
    """
    import llvmlite.binding as llvm

    text = str(module)
    chosen = [name for name in names if not name.endswith(ONCE)]
    target = "\n".join(re.findall(r"^target .*$", text, flags=re.MULTILINE))
    entry_points = [_entry_point(module.get_function(name)) for name in chosen]
    both = llvm.parse_assembly("".join([target, "\ndeclare hidden i32 @has_avx()\n", *entry_points]))
    for kind, version in zip(KINDS, (text, _with_avx(text)), strict=True):
        part = llvm.parse_assembly(version)
        for name in chosen:
            part.get_function(name).name = f"{name}.{kind}"
        if kind != KINDS[0]:
            remove(part, [name for name in names if name not in chosen])
        both.link_in(part)
        for name in chosen:
            both.get_function(f"{name}.{kind}").linkage = "internal"
    return both


def remove(module, names):
    """Remove functions from a module (modified), and all that nothing else needs."""
    import llvmlite.binding as llvm

    for name in names:
        module.get_function(name).linkage = "internal"
    machine = llvm.Target.from_triple(module.triple).create_target_machine()
    passes = llvm.create_new_module_pass_manager()
    passes.add_global_dead_code_eliminate_pass()
    passes.run(module, llvm.create_pass_builder(machine, llvm.create_pipeline_tuning_options()))


def _entry_point(function):
    """Intermediate code of an entry point that chooses, of the type of a function."""
    returned, kinds = re.fullmatch(r"(\w+) \((.*)\)", str(function.global_value_type)).groups()
    arguments = ", ".join(f"{kind} %{place}" for place, kind in enumerate(kinds.split(", ")))
    return ENTRY_POINT.format(name=function.name, returned=returned, kinds=kinds, arguments=arguments)


def _with_avx(text):
    """Intermediate code that LLVM compiles to AVX instructions."""
    return re.sub(r"^(attributes #\d+ = \{.*) \}$", r'\1 "target-features"="+avx" }', text, flags=re.MULTILINE)


def what_asks(platform):
    """Object files (list of bytes) that the entry points need on a platform, to ask for the kind of the processor."""
    if not platform.startswith(ARCHITECTURE):
        return []
    with tempfile.TemporaryDirectory() as folder:
        return [compile_c(Path(folder), HAS_AVX, platform, ("-Os", "-fPIC", "-fvisibility=hidden"))]
