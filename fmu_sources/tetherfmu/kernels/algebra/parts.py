"""Parts of flat arrays as views, at the cost of an addition: a slice of numba also looks for negative and for large places."""

from numba import types
from numba.core import cgutils
from numba.core.imputils import impl_ret_borrowed
from numba.extending import intrinsic
from numba.np.arrayobj import make_view


@intrinsic
def part(typing, array, start, size):
    """View of `size` numbers of a flat array from place `start` on, which must be there."""

    def code(context, builder, signature, values):
        kind = signature.args[0]
        whole = context.make_array(kind)(context, builder, values[0])
        first = builder.gep(whole.data, [values[1]])
        view = make_view(context, builder, kind, whole, kind, first, values[2:], cgutils.unpack_tuple(builder, whole.strides))
        return impl_ret_borrowed(context, builder, kind, view._getvalue())

    return array(array, types.intp, types.intp), code
