/* Many rows in one call. A warm-up walks with the solver of the FMU; a steady state is sought by Newton's method with
   the natural monotonicity test, then by following the machine to rest, then by leading the inputs there, as one would
   by hand (Deuflhard 2004, section 3.3). Every row stands for itself: it knows nothing of the rows before it, so rows
   may be cut into blocks, shared among threads and computed again in any order with the same bits. */

#include <complex.h>

#if defined _WIN32
#define BATCH_EXPORT __declspec(dllexport)
#else
#define BATCH_EXPORT __attribute__((visibility("default")))
#endif

/* N states and N_OUTPUTS outputs are the model's own; the FMU's outputs go on with the stored energy. */
enum { N = NX - 2, N1 = AT_LEAST_1(N), STORED = N_OUTPUTS, OUTSIDE = N_OUTPUTS + 2 };

/* What became of a row; the same numbers as gearheat.fmu.batch.Status. */
enum { ROW_OK, ROW_NO_BALANCE, ROW_UNSTABLE, ROW_NOT_FINITE, ROW_STOPPED };

/* Sizes of steps are counted in nominals of the states. */
#define CONVERGED 1e-10        /* a root is found when the next correction is below this */
#define ROUND_OFF 1e-7         /* corrections below this that no longer shrink are round-off */
#define CHORD 1e-3             /* corrections below this keep the Jacobian ... */
#define CHORD_GAIN 0.1         /* ... as long as the next one is shorter by this */
#define LEAST_DAMPING 1e-5
#define CAUTION 0.3            /* a relaxation step is at most this share of the time in which a deviation grows by e */
#define FAR 5.0                /* and this many nominals long */
#define LONGEST 1e9            /* relaxation ends where steps this long [s] change nothing */
#define SHORTEST 1e-12
#define LEAST_STRIDE 1e-3      /* of the inputs' way */
enum { MOST_NEWTON = 50, MOST_EULER = 8, MOST_RELAX = 300, MOST_LED = 15, MOST_ROTATIONS = 60 };

typedef struct {
    const double *u, *p, *home;
    double k[AT_LEAST_1(NK_REST)], c[AT_LEAST_1(NC_REST)];
    double r[N1], r_new[N1], d[N1], d_new[N1], trial[N1], before[N1];
    double J[N1 * N1], J_new[N1 * N1], lu[N1 * N1];
    double complex h[N1 * N1];
    double led[AT_LEAST_1(NU)];
    int pivot[N1];
    double euler;              /* length of an implicit Euler step [s], 0 for the steady equations */
    int steps;
} Row;

static int finite(const double *v, int n)
{
    int i;
    for (i = 0; i < n; i++)
        if (!isfinite(v[i])) return 0;
    return 1;
}

static double size(const double *d)
{
    double most = 0.0;
    int i;
    for (i = 0; i < N; i++) most = fmax(most, fabs(d[i]) / model_nominal[FIRST_X + i]);
    return most;
}

/* Largest part of a step that stays inside the states' ranges and is not wild: ten nominals and half the value. */
static double share(const double *z, const double *d)
{
    double least = 1.0;
    int i;
    for (i = 0; i < N; i++) {
        double room = d[i] > 0 ? model_high[FIRST_X + i] - z[i] : z[i] - model_low[FIRST_X + i];
        double most = fmin(0.9 * room, 10 * model_nominal[FIRST_X + i] + 0.5 * fabs(z[i]));
        if (d[i] != 0) least = fmin(least, most / fabs(d[i]));
    }
    return least;
}

/* The residual at z, and its Jacobian by columns unless J is NULL. */
static void evaluate(Row *w, const double *z, double *r, double *J)
{
    int i;
    if (J) rest_balance(z, w->u, w->p, w->k, w->c, r, J);
    else rest_rates(z, w->u, w->p, w->k, w->c, r);
    if (w->euler == 0.0) return;
    for (i = 0; i < N; i++) r[i] = (z[i] - w->before[i]) / w->euler - r[i];
    if (!J) return;
    for (i = 0; i < N * N; i++) J[i] = (i % (N1 + 1) == 0 ? 1 / w->euler : 0.0) - J[i];
}

