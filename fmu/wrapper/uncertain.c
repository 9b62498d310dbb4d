/* Standard deviations from uncertain parameters. Beside the states their sensitivities along the leading directions of the
   uncertainty are integrated: ds/dt = J s + F, with J and F of the middle of each accepted step.

   In a mixture this holds for all directions but the first. Along that the model itself runs at the nodes of Gauss and
   Hermite's rule for three points, 0 and +-sqrt(3) standard deviations: the instance and the two behind it. */

/* Let the instances behind this one have its inputs, and its parameters as they are at their nodes; before the run its
   states, too. */
static void follow(Instance *m)
{
    int before_run = m->s.mode & (INSTANTIATED | INITIALIZATION), k, i;
    for (k = 1; k <= N_SIDES; k++) {
        Instance *side = m + k;
        State own = side->s;
        memcpy(&side->s, &m->s, sizeof m->s);
        for (i = 0; i < NP; i++) {
            int at = (k - 1) * NP + i;
            double p = m->s.p[i] * model_side_factors[at] + model_side_shifts[at];
            side->s.p[i] = fmin(fmax(p, model_low[FIRST_P + i]), model_high[FIRST_P + i]);
        }
        if (before_run) {
            for (i = 0; i < NS; i++) side->s.x[i] += model_side_states[(k - 1) * NS + i];
        } else {
            memcpy(side->s.x, own.x, sizeof own.x);
            memcpy(side->s.z, own.z, sizeof own.z);
            memcpy(side->s.s, own.s, sizeof own.s);
            side->s.h_first = own.h_first;
            side->s.h_last = own.h_last;
        }
        if (memcmp(side->s.p, own.p, sizeof own.p) != 0) side->constants_known = 0;
        if (before_run || !side->constants_known || memcmp(side->s.u, own.u, sizeof own.u) != 0) changed(side);
    }
}

/* How parameters and constants move along each direction: in proportion to the value a parameter has now. */
static void refresh_directions(Instance *m)
{
    int k, i;
    refresh_constants(m);
    if (m->directions_known) return;
    for (k = 0; k < ND; k++) {
        double *p_dot = m->p_dot + k * NP;
        for (i = 0; i < NP; i++) {
            double at = model_start[FIRST_P + i];
            p_dot[i] = model_directions[k * NP + i] * (at != 0.0 ? m->s.p[i] / at : 1.0);
        }
        model_constants_directional(m->s.p, p_dot, m->c_dot + k * NC);
    }
    m->directions_known = 1;
}

/* The sensitivities over an accepted step of size h from x, z, u. */
static void move_states(Instance *m, const double *x, const double *z, const double *u, double h, const double *x_new,
                        const double *z_new)
{
    double x_mid[AT_LEAST_1(NX)], z_mid[AT_LEAST_1(NZ)] = {0.0}, u_mid[AT_LEAST_1(NU)], s[AT_LEAST_1(ND * NS)];
    int i;
    refresh_directions(m);
    for (i = 0; i < NX; i++) x_mid[i] = (x[i] + x_new[i]) / 2;
    for (i = 0; i < NZ; i++) z_mid[i] = (z[i] + z_new[i]) / 2;
    for (i = 0; i < NU; i++) u_mid[i] = u[i] + m->s.slope[i] * h / 2;
    memcpy(s, m->s.s, sizeof s);
    model_move(x_mid, z_mid, u_mid, m->s.p, m->c, m->p_dot, m->c_dot, &h, s, m->s.s);
}

/* The linear standard deviations at a node; parameters that contradict each other have none, nor has what has no
   solution. */
static void deviate(Instance *m, double *deviation)
{
    int k;
    refresh_directions(m);
    if (check_relations(m, "outputs") && !unsolved(m))
        model_deviations(m->s.x, m->z, m->s.u, m->s.p, m->c, m->p_dot, m->c_dot, m->s.s, deviation);
    else
        for (k = 0; k < NSD; k++) deviation[k] = NAN;
}

/* The value at a node of what has a standard deviation. */
static double value_at_node(Instance *m, int i)
{
    int r = model_deviating[i];
    if (r < FIRST_U) return m->s.x[r];
    refresh_outputs(m);
    return m->y[r - FIRST_Y];
}

/* The standard deviation of a mixture: what its nodes have in common, and how far they lie apart. */
static double deviation_of(Instance *m, int i)
{
    double linear[1 + N_SIDES][AT_LEAST_1(NSD)];
    int k, j;
    if (m->deviations_known) return m->deviation[i];
    follow(m);
    for (k = 0; k <= N_SIDES; k++) deviate(m + k, linear[k]);
    memcpy(m->deviation, linear[0], sizeof m->deviation);
    for (j = 0; j < NSD && N_SIDES > 0; j++) {
        double variance = 0.0, mean = 0.0;
        for (k = 0; k <= N_SIDES; k++) {
            double weight = k == 0 ? 2.0 / 3.0 : 1.0 / 6.0, apart = value_at_node(m + k, j) - value_at_node(m, j);
            mean += weight * apart;
            variance += weight * (linear[k][j] * linear[k][j] + apart * apart);
        }
        m->deviation[j] = sqrt(fmax(variance - mean * mean, 0.0));
    }
    m->deviations_known = 1;
    return m->deviation[i];
}
