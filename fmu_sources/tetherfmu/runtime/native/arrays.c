/* The arrays of the kernels (plan_layout.py), and the calls of the kernels. tables.h defines the place of each variable in
them; for a single tether its inputs and outputs are those arrays (DIRECT). */
#include "arrays.h"

#include <string.h>

#include "instance.h"
#include "kernels.h"
#include "messages.h"
#include "room.h"

static int64_t of_line(const Arrays *arrays, int line, int which)
{
    return arrays->plan[PLAN_HEADER + PLAN_LINE_NUMBERS * line + which];
}

double *state_of(const Arrays *arrays, int line)
{
    return arrays->state + of_line(arrays, line, PLAN_STATE_AT);
}

double *parameters_of(const Arrays *arrays, int line)
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

/* Quantities of a line in the order of the kernel `pack`. */
static void quantities_of(const double *values, int line, double *quantities)
{
    for (int i = 0; i < QUANTITIES; i++) {
        int reference = QUANTITY_FROM[line][i];
        quantities[i] = reference < 0 ? QUANTITY_DEFAULT[line][i] : values[reference];
    }
}

/* Allocate the arrays for values, in one block; NULL without memory. */
Arrays *make_arrays(Instance *instance, const double *values)
{
    int64_t *plan = instance->plan, segments = 0;
    memcpy(plan, GIVEN_PLAN, sizeof GIVEN_PLAN);
    for (int i = 0; i < STARTS; i++) plan[START_FROM[i].place] = values[START_FROM[i].reference] == AT_START_AT_REST;
    for (int k = 0; k < LINES; k++) {
        quantities_of(values, k, instance->quantities);
        int64_t n = KERNEL(segments)(IN(memory_of(instance)) 1, instance->quantities);
        plan[PLAN_HEADER + PLAN_LINE_NUMBERS * k + PLAN_SEGMENTS] = n;
        segments += n;
    }
    KERNEL(complete)(IN(memory_of(instance)) plan);
    size_t parameters = (size_t)plan[PLAN_PARAMETERS_SIZE], state = (size_t)plan[PLAN_STATE_SIZE];
    size_t inputs = DIRECT ? 0 : (size_t)plan[PLAN_INPUTS_SIZE], outputs = DIRECT ? 0 : (size_t)plan[PLAN_OUTPUTS_SIZE];
    size_t work = (size_t)plan[PLAN_WORK_SIZE];
    size_t numbers = PLAN_SIZE + parameters + inputs + STATES_HELD * state + outputs + work + VALUES;
    Arrays *arrays = take_room(instance, sizeof *arrays + numbers * sizeof(double));
    if (!arrays) return NULL;
#if KERNELS_IN_C
    arrays->memory = memory_of(instance);
#endif
    arrays->segments = segments;
    arrays->quantities = instance->quantities;
    arrays->plan = (int64_t *)(arrays + 1);
    memcpy(arrays->plan, plan, sizeof instance->plan);
    arrays->parameters = (double *)(arrays->plan + PLAN_SIZE);
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

/* --- parameters */

/* A quantity for a message: Integers and Enumerations without a fraction, if they have none. */
static Fact fact_of(const char *key, const double *quantities, int line, int place)
{
    int reference = QUANTITY_FROM[line][place];
    double value = quantities[place];
    bool is_whole = reference >= 0 && PARAMETER[reference - PARAMETERS_AT].kind != REAL && is_integer(value);
    return is_whole ? whole(key, value) : real(key, value);
}

/* Whether the parameters of free points, which the kernels do not check, are allowed; otherwise `problem` is filled in. */
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

/* A sentence on a line, with its name if it has one; line : -1 for none. */
void about_line(char *text, int line, const char *said)
{
    const char *name = line < 0 ? "" : LINE_NAME[line];
    char own[LONGEST_TEXT];
    rename_in(own, sizeof own, said, WORDS + WORDS_AT[line + 1]);
    fill_in(text, LONGEST_TEXT, *name ? "the line {line}: {said}" : "{said}", FACTS(word("line", name), word("said", own)));
}

/* Describe the problem with the quantities of a line. */
static void refuse_quantities(const double *quantities, int line, int32_t result, char *problem)
{
    char said[LONGEST_TEXT];
    int place = index_of(result), reference = QUANTITY_FROM[line][place];
    bool is_alone = code_of(result) == PARAMETER_OUT_OF_RANGE || code_of(result) == PARAMETER_NOT_WHOLE;
    fill_in(said, LONGEST_TEXT, KERNEL_SENTENCE[code_of(result)], FACTS(
        word("name", reference < 0 ? "" : PARAMETER[reference - PARAMETERS_AT].name),
        word("range", reference < 0 ? "" : PARAMETER[reference - PARAMETERS_AT].range),
        fact_of("value", quantities, line, place),
        fact_of("roughness", quantities, line, QUANTITY_SURFACE_ROUGHNESS),
        fact_of("height", quantities, line, QUANTITY_WIND_REFERENCE_HEIGHT),
        fact_of("length", quantities, line, QUANTITY_INITIAL_LENGTH),
        fact_of("shortest_stop", quantities, line, QUANTITY_SHORTEST_LENGTH),
        fact_of("longest_stop", quantities, line, QUANTITY_LONGEST_LENGTH),
        fact_of("segments", quantities, line, QUANTITY_SEGMENTS)));
    about_line(problem, is_alone ? -1 : line, said);
}

/* Write into the parameters of a line which of its ends are free points, and its share of their masses. */
static void put_ends(const Arrays *arrays, int line)
{
    static const int IS_FREE[2] = {AT_GROUND_IS_FREE, AT_KITE_IS_FREE};
    double *parameters = parameters_of(arrays, line);
    int64_t n = segments_of(arrays, line);
    for (int end = 0; end < 2; end++) {
        if (of_line(arrays, line, PLAN_START_POINT + end) < 0) continue;
        parameters[IS_FREE[end]] = 1.0;
        if (CARRIED[line][end] < 0) continue;
        parameters[AT_PARAMETER_SCALARS + AT_SEGMENT_PROPERTIES * n + end * n] = arrays->values[CARRIED[line][end]];
    }
}

/* Write the portion number, if any, and the sheave at its end into the parameters of a line. */
static void put_sheave(const Arrays *arrays, int line)
{
    double *parameters = parameters_of(arrays, line), *values = arrays->values;
    if (!SHEAVE[line].kind) return;
    parameters[AT_IS_PORTION] = SHEAVE[line].kind;
    parameters[AT_GIVEN_PORTION] = values[SHEAVE[line].portion];
    parameters[AT_SHEAVE_MASS] = SHEAVE[line].mass < 0 ? 0.0 : values[SHEAVE[line].mass];
    parameters[AT_SHEAVE_FRICTION] = SHEAVE[line].friction < 0 ? 0.0 : values[SHEAVE[line].friction];
    parameters[AT_SHEAVE_EFFICIENCY] = SHEAVE[line].efficiency < 0 ? 1.0 : values[SHEAVE[line].efficiency];
}

/* Write the drums that drive force-controlled lines into their parameters. */
static void put_holders(const Arrays *arrays)
{
    for (int i = 0; i < HOLDERS; i++) {
        double *parameters = parameters_of(arrays, HOLDER[i].line);
        if (parameters[AT_WINCH_CONTROL] == AT_WINCH_BY_FORCE) parameters[HOLDER[i].place] = HOLDER_NUMBER[i];
    }
}

/* Whether all parameters are allowed, alone and together, and passed to the kernels; otherwise `problem` (of LONGEST_TEXT
bytes) describes the problem. */
bool pack_parameters(const Arrays *arrays, double importer_tolerance, char *problem)
{
    double *quantities = arrays->quantities;
    if (!check_points(arrays->values, problem)) return false;
    for (int k = 0; k < LINES; k++) {
        quantities_of(arrays->values, k, quantities);
        int32_t result = KERNEL(pack)(
            IN(arrays->memory) 1, FREE_KITE, quantities, importer_tolerance, parameters_of(arrays, k));
        if (result) {
            refuse_quantities(quantities, k, result, problem);
            return false;
        }
        put_ends(arrays, k);
        put_sheave(arrays, k);
        if (!of_line(arrays, k, PLAN_WIND_POINTS)) continue;
        parameters_of(arrays, k)[AT_WIND_POINTS] = (double)of_line(arrays, k, PLAN_WIND_POINTS);
        parameters_of(arrays, k)[AT_WIND_PROFILE] = AT_AT_NODES;
    }
    put_holders(arrays);
    return true;
}

/* --- starts, steps and outputs

Inputs and outputs of the kernels are among the values, or separate if their variables are elsewhere. */
static double *inputs_in(const Arrays *arrays, double *values)
{
    return DIRECT ? values : arrays->given;
}

static double *outputs_in(const Arrays *arrays, double *values)
{
    return DIRECT ? values + OUTPUTS_AT : arrays->found;
}

/* Copy the inputs among the values to the array of the kernels, unless they are identical; lines on shared winches have sums. */
static void give(const Arrays *arrays, const double *values)
{
    for (int i = 0; !DIRECT && i < INPUTS_FROM; i++)
        arrays->given[INPUT_FROM[i].place] = values[INPUT_FROM[i].reference];
    for (int i = 0; i < HELD_TERMS; i++) arrays->given[HELD[i].place] = 0.0;
    for (int i = 0; i < HELD_TERMS; i++) arrays->given[HELD[i].place] += HELD_FACTOR[i] * values[HELD[i].reference];
}

/* Copy the outputs of the kernels to the values if the status is 0, and return it; the force on a point is the sum over its
lines. */
static int32_t show(const Arrays *arrays, double *values, int32_t result)
{
    if (result || DIRECT) return result;
    for (int i = OUTPUTS_AT; i < PARAMETERS_AT; i++) values[i] = 0.0;
    for (int i = 0; i < OUTPUTS_FROM; i++) values[OUTPUT_FROM[i].reference] += arrays->found[OUTPUT_FROM[i].place];
    for (int i = 0; i < MOTIONS; i++) {
        int64_t n = of_line(arrays, MOTION[i].line, PLAN_SEGMENTS) + (int64_t)state_of(arrays, MOTION[i].line)[AT_LET_GO];
        int64_t node = 3 * (MOTION[i].is_end ? n : 0) + 3 * (MOTION[i].component / 3) * (n + 1);
        values[MOTION[i].reference] = state_of(arrays, MOTION[i].line)[AT_STATE_HEADER + node + MOTION[i].component % 3];
    }
    for (int i = 0; i < TURNED_TERMS; i++) {
        double before = TURNED[i].less < 0 ? 0.0 : values[TURNED[i].less];
        values[TURNED[i].reference] += TURNED_FACTOR[i] * (arrays->found[TURNED[i].place] - before);
    }
    return 0;
}

/* Solve the initial shapes for the inputs in `values`, and write its outputs; returns the kernel's status. */
int32_t first_shape(Arrays *arrays, double *values)
{
#if FREE_KITE
    memcpy(values + AT_KITE_POSITION, values + PARAMETERS_AT + INITIAL_KITE_POSITION, KITE_MOTION * sizeof(double));
#endif
    give(arrays, values);
    return show(arrays, values, KERNEL(initialize)(
        IN(arrays->memory) arrays->plan, arrays->parameters, inputs_in(arrays, values), arrays->state,
        outputs_in(arrays, values), arrays->work));
}

/* One communication step [s] of the state with the inputs in `values`, which receive its outputs; `before` receives the
earlier state. Returns the kernel's status: if it is not 0, state and outputs are unchanged. */
int32_t do_step(Arrays *arrays, double step, double *before, double *values)
{
    give(arrays, values);
    return show(arrays, values, KERNEL(advance)(
        IN(arrays->memory) arrays->plan, arrays->parameters, inputs_in(arrays, values), step, arrays->state, before,
        outputs_in(arrays, values), arrays->work));
}

/* Write the outputs of the state to `values`; returns the kernel's status. */
int32_t take_outputs(Arrays *arrays, double *values)
{
    return show(arrays, values, KERNEL(outputs)(
        IN(arrays->memory) arrays->plan, arrays->parameters, inputs_in(arrays, values), arrays->state,
        outputs_in(arrays, values), arrays->work));
}

/* --- refusals */

/* Describe the status of a kernel for a step [s], or for the start, with the present inputs and unstretched length. */
void sentence_of(char text[LONGEST_TEXT], const Arrays *arrays, const double *values, int32_t result, double step)
{
    int about = (int)arrays->plan[PLAN_STATUS_LINE], line = about < 0 ? 0 : about, place = index_of(result);
    char said[LONGEST_TEXT], vector[LONGEST_TEXT];
    if (about < 0 && code_of(result) == INPUT_NOT_FINITE) { /* a load */
        const double *load = arrays->given + arrays->plan[PLAN_INPUTS_SIZE] + 3 * (place - FREE_POINTS);
        fill_in(said, sizeof said, "{point}.load", FACTS(word("point", FREE_POINT_NAME[place])));
        fill_in(vector, sizeof vector, "[{x}, {y}, {z}]", FACTS(real("x", load[0]), real("y", load[1]), real("z", load[2])));
        fill_in(text, LONGEST_TEXT, KERNEL_SENTENCE[INPUT_NOT_FINITE], FACTS(word("name", said), word("value", vector)));
        return;
    }
    if (code_of(result) == NO_EQUILIBRIUM_OF_POINT) {
        fill_in(text, LONGEST_TEXT, KERNEL_SENTENCE[NO_EQUILIBRIUM_OF_POINT], FACTS(word("name", FREE_POINT_NAME[place])));
        return;
    }
    const double *inputs = DIRECT ? values : arrays->given + of_line(arrays, line, PLAN_INPUTS_AT);
    bool is_input = place < INPUTS_OF_A_LINE;
    fill_sentence(said, result, step, (About){
        .name = is_input ? LINE_INPUT_NAME[line][place] : "",
        .value = is_input ? inputs[place] : 0.0,
        .inputs = inputs,
        .parameters = parameters_of(arrays, line),
        .length = state_of(arrays, line)[AT_LENGTH],
        .segments = about < 0 ? arrays->segments : segments_of(arrays, line)});
    about_line(text, about, said);
}
