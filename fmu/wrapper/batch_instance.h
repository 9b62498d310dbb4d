/* What the solver of the FMU asks of an instance, without the rest of one. */

enum { FIRST_X = 0, FIRST_U = NX, SUPPLIED = NX - 2, THROUGHPUT = NX - 1, N_CONTROLLED = NX - 1 };

typedef struct {
    int jumped;                /* an input has jumped since the last step */
    double tolerance, h_first, h_last;
    double x[NX], u[AT_LEAST_1(NU)], slope[AT_LEAST_1(NU)], p[AT_LEAST_1(NP)];
} State;

typedef struct {
    State s;
    int constants_known;       /* c belongs to s.p */
    int outputs_known;         /* y and dx belong to s */
    double c[AT_LEAST_1(NC)], y[NY], dx[NX];
} Instance;

static void refresh_constants(Instance *m)
{
    if (m->constants_known) return;
    model_constants(m->s.p, m->c);
    m->constants_known = 1;
}

static void refresh_outputs(Instance *m)
{
    if (m->outputs_known) return;
    refresh_constants(m);
    model_outputs(m->s.x, m->s.u, m->s.p, m->c, m->y, m->dx);
    m->outputs_known = 1;
}

static int in_range(int r, double value)
{
    return isfinite(value) && value >= model_low[r] && value <= model_high[r];
}

/* The step was made in a lane: trial() finds x_new filled, and the error behind it. */
static void model_step(const double *x, const double *u, const double *slope, const double *p, const double *c,
                       const double *h, double *x_new, double *error)
{
    (void)x, (void)u, (void)slope, (void)p, (void)c, (void)h;
    memcpy(error, x_new + NX, N_CONTROLLED * sizeof(double));
}