/* LU of w->J with row exchanges into w->lu; 0 where it is singular or not finite. */
static int factor_matrix(Row *w)
{
    double *a = w->lu;
    int i, j, k;
    if (!finite(w->J, N * N)) return 0;
    memcpy(a, w->J, sizeof w->lu);
    for (k = 0; k < N; k++) {
        int best = k;
        for (i = k + 1; i < N; i++)
            if (fabs(a[i + k * N]) > fabs(a[best + k * N])) best = i;
        if (a[best + k * N] == 0.0) return 0;
        w->pivot[k] = best;
        if (best != k)
            for (j = 0; j < N; j++) {
                double swap = a[k + j * N];
                a[k + j * N] = a[best + j * N];
                a[best + j * N] = swap;
            }
        for (i = k + 1; i < N; i++) a[i + k * N] /= a[k + k * N];
        for (j = k + 1; j < N; j++)
            for (i = k + 1; i < N; i++) a[i + j * N] -= a[i + k * N] * a[k + j * N];
    }
    return 1;
}

/* d = -J^-1 r with the factors at hand; 0 where it is not finite. */
static int correction(const Row *w, const double *r, double *d)
{
    const double *a = w->lu;
    int i, k;
    for (i = 0; i < N; i++) d[i] = -r[i];
    for (k = 0; k < N; k++) {
        double swap = d[w->pivot[k]];
        d[w->pivot[k]] = d[k];
        d[k] = swap;
    }
    for (k = 0; k < N; k++)
        for (i = k + 1; i < N; i++) d[i] -= a[i + k * N] * d[k];
    for (k = N - 1; k >= 0; k--) {
        d[k] /= a[k + k * N];
        for (i = 0; i < k; i++) d[i] -= a[i + k * N] * d[k];
    }
    return finite(d, N);
}

/* Corrections with the Jacobian that is there while they shrink fast: 1 at a root, 0 where a new Jacobian is due,
   taken at z. On entry w->d is the correction at z and short. */
static int chord(Row *w, double *z)
{
    double length = size(w->d);
    int i;
    for (;;) {
        for (i = 0; i < N; i++) w->trial[i] = z[i] + w->d[i];
        evaluate(w, w->trial, w->r_new, NULL);
        if (!correction(w, w->r_new, w->d_new) || size(w->d_new) > CHORD_GAIN * length) return 0;
        w->steps++;
        length = size(w->d_new);
        memcpy(z, w->trial, sizeof w->trial);
        memcpy(w->d, w->d_new, sizeof w->d);
        if (length > CONVERGED) continue;
        for (i = 0; i < N; i++) z[i] += w->d[i];
        return 1;
    }
}

/* Newton's method from z, where w->r and w->J are known; 1 at a root. */
static int newton_from_here(Row *w, double *z, int most)
{
    double damping = 1.0;
    int step, i;
    for (step = 0; step < most; step++) {
        double length;
        if (!finite(w->r, N) || !factor_matrix(w) || !correction(w, w->r, w->d)) return 0;
        length = size(w->d);
        if (length <= CONVERGED) {
            for (i = 0; i < N; i++) z[i] += w->d[i];
            return 1;
        }
        damping = fmin(damping, share(z, w->d));
        if (damping == 1.0 && length <= CHORD) {
            if (chord(w, z)) return 1;
            evaluate(w, z, w->r, w->J);
            if (!finite(w->r, N) || !factor_matrix(w) || !correction(w, w->r, w->d)) return 0;
            length = size(w->d);
            if (length <= CONVERGED) continue;
        }
        for (;;) {
            int sound;
            for (i = 0; i < N; i++) w->trial[i] = z[i] + damping * w->d[i];
            evaluate(w, w->trial, w->r_new, w->J_new);
            sound = correction(w, w->r_new, w->d_new);
            if (sound && size(w->d_new) <= (1 - damping / 4) * length) break;
            if (length <= ROUND_OFF) return 1;
            damping /= sound ? 2 : 8;
            if (damping < LEAST_DAMPING) return 0;
        }
        w->steps++;
        memcpy(z, w->trial, sizeof w->trial);
        memcpy(w->r, w->r_new, sizeof w->r);
        memcpy(w->J, w->J_new, sizeof w->J);
        damping = fmin(1.0, 4 * damping);
    }
    return 0;
}

