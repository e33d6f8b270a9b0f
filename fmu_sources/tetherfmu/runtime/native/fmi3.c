/* FMI 3.0 for co-simulation, around tether.c. */
#include "fmi3Functions.h"
#include "tether.h"

/* Pass a message to the importer, with the name of the instance, which FMI 3 has no argument for. */
static void log_fmi3(const Tether *tether, Status status, const char *text)
{
    char message[LONGEST_TEXT];
    fill_in(message, sizeof message, "{name}: {text}", FACTS(word("name", tether->name), word("text", text)));
    fmi3LogMessageCallback log = (fmi3LogMessageCallback)tether->importer_log;
    log(tether->environment, (fmi3Status)status, CATEGORY[status], message);
}

const char *fmi3GetVersion(void)
{
    return fmi3Version;
}

fmi3Status fmi3SetDebugLogging(
    fmi3Instance instance, fmi3Boolean loggingOn, size_t nCategories, const fmi3String categories[])
{
    ENTER(instance);
    DONE(check_categories(tether, nCategories, categories));
}

/* --- life cycle */

/* A new instance; NULL, and a message, if `refusal` says why there can be none, or if the token is wrong. */
static fmi3Instance instantiated(
    const char *call, fmi3String name, fmi3String token, fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
    const char *refusal)
{
    Tether *tether = make_tether(name ? name : "", log_fmi3, environment, (void (*)(void))log);
    if (!tether) return NULL;
    tether->call = call;
    if (!name)
        say(tether, ERROR, IS_NULL, FACTS(word("argument", "instanceName")));
    else if (refusal)
        say(tether, ERROR, refusal, NULL);
    else if (check_token(tether, token) == OK)
        return tether;
    free_tether(tether);
    return NULL;
}

fmi3Instance fmi3InstantiateCoSimulation(
    fmi3String instanceName, fmi3String instantiationToken, fmi3String resourcePath, fmi3Boolean visible,
    fmi3Boolean loggingOn, fmi3Boolean eventModeUsed, fmi3Boolean earlyReturnAllowed,
    const fmi3ValueReference requiredIntermediateVariables[], size_t nRequiredIntermediateVariables,
    fmi3InstanceEnvironment instanceEnvironment, fmi3LogMessageCallback logMessage,
    fmi3IntermediateUpdateCallback intermediateUpdate)
{
    const char *refusal = eventModeUsed || nRequiredIntermediateVariables ? NOT_OFFERED : NULL;
    return instantiated(__func__, instanceName, instantiationToken, instanceEnvironment, logMessage, refusal);
}

fmi3Instance fmi3InstantiateModelExchange(
    fmi3String instanceName, fmi3String instantiationToken, fmi3String resourcePath, fmi3Boolean visible,
    fmi3Boolean loggingOn, fmi3InstanceEnvironment instanceEnvironment, fmi3LogMessageCallback logMessage)
{
    return instantiated(__func__, instanceName, instantiationToken, instanceEnvironment, logMessage, NO_CO_SIMULATION);
}

fmi3Instance fmi3InstantiateScheduledExecution(
    fmi3String instanceName, fmi3String instantiationToken, fmi3String resourcePath, fmi3Boolean visible,
    fmi3Boolean loggingOn, fmi3InstanceEnvironment instanceEnvironment, fmi3LogMessageCallback logMessage,
    fmi3ClockUpdateCallback clockUpdate, fmi3LockPreemptionCallback lockPreemption,
    fmi3UnlockPreemptionCallback unlockPreemption)
{
    return instantiated(__func__, instanceName, instantiationToken, instanceEnvironment, logMessage, NO_CO_SIMULATION);
}

void fmi3FreeInstance(fmi3Instance instance)
{
    Tether *tether = entered(instance, __func__);
    if (tether) free_tether(tether);
}

fmi3Status fmi3EnterInitializationMode(
    fmi3Instance instance, fmi3Boolean toleranceDefined, fmi3Float64 tolerance, fmi3Float64 startTime,
    fmi3Boolean stopTimeDefined, fmi3Float64 stopTime)
{
    ENTER(instance);
    if (tether->phase != BEFORE) DONE(enter_initialization(tether)); /* refuses it in its own words */
    Status status = set_up_experiment(tether, toleranceDefined, tolerance, startTime, stopTimeDefined, stopTime);
    if (status <= WARNING) enter_initialization(tether);
    DONE(status);
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance instance)
{
    ENTER(instance);
    DONE(exit_initialization(tether));
}

