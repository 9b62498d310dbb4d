/* Instances, initialization, event mode and step mode as FMI 3.0 has them. */

fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
                                          fmi3Boolean logging, fmi3InstanceEnvironment environment,
                                          fmi3LogMessageCallback logger)
{
    const Callbacks callbacks = {logger, environment, 1};
    return instantiate(name, MODEL_EXCHANGE, token, resources, &callbacks, visible, logging);
}

/* An instance that must not come to be, once it can say why. */
static fmi3Instance without(Instance *m, const char *function, const char *what)
{
    if (m) refuse(m, "%s: this FMU has no %s.", function, what);
    fmi3FreeInstance(m);
    return NULL;
}

fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
                                         fmi3Boolean logging, fmi3Boolean event_mode, fmi3Boolean early_return,
                                         const fmi3ValueReference intermediate[], size_t n_intermediate,
                                         fmi3InstanceEnvironment environment, fmi3LogMessageCallback logger,
                                         fmi3IntermediateUpdateCallback update)
{
    const Callbacks callbacks = {logger, environment, event_mode};
    Instance *m = instantiate(name, CO_SIMULATION, token, resources, &callbacks, visible, logging);
    (void)early_return, (void)intermediate, (void)update;
    return n_intermediate == 0 ? m : without(m, "fmi3InstantiateCoSimulation", "intermediate update");
}

fmi3Instance fmi3InstantiateScheduledExecution(fmi3String name, fmi3String token, fmi3String resources,
                                               fmi3Boolean visible, fmi3Boolean logging,
                                               fmi3InstanceEnvironment environment, fmi3LogMessageCallback logger,
                                               fmi3ClockUpdateCallback update, fmi3LockPreemptionCallback lock,
                                               fmi3UnlockPreemptionCallback unlock)
{
    const Callbacks callbacks = {logger, environment, 0};
    Instance *m = instantiate(name, CO_SIMULATION, token, resources, &callbacks, visible, logging);
    (void)update, (void)lock, (void)unlock;
    return without(m, "fmi3InstantiateScheduledExecution", "scheduled execution");
}

fmi3Status fmi3EnterInitializationMode(fmi3Instance c, fmi3Boolean tolerance_defined, fmi3Float64 tolerance,
                                       fmi3Float64 from, fmi3Boolean stop_defined, fmi3Float64 stop)
{
    fmi3Status status = set_up(c, tolerance_defined, tolerance, from, stop_defined, stop);
    return status == fmi3OK ? enter_initialization(c) : status;
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance c)
{
    Instance *m = c;
    fmi3Status status = exit_initialization(m);
    if (status <= fmi3Warning && m->callbacks.event_mode) m->s.mode = EVENT;
    return status;
}

/* There are no events, only inputs and parameters that change. */
fmi3Status fmi3EnterEventMode(fmi3Instance c)
{
    Instance *m = c;
    if (!allowed(m, CONTINUOUS_TIME | STEP_COMPLETE | STEP_FAILED, "fmi3EnterEventMode")) return fmi3Error;
    if (!m->callbacks.event_mode)
        return refuse(m, "fmi3EnterEventMode: the instance was made with eventModeUsed = fmi3False.");
    if (m->s.mode == CONTINUOUS_TIME) m->s.states_touched = 0;
    m->s.mode = EVENT;
    return fmi3OK;
}

fmi3Status fmi3UpdateDiscreteStates(fmi3Instance c, fmi3Boolean *again, fmi3Boolean *terminate, fmi3Boolean *nominals,
                                    fmi3Boolean *values, fmi3Boolean *time_defined, fmi3Float64 *time)
{
    static const char f[] = "fmi3UpdateDiscreteStates";
    Instance *m = c;
    if (!allowed(m, EVENT, f)) return fmi3Error;
    if (missing(m, again, 1, f) || missing(m, terminate, 1, f) || missing(m, nominals, 1, f)) return fmi3Error;
    if (missing(m, values, 1, f) || missing(m, time_defined, 1, f) || missing(m, time, 1, f)) return fmi3Error;
    *again = *terminate = *nominals = *time_defined = fmi3False;
    *time = 0.0;
    /* The values have not changed, but importers restart their integrator only when told so, and a jump of an input
       needs the restart. */
    *values = m->s.type == MODEL_EXCHANGE && m->s.states_touched;
    m->s.states_touched = 0;
    return fmi3OK;
}

fmi3Status fmi3EnterStepMode(fmi3Instance c)
{
    Instance *m = c;
    if (!allowed_for(m, CO_SIMULATION, EVENT, "fmi3EnterStepMode")) return fmi3Error;
    if (!check_relations(m, "fmi3EnterStepMode")) return fmi3Error;
    m->s.mode = STEP_COMPLETE;
    return fmi3OK;
}

fmi3Status fmi3DoStep(fmi3Instance c, fmi3Float64 time, fmi3Float64 step, fmi3Boolean no_return, fmi3Boolean *event,
                      fmi3Boolean *terminate, fmi3Boolean *early_return, fmi3Float64 *reached)
{
    static const char f[] = "fmi3DoStep";
    Instance *m = c;
    fmi3Status status;
    if (!m || missing(m, event, 1, f) || missing(m, terminate, 1, f)) return fmi3Error;
    if (missing(m, early_return, 1, f) || missing(m, reached, 1, f)) return fmi3Error;
    status = do_step(m, time, step, no_return);
    *event = *terminate = *early_return = fmi3False;
    *reached = m->s.time;
    return status;
}

static fmi3Status count(Instance *m, size_t *n, size_t value, const char *function)
{
    if (!allowed_for(m, MODEL_EXCHANGE, ANY_MODE, function) || missing(m, n, 1, function)) return fmi3Error;
    *n = value;
    return fmi3OK;
}

fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance c, size_t *n)
{
    return count(c, n, NX, "fmi3GetNumberOfContinuousStates");
}

fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance c, size_t *n)
{
    return count(c, n, 0, "fmi3GetNumberOfEventIndicators");
}
