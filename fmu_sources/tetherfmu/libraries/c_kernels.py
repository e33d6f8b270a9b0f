"""The kernels of a library as one C99 file, for processors without a compiled library.

LLVM compiles them for WebAssembly, without lanes, and `c_code.py` translates that to C. All operations are those of the
library, in the same order: with the same mathematical functions the numbers are identical to the last bit.

    python -m tetherfmu.libraries.c_kernels LIBRARY PATH     run by `c_kernels`
"""

import gzip
import re
import sys
from pathlib import Path

from tetherfmu.runtime.kernel_library import this_platform, verbs

from . import ahead_of_time, c_code, c_function, c_operations, ready, wasm_file, webassembly

FILE = "kernels.c"
RECIPE = [c_code.HEAD, *(module.__file__ for module in (c_code, c_function, c_operations, wasm_file, webassembly))]
NOT_IN_FMUS = {"fly", "energy"}  # entry points of the Python API
ALIGNED = 16


def c_kernels(library):
    """Path of the C file of a library; made if it is missing.

    The functions that the shell calls are `in_c_pack` and so on; RuntimeError if compiling fails, or what compiles is
    missing.
    """
    path = webassembly.place_of(f"c_{library}", FILE, [library], [__file__, *RECIPE])
    if not path.exists():
        print(f"writing the kernels of {library} as C, once", file=sys.stderr, flush=True)
        ready.run("c_kernels", [library, str(path)], path.parents[1])
    return path


def text_of(code, library):
    """Text of the C file; code : intermediate code of the library, as `ahead_of_time` keeps it."""
    names = {f"{library}_{verb}": f"in_c_{verb}" for verb in verbs(library) if verb not in NOT_IN_FMUS}
    for name in {*ahead_of_time.names_of(library)} - names.keys():
        code = re.sub(rf"^define (?=\w+ @{name}\()", "define internal ", code, flags=re.MULTILINE)
    content = webassembly.object_file(code, names)
    stack = -(-c_code.stack_size(webassembly.linked(content, names)) // ALIGNED) * ALIGNED
    return c_code.text(webassembly.linked(content, names, stack), names)


def main(arguments):
    """Write the C file of a library."""
    library, path = arguments[0], Path(arguments[1])
    folder = ready.compiled_in(ready.cache_folder(), [library], [this_platform()])[library]
    text = text_of(gzip.decompress((folder / ahead_of_time.CODE).read_bytes()).decode(), library)
    path.parent.mkdir(exist_ok=True)
    ahead_of_time.write(path, text.encode("ascii"))
    print(f"{len(text) // 1000} kB", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
