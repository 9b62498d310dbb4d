/* Directional derivatives of every unknown along every known, against differences, in every mode that has them; tells
   the pairs where one depends on the other. */

#include "checks.h"

enum { MOST = 512 };

static const Fmu *m;
static fmi2ValueReference unknown[MOST];
static int n_unknown;

/* Unknowns when one known is moved; only initialization mode lets everything be set. */
static void moved(fmi2Component c, const Variable *known, double value, double *to)
{
    MUST(m->f.SetReal(c, &known->r, 1, &value));
    MUST(m->f.GetReal(c, unknown, (size_t)n_unknown, to));
}

/* Central differences of two sizes, the better value they give together, and how much it may be off. */
static void differences(fmi2Component c, const Variable *known, double *value, double *doubt)
{
    double sides[4][MOST], middle[MOST], at, size;
    int i;
    MUST(m->f.GetReal(c, &known->r, 1, &at));
    size = 1e-4 * (fabs(at) > 0 ? fabs(at) : known->nominal);
    moved(c, known, at + size, sides[0]), moved(c, known, at - size, sides[1]);
    moved(c, known, at + size / 2, sides[2]), moved(c, known, at - size / 2, sides[3]);
    moved(c, known, at, middle);
    for (i = 0; i < n_unknown; i++) {
        double wide = (sides[0][i] - sides[1][i]) / (2 * size), narrow = (sides[2][i] - sides[3][i]) / size;
        value[i] = (4 * narrow - wide) / 3;
        doubt[i] = fabs(wide - narrow) + 1e-14 * (fabs(middle[i]) + fabs(sides[0][i])) / size;
    }
}

/* The modes in which the same point must give the same derivatives: both interfaces, initialization and behind it. */
static fmi2Component into(fmi2Type type, int behind, const double *known, int n)
{
    fmi2Component c = instantiate(m, type, NULL);
    fmi2ValueReference refs[MOST];
    int i, k = 0;
    for (i = 0; i < m->n; i++)
        if (strchr("xup", m->all[i].kind)) refs[k++] = m->all[i].r;
    MUST(m->f.SetupExperiment(c, fmi2False, 0.0, 0.0, fmi2False, 0.0));
    MUST(m->f.EnterInitializationMode(c));
    MUST(m->f.SetReal(c, refs, (size_t)n, known));
    if (behind) MUST(m->f.ExitInitializationMode(c));
    if (behind > 1) MUST(m->f.EnterContinuousTimeMode(c));
    return c;
}

void check_slopes(const Fmu *fmu, int n, char **arguments)
{
    double value[MOST], doubt[MOST], found[MOST], again[MOST], point[MOST], one = 1.0;
    fmi2Component c, others[4];
    int i, j, k, known = 0;
    Random r;
    (void)n, (void)arguments;
    m = fmu;
    seed(&r, 6);
    for (i = 0; i < m->n; i++) {
        const Variable *v = &m->all[i];
        if (strchr("yd", v->kind)) unknown[n_unknown++] = v->r;
        else {
            double moved_by = (v->kind == 'p' ? 0.02 : 1.0) * v->swing * uniform(&r);
            point[known++] = fmin(fmax(v->start + moved_by, v->low), v->high);
        }
    }
    c = into(fmi2CoSimulation, 0, point, known);
    others[0] = into(fmi2CoSimulation, 1, point, known), others[1] = into(fmi2ModelExchange, 0, point, known);
    others[2] = into(fmi2ModelExchange, 1, point, known), others[3] = into(fmi2ModelExchange, 2, point, known);
    for (i = 0; i < m->n; i++) {
        const Variable *v = &m->all[i];
        if (strchr("yd", v->kind)) continue;
        MUST(m->f.GetDirectionalDerivative(c, unknown, (size_t)n_unknown, &v->r, 1, &one, found));
        for (j = 0; j < 4; j++) {
            MUST(m->f.GetDirectionalDerivative(others[j], unknown, (size_t)n_unknown, &v->r, 1, &one, again));
            EXPECT(memcmp(found, again, (size_t)n_unknown * sizeof *found) == 0, "along %s modes differ", v->name);
        }
        if (v->swing > 0) differences(c, v, value, doubt);
        for (k = 0; k < n_unknown; k++) {
            double e = fabs(found[k] - value[k]), scale = fabs(value[k]) + doubt[k];
            const char *name = "";
            for (j = 0; j < m->n; j++)
                if (m->all[j].r == unknown[k]) name = m->all[j].name;
            if (strstr(name, "residual")) continue; /* nothing but round-off */
            if (v->swing > 0) EXPECT(e <= 1e-6 * scale + 10 * doubt[k], "d %s / d %s is %.12g, differences give %.12g (doubt %.2g)", name,
                   v->name, found[k], value[k], doubt[k]);
            if (found[k] != 0.0) printf("%s %s\n", name, v->name);
        }
    }
    m->f.FreeInstance(c);
    for (j = 0; j < 4; j++) m->f.FreeInstance(others[j]);
}
