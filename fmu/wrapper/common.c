const char *fmi2GetVersion(void) { return fmi2Version; }

/* The state of a fresh instance. */
static void start(Instance *m)
{
    int type = m->s.type, i;
    memset(&m->s, 0, sizeof m->s);
    m->s.type = type;
    m->s.mode = INSTANTIATED;
    m->s.tolerance = TOLERANCE;
    for (i = 0; i < NX; i++) m->s.x[i] = model_start[FIRST_X + i];
    for (i = 0; i < NZ; i++) m->s.z[i] = model_z_start[i];
    for (i = 0; i < ND * NS; i++) m->s.s[i] = model_state_directions[i];
    for (i = 0; i < NU; i++) m->s.u[i] = model_start[FIRST_U + i];
    for (i = 0; i < NP; i++) m->s.own[i] = model_start[FIRST_P + i];
    for (i = 0; i < N_CHOICES; i++) m->s.choice[i] = model_start[FIRST_CHOICE + i];
    use_choices(&m->s);
    m->constants_known = 0;
    changed(m);
    m->log_mask = m->log_mask_at_start;
    memset(m->warned, 0, sizeof m->warned);
    memset(m->kept, 0, sizeof m->kept);
    memset(m->s.wrong, 0, sizeof m->s.wrong);
    m->s.refused_step = NAN;
    m->order_told = 0;
    m->outputs_wanted = 1;
}

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions *callbacks, fmi2Boolean visible, fmi2Boolean logging)
{
    Instance *m, untold;
    size_t length = name ? strlen(name) : 0;
    int i;
    (void)resources;
    (void)visible;
    if (!callbacks) return NULL;
    memset(&untold, 0, sizeof untold);
    untold.callbacks = *callbacks;
    untold.name = (char *)MODEL_NAME;
    if (length == 0) return refuse(&untold, "fmi2Instantiate: the instance has no name."), NULL;
    if (type != fmi2ModelExchange && type != fmi2CoSimulation)
        return refuse(&untold, "fmi2Instantiate: unknown FMU type %d.", (int)type), NULL;
    if (NSD > 0 && type == fmi2ModelExchange)
        return refuse(&untold, "fmi2Instantiate: an FMU with standard deviations serves co-simulation only."), NULL;
    if (!guid || strcmp(guid, MODEL_GUID) != 0)
        return refuse(&untold, "fmi2Instantiate: wrong GUID %.100s: this binary belongs to %s.",
                      guid ? guid : "(none)", MODEL_GUID), NULL;
    m = calloc(1 + N_SIDES, sizeof *m);
    if (m) m->name = malloc(length + 1);
    if (!m || !m->name) {
        free(m);
        return refuse(&untold, "fmi2Instantiate: out of memory."), NULL;
    }
    memcpy(m->name, name, length + 1);
    m->callbacks = *callbacks;
    m->log_mask_at_start = logging ? (1u << N_CATEGORIES) - 1 : 0;
    m->s.type = type;
    start(m);
    for (i = 1; i <= N_SIDES; i++) {
        m[i].name = m->name;
        m[i].callbacks = m->callbacks;
    }
    return m;
}

void fmi2FreeInstance(fmi2Component c)
{
    Instance *m = c;
    if (!m) return;
    free(m->name);
    free(m);
}

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t count, const fmi2String names[])
{
    Instance *m = c;
    unsigned mask = count == 0 ? (1u << N_CATEGORIES) - 1 : 0;
    size_t i;
    int k;
    if (!allowed(m, ANY_MODE, "fmi2SetDebugLogging")) return fmi2Error;
    if (missing(m, names, count, "fmi2SetDebugLogging")) return fmi2Error;
    for (i = 0; i < count; i++) {
        for (k = 0; k < N_CATEGORIES; k++)
            if (names[i] && strcmp(names[i], category_names[k]) == 0) break;
        if (k == N_CATEGORIES)
            return refuse(m, "fmi2SetDebugLogging: unknown category %.100s.", names[i] ? names[i] : "(null)");
        mask |= 1u << k;
    }
    m->log_mask = on ? mask : 0;
    return fmi2OK;
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean tolerance_defined, fmi2Real tolerance, fmi2Real from,
                               fmi2Boolean stop_defined, fmi2Real stop)
{
    Instance *m = c;
    if (!allowed(m, INSTANTIATED, "fmi2SetupExperiment")) return fmi2Error;
    if (tolerance_defined && !(isfinite(tolerance) && tolerance > 0))
        return refuse(m, "fmi2SetupExperiment: tolerance %g must be above 0 and finite.", tolerance);
    if (!isfinite(from)) return refuse(m, "fmi2SetupExperiment: start time %g is not finite.", from);
    if (stop_defined && !(stop >= from))
        return refuse(m, "fmi2SetupExperiment: stop time %g s lies before the start time %g s.", stop, from);
    m->s.tolerance = tolerance_defined ? tolerance : TOLERANCE;
    m->s.time = from;
    m->s.stop_defined = stop_defined != fmi2False;
    m->s.stop = stop_defined ? stop : 0.0;
    return fmi2OK;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c)
{
    Instance *m = c;
    if (!allowed(m, INSTANTIATED, "fmi2EnterInitializationMode")) return fmi2Error;
    m->s.mode = INITIALIZATION;
    return fmi2OK;
}

