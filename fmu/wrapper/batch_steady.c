/* Steady states, as gearheat.model.run.steady finds them: Newton's method on states and algebraic variables together, then
   a pseudo-transient, then a continuation of the inputs (Deuflhard 2004, section 3.3). */

enum { N1 = AT_LEAST_1(N), NW = N + NZ, W1 = AT_LEAST_1(N + NZ) };

/* Sizes of steps are counted in nominals. The numbers in capitals not given here come from gearheat.model.run.newton. */
#define CHORD 0.1              /* corrections below this keep the Jacobian ... */
#define CHORD_GAIN 0.2         /* ... as long as the next one is shorter by this */
#define NEAR 1.0               /* a way shorter than this is not watched */
enum { MOST_CHORDS = 8, MOST_ROTATIONS = 60 };

typedef struct {
    const double *u, *p, *home;
    double c[AT_LEAST_1(NC)];  /* what depends on parameters alone, then what depends on inputs too */
    double r[W1], r_new[W1], d[W1], d_new[W1], trial[W1], before[W1];
    double entries[AT_LEAST_1(NJ)], J[W1 * W1], J_new[W1 * W1], lu[W1 * W1];
    double taken[MOST_CHORDS][W1];
    double R[N1 * N1], a[N1 * N1];
    double complex h[N1 * N1];
    double between[AT_LEAST_1(NU)];
    int pivot[W1];
    double euler;              /* length of an implicit Euler step [s], 0 for the steady equations */
    int watched, quiet, heat;  /* see watch */
    int steps;
} Row;

static double nominal(int i)
{
    return i < N ? model_nominal[i] : model_z_nominal[i - N];
}

/* Largest of the first n components in nominals. */
static double size(const double *d, int n)
{
    double most = 0.0;
    int i;
    for (i = 0; i < n; i++) most = fmax(most, fabs(d[i]) / nominal(i));
    return most;
}

/* Largest part of a step that stays inside the states' ranges and is not wild. */
static double share(const double *w, const double *d)
{
    double least = 1.0;
    int i;
    for (i = 0; i < N; i++) {
        double room = d[i] > 0 ? model_high[i] - w[i] : w[i] - model_low[i];
        double most = fmin(0.9 * room, STRIDE * model_nominal[i] + 0.5 * fabs(w[i]));
        if (d[i] != 0) least = fmin(least, most / fabs(d[i]));
    }
    return least;
}

/* The residual at z, and its Jacobian by columns unless J is NULL. */
static void evaluate(Row *w, const double *z, double *r, double *J)
{
    int i;
    if (J) {
        model_equations(z, z + N, w->u, w->p, w->c, r, w->entries);
        memset(J, 0, sizeof w->J);
        for (i = 0; i < NJ; i++) J[model_row[i] + model_column[i] * NW] = w->entries[i];
    } else {
        model_rates(z, z + N, w->u, w->p, w->c, r);
    }
    if (w->euler == 0.0) return;
    for (i = 0; i < NW; i++) r[i] = (i < N ? (z[i] - w->before[i]) / w->euler : 0.0) - r[i];
    if (!J) return;
    for (i = 0; i < NW * NW; i++) J[i] = -J[i];
    for (i = 0; i < N; i++) J[i * (NW + 1)] += 1 / w->euler;
}

/* LU of w->J with row exchanges into w->lu; 0 where it is singular or not finite. */
static int factor_matrix(Row *w)
{
    memcpy(w->lu, w->J, sizeof w->lu);
    return lu_factor(w->lu, w->pivot, NW);
}

/* d = -J^-1 r with the factors at hand; 0 where it is not finite. */
static int correction(const Row *w, const double *r, double *d)
{
    int i;
    for (i = 0; i < NW; i++) d[i] = -r[i];
    return lu_solve(w->lu, w->pivot, d, NW);
}

/* The Jacobian of the states' rates where the algebraic variables follow, from that of all equations, to w->R; 0 where
   there is none. */
static int reduce(Row *w, const double *J)
{
    double inner[AT_LEAST_1(NZ * NZ)], column[AT_LEAST_1(NZ)];
    int pivot[AT_LEAST_1(NZ)], i, j, k;
    for (j = 0; j < NZ; j++)
        for (i = 0; i < NZ; i++) inner[i + j * NZ] = J[N + i + (N + j) * NW];
    if (NZ > 0 && !lu_factor(inner, pivot, NZ)) return 0;
    for (j = 0; j < N; j++) {
        for (i = 0; i < NZ; i++) column[i] = J[N + i + j * NW];
        if (NZ > 0 && !lu_solve(inner, pivot, column, NZ)) return 0;
        for (i = 0; i < N; i++) {
            double sum = J[i + j * NW];
            for (k = 0; k < NZ; k++) sum -= J[i + (N + k) * NW] * column[k];
            w->R[i + j * N] = sum;
        }
    }
    return all_finite(w->R, N * N);
}

