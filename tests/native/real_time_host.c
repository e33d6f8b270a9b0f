/* A rig in C around a native FMU for FMI 2 with fixed steps: real_time_host TOKEN MODE FLIGHT STEPS STEP FIXED

MODE : time (prints the median, the 99.99th percentile and the largest time of fmi2DoStep, its inputs and outputs [us], by
the clock and of the processor, and the most iterations in one), silent (the process is killed at any system call and aborts at any allocation in the steps) or
loud (the same, with a system call after them).  FLIGHT : circle, snaps or rest.  STEP : communication step [s].
FIXED : value reference of fixed_step, its value [s] and the reference of solver_iterations, with commas between them.
Compiled with _GNU_SOURCE, the C shell, the kernels, and --wrap of malloc, calloc, realloc and free. */
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#include "fmi2Functions.h"
#include "instance.h"

enum { MOVED = 6, WIND = 3, WARM = 100 };
static const unsigned READ[MOVED] = {
    OUTPUTS_AT + AT_GROUND_FORCE, OUTPUTS_AT + AT_GROUND_FORCE + 1, OUTPUTS_AT + AT_GROUND_FORCE + 2,
    OUTPUTS_AT + AT_KITE_FORCE, OUTPUTS_AT + AT_KITE_FORCE + 1, OUTPUTS_AT + AT_KITE_FORCE + 2};
static const unsigned SET[MOVED + WIND] = {
    AT_KITE_POSITION, AT_KITE_POSITION + 1, AT_KITE_POSITION + 2, AT_KITE_VELOCITY, AT_KITE_VELOCITY + 1,
    AT_KITE_VELOCITY + 2, AT_WIND_VELOCITY, AT_WIND_VELOCITY + 1, AT_WIND_VELOCITY + 2};
static int stepping;

#define WATCHED(call) \
    if (stepping) abort(); \
    return call
void *__real_malloc(size_t), *__real_calloc(size_t, size_t), *__real_realloc(void *, size_t), __real_free(void *);
void *__wrap_malloc(size_t size) { WATCHED(__real_malloc(size)); }
void *__wrap_calloc(size_t count, size_t size) { WATCHED(__real_calloc(count, size)); }
void *__wrap_realloc(void *block, size_t size) { WATCHED(__real_realloc(block, size)); }
void __wrap_free(void *block)
{
    if (stepping) abort();
    __real_free(block);
}

static void die(const char *what)
{
    fprintf(stderr, "%s\n", what);
    exit(3);
}

static void forbid_system_calls(void) /* all but the one that ends the process */
{
    struct sock_filter lines[] = {
        BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(struct seccomp_data, nr)),
        BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_exit_group, 0, 1),
        BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
        BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_KILL_PROCESS)};
    struct sock_fprog program = {4, lines};
    if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) || prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program)) exit(77);
}

static double now(clockid_t clock) /* [us] */
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
    printf("%g %g %g ", times[count / 2], times[(long)(0.9999 * (double)count)], times[count - 1]);
}

/* Position [m] and velocity [m/s] of the kite, and the wind [m/s]. The tether is 505 m long. */
static void motion(char flight, double time, double *inputs)
{
    static const double ALONG[] = {0.6, 0.0, 0.8};
    double angle = 0.05 * time, rate = 1.5707963267948966;
    for (int i = 0; i < WIND; i++) inputs[MOVED + i] = i == 0 && flight != 'r' ? 8.0 : 0.0;
    if (flight == 'c') { /* 505.3 m from the ground station on a circle of 87 m, whose axis rises by 20 degrees */
        double up = 87.0 * sin(angle), climb = 4.35 * cos(angle);
        inputs[0] = 467.73 - 0.34202 * up, inputs[1] = 87.0 * cos(angle), inputs[2] = 170.24 + 0.93969 * up;
        inputs[3] = -0.34202 * climb, inputs[4] = -4.35 * sin(angle), inputs[5] = 0.93969 * climb;
        return;
    }
    for (int i = 0; i < 3; i++) { /* between 460 and 506 m, 0.25 Hz, 36 m/s at most; or at rest at 500 m */
        inputs[i] = ALONG[i] * (flight == 'r' ? 500.0 : 483.0 + 23.0 * sin(rate * time));
        inputs[3 + i] = flight == 'r' ? 0.0 : ALONG[i] * 23.0 * rate * cos(rate * time);
    }
}

int main(int count, char **argument)
{
    static const fmi2CallbackFunctions callbacks = {NULL, NULL, NULL, NULL, NULL};
    unsigned fixed_step, iterations;
    double fixed, inputs[MOVED + WIND], found[MOVED];
    int before = 0, most = 0, spent = 0;
    if (count != 7 || sscanf(argument[6], "%u,%lf,%u", &fixed_step, &fixed, &iterations) != 3) return 2;
    char mode = argument[2][0], flight = argument[3][0];
    long steps = atol(argument[4]);
    double step = atof(argument[5]), *times = malloc(2 * (size_t)steps * sizeof *times), *of_processor = times + steps;
    void *tether = fmi2Instantiate("tether", fmi2CoSimulation, argument[1], NULL, &callbacks, 0, 0);
    if (!tether || !times) die("instantiate");
    memset(times, 0, 2 * (size_t)steps * sizeof *times); /* so that its pages are there */
    motion(flight, 0.0, inputs);
    if (fmi2SetReal(tether, &fixed_step, 1, &fixed) > fmi2Warning || fmi2SetReal(tether, SET, MOVED + WIND, inputs)) die("set");
    if (fmi2EnterInitializationMode(tether) || fmi2ExitInitializationMode(tether) > fmi2Warning) die("initialize");
    for (long k = -WARM; k < steps; k++) {
        if (k == 0 && mode != 't') {
            stepping = 1;
            forbid_system_calls();
        }
        motion(flight, (double)(k + WARM) * step, inputs);
        double began = 0.0, begun = 0.0;
        if (mode == 't') begun = now(CLOCK_THREAD_CPUTIME_ID), began = now(CLOCK_MONOTONIC);
        int status = fmi2SetReal(tether, SET, MOVED + WIND, inputs);
        if (!status) status = fmi2DoStep(tether, (double)(k + WARM) * step, step, 1);
        if (status <= fmi2Warning) status = fmi2GetReal(tether, READ, MOVED, found);
        if (mode == 't' && k >= 0) {
            times[k] = now(CLOCK_MONOTONIC) - began;
            of_processor[k] = now(CLOCK_THREAD_CPUTIME_ID) - begun;
        }
        if (status > fmi2Warning) _exit(4);
        fmi2GetInteger(tether, &iterations, 1, &spent);
        if (k >= 0 && spent - before > most) most = spent - before;
        before = spent;
    }
    if (mode == 'l') syscall(SYS_getppid);
    if (mode != 't') _exit(0);
    print_percentiles(times, steps);
    print_percentiles(of_processor, steps);
    printf("%d\n", most);
    return 0;
}
