/* A saved state: the record of saved_state.py, byte for byte, so that it can go from one flavour of the FMU to the other. */
#include "saved_state.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "finite.h"
#include "instance.h"
#include "room.h"

typedef struct { /* header and facts of saved_state.py; all platforms are little-endian */
    char magic[8];
    uint32_t length, checksum; /* of the rest */
    char variant[16];
    uint32_t phase, segments;
    double tolerance, time;
} Head;

enum { HEADER = offsetof(Head, variant) }; /* bytes before the checksummed part */

/* CRC-32 of zlib, four bits at a time. */
static uint32_t crc32(const unsigned char *bytes, size_t size)
{
    static const uint32_t TABLE[16] = {
        0x00000000, 0x1db71064, 0x3b6e20c8, 0x26d930ac, 0x76dc4190, 0x6b6b51f4, 0x4db26158, 0x5005713c,
        0xedb88320, 0xf00f9344, 0xd6d6a3e8, 0xcb61b38c, 0x9b64c2b0, 0x86d3d2d4, 0xa00ae278, 0xbdbdf21c};
    uint32_t rest = 0xFFFFFFFF;
    for (size_t i = 0; i < size; i++) {
        rest = TABLE[(rest ^ bytes[i]) & 15] ^ rest >> 4;
        rest = TABLE[(rest ^ bytes[i] >> 4) & 15] ^ rest >> 4;
    }
    return ~rest;
}

static void discard(Saved *saved)
{
    if (saved) unmark(&saved->identity);
    free(saved);
}

/* Room for a record, in `*saved` if that is large enough; NULL without memory. */
static Saved *room_for(Saved *old, size_t size)
{
    Saved *saved = old;
    if (!old || old->room < size) {
        saved = calloc(1, sizeof *saved + size);
        if (!saved) return NULL;
        discard(old);
        saved->identity = &A_SAVED_STATE;
        saved->room = size;
    }
    saved->size = size;
    return saved;
}

/* Whether a pointer refers to an FMU state of this FMU. */
static Status check_saved(Instance *instance, const Saved *saved)
{
    if (!saved) return refuse_null(instance, "FMUstate");
    return saved->identity == &A_SAVED_STATE ? OK : say(instance, ERROR, NO_FMU_STATE, NULL);
}

/* Free a state and clear `*saved`. As the standard requires, NULL is ignored. */
Status free_saved(Instance *instance, Saved **saved)
{
    if (!saved || !*saved) return OK;
    if (check_saved(instance, *saved) != OK) return ERROR;
    discard(*saved);
    *saved = NULL;
    return OK;
}

/* Number of bytes for `serialize`. */
Status saved_size(Instance *instance, const Saved *saved, size_t *size)
{
    if (check_saved(instance, saved) != OK) return ERROR;
    *size = saved->size;
    return OK;
}

/* Write the whole state to `*saved`, which is allocated if it is NULL. */
Status save(Instance *instance, Saved **saved)
{
    if (*saved && check_saved(instance, *saved) != OK) return ERROR;
    size_t state = instance->phase >= STEPPING ? STATE_SIZE(instance->arrays->segments) * sizeof(double) : 0;
    size_t values = VALUES * sizeof(double), size = sizeof(Head) + values + state;
    Saved *made = room_for(*saved, size);
    if (!made) return say(instance, ERROR, NO_MEMORY, NULL);
    *saved = made;
    Head head = {.length = (uint32_t)(size - HEADER), .variant = VARIANT, .phase = instance->phase};
    memcpy(head.magic, MAGIC, sizeof head.magic);
    head.segments = instance->arrays ? (uint32_t)instance->arrays->segments : 0;
    head.tolerance = instance->tolerance;
    head.time = instance->time;
    memcpy(made->bytes, &head, sizeof head);
    memcpy(made->bytes + sizeof head, instance->values, values);
    if (state) memcpy(made->bytes + sizeof head + values, instance->arrays->state, state);
    return OK;
}

