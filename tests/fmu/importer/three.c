/* The functions of FMI 2.0 over those of an FMU of FMI 3.0, so that one fuzzer serves both: what differs is passed on in
   the other words, and what 3.0 has no counterpart of is refused. Adjoint derivatives are called with what the
   directional ones give; `visible` stands for the event mode of co-simulation. */

#include <stdlib.h>

#include "fmi2Functions.h"
#define FMI3_OVERRIDE_FUNCTION_PREFIX
#include "fmi3Functions.h"

enum { NO_STATUS = 7, MOST = 2048 };

typedef struct {
    fmi3Instance c;
    fmi2CallbackFunctions callbacks;
    fmi2Type type;
    int events, begun;             /* event mode is used; no longer before initialization */
    fmi2Boolean tolerance_defined, stop_defined;
    double tolerance, from, stop;
} Both;

static void tell(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category, fmi3String message)
{
    Both *b = environment;
    if (b->callbacks.logger)
        b->callbacks.logger(b->callbacks.componentEnvironment, "one", (fmi2Status)status, category, message);
}

static fmi2Status refused(Both *b, const char *why)
{
    tell(b, fmi3Error, "logStatusError", why);
    return fmi2Error;
}

#define OF(component) Both *b = component
#define PASS(call) return (fmi2Status)(call)
#define ABSENT(name, ...) \
    fmi2Status fmi2##name(fmi2Component c, __VA_ARGS__) { return refused(c, #name " is not of FMI 3.0"); }

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char *fmi2GetVersion(void) { return fmi2Version; }

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String token, fmi2String resources,
                              const fmi2CallbackFunctions *callbacks, fmi2Boolean visible, fmi2Boolean logging)
{
    Both *b;
    if (!callbacks || type < fmi2ModelExchange || type > fmi2CoSimulation || !(b = calloc(1, sizeof *b))) return NULL;
    b->callbacks = *callbacks, b->type = type, b->events = visible;
    b->c = type == fmi2ModelExchange
         ? fmi3InstantiateModelExchange(name, token, resources, 0, logging, b, tell)
         : fmi3InstantiateCoSimulation(name, token, resources, 0, logging, visible, 0, NULL, 0, b, tell, NULL);
    if (!b->c) return free(b), NULL;
    return b;
}

void fmi2FreeInstance(fmi2Component c)
{
    OF(c);
    fmi3FreeInstance(b->c);
    free(b);
}

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String names[])
{
    OF(c);
    PASS(fmi3SetDebugLogging(b->c, on, n, names));
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean tolerance_defined, fmi2Real tolerance, fmi2Real from,
                               fmi2Boolean stop_defined, fmi2Real stop)
{
    OF(c);
    if (b->begun) return refused(b, "the experiment is set up before initialization");
    b->tolerance_defined = tolerance_defined, b->tolerance = tolerance, b->from = from;
    b->stop_defined = stop_defined, b->stop = stop;
    return fmi2OK;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c)
{
    OF(c);
    fmi3Status status = fmi3EnterInitializationMode(b->c, b->tolerance_defined, b->tolerance, b->from, b->stop_defined,
                                                    b->stop);
    b->begun |= status == fmi3OK;
    return (fmi2Status)status;
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c)
{
    OF(c);
    fmi3Status status = fmi3ExitInitializationMode(b->c);
    if (status <= fmi3Warning && b->events && b->type == fmi2CoSimulation) fmi3EnterStepMode(b->c);
    return (fmi2Status)status;
}

fmi2Status fmi2Reset(fmi2Component c)
{
    OF(c);
    b->begun = 0, b->from = 0.0, b->tolerance_defined = b->stop_defined = 0;
    PASS(fmi3Reset(b->c));
}

fmi2Status fmi2EnterContinuousTimeMode(fmi2Component c)
{
    OF(c);
    PASS(b->type == fmi2CoSimulation ? fmi3EnterStepMode(b->c) : fmi3EnterContinuousTimeMode(b->c));
}

fmi2Status fmi2NewDiscreteStates(fmi2Component c, fmi2EventInfo *info)
{
    OF(c);
    fmi3Boolean f[5] = {0};
    double time;
    fmi3Status status;
    if (!info) PASS(fmi3UpdateDiscreteStates(b->c, NULL, NULL, NULL, NULL, NULL, NULL));
    status = fmi3UpdateDiscreteStates(b->c, f, f + 1, f + 2, f + 3, f + 4, &time);
    info->newDiscreteStatesNeeded = f[0], info->terminateSimulation = f[1];
    return (fmi2Status)status;
}

