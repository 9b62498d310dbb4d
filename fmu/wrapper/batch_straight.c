/* Steady states of rows side by side, one in each lane: newton() where it gets there. What is unusual in a row (implicit
   equations that do not come out at once, a way on which a machine might not stay) leaves it to settle(). Lanes know
   nothing of each other. */

enum { Z1 = AT_LEAST_1(NZ), INNER = 2 * NZ + N };

/* What solves the linear equations of Newton's method: the algebraic variables follow from the states. */
typedef struct {
    lanes across[N1 * Z1];         /* states' rates by the algebraic variables */
    lanes follows[Z1 * INNER];     /* behind NZ columns: what these follow by from the states, and from their equations */
    lanes R[N1 * N1];              /* LU of the states' rates by the states, the algebraic variables following */
} Factors;

typedef struct {
    lanes u[AT_LEAST_1(NU)], p[AT_LEAST_1(NP)], c[AT_LEAST_1(NC)];
    lanes z[W1], d[W1], trial[W1], d_new[W1], r[W1], y[NYR];
    lanes entries[AT_LEAST_1(NJ)], J[W1 * W1], M[N1 * N1];
    Factors at, new;
    lanes_bits heat;               /* the last factors are of heat that flows through conductors, see heat_holds */
    int32_t steps[LANES];
} Side;

/* Gauss-Jordan elimination of n rows of n numbers and m right sides, with exchanges of rows: the solutions take the place
   of the right sides. The lanes where there are any. */
static lanes_bits eliminate(lanes *a, int n, int m)
{
    lanes_bits sound = ~(lanes_bits){0};
    int width = n + m, i, j, k;
    for (k = 0; k < n; k++) {
        lanes *top = a + k * width, inverse;
        for (i = k + 1; i < n; i++) {
            lanes *row = a + i * width;
            lanes_bits larger = lanes_where(lanes_fabs(row[k]) > lanes_fabs(top[k]));
            if (!lanes_any(larger)) continue;
            for (j = k; j < width; j++) {
                lanes swap = top[j];
                top[j] = lanes_select(larger, row[j], swap);
                row[j] = lanes_select(larger, swap, row[j]);
            }
        }
        sound &= lanes_where(lanes_fabs(top[k]) > 0.0);
        inverse = 1.0 / top[k];
        for (j = k + 1; j < width; j++) top[j] *= inverse;
        for (i = 0; i < n; i++) {
            lanes *row = a + i * width, f = row[k];
            for (j = k + 1; j < width && i != k; j++) row[j] -= f * top[j];
        }
    }
    return sound;
}

static lanes_bits lanes_finite(const lanes *d, int n)
{
    lanes_bits finite = ~(lanes_bits){0};
    int i;
    for (i = 0; i < n; i++) finite &= lanes_where(lanes_fabs(d[i]) <= 0x1.fffffffffffffp1023);
    return finite;
}

static lanes lanes_size(const lanes *d, int first, int n)
{
    lanes most = lanes_all(0.0);
    int i;
    for (i = 0; i < n; i++) most = lanes_fmax(most, lanes_fabs(d[i]) / nominal(first + i));
    return most;
}

/* Largest part of a step that stays inside the states' ranges and is not wild. */
static lanes lanes_share(const lanes *w, const lanes *d)
{
    lanes least = lanes_all(1.0);
    int i;
    for (i = 0; i < N; i++) {
        lanes room = lanes_select(lanes_where(d[i] > 0.0), model_high[i] - w[i], w[i] - model_low[i]);
        lanes most = lanes_fmin(0.9 * room, STRIDE * model_nominal[i] + 0.5 * lanes_fabs(w[i])) / lanes_fabs(d[i]);
        least = lanes_select(lanes_where(d[i] != 0.0), lanes_fmin(least, most), least);
    }
    return least;
}

/* Whether a machine stays: R, with what is off its diagonal in magnitude, has negative pivots. There are units then in which
   Gershgorin's circles of R lie left of zero. */
static lanes_bits stays(Side *s, const lanes *R)
{
    lanes_bits sound = ~(lanes_bits){0};
    int i, j, k;
    s->heat = sound;
    for (i = 0; i < N; i++)
        for (j = 0; j < N; j++) {
            s->M[i * N + j] = i == j ? R[i * N + j] : lanes_fabs(R[i * N + j]);
            if (i != j) s->heat &= ~lanes_where(R[i * N + j] < 0.0);
        }
    for (k = 0; k < N; k++) {
        const lanes *top = s->M + k * N;
        lanes inverse = 1.0 / top[k];
        sound &= lanes_where(top[k] < 0.0);
        for (i = k + 1; i < N; i++) {
            lanes f = s->M[i * N + k] * inverse;
            for (j = k + 1; j < N; j++) s->M[i * N + j] -= f * top[j];
        }
    }
    return sound;
}

