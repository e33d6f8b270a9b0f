#ifndef FINITE_H
#define FINITE_H

#include <float.h>
#include <math.h>
#include <stdbool.h>

/* `isfinite`, which the C library of Windows lacks as a function. */
static inline bool is_finite(double number)
{
    return fabs(number) <= DBL_MAX;
}

#endif