fmi2Status fmi2CompletedIntegratorStep(fmi2Component c, fmi2Boolean no_return, fmi2Boolean *event, fmi2Boolean *end)
{
    OF(c);
    fmi3Boolean f[2] = {0};
    fmi3Status status = fmi3CompletedIntegratorStep(b->c, no_return, event ? f : NULL, end ? f + 1 : NULL);
    if (status == fmi3OK) *event = f[0], *end = f[1];
    return (fmi2Status)status;
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real time, fmi2Real step, fmi2Boolean no_return)
{
    OF(c);
    fmi3Boolean f[3];
    double reached;
    fmi3Status status = fmi3DoStep(b->c, time, step, no_return, f, f + 1, f + 2, &reached);
    return status <= fmi3Warning && (f[0] || f[1] || f[2]) ? NO_STATUS : (fmi2Status)status;
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknown[], size_t n_unknown,
                                        const fmi2ValueReference known[], size_t n_known, const fmi2Real along[],
                                        fmi2Real found[])
{
    OF(c);
    double back[MOST];
    fmi3Status status = fmi3GetDirectionalDerivative(b->c, unknown, n_unknown, known, n_known, along, n_known, found,
                                                     n_unknown);
    if (status != fmi3OK) return (fmi2Status)status;
    PASS(fmi3GetAdjointDerivative(b->c, unknown, n_unknown, known, n_known, found, n_unknown, back, n_known));
}

#define VALUES(name, TYPE, now, NOW) \
    fmi2Status fmi2Get##name(fmi2Component c, const fmi2ValueReference r[], size_t n, TYPE value[]) \
    { \
        OF(c); \
        PASS(fmi3Get##now(b->c, r, n, (NOW *)value, n)); \
    } \
    fmi2Status fmi2Set##name(fmi2Component c, const fmi2ValueReference r[], size_t n, const TYPE value[]) \
    { \
        OF(c); \
        PASS(fmi3Set##now(b->c, r, n, (const NOW *)value, n)); \
    }
VALUES(Real, fmi2Real, Float64, fmi3Float64)
VALUES(Integer, fmi2Integer, Int32, fmi3Int32)
VALUES(String, fmi2String, String, fmi3String)

#define ONE(name, now, TYPE) \
    fmi2Status fmi2##name(fmi2Component c, TYPE argument) \
    { \
        OF(c); \
        PASS(fmi3##now(b->c, argument)); \
    }
#define ARRAY(name, now, TYPE) \
    fmi2Status fmi2##name(fmi2Component c, TYPE values[], size_t n) \
    { \
        OF(c); \
        PASS(fmi3##now(b->c, values, n)); \
    }
#define PLAIN(name) \
    fmi2Status fmi2##name(fmi2Component c) \
    { \
        OF(c); \
        PASS(fmi3##name(b->c)); \
    }
PLAIN(Terminate)
PLAIN(EnterEventMode)
ONE(SetTime, SetTime, fmi2Real)
ONE(GetFMUstate, GetFMUState, fmi2FMUstate *)
ONE(SetFMUstate, SetFMUState, fmi2FMUstate)
ONE(FreeFMUstate, FreeFMUState, fmi2FMUstate *)
ARRAY(SetContinuousStates, SetContinuousStates, const fmi2Real)
ARRAY(GetContinuousStates, GetContinuousStates, fmi2Real)
ARRAY(GetDerivatives, GetContinuousStateDerivatives, fmi2Real)
ARRAY(GetEventIndicators, GetEventIndicators, fmi2Real)
ARRAY(GetNominalsOfContinuousStates, GetNominalsOfContinuousStates, fmi2Real)

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t *size)
{
    OF(c);
    PASS(fmi3SerializedFMUStateSize(b->c, state, size));
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size)
{
    OF(c);
    PASS(fmi3SerializeFMUState(b->c, state, (fmi3Byte *)bytes, size));
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state)
{
    OF(c);
    PASS(fmi3DeserializeFMUState(b->c, (const fmi3Byte *)bytes, size, state));
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference r[], size_t n,
                                        const fmi2Integer order[], fmi2Real value[])
{
    OF(c);
    PASS(fmi3GetOutputDerivatives(b->c, r, n, order, value, n));
}

ABSENT(SetRealInputDerivatives, const fmi2ValueReference r[], size_t n, const fmi2Integer order[], const fmi2Real v[])
ABSENT(GetBoolean, const fmi2ValueReference r[], size_t n, fmi2Boolean value[])
ABSENT(SetBoolean, const fmi2ValueReference r[], size_t n, const fmi2Boolean value[])
ABSENT(GetStatus, const fmi2StatusKind kind, fmi2Status *value)
ABSENT(GetRealStatus, const fmi2StatusKind kind, fmi2Real *value)
ABSENT(GetIntegerStatus, const fmi2StatusKind kind, fmi2Integer *value)
ABSENT(GetBooleanStatus, const fmi2StatusKind kind, fmi2Boolean *value)
ABSENT(GetStringStatus, const fmi2StatusKind kind, fmi2String *value)
fmi2Status fmi2CancelStep(fmi2Component c) { return refused(c, "CancelStep is not of FMI 3.0"); }
