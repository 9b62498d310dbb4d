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
} Walk;

/* What an error of a state is measured by. The supplied energy is measured by the energy that has crossed the boundary:
   without it a step may pass over a fast layer whose states end up right but whose energy is lost from the audit. */
static double scale(const double *x, int i)
{
    double nominal = model_nominal[FIRST_X + i];
    return i == SUPPLIED ? 0.1 * (x[THROUGHPUT] + 1e-3 * nominal) : nominal;
}

/* One trial step; its error in units of the tolerance, INFINITY when the result cannot be used. */
static double trial(const Instance *m, const double *x, const double *u, double h, double *x_new, int *worst)
{
    double error[N_CONTROLLED], norm = 0.0;
    int i;
    model_step(x, u, m->s.slope, m->s.p, m->c, &h, x_new, error);
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

/* Walk over a communication step. With success the state is that at its end, else it is as before. A held input that
   jumps makes a boundary layer behind the communication point, so the size that fitted there last time is remembered
   beside the size that fitted at the end. */
static int walk(Instance *m, double length, Walk *w)
{
    State *s = &m->s;
    double x[AT_LEAST_1(NX)], x_new[AT_LEAST_1(NX)], u[AT_LEAST_1(NU)];
    double t = 0.0, first = 0.0, h = s->jumped ? s->h_first : s->h_last;
    int in_a_row = 0, i;
    memset(w, 0, sizeof *w);
    refresh_constants(m);
    memcpy(x, s->x, sizeof x);
    memcpy(u, s->u, sizeof u);
    if (!(h > 0.0)) h = length;
    while (t < length) {
        double left = length - t;
        int last = h * (1 + 1e-9) >= left;
        double size = last ? left : 2 * h > left ? left / 2 : h;
        double error = trial(m, x, u, size, x_new, &w->worst);
        if (w->accepted + w->rejected > MAX_STEPS) return 0;
        if (!(error <= 1.0)) {
            w->rejected++;
            h = size * (isfinite(error) ? factor(error) : 0.2);
            if (++in_a_row > MAX_REJECTIONS || t + h == t) return 0;
            continue;
        }
        w->accepted++;
        t = last ? length : t + size;
        memcpy(x, x_new, sizeof x);
        for (i = 0; i < NU; i++) u[i] = s->u[i] + s->slope[i] * t;
        h = fmax(size < h ? h : 0.0, size * (in_a_row ? fmin(factor(error), 1.0) : factor(error)));
        if (first == 0.0) first = h;
        in_a_row = 0;
        w->reached = t;
    }
    memcpy(s->x, x, sizeof x);
    memcpy(s->u, u, sizeof u);
    s->h_first = first;
    s->h_last = h;
    s->jumped = 0;
    return 1;
}
