/* Measures a native FMU for FMI 2 as a host in C runs it: native_host FMU GUID KERNELS INPUTS

INPUTS : file of doubles, six inputs for each of STEPS steps. Compiled with the tables of that FMU (tests/native/programs.py),
so that the arrays of an instance can be given to the bare kernels. Prints, in microseconds per step (median of rounds that
alternate): the kernels alone, the FMU; then from instantiation to the end of the first step [us], and bytes per instance. */
#define _POSIX_C_SOURCE 199309L
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "fmi2FunctionTypes.h"
#include "instance.h"

enum { STEPS = 500, ROUNDS = 41, INSTANCES = 10000, MOVED = 6 };
static const double STEP = 0.02;
static const unsigned MOVED_INPUTS[MOVED] = {0, 1, 2, 3, 4, 5}, READ[MOVED] = {
    OUTPUTS_AT + AT_GROUND_FORCE, OUTPUTS_AT + AT_GROUND_FORCE + 1, OUTPUTS_AT + AT_GROUND_FORCE + 2,
    OUTPUTS_AT + AT_KITE_FORCE, OUTPUTS_AT + AT_KITE_FORCE + 1, OUTPUTS_AT + AT_KITE_FORCE + 2};
static double inputs[STEPS][MOVED];

static struct {
    fmi2InstantiateTYPE *instantiate;
    fmi2EnterInitializationModeTYPE *enter;
    fmi2ExitInitializationModeTYPE *leave;
    fmi2SetRealTYPE *set;
    fmi2GetRealTYPE *get;
    fmi2DoStepTYPE *step;
    fmi2ResetTYPE *reset;
} fmi;
static int32_t (*kernel_advance)(int64_t *, double *, double *, double, double *, double *, double *, double *);

static void *find(void *library, const char *name)
{
    void *address = library ? dlsym(library, name) : NULL;
    if (!address) {
        fprintf(stderr, "%s: %s\n", name, dlerror());
        exit(3);
    }
    return address;
}

static double now(void) /* [us] */
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return 1e6 * (double)time.tv_sec + 1e-3 * (double)time.tv_nsec;
}

static int compare(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(double *numbers, int count)
{
    qsort(numbers, (size_t)count, sizeof *numbers, compare);
    return numbers[count / 2];
}

static Instance *started(const char *guid)
{
    static const fmi2CallbackFunctions callbacks = {NULL, NULL, NULL, NULL, NULL};
    Instance *instance = fmi.instantiate("tether", fmi2CoSimulation, guid, NULL, &callbacks, 0, 0);
    if (!instance || fmi.set(instance, MOVED_INPUTS, MOVED, inputs[0]) || fmi.enter(instance) || fmi.leave(instance)) exit(4);
    return instance;
}

static double with_fmi(const char *guid)
{
    double found[MOVED];
    Instance *instance = started(guid);
    double began = now();
    for (int k = 0; k < STEPS; k++)
        if (fmi.set(instance, MOVED_INPUTS, MOVED, inputs[k]) || fmi.step(instance, k * STEP, STEP, 1) || fmi.get(instance, READ, MOVED, found))
            exit(5);
    return (now() - began) / STEPS;
}

static double with_kernels(const char *guid)
{
    Instance *instance = started(guid);
    Arrays *arrays = instance->arrays;
    double began = now();
    for (int k = 0; k < STEPS; k++) {
        memcpy(instance->values, inputs[k], sizeof inputs[k]);
        double *values = instance->values;
        if (kernel_advance(
                arrays->plan, arrays->parameters, values, STEP, arrays->state, arrays->before, values + OUTPUTS_AT,
                arrays->work))
            exit(6);
    }
    return (now() - began) / STEPS;
}

static double first_step(const char *guid)
{
    double began = now();
    if (fmi.step(started(guid), 0.0, STEP, 1)) exit(8);
    return now() - began;
}

static double resident(void)
{
    long pages = 0;
    FILE *file = fopen("/proc/self/statm", "r");
    if (!file || fscanf(file, "%*s %ld", &pages) != 1) exit(9);
    fclose(file);
    return 4096.0 * (double)pages;
}

int main(int count, char **argument)
{
    if (count != 5) return 2;
    void *fmu = dlopen(argument[1], RTLD_NOW | RTLD_LOCAL), *kernels = dlopen(argument[3], RTLD_NOW | RTLD_LOCAL);
    const char *guid = argument[2];
    *(void **)&fmi.instantiate = find(fmu, "fmi2Instantiate");
    *(void **)&fmi.enter = find(fmu, "fmi2EnterInitializationMode");
    *(void **)&fmi.leave = find(fmu, "fmi2ExitInitializationMode");
    *(void **)&fmi.set = find(fmu, "fmi2SetReal");
    *(void **)&fmi.get = find(fmu, "fmi2GetReal");
    *(void **)&fmi.step = find(fmu, "fmi2DoStep");
    *(void **)&kernel_advance = find(kernels, "dynamic_advance");
    FILE *file = fopen(argument[4], "rb");
    if (!file || fread(inputs, sizeof inputs, 1, file) != 1) return 10;
    double bare[ROUNDS], whole[ROUNDS], above[ROUNDS], first[ROUNDS];
    for (int i = 0; i < ROUNDS; i++) {
        first[i] = first_step(guid);
        bare[i] = with_kernels(guid);
        whole[i] = with_fmi(guid);
        above[i] = whole[i] - bare[i];
    }
    double before = resident();
    for (int i = 0; i < INSTANCES; i++) started(guid);
    double each = (resident() - before) / INSTANCES;
    printf("%g %g %g %g %g\n", median(bare, ROUNDS), median(whole, ROUNDS), median(above, ROUNDS), median(first, ROUNDS), each);
    return 0;
}
