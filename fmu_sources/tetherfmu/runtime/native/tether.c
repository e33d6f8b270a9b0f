/* The life of a tether: phases, values, start and steps. A call that is refused leaves everything as it was. */
#include "tether.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const char THIS_FMU = 0;
const char *const CATEGORY[] = {"logStatusOK", "logStatusWarning", "logStatusDiscard", "logStatusError"};

/* --- making and resetting */

/* The instance that a call is for, or NULL if it is none of this FMU. */
Tether *entered(void *instance, const char *call)
{
    Tether *tether = instance;
    if (!tether || tether->identity != &THIS_FMU) return NULL;
    tether->call = call;
    return tether;
}

Tether *make_tether(const char *name, Log log, void *environment, void (*importer_log)(void))
{
    size_t length = strlen(name) + 1;
    Tether *tether = calloc(1, sizeof *tether);
    if (!tether) return NULL;
    tether->name = calloc(1, length);
    if (!tether->name) {
        free(tether);
        return NULL;
    }
    memcpy(tether->name, name, length);
    tether->identity = &THIS_FMU;
    tether->log = log;
    tether->environment = environment;
    tether->importer_log = importer_log;
    to_start_values(tether);
    return tether;
}

void free_tether(Tether *tether)
{
    free_chain(tether->chain);
    free(tether->name);
    tether->identity = NULL;
    free(tether);
}

/* Be as after instantiation. */
void to_start_values(Tether *tether)
{
    free_chain(tether->chain);
    tether->chain = NULL;
    memcpy(tether->values, START, sizeof START);
    memset(tether->derivatives, 0, sizeof tether->derivatives);
    tether->values[TIME] = 0.0;
    tether->phase = BEFORE;
    tether->stop_is_defined = tether->warned_of_time = false;
    tether->warned = 0;
    tether->tolerance = tether->start_time = 0.0;
    tether->time = NAN;
}

/* Whether a guid or an instantiation token is that of this FMU. */
Status check_token(const Tether *tether, const char *token)
{
    if (token && !strcmp(token, TOKEN)) return OK;
    return say(tether, ERROR, WRONG_TOKEN, FACTS(word("token", token ? token : "NULL"), word("expected", TOKEN)));
}

/* Warnings and refusals are always passed on, there are no other messages: the names of categories are checked, no more. */
Status check_categories(const Tether *tether, size_t count, const char *const *categories)
{
    if (count && !categories) return say(tether, ERROR, IS_NULL, FACTS(word("argument", "categories")));
    for (size_t i = 0; i < count; i++) {
        const char *name = categories[i] ? categories[i] : "NULL";
        bool known = !strcmp(name, "logAll");
        for (int k = WARNING; k <= ERROR; k++) known = known || !strcmp(name, CATEGORY[k]);
        if (!known) return say(tether, ERROR, NO_SUCH_CATEGORY, FACTS(word("category", name)));
    }
    return OK;
}

/* --- phases */

static Status refuse_phase(const Tether *tether, const char *sentence)
{
    return say(tether, ERROR, sentence, FACTS(word("phase", PHASE[tether->phase])));
}

Status set_up_experiment(Tether *tether, bool has_tolerance, double tolerance, double start, bool has_stop, double stop)
{
    Fact given = real("tolerance", tolerance), largest = real("largest", LOOSEST_TOLERANCE);
    if (tether->phase != BEFORE) return refuse_phase(tether, CANNOT_BE_SET_UP);
    if (!is_finite(start)) return say(tether, ERROR, TIME_NOT_FINITE, FACTS(real("time", start)));
    tether->start_time = tether->values[TIME] = start;
    tether->stop_is_defined = has_stop;
    tether->stop_time = stop;
    if (!has_tolerance) return OK;
    if (!(0.0 < tolerance && tolerance <= LOOSEST_TOLERANCE))
        return say(tether, WARNING, TOLERANCE_NOT_USED, FACTS(given, largest));
    tether->tolerance = tolerance;
    return OK;
}

Status enter_initialization(Tether *tether)
{
    if (tether->phase != BEFORE) return refuse_phase(tether, CANNOT_BE_ENTERED);
    tether->phase = INITIALIZING;
    return OK;
}

Status terminate(Tether *tether)
{
    if (tether->phase != STEPPING) return refuse_phase(tether, CANNOT_BE_TERMINATED);
    tether->phase = TERMINATED;
    return OK;
}

/* --- start and steps */

