/* fuzz FACTS FIRST COUNT [LIBRARY]: random sequences of calls with random arguments, one for each seed from FIRST on.

   Whatever is called: no crash and no report of a sanitizer; a status of FMI; never fmi2OK with a value that is not
   finite; a call that is refused or discarded changes nothing and says why; a state after a step lies in its range;
   nothing is written behind the end of an array. COUNT 1 tells every call. */

#include "checks.h"

#include <signal.h>
#include <sys/time.h>
#include <unistd.h>

enum { MOST = 1024, INSTANCES = 2, STATES = 6, ROOM = 1 << 15, GUARD = 8 };

int failures;

static Fmu m;
static Random r;
static unsigned long current;
static int verbose;
static const char *calling = "nothing";
static double slowest;
static unsigned long slowest_seed, tally[2][6], steps[2];

typedef struct {
    Heard heard;
    fmi2CallbackFunctions callbacks;
    fmi2Component c;
    fmi2Type type;
    double time;                   /* what the importer believes */
} One;

static One ones[INSTANCES];
static struct {
    fmi2FMUstate state;
    int owner;
    double time;
} states[STATES];
static char bytes[ROOM], undamaged[ROOM];
static size_t size;

#define WRONG(...) \
    do { \
        if (failures++ < 40) \
            printf("seed %lu, %s: ", current, calling), printf(__VA_ARGS__), printf("\n"); \
    } while (0)

/* --- arguments ------------------------------------------------------------------------------------------------ */

static double odd(void)
{
    static const double strange[] = {NAN, INFINITY, -INFINITY, 0.0, -0.0, 1e308, -1e308, 5e-324, 1.0, -1.0, 1e-12};
    unsigned k = below(&r, 16);
    if (k < 11) return strange[k];
    return (k % 2 ? 1 : -1) * pow(10.0, -20.0 + 40.0 * uniform(&r));
}

/* Mostly a value near the variable's start, sometimes far off, sometimes nonsense. */
static double value_for(const Variable *v)
{
    unsigned k = below(&r, 100);
    double start = isfinite(v->start) ? v->start : 0.0;
    if (k < 90) return start + v->swing * (2 * uniform(&r) - 1);
    if (k < 95) return start + 1000 * v->swing * (2 * uniform(&r) - 1);
    return odd();
}

static double step_length(void)
{
    static const double lengths[] = {0.0, 1e-9, 0.01, 0.1, 1.0, 10.0, 60.0, 3600.0, 1e6, 1e9};
    unsigned k = below(&r, 48);
    if (k < 10) return lengths[k];
    return k < 45 ? 100.0 * uniform(&r) : odd();
}

static double time_for(const One *one)
{
    unsigned k = below(&r, 40);
    if (k < 36) return one->time;
    return k < 38 ? one->time * (1 + 1e-13 * uniform(&r)) + 1e-13 : odd();
}

/* Mostly a variable of the wanted kind, sometimes any, sometimes none. */
static fmi2ValueReference reference(const char *kinds, double *value)
{
    unsigned k = below(&r, 100), tries = 0;
    const Variable *v = &m.all[below(&r, (unsigned)m.n)];
    if (k == 0) {
        *value = odd();
        return below(&r, 2) ? (fmi2ValueReference)m.n + below(&r, 3) : (fmi2ValueReference)-1 - below(&r, 3);
    }
    while (k < 98 && !strchr(kinds, v->kind) && tries++ < 200) v = &m.all[below(&r, (unsigned)m.n)];
    *value = value_for(v);
    return v->r;
}

static size_t some(fmi2ValueReference *refs, double *values, const char *kinds)
{
    size_t n = below(&r, 8), i;
    if (below(&r, 20) == 0) n = below(&r, 200);
    for (i = 0; i < n; i++) refs[i] = reference(kinds, &values[i]);
    for (; i < n + GUARD; i++) values[i] = 12345.0;
    return n;
}

static void *or_null(void *pointer) { return below(&r, 100) ? pointer : NULL; }

/* --- what must hold ------------------------------------------------------------------------------------------- */

