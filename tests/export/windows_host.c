/* Runs a compiled kernel library on Windows: windows_host LIBRARY VARIANT INPUT OUTPUT, without spaces in the names.

INPUT  : doubles n, sizes of parameters, state, work, outputs, count of steps, step, shape points; the parameters; then
         count + 1 rows of inputs.
OUTPUT : the outputs of the start and of every step.

It calls the system and no C library, which would take a minute to compile. */
#include <windows.h>

typedef int (*initialize_t)(long long, double *, double *, double *, long long, double *, double *);
typedef int (*advance_t)(long long, double *, double *, double, double *, double *, long long, double *, double *);

enum { INPUTS = 21 };

static void check(int fine, unsigned status)
{
    if (!fine) ExitProcess(status);
}

static FARPROC find(HMODULE library, const char *variant, const char *verb)
{
    char name[64];
    lstrcpyA(name, variant);
    lstrcatA(name, verb);
    FARPROC found = GetProcAddress(library, name);
    check(found != NULL, 4);
    return found;
}

static double *zeros(double count)
{
    return HeapAlloc(GetProcessHeap(), HEAP_ZERO_MEMORY, 8 * (SIZE_T)count);
}

static void read(HANDLE file, double *numbers, double count)
{
    DWORD done, size = 8 * (DWORD)count;
    check(ReadFile(file, numbers, size, &done, NULL) && done == size, 5);
}

void start(void)
{
    char *argument[5], *next = GetCommandLineA();
    double head[8], row[INPUTS];
    for (int k = 0; k < 5; k++) { /* the names of the program, the library, the variant, the input and the output */
        argument[k] = next;
        while (*next && *next != ' ') next++;
        while (*next == ' ') *next++ = 0;
    }
    HMODULE library = LoadLibraryA(argument[1]);
    check(library != NULL, 3);
    initialize_t initialize = (initialize_t)find(library, argument[2], "_initialize");
    advance_t advance = (advance_t)find(library, argument[2], "_advance");
    HANDLE in = CreateFileA(argument[3], GENERIC_READ, 0, NULL, OPEN_EXISTING, 0, NULL);
    HANDLE out = CreateFileA(argument[4], GENERIC_WRITE, 0, NULL, CREATE_ALWAYS, 0, NULL);
    read(in, head, 8);
    double *parameters = zeros(head[1]), *state = zeros(head[2]), *before = zeros(head[2]);
    double *work = zeros(head[3]), *outputs = zeros(head[4]);
    long long n = (long long)head[0], points = (long long)head[7];
    read(in, parameters, head[1]);
    for (int k = 0; k <= (int)head[5]; k++) {
        DWORD done;
        read(in, row, INPUTS);
        int status = k == 0 ? initialize(n, parameters, row, state, points, outputs, work)
                            : advance(n, parameters, row, head[6], state, before, points, outputs, work);
        check(status == 0, 7);
        check(WriteFile(out, outputs, 8 * (DWORD)head[4], &done, NULL), 6);
    }
    ExitProcess(0);
}
