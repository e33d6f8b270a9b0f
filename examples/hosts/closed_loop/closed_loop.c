/* How does a host in C fly a kite in real time? A kite on a circle, on `TetherDynamicFree` for FMI 3, in steps of 5 ms.

    tetherfmu build TetherDynamicFree --native --fmi 3 --header --sources --out native
    python -m zipfile --extract native/TetherDynamicFree.fmu native/TetherDynamicFree
    cmake -S examples/hosts/closed_loop -B build -DNATIVE=native && cmake --build build
    build/closed_loop native/TetherDynamicFree

With -DLINKED=ON the C sources of the FMU are in the program, which then needs no folder and loads nothing.

    --duration S    how long the kite flies [s], 60 if not given
    --fast          as fast as possible, not in real time
    --refuse S      at this time [s] the load on the kite is no number, as from a sensor that fails: the step is refused

For Linux and Windows. The kite gives a load to the tether, the tether moves it; the load belongs to the start of a step. A
step that is late does not delay those after it. When the tether refuses a step, the host restores the state of before and
repeats the step with the load of the last one. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "TetherDynamicFree.h"
#include "kite.h"
#include "platform.h"

#define STEP 0.005 /* [s] */
enum { SECOND = 200 }; /* steps */

static const fmi3Float64 LENGTH = 200.0, STRETCHED = 200.8, MASS = 19.6, START_SPEED = 20.0; /* [m], [m], [kg], [m/s] */
static const Vector WIND = {9.0, 0.0, 0.0}; /* [m/s] */
static Fmu fmu;
static fmi3Instance tether;

typedef struct {
    double duration, refuse; /* [s] */
    int fast;
    const char *folder; /* of the extracted FMU */
} Options;

typedef struct { /* what the summary says */
    long late, refused;
    double latest, largest_force, largest_tension; /* [s], [N], [N] */
    uint64_t checksum; /* of the force on the kite after each step */
} Summary;

static void stop(const char *reason)
{
    fprintf(stderr, "closed_loop: %s\n", reason);
    exit(1);
}

static void print_message(fmi3InstanceEnvironment host, fmi3Status status, fmi3String category, fmi3String message)
{
    (void)host, (void)status, (void)category;
    fprintf(stderr, "%s\n", message);
}

static void check(fmi3Status status)
{
    if (status > fmi3Warning) stop("the FMU refused a call; its message says why");
}

static void set(fmi3ValueReference variable, fmi3Float64 value)
{
    check(fmu.SetFloat64(tether, &variable, 1, &value, 1));
}

static void set_vector(fmi3ValueReference variable, Vector value)
{
    const fmi3Float64 values[] = {value.x, value.y, value.z};
    check(fmu.SetFloat64(tether, &variable, 1, values, 3));
}

static double get(fmi3ValueReference variable)
{
    fmi3Float64 value = 0.0;
    check(fmu.GetFloat64(tether, &variable, 1, &value, 1));
    return value;
}

static Vector get_vector(fmi3ValueReference variable)
{
    fmi3Float64 values[3] = {0.0, 0.0, 0.0};
    check(fmu.GetFloat64(tether, &variable, 1, values, 3));
    return (Vector){values[0], values[1], values[2]};
}

static Options read_options(int count, char **argument)
{
    Options found = {60.0, -1.0, 0, NULL};
    for (int k = 1; k < count; k++) {
        double *number = strcmp(argument[k], "--duration") == 0 ? &found.duration
                         : strcmp(argument[k], "--refuse") == 0 ? &found.refuse : NULL;
        if (number && k + 1 < count) {
            char *end;
            *number = strtod(argument[++k], &end);
            if (*end || end == argument[k] || !(*number >= 0.0 && *number <= 1e6)) stop("a time is from 0 to 1e6 s");
        } else if (strcmp(argument[k], "--fast") == 0) found.fast = 1;
        else if (argument[k][0] == '-' || found.folder) stop("options: --duration S, --fast, --refuse S");
        else found.folder = argument[k];
    }
#if !defined(LINKED)
    if (!found.folder) stop("give the folder of an extracted TetherDynamicFree.fmu");
#endif
    return found;
}