static void guarded(const double *values, size_t n)
{
    size_t i;
    for (i = n; i < n + GUARD; i++)
        if (values[i] != 12345.0) WRONG("wrote behind the end of an array of %d", (int)n);
}

static void finite_if_ok(fmi2Status status, const double *values, size_t n)
{
    size_t i;
    for (i = 0; status <= fmi2Warning && i < n; i++)
        if (!isfinite(values[i])) WRONG("fmi2OK with %g at place %d of %d", values[i], (int)i, (int)n);
}

static size_t snapshot(fmi2Component c, char *to)
{
    fmi2FMUstate state = NULL;
    size_t n = 0;
    if (m.f.GetFMUstate(c, &state) != fmi2OK || m.f.SerializedFMUstateSize(c, state, &n) != fmi2OK || n > ROOM ||
        m.f.SerializeFMUstate(c, state, to, n) != fmi2OK || m.f.FreeFMUstate(c, &state) != fmi2OK || state)
        WRONG("the state cannot be saved");
    return n;
}

/* States, inputs and parameters, where they can be read. */
static int values_of(fmi2Component c, double *values)
{
    fmi2ValueReference refs[MOST];
    size_t n = 0;
    int i;
    for (i = 0; i < m.n; i++)
        if (strchr("xup", m.all[i].kind)) refs[n++] = m.all[i].r;
    return m.f.GetReal(c, refs, n, values) == fmi2OK ? (int)n : 0;
}

static void in_range(const One *one)
{
    double x[MOST];
    int i;
    if (m.f.GetReal(one->c, m.refs, (size_t)m.nx, x) != fmi2OK) WRONG("the states of a good step cannot be read");
    else for (i = 0; i < m.nx; i++)
        if (!(x[i] >= m.x[i].low && x[i] <= m.x[i].high)) WRONG("%s = %g after a good step", m.x[i].name, x[i]);
}

static fmi2ComponentEnvironment expected_environment;

static void listen(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status, fmi2String category,
                   fmi2String message, ...)
{
    One *one = environment;
    if (environment != expected_environment) WRONG("a message for another instance");
    if (!name || !category || strncmp(category, "log", 3) != 0) WRONG("a message without name or category");
    if (!message || !*message) WRONG("an empty message");
    else if (strchr(message, '%')) WRONG("a message with a format: %.200s", message);
    if (status > fmi2Error) WRONG("a message of status %d", (int)status);
    one->heard.count++;
    if (message) snprintf(one->heard.last, sizeof one->heard.last, "%s", message);
}

/* --- calls ---------------------------------------------------------------------------------------------------- */

static fmi2Status set_real(One *one)
{
    fmi2ValueReference refs[MOST];
    double values[MOST];
    size_t n = some(refs, values, below(&r, 3) ? "u" : "uxp");
    return m.f.SetReal(one->c, n ? or_null(refs) : NULL, n, n ? or_null(values) : NULL);
}

static fmi2Status get_real(One *one)
{
    fmi2ValueReference refs[MOST];
    double values[MOST], *to;
    size_t n = some(refs, values, "xduyp");
    fmi2Status status;
    to = n ? or_null(values) : NULL;
    status = m.f.GetReal(one->c, n ? or_null(refs) : NULL, n, to);
    if (to) finite_if_ok(status, values, n);
    else if (n && status == fmi2OK) WRONG("values were read to nowhere");
    guarded(values, n);
    return status;
}

static fmi2Status do_step(One *one)
{
    double h = step_length(), t = time_for(one), began = processor_now(), took;
    fmi2Status status = m.f.DoStep(one->c, t, h, (int)below(&r, 2));
    took = processor_now() - began;
    if (took > slowest) slowest = took, slowest_seed = current;
    steps[status > fmi2Warning]++;
    if (status <= fmi2Warning) {
        one->time = t + h;
        if (!isfinite(one->time) || h < 0) WRONG("a step of %g s from %g s was done", h, t);
        in_range(one);
    }
    return status;
}

