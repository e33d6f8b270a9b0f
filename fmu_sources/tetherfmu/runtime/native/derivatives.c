/* Input derivatives, which the importer sets for the next step, and output derivatives by inputs, which it requests. */
#include "derivatives.h"

#include <math.h>
#include <string.h>

#include "instance.h"

/* --- derivatives of inputs */

/* Whether the line of a term also has a term of another shared winch. */
static bool is_held_twice(int term)
{
    for (int i = 0; i < HELD_TERMS; i++)
        if (i != term && HELD[i].place == HELD[term].place && HELD[i].reference < INPUTS) return true;
    return false;
}

static Status check_derivative(Instance *instance, unsigned reference, int32_t order, double value)
{
    if (!(kind_of(reference, REAL) & INPUT))
        return say(instance, ERROR, NO_CONTINUOUS_INPUT, FACTS(VARIABLE(reference)));
    Fact name = word("name", INPUT_NAME[reference]);
    if (instance->phase == TERMINATED) return say(instance, ERROR, NOT_AFTER_THE_END, FACTS(name, real("value", value)));
    if (order != 1) return say(instance, ERROR, WRONG_ORDER, FACTS(name, whole("order", order)));
    for (int i = 0; i < HELD_TERMS; i++)
        if (HELD[i].reference == (int)reference && is_held_twice(i)) return say(instance, ERROR, SHARED_DERIVATIVE, FACTS(name));
    if (fabs(value) <= AT_LARGEST_INPUT) return OK;
    return say(instance, ERROR, WRONG_DERIVATIVE, FACTS(name, real("value", value), real("largest", AT_LARGEST_INPUT)));
}

/* --- storage: in the states of the lines; before the first step, in the instance */

static bool is_at_point(const Arrays *arrays, int line, int end, int point)
{
    return arrays->plan[PLAN_HEADER + PLAN_LINE_NUMBERS * line + PLAN_START_POINT + end] == point;
}

/* Store the derivative of an input in the state of its line. */
static void put_in_line(const Arrays *arrays, int line, int place, double value)
{
    double *given = state_of(arrays, line) + AT_GIVEN_DERIVATIVES;
    *given = (double)((uint32_t)*given | 1u << place);
    state_of(arrays, line)[AT_INPUT_DERIVATIVES + place] = value;
}

/* Store the derivative of a load component on a free point. All lines there store it, in the place of the acceleration of a
driven end, see `free_points.places_of_load`. */
static void put_rate_of_load(const Arrays *arrays, int point, int component, double value)
{
    for (int k = 0; k < LINES; k++) {
        if (is_at_point(arrays, k, 0, point)) put_in_line(arrays, k, AT_GROUND_VELOCITY + component, value);
        if (is_at_point(arrays, k, 1, point)) put_in_line(arrays, k, AT_KITE_VELOCITY + component, value);
    }
}

/* Store the derivative of an input in all its lines. The last numbers of the state of a line are derivatives of the wind at
its points, 0 if none is set. */
static void put_in_lines(const Arrays *arrays, unsigned reference, double value)
{
    for (int i = 0; i < INPUTS_FROM; i++) {
        int line = INPUT_FROM[i].line, own = INPUT_FROM[i].own;
        if (INPUT_FROM[i].reference != (int)reference) continue;
        if (line < 0) put_rate_of_load(arrays, own / 3, own % 3, value);
        else if (own < AT_INPUTS) put_in_line(arrays, line, own, value);
        else state_of(arrays, line)[state_size_of(arrays, line) + own - INPUTS_OF_A_LINE] = value;
    }
    for (int i = 0; i < HELD_TERMS; i++)
        if (HELD[i].reference == (int)reference) put_in_line(arrays, HELD[i].line, HELD[i].own, HELD_FACTOR[i] * value);
}

static void keep_derivative(Instance *instance, unsigned reference, double value)
{
    if (instance->phase >= STEPPING) {
        put_in_lines(instance->arrays, reference, value);
        return;
    }
    instance->derivatives[reference] = value;
    instance->has_derivative[reference] = true;
}