fmi3Status fmi3Terminate(fmi3Instance instance)
{
    ENTER(instance);
    DONE(terminate(tether));
}

fmi3Status fmi3Reset(fmi3Instance instance)
{
    ENTER(instance);
    to_start_values(tether);
    return fmi3OK;
}

/* There are no events, a step is never left early, and the simulation need not end. */
fmi3Status fmi3DoStep(
    fmi3Instance instance, fmi3Float64 currentCommunicationPoint, fmi3Float64 communicationStepSize,
    fmi3Boolean noSetFMUStatePriorToCurrentPoint, fmi3Boolean *eventHandlingNeeded, fmi3Boolean *terminateSimulation,
    fmi3Boolean *earlyReturn, fmi3Float64 *lastSuccessfulTime)
{
    ENTER(instance);
    NEED(eventHandlingNeeded);
    NEED(terminateSimulation);
    NEED(earlyReturn);
    NEED(lastSuccessfulTime);
    *eventHandlingNeeded = *terminateSimulation = *earlyReturn = fmi3False;
    Status status = advance(tether, currentCommunicationPoint, communicationStepSize);
    *lastSuccessfulTime = last_successful_time(tether);
    DONE(status);
}

/* --- values */

#define ARGUMENTS fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences
#define NEED_VALUES                              \
    ENTER(instance);                             \
    if (nValueReferences) NEED(valueReferences); \
    if (nValues) NEED(values)

#define VARIABLES(name, type, number, kinds)                                                         \
    fmi3Status fmi3Get##name(ARGUMENTS, type values[], size_t nValues)                               \
    {                                                                                                \
        NEED_VALUES;                                                                                 \
        DONE(get_values(tether, number, kinds, valueReferences, nValueReferences, values, nValues)); \
    }                                                                                                \
    fmi3Status fmi3Set##name(ARGUMENTS, const type values[], size_t nValues)                         \
    {                                                                                                \
        NEED_VALUES;                                                                                 \
        DONE(set_values(tether, number, kinds, valueReferences, nValueReferences, values, nValues)); \
    }

/* Types that no variable has: fine for no variable at all. */
#define NO_VARIABLES(name, type)                                                            \
    fmi3Status fmi3Get##name(ARGUMENTS, type values[], size_t nValues)                      \
    {                                                                                       \
        ENTER(instance);                                                                    \
        DONE(refuse_references(tether, CANNOT_BE_READ, valueReferences, nValueReferences)); \
    }                                                                                       \
    fmi3Status fmi3Set##name(ARGUMENTS, const type values[], size_t nValues)                \
    {                                                                                       \
        ENTER(instance);                                                                    \
        DONE(refuse_references(tether, CANNOT_BE_SET, valueReferences, nValueReferences));  \
    }

static Status refuse_references(
    const Tether *tether, const char *sentence, const fmi3ValueReference *references, size_t count)
{
    if (!count) return OK;
    if (!references) return say(tether, ERROR, IS_NULL, FACTS(word("argument", "valueReferences")));
    return say(tether, ERROR, sentence, FACTS(whole("reference", references[0]), word("value", "such a value")));
}

VARIABLES(Float64, fmi3Float64, FLOAT64, REAL)
VARIABLES(Int32, fmi3Int32, INT32, INTEGER)
VARIABLES(Int64, fmi3Int64, INT64, ENUMERATION)
NO_VARIABLES(Float32, fmi3Float32)
NO_VARIABLES(Int8, fmi3Int8)
NO_VARIABLES(UInt8, fmi3UInt8)
NO_VARIABLES(Int16, fmi3Int16)
NO_VARIABLES(UInt16, fmi3UInt16)
NO_VARIABLES(UInt32, fmi3UInt32)
NO_VARIABLES(UInt64, fmi3UInt64)
NO_VARIABLES(Boolean, fmi3Boolean)
NO_VARIABLES(String, fmi3String)

