/* Every function of FMI 2.0 in every mode of both interfaces: what the standard's tables allow is done, what they do
   not is refused with fmi2Error, and a refused call leaves the run that follows bit for bit as it was. */

#include "checks.h"

enum { INSTANTIATED = 1, INITIALIZATION = 2, EVENT = 4, CONTINUOUS = 8, COMPLETE = 16, FAILED = 32, TERMINATED = 64 };
enum { ANY = 127, GET = ANY & ~INSTANTIATED, SET = INSTANTIATED | INITIALIZATION | EVENT | COMPLETE };

static const int modes[2][5] = {{INSTANTIATED, INITIALIZATION, EVENT, CONTINUOUS, TERMINATED},
                                {INSTANTIATED, INITIALIZATION, COMPLETE, FAILED, TERMINATED}};

static const Fmu *m;
static double room[1024];
static size_t nx;
static const char *breaking;       /* input that makes a step fail, and its value */
static double breaking_value;

static fmi2Status set_input(fmi2Component c)
{
    return m->f.SetReal(c, &m->u[0].r, 1, &m->u[0].start);
}

#define CALL(name, call) \
    static fmi2Status call_##name(fmi2Component c) \
    { \
        const Functions *f = &m->f; \
        (void)c, (void)f; \
        return call; \
    }

static fmi2Boolean flag_1, flag_2;
static fmi2EventInfo info;
static fmi2Status answer;
static fmi2Integer integer, one[] = {1};
static fmi2String text;
static double unit = 1.0, slope[1], zero[1];
static fmi2FMUstate saved;
static char bytes[1 << 16];
static size_t size;

static fmi2Status save(fmi2Component c)
{
    fmi2FMUstate state = NULL;
    fmi2Status status = m->f.GetFMUstate(c, &state);
    if (status == fmi2OK) status = m->f.SetFMUstate(c, state);
    if (status == fmi2OK) status = m->f.SerializedFMUstateSize(c, state, &size);
    if (status == fmi2OK) status = m->f.SerializeFMUstate(c, state, bytes, size);
    if (status == fmi2OK) status = m->f.DeSerializeFMUstate(c, bytes, size, &state);
    if (status == fmi2OK) status = m->f.FreeFMUstate(c, &state);
    return status;
}

static double now;

CALL(SetDebugLogging, f->SetDebugLogging(c, fmi2False, 0, NULL))
CALL(SetupExperiment, f->SetupExperiment(c, fmi2False, 0.0, 0.0, fmi2False, 0.0))
CALL(EnterInitializationMode, f->EnterInitializationMode(c))
CALL(ExitInitializationMode, f->ExitInitializationMode(c))
CALL(Terminate, f->Terminate(c))
CALL(Reset, f->Reset(c))
CALL(GetReal, f->GetReal(c, m->refs, (size_t)m->n, room))
CALL(GetInteger, f->GetInteger(c, NULL, 0, NULL))
CALL(GetBoolean, f->GetBoolean(c, NULL, 0, NULL))
CALL(GetString, f->GetString(c, NULL, 0, NULL))
CALL(SetReal, set_input(c))
CALL(SetParameter, f->SetReal(c, &m->p[0].r, 1, &m->p[0].start))
CALL(SetState, f->SetReal(c, &m->x[0].r, 1, &m->x[0].start))
CALL(SetInteger, f->SetInteger(c, NULL, 0, NULL))
CALL(SetBoolean, f->SetBoolean(c, NULL, 0, NULL))
CALL(SetString, f->SetString(c, NULL, 0, NULL))
CALL(FMUstate, save(c))
CALL(GetDirectionalDerivative, f->GetDirectionalDerivative(c, &m->d[0].r, 1, &m->x[0].r, 1, &unit, slope))
CALL(EnterEventMode, f->EnterEventMode(c))
CALL(NewDiscreteStates, f->NewDiscreteStates(c, &info))
CALL(EnterContinuousTimeMode, f->EnterContinuousTimeMode(c))
CALL(CompletedIntegratorStep, f->CompletedIntegratorStep(c, fmi2True, &flag_1, &flag_2))
CALL(SetTime, f->SetTime(c, now))
CALL(SetContinuousStates, f->SetContinuousStates(c, room, nx))
CALL(GetDerivatives, f->GetDerivatives(c, room, nx))
CALL(GetEventIndicators, f->GetEventIndicators(c, NULL, 0))
CALL(GetContinuousStates, f->GetContinuousStates(c, room, nx))
CALL(GetNominalsOfContinuousStates, f->GetNominalsOfContinuousStates(c, room, nx))
CALL(SetRealInputDerivatives, f->SetRealInputDerivatives(c, &m->u[0].r, 1, one, zero))
CALL(GetRealOutputDerivatives, f->GetRealOutputDerivatives(c, &m->y[0].r, 1, one, slope))
CALL(DoStep, f->DoStep(c, now, 0.5, fmi2True))
CALL(CancelStep, f->CancelStep(c))
CALL(GetStatus, f->GetStatus(c, fmi2DoStepStatus, &answer))
CALL(GetRealStatus, f->GetRealStatus(c, fmi2LastSuccessfulTime, slope))
CALL(GetIntegerStatus, f->GetIntegerStatus(c, fmi2LastSuccessfulTime, &integer))
CALL(GetBooleanStatus, f->GetBooleanStatus(c, fmi2Terminated, &flag_1))
CALL(GetStringStatus, f->GetStringStatus(c, fmi2PendingStatus, &text))

