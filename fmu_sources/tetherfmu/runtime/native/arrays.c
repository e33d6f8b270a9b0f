/* The arrays of the kernels, and the calls of the kernels. */
#include "arrays.h"

#include <string.h>

#include "kernels.h"
#include "messages.h"
#include "room.h"

/* The arrays for values, in one block; NULL without memory. */
Arrays *make_arrays(Instance *instance, const double *values)
{
    int64_t n = KERNEL(segments)(IN(memory_of(instance)) 1, values + PARAMETERS_AT);
    size_t parameters = PARAMETERS_SIZE(n), state = STATE_SIZE(n), work = (size_t)KERNEL(work_size)(IN(memory_of(instance)) n);
    size_t numbers = parameters + STATES_HELD * state + work + VALUES;
    Arrays *arrays = take_room(instance, sizeof *arrays + numbers * sizeof(double));
    if (!arrays) return NULL;
#if KERNELS_IN_C
    arrays->memory = memory_of(instance);
#endif
    arrays->segments = n;
    arrays->parameters = (double *)(arrays + 1);
    arrays->state = arrays->parameters + parameters;
    arrays->before = arrays->state + state;
    arrays->spare = arrays->before + state;
    arrays->work = arrays->spare + state;
    arrays->values = arrays->work + work;
    memcpy(arrays->values, values, VALUES * sizeof(double));
    return arrays;
}

/* A parameter as a message has it: Integers and Enumerations without a fraction, where they have none. */
static Fact fact_of(const char *key, const double *given, int number)
{
    double value = given[number];
    return PARAMETER[number].kind != REAL && is_integer(value) ? whole(key, value) : real(key, value);
}

/* Whether all parameters are allowed, alone and together, so that the kernels have them; if not, `problem` (of LONGEST_TEXT
bytes) says what is wrong. */
bool pack_parameters(const Arrays *arrays, double importer_tolerance, char *problem)
{
    const double *given = arrays->values + PARAMETERS_AT;
    int32_t result = KERNEL(pack)(IN(arrays->memory) 1, FREE_KITE, given, importer_tolerance, arrays->parameters);
    if (!result && WIND_POINTS > 0) {
        arrays->parameters[AT_WIND_POINTS] = WIND_POINTS;
        arrays->parameters[AT_WIND_PROFILE] = AT_AT_NODES;
    }
    if (!result) return true;
    const Parameter *declared = &PARAMETER[index_of(result)];
    fill_in(problem, LONGEST_TEXT, KERNEL_SENTENCE[code_of(result)], FACTS(
        word("name", declared->name),
        word("range", declared->range),
        fact_of("value", given, index_of(result)),
        fact_of("roughness", given, SURFACE_ROUGHNESS),
        fact_of("height", given, WIND_REFERENCE_HEIGHT),
        fact_of("shortest_stop", given, SHORTEST_LENGTH),
        fact_of("longest_stop", given, LONGEST_LENGTH),
        fact_of("length", given, INITIAL_LENGTH),
        fact_of("segments", given, SEGMENTS)));
    return false;
}

/* First shape for the inputs in `values`, which get its outputs; returns the kernel's status. */
int32_t first_shape(Arrays *arrays, double *values)
{
#if FREE_KITE
    memcpy(values + AT_KITE_POSITION, values + PARAMETERS_AT + INITIAL_KITE_POSITION, KITE_MOTION * sizeof(double));
#endif
    return KERNEL(initialize)(
        IN(arrays->memory) arrays->segments, arrays->parameters, values, arrays->state, SHAPE_POINTS, values + OUTPUTS_AT,
        arrays->work);
}

/* One communication step [s] of the state with the inputs in `values`, which get its outputs; `before` gets the state of
before. Returns the kernel's status: where that is not 0, state and outputs are as they were. */
int32_t do_step(Arrays *arrays, double step, double *before, double *values)
{
    return KERNEL(advance)(
        IN(arrays->memory) arrays->segments, arrays->parameters, values, step, arrays->state, before, SHAPE_POINTS,
        values + OUTPUTS_AT, arrays->work);
}

/* Outputs in `values` that belong to the state; returns the kernel's status. */
int32_t take_outputs(Arrays *arrays, double *values)
{
    return KERNEL(outputs)(
        IN(arrays->memory) arrays->segments, arrays->parameters, arrays->state, SHAPE_POINTS, values + OUTPUTS_AT, arrays->work);
}

double *state_of(const Arrays *arrays, int line)
{
    return arrays->state;
}

const double *parameters_of(const Arrays *arrays, int line)
{
    return arrays->parameters;
}

int64_t segments_of(const Arrays *arrays, int line)
{
    return arrays->segments;
}

size_t state_size_of(const Arrays *arrays, int line)
{
    return STATE_SIZE(arrays->segments);
}

/* What the status of a kernel means for a step [s], with the inputs and the unstretched length of now, into `text`. */
void sentence_of(
    char text[LONGEST_TEXT], const Arrays *arrays, const double *values, int32_t result, double step, bool at_start)
{
    int place = index_of(result);
    fill_sentence(text, result, step, (About){
        .name = INPUT_NAME[place],
        .value = values[place],
        .inputs = values,
        .parameters = arrays->parameters,
        .length = arrays->state[AT_LENGTH],
        .segments = arrays->segments});
}
