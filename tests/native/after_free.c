/* Calls with what was freed before, in a host whose `free` does nothing (linked with --wrap=free). */
#include <stdio.h>

#include "tables.h"

#if FMI == 2
#include "fmi2Functions.h"
#define CALL(name) fmi2##name
#define STATE(name) fmi2##name##FMUstate
typedef fmi2FMUstate State;
static const fmi2CallbackFunctions CALLBACKS;
#define INSTANTIATED fmi2Instantiate("tether", fmi2CoSimulation, TOKEN, NULL, &CALLBACKS, 0, 0)
#else
#include "fmi3Functions.h"
#define CALL(name) fmi3##name
#define STATE(name) fmi3##name##FMUState
typedef fmi3FMUState State;
#define INSTANTIATED fmi3InstantiateCoSimulation("tether", TOKEN, NULL, 0, 0, 0, 0, NULL, 0, NULL, NULL, NULL)
#endif

void __wrap_free(void *memory)
{
}

int main(void)
{
    void *tether = INSTANTIATED, *other = INSTANTIATED;
    State state = NULL, same;
    int wrong = CALL(Reset)(tether) || CALL(Reset)(other) || STATE(Get)(tether, &state);
    same = state;
    wrong += STATE(Set)(tether, state) != CALL(OK) || STATE(Free)(tether, &state) != CALL(OK) || state != NULL;
    wrong += STATE(Set)(tether, same) == CALL(OK) || STATE(Free)(tether, &same) == CALL(OK) || same == NULL;
    CALL(FreeInstance)(tether);
    CALL(FreeInstance)(tether);
    wrong += CALL(Reset)(tether) == CALL(OK) || STATE(Get)(tether, &state) == CALL(OK) || CALL(Reset)(other);
    puts(wrong ? "not all refused" : "all refused");
    return wrong;
}
