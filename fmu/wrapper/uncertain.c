/* Standard deviations from uncertain parameters. Beside the states their sensitivities along the leading directions of the
   uncertainty are integrated: ds/dt = J s + F, with J and F of the middle of each accepted step. */

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

/* A standard deviation; parameters that contradict each other have none, nor has what has no solution. */
static double deviation_of(Instance *m, int i)
{
    int k;
    if (!m->deviations_known) {
        refresh_directions(m);
        if (check_relations(m, "outputs") && !unsolved(m))
            model_deviations(m->s.x, m->z, m->s.u, m->s.p, m->c, m->p_dot, m->c_dot, m->s.s, m->deviation);
        else
            for (k = 0; k < NSD; k++) m->deviation[k] = NAN;
        m->deviations_known = 1;
    }
    return m->deviation[i];
}
