#ifndef FINITE_H
#define FINITE_H

#include <float.h>
#include <math.h>
#include <stdbool.h>

/* `isfinite`, for which the C library of Windows has no function. */
static inline bool is_finite(double number)
{
    return fabs(number) <= DBL_MAX;
}

#endif
