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
        if (order[i] != 1)
            return refuse(m, "%s: order %d of %s: only the first derivative can be set.", f, order[i],
                          model_names[r[i]]);
        if (!isfinite(value[i]))
            return refuse(m, "%s: derivative %g of %s is not finite.", f, value[i], model_names[r[i]]);
    }
    for (i = 0; i < n; i++) m->s.slope[r[i] - FIRST_U] = value[i];
    return fmi2OK;
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real time, fmi2Real step, fmi2Boolean no_return)
{
    Instance *m = c;
    Walk w;
    double round_off;
    (void)no_return;
    if (!allowed_for(m, fmi2CoSimulation, STEP_COMPLETE | STEP_FAILED, "fmi2DoStep")) return fmi2Error;
    if (!isfinite(time + step) || step < 0)
        return refuse(m, "fmi2DoStep: step of %g s from %.10g s: both must be finite, as must be their sum, and the "
                      "step not negative.", step, time);
    /* The master adds up its steps: its clock is right, ours follows as long as the difference is round-off. */
    round_off = 1e-9 * (1 + fabs(m->s.time)) + 1e-6 * step;
    if (fabs(time - m->s.time) > round_off)
        return refuse(m, "fmi2DoStep: the step starts at %.10g s, but the instance is at %.10g s.", time, m->s.time);
    if (m->s.stop_defined && step > 0 && time >= m->s.stop + round_off)
        return refuse(m, "fmi2DoStep: the step starts at %.10g s, behind the stop time %.10g s.", time, m->s.stop);
    if (!check_relations(m, "fmi2DoStep")) return fmi2Error;
    if (!walk(m, step, &w)) {
        const char *name = model_names[FIRST_X + w.worst];
        m->s.mode = STEP_FAILED;
        if (w.block)
            return refuse(m, "fmi2DoStep: no step from %.10g s: the equation \"%s\" has no solution at %s. Nothing has "
                          "changed; check speeds, torques and temperatures.", time, w.block,
                          w.accepted ? "its end" : "its begin");
        if (w.accepted > 0)
            return discard(m, "fmi2DoStep: no step from %.10g s to %.10g s: %s cannot be continued behind %.10g s. "
                           "Nothing has changed; retry with a shorter step.", time, time + step, name,
                           time + w.reached);
        return refuse(m, "fmi2DoStep: no step from %.10g s: %s becomes infinite or leaves its range. Nothing has "
                      "changed; check the inputs.", time, name);
    }
    m->s.mode = STEP_COMPLETE;
    m->s.time = time + step;
    note(m, fmi2OK, LOG_SOLVER, "t = %.10g s: %ld steps, %ld rejected, next %.3g s, limited by %s.", m->s.time,
         w.accepted, w.rejected, m->s.h_last, model_names[FIRST_X + w.worst]);
    warn_validity(m);
    return fmi2OK;
}

fmi2Status fmi2CancelStep(fmi2Component c)
{
    if (!allowed_for(c, fmi2CoSimulation, 0, "fmi2CancelStep")) return fmi2Error;
    return fmi2OK;
}

#define STATUS_MODES (STEP_COMPLETE | STEP_FAILED | TERMINATED)

static fmi2Status no_status(fmi2Component c, const char *function)
{
    if (!allowed_for(c, fmi2CoSimulation, STATUS_MODES, function)) return fmi2Error;
    return discard(c, "%s: steps are never pending.", function);
}

fmi2Status fmi2GetStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Status *value)
{
    (void)kind, (void)value;
    return no_status(c, "fmi2GetStatus");
}

fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value)
{
    Instance *m = c;
    if (!allowed_for(m, fmi2CoSimulation, STATUS_MODES, "fmi2GetRealStatus")) return fmi2Error;
    if (missing(m, value, 1, "fmi2GetRealStatus")) return fmi2Error;
    if (kind != fmi2LastSuccessfulTime) return no_status(c, "fmi2GetRealStatus");
    *value = m->s.time;
    return fmi2OK;
}

fmi2Status fmi2GetIntegerStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Integer *value)
{
    (void)kind, (void)value;
    return no_status(c, "fmi2GetIntegerStatus");
}

fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value)
{
    Instance *m = c;
    if (!allowed_for(m, fmi2CoSimulation, STATUS_MODES, "fmi2GetBooleanStatus")) return fmi2Error;
    if (missing(m, value, 1, "fmi2GetBooleanStatus")) return fmi2Error;
    if (kind != fmi2Terminated) return no_status(c, "fmi2GetBooleanStatus");
    *value = fmi2False; /* the model never ends a simulation */
    return fmi2OK;
}

fmi2Status fmi2GetStringStatus(fmi2Component c, const fmi2StatusKind kind, fmi2String *value)
{
    (void)kind, (void)value;
    return no_status(c, "fmi2GetStringStatus");
}
