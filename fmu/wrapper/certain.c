/* An FMU without standard deviations. */

static void move_states(Instance *m, const double *x, const double *z, const double *u, double h, const double *x_new,
                        const double *z_new)
{
    (void)m, (void)x, (void)z, (void)u, (void)h, (void)x_new, (void)z_new;
}

static void follow(Instance *m) { (void)m; }

static double deviation_of(Instance *m, int i)
{
    (void)m, (void)i;
    return NAN;
}
