/* A saved state: the record of saved_state.py, byte for byte, so that it can go from one flavour of the FMU to the other. */
#include "tether.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct { /* header and facts of saved_state.py; all platforms are little-endian */
    char magic[8];
    uint32_t length, checksum; /* of what follows */
    char variant[16];
    uint32_t phase, segments;
    double tolerance, time;
} Head;

enum { HEADER = 16 }; /* bytes before what the checksum is of */

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

/* Room for a record, in `*saved` if there is one that has it; NULL without memory. */
static Saved *make_room(Saved *old, size_t size)
{
    Saved *saved = old;
    if (!old || old->room < size) {
        saved = calloc(1, sizeof *saved + size);
        if (!saved) return NULL;
        free(old);
        saved->identity = &THIS_FMU;
        saved->room = size;
    }
    saved->size = size;
    return saved;
}

/* Whether a pointer is one of an FMU state of this FMU. */
static Status check_saved(const Tether *tether, const Saved *saved)
{
    if (!saved) return say(tether, ERROR, IS_NULL, FACTS(word("argument", "FMUstate")));
    return saved->identity == &THIS_FMU ? OK : say(tether, ERROR, NO_FMU_STATE, NULL);
}

/* Free a state, and forget it in `*saved`. As the standard has it, nothing is done where there is none. */
Status free_saved(const Tether *tether, Saved **saved)
{
    if (!saved || !*saved) return OK;
    if (check_saved(tether, *saved) != OK) return ERROR;
    (*saved)->identity = NULL;
    free(*saved);
    *saved = NULL;
    return OK;
}

/* Bytes that `serialize` needs. */
Status saved_size(const Tether *tether, const Saved *saved, size_t *size)
{
    if (check_saved(tether, saved) != OK) return ERROR;
    *size = saved->size;
    return OK;
}

/* Write the whole state to `*saved`, which is made if it is NULL. */
Status save(Tether *tether, Saved **saved)
{
    if (*saved && check_saved(tether, *saved) != OK) return ERROR;
    size_t state = tether->phase >= STEPPING ? STATE_SIZE(tether->chain->segments) * sizeof(double) : 0;
    size_t values = VALUES * sizeof(double), size = sizeof(Head) + values + state;
    Saved *made = make_room(*saved, size);
    if (!made) return say(tether, ERROR, NO_MEMORY, NULL);
    *saved = made;
    Head head = {.length = (uint32_t)(size - HEADER), .variant = VARIANT, .phase = tether->phase};
    memcpy(head.magic, MAGIC, sizeof head.magic);
    head.segments = tether->chain ? (uint32_t)tether->chain->segments : 0;
    head.tolerance = tether->tolerance;
    head.time = tether->time;
    memcpy(made->bytes, &head, sizeof head);
    memcpy(made->bytes + sizeof head, tether->values, values);
    if (state) memcpy(made->bytes + sizeof head + values, tether->chain->state, state);
    return OK;
}

Status serialize(const Tether *tether, const Saved *saved, void *bytes, size_t size)
{
    if (check_saved(tether, saved) != OK) return ERROR;
    if (size < saved->size)
        return say(tether, ERROR, SHORT_BUFFER, FACTS(whole("count", (double)size), whole("needed", (double)saved->size)));
    uint32_t checksum = crc32(saved->bytes + HEADER, saved->size - HEADER);
    memcpy(bytes, saved->bytes, saved->size);
    memcpy((unsigned char *)bytes + offsetof(Head, checksum), &checksum, sizeof checksum);
    return OK;
}

static Status refuse_state(const Tether *tether, const char *problem)
{
    return say(tether, ERROR, STATE_REFUSED, FACTS(word("problem", problem)));
}

/* Why bytes are no record of this FMU, or NULL. */
static const char *problem_of(const unsigned char *bytes, size_t size)
{
    Head head;
    if (size < sizeof head || memcmp(bytes, MAGIC, sizeof head.magic)) return NO_STATE;
    memcpy(&head, bytes, sizeof head);
    if (head.length != size - HEADER || crc32(bytes + HEADER, size - HEADER) != head.checksum) return STATE_DAMAGED;
    size_t state = head.phase >= STEPPING ? STATE_SIZE((size_t)head.segments) : 0;
    bool same = !strncmp(head.variant, VARIANT, sizeof head.variant) && head.phase <= TERMINATED;
    return same && size == sizeof head + (VALUES + state) * sizeof(double) ? NULL : STATE_OF_ANOTHER;
}

