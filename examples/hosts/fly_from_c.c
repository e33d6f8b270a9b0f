/* How does a host in C fly a tether? A kite that leaves at 5 m/s across its native FMU for FMI 2; prints the force on it.

    tetherfmu build TetherDynamic --native --header --out native
    python -m zipfile --extract native/TetherDynamic.fmu TetherDynamic
    cc examples/hosts/fly_from_c.c -Inative -I"$(python -c 'import fmpy; print(fmpy.__path__[0])')/c-code" -ldl -o fly_from_c
    ./fly_from_c TetherDynamic

The value references and the guid come from native/TetherDynamic.h, which --header writes for that build; the headers of FMI
come with FMPy. For Linux; on macOS and Windows the path of the library differs, on Windows also dlopen. */

#include <dlfcn.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include "TetherDynamic.h"
#include "fmi2Functions.h"

#define CALL(function) fmi2##function##TYPE *function = (fmi2##function##TYPE *)address(library, "fmi2" #function)

static void stop(const char *reason, const char *name) {
    fprintf(stderr, "fly_from_c: %s%s\n", reason, name);
    exit(1);
}

static void *address(void *library, const char *function) {
    void *found = dlsym(library, function);
    if (!found) stop("the library of the FMU has no function ", function);
    return found;
}

static void check(fmi2Status status) {
    if (status > fmi2Warning) stop("the FMU refused a call; its message says why", "");
}

static void print_message(fmi2ComponentEnvironment host, fmi2String instance, fmi2Status status, fmi2String category,
                          fmi2String message, ...) {
    va_list values;
    va_start(values, message);
    vfprintf(stderr, message, values);
    va_end(values);
    fputc('\n', stderr);
}

int main(int count, char **arguments) {
    char path[4096];
    if (count != 2) stop("give the folder of an extracted ", "TetherDynamic.fmu");
    snprintf(path, sizeof path, "%s/binaries/linux64/" TETHER_MODEL_IDENTIFIER ".so", arguments[1]);
    void *library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    if (!library) stop("", dlerror());
    CALL(Instantiate);
    CALL(SetupExperiment);
    CALL(EnterInitializationMode);
    CALL(ExitInitializationMode);
    CALL(SetReal);
    CALL(GetReal);
    CALL(DoStep);
    CALL(FreeInstance);

    const double step = 0.02, speed = 5.0;
    const fmi2ValueReference y[] = {TETHER_KITE_POSITION_2, TETHER_KITE_VELOCITY_2};
    const fmi2ValueReference force[] = {TETHER_KITE_FORCE_1, TETHER_KITE_FORCE_2, TETHER_KITE_FORCE_3};
    fmi2CallbackFunctions callbacks = {print_message, calloc, free, NULL, NULL};
    fmi2Component tether = Instantiate("tether", fmi2CoSimulation, TETHER_GUID, "", &callbacks, fmi2False, fmi2True);
    if (!tether) stop("the FMU gives no instance", "");
    check(SetupExperiment(tether, fmi2False, 0.0, 0.0, fmi2False, 0.0));
    check(EnterInitializationMode(tether));
    check(SetReal(tether, y, 2, (fmi2Real[]){0.0, speed}));
    check(ExitInitializationMode(tether));
    for (int k = 0; k < 500; k++) {
        const double time = step * k;
        double newtons[3];
        check(SetReal(tether, y, 2, (fmi2Real[]){speed * time, speed})); /* the inputs belong to the start of the step */
        check(DoStep(tether, time, step, fmi2True));
        check(GetReal(tether, force, 3, newtons)); /* the outputs to its end */
        if (k % 100 == 99) printf("%4.1f s: %.3f %.3f %.3f N\n", time + step, newtons[0], newtons[1], newtons[2]);
    }
    FreeInstance(tether);
    dlclose(library);
    return 0;
}
