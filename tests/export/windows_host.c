/* Runs a compiled kernel library on Windows: windows_host LIBRARY VARIANT INPUT OUTPUT, without spaces in the names.

INPUT  : the plan; then doubles: sizes of parameters, state, work, outputs, count of steps, step; the parameters; then
         count + 1 rows of inputs.
OUTPUT : the outputs of the start and of every step.

It calls the system and no C library, which would take a minute to compile. */
#include <windows.h>

typedef int (*initialize_t)(double *, double *, double *, double *, double *, double *);
typedef int (*advance_t)(double *, double *, double *, double, double *, double *, double *, double *);

enum { INPUTS = 21, PLAN = PLAN_SIZE };

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
    double plan[PLAN], head[6], row[INPUTS]; /* the kernels read whole numbers in the plan */
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
    read(in, plan, PLAN);
    read(in, head, 6);
    double *parameters = zeros(head[0]), *state = zeros(head[1]), *before = zeros(head[1]);
    double *work = zeros(head[2]), *outputs = zeros(head[3]);
    read(in, parameters, head[0]);
    for (int k = 0; k <= (int)head[4]; k++) {
        DWORD done;
        read(in, row, INPUTS);
        int status = k == 0 ? initialize(plan, parameters, row, state, outputs, work)
                            : advance(plan, parameters, row, head[5], state, before, outputs, work);
        check(status == 0, 7);
        check(WriteFile(out, outputs, 8 * (DWORD)head[3], &done, NULL), 6);
    }
    ExitProcess(0);
}
