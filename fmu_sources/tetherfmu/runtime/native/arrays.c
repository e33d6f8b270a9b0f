/* The arrays of the kernels: parameters checked and packed, with the rules and the arithmetic of parameters.py. */
#include "arrays.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "finite.h"
#include "kernels.h"
#include "messages.h"

static double parameter(const double *values, int number)
{
    return values[PARAMETERS_AT + number];
}

/* Number of segments as the variant knows it, see `variants.effective`. */
static int64_t effective_segments(const double *values)
{
    return WITHOUT_NODES ? 1 : (int64_t)parameter(values, SEGMENTS);
}

static bool allows(const Parameter *declared, double value)
{
    if (declared->kind == ENUMERATION && value != floor(value)) return false;
    return is_finite(value) && declared->minimum <= value && value <= declared->maximum;
}

static bool check_parameter(const Parameter *declared, double value, char *problem)
{
    bool is_whole = declared->kind != REAL && is_finite(value) && value == floor(value);
    Fact name = word("name", declared->name), fact = is_whole ? whole("value", value) : real("value", value);
    if (!allows(declared, value)) {
        fill_in(problem, LONGEST_TEXT, OUT_OF_RANGE, FACTS(name, fact, word("range", declared->range)));
        return false;
    }
    if (declared->kind != REAL && !is_whole) {
        fill_in(problem, LONGEST_TEXT, NOT_WHOLE, FACTS(name, fact));
        return false;
    }
    return true;
}

/* Whether all parameters are allowed, alone and together; if not, `problem` (of LONGEST_TEXT bytes) says what is wrong. */
bool check_parameters(const double *values, char *problem)
{
    for (int i = 0; i < PARAMETERS; i++)
        if (!check_parameter(&PARAMETER[i], parameter(values, i), problem)) return false;
    double profile = parameter(values, WIND_PROFILE), roughness = parameter(values, SURFACE_ROUGHNESS);
    double height = parameter(values, WIND_REFERENCE_HEIGHT), length = parameter(values, INITIAL_LENGTH);
    if ((profile == AT_LOGARITHMIC || profile == AT_EXPLOG) && roughness >= height) {
        fill_in(problem, LONGEST_TEXT, ROUGHNESS_TOO_LARGE, FACTS(real("roughness", roughness), real("height", height)));
        return false;
    }
    double segments = (double)effective_segments(values);
    if (length / segments < AT_MIN_SEGMENT_LENGTH) {
        fill_in(problem, LONGEST_TEXT, SEGMENTS_TOO_SHORT, FACTS(real("length", length), whole("segments", segments)));
        return false;
    }
    return true;
}

/* Relative tolerance of the solver [-]. */
static double tolerance_of(const double *values, double importer_tolerance)
{
    double own = parameter(values, RELATIVE_TOLERANCE);
    return own != 0.0 ? own : importer_tolerance != 0.0 ? importer_tolerance : DEFAULT_TOLERANCE;
}

static void fill(double *parameters, int64_t n, int property, double value)
{
    for (int64_t s = 0; s < n; s++) parameters[AT_PARAMETER_SCALARS + property * n + s] = value;
}

/* The `parameters` array of a uniform instance, with the arithmetic of `parameters.pack`. */
static void pack(double *flat, int64_t n, const double *values, double tolerance)
{
    for (int i = 0; i < PARAMETERS; i++)
        if (PARAMETER[i].place >= 0) flat[PARAMETER[i].place] = parameter(values, i);
    double length = parameter(values, INITIAL_LENGTH), diameter = parameter(values, DIAMETER);
    flat[AT_RELATIVE_TOLERANCE] = tolerance;
    flat[AT_KITE_IS_FREE] = FREE_KITE;
    fill(flat, n, AT_SHARE, length / (double)n / length);
    fill(flat, n, AT_STIFFNESS, parameter(values, AXIAL_STIFFNESS));
    fill(flat, n, AT_DAMPING, WITHOUT_WAVES ? 0.0 : parameter(values, AXIAL_DAMPING));
    fill(flat, n, AT_LINE_DENSITY, parameter(values, DENSITY) * PI * pow(diameter, 2.0) / 4.0);
    fill(flat, n, AT_DRAG_WIDTH, parameter(values, DRAG_COEFFICIENT) * diameter);
#if FREE_KITE
    flat[AT_PARAMETER_SCALARS + AT_SEGMENT_PROPERTIES * n + n] = parameter(values, KITE_MASS);
#endif
}

enum { STATES_HELD = 3 }; /* `state`, `before` and `spare` */

/* The arrays for values whose parameters `check_parameters` allows, in one block; NULL without memory. */
Arrays *make_arrays(const double *values, double importer_tolerance)
{
    int64_t n = effective_segments(values);
    size_t parameters = PARAMETERS_SIZE(n), state = STATE_SIZE(n), work = (size_t)KERNEL(work_size)(n);
    Arrays *arrays = calloc(1, sizeof *arrays + (parameters + STATES_HELD * state + work + VALUES) * sizeof(double));
    if (!arrays) return NULL;
    arrays->segments = n;
    arrays->parameters = (double *)(arrays + 1);
    arrays->state = arrays->parameters + parameters;
    arrays->before = arrays->state + state;
    arrays->spare = arrays->before + state;
    arrays->work = arrays->spare + state;
    arrays->values = arrays->work + work;
    memcpy(arrays->values, values, VALUES * sizeof(double));
    pack(arrays->parameters, n, values, tolerance_of(values, importer_tolerance));
    return arrays;
}

void free_arrays(Arrays *arrays)
{
    free(arrays);
}

/* First shape for the inputs in `values`, which get its outputs; returns the kernel's status. */
int32_t first_shape(const Arrays *arrays, double *values)
{
#if FREE_KITE
    memcpy(values + AT_KITE_POSITION, values + PARAMETERS_AT + INITIAL_KITE_POSITION, KITE_MOTION * sizeof(double));
#endif
    return KERNEL(initialize)(
        arrays->segments, arrays->parameters, values, arrays->state, SHAPE_POINTS, values + OUTPUTS_AT, arrays->work);
}

/* One communication step [s] of the state with the inputs in `values`, which get its outputs; `before` gets the state of
before. Returns the kernel's status: where that is not 0, state and outputs are as they were. */
int32_t do_step(const Arrays *arrays, double step, double *before, double *values)
{
    return KERNEL(advance)(
        arrays->segments, arrays->parameters, values, step, arrays->state, before, SHAPE_POINTS, values + OUTPUTS_AT,
        arrays->work);
}

/* Outputs in `values` that belong to the state; returns the kernel's status. */
int32_t take_outputs(const Arrays *arrays, double *values)
{
    return KERNEL(outputs)(
        arrays->segments, arrays->parameters, arrays->state, SHAPE_POINTS, values + OUTPUTS_AT, arrays->work);
}
