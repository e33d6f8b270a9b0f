/* What differs between systems: where the functions of the FMU come from, and the clock. */
#ifndef PLATFORM_H
#define PLATFORM_H

#include "fmi3Functions.h"

#define FUNCTIONS(DO)                                                                                        \
    DO(InstantiateCoSimulation) DO(EnterInitializationMode) DO(ExitInitializationMode) DO(SetFloat64)        \
    DO(SetInt32) DO(GetFloat64) DO(DoStep) DO(GetFMUState) DO(SetFMUState) DO(FreeFMUState) DO(FreeInstance)
#define FIELD(name) fmi3##name##TYPE *name;

typedef struct { /* the functions of FMI that the host calls */
    FUNCTIONS(FIELD)
} Fmu;

/* The functions of the FMU that is linked into the program, or of the library in the folder of an extracted FMU.

What is wrong is a sentence in `problem` (room for 256 characters); returns whether all were found. */
int find_functions(Fmu *fmu, const char *folder, char *problem);

/* Time of a clock that never jumps [s]. */
double now(void);

/* Sleep until that clock shows a time [s]; returns at once if it has passed. */
void sleep_until(double time);

#endif
