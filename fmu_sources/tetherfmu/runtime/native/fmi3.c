/* FMI 3.0 for co-simulation, around instance.c.

`handle` is the pointer that the importer passes; `instance` what it points to, once that is known to be an instance. */
#include "derivatives.h"
#include "fmi3Functions.h"
#include "instance.h"
#include "saved_state.h"

/* Pass a message to the importer, with the instance name, for which FMI 3 has no argument. */
static void log_fmi3(const Instance *instance, Status status, const char *text)
{
    char message[LONGEST_TEXT];
    fill_in(message, sizeof message, "{name}: {text}", FACTS(word("name", instance->name), word("text", text)));
    fmi3LogMessageCallback log = (fmi3LogMessageCallback)instance->importer_log;
    log(instance->environment, (fmi3Status)status, CATEGORY[status], message);
}

const char *fmi3GetVersion(void)
{
    return fmi3Version;
}

fmi3Status fmi3SetDebugLogging(
    fmi3Instance handle, fmi3Boolean loggingOn, size_t nCategories, const fmi3String categories[])
{
    Instance *instance = entered(handle, __func__);
    return instance ? set_logging(instance, loggingOn, nCategories, categories) : fmi3Error;
}

/* --- life cycle */

/* A new instance; NULL, and a message, if `refusal` states a reason, or if the token is wrong. what : unsupported feature,
for the refusal. */
static fmi3Instance instantiated(
    const char *call, fmi3String name, fmi3String token, fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
    fmi3Boolean is_logging, const char *refusal, const char *what)
{
    Instance *instance = make_instance(name ? name : "", log_fmi3, environment, (void (*)(void))log, is_logging);
    if (!instance) return NULL;
    instance->call = call;
    if (!name)
        refuse_null(instance, "instanceName");
    else if (refusal)
        say(instance, ERROR, refusal, FACTS(word("what", what)));
    else if (check_token(instance, token) == OK)
        return instance;
    free_instance(instance);
    return NULL;
}

fmi3Instance fmi3InstantiateCoSimulation(
    fmi3String instanceName, fmi3String instantiationToken, fmi3String resourcePath, fmi3Boolean visible,
    fmi3Boolean loggingOn, fmi3Boolean eventModeUsed, fmi3Boolean earlyReturnAllowed,
    const fmi3ValueReference requiredIntermediateVariables[], size_t nRequiredIntermediateVariables,
    fmi3InstanceEnvironment instanceEnvironment, fmi3LogMessageCallback logMessage,
    fmi3IntermediateUpdateCallback intermediateUpdate)
{
    const char *what = eventModeUsed ? "eventModeUsed" : nRequiredIntermediateVariables ? "requiredIntermediateVariables" : "";
    const char *refusal = *what ? NOT_OFFERED : NULL;
    return instantiated(
        __func__, instanceName, instantiationToken, instanceEnvironment, logMessage, loggingOn, refusal, what);
}

fmi3Instance fmi3InstantiateModelExchange(
    fmi3String instanceName, fmi3String instantiationToken, fmi3String resourcePath, fmi3Boolean visible,
    fmi3Boolean loggingOn, fmi3InstanceEnvironment instanceEnvironment, fmi3LogMessageCallback logMessage)
{
    return instantiated(
        __func__, instanceName, instantiationToken, instanceEnvironment, logMessage, loggingOn, NO_CO_SIMULATION, "");
}

fmi3Instance fmi3InstantiateScheduledExecution(
    fmi3String instanceName, fmi3String instantiationToken, fmi3String resourcePath, fmi3Boolean visible,
    fmi3Boolean loggingOn, fmi3InstanceEnvironment instanceEnvironment, fmi3LogMessageCallback logMessage,
    fmi3ClockUpdateCallback clockUpdate, fmi3LockPreemptionCallback lockPreemption,
    fmi3UnlockPreemptionCallback unlockPreemption)
{
    return instantiated(
        __func__, instanceName, instantiationToken, instanceEnvironment, logMessage, loggingOn, NO_CO_SIMULATION, "");
}

void fmi3FreeInstance(fmi3Instance handle)
{
    Instance *instance = entered(handle, __func__);
    if (instance) free_instance(instance);
}

