/* The parts of an FMU by themselves, from its own source, given as SOURCE: each function does its work `n` times. */

#include SOURCE

#define OFFERED __attribute__((visibility("default")))

static double x[AT_LEAST_1(NX)], z[AT_LEAST_1(NZ)], u[AT_LEAST_1(NU)], slope[AT_LEAST_1(NU)], p[AT_LEAST_1(NP)];
static double c[AT_LEAST_1(NC)], dx[AT_LEAST_1(NX)], y[AT_LEAST_1(NY)];
static double x_new[AT_LEAST_1(NX)], z_new[AT_LEAST_1(NZ)], error[AT_LEAST_1(NX)];

OFFERED void prepare(void)
{
    int i;
    for (i = 0; i < NX; i++) x[i] = model_start[FIRST_X + i];
    for (i = 0; i < NU; i++) u[i] = model_start[FIRST_U + i];
    for (i = 0; i < NP; i++) p[i] = model_start[FIRST_P + i];
    for (i = 0; i < NZ; i++) z[i] = model_z_start[i];
    model_constants(p, c);
    implicit_solve(x, z, u, p, c, -1);
}

static void move(int k) { x[0] += k % 2 ? 1e-3 : -1e-3; }

/* The rates at a new point, its implicit equations solved from the last one. */
OFFERED void rates(int n)
{
    int k;
    for (k = 0; k < n; k++) move(k), implicit_solve(x, z, u, p, c, -1), model_rates(x, z, u, p, c, dx);
}

OFFERED void steps(int n)
{
    double h = 60.0;
    int k;
    for (k = 0; k < n; k++) move(k), model_step(x, z, u, slope, p, c, &h, x_new, z_new, error);
}

OFFERED void outputs(int n)
{
    int k;
    for (k = 0; k < n; k++) move(k), implicit_solve(x, z, u, p, c, -1), model_outputs(x, z, u, p, c, y, dx);
}
