"""The kernels of all variants as one WebAssembly file, for a browser.

It exports the entry points of each variant (`kernels/entry_points.py`) by the names of the libraries, such as
`dynamic_advance`, and `__heap_base`, the first address that is free. It imports a memory and functions of mathematics
(`IMPORTS`). Counts are 64-bit integers, arrays 32-bit addresses of numbers in the memory.

numba writes the functions of all variants in one go, so that what variants share is in the file once.

    python -m tetherfmu.libraries.webassembly FILE [PLATFORM,... VARIANT=FOLDER ...]     run by `browser_file`

writes the libraries of variants, too, as `ahead_of_time` does: numba then need not write the functions again.
"""

import re
import sys
import tempfile
from hashlib import sha256
from pathlib import Path

from tetherfmu.runtime.variants import VARIANTS

from . import ahead_of_time, llvm_modules, ready
from .intermediate_code import Code
from .linking import MATHEMATICS, zig
from .llvm_modules import Target
from .sources import code_in, digest

FILE = "tetherfmu.wasm"
INSTRUCTIONS = {"sqrt", "ceil"}  # of WebAssembly itself
IMPORTS = tuple(name for name in MATHEMATICS if name not in INSTRUCTIONS)
TARGET = Target("wasm32-unknown-unknown", "generic")
FEATURES = "+bulk-memory,+bulk-memory-opt,+sign-ext,+nontrapping-fptoint"
LANES = "+simd128"  # two numbers in one instruction
OVERFLOW = "llvm.umul.with.overflow.i64"
# LLVM asks before some loops whether a product is too large for 64 bits; WebAssembly would ask for a product of 128 bits
CHECKED_PRODUCT = """
define internal {i64, i1} @checked_product(i64 %a, i64 %b) {
  %product = mul i64 %a, %b
  %divisor = call i64 @llvm.umax.i64(i64 %a, i64 1)
  %largest = udiv i64 -1, %divisor
  %overflows = icmp ugt i64 %b, %largest
  %first = insertvalue {i64, i1} poison, i64 %product, 0
  %both = insertvalue {i64, i1} %first, i1 %overflows, 1
  ret {i64, i1} %both
}
"""


def browser_file():
    """Path of the WebAssembly file of all variants, in lanes; compiled if it is missing.

    RuntimeError if compiling fails, or what compiles is missing.
    """
    path = _place()
    if not path.exists():
        print("compiling the kernels for the browser, once", file=sys.stderr, flush=True)
        ready.run("webassembly", [str(path)], path.parents[1])
    return path


def with_libraries():
    """`browser_file`, and the libraries of all variants for all platforms; missing ones are compiled together."""
    path = _place()
    ready.folders(ready.LIBRARIES, list(ahead_of_time.TARGETS), None if path.exists() else path)
    return browser_file()


def _place():
    return place_of("webassembly", FILE, VARIANTS, [__file__])


def place_of(name, file, variants, recipe):
    """Path of a file made from the kernels of variants: in the wheel, or else in the cache.

    The name of its folder contains a hash of its sources; recipe : paths of the modules that make it.
    """
    texts = [*map(digest, variants), *(code_in(Path(each)) for each in recipe)]
    folder = f"{name}_{sha256(''.join(texts).encode('utf-8')).hexdigest()[:12]}"
    in_wheel = ready.IN_WHEEL / folder / file
    return in_wheel if in_wheel.exists() else ready.cache_folder() / folder / file


def object_file(text, exported, features=FEATURES):
    """Bytes of an object file for WebAssembly.

    text : of a module as `ahead_of_time` keeps it.  exported : names of functions.
    """
    import llvmlite.binding as llvm

    machine = llvm_modules.machine_of(TARGET, features=features, reloc="static", codemodel="default")
    module = llvm_modules.for_target(_with_instructions(text), TARGET, machine)
    llvm_modules.optimize(module, machine, level=3)
    llvm_modules.check_names(module, exported)
    return machine.emit_object(llvm.parse_assembly(_without_large_products(str(module))))


def linked(content, exported, stack=65536):
    """Bytes of a WebAssembly file; content : bytes of its object file.  stack : its size, in bytes."""
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        (folder / "kernels.o").write_bytes(content)
        (folder / "imports").write_text("\n".join(IMPORTS))
        options = ["--no-entry", "--import-memory", "--allow-undefined-file=imports", "--strip-all", "--gc-sections"]
        options += [f"--export={name}" for name in (*exported, "__heap_base")]
        zig(folder, "wasm-ld", *options, "-z", f"stack-size={stack}", "-o", FILE, "kernels.o")
        return (folder / FILE).read_bytes()


def _small(text):
    """Intermediate code without loop unrolling that only lengthens it: a browser has to download the file."""
    return re.sub(r"^(define .*\)[^{]*) \{$", r"\1 optsize {", text, flags=re.MULTILINE)


def _with_instructions(text):
    """Intermediate code with instructions in place of functions of mathematics."""
    for name in INSTRUCTIONS:
        text = re.sub(rf"^declare double @{name}\(.*$", f"declare double @llvm.{name}.f64(double)", text, flags=re.MULTILINE)
        text = text.replace(f"@{name}(", f"@llvm.{name}.f64(")
    return _declared_once(text)


def _without_large_products(text):
    """Intermediate code without 128-bit products."""
    if f"@{OVERFLOW}(" not in text:
        return text
    text = re.sub(rf"^declare .*@{re.escape(OVERFLOW)}\(.*$", "", text, flags=re.MULTILINE)
    text = text.replace(f"@{OVERFLOW}(", "@checked_product(")
    return _declared_once(f"{text}{CHECKED_PRODUCT}declare i64 @llvm.umax.i64(i64, i64)\n")


def _declared_once(text):
    """Intermediate code without the repeated declarations of a function."""
    declared = set()

    def first(found):
        repeated = found[1] in declared
        declared.add(found[1])
        return "" if repeated else found[0]

    return re.sub(r"^declare [^@]*@([\w.]+)\(.*$", first, text, flags=re.MULTILINE)


def write(path, codes):
    """Write the file for browsers; codes : `intermediate_code.Code` of each variant; equal texts are stored once.

    A page steps and shows no energies: what it does not call is left out.
    """
    idle = {f"{variant}_{verb}" for variant in VARIANTS for verb in ("fly", "energy")}
    exported = [name for variant in VARIANTS for name in ahead_of_time.names_of(variant) if name not in idle]
    texts = dict.fromkeys(text for code in codes for text in code.texts)
    names = {name: entry for code in codes for name, entry in code.names.items() if entry in exported}
    text = str(llvm_modules.whole_module(Code(list(texts), names), llvm_modules.RARE + llvm_modules.IN_A_BROWSER))
    content = linked(object_file(_small(text), exported, f"{FEATURES},{LANES}"), exported)
    path.parent.mkdir(exist_ok=True)
    ahead_of_time.write(path, content)
    return f"{path.name}, {len(content) // 1000} kB,"


def main(arguments):
    """Write the file for browsers, after libraries if there are any to be written."""
    path, *libraries = arguments
    written = (write, Path(path))
    ahead_of_time.main(libraries or [""], lambda: (*written, list(map(ahead_of_time.code_of, VARIANTS))))


if __name__ == "__main__":
    from tetherfmu.libraries.webassembly import main  # other processes import their task by this name

    main(sys.argv[1:])
