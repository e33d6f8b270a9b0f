"""What a C file of kernels begins with, and the small functions that it may need."""

_LOAD = """
static inline {kind} load_{name}(const unsigned char *at)
{{
#if defined(__GNUC__)
    return *(const any_{name} *)(const void *)at;
#else
    {kind} number;
    memcpy(&number, at, sizeof number);
    return number;
#endif
}}
"""
_STORE = """
static inline void store_{name}(unsigned char *at, {given} given)
{{
#if defined(__GNUC__)
    *(any_{name} *)(void *)at = ({kind})given;
#else
    const {kind} number = ({kind})given;
    memcpy(at, &number, sizeof number);
#endif
}}
"""
_SHIFTED = """
static inline uint{bits}_t shifted_{bits}(uint{bits}_t number, uint{bits}_t by)
{{
    by &= {most}u;
    return number >> by | (number >> {most} && by ? ~(uint{bits}_t)0 << ({bits}u - by) : 0u);
}}
"""
_SAME_BITS = """
static inline {after} {name}({before} {given})
{{
    {after} {found};
    memcpy(&{found}, &{given}, sizeof {found});
    return {found};
}}
"""
_LOAD_8 = """\
static inline uint32_t load_8(const unsigned char *at)
{
    return *at;
}
"""
_STORE_8 = """
static inline void store_8(unsigned char *at, uint64_t given)
{
    *at = (unsigned char)given;
}
"""
_TRUNCATED = """
/* Towards zero, and to the nearest limit where it is beyond them. */
static inline uint64_t truncated(double number)
{
    if (number != number) return 0;
    if (number >= 9223372036854775808.0) return (uint64_t)INT64_MAX;
    if (number <= -9223372036854775808.0) return (uint64_t)INT64_MIN;
    return (uint64_t)(int64_t)number;
}
"""
_TYPES = {"32": "uint32_t", "64": "uint64_t", "f64": "double"}
HELPERS = [
    _LOAD_8,
    *(_LOAD.format(name=name, kind=kind) for name, kind in _TYPES.items()),
    _STORE_8,
    *(_STORE.format(name=name, kind=kind, given=kind if name == "f64" else "uint64_t") for name, kind in _TYPES.items()),
    *(_SHIFTED.format(bits=bits, most=bits - 1) for bits in (32, 64)),
    _SAME_BITS.format(name="bits_of", after="uint64_t", before="double", found="bits", given="number"),
    _SAME_BITS.format(name="number_of", after="double", before="uint64_t", found="number", given="bits"),
    _TRUNCATED,
]
HEAD = """\
/* The kernels as C99: made of WebAssembly by libraries/c_code.py. `m` is the memory of an instance, `s` the top of its
stack; an address is a place in the memory. */
#include <float.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
#error "the kernels are for processors that store the lowest byte first"
#endif
#if FLT_EVAL_METHOD != 0
#error "the kernels need doubles that are rounded after each operation; compile for SSE2"
#endif
/* no product and sum in one operation, which would be rounded once only */
#if defined(__clang__) || defined(_MSC_VER)
#pragma STDC FP_CONTRACT OFF
#elif defined(__GNUC__)
#pragma GCC optimize("fp-contract=off")
#endif
/* numbers of any type lie in the memory, at multiples of their sizes */
#if defined(__GNUC__)
typedef uint32_t __attribute__((may_alias)) any_32;
typedef uint64_t __attribute__((may_alias)) any_64;
typedef double __attribute__((may_alias)) any_f64;
#endif
"""
