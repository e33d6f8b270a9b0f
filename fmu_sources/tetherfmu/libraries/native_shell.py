"""The shared library of a native FMU: the C shell in `runtime/native`, compiled for its variables, linked with the kernels.

The C compiler inside the package `ziglang` compiles it for every platform; the package contains the C library headers,
no C library is built. Nothing is cached: it needs a tenth of a second.
"""

import tempfile
from pathlib import Path

from .linking import KERNELS_NEED, compile_c, link
from .sources import PACKAGE

SHELL = PACKAGE / "runtime" / "native"
PARTS = ("has_avx", "room", "messages", "sentences", "polygons", "arrays", "saved_state", "derivatives", "instance")
OF_WINDOWS = ("__stdio_common_vsprintf", "__acrt_iob_func")  # replace vsnprintf and stderr
NEEDED = {
    ("libm.so.6", "math"): (*KERNELS_NEED["libm.so.6", "math"], "floor"),
    ("libc.so.6", "string"): ("memset", "strcmp", "strcspn", "strlen"),
    ("libc.so.6", "private"): ("memcpy", "memcmp", "bcmp", "strchr"),  # LLVM makes bcmp of memcmp
    ("libc.so.6", "heap"): ("calloc", "free"),
    ("libc.so.6", "convert"): ("strtod", "strtol"),
    ("libc.so.6", "stdio"): ("vsnprintf", "fputs", "stderr", *OF_WINDOWS),
}
OPTIONS = (
    *("-Os", "-fno-inline-functions"),  # compiles in half the time of -O2, and a step takes its time in the kernels
    *("-std=c99", "-g0", "-fPIC", "-fvisibility=hidden", "-fno-stack-protector", "-ffp-contract=off"),
    *("-Wall", "-Wextra", "-Wno-unused-parameter", "-Wno-cast-function-type", "-Werror"),
)


def unit(fmi):
    """The C file that is compiled: all of the shell at once, with the functions of FMI 2 or 3."""
    return "".join(f'#include "{part}.c"\n' for part in (*PARTS, f"fmi{fmi}"))


def native_library(kernels, library, platform, tables, fmi, headers, exported):
    """Bytes of the shared library of a native FMU; RuntimeError with the compiler's words if it fails.

    kernels : object file (bytes) of the kernels for the platform.  library : file name of the result.  tables : text of
    `tables.h`.  fmi : 2 or 3.  headers : folder with FMI's headers.  exported : names of the functions of FMI.
    """
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        (folder / "tables.h").write_text(tables, encoding="utf-8")
        (folder / "unit.c").write_text(unit(fmi), encoding="utf-8")
        places = (f"-I{folder}", f"-I{SHELL}", f"-I{headers}")
        shell = compile_c(folder, "unit.c", platform, (*OPTIONS, *places))
    marked = platform.endswith("windows")  # by the headers
    return link([shell, kernels], library, platform, () if marked else exported, NEEDED)
