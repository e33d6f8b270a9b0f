/* The kernels, see kernels/entry_points.py. Nothing but arrays.c calls them. */
#ifndef KERNELS_H
#define KERNELS_H

#include <stdint.h>

#include "tables.h"

#if KERNELS_IN_C
#include "kernels_in_c.h"
#else
#define IN(memory) /* kernels in a library use the addresses of this process */

int64_t KERNEL(segments)(int64_t tethers, const double *quantities);
int32_t KERNEL(pack)(int64_t tethers, int64_t kites, const double *quantities, double tolerance, double *parameters);
int32_t KERNEL(complete)(int64_t *plan);
int32_t KERNEL(initialize)(
    int64_t *plan, double *parameters, double *inputs, double *state, double *outputs, double *work);
int32_t KERNEL(advance)(
    int64_t *plan, double *parameters, double *inputs, double step, double *state, double *before, double *outputs,
    double *work);
int32_t KERNEL(outputs)(
    int64_t *plan, double *parameters, double *inputs, double *state, double *outputs, double *work);
#endif

/* A kernel returns 0 on success, else a code and the index of an input or a parameter, decoded by `status.code` and
`status.index` of status.py. */
static inline int code_of(int32_t result)
{
    return result & 0xFF;
}

static inline int index_of(int32_t result)
{
    return result >> 8;
}

#endif
