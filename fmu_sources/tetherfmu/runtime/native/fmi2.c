/* FMI 2.0 for co-simulation, around instance.c.

`c` is the pointer that the importer passes; `instance` what it points to, once that is known to be an instance. */
#include "derivatives.h"
#include "fmi2Functions.h"
#include "instance.h"
#include "saved_state.h"

/* Pass a message to the importer's logger, which treats it as a format: `%` and `#` are doubled. */
static void log_fmi2(const Instance *instance, Status status, const char *text)
{
    char format[2 * LONGEST_TEXT], *next = format;
    for (; *text; text++) {
        *next++ = *text;
        if (*text == '%' || *text == '#') *next++ = *text;
    }
    *next = '\0';
    fmi2CallbackLogger logger = (fmi2CallbackLogger)instance->importer_log;
    logger(instance->environment, instance->name, (fmi2Status)status, CATEGORY[status], format);
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
    Instance *instance = entered(c, __func__);
    return instance ? set_logging(instance, loggingOn, nCategories, categories) : fmi2Error;
}

/* --- life cycle */

fmi2Component fmi2Instantiate(
    fmi2String instanceName, fmi2Type fmuType, fmi2String fmuGUID, fmi2String fmuResourceLocation,
    const fmi2CallbackFunctions *functions, fmi2Boolean visible, fmi2Boolean loggingOn)
{
    /* `fmuResourceLocation` is not used */
    void (*logger)(void) = functions ? (void (*)(void))functions->logger : NULL;
    void *environment = functions ? functions->componentEnvironment : NULL;
    Instance *instance = make_instance(instanceName ? instanceName : "", log_fmi2, environment, logger, loggingOn);
    if (!instance) return NULL;
    instance->call = __func__;
    if (!instanceName)
        refuse_null(instance, "instanceName");
    else if (fmuType != fmi2CoSimulation)
        say(instance, ERROR, NO_CO_SIMULATION, NULL);
    else if (check_token(instance, fmuGUID) == OK)
        return instance;
    free_instance(instance);
    return NULL;
}

void fmi2FreeInstance(fmi2Component c)
{
    Instance *instance = entered(c, __func__);
    if (instance) free_instance(instance);
}

fmi2Status fmi2SetupExperiment(
    fmi2Component c, fmi2Boolean toleranceDefined, fmi2Real tolerance, fmi2Real startTime, fmi2Boolean stopTimeDefined,
    fmi2Real stopTime)
{
    Instance *instance = entered(c, __func__);
    if (!instance) return fmi2Error;
    return set_up_experiment(instance, toleranceDefined, tolerance, startTime, stopTimeDefined, stopTime);
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c)
{
    Instance *instance = entered(c, __func__);
    return instance ? enter_initialization(instance) : fmi2Error;
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c)
{
    Instance *instance = entered(c, __func__);
    return instance ? begin_steps(instance) : fmi2Error;
}

fmi2Status fmi2Terminate(fmi2Component c)
{
    Instance *instance = entered(c, __func__);
    return instance ? terminate(instance) : fmi2Error;
}

fmi2Status fmi2Reset(fmi2Component c)
{
    Instance *instance = entered(c, __func__);
    if (!instance) return fmi2Error;
    to_start_values(instance);
    return fmi2OK;
}

/* A refused step is an error, after which another step is possible: with fmi2Discard an importer would continue from a
partial step. */
fmi2Status fmi2DoStep(
    fmi2Component c, fmi2Real currentCommunicationPoint, fmi2Real communicationStepSize,
    fmi2Boolean noSetFMUStatePriorToCurrentPoint)
{
    Instance *instance = entered(c, __func__);
    return instance ? advance(instance, currentCommunicationPoint, communicationStepSize, ERROR) : fmi2Error;
}

/* --- values */

/* Values of variables of some kinds. */
static Status read_values(
    fmi2Component c, const char *call, Type type, unsigned kinds, const fmi2ValueReference vr[], size_t nvr, void *value)
{
    Instance *instance = entered(c, call);
    if (!instance) return ERROR;
    if (nvr && !vr) return refuse_null(instance, "vr");
    if (nvr && !value) return refuse_null(instance, "value");
    return get_values(instance, type, kinds, vr, nvr, value, nvr);
}

/* Common code of the functions that read numbers. kinds : of variables of the function. */
static Status get(
    fmi2Component c, const char *call, Type type, unsigned kinds, const fmi2ValueReference vr[], size_t nvr, void *value)
{
    return filled(read_values(c, call, type, kinds, vr, nvr, value), type, value, nvr);
}

