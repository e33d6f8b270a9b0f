"""How kernels are compiled: by numba, without exceptions or allocation. What numba lacks: `by_kind`, `power`, `flat_arrays`.

Rules of a kernel, so that its machine code can stand alone without Python: arguments are numbers, tuples and flat
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

OPTIONS = {"error_model": "numpy", "no_cfunc_wrapper": True}  # which `entry_point` has all the same
WITHOUT = {  # passes of numba for what no kernel has: closures, inlined functions, expressions of whole arrays
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
    """numba's compiler without the passes that change nothing in a kernel: an eighth of the time."""

    def define_pipelines(self):
        """Passes of numba, in a list of one pipeline.

        What a kernel calls inherits options that it does not set from its first caller, and an overload, such as `max`, is
        compiled for each set of options that its callers have. That a `view` is inlined is hidden from what it calls, so
        that the code of a function does not depend on what was compiled before.
        """
        ConfigStack.top_or_none().forceinline = False
        pipeline = DefaultPassBuilder.define_nopython_pipeline(self.state)
        pipeline.passes = [each for each in pipeline.passes if each[0].__name__ not in WITHOUT]
        pipeline.finalize()
        return [pipeline]


def kernel(function):
    """Compile a function for other kernels (and for tests) at its first call, once for all constants of a kind."""
    compiled = njit(pipeline_class=KernelCompiler, **OPTIONS)(function)
    if compiled is not function:  # as it is where numba is switched off
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
    """A kernel of two arguments: `of_tuple` where the first one is a tuple, `of_array` where it is an array.

    Which one is known when the caller is compiled, and so are the numbers that `of_tuple` returns without a look at it.
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
    """base**exponent by `pow` of the C library, as Python has it, also where the compiler knows the exponent.

    It would make x*x of x**2, which in one of some 1000 cases differs in the last bit.
    """

    def code(context, builder, signature, values):
        double = ir.DoubleType()
        function = cgutils.get_or_insert_function(builder.module, ir.FunctionType(double, (double, double)), "pow")
        function.attributes.add("nobuiltin")
        return builder.call(function, values)

    return types.float64(types.float64, types.float64), code
