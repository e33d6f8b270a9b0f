"""Assemble native FMUs: no Python in them, one library for each platform that has the C shell and the kernels in it.

The shell is compiled for the variables of the FMU, so it reads no file when it runs.
"""

import re
from functools import partial
from importlib.util import find_spec
from pathlib import Path

from tetherfmu.fmi.resources import DEFAULT_OPTIONS
from tetherfmu.libraries import ready
from tetherfmu.libraries.ahead_of_time import object_name
from tetherfmu.libraries.native_shell import SHELL, native_library
from tetherfmu.runtime.kernel_library import SUFFIXES
from tetherfmu.runtime.variables import table_of
from tetherfmu.runtime.variants import BY_NAME, library_of

from ..archive import DESCRIPTION, SLAVES, guid_of, write
from ..build_options import BuildOptions
from ..documents import documents
from . import description, description_fmi3, host_header, sources
from .arrays import arrays_at, places_of
from .tables import header, room_of, wiring_of
from .universal import universal

HEADERS = Path(find_spec("fmpy").origin).with_name("c-code")  # FMI's own, under the 2-clause BSD licence
TERMINALS = "terminalsAndIcons/terminalsAndIcons.xml"
SYSTEMS_OF_FMI2 = {"linux": "linux64", "windows": "win64", "darwin": "darwin64"}


def build(name, folder, options=None, fmi=2, with_header=False, with_sources=False):
    """Build one native FMU and return its path; RuntimeError if a compiler or the linker fails.

    The arguments are those of `archive.build`; fmi : version, 2 or 3.  with_header : whether a C header for hosts is written
    beside it, see `host_header`.  with_sources : whether the FMU can also be compiled by its importer, see `sources`.
    """
    folder, options = Path(folder), options or BuildOptions()
    folder.mkdir(parents=True, exist_ok=True)
    variant, given = SLAVES[name], DEFAULT_OPTIONS | options.as_dict()
    about = " ".join(filter(None, [BY_NAME[variant].description, given["about"]]))
    kernels, files = kernels_of(library_of(variant), options.platforms), {}
    if fmi == 3:
        files[TERMINALS] = description_fmi3.terminals(table_of(variant, given)).encode("utf-8")
    files |= documents(name, variant, about, options, native=fmi)
    texts = writers(name, variant, about, given, fmi, (sources.FILE,) if with_sources else ())
    token = complete(files, name, kernels, texts, fmi)
    if with_sources:
        lines = wiring_of(variant, table_of(variant, given), given["shape_points"]).lines
        room = room_of(ready.kernels(library_of(variant)), lines)
        files |= sources.sources(name, library_of(variant), texts[1](token), room, fmi, HEADERS)
    made = write(files, folder, name, options.purpose)
    if with_header:
        table = table_of(variant, given)
        host_header.write(made, name, table, places_of(table, given["shape_points"]), fmi, token)
    return made


def complete(files, name, kernels, texts, fmi):
    """Add model description and libraries to the files of an FMU (modified); returns its token.

    texts : functions of the token that give the model description and `tables.h`.  kernels : as of `kernels_of`.
    """
    describe, tabulate = texts
    shell = {path.name: path.read_bytes() for path in SHELL.glob("*.[ch]")}
    token = guid_of(describe(""), {**files, **shell, **kernels, "tables.h": tabulate("").encode("utf-8")})
    files[DESCRIPTION] = describe(token).encode("utf-8")
    files |= binaries(name, kernels, tabulate(token), fmi)
    return token


def kernels_of(library, platforms):
    """Object files (bytes) of the kernels of a library: dict by platform."""
    folder = ready.folders([library], platforms)[library]
    return {platform: (folder / object_name(platform)).read_bytes() for platform in platforms}


def writers(name, variant, about, given, fmi, sources=()):
    """Functions of the token that give the text of the model description and that of `tables.h`.

    given : `BuildOptions.as_dict` with its defaults.  sources : C files that an importer compiles.
    """
    table, shape_points = table_of(variant, given), given["shape_points"]
    places = places_of(table, shape_points)
    times = given["step"], given["stop"]
    describe = partial(writer_of(fmi).text, name, about, table, places, times, sources=sources)
    return describe, partial(header, wiring_of(variant, table, shape_points), widths_of(table, places, fmi))


def writer_of(fmi):
    """Module that writes the model description of a version of FMI."""
    return description_fmi3 if fmi == 3 else description


def widths_of(table, places, fmi):
    """Of FMI 3, which has arrays: dict of value reference to number of values; None for FMI 2."""
    if fmi == 2:
        return None
    return {array.reference: len(array.variables) for array in arrays_at(table, places)}


def binaries(name, kernels, tables, fmi):
    """The libraries of an FMU: dict of path in the archive to bytes.

    kernels : dict of platform to object file (bytes).  tables : text of `tables.h`.
    """
    exported = functions_of(fmi)
    made = {}
    for platform, content in kernels.items():
        system = platform.partition("-")[2]
        file = f"{name}{SUFFIXES[system]}"
        library = native_library(content, file, platform, tables, fmi, HEADERS, exported)
        path = f"binaries/{platform}/{file}"
        if fmi == 2 and (system == "darwin" or f"binaries/{SYSTEMS_OF_FMI2[system]}/{file}" not in made):
            path = f"binaries/{SYSTEMS_OF_FMI2[system]}/{file}"
        made[path] = universal([made[path], library]) if path in made else library
    return made


def functions_of(fmi):
    """Names of all functions of FMI 2 or 3, from its header."""
    text = (HEADERS / f"fmi{fmi}Functions.h").read_text(encoding="utf-8", errors="replace")
    return re.findall(rf"^ *FMI{fmi}_Export\s+fmi{fmi}\w+TYPE\s+(fmi{fmi}\w+);", text, re.MULTILINE)
