/* The arrays of the kernels for a system of lines (system_layout.py), and the calls of the kernels. In the place of arrays.c.
Which variable stands where is what system_maps.py says. */
#include "arrays.h"

#include <string.h>

#include "instance.h"
#include "kernels.h"
#include "messages.h"
#include "room.h"

static int64_t *row_of(int64_t *plan, int line)
{
    return plan + PLAN_HEADER + PLAN_LINE_NUMBERS * line;
}

static int64_t of_line(const Arrays *arrays, int line, int which)
{
    return arrays->plan[PLAN_HEADER + PLAN_LINE_NUMBERS * line + which];
}

double *state_of(const Arrays *arrays, int line)
{
    return arrays->state + of_line(arrays, line, PLAN_STATE_AT);
}

const double *parameters_of(const Arrays *arrays, int line)
{
    return arrays->parameters + of_line(arrays, line, PLAN_PARAMETERS_AT);
}

int64_t segments_of(const Arrays *arrays, int line)
{
    return of_line(arrays, line, PLAN_SEGMENTS);
}

size_t state_size_of(const Arrays *arrays, int line)
{
    int64_t end = line + 1 < LINES ? of_line(arrays, line + 1, PLAN_STATE_AT) : arrays->plan[PLAN_STATE_SIZE];
    return (size_t)(end - of_line(arrays, line, PLAN_STATE_AT));
}

/* Quantities of a line in the order in which the kernel `pack` takes them. */
static void quantities_of(const double *values, int line, double *quantities)
{
    for (int i = 0; i < QUANTITIES; i++) {
        int reference = QUANTITY_FROM[line][i];
        quantities[i] = reference < 0 ? QUANTITY_DEFAULT[i] : values[reference];
    }
}

/* The arrays for values, in one block; NULL without memory. */
Arrays *make_arrays(Instance *instance, const double *values)
{
    int64_t *plan = instance->plan, segments = 0;
    memcpy(plan, GIVEN_PLAN, sizeof GIVEN_PLAN);
    for (int i = 0; i < STARTS; i++) plan[START_FROM[i].place] = values[START_FROM[i].reference] == AT_START_AT_REST;
    for (int k = 0; k < LINES; k++) {
        quantities_of(values, k, instance->quantities);
        int64_t n = KERNEL(segments)(IN(memory_of(instance)) 1, instance->quantities);
        row_of(plan, k)[PLAN_SEGMENTS] = n;
        segments += n;
    }
    KERNEL(complete)(IN(memory_of(instance)) plan);
    size_t parameters = (size_t)plan[PLAN_PARAMETERS_SIZE], inputs = (size_t)plan[PLAN_INPUTS_SIZE];
    size_t state = (size_t)plan[PLAN_STATE_SIZE], outputs = (size_t)plan[PLAN_OUTPUTS_SIZE];
    size_t work = (size_t)plan[PLAN_WORK_SIZE];
    size_t numbers = parameters + inputs + STATES_HELD * state + outputs + work + VALUES;
    Arrays *arrays = take_room(instance, sizeof *arrays + numbers * sizeof(double));
    if (!arrays) return NULL;
#if KERNELS_IN_C
    arrays->memory = memory_of(instance);
#endif
    arrays->segments = segments;
    arrays->quantities = instance->quantities;
    memcpy(arrays->plan, plan, sizeof arrays->plan);
    arrays->parameters = (double *)(arrays + 1);
    arrays->given = arrays->parameters + parameters;
    arrays->state = arrays->given + inputs;
    arrays->before = arrays->state + state;
    arrays->spare = arrays->before + state;
    arrays->found = arrays->spare + state;
    arrays->work = arrays->found + outputs;
    arrays->values = arrays->work + work;
    memcpy(arrays->values, values, VALUES * sizeof(double));
    return arrays;
}

/* A quantity as a message has it: Integers and Enumerations without a fraction, where they have none. */
static Fact fact_of(const char *key, const double *quantities, int line, int place)
{
    int reference = QUANTITY_FROM[line][place];
    double value = quantities[place];
    bool is_whole = reference >= 0 && PARAMETER[reference - PARAMETERS_AT].kind != REAL && is_integer(value);
    return is_whole ? whole(key, value) : real(key, value);
}