/* The states of an instance and of those behind it. */
static void keep(const Instance *m, State states[])
{
    int k;
    for (k = 0; k <= N_SIDES; k++) memcpy(states + k, &m[k].s, sizeof *states);
}

static fmi2Status go_back(Instance *m, const State states[])
{
    int k;
    for (k = 0; k <= N_SIDES; k++) {
        memcpy(&m[k].s, states + k, sizeof *states);
        m[k].constants_known = 0;
        changed(m + k);
    }
    return fmi2Error;
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c)
{
    Instance *m = c;
    State before[1 + N_SIDES];
    fmi2Status status;
    const char *block;
    int r, k;
    if (!allowed(m, INITIALIZATION, "fmi2ExitInitializationMode")) return fmi2Error;
    if (!check_relations(m, "fmi2ExitInitializationMode")) return fmi2Error;
    for (r = 0; r < NU; r++)
        if (m->s.wrong[r]) return refuse_value(m, "fmi2ExitInitializationMode", FIRST_U + r, m->asked[r]), fmi2Error;
    keep(m, before);
    follow(m);
    for (k = N_SIDES, status = fmi2OK; k >= 0; k--)
        if (begin(m + k) != fmi2OK) status = fmi2Warning;
    if ((block = unsolved(m)) != NULL)
        return refuse(m, "fmi2ExitInitializationMode: the equation \"%s\" has no solution. Check start values, inputs and "
                      "parameters.", block), go_back(m, before);
    if ((r = wrong_result(m)) != N_VARIABLES)
        return refuse(m, "fmi2ExitInitializationMode: %s is %.10g%s, but must be %s. Check start values, inputs and "
                      "parameters.", model_names[r], value_of(m, r), model_units[r], model_ranges[r]),
               go_back(m, before);
    for (k = 0; k <= N_SIDES; k++) accept_algebra(m + k);
    m->s.mode = m->s.type == fmi2ModelExchange ? EVENT : STEP_COMPLETE;
    warn_validity(m);
    return status;
}

fmi2Status fmi2Terminate(fmi2Component c)
{
    Instance *m = c;
    if (!allowed(m, EVENT | CONTINUOUS_TIME | STEP_COMPLETE | STEP_FAILED, "fmi2Terminate")) return fmi2Error;
    m->s.mode = TERMINATED;
    return fmi2OK;
}

fmi2Status fmi2Reset(fmi2Component c)
{
    Instance *m = c;
    if (!allowed(m, ANY_MODE, "fmi2Reset")) return fmi2Error;
    start(m);
    return fmi2OK;
}

/* Whether all references are of variables of some types. */
static int of_type(const Instance *m, const fmi2ValueReference r[], size_t n, int types, const char *function)
{
    size_t i;
    for (i = 0; i < n; i++) {
        if (r[i] >= N_VARIABLES) return refuse(m, "%s: unknown value reference %u.", function, r[i]), 0;
        if (!(model_type[r[i]] & types))
            return refuse(m, "%s: %s is %s.", function, model_names[r[i]], model_type[r[i]] == REAL_NUMBER ? "a real number"
                          : model_type[r[i]] == WHOLE_NUMBER ? "a whole number" : "an enumeration"), 0;
    }
    return 1;
}

static int known_references(const Instance *m, const fmi2ValueReference r[], size_t n, const char *function)
{
    return of_type(m, r, n, REAL_NUMBER, function);
}

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2Real value[])
{
    Instance *m = c;
    fmi2Status status = fmi2OK;
    size_t i;
    if (!allowed(m, GETTABLE, "fmi2GetReal")) return fmi2Error;
    if (missing(m, r, n, "fmi2GetReal") || missing(m, value, n, "fmi2GetReal")) return fmi2Error;
    if (!known_references(m, r, n, "fmi2GetReal")) return fmi2Error;
    for (i = 0; i < n; i++) {
        value[i] = value_of(m, r[i]);
        if (!in_range(r[i], value[i]))
            status = discard(m, "fmi2GetReal: %s is %g at t = %.10g s, but must be %s%s%s.", model_names[r[i]], value[i],
                             m->s.time, model_ranges[r[i]], unsolved(m) ? "; no solution of " : "",
                             unsolved(m) ? unsolved(m) : "");
    }
    return status;
}

