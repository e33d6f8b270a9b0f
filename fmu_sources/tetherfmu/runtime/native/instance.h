/* One instance of the FMU: its life from instantiation to termination, and the values of its variables. */
#ifndef INSTANCE_H
#define INSTANCE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "arrays.h"
#include "messages.h"
#include "polygons.h"
#include "tables.h"

typedef enum { FLOAT64, FLOAT32, INT32, INT64, TRUTH_INT, TRUTH, BYTES } Type; /* of the importer's values */
typedef void (*Log)(const Instance *instance, Status status, const char *text);

struct Instance {
    const void *identity; /* identifies valid pointers */
    char *name;
    Log log; /* of fmi2.c or fmi3.c, which know the type of the importer's function */
    void *environment;
    void (*importer_log)(void);
    const char *call; /* the FMI function that runs, for messages */
    Phase phase;
    bool is_logging, has_written; /* whether the importer wants messages; whether the first refusal went to stderr */
    bool stop_is_defined, warned_of_time;
    uint64_t warned[LINES];       /* reported implausibilities of each line, as bits */
    double tolerance;             /* the importer's, 0 for none */
    double time;                  /* end of the last step [s], NaN before the first */
    double start_time, stop_time; /* [s] */
    Watch watch;                  /* of the path of the kite end of a tether alone */
    Arrays *arrays;               /* NULL before the first start */
    double values[VALUES + 1];    /* inputs, outputs, parameters; last the time */
    double derivatives[INPUTS];     /* of inputs, set before the first step */
    bool has_derivative[INPUTS];    /* whether one was given */
    double scratch[3 * VALUES];     /* without meaning between calls */
    double quantities[QUANTITIES];  /* of a line, in kernel order; undefined between calls */
    int64_t plan[PLAN_SIZE];        /* of arrays that are not allocated yet */
};

extern const char AN_INSTANCE, A_SAVED_STATE; /* their addresses mark objects of this FMU */
extern const char *const CATEGORY[]; /* names of log categories, by status */

/* --- its life */

void unmark(const void **identity);
Instance *entered(void *handle, const char *call);
Status refuse_call(void *handle, const char *call);
Instance *make_instance(const char *name, Log log, void *environment, void (*importer_log)(void), bool is_logging);
void free_instance(Instance *instance);
void to_start_values(Instance *instance);
void take_arrays(Instance *instance, Arrays *arrays);
Status check_token(Instance *instance, const char *token);
Status set_logging(Instance *instance, bool is_logging, size_t count, const char *const *categories);
Status set_up_experiment(
    Instance *instance, bool has_tolerance, double tolerance, double start, bool has_stop, double stop);
Status enter_initialization(Instance *instance);
Status exit_initialization(Instance *instance);
Status start(Instance *instance, Status refusal);
Status advance(Instance *instance, double time, double step, Status refusal);
Status terminate(Instance *instance);
double last_successful_time(const Instance *instance);

/* --- its values */

unsigned kind_of(unsigned reference, unsigned kinds);
Fact name_of(unsigned reference);
#define VARIABLE(reference) whole("reference", reference), name_of(reference) /* facts for sentences about a variable */
Status check_count(Instance *instance, const unsigned *references, size_t count, size_t room);
Status filled(Status status, Type type, void *values, size_t room);
Status get_values(
    Instance *instance, Type type, unsigned kinds, const unsigned *references, size_t count, void *values, size_t room);
Status set_values(
    Instance *instance, Type type, unsigned kinds, const unsigned *references, size_t count, const void *values,
    size_t room);

#endif