/* Say what has been implausible since the start, each once. */
static Status warn(Tether *tether)
{
    uint32_t noted = (uint32_t)tether->chain->state[AT_WARNINGS], new = noted & ~tether->warned;
    tether->warned |= noted;
    for (int kind = 0; kind < AT_WARNING_KINDS; kind++) {
        double value = tether->chain->state[AT_WARNED_VALUES + kind];
        if (new >> kind & 1)
            say(tether, WARNING, WARNING_SENTENCE[kind],
                FACTS(real("value", value), real("percent", 100.0 * value), real("strain", 100.0 * (value - 1.0))));
    }
    return new ? WARNING : OK;
}

/* Say what the status of a kernel means for a step [s], with the inputs and the unstretched length of now. */
static Status say_kernel_status(
    const Tether *tether, Status status, const Chain *chain, const double *values, int32_t result, double step)
{
    int place = result >> 8, code = result & 0xFF;
    return say(tether, status, KERNEL_SENTENCE[code], FACTS(
        word("name", INPUT_NAME[place]),
        real("value", values[place]),
        real("step", step),
        real("reel_out_speed", values[AT_REEL_OUT_SPEED]),
        real("length", chain->state[AT_LENGTH]),
        real("relative_tolerance", chain->parameters[AT_RELATIVE_TOLERANCE]),
        real("fixed_step", chain->parameters[AT_FIXED_STEP]),
        whole("budget", (double)(AT_WORK_BUDGET / chain->segments))));
}

/* Go on with another chain and its values. */
void take_chain(Tether *tether, Chain *chain)
{
    free_chain(tether->chain);
    tether->chain = chain;
    memcpy(tether->values, chain->values, VALUES * sizeof(double));
}

/* Check the parameters and find the first shape; `refusal` is the status if that is not possible, and nothing is changed. */
Status start(Tether *tether, Status refusal)
{
    char problem[LONGEST_TEXT];
    if (!check_parameters(tether->values, problem))
        return say(tether, refusal, "{problem}", FACTS(word("problem", problem)));
    Chain *chain = make_chain(tether->values, tether->tolerance);
    if (!chain) return say(tether, ERROR, NO_MEMORY, NULL);
    int32_t result = first_shape(chain, chain->values);
    if (result) {
        say_kernel_status(tether, refusal, chain, chain->values, result, 0.0);
        free_chain(chain);
        return refusal;
    }
    take_chain(tether, chain);
    tether->warned = 0;
    return OK;
}

Status exit_initialization(Tether *tether)
{
    if (tether->phase != INITIALIZING) return refuse_phase(tether, CANNOT_BE_LEFT);
    Status status = start(tether, ERROR);
    if (status != OK) return status;
    tether->phase = STEPPING;
    memcpy(tether->chain->state + AT_GIVEN_DERIVATIVES, tether->derivatives, sizeof tether->derivatives);
    return warn(tether);
}

double last_successful_time(const Tether *tether)
{
    return tether->time != tether->time ? tether->start_time : tether->time;
}

/* Whether a step can be done now; a communication point where no step ended is reported once. */
static Status check_time(Tether *tether, double time, double step)
{
    double off = fabs(time - tether->time), allowed = 1e-3 * fabs(step) + 1e-9 * fabs(time), stop = tether->stop_time;
    if (tether->phase != STEPPING) return refuse_phase(tether, NO_STEP_NOW);
    if (!is_finite(time)) return say(tether, DISCARD, TIME_NOT_FINITE, FACTS(real("time", time)));
    if (tether->stop_is_defined && time + step > stop + allowed)
        return say(tether, ERROR, PAST_THE_END, FACTS(real("step", step), real("time", time), real("stop", stop)));
    if (!(off > allowed) || tether->warned_of_time) return OK; /* `off` is NaN before the first step */
    tether->warned_of_time = true;
    return say(tether, WARNING, TIME_JUMPS, FACTS(real("time", time), real("end", tether->time)));
}

/* Remember from where and with which inputs a step was done. */
static void remember(Chain *chain, const double *values)
{
    double *before = chain->spare;
    chain->spare = chain->before;
    chain->before = before;
    memcpy(chain->inputs, values, sizeof chain->inputs);
    chain->is_repeatable = true;
}