/* Factors of the Jacobian's entries. The lanes where there are any and where a machine stays. */
static lanes_bits factor(Side *s, Factors *f)
{
    lanes_bits sound;
    int i, j, k;
    memset(s->J, 0, sizeof s->J);
    memset(f->follows, 0, sizeof f->follows);
    for (i = 0; i < NJ; i++) s->J[model_row[i] * NW + model_column[i]] = s->entries[i];
    for (i = 0; i < NZ; i++) {
        lanes *row = f->follows + i * INNER;
        memcpy(row, s->J + (N + i) * NW + N, NZ * sizeof *row);
        memcpy(row + NZ, s->J + (N + i) * NW, N * sizeof *row);
        row[NZ + N + i] = lanes_all(1.0);
    }
    sound = eliminate(f->follows, NZ, N + NZ);
    for (i = 0; i < N; i++) {
        memcpy(f->R + i * N, s->J + i * NW, N * sizeof *f->R);
        memcpy(f->across + i * NZ, s->J + i * NW + N, NZ * sizeof *f->R);
        for (k = 0; k < NZ; k++)
            for (j = 0; j < N; j++) f->R[i * N + j] -= f->across[i * NZ + k] * f->follows[k * INNER + NZ + j];
    }
    sound &= stays(s, f->R);
    for (k = 0; k < N; k++) {
        const lanes *top = f->R + k * N;
        lanes inverse = 1.0 / top[k];
        for (i = k + 1; i < N; i++) {
            lanes *row = f->R + i * N;
            row[k] *= inverse;
            for (j = k + 1; j < N; j++) row[j] -= row[k] * top[j];
        }
    }
    return sound;
}

/* Newton's correction for a residual. The lanes where there is one. */
static lanes_bits lanes_correction(const Factors *f, const lanes *r, lanes *d)
{
    int i, j;
    for (i = 0; i < NZ; i++) {
        d[N + i] = lanes_all(0.0);
        for (j = 0; j < NZ; j++) d[N + i] -= f->follows[i * INNER + NZ + N + j] * r[N + j];
    }
    for (i = 0; i < N; i++) {
        d[i] = -r[i];
        for (j = 0; j < NZ; j++) d[i] -= f->across[i * NZ + j] * d[N + j];
        for (j = 0; j < i; j++) d[i] -= f->R[i * N + j] * d[j];
    }
    for (i = N - 1; i >= 0; i--) {
        for (j = i + 1; j < N; j++) d[i] -= f->R[i * N + j] * d[j];
        d[i] /= f->R[i * N + i];
    }
    for (i = 0; i < NZ; i++)
        for (j = 0; j < N; j++) d[N + i] -= f->follows[i * INNER + NZ + j] * d[j];
    return lanes_finite(d, NW);
}

/* The algebraic variables at the start; the lanes where Newton's method finds them undamped. */
static lanes_bits lanes_implicit(Side *s)
{
    lanes_bits open = ~(lanes_bits){0}, found = {0};
    lanes *z = s->z + N, *rows = s->at.follows, length = lanes_all(INFINITY);
    int step, i;
    for (step = 0; step < MOST_NEWTON && NZ > 0 && lanes_any(open); step++) {
        lanes next;
        lanes_bits there;
        lanes_algebra(s->z, z, s->u, s->p, s->c, s->r, s->J);
        for (i = 0; i < NZ * (NZ + 1); i++) {
            int row = i / (NZ + 1), column = i % (NZ + 1);
            rows[i] = column < NZ ? s->J[row + column * NZ] : s->r[row];
        }
        open &= eliminate(rows, NZ, 1);
        for (i = 0; i < NZ; i++) s->d[i] = -rows[i * (NZ + 1) + NZ];
        open &= lanes_finite(s->d, NZ);
        next = lanes_size(s->d, N, NZ);
        there = open & lanes_where(next <= CONVERGED);
        open &= lanes_where(next <= CONTRACTION * length);
        for (i = 0; i < NZ; i++) z[i] = lanes_select(step > 0 ? open | there : open & ~there, z[i] + s->d[i], z[i]);
        found |= there;
        open &= ~there;
        length = next;
    }
    return NZ > 0 ? found : open;
}

/* Whether nothing between a start and an equilibrium would run away. */
static lanes_bits lanes_between(Side *s, const lanes *start)
{
    lanes_bits sound = ~(lanes_bits){0};
    int quarter, i;
    for (quarter = 1; quarter < 4; quarter++) {
        for (i = 0; i < NW; i++) s->trial[i] = start[i] + 0.25 * quarter * (s->z[i] - start[i]);
        lanes_equations(s->trial, s->trial + N, s->u, s->p, s->c, s->r, s->entries);
        sound &= factor(s, &s->new);
    }
    return sound;
}