/* Common code of the functions that set numbers. */
static Status set(
    fmi2Component c, const char *call, Type type, unsigned kinds, const fmi2ValueReference vr[], size_t nvr,
    const void *value)
{
    Instance *instance = entered(c, call);
    if (!instance) return ERROR;
    if (nvr && !vr) return refuse_null(instance, "vr");
    if (nvr && !value) return refuse_null(instance, "value");
    return set_values(instance, type, kinds, vr, nvr, value, nvr);
}

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, fmi2Real value[])
{
    return get(c, __func__, FLOAT64, REAL, vr, nvr, value);
}

fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, fmi2Integer value[])
{
    return get(c, __func__, INT32, INTEGER | ENUMERATION, vr, nvr, value);
}

fmi2Status fmi2GetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, fmi2Boolean value[])
{
    return get(c, __func__, TRUTH_INT, BOOLEAN, vr, nvr, value);
}

fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, fmi2String value[])
{
    return filled(read_values(c, __func__, BYTES, 0, vr, nvr, value), BYTES, value, nvr * sizeof *value);
}

fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Real value[])
{
    return set(c, __func__, FLOAT64, REAL, vr, nvr, value);
}

fmi2Status fmi2SetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Integer value[])
{
    return set(c, __func__, INT32, INTEGER | ENUMERATION, vr, nvr, value);
}

fmi2Status fmi2SetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Boolean value[])
{
    return set(c, __func__, TRUTH_INT, BOOLEAN, vr, nvr, value);
}

fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2String value[])
{
    Instance *instance = entered(c, __func__);
    if (!instance) return fmi2Error;
    if (!nvr) return fmi2OK;
    if (!vr) return refuse_null(instance, "vr");
    if (!value) return refuse_null(instance, "value");
    Fact text = word("value", value[0] ? value[0] : "NULL");
    return say(instance, ERROR, CANNOT_BE_SET, FACTS(VARIABLE(vr[0]), text));
}

/* --- derivatives */

fmi2Status fmi2SetRealInputDerivatives(
    fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Integer order[], const fmi2Real value[])
{
    Instance *instance = entered(c, __func__);
    if (!instance) return fmi2Error;
    if (nvr && !vr) return refuse_null(instance, "vr");
    if (nvr && !value) return refuse_null(instance, "value");
    if (nvr && !order) return refuse_null(instance, "order");
    return set_input_derivatives(instance, vr, nvr, order, value);
}

static Status read_derivative(
    fmi2Component c, const char *call, const fmi2ValueReference vUnknown_ref[], size_t nUnknown,
    const fmi2ValueReference vKnown_ref[], size_t nKnown, const fmi2Real dvKnown[], fmi2Real dvUnknown[])
{
    Instance *instance = entered(c, call);
    if (!instance) return ERROR;
    if (nUnknown && !vUnknown_ref) return refuse_null(instance, "vUnknown_ref");
    if (nUnknown && !dvUnknown) return refuse_null(instance, "dvUnknown");
    if (nKnown && !vKnown_ref) return refuse_null(instance, "vKnown_ref");
    if (nKnown && !dvKnown) return refuse_null(instance, "dvKnown");
    return directional_derivative(
        instance, vUnknown_ref, nUnknown, vKnown_ref, nKnown, dvKnown, nKnown, dvUnknown, nUnknown);
}

fmi2Status fmi2GetDirectionalDerivative(
    fmi2Component c, const fmi2ValueReference vUnknown_ref[], size_t nUnknown, const fmi2ValueReference vKnown_ref[],
    size_t nKnown, const fmi2Real dvKnown[], fmi2Real dvUnknown[])
{
    Status status = read_derivative(c, __func__, vUnknown_ref, nUnknown, vKnown_ref, nKnown, dvKnown, dvUnknown);
    return filled(status, FLOAT64, dvUnknown, nUnknown);
}

/* --- state */

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *FMUstate)
{
    Instance *instance = entered(c, __func__);
    if (!instance) return fmi2Error;
    return FMUstate ? save(instance, (Saved **)FMUstate) : refuse_null(instance, "FMUstate");
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate FMUstate)
{
    Instance *instance = entered(c, __func__);
    return instance ? restore(instance, FMUstate) : fmi2Error;
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *FMUstate)
{
    Instance *instance = entered(c, __func__);
    return instance ? free_saved(instance, (Saved **)FMUstate) : fmi2Error;
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate FMUstate, size_t *size)
{
    Instance *instance = entered(c, __func__);
    if (!instance) return fmi2Error;
    return size ? saved_size(instance, FMUstate, size) : refuse_null(instance, "size");
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate FMUstate, fmi2Byte serializedState[], size_t size)
{
    Instance *instance = entered(c, __func__);
    if (!instance) return fmi2Error;
    if (!serializedState) return refuse_null(instance, "serializedState");
    return serialize(instance, FMUstate, serializedState, size);
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte serializedState[], size_t size, fmi2FMUstate *FMUstate)
{
    Instance *instance = entered(c, __func__);
    if (!instance) return fmi2Error;
    if (!serializedState) return refuse_null(instance, "serializedState");
    if (!FMUstate) return refuse_null(instance, "FMUstate");
    return deserialize(instance, serializedState, size, (Saved **)FMUstate);
}