static Kite start_flight(void)
{
    const Vector position = start_of_circle(STRETCHED);
    const fmi3ValueReference segments = TETHER_SEGMENTS;
    const fmi3Int32 ten = 10;
    Kite kite = first_kite(position);
    tether = fmu.InstantiateCoSimulation("tether", TETHER_INSTANTIATION_TOKEN, NULL, fmi3False, fmi3True, fmi3False,
                                         fmi3False, NULL, 0, NULL, print_message, NULL);
    if (!tether) stop("the FMU gives no instance");
    check(fmu.SetInt32(tether, &segments, 1, &ten, 1));
    set(TETHER_FIXED_STEP, STEP);
    set(TETHER_INITIAL_LENGTH, LENGTH);
    set(TETHER_KITE_MASS, MASS);
    set_vector(TETHER_INITIAL_KITE_POSITION, position);
    set_vector(TETHER_INITIAL_KITE_VELOCITY, sum((Vector){0.0, 0.0, 0.0}, START_SPEED, kite.heading));
    set_vector(TETHER_WIND_VELOCITY, WIND);
    check(fmu.EnterInitializationMode(tether, fmi3False, 0.0, 0.0, fmi3False, 0.0));
    check(fmu.ExitInitializationMode(tether));
    return kite;
}

static fmi3Status do_step(double time)
{
    fmi3Boolean event, end, early;
    fmi3Float64 reached;
    return fmu.DoStep(tether, time, STEP, fmi3True, &event, &end, &early, &reached);
}

/* Do a step with a load [N]; if it is refused, with the load of the step before. Returns whether it was refused. */
static int step_with(Vector load, double time, fmi3FMUState *before)
{
    check(fmu.GetFMUState(tether, before)); /* with the inputs; takes memory the first time only */
    set_vector(TETHER_KITE_LOAD, load);
    const fmi3Status status = do_step(time);
    const int refused = status == fmi3Discard;
    if (refused) check(fmu.SetFMUState(tether, *before));
    check(refused ? do_step(time) : status);
    return refused;
}

static void take_note(Summary *summary, Vector force)
{
    const double numbers[] = {force.x, force.y, force.z};
    unsigned char bytes[sizeof numbers];
    memcpy(bytes, numbers, sizeof bytes);
    for (size_t i = 0; i < sizeof bytes; i++) summary->checksum = (summary->checksum ^ bytes[i]) * UINT64_C(1099511628211);
    summary->largest_force = fmax(summary->largest_force, norm(force));
    summary->largest_tension = fmax(summary->largest_tension, get(TETHER_PEAK_TENSION));
}

static Summary fly(Kite kite, Options options)
{
    Summary summary = {0, 0, 0.0, 0.0, 0.0, UINT64_C(14695981039346656037)}; /* start of FNV-1a */
    fmi3FMUState before = NULL;
    Vector position = get_vector(TETHER_KITE_POSITION), velocity = get_vector(TETHER_KITE_VELOCITY);
    const long steps = lround(options.duration / STEP), spoiled = options.refuse < 0.0 ? -1 : lround(options.refuse / STEP);
    const double began = now();
    for (long k = 0; k < steps; k++) {
        Vector load = load_of_air(&kite, position, velocity, WIND);
        if (k == spoiled) load.x = NAN;
        summary.refused += step_with(load, STEP * (double)k, &before);
        position = get_vector(TETHER_KITE_POSITION), velocity = get_vector(TETHER_KITE_VELOCITY);
        turn(&kite, position, STEP);
        const Vector force = get_vector(TETHER_KITE_FORCE);
        take_note(&summary, force);
        if ((k + 1) % SECOND == 0)
            printf("%4ld s  height %5.1f m  speed %4.1f m/s  force on the kite %6.1f N  tension at the ground %6.1f N\n",
                   (k + 1) / SECOND, position.z, norm(velocity), norm(force), get(TETHER_GROUND_TENSION));
        if (options.fast) continue;
        const double deadline = began + STEP * (double)(k + 1), lateness = now() - deadline;
        if (lateness > 0.0) summary.late++, summary.latest = fmax(summary.latest, lateness);
        fflush(stdout);
        sleep_until(deadline);
    }
    check(fmu.FreeFMUState(tether, &before));
    printf("%ld steps of %g ms, %ld refused and repeated\n", steps, 1e3 * STEP, summary.refused);
    return summary;
}

int main(int count, char **argument)
{
    char problem[256] = "";
    const Options options = read_options(count, argument);
    if (!find_functions(&fmu, options.folder, problem)) stop(problem);
    const Summary summary = fly(start_flight(), options);
    fmu.FreeInstance(tether);
    printf("largest force on the kite %.1f N, largest tension %.1f N\n", summary.largest_force, summary.largest_tension);
    if (!options.fast) printf("%ld late steps, the latest by %.3f ms\n", summary.late, 1e3 * summary.latest);
    printf("checksum of all forces on the kite %016llx\n", (unsigned long long)summary.checksum);
    return 0;
}
