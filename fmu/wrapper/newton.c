/* Newton's method damped by the natural monotonicity test (Deuflhard 2004, section 3.3), several guesses and a homotopy,
   as gearheat.model.run.newton and algebra have them in Python; the numbers in capitals come from there. */

/* A first correction below this, in nominals and values, is round-off: what is solved stays solved bit by bit. */
#define SAME 1e-14

/* LU of a matrix by columns with row exchanges, in place; 0 where it is singular or not finite. */
static int lu_factor(double *a, int *pivot, int n)
{
    int i, j, k;
    for (i = 0; i < n * n; i++)
        if (!isfinite(a[i])) return 0;
    for (k = 0; k < n; k++) {
        int best = k;
        for (i = k + 1; i < n; i++)
            if (fabs(a[i + k * n]) > fabs(a[best + k * n])) best = i;
        if (a[best + k * n] == 0.0) return 0;
        pivot[k] = best;
        if (best != k)
            for (j = 0; j < n; j++) {
                double swap = a[k + j * n];
                a[k + j * n] = a[best + j * n];
                a[best + j * n] = swap;
            }
        for (i = k + 1; i < n; i++) a[i + k * n] /= a[k + k * n];
        for (j = k + 1; j < n; j++)
            for (i = k + 1; i < n; i++) a[i + j * n] -= a[i + k * n] * a[k + j * n];
    }
    return 1;
}

/* Solve with the factors, in place; 0 where the result is not finite. */
static int lu_solve(const double *a, const int *pivot, double *d, int n)
{
    int i, k;
    for (k = 0; k < n; k++) {
        double swap = d[pivot[k]];
        d[pivot[k]] = d[k];
        d[k] = swap;
    }
    for (k = 0; k < n; k++)
        for (i = k + 1; i < n; i++) d[i] -= a[i + k * n] * d[k];
    for (k = n - 1; k >= 0; k--) {
        d[k] /= a[k + k * n];
        for (i = 0; i < k; i++) d[i] -= a[i + k * n] * d[k];
    }
    for (i = 0; i < n; i++)
        if (!isfinite(d[i])) return 0;
    return 1;
}

/* Where the implicit equations are to be solved. A share below 1 of a homotopy leaves a part of what the guess leaves. */
typedef struct {
    const double *x, *u, *p, *c;
    double share, left[AT_LEAST_1(NZ)];
    int most;                  /* corrections that may still be tried; any number where it is negative */
} Implicit;

typedef struct {
    double r[AT_LEAST_1(NZ)], J[AT_LEAST_1(NZ * NZ)], d[AT_LEAST_1(NZ)];
    double length;             /* of the correction, in nominals */
} Correction;

/* The equations at z and Newton's correction there; 0 where there is none. */
static int implicit_correction(Implicit *at, const double *z, Correction *k)
{
    int pivot[AT_LEAST_1(NZ)], i;
    if (at->most == 0) return 0;
    at->most -= at->most > 0;
    model_algebra(at->x, z, at->u, at->p, at->c, k->r, k->J);
    for (i = 0; i < NZ; i++) {
        if (at->share < 1.0) k->r[i] -= (1 - at->share) * at->left[i];
        if (!isfinite(k->r[i])) return 0;
        k->d[i] = -k->r[i];
    }
    if (!lu_factor(k->J, pivot, NZ) || !lu_solve(k->J, pivot, k->d, NZ)) return 0;
    k->length = 0.0;
    for (i = 0; i < NZ; i++) k->length = fmax(k->length, fabs(k->d[i]) / model_z_nominal[i]);
    return 1;
}

static int implicit_newton(Implicit *at, double *z, int most)
{
    Correction now, next;
    double damping = 1.0, trial[AT_LEAST_1(NZ)];
    int step, sound, i;
    if (!implicit_correction(at, z, &now)) return 0;
    for (step = 0; step < most; step++) {
        if (now.length <= CONVERGED) {
            for (i = 0; i < NZ; i++)
                if (step > 0 || fabs(now.d[i]) > SAME * (model_z_nominal[i] + fabs(z[i]))) z[i] += now.d[i];
            return 1;
        }
        for (;;) {
            for (i = 0; i < NZ; i++) trial[i] = z[i] + damping * now.d[i];
            sound = implicit_correction(at, trial, &next);
            if (sound && next.length <= (1 - (1 - CONTRACTION) * damping) * now.length) break;
            if (now.length <= ROUND_OFF) return 1;
            damping /= sound ? 2 : 8;
            if (damping < LEAST_STEP) return 0;
        }
        memcpy(z, trial, sizeof trial);
        now = next;
        damping = fmin(1.0, 4 * damping);
    }
    return 0;
}

/* From the model's guess along a share of what the guess leaves. */
static int implicit_homotopy(Implicit *at, double *z)
{
    double share = 0.0, stride = FIRST_STRIDE, J[AT_LEAST_1(NZ * NZ)], trial[AT_LEAST_1(NZ)];
    memcpy(z, model_z_start, NZ * sizeof *z);
    model_algebra(at->x, z, at->u, at->p, at->c, at->left, J);
    while (share < 1.0 && stride > LEAST_STRIDE) {
        at->share = fmin(1.0, share + stride);
        memcpy(trial, z, NZ * sizeof *z);
        if (implicit_newton(at, trial, MOST_STRIDE)) {
            memcpy(z, trial, NZ * sizeof *z);
            share = at->share;
            stride *= 2;
        } else {
            stride /= 2;
        }
    }
    return share >= 1.0;
}

/* The algebraic variables at x, u, p, begun from z, by at most so many corrections (any number where negative); -1, or the
   number of an equation that has no solution: then z is as before. */
static int implicit_solve(const double *x, double *z, const double *u, const double *p, const double *c, int most)
{
    static const double guesses[N_GUESSES] = GUESSES;
    Implicit at;
    Correction last;
    double found[AT_LEAST_1(NZ)];
    int k, i, worst = 0;
    if (NZ == 0) return -1;
    at.x = x, at.u = u, at.p = p, at.c = c, at.share = 1.0, at.most = most;
    for (k = -2; k < N_GUESSES; k++) {
        for (i = 0; i < NZ; i++)
            found[i] = k == -2 ? z[i] : model_z_start[i] + (k < 0 ? 0.0 : guesses[k]) * model_z_nominal[i];
        if (implicit_newton(&at, found, MOST_NEWTON)) break;
    }
    if (k == N_GUESSES && !implicit_homotopy(&at, found)) {
        at.share = 1.0, at.most = 1;
        implicit_correction(&at, found, &last);
        for (i = 0; i < NZ; i++)
            if (!(fabs(last.r[i]) <= fabs(last.r[worst]))) worst = i;
        return worst;
    }
    memcpy(z, found, NZ * sizeof *z);
    return -1;
}
