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

static inline uint32_t load_8(const unsigned char *at)
{
    return *at;
}

static inline uint32_t load_32(const unsigned char *at)
{
#if defined(__GNUC__)
    return *(const any_32 *)(const void *)at;
#else
    uint32_t number;
    memcpy(&number, at, sizeof number);
    return number;
#endif
}

static inline uint64_t load_64(const unsigned char *at)
{
#if defined(__GNUC__)
    return *(const any_64 *)(const void *)at;
#else
    uint64_t number;
    memcpy(&number, at, sizeof number);
    return number;
#endif
}

static inline double load_f64(const unsigned char *at)
{
#if defined(__GNUC__)
    return *(const any_f64 *)(const void *)at;
#else
    double number;
    memcpy(&number, at, sizeof number);
    return number;
#endif
}

static inline void store_8(unsigned char *at, uint64_t given)
{
    *at = (unsigned char)given;
}

static inline void store_32(unsigned char *at, uint64_t given)
{
#if defined(__GNUC__)
    *(any_32 *)(void *)at = (uint32_t)given;
#else
    const uint32_t number = (uint32_t)given;
    memcpy(at, &number, sizeof number);
#endif
}

static inline void store_64(unsigned char *at, uint64_t given)
{
#if defined(__GNUC__)
    *(any_64 *)(void *)at = (uint64_t)given;
#else
    const uint64_t number = (uint64_t)given;
    memcpy(at, &number, sizeof number);
#endif
}

static inline void store_f64(unsigned char *at, double given)
{
#if defined(__GNUC__)
    *(any_f64 *)(void *)at = (double)given;
#else
    const double number = (double)given;
    memcpy(at, &number, sizeof number);
#endif
}

static inline uint32_t shifted_32(uint32_t number, uint32_t by)
{
    by &= 31u;
    return number >> by | (number >> 31 && by ? ~(uint32_t)0 << (32u - by) : 0u);
}

static inline uint64_t shifted_64(uint64_t number, uint64_t by)
{
    by &= 63u;
    return number >> by | (number >> 63 && by ? ~(uint64_t)0 << (64u - by) : 0u);
}

static inline uint64_t bits_of(double number)
{
    uint64_t bits;
    memcpy(&bits, &number, sizeof bits);
    return bits;
}

static inline double number_of(uint64_t bits)
{
    double number;
    memcpy(&number, &bits, sizeof number);
    return number;
}

/* Towards zero, and to the nearest limit where it is beyond them. */
static inline uint64_t truncated(double number)
{
    if (number != number) return 0;
    if (number >= 9223372036854775808.0) return (uint64_t)INT64_MAX;
    if (number <= -9223372036854775808.0) return (uint64_t)INT64_MIN;
    return (uint64_t)(int64_t)number;
}
