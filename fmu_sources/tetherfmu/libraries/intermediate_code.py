"""The intermediate code of the entry points, by a numba with some internals replaced, `write_only`.

By default numba links, optimizes and compiles each function with copies of all its callees, because Python may call it
immediately: two thirds of the time. Python calls none of these; `ahead_of_time.py` does this once, at the end. Replaced:

- `JITCPUCodegen._library_class`, the compilation result of a function: it stores its text and its callees;
- `JITCPUCodegen.set_env`, which writes an address into machine code: there is none;
- `Function.get_call_type`: numba infers at each place the result type of an operator or function of plain numbers; caching
  saves a fifth of the time.

This requires a separate process: nothing compiled there can be called. The internals are those of numba.core,
`codegen` and `types.functions`, of the versions in `ready.TESTED`.
"""

import gc
from functools import cache
from importlib import import_module
from time import monotonic
from typing import NamedTuple

from tetherfmu.runtime.kernel_library import SYSTEM

PAUSE = 15.0  # s between lines of progress
being_written = []  # variants, in this process


class Code(NamedTuple):
    """Code to be linked and optimized for a variant."""

    texts: list  # intermediate code
    names: dict  # name of each entry point there: name under which the library has it


@cache
def write_only():
    """Change numba in this process: it writes intermediate code and no machine code. Call it before kernels are imported."""
    from numba.core import codegen

    tell_progress(keep_texts())
    codegen.JITCPUCodegen.set_env = lambda self, name, environment: None
    gc.disable()  # nearly all objects live until the end


def keep_texts():
    """Make numba in this process keep the texts of functions; returns its library class, without addresses."""
    from numba.core import cgutils, codegen, types
    from numba.core.types.functions import Function

    class Library(codegen.JITCodeLibrary):
        def __init__(self, owner, name):
            codegen.CodeLibrary.__init__(self, owner, name)
            self._linking_libraries, self.texts = [], []

        def add_ir_module(self, module):
            self.texts.append(cgutils.normalize_ir_text(str(module)))

        def finalize(self):
            self._finalized = True

        def get_pointer_to_function(self, name):
            return 0

    ask = Function.get_call_type
    known = cache(lambda function, context, args: ask(function, context, args, {}))

    def get_call_type(self, context, args, kws):
        plain = (isinstance(each, types.Number | types.Boolean) and not isinstance(each, types.Literal) for each in args)
        return ask(self, context, args, kws) if kws or not all(plain) else known(self, context, tuple(args))

    codegen.JITCPUCodegen._library_class = Library
    Function.get_call_type = get_call_type
    return Library


def tell_progress(library):
    """Make a library class (modified) print every `PAUSE` s how many functions are written."""
    finalize, written, told = library.finalize, 0, monotonic()

    def finalize_and_tell(self):
        nonlocal written, told
        finalize(self)
        written += 1
        if monotonic() - told > PAUSE:
            told = monotonic()
            print(f"{being_written[-1]}: {written} functions written", flush=True)

    library.finalize = finalize_and_tell


@cache
def code_of(variant):
    """`Code` of the entry points of a variant; SYSTEM needs its own process, as its kernels know `compilation.PARTS`."""
    write_only()
    being_written.append(variant)
    from tetherfmu.kernels import compilation

    compilation.PARTS = variant == SYSTEM
    compilation.OPTIONS |= {"no_cpython_wrapper": True, "_nrt": False}  # Python calls none of these, and they own no arrays
    functions = import_module("tetherfmu.libraries.just_in_time").compiled(variant)
    texts = {}  # without repetition, callees first
    for function in functions.values():
        library = function._library
        texts |= dict.fromkeys(texts_below(library))
    return Code(list(texts), {function._wrapper_name: f"{variant}_{verb}" for verb, function in functions.items()})


def texts_below(library):
    """Texts of a library of numba and of all its callees, callees first; without numba's own runtime."""
    from numba.core.runtime.nrt import rtsys

    seen, found = {rtsys._library}, []

    def visit(each):
        if each not in seen:
            seen.add(each)
            for callee in each._linking_libraries:
                visit(callee)
            found.extend(each.texts)

    visit(library)
    return found