/* Modes by the tables of FMI 2.0.4, sections 3.2.3 and 4.2.4. What they leave to the FMU stands in `either`. */
static const struct {
    const char *name;
    fmi2Status (*call)(fmi2Component);
    int exchange, simulation;      /* modes it is allowed in, for each interface */
    int either;                    /* modes where both answers are right */
} calls[] = {
#define ROW(name, exchange, simulation, either) {#name, call_##name, exchange, simulation, either}
    ROW(SetDebugLogging, ANY, ANY, 0),
    ROW(SetupExperiment, INSTANTIATED, INSTANTIATED, 0),
    ROW(EnterInitializationMode, INSTANTIATED, INSTANTIATED, 0),
    ROW(ExitInitializationMode, INITIALIZATION, INITIALIZATION, 0),
    ROW(Terminate, EVENT | CONTINUOUS, COMPLETE | FAILED, 0),
    ROW(Reset, ANY, ANY, 0),
    ROW(GetReal, GET, GET, 0),
    ROW(GetInteger, GET, GET, 0),
    ROW(GetBoolean, GET, GET, 0),
    ROW(GetString, GET, GET, 0),
    ROW(SetReal, SET | CONTINUOUS, SET, FAILED),
    ROW(SetParameter, SET, SET, FAILED),
    ROW(SetState, INSTANTIATED | INITIALIZATION, INSTANTIATED | INITIALIZATION, 0),
    ROW(SetInteger, SET, SET, FAILED),
    ROW(SetBoolean, SET, SET, FAILED),
    ROW(SetString, SET, SET, FAILED),
    ROW(FMUstate, ANY, ANY, 0),
    ROW(GetDirectionalDerivative, GET, GET, 0),
    ROW(EnterEventMode, CONTINUOUS, 0, EVENT),
    ROW(NewDiscreteStates, EVENT, 0, 0),
    ROW(EnterContinuousTimeMode, EVENT, 0, 0),
    ROW(CompletedIntegratorStep, CONTINUOUS, 0, 0),
    ROW(SetTime, EVENT | CONTINUOUS, 0, 0),
    ROW(SetContinuousStates, CONTINUOUS, 0, 0),
    ROW(GetDerivatives, EVENT | CONTINUOUS | TERMINATED, 0, INITIALIZATION),
    ROW(GetEventIndicators, GET, 0, 0),
    ROW(GetContinuousStates, GET, 0, 0),
    ROW(GetNominalsOfContinuousStates, ANY & ~INITIALIZATION, 0, INITIALIZATION),
    ROW(SetRealInputDerivatives, 0, INSTANTIATED | INITIALIZATION | COMPLETE, FAILED),
    ROW(GetRealOutputDerivatives, 0, COMPLETE | FAILED | TERMINATED, 0),
    ROW(DoStep, 0, COMPLETE, FAILED),
    ROW(CancelStep, 0, 0, 0),
    ROW(GetStatus, 0, COMPLETE | FAILED | TERMINATED, 0),
    ROW(GetRealStatus, 0, COMPLETE | FAILED | TERMINATED, 0),
    ROW(GetIntegerStatus, 0, COMPLETE | FAILED | TERMINATED, 0),
    ROW(GetBooleanStatus, 0, COMPLETE | FAILED | TERMINATED, 0),
    ROW(GetStringStatus, 0, COMPLETE | FAILED | TERMINATED, 0),
};

