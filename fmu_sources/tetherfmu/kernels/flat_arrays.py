"""Flat arrays of the compiled kernels: an address and a length.

A numba array has five more fields, which each use copies and the compiler has to remove again, and each use checks for
negative indices. The entry points therefore make flat arrays of their pointers. A kernel that Python calls
directly, in a test, gets numpy arrays; constants are numpy arrays, too.
"""

import operator

from numba import types
from numba.core import cgutils
from numba.core.imputils import impl_ret_borrowed
from numba.core.typing.templates import AbstractTemplate, infer_global, signature
from numba.extending import intrinsic, lower_builtin, models, overload, register_model
from numba.np.arrayobj import make_view


class FlatArray(types.Type):
    """Type of an array of numbers with another owner: contiguous, or every second number of such an array."""

    def __init__(self, dtype, stride=1):
        self.dtype, self.stride = dtype, stride
        super().__init__(f"FlatArray({dtype}, {stride})")


@register_model(FlatArray)
class FlatArrayModel(models.StructModel):
    """Representation that kernels pass to each other."""

    def __init__(self, manager, kind):
        super().__init__(manager, kind, [("data", types.CPointer(kind.dtype)), ("size", types.intp)])


def fields(context, builder, kind, array):
    """Fields of a flat or numpy array in generated code."""
    if isinstance(kind, types.Array):
        return context.make_array(kind)(context, builder, array)
    return cgutils.create_struct_proxy(kind)(context, builder, array)


def _made(context, builder, kind, data, size):
    """A new array in generated code."""
    array = fields(context, builder, kind, None)
    array.data, array.size = data, size
    return array._getvalue()


@intrinsic
def flat(typing, pointer, size):
    """Flat array of `size` numbers at an address."""

    def code(context, builder, signature, values):
        return _made(context, builder, signature.return_type, *values)

    return FlatArray(pointer.dtype)(pointer, types.intp), code


@intrinsic
def part(typing, array, start, size):
    """View of `size` numbers of a flat array from place `start` on, without bounds checks.

    Also for numpy arrays, for which numba would check for negative or excessive indices.
    """

    def code(context, builder, signature, values):
        kind = signature.args[0]
        whole = fields(context, builder, kind, values[0])
        first = builder.gep(whole.data, [values[1]])
        if isinstance(kind, FlatArray):
            return _made(context, builder, kind, first, values[2])
        strides = cgutils.unpack_tuple(builder, whole.strides)
        view = make_view(context, builder, kind, whole, kind, first, values[2:], strides)
        return impl_ret_borrowed(context, builder, kind, view._getvalue())

    return array(array, types.intp, types.intp), code


@intrinsic
def _every_second(typing, array, start, size):
    def code(context, builder, signature, values):
        first = builder.gep(fields(context, builder, signature.args[0], values[0]).data, [values[1]])
        return _made(context, builder, signature.return_type, first, values[2])

    return FlatArray(array.dtype, 2)(array, types.intp, types.intp), code


def every_second(array, start, size):
    """View of `size` numbers of a flat array from place `start` on, every other one."""
    return array[start : start + 2 * size : 2]


@overload(every_second)
def _view_every_second(array, start, size):
    if isinstance(array, FlatArray):
        return lambda array, start, size: _every_second(array, start, size)
    return every_second


@infer_global(len)
class _Length(AbstractTemplate):
    def generic(self, args, kws):
        return signature(types.intp, *args) if isinstance(args[0], FlatArray) else None


@infer_global(operator.getitem)
class _Read(AbstractTemplate):
    def generic(self, args, kws):
        array, place = args
        is_number = isinstance(array, FlatArray) and isinstance(place, types.Integer)
        return signature(array.dtype, array, types.intp) if is_number else None


@infer_global(operator.setitem)
class _Write(AbstractTemplate):
    def generic(self, args, kws):
        array, place, _ = args
        is_number = isinstance(array, FlatArray) and isinstance(place, types.Integer)
        return signature(types.none, array, types.intp, array.dtype) if is_number else None


def _address(context, builder, kind, array, place):
    """Code for the address of a number of a flat array."""
    place = builder.mul(place, place.type(kind.stride)) if kind.stride > 1 else place
    return builder.gep(fields(context, builder, kind, array).data, [place])


@lower_builtin(len, FlatArray)
def _length(context, builder, signature, values):
    return fields(context, builder, signature.args[0], values[0]).size


@lower_builtin(operator.getitem, FlatArray, types.intp)
def _read(context, builder, signature, values):
    return builder.load(_address(context, builder, signature.args[0], *values))


@lower_builtin(operator.setitem, FlatArray, types.intp, types.Any)
def _write(context, builder, signature, values):
    builder.store(values[2], _address(context, builder, signature.args[0], *values[:2]))
    return context.get_dummy_value()
