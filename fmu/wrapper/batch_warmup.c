/* Warm-ups by the adaptive solver of the FMU. The states behind the model's own are its audit's.

   A step costs far more than deciding on it, so the trial steps of some rows are made together, one in each lane. Every
   row keeps its own time, step size and piece of the duty, and the next row takes over the lane of one that is done.
   Which rows share a call changes nothing in any of them. */

enum { STORED = N_OUTPUTS, OUTSIDE = N_OUTPUTS + 2 };

/* The duty of a warm-up, the same for all rows: m pieces; inputs that are not scheduled keep the row's value.
   before[k] and after[k] rows are kept at the beginning of piece k, before and after its inputs are set. */
typedef struct {
    int64_t m;
    const double *length, *value, *slope;
    const int32_t *scheduled, *before, *after;
    double tolerance;
} Duty;

typedef struct {
    double *x, *y;             /* where the next kept row goes */
    double outside;            /* largest number of law arguments out of range */
} Kept;

/* Keep a row some times; 0 where an implicit equation has no solution there. */
static int keep(Instance *m, int count, Kept *kept)
{
    for (; count > 0; count--) {
        if (!refresh_outputs(m)) return 0;
        memcpy(kept->x, m->s.x, N * sizeof(double));
        memcpy(kept->y, m->y, N_OUTPUTS * sizeof(double));
        kept->outside = fmax(kept->outside, m->y[OUTSIDE]);
        kept->x += N;
        kept->y += N_OUTPUTS;
    }
    return 1;
}

static void set_inputs(Instance *m, const Duty *duty, int64_t k)
{
    int i;
    for (i = 0; i < NU; i++) {
        double value = duty->value[k * NU + i];
        if (!duty->scheduled[i]) continue;
        m->s.slope[i] = duty->slope[k * NU + i];
        if (fabs(value - m->s.u[i]) > 1e-6 * (fabs(m->s.u[i]) + model_nominal[FIRST_U + i])) m->s.jumped = 1;
        m->s.u[i] = value;
    }
    changed(m);
}

/* A row on its way. */
typedef struct {
    Instance m;
    Kept kept;
    int64_t row, piece;        /* which row; the piece of the duty it is in, m when it is done */
    double begin;              /* stored energy at the start */
    double x[NX], z[AT_LEAST_1(NZ)], u[AT_LEAST_1(NU)];   /* where the next trial begins */
    double t, h, first, size;  /* in the piece: time, step proposed, the one proposed first, the one tried */
    int last;                  /* the trial leads to the end of the piece */
    Effort effort;             /* in the piece */
    int32_t steps;
    int fresh;                 /* its parameters are not in its lane yet */
} Runner;

/* The arguments of batch_warmup, and the next row to begin with. */
typedef struct {
    int64_t n;
    const Duty *duty;
    const double *u;
    int64_t u_stride;
    const double *p;
    int64_t p_stride;
    const double *start;
    int64_t start_stride, times;
    double *x, *y, *energy;
    int32_t *status, *steps;
    int64_t next;
} Rows;

/* What lanes_step takes and gives. */
typedef struct {
    lanes x[NX], z[AT_LEAST_1(NZ)], u[AT_LEAST_1(NU)], slope[AT_LEAST_1(NU)], p[AT_LEAST_1(NP)], c[AT_LEAST_1(NC)], h;
    lanes x_new[NX], z_new[AT_LEAST_1(NZ)], error[N_CONTROLLED];
} Beside;

/* What becomes of a row that is not done. */
enum { ROW_UNDER_WAY = -1 };

/* Begin a piece of the duty as advance() begins a communication step. */
static void depart(Runner *r, double length)
{
    State *s = &r->m.s;
    memcpy(r->x, s->x, sizeof r->x);
    memcpy(r->z, s->z, sizeof r->z);
    memcpy(r->u, s->u, sizeof r->u);
    r->t = r->first = 0.0;
    r->h = s->jumped ? s->h_first : s->h_last;
    if (!(r->h > 0.0)) r->h = length;
    memset(&r->effort, 0, sizeof r->effort);
}