/* A matrix without negative terms off its diagonal is stable if and only if its negative has positive pivots; heat that
   flows through conductors makes such a one. 1 where this shows that w->R is stable. */
static int heat_holds(Row *w)
{
    double *a = w->a;
    int i, j, k;
    for (i = 0; i < N * N; i++) {
        if (i % (N1 + 1) != 0 && w->R[i] < 0.0) return 0;
        a[i] = -w->R[i];
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

/* Rate [1/s] at which a small deviation grows fastest for w->R; 0 below round-off. */
static double growth(Row *w)
{
    double complex *h = w->h;
    double fastest = -INFINITY, largest = 0.0;
    int high = N - 1, tried = 0, i;
    if (N == 0 || heat_holds(w)) return 0.0;
    hessenberg(w->R, h);
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

/* Whether a machine stays at an equilibrium with a Jacobian of all equations. */
static int stable(Row *w, const double *J)
{
    return reduce(w, J) && growth(w) == 0.0;
}

static double product(const double *a, const double *b)
{
    double sum = 0.0;
    int i;
    for (i = 0; i < NW; i++) sum += a[i] / nominal(i) * (b[i] / nominal(i));
    return sum;
}

/* Newton's method without new Jacobians: Broyden's secant updates of the one at hand, kept as the steps taken (Kelley
   1995, section 7.3). 1 at a root, 0 where a new Jacobian is due, taken at z. On entry w->d is the correction at z. */
static int chord(Row *w, double *z)
{
    double square[MOST_CHORDS], length = size(w->d, NW);
    int n, i, j;
    memcpy(w->taken[0], w->d, sizeof w->d);
    for (n = 0; n < MOST_CHORDS; n++) {
        const double *last = w->taken[n];
        double *d = w->d_new, pull;
        for (i = 0; i < NW; i++) w->trial[i] = z[i] + last[i];
        evaluate(w, w->trial, w->r_new, NULL);
        if (!correction(w, w->r_new, d)) return 0;
        square[n] = product(last, last);
        for (j = 0; j < n; j++) {
            pull = product(w->taken[j], d) / square[j];
            for (i = 0; i < NW; i++) d[i] += pull * w->taken[j + 1][i];
        }
        pull = product(last, d) / square[n];
        if (!(size(d, NW) <= CHORD_GAIN * length)) return 0;
        for (i = 0; i < NW; i++) d[i] /= 1 - pull;
        w->steps++;
        length = size(d, NW);
        memcpy(z, w->trial, sizeof w->trial);
        if (length <= CONVERGED) {
            for (i = 0; i < NW; i++) z[i] += d[i];
            return 1;
        }
        if (n + 1 < MOST_CHORDS) memcpy(w->taken[n + 1], d, sizeof w->d_new);
    }
    return 0;
}

/* Note whether a machine would stay where a Jacobian was met, and whether heat alone sees to that. */
static void watch(Row *w)
{
    if (!reduce(w, w->J)) w->quiet = 0;
    else if (!heat_holds(w)) {
        w->heat = 0;
        w->quiet = w->quiet && growth(w) == 0.0;
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
        if (!all_finite(w->r, NW) || !factor_matrix(w) || !correction(w, w->r, w->d)) return 0;
        length = size(w->d, NW);
        if (length <= CONVERGED) {
            for (i = 0; i < NW; i++) z[i] += w->d[i];
            return 1;
        }
        damping = fmin(damping, share(z, w->d));
        if (damping == 1.0 && length <= CHORD) {
            if (chord(w, z)) return 1;
            evaluate(w, z, w->r, w->J);
            if (!all_finite(w->r, NW) || !factor_matrix(w) || !correction(w, w->r, w->d)) return 0;
            length = size(w->d, NW);
            if (length <= CONVERGED) continue;
        }
        if (w->watched && step == 0 && length > NEAR) damping = fmin(damping, 0.5);
        for (;;) {
            int sound;
            for (i = 0; i < NW; i++) w->trial[i] = z[i] + damping * w->d[i];
            evaluate(w, w->trial, w->r_new, w->J_new);
            sound = correction(w, w->r_new, w->d_new);
            if (sound && size(w->d_new, NW) <= (1 - (1 - CONTRACTION) * damping) * length) break;
            if (length <= ROUND_OFF) return 1;
            damping /= sound ? 2 : 8;
            if (damping < LEAST_STEP) return 0;
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
        double scale = model_nominal[i], from = w->before[i];
        if (fabs(z[i] - from) / (1 + fabs(from) / (STRIDE * scale)) > FAR * scale) return 1;
    }
    return 0;
}

/* Follow the machine from z by implicit Euler steps that grow as long as they are easy, short where the machine runs away
   from itself; 1 at an equilibrium. */
static int pseudo_transient(Row *w, double *z)
{
    double step, runs, moved;
    int taken = 0;
    evaluate(w, z, w->r, w->J);
    if (!all_finite(w->r, NW)) return 0;
    step = fmin(fmax(1 / fmax(size(w->r, N), 1e-12), 1e-6), 1e3);
    runs = reduce(w, w->J) ? growth(w) : 0.0;
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
        moved = size(w->d, N);
        if (step >= LONGEST && moved < 1.0) return newton(w, z, MOST_NEWTON);
        evaluate(w, z, w->r, w->J);
        runs = reduce(w, w->J) ? growth(w) : 0.0;
        step = fmin(step * (w->steps - began <= 4 ? 5 : 2), 10 * LONGEST);
    }
    return 0;
}

/* Continue from the model's own inputs to those given, in strides that adapt; 1 at a root. */
static int continued(Row *w, double *z)
{
    const double *asked = w->u;
    double way = 0.0, stride = FIRST_STRIDE, kept[W1];
    int found, i, same = 1;
    for (i = 0; i < NU; i++) same = same && asked[i] == w->home[i];
    if (same) return 0;
    memcpy(w->between, w->home, sizeof w->between);
    w->u = w->between;
    model_given(w->u, w->p, w->c, w->c + NK);
    found = pseudo_transient(w, z);
    while (found && way < 1.0 && stride > LEAST_STRIDE) {
        double aim = fmin(1.0, way + stride);
        memcpy(kept, z, sizeof kept);
        for (i = 0; i < NU; i++) w->between[i] = aim < 1.0 ? w->home[i] + aim * (asked[i] - w->home[i]) : asked[i];
        model_given(w->u, w->p, w->c, w->c + NK);
        if (newton(w, z, MOST_STRIDE)) {
            way = aim;
            stride *= 2;
        } else {
            memcpy(z, kept, sizeof kept);
            stride /= 2;
        }
    }
    w->u = asked;
    model_given(w->u, w->p, w->c, w->c + NK);
    return found && way >= 1.0;
}

/* Whether a search has ended where the machine stays; notes where it has not. */
static int accepted(Row *w, int found, int *unstable)
{
    if (found && stable(w, w->J)) return 1;
    *unstable |= found;
    return 0;
}

/* Whether nothing between a start and an equilibrium would run away. */
static int steady_between(Row *w, const double *start, const double *z)
{
    int quarter, i;
    for (quarter = 1; quarter < 4; quarter++) {
        for (i = 0; i < NW; i++) w->trial[i] = start[i] + 0.25 * quarter * (z[i] - start[i]);
        evaluate(w, w->trial, w->r_new, w->J_new);
        if (!stable(w, w->J_new)) return 0;
    }
    return 1;
}

/* The equilibrium a row settles in, to z. Where a machine would run away on the way there, it decides by itself where it
   settles. Newton's method meets enough of the way where heat flows through conductors only. */
static int settle(Row *w, const double *from, double *z)
{
    double start[W1], found[W1];
    int unstable = 0, reached;
    w->steps = 0;
    w->euler = 0.0;
    w->watched = w->quiet = w->heat = 1;
    memcpy(start, from, N * sizeof *start);
    memcpy(start + N, model_z_start, NZ * sizeof *start);
    if (implicit_solve(start, start + N, w->u, w->p, w->c, -1) >= 0) return ROW_NO_SOLUTION;
    memcpy(z, start, NW * sizeof *z);
    reached = accepted(w, newton(w, z, MOST_NEWTON), &unstable);
    w->watched = 0;
    if (reached && w->quiet && (w->heat || steady_between(w, start, z))) return ROW_OK;
    memcpy(found, z, NW * sizeof *z);
    memcpy(z, start, NW * sizeof *z);
    if (accepted(w, pseudo_transient(w, z), &unstable)) return ROW_OK;
    memcpy(z, reached ? found : start, NW * sizeof *z);
    if (reached || accepted(w, continued(w, z), &unstable)) return ROW_OK;
    if (unstable) return ROW_UNSTABLE;
    w->euler = 0.0;
    evaluate(w, start, w->r, NULL);
    return all_finite(w->r, NW) ? ROW_NO_EQUILIBRIUM : ROW_NOT_FINITE;
}
