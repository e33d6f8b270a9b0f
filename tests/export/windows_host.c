/* Runs a compiled kernel library on Windows: windows_host LIBRARY VARIANT INPUT OUTPUT

INPUT  : doubles n, sizes of parameters, state, work, outputs, count of steps, step, shape points; the parameters; then
         count + 1 rows of inputs.
OUTPUT : the outputs of the start and of every step. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <windows.h>

typedef int (*initialize_t)(long long, double *, double *, double *, double *);
typedef int (*advance_t)(long long, double *, double *, double, double *, double *);
typedef int (*observe_t)(long long, double *, double *, long long, double *, double *);

enum { INPUTS = 19 };

static void *find(HMODULE library, const char *variant, const char *verb)
{
    char name[64];
    snprintf(name, sizeof name, "%s_%s", variant, verb);
    return (void *)GetProcAddress(library, name);
}

int main(int count, char **argument)
{
    double head[8], row[INPUTS];
    if (count != 5) return 2;
    HMODULE library = LoadLibraryA(argument[1]);
    if (!library) return 3;
    initialize_t initialize = (initialize_t)find(library, argument[2], "initialize");
    advance_t advance = (advance_t)find(library, argument[2], "advance");
    observe_t observe = (observe_t)find(library, argument[2], "observe");
    FILE *in = fopen(argument[3], "rb"), *out = fopen(argument[4], "wb");
    if (!initialize || !advance || !observe || !in || !out || fread(head, 8, 8, in) != 8) return 4;
    long long n = (long long)head[0], points = (long long)head[7];
    size_t parameters_size = (size_t)head[1], outputs_size = (size_t)head[4];
    double *parameters = calloc(parameters_size, 8), *state = calloc((size_t)head[2], 8);
    double *work = calloc((size_t)head[3], 8), *outputs = calloc(outputs_size, 8);
    if (fread(parameters, 8, parameters_size, in) != parameters_size) return 5;
    for (int k = 0; k <= (int)head[5]; k++) {
        if (fread(row, 8, INPUTS, in) != INPUTS) return 6;
        int status = k == 0 ? initialize(n, parameters, row, state, work) : advance(n, parameters, row, head[6], state, work);
        if (status) return 7;
        observe(n, parameters, state, points, outputs, work);
        fwrite(outputs, 8, outputs_size, out);
    }
    fclose(out);
    return 0;
}
