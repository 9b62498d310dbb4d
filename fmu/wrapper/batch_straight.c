/* Steady states of rows side by side, one in each lane: newton() where it goes straight. What is unusual in a row (an
   equation or a step that does not come out at once, a way on which more than heat decides where the machine stays) leaves
   it to settle(). Lanes know nothing of each other. */

enum { Z1 = AT_LEAST_1(NZ), INNER = NZ + N + 1 };

typedef struct {
    lanes u[AT_LEAST_1(NU)], p[AT_LEAST_1(NP)], c[AT_LEAST_1(NC)];
    lanes z[W1], d[W1], trial[W1], d_new[W1], r[W1], y[NYR];
    lanes entries[AT_LEAST_1(NJ)], J[W1 * W1], inner[Z1 * INNER];
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

/* Newton's correction at z. The lanes where there is one and where heat alone keeps a machine there, see heat_holds: the
   states' Jacobian with the algebraic variables following has no negative term off its diagonal, and negative pivots. */
static lanes_bits lanes_correction(Side *s, const lanes *z, lanes *d)
{
    lanes_bits sound;
    lanes *R = s->J;
    int i, j, k;
    lanes_equations(z, z + N, s->u, s->p, s->c, s->r, s->entries);
    memset(s->J, 0, sizeof s->J);
    for (i = 0; i < NJ; i++) s->J[model_row[i] * NW + model_column[i]] = s->entries[i];
    for (i = 0; i < NZ; i++) {
        const lanes *row = s->J + (N + i) * NW;
        memcpy(s->inner + i * INNER, row + N, NZ * sizeof *row);
        memcpy(s->inner + i * INNER + NZ, row, N * sizeof *row);
        s->inner[i * INNER + NZ + N] = s->r[N + i];
    }
    sound = eliminate(s->inner, NZ, N + 1);
    for (i = 0; i < N; i++)
        for (k = 0; k < NZ; k++) {
            const lanes *follows = s->inner + k * INNER + NZ;
            lanes f = R[i * NW + N + k];
            for (j = 0; j < N; j++) R[i * NW + j] -= f * follows[j];
            s->r[i] -= f * follows[N];
        }
    for (i = 0; i < N; i++)
        for (j = 0; j < N; j++)
            if (i != j) sound &= ~lanes_where(R[i * NW + j] < 0.0);
    for (k = 0; k < N; k++) {
        lanes inverse = 1.0 / R[k * NW + k];
        sound &= lanes_where(R[k * NW + k] < 0.0);
        for (i = k + 1; i < N; i++) {
            lanes f = R[i * NW + k] * inverse;
            for (j = k + 1; j < N; j++) R[i * NW + j] -= f * R[k * NW + j];
            s->r[i] -= f * s->r[k];
        }
    }
    for (k = N - 1; k >= 0; k--) {
        lanes sum = s->r[k];
        for (j = k + 1; j < N; j++) sum += R[k * NW + j] * d[j];
        d[k] = -sum / R[k * NW + k];
    }
    for (i = 0; i < NZ; i++) {
        const lanes *follows = s->inner + i * INNER + NZ;
        lanes sum = follows[N];
        for (j = 0; j < N; j++) sum += follows[j] * d[j];
        d[N + i] = -sum;
    }
    return sound & lanes_finite(d, NW);
}

/* The algebraic variables at the start; the lanes where Newton's method finds them undamped. */
static lanes_bits lanes_implicit(Side *s)
{
    lanes_bits open = ~(lanes_bits){0}, found = {0};
    lanes *z = s->z + N, length = lanes_all(INFINITY);
    int step, i;
    for (step = 0; step < MOST_NEWTON && NZ > 0 && lanes_any(open); step++) {
        lanes next;
        lanes_bits there;
        lanes_algebra(s->z, z, s->u, s->p, s->c, s->r, s->J);
        for (i = 0; i < NZ * (NZ + 1); i++) {
            int row = i / (NZ + 1), column = i % (NZ + 1);
            s->inner[i] = column < NZ ? s->J[row + column * NZ] : s->r[row];
        }
        open &= eliminate(s->inner, NZ, 1);
        for (i = 0; i < NZ; i++) s->d[i] = -s->inner[i * (NZ + 1) + NZ];
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

/* From the start to the equilibrium, to z: the lanes that get there straight. */
static lanes_bits straight(Side *s)
{
    lanes_bits on = lanes_implicit(s), done = {0};
    lanes length, damping = lanes_all(1.0);
    int step, i;
    memset(s->steps, 0, sizeof s->steps);
    on &= lanes_correction(s, s->z, s->d);
    length = lanes_size(s->d, 0, NW);
    for (step = 0; step < MOST_NEWTON; step++) {
        lanes_bits there = on & lanes_where(length <= CONVERGED);
        lanes next;
        for (i = 0; i < NW; i++) s->z[i] = lanes_select(there, s->z[i] + s->d[i], s->z[i]);
        done |= there;
        on &= ~there;
        if (!lanes_any(on)) break;
        damping = lanes_fmin(damping, lanes_share(s->z, s->d));
        if (step == 0) damping = lanes_select(lanes_where(length > NEAR), lanes_fmin(damping, lanes_all(0.5)), damping);
        for (i = 0; i < NW; i++) s->trial[i] = s->z[i] + damping * s->d[i];
        on &= lanes_correction(s, s->trial, s->d_new);
        next = lanes_size(s->d_new, 0, NW);
        on &= lanes_where(next <= (1.0 - (1.0 - CONTRACTION) * damping) * length);
        for (i = 0; i < NW; i++) {
            s->z[i] = lanes_select(on, s->trial[i], s->z[i]);
            s->d[i] = lanes_select(on, s->d_new[i], s->d[i]);
        }
        length = next;
        damping = lanes_fmin(4.0 * damping, lanes_all(1.0));
        for (i = 0; i < LANES; i++) s->steps[i] += on[i] != 0;
    }
    return done;
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
