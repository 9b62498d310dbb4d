/* Advance over a communication step; 0 where it does not arrive, for the caller to go back. A held input that jumps makes
   a boundary layer behind the communication point, so the size that fitted there last time is remembered beside the size
   that fitted at the end. In real time all steps are alike, as many as the communication step asks for. */
static int advance(Instance *m, double length, Advance *w)
{
    State *s = &m->s;
    double x[AT_LEAST_1(NX)], x_new[AT_LEAST_1(NX)], u[AT_LEAST_1(NU)], z[AT_LEAST_1(NZ)], z_new[AT_LEAST_1(NZ)] = {0.0};
    double t = 0.0, first = 0.0, h = s->jumped ? s->h_first : s->h_last;
    double alike = REAL_TIME > 0.0 ? length / fmax(1.0, ceil(length / REAL_TIME - 1e-6)) : 0.0;
    int i;
    memset(w, 0, sizeof *w);
    refresh_constants(m);
    if ((w->block = unsolved(m)) != NULL) return 0;
    memcpy(x, s->x, sizeof x);
    memcpy(z, m->z, sizeof z);
    memcpy(u, s->u, sizeof u);
    if (REAL_TIME > 0.0) h = alike;
    if (!(h > 0.0)) h = length;
    while (t < length) {
        double left = length - t;
        int last = h * (1 + 1e-9) >= left;
        double size = last ? left : 2 * h > left ? left / 2 : h;
        double error = trial(m, x, z, u, size, x_new, z_new, &w->worst);
        if (REAL_TIME > 0.0 && isfinite(error)) error = 0.0; /* what it comes to was measured by the export */
        h = next_size(&w->effort, error, size, h, length);
        if (error <= 1.0) {
            move_states(m, x, z, u, size, x_new, z_new);
            t = last ? length : t + size;
            memcpy(x, x_new, sizeof x);
            memcpy(z, z_new, sizeof z);
            for (i = 0; i < NU; i++) u[i] = s->u[i] + s->slope[i] * t;
            if (first == 0.0) first = h;
            w->reached = t;
        }
        if (REAL_TIME > 0.0 && h > 0.0) h = error <= 1.0 ? alike : 0.0;
        if (h == 0.0 && t < length) return 0;
    }
    memcpy(s->x, x, sizeof x);
    memcpy(s->z, z, sizeof z);
    memcpy(s->u, u, sizeof u);
    if (length > 0.0) changed(m);
    if ((w->block = unsolved(m)) != NULL) return 0;
    accept_algebra(m);
    s->h_first = first;
    s->h_last = h;
    s->jumped = 0;
    return 1;
}
