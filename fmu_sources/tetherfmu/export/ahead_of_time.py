"""Compile the entry points ahead of time: one small shared library per variant and platform, without Python.

numba compiles each entry point to LLVM's intermediate code. There every function but the entry points becomes internal and
the code is optimized again: all that refers to Python is then dead and vanishes. llvmlite makes an object file for each
platform, and Zig's C compiler (package `ziglang`) links it, whatever machine this runs on.

    python -m tetherfmu.export.ahead_of_time FOLDER PLATFORM,... VARIANT,...     writes the object files (run by `libraries`)
"""

import os
import re
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import NamedTuple

from tetherfmu.runtime.kernel_library import Kernels, file_name

SOURCES = Path(__file__).resolve().parents[2]
MATHEMATICS = {"sqrt", "exp", "log", "log1p", "pow", "asinh", "sinh", "atan2", "ceil", "memset", "memcpy"}
# the plainest processor of each kind, so that the library runs on all of them
PLAIN_CPU = {"NUMBA_CPU_NAME": "x86-64", "NUMBA_CPU_FEATURES": ""}


class Target(NamedTuple):
    """What LLVM and the linker call a platform."""

    triple: str
    cpu: str
    linker: str
    options: tuple = ()


TARGETS = {
    "x86_64-linux": Target("x86_64-unknown-linux-gnu", "x86-64", "x86_64-linux-gnu.2.17", ("-lm",)),
    "x86_64-windows": Target("x86_64-w64-windows-gnu", "x86-64", "x86_64-windows-gnu"),
    "aarch64-linux": Target("aarch64-unknown-linux-gnu", "generic", "aarch64-linux-gnu.2.17", ("-lm",)),
    "aarch64-darwin": Target("arm64-apple-macosx11.0.0", "apple-m1", "aarch64-macos"),
}


def module_for(ir, target, machine):
    """LLVM module of several entry points for a target, with nothing but them exported.

    ir : dict of exported name to (intermediate code, name there).  Returns the module and the names it still needs.
    """
    import llvmlite.binding as llvm

    modules = []
    for name, (code, inner_name) in ir.items():
        code = re.sub(r"^target triple = .*$", f'target triple = "{target.triple}"', code, flags=re.M)
        code = re.sub(r"^target datalayout = .*$", f'target datalayout = "{machine.target_data}"', code, flags=re.M)
        if not target.triple.startswith("x86"):
            code = re.sub(r'"target-(cpu|features)"="[^"]*"', "", code)
        modules.append(llvm.parse_assembly(code))
        modules[-1].get_function(inner_name).name = name
    linked, *others = modules
    for module in others:
        linked.link_in(module)
    linked.verify()
    for item in [*linked.global_variables, *linked.functions]:
        if not item.is_declaration and item.name not in ir:
            item.linkage = "internal"
    tuning = llvm.create_pipeline_tuning_options(speed_level=3)
    tuning.slp_vectorization = True  # two statements in one instruction; numba leaves it out
    builder = llvm.create_pass_builder(machine, tuning)
    builder.getModulePassManager().run(linked, builder)
    items = [*linked.functions, *linked.global_variables]
    needed = {item.name for item in items if item.is_declaration and not item.name.startswith("llvm.")}
    return linked, needed


def intermediate_code(variant):
    """Dict of exported name to (intermediate code, name there) for the entry points of a variant."""
    from tetherfmu.kernels import entry_points
    from tetherfmu.kernels.compilation import compile_entry_point

    ir = {}
    for verb in Kernels._fields:
        name = f"{variant}_{verb}"
        function = compile_entry_point(getattr(entry_points, name), on_disk=False)
        ir[name] = (function._library.get_llvm_str(), function._wrapper_name)
    return ir


def write_objects(folder, platforms, variants):
    """Write an object file for each variant and platform; RuntimeError if one needs more than mathematics."""
    import llvmlite.binding as llvm

    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    for variant in variants:
        ir = intermediate_code(variant)
        for platform in platforms:
            target = TARGETS[platform]
            machine = llvm.Target.from_triple(target.triple).create_target_machine(
                cpu=target.cpu, opt=3, reloc="pic", codemodel="small"
            )
            module, needed = module_for(ir, target, machine)
            if not needed <= MATHEMATICS:
                raise RuntimeError(f"the kernels of {variant} need {sorted(needed - MATHEMATICS)}: see compilation.py")
            (folder / f"{variant}-{platform}.o").write_bytes(machine.emit_object(module))


def link(objects, variant, platform, library):
    """Link an object file to a shared library; RuntimeError with the linker's words if that fails."""
    target = TARGETS[platform]
    command = [sys.executable, "-m", "ziglang", "cc", "-target", target.linker, "-shared", "-s", "-o", library.name]
    command += [str(objects / f"{variant}-{platform}.o"), *target.options]
    done = subprocess.run(command, cwd=library.parent, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise RuntimeError(f"linking {library.name} failed: {done.stderr.strip()}")


def libraries(folder, platforms, variants):
    """Libraries of some variants for some platforms, in a folder; what is there already is kept.

    folder : Path, named by the content of the sources.  platforms : names in `TARGETS`.  RuntimeError if the compiler or the
    linker fails.
    """
    folder.mkdir(parents=True, exist_ok=True)
    pairs = [(each, platform) for each in variants for platform in platforms]
    missing = [pair for pair in pairs if not (folder / file_name(*pair)).exists()]
    if not missing:
        return
    variants, platforms = (sorted(set(names)) for names in zip(*missing, strict=True))
    with tempfile.TemporaryDirectory() as temporary:
        objects = Path(temporary)
        command = [sys.executable, "-m", __spec__.name, temporary, ",".join(platforms), ",".join(variants)]
        environment = {**os.environ, **PLAIN_CPU, "PYTHONPATH": str(SOURCES)}  # the child compiles this very package
        done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise RuntimeError(f"compiling the kernels failed: {done.stderr.strip()}")

        def link_platform(platform):
            for variant in variants:
                partial = objects / file_name(variant, platform)
                link(objects, variant, platform, partial)
                (folder / partial.name).write_bytes(partial.read_bytes())

        with ThreadPoolExecutor(max_workers=2) as pool:
            list(pool.map(link_platform, platforms))


if __name__ == "__main__":
    write_objects(Path(sys.argv[1]), sys.argv[2].split(","), sys.argv[3].split(","))
