/* FMI 2.0 for co-simulation, around tether.c. */
#include "fmi2Functions.h"
#include "tether.h"

#include <string.h>

/* Pass a message to the importer's logger, which takes it for a format: `%` and `#` are doubled. */
static void log_fmi2(const Tether *tether, Status status, const char *text)
{
    char format[2 * LONGEST_TEXT], *next = format;
    for (; *text; text++) {
        *next++ = *text;
        if (*text == '%' || *text == '#') *next++ = *text;
    }
    *next = '\0';
    fmi2CallbackLogger logger = (fmi2CallbackLogger)tether->importer_log;
    logger(tether->environment, tether->name, (fmi2Status)status, CATEGORY[status], format);
}

const char *fmi2GetTypesPlatform(void)
{
    return fmi2TypesPlatform;
}

const char *fmi2GetVersion(void)
{
    return fmi2Version;
}

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean loggingOn, size_t nCategories, const fmi2String categories[])
{
    ENTER(c);
    DONE(check_categories(tether, nCategories, categories));
}

/* --- life cycle */

fmi2Component fmi2Instantiate(
    fmi2String instanceName, fmi2Type fmuType, fmi2String fmuGUID, fmi2String fmuResourceLocation,
    const fmi2CallbackFunctions *functions, fmi2Boolean visible, fmi2Boolean loggingOn)
{
    /* nothing is read from `fmuResourceLocation` */
    void (*logger)(void) = functions ? (void (*)(void))functions->logger : NULL;
    void *environment = functions ? functions->componentEnvironment : NULL;
    Tether *tether = make_tether(instanceName ? instanceName : "", log_fmi2, environment, logger);
    if (!tether) return NULL;
    tether->call = __func__;
    if (!instanceName)
        say(tether, ERROR, IS_NULL, FACTS(word("argument", "instanceName")));
    else if (fmuType != fmi2CoSimulation)
        say(tether, ERROR, NO_CO_SIMULATION, NULL);
    else if (check_token(tether, fmuGUID) == OK)
        return tether;
    free_tether(tether);
    return NULL;
}

void fmi2FreeInstance(fmi2Component c)
{
    Tether *tether = entered(c, __func__);
    if (tether) free_tether(tether);
}

fmi2Status fmi2SetupExperiment(
    fmi2Component c, fmi2Boolean toleranceDefined, fmi2Real tolerance, fmi2Real startTime, fmi2Boolean stopTimeDefined,
    fmi2Real stopTime)
{
    ENTER(c);
    DONE(set_up_experiment(tether, toleranceDefined, tolerance, startTime, stopTimeDefined, stopTime));
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c)
{
    ENTER(c);
    DONE(enter_initialization(tether));
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c)
{
    ENTER(c);
    DONE(exit_initialization(tether));
}

fmi2Status fmi2Terminate(fmi2Component c)
{
    ENTER(c);
    DONE(terminate(tether));
}

fmi2Status fmi2Reset(fmi2Component c)
{
    ENTER(c);
    to_start_values(tether);
    return fmi2OK;
}

fmi2Status fmi2DoStep(
    fmi2Component c, fmi2Real currentCommunicationPoint, fmi2Real communicationStepSize,
    fmi2Boolean noSetFMUStatePriorToCurrentPoint)
{
    ENTER(c);
    DONE(advance(tether, currentCommunicationPoint, communicationStepSize));
}

/* --- values */

#define ARGUMENTS fmi2Component c, const fmi2ValueReference vr[], size_t nvr
#define NEED_VALUES    \
    ENTER(c);          \
    if (nvr) NEED(vr); \
    if (nvr) NEED(value)

#define GET(name, type, number, kinds)                                \
    fmi2Status fmi2Get##name(ARGUMENTS, type value[])                 \
    {                                                                 \
        NEED_VALUES;                                                  \
        DONE(get_values(tether, number, kinds, vr, nvr, value, nvr)); \
    }

#define SET(name, type, number, kinds)                                \
    fmi2Status fmi2Set##name(ARGUMENTS, const type value[])           \
    {                                                                 \
        NEED_VALUES;                                                  \
        DONE(set_values(tether, number, kinds, vr, nvr, value, nvr)); \
    }

GET(Real, fmi2Real, FLOAT64, REAL)
GET(Integer, fmi2Integer, INT32, INTEGER | ENUMERATION)
GET(Boolean, fmi2Boolean, INT32, 0)
GET(String, fmi2String, INT32, 0)
SET(Real, fmi2Real, FLOAT64, REAL)
SET(Integer, fmi2Integer, INT32, INTEGER | ENUMERATION)
SET(Boolean, fmi2Boolean, INT32, 0)

fmi2Status fmi2SetString(ARGUMENTS, const fmi2String value[])
{
    NEED_VALUES;
    if (!nvr) return fmi2OK;
    DONE(say(tether, ERROR, CANNOT_BE_SET, FACTS(whole("reference", vr[0]), word("value", value[0] ? value[0] : "NULL"))));
}

