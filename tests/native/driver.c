/* Random sessions of legal and illegal calls: driver SEED SESSIONS

Compiled with the C shell for FMI 2 or 3 (-DFMI=2, -DFMI=3) and a compiler's sanitizers, linked with the kernels. After each
call: a refused one has changed nothing (the serialized states of before and after are equal), a done one leaves finite
outputs. Any other end than "sessions done" is a fault. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "instance.h"

#if FMI == 2
#include "fmi2Functions.h"
#define CALL(name) fmi2##name
typedef fmi2FMUstate State;
typedef char Byte;
#else
#include "fmi3Functions.h"
#define CALL(name) fmi3##name
typedef fmi3FMUState State;
typedef uint8_t Byte;
#endif

enum { CALLS = 40, STATES = 4, AT_ONCE = 8, MOST = 4096 };
enum { FIRST_NUMBER = 24 }; /* byte of a saved state from where on numbers are replaced, 8 at a time */

static uint64_t random_state;
static void *instance;
static State states[STATES];
static int messages, steps; /* that were passed on; that were done */

static uint64_t draw(void) /* splitmix64 */
{
    uint64_t z = random_state += 0x9E3779B97F4A7C15;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EB;
    return z ^ (z >> 31);
}

static unsigned below(unsigned count)
{
    return (unsigned)(draw() % count);
}

static double any_number(void)
{
    static const double LIST[] = {0.0, -0.0, 1.0, -1.0, 300.0, 1e-300, 1e9, -1e12, 1e300, INFINITY, -INFINITY, NAN};
    double number;
    uint64_t bits = draw();
    if (below(3)) return LIST[below(12)];
    memcpy(&number, &bits, sizeof number);
    return number;
}

static void fault(const char *what)
{
    fprintf(stderr, "fault: %s\n", what);
    abort();
}

/* --- the two versions of FMI */

#if FMI == 2
static void hear(void *environment, const char *name, fmi2Status status, const char *category, const char *format, ...)
{
    messages += environment == &messages && name && status <= fmi2Error && category && strlen(format) < MOST;
}

static void instantiate(const char *token)
{
    static const fmi2CallbackFunctions callbacks = {hear, NULL, NULL, NULL, &messages};
    instance = fmi2Instantiate("tether", fmi2CoSimulation, token, below(2) ? NULL : "file:/a%20b", &callbacks, 0, (int)below(2));
}

static int enter(void)
{
    int status = below(2) ? fmi2SetupExperiment(instance, (int)below(2), any_number(), 0.0, below(4) == 0, 1.0) : fmi2OK;
    return status ? status : (int)fmi2EnterInitializationMode(instance);
}

static int step(double time, double size)
{
    double last = NAN;
    int terminated = 1, status = fmi2DoStep(instance, time, size, (int)below(2));
    if (fmi2GetRealStatus(instance, fmi2LastSuccessfulTime, &last) != fmi2OK || last != last) fault("last time");
    if (fmi2GetBooleanStatus(instance, fmi2Terminated, &terminated) != fmi2OK || terminated) fault("terminated");
    return status;
}

static int get_reals(const unsigned *references, size_t count, double *values, size_t room)
{
    return fmi2GetReal(instance, references, count < room ? count : room, values);
}

static int set_reals(const unsigned *references, size_t count, const double *values, size_t room)
{
    return fmi2SetReal(instance, references, count < room ? count : room, values);
}

static int get_integers(const unsigned *references, size_t count, void *values)
{
    return fmi2GetInteger(instance, references, count, values);
}

static int set_integers(const unsigned *references, size_t count, const int *values)
{
    return fmi2SetInteger(instance, references, count, values);
}

static int set_derivatives(const unsigned *references, size_t count, const int *orders, const double *values)
{
    return fmi2SetRealInputDerivatives(instance, references, count, orders, values);
}

static int directional(
    const unsigned *unknowns, size_t count, const unsigned *knowns, size_t known_count, const double *seed, size_t seeds,
    double *sensitivity, size_t room)
{
    if (count > room) count = room;
    if (known_count > seeds) known_count = seeds;
    return fmi2GetDirectionalDerivative(instance, unknowns, count, knowns, known_count, seed, sensitivity);
}

static int not_offered(void)
{
    fmi2EventInfo info;
    switch (below(5)) {
    case 0: return fmi2GetRealOutputDerivatives(instance, NULL, 1, NULL, NULL);
    case 1: return fmi2NewDiscreteStates(instance, &info);
    case 2: return fmi2CancelStep(instance);
    case 3: return fmi2SetString(instance, NULL, 1, NULL);
    default: return fmi2GetBoolean(instance, NULL, 1, NULL);
    }
}

