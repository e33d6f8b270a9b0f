"""Assemble native FMUs: no Python in them, one library for each platform that has the C shell and the kernels in it.

The shell is compiled for the variables of the FMU, so it reads no file when it runs.
"""

import re
import runpy
from importlib.util import find_spec
from pathlib import Path

from tetherfmu.libraries import ready
from tetherfmu.libraries.ahead_of_time import object_name
from tetherfmu.libraries.native_shell import SHELL, native_library
from tetherfmu.runtime.kernel_library import SUFFIXES, this_platform
from tetherfmu.runtime.resources import DEFAULT_OPTIONS
from tetherfmu.runtime.variables import table_of
from tetherfmu.runtime.variants import library_of

from . import native_description, native_description_fmi3
from .archive import DESCRIPTION, SCRIPTS, SLAVES, build_options, guid_of, write
from .arrays import arrays
from .documents import documents
from .native_tables import header
from .universal import universal

HEADERS = Path(find_spec("fmpy").origin).with_name("c-code")  # FMI's own, under the 2-clause BSD licence
TERMINALS = "terminalsAndIcons/terminalsAndIcons.xml"
SYSTEMS_OF_FMI2 = {"linux": "linux64", "windows": "win64", "darwin": "darwin64"}


def build(name, folder, segments=20, shape_points=21, platforms=None, scene=None, starts=(), fmi=2):
    """Build one native FMU and return its path; RuntimeError if a compiler or the linker fails.

    The arguments are those of `archive.build`; fmi : version, 2 or 3.
    """
    folder, platforms = Path(folder), platforms or [this_platform()]
    folder.mkdir(parents=True, exist_ok=True)
    script, variant = SLAVES[name]
    options = build_options(segments, shape_points, scene, starts)
    table = table_of(variant, options)
    about = " ".join(filter(None, [runpy.run_path(str(SCRIPTS / script))[name].description, options.get("about")]))
    library = library_of(variant)
    compiled = ready.folders([library], platforms)[library]
    kernels = {platform: (compiled / object_name(platform)).read_bytes() for platform in platforms}
    files = documents(name, variant, about, options, platforms, scene.page if scene else None, native=fmi)

    widths = None
    if fmi == 3:
        widths = {array.reference: len(array.variables) for array in arrays(table, shape_points)}
        files[TERMINALS] = native_description_fmi3.terminals(table).encode("utf-8")
    writer = native_description_fmi3 if fmi == 3 else native_description

    def description(token):
        step = (DEFAULT_OPTIONS | options)["step"]
        return writer.text(name, about, table, shape_points, step, token)

    tables = header(variant, table, shape_points, "", widths)
    sources = {f"{path.name} of the shell": path.read_bytes() for path in sorted(SHELL.glob("*.[ch]"))}
    made_of = {**files, **sources, **kernels, "tables": tables.encode("utf-8")}
    token = guid_of(description(""), made_of)
    tables = header(variant, table, shape_points, token, widths)
    files[DESCRIPTION] = description(token).encode("utf-8")
    files |= binaries(name, kernels, tables, fmi)
    return write(files, folder, name, scene)


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
