/* The life of an instance: phases, values, start and steps. A refused call changes nothing. */
#include "instance.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "finite.h"
#include "room.h"

const char AN_INSTANCE = 0, A_SAVED_STATE = 0;
const char *const CATEGORY[] = {"logStatusOK", "logStatusWarning", "logStatusDiscard", "logStatusError"};

/* --- making and resetting */

/* Clear the mark of an object before it is freed, so that a later call with it is refused if its memory is intact. The
compiler would omit a write that nobody reads. */
void unmark(const void **identity)
{
    *(const void *volatile *)identity = NULL;
}

/* The instance of a call; NULL if the importer's pointer does not belong to this FMU. */
Instance *entered(void *handle, const char *call)
{
    Instance *instance = handle;
    if (!instance || instance->identity != &AN_INSTANCE) return NULL;
    instance->call = call;
    return instance;
}

/* Refuse a call that the flags of the model description exclude. */
Status refuse_call(void *handle, const char *call)
{
    Instance *instance = entered(handle, call);
    return instance ? say(instance, ERROR, NOT_OFFERED, FACTS(word("what", call))) : ERROR;
}

Instance *make_instance(const char *name, Log log, void *environment, void (*importer_log)(void), bool is_logging)
{
    size_t length = strlen(name) + 1;
    Instance *instance = make_room();
    if (!instance) return NULL;
    instance->name = calloc(1, length);
    if (!instance->name) {
        free_room(instance);
        return NULL;
    }
    memcpy(instance->name, name, length);
    instance->identity = &AN_INSTANCE;
    instance->log = log;
    instance->environment = environment;
    instance->importer_log = importer_log;
    instance->is_logging = is_logging && importer_log;
    to_start_values(instance);
    return instance;
}

void free_instance(Instance *instance)
{
    give_back(instance->arrays);
    free(instance->name);
    unmark(&instance->identity);
    free_room(instance);
}

/* Reset to the state after instantiation. */
void to_start_values(Instance *instance)
{
    give_back(instance->arrays);
    instance->arrays = NULL;
    memcpy(instance->values, START, sizeof START);
    memset(instance->has_derivative, 0, sizeof instance->has_derivative);
    instance->values[TIME] = 0.0;
    instance->phase = BEFORE;
    instance->stop_is_defined = instance->warned_of_time = false;
    memset(instance->warned, 0, sizeof instance->warned);
    instance->tolerance = instance->start_time = 0.0;
    instance->time = NAN;
}

/* Whether a guid or an instantiation token belongs to this FMU. */
Status check_token(Instance *instance, const char *token)
{
    if (token && !strcmp(token, TOKEN)) return OK;
    return say(instance, ERROR, WRONG_TOKEN, FACTS(word("token", token ? token : "NULL"), word("expected", TOKEN)));
}

/* Warnings and refusals are always passed on, there are no other messages: the names of categories are checked, no more. */
Status set_logging(Instance *instance, bool is_logging, size_t count, const char *const *categories)
{
    if (count && !categories) return refuse_null(instance, "categories");
    for (size_t i = 0; i < count; i++) {
        const char *name = categories[i] ? categories[i] : "NULL";
        bool known = !strcmp(name, "logAll");
        for (int k = WARNING; k <= ERROR; k++) known = known || !strcmp(name, CATEGORY[k]);
        if (!known) return say(instance, ERROR, NO_SUCH_CATEGORY, FACTS(word("category", name)));
    }
    instance->is_logging = is_logging && instance->importer_log;
    return OK;
}

/* --- phases */

static Status refuse_phase(Instance *instance, const char *sentence)
{
    return say(instance, ERROR, sentence, FACTS(word("phase", PHASE[instance->phase])));
}

Status set_up_experiment(Instance *instance, bool has_tolerance, double tolerance, double start, bool has_stop, double stop)
{
    if (instance->phase != BEFORE) return refuse_phase(instance, CANNOT_BE_SET_UP);
    if (!is_finite(start)) return say(instance, ERROR, START_NOT_FINITE, FACTS(real("start", start)));
    if (has_stop && !(stop >= start))
        return say(instance, ERROR, STOP_BEFORE_START, FACTS(real("stop", stop), real("start", start)));
    instance->start_time = instance->values[TIME] = start;
    instance->stop_is_defined = has_stop;
    instance->stop_time = stop;
    if (!has_tolerance) return OK;
    if (!(tolerance > 0.0)) return say(instance, WARNING, TOLERANCE_NOT_USED, FACTS(real("tolerance", tolerance)));
    if (tolerance < DEFAULT_TOLERANCE) instance->tolerance = tolerance; /* a looser one is inaccurate */
    return OK;
}

