/* For Linux (POSIX) and Windows; with LINKED the FMU is part of the program. */
#if !defined(_WIN32)
#define _POSIX_C_SOURCE 200112L
#endif
#include "platform.h"

#include <stdio.h>
#include <string.h>

#if defined(_WIN32)
#include <windows.h>
#define PLATFORM "x86_64-windows"
#define ENDING ".dll"
#else
#include <dlfcn.h>
#include <time.h>
#if defined(__aarch64__)
#define PLATFORM "aarch64-linux"
#else
#define PLATFORM "x86_64-linux"
#endif
#define ENDING ".so"
#endif

enum { ROOM = 256, LONGEST_PATH = 4096 };

#if defined(LINKED)
#define TAKE(name) fmu->name = fmi3##name;
int find_functions(Fmu *fmu, const char *folder, char *problem)
{
    (void)folder, (void)problem;
    FUNCTIONS(TAKE)
    return 1;
}
#else
#include "TetherDynamicFree.h"

#if defined(_WIN32)
typedef HMODULE Library;
typedef FARPROC Address;
#define OPEN(path) LoadLibraryA(path)
#define ADDRESS(library, name) GetProcAddress(library, name)
#else
typedef void *Library;
typedef void *Address;
#define OPEN(path) dlopen(path, RTLD_NOW | RTLD_LOCAL)
#define ADDRESS(library, name) dlsym(library, name)
#endif

/* Find a function; `function` is the address of a pointer to it, which C cannot convert from what the system gives. */
static int find(void *function, Library library, const char *name, char *problem)
{
    Address found = ADDRESS(library, name);
    if (!found) snprintf(problem, ROOM, "the library of the FMU has no function %s", name);
    memcpy(function, &found, sizeof found);
    return found != NULL;
}

#define FIND(name) &&find(&fmu->name, library, "fmi3" #name, problem)
int find_functions(Fmu *fmu, const char *folder, char *problem)
{
    char path[LONGEST_PATH];
    snprintf(path, sizeof path, "%s/binaries/" PLATFORM "/" TETHER_MODEL_IDENTIFIER ENDING, folder);
    Library library = OPEN(path);
    if (!library) snprintf(problem, ROOM, "%.200s cannot be loaded", path);
    return library FUNCTIONS(FIND);
}
#endif

#if defined(_WIN32)
#if !defined(CREATE_WAITABLE_TIMER_HIGH_RESOLUTION)
#define CREATE_WAITABLE_TIMER_HIGH_RESOLUTION 2 /* since Windows 10 1803 */
#endif
double now(void)
{
    LARGE_INTEGER count, frequency;
    QueryPerformanceFrequency(&frequency);
    QueryPerformanceCounter(&count);
    return (double)count.QuadPart / (double)frequency.QuadPart;
}

void sleep_until(double time)
{
    static HANDLE timer;
    if (!timer) timer = CreateWaitableTimerExW(NULL, NULL, CREATE_WAITABLE_TIMER_HIGH_RESOLUTION, TIMER_ALL_ACCESS);
    LARGE_INTEGER left;
    left.QuadPart = (LONGLONG)(1e7 * (now() - time)); /* negative: from now on, in units of 100 ns */
    if (left.QuadPart < 0 && timer && SetWaitableTimer(timer, &left, 0, NULL, NULL, FALSE)) WaitForSingleObject(timer, INFINITE);
    while (now() < time) YieldProcessor();
}
#else
double now(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

void sleep_until(double time)
{
    struct timespec until = {(time_t)time, 0};
    until.tv_nsec = (long)(1e9 * (time - (double)until.tv_sec));
    clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, NULL);
}
#endif
