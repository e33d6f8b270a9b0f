/* One running tether, for the functions of FMI 2 and of FMI 3.

The generated `tables.h` has what the declarations of the package say: places in the flat arrays (AT_..., see layout.py),
variables, parameters and sentences. */
#ifndef TETHER_H
#define TETHER_H

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "tables.h"

typedef enum { OK, WARNING, DISCARD, ERROR } Status; /* the numbers of FMI 2 and FMI 3 */
typedef enum { FLOAT64, INT32, INT64 } Type;         /* of the numbers that the importer passes */

/* What the kernels work on: the arrays of layout.py for a number of segments. */
typedef struct {
    int64_t segments;
    double *parameters, *state, *work;
    double *before; /* the state before the last step that was done */
    double *spare;  /* room for a state */
    double *values; /* of the tether, for a start or a saved state that may be refused */
    double inputs[AT_INPUTS]; /* of the last step */
    bool is_repeatable;       /* whether `before` and `inputs` are known: not after a start or a restored state */
} Chain;

typedef struct Tether Tether;
typedef void (*Log)(const Tether *tether, Status status, const char *text);

struct Tether {
    const void *identity; /* `&THIS_FMU`, so that a pointer to anything else is recognized */
    char *name;
    Log log; /* of fmi2.c or fmi3.c, which know the type of the importer's function */
    void *environment;
    void (*importer_log)(void);
    const char *call; /* the FMI function that runs, for messages */
    Phase phase;
    bool stop_is_defined, warned_of_time;
    uint32_t warned;              /* what was implausible and has been said, as bits */
    double tolerance;             /* the importer's, 0 for none */
    double time;                  /* end of the last step [s], NaN before the first */
    double start_time, stop_time; /* [s] */
    Chain *chain;                 /* NULL before the first start */
    double values[VALUES + 1];    /* inputs, outputs, parameters; last the time */
    double derivatives[1 + AT_INPUTS]; /* of inputs, given before the first step, see derivatives.c */
};

/* A saved state. `bytes` is the record of saved_state.py, its checksum is made when it is serialized. */
typedef struct {
    const void *identity;
    size_t size, room;
    unsigned char bytes[];
} Saved;

extern const char THIS_FMU;
extern const char *const CATEGORY[]; /* names of log categories, by status */

/* `isfinite`, for which the C library of Windows has no function. */
static inline bool is_finite(double number)
{
    return fabs(number) <= DBL_MAX;
}

/* --- the kernels, see entry_points.py */

int32_t KERNEL(initialize)(int64_t, const double *, const double *, double *, double *);
int32_t KERNEL(advance)(int64_t, const double *, const double *, double, double *, double *);
int32_t KERNEL(observe)(int64_t, const double *, const double *, int64_t, double *, double *);

/* --- messages.c: sentences with {names} that are filled in */

typedef struct {
    const char *key, *text;
    double number;
    bool whole;
} Fact;

Fact real(const char *key, double number);
Fact whole(const char *key, double number);
Fact word(const char *key, const char *text);
void fill_in(char *text, size_t room, const char *sentence, const Fact *facts);
Status say(const Tether *tether, Status status, const char *sentence, const Fact *facts);
#define FACTS(...) ((const Fact[]){__VA_ARGS__, {0}})
enum { LONGEST_TEXT = 1024 };

/* --- chain.c: parameters checked and packed, as parameters.py does it */

bool check_parameters(const double *values, char *problem);
Chain *make_chain(const double *values, double importer_tolerance);
void free_chain(Chain *chain);
int32_t first_shape(const Chain *chain, double *values);
int32_t observe(const Chain *chain, double *values);
void read_free_kite(const Chain *chain, double *values);

/* --- tether.c: its life */

Tether *entered(void *instance, const char *call);
Tether *make_tether(const char *name, Log log, void *environment, void (*importer_log)(void));
void free_tether(Tether *tether);
void to_start_values(Tether *tether);
void take_chain(Tether *tether, Chain *chain);
Status check_token(const Tether *tether, const char *token);
Status check_categories(const Tether *tether, size_t count, const char *const *categories);
Status set_up_experiment(Tether *tether, bool has_tolerance, double tolerance, double start, bool has_stop, double stop);
Status enter_initialization(Tether *tether);
Status exit_initialization(Tether *tether);
Status start(Tether *tether, Status refusal);
Status advance(Tether *tether, double time, double step);
Status terminate(Tether *tether);
double last_successful_time(const Tether *tether);

unsigned kind_of(unsigned reference, unsigned kinds);
Status check_count(const Tether *tether, const unsigned *references, size_t count, size_t room);
Status get_values(
    Tether *tether, Type type, unsigned kinds, const unsigned *references, size_t count, void *values, size_t room);
Status set_values(
    Tether *tether, Type type, unsigned kinds, const unsigned *references, size_t count, const void *values, size_t room);

/* --- derivatives.c */

Status set_input_derivatives(
    Tether *tether, const unsigned *references, size_t count, const int32_t *orders, const double *values);
Status directional_derivative(
    Tether *tether, const unsigned *unknowns, size_t count, const unsigned *knowns, size_t known_count, const double *seed,
    size_t seeds, double *sensitivity, size_t room);

/* --- saved_state.c */

Status save(Tether *tether, Saved **saved);
Status free_saved(const Tether *tether, Saved **saved);
Status restore(Tether *tether, const Saved *saved);
Status saved_size(const Tether *tether, const Saved *saved, size_t *size);
Status serialize(const Tether *tether, const Saved *saved, void *bytes, size_t size);
Status deserialize(const Tether *tether, const void *bytes, size_t size, Saved **saved);

/* --- what the functions of FMI begin and end with */

#define ENTER(instance)                           \
    Tether *tether = entered(instance, __func__); \
    if (!tether) return (int)ERROR
#define NEED(pointer) \
    if (!(pointer)) return (int)say(tether, ERROR, IS_NULL, FACTS(word("argument", #pointer)))
#define DONE(status) return (int)(status)
#define NOT_OFFERED_CALL(type, name, ...)            \
    type name(__VA_ARGS__)                           \
    {                                                \
        ENTER(instance);                             \
        DONE(say(tether, ERROR, NOT_OFFERED, NULL)); \
    }

#endif
