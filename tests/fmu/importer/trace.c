/* A run with every kind of result told in hexadecimal, to compare binaries of the same model. */

#include "checks.h"

enum { MOST = 1024 };

static void line(const char *what, const double *values, int n)
{
    int i;
    printf("%s", what);
    for (i = 0; i < n; i++) printf(" %a", values[i]);
    printf("\n");
}

void check_trace(const Fmu *m, int n, char **arguments)
{
    static const double steps[] = {0.01, 1.0, 7.5, 60.0, 600.0};
    fmi2Integer order[MOST];
    double t = 0.0, values[MOST], direction[MOST];
    fmi2Component c = ready(m, 0.0);
    int k, i;
    (void)n, (void)arguments;
    for (i = 0; i < MOST; i++) order[i] = 1, direction[i] = 0.1 * (i + 1);
    for (k = 0; k < 60; k++) {
        MUST(advance(m, c, &t, steps[k % 5], k, k % 2));
        MUST(read_all(m, c, values));
        line("values", values, m->n);
        MUST(m->f.GetRealOutputDerivatives(c, m->refs + 2 * m->nx + m->nu, (size_t)m->ny, order, values));
        line("slopes", values, m->ny);
        MUST(m->f.GetDirectionalDerivative(c, m->refs + m->nx, (size_t)m->nx, m->refs + 2 * m->nx + m->nu + m->ny,
                                           (size_t)m->np, direction, values));
        line("along", values, m->nx);
    }
    m->f.FreeInstance(c);
    c = instantiate(m, fmi2ModelExchange, NULL);
    MUST(m->f.SetupExperiment(c, fmi2False, 0.0, 0.0, fmi2False, 0.0));
    MUST(m->f.EnterInitializationMode(c));
    MUST(m->f.ExitInitializationMode(c));
    MUST(m->f.GetDerivatives(c, values, (size_t)m->nx));
    line("rates", values, m->nx);
    m->f.FreeInstance(c);
}
