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
