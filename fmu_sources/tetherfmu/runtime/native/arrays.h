/* The arrays of all lines (plan_layout.py), and all operations with the kernels. */
#ifndef ARRAYS_H
#define ARRAYS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "messages.h"
#include "tables.h"

enum { KITE_MOTION = 6 }; /* components of the position and the velocity of the kite end, which follow each other */

typedef struct {
#if KERNELS_IN_C
    unsigned char *memory; /* of the kernels, see kernels_in_c.h */
#endif
    int64_t segments; /* in all lines */
    int64_t *plan;
    double *given, *found; /* inputs and outputs of the kernels, unless these are among the values */
    double *quantities;    /* of the instance */
    double *parameters, *state, *work;
    double *before; /* the state before the last step that was done */
    double *spare;  /* room for the state before the next one */
    double *values; /* of the tether, for a start or a saved state that may be refused */
    double inputs[INPUTS];    /* of the last step */
    bool is_repeatable;       /* whether `before` and `inputs` are known: not after a start or a restored state */
} Arrays;

Arrays *make_arrays(Instance *instance, const double *values);
bool pack_parameters(const Arrays *arrays, double importer_tolerance, char *problem);
int32_t first_shape(Arrays *arrays, double *values);
int32_t do_step(Arrays *arrays, double step, double *before, double *values);
int32_t take_outputs(Arrays *arrays, double *values);
double *state_of(const Arrays *arrays, int line);
double *parameters_of(const Arrays *arrays, int line);
int64_t segments_of(const Arrays *arrays, int line);
size_t state_size_of(const Arrays *arrays, int line);
void about_line(char *text, int line, const char *said);
void sentence_of(char text[LONGEST_TEXT], const Arrays *arrays, const double *values, int32_t result, double step);

/* --- sentences.c */

typedef struct {
    const char *name; /* of the input or parameter that a status is about */
    double value;
    const double *inputs, *parameters;
    double length; /* unstretched [m] */
    int64_t segments;
} About;

bool is_integer(double value);
void fill_sentence(char text[LONGEST_TEXT], int32_t result, double step, About about);

#endif
