"""numba for tests that call kernels: machine code is made of what Python calls and of nothing else, in half the time.

numba optimizes each function with all that it calls, makes machine code of it and of two wrappers, and does that again for
its caller. Here its libraries keep the text of their functions, as in `libraries.intermediate_code`. When Python calls a
kernel, it is linked with all that it needs, optimized and compiled once, for this very processor; and so are all entry
points together when Python asks for the address of one.
References to arrays are not counted: an array that a test gives to a kernel lives until the end.
"""

import gc
from contextlib import contextmanager

from numba.core import ccallback, codegen, cpu, dispatcher, registry
from numba.core.runtime.context import NRTContext
from numba.core.runtime.nrt import rtsys

from tetherfmu.libraries.intermediate_code import keep_texts, texts_below
from tetherfmu.libraries.llvm_modules import as_one_module, optimize


class _Caller:
    """Who calls what numba compiles now."""

    is_python = False


_waiting = {}  # names of entry points whose machine code nobody has asked for yet, and their libraries


@contextmanager
def _for_python():
    _Caller.is_python = True
    try:
        yield
    finally:
        _Caller.is_python = False


def make_code_late():
    """Change numba in this process, before it compiles any kernel."""
    rtsys.initialize(registry.cpu_target.target_context)
    rtsys.library._ensure_finalized()  # numba's own functions are compiled as ever
    keep_texts().get_pointer_to_function = _get_pointer_to_function
    NRTContext.incref = NRTContext.decref = lambda self, builder, kind, value: None
    codegen.JITCPUCodegen.set_env = _where_code_is(codegen.JITCPUCodegen.set_env)
    cpu.CPUContext.create_cpython_wrapper = _where_python_calls(cpu.CPUContext.create_cpython_wrapper)
    ccallback.CFunc.address = property(_address)
    dispatcher.Dispatcher.add_overload = _add_overload
    dispatcher.Dispatcher._compile_for_args = _compile_for_args


def _where_python_calls(create_cpython_wrapper):
    def create(self, *arguments, **options):
        if _Caller.is_python:
            create_cpython_wrapper(self, *arguments, **options)

    return create


def _where_code_is(set_env):
    def set_or_leave(self, name, environment):
        if self._engine.is_symbol_defined(name):
            set_env(self, name, environment)

    return set_or_leave


def _add_overload(self, compiled):
    """Keep what other kernels call; Python cannot call it."""
    self.overloads[tuple(compiled.signature.args)] = compiled


def _compile_for_args(self, *arguments):
    """Compile a kernel for arguments that Python gives: with all that it calls, then once more with a wrapper."""
    kinds = tuple(map(self.typeof_pyval, arguments))
    gc.disable()  # nearly all that numba makes lives on
    try:
        self.compile(kinds)
        with _for_python():
            compiled = self._compiler.compile(kinds, None)
    finally:
        self._types_active_call.clear()
        gc.enable()
    self._insert([kind._code for kind in kinds], compiled.entry_point, compiled.objectmode)
    return compiled.entry_point


def _get_pointer_to_function(self, name):
    """Address of a function of a library, compiled now; 0 for an entry point, and for one that only kernels call."""
    if name.startswith("cfunc."):
        _waiting[name] = self
        return 0
    if not _Caller.is_python:
        return 0
    _make_code({name: self})
    return self._codegen._engine.get_function_address(name)


def _address(self):
    """Address of an entry point, with which all that wait are compiled."""
    if _waiting:
        _make_code(_waiting)
        _waiting.clear()
    return self._library._codegen._engine.get_function_address(self._wrapper_name)


def _make_code(functions):
    """Link, optimize and compile functions, names and libraries, with all that they call."""
    texts = dict.fromkeys(text for library in functions.values() for text in texts_below(library))
    module = as_one_module(texts)
    for function in module.functions:
        if not function.is_declaration and function.name not in functions:
            function.linkage = "internal"
    module.link_in(rtsys.library._get_module_for_linking(), preserve=True)
    code = next(iter(functions.values()))._codegen
    optimize(module, code._tm, level=1)
    code._add_module(module)
    code._engine.finalize_object()