fmi3Status fmi3EnterInitializationMode(
    fmi3Instance handle, fmi3Boolean toleranceDefined, fmi3Float64 tolerance, fmi3Float64 startTime,
    fmi3Boolean stopTimeDefined, fmi3Float64 stopTime)
{
    Instance *instance = entered(handle, __func__);
    if (!instance) return fmi3Error;
    if (instance->phase != BEFORE) return enter_initialization(instance); /* refuses it with its own message */
    Status status = set_up_experiment(instance, toleranceDefined, tolerance, startTime, stopTimeDefined, stopTime);
    return status == OK ? enter_initialization(instance) : status;
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance handle)
{
    Instance *instance = entered(handle, __func__);
    return instance ? begin_steps(instance) : fmi3Error;
}

fmi3Status fmi3Terminate(fmi3Instance handle)
{
    Instance *instance = entered(handle, __func__);
    return instance ? terminate(instance) : fmi3Error;
}

fmi3Status fmi3Reset(fmi3Instance handle)
{
    Instance *instance = entered(handle, __func__);
    if (!instance) return fmi3Error;
    to_start_values(instance);
    return fmi3OK;
}

/* There are no events, a step never ends early, and the simulation need not end. */
fmi3Status fmi3DoStep(
    fmi3Instance handle, fmi3Float64 currentCommunicationPoint, fmi3Float64 communicationStepSize,
    fmi3Boolean noSetFMUStatePriorToCurrentPoint, fmi3Boolean *eventHandlingNeeded, fmi3Boolean *terminateSimulation,
    fmi3Boolean *earlyReturn, fmi3Float64 *lastSuccessfulTime)
{
    Instance *instance = entered(handle, __func__);
    if (!instance) return fmi3Error;
    if (!eventHandlingNeeded) return refuse_null(instance, "eventHandlingNeeded");
    if (!terminateSimulation) return refuse_null(instance, "terminateSimulation");
    if (!earlyReturn) return refuse_null(instance, "earlyReturn");
    if (!lastSuccessfulTime) return refuse_null(instance, "lastSuccessfulTime");
    *eventHandlingNeeded = *terminateSimulation = *earlyReturn = fmi3False;
    Status status = advance(instance, currentCommunicationPoint, communicationStepSize, DISCARD);
    *lastSuccessfulTime = last_successful_time(instance);
    return status;
}

/* --- values */

#define ARGUMENTS fmi3Instance handle, const fmi3ValueReference references[], size_t count

/* Common code of the functions that read values. kinds : of variables of the function. */
static Status read_values(ARGUMENTS, const char *call, Type type, unsigned kinds, void *values, size_t room)
{
    Instance *instance = entered(handle, call);
    if (!instance) return ERROR;
    if (count && !references) return refuse_null(instance, "valueReferences");
    if (room && !values) return refuse_null(instance, "values");
    return get_values(instance, type, kinds, references, count, values, room);
}

static Status get(ARGUMENTS, const char *call, Type type, unsigned kinds, void *values, size_t room)
{
    return filled(read_values(handle, references, count, call, type, kinds, values, room), type, values, room);
}

/* Common code of the functions that set values. */
static Status set(ARGUMENTS, const char *call, Type type, unsigned kinds, const void *values, size_t room)
{
    Instance *instance = entered(handle, call);
    if (!instance) return ERROR;
    if (count && !references) return refuse_null(instance, "valueReferences");
    if (room && !values) return refuse_null(instance, "values");
    return set_values(instance, type, kinds, references, count, values, room);
}

/* Common code of the functions for types without variables: fine for zero variables. */
static Status refuse_type(ARGUMENTS, const char *call, const char *sentence)
{
    Instance *instance = entered(handle, call);
    if (!instance) return ERROR;
    if (!count) return OK;
    if (!references) return refuse_null(instance, "valueReferences");
    return say(instance, ERROR, sentence, FACTS(VARIABLE(references[0]), word("value", "such a value")));
}

fmi3Status fmi3GetFloat64(ARGUMENTS, fmi3Float64 values[], size_t nValues)
{
    return get(handle, references, count, __func__, FLOAT64, REAL, values, nValues);
}

fmi3Status fmi3GetInt32(ARGUMENTS, fmi3Int32 values[], size_t nValues)
{
    return get(handle, references, count, __func__, INT32, INTEGER, values, nValues);
}

fmi3Status fmi3GetInt64(ARGUMENTS, fmi3Int64 values[], size_t nValues)
{
    return get(handle, references, count, __func__, INT64, ENUMERATION, values, nValues);
}

fmi3Status fmi3GetBoolean(ARGUMENTS, fmi3Boolean values[], size_t nValues)
{
    return get(handle, references, count, __func__, TRUTH, BOOLEAN, values, nValues);
}