Status enter_initialization(Instance *instance)
{
    if (instance->phase != BEFORE) return refuse_phase(instance, CANNOT_BE_ENTERED);
    instance->phase = INITIALIZING;
    return OK;
}

Status terminate(Instance *instance)
{
    if (instance->phase != STEPPING) return refuse_phase(instance, CANNOT_BE_TERMINATED);
    instance->phase = TERMINATED;
    return OK;
}

/* --- start and steps */

/* Warn of values with probably wrong units. */
static void warn_of_units(Instance *instance)
{
    for (size_t i = 0; i < sizeof DOUBT / sizeof *DOUBT; i++) {
        double value = instance->values[DOUBT[i].reference];
        if (value != 0.0 && DOUBT[i].side * (value - DOUBT[i].limit) > 0.0)
            say(instance, WARNING, DOUBT[i].sentence, FACTS(real("value", value)));
    }
}

/* Whether line k continues over a sheave as the next one. */
static bool goes_on(const Instance *instance, int k)
{
    return instance->arrays->plan[PLAN_HEADER + PLAN_LINE_NUMBERS * k + PLAN_THROUGH] != 0;
}

/* Whether a note on a line, possibly over sheaves, is unreported, and this portion is the worst. */
static bool is_to_be_said(const Instance *instance, int line, int kind)
{
    const double *state = state_of(instance->arrays, line);
    int k = line;
    if (!((uint64_t)state[AT_WARNINGS] >> kind & 1)) return false;
    while (k > 0 && goes_on(instance, k - 1)) k--;
    for (bool is_last = false; !is_last; k++) {
        const double *other = state_of(instance->arrays, k);
        double more = other[AT_WARNED_VALUES + kind] - state[AT_WARNED_VALUES + kind];
        if (instance->warned[k] >> kind & 1) return false;
        if ((uint64_t)other[AT_WARNINGS] >> kind & 1 && (more > 0.0 || (more == 0.0 && k < line))) return false;
        is_last = !goes_on(instance, k);
    }
    return true;
}

/* Warn of implausible behaviour of a portion since the start, once per line. */
static void warn_of_line(Instance *instance, int line)
{
    const double *state = state_of(instance->arrays, line);
    char text[LONGEST_TEXT], said[LONGEST_TEXT];
    for (int kind = 0; kind < AT_WARNING_KINDS; kind++) {
        double value = state[AT_WARNED_VALUES + kind];
        if (!is_to_be_said(instance, line, kind)) continue;
        fill_in(said, sizeof said, WARNING_SENTENCE[kind],
            FACTS(real("value", value), real("percent", 100.0 * value), real("strain", 100.0 * (value - 1.0)),
                real("segment", state[AT_TORN_SEGMENT]), real("time", state[AT_TORN_AT])));
        about_line(text, line, said);
        say(instance, WARNING, "{text}", FACTS(word("text", text)));
    }
}

static void warn(Instance *instance)
{
    for (int k = 0; k < LINES; k++) warn_of_line(instance, k);
    for (int k = 0; k < LINES; k++) instance->warned[k] |= (uint64_t)state_of(instance->arrays, k)[AT_WARNINGS];
}

/* Continue with other arrays and their values. */
void take_arrays(Instance *instance, Arrays *arrays)
{
    give_back(instance->arrays);
    instance->arrays = arrays;
    memcpy(instance->values, arrays->values, VALUES * sizeof(double));
}

/* Check the parameters and solve the initial shape; on failure `refusal` is the status, and nothing changes. */
Status start(Instance *instance, Status refusal)
{
    char problem[LONGEST_TEXT];
    Arrays *arrays = make_arrays(instance, instance->values);
    if (!arrays) return say(instance, ERROR, NO_MEMORY, NULL);
    if (!pack_parameters(arrays, instance->tolerance, problem)) {
        give_back(arrays);
        return say(instance, refusal, "{problem}", FACTS(word("problem", problem)));
    }
    int32_t result = first_shape(arrays, arrays->values);
    if (result) {
        sentence_of(problem, arrays, arrays->values, result, 0.0);
        give_back(arrays);
        return say(instance, refusal, "{problem}", FACTS(word("problem", problem)));
    }
    take_arrays(instance, arrays);
    watch_anew(&instance->watch);
    memset(instance->warned, 0, sizeof instance->warned);
    return OK;
}