static void into(fmi2Component c, fmi2Type type, int mode)
{
    now = 0.0;
    if (mode == INSTANTIATED) return;
    MUST(m->f.SetupExperiment(c, fmi2True, 1e-6, 0.0, fmi2False, 0.0));
    MUST(m->f.EnterInitializationMode(c));
    if (mode == INITIALIZATION) return;
    MUST(m->f.ExitInitializationMode(c));
    if (mode == EVENT || mode == COMPLETE) return;
    if (mode == CONTINUOUS) {
        MUST(m->f.NewDiscreteStates(c, &info));
        MUST(m->f.EnterContinuousTimeMode(c));
    } else if (mode == FAILED) {
        const Variable *v = &m->all[position(m, breaking)];
        MUST(m->f.SetReal(c, &v->r, 1, &breaking_value));
        EXPECT(m->f.DoStep(c, 0.0, 100.0, fmi2True) > fmi2Warning, "the step did not fail");
        MUST(m->f.SetReal(c, &v->r, 1, &v->start));
    } else MUST(m->f.Terminate(c));
    (void)type;
}

/* From any mode to the end: a short run, whose values are all compared. A failed or ended one starts anew. */
static void finish(fmi2Component c, fmi2Type type, int mode, double *values)
{
    double x[64], dx[64];
    int i, k;
    if (mode == FAILED || mode == TERMINATED) {
        MUST(m->f.Reset(c));
        mode = INSTANTIATED;
    }
    if (mode == INSTANTIATED) {
        MUST(m->f.SetupExperiment(c, fmi2True, 1e-6, 0.0, fmi2False, 0.0));
        MUST(m->f.EnterInitializationMode(c));
    }
    if (mode <= INITIALIZATION) {
        MUST(m->f.ExitInitializationMode(c));
        mode = type == fmi2ModelExchange ? EVENT : COMPLETE;
    }
    if (mode == EVENT) {
        MUST(m->f.NewDiscreteStates(c, &info));
        MUST(m->f.EnterContinuousTimeMode(c));
    }
    for (k = 0; k < 3; k++) {
        if (type == fmi2CoSimulation) MUST(m->f.DoStep(c, 10.0 * k, 10.0, fmi2True));
        else {
            MUST(m->f.GetContinuousStates(c, x, nx));
            MUST(m->f.GetDerivatives(c, dx, nx));
            for (i = 0; i < (int)nx; i++) x[i] += 1e-4 * dx[i];
            MUST(m->f.SetTime(c, 1e-4 * (k + 1)));
            MUST(m->f.SetContinuousStates(c, x, nx));
            MUST(m->f.CompletedIntegratorStep(c, fmi2True, &flag_1, &flag_2));
        }
    }
    MUST(read_all(m, c, values));
}

