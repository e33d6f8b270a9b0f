/* $name, all of it: the kernels and the shell, compiled as one file of C99, with nothing but the mathematical library.

Define FMI${fmi}_FUNCTION_PREFIX, as ${name}_ or another name for each FMU, to link several FMUs into one program. Define MAX_SEGMENTS to give an instance less
room than that for $segments segments. */
#if defined(__GNUC__)
#pragma GCC diagnostic ignored "-Wunused-parameter" /* functions of the standard have unused parameters */
#endif
#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define KERNELS_IN_C 1
#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wstrict-prototypes" /* in the header of FMI 3 */
#endif
#include "fmi${fmi}Functions.h"
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif
#define PREFIXED(prefix, name) prefix##name
#define WITH_PREFIX(prefix, name) PREFIXED(prefix, name)
#if defined(FMI2_FUNCTION_PREFIX)
#undef fmi2FullName
#define fmi2FullName(name) WITH_PREFIX(FMI2_FUNCTION_PREFIX, name)
#endif
#if defined(FMI${fmi}_FUNCTION_PREFIX)
#define OWN(name) WITH_PREFIX(FMI${fmi}_FUNCTION_PREFIX, name)
#else
#define OWN(name) PREFIXED(${name}_, name)
#endif
#if defined(__GNUC__) && !defined(_WIN32)
#pragma GCC visibility push(hidden) /* except the functions of FMI */
#endif
#include "names.h"
#include "tables.h"
#include "kernels.c"
$parts
