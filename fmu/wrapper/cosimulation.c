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
static unsigned beginning(const State *s)
{
    size_t from = offsetof(State, time);
    return hash((const char *)s + from, sizeof *s - from);
}

static int refused_before(const Instance *m, double step)
{
    return step == m->s.refused_step && beginning(&m->s) == m->s.refused_from;
}

static void remember_refusal(Instance *m, double step, const char *reason)
{
    m->s.mode = STEP_FAILED;
    m->s.refused_from = beginning(&m->s);
    m->s.refused_step = step;
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
        return refuse(m, "fmi2DoStep: no step from %.10g s: %s becomes infinite or leaves its range (%s%s). Nothing "
                      "has changed; check the inputs.", time, name, model_ranges[FIRST_X + w->worst],
                      model_units[FIRST_X + w->worst]);
    if (e->accepted + e->rejected >= MAX_STEPS)
        return discard(m, "fmi2DoStep: no step from %.10g s to %.10g s: %ld internal steps lead to %.10g s only, "
                       "limited by %s. Nothing has changed; retry with a shorter step.", time, time + step,
                       e->accepted + e->rejected, time + w->reached, name);
    return discard(m, "fmi2DoStep: no step from %.10g s to %.10g s: %s becomes infinite or leaves its range (%s%s) "
                   "behind %.10g s. Nothing has changed; retry with a shorter step.", time, time + step, name,
                   model_ranges[FIRST_X + w->worst], model_units[FIRST_X + w->worst], time + w->reached);
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real time, fmi2Real step, fmi2Boolean no_return)
{
    Instance *m = c;
    State before[1 + N_SIDES];
    Advance w;
    int r, k, wanted;
    (void)no_return;
    if (!allowed_for(m, fmi2CoSimulation, STEP_COMPLETE | STEP_FAILED, "fmi2DoStep")) return fmi2Error;
    if (!timely(m, time, step)) return fmi2Error;
    if (!check_relations(m, "fmi2DoStep")) return fmi2Error;
    if (refused_before(m, step))
        return refuse(m, "fmi2DoStep: the step of %g s from %.10g s was refused because of %s, and nothing has changed "
                      "since. Take a shorter step, or other inputs.", step, time,
                      m->refused_by ? m->refused_by : "what another instance has told");
    if ((r = input_astray(m, step)) != N_VARIABLES) {
        remember_refusal(m, step, model_names[r]);
        return discard(m, "fmi2DoStep: no step from %.10g s to %.10g s: its slope leads %s out of its range (%s%s). "
                       "Nothing has changed; retry with a shorter step.", time, time + step, model_names[r],
                       model_ranges[r], model_units[r]);
    }
    keep(m, before);
    follow(m);
    for (k = N_SIDES; k >= 0 && advance(m + k, step, &w); k--) {}
    if (k >= 0) {
        go_back(m, before);
        if (k > 0) warn(m, "fmi2DoStep: parameters at %+.3g standard deviations are what leads to:", model_sides[k - 1]);
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
        go_back(m, before);
        remember_refusal(m, step, model_names[r]);
        return discard(m, "fmi2DoStep: no step from %.10g s to %.10g s: %s would be %.10g%s, but must be %s. "
                       "Nothing has changed; check the inputs.", time, time + step, model_names[r], value,
                       model_units[r], model_ranges[r]);
    }
    note(m, fmi2OK, LOG_SOLVER, "t = %.10g s: %ld steps, %ld rejected, next %.3g s, limited by %s.", m->s.time,
         w.effort.accepted, w.effort.rejected, m->s.h_last, model_names[FIRST_X + w.worst]);
    warn_validity(m);
    return fmi2OK;
}