/* Modes in which a variable may be set. */
static int settable(fmi2ValueReference r)
{
    if (r < FIRST_U) return INSTANTIATED | INITIALIZATION;
    if (r < FIRST_Y) return SETTABLE;
    if ((r >= FIRST_DX && r < FIRST_CHOICE) || r >= FIRST_SD) return 0;
    if (r < FIRST_P) return 0;
    return model_type[r] == WHOLE_NUMBER || r == FIRST_CHOICE + START ? INSTANTIATED | INITIALIZATION
                                                                      : SETTABLE & ~CONTINUOUS_TIME;
}

/* Masters fill inputs with zeros before they have values to pass on: some while they initialize, some until their first
   exchange of values. Such an input keeps its last valid value; the call succeeds, because masters take even a warning
   for a failure. From then on every value counts. Another value out of range is refused when initialization is left,
   unless a valid one has followed. */
static int stays(const Instance *m, fmi2ValueReference r, double value)
{
    int input = r >= FIRST_U && r < FIRST_Y;
    if (!input || in_range(r, value)) return 0;
    return m->s.mode & (INSTANTIATED | INITIALIZATION) ||
           (value == 0.0 && m->s.type == fmi2CoSimulation && !m->s.stepped);
}

static void tell_kept(Instance *m, fmi2ValueReference r, double value)
{
    if (m->kept[r - FIRST_U]) return;
    m->kept[r - FIRST_U] = 1;
    warn(m, "fmi2SetReal: %s = %.10g%s is out of range. It must be %s%s; until then it stays at %.10g%s.",
         model_names[r], value, model_units[r], model_ranges[r], model_units[r], *stored(m, r), model_units[r]);
}

/* Whether a variable may have a value now; says why not. */
static int takes(const Instance *m, fmi2ValueReference r, double value, const char *function)
{
    if (settable(r) == 0)
        refuse(m, "%s: %s is calculated and cannot be set.", function, model_names[r]);
    else if (!(settable(r) & m->s.mode))
        refuse(m, "%s: %s cannot be set in the mode \"%s\".", function, model_names[r], mode_name(m->s.mode));
    else if (!in_range(r, value) && !stays(m, r, value))
        refuse_value(m, function, r, value);
    else
        return 1;
    return 0;
}

static void put(Instance *m, fmi2ValueReference r, double value)
{
    double *place = stored(m, r);
    int input = r >= FIRST_U && r < FIRST_Y;
    if (input) m->s.wrong[r - FIRST_U] = 0;
    if (*place == value) return;
    if (stays(m, r, value)) {
        if (value == 0.0) {
            tell_kept(m, r, value);
        } else {
            m->s.wrong[r - FIRST_U] = 1;
            m->asked[r - FIRST_U] = value;
        }
        return;
    }
    if (fabs(value - *place) > 1e-6 * (fabs(*place) + model_nominal[r]) || r >= FIRST_P)
        m->s.jumped = m->s.states_touched = 1;
    *place = value;
    changed(m);
    if (r < FIRST_P) return;
    use_choices(&m->s);
    m->constants_known = 0;
}

fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2Real value[])
{
    Instance *m = c;
    size_t i;
    if (!allowed(m, SETTABLE, "fmi2SetReal")) return fmi2Error;
    if (missing(m, r, n, "fmi2SetReal") || missing(m, value, n, "fmi2SetReal")) return fmi2Error;
    if (!known_references(m, r, n, "fmi2SetReal")) return fmi2Error;
    for (i = 0; i < n; i++)
        if (!takes(m, r[i], value[i], "fmi2SetReal")) return fmi2Error;
    for (i = 0; i < n; i++) put(m, r[i], value[i]);
    return fmi2OK;
}

/* Bodies of the functions for numbers that are whole; inside they are doubles. */
#define GET_WHOLE(TYPES, FUNCTION) \
    Instance *m = c; \
    size_t i; \
    if (!allowed(m, GETTABLE, FUNCTION) || missing(m, r, n, FUNCTION) || missing(m, value, n, FUNCTION)) return fmi2Error; \
    if (!of_type(m, r, n, TYPES, FUNCTION)) return fmi2Error; \
    for (i = 0; i < n; i++) value[i] = (int)*stored(m, r[i]); \
    return fmi2OK;

#define SET_WHOLE(TYPES, FUNCTION) \
    Instance *m = c; \
    size_t i; \
    if (!allowed(m, SETTABLE & ~CONTINUOUS_TIME, FUNCTION)) return fmi2Error; \
    if (missing(m, r, n, FUNCTION) || missing(m, value, n, FUNCTION)) return fmi2Error; \
    if (!of_type(m, r, n, TYPES, FUNCTION)) return fmi2Error; \
    for (i = 0; i < n; i++) \
        if (!takes(m, r[i], (double)value[i], FUNCTION)) return fmi2Error; \
    for (i = 0; i < n; i++) put(m, r[i], (double)value[i]); \
    return fmi2OK;

static fmi2Status no_variables(fmi2Component c, size_t n, int modes, const char *function)
{
    if (!allowed(c, modes, function)) return fmi2Error;
    return n == 0 ? fmi2OK : refuse(c, "%s: unknown value reference; no variable is of this type.", function);
}
