/* Input derivatives, which the importer sets for the next step, and output derivatives by inputs, which it requests. */
#ifndef DERIVATIVES_H
#define DERIVATIVES_H

#include <stdint.h>

#include "arrays.h"
#include "messages.h"

Status set_input_derivatives(
    Instance *instance, const unsigned *references, size_t count, const int32_t *orders, const double *values);
Status directional_derivative(
    Instance *instance, const unsigned *unknowns, size_t count, const unsigned *knowns, size_t known_count,
    const double *seed, size_t seeds, double *sensitivity, size_t room);
Status begin_steps(Instance *instance);

#endif