/* Whether the parameters of free points are allowed, which the kernels do not check; if not, `problem` says what is wrong. */
static bool check_points(const double *values, char *problem)
{
    for (int i = 0; i < CHECKS; i++) {
        double value = values[CHECK[i].reference];
        const Parameter *declared = &PARAMETER[CHECK[i].reference - PARAMETERS_AT];
        bool is_number = declared->kind == REAL || is_integer(value);
        if (is_number && value >= CHECK[i].lowest && value <= CHECK[i].highest) continue;
        Fact fact = declared->kind != REAL && is_number ? whole("value", value) : real("value", value);
        fill_in(problem, LONGEST_TEXT, KERNEL_SENTENCE[PARAMETER_OUT_OF_RANGE], FACTS(
            word("name", declared->name), word("range", declared->range), fact));
        return false;
    }
    return true;
}

/* What is wrong with the quantities of a line. */
static void refuse_quantities(const double *quantities, int line, int32_t result, char *problem)
{
    char text[LONGEST_TEXT];
    int place = index_of(result), reference = QUANTITY_FROM[line][place];
    bool is_alone = code_of(result) == PARAMETER_OUT_OF_RANGE || code_of(result) == PARAMETER_NOT_WHOLE;
    fill_in(text, LONGEST_TEXT, KERNEL_SENTENCE[code_of(result)], FACTS(
        word("name", reference < 0 ? "" : PARAMETER[reference - PARAMETERS_AT].name),
        word("range", reference < 0 ? "" : PARAMETER[reference - PARAMETERS_AT].range),
        fact_of("value", quantities, line, place),
        fact_of("roughness", quantities, line, QUANTITY_SURFACE_ROUGHNESS),
        fact_of("height", quantities, line, QUANTITY_WIND_REFERENCE_HEIGHT),
        fact_of("length", quantities, line, QUANTITY_INITIAL_LENGTH),
        fact_of("shortest_stop", quantities, line, QUANTITY_SHORTEST_LENGTH),
        fact_of("longest_stop", quantities, line, QUANTITY_LONGEST_LENGTH),
        fact_of("segments", quantities, line, QUANTITY_SEGMENTS)));
    fill_in(problem, LONGEST_TEXT, is_alone ? "{text}" : "the line {line}: {text}", FACTS(
        word("line", LINE_NAME[line]), word("text", text)));
}

/* Whether all parameters are allowed, alone and together, so that the kernels have them; if not, `problem` (of LONGEST_TEXT
bytes) says what is wrong. */
bool pack_parameters(const Arrays *arrays, double importer_tolerance, char *problem)
{
    double *quantities = arrays->quantities;
    if (!check_points(arrays->values, problem)) return false;
    for (int k = 0; k < LINES; k++) {
        double mass[2];
        for (int end = 0; end < 2; end++) mass[end] = CARRIED[k][end] < 0 ? 0.0 : arrays->values[CARRIED[k][end]];
        quantities_of(arrays->values, k, quantities);
        int32_t result = KERNEL(pack)(
            IN(arrays->memory) 1, quantities, importer_tolerance, of_line(arrays, k, PLAN_START_POINT) >= 0,
            of_line(arrays, k, PLAN_END_POINT) >= 0, mass[0], mass[1],
            arrays->parameters + of_line(arrays, k, PLAN_PARAMETERS_AT));
        if (!result) continue;
        refuse_quantities(quantities, k, result, problem);
        return false;
    }
    return true;
}

/* Put the inputs among the values into the array of the kernels. */
static void give(const Arrays *arrays, const double *values)
{
    for (size_t i = 0; i < sizeof INPUT_FROM / sizeof *INPUT_FROM; i++)
        arrays->given[INPUT_FROM[i].place] = values[INPUT_FROM[i].reference];
}

