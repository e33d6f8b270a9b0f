/* What of derivatives.c is that of one tether: where derivatives of its inputs wait, and their scales. */
#include "derivatives.h"

#include <string.h>

#include "instance.h"

/* Derivatives of the inputs of one tether wait: bits of the inputs of the table that have one, then their values, as in the state
(AT_GIVEN_DERIVATIVES); then those of the wind at points, 0 where none is given, which the state has at its end */

enum { WIND_AT = INPUTS - AT_INPUTS }; /* numbers of the input wind_at, the last ones */

static double *waiting_derivatives(Instance *instance)
{
    return instance->phase < STEPPING ? instance->derivatives : instance->arrays->state + AT_GIVEN_DERIVATIVES;
}

static double *waiting_of_wind_at(Instance *instance)
{
    if (instance->phase < STEPPING) return instance->derivatives + 1 + AT_INPUTS;
    return instance->arrays->state + STATE_SIZE(instance->arrays->segments) - WIND_AT;
}

/* Hand over what was given before the first step to the state of the start. */
void give_derivatives(Instance *instance)
{
    double *state = instance->arrays->state;
    memcpy(state + AT_GIVEN_DERIVATIVES, instance->derivatives, (1 + AT_INPUTS) * sizeof(double));
    memcpy(state + STATE_SIZE(instance->arrays->segments) - WIND_AT, instance->derivatives + 1 + AT_INPUTS,
        WIND_AT * sizeof(double));
}

/* Keep the derivative of an input for the next step. */
void keep_derivative(Instance *instance, unsigned reference, double value)
{
    double *derivatives = waiting_derivatives(instance);
    if (reference >= AT_INPUTS) {
        waiting_of_wind_at(instance)[reference - AT_INPUTS] = value;
        return;
    }
    derivatives[0] = (double)((uint32_t)derivatives[0] | 1u << reference);
    derivatives[1 + reference] = value;
}

/* Scale of an input, see `scale_in_line`. */
double scale_of(const Arrays *arrays, unsigned input, double step, double part)
{
    return scale_in_line(arrays, 0, input, step, part);
}
