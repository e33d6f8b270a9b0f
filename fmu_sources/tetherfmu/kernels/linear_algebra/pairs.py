"""Pairs: two numbers that the processor adds, multiplies and divides at once.

A chain is symmetric: the operations on a segment near one end also apply to its mirror image near the other. Kernels
process both halves at once: the first number of a pair belongs to the ground half, the second to the kite half. Kernels
that only add, subtract, multiply, divide, `sqrt`, `max` and `select` accept numbers and pairs. Each number of a pair
equals the result of the scalar operation, bit for bit.

Measured when it was introduced: 290 ns for each segment and step of the dynamic tether without pairs, 214 ns with them
(20 segments, plain x86-64, two numbers in one SSE2 instruction).
"""

import operator
from math import sqrt

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic, models, overload, register_model

from ..compilation import kernel
from ..flat_arrays import fields

_TWO_DOUBLES = ir.VectorType(ir.DoubleType(), 2)
_PLACES = [ir.Constant(ir.IntType(32), k) for k in range(2)]


class _PairType(types.Type):
    def __init__(self):
        super().__init__("Pair")


_PAIR = _PairType()


@register_model(_PairType)
class _PairModel(models.PrimitiveModel):
    def __init__(self, manager, kind):
        super().__init__(manager, kind, _TWO_DOUBLES)


def _joined(builder, a, b):
    """Code for the vector of two numbers."""
    vector = builder.insert_element(ir.Constant(_TWO_DOUBLES, ir.Undefined), a, _PLACES[0])
    return builder.insert_element(vector, b, _PLACES[1])


def _as_vectors(builder, kinds, values):
    """Code for the vectors of pairs and of plain numbers, which are duplicated."""
    return [value if kind is _PAIR else _joined(builder, value, value) for kind, value in zip(kinds, values, strict=True)]


def _are_pairs(*kinds):
    """Whether these are pairs, or pairs and plain numbers."""
    return any(kind is _PAIR for kind in kinds) and all(kind is _PAIR or kind == types.float64 for kind in kinds)


def _is_tuple(kind):
    return isinstance(kind, types.UniTuple)


def _of_kind(kind, like):
    """Type of one `kind` for each number or pair of a type."""
    return types.UniTuple(kind, like.count) if _is_tuple(like) else kind


def _each(context, builder, operation, kind, *values):
    """Code for a tuple of operations on the parts of tuples, or for one operation."""
    if not _is_tuple(kind):
        return operation(*values)
    parts = zip(*(cgutils.unpack_tuple(builder, value) for value in values), strict=True)
    return context.make_tuple(builder, kind, [operation(*each) for each in parts])


@intrinsic
def pair(typing, a, b):
    """Pair of two numbers; tuple of pairs of two tuples of numbers."""

    def code(context, builder, signature, values):
        return _each(context, builder, lambda a, b: _joined(builder, a, b), signature.return_type, *values)

    return _of_kind(_PAIR, a)(a, b), code


def _number(place):
    """Function that extracts the number at place 0 or 1 from a pair, or from all pairs of a tuple."""

    @intrinsic
    def number(typing, a):
        def code(context, builder, signature, values):
            return _each(
                context, builder, lambda a: builder.extract_element(a, _PLACES[place]), signature.return_type, *values
            )

        return _of_kind(types.float64, a)(a), code

    return number


first, second = _number(0), _number(1)


def _place_of_two(context, builder, kind, array, place):
    """Code for the address of two neighbours in a flat array."""
    data = fields(context, builder, kind, array).data
    return builder.bitcast(builder.gep(data, [place]), ir.PointerType(_TWO_DOUBLES))


@intrinsic
def load_pair(typing, array, place):
    """Pair from `place` and the next place of a flat array."""

    def code(context, builder, signature, values):
        return builder.load(_place_of_two(context, builder, signature.args[0], *values), align=8)

    return _PAIR(array, types.intp), code


@intrinsic
def store_pair(typing, array, place, a):
    """Write a pair to `place` and to the next place of a flat array (modified)."""

    def code(context, builder, signature, values):
        address = _place_of_two(context, builder, signature.args[0], *values[:2])
        builder.store(values[2], address, align=8)
        return context.get_dummy_value()

    return types.void(array, types.intp, _PAIR), code


