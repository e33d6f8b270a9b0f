/* Runs an FMU for FMI 2 on Windows: windows_fmi_host LIBRARY GUID INPUT OUTPUT, without spaces in the names.

INPUT  : doubles: count of inputs, of outputs, of steps, size of a step; value references of both; a row of inputs per step.
OUTPUT : the outputs of the start and of every step. Last, a step of -0.1 - 0.2 s is refused: what is said goes to stdout.

It calls the system and no C library, which would take a minute to compile. */
#include <windows.h>

typedef void (*logger_t)(void *, const char *, int, const char *, const char *, ...);
typedef struct { logger_t logger; void *unused[4]; } callbacks_t;
typedef void *(*instantiate_t)(const char *, int, const char *, const char *, const callbacks_t *, int, int);
typedef int (*call_t)(void *);
typedef int (*values_t)(void *, const unsigned *, size_t, double *);
typedef int (*step_t)(void *, double, double, int);

static void check(int fine, unsigned status)
{
    if (!fine) ExitProcess(status);
}

static void say(void *environment, const char *name, int status, const char *category, const char *message, ...)
{
    char line[2048], digit[] = {' ', (char)('0' + status), ' ', 0};
    const char *words[] = {digit, category, " ", message, "\n"};
    DWORD done;
    lstrcpyA(line, name);
    for (int k = 0; k < 5; k++) lstrcatA(line, words[k]);
    WriteFile(GetStdHandle(STD_OUTPUT_HANDLE), line, (DWORD)lstrlenA(line), &done, NULL);
}

static void *room(double count)
{
    return HeapAlloc(GetProcessHeap(), HEAP_ZERO_MEMORY, 8 * (SIZE_T)count);
}

static double *read(HANDLE file, double count)
{
    DWORD done, size = 8 * (DWORD)count;
    double *numbers = room(count);
    check(ReadFile(file, numbers, size, &done, NULL) && done == size, 5);
    return numbers;
}

static unsigned *references(HANDLE file, double count)
{
    double *numbers = read(file, count);
    unsigned *list = room(count);
    for (int i = 0; i < (int)count; i++) list[i] = (unsigned)numbers[i];
    return list;
}

void start(void)
{
    char *argument[5], *next = GetCommandLineA();
    for (int k = 0; k < 5; k++) { /* the names of the program, the library, the guid, the input and the output */
        argument[k] = next;
        while (*next && *next != ' ') next++;
        while (*next == ' ') *next++ = 0;
    }
    HMODULE library = LoadLibraryA(argument[1]);
    check(library != NULL, 3);
    instantiate_t instantiate = (instantiate_t)GetProcAddress(library, "fmi2Instantiate");
    call_t enter = (call_t)GetProcAddress(library, "fmi2EnterInitializationMode");
    call_t leave = (call_t)GetProcAddress(library, "fmi2ExitInitializationMode");
    values_t set = (values_t)GetProcAddress(library, "fmi2SetReal");
    values_t get = (values_t)GetProcAddress(library, "fmi2GetReal");
    step_t step = (step_t)GetProcAddress(library, "fmi2DoStep");
    check(instantiate && enter && leave && set && get && step, 4);
    HANDLE in = CreateFileA(argument[3], GENERIC_READ, 0, NULL, OPEN_EXISTING, 0, NULL);
    HANDLE out = CreateFileA(argument[4], GENERIC_WRITE, 0, NULL, CREATE_ALWAYS, 0, NULL);
    const double *head = read(in, 4);
    size_t inputs = (size_t)head[0], outputs = (size_t)head[1], steps = (size_t)head[2];
    unsigned *input = references(in, head[0]), *output = references(in, head[1]);
    double *rows = read(in, head[0] * head[2]), *found = room(head[1]);
    const callbacks_t callbacks = {say, {0}};
    void *tether = instantiate("tether", 1, argument[2], "file:///nowhere", &callbacks, 0, 0);
    check(tether && !set(tether, input, inputs, rows) && !enter(tether) && !leave(tether), 6);
    for (size_t k = 0; k <= steps; k++) {
        DWORD done;
        check(k == 0 || !set(tether, input, inputs, rows + (k - 1) * inputs), 7);
        check(k == 0 || !step(tether, head[3] * (double)(k - 1), head[3], 1), 8);
        check(!get(tether, output, outputs, found), 9);
        check(WriteFile(out, found, 8 * (DWORD)outputs, &done, NULL), 10);
    }
    ExitProcess(step(tether, head[3] * (double)steps, -0.1 - 0.2, 1) == 2 ? 0 : 11);
}