/* --- derivatives */

fmi2Status fmi2SetRealInputDerivatives(ARGUMENTS, const fmi2Integer order[], const fmi2Real value[])
{
    NEED_VALUES;
    if (nvr) NEED(order);
    DONE(set_input_derivatives(tether, vr, nvr, order, value));
}

fmi2Status fmi2GetDirectionalDerivative(
    fmi2Component c, const fmi2ValueReference vUnknown_ref[], size_t nUnknown, const fmi2ValueReference vKnown_ref[],
    size_t nKnown, const fmi2Real dvKnown[], fmi2Real dvUnknown[])
{
    ENTER(c);
    if (nUnknown) NEED(vUnknown_ref);
    if (nUnknown) NEED(dvUnknown);
    if (nKnown) NEED(vKnown_ref);
    if (nKnown) NEED(dvKnown);
    DONE(directional_derivative(
        tether, vUnknown_ref, nUnknown, vKnown_ref, nKnown, dvKnown, nKnown, dvUnknown, nUnknown));
}

/* --- state */

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *FMUstate)
{
    ENTER(c);
    NEED(FMUstate);
    DONE(save(tether, (Saved **)FMUstate));
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate FMUstate)
{
    ENTER(c);
    DONE(restore(tether, FMUstate));
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *FMUstate)
{
    ENTER(c);
    DONE(free_saved(tether, (Saved **)FMUstate));
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate FMUstate, size_t *size)
{
    ENTER(c);
    NEED(size);
    DONE(saved_size(tether, FMUstate, size));
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate FMUstate, fmi2Byte serializedState[], size_t size)
{
    ENTER(c);
    NEED(serializedState);
    DONE(serialize(tether, FMUstate, serializedState, size));
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte serializedState[], size_t size, fmi2FMUstate *FMUstate)
{
    ENTER(c);
    NEED(serializedState);
    NEED(FMUstate);
    DONE(deserialize(tether, serializedState, size, (Saved **)FMUstate));
}

/* --- status of the last step: never pending; a discarded step has got nowhere, and the next one can be done */

fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind s, fmi2Real *value)
{
    ENTER(c);
    NEED(value);
    if (s != fmi2LastSuccessfulTime) DONE(say(tether, DISCARD, NOT_OFFERED, NULL));
    *value = last_successful_time(tether);
    return fmi2OK;
}

fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind s, fmi2Boolean *value)
{
    ENTER(c);
    NEED(value);
    if (s != fmi2Terminated) DONE(say(tether, DISCARD, NOT_OFFERED, NULL));
    *value = fmi2False;
    return fmi2OK;
}

#define NO_STATUS(name, type)                                                      \
    fmi2Status fmi2Get##name(fmi2Component c, const fmi2StatusKind s, type *value) \
    {                                                                              \
        ENTER(c);                                                                  \
        NEED(value);                                                               \
        DONE(say(tether, DISCARD, NOT_OFFERED, NULL));                             \
    }

NO_STATUS(Status, fmi2Status)
NO_STATUS(IntegerStatus, fmi2Integer)
NO_STATUS(StringStatus, fmi2String)

/* --- what the flags of the model description do not offer */

NOT_OFFERED_CALL(fmi2Status, fmi2CancelStep, fmi2Component instance)
NOT_OFFERED_CALL(
    fmi2Status, fmi2GetRealOutputDerivatives, fmi2Component instance, const fmi2ValueReference vr[], size_t nvr,
    const fmi2Integer order[], fmi2Real value[])

/* --- model exchange */

NOT_OFFERED_CALL(fmi2Status, fmi2EnterEventMode, fmi2Component instance)
NOT_OFFERED_CALL(fmi2Status, fmi2NewDiscreteStates, fmi2Component instance, fmi2EventInfo *eventInfo)
NOT_OFFERED_CALL(fmi2Status, fmi2EnterContinuousTimeMode, fmi2Component instance)
NOT_OFFERED_CALL(
    fmi2Status, fmi2CompletedIntegratorStep, fmi2Component instance, fmi2Boolean prior, fmi2Boolean *event,
    fmi2Boolean *terminate)
NOT_OFFERED_CALL(fmi2Status, fmi2SetTime, fmi2Component instance, fmi2Real time)
NOT_OFFERED_CALL(fmi2Status, fmi2SetContinuousStates, fmi2Component instance, const fmi2Real x[], size_t nx)
NOT_OFFERED_CALL(fmi2Status, fmi2GetDerivatives, fmi2Component instance, fmi2Real derivatives[], size_t nx)
NOT_OFFERED_CALL(fmi2Status, fmi2GetEventIndicators, fmi2Component instance, fmi2Real eventIndicators[], size_t ni)
NOT_OFFERED_CALL(fmi2Status, fmi2GetContinuousStates, fmi2Component instance, fmi2Real x[], size_t nx)
NOT_OFFERED_CALL(fmi2Status, fmi2GetNominalsOfContinuousStates, fmi2Component instance, fmi2Real nominals[], size_t nx)