@intrinsic
def unzip(typing, a, b):
    """(first of a, first of b) and (second of a, second of b)."""

    def code(context, builder, signature, values):
        masks = (ir.Constant(ir.VectorType(ir.IntType(32), 2), [k, k + 2]) for k in range(2))
        pairs = [builder.shuffle_vector(*values, mask) for mask in masks]
        return context.make_tuple(builder, signature.return_type, pairs)

    return types.UniTuple(_PAIR, 2)(a, b), code


@intrinsic
def swapped(typing, a):
    """Pair with its two numbers swapped; tuple of such pairs."""

    def code(context, builder, signature, values):
        mask = ir.Constant(ir.VectorType(ir.IntType(32), 2), [1, 0])
        return _each(context, builder, lambda a: builder.shuffle_vector(a, a, mask), signature.return_type, *values)

    return a(a), code


def _of_vectors(build):
    """Code of an operation on pairs and plain numbers: the result of `build` from a builder and their vectors."""
    return lambda context, builder, signature, values: build(builder, *_as_vectors(builder, signature.args, values))


def _larger(builder, a, b):
    return builder.select(builder.fcmp_ordered(">", b, a), b, a)


def _root(builder, a):
    kind = ir.FunctionType(_TWO_DOUBLES, [_TWO_DOUBLES])
    return builder.call(cgutils.get_or_insert_function(builder.module, kind, "llvm.sqrt.v2f64"), [a])


def _selected(builder, sign, a, b):
    zero = ir.Constant(_TWO_DOUBLES, [ir.Constant(ir.DoubleType(), 0.0)] * 2)
    return builder.select(builder.fcmp_ordered(">", sign, zero), a, b)


def _let_work_on_pairs(function, build):
    """Make a function, or a Python operator, of two numbers accept pairs."""

    @intrinsic
    def of_pairs(typing, a, b):
        return _PAIR(a, b), _of_vectors(build)

    @overload(function)
    def overloaded(a, b):
        if _are_pairs(a, b):
            return lambda a, b: of_pairs(a, b)
        return None


_let_work_on_pairs(operator.add, ir.IRBuilder.fadd)
_let_work_on_pairs(operator.sub, ir.IRBuilder.fsub)
_let_work_on_pairs(operator.mul, ir.IRBuilder.fmul)
_let_work_on_pairs(operator.truediv, ir.IRBuilder.fdiv)
_let_work_on_pairs(max, _larger)


@intrinsic
def _root_of_pair(typing, a):
    return _PAIR(a), _of_vectors(_root)


@intrinsic
def _select_in_pairs(typing, sign, a, b):
    return _PAIR(sign, a, b), _of_vectors(_selected)


@overload(operator.neg)
def _negative(a):
    if a is _PAIR:
        return lambda a: -1.0 * a
    return None


@overload(sqrt)
def _sqrt(a):
    if a is _PAIR:
        return lambda a: _root_of_pair(a)
    return None


def select(sign, a, b):
    """a where sign > 0, b elsewhere."""
    return a if sign > 0.0 else b


@overload(select)
def _select(sign, a, b):
    if _are_pairs(sign, a, b):
        return lambda sign, a, b: _select_in_pairs(sign, a, b)
    return select


def number_at(array, start, s):
    """Number at place start + s of an array; for two s, the pair of the numbers at both places."""
    return array[start + s]


@overload(number_at)
def _number_at(array, start, s):
    if isinstance(s, types.UniTuple):
        return lambda array, start, s: pair(array[start + s[0]], array[start + s[1]])
    return lambda array, start, s: array[start + s]


def broadcast(values, like):
    """A tuple of numbers unchanged if `like` is a number; if it is a pair, the tuple of pairs of equal numbers."""
    return values


@overload(broadcast)
def _broadcast(values, like):
    if like is _PAIR:
        return lambda values, like: pair(values, values)
    return broadcast


def lanewise(function):
    """Make a function of a number and a flat array accept a pair: it is called for each of the two numbers.

    It returns a tuple of numbers, and for a pair a tuple of pairs.
    """
    of_number = kernel(function)

    @overload(function)
    def overloaded(number, array):
        if number is _PAIR:
            return lambda number, array: pair(of_number(first(number), array), of_number(second(number), array))
        return lambda number, array: of_number(number, array)

    return function
