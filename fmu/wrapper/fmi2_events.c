/* Model exchange: modes, time, states, derivatives. There are no events, only inputs and parameters that change. */

fmi2Status fmi2EnterEventMode(fmi2Component c)
{
    Instance *m = c;
    if (!allowed_for(m, fmi2ModelExchange, EVENT | CONTINUOUS_TIME, "fmi2EnterEventMode")) return fmi2Error;
    if (m->s.mode == CONTINUOUS_TIME) m->s.states_touched = 0;
    m->s.mode = EVENT;
    return fmi2OK;
}

fmi2Status fmi2NewDiscreteStates(fmi2Component c, fmi2EventInfo *info)
{
    Instance *m = c;
    if (!allowed_for(m, fmi2ModelExchange, EVENT, "fmi2NewDiscreteStates")) return fmi2Error;
    if (missing(m, info, 1, "fmi2NewDiscreteStates")) return fmi2Error;
    memset(info, 0, sizeof *info);
    /* The values have not changed, but importers restart their integrator only when told so, and a jump of an input
       needs the restart. */
    info->valuesOfContinuousStatesChanged = m->s.states_touched;
    m->s.states_touched = 0;
    return fmi2OK;
}
