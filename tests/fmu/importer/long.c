/* What only shows after many repetitions: memory, the clock; and model exchange with an integrator of one's own. */

#include "checks.h"

#include <malloc.h>

enum { MOST = 1024 };

/* Bytes given out by malloc and not yet given back. (Its successor mallinfo2 is newer than some C libraries.) */
#pragma GCC diagnostic ignored "-Wdeprecated-declarations"
static long allocated(void)
{
    struct mallinfo i = mallinfo();
    return (long)i.uordblks + (long)i.hblkhd;
}

static long resident(void)
{
    long total, pages = 0;
    FILE *file = fopen("/proc/self/statm", "r");
    if (!file || fscanf(file, "%ld %ld", &total, &pages) != 2) pages = 0;
    if (file) fclose(file);
    return 4 * pages;
}

/* One whole life, of either interface; in many ways it ends early, or with a state saved and freed. */
static void live(const Fmu *m, long k)
{
    HEARD(heard);
    fmi2Component c = instantiate(m, k % 2 ? fmi2CoSimulation : fmi2ModelExchange, &heard);
    fmi2FMUstate state = NULL;
    double values[MOST];
    if (k % 7 == 0) {
        m->f.FreeInstance(c);
        return;
    }
    MUST(m->f.SetupExperiment(c, fmi2False, 0.0, 0.0, fmi2False, 0.0));
    MUST(m->f.EnterInitializationMode(c));
    MUST(m->f.ExitInitializationMode(c));
    MUST(m->f.GetFMUstate(c, &state));
    if (k % 2) MUST(m->f.DoStep(c, 0.0, 1.0, fmi2True));
    MUST(read_all(m, c, values));
    MUST(m->f.SetFMUstate(c, state));
    MUST(m->f.FreeFMUstate(c, &state));
    if (k % 3) MUST(m->f.Terminate(c));
    m->f.FreeInstance(c);
}

void check_cycles(const Fmu *m, int n, char **arguments)
{
    long count, k, before = 0, pages = 0;
    NEEDS(n == 1, "cycles COUNT");
    count = atol(arguments[0]);
    resident(); /* so that what it needs itself is there already */
    for (k = 0; k < count; k++) {
        if (k == count / 10) pages = resident(), before = allocated();
        live(m, k);
    }
    before = allocated() - before, pages = resident() - pages;
    printf("%ld lives: %ld bytes and %ld KB of pages more than after a tenth of them\n", count, before, pages);
    EXPECT(before == 0, "%ld bytes are not given back", before);
    EXPECT(pages <= 64, "%ld KB more are resident", pages);
}

/* Many small steps by an importer that adds them up, so that its clock is off by round-off, or multiplies. */
static void small_steps(const Fmu *m, long count, double step, int adds_up, double *found)
{
    double t = 0.0, last;
    long k;
    fmi2Component c = instantiate(m, fmi2CoSimulation, NULL);
    MUST(m->f.SetupExperiment(c, fmi2False, 0.0, 0.0, fmi2True, (double)count * step));
    MUST(m->f.EnterInitializationMode(c));
    MUST(m->f.ExitInitializationMode(c));
    for (k = 0; k < count;) {
        MUST(m->f.DoStep(c, t, step, fmi2True));
        k++;
        t = adds_up ? t + step : (double)k * step;
    }
    MUST(m->f.GetRealStatus(c, fmi2LastSuccessfulTime, &last));
    MUST(m->f.GetReal(c, m->refs, (size_t)m->nx, found));
    m->f.FreeInstance(c);
    printf("the importer's clock is off by %.3g s, the instance's by %.3g s from that\n", t - (double)count * step,
           last - t);
    EXPECT(fabs(last - t) <= 1e-14 * t, "the clocks drift apart: %.17g and %.17g s", last, t);
}