static fmi2Status input_derivatives(One *one)
{
    fmi2ValueReference refs[MOST];
    fmi2Integer order[MOST];
    double values[MOST];
    size_t n = some(refs, values, "u"), i;
    for (i = 0; i < n; i++) {
        order[i] = below(&r, 60) ? 1 : (fmi2Integer)below(&r, 5) - 2;
        if (below(&r, 50)) values[i] = 0.01 * (uniform(&r) - 0.5);
    }
    return m.f.SetRealInputDerivatives(one->c, n ? or_null(refs) : NULL, n, n ? or_null(order) : NULL,
                                       n ? or_null(values) : NULL);
}

static fmi2Status output_derivatives(One *one)
{
    fmi2ValueReference refs[MOST];
    fmi2Integer order[MOST];
    double values[MOST], *to;
    size_t n = some(refs, values, "yx"), i;
    fmi2Status status;
    for (i = 0; i < n; i++) order[i] = below(&r, 60) ? 1 : (fmi2Integer)below(&r, 5) - 2;
    to = n ? or_null(values) : NULL;
    status = m.f.GetRealOutputDerivatives(one->c, refs, n, n ? or_null(order) : NULL, to);
    if (to) finite_if_ok(status, values, n);
    guarded(values, n);
    return status;
}

static fmi2Status directional(One *one)
{
    fmi2ValueReference unknown[MOST], known[MOST];
    double along[MOST], values[MOST], *to;
    size_t n_known = some(known, along, "xup"), n = some(unknown, values, "dyx"), i;
    fmi2Status status;
    for (i = 0; i < n_known; i++)
        if (below(&r, 40)) along[i] = 2 * uniform(&r) - 1;
    to = n ? or_null(values) : NULL;
    status = m.f.GetDirectionalDerivative(one->c, n ? or_null(unknown) : NULL, n, n_known ? or_null(known) : NULL,
                                          n_known, n_known ? or_null(along) : NULL, to);
    if (to) finite_if_ok(status, values, n);
    guarded(values, n);
    return status;
}

static fmi2Status setup(One *one)
{
    double from = below(&r, 8) ? 0.0 : odd(), to = below(&r, 8) ? from + 1e5 : odd();
    double tolerance = below(&r, 8) ? pow(10.0, -8.0 * uniform(&r)) : odd();
    fmi2Status status = m.f.SetupExperiment(one->c, (int)below(&r, 2), tolerance, from, below(&r, 4) == 0, to);
    if (status <= fmi2Warning) one->time = from;
    return status;
}

static fmi2Status exchange(One *one)
{
    double values[MOST];
    size_t n = below(&r, 12) ? (size_t)m.nx : below(&r, 12), i;
    unsigned which = below(&r, 8);
    fmi2EventInfo info;
    fmi2Boolean a, b;
    double t = time_for(one);
    fmi2Status status;
    for (i = 0; i < MOST; i++) values[i] = 12345.0;
    calling = "a function of model exchange";
    switch (which) {
    case 0:
    case 1:
        status = m.f.SetTime(one->c, t);
        if (status <= fmi2Warning) one->time = t;
        return status;
    case 2:
        for (i = 0; i < n && i < (size_t)m.nx; i++) values[i] = value_for(&m.x[i]);
        return m.f.SetContinuousStates(one->c, n ? or_null(values) : NULL, n);
    case 3:
        status = m.f.GetContinuousStates(one->c, values, n);
        break;
    case 4:
        status = m.f.GetNominalsOfContinuousStates(one->c, values, n);
        break;
    case 5: return m.f.GetEventIndicators(one->c, n % 2 ? NULL : values, below(&r, 3));
    case 6:
        status = m.f.NewDiscreteStates(one->c, or_null(&info));
        if (status == fmi2OK && (info.terminateSimulation || info.newDiscreteStatesNeeded)) WRONG("an event");
        return status;
    default:
        if (below(&r, 3) == 0) return m.f.CompletedIntegratorStep(one->c, 1, or_null(&a), or_null(&b));
        status = m.f.GetDerivatives(one->c, values, n);
    }
    finite_if_ok(status, values, n);
    if (status == fmi2OK) guarded(values, n);
    return status;
}