/* One communication step [s] with the inputs at its start. */
Status advance(Tether *tether, double time, double step)
{
    Status status = check_time(tether, time, step);
    if (status > WARNING) return status;
    Chain *chain = tether->chain;
    size_t size = STATE_SIZE(chain->segments) * sizeof(double);
    memcpy(chain->spare, chain->state, size);
    int32_t result = KERNEL(advance)(chain->segments, chain->parameters, tether->values, step, chain->state, chain->work);
    if (!result) result = observe(chain, tether->values);
    if (result) {
        say_kernel_status(tether, DISCARD, chain, tether->values, result, step); /* with the length that was tried */
        memcpy(chain->state, chain->spare, size);
        observe(chain, tether->values);
        return DISCARD;
    }
    remember(chain, tether->values);
    read_free_kite(chain, tether->values);
    tether->time = tether->values[TIME] = time + step;
    Status warned = warn(tether);
    return status > warned ? status : warned;
}

/* --- values */

/* Kind of a value reference; 0 of one that is none of the kinds asked for. */
unsigned kind_of(unsigned reference, unsigned kinds)
{
    return reference <= VALUES && KIND[reference] & kinds ? KIND[reference] : 0;
}

/* Whether `room` values are as many as the variables have. */
Status check_count(const Tether *tether, const unsigned *references, size_t count, size_t room)
{
    size_t needed = 0;
    for (size_t i = 0; i < count; i++) needed += WIDTH[references[i]];
    if (needed == room) return OK;
    return say(tether, ERROR, WRONG_COUNT, FACTS(whole("count", (double)room), whole("needed", (double)needed)));
}

/* A number of an Integer or Enumeration variable; 0 for what no such variable holds. */
static int32_t integer(double value)
{
    return fabs(value) <= AT_LARGEST_INTEGER ? (int32_t)value : 0;
}

/* Values of variables of some kinds, in their order. In initialization mode outputs are calculated when they are read. */
Status get_values(
    Tether *tether, Type type, unsigned kinds, const unsigned *references, size_t count, void *values, size_t room)
{
    bool outputs = false;
    Status status = OK;
    for (size_t i = 0; i < count; i++) {
        unsigned kind = kind_of(references[i], kinds);
        if (!kind) return say(tether, ERROR, CANNOT_BE_READ, FACTS(whole("reference", references[i])));
        outputs = outputs || kind & OUTPUT;
    }
    if (check_count(tether, references, count, room) != OK) return ERROR;
    if (outputs && tether->phase == INITIALIZING) status = start(tether, WARNING);
    for (size_t i = 0, k = 0; i < count; i++) {
        const double *value = tether->values + references[i];
        for (unsigned j = 0; j < WIDTH[references[i]]; j++, k++) {
            if (type == FLOAT64) ((double *)values)[k] = value[j];
            if (type == INT32) ((int32_t *)values)[k] = integer(value[j]);
            if (type == INT64) ((int64_t *)values)[k] = integer(value[j]);
        }
    }
    return status;
}

static double number(Type type, const void *values, size_t k)
{
    if (type == INT32) return ((const int32_t *)values)[k];
    if (type == INT64) return (double)((const int64_t *)values)[k];
    return ((const double *)values)[k];
}

/* Whether a variable can be set now. */
static Status check_settable(const Tether *tether, Type type, unsigned kinds, unsigned reference, double value)
{
    unsigned kind = kind_of(reference, kinds);
    Fact fact = type == FLOAT64 ? real("value", value) : whole("value", value);
    if (!(kind & (INPUT | PARAMETER_KIND)))
        return say(tether, ERROR, CANNOT_BE_SET, FACTS(whole("reference", reference), fact));
    if (kind & PARAMETER_KIND && tether->phase >= STEPPING)
        return say(tether, ERROR, IS_FIXED, FACTS(word("name", PARAMETER[reference - PARAMETERS_AT].name), fact));
    if (kind & INPUT && tether->phase == TERMINATED)
        return say(tether, ERROR, NOT_AFTER_THE_END, FACTS(word("name", INPUT_NAME[reference]), fact));
    return OK;
}

/* Store values of variables of some kinds; they are checked when they are used. All are set, or none. */
Status set_values(
    Tether *tether, Type type, unsigned kinds, const unsigned *references, size_t count, const void *values, size_t room)
{
    for (size_t i = 0, k = 0; i < count; i++) {
        double first = k < room ? number(type, values, k) : NAN;
        if (check_settable(tether, type, kinds, references[i], first) != OK) return ERROR;
        k += WIDTH[references[i]];
    }
    if (check_count(tether, references, count, room) != OK) return ERROR;
    for (size_t i = 0, k = 0; i < count; i++)
        for (unsigned j = 0; j < WIDTH[references[i]]; j++, k++) tether->values[references[i] + j] = number(type, values, k);
    return OK;
}
