/* Flies the circle with an FMU for FMI 2 that is compiled into this program, and times each step.

    host INPUTS STEPS STEP SEGMENTS FIXED_STEP [OUTPUTS]

INPUTS: rows of position and velocity of the kite as doubles, begun again after the last one. OUTPUTS: file for the forces
after each step. Prints the median, the 99.99th percentile and the longest time of a step [us], by the clock and of the
processor, and the most iterations in one. SEGMENTS_AT, FIXED_STEP_AT, KITE_AT, FORCES_AT, ITERATIONS_AT: value references. */
#define _POSIX_C_SOURCE 199309L
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "fmu.c"

enum { MOVED = 6, PULLS = 6 };

static void print_message(
    fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status, fmi2String category, fmi2String message, ...)
{
    fprintf(stderr, "%s: %s\n", category, message);
}

static void expect(int good, const char *what)
{
    if (good) return;
    fprintf(stderr, "%s failed\n", what);
    exit(1);
}

static double now(clockid_t clock)
{
    struct timespec time;
    clock_gettime(clock, &time);
    return 1e6 * (double)time.tv_sec + 1e-3 * (double)time.tv_nsec;
}

static int compare(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void print_percentiles(double *times, long count)
{
    qsort(times, (size_t)count, sizeof *times, compare);
    printf("%.2f %.2f %.2f ", times[count / 2], times[(long)(0.9999 * (double)count)], times[count - 1]);
}

int main(int count, char **arguments)
{
    expect(count >= 6, "reading the arguments");
    FILE *file = fopen(arguments[1], "rb"), *kept = count > 6 ? fopen(arguments[6], "wb") : NULL;
    long steps = atol(arguments[2]);
    double step = atof(arguments[3]), fixed_step = atof(arguments[5]);
    double *times = malloc(2 * (size_t)steps * sizeof *times), *of_processor = times + steps;
    int segments = atoi(arguments[4]), before = 0, most = 0;
    static double rows[100000][MOVED];
    expect(file != NULL, "opening the inputs");
    expect(times != NULL, "taking memory");
    memset(times, 0, 2 * (size_t)steps * sizeof *times); /* so that its pages are there */
    size_t revolution = fread(rows, sizeof *rows, 100000, file);
    fclose(file);
    fmi2CallbackFunctions functions = {print_message, NULL, NULL, NULL, NULL};
    fmi2Component c = fmi2Instantiate("tether", fmi2CoSimulation, TOKEN, "", &functions, fmi2False, fmi2False);
    expect(c != NULL, "fmi2Instantiate");
    fmi2ValueReference kite[MOVED], forces[PULLS], at_segments = SEGMENTS_AT, at_fixed_step = FIXED_STEP_AT;
    fmi2ValueReference at_iterations = ITERATIONS_AT;
    for (unsigned i = 0; i < MOVED; i++) kite[i] = KITE_AT + i;
    for (unsigned i = 0; i < PULLS; i++) forces[i] = FORCES_AT + i;
    expect(fmi2SetInteger(c, &at_segments, 1, &segments) == fmi2OK, "fmi2SetInteger");
    expect(fmi2SetReal(c, &at_fixed_step, 1, &fixed_step) == fmi2OK, "fmi2SetReal");
    expect(fmi2SetReal(c, kite, MOVED, rows[0]) == fmi2OK, "fmi2SetReal");
    expect(fmi2SetupExperiment(c, fmi2False, 0.0, 0.0, fmi2False, 0.0) == fmi2OK, "fmi2SetupExperiment");
    expect(fmi2EnterInitializationMode(c) == fmi2OK, "fmi2EnterInitializationMode");
    expect(fmi2ExitInitializationMode(c) <= fmi2Warning, "fmi2ExitInitializationMode");
    for (long k = 0; k < steps; k++) {
        double found[PULLS], begun = now(CLOCK_THREAD_CPUTIME_ID), began = now(CLOCK_MONOTONIC);
        int iterations;
        expect(fmi2SetReal(c, kite, MOVED, rows[(size_t)k % revolution]) == fmi2OK, "fmi2SetReal");
        expect(fmi2DoStep(c, (double)k * step, step, fmi2True) <= fmi2Warning, "fmi2DoStep");
        expect(fmi2GetReal(c, forces, PULLS, found) == fmi2OK, "fmi2GetReal");
        times[k] = now(CLOCK_MONOTONIC) - began;
        of_processor[k] = now(CLOCK_THREAD_CPUTIME_ID) - begun;
        expect(fmi2GetInteger(c, &at_iterations, 1, &iterations) == fmi2OK, "fmi2GetInteger");
        if (iterations - before > most) most = iterations - before;
        before = iterations;
        if (kept) fwrite(found, sizeof found, 1, kept);
    }
    if (kept) fclose(kept);
    print_percentiles(times, steps);
    print_percentiles(of_processor, steps);
    printf("%d\n", most);
    free(times);
    fmi2FreeInstance(c);
    return 0;
}