Status exit_initialization(Instance *instance)
{
    if (instance->phase != INITIALIZING) return refuse_phase(instance, CANNOT_BE_LEFT);
    if (start(instance, ERROR) != OK) return ERROR;
    instance->phase = STEPPING;
    warn_of_units(instance);
    warn(instance);
    return OK;
}

double last_successful_time(const Instance *instance)
{
    return instance->time != instance->time ? instance->start_time : instance->time;
}

/* Whether a step can be done now; a communication point where no step ended is reported once. */
static Status check_time(Instance *instance, double time, double step, Status refusal)
{
    double off = fabs(time - instance->time), stop = instance->stop_time;
    double allowed = JUMP_OF_STEP * fabs(step) + JUMP_OF_TIME * fabs(time);
    if (instance->phase != STEPPING) return refuse_phase(instance, NO_STEP_NOW);
    if (!is_finite(time)) return say(instance, refusal, TIME_NOT_FINITE, FACTS(real("time", time)));
    if (instance->stop_is_defined && time + step > stop + allowed)
        return say(instance, ERROR, PAST_THE_END, FACTS(real("step", step), real("time", time), real("stop", stop)));
    if (!(off > allowed) || instance->warned_of_time) return OK; /* `off` is NaN before the first step */
    instance->warned_of_time = true;
    return say(instance, WARNING, TIME_JUMPS, FACTS(real("time", time), real("end", instance->time)));
}

/* The period of a polygonal path of a driven kite end of a tether alone, 0 if it has none or is not looked at. */
static int period_of_kite(Instance *instance, double step)
{
    const double *kite = instance->values + AT_KITE_POSITION;
    if (!DIRECT || FREE_KITE || instance->watch.is_over) return 0;
    return period_of(&instance->watch, kite, kite + (AT_KITE_VELOCITY - AT_KITE_POSITION), step);
}

/* Remember the start and the inputs of a step. */
static void remember(Arrays *arrays, const double *values)
{
    double *before = arrays->spare;
    arrays->spare = arrays->before;
    arrays->before = before;
    memcpy(arrays->inputs, values, sizeof arrays->inputs);
    arrays->is_repeatable = true;
}

/* One communication step [s] with the inputs at its start; `refusal` is the status where it cannot be done. */
Status advance(Instance *instance, double time, double step, Status refusal)
{
    Status status = check_time(instance, time, step, refusal);
    if (status != OK) return status;
    Arrays *arrays = instance->arrays;
    int period = period_of_kite(instance, step);
    int32_t result = do_step(arrays, step, arrays->spare, instance->values);
    if (result) {
        char problem[LONGEST_TEXT];
        sentence_of(problem, arrays, instance->values, result, step);
        return say(instance, refusal, STEP_REFUSED, FACTS(real("time", time), word("problem", problem)));
    }
    remember(arrays, instance->values);
    instance->time = instance->values[TIME] = time + step;
    if (period) say(instance, WARNING, POLYGON, FACTS(word("name", "kite_position"), whole("period", period)));
    warn(instance);
    return OK;
}

/* --- values */

/* Kind of a value reference; 0 if it is not of the requested kinds. */
unsigned kind_of(unsigned reference, unsigned kinds)
{
    return reference <= VALUES && KIND[reference] & kinds ? KIND[reference] : 0;
}

/* Name of a value reference, for sentences that also contain its number. */
Fact name_of(unsigned reference)
{
    return word("name", reference <= VALUES && *NAME[reference] ? NAME[reference] : UNKNOWN_VARIABLE);
}

/* Whether `room` equals the number of values of the variables. */
Status check_count(Instance *instance, const unsigned *references, size_t count, size_t room)
{
    size_t needed = 0;
    for (size_t i = 0; i < count; i++) needed += WIDTH[references[i]];
    if (needed == room) return OK;
    return say(instance, ERROR, WRONG_COUNT, FACTS(whole("count", (double)room), whole("needed", (double)needed)));
}

/* A number of an Integer or Enumeration variable; 0 if it is out of range. */
static int32_t integer(double value)
{
    return fabs(value) <= AT_LARGEST_INTEGER ? (int32_t)value : 0;
}