static fmi2Status mode(One *one)
{
    switch (below(&r, 12)) {
    case 0: return m.f.EnterInitializationMode(one->c);
    case 1: return m.f.ExitInitializationMode(one->c);
    case 2: return m.f.EnterEventMode(one->c);
    case 3: return m.f.EnterContinuousTimeMode(one->c);
    case 4: return below(&r, 8) ? m.f.CancelStep(one->c) : m.f.Terminate(one->c);
    case 5:
        if (below(&r, 8)) return m.f.ExitInitializationMode(one->c);
        one->time = 0.0;
        return m.f.Reset(one->c);
    case 6: return m.f.EnterContinuousTimeMode(one->c);
    case 7: {
        static const char *const names[] = {"logStatusError", "logSolver", "nonsense", "", NULL, "logStatusWarning"};
        fmi2String chosen[3];
        size_t n = below(&r, 4), i;
        for (i = 0; i < n; i++) chosen[i] = names[below(&r, 6)];
        return m.f.SetDebugLogging(one->c, (int)below(&r, 2), n, n ? or_null(chosen) : NULL);
    }
    default: return setup(one);
    }
}

static fmi2Status status_or_other(One *one)
{
    fmi2Status s;
    fmi2Real real;
    fmi2Integer integer[2] = {(fmi2Integer)below(&r, 5), 1};
    fmi2Boolean boolean = 0;
    fmi2String text;
    /* behind the real numbers stand those that are whole */
    fmi2ValueReference refs[4] = {below(&r, 2) ? below(&r, 2) : (unsigned)m.n, 1, 99999, below(&r, 1000)};
    fmi2StatusKind kind = (fmi2StatusKind)((int)below(&r, 6) - 1);
    size_t n = below(&r, 3);
    switch (below(&r, 11)) {
    case 0: return m.f.GetStatus(one->c, kind, or_null(&s));
    case 1: return m.f.GetRealStatus(one->c, kind, or_null(&real));
    case 2: return m.f.GetIntegerStatus(one->c, kind, or_null(integer));
    case 3: return m.f.GetBooleanStatus(one->c, kind, or_null(&boolean));
    case 4: return m.f.GetStringStatus(one->c, kind, or_null(&text));
    case 5: return m.f.GetInteger(one->c, refs, n, integer);
    case 6: return m.f.SetInteger(one->c, refs, n, integer);
    case 7: return m.f.GetBoolean(one->c, refs, n, &boolean);
    case 8: return m.f.SetBoolean(one->c, refs, n, NULL);
    case 9: return m.f.GetString(one->c, NULL, n, &text);
    default: return m.f.SetString(one->c, refs, n, NULL);
    }
}

static fmi2Status save_state(One *one)
{
    unsigned k = below(&r, STATES);
    fmi2FMUstate was = states[k].state;
    fmi2Status status;
    if (was && states[k].owner != (int)(one - ones)) return fmi2OK; /* the standard: an instance's own memory only */
    status = below(&r, 30) ? m.f.GetFMUstate(one->c, &states[k].state) : m.f.GetFMUstate(one->c, NULL);
    if (status == fmi2OK) states[k].owner = (int)(one - ones), states[k].time = one->time;
    return status;
}

/* Nonsense in place of saved bytes, or saved bytes with a little damage. */
static void damage(void)
{
    unsigned k;
    if (size == 0 || below(&r, 3)) return;
    for (k = below(&r, 6); k > 0; k--) bytes[below(&r, (unsigned)size)] = (char)below(&r, 256);
}

