/* Sentences for the status of a kernel, about a tether or a line of a system. */
#include "arrays.h"

#include <math.h>

#include "kernels.h"
#include "messages.h"

bool is_integer(double value)
{
    return value == floor(value);
}

/* The sentence of a status for a step [s], into `text`. */
void fill_sentence(char text[LONGEST_TEXT], int32_t result, double step, About about)
{
    double square = 0.0, longest = about.parameters[AT_LONGEST_LENGTH];
    for (int i = 0; i < 3; i++) {
        double way = about.inputs[AT_KITE_POSITION + i] - about.inputs[AT_GROUND_POSITION + i];
        square += way * way;
    }
    fill_in(text, LONGEST_TEXT, KERNEL_SENTENCE[code_of(result)], FACTS(
        word("name", about.name),
        real("value", about.value),
        real("step", step),
        real("reel_out_speed", about.inputs[AT_REEL_OUT_SPEED]),
        real("winch_force", about.inputs[AT_WINCH_FORCE]),
        real("winch_length", about.inputs[AT_WINCH_LENGTH]),
        real("friction", about.parameters[AT_WINCH_FRICTION]),
        real("ground_height", about.parameters[AT_GROUND_HEIGHT]),
        real("shortest_stop", about.parameters[AT_SHORTEST_LENGTH]),
        real("least_length", about.parameters[AT_LEAST_LENGTH]),
        real("longest_stop", longest == AT_NO_STOP ? INFINITY : longest),
        real("length", about.length),
        real("distance", sqrt(square)),
        real("relative_tolerance", about.parameters[AT_RELATIVE_TOLERANCE]),
        real("fixed_step", about.parameters[AT_FIXED_STEP]),
        whole("budget", (double)(AT_ITERATION_BUDGET / about.segments))));
}
