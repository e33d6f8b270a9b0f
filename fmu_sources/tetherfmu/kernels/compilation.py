"""Compilation of kernels by numba, without exceptions or allocation. Additions to numba: `by_kind`, `power`, `flat_arrays`.

Rules of a kernel, so that its machine code is independent of Python: arguments are numbers, tuples and flat
arrays; work space comes from the caller; a failure is a status code; other kernels are called by name only. Nothing
is allocated, raised or received as a function.
"""

from functools import partial

from llvmlite import ir
from numba import cfunc, njit, types
from numba.core import cgutils
from numba.core.compiler import CompilerBase, DefaultPassBuilder
from numba.core.targetconfig import ConfigStack
from numba.extending import intrinsic, overload

PARTS = True  # whether kernels know lines in two parts (`equations/parts.py`) and portions, which a single tether never is
OPTIONS = {"error_model": "numpy", "no_cfunc_wrapper": True}  # `entry_point` still has a C wrapper
WITHOUT = {  # passes of numba for features that kernels lack: closures, inlined functions, array expressions
    "WithLifting",
    "InlineClosureLikes",
    "RewriteDynamicRaises",
    "MakeFunctionToJitFunction",
    "InlineInlinables",
    "FindLiterallyCalls",
    "LiteralUnroll",
    "LiteralPropagationSubPipelinePass",
    "InlineOverloads",
    "NopythonRewrites",
    "NoPythonSupportedFeatureValidation",
    "AnnotateTypes",
    "DumpParforDiagnostics",
}


class KernelCompiler(CompilerBase):
    """numba's compiler without the passes that have no effect on kernels: an eighth of the time."""

    def define_pipelines(self):
        """Passes of numba, in a list of one pipeline.

        A callee inherits options that it does not set from its first caller, and an overload, such as `max`, is
        compiled for each set of options of its callers. Inlining of a `view` is hidden from its callees, so
        that the code of a function does not depend on earlier compilations.
        """
        ConfigStack.top_or_none().forceinline = False
        pipeline = DefaultPassBuilder.define_nopython_pipeline(self.state)
        pipeline.passes = [each for each in pipeline.passes if each[0].__name__ not in WITHOUT]
        pipeline.finalize()
        return [pipeline]


def kernel(function):
    """Compile a function for other kernels (and for tests) at its first call, once for all constants of a kind."""
    compiled = njit(pipeline_class=KernelCompiler, **OPTIONS)(function)
    if compiled is not function:  # identical if numba is disabled
        compiled.get_call_template = partial(_template_for_any_constant, compiled.get_call_template)
    return compiled


def _template_for_any_constant(template_for, args, kws):
    return template_for(tuple(map(types.unliteral, args)), {name: types.unliteral(kind) for name, kind in kws.items()})


def view(function):
    """Compile a kernel that is always inlined, anew for each constant that it is called with, and may return arrays."""
    return njit(pipeline_class=KernelCompiler, forceinline=True, **OPTIONS)(function)


def entry_point(signature, function):
    """Compile a function that takes numbers and pointers, to a `numba.CFunc`."""
    return cfunc(signature, pipeline_class=KernelCompiler, **OPTIONS)(function)


def by_kind(of_tuple, of_array):
    """A kernel of two arguments: `of_tuple` if the first one is a tuple, `of_array` if it is an array.

    The choice is made at compile time, and so are constants that `of_tuple` returns regardless of the argument.
    """

    def either(first, second):
        return of_array(first, second)

    @overload(either)
    def choose(first, second):
        chosen = of_tuple if isinstance(first, types.BaseTuple) else of_array
        return lambda first, second: chosen(first, second)

    return either


@intrinsic
def power(typing, base, exponent):
    """base**exponent by `pow` of the C library, like Python, even for an exponent known at compile time.

    The compiler would turn x**2 into x*x, which differs in the last bit in one of some 1000 cases.
    """

    def code(context, builder, signature, values):
        double = ir.DoubleType()
        function = cgutils.get_or_insert_function(builder.module, ir.FunctionType(double, (double, double)), "pow")
        function.attributes.add("nobuiltin")
        return builder.call(function, values)

    return types.float64(types.float64, types.float64), code