static fmi2Status saved(One *one)
{
    unsigned k = below(&r, STATES);
    fmi2FMUstate fresh = NULL;
    fmi2Status status;
    size_t n = 0, needed;
    int foreign = states[k].state && ones[states[k].owner].type != one->type;
    switch (below(&r, 7)) {
    case 0:
    case 1:
        status = m.f.SetFMUstate(one->c, states[k].state);
        if (foreign && status == fmi2OK) WRONG("a state of the other interface was taken");
        if (status == fmi2OK) one->time = states[k].time;
        return status;
    case 2:
        if (states[k].state && states[k].owner != (int)(one - ones)) return fmi2OK;
        status = below(&r, 10) ? m.f.FreeFMUstate(one->c, &states[k].state) : m.f.FreeFMUstate(one->c, NULL);
        return status;
    case 3: return m.f.SerializedFMUstateSize(one->c, states[k].state, or_null(&n));
    case 4:
        status = m.f.SerializedFMUstateSize(one->c, states[k].state, &n);
        if (status != fmi2OK || n > ROOM) return status;
        needed = n;
        if (below(&r, 6) == 0) n = below(&r, (unsigned)n + 2);
        status = m.f.SerializeFMUstate(one->c, states[k].state, or_null(bytes), n);
        if (status == fmi2OK && n < needed) WRONG("a state was written to %d of %d bytes", (int)n, (int)needed);
        if (status == fmi2OK) memcpy(undamaged, bytes, size = needed);
        return status;
    default:
        damage();
        n = below(&r, 5) ? size : below(&r, ROOM);
        status = m.f.DeSerializeFMUstate(one->c, or_null(bytes), n, &fresh);
        if (status == fmi2OK && (size == 0 || memcmp(bytes, undamaged, size) != 0)) WRONG("a damaged state was taken");
        if (status == fmi2OK && m.f.SetFMUstate(one->c, fresh) == fmi2OK)
            if (m.f.GetRealStatus(one->c, fmi2LastSuccessfulTime, &one->time) != fmi2OK) one->time = 0.0;
        m.f.FreeFMUstate(one->c, &fresh);
        return status;
    }
}

/* --- sequences ------------------------------------------------------------------------------------------------ */

static void begin(One *one)
{
    fmi2CallbackFunctions fresh = {below(&r, 20) ? listen : NULL, calloc, free, NULL, one};
    memset(one, 0, sizeof *one);
    memcpy(&one->callbacks, &fresh, sizeof fresh);
    one->type = below(&r, 3) ? fmi2CoSimulation : fmi2ModelExchange;
    expected_environment = one;
    if (below(&r, 10) == 0) { /* one that must not come to be, or its refusal would show as a leak */
        calling = "fmi2Instantiate";
        if (m.f.Instantiate(below(&r, 2) ? "" : NULL, one->type, m.guid, NULL, &one->callbacks, 1, 1) ||
            m.f.Instantiate("one", (fmi2Type)(2 + below(&r, 9)), m.guid, "", &one->callbacks, 1, 1) ||
            m.f.Instantiate("one", one->type, below(&r, 2) ? NULL : "{}", "", &one->callbacks, 0, 1) ||
            m.f.Instantiate("one", one->type, m.guid, "", NULL, 0, 0))
            WRONG("an instance came to be");
    }
    one->c = m.f.Instantiate("one % s", one->type, m.guid, below(&r, 2) ? NULL : "file:///nowhere", &one->callbacks,
                             (int)below(&r, 2), below(&r, 3) == 0);
    if (!one->c) {
        WRONG("no instance");
        exit(1);
    }
    if (below(&r, 4)) { /* most go on to where something can happen */
        if (below(&r, 2)) set_real(one);
        setup(one);
        if (m.f.EnterInitializationMode(one->c) == fmi2OK && below(&r, 2)) set_real(one);
        m.f.ExitInitializationMode(one->c);
        if (one->type == fmi2ModelExchange && below(&r, 2)) m.f.EnterContinuousTimeMode(one->c);
    }
}

