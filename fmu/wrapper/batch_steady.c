/* Steady states, sought as one would by hand: Newton's method, then following the machine to rest, then leading the
   inputs there (Deuflhard 2004, section 3.3). */

enum { N1 = AT_LEAST_1(N) };

/* Sizes of steps are counted in nominals of the states. */
#define CONVERGED 1e-10        /* a root is found when the next correction is below this */
#define ROUND_OFF 1e-7         /* corrections below this that no longer shrink are round-off */
#define CHORD 0.1              /* corrections below this keep the Jacobian ... */
#define CHORD_GAIN 0.2         /* ... as long as the next one is shorter by this */
#define NEAR 1.0               /* a way shorter than this is not watched */
#define LEAST_DAMPING 1e-5
#define CAUTION 0.3            /* a relaxation step is at most this share of the time in which a deviation grows by e */
#define FAR 5.0                /* and this many nominals long */
#define LONGEST 1e9            /* relaxation ends where steps this long [s] change nothing */
#define SHORTEST 1e-12
#define LEAST_STRIDE 1e-3      /* of the inputs' way */
enum { MOST_NEWTON = 50, MOST_CHORDS = 8, MOST_EULER = 8, MOST_RELAX = 300, MOST_LED = 15, MOST_ROTATIONS = 60 };

typedef struct {
    const double *u, *p, *home;
    double k[AT_LEAST_1(NK)], c[AT_LEAST_1(NC)];
    double r[N1], r_new[N1], d[N1], d_new[N1], trial[N1], before[N1];
    double entries[AT_LEAST_1(NJ)], J[N1 * N1], J_new[N1 * N1], lu[N1 * N1];
    double taken[MOST_CHORDS][N1];
    double complex h[N1 * N1];
    double led[AT_LEAST_1(NU)];
    int pivot[N1];
    double euler;              /* length of an implicit Euler step [s], 0 for the steady equations */
    int watched, quiet, heat;  /* see watch */
    int steps;
} Row;

static double size(const double *d)
{
    double most = 0.0;
    int i;
    for (i = 0; i < N; i++) most = fmax(most, fabs(d[i]) / model_nominal[i]);
    return most;
}

/* Largest part of a step that stays inside the states' ranges and is not wild: ten nominals and half the value. */
static double share(const double *z, const double *d)
{
    double least = 1.0;
    int i;
    for (i = 0; i < N; i++) {
        double room = d[i] > 0 ? model_high[i] - z[i] : z[i] - model_low[i];
        double most = fmin(0.9 * room, 10 * model_nominal[i] + 0.5 * fabs(z[i]));
        if (d[i] != 0) least = fmin(least, most / fabs(d[i]));
    }
    return least;
}

/* The residual at z, and its Jacobian by columns unless J is NULL. */
static void evaluate(Row *w, const double *z, double *r, double *J)
{
    int i;
    if (J) {
        model_balance(z, w->u, w->p, w->k, w->c, r, w->entries);
        memset(J, 0, sizeof w->J);
        for (i = 0; i < NJ; i++) J[model_row[i] + model_column[i] * N] = w->entries[i];
    } else {
        model_rates(z, w->u, w->p, w->k, w->c, r);
    }
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
    if (!all_finite(w->J, N * N)) return 0;
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
    return all_finite(d, N);
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
            h[i + j * N] = J[i + j * N] * (model_nominal[j] / model_nominal[i]);
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
    if (N == 0 || !all_finite(J, N * N) || heat_holds(w, J)) return 0.0;
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
    return all_finite(J, N * N) && growth(w, J) == 0.0;
}

static double product(const double *a, const double *b)
{
    double sum = 0.0;
    int i;
    for (i = 0; i < N; i++) sum += a[i] / model_nominal[i] * (b[i] / model_nominal[i]);
    return sum;
}

/* Newton's method without new Jacobians: Broyden's secant updates of the one at hand, kept as the steps taken (Kelley
   1995, section 7.3). 1 at a root, 0 where a new Jacobian is due, taken at z. On entry w->d is the correction at z. */
static int chord(Row *w, double *z)
{
    double square[MOST_CHORDS], length = size(w->d);
    int n, i, j;
    memcpy(w->taken[0], w->d, sizeof w->d);
    for (n = 0; n < MOST_CHORDS; n++) {
        const double *last = w->taken[n];
        double *d = w->d_new, pull;
        for (i = 0; i < N; i++) w->trial[i] = z[i] + last[i];
        evaluate(w, w->trial, w->r_new, NULL);
        if (!correction(w, w->r_new, d)) return 0;
        square[n] = product(last, last);
        for (j = 0; j < n; j++) {
            pull = product(w->taken[j], d) / square[j];
            for (i = 0; i < N; i++) d[i] += pull * w->taken[j + 1][i];
        }
        pull = product(last, d) / square[n];
        if (!(size(d) <= CHORD_GAIN * length)) return 0;
        for (i = 0; i < N; i++) d[i] /= 1 - pull;
        w->steps++;
        length = size(d);
        memcpy(z, w->trial, sizeof w->trial);
        if (length <= CONVERGED) {
            for (i = 0; i < N; i++) z[i] += d[i];
            return 1;
        }
        if (n + 1 < MOST_CHORDS) memcpy(w->taken[n + 1], d, sizeof w->d_new);
    }
    return 0;
}