static int nulls(void)
{
    size_t size;
    switch (below(10)) {
    case 8: return fmi2SetRealInputDerivatives(instance, NULL, 1, NULL, NULL);
    case 9: return fmi2GetDirectionalDerivative(instance, NULL, 1, NULL, 1, NULL, NULL);
    case 0: return fmi2GetReal(instance, NULL, 1, NULL);
    case 1: return fmi2SetInteger(instance, NULL, 1, NULL);
    case 2: return fmi2GetFMUstate(instance, NULL);
    case 3: return fmi2SetFMUstate(instance, NULL);
    case 4: return fmi2SerializedFMUstateSize(instance, NULL, &size);
    case 5: return fmi2DeSerializeFMUstate(instance, NULL, 7, NULL);
    case 6: return fmi2SetDebugLogging(instance, 1, 2, NULL);
    default: return fmi2GetRealStatus(instance, fmi2LastSuccessfulTime, NULL);
    }
}
#define START_ARGUMENTS (instance)
#define SERIALIZED_SIZE fmi2SerializedFMUstateSize
#define SERIALIZE fmi2SerializeFMUstate
#define DESERIALIZE fmi2DeSerializeFMUstate
#define GET_STATE fmi2GetFMUstate
#define SET_STATE fmi2SetFMUstate
#define FREE_STATE fmi2FreeFMUstate
#else
static void hear(void *environment, fmi3Status status, const char *category, const char *message)
{
    messages += environment == &messages && status <= fmi3Error && category && strlen(message) < MOST;
}

static void instantiate(const char *token)
{
    bool logging = below(2), early = below(2);
    instance = fmi3InstantiateCoSimulation(
        "tether", token, below(2) ? NULL : "/a b/", false, logging, false, early, NULL, 0, &messages, hear, NULL);
}

static int enter(void)
{
    return fmi3EnterInitializationMode(instance, below(2), any_number(), 0.0, below(4) == 0, 1.0);
}

static int step(double time, double size)
{
    bool event = true, end = true, early = true;
    double last = NAN;
    int status = fmi3DoStep(instance, time, size, below(2), &event, &end, &early, &last);
    if (event || end || early || last != last) fault("flags of a step");
    return status;
}

static int get_reals(const unsigned *references, size_t count, double *values, size_t room)
{
    return fmi3GetFloat64(instance, references, count, values, room);
}

static int set_reals(const unsigned *references, size_t count, const double *values, size_t room)
{
    return fmi3SetFloat64(instance, references, count, values, room);
}

static int get_integers(const unsigned *references, size_t count, void *values)
{
    return below(2) ? fmi3GetInt32(instance, references, count, values, count)
                    : fmi3GetInt64(instance, references, count, values, count);
}

static int set_integers(const unsigned *references, size_t count, const int *values)
{
    int64_t wide[AT_ONCE];
    for (size_t i = 0; i < count; i++) wide[i] = values[i];
    return below(2) ? fmi3SetInt32(instance, references, count, values, count)
                    : fmi3SetInt64(instance, references, count, wide, count);
}

static int set_derivatives(const unsigned *references, size_t count, const int *orders, const double *values)
{
    return fmi3OK; /* FMI 3 has no such function */
}

static int directional(
    const unsigned *unknowns, size_t count, const unsigned *knowns, size_t known_count, const double *seed, size_t seeds,
    double *sensitivity, size_t room)
{
    return fmi3GetDirectionalDerivative(instance, unknowns, count, knowns, known_count, seed, seeds, sensitivity, room);
}

static int not_offered(void)
{
    switch (below(6)) {
    case 0: return fmi3GetAdjointDerivative(instance, NULL, 1, NULL, 1, NULL, 1, NULL, 1);
    case 1: return fmi3EnterEventMode(instance);
    case 2: return fmi3UpdateDiscreteStates(instance, NULL, NULL, NULL, NULL, NULL, NULL);
    case 3: return fmi3EnterConfigurationMode(instance);
    case 4: return fmi3SetString(instance, NULL, 1, NULL, 1);
    default: return fmi3GetClock(instance, NULL, 1, NULL);
    }
}