Status deserialize(const Tether *tether, const void *bytes, size_t size, Saved **saved)
{
    if (*saved && check_saved(tether, *saved) != OK) return ERROR;
    const char *problem = problem_of(bytes, size);
    if (problem) return refuse_state(tether, problem);
    Saved *made = make_room(*saved, size);
    if (!made) return say(tether, ERROR, NO_MEMORY, NULL);
    *saved = made;
    memcpy(made->bytes, bytes, size);
    memset(made->bytes + offsetof(Head, checksum), 0, sizeof(uint32_t));
    return OK;
}

/* Whether the integers among the values are such; outputs do not count, they are computed anew. */
static Status check_integers(const Tether *tether, const double *values)
{
    char problem[LONGEST_TEXT], text[LONGEST_TEXT];
    for (int i = 0; i < PARAMETERS; i++) {
        double value = values[PARAMETERS_AT + i];
        if (PARAMETER[i].kind == REAL || fabs(value) <= AT_LARGEST_INTEGER) continue;
        fill_in(problem, sizeof problem, NO_INTEGER, FACTS(word("name", PARAMETER[i].name), real("value", value)));
        fill_in(text, sizeof text, STATE_WRONG_PARAMETER, FACTS(word("problem", problem)));
        return refuse_state(tether, text);
    }
    return OK;
}

/* Whether a number of a state is a set of so many bits. */
static bool is_set(double number, int count)
{
    return 0.0 <= number && number < (1 << count) && number == floor(number);
}

/* Why the numbers of a state array cannot be used, or NULL if the chain has taken them. */
static const char *problem_of_state(Chain *chain, const Head *head, const double *state)
{
    if (chain->segments != (int64_t)head->segments) return STATE_DAMAGED;
    memcpy(chain->state, state, STATE_SIZE(chain->segments) * sizeof(double));
    bool sets = is_set(chain->state[AT_WARNINGS], AT_WARNING_KINDS) && is_set(chain->state[AT_GIVEN_DERIVATIVES], AT_INPUTS);
    if (!sets || observe(chain, chain->values)) return STATE_IMPOSSIBLE;
    read_free_kite(chain, chain->values);
    return NULL;
}

/* Outputs follow from the state: those that were saved do not count. */
static void clear_outputs(double *values)
{
    memset(values + OUTPUTS_AT, 0, (PARAMETERS_AT - OUTPUTS_AT) * sizeof(double));
    if (FREE_KITE) memset(values + AT_KITE_POSITION, 0, 6 * sizeof(double));
}

/* Go on with the chain of a saved state; if that is not possible, nothing is changed. */
static Status restore_chain(Tether *tether, const Head *head, const double *values)
{
    char problem[LONGEST_TEXT], text[LONGEST_TEXT];
    if (!check_parameters(values, problem)) {
        fill_in(text, sizeof text, STATE_WRONG_PARAMETER, FACTS(word("problem", problem)));
        return refuse_state(tether, text);
    }
    Chain *chain = make_chain(values, head->tolerance);
    if (!chain) return say(tether, ERROR, NO_MEMORY, NULL);
    clear_outputs(chain->values);
    const char *wrong = problem_of_state(chain, head, values + VALUES);
    if (wrong) {
        free_chain(chain);
        return refuse_state(tether, wrong);
    }
    take_chain(tether, chain);
    tether->warned |= (uint32_t)chain->state[AT_WARNINGS];
    return OK;
}

/* Go back to a state, bit for bit; if that is not possible, nothing is changed. */
Status restore(Tether *tether, const Saved *saved)
{
    Head head;
    if (check_saved(tether, saved) != OK) return ERROR;
    memcpy(&head, saved->bytes, sizeof head);
    const double *values = (const double *)(saved->bytes + sizeof head);
    if (check_integers(tether, values) != OK) return ERROR;
    if (head.phase < STEPPING) {
        memcpy(tether->values, values, VALUES * sizeof(double));
        clear_outputs(tether->values);
        memset(tether->derivatives, 0, sizeof tether->derivatives); /* the record has no place for them */
    } else if (restore_chain(tether, &head, values) != OK) {
        return ERROR;
    }
    tether->phase = (Phase)head.phase;
    tether->tolerance = head.tolerance;
    tether->time = head.time;
    tether->values[TIME] = last_successful_time(tether);
    return OK;
}