/* Put the outputs of the kernels into the values; the force on a point is the sum of those of its lines. */
static void show(const Arrays *arrays, double *values)
{
    for (int i = OUTPUTS_AT; i < PARAMETERS_AT; i++) values[i] = 0.0;
    for (size_t i = 0; i < sizeof OUTPUT_FROM / sizeof *OUTPUT_FROM; i++)
        values[OUTPUT_FROM[i].reference] += arrays->found[OUTPUT_FROM[i].place];
    for (int i = 0; i < MOTIONS; i++) {
        int64_t n = of_line(arrays, MOTION[i].line, PLAN_SEGMENTS);
        int64_t node = 3 * (MOTION[i].is_end ? n : 0) + 3 * (MOTION[i].component / 3) * (n + 1);
        values[MOTION[i].reference] = state_of(arrays, MOTION[i].line)[AT_STATE_HEADER + node + MOTION[i].component % 3];
    }
}

/* First shapes for the inputs in `values`, which get its outputs; returns the kernel's status. */
int32_t first_shape(Arrays *arrays, double *values)
{
    give(arrays, values);
    int32_t result = KERNEL(initialize)(
        IN(arrays->memory) arrays->plan, arrays->parameters, arrays->given, arrays->state, arrays->spare, arrays->found,
        arrays->work);
    if (!result) show(arrays, values);
    return result;
}

/* One communication step [s] of the state with the inputs in `values`, which get its outputs; `before` gets the state of
before. Returns the kernel's status: where that is not 0, state and outputs are as they were. */
int32_t do_step(Arrays *arrays, double step, double *before, double *values)
{
    give(arrays, values);
    int32_t result = KERNEL(advance)(
        IN(arrays->memory) arrays->plan, arrays->parameters, arrays->given, step, arrays->state, before, arrays->found,
        arrays->work);
    if (!result) show(arrays, values);
    return result;
}

/* Outputs in `values` that belong to the state; returns the kernel's status. */
int32_t take_outputs(Arrays *arrays, double *values)
{
    int32_t result = KERNEL(outputs)(
        IN(arrays->memory) arrays->plan, arrays->parameters, arrays->state, arrays->found, arrays->work);
    if (!result) show(arrays, values);
    return result;
}

/* What the status of a kernel means for a step [s], or for the start, with the inputs and the unstretched length of now. */
void sentence_of(
    char text[LONGEST_TEXT], const Arrays *arrays, const double *values, int32_t result, double step, bool at_start)
{
    int about = (int)arrays->plan[PLAN_STATUS_LINE], line = about < 0 ? 0 : about, place = index_of(result);
    char said[LONGEST_TEXT], vector[LONGEST_TEXT];
    if (about < 0 && code_of(result) == INPUT_NOT_FINITE) { /* a load */
        const double *load = arrays->given + AT_INPUTS * LINES + 3 * place;
        fill_in(said, sizeof said, "{point}.load", FACTS(word("point", FREE_POINT_NAME[place])));
        fill_in(vector, sizeof vector, "[{x}, {y}, {z}]", FACTS(real("x", load[0]), real("y", load[1]), real("z", load[2])));
        fill_in(text, LONGEST_TEXT, KERNEL_SENTENCE[INPUT_NOT_FINITE], FACTS(word("name", said), word("value", vector)));
        return;
    }
    if (code_of(result) == NO_EQUILIBRIUM_OF_POINT) {
        fill_in(text, LONGEST_TEXT, KERNEL_SENTENCE[NO_EQUILIBRIUM_OF_POINT], FACTS(word("name", FREE_POINT_NAME[place])));
        return;
    }
    const double *parameters = parameters_of(arrays, line);
    const double *inputs = arrays->given + AT_INPUTS * line;
    bool is_input = place < AT_INPUTS;
    fill_sentence(said, result, step, (About){
        .name = is_input ? LINE_INPUT_NAME[line][place] : "",
        .value = is_input ? inputs[place] : 0.0,
        .inputs = inputs,
        .parameters = parameters,
        .length = at_start ? parameters[AT_INITIAL_LENGTH] : state_of(arrays, line)[AT_LENGTH],
        .segments = about < 0 ? arrays->segments : segments_of(arrays, line)});
    fill_in(text, LONGEST_TEXT, about < 0 ? "{said}" : "the line {line}: {said}", FACTS(
        word("line", LINE_NAME[line]), word("said", said)));
}
