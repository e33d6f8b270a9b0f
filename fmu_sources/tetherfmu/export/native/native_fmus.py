"""Assemble native FMUs: no Python in them, one library for each platform that has the C shell and the kernels in it.

The shell is compiled for the variables of the FMU, so it reads no file when it runs.
"""

import re
import struct
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from typing import NamedTuple

from tetherfmu.fmi.resources import DEFAULT_OPTIONS
from tetherfmu.libraries import ready
from tetherfmu.libraries.ahead_of_time import object_name
from tetherfmu.libraries.native_shell import SHELL, native_library
from tetherfmu.runtime.kernel_library import SUFFIXES
from tetherfmu.wiring.fmu import Wiring, of_tether

from ..archive import DESCRIPTION, SLAVES, guid_of, write
from ..build_options import BuildOptions
from ..documents import documents
from ..rehearsal import check_start
from . import description, description_fmi3, host_header, source_folder
from .c_tables import header, room_of

HEADERS = Path(find_spec("fmpy").origin).with_name("c-code")  # FMI's own, under the 2-clause BSD licence
MAGIC, PAGE_BITS = 0xCAFEBABE, 14  # of Apple's mach-o/fat.h; libraries begin at multiples of 16 kB, the larger page
TERMINALS = "terminalsAndIcons/terminalsAndIcons.xml"
SYSTEMS_OF_FMI2 = {"linux": "linux64", "windows": "win64", "darwin": "darwin64"}


class Model(NamedTuple):
    """The model in a native FMU."""

    name: str
    about: str  # its description
    wiring: Wiring
    terminals: str  # text of terminalsAndIcons.xml, for FMI 3
    times: tuple  # communication step and stop time of the default experiment [s]


def build(name, folder, options=None, fmi=2, with_header=None, with_sources=False):
    """Build one native FMU and return its path; RuntimeError if a compiler or the linker fails.

    Arguments as for `archive.build`; fmi : version, 2 or 3.  with_header, with_sources : as for `written`.
    """
    options = options or BuildOptions()
    variant = SLAVES[name]
    given = DEFAULT_OPTIONS | options.of_slave(variant)
    check_start(variant, given)
    about, wiring = options.description_of(variant), of_tether(variant, given)
    terminals = description_fmi3.terminals(wiring.shown)
    model = Model(name, about, wiring, terminals, (given["step"], given["stop"]))
    files = documents(name, variant, about, options, given, native=fmi)
    return written(files, model, folder, options.platforms, fmi, with_header, with_sources, options.purpose)


def written(files, model, folder, platforms, fmi, with_header=None, with_sources=False, purpose=None):
    """Write a native FMU to a folder, created if missing; returns its path.

    files : other than the model, dict of path in the archive to bytes (modified).  model : `Model`.  platforms : as in
    `BuildOptions`.  with_header : prefix of the names in a C header for hosts that is written beside it, None
    for no header, see `host_header`.  with_sources :
    whether its importer can also compile the FMU, see `sources`.
    """
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    wiring = model.wiring
    compiled = ready.folders([wiring.library], platforms)[wiring.library]
    kernels = {platform: (compiled / object_name(platform)).read_bytes() for platform in platforms}
    if fmi == 3:
        files[TERMINALS] = model.terminals.encode("utf-8")
    describe = partial((description_fmi3 if fmi == 3 else description).text, model)
    listed = (source_folder.FILE,) if with_sources else ()
    shell = {path.name: path.read_bytes() for path in SHELL.glob("*.[ch]")}
    hashed = {**files, **shell, **kernels, "tables.h": header(wiring, fmi, "").encode("utf-8")}
    token = guid_of(describe("", listed), hashed)
    tables = header(wiring, fmi, token)
    files[DESCRIPTION] = describe(token, listed).encode("utf-8")
    files |= binaries(model.name, kernels, tables, fmi)
    if with_sources:
        room = room_of(ready.kernels(wiring.library), wiring)
        files |= source_folder.sources(model.name, wiring.library, tables, room, fmi, HEADERS)
    made = write(files, folder, model.name, purpose)
    if with_header:
        host_header.write(made, model.name, wiring, fmi, token, with_header)
    return made


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


def universal(libraries):
    """Bytes of a universal library of macOS, from which the system loads the part for its processor.

    libraries : bytes, each for one processor; they are unchanged and signed.
    """
    page = 1 << PAGE_BITS
    head, body = struct.pack(">2I", MAGIC, len(libraries)), b""
    for library in libraries:
        body += b"\0" * (-len(body) % page)
        head += struct.pack(">5I", *struct.unpack_from("<2I", library, 4), page + len(body), len(library), PAGE_BITS)
        body += library
    return head.ljust(page, b"\0") + body