/* End initialization. The initial state receives the derivatives that were set before. */
Status begin_steps(Instance *instance)
{
    if (exit_initialization(instance) != OK) return ERROR;
    for (unsigned i = 0; i < INPUTS; i++)
        if (instance->has_derivative[i]) put_in_lines(instance->arrays, i, instance->derivatives[i]);
    return OK;
}

/* Store first derivatives of inputs for the next step: all or none. */
Status set_input_derivatives(
    Instance *instance, const unsigned *references, size_t count, const int32_t *orders, const double *values)
{
    for (size_t i = 0; i < count; i++)
        if (check_derivative(instance, references[i], orders[i], values[i]) != OK) return ERROR;
    for (size_t i = 0; i < count; i++) keep_derivative(instance, references[i], values[i]);
    return OK;
}

/* --- derivatives of outputs by inputs: differences of the last step, repeated with other inputs

Inputs change by fractions of their scales. Internal steps must not change, so a tether with internal steps uses small
fractions; the others are in an equilibrium whose iteration ends at 1e-9. A smaller fraction is tried if the end forces are
not smooth over the first one. */
enum { PARTS = 3 };
static const double PARTS_WITH_STEPS[PARTS] = {1e-7, 1e-8, 1e-9}, PARTS_WITHOUT_STEPS[PARTS] = {1e-5, 1e-6, 1e-7};
static const double SAME_STEP = 1e-3; /* relative difference of the next internal step: larger after other ones */
static const double SMOOTH = 1e-3;    /* difference of both sides over the larger: twice the error of a one-sided kink */
static const double ONE_SIDED = 1.0;  /* error assigned to a one-sided difference */
static const double SLOW = 1e-3;      /* [m/s], largest change of a velocity that is derived from a position */

/* Scale of an input of a line, in its unit, as runtime/inputs.py declares it. step : [s], 0 for the start. part : the
largest factor on it: a position with a derived velocity changes this velocity by at most `SLOW`. */
static double scale_in_line(const Arrays *arrays, int line, unsigned place, double step, double part)
{
    const double *state = state_of(arrays, line), *parameters = parameters_of(arrays, line);
    const double *before = arrays->before + (state - arrays->state);
    int64_t n = segments_of(arrays, line);
    double segment = (step > 0.0 ? state[AT_LENGTH] : parameters[AT_INITIAL_LENGTH]) / (double)n;
    double way = step > 0.0 ? SLOW / part * before[AT_LAST_STEP] : 0.0; /* 0 without derived velocities */
    bool sets_velocity = parameters[AT_END_VELOCITIES] == AT_DERIVED && way > 0.0;
    switch (INPUT_SCALE[place]) {
    case SCALE_SEGMENT_LENGTH: return sets_velocity && way < segment ? way : segment;
    case SCALE_STIFFNESS: return parameters[AT_PARAMETER_SCALARS + AT_STIFFNESS * n];
    case SCALE_FAST_WIND: return FAST_WIND_SPEED;
    default: return segment < FAST_END_SPEED * step ? segment / step : FAST_END_SPEED; /* SCALE_SEGMENT_PER_STEP */
    }
}

/* `scale_of` a load on a free point: the smallest scale of a kite load at the line ends there. */
static double scale_of_load(const Arrays *arrays, int point, double step, double part)
{
    double least = INFINITY;
    for (int k = 0; k < LINES; k++) {
        if (!is_at_point(arrays, k, 0, point) && !is_at_point(arrays, k, 1, point)) continue;
        double scale = scale_in_line(arrays, k, AT_KITE_LOAD, step, part);
        if (scale < least) least = scale;
    }
    return least;
}

/* `scale_of` an input of the FMU: the smallest scale of its lines. */
static double scale_of(const Arrays *arrays, unsigned input, double step, double part)
{
    double least = INFINITY, scale;
    for (int i = 0; i < INPUTS_FROM; i++) {
        int line = INPUT_FROM[i].line, own = INPUT_FROM[i].own;
        if (INPUT_FROM[i].reference != (int)input) continue;
        scale = line < 0 ? scale_of_load(arrays, own / 3, step, part) : scale_in_line(arrays, line, own, step, part);
        if (scale < least) least = scale;
    }
    for (int i = 0; i < HELD_TERMS; i++) {
        if (HELD[i].reference != (int)input) continue;
        scale = scale_in_line(arrays, HELD[i].line, (unsigned)HELD[i].own, step, part) / fabs(HELD_FACTOR[i]);
        if (scale < least) least = scale;
    }
    return least;
}

