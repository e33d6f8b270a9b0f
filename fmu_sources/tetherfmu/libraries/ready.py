"""Compiled libraries ready for use: those that the wheel carries, or those that are compiled here when they are missing."""

import os
import subprocess
import sys
import tempfile
from functools import cache
from hashlib import sha256
from importlib.metadata import PackageNotFoundError, version
from time import monotonic

from tetherfmu.runtime import kernel_library
from tetherfmu.runtime.kernel_library import file_name, this_platform
from tetherfmu.runtime.variants import VARIANTS

from .ahead_of_time import TARGETS
from .children import child
from .sources import PACKAGE, digest
from .whole_files import clear

IN_WHEEL = PACKAGE / "libraries" / "compiled"
TOOLS = ("llvmlite", "numba", "ziglang")
LIBRARIES = (*VARIANTS, kernel_library.SYSTEM)  # all libraries; later ones need longer to compile
# first and last version of numba whose internals are known, and that leaves nothing of Python in a library (0.65 leaves the
# error of a `range` without a step); the extra `build` has the same, tests/libraries/ends_of_numba.py tries both
TESTED = (0, 66), (0, 68)
UNFINISHED = "partial-"  # prefix of a folder in which a process compiles
TEMPORARY = ("TMPDIR", "TEMP", "TMP")  # environment variables that name the folder for temporary files
FOR_NUMBA = {  # environment variables
    "NUMBA_CPU_NAME": "x86-64",  # the plainest processor, as the targets of `ahead_of_time` are
    "NUMBA_CPU_FEATURES": "",
    "PYTHONHASHSEED": "0",  # the order of a set of names determines the order of some
    "NUMBA_DISABLE_ERROR_MESSAGE_HIGHLIGHTING": "1",  # numba writes thousands of messages that nobody sees
}


@cache
def kernels(variant):
    """Entry points of a variant for this machine, `kernel_library.Kernels`, or those of SYSTEM.

    RuntimeError if they cannot be compiled.
    """
    return kernel_library.load(folders([variant], [this_platform()])[variant], variant)


def folders(variants, platforms, browser=None):
    """Folders that have the libraries of variants for platforms (`ahead_of_time.TARGETS`), compiled if they are missing.

    browser : path of the file for browsers, if it is to be made in the same go (`webassembly.py`).
    Dict of variant to Path. RuntimeError if a platform is unknown, compiling or linking fails, or what compiles is missing.
    """
    unknown = set(platforms) - TARGETS.keys()
    if unknown:
        raise RuntimeError(f"kernels cannot be compiled for {', '.join(sorted(unknown))}, only for {', '.join(TARGETS)}")
    in_wheel = {variant: place(IN_WHEEL, variant) for variant in variants}
    if all(has_all(folder, variant, platforms) for variant, folder in in_wheel.items()):
        return in_wheel
    return compiled_in(cache_folder(), variants, platforms, browser=browser)


def compiled_in(root, variants, platforms, browser=None):
    """As `folders`, below the folder `root`."""
    found = {variant: place(root, variant) for variant in variants}
    missing = [variant for variant in found if not has_all(found[variant], variant, platforms)]
    if missing:
        slowest_first = sorted(missing, key=LIBRARIES.index, reverse=True)
        wanted = [each for each in platforms if not all(has_all(found[variant], variant, [each]) for variant in missing)]
        _compile({variant: found[variant] for variant in slowest_first}, wanted, browser)
    return found


def place(root, variant):
    """Folder of the libraries of a variant below `root`, named by its sources: an edit never leaves old code in use."""
    return root / f"{variant}_{digest(variant)}"


def has_all(folder, variant, platforms):
    """Whether a folder has the libraries of a variant for all platforms."""
    return all((folder / file_name(variant, platform)).exists() for platform in platforms)


def cache_folder():
    """Cache folder of compiled files, named by the compilers; RuntimeError if one is not installed."""
    try:
        tools = [f"{package} {version(package)}" for package in TOOLS]
    except PackageNotFoundError as error:
        raise RuntimeError(
            f"the kernels are not compiled for this platform or were edited, and {error.name}, which compiles them, is not "
            'installed; install it with: pip install "tetherfmu[build]"'
        ) from None
    name = " ".join([f"python {sys.version_info.major}.{sys.version_info.minor}", *tools])
    return PACKAGE / "__pycache__" / f"libraries_{sha256(name.encode()).hexdigest()[:12]}"


def check_numba():
    """RuntimeError unless the internals of the installed numba version are known."""
    numba = version("numba")
    if not TESTED[0] <= tuple(map(int, numba.split(".")[:2])) <= TESTED[1]:
        first, last = (".".join(map(str, each)) for each in TESTED)
        raise RuntimeError(
            f"the kernels are not compiled for this platform or were edited, and numba {numba} cannot compile them, only "
            f'{first} to {last}; install one with: pip install "tetherfmu[build]"'
        )


def _compile(folders, platforms, browser):
    """Compile variants in a process of its own, announced on stderr; folders : dict of variant to folder, in their order."""
    check_numba()
    root = next(iter(folders.values())).parent
    print(f"compiling kernels for {', '.join(platforms)}, once: {', '.join(folders)}", file=sys.stderr, flush=True)
    variants = [f"{variant}={folder}" for variant, folder in folders.items()]
    module, first = ("ahead_of_time", []) if browser is None else ("webassembly", [str(browser)])
    run(module, [*first, ",".join(platforms), *variants], root)
    if browser is None:
        later = [each for each in LIBRARIES if not has_all(place(root, each), each, platforms)]
        names = ("systems of tethers" if each == kernel_library.SYSTEM else each for each in later)
        listed = ", ".join([*names, "tetherfmu web"])
        print(f"not yet compiled; each will be compiled at its first use: {listed}", file=sys.stderr, flush=True)


def run(module, arguments, root):
    """Run a module in this folder, which compiles below the folder `root` and writes a line of progress.

    RuntimeError with its stderr if it fails.
    """
    began = monotonic()
    # -P: a file of the user with the name of a module that numba imports is not imported
    command = [sys.executable, "-P", "-m", f"tetherfmu.libraries.{module}", *arguments]
    path = [str(PACKAGE.parent), *filter(None, [os.environ.get("PYTHONPATH")])]  # the child compiles this very package
    root.mkdir(parents=True, exist_ok=True)
    clear(root, f"{UNFINISHED}*")
    with (
        tempfile.TemporaryDirectory(dir=root, prefix=UNFINISHED) as unfinished,  # also if Ctrl-C ends the child
        tempfile.TemporaryFile("w+") as problems,
    ):
        own = {"PYTHONPATH": os.pathsep.join(path), **dict.fromkeys(TEMPORARY, unfinished)}
        with child(command, env=os.environ | FOR_NUMBA | own, stdout=subprocess.PIPE, stderr=problems) as started:
            for line in started.stdout:
                print(f"  {line.strip()} after {monotonic() - began:.0f} s", file=sys.stderr, flush=True)
            if started.wait() != 0:
                problems.seek(0)
                raise RuntimeError(f"compiling the kernels failed: {problems.read().strip()}")