fmi3Status fmi3SetFloat64(ARGUMENTS, const fmi3Float64 values[], size_t nValues)
{
    return set(handle, references, count, __func__, FLOAT64, REAL, values, nValues);
}

fmi3Status fmi3SetInt32(ARGUMENTS, const fmi3Int32 values[], size_t nValues)
{
    return set(handle, references, count, __func__, INT32, INTEGER, values, nValues);
}

fmi3Status fmi3SetInt64(ARGUMENTS, const fmi3Int64 values[], size_t nValues)
{
    return set(handle, references, count, __func__, INT64, ENUMERATION, values, nValues);
}

fmi3Status fmi3SetBoolean(ARGUMENTS, const fmi3Boolean values[], size_t nValues)
{
    return set(handle, references, count, __func__, TRUTH, BOOLEAN, values, nValues);
}

#define CANNOT_READ refuse_type(handle, references, count, __func__, CANNOT_BE_READ)
#define CLEAR(status, values, count) filled(status, BYTES, values, (count) * sizeof *(values))
#define NO_VALUES CLEAR(CANNOT_READ, values, nValues)
#define NO_VARIABLES_GET(name, status, ...) \
    fmi3Status name(ARGUMENTS, __VA_ARGS__) \
    {                                       \
        return status;                      \
    }

#define NO_VARIABLES_SET(name, ...)                                             \
    fmi3Status name(ARGUMENTS, __VA_ARGS__)                                     \
    {                                                                           \
        return refuse_type(handle, references, count, __func__, CANNOT_BE_SET); \
    }

NO_VARIABLES_GET(fmi3GetFloat32, filled(CANNOT_READ, FLOAT32, values, nValues), fmi3Float32 values[], size_t nValues)
NO_VARIABLES_GET(fmi3GetInt8, NO_VALUES, fmi3Int8 values[], size_t nValues)
NO_VARIABLES_GET(fmi3GetUInt8, NO_VALUES, fmi3UInt8 values[], size_t nValues)
NO_VARIABLES_GET(fmi3GetInt16, NO_VALUES, fmi3Int16 values[], size_t nValues)
NO_VARIABLES_GET(fmi3GetUInt16, NO_VALUES, fmi3UInt16 values[], size_t nValues)
NO_VARIABLES_GET(fmi3GetUInt32, NO_VALUES, fmi3UInt32 values[], size_t nValues)
NO_VARIABLES_GET(fmi3GetUInt64, NO_VALUES, fmi3UInt64 values[], size_t nValues)
NO_VARIABLES_GET(fmi3GetString, NO_VALUES, fmi3String values[], size_t nValues)
NO_VARIABLES_GET(
    fmi3GetBinary, CLEAR(NO_VALUES, valueSizes, nValues), size_t valueSizes[],
    fmi3Binary values[], size_t nValues)
NO_VARIABLES_GET(fmi3GetClock, filled(CANNOT_READ, TRUTH, values, count), fmi3Clock values[])
NO_VARIABLES_SET(fmi3SetFloat32, const fmi3Float32 values[], size_t nValues)
NO_VARIABLES_SET(fmi3SetInt8, const fmi3Int8 values[], size_t nValues)
NO_VARIABLES_SET(fmi3SetUInt8, const fmi3UInt8 values[], size_t nValues)
NO_VARIABLES_SET(fmi3SetInt16, const fmi3Int16 values[], size_t nValues)
NO_VARIABLES_SET(fmi3SetUInt16, const fmi3UInt16 values[], size_t nValues)
NO_VARIABLES_SET(fmi3SetUInt32, const fmi3UInt32 values[], size_t nValues)
NO_VARIABLES_SET(fmi3SetUInt64, const fmi3UInt64 values[], size_t nValues)
NO_VARIABLES_SET(fmi3SetString, const fmi3String values[], size_t nValues)
NO_VARIABLES_SET(fmi3SetBinary, const size_t valueSizes[], const fmi3Binary values[], size_t nValues)
NO_VARIABLES_SET(fmi3SetClock, const fmi3Clock values[])

/* --- derivatives */

