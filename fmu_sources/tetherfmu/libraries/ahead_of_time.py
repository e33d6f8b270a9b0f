"""Compile the entry points ahead of time: one small shared library per variant and platform, without Python.

numba writes intermediate code (`intermediate_code.py`). All functions of a variant are linked, all but the entry points
becomes internal, and the whole is optimized once for each architecture: all that refers to Python is then dead and
vanishes. llvmlite makes an object file for each platform, on x86-64 for two kinds of processors (`processors.py`), which is
linked (`linking.py`) whatever machine this runs on.

    python -m tetherfmu.libraries.ahead_of_time PLATFORM,... VARIANT=FOLDER ...     run by `ready`

writes the libraries of each variant into its folder, and the name of each variant to the standard output when it is done.
"""

import gzip
import os
import signal
import sys
import tempfile
from collections import Counter
from concurrent.futures import ProcessPoolExecutor, as_completed
from functools import partial
from itertools import groupby
from multiprocessing import get_context
from pathlib import Path
from time import monotonic

from tetherfmu.libraries import processors
from tetherfmu.libraries.intermediate_code import PAUSE
from tetherfmu.libraries.linking import link
from tetherfmu.libraries.llvm_modules import Target, check_names, for_target, machine_of, optimize, whole_module
from tetherfmu.runtime.kernel_library import SYSTEM, file_name, verbs

TARGETS = {
    "x86_64-linux": Target("x86_64-unknown-linux-gnu", "x86-64"),
    "x86_64-windows": Target("x86_64-w64-windows-gnu", "x86-64"),
    "x86_64-darwin": Target("x86_64-apple-macosx11.0.0", "x86-64"),
    "aarch64-linux": Target("aarch64-unknown-linux-gnu", "generic"),
    "aarch64-darwin": Target("arm64-apple-macosx11.0.0", "apple-m1"),
}


CODE = "code.ll.gz"  # file beside the libraries: linked code from numba, for any target


def object_files(folder, variant, platforms, code=None):
    """Object files of a variant: pairs (platform, bytes); RuntimeError if they depend on more than mathematics.

    code : `intermediate_code.Code`, generated once per folder and cached there: kernels for other
    platforms need no numba, and platforms of an architecture share the optimized code. Equal code yields equal bytes.
    """
    plain = _kept(folder, CODE, lambda: whole_module(code))
    for platform in platforms:
        architecture = platform.partition("-")[0]
        text = _kept(folder, f"{architecture}.ll.gz", partial(_second_round, plain, architecture, names_of(variant)))
        machine = machine_of(TARGETS[platform])
        yield platform, machine.emit_object(for_target(text, TARGETS[platform], machine))


def _second_round(plain, architecture, exported):
    """A module optimized for an architecture, be it made for whichever of its platforms first."""
    target = next(each for platform, each in TARGETS.items() if platform.startswith(architecture))
    machine = machine_of(target)
    module = for_target(plain, target, machine)
    optimize(module, machine, level=3)
    check_names(module, exported)
    return processors.for_both_kinds(module, exported) if architecture == processors.ARCHITECTURE else module


def _kept(folder, name, make):
    """Text of a module that a folder keeps in a file, or that is made now."""
    path = folder / name
    if path.exists():
        return gzip.decompress(path.read_bytes()).decode()
    text = str(make())
    write(path, gzip.compress(text.encode(), compresslevel=5, mtime=0))
    return text


def names_of(variant):
    """Names of the entry points of a variant in its library."""
    return [f"{variant}_{verb}" for verb in verbs(variant)]


def write_libraries(folder, variant, platforms, code):
    """Write the libraries of a variant that a folder has not, each after its object file; returns the variant."""
    missing = [platform for platform in platforms if not (folder / file_name(variant, platform)).exists()]
    for platform, content in object_files(folder, variant, missing, code):
        path = folder / file_name(variant, platform)
        write(folder / object_name(platform), content)
        write(path, link([content, *processors.what_asks(platform)], path.name, platform, names_of(variant)))
    return variant


def alike(platforms):
    """Lists of the platforms with the same kind of processor, which share most of the work."""
    return [list(group) for _, group in groupby(sorted(platforms), lambda platform: platform.partition("-")[0])]


def object_name(platform):
    """Name of the object file beside the library of a variant, for linking a native FMU."""
    return f"{platform}.o"


def write(path, content):
    """Write a file that is there as a whole or not at all."""
    unfinished = Path(tempfile.gettempdir()) / f"{os.getpid()}-{path.name}"  # where `ready` tidies up
    unfinished.write_bytes(content)
    unfinished.replace(path)


def main(arguments, more=None):
    """Write the libraries of all variants; other processes optimize them while numba continues with the next one.

    more : function, called after all variants but systems, that returns a function and its arguments, for another process.
    """
    platforms, *variants = arguments
    at_once = signal.SIGINT, signal.SIG_DFL  # Ctrl-C ends a process also while LLVM works
    signal.signal(*at_once)
    with ProcessPoolExecutor(os.cpu_count(), get_context("spawn"), signal.signal, at_once) as pool:
        waiting, left, began = [], Counter(), monotonic()  # number of remaining tasks of each variant
        folders = {variant: Path(place) for variant, _, place in (each.partition("=") for each in variants)}
        missing = [variant for variant, folder in folders.items() if not (folder / CODE).exists()]
        # kernels of systems know more than others, and need another process
        of_systems = pool.submit(code_of, SYSTEM) if SYSTEM in missing else None

        def submit(variant, code):
            folders[variant].mkdir(parents=True, exist_ok=True)
            if monotonic() - began > PAUSE:
                print(f"{variant} written, being optimized", flush=True)
            for group in alike(platforms.split(",")):
                waiting.append(pool.submit(write_libraries, folders[variant], variant, group, code))
                left[variant] += 1

        for variant in folders.keys() - missing:  # need no numba
            submit(variant, None)
        for variant in (each for each in missing if each != SYSTEM):
            submit(variant, code_of(variant))
        if more is not None:
            waiting.append(pool.submit(*more()))
        if of_systems is not None:
            submit(SYSTEM, of_systems.result())
        for done in as_completed(waiting):
            left[done.result()] -= 1
            if left[done.result()] <= 0:
                print(done.result(), flush=True)


def code_of(variant):
    """`intermediate_code.Code` of a variant; numba is imported where it is needed."""
    from tetherfmu.libraries import intermediate_code

    return intermediate_code.code_of(variant)


if __name__ == "__main__":
    from tetherfmu.libraries.ahead_of_time import main  # other processes import their task by this name

    main(sys.argv[1:])
