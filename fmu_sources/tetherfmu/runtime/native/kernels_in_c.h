/* The kernels as C, with the interface of a library. Their arrays are in the memory of the instance, see room_in_c.c. */
#ifndef KERNELS_IN_C_H
#define KERNELS_IN_C_H

#include <stdint.h>

#define IN(memory) (memory),

/* The kernels' address of a place in the memory. */
static inline uint32_t address(const unsigned char *memory, const void *place)
{
    return (uint32_t)((const unsigned char *)place - memory);
}

static inline int64_t KERNEL(segments)(unsigned char *m, int64_t tethers, const double *quantities)
{
    return (int64_t)in_c_segments(m, STACK_TOP, (uint64_t)tethers, address(m, quantities));
}

static inline int32_t KERNEL(pack)(
    unsigned char *m, int64_t tethers, int64_t kites, const double *quantities, double tolerance, double *parameters)
{
    return (int32_t)in_c_pack(
        m, STACK_TOP, (uint64_t)tethers, (uint64_t)kites, address(m, quantities), tolerance, address(m, parameters));
}

static inline int32_t KERNEL(complete)(unsigned char *m, int64_t *plan)
{
    return (int32_t)in_c_complete(m, STACK_TOP, address(m, plan));
}

static inline int32_t KERNEL(initialize)(
    unsigned char *m, int64_t *plan, double *parameters, double *inputs, double *state, double *outputs, double *work)
{
    return (int32_t)in_c_initialize(
        m, STACK_TOP, address(m, plan), address(m, parameters), address(m, inputs), address(m, state),
        address(m, outputs), address(m, work));
}

static inline int32_t KERNEL(advance)(
    unsigned char *m, int64_t *plan, double *parameters, double *inputs, double step, double *state, double *before,
    double *outputs, double *work)
{
    return (int32_t)in_c_advance(
        m, STACK_TOP, address(m, plan), address(m, parameters), address(m, inputs), step, address(m, state),
        address(m, before), address(m, outputs), address(m, work));
}

static inline int32_t KERNEL(outputs)(
    unsigned char *m, int64_t *plan, double *parameters, double *inputs, double *state, double *outputs, double *work)
{
    return (int32_t)in_c_outputs(
        m, STACK_TOP, address(m, plan), address(m, parameters), address(m, inputs), address(m, state),
        address(m, outputs), address(m, work));
}

#endif