/* Repeat the last step, or the start if `step` is 0, with the inputs in `values`, which receive the outputs; returns the
kernel's status. The tether does not change. */
static int32_t repeat(const Arrays *arrays, double step, double *values)
{
    Arrays trial = *arrays;
    trial.state = arrays->spare;
    if (!(step > 0.0)) return first_shape(&trial, values);
    memcpy(trial.state, arrays->before, STATE_SIZE(arrays->segments) * sizeof(double));
    return do_step(&trial, step, arrays->before, values); /* `before` is unchanged */
}

/* Whether two outputs have the same slack segments, so that no kink of the forces lies in between. */
static bool is_on_same_side(const double *values, const double *others)
{
    for (int k = 0; HAS_KINK && k < LINES; k++)
        if (values[SLACK_SEGMENTS_AT[k]] != others[SLACK_SEGMENTS_AT[k]]) return false;
    return true;
}

/* Whether the repeated step used the same internal steps. */
static bool took_same_steps(const Arrays *arrays)
{
    const double *before = arrays->state, *after = arrays->spare;
    double next = before[AT_SOLVER_STEP], off = fabs(after[AT_SOLVER_STEP] - next);
    bool as_many = before[AT_STEPS] == after[AT_STEPS] && before[AT_REJECTIONS] == after[AT_REJECTIONS];
    return as_many && off <= SAME_STEP * next;
}

/* Repeat it with inputs changed along a direction by this amount; returns whether it is comparable. */
static bool repeat_with(
    const Arrays *arrays, double step, const double *values, const double *direction, double by, double *changed)
{
    memcpy(changed, values, VALUES * sizeof(double));
    memcpy(changed, arrays->inputs, sizeof arrays->inputs);
    for (int i = 0; i < INPUTS; i++) changed[i] += by * direction[i];
    bool is_done = !repeat(arrays, step, changed) && (!(step > 0.0) || took_same_steps(arrays));
    return is_done && is_on_same_side(changed, values);
}

/* Difference between the changes of the end forces (of lines) to both sides, relative to the larger change. */
static double asymmetry(const double *before, const double *values, const double *after)
{
    double difference = 0.0, larger = 0.0;
    for (size_t k = 0; k < sizeof FORCE_AT / sizeof *FORCE_AT; k++) {
        unsigned i = FORCE_AT[k];
        double backwards = values[i] - before[i], forwards = after[i] - values[i];
        difference = fmax(difference, fabs(forwards - backwards));
        larger = fmax(larger, fmax(fabs(forwards), fabs(backwards)));
    }
    return larger > 0.0 ? difference / larger : 0.0;
}

/* Difference quotient of all values into `quotient`: two-sided, or one-sided if the other side is not comparable. Returns
its doubtfulness: `asymmetry`, `ONE_SIDED`, or infinity if neither side is. room : of VALUES. */
static double find_quotient(
    const Arrays *arrays, double step, const double *values, const double *direction, double by, double *quotient,
    double *room)
{
    bool forwards = repeat_with(arrays, step, values, direction, by, quotient);
    bool backwards = repeat_with(arrays, step, values, direction, -by, room);
    if (!forwards && !backwards) return INFINITY;
    double doubt = forwards && backwards ? asymmetry(room, values, quotient) : ONE_SIDED;
    const double *last = forwards ? quotient : values, *first = backwards ? room : values;
    double distance = forwards && backwards ? 2.0 * by : by;
    for (int i = 0; i < VALUES; i++) quotient[i] = (last[i] - first[i]) / distance;
    return doubt;
}

