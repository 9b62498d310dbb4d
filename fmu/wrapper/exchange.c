fmi2Status fmi2EnterContinuousTimeMode(fmi2Component c)
{
    Instance *m = c;
    if (!allowed_for(m, fmi2ModelExchange, EVENT, "fmi2EnterContinuousTimeMode")) return fmi2Error;
    if (!check_relations(m, "fmi2EnterContinuousTimeMode")) return fmi2Error;
    m->s.mode = CONTINUOUS_TIME;
    return fmi2OK;
}

fmi2Status fmi2CompletedIntegratorStep(fmi2Component c, fmi2Boolean no_return, fmi2Boolean *enter_event_mode,
                                       fmi2Boolean *terminate)
{
    static const char f[] = "fmi2CompletedIntegratorStep";
    Instance *m = c;
    (void)no_return;
    if (!allowed_for(m, fmi2ModelExchange, CONTINUOUS_TIME, f)) return fmi2Error;
    if (missing(m, enter_event_mode, 1, f) || missing(m, terminate, 1, f)) return fmi2Error;
    *enter_event_mode = fmi2False;
    *terminate = fmi2False;
    accept_algebra(m);
    warn_validity(m);
    return fmi2OK;
}

fmi2Status fmi2SetTime(fmi2Component c, fmi2Real time)
{
    Instance *m = c;
    if (!allowed_for(m, fmi2ModelExchange, EVENT | CONTINUOUS_TIME, "fmi2SetTime")) return fmi2Error;
    if (!isfinite(time)) return refuse(m, "fmi2SetTime: %g is not finite.", time);
    m->s.time = time;
    return fmi2OK;
}

static int wrong_size(const Instance *m, const void *values, size_t n, size_t expected, const char *function)
{
    if (missing(m, values, n, function)) return 1;
    if (n == expected) return 0;
    refuse(m, "%s: %lu values instead of %lu.", function, (unsigned long)n, (unsigned long)expected);
    return 1;
}

fmi2Status fmi2SetContinuousStates(fmi2Component c, const fmi2Real x[], size_t n)
{
    Instance *m = c;
    int i;
    if (!allowed_for(m, fmi2ModelExchange, CONTINUOUS_TIME, "fmi2SetContinuousStates")) return fmi2Error;
    if (wrong_size(m, x, n, NX, "fmi2SetContinuousStates")) return fmi2Error;
    for (i = 0; i < NX; i++)
        if (!in_range(FIRST_X + i, x[i])) /* the integrator tried too far and may step back */
            return discard(m, "fmi2SetContinuousStates: %s = %g is out of range.", model_names[FIRST_X + i], x[i]);
    memcpy(m->s.x, x, sizeof m->s.x);
    changed(m);
    return fmi2OK;
}

fmi2Status fmi2GetContinuousStates(fmi2Component c, fmi2Real x[], size_t n)
{
    Instance *m = c;
    if (!allowed_for(m, fmi2ModelExchange, GETTABLE, "fmi2GetContinuousStates")) return fmi2Error;
    if (wrong_size(m, x, n, NX, "fmi2GetContinuousStates")) return fmi2Error;
    memcpy(x, m->s.x, sizeof m->s.x);
    return fmi2OK;
}

fmi2Status fmi2GetDerivatives(fmi2Component c, fmi2Real dx[], size_t n)
{
    Instance *m = c;
    const char *block;
    int i;
    if (!allowed_for(m, fmi2ModelExchange, GETTABLE, "fmi2GetDerivatives")) return fmi2Error;
    if (wrong_size(m, dx, n, NX, "fmi2GetDerivatives")) return fmi2Error;
    if ((block = unsolved(m)) != NULL)
        return discard(m, "fmi2GetDerivatives: the equation \"%s\" has no solution at t = %.10g s.", block, m->s.time);
    refresh_constants(m);
    if (m->outputs_known) memcpy(dx, m->dx, sizeof m->dx);
    else model_rates(m->s.x, m->z, m->s.u, m->s.p, m->c, dx);
    for (i = 0; i < NX; i++)
        if (!isfinite(dx[i]))
            return discard(m, "fmi2GetDerivatives: %s is %g at t = %.10g s.", model_names[FIRST_DX + i], dx[i],
                           m->s.time);
    return fmi2OK;
}

fmi2Status fmi2GetEventIndicators(fmi2Component c, fmi2Real z[], size_t n)
{
    Instance *m = c;
    if (!allowed_for(m, fmi2ModelExchange, GETTABLE, "fmi2GetEventIndicators")) return fmi2Error;
    return wrong_size(m, z, n, 0, "fmi2GetEventIndicators") ? fmi2Error : fmi2OK;
}

fmi2Status fmi2GetNominalsOfContinuousStates(fmi2Component c, fmi2Real nominal[], size_t n)
{
    Instance *m = c;
    if (!allowed_for(m, fmi2ModelExchange, ANY_MODE, "fmi2GetNominalsOfContinuousStates")) return fmi2Error;
    if (wrong_size(m, nominal, n, NX, "fmi2GetNominalsOfContinuousStates")) return fmi2Error;
    memcpy(nominal, model_nominal + FIRST_X, sizeof m->s.x);
    return fmi2OK;
}
