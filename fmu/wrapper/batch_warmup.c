/* Warm-ups by the adaptive solver of the FMU. The states behind the model's own are its audit's. */

enum { STORED = N_OUTPUTS, OUTSIDE = N_OUTPUTS + 2 };

/* The course of a warm-up, the same for all rows: m pieces; inputs that are not scheduled keep the row's value.
   before[k] and after[k] rows are kept at the beginning of piece k, before and after its inputs are set. */
typedef struct {
    int64_t m;
    const double *length, *value, *slope;
    const int32_t *scheduled, *before, *after;
    double tolerance;
} Course;

typedef struct {
    double *x, *y;             /* where the next kept row goes */
    double outside;            /* largest number of law arguments out of range */
} Kept;

static void keep(Instance *m, int count, Kept *kept)
{
    for (; count > 0; count--) {
        refresh_outputs(m);
        memcpy(kept->x, m->s.x, N * sizeof(double));
        memcpy(kept->y, m->y, N_OUTPUTS * sizeof(double));
        kept->outside = fmax(kept->outside, m->y[OUTSIDE]);
        kept->x += N;
        kept->y += N_OUTPUTS;
    }
}

static void set_inputs(Instance *m, const Course *course, int64_t k)
{
    int i;
    for (i = 0; i < NU; i++) {
        double value = course->value[k * NU + i];
        if (!course->scheduled[i]) continue;
        m->s.slope[i] = course->slope[k * NU + i];
        if (fabs(value - m->s.u[i]) > 1e-6 * (fabs(m->s.u[i]) + model_nominal[FIRST_U + i])) m->s.jumped = 1;
        m->s.u[i] = value;
    }
    m->outputs_known = 0;
}

/* One warm-up of an instance whose states, inputs and parameters are set. The energy that came in, that the states
   gained, and the throughput [J] go to energy. */
static int warm_up(Instance *m, const Course *course, Kept *kept, double *energy, int32_t *steps)
{
    double begin;
    int64_t k;
    set_inputs(m, course, 0);
    m->s.jumped = 1;
    refresh_outputs(m);
    begin = m->y[STORED];
    if (!all_finite(m->dx, NX)) return ROW_NOT_FINITE;
    for (k = 0; k < course->m; k++) {
        Walk w;
        int walked;
        keep(m, course->before[k], kept);
        if (k > 0) set_inputs(m, course, k);
        keep(m, course->after[k], kept);
        walked = walk(m, course->length[k], &w);
        m->outputs_known = 0;
        *steps += (int32_t)(w.accepted + w.rejected);
        if (!walked) return ROW_STOPPED;
    }
    keep(m, course->before[k], kept);
    refresh_outputs(m);
    energy[0] = m->s.x[SUPPLIED];
    energy[1] = m->y[STORED] - begin;
    energy[2] = m->s.x[THROUGHPUT];
    return ROW_OK;
}

/* Warm-ups of n rows. x takes N numbers a row and time, y N_OUTPUTS; energy takes what came in, what was gained, the
   throughput [J], and the largest number of law arguments out of range. */
BATCH_EXPORT int batch_warmup(int64_t n, const Course *course, const double *u, int64_t u_stride, const double *p,
                              int64_t p_stride, const double *start, int64_t start_stride, int64_t times, double *x,
                              double *y, double *energy, int32_t *status, int32_t *steps)
{
    Instance *m = calloc(1, sizeof *m);
    int64_t row;
    if (!m) return 0;
    for (row = 0; row < n; row++) {
        double *x_row = x + row * times * N, *y_row = y + row * times * N_OUTPUTS;
        Kept kept = {x_row, y_row, 0.0};
        memset(&m->s, 0, sizeof m->s);
        memcpy(m->s.x, start + row * start_stride, N * sizeof(double));
        memcpy(m->s.u, u + row * u_stride, NU * sizeof(double));
        memcpy(m->s.p, p + row * p_stride, NP * sizeof(double));
        m->s.tolerance = course->tolerance;
        m->constants_known = row > 0 && p_stride == 0;
        steps[row] = 0;
        status[row] = warm_up(m, course, &kept, energy + 4 * row, steps + row);
        energy[4 * row + 3] = kept.outside;
        if (status[row] == ROW_OK) continue;
        nothing(x_row, times * N);
        nothing(y_row, times * N_OUTPUTS);
        nothing(energy + 4 * row, 4);
    }
    free(m);
    return 1;
}
