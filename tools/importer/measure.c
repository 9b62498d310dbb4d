/* measure FACTS INPUT: what calls cost, in seconds, and a warm-up of 330 min in five stages of one input.

   Lines: `call S` four inputs, a step of 1 s and fifteen outputs, `state BYTES`, and for each communication step `warmup STEP S` followed by the states at the ends of the stages. */

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "importer.h"

enum { CALLS = 500, REPEATS = 100, RUNS = 8, STAGES = 5, MOST = 64 };
static const double parts[STAGES] = {0.4, 0.6, 0.8, 1.0, 0.2};
#define STAGE 3960.0

static double least(double a, double b)
{
    return a < b ? a : b;
}

static double call(const Fmu *m)
{
    fmi2ValueReference in[4], out[15];
    double u[4], y[15], t = 0.0, best = 1e9, begun;
    fmi2Component c = ready(m, 0.0);
    int k, i, nu = m->nu < 4 ? m->nu : 4, ny = m->ny < 15 ? m->ny : 15;
    for (i = 0; i < nu; i++) in[i] = m->u[i].r, u[i] = m->u[i].start;
    for (i = 0; i < ny; i++) out[i] = m->y[i].r;
    for (i = 0; i < REPEATS; i++) {
        begun = clock_now();
        for (k = 0; k < CALLS; k++, t += 1.0) {
            MUST(m->f.SetReal(c, in, (size_t)nu, u));
            MUST(m->f.DoStep(c, t, 1.0, fmi2True));
            MUST(m->f.GetReal(c, out, (size_t)ny, y));
        }
        best = least(best, clock_now() - begun);
    }
    m->f.FreeInstance(c);
    return best / CALLS;
}

static void warmup(const Fmu *m, int input, double step)
{
    fmi2ValueReference x[MOST];
    double values[STAGES][MOST], best = 1e9, begun, u, t, end;
    int i, k;
    for (i = 0; i < m->nx; i++) x[i] = m->x[i].r;
    for (i = 0; i < RUNS; i++) {
        fmi2Component c = ready(m, 0.0);
        begun = clock_now();
        for (k = 0, t = 0.0; k < STAGES; k++) {
            u = parts[k] * m->all[input].start;
            MUST(m->f.SetReal(c, &m->all[input].r, 1, &u));
            for (end = (k + 1) * STAGE; t < end - 0.5 * step; t += step) MUST(m->f.DoStep(c, t, step, fmi2True));
            MUST(m->f.GetReal(c, x, (size_t)m->nx, values[k]));
        }
        best = least(best, clock_now() - begun);
        m->f.FreeInstance(c);
    }
    printf("warmup %g %.9g", step, best);
    for (k = 0; k < STAGES; k++)
        for (i = 0; i < m->nx; i++) printf(" %.17g", values[k][i]);
    printf("\n");
}

int main(int n, char **arguments)
{
    static const double steps[] = {1.0, 10.0, 60.0};
    fmi2FMUstate state = NULL;
    fmi2Component c;
    size_t size;
    Fmu m;
    int k;
    if (n != 3) {
        fprintf(stderr, "measure FACTS INPUT\n");
        return 2;
    }
    load(&m, arguments[1], NULL);
    c = ready(&m, 0.0);
    MUST(m.f.GetFMUstate(c, &state));
    MUST(m.f.SerializedFMUstateSize(c, state, &size));
    MUST(m.f.FreeFMUstate(c, &state));
    m.f.FreeInstance(c);
    printf("call %.9g\nstate %lu\n", call(&m), (unsigned long)size);
    for (k = 0; k < 3; k++) warmup(&m, position(&m, arguments[2]), steps[k]);
    return 0;
}