/* Whether values of variables of these kinds can be read now. In initialization mode this computes outputs. */
static Status check_readable(Instance *instance, unsigned kinds, const unsigned *references, size_t count, size_t room)
{
    bool outputs = false;
    for (size_t i = 0; i < count; i++) {
        unsigned kind = kind_of(references[i], kinds);
        if (!kind) return say(instance, ERROR, CANNOT_BE_READ, FACTS(VARIABLE(references[i])));
        outputs = outputs || kind & OUTPUT;
    }
    if (check_count(instance, references, count, room) != OK) return ERROR;
    return outputs && instance->phase == INITIALIZING ? start(instance, ERROR) : OK;
}

/* The status of a call that reads. On failure, invalid values are written, for importers that ignore the status: NaN, the
smallest integer, false, or bytes that are 0, as a string NULL. */
Status filled(Status status, Type type, void *values, size_t room)
{
    if (status == OK || !values) return status;
    for (size_t k = 0; k < room; k++) {
        if (type == FLOAT64) ((double *)values)[k] = NAN;
        if (type == FLOAT32) ((float *)values)[k] = NAN;
        if (type == INT32) ((int32_t *)values)[k] = INT32_MIN;
        if (type == INT64) ((int64_t *)values)[k] = INT32_MIN;
        if (type == TRUTH_INT) ((int32_t *)values)[k] = 0;
        if (type == TRUTH) ((bool *)values)[k] = false;
        if (type == BYTES) ((char *)values)[k] = 0;
    }
    return status;
}

/* Values of variables of these kinds, in order. */
Status get_values(
    Instance *instance, Type type, unsigned kinds, const unsigned *references, size_t count, void *values, size_t room)
{
    if (check_readable(instance, kinds, references, count, room) != OK) return ERROR;
    for (size_t i = 0, k = 0; i < count; i++) {
        const double *value = instance->values + references[i];
        for (unsigned j = 0; j < WIDTH[references[i]]; j++, k++) {
            if (type == FLOAT64) ((double *)values)[k] = value[j];
            if (type == INT32) ((int32_t *)values)[k] = integer(value[j]);
            if (type == INT64) ((int64_t *)values)[k] = integer(value[j]);
            if (type == TRUTH_INT) ((int32_t *)values)[k] = value[j] != 0.0;
            if (type == TRUTH) ((bool *)values)[k] = value[j] != 0.0;
        }
    }
    return OK;
}

static double number(Type type, const void *values, size_t k)
{
    if (type == INT32) return ((const int32_t *)values)[k];
    if (type == INT64) return (double)((const int64_t *)values)[k];
    if (type == TRUTH_INT) return ((const int32_t *)values)[k] != 0;
    if (type == TRUTH) return ((const bool *)values)[k];
    return ((const double *)values)[k];
}

/* Whether a variable can be set now. */
static Status check_settable(Instance *instance, Type type, unsigned kinds, unsigned reference, double value)
{
    unsigned kind = kind_of(reference, kinds);
    Fact fact = type == FLOAT64 ? real("value", value) : whole("value", value);
    if (!(kind & (INPUT | PARAMETER_KIND)))
        return say(instance, ERROR, CANNOT_BE_SET, FACTS(VARIABLE(reference), fact));
    if (kind & PARAMETER_KIND && instance->phase >= STEPPING)
        return say(instance, ERROR, IS_FIXED, FACTS(word("name", PARAMETER[reference - PARAMETERS_AT].name), fact));
    if (kind & INPUT && instance->phase == TERMINATED)
        return say(instance, ERROR, NOT_AFTER_THE_END, FACTS(word("name", INPUT_NAME[reference]), fact));
    return OK;
}

/* Store values of variables of these kinds, all or none; they are checked when they are used. */
Status set_values(
    Instance *instance, Type type, unsigned kinds, const unsigned *references, size_t count, const void *values,
    size_t room)
{
    for (size_t i = 0, k = 0; i < count; i++) {
        double first = k < room ? number(type, values, k) : NAN;
        if (check_settable(instance, type, kinds, references[i], first) != OK) return ERROR;
        k += WIDTH[references[i]];
    }
    if (check_count(instance, references, count, room) != OK) return ERROR;
    for (size_t i = 0, k = 0; i < count; i++)
        for (unsigned j = 0; j < WIDTH[references[i]]; j++, k++)
            instance->values[references[i] + j] = number(type, values, k);
    return OK;
}
