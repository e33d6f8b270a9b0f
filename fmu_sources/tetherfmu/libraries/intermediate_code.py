"""The intermediate code of the entry points: numba's own way, and a fast one that changes numba's internals.

numba's own way optimizes each function with all that it calls, makes machine code of it, and does that again for its caller:
two thirds of the time. The fast way keeps the text of each function, written once; all texts are linked and optimized once
at the end (`ahead_of_time.py`). Both are for a process of their own: nothing that is compiled there can be called.

Source of the internals: `codegen`, `cpu`, `types.functions` and `typing.templates` of numba.core, of
the versions in `ready.TESTED`.
"""

import gc
from functools import cache
from importlib import import_module
from typing import NamedTuple


class Code(NamedTuple):
    """What is to be linked and optimized for a variant."""

    texts: list  # intermediate code
    names: dict  # name of each entry point there: name under which the library has it


@cache
def write_only():
    """Change numba in this process: it writes intermediate code and no machine code. Call it before kernels are imported."""
    from numba.core import codegen

    keep_texts()
    library = codegen.JITCodeLibrary
    library.enable_object_caching = lambda self: None
    library.get_pointer_to_function = lambda self, name: 0
    codegen.JITCPUCodegen.set_env = lambda self, name, environment: None
    gc.disable()  # nearly all lives until the end


def keep_texts():
    """Let the libraries of numba in this process keep the text of their functions, and nothing else, until it is linked."""
    from numba.core import cgutils, codegen

    def start(self, owner, name):
        codegen.CodeLibrary.__init__(self, owner, name)
        self._linking_libraries = []
        self.texts = []

    def add_ir_module(self, module):
        self.texts.append(cgutils.normalize_ir_text(str(module)))

    def finalize(self):
        self._finalized = True

    library = codegen.JITCodeLibrary
    library.__init__ = start
    library.add_ir_module = add_ir_module
    library.finalize = finalize
    _remember_operators()
    _forget_callers()


def _forget_callers():
    """Let the code of a function not depend on its first caller, and so on what was compiled before.

    numba inlines a function by force if its first caller is inlined so, and compiles an overload, such as `min`, once for
    each set of flags that its callers have; all of them then call the latest.
    """
    from numba.core.cpu import CPUTargetOptions
    from numba.core.typing.templates import _OverloadFunctionTemplate

    finalize = CPUTargetOptions.finalize

    def finalize_alone(self, flags, options):
        if not flags.is_set("forceinline"):
            flags.forceinline = False
        finalize(self, flags, options)

    def get_impl(self, args, kws):
        key = self.context, tuple(args), tuple(kws.items())
        return self._impl_cache[key] if key in self._impl_cache else self._build_impl(key, args, kws)

    CPUTargetOptions.finalize = finalize_alone
    _OverloadFunctionTemplate._get_impl = get_impl


def _remember_operators():
    """Ask numba once, not each time, what an operator or function of plain numbers returns: a fifth of the time."""
    from numba.core import types
    from numba.core.types.functions import Function

    ask, known = Function.get_call_type, {}

    def is_plain(kind):
        return isinstance(kind, types.Number | types.Boolean) and not isinstance(kind, types.Literal)

    def get_call_type(self, context, args, kws):
        if kws or not all(map(is_plain, args)):
            return ask(self, context, args, kws)
        key = (self, tuple(args))
        if key not in known:
            known[key] = ask(self, context, args, kws)
        return known[key]

    Function.get_call_type = get_call_type


def code_of(variant, fast):
    """`Code` of the entry points of a variant; fast : whether `write_only` was called in this process."""
    from tetherfmu.kernels import compilation

    compilation.OPTIONS |= {"no_cpython_wrapper": True, "_nrt": False}  # Python calls none of these, and they own no arrays
    functions = import_module("tetherfmu.libraries.just_in_time").compiled(variant)
    texts = {}  # without repetition, callees first
    for function in functions.values():
        library = function._library
        texts |= dict.fromkeys(texts_below(library) if fast else [library.get_llvm_str()])
    return Code(list(texts), {function._wrapper_name: f"{variant}_{verb}" for verb, function in functions.items()})


def texts_below(library):
    """Texts of a library of numba and of all that it calls, callees first; without those of numba's own runtime."""
    from numba.core.runtime.nrt import rtsys

    seen, found = {id(rtsys._library)}, []

    def visit(each):
        if id(each) not in seen:
            seen.add(id(each))
            for callee in each._linking_libraries:
                visit(callee)
            found.extend(each.texts)

    visit(library)
    return found
