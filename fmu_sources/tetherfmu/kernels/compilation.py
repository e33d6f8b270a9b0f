"""How kernels are compiled: by numba, without exceptions or allocation. What numba cannot say: `by_kind`, `part`, `power`.

Rules of a kernel, so that its machine code can stand alone without Python: arguments are numbers, tuples and flat
arrays; work space comes from the caller; a failure is a status code; other kernels are called by name only. Nothing
is allocated, raised or received as a function.
"""

from llvmlite import ir
from numba import cfunc, njit, types
from numba.core import cgutils
from numba.core.imputils import impl_ret_borrowed
from numba.extending import intrinsic, overload
from numba.np.arrayobj import make_view

OPTIONS = {"error_model": "numpy", "no_cfunc_wrapper": True}  # which `entry_point` has all the same


def kernel(function):
    """Compile a function for other kernels (and for tests) at its first call."""
    return njit(**OPTIONS)(function)


def view(function):
    """Compile a kernel that is always inlined: one that returns arrays, as views or in a record, so that no reference is
    counted, or one that is compiled anew for each constant that it is called with.
    """
    return njit(forceinline=True, **OPTIONS)(function)


def entry_point(signature, function):
    """Compile a function that takes numbers and pointers, to a `numba.CFunc`."""
    return cfunc(signature, **OPTIONS)(function)


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
def part(typing, array, start, size):
    """View of `size` numbers of a flat array from place `start` on, which must be there.

    It costs an addition; a slice of numba also looks for places that are negative or beyond the end.
    """

    def code(context, builder, signature, values):
        kind = signature.args[0]
        whole = context.make_array(kind)(context, builder, values[0])
        first = builder.gep(whole.data, [values[1]])
        strides = cgutils.unpack_tuple(builder, whole.strides)
        view = make_view(context, builder, kind, whole, kind, first, values[2:], strides)
        return impl_ret_borrowed(context, builder, kind, view._getvalue())

    return array(array, types.intp, types.intp), code


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
