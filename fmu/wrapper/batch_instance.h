/* What the solver of the FMU asks of an instance, without the rest of one. */

enum { FIRST_X = 0, FIRST_U = NX, SUPPLIED = NX - 2, THROUGHPUT = NX - 1, N_CONTROLLED = NX - 1 };

typedef struct {
    int jumped;                /* an input has jumped since the last step */
    int consistent;            /* z belongs to x, u and p */
    double tolerance, h_first, h_last;
    double x[NX], z[AT_LEAST_1(NZ)], u[AT_LEAST_1(NU)], slope[AT_LEAST_1(NU)], p[AT_LEAST_1(NP)];
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

/* Whether the implicit equations have a solution; solves them where something has changed. */
static int refresh_algebra(Instance *m)
{
    if (m->s.consistent) return 1;
    refresh_constants(m);
    m->s.consistent = implicit_solve(m->s.x, m->s.z, m->s.u, m->s.p, m->c, -1) < 0;
    return m->s.consistent;
}

/* Outputs and rates; 0 where an implicit equation has no solution. */
static int refresh_outputs(Instance *m)
{
    if (m->outputs_known) return 1;
    if (!refresh_algebra(m)) return 0;
    refresh_constants(m);
    model_outputs(m->s.x, m->s.z, m->s.u, m->s.p, m->c, m->y, m->dx);
    m->outputs_known = 1;
    return 1;
}

static void changed(Instance *m)
{
    m->outputs_known = m->s.consistent = 0;
}

static int in_range(int r, double value)
{
    return isfinite(value) && value >= model_low[r] && value <= model_high[r];
}

/* The step was made in a lane: trial() finds x_new and z_new filled, and the error behind x_new. */
static void model_step(const double *x, const double *z, const double *u, const double *slope, const double *p,
                       const double *c, const double *h, double *x_new, double *z_new, double *error)
{
    (void)x, (void)z, (void)u, (void)slope, (void)p, (void)c, (void)h, (void)z_new;
    memcpy(error, x_new + NX, N_CONTROLLED * sizeof(double));
}
