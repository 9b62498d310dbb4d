/* The model's functions behind dirty flags. */

static void refresh_constants(Instance *m)
{
    if (m->constants_known) return;
    model_constants(m->s.p, m->c);
    m->constants_known = 1;
    m->relations_hold = m->directions_known = 0;
}

/* Solve the implicit equations where states, inputs or parameters have changed; NULL, or the name of the one without a
   solution. */
static const char *unsolved(Instance *m)
{
    if (!m->algebra_known) {
        refresh_constants(m);
        memcpy(m->z, m->s.z, sizeof m->z);
        m->unsolved = implicit_solve(m->s.x, m->z, m->s.u, m->s.p, m->c,
                                     m->s.mode & (INSTANTIATED | INITIALIZATION) ? -1 : MAX_CORRECTIONS);
        m->algebra_known = 1;
    }
    return m->unsolved < 0 ? NULL : model_blocks[m->unsolved];
}

/* Whether the parameters fit each other; asked when all of them are set, as one by one they pass through states that
   do not. All relations that do not hold are told, those without a value only where nothing else is wrong. */
static int check_relations(Instance *m, const char *function)
{
    double value[AT_LEAST_1(NR)];
    int i, undefined;
    refresh_constants(m);
    if (NR == 0 || m->relations_hold) return 1;
    model_relations_of(m->s.p, value);
    m->relations_hold = 1;
    for (undefined = 0; undefined < 2 && m->relations_hold; undefined++)
        for (i = 0; i < NR; i++) {
            if (value[i] >= model_relation_low[i] && value[i] <= model_relation_high[i]) continue;
            if (isfinite(value[i]) == (undefined != 0)) continue;
            m->relations_hold = 0;
            refuse(m, "%s: %s %.6g, %s", function, model_relations[i], value[i], model_remedies[i]);
        }
    return m->relations_hold;
}

/* What calculation leaves beside the end of a range by round-off lies on it. */
static void settle(double *y)
{
    int i;
    for (i = 0; i < NY; i++) {
        double low = model_low[FIRST_Y + i], high = model_high[FIRST_Y + i], slack = 1e-9 * model_nominal[FIRST_Y + i];
        if (y[i] < low && y[i] >= low - slack) y[i] = low;
        if (y[i] > high && y[i] <= high + slack) y[i] = high;
    }
}

/* Parameters that contradict each other have no outputs, nor has what has no solution. */
static void refresh_outputs(Instance *m)
{
    int i;
    if (m->outputs_known) return;
    if (check_relations(m, "outputs") && !unsolved(m)) {
        model_outputs(m->s.x, m->z, m->s.u, m->s.p, m->c, m->y, m->dx);
        settle(m->y);
    } else {
        for (i = 0; i < NY; i++) m->y[i] = NAN;
        for (i = 0; i < NX; i++) m->dx[i] = NAN;
    }
    m->outputs_known = 1;
}

/* From here on iterations begin at the present solution. */
static void accept_algebra(Instance *m)
{
    if (!unsolved(m)) memcpy(m->s.z, m->z, sizeof m->s.z);
}

/* Something the outputs depend on has changed. */
static void changed(Instance *m)
{
    m->outputs_known = m->algebra_known = m->deviations_known = 0;
}

/* Where a value lies: NULL for a value the model calculates. */
static double *stored(Instance *m, fmi2ValueReference r)
{
    if (r < FIRST_U) return &m->s.x[r - FIRST_X];
    if (r < FIRST_Y) return &m->s.u[r - FIRST_U];
    if (r >= FIRST_P && r < FIRST_DX) return &m->s.own[r - FIRST_P];
    if (r >= FIRST_CHOICE && r < FIRST_SD) return &m->s.choice[r - FIRST_CHOICE];
    return NULL;
}

static double deviation_of(Instance *m, int i);

static double value_of(Instance *m, fmi2ValueReference r)
{
    const double *value = stored(m, r);
    if (value) return *value;
    if (r >= FIRST_SD) return deviation_of(m, r - FIRST_SD);
    m->outputs_wanted = 1;
    refresh_outputs(m);
    return r < FIRST_P ? m->y[r - FIRST_Y] : m->dx[r - FIRST_DX];
}

static int in_range(fmi2ValueReference r, double value)
{
    return isfinite(value) && value >= model_low[r] && value <= model_high[r];
}

/* What is wrong with a value; a value beyond its range would only show as a strange result far from its cause. */
static fmi2Status refuse_value(const Instance *m, const char *function, fmi2ValueReference r, double value)
{
    if (!isfinite(value)) return refuse(m, "%s: %s = %g is not finite.", function, model_names[r], value);
    return refuse(m, "%s: %s = %.10g%s is out of range. It must be %s%s.", function, model_names[r], value,
                  model_units[r], model_ranges[r], model_units[r]);
}

/* The first output or derivative outside its declared range or not finite; N_VARIABLES when all are well. */
static int wrong_result(Instance *m)
{
    int i;
    refresh_outputs(m);
    for (i = 0; i < NY; i++)
        if (!in_range(FIRST_Y + i, m->y[i])) return FIRST_Y + i;
    for (i = 0; i < NX; i++)
        if (!in_range(FIRST_DX + i, m->dx[i])) return FIRST_DX + i;
    return N_VARIABLES;
}

/* Whether the range of a law argument was told of before: a part may use a law several times, such as for each face. */
static int told(const Instance *m, int check)
{
    int i;
    for (i = 0; i < NK; i++)
        if (m->warned[i] && strcmp(model_checks[i], model_checks[check]) == 0) return 1;
    return 0;
}

/* Law arguments outside the range of their source are told once each. */
static void warn_validity(Instance *m)
{
    double argument[AT_LEAST_1(NK)];
    int i, again;
    if (NK == 0 || !(m->log_mask & (1u << LOG_WARNING))) return;
    refresh_constants(m);
    if (unsolved(m)) return;
    model_arguments(m->s.x, m->z, m->s.u, m->s.p, m->c, argument);
    for (i = 0; i < NK; i++) {
        if (m->warned[i] || !(argument[i] < model_check_low[i] || argument[i] > model_check_high[i])) continue;
        again = told(m, i);
        m->warned[i] = 1;
        if (again) continue;
        note(m, fmi2Warning, LOG_WARNING, "%s = %.6g is outside %.6g .. %.6g at t = %.10g s.", model_checks[i],
             argument[i], model_check_low[i], model_check_high[i], m->s.time);
    }
}
