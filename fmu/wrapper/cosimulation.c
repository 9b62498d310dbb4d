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

/* Whether a step may begin at a time of the master's clock; ours follows as long as the difference is round-off. */
static int timely(const Instance *m, double time, double step)
{
    double round_off = 1e-9 * (1 + fabs(m->s.time)) + 1e-6 * step, end = time + step;
    if (!isfinite(end) || step < 0)
        return refuse(m, "fmi2DoStep: step of %g s from %.10g s: both must be finite, as must be their sum, and the "
                      "step not negative.", step, time), 0;
    if (fabs(time - m->s.time) > round_off)
        return refuse(m, "fmi2DoStep: the step starts at %.10g s, but the instance is at %.10g s.", time, m->s.time), 0;
    if (m->s.stop_defined && step > 0 && end > m->s.stop + 1e-9 * (1 + fabs(m->s.stop)) + fmin(1e-6 * step, 1e-6))
        return refuse(m, "fmi2DoStep: the step from %.10g s to %.10g s passes the stop time %.10g s.", time, end,
                      m->s.stop), 0;
    return 1;
}

/* A refused step is not tried again as long as its time, inputs, parameters and states are the same: a master that only
   repeats it would never end. */
static uint64_t beginning(const State *s)
{
    size_t from = offsetof(State, time);
    return hash((const char *)s + from, sizeof *s - from);
}

static int refused_before(const Instance *m, double step)
{
    return step == m->refused_step && beginning(&m->s) == m->refused_from;
}

static void remember_refusal(Instance *m, double step, const char *reason)
{
    m->s.mode = STEP_FAILED;
    m->refused_from = beginning(&m->s);
    m->refused_step = step;
    m->refused_by = reason;
}

/* The first input that its slope leads out of its range until the end of a step; N_VARIABLES when there is none. */
static int input_astray(const Instance *m, double step)
{
    int i;
    for (i = 0; i < NU; i++)
        if (!in_range(FIRST_U + i, m->s.u[i] + m->s.slope[i] * step)) return FIRST_U + i;
    return N_VARIABLES;
}

/* Why a step did not arrive. */
static fmi2Status stuck(const Instance *m, double time, double step, const Advance *w)
{
    const Effort *e = &w->effort;
    const char *name = model_names[FIRST_X + w->worst];
    if (w->block)
        return discard(m, "fmi2DoStep: no step from %.10g s to %.10g s: the equation \"%s\" has no solution at its %s. "
                       "Nothing has changed; check speeds, torques and temperatures.", time, time + step, w->block,
                       e->accepted ? "end" : "begin");
    if (e->accepted == 0)
        return refuse(m, "fmi2DoStep: no step from %.10g s: %s becomes infinite or leaves its range (%s %s). Nothing "
                      "has changed; check the inputs.", time, name, model_ranges[FIRST_X + w->worst],
                      model_units[FIRST_X + w->worst]);
    if (e->accepted + e->rejected >= MAX_STEPS)
        return discard(m, "fmi2DoStep: no step from %.10g s to %.10g s: %ld internal steps lead to %.10g s only, "
                       "limited by %s. Nothing has changed; retry with a shorter step.", time, time + step,
                       e->accepted + e->rejected, time + w->reached, name);
    return discard(m, "fmi2DoStep: no step from %.10g s to %.10g s: %s becomes infinite or leaves its range (%s %s) "
                   "behind %.10g s. Nothing has changed; retry with a shorter step.", time, time + step, name,
                   model_ranges[FIRST_X + w->worst], model_units[FIRST_X + w->worst], time + w->reached);
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real time, fmi2Real step, fmi2Boolean no_return)
{
    Instance *m = c;
    State before;
    Advance w;
    int r, wanted;
    (void)no_return;
    if (!allowed_for(m, fmi2CoSimulation, STEP_COMPLETE | STEP_FAILED, "fmi2DoStep")) return fmi2Error;
    if (!timely(m, time, step)) return fmi2Error;
    if (!check_relations(m, "fmi2DoStep")) return fmi2Error;
    if (refused_before(m, step))
        return refuse(m, "fmi2DoStep: the step of %g s from %.10g s was refused because of %s, and nothing has changed "
                      "since. Take a shorter step, or other inputs.", step, time, m->refused_by);
    if ((r = input_astray(m, step)) != N_VARIABLES) {
        remember_refusal(m, step, model_names[r]);
        return discard(m, "fmi2DoStep: no step from %.10g s to %.10g s: its slope leads %s out of its range (%s %s). "
                       "Nothing has changed; retry with a shorter step.", time, time + step, model_names[r],
                       model_ranges[r], model_units[r]);
    }
    before = m->s;
    if (!advance(m, step, &w)) {
        m->s = before;
        changed(m);
        remember_refusal(m, step, w.block ? w.block : model_names[FIRST_X + w.worst]);
        return stuck(m, time, step, &w);
    }
    m->s.mode = STEP_COMPLETE;
    m->s.stepped = 1;
    m->s.time = time + step;
    m->outputs_known = m->outputs_known && step == 0;
    /* Whoever reads the outputs after each step gets them checked with the step, at no cost. Whoever does not, has them
       checked when they are read. */
    wanted = m->outputs_wanted;
    m->outputs_wanted = 0;
    if (wanted && (r = wrong_result(m)) != N_VARIABLES) {
        double value = value_of(m, r);
        m->s = before;
        changed(m);
        remember_refusal(m, step, model_names[r]);
        return discard(m, "fmi2DoStep: no step from %.10g s to %.10g s: %s would be %.10g %s, but must be %s. "
                       "Nothing has changed; check the inputs.", time, time + step, model_names[r], value,
                       model_units[r], model_ranges[r]);
    }
    note(m, fmi2OK, LOG_SOLVER, "t = %.10g s: %ld steps, %ld rejected, next %.3g s, limited by %s.", m->s.time,
         w.effort.accepted, w.effort.rejected, m->s.h_last, model_names[FIRST_X + w.worst]);
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