/* Note whether a machine would stay calm at a Jacobian met on the way, and whether heat alone sees to that. */
static void watch(Row *w)
{
    if (!all_finite(w->J, N * N)) w->quiet = 0;
    else if (!heat_holds(w, w->J)) {
        w->heat = 0;
        w->quiet = w->quiet && growth(w, w->J) == 0.0;
    }
}

/* Newton's method from z; 1 at a root. Where it is watched, its first step goes half of the way. */
static int newton(Row *w, double *z, int most)
{
    double damping = 1.0;
    int step, i;
    evaluate(w, z, w->r, w->J);
    for (step = 0; step < most; step++) {
        double length;
        if (w->watched) watch(w);
        if (!all_finite(w->r, N) || !factor_matrix(w) || !correction(w, w->r, w->d)) return 0;
        length = size(w->d);
        if (length <= CONVERGED) {
            for (i = 0; i < N; i++) z[i] += w->d[i];
            return 1;
        }
        damping = fmin(damping, share(z, w->d));
        if (damping == 1.0 && length <= CHORD) {
            if (chord(w, z)) return 1;
            evaluate(w, z, w->r, w->J);
            if (!all_finite(w->r, N) || !factor_matrix(w) || !correction(w, w->r, w->d)) return 0;
            length = size(w->d);
            if (length <= CONVERGED) continue;
        }
        if (w->watched && step == 0 && length > NEAR) damping = fmin(damping, 0.5);
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

/* Whether an Euler step went far: more than some nominals, or some tenths of the value where that is more. */
static int went_far(const Row *w, const double *z)
{
    int i;
    for (i = 0; i < N; i++) {
        double nominal = model_nominal[i], from = w->before[i];
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
    if (!all_finite(w->r, N)) return 0;
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
    model_given(w->u, w->p, w->k, w->c);
    found = relax(w, z);
    while (found && way < 1.0 && stride > LEAST_STRIDE) {
        double aim = fmin(1.0, way + stride);
        memcpy(kept, z, sizeof kept);
        for (i = 0; i < NU; i++) w->led[i] = aim < 1.0 ? w->home[i] + aim * (asked[i] - w->home[i]) : asked[i];
        model_given(w->u, w->p, w->k, w->c);
        if (newton(w, z, MOST_LED)) {
            way = aim;
            stride *= 2;
        } else {
            memcpy(z, kept, sizeof kept);
            stride /= 2;
        }
    }
    w->u = asked;
    model_given(w->u, w->p, w->k, w->c);
    return found && way >= 1.0;
}

/* Whether a search has ended where the machine stays; notes where it has not. */
static int accepted(Row *w, int found, int *unstable)
{
    if (found && stable(w, w->J)) return 1;
    *unstable |= found;
    return 0;
}

/* Whether nothing on the straight way from a start to a balance would run away. */
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

/* The balance a row comes to rest in, to z. Where a machine would run away on the way there, it decides by itself where
   it comes to rest. Newton's method meets enough of the way where heat flows through conductors only. */
static int settle(Row *w, const double *start, double *z)
{
    double found[N1];
    int unstable = 0, reached;
    w->steps = 0;
    w->euler = 0.0;
    w->watched = w->quiet = w->heat = 1;
    memcpy(z, start, N * sizeof *z);
    reached = accepted(w, newton(w, z, MOST_NEWTON), &unstable);
    w->watched = 0;
    if (reached && w->quiet && (w->heat || calm(w, start, z))) return ROW_OK;
    memcpy(found, z, N * sizeof *z);
    memcpy(z, start, N * sizeof *z);
    if (accepted(w, relax(w, z), &unstable)) return ROW_OK;
    memcpy(z, reached ? found : start, N * sizeof *z);
    if (reached || accepted(w, led(w, z), &unstable)) return ROW_OK;
    if (unstable) return ROW_UNSTABLE;
    w->euler = 0.0;
    evaluate(w, start, w->r, NULL);
    return all_finite(w->r, N) ? ROW_NO_BALANCE : ROW_NOT_FINITE;
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
            model_fixed(w->p, w->k);
        }
        if (row == 0 || p_stride || u_stride) model_given(w->u, w->p, w->k, w->c);
        status[row] = settle(w, start + row * start_stride, z);
        iterations[row] = w->steps;
        if (status[row] == ROW_OK) model_outputs(z, w->u, w->p, w->k, w->c, out);
        if (status[row] == ROW_OK && all_finite(z, N)) continue;
        nothing(z, N);
        nothing(out, NYR);
    }
    free(w);
    return 1;
}