/* --- status of the last step: never pending; a refused step made no progress, and the next one is possible */

static Status no_status(fmi2Component c, const char *call, const void *value)
{
    Instance *instance = entered(c, call);
    if (!instance) return ERROR;
    return value ? say(instance, DISCARD, NOT_OFFERED, FACTS(word("what", "this status"))) : refuse_null(instance, "value");
}

fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind s, fmi2Real *value)
{
    Instance *instance = entered(c, __func__);
    if (!instance || !value || s != fmi2LastSuccessfulTime) return filled(no_status(c, __func__, value), FLOAT64, value, 1);
    *value = last_successful_time(instance);
    return fmi2OK;
}

fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind s, fmi2Boolean *value)
{
    if (value) *value = fmi2False;
    return s == fmi2Terminated && value && entered(c, __func__) ? fmi2OK : no_status(c, __func__, value);
}

fmi2Status fmi2GetStatus(fmi2Component c, const fmi2StatusKind s, fmi2Status *value)
{
    if (value) *value = fmi2Error;
    return no_status(c, __func__, value);
}

fmi2Status fmi2GetIntegerStatus(fmi2Component c, const fmi2StatusKind s, fmi2Integer *value)
{
    return filled(no_status(c, __func__, value), INT32, value, 1);
}

fmi2Status fmi2GetStringStatus(fmi2Component c, const fmi2StatusKind s, fmi2String *value)
{
    return filled(no_status(c, __func__, value), BYTES, value, sizeof *value);
}

/* --- functions that the flags of the model description exclude */

#define REFUSED refuse_call(c, __func__)
#define NOT_OFFERED_GET(name, status, ...) \
    fmi2Status name(__VA_ARGS__)           \
    {                                      \
        return status;                     \
    }
#define NOT_OFFERED_CALL(name, ...) NOT_OFFERED_GET(name, REFUSED, __VA_ARGS__)

NOT_OFFERED_CALL(fmi2CancelStep, fmi2Component c)
NOT_OFFERED_GET(
    fmi2GetRealOutputDerivatives, filled(REFUSED, FLOAT64, value, nvr), fmi2Component c, const fmi2ValueReference vr[],
    size_t nvr, const fmi2Integer order[], fmi2Real value[])

/* --- model exchange */

NOT_OFFERED_CALL(fmi2EnterEventMode, fmi2Component c)
NOT_OFFERED_GET(
    fmi2NewDiscreteStates, filled(REFUSED, BYTES, eventInfo, sizeof *eventInfo), fmi2Component c, fmi2EventInfo *eventInfo)
NOT_OFFERED_CALL(fmi2EnterContinuousTimeMode, fmi2Component c)
NOT_OFFERED_GET(
    fmi2CompletedIntegratorStep, filled(filled(REFUSED, TRUTH_INT, event, 1), TRUTH_INT, terminate, 1), fmi2Component c,
    fmi2Boolean prior, fmi2Boolean *event, fmi2Boolean *terminate)
NOT_OFFERED_CALL(fmi2SetTime, fmi2Component c, fmi2Real time)
NOT_OFFERED_CALL(fmi2SetContinuousStates, fmi2Component c, const fmi2Real x[], size_t nx)
NOT_OFFERED_GET(
    fmi2GetDerivatives, filled(REFUSED, FLOAT64, derivatives, nx), fmi2Component c, fmi2Real derivatives[], size_t nx)
NOT_OFFERED_GET(
    fmi2GetEventIndicators, filled(REFUSED, FLOAT64, indicators, ni), fmi2Component c, fmi2Real indicators[], size_t ni)
NOT_OFFERED_GET(fmi2GetContinuousStates, filled(REFUSED, FLOAT64, x, nx), fmi2Component c, fmi2Real x[], size_t nx)
NOT_OFFERED_GET(
    fmi2GetNominalsOfContinuousStates, filled(REFUSED, FLOAT64, nominals, nx), fmi2Component c, fmi2Real nominals[],
    size_t nx)
