/* A small FMI 2.0 host: c_host LIBRARY GUID RESOURCES SCENARIO PLAN END

SCENARIO: text: references of reals to start with, their values, the same of integers; references of inputs, of real outputs, of
          integer outputs; count of steps, their sizes, their inputs. A list of references has its length in front.
PLAN    : alone; interleaved: two instances; threads: four instances at once; relay: every step in a new thread; states: saved, set
          back, set in another instance, reset.
END     : unload the library; finalize its interpreter and keep it loaded; stay: do neither; abandon: free no instance either.
stdout  : a flight per paragraph, the outputs of a communication point per line, exact to the last bit.
Any status but fmi2OK ends the program with exit status 3. */
#include <dlfcn.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef void *component_t;
typedef void *state_t;
typedef unsigned int reference_t;

typedef struct {
    void (*logger)(void *, const char *, int, const char *, const char *, ...);
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void (*step_finished)(void *, int);
    void *environment;
} callbacks_t;

static struct {
    const char *(*GetTypesPlatform)(void);
    const char *(*GetVersion)(void);
    int (*SetDebugLogging)(component_t, int, size_t, const char *const *);
    component_t (*Instantiate)(const char *, int, const char *, const char *, const callbacks_t *, int, int);
    void (*FreeInstance)(component_t);
    int (*SetupExperiment)(component_t, int, double, double, int, double);
    int (*EnterInitializationMode)(component_t);
    int (*ExitInitializationMode)(component_t);
    int (*Terminate)(component_t);
    int (*Reset)(component_t);
    int (*SetReal)(component_t, const reference_t *, size_t, const double *);
    int (*SetInteger)(component_t, const reference_t *, size_t, const int *);
    int (*GetReal)(component_t, const reference_t *, size_t, double *);
    int (*GetInteger)(component_t, const reference_t *, size_t, int *);
    int (*DoStep)(component_t, double, double, int);
    int (*GetFMUstate)(component_t, state_t *);
    int (*SetFMUstate)(component_t, state_t);
    int (*FreeFMUstate)(component_t, state_t *);
    int (*SerializedFMUstateSize)(component_t, state_t, size_t *);
    int (*SerializeFMUstate)(component_t, state_t, char *, size_t);
    int (*DeSerializeFMUstate)(component_t, const char *, size_t, state_t *);
} fmi;

static struct {
    size_t reals, integers, inputs, real_outputs, integer_outputs, steps;
    reference_t *real, *integer, *input, *real_output, *integer_output;
    double *real_start, *step, *value;
    int *integer_start;
} scene;

typedef struct {
    component_t component;
    double time, *real;
    int *integer;
} flight_t;

static const char *guid, *resources;
static int abandoned;

static void fail(const char *what)
{
    fprintf(stderr, "c_host: %s failed\n", what);
    exit(3);
}