/* Derivative of all values along a direction of the inputs into `derivative`, the least doubtful one; false if there is
none. room : of 2 VALUES. */
static bool differentiate(
    const Arrays *arrays, double step, const double *values, const double *direction, double *derivative, double *room)
{
    const double *parts = arrays->state[AT_STEPS] > 0.0 ? PARTS_WITH_STEPS : PARTS_WITHOUT_STEPS;
    double largest = 0.0;
    for (unsigned i = 0; i < INPUTS; i++) {
        double size = fabs(direction[i]) / scale_of(arrays, i, step, parts[0]);
        if (size > largest) largest = size;
    }
    memset(derivative, 0, VALUES * sizeof(double));
    if (!(largest > 0.0)) return true;
    double least = INFINITY, *quotient = room;
    for (int k = 0; k < PARTS && !(least <= SMOOTH); k++) {
        double doubt = find_quotient(arrays, step, values, direction, parts[k] / largest, quotient, room + VALUES);
        if (!(doubt < least)) continue;
        least = doubt;
        memcpy(derivative, quotient, VALUES * sizeof(double));
    }
    return least < INFINITY;
}

/* Check the variables and their numbers, and convert the seed to a direction of the inputs. */
static Status read_direction(
    Instance *instance, const unsigned *unknowns, size_t count, const unsigned *knowns, size_t known_count,
    const double *seed, size_t seeds, size_t room, double *direction)
{
    for (size_t i = 0; i < count; i++)
        if (!(kind_of(unknowns[i], REAL) & OUTPUT))
            return say(instance, ERROR, NO_CONTINUOUS_OUTPUT, FACTS(VARIABLE(unknowns[i])));
    for (size_t i = 0; i < known_count; i++)
        if (!(kind_of(knowns[i], REAL) & INPUT))
            return say(instance, ERROR, NO_CONTINUOUS_INPUT, FACTS(VARIABLE(knowns[i])));
    if (check_count(instance, unknowns, count, room) != OK) return ERROR;
    if (check_count(instance, knowns, known_count, seeds) != OK) return ERROR;
    for (size_t i = 0, k = 0; i < known_count; i++)
        for (unsigned j = 0; j < WIDTH[knowns[i]]; j++, k++) {
            if (!(fabs(seed[k]) <= AT_LARGEST_INPUT))
                return say(instance, ERROR, WRONG_SEED, FACTS(real("value", seed[k]), real("largest", AT_LARGEST_INPUT)));
            direction[knowns[i] + j] += seed[k];
        }
    return OK;
}

/* The arrays of the last step, or of a start with the present inputs, to be differentiated. NULL, and a message, if there
are none. */
static Arrays *differentiable(Instance *instance)
{
    Arrays *arrays = instance->arrays;
    if (instance->phase == INITIALIZING) {
        if (start(instance, DISCARD) != OK) return NULL;
        arrays = instance->arrays;
        memcpy(arrays->inputs, instance->values, sizeof arrays->inputs);
        return arrays;
    }
    if (instance->phase >= STEPPING && arrays->is_repeatable) return arrays;
    say(instance, DISCARD, NOTHING_TO_DIFFERENTIATE, NULL);
    return NULL;
}

/* Change of outputs along a direction of inputs: for the last step, by its inputs; in initialization mode for the start. */
Status directional_derivative(
    Instance *instance, const unsigned *unknowns, size_t count, const unsigned *knowns, size_t known_count,
    const double *seed, size_t seeds, double *sensitivity, size_t room)
{
    double direction[INPUTS] = {0.0};
    if (read_direction(instance, unknowns, count, knowns, known_count, seed, seeds, room, direction) != OK) return ERROR;
    Arrays *arrays = differentiable(instance);
    if (!arrays) return DISCARD;
    double *derivative = instance->scratch;
    double step = instance->phase == INITIALIZING ? 0.0 : arrays->state[AT_LAST_STEP];
    bool found = differentiate(arrays, step, instance->values, direction, derivative, derivative + VALUES);
    for (size_t i = 0, k = 0; found && i < count; i++)
        for (unsigned j = 0; j < WIDTH[unknowns[i]]; j++, k++) sensitivity[k] = derivative[unknowns[i] + j];
    return found ? OK : say(instance, DISCARD, NO_DERIVATIVE, NULL);
}
