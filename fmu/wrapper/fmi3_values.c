/* Values and derivatives as FMI 3.0 asks for them. All variables are scalars, so that all arrays are equally long. */

enum { TIME = N_VARIABLES }; /* value reference of the independent variable */

fmi3Status fmi3GetFloat64(fmi3Instance c, const fmi3ValueReference r[], size_t n, fmi3Float64 value[], size_t n_values)
{
    static const char f[] = "fmi3GetFloat64";
    Instance *m = c;
    fmi3Status status, worst = fmi3OK;
    size_t from = 0, i;
    if (!allowed(m, GETTABLE, f) || missing(m, r, n, f) || wrong_size(m, value, n_values, n, f)) return fmi3Error;
    for (i = 0; i <= n; i++) {
        if (i < n && r[i] != TIME) continue;
        if ((status = get_values(m, r + from, i - from, value + from)) > worst) worst = status;
        if (i < n) value[i] = m->s.time;
        from = i + 1;
    }
    return worst;
}

fmi3Status fmi3SetFloat64(fmi3Instance c, const fmi3ValueReference r[], size_t n, const fmi3Float64 value[],
                          size_t n_values)
{
    if (!c || wrong_size(c, value, n_values, n, "fmi3SetFloat64")) return fmi3Error;
    return set_values(c, r, n, value);
}

#define WHOLE_VARIABLES(TYPE, TYPES) \
    fmi3Status fmi3Get##TYPE(fmi3Instance c, const fmi3ValueReference r[], size_t n, fmi3##TYPE value[], size_t n_values) \
    { \
        if (!c || wrong_size(c, value, n_values, n, "fmi3Get" #TYPE)) return fmi3Error; \
        GET_WHOLE(TYPES, "fmi3Get" #TYPE) \
    } \
    fmi3Status fmi3Set##TYPE(fmi3Instance c, const fmi3ValueReference r[], size_t n, const fmi3##TYPE value[], \
                             size_t n_values) \
    { \
        if (!c || wrong_size(c, value, n_values, n, "fmi3Set" #TYPE)) return fmi3Error; \
        SET_WHOLE(TYPES, "fmi3Set" #TYPE) \
    }

WHOLE_VARIABLES(Int32, WHOLE_NUMBER)
WHOLE_VARIABLES(Int64, ENUMERATION)

fmi3Status fmi3GetDirectionalDerivative(fmi3Instance c, const fmi3ValueReference unknown[], size_t n_unknown,
                                        const fmi3ValueReference known[], size_t n_known, const fmi3Float64 seed[],
                                        size_t n_seed, fmi3Float64 sensitivity[], size_t n_sensitivity)
{
    static const char f[] = "fmi3GetDirectionalDerivative";
    if (!c || wrong_size(c, seed, n_seed, n_known, f)) return fmi3Error;
    if (wrong_size(c, sensitivity, n_sensitivity, n_unknown, f)) return fmi3Error;
    return directional(c, unknown, n_unknown, known, n_known, seed, sensitivity);
}

fmi3Status fmi3GetOutputDerivatives(fmi3Instance c, const fmi3ValueReference r[], size_t n, const fmi3Int32 order[],
                                    fmi3Float64 value[], size_t n_values)
{
    if (!c || wrong_size(c, value, n_values, n, "fmi3GetOutputDerivatives")) return fmi3Error;
    return output_derivatives(c, r, n, order, value);
}

/* Derivatives of the seeds' sum of outputs and rates along all states, inputs and parameters; 0 where the implicit
   equations have no solution. */
static int derive_back(Instance *m, const Slopes *seed, Direction *out)
{
    double c_bar[AT_LEAST_1(NC)], through[AT_LEAST_1(NP)];
    int i;
    refresh_constants(m);
    if (unsolved(m)) return 0;
    model_adjoint(m->s.x, m->z, m->s.u, m->s.p, m->c, seed->y, seed->dx, out->x, out->u, out->p, c_bar);
    model_constants_adjoint(m->s.p, c_bar, through);
    for (i = 0; i < NP; i++) out->p[i] += through[i];
    return 1;
}

fmi3Status fmi3GetAdjointDerivative(fmi3Instance c, const fmi3ValueReference unknown[], size_t n_unknown,
                                    const fmi3ValueReference known[], size_t n_known, const fmi3Float64 seed[],
                                    size_t n_seed, fmi3Float64 sensitivity[], size_t n_sensitivity)
{
    static const char f[] = "fmi3GetAdjointDerivative";
    Instance *m = c;
    Direction d;
    Slopes s;
    double own[NX] = {0.0}; /* of the states that are outputs themselves */
    size_t i;
    if (!allowed(m, GETTABLE, f) || missing(m, unknown, n_unknown, f) || missing(m, known, n_known, f)) return fmi3Error;
    if (wrong_size(m, seed, n_seed, n_unknown, f)) return fmi3Error;
    if (wrong_size(m, sensitivity, n_sensitivity, n_known, f)) return fmi3Error;
    if (!known_references(m, unknown, n_unknown, f) || !known_references(m, known, n_known, f)) return fmi3Error;
    if (without_slope(m, unknown, n_unknown, f)) return fmi3Discard;
    memset(&s, 0, sizeof s);
    for (i = 0; i < n_unknown; i++) {
        fmi3ValueReference r = unknown[i];
        if (!isfinite(seed[i])) return refuse(m, "%s: %g along %s is not finite.", f, seed[i], model_names[r]);
        if (!is_calculated(r)) return refuse(m, "%s: %s is given, so it is no unknown.", f, model_names[r]);
        if (r < FIRST_U) own[r - FIRST_X] += seed[i];
        else if (r < FIRST_P) s.y[r - FIRST_Y] += seed[i];
        else s.dx[r - FIRST_DX] += seed[i];
    }
    for (i = 0; i < n_known; i++)
        if (!settable(known[i]))
            return refuse(m, "%s: %s is calculated, so it is no known.", f, model_names[known[i]]);
    if (!derive_back(m, &s, &d))
        return discard(m, "%s: the equation \"%s\" has no solution at t = %.10g s.", f, unsolved(m), m->s.time);
    for (i = 0; i < n_known; i++) {
        fmi3ValueReference r = known[i];
        sensitivity[i] = r < FIRST_U ? d.x[r - FIRST_X] + own[r - FIRST_X]
                       : r < FIRST_Y ? d.u[r - FIRST_U] : d.p[r - FIRST_P];
        if (!isfinite(sensitivity[i]))
            return discard(m, "%s: the derivative along %s is not finite.", f, model_names[r]);
    }
    return fmi3OK;
}