#define CALL(function, ...) \
    if (fmi.function(__VA_ARGS__) != 0) fail(#function)

static void *find(void *library, const char *name)
{
    void *address = dlsym(library, name);
    if (!address) fail(name);
    return address;
}

#define FIND(function) *(void **)&fmi.function = find(library, "fmi2" #function)

static void find_functions(void *library)
{
    FIND(GetTypesPlatform), FIND(GetVersion), FIND(SetDebugLogging), FIND(Instantiate), FIND(FreeInstance);
    FIND(SetupExperiment), FIND(EnterInitializationMode), FIND(ExitInitializationMode), FIND(Terminate), FIND(Reset);
    FIND(SetReal), FIND(SetInteger), FIND(GetReal), FIND(GetInteger), FIND(DoStep);
    FIND(GetFMUstate), FIND(SetFMUstate), FIND(FreeFMUstate);
    FIND(SerializedFMUstateSize), FIND(SerializeFMUstate), FIND(DeSerializeFMUstate);
}

/* --- scenario */

static double number(FILE *file)
{
    char text[64];
    if (fscanf(file, "%63s", text) != 1) fail("reading the scenario");
    return strtod(text, NULL);
}

static reference_t *references(FILE *file, size_t *count)
{
    *count = (size_t)number(file);
    reference_t *list = calloc(*count + 1, sizeof *list);
    for (size_t i = 0; i < *count; i++) list[i] = (reference_t)number(file);
    return list;
}

static double *numbers(FILE *file, size_t count)
{
    double *list = calloc(count + 1, sizeof *list);
    for (size_t i = 0; i < count; i++) list[i] = number(file);
    return list;
}

static void read_scene(const char *path)
{
    FILE *file = fopen(path, "r");
    if (!file) fail(path);
    scene.real = references(file, &scene.reals);
    scene.real_start = numbers(file, scene.reals);
    scene.integer = references(file, &scene.integers);
    scene.integer_start = calloc(scene.integers + 1, sizeof(int));
    for (size_t i = 0; i < scene.integers; i++) scene.integer_start[i] = (int)number(file);
    scene.input = references(file, &scene.inputs);
    scene.real_output = references(file, &scene.real_outputs);
    scene.integer_output = references(file, &scene.integer_outputs);
    scene.steps = (size_t)number(file);
    scene.step = numbers(file, scene.steps);
    scene.value = numbers(file, scene.steps * scene.inputs);
    fclose(file);
}

/* --- a flight: one instance and what it gave */

static void say(void *environment, const char *instance, int status, const char *category, const char *format, ...)
{
    (void)environment, (void)category;
    va_list arguments;
    va_start(arguments, format);
    fprintf(stderr, "%s, status %d: ", instance, status);
    vfprintf(stderr, format, arguments);
    fputc('\n', stderr);
    va_end(arguments);
}

static const callbacks_t callbacks = {say, calloc, free, NULL, NULL};

static void observe(flight_t *flight, size_t point)
{
    double *real = flight->real + point * scene.real_outputs;
    int *integer = flight->integer + point * scene.integer_outputs;
    CALL(GetReal, flight->component, scene.real_output, scene.real_outputs, real);
    CALL(GetInteger, flight->component, scene.integer_output, scene.integer_outputs, integer);
}

static void initialize(flight_t *flight)
{
    flight->time = 0.0;
    CALL(SetupExperiment, flight->component, 0, 0.0, 0.0, 0, 0.0);
    CALL(EnterInitializationMode, flight->component);
    CALL(SetReal, flight->component, scene.real, scene.reals, scene.real_start);
    CALL(SetInteger, flight->component, scene.integer, scene.integers, scene.integer_start);
    CALL(ExitInitializationMode, flight->component);
    observe(flight, 0);
}

static flight_t start(const char *name)
{
    flight_t flight = {.component = fmi.Instantiate(name, 1, guid, resources, &callbacks, 0, 0)};
    if (!flight.component) fail("Instantiate");
    flight.real = calloc((scene.steps + 1) * scene.real_outputs + 1, sizeof(double));
    flight.integer = calloc((scene.steps + 1) * scene.integer_outputs + 1, sizeof(int));
    CALL(SetDebugLogging, flight.component, 0, 0, NULL);
    initialize(&flight);
    return flight;
}

static void fly(flight_t *flight, size_t from, size_t to)
{
    for (size_t k = from; k < to; k++) {
        CALL(SetReal, flight->component, scene.input, scene.inputs, scene.value + k * scene.inputs);
        CALL(DoStep, flight->component, flight->time, scene.step[k], 1);
        flight->time += scene.step[k];
        observe(flight, k + 1);
    }
}

static void print(const flight_t *flight)
{
    for (size_t k = 0; k <= scene.steps; k++) {
        for (size_t i = 0; i < scene.real_outputs; i++) printf("%a ", flight->real[k * scene.real_outputs + i]);
        for (size_t i = 0; i < scene.integer_outputs; i++) printf("%d ", flight->integer[k * scene.integer_outputs + i]);
        printf("\n");
    }
    printf("\n");
}

static void land(flight_t *flight)
{
    print(flight);
    if (abandoned) return;
    CALL(Terminate, flight->component);
    fmi.FreeInstance(flight->component);
    free(flight->real);
    free(flight->integer);
}

/* --- plans */

static void alone(void)
{
    flight_t flight = start("alone");
    fly(&flight, 0, scene.steps);
    land(&flight);
}

static void interleaved(void)
{
    flight_t first = start("first"), second = start("second");
    for (size_t k = 0; k < scene.steps; k++) {
        fly(&first, k, k + 1);
        fly(&second, k, k + 1);
    }
    land(&first);
    land(&second);
}

static void *fly_in_thread(void *flight)
{
    *(flight_t *)flight = start("thread");
    fly(flight, 0, scene.steps);
    return NULL;
}

static void threads(void)
{
    enum { COUNT = 4 };
    pthread_t thread[COUNT];
    flight_t flight[COUNT];
    for (int i = 0; i < COUNT; i++)
        if (pthread_create(&thread[i], NULL, fly_in_thread, &flight[i])) fail("pthread_create");
    for (int i = 0; i < COUNT; i++) pthread_join(thread[i], NULL);
    for (int i = 0; i < COUNT; i++) land(&flight[i]);
}

typedef struct {
    flight_t *flight;
    size_t step;
} leg_t;

static void *fly_a_leg(void *leg)
{
    fly(((leg_t *)leg)->flight, ((leg_t *)leg)->step, ((leg_t *)leg)->step + 1);
    return NULL;
}

static void relay(void)
{
    flight_t flight = start("relay");
    for (size_t k = 0; k < scene.steps; k++) {
        pthread_t thread;
        leg_t leg = {&flight, k};
        if (pthread_create(&thread, NULL, fly_a_leg, &leg)) fail("pthread_create");
        pthread_join(thread, NULL);
    }
    land(&flight);
}

/* Forget the second half of a flight and fly it again. */
static void repeat(flight_t *flight, double time)
{
    size_t half = scene.steps / 2;
    size_t done = half + 1, left = scene.steps - half;
    memset(flight->real + done * scene.real_outputs, 0, left * scene.real_outputs * sizeof(double));
    memset(flight->integer + done * scene.integer_outputs, 0, left * scene.integer_outputs * sizeof(int));
    flight->time = time;
    fly(flight, half, scene.steps);
}

static void states(void)
{
    size_t half = scene.steps / 2, size;
    flight_t flight = start("first"), other = start("other");
    state_t state = NULL, copy = NULL;
    fly(&flight, 0, half);
    double time = flight.time;
    CALL(GetFMUstate, flight.component, &state);
    CALL(SerializedFMUstateSize, flight.component, state, &size);
    char *bytes = malloc(size);
    CALL(SerializeFMUstate, flight.component, state, bytes, size);
    fly(&flight, half, scene.steps);
    print(&flight);
    CALL(SetFMUstate, flight.component, state);
    CALL(FreeFMUstate, flight.component, &state);
    repeat(&flight, time);
    print(&flight);
    fly(&other, 0, half / 2);
    memcpy(other.real, flight.real, (half + 1) * scene.real_outputs * sizeof(double));
    memcpy(other.integer, flight.integer, (half + 1) * scene.integer_outputs * sizeof(int));
    CALL(DeSerializeFMUstate, other.component, bytes, size, &copy);
    CALL(SetFMUstate, other.component, copy);
    CALL(FreeFMUstate, other.component, &copy);
    repeat(&other, time);
    land(&other);
    CALL(Reset, flight.component);
    initialize(&flight);
    fly(&flight, 0, scene.steps);
    land(&flight);
    free(bytes);
}

int main(int count, char **argument)
{
    if (count != 7) fail("c_host LIBRARY GUID RESOURCES SCENARIO PLAN END");
    const char *plan = argument[5], *end = argument[6];
    void *library = dlopen(argument[1], RTLD_NOW | RTLD_LOCAL);
    if (!library) fail(dlerror());
    find_functions(library);
    guid = argument[2], resources = argument[3], abandoned = !strcmp(end, "abandon");
    read_scene(argument[4]);
    if (strcmp(fmi.GetTypesPlatform(), "default") || strcmp(fmi.GetVersion(), "2.0")) fail("platform or version");
    if (!strcmp(plan, "alone")) alone();
    if (!strcmp(plan, "interleaved")) interleaved();
    if (!strcmp(plan, "threads")) threads();
    if (!strcmp(plan, "relay")) relay();
    if (!strcmp(plan, "states")) states();
    if (!strcmp(end, "unload")) dlclose(library);
    if (!strcmp(end, "finalize")) ((void (*)(void))find(library, "finalizePythonInterpreter"))();
    return 0;
}