static void arrive(Runner *r)
{
    State *s = &r->m.s;
    memcpy(s->x, r->x, sizeof r->x);
    memcpy(s->z, r->z, sizeof r->z);
    memcpy(s->u, r->u, sizeof r->u);
    s->h_first = r->first;
    s->h_last = r->h;
    s->jumped = 0;
    changed(&r->m);
}

/* To the next trial step, through the ends of pieces; or to the end of the duty, where the energy that came in, that
   the states gained, and the throughput [J] are left. */
static int proceed(Runner *r, const Duty *duty, double *energy)
{
    Instance *m = &r->m;
    double left, length;
    while (length = duty->length[r->piece], !(r->t < length)) {
        arrive(r);
        r->piece++;
        if (!keep(m, duty->before[r->piece], &r->kept)) return ROW_NO_SOLUTION;
        if (r->piece == duty->m) {
            if (!refresh_outputs(m)) return ROW_NO_SOLUTION;
            energy[0] = m->s.x[SUPPLIED];
            energy[1] = m->y[STORED] - r->begin;
            energy[2] = m->s.x[THROUGHPUT];
            return ROW_OK;
        }
        set_inputs(m, duty, r->piece);
        if (!keep(m, duty->after[r->piece], &r->kept) || !refresh_algebra(m)) return ROW_NO_SOLUTION;
        depart(r, duty->length[r->piece]);
    }
    left = length - r->t;
    r->last = r->h * (1 + 1e-9) >= left;
    r->size = r->last ? left : 2 * r->h > left ? left / 2 : r->h;
    return ROW_UNDER_WAY;
}

/* From an instance whose states, inputs and parameters are set to its first trial step. */
static int start_out(Runner *r, const Duty *duty, double *energy)
{
    Instance *m = &r->m;
    m->s.tolerance = duty->tolerance;
    r->piece = 0;
    set_inputs(m, duty, 0);
    m->s.jumped = 1;
    memcpy(m->s.z, model_z_start, NZ * sizeof(double));
    changed(m);
    if (!refresh_outputs(m)) return ROW_NO_SOLUTION;
    r->begin = m->y[STORED];
    if (!all_finite(m->dx, NX)) return ROW_NOT_FINITE;
    keep(m, duty->before[0] + duty->after[0], &r->kept);
    depart(r, duty->length[0]);
    return proceed(r, duty, energy);
}

/* Take or refuse the trial step in a lane, as advance() does. */
static int conclude(Runner *r, const Beside *b, int lane, const Duty *duty, double *energy)
{
    double x_new[NX + N_CONTROLLED], z_new[AT_LEAST_1(NZ)] = {0.0}, length = duty->length[r->piece], error;
    int worst, i;
    for (i = 0; i < NX; i++) x_new[i] = b->x_new[i][lane];
    for (i = 0; i < N_CONTROLLED; i++) x_new[NX + i] = b->error[i][lane];
    for (i = 0; i < NZ; i++) z_new[i] = b->z_new[i][lane];
    error = trial(&r->m, r->x, r->z, r->u, r->size, x_new, z_new, &worst);
    r->steps++;
    r->h = next_size(&r->effort, error, r->size, r->h, length);
    if (error <= 1.0) {
        r->t = r->last ? length : r->t + r->size;
        memcpy(r->x, x_new, sizeof r->x);
        memcpy(r->z, z_new, sizeof r->z);
        for (i = 0; i < NU; i++) r->u[i] = r->m.s.u[i] + r->m.s.slope[i] * r->t;
        if (r->first == 0.0) r->first = r->h;
    }
    return r->h == 0.0 && r->t < length ? ROW_STOPPED : proceed(r, duty, energy);
}