static void one_call(size_t k, fmi2Type type, int mode, const double *undisturbed)
{
    HEARD(heard);
    int legal = (type == fmi2ModelExchange ? calls[k].exchange : calls[k].simulation) & mode;
    double after[1024];
    fmi2Component c = instantiate(m, type, &heard);
    fmi2Status status;
    into(c, type, mode);
    MUST(m->f.GetFMUstate(c, &saved));
    heard.errors = 0;
    status = calls[k].call(c);
    if (legal) {
        EXPECT(status <= fmi2Discard, "%s is legal in mode %d of type %d, but gave %d: %s", calls[k].name, mode, type,
               status, heard.last);
    } else if (!(calls[k].either & mode)) {
        EXPECT(status == fmi2Error, "%s is illegal in mode %d of type %d, but gave %d", calls[k].name, mode, type,
               status);
    }
    if (status == fmi2Error) EXPECT(heard.errors > 0, "%s was refused without a word", calls[k].name);
    if (status > fmi2Discard) { /* the run goes on as if nothing had been called */
        finish(c, type, mode, after);
        EXPECT(memcmp(after, undisturbed, (size_t)m->n * sizeof *after) == 0, "%s was refused in mode %d of type %d, "
               "but changed the run", calls[k].name, mode, type);
    }
    MUST(m->f.FreeFMUstate(c, &saved));
    m->f.FreeInstance(c);
}

void check_order(const Fmu *fmu, int n, char **arguments)
{
    double undisturbed[1024];
    size_t k;
    int type, i;
    m = fmu, nx = (size_t)fmu->nx;
    NEEDS(n == 2, "order INPUT VALUE");
    breaking = arguments[0], breaking_value = atof(arguments[1]);
    for (type = 0; type < 2; type++)
        for (i = 0; i < 5; i++) {
            fmi2Component c = instantiate(m, (fmi2Type)type, NULL);
            HEARD(quiet);
            if (modes[type][i] == FAILED) m->f.FreeInstance(c), c = instantiate(m, (fmi2Type)type, &quiet);
            into(c, (fmi2Type)type, modes[type][i]);
            finish(c, (fmi2Type)type, modes[type][i], undisturbed);
            m->f.FreeInstance(c);
            for (k = 0; k < sizeof calls / sizeof *calls; k++) one_call(k, (fmi2Type)type, modes[type][i], undisturbed);
        }
    printf("%d calls in %d modes\n", (int)(sizeof calls / sizeof *calls), 10);
}

/* Instances that must not come to be, and the two questions that need none. */
void check_birth(const Fmu *fmu, int n, char **arguments)
{
    HEARD(heard);
    (void)n, (void)arguments;
    m = fmu;
    EXPECT(strcmp(m->f.GetVersion(), "2.0") == 0, "version %s", m->f.GetVersion());
    EXPECT(strcmp(m->f.GetTypesPlatform(), "default") == 0, "types %s", m->f.GetTypesPlatform());
#define BORN(...) \
    { \
        fmi2Component c = m->f.Instantiate(__VA_ARGS__); \
        EXPECT(!c, "an instance came to be of " #__VA_ARGS__); \
        if (c) m->f.FreeInstance(c); \
    }
    BORN("one", fmi2CoSimulation, "{0}", "", &heard.callbacks, 0, 0)
    BORN("one", fmi2CoSimulation, NULL, "", &heard.callbacks, 0, 0)
    BORN("", fmi2CoSimulation, m->guid, "", &heard.callbacks, 0, 0)
    BORN(NULL, fmi2CoSimulation, m->guid, "", &heard.callbacks, 0, 0)
    BORN("one", (fmi2Type)7, m->guid, "", &heard.callbacks, 0, 0)
    EXPECT(heard.errors == 5, "%d of 5 refusals were told", heard.errors);
    BORN("one", fmi2CoSimulation, m->guid, "", NULL, 0, 0)
    m->f.FreeInstance(NULL);
    EXPECT(m->f.DoStep(NULL, 0.0, 1.0, 0) == fmi2Error, "a step of nothing");
    printf("refused\n");
}