Status serialize(Instance *instance, const Saved *saved, void *bytes, size_t size)
{
    if (check_saved(instance, saved) != OK) return ERROR;
    if (size < saved->size)
        return say(instance, ERROR, SHORT_BUFFER, FACTS(whole("count", (double)size), whole("needed", (double)saved->size)));
    uint32_t checksum = crc32(saved->bytes + HEADER, saved->size - HEADER);
    memcpy(bytes, saved->bytes, saved->size);
    memcpy((unsigned char *)bytes + offsetof(Head, checksum), &checksum, sizeof checksum);
    return OK;
}

static Status refuse_state(Instance *instance, const char *problem)
{
    return say(instance, ERROR, STATE_REFUSED, FACTS(word("problem", problem)));
}

/* Why bytes are no record of this FMU, or NULL; `head` (modified) gets the first of them, where there are enough. */
static const char *problem_of(const unsigned char *bytes, size_t size, Head *head)
{
    static const char OWN[sizeof head->variant] = VARIANT;
    if (size < sizeof *head || memcmp(bytes, MAGIC, sizeof head->magic)) return NO_STATE;
    memcpy(head, bytes, sizeof *head);
    if (head->length != size - HEADER || crc32(bytes + HEADER, size - HEADER) != head->checksum) return STATE_DAMAGED;
    size_t state = head->phase >= STEPPING ? STATE_SIZE((size_t)head->segments) : 0;
    bool same = !memcmp(head->variant, OWN, sizeof OWN) && head->phase <= TERMINATED;
    if (!same || size != sizeof *head + (VALUES + state) * sizeof(double)) return STATE_OF_ANOTHER;
    if (!(0.0 <= head->tolerance && head->tolerance <= DEFAULT_TOLERANCE)) return STATE_WRONG_TOLERANCE;
    bool no_step_done = head->time != head->time;
    return no_step_done || is_finite(head->time) ? NULL : STATE_WRONG_TIME;
}

Status deserialize(Instance *instance, const void *bytes, size_t size, Saved **saved)
{
    if (*saved && check_saved(instance, *saved) != OK) return ERROR;
    Head head = {.tolerance = 0.0};
    const char *problem = problem_of(bytes, size, &head);
    if (problem) {
        char text[LONGEST_TEXT];
        Fact largest = real("largest", DEFAULT_TOLERANCE);
        fill_in(text, sizeof text, problem, FACTS(real("tolerance", head.tolerance), largest, real("time", head.time)));
        return refuse_state(instance, text);
    }
    Saved *made = room_for(*saved, size);
    if (!made) return say(instance, ERROR, NO_MEMORY, NULL);
    *saved = made;
    memcpy(made->bytes, bytes, size);
    memset(made->bytes + offsetof(Head, checksum), 0, sizeof(uint32_t));
    return OK;
}

/* Whether Integer values are integers; outputs do not count, they are recomputed. */
static Status check_integers(Instance *instance, const double *values)
{
    char problem[LONGEST_TEXT], text[LONGEST_TEXT];
    for (int i = 0; i < PARAMETERS; i++) {
        double value = values[PARAMETERS_AT + i];
        if (PARAMETER[i].kind == REAL || fabs(value) <= AT_LARGEST_INTEGER) continue;
        fill_in(problem, sizeof problem, NO_INTEGER, FACTS(word("name", PARAMETER[i].name), real("value", value)));
        fill_in(text, sizeof text, STATE_WRONG_PARAMETER, FACTS(word("problem", problem)));
        return refuse_state(instance, text);
    }
    return OK;
}

/* Whether quantities without a variable in this FMU have its values. */
static Status check_constants(Instance *instance, const double *values)
{
    for (int i = 0; i < CONSTANTS; i++) {
        double value = values[CONSTANT[i].reference], expected = START[CONSTANT[i].reference];
        if (value == expected) continue;
        char text[LONGEST_TEXT];
        fill_in(text, sizeof text, STATE_OTHER_CONSTANT, FACTS(
            word("name", CONSTANT[i].name), real("value", value), real("expected", expected)));
        return refuse_state(instance, text);
    }
    return OK;
}