static void one_call(One *one)
{
    static const struct {
        const char *name;
        fmi2Status (*call)(One *);
        int weight;
    } calls[] = {{"fmi2SetReal", set_real, 20},
                 {"fmi2GetReal", get_real, 15},
                 {"fmi2DoStep", do_step, 25},
                 {"fmi2SetRealInputDerivatives", input_derivatives, 6},
                 {"fmi2GetRealOutputDerivatives", output_derivatives, 5},
                 {"fmi2GetDirectionalDerivative", directional, 5},
                 {"a function of model exchange", exchange, 15},
                 {"a change of mode", mode, 8},
                 {"a status or a value of another type", status_or_other, 6},
                 {"fmi2GetFMUstate", save_state, 6},
                 {"a function of saved states", saved, 10}};
    static char before[ROOM], after[ROOM];
    double values[MOST], later[MOST];
    size_t n, k = 0;
    int choice = (int)below(&r, 121), known, heard;
    fmi2Status status;
    while (choice >= calls[k].weight) choice -= calls[k++].weight;
    if (below(&r, 8) && one->type == fmi2ModelExchange && k >= 2 && k <= 4) k = 6; /* mostly its own functions */
    if (below(&r, 8) && one->type == fmi2CoSimulation && k == 6) k = 2;
    calling = calls[k].name;
    expected_environment = one;
    n = snapshot(one->c, before);
    known = k == 2 ? values_of(one->c, values) : 0;
    heard = one->heard.count;
    status = calls[k].call(one);
    if ((unsigned)status > fmi2Error) WRONG("status %d", (int)status);
    tally[one->type == fmi2CoSimulation][(unsigned)status > 5 ? 5 : status]++;
    if (verbose) printf("  %s %s: %d  %s\n", one->type ? "CS" : "ME", calling, status,
                     one->heard.count > heard ? one->heard.last : "");
    if (status == fmi2OK || status == fmi2Warning) return;
    if (one->callbacks.logger && one->heard.count == heard) WRONG("status %d without a word", (int)status);
    if (k == 2) { /* the mode may say that the step failed; all values stay */
        if (known && (values_of(one->c, later) != known || memcmp(values, later, (size_t)known * sizeof *values) != 0))
            WRONG("a refused step changed a value");
    } else if (snapshot(one->c, after) != n || memcmp(before, after, n) != 0)
        WRONG("status %d, but the state changed", status);
}

static void sequence(void)
{
    unsigned n, k, i;
    seed(&r, current);
    memset(bytes, 0, size);
    size = 0;
    for (i = 0; i < INSTANCES; i++) begin(&ones[i]);
    for (n = 10 + below(&r, 50), k = 0; k < n; k++) one_call(&ones[below(&r, 4) ? 0 : 1]);
    calling = "the end";
    for (k = 0; k < STATES; k++) {
        if (!states[k].state) continue;
        expected_environment = &ones[states[k].owner];
        if (m.f.FreeFMUstate(ones[states[k].owner].c, &states[k].state) != fmi2OK || states[k].state)
            WRONG("a state is not freed");
    }
    for (i = 0; i < INSTANCES; i++) m.f.FreeInstance(ones[i].c);
}

static void too_slow(int signal)
{
    (void)signal;
    printf("seed %lu, %s: no end within a minute of processor time\n", current, calling);
    fflush(stdout);
    _exit(1);
}

int main(int n, char **arguments)
{
    const struct itimerval minute = {{0, 0}, {60, 0}};
    unsigned long first, count;
    double began = processor_now();
    NEEDS(n == 4 || n == 5, "FACTS FIRST COUNT [LIBRARY]");
    load(&m, arguments[1], n == 5 ? arguments[4] : NULL);
    first = strtoul(arguments[2], NULL, 10), count = strtoul(arguments[3], NULL, 10);
    verbose = count == 1;
    signal(SIGPROF, too_slow);
    for (current = first; current < first + count; current++) {
        setitimer(ITIMER_PROF, &minute, NULL);
        sequence();
    }
    printf("%lu sequences in %.1f s; CS: %lu OK, %lu warnings, %lu discarded, %lu refused; ME: %lu, %lu, %lu, %lu; "
           "%lu steps done, %lu not; slowest step %.3g s (seed %lu)\n", count, processor_now() - began, tally[1][0],
           tally[1][1], tally[1][2], tally[1][3], tally[0][0], tally[0][1], tally[0][2], tally[0][3], steps[0],
           steps[1], slowest, slowest_seed);
    return failures > 0;
}