/* From the start to the equilibrium, to z: the lanes that get there. */
static lanes_bits straight(Side *s)
{
    lanes_bits on = lanes_implicit(s), done = {0}, heat;
    lanes start[W1];
    lanes length, damping = lanes_all(1.0);
    int step, i;
    memset(s->steps, 0, sizeof s->steps);
    memcpy(start, s->z, sizeof start);
    lanes_equations(s->z, s->z + N, s->u, s->p, s->c, s->r, s->entries);
    on &= factor(s, &s->at);
    heat = s->heat;
    on &= lanes_correction(&s->at, s->r, s->d);
    for (step = 0; step < MOST_NEWTON; step++) {
        lanes_bits there, taken;
        length = lanes_size(s->d, 0, NW);
        there = on & lanes_where(length <= CONVERGED);
        for (i = 0; i < NW; i++) s->z[i] = lanes_select(there, s->z[i] + s->d[i], s->z[i]);
        done |= there;
        on &= ~there;
        if (!lanes_any(on)) break;
        damping = lanes_fmin(damping, lanes_share(s->z, s->d));
        if (step == 0) damping = lanes_select(lanes_where(length > NEAR), lanes_fmin(damping, lanes_all(0.5)), damping);
        for (i = 0; i < NW; i++) s->trial[i] = s->z[i] + damping * s->d[i];
        lanes_equations(s->trial, s->trial + N, s->u, s->p, s->c, s->r, s->entries);
        taken = on & lanes_correction(&s->at, s->r, s->d_new);
        taken &= lanes_where(lanes_size(s->d_new, 0, NW) <= (1.0 - (1.0 - CONTRACTION) * damping) * length);
        on &= taken | (lanes_where(damping >= 2.0 * LEAST_STEP) & lanes_where(length > ROUND_OFF));
        on &= factor(s, &s->new) | ~taken;
        heat &= s->heat | ~taken;
        taken &= on & lanes_correction(&s->new, s->r, s->d_new);
        for (i = 0; i < (int)(sizeof s->at / sizeof(lanes)); i++)
            ((lanes *)&s->at)[i] = lanes_select(taken, ((lanes *)&s->new)[i], ((lanes *)&s->at)[i]);
        for (i = 0; i < NW; i++) {
            s->z[i] = lanes_select(taken, s->trial[i], s->z[i]);
            s->d[i] = lanes_select(taken, s->d_new[i], s->d[i]);
        }
        damping = lanes_select(taken, lanes_fmin(4.0 * damping, lanes_all(1.0)), 0.5 * damping);
        for (i = 0; i < LANES; i++) s->steps[i] += taken[i] != 0;
    }
    return lanes_any(done & ~heat) ? done & (heat | lanes_between(s, start)) : done;
}

static void put(lanes *to, int lane, const double *from, int n)
{
    int i;
    for (i = 0; i < n; i++) to[i][lane] = from[i];
}

static void take(double *to, const lanes *from, int lane, int n)
{
    int i;
    for (i = 0; i < n; i++) to[i] = from[i][lane];
}

/* Steady states of n rows. A stride of 0 says that all rows share one vector. x takes N numbers a row, y NYR. */
BATCH_EXPORT int batch_steady(int64_t n, const double *u, int64_t u_stride, const double *p, int64_t p_stride,
                              const double *start, int64_t start_stride, const double *home, double *x, double *y,
                              int32_t *status, int32_t *iterations)
{
    void *memory = calloc(1, sizeof(Side) + sizeof(lanes));
    Side *s = (Side *)(((uintptr_t)memory + sizeof(lanes) - 1) & ~(uintptr_t)(sizeof(lanes) - 1));
    Row *w = calloc(1, sizeof *w);
    double z[W1];
    int64_t first;
    if (!w || !memory) return free(w), free(memory), 0;
    w->home = home;
    for (first = 0; first < n; first += LANES) {
        lanes_bits done;
        int lane;
        for (lane = 0; lane < LANES; lane++) {
            int64_t row = first + lane < n ? first + lane : first;   /* a lane without a row mirrors the first one */
            if (first == 0 || p_stride) {
                model_fixed(p + row * p_stride, w->c);
                put(s->p, lane, p + row * p_stride, NP);
                put(s->c, lane, w->c, NK);
            }
            put(s->u, lane, u + row * u_stride, NU);
            put(s->z, lane, start + row * start_stride, N);
            put(s->z + N, lane, model_z_start, NZ);
        }
        if (first == 0 || p_stride || u_stride) lanes_given(s->u, s->p, s->c, s->c + NK);
        done = straight(s);
        lanes_outputs(s->z, s->z + N, s->u, s->p, s->c, s->y);
        for (lane = 0; lane < LANES && first + lane < n; lane++) {
            int64_t row = first + lane;
            double *out = y + row * NYR;
            status[row] = ROW_OK;
            iterations[row] = s->steps[lane];
            take(z, s->z, lane, NW);
            take(out, s->y, lane, NYR);
            if (!done[lane]) {
                w->u = u + row * u_stride;
                w->p = p + row * p_stride;
                model_fixed(w->p, w->c);
                model_given(w->u, w->p, w->c, w->c + NK);
                status[row] = settle(w, start + row * start_stride, z);
                iterations[row] = w->steps;
                if (status[row] == ROW_OK) model_outputs(z, z + N, w->u, w->p, w->c, out);
            }
            memcpy(x + row * N, z, N * sizeof *z);
            if (status[row] == ROW_OK && all_finite(z, NW)) continue;
            nothing(x + row * N, N);
            nothing(out, NYR);
        }
    }
    free(w);
    free(memory);
    return 1;
}
