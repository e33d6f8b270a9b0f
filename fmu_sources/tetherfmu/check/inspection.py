"""Inspect an FMU and this machine without running the FMU; needs FMPy."""

import platform
import re
import string
import sys
import sysconfig
import zipfile
from contextlib import contextmanager
from importlib.metadata import version
from pathlib import Path, PurePosixPath

from tetherfmu.console.ending import one_line
from tetherfmu.runtime.kernel_library import NO_LIBRARY_OF_PYTHONFMU, PYTHONFMU, platform_of, this_platform

from .soundness import DESCRIPTION, NOTE, OK, PROBLEM, Finding

MADE_BY_PYTHONFMU = "resources/slavemodule.txt"
KERNELS = "resources/kernels/"
RECOMMENDED = ("documentation/index.html", "documentation/externalDependencies.txt", "documentation/licenses/license.txt")
ICONS = {"2": "model.png", "3": "terminalsAndIcons/icon.png"}
MOST_PROBLEMS = 20  # of its validation that are shown
HARMLESS = frozenset(string.ascii_letters + string.digits + "_-.~ ")  # in a path that PythonFMU's library must understand

PART = r"[A-Za-z_][A-Za-z_0-9]*(\[[0-9]+(,[0-9]+)*\])?"  # of a structured name, with its indices
PLAIN = re.compile(rf"{PART}(\.{PART})*")


def machine():
    """Python and FMPy that check the FMU."""
    bits = 64 if sys.maxsize > 2**32 else 32
    python = f"Python {platform.python_version()}, {bits} bit, {sys.executable}, on {this_platform()}"
    return [Finding(OK, python), Finding(OK, f"FMPy {version('fmpy')}")]


def fmi_version(path):
    """Major version of FMI of an FMU, "2" for example; "" if its description cannot be read."""
    with zipfile.ZipFile(path) as opened:
        found = re.search(rb"""fmiVersion\s*=\s*["'](\d)""", opened.read(DESCRIPTION))
    return found[1].decode() if found else ""


@contextmanager
def plain_names_at_once():
    """FMPy parses the name of each variable by a grammar, in some ms; here a name that is plainly right is not parsed."""
    from lark import Lark

    parse = Lark.parse
    Lark.parse = lambda self, text, *more, **options: PLAIN.fullmatch(text) or parse(self, text, *more, **options)
    try:
        yield
    finally:
        Lark.parse = parse


def description(path):
    """Whether the model description obeys FMPy's validation, which begins with the XML schema of its version of FMI."""
    from fmpy.validation import validate_fmu

    with plain_names_at_once():
        problems = validate_fmu(str(path))
    if problems:
        found = [Finding(PROBLEM, f"FMPy's validation: {one_line(problem)}") for problem in problems[:MOST_PROBLEMS]]
        return found + [Finding(PROBLEM, f"and {len(problems) - MOST_PROBLEMS} more")] * (len(problems) > MOST_PROBLEMS)
    validity = f"valid by the XML schema of FMI {fmi_version(path)}.0, and FMPy finds no problem"
    return [Finding(OK, f"model description: {validity}")]


def units(path):
    """Units of the variables of an FMU: dict of name to unit or None."""
    from fmpy import read_model_description

    return {variable.name: variable.unit for variable in read_model_description(str(path), validate=False).modelVariables}


def layout(names, version):
    """Files that a version of FMI recommends and that this FMU has not."""
    missing = [name for name in (ICONS.get(version, ICONS["2"]), *RECOMMENDED) if name not in names]
    if missing:
        return [Finding(NOTE, f"FMI recommends files that the FMU lacks: {', '.join(missing)}")]
    return [Finding(OK, "page, icon, licences and external dependencies are where FMI recommends them")]


def platforms(names, version):
    """Whether the FMU has a library, and its kernels if it is a tether, for this machine."""
    import fmpy

    ending, place = fmpy.sharedLibraryExtension, fmpy.platform_tuple if version == "3" else fmpy.platform
    libraries = sorted({PurePosixPath(name).parts[1] for name in names if name.startswith("binaries/") and name[-1] != "/"})
    if not any(name.startswith(f"binaries/{place}/") and name.endswith(ending) for name in names):
        remedy = "run it on one of those platforms" if libraries else ""
        if MADE_BY_PYTHONFMU in names:
            remedy = NO_LIBRARY_OF_PYTHONFMU.format(platforms=this_platform())
            if this_platform() in PYTHONFMU:
                remedy = f"build it with: tetherfmu build --platforms {this_platform()}"
        text = f"the FMU has no library for {place}, only for {', '.join(libraries) or 'none'}"
        return [Finding(PROBLEM, text, remedy)]
    kernels = sorted(platform_of(name) for name in names if name.startswith(KERNELS))
    if kernels and this_platform() not in kernels:
        remedy = f"build it with: tetherfmu build --platforms {this_platform()}"
        return [Finding(PROBLEM, f"the FMU has no kernels for {this_platform()}, only for {', '.join(kernels)}", remedy)]
    return [Finding(OK, f"platforms: {', '.join(kernels or libraries)}; this one is among them")]


def hosts_that_are_not_python():
    """Requirements of FMUs made by PythonFMU for hosts that are not Python programs."""
    if sys.platform != "linux":
        return []
    library = shared_python()
    if library:
        return [Finding(NOTE, "hosts that are not Python need the Python library", f"start them with LD_PRELOAD={library}")]
    text = "this Python has no shared library, so hosts that are not Python cannot run the FMU with it"
    remedy = f"install libpython{sysconfig.get_python_version()} or a Python that is built with --enable-shared"
    return [Finding(NOTE, text, remedy)]


def shared_python():
    """Path of the shared library of this Python, or None."""
    name = sysconfig.get_config_var("INSTSONAME") or ""
    folder = Path(sysconfig.get_config_var("LIBDIR") or "")
    candidates = [folder / name, folder / (sysconfig.get_config_var("MULTIARCH") or "") / name]
    return next((each for each in candidates if ".so" in name and each.is_file()), None)


def crashing_characters(path):
    """Characters of a path that crash PythonFMU's library when an FMU is extracted there."""
    path = Path(path).resolve()
    return sorted(set("".join(path.parts).removeprefix(path.anchor)) - HARMLESS)


def paths(path, temporary):
    """Whether PythonFMU's library works in the folder for extraction; and beside the FMU, where some hosts extract."""
    characters = crashing_characters(temporary)
    if characters:
        text = f"FMUs are extracted to {temporary}; PythonFMU's library crashes on {' '.join(characters)} in that path"
        return [Finding(PROBLEM, text, "set the variable TMPDIR (TEMP on Windows) to a folder with a plain path")]
    characters = crashing_characters(Path(path).resolve().parent)
    if characters:
        text = f"a host that extracts the FMU beside itself will crash: its path has {' '.join(characters)}"
        return [Finding(NOTE, text, "move the FMU to a folder with a plain path")]
    return [Finding(OK, "paths: PythonFMU's library accepts their characters")]
