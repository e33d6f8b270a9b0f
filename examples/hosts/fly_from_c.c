/* How does a host in C fly a tether? A kite that leaves at 5 m/s across its native FMU for FMI 2; prints the force on it.

    tetherfmu build TetherDynamic --native --out native
    python -m zipfile --extract native/TetherDynamic.fmu TetherDynamic
    cc examples/hosts/fly_from_c.c -I"$(python -c 'import fmpy; print(fmpy.__path__[0])')/c-code" -ldl -o fly_from_c
    ./fly_from_c TetherDynamic

The headers of FMI come with FMPy. For Linux; on macOS and Windows the path of the library differs, on Windows also dlopen. */

#include <dlfcn.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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

/* Text of an attribute in the first tag of a model description that contains `mark`. */
static void attribute(const char *xml, const char *mark, const char *name, char *text, size_t size) {
    const char *found = strstr(xml, mark), *end;
    if (!found) stop("the model description has no", mark);
    while (*found != '<') found--;
    if (!(found = strstr(found, name))) stop("the model description has no", name);
    found += strlen(name);
    if (!(end = strchr(found, '"')) || (size_t)(end - found) >= size) stop("too long in the model description:", name);
    memcpy(text, found, end - found);
    text[end - found] = '\0';
}

/* Value reference of a variable; an enumeration has the name of its type, which stands above the variables. */
static fmi2ValueReference reference(const char *xml, const char *variable) {
    const char *variables = strstr(xml, "<ModelVariables");
    char mark[64], text[16];
    if (!variables) stop("the model description has no ", "ModelVariables");
    snprintf(mark, sizeof mark, " name=\"%s\"", variable);
    attribute(variables, mark, " valueReference=\"", text, sizeof text);
    return (fmi2ValueReference)strtoul(text, NULL, 10);
}

int main(int count, char **arguments) {
    static char xml[1 << 20];
    char path[4096], guid[64];
    if (count != 2) stop("give the folder of an extracted ", "TetherDynamic.fmu");
    snprintf(path, sizeof path, "%s/modelDescription.xml", arguments[1]);
    FILE *file = fopen(path, "r");
    if (!file) stop("the folder has no ", "modelDescription.xml");
    xml[fread(xml, 1, sizeof xml - 1, file)] = '\0';
    fclose(file);
    attribute(xml, " guid=\"", " guid=\"", guid, sizeof guid);

    snprintf(path, sizeof path, "%s/binaries/linux64/TetherDynamic.so", arguments[1]);
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
    const fmi2ValueReference y[] = {reference(xml, "kite_position[2]"), reference(xml, "kite_velocity[2]")};
    const fmi2ValueReference force[] = {reference(xml, "kite_force[1]"), reference(xml, "kite_force[2]"),
                                        reference(xml, "kite_force[3]")};
    fmi2CallbackFunctions callbacks = {print_message, calloc, free, NULL, NULL};
    fmi2Component tether = Instantiate("tether", fmi2CoSimulation, guid, "", &callbacks, fmi2False, fmi2False);
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