static void put(Beside *b, int lane, const Runner *r)
{
    const State *s = &r->m.s;
    int i;
    for (i = 0; i < NX; i++) b->x[i][lane] = r->x[i];
    for (i = 0; i < NZ; i++) b->z[i][lane] = r->z[i];
    for (i = 0; i < NU; i++) b->u[i][lane] = r->u[i];
    for (i = 0; i < NU; i++) b->slope[i][lane] = s->slope[i];
    b->h[lane] = r->size;
    if (!r->fresh) return;
    for (i = 0; i < NP; i++) b->p[i][lane] = s->p[i];
    for (i = 0; i < NC; i++) b->c[i][lane] = r->m.c[i];
}

static int open_row(Runner *r, Rows *rows)
{
    Instance *m = &r->m;
    int64_t row = r->row = rows->next++;
    r->kept = (Kept){rows->x + row * rows->times * N, rows->y + row * rows->times * N_OUTPUTS, 0.0};
    memset(&m->s, 0, sizeof m->s);
    memcpy(m->s.x, rows->start + row * rows->start_stride, N * sizeof(double));
    memcpy(m->s.u, rows->u + row * rows->u_stride, NU * sizeof(double));
    memcpy(m->s.p, rows->p + row * rows->p_stride, NP * sizeof(double));
    m->constants_known = m->constants_known && rows->p_stride == 0;
    r->steps = 0;
    r->fresh = 1;
    return start_out(r, rows->duty, rows->energy + 4 * row);
}

static void close_row(const Runner *r, Rows *rows, int outcome)
{
    int64_t row = r->row;
    rows->status[row] = outcome;
    rows->steps[row] = r->steps;
    rows->energy[4 * row + 3] = r->kept.outside;
    if (outcome == ROW_OK) return;
    nothing(rows->x + row * rows->times * N, rows->times * N);
    nothing(rows->y + row * rows->times * N_OUTPUTS, rows->times * N_OUTPUTS);
    nothing(rows->energy + 4 * row, 4);
}

/* After an outcome of a lane's row, with the row or with those after it, to a trial step; 0 when there are no more. */
static int carry_on(Runner *r, Rows *rows, int outcome)
{
    while (outcome != ROW_UNDER_WAY) {
        close_row(r, rows, outcome);
        if (rows->next == rows->n) return 0;
        outcome = open_row(r, rows);
    }
    return 1;
}

static void run_rows(Rows *rows, Runner *runner)
{
    Beside b;
    int busy[LANES] = {0}, lanes_busy = 0, lane;
    memset(&b, 0, sizeof b);
    for (lane = 0; lane < LANES && rows->next < rows->n; lane++)
        lanes_busy += busy[lane] = carry_on(&runner[lane], rows, open_row(&runner[lane], rows));
    while (lanes_busy > 0) {
        /* A lane that never had a row mirrors the first one: zeros might take long. */
        for (lane = 0; lane < LANES; lane++) put(&b, lane, &runner[lane < rows->n ? lane : 0]);
        for (lane = 0; lane < LANES; lane++) runner[lane].fresh = 0;
        lanes_step(b.x, b.z, b.u, b.slope, b.p, b.c, &b.h, b.x_new, b.z_new, b.error);
        for (lane = 0; lane < LANES; lane++) {
            Runner *r = &runner[lane];
            if (!busy[lane]) continue;
            busy[lane] = carry_on(r, rows, conclude(r, &b, lane, rows->duty, rows->energy + 4 * r->row));
            lanes_busy -= !busy[lane];
        }
    }
}

/* Warm-ups of n rows. x takes N numbers a row and time, y N_OUTPUTS; energy takes what came in, what was gained, the
   throughput [J], and the largest number of law arguments out of range. */
BATCH_EXPORT int batch_warmup(int64_t n, const Duty *duty, const double *u, int64_t u_stride, const double *p,
                              int64_t p_stride, const double *start, int64_t start_stride, int64_t times, double *x,
                              double *y, double *energy, int32_t *status, int32_t *steps)
{
    Rows rows = {n, duty, u, u_stride, p, p_stride, start, start_stride, times, x, y, energy, status, steps, 0};
    Runner *runner = calloc(LANES, sizeof *runner);
    if (!runner) return 0;
    run_rows(&rows, runner);
    free(runner);
    return 1;
}
