/* What the FMU of a system does not offer, as its flags say: derivatives of inputs, and of outputs by inputs. */
#include "derivatives.h"

#include "instance.h"

/* There are none. */
void give_derivatives(Instance *instance)
{
    (void)instance;
}

Status set_input_derivatives(
    Instance *instance, const unsigned *references, size_t count, const int32_t *orders, const double *values)
{
    return say(instance, ERROR, NOT_OFFERED, NULL);
}

Status directional_derivative(
    Instance *instance, const unsigned *unknowns, size_t count, const unsigned *knowns, size_t known_count,
    const double *seed, size_t seeds, double *sensitivity, size_t room)
{
    return say(instance, ERROR, NOT_OFFERED, NULL);
}