static int newton(Row *w, double *z, int most)
{
    evaluate(w, z, w->r, w->J);
    return newton_from_here(w, z, most);
}

/* A matrix without negative terms off its diagonal is stable if and only if its negative has positive pivots; heat that
   flows through conductors makes such a one. 1 where this shows that J is stable. */
static int heat_holds(Row *w, const double *J)
{
    double *a = w->lu;
    int i, j, k;
    for (i = 0; i < N * N; i++) {
        if (i % (N1 + 1) != 0 && J[i] < 0.0) return 0;
        a[i] = -J[i];
    }
    for (k = 0; k < N; k++) {
        if (!(a[k + k * N] > 0.0)) return 0;
        for (j = k + 1; j < N; j++)
            for (i = k + 1; i < N; i++) a[i + j * N] -= a[i + k * N] / a[k + k * N] * a[k + j * N];
    }
    return 1;
}

/* J with the states in nominals as a Hessenberg matrix, by elimination with row exchanges. */
static void hessenberg(const double *J, double complex *h)
{
    int i, j, k;
    for (j = 0; j < N; j++)
        for (i = 0; i < N; i++)
            h[i + j * N] = J[i + j * N] * (model_nominal[FIRST_X + j] / model_nominal[FIRST_X + i]);
    for (k = 1; k < N - 1; k++) {
        int best = k;
        for (i = k + 1; i < N; i++)
            if (cabs(h[i + (k - 1) * N]) > cabs(h[best + (k - 1) * N])) best = i;
        if (h[best + (k - 1) * N] == 0.0) continue;
        if (best != k) {
            double complex swap;
            for (j = 0; j < N; j++) swap = h[k + j * N], h[k + j * N] = h[best + j * N], h[best + j * N] = swap;
            for (i = 0; i < N; i++) swap = h[i + k * N], h[i + k * N] = h[i + best * N], h[i + best * N] = swap;
        }
        for (i = k + 1; i < N; i++) {
            double complex f = h[i + (k - 1) * N] / h[k + (k - 1) * N];
            if (f == 0.0) continue;
            for (j = 0; j < N; j++) h[i + j * N] -= f * h[k + j * N];
            for (j = 0; j < N; j++) h[j + k * N] += f * h[j + i * N];
        }
    }
}

/* One QR step with a shift on rows and columns low .. high of a Hessenberg matrix. */
static void rotate(double complex *h, int low, int high, double complex shift)
{
    double complex c = 1.0, s = 0.0, c_old = 1.0, s_old = 0.0;
    int i, j, k;
    for (i = low; i <= high; i++) h[i + i * N] -= shift;
    for (k = low; k <= high; k++) {
        c_old = c, s_old = s;
        if (k < high) {
            double complex a = h[k + k * N], b = h[k + 1 + k * N];
            double length = hypot(cabs(a), cabs(b));
            c = length > 0.0 ? a / length : 1.0, s = length > 0.0 ? b / length : 0.0;
            for (j = k; j <= high; j++) {
                double complex x = h[k + j * N], y = h[k + 1 + j * N];
                h[k + j * N] = conj(c) * x + conj(s) * y;
                h[k + 1 + j * N] = c * y - s * x;
            }
        }
        if (k > low)  /* the rotation before, from the right: its rows are complete now */
            for (i = low; i <= k; i++) {
                double complex x = h[i + (k - 1) * N], y = h[i + k * N];
                h[i + (k - 1) * N] = x * c_old + y * s_old;
                h[i + k * N] = y * conj(c_old) - x * conj(s_old);
            }
    }
    for (i = low; i <= high; i++) h[i + i * N] += shift;
}