static Status read_derivative(
    fmi3Instance handle, const char *call, const fmi3ValueReference unknowns[], size_t nUnknowns,
    const fmi3ValueReference knowns[], size_t nKnowns, const fmi3Float64 seed[], size_t nSeed, fmi3Float64 sensitivity[],
    size_t nSensitivity)
{
    Instance *instance = entered(handle, call);
    if (!instance) return ERROR;
    if (nUnknowns && !unknowns) return refuse_null(instance, "unknowns");
    if (nSensitivity && !sensitivity) return refuse_null(instance, "sensitivity");
    if (nKnowns && !knowns) return refuse_null(instance, "knowns");
    if (nSeed && !seed) return refuse_null(instance, "seed");
    return directional_derivative(
        instance, unknowns, nUnknowns, knowns, nKnowns, seed, nSeed, sensitivity, nSensitivity);
}

fmi3Status fmi3GetDirectionalDerivative(
    fmi3Instance handle, const fmi3ValueReference unknowns[], size_t nUnknowns, const fmi3ValueReference knowns[],
    size_t nKnowns, const fmi3Float64 seed[], size_t nSeed, fmi3Float64 sensitivity[], size_t nSensitivity)
{
    Status status = read_derivative(
        handle, __func__, unknowns, nUnknowns, knowns, nKnowns, seed, nSeed, sensitivity, nSensitivity);
    return filled(status, FLOAT64, sensitivity, nSensitivity);
}

/* --- state */

fmi3Status fmi3GetFMUState(fmi3Instance handle, fmi3FMUState *FMUState)
{
    Instance *instance = entered(handle, __func__);
    if (!instance) return fmi3Error;
    if (!FMUState) return refuse_null(instance, "FMUState");
    return save(instance, (Saved **)FMUState);
}

fmi3Status fmi3SetFMUState(fmi3Instance handle, fmi3FMUState FMUState)
{
    Instance *instance = entered(handle, __func__);
    return instance ? restore(instance, FMUState) : fmi3Error;
}

fmi3Status fmi3FreeFMUState(fmi3Instance handle, fmi3FMUState *FMUState)
{
    Instance *instance = entered(handle, __func__);
    return instance ? free_saved(instance, (Saved **)FMUState) : fmi3Error;
}

fmi3Status fmi3SerializedFMUStateSize(fmi3Instance handle, fmi3FMUState FMUState, size_t *size)
{
    Instance *instance = entered(handle, __func__);
    if (!instance) return fmi3Error;
    if (!size) return refuse_null(instance, "size");
    return saved_size(instance, FMUState, size);
}

fmi3Status fmi3SerializeFMUState(fmi3Instance handle, fmi3FMUState FMUState, fmi3Byte serializedState[], size_t size)
{
    Instance *instance = entered(handle, __func__);
    if (!instance) return fmi3Error;
    if (!serializedState) return refuse_null(instance, "serializedState");
    return serialize(instance, FMUState, serializedState, size);
}

fmi3Status fmi3DeserializeFMUState(
    fmi3Instance handle, const fmi3Byte serializedState[], size_t size, fmi3FMUState *FMUState)
{
    Instance *instance = entered(handle, __func__);
    if (!instance) return fmi3Error;
    if (!serializedState) return refuse_null(instance, "serializedState");
    if (!FMUState) return refuse_null(instance, "FMUState");
    return deserialize(instance, serializedState, size, (Saved **)FMUState);
}

/* --- functions that the flags of the model description exclude */

#define REFUSED refuse_call(handle, __func__)
#define NOT_OFFERED_GET(name, status, ...) \
    fmi3Status name(__VA_ARGS__)           \
    {                                      \
        return status;                     \
    }
#define NOT_OFFERED_CALL(name, ...) NOT_OFFERED_GET(name, REFUSED, __VA_ARGS__)

NOT_OFFERED_CALL(fmi3EnterEventMode, fmi3Instance handle)
NOT_OFFERED_CALL(fmi3EnterStepMode, fmi3Instance handle)
NOT_OFFERED_CALL(fmi3EnterConfigurationMode, fmi3Instance handle)
NOT_OFFERED_CALL(fmi3ExitConfigurationMode, fmi3Instance handle)
NOT_OFFERED_CALL(fmi3EvaluateDiscreteStates, fmi3Instance handle)
NOT_OFFERED_GET(
    fmi3UpdateDiscreteStates,
    CLEAR(CLEAR(CLEAR(CLEAR(CLEAR(
        filled(REFUSED, FLOAT64, next, 1), defined, 1), values, 1), nominals, 1), end, 1), update, 1),
    fmi3Instance handle, fmi3Boolean *update, fmi3Boolean *end, fmi3Boolean *nominals, fmi3Boolean *values,
    fmi3Boolean *defined, fmi3Float64 *next)
