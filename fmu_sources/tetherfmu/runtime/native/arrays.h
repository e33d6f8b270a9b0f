/* The arrays of layout.py for one tether, and all that is done with the kernels. */
#ifndef ARRAYS_H
#define ARRAYS_H

#include <stdbool.h>
#include <stdint.h>

#include "tables.h"

enum { KITE_MOTION = 6 }; /* components of the position and the velocity of the kite end, which follow each other */

typedef struct {
    int64_t segments;
    double *parameters, *state, *work;
    double *before; /* the state before the last step that was done */
    double *spare;  /* room for the state before the next one */
    double *values; /* of the tether, for a start or a saved state that may be refused */
    double inputs[INPUTS];    /* of the last step */
    bool is_repeatable;       /* whether `before` and `inputs` are known: not after a start or a restored state */
} Arrays;

Arrays *make_arrays(const double *values);
bool pack_parameters(const Arrays *arrays, double importer_tolerance, char *problem);
void free_arrays(Arrays *arrays);
int32_t first_shape(const Arrays *arrays, double *values);
int32_t do_step(const Arrays *arrays, double step, double *before, double *values);
int32_t take_outputs(const Arrays *arrays, double *values);

#endif