/* The eigenvalue of the last two rows that is nearer to the last element. */
static double complex shift_of(const double complex *h, int high)
{
    double complex a = h[high - 1 + (high - 1) * N], b = h[high - 1 + high * N];
    double complex c = h[high + (high - 1) * N], d = h[high + high * N];
    double complex half = (a - d) / 2, root = csqrt(half * half + b * c);
    double complex far = cabs(half + root) > cabs(half - root) ? half + root : half - root;
    return far == 0.0 ? d : d - b * c / far;
}

/* Rate [1/s] at which a small deviation grows fastest for a Jacobian J; 0 below round-off. */
static double growth(Row *w, const double *J)
{
    double complex *h = w->h;
    double fastest = -INFINITY, largest = 0.0;
    int high = N - 1, tried = 0, i;
    if (N == 0 || !finite(J, N * N) || heat_holds(w, J)) return 0.0;
    hessenberg(J, h);
    while (high > 0) {
        int low = high;
        while (low > 0 && cabs(h[low + (low - 1) * N]) > 1e-16 * (cabs(h[low + low * N]) + cabs(h[low - 1 + (low - 1) * N])))
            low--;
        if (low == high || tried >= MOST_ROTATIONS) {
            high--;
            tried = 0;
            continue;
        }
        tried++;
        rotate(h, low, high, tried % 11 == 10 ? cabs(h[high + (high - 1) * N]) + h[high + high * N] : shift_of(h, high));
    }
    for (i = 0; i < N; i++) {
        fastest = fmax(fastest, creal(h[i + i * N]));
        largest = fmax(largest, cabs(h[i + i * N]));
    }
    return fastest > 1e-10 * largest ? fastest : 0.0;
}

/* Whether a machine stays at a balance with a Jacobian. */
static int stable(Row *w, const double *J)
{
    return finite(J, N * N) && growth(w, J) == 0.0;
}

/* Whether an Euler step went far: more than some nominals, or some tenths of the value where that is more. */
static int went_far(const Row *w, const double *z)
{
    int i;
    for (i = 0; i < N; i++) {
        double nominal = model_nominal[FIRST_X + i], from = w->before[i];
        if (fabs(z[i] - from) / (1 + fabs(from) / (10 * nominal)) > FAR * nominal) return 1;
    }
    return 0;
}

/* Follow the machine to rest from z by implicit Euler steps that grow as long as they are easy, short where the machine
   runs away from itself; 1 at a root. */
static int relax(Row *w, double *z)
{
    double step, runs, moved;
    int taken = 0;
    evaluate(w, z, w->r, w->J);
    if (!finite(w->r, N)) return 0;
    step = fmin(fmax(1 / fmax(size(w->r), 1e-12), 1e-6), 1e3);
    runs = growth(w, w->J);
    while (taken < MOST_RELAX && step > SHORTEST) {
        int began = w->steps, found, i;
        memcpy(w->before, z, sizeof w->before);
        step = fmin(step, CAUTION / fmax(runs, 1e-300));
        w->euler = step;
        found = newton(w, z, MOST_EULER);
        w->euler = 0.0;
        taken += w->steps > began ? w->steps - began : 1;
        if (!found || went_far(w, z)) {
            memcpy(z, w->before, sizeof w->before);
            step /= 4;
            continue;
        }
        for (i = 0; i < N; i++) w->d[i] = z[i] - w->before[i];
        moved = size(w->d);
        if (step >= LONGEST && moved < 1.0) return newton(w, z, MOST_NEWTON);
        evaluate(w, z, w->r, w->J);
        runs = growth(w, w->J);
        step = fmin(step * (w->steps - began <= 4 ? 5 : 2), 10 * LONGEST);
    }
    return 0;
}

