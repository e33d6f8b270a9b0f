"""The folder `sources` of a native FMU: the C shell and the kernels as C, to be compiled for any processor.

One file, `fmu.c`, includes all others, so that a compiler needs only its name.
"""

import re
from xml.etree.ElementTree import Element, SubElement

from tetherfmu.libraries.c_kernels import c_kernels
from tetherfmu.libraries.native_shell import PARTS, SHELL
from tetherfmu.runtime.limits import MAX_SEGMENTS

from ..texts import filled, xml_text

FOLDER = "sources"
FILE = "fmu.c"
NOT_IN_C = {"has_avx": None, "room": "room_in_c"}  # parts of the shell that are omitted or replaced
DATA = ("AN_INSTANCE", "A_SAVED_STATE", "CATEGORY")
PROTOTYPE = re.compile(r"^(?!static|typedef|extern)\w[\w *]*?(\w+)\([^;]*\);", re.MULTILINE)


def sources(name, library, tables, room, fmi, headers):
    """Files of the folder: dict of path in the archive to bytes; RuntimeError if the kernels cannot be generated.

    name : of the FMU.  library : of its kernels.  tables : text of `tables.h`.  room : text of `tables.room_of`.
    fmi : 2 or 3.  headers : folder with the FMI headers.
    """
    parts = [NOT_IN_C.get(part, part) for part in (*PARTS, f"fmi{fmi}") if NOT_IN_C.get(part, part)]
    included = "\n".join(f'#include "{part}.c"' for part in parts)
    texts = {FILE: filled(FILE, name=name, fmi=fmi, segments=MAX_SEGMENTS, parts=included)}
    texts |= {"CMakeLists.txt": filled("CMakeLists.txt", name=name), "names.h": names(), "tables.h": f"{tables}{room}"}
    if fmi == 3:
        texts["buildDescription.xml"] = build_description(name)
    found = {file: text.encode("utf-8") for file, text in texts.items()}
    taken = [SHELL / f"{part}.c" for part in parts] + sorted(SHELL.glob("*.h")) + sorted(headers.glob(f"fmi{fmi}*.h"))
    found |= {path.name: path.read_bytes() for path in (*taken, c_kernels(library))}
    return {f"{FOLDER}/{file}": content for file, content in found.items()}


def names():
    """Text of a header that prefixes all functions of the shell with the prefix or the name of the FMU."""
    found = [each for path in sorted(SHELL.glob("*.h")) for each in PROTOTYPE.findall(path.read_text(encoding="utf-8"))]
    listed = sorted({*found, *DATA} - {"KERNEL"})
    return "\n".join(
        ["/* Names that no other FMU in the same program has. */", *(f"#define {each} OWN({each})" for each in listed), ""]
    )


def build_description(name):
    """Text of buildDescription.xml, which FMI 3 has."""
    root = Element("fmiBuildDescription", fmiVersion="3.0")
    configuration = SubElement(root, "BuildConfiguration", modelIdentifier=name)
    files = SubElement(configuration, "SourceFileSet", language="C99")
    SubElement(files, "SourceFile", name=FILE)
    SubElement(files, "IncludeDirectory", name=".")
    SubElement(configuration, "Library", name="m", external="true", description="mathematical library of C")
    return xml_text(root)
