/* Runs an FMU for FMI 2 on Windows: windows_fmi_host LIBRARY GUID INPUT OUTPUT

INPUT  : doubles: count of inputs, of outputs, of steps, size of a step; value references of both; a row of inputs per step.
OUTPUT : the outputs of the start and of every step. Last, a step of -0.1 - 0.2 s is refused: what is said goes to stdout. */
#include <stdio.h>
#include <stdlib.h>
#include <windows.h>

typedef void (*logger_t)(void *, const char *, int, const char *, const char *, ...);
typedef struct { logger_t logger; void *unused[4]; } callbacks_t;
typedef void *(*instantiate_t)(const char *, int, const char *, const char *, const callbacks_t *, int, int);
typedef int (*call_t)(void *);
typedef int (*values_t)(void *, const unsigned *, size_t, double *);
typedef int (*step_t)(void *, double, double, int);

static void say(void *environment, const char *name, int status, const char *category, const char *message, ...)
{
    printf("%s %d %s %s\n", name, status, category, message);
}

static double *read(FILE *file, size_t count)
{
    double *numbers = calloc(count + 1, sizeof *numbers);
    if (fread(numbers, 8, count, file) != count) exit(5);
    return numbers;
}

static unsigned *whole(const double *numbers, size_t count)
{
    unsigned *list = calloc(count + 1, sizeof *list);
    for (size_t i = 0; i < count; i++) list[i] = (unsigned)numbers[i];
    return list;
}

int main(int count, char **argument)
{
    if (count != 5) return 2;
    HMODULE library = LoadLibraryA(argument[1]);
    if (!library) return 3;
    instantiate_t instantiate = (instantiate_t)(void *)GetProcAddress(library, "fmi2Instantiate");
    call_t enter = (call_t)(void *)GetProcAddress(library, "fmi2EnterInitializationMode");
    call_t leave = (call_t)(void *)GetProcAddress(library, "fmi2ExitInitializationMode");
    values_t set = (values_t)(void *)GetProcAddress(library, "fmi2SetReal");
    values_t get = (values_t)(void *)GetProcAddress(library, "fmi2GetReal");
    step_t step = (step_t)(void *)GetProcAddress(library, "fmi2DoStep");
    FILE *in = fopen(argument[3], "rb"), *out = fopen(argument[4], "wb");
    if (!instantiate || !enter || !leave || !set || !get || !step || !in || !out) return 4;
    const double *head = read(in, 4);
    size_t inputs = (size_t)head[0], outputs = (size_t)head[1], steps = (size_t)head[2];
    unsigned *input = whole(read(in, inputs), inputs), *output = whole(read(in, outputs), outputs);
    double *found = calloc(outputs, sizeof *found);
    const callbacks_t callbacks = {say, {0}};
    void *tether = instantiate("tether", 1, argument[2], "file:///nowhere", &callbacks, 0, 0);
    double *rows = read(in, steps * inputs);
    if (!tether || set(tether, input, inputs, rows) || enter(tether) || leave(tether)) return 6;
    for (size_t k = 0; k <= steps; k++) {
        if (k > 0 && set(tether, input, inputs, rows + (k - 1) * inputs)) return 7;
        if (k > 0 && step(tether, head[3] * (double)(k - 1), head[3], 1)) return 8;
        if (get(tether, output, outputs, found)) return 9;
        fwrite(found, 8, outputs, out);
    }
    fclose(out);
    return step(tether, head[3] * (double)steps, -0.1 - 0.2, 1) == 2 ? 0 : 10;
}