/* Lead the inputs from the model's own to those given, in strides that adapt; 1 at a root. */
static int led(Row *w, double *z)
{
    const double *asked = w->u;
    double way = 0.0, stride = 0.25, kept[N1];
    int found, i, same = 1;
    for (i = 0; i < NU; i++) same = same && asked[i] == w->home[i];
    if (same) return 0;
    memcpy(w->led, w->home, sizeof w->led);
    w->u = w->led;
    rest_given(w->u, w->p, w->k, w->c);
    found = relax(w, z);
    while (found && way < 1.0 && stride > LEAST_STRIDE) {
        double aim = fmin(1.0, way + stride);
        memcpy(kept, z, sizeof kept);
        for (i = 0; i < NU; i++) w->led[i] = aim < 1.0 ? w->home[i] + aim * (asked[i] - w->home[i]) : asked[i];
        rest_given(w->u, w->p, w->k, w->c);
        if (newton(w, z, MOST_LED)) {
            way = aim;
            stride *= 2;
        } else {
            memcpy(z, kept, sizeof kept);
            stride /= 2;
        }
    }
    w->u = asked;
    rest_given(w->u, w->p, w->k, w->c);
    return found && way >= 1.0;
}

/* Whether nothing on the way from a start, where it is calm, to a balance would run away: else the machine decides by
   itself where it comes to rest. */
static int calm(Row *w, const double *start, const double *z)
{
    int quarter, i;
    for (quarter = 1; quarter < 4; quarter++) {
        for (i = 0; i < N; i++) w->trial[i] = start[i] + 0.25 * quarter * (z[i] - start[i]);
        evaluate(w, w->trial, w->r_new, w->J_new);
        if (!stable(w, w->J_new)) return 0;
    }
    return 1;
}

/* The balance a row comes to rest in, to z. */
static int settle(Row *w, const double *start, double *z)
{
    int quiet, finite_start, unstable = 0;
    w->steps = 0;
    w->euler = 0.0;
    memcpy(z, start, N * sizeof *z);
    evaluate(w, z, w->r, w->J);
    finite_start = finite(w->r, N);
    quiet = stable(w, w->J);
    if (newton_from_here(w, z, MOST_NEWTON)) {
        if (stable(w, w->J)) {
            double found[N1];
            if (quiet && calm(w, start, z)) return ROW_OK;
            memcpy(found, z, N * sizeof *z);
            memcpy(z, start, N * sizeof *z);
            if (!relax(w, z) || !stable(w, w->J)) memcpy(z, found, N * sizeof *z);
            return ROW_OK;
        }
        unstable = 1;
    }
    memcpy(z, start, N * sizeof *z);
    if (relax(w, z)) {
        if (stable(w, w->J)) return ROW_OK;
        unstable = 1;
    }
    memcpy(z, start, N * sizeof *z);
    if (led(w, z)) {
        if (stable(w, w->J)) return ROW_OK;
        unstable = 1;
    }
    return unstable ? ROW_UNSTABLE : finite_start ? ROW_NO_BALANCE : ROW_NOT_FINITE;
}

static void nothing(double *v, int64_t n)
{
    int64_t i;
    for (i = 0; i < n; i++) v[i] = NAN;
}

/* Steady states of n rows. A stride of 0 says that all rows share one vector. x takes N numbers a row, y NYR. */
BATCH_EXPORT int batch_steady(int64_t n, const double *u, int64_t u_stride, const double *p, int64_t p_stride,
                              const double *start, int64_t start_stride, const double *home, double *x, double *y,
                              int32_t *status, int32_t *iterations)
{
    Row *w = calloc(1, sizeof *w);
    int64_t row;
    if (!w) return 0;
    w->home = home;
    for (row = 0; row < n; row++) {
        double *z = x + row * N, *out = y + row * NYR;
        w->u = u + row * u_stride;
        if (row == 0 || p_stride) {
            w->p = p + row * p_stride;
            rest_fixed(w->p, w->k);
        }
        if (row == 0 || p_stride || u_stride) rest_given(w->u, w->p, w->k, w->c);
        status[row] = settle(w, start + row * start_stride, z);
        iterations[row] = w->steps;
        if (status[row] == ROW_OK) rest_outputs(z, w->u, w->p, w->k, w->c, out);
        if (status[row] == ROW_OK && finite(z, N)) continue;
        nothing(z, N);
        nothing(out, NYR);
    }
    free(w);
    return 1;
}

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
    if (!finite(m->dx, NX)) return ROW_NOT_FINITE;
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
