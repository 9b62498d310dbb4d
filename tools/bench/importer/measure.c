/* measure COSTS                what the parts of an FMU cost, by the library of costs.c
   measure COSTS FACTS          and what four hours in steps of a minute cost, all outputs read after each
   measure COSTS FACTS INPUT    and what calls of the FMU and a warm-up of 330 min in five stages of one input cost

   All costs are taken by turns and the least of many turns counts, so that a busy moment of the machine meets all of
   them. Lines: `rhs S`, `step S`, `outputs S`; `run S`, the four hours; `call S` (four inputs, a step of 1 s, fifteen
   outputs), `jump S` (a step of 60 s behind a jump of the input), `warmup STEP S` followed by the states at the ends of the stages, `state BYTES`, `instance BYTES` (where the
   system tells). */

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "importer.h"

enum { TURNS = 15, TIMES = 10000, CALLS = 4000, JUMPS = 400, STAGES = 5, MOST = 64, MANY = 2000, LENGTHS = 3 };
static const double parts[STAGES] = {0.4, 0.6, 0.8, 1.0, 0.2}, lengths[LENGTHS] = {1.0, 10.0, 60.0};
#define STAGE 3960.0
#define RUN 14400.0

static void keep_least(double *least, double seconds)
{
    if (*least == 0.0 || seconds < *least) *least = seconds;
}

static void part(const char *library, const char *name, double *least)
{
    void *found = function(library, name);
    void (*work)(int);
    double begun;
    memcpy(&work, &found, sizeof found);
    begun = processor_now();
    work(TIMES);
    keep_least(least, (processor_now() - begun) / TIMES);
}

static void call(const Fmu *m, double *least)
{
    fmi2ValueReference in[4], out[15];
    double u[4], y[15], t = 0.0, begun;
    fmi2Component c = ready(m, 0.0);
    int k, i, nu = m->nu < 4 ? m->nu : 4, ny = m->ny < 15 ? m->ny : 15;
    for (i = 0; i < nu; i++) in[i] = m->u[i].r, u[i] = m->u[i].start;
    for (i = 0; i < ny; i++) out[i] = m->y[i].r;
    begun = processor_now();
    for (k = 0; k < CALLS; k++, t += 1.0) {
        MUST(m->f.SetReal(c, in, (size_t)nu, u));
        MUST(m->f.DoStep(c, t, 1.0, fmi2True));
        MUST(m->f.GetReal(c, out, (size_t)ny, y));
    }
    keep_least(least, (processor_now() - begun) / CALLS);
    m->f.FreeInstance(c);
}

static void jump(const Fmu *m, int input, double *least)
{
    double u, begun;
    fmi2Component c = ready(m, 0.0);
    int k;
    begun = processor_now();
    for (k = 0; k < JUMPS; k++) {
        u = parts[k % STAGES] * m->all[input].start;
        MUST(m->f.SetReal(c, &m->all[input].r, 1, &u));
        MUST(m->f.DoStep(c, 60.0 * k, 60.0, fmi2True));
    }
    keep_least(least, (processor_now() - begun) / JUMPS);
    m->f.FreeInstance(c);
}

static void run(const Fmu *m, double *least)
{
    double *y = malloc((size_t)m->ny * sizeof *y), t, begun;
    fmi2Component c = ready(m, 0.0);
    begun = processor_now();
    for (t = 0.0; t < RUN; t += 60.0) {
        MUST(m->f.DoStep(c, t, 60.0, fmi2True));
        MUST(m->f.GetReal(c, m->refs + 2 * m->nx + m->nu, (size_t)m->ny, y));
    }
    keep_least(least, processor_now() - begun);
    m->f.FreeInstance(c);
    free(y);
}

static void warmup(const Fmu *m, int input, double step, double values[STAGES][MOST], double *least)
{
    fmi2ValueReference x[MOST];
    double begun, u, t = 0.0, end;
    fmi2Component c = ready(m, 0.0);
    int i, k;
    for (i = 0; i < m->nx; i++) x[i] = m->x[i].r;
    begun = processor_now();
    for (k = 0; k < STAGES; k++) {
        u = parts[k] * m->all[input].start;
        MUST(m->f.SetReal(c, &m->all[input].r, 1, &u));
        for (end = (k + 1) * STAGE; t < end - 0.5 * step; t += step) MUST(m->f.DoStep(c, t, step, fmi2True));
        MUST(m->f.GetReal(c, x, (size_t)m->nx, values[k]));
    }
    keep_least(least, processor_now() - begun);
    m->f.FreeInstance(c);
}

static long resident(void)
{
    long total, pages = 0;
    FILE *file = fopen("/proc/self/statm", "r");
    if (file && fscanf(file, "%ld %ld", &total, &pages) != 2) pages = 0;
    if (file) fclose(file);
    return 4096 * pages;
}

static void memory(const Fmu *m)
{
    static fmi2Component many[MANY];
    fmi2FMUstate state = NULL;
    size_t size;
    long before;
    int k;
    many[0] = ready(m, 0.0);
    MUST(m->f.GetFMUstate(many[0], &state));
    MUST(m->f.SerializedFMUstateSize(many[0], state, &size));
    MUST(m->f.FreeFMUstate(many[0], &state));
    before = resident();
    for (k = 1; k < MANY; k++) many[k] = ready(m, 0.0);
    printf("state %lu\n", (unsigned long)size);
    if (before) printf("instance %ld\n", (resident() - before) / (MANY - 1));
    for (k = 0; k < MANY; k++) m->f.FreeInstance(many[k]);
}

int main(int n, char **arguments)
{
    static double values[LENGTHS][STAGES][MOST];
    double rhs = 0.0, step = 0.0, outputs = 0.0, hours = 0.0, calls = 0.0, jumps = 0.0, stages[LENGTHS] = {0.0};
    void (*prepare)(void), *found;
    int turn, k, i, j, input = 0;
    Fmu m = {0};
    if (n < 2 || n > 4) {
        fprintf(stderr, "measure COSTS [FACTS [INPUT]]\n");
        return 2;
    }
    found = function(arguments[1], "prepare");
    memcpy(&prepare, &found, sizeof found);
    prepare();
    if (n > 2) load(&m, arguments[2], NULL);
    if (n > 3) input = position(&m, arguments[3]);
    for (turn = 0; turn < TURNS; turn++) {
        part(arguments[1], "rates", &rhs);
        part(arguments[1], "steps", &step);
        part(arguments[1], "outputs", &outputs);
        if (n == 3) run(&m, &hours);
        if (n < 4) continue;
        call(&m, &calls);
        jump(&m, input, &jumps);
        for (k = 0; k < LENGTHS; k++) warmup(&m, input, lengths[k], values[k], &stages[k]);
    }
    printf("rhs %.9g\nstep %.9g\noutputs %.9g\n", rhs, step, outputs);
    if (n == 3) printf("run %.9g\n", hours);
    if (n < 4) return 0;
    printf("call %.9g\njump %.9g\n", calls, jumps);
    for (k = 0; k < LENGTHS; k++) {
        printf("warmup %g %.9g", lengths[k], stages[k]);
        for (j = 0; j < STAGES; j++)
            for (i = 0; i < m.nx; i++) printf(" %.17g", values[k][j][i]);
        printf("\n");
    }
    memory(&m);
    return 0;
}