/* Whether a number of a state is a set of so many bits. */
static bool is_set(double number, int count)
{
    return 0.0 <= number && number < (double)((uint64_t)1 << count) && number == floor(number);
}

/* Whether a state array is valid for any tether, as in `saved_state.check_state`. */
static bool is_possible(const double *state, size_t size)
{
    for (size_t i = 0; i < size; i++)
        if (!is_finite(state[i])) return false;
    for (size_t i = 0; i < sizeof STATE_RANGE / sizeof *STATE_RANGE; i++) {
        double number = state[STATE_RANGE[i].place];
        if (number < STATE_RANGE[i].lowest || number > STATE_RANGE[i].highest) return false;
    }
    return is_set(state[AT_WARNINGS], AT_WARNING_KINDS) && is_set(state[AT_GIVEN_DERIVATIVES], AT_INPUTS);
}

/* Reason why the numbers of a state array are invalid, or NULL after they were accepted. */
static const char *problem_of_state(Arrays *arrays, const Head *head, const double *state)
{
    if (arrays->segments != (int64_t)head->segments) return STATE_DAMAGED;
    size_t size = STATE_SIZE(arrays->segments);
    memcpy(arrays->state, state, size * sizeof(double));
    for (int k = 0; k < LINES; k++)
        if (!is_possible(state_of(arrays, k), state_size_of(arrays, k))) return STATE_IMPOSSIBLE;
    if (take_outputs(arrays, arrays->values)) return STATE_IMPOSSIBLE;
    return NULL;
}

/* Outputs are recomputed from the state: saved outputs do not count. */
static void clear_outputs(double *values)
{
    memset(values + OUTPUTS_AT, 0, (PARAMETERS_AT - OUTPUTS_AT) * sizeof(double));
}

/* Continue with the arrays of a saved state; on failure nothing changes. */
static Status restore_arrays(Instance *instance, const Head *head, const double *values)
{
    char problem[LONGEST_TEXT], text[LONGEST_TEXT];
    Arrays *arrays = make_arrays(instance, values);
    if (!arrays) return say(instance, ERROR, NO_MEMORY, NULL);
    if (!pack_parameters(arrays, head->tolerance, problem)) {
        give_back(arrays);
        fill_in(text, sizeof text, STATE_WRONG_PARAMETER, FACTS(word("problem", problem)));
        return refuse_state(instance, text);
    }
    clear_outputs(arrays->values);
    const char *wrong = problem_of_state(arrays, head, values + VALUES);
    if (wrong) {
        give_back(arrays);
        return refuse_state(instance, wrong);
    }
    take_arrays(instance, arrays);
    forget_path(&instance->watch);
    for (int k = 0; k < LINES; k++) instance->warned[k] |= (uint64_t)state_of(arrays, k)[AT_WARNINGS];
    return OK;
}

/* Restore a state, bit for bit; on failure nothing changes. */
Status restore(Instance *instance, const Saved *saved)
{
    Head head;
    if (check_saved(instance, saved) != OK) return ERROR;
    memcpy(&head, saved->bytes, sizeof head);
    const double *values = (const double *)(saved->bytes + sizeof head);
    if (check_constants(instance, values) != OK || check_integers(instance, values) != OK) return ERROR;
    if (head.phase < STEPPING) {
        memcpy(instance->values, values, VALUES * sizeof(double));
        clear_outputs(instance->values);
        memset(instance->has_derivative, 0, sizeof instance->has_derivative); /* the record does not contain them */
    } else if (restore_arrays(instance, &head, values) != OK) {
        return ERROR;
    }
    instance->phase = (Phase)head.phase;
    instance->tolerance = head.tolerance;
    instance->time = head.time;
    instance->values[TIME] = last_successful_time(instance);
    return OK;
}