NOT_OFFERED_GET(
    fmi3GetNumberOfVariableDependencies, CLEAR(REFUSED, count, 1), fmi3Instance handle, fmi3ValueReference reference,
    size_t *count)
NOT_OFFERED_GET(
    fmi3GetVariableDependencies,
    CLEAR(CLEAR(CLEAR(CLEAR(REFUSED, elements, count), independents, count), others, count), kinds, count),
    fmi3Instance handle, fmi3ValueReference dependent, size_t elements[], fmi3ValueReference independents[],
    size_t others[], fmi3DependencyKind kinds[], size_t count)
NOT_OFFERED_GET(
    fmi3GetAdjointDerivative, filled(REFUSED, FLOAT64, sensitivity, nSensitivity), ARGUMENTS,
    const fmi3ValueReference knowns[], size_t nKnowns, const fmi3Float64 seed[], size_t nSeed, fmi3Float64 sensitivity[],
    size_t nSensitivity)
NOT_OFFERED_GET(
    fmi3GetOutputDerivatives, filled(REFUSED, FLOAT64, values, nValues), ARGUMENTS, const fmi3Int32 orders[],
    fmi3Float64 values[], size_t nValues)
NOT_OFFERED_GET(
    fmi3GetIntervalDecimal, CLEAR(filled(REFUSED, FLOAT64, intervals, count), qualifiers, count), ARGUMENTS,
    fmi3Float64 intervals[], fmi3IntervalQualifier qualifiers[])
NOT_OFFERED_GET(
    fmi3GetIntervalFraction, CLEAR(CLEAR(CLEAR(REFUSED, counters, count), resolutions, count), qualifiers, count), ARGUMENTS,
    fmi3UInt64 counters[], fmi3UInt64 resolutions[], fmi3IntervalQualifier qualifiers[])
NOT_OFFERED_GET(fmi3GetShiftDecimal, filled(REFUSED, FLOAT64, shifts, count), ARGUMENTS, fmi3Float64 shifts[])
NOT_OFFERED_GET(
    fmi3GetShiftFraction, CLEAR(CLEAR(REFUSED, counters, count), resolutions, count), ARGUMENTS, fmi3UInt64 counters[],
    fmi3UInt64 resolutions[])
NOT_OFFERED_CALL(fmi3SetIntervalDecimal, ARGUMENTS, const fmi3Float64 intervals[])
NOT_OFFERED_CALL(fmi3SetIntervalFraction, ARGUMENTS, const fmi3UInt64 counters[], const fmi3UInt64 resolutions[])
NOT_OFFERED_CALL(fmi3SetShiftDecimal, ARGUMENTS, const fmi3Float64 shifts[])
NOT_OFFERED_CALL(fmi3SetShiftFraction, ARGUMENTS, const fmi3UInt64 counters[], const fmi3UInt64 resolutions[])

/* --- model exchange and scheduled execution */

NOT_OFFERED_CALL(fmi3EnterContinuousTimeMode, fmi3Instance handle)
NOT_OFFERED_GET(
    fmi3CompletedIntegratorStep, CLEAR(CLEAR(REFUSED, event, 1), end, 1), fmi3Instance handle, fmi3Boolean prior,
    fmi3Boolean *event, fmi3Boolean *end)
NOT_OFFERED_CALL(fmi3SetTime, fmi3Instance handle, fmi3Float64 time)
NOT_OFFERED_CALL(fmi3SetContinuousStates, fmi3Instance handle, const fmi3Float64 states[], size_t count)
#define NOT_OFFERED_STATES(name) \
    NOT_OFFERED_GET(name, filled(REFUSED, FLOAT64, values, count), fmi3Instance handle, fmi3Float64 values[], size_t count)
NOT_OFFERED_STATES(fmi3GetContinuousStateDerivatives)
NOT_OFFERED_STATES(fmi3GetEventIndicators)
NOT_OFFERED_STATES(fmi3GetContinuousStates)
NOT_OFFERED_STATES(fmi3GetNominalsOfContinuousStates)
NOT_OFFERED_GET(fmi3GetNumberOfEventIndicators, CLEAR(REFUSED, count, 1), fmi3Instance handle, size_t *count)
NOT_OFFERED_GET(fmi3GetNumberOfContinuousStates, CLEAR(REFUSED, count, 1), fmi3Instance handle, size_t *count)
NOT_OFFERED_CALL(fmi3ActivateModelPartition, fmi3Instance handle, fmi3ValueReference clock, fmi3Float64 time)
