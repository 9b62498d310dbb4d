/* The parts of an FMU by themselves, from its own source, given as SOURCE: each function does its work `n` times. */

#include SOURCE

#define OFFERED __attribute__((visibility("default")))

static double x[AT_LEAST_1(NX)], u[AT_LEAST_1(NU)], slope[AT_LEAST_1(NU)], p[AT_LEAST_1(NP)], c[AT_LEAST_1(NC)];
static double dx[AT_LEAST_1(NX)], x_new[AT_LEAST_1(NX)], error[AT_LEAST_1(NX)], y[AT_LEAST_1(NY)];

OFFERED void prepare(void)
{
    int i;
    for (i = 0; i < NX; i++) x[i] = model_start[FIRST_X + i];
    for (i = 0; i < NU; i++) u[i] = model_start[FIRST_U + i];
    for (i = 0; i < NP; i++) p[i] = model_start[FIRST_P + i];
    model_constants(p, c);
}

static void move(int k) { x[0] += k % 2 ? 1e-3 : -1e-3; }

OFFERED void rates(int n)
{
    int k;
    for (k = 0; k < n; k++) move(k), model_rates(x, u, p, c, dx);
}

OFFERED void steps(int n)
{
    double h = 60.0;
    int k;
    for (k = 0; k < n; k++) move(k), model_step(x, u, slope, p, c, &h, x_new, error);
}

OFFERED void outputs(int n)
{
    int k;
    for (k = 0; k < n; k++) move(k), model_outputs(x, u, p, c, y, dx);
}
