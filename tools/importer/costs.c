/* What one right-hand side and one step of the solver cost, in seconds, by the FMU's own source, given as SOURCE:
   `rhs S`, `step S`, `outputs S`. */

#include SOURCE

#include <stdio.h>
#include <time.h>

enum { TIMES = 1000, REPEATS = 400 }; /* the least of many short windows: other work seldom fills them all */

static double now(void)
{
    struct timespec t;
    timespec_get(&t, TIME_UTC);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

#define COST(name, work)                                                       \
    do {                                                                       \
        double best = 1e9;                                                     \
        int i, k;                                                              \
        for (i = 0; i < REPEATS; i++) {                                        \
            double begun = now();                                              \
            for (k = 0; k < TIMES; k++) {                                      \
                x[0] += k % 2 ? 1e-3 : -1e-3;                                  \
                work;                                                          \
            }                                                                  \
            begun = now() - begun;                                             \
            if (begun < best) best = begun;                                    \
        }                                                                      \
        printf(name " %.9g\n", best / TIMES);                                  \
    } while (0)

int main(void)
{
    static double x[NX], u[NU + 1], slope[NU + 1], p[NP + 1], c[NC + 1], dx[NX], x_new[NX], error[NX], y[NY + 1], h = 60.0;
    int i;
    for (i = 0; i < NX; i++) x[i] = model_start[FIRST_X + i];
    for (i = 0; i < NU; i++) u[i] = model_start[FIRST_U + i];
    for (i = 0; i < NP; i++) p[i] = model_start[FIRST_P + i];
    model_constants(p, c);
    COST("rhs", model_rates(x, u, p, c, dx));
    COST("step", model_step(x, u, slope, p, c, &h, x_new, error));
    COST("outputs", model_outputs(x, u, p, c, y, dx));
    return 0;
}