void check_drift(const Fmu *m, int n, char **arguments)
{
    double step, exact[MOST], found[MOST], bound, worst;
    long count;
    int i, adds_up;
    fmi2Component c;
    NEEDS(n == 3, "drift COUNT STEP BOUND");
    count = atol(arguments[0]), step = atof(arguments[1]), bound = atof(arguments[2]);
    c = ready(m, 1e-9);
    MUST(m->f.DoStep(c, 0.0, (double)count * step, fmi2True));
    MUST(m->f.GetReal(c, m->refs, (size_t)m->nx, exact));
    m->f.FreeInstance(c);
    for (adds_up = 0; adds_up < 2; adds_up++) {
        small_steps(m, count, step, adds_up, found);
        for (i = 0, worst = 0.0; i < m->nx; i++) /* an energy that grows without end is measured by what it became */
            worst = fmax(worst, fabs(found[i] - exact[i]) / (m->x[i].nominal + fabs(exact[i])));
        printf("%.3g off\n", worst);
        EXPECT(worst <= bound, "%.3g off", worst);
    }
}

static void rates(const Fmu *m, fmi2Component c, double t, const double *x, double *dx)
{
    MUST(m->f.SetTime(c, t));
    MUST(m->f.SetContinuousStates(c, x, (size_t)m->nx));
    MUST(m->f.GetDerivatives(c, dx, (size_t)m->nx));
}

/* Model exchange with the classical Runge-Kutta method and inputs that jump in event mode, against co-simulation. */
void check_exchange(const Fmu *m, int n, char **arguments)
{
    static const double part[4] = {0.0, 0.5, 0.5, 1.0}, weight[4] = {1 / 6.0, 1 / 3.0, 1 / 3.0, 1 / 6.0};
    double length, h, bound, x[64], k[4][64], z[64], found[MOST], other[MOST], u[MOST], worst = 0.0, t = 0.0;
    fmi2Component c = instantiate(m, fmi2ModelExchange, NULL), s = ready(m, 1e-9);
    fmi2Boolean event, over;
    fmi2EventInfo info;
    int phase, i, j, which = 0;
    long step, count;
    NEEDS(n == 3, "exchange PHASE STEP BOUND");
    length = atof(arguments[0]), h = atof(arguments[1]), bound = atof(arguments[2]), count = lround(length / h);
    MUST(m->f.SetupExperiment(c, fmi2False, 0.0, 0.0, fmi2False, 0.0));
    MUST(m->f.EnterInitializationMode(c));
    MUST(m->f.ExitInitializationMode(c));
    for (phase = 0; phase < 3; phase++) {
        if (phase) MUST(m->f.EnterEventMode(c));
        duty(m, phase, u);
        MUST(m->f.SetReal(c, m->refs + 2 * m->nx, (size_t)m->nu, u));
        MUST(m->f.SetReal(s, m->refs + 2 * m->nx, (size_t)m->nu, u));
        MUST(m->f.NewDiscreteStates(c, &info));
        EXPECT(info.valuesOfContinuousStatesChanged || phase == 0, "a jump does not restart the integrator");
        EXPECT(!info.newDiscreteStatesNeeded && !info.terminateSimulation && !info.nextEventTimeDefined, "events");
        MUST(m->f.EnterContinuousTimeMode(c));
        MUST(m->f.GetContinuousStates(c, x, (size_t)m->nx));
        for (step = 0; step < count; step++, t = length * phase + (double)step * h) {
            for (j = 0; j < 4; j++) {
                for (i = 0; i < m->nx; i++) z[i] = x[i] + (j ? part[j] * h * k[j - 1][i] : 0.0);
                rates(m, c, t + part[j] * h, z, k[j]);
            }
            for (i = 0; i < m->nx; i++)
                for (j = 0; j < 4; j++) x[i] += h * weight[j] * k[j][i];
            MUST(m->f.SetTime(c, t + h));
            MUST(m->f.SetContinuousStates(c, x, (size_t)m->nx));
            MUST(m->f.CompletedIntegratorStep(c, fmi2True, &event, &over));
            EXPECT(!event && !over, "an event out of nowhere");
        }
        MUST(m->f.DoStep(s, length * phase, length, fmi2True));
        MUST(read_all(m, c, found));
        MUST(read_all(m, s, other));
        for (i = 0; i < m->n; i++) {
            double e = fabs(found[i] - other[i]) / (m->all[i].nominal + fabs(other[i]));
            if (e > worst) worst = e, which = i;
        }
    }
    printf("%.3g between the interfaces, at %s\n", worst, m->all[which].name);
    EXPECT(worst <= bound, "the interfaces differ by %.3g at %s: %.17g and %.17g", worst, m->all[which].name,
           found[which], other[which]);
    m->f.FreeInstance(c);
    m->f.FreeInstance(s);
}