static int nulls(void)
{
    size_t size;
    switch (below(9)) {
    case 8: return fmi3GetDirectionalDerivative(instance, NULL, 1, NULL, 1, NULL, 1, NULL, 1);
    case 0: return fmi3GetFloat64(instance, NULL, 1, NULL, 1);
    case 1: return fmi3SetInt32(instance, NULL, 1, NULL, 1);
    case 2: return fmi3GetFMUState(instance, NULL);
    case 3: return fmi3SetFMUState(instance, NULL);
    case 4: return fmi3SerializedFMUStateSize(instance, NULL, &size);
    case 5: return fmi3DeserializeFMUState(instance, NULL, 7, NULL);
    case 6: return fmi3SetDebugLogging(instance, true, 2, NULL);
    default: return fmi3DoStep(instance, 0.0, 0.1, true, NULL, NULL, NULL, NULL);
    }
}
#define START_ARGUMENTS (instance, false, 0.0, 0.0, false, 0.0)
#define SERIALIZED_SIZE fmi3SerializedFMUStateSize
#define SERIALIZE fmi3SerializeFMUState
#define DESERIALIZE fmi3DeserializeFMUState
#define GET_STATE fmi3GetFMUState
#define SET_STATE fmi3SetFMUState
#define FREE_STATE fmi3FreeFMUState
#endif

/* --- what both do */

static unsigned any_reference(void)
{
    return below(20) ? below(VALUES + 1) : (unsigned)draw();
}

static int some_values(bool set)
{
    unsigned references[AT_ONCE];
    size_t count = 1 + below(AT_ONCE), room = 0;
    double values[AT_ONCE * (3 * SHAPE_POINTS + 3)];
    for (size_t i = 0; i < count; i++) {
        references[i] = set && below(2) ? below(AT_INPUTS) : any_reference();
        room += references[i] <= VALUES ? WIDTH[references[i]] : 1;
    }
    if (below(10) == 0) room = below(AT_ONCE);
    for (size_t i = 0; i < room; i++) values[i] = below(2) ? (double)below(400) : any_number();
    return set ? set_reals(references, count, values, room) : get_reals(references, count, values, room);
}

static int some_integers(bool set)
{
    unsigned references[AT_ONCE];
    int values[AT_ONCE];
    int64_t found[AT_ONCE];
    size_t count = 1 + below(AT_ONCE);
    for (size_t i = 0; i < count; i++) {
        references[i] = below(2) ? PARAMETERS_AT + below(PARAMETERS) : any_reference();
        values[i] = below(4) ? (int)below(7) : (int)draw();
    }
    return set ? set_integers(references, count, values) : get_integers(references, count, found);
}

static int some_input_derivatives(void)
{
    unsigned references[AT_ONCE];
    int orders[AT_ONCE];
    double values[AT_ONCE];
    size_t count = 1 + below(AT_ONCE);
    bool good = below(2);
    for (size_t i = 0; i < count; i++) {
        references[i] = good ? (unsigned)(AT_GROUND_POSITION + below(7)) : any_reference();
        orders[i] = good || below(4) ? 1 : (int)draw();
        values[i] = good || below(2) ? (double)below(40) : any_number();
    }
    return set_derivatives(references, count, orders, values);
}

static size_t bytes_of(Byte *bytes)
{
    State state = NULL;
    size_t size = 0;
    if (GET_STATE(instance, &state) || SERIALIZED_SIZE(instance, state, &size) || size > MOST * 8) fault("no state");
    if (SERIALIZE(instance, state, bytes, size) || FREE_STATE(instance, &state) || state) fault("no bytes");
    return size;
}

/* References of inputs or of outputs, or of anything; returns the number of their values. */
static size_t draw_references(unsigned first, unsigned number, size_t count, unsigned *references)
{
    size_t room = 0;
    for (size_t i = 0; i < count; i++) {
        references[i] = below(8) ? first + below(number) : any_reference();
        room += references[i] <= VALUES ? WIDTH[references[i]] : 1;
    }
    return below(10) ? room : below(AT_ONCE);
}

/* A directional derivative: whatever the answer, the state is that of before, and what is found is finite. */
static int some_derivative(void)
{
    static Byte before[MOST * 8], after[MOST * 8];
    enum { ROOM = AT_ONCE * (3 * SHAPE_POINTS + 3) };
    unsigned unknowns[AT_ONCE], knowns[AT_ONCE];
    double seed[ROOM], sensitivity[ROOM] = {0.0};
    size_t count = 1 + below(3), known_count = 1 + below(3), size = bytes_of(before);
    size_t room = draw_references(OUTPUTS_AT, 6, count, unknowns), seeds = draw_references(0, AT_INPUTS, known_count, knowns);
    for (size_t i = 0; i < seeds; i++) seed[i] = below(8) ? (double)below(3) : any_number();
    int status = directional(unknowns, count, knowns, known_count, seed, seeds, sensitivity, room);
    if (((Instance *)instance)->phase != INITIALIZING && (bytes_of(after) != size || memcmp(before, after, size)))
        fault("a derivative has changed the state");
    if (FMI == 2) room = count < room ? count : room;
    for (size_t i = 0; i < ROOM; i++)
        if (is_finite(sensitivity[i]) != (status == OK || i >= room)) fault("a derivative that is there, or not, is not finite");
    return status;
}

