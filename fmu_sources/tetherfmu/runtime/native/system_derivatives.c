/* What of derivatives.c is that of a system: where derivatives of its inputs wait, and their scales. */
#include "derivatives.h"

#include <math.h>

#include "instance.h"

enum { ROWS = sizeof INPUT_FROM / sizeof *INPUT_FROM, INPUTS_OF_LINES = AT_INPUTS * LINES };

static bool is_at_point(const Arrays *arrays, int line, bool at_end, int point)
{
    return arrays->plan[PLAN_HEADER + PLAN_LINE_NUMBERS * line + (at_end ? PLAN_END_POINT : PLAN_START_POINT)] == point;
}

/* Let the state of a line have the derivative of an input of it. */
static void put_in_line(const Arrays *arrays, int line, int place, double value)
{
    double *given = state_of(arrays, line) + AT_GIVEN_DERIVATIVES;
    *given = (double)((uint32_t)*given | 1u << place);
    state_of(arrays, line)[AT_INPUT_DERIVATIVES + place] = value;
}

/* The same of a component of the load on a free point. It waits in all lines there, in the place of the acceleration that a
driven end would have, see `lines.take_load_rates`. */
static void put_rate_of_load(const Arrays *arrays, int point, int component, double value)
{
    for (int k = 0; k < LINES; k++) {
        if (is_at_point(arrays, k, false, point)) put_in_line(arrays, k, AT_GROUND_VELOCITY + component, value);
        if (is_at_point(arrays, k, true, point)) put_in_line(arrays, k, AT_KITE_VELOCITY + component, value);
    }
}

/* The same of an input of the system, in all lines that have it. */
static void put_in_lines(const Arrays *arrays, unsigned reference, double value)
{
    for (int i = 0; i < ROWS; i++) {
        int place = INPUT_FROM[i].place, of_load = place - INPUTS_OF_LINES;
        if (INPUT_FROM[i].reference != (int)reference) continue;
        if (of_load >= 0) put_rate_of_load(arrays, of_load / 3, of_load % 3, value);
        else put_in_line(arrays, place / AT_INPUTS, place % AT_INPUTS, value);
    }
}

/* Keep the derivative of an input for the next step; before the first one with a mark that it is given. */
void keep_derivative(Instance *instance, unsigned reference, double value)
{
    if (instance->phase >= STEPPING) {
        put_in_lines(instance->arrays, reference, value);
        return;
    }
    instance->derivatives[reference] = value;
    instance->derivatives[INPUTS + reference] = 1.0;
}

/* Hand over what was given before the first step to the state of the start. */
void give_derivatives(Instance *instance)
{
    for (unsigned i = 0; i < INPUTS; i++)
        if (instance->derivatives[INPUTS + i] != 0.0) put_in_lines(instance->arrays, i, instance->derivatives[i]);
}

/* Scale of an input, see `scale_in_line`: the smallest one of the lines that have it. */
double scale_of(const Arrays *arrays, unsigned input, double step, double part)
{
    double least = INFINITY;
    for (int i = 0; i < ROWS; i++) {
        int place = INPUT_FROM[i].place, of_load = place - INPUTS_OF_LINES;
        if (INPUT_FROM[i].reference != (int)input) continue;
        if (of_load < 0) least = fmin(least, scale_in_line(arrays, place / AT_INPUTS, place % AT_INPUTS, step, part));
        for (int k = 0; of_load >= 0 && k < LINES; k++)
            if (is_at_point(arrays, k, false, of_load / 3) || is_at_point(arrays, k, true, of_load / 3))
                least = fmin(least, scale_in_line(arrays, k, AT_KITE_LOAD, step, part));
    }
    return least;
}