fmi3Status fmi3GetBinary(ARGUMENTS, size_t valueSizes[], fmi3Binary values[], size_t nValues)
{
    ENTER(instance);
    DONE(refuse_references(tether, CANNOT_BE_READ, valueReferences, nValueReferences));
}

fmi3Status fmi3SetBinary(ARGUMENTS, const size_t valueSizes[], const fmi3Binary values[], size_t nValues)
{
    ENTER(instance);
    DONE(refuse_references(tether, CANNOT_BE_SET, valueReferences, nValueReferences));
}

fmi3Status fmi3GetClock(ARGUMENTS, fmi3Clock values[])
{
    ENTER(instance);
    DONE(refuse_references(tether, CANNOT_BE_READ, valueReferences, nValueReferences));
}

fmi3Status fmi3SetClock(ARGUMENTS, const fmi3Clock values[])
{
    ENTER(instance);
    DONE(refuse_references(tether, CANNOT_BE_SET, valueReferences, nValueReferences));
}

/* --- derivatives */

fmi3Status fmi3GetDirectionalDerivative(
    fmi3Instance instance, const fmi3ValueReference unknowns[], size_t nUnknowns, const fmi3ValueReference knowns[],
    size_t nKnowns, const fmi3Float64 seed[], size_t nSeed, fmi3Float64 sensitivity[], size_t nSensitivity)
{
    ENTER(instance);
    if (nUnknowns) NEED(unknowns);
    if (nSensitivity) NEED(sensitivity);
    if (nKnowns) NEED(knowns);
    if (nSeed) NEED(seed);
    DONE(directional_derivative(
        tether, unknowns, nUnknowns, knowns, nKnowns, seed, nSeed, sensitivity, nSensitivity));
}

/* --- state */

fmi3Status fmi3GetFMUState(fmi3Instance instance, fmi3FMUState *FMUState)
{
    ENTER(instance);
    NEED(FMUState);
    DONE(save(tether, (Saved **)FMUState));
}

fmi3Status fmi3SetFMUState(fmi3Instance instance, fmi3FMUState FMUState)
{
    ENTER(instance);
    DONE(restore(tether, FMUState));
}

fmi3Status fmi3FreeFMUState(fmi3Instance instance, fmi3FMUState *FMUState)
{
    ENTER(instance);
    DONE(free_saved(tether, (Saved **)FMUState));
}

fmi3Status fmi3SerializedFMUStateSize(fmi3Instance instance, fmi3FMUState FMUState, size_t *size)
{
    ENTER(instance);
    NEED(size);
    DONE(saved_size(tether, FMUState, size));
}

fmi3Status fmi3SerializeFMUState(fmi3Instance instance, fmi3FMUState FMUState, fmi3Byte serializedState[], size_t size)
{
    ENTER(instance);
    NEED(serializedState);
    DONE(serialize(tether, FMUState, serializedState, size));
}

fmi3Status fmi3DeserializeFMUState(
    fmi3Instance instance, const fmi3Byte serializedState[], size_t size, fmi3FMUState *FMUState)
{
    ENTER(instance);
    NEED(serializedState);
    NEED(FMUState);
    DONE(deserialize(tether, serializedState, size, (Saved **)FMUState));
}

/* --- what the flags of the model description do not offer */

#define REFERENCES const fmi3ValueReference references[], size_t count
#define OF_CLOCKS(name, ...) NOT_OFFERED_CALL(fmi3Status, name, fmi3Instance instance, REFERENCES, __VA_ARGS__)

NOT_OFFERED_CALL(fmi3Status, fmi3EnterEventMode, fmi3Instance instance)
NOT_OFFERED_CALL(fmi3Status, fmi3EnterStepMode, fmi3Instance instance)
NOT_OFFERED_CALL(fmi3Status, fmi3EnterConfigurationMode, fmi3Instance instance)
NOT_OFFERED_CALL(fmi3Status, fmi3ExitConfigurationMode, fmi3Instance instance)
NOT_OFFERED_CALL(fmi3Status, fmi3EvaluateDiscreteStates, fmi3Instance instance)
NOT_OFFERED_CALL(
    fmi3Status, fmi3UpdateDiscreteStates, fmi3Instance instance, fmi3Boolean *update, fmi3Boolean *end,
    fmi3Boolean *nominals, fmi3Boolean *values, fmi3Boolean *defined, fmi3Float64 *next)