static int read_bytes(void)
{
    static Byte bytes[MOST * 8];
    State *state = &states[below(STATES)];
    size_t size = bytes_of(bytes);
    switch (below(5)) {
    case 0: size = below((unsigned)size); break;
    case 1: bytes[below((unsigned)size)] ^= (Byte)(1 + below(255)); break;
    case 2: /* numbers of any kind, with a checksum that is right */
        for (unsigned i = 0; i < 3; i++) {
            double number = any_number();
            memcpy(bytes + FIRST_NUMBER + 8 * below((unsigned)(size - FIRST_NUMBER) / 8), &number, 8);
        }
        uint32_t checksum = crc32((unsigned char *)bytes + HEADER, size - HEADER);
        memcpy(bytes + offsetof(Head, checksum), &checksum, sizeof checksum);
    }
    Byte *copy = malloc(size + 1); /* so that a byte too many is seen */
    memcpy(copy, bytes, size);
    int status = DESERIALIZE(instance, copy, size, state);
    free(copy);
    return status;
}

static int write_bytes(void)
{
    State state = states[below(STATES)];
    size_t size = below(5000);
    Byte *room = malloc(size + 1);
    int status = SERIALIZE(instance, state, room, size);
    free(room);
    return status;
}

static int counted(int status)
{
    steps += status == OK;
    return status;
}

/* A start as it should be. */
static int begin(void)
{
    CALL(Reset)(instance);
    int status = CALL(EnterInitializationMode)START_ARGUMENTS;
    return status ? status : (int)CALL(ExitInitializationMode)(instance);
}

static int one_call(void)
{
    static const double SIZES[] = {0.001, 0.02, 0.1, 0.0, -0.02, NAN, INFINITY, 1e7};
    double foreign[4] = {0.0};
    State other = foreign;
    switch (below(34)) {
    case 30: return some_input_derivatives();
    case 31: case 32: case 33: return some_derivative();
    case 0: case 1: return enter();
    case 24: case 25: return begin();
    case 26: case 27: case 28: case 29: return counted(step(0.0, SIZES[below(3)]));
    case 2: case 3: return CALL(ExitInitializationMode)(instance);
    case 4: return below(4) ? 0 : (int)CALL(Terminate)(instance);
    case 5: return below(4) ? 0 : (int)CALL(Reset)(instance);
    case 6: case 7: case 8: case 9: return counted(step(below(8) ? 0.0 : any_number(), SIZES[below(8)]));
    case 10: case 11: return some_values(false);
    case 12: return some_values(true);
    case 13: return some_integers(false);
    case 14: return some_integers(true);
    case 15: case 16: return GET_STATE(instance, &states[below(STATES)]);
    case 17: case 18: return SET_STATE(instance, states[below(STATES)]);
    case 19: return read_bytes();
    case 20: return write_bytes();
    case 21: return below(2) ? FREE_STATE(instance, &states[below(STATES)]) : SET_STATE(instance, other);
    case 22: return not_offered();
    default: return nulls();
    }
}

static void check(const Byte *before, size_t size, int status, int said)
{
    static Byte after[MOST * 8];
    const Instance *known = instance;
    for (int i = 0; i < VALUES; i++)
        if (KIND[i] & OUTPUT && !is_finite(known->values[i])) fault("an output is not finite");
    if (status < 0 || status > ERROR) fault("a status that does not exist");
    if (status == OK) return;
    if (status == WARNING) fault("a warning is a message, and no status");
    if (messages == said) fault("refused without a word");
    if (bytes_of(after) != size || memcmp(before, after, size)) fault("a refused call has changed the state");
}

static void session(void)
{
    static Byte before[MOST * 8];
    double foreign[64] = {0.0};
    instantiate(below(10) ? TOKEN : "{wrong}");
    if (!instance) instantiate(TOKEN);
    if (!instance) fault("no instance");
    if (CALL(Reset)(NULL) != (int)ERROR || CALL(Reset)(foreign) != (int)ERROR) fault("a foreign instance");
    CALL(FreeInstance)(foreign);
    for (int i = 0; i < CALLS; i++) {
        size_t size = bytes_of(before);
        int said = messages;
        check(before, size, one_call(), said);
    }
    for (int i = 0; i < STATES; i++)
        if (CALL(Reset)(instance) || FREE_STATE(instance, &states[i]) || states[i]) fault("a state cannot be freed");
    CALL(FreeInstance)(instance);
}

int main(int count, char **argument)
{
    if (count != 3) return 2;
    long sessions = atol(argument[2]);
    random_state = strtoull(argument[1], NULL, 10);
    for (long i = 0; i < sessions; i++) session();
    printf("%ld sessions done: %d steps, %d messages\n", sessions, steps, messages);
    return 0;
}
