/* Adaptive steps of the Rosenbrock method from one communication point to the next. */

#ifndef MAX_STEPS
#define MAX_STEPS 10000000L    /* within one communication step */
#endif
#define MAX_REJECTIONS 80      /* in a row */
#define SAFETY 0.9
#define MAX_GROWTH 5.0
#define MIN_SHRINK 0.1

typedef struct {
    double reached;            /* time from the communication point that was reached */
    long accepted, rejected;
    int worst;                 /* state that limited the last trial */
    const char *block;         /* implicit equation without a solution at the begin or the end, or NULL */
} Walk;

/* What an error of a state is measured by. The supplied energy is measured by the energy that has crossed the boundary:
   without it a step may pass over a fast layer whose states end up right but whose energy is lost from the audit. */
static double scale(const double *x, int i)
{
    double nominal = model_nominal[FIRST_X + i];
    return i == SUPPLIED ? 0.1 * (x[THROUGHPUT] + 1e-3 * nominal) : nominal;
}

/* One trial step; its error in units of the tolerance, INFINITY when the result cannot be used. */
static double trial(const Instance *m, const double *x, const double *z, const double *u, double h, double *x_new,
                    double *z_new, int *worst)
{
    double error[N_CONTROLLED], norm = 0.0;
    int i;
    model_step(x, z, u, m->s.slope, m->s.p, m->c, &h, x_new, z_new, error);
    for (i = 0; i < NZ; i++)
        if (!isfinite(z_new[i])) return INFINITY;
    for (i = 0; i < NX; i++)
        if (!in_range(FIRST_X + i, x_new[i])) {
            *worst = i;
            return INFINITY;
        }
    for (i = 0; i < N_CONTROLLED; i++) {
        double e = fabs(error[i]) / (m->s.tolerance * scale(x_new, i));
        if (!(e <= 1e12)) {
            *worst = i;
            return INFINITY;
        }
        if (e > norm) {
            norm = e;
            *worst = i;
        }
    }
    return norm;
}

/* Factor to the next step size for an error in units of the tolerance. */
static double factor(double error)
{
    double f = error > 0.0 ? SAFETY * pow(error, -1.0 / ORDER) : MAX_GROWTH;
    return f > MAX_GROWTH ? MAX_GROWTH : f < MIN_SHRINK ? MIN_SHRINK : f;
}
