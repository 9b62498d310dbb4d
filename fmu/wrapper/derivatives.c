/* Derivatives in a direction: fmi2GetDirectionalDerivative and the output derivatives of co-simulation. */

typedef struct {
    double x[AT_LEAST_1(NX)], u[AT_LEAST_1(NU)], p[AT_LEAST_1(NP)];
} Direction;

typedef struct {
    double y[AT_LEAST_1(NY)], dx[AT_LEAST_1(NX)];
} Slopes;

/* Derivatives along d; 0 where the implicit equations have no solution. */
static int derive(Instance *m, const Direction *d, int parameters_move, Slopes *out)
{
    double c_dot[AT_LEAST_1(NC)];
    memset(c_dot, 0, sizeof c_dot);
    refresh_constants(m);
    if (unsolved(m)) return 0;
    if (parameters_move) model_constants_directional(m->s.p, d->p, c_dot);
    model_directional(m->s.x, m->z, m->s.u, m->s.p, m->c, d->x, d->u, d->p, c_dot, out->y, out->dx);
    return 1;
}

static double slope_of(const Direction *d, const Slopes *s, fmi2ValueReference r)
{
    if (r < FIRST_U) return d->x[r - FIRST_X];
    return r < FIRST_P ? s->y[r - FIRST_Y] : s->dx[r - FIRST_DX];
}

/* Of a standard deviation no slope is known. */
static int without_slope(const Instance *m, const fmi2ValueReference r[], size_t n, const char *function)
{
    size_t i;
    for (i = 0; i < n; i++)
        if (NSD > 0 && r[i] >= FIRST_SD) {
            discard(m, "%s: of %s no derivative is known.", function, model_names[r[i]]);
            return 1;
        }
    return 0;
}

static int is_calculated(fmi2ValueReference r)
{
    return r < FIRST_U || (r >= FIRST_Y && r < FIRST_P) || (r >= FIRST_DX && r < FIRST_CHOICE) || r >= FIRST_SD;
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknown[], size_t n_unknown,
                                        const fmi2ValueReference known[], size_t n_known, const fmi2Real d_known[],
                                        fmi2Real d_unknown[])
{
    static const char f[] = "fmi2GetDirectionalDerivative";
    Instance *m = c;
    Direction d;
    Slopes s;
    int parameters_move = 0;
    size_t i;
    if (!allowed(m, GETTABLE, f)) return fmi2Error;
    if (missing(m, unknown, n_unknown, f) || missing(m, d_unknown, n_unknown, f)) return fmi2Error;
    if (missing(m, known, n_known, f) || missing(m, d_known, n_known, f)) return fmi2Error;
    if (!known_references(m, unknown, n_unknown, f) || !known_references(m, known, n_known, f)) return fmi2Error;
    if (without_slope(m, unknown, n_unknown, f)) return fmi2Discard;
    memset(&d, 0, sizeof d);
    for (i = 0; i < n_known; i++) {
        fmi2ValueReference r = known[i];
        if (!isfinite(d_known[i])) return refuse(m, "%s: %g along %s is not finite.", f, d_known[i], model_names[r]);
        if (r < FIRST_U) d.x[r - FIRST_X] += d_known[i];
        else if (r < FIRST_Y) d.u[r - FIRST_U] += d_known[i];
        else if (r >= FIRST_P && r < FIRST_DX) d.p[r - FIRST_P] += d_known[i], parameters_move = 1;
        else return refuse(m, "%s: %s is calculated, so it is no known.", f, model_names[r]);
    }
    for (i = 0; i < n_unknown; i++)
        if (!is_calculated(unknown[i]))
            return refuse(m, "%s: %s is given, so it is no unknown.", f, model_names[unknown[i]]);
    if (!derive(m, &d, parameters_move, &s))
        return discard(m, "%s: the equation \"%s\" has no solution at t = %.10g s.", f, unsolved(m), m->s.time);
    for (i = 0; i < n_unknown; i++) {
        d_unknown[i] = slope_of(&d, &s, unknown[i]);
        if (!isfinite(d_unknown[i]))
            return discard(m, "%s: the derivative of %s is not finite.", f, model_names[unknown[i]]);
    }
    return fmi2OK;
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference r[], size_t n,
                                        const fmi2Integer order[], fmi2Real value[])
{
    static const char f[] = "fmi2GetRealOutputDerivatives";
    Instance *m = c;
    Direction d;
    Slopes s;
    size_t i;
    if (!allowed_for(m, fmi2CoSimulation, STEP_COMPLETE | STEP_FAILED | TERMINATED, f)) return fmi2Error;
    if (missing(m, r, n, f) || missing(m, order, n, f) || missing(m, value, n, f)) return fmi2Error;
    if (!known_references(m, r, n, f)) return fmi2Error;
    if (without_slope(m, r, n, f)) return fmi2Discard;
    for (i = 0; i < n; i++) {
        if (r[i] >= FIRST_P || (r[i] >= FIRST_U && r[i] < FIRST_Y))
            return refuse(m, "%s: %s is no output.", f, model_names[r[i]]);
        if (order[i] != 1)
            return refuse(m, "%s: order %d of %s: only the first derivative is known.", f, order[i],
                          model_names[r[i]]);
    }
    refresh_outputs(m);
    memset(&d, 0, sizeof d);
    memcpy(d.x, m->dx, sizeof d.x);
    memcpy(d.u, m->s.slope, sizeof d.u);
    if (!derive(m, &d, 0, &s))
        return discard(m, "%s: the equation \"%s\" has no solution at t = %.10g s.", f, unsolved(m), m->s.time);
    for (i = 0; i < n; i++) {
        value[i] = slope_of(&d, &s, r[i]);
        if (!isfinite(value[i])) return discard(m, "%s: the derivative of %s is not finite.", f, model_names[r[i]]);
    }
    return fmi2OK;
}
