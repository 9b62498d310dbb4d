/* duties FACTS FIRST COUNT [LIBRARY]: random duties of a machine, one for each seed from FIRST on.

   Inputs jump, ramp, lie on and beyond the ends of their ranges, are zero, infinite or no number; states start anywhere
   in their ranges. Whatever is asked for: a communication step takes less than a second of processor time; after
   fmi2OK every variable is finite and in its declared range; a refused step changes nothing, says why, and is an error
   when it is asked for again. */

#include "checks.h"

enum { MOST = 1024, STEPS = 8 };

int failures;

static Fmu m;
static Random r;
static unsigned long current, done, refused[5], begun;
static double slowest;

#define WRONG(...) \
    do { \
        if (failures++ < 40) printf("seed %lu: ", current), printf(__VA_ARGS__), printf("\n"); \
    } while (0)

/* Mostly near the start, often on an end of the range or far out, sometimes what no machine can take. */
static double value_for(const Variable *v)
{
    static const double strange[] = {NAN, INFINITY, -INFINITY, 0.0, 1e300, -1e300, 1e-300};
    double start = isfinite(v->start) ? v->start : 0.0, u = 2 * uniform(&r) - 1;
    switch (below(&r, 16)) {
    case 0: return isfinite(v->low) ? v->low : -1e3 * v->nominal;
    case 1: return isfinite(v->high) ? v->high : 1e3 * v->nominal;
    case 2: return isfinite(v->low) ? v->low - fabs(u) * v->nominal : -1e6 * v->nominal;
    case 3: return strange[below(&r, 7)];
    case 4: return 0.0;
    case 5: return start + 100 * u * v->swing;
    case 6: return -start;
    default: return start + 5 * u * v->swing;
    }
}

static double step_length(void)
{
    static const double lengths[] = {1e-3, 0.1, 1.0, 10.0, 60.0, 60.0, 600.0, 3600.0, 86400.0, 1e6};
    return lengths[below(&r, 10)];
}

/* States, inputs and parameters. */
static size_t knowns(fmi2Component c, double *values)
{
    fmi2ValueReference refs[MOST];
    size_t n = 0;
    int i;
    for (i = 0; i < m.n; i++)
        if (strchr("xup", m.all[i].kind)) refs[n++] = m.all[i].r;
    if (m.f.GetReal(c, refs, n, values) != fmi2OK) WRONG("the knowns cannot be read");
    return n;
}

static void all_in_range(fmi2Component c)
{
    double values[MOST];
    int i;
    if (read_all(&m, c, values) != fmi2OK) {
        WRONG("a variable cannot be read after a good step");
        return;
    }
    for (i = 0; i < m.n; i++)
        if (!(isfinite(values[i]) && values[i] >= m.all[i].low && values[i] <= m.all[i].high))
            WRONG("%s = %.17g after a good step, its range is %g .. %g", m.all[i].name, values[i], m.all[i].low,
                  m.all[i].high);
}

static fmi2Status timed_step(fmi2Component c, double time, double step)
{
    double began = processor_now(), took;
    fmi2Status status = m.f.DoStep(c, time, step, fmi2True);
    took = processor_now() - began;
    if (took > slowest) slowest = took;
    if (took > 1.0) WRONG("a step of %g s took %.3g s", step, took);
    return status;
}

static void set(fmi2Component c, const Variable *v, double value) { m.f.SetReal(c, &v->r, 1, &value); }

static fmi2Component prepared(Heard *heard)
{
    fmi2Component c = instantiate(&m, fmi2CoSimulation, heard);
    int i;
    MUST(m.f.SetupExperiment(c, (int)below(&r, 2), pow(10.0, -3.0 - 3.0 * uniform(&r)), 0.0, fmi2False, 0.0));
    MUST(m.f.EnterInitializationMode(c));
    for (i = 0; i < m.nu; i++)
        if (below(&r, 4) == 0) {
            double value = value_for(&m.u[i]);
            MUST(m.f.SetReal(c, &m.u[i].r, 1, &value));
            if (!(value >= m.u[i].low && value <= m.u[i].high)) set(c, &m.u[i], m.u[i].start); /* else it cannot begin */
        }
    for (i = 0; i < m.nu; i++)
        if (strcmp(m.u[i].name, "room.T") == 0 && below(&r, 2)) {
            double zero = 0.0;
            MUST(m.f.SetReal(c, &m.u[i].r, 1, &zero));
        }
    for (i = 0; i < m.nx; i++)
        if (below(&r, 8) == 0) set(c, &m.x[i], value_for(&m.x[i]));
    if (m.f.ExitInitializationMode(c) == fmi2OK) return c;
    m.f.FreeInstance(c);
    return NULL;
}

static void refused_well(fmi2Component c, const Heard *heard, int heard_before, const double *before, double time,
                         double step, fmi2Status status)
{
    double after[MOST];
    size_t n = knowns(c, after);
    if (memcmp(before, after, n * sizeof *after) != 0) WRONG("a refused step changed a value");
    if (status != fmi2Discard && status != fmi2Error) WRONG("status %d", (int)status);
    if (heard->count == heard_before) WRONG("refused without a word");
    if (timed_step(c, time, step) != fmi2Error) WRONG("the same step again is no error");
}

static void run(void)
{
    HEARD(heard);
    fmi2Component c = prepared(&heard);
    double time = 0.0, before[MOST];
    fmi2Integer first = 1;
    int k, i;
    if (!c) return;
    begun++;
    for (k = 0; k < STEPS; k++) {
        double step = step_length(), slope;
        fmi2Status status;
        int told;
        for (i = 0; i < m.nu; i++) {
            slope = below(&r, 12) ? 0.0 : m.u[i].swing * (2 * uniform(&r) - 1) / step;
            if (below(&r, 3) == 0) set(c, &m.u[i], value_for(&m.u[i]));
            MUST(m.f.SetRealInputDerivatives(c, &m.u[i].r, 1, &first, &slope));
        }
        knowns(c, before);
        told = heard.count;
        status = timed_step(c, time, step);
        refused[status > fmi2Error ? 4 : status]++;
        if (status == fmi2OK) {
            time += step;
            done++;
            all_in_range(c);
        } else {
            refused_well(c, &heard, told, before, time, step, status);
            for (i = 0; i < m.nu; i++) set(c, &m.u[i], m.u[i].start);
        }
    }
    m.f.FreeInstance(c);
}

int main(int n, char **arguments)
{
    unsigned long first, count;
    double began = processor_now();
    NEEDS(n == 4 || n == 5, "FACTS FIRST COUNT [LIBRARY]");
    load(&m, arguments[1], n == 5 ? arguments[4] : NULL);
    first = strtoul(arguments[2], NULL, 10), count = strtoul(arguments[3], NULL, 10);
    for (current = first; current < first + count; current++) {
        seed(&r, current);
        run();
    }
    printf("%lu duties begun of %lu, %lu steps done, %lu discarded, %lu errors, slowest %.3g s, %.1f s in all\n", begun,
           count, done, refused[fmi2Discard], refused[fmi2Error], slowest, processor_now() - began);
    return failures > 0;
}
