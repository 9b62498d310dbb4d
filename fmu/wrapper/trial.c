/* Adaptive steps of the Rosenbrock method from one communication point to the next. */

/* What one communication step may cost. Counts, not clocks, so that a run ends alike on every machine. 10000
   trials take less than a second for models of some hundred equations; a long step of a stiff machine takes some
   hundred. */
#ifndef MAX_STEPS
#define MAX_STEPS 10000L       /* trials */
#endif
#define MAX_OFF_RANGE 100L     /* trials that left the range of a state, in all */
#define SMALLEST 1e-12         /* size of a trial by the length of the communication step */
#define SAFETY 0.9
#define MAX_GROWTH 5.0
#define MIN_SHRINK 0.1

/* Trials within one communication step. */
typedef struct {
    long accepted, rejected;
    long off_range;            /* rejected because a state left its range or became infinite */
    int after_rejection;       /* the last trial was rejected */
} Effort;

typedef struct {
    double reached;            /* time from the communication point that was reached */
    Effort effort;
    int worst;                 /* state that limited the last trial */
    const char *block;         /* implicit equation without a solution at the begin or the end, or NULL */
} Advance;

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
    double error[AT_LEAST_1(N_CONTROLLED)], norm = 0.0;
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

/* Counts a trial of some size whose proposal was h, and gives the next proposal; 0 when the communication step of the
   given length is not worth another trial. */
static double next_size(Effort *e, double error, double size, double h, double length)
{
    int accepted = error <= 1.0, off_range = !isfinite(error);
    double f = off_range ? 0.2 : factor(error);
    if (accepted) h = fmax(size < h ? h : 0.0, size * (e->after_rejection ? fmin(f, 1.0) : f));
    else h = size * f;
    e->after_rejection = !accepted;
    e->accepted += accepted;
    e->rejected += !accepted;
    e->off_range += off_range;
    if (e->accepted + e->rejected >= MAX_STEPS || e->off_range >= MAX_OFF_RANGE) return 0.0;
    return accepted || h >= SMALLEST * length ? h : 0.0;
}