NOT_OFFERED_CALL(
    fmi3Status, fmi3GetNumberOfVariableDependencies, fmi3Instance instance, fmi3ValueReference reference,
    size_t *count)
NOT_OFFERED_CALL(
    fmi3Status, fmi3GetVariableDependencies, fmi3Instance instance, fmi3ValueReference dependent, size_t elements[],
    fmi3ValueReference independents[], size_t others[], fmi3DependencyKind kinds[], size_t count)
NOT_OFFERED_CALL(
    fmi3Status, fmi3GetAdjointDerivative, fmi3Instance instance, REFERENCES, const fmi3ValueReference knowns[],
    size_t nKnowns, const fmi3Float64 seed[], size_t nSeed, fmi3Float64 sensitivity[], size_t nSensitivity)
NOT_OFFERED_CALL(
    fmi3Status, fmi3GetOutputDerivatives, fmi3Instance instance, REFERENCES, const fmi3Int32 orders[],
    fmi3Float64 values[], size_t nValues)
OF_CLOCKS(fmi3GetIntervalDecimal, fmi3Float64 intervals[], fmi3IntervalQualifier qualifiers[])
OF_CLOCKS(fmi3GetIntervalFraction, fmi3UInt64 counters[], fmi3UInt64 resolutions[], fmi3IntervalQualifier qualifiers[])
OF_CLOCKS(fmi3GetShiftDecimal, fmi3Float64 shifts[])
OF_CLOCKS(fmi3GetShiftFraction, fmi3UInt64 counters[], fmi3UInt64 resolutions[])
OF_CLOCKS(fmi3SetIntervalDecimal, const fmi3Float64 intervals[])
OF_CLOCKS(fmi3SetIntervalFraction, const fmi3UInt64 counters[], const fmi3UInt64 resolutions[])
OF_CLOCKS(fmi3SetShiftDecimal, const fmi3Float64 shifts[])
OF_CLOCKS(fmi3SetShiftFraction, const fmi3UInt64 counters[], const fmi3UInt64 resolutions[])

/* --- model exchange and scheduled execution */

NOT_OFFERED_CALL(fmi3Status, fmi3EnterContinuousTimeMode, fmi3Instance instance)
NOT_OFFERED_CALL(
    fmi3Status, fmi3CompletedIntegratorStep, fmi3Instance instance, fmi3Boolean prior, fmi3Boolean *event,
    fmi3Boolean *end)
NOT_OFFERED_CALL(fmi3Status, fmi3SetTime, fmi3Instance instance, fmi3Float64 time)
NOT_OFFERED_CALL(fmi3Status, fmi3SetContinuousStates, fmi3Instance instance, const fmi3Float64 states[], size_t count)
NOT_OFFERED_CALL(
    fmi3Status, fmi3GetContinuousStateDerivatives, fmi3Instance instance, fmi3Float64 derivatives[], size_t count)
NOT_OFFERED_CALL(fmi3Status, fmi3GetEventIndicators, fmi3Instance instance, fmi3Float64 indicators[], size_t count)
NOT_OFFERED_CALL(fmi3Status, fmi3GetContinuousStates, fmi3Instance instance, fmi3Float64 states[], size_t count)
NOT_OFFERED_CALL(
    fmi3Status, fmi3GetNominalsOfContinuousStates, fmi3Instance instance, fmi3Float64 nominals[], size_t count)
NOT_OFFERED_CALL(fmi3Status, fmi3GetNumberOfEventIndicators, fmi3Instance instance, size_t *count)
NOT_OFFERED_CALL(fmi3Status, fmi3GetNumberOfContinuousStates, fmi3Instance instance, size_t *count)
NOT_OFFERED_CALL(
    fmi3Status, fmi3ActivateModelPartition, fmi3Instance instance, fmi3ValueReference clock, fmi3Float64 time)
