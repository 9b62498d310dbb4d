/* Co-simulation: communication steps, input and output derivatives, status. */

fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference r[], size_t n,
                                       const fmi2Integer order[], const fmi2Real value[])
{
    static const char f[] = "fmi2SetRealInputDerivatives";
    Instance *m = c;
    size_t i;
    if (!allowed_for(m, fmi2CoSimulation, INSTANTIATED | INITIALIZATION | STEP_COMPLETE | STEP_FAILED, f))
        return fmi2Error;
    if (missing(m, r, n, f) || missing(m, order, n, f) || missing(m, value, n, f)) return fmi2Error;
    if (!known_references(m, r, n, f)) return fmi2Error;
    for (i = 0; i < n; i++) {
        if (r[i] < FIRST_U || r[i] >= FIRST_Y) return refuse(m, "%s: %s is no input.", f, model_names[r[i]]);
        if (order[i] < 1)
            return refuse(m, "%s: order %d of %s: it must be at least 1.", f, order[i], model_names[r[i]]);
        if (!isfinite(value[i]))
            return refuse(m, "%s: derivative %g of %s is not finite.", f, value[i], model_names[r[i]]);
    }
    for (i = 0; i < n; i++) {
        if (order[i] == 1) m->s.slope[r[i] - FIRST_U] = value[i];
        else if (!m->order_told) {
            m->order_told = 1;
            warn(m, "%s: order %d of %s is ignored: the first derivative alone counts.", f, order[i],
                 model_names[r[i]]);
        }
    }
    return fmi2OK;
}
