/* Windows of logs, some side by side: a rig steps from sample to sample, and a Kalman filter corrects its states by what
   is read. Two implicit stages of second order a step, L-stable and stiffly accurate; exact derivatives by the knobs.

   The text of march.c stands above this one. Matrices of one lane lie column by column. */

/* n windows of L samples with k knobs; derivatives only where k > 0. */
typedef struct {
  whole n, L, k;
  whole parts;                               /* steps of a sample */
  const whole *length;                       /* of each window (n) */
  const unsigned char *counts, *ends;        /* whether a sample counts, else it corrects; and ends a piece (n, L) */
  const double *given, *read;                /* (n, L, given), (n, L, shown), NaN where missing */
  const double *p, *dp;                      /* (n, np), (n, plant's knobs, k) */
  const double *factor, *shift;              /* input = factor * given - shift (n, given) */
  const double *scaled, *offset;             /* shown = scaled * reading + offset (n, shown) */
  const double *by;                          /* 1 where a knob moves a reading (shown, k) */
  const double *u, *noise;                   /* (nu); standard deviation of the given inputs (given) */
  const whole *input_of, *gain;              /* input that a knob moves or -1, and whether it moves by a factor (k) */
  const whole *u_at, *state_of;              /* place of each given input (given); state of each reading or -1 (shown) */
  const double *x0, *z0, *P0, *S0;           /* (n, nx), (nz), diagonal (nx), of x0 by the knobs (n, k, nx) */
  const double *Q, *scatter;                 /* diagonal (nx), standard deviations (shown) */
  const double *spread;                      /* standard deviations of means over pieces (shown) */
  const double *step, *tails;                /* [s]; degrees of freedom of the errors */
} Logs;

/* (n, k), (n, k, k), (n, L, shown). */
typedef struct { double *slope, *curvature, *shown; } Told;

#define LOG_GAMMA 0.29289321881345247560
/* Newton's corrections at most, the last of them over the nominals, the longest one; a shorter one from some on, as a
   relay may throw it about; variance of a missing reading over that of one that is there. */
enum { LOG_MOST = 30, LOG_SHORTER = 6 };
static const double LOG_SETTLED = 1e-10, LOG_LONG = 2, LOG_SHORT = 0.3, MISSING = 1e8;

typedef struct {
  Runs runs;
  const Logs *logs;
  whole t, nx, nw, reads, columns;          /* columns: k knobs, then nx states, then the noise of inputs */
  lanes *factor, *shift, *scaled, *offset, *dp;
  lanes *w[3], *LU[2], *base;               /* at the begin of a step and of both its stages */
  whole *pivot[2];
  lanes *y[2], *d[2], *by[2];               /* readings, and derivatives of unknowns and of readings of both stages */
  lanes *shown, *shown_by, *turn;           /* of the sample: what is read, its derivatives; of states before the step */
  lanes *S, *S_new, *P, *AP, *CP, *cross, *gain, *V, *e, *variance;
  lanes *many, *sum, *sum_by;               /* of a piece: readings, and sums of their errors and derivatives */
  whole *pivot_V;
  lanes *slope, *curvature;
} Follow;

/* Solves w = base + h rate(w), and keeps the factors of the last correction. */
static void log_stage(Follow *F, lanes *w, lanes *LU, whole *pivot, lanes h) {
  Runs *R = &F->runs;
  int open[LANES], fine[LANES] = {0};
  memcpy(open, R->on, sizeof open);
  for (int tries = 0; tries < LOG_MOST && any(open); tries++) {
    linear(R, w, h, 0, R->LU, R->pivot, fine);
    for (whole i = 0; i < F->nw; i++) R->left[i] = i < F->nx ? w[i] - F->base[i] - h * R->r[i] : R->r[i];
    EACH if (open[l]) {
      for (whole i = 0; i < F->nw * F->nw; i++) LU[i][l] = R->LU[i][l];
      for (whole i = 0; i < F->nw; i++) pivot[i * LANES + l] = R->pivot[i * LANES + l];
    }
    solved(R->LU, R->pivot, F->nw, R->left);
    EACH if (open[l]) {
      double size = 0;
      for (whole i = 0; i < F->nw; i++) {
        const double own = fabs(R->left[i][l] / R->plant->scale[i]);
        if (!(own <= size)) size = own;
      }
      const double most = tries < LOG_SHORTER ? LOG_LONG : LOG_SHORT, part = size > most ? most / size : 1;
      for (whole i = 0; i < F->nw; i++) w[i][l] -= part * R->left[i][l];
      if (!(size >= LOG_SETTLED)) open[l] = 0;
    }
  }
}

/* Derivatives of some rows by the plant's knobs and inputs along the knobs here, and along the noise of inputs: adds
   `part` times them to columns of b, `height` apart. */
static void along(Follow *F, Pattern by, const lanes *entries, lanes *b, whole height, whole from, lanes part) {
  const Plant *P = F->runs.plant;
  const Logs *D = F->logs;
  for (whole j = 0; j < P->knobs + P->given; j++)
    for (whole e = by.begin[j]; e < by.begin[j + 1]; e++) {
      const whole i = by.row[e];
      const lanes value = entries[e] * (i < from ? part : -lanes_all(1.0));
      for (whole c = 0; c < D->k; c++) {
        if (j < P->knobs) b[c * height + i] += value * F->dp[j * D->k + c];
        else if (D->input_of[c] == j - P->knobs)
          b[c * height + i] -= value * (D->gain[c] ? F->runs.u[D->u_at[j - P->knobs]] + F->shift[j - P->knobs]
                                                   : lanes_all(1.0));
      }
      if (j >= P->knobs) b[(D->k + F->nx + j - P->knobs) * height + i] += value * D->noise[j - P->knobs];
    }
}

/* Derivatives of the unknowns of a stage, those of its base in columns of `b`, and of what is read there. */
static void log_turn(Follow *F, int stage, lanes h) {
  Runs *R = &F->runs;
  const Plant *P = R->plant;
  lanes *d = F->d[stage], *by = F->by[stage];
  call(R, P->slopes, 0, F->w[stage + 1], R->sparse, R->direct);
  along(F, P->rates_by, R->sparse, d, F->nw, F->nx, h);
  for (whole c = 0; c < F->columns; c++) solved(F->LU[stage], F->pivot[stage], F->nw, d + c * F->nw);
  call(R, P->reading_slopes, 0, F->w[stage + 1], R->sparse, R->direct);
  memset(by, 0, F->columns * F->reads * sizeof *by);
  for (whole j = 0; j < F->nw; j++)
    for (whole e = P->shown_w.begin[j]; e < P->shown_w.begin[j + 1]; e++)
      for (whole c = 0; c < F->columns; c++)
        by[c * F->reads + P->shown_w.row[e]] += R->sparse[e] * d[c * F->nw + j];
  along(F, P->shown_by, R->direct, by, F->reads, F->reads, lanes_all(1.0));
}

/* c = a b of matrices of (n, m) and (m, columns) that lie column by column, columns `high` and `tall` apart. */
static void product(lanes *c, const lanes *a, const lanes *b, whole n, whole m, whole columns, whole high, whole tall) {
  memset(c, 0, n * columns * sizeof *c);
  for (whole j = 0; j < columns; j++)
    for (whole k = 0; k < m; k++)
      for (whole i = 0; i < n; i++) c[j * n + i] += a[k * high + i] * b[j * tall + k];
}

/* Derivatives behind a step into d[1] and turn, columns of knobs first, from those before it; adds its share to those of
   what is read. */
static void log_slopes(Follow *F, double step, lanes h, double share) {
  const whole nw = F->nw, nx = F->nx;
  for (int stage = 0; stage < 2; stage++) {
    lanes *d = F->d[stage];
    memset(d, 0, F->columns * nw * sizeof *d);
    for (whole c = 0; c < F->columns; c++)
      for (whole i = 0; i < nx; i++) {
        const lanes begin = F->turn[c * nx + i];
        d[c * nw + i] = stage ? begin + (step * (1 - LOG_GAMMA) / h) * (F->d[0][c * nw + i] - begin) : begin;
      }
    log_turn(F, stage, h);
  }
  for (whole c = 0; c < F->columns; c++) memcpy(F->turn + c * nx, F->d[1] + c * nw, nx * sizeof(lanes));
  for (whole i = 0; i < F->columns * F->reads; i++)
    F->shown_by[i] += share * ((1 - LOG_GAMMA) * F->by[0][i] + LOG_GAMMA * F->by[1][i]);
}

/* Covariance of the errors with its factors, gain, covariance after the sample. A walk that gains Q in a sample has Q/3
   in the mean over it, and Q/2 in common with its end. */
static void log_update(Follow *F) {
  const Logs *D = F->logs;
  const whole nx = F->nx, m = F->reads;
  const lanes *C = F->shown_by + D->k * m, *A = F->d[1] + D->k * F->nw, *B = A + nx * F->nw, *E = C + nx * m;
  const whole given = F->runs.plant->given;
  int fine[LANES] = {0};
  product(F->CP, C, F->P, m, nx, nx, m, nx);
  product(F->AP, A, F->P, nx, nx, nx, F->nw, nx);
  for (whole i = 0; i < m; i++)
    for (whole j = 0; j < m; j++) {
      lanes sum = lanes_all(D->state_of[i] >= 0 && D->state_of[i] == D->state_of[j] ? D->Q[D->state_of[i]] / 3 : 0.0);
      for (whole s = 0; s < nx; s++) sum += F->CP[s * m + i] * C[s * m + j];
      for (whole g = 0; g < given; g++) sum += E[g * m + i] * E[g * m + j];
      F->V[i * m + j] = i == j ? sum + F->variance[i] : sum;
    }
  for (whole i = 0; i < nx; i++) {
    for (whole j = 0; j < m; j++) {
      lanes sum = lanes_all(D->state_of[j] == i ? D->Q[i] / 2 : 0.0);
      for (whole s = 0; s < nx; s++) sum += F->AP[s * nx + i] * C[s * m + j];
      for (whole g = 0; g < given; g++) sum += B[g * F->nw + i] * E[g * m + j];
      F->cross[i * m + j] = F->gain[i * m + j] = sum;
    }
  }
  factored(F->V, F->pivot_V, m, fine);
  for (whole i = 0; i < nx; i++) solved(F->V, F->pivot_V, m, F->gain + i * m);
  for (whole i = 0; i < nx; i++)
    for (whole j = 0; j <= i; j++) {
      lanes sum = lanes_all(i == j ? D->Q[i] : 0.0), mirrored = sum;
      for (whole s = 0; s < nx; s++)
        sum += F->AP[s * nx + i] * A[s * F->nw + j], mirrored += F->AP[s * nx + j] * A[s * F->nw + i];
      for (whole g = 0; g < given; g++) {
        const lanes both = B[g * F->nw + i] * B[g * F->nw + j];
        sum += both, mirrored += both;
      }
      for (whole r = 0; r < m; r++)
        sum -= F->gain[i * m + r] * F->cross[j * m + r], mirrored -= F->gain[j * m + r] * F->cross[i * m + r];
      F->P[j * nx + i] = F->P[i * nx + j] = (sum + mirrored) / 2;
    }
}

/* Adds the errors of a sample to those of its piece, and behind it their means: each a t, as least squares that are weighted
   anew at every pass. by_z (reads, k) is used up. */
static void log_count(Follow *F, lanes *by_z, lanes counts, lanes ends) {
  const whole m = F->reads, k = F->logs->k;
  const double tails = *F->logs->tails;
  for (whole i = 0; i < m; i++) {
    const double sd = F->logs->spread[i], own = F->logs->scatter[i] * F->logs->scatter[i];
    const lanes there = lanes_only(F->variance[i] == own, counts);
    F->many[i] += there, F->sum[i] += there * F->e[i];
    for (whole c = 0; c < k; c++) F->sum_by[i * k + c] += lanes_only(there != 0, by_z[c * m + i]);
    if (!lanes_any(lanes_where(ends != 0))) continue;
    const lanes n = lanes_only(ends != 0, F->many[i]), e = lanes_only(n != 0, F->sum[i] / n) / sd;
    const lanes weight = (tails + 1) / (tails + e * e);
    for (whole c = 0; c < k; c++) by_z[c * m + i] = lanes_only(n != 0, F->sum_by[i * k + c] / n) / sd;
    for (whole c = 0; c < k; c++) {
      F->slope[c] += weight * by_z[c * m + i] * e;
      for (whole b = 0; b < k; b++) F->curvature[c * k + b] += weight * by_z[c * m + i] * by_z[b * m + i];
    }
    F->many[i] = lanes_only(ends == 0, F->many[i]), F->sum[i] = lanes_only(ends == 0, F->sum[i]);
    for (whole c = 0; c < k; c++) F->sum_by[i * k + c] = lanes_only(ends == 0, F->sum_by[i * k + c]);
  }
}

/* Correction of the unknowns, of the derivatives of the states, and what it says. */
static void log_correct(Follow *F, lanes corrects, lanes counts, lanes ends) {
  const Logs *D = F->logs;
  const whole nx = F->nx, m = F->reads, k = D->k;
  lanes *by_z = F->by[0];
  if (lanes_any(lanes_where(corrects != 0))) log_update(F);
  for (whole i = 0; i < nx * m; i++) F->gain[i] = lanes_only(corrects != 0, F->gain[i]);
  product(by_z, F->shown_by + k * m, F->S, m, nx, k, m, nx);
  product(F->S_new, F->d[1] + k * F->nw, F->S, nx, nx, k, F->nw, nx);
  for (whole c = 0; c < k; c++) {
    for (whole i = 0; i < m; i++) {
      const lanes own = D->gain[c] ? F->shown[i] : lanes_all(1.0);
      by_z[c * m + i] += F->shown_by[c * m + i] + D->by[i * k + c] * own;
    }
    for (whole i = 0; i < nx; i++) {
      lanes sum = F->S_new[c * nx + i] + F->d[1][c * F->nw + i];
      for (whole r = 0; r < m; r++) sum -= F->gain[i * m + r] * by_z[c * m + r];
      F->S[c * nx + i] = sum;
    }
  }
  for (whole i = 0; i < nx; i++)
    for (whole r = 0; r < m; r++) F->w[0][i] += F->gain[i * m + r] * F->e[r];
  log_count(F, by_z, counts, ends);
}

/* The inputs of a sample. */
static void log_given(Follow *F) {
  Runs *R = &F->runs;
  const Logs *D = F->logs;
  for (whole g = 0; g < R->plant->given; g++) {
    EACH R->u[D->u_at[g]][l] = D->given[(R->run[l] * D->L + F->t) * R->plant->given + g];
    R->u[D->u_at[g]] = F->factor[g] * R->u[D->u_at[g]] - F->shift[g];
  }
}

/* Both stages of a step. */
static void log_step(Follow *F, lanes h) {
  for (int stage = 0; stage < 2; stage++) {
    memcpy(F->w[stage + 1], F->w[stage], F->nw * sizeof(lanes));
    for (whole i = 0; i < F->nx; i++)
      F->base[i] = F->w[0][i] + (stage ? (1 - LOG_GAMMA) / LOG_GAMMA * (F->w[1][i] - F->w[0][i]) : lanes_all(0.0));
    log_stage(F, F->w[stage + 1], F->LU[stage], F->pivot[stage], h);
    call(&F->runs, F->runs.plant->readings, 0, F->w[stage + 1], F->y[stage], 0);
  }
}

/* All steps of a sample from its begin; with derivatives on demand. */
static void log_steps(Follow *F, int slopes) {
  const Logs *D = F->logs;
  const whole m = F->reads, nx = F->nx;
  const double step = *D->step / D->parts;
  const lanes h = lanes_all(step * LOG_GAMMA);
  memset(F->shown, 0, m * sizeof(lanes)), memset(F->shown_by, 0, F->columns * m * sizeof(lanes));
  for (whole c = 0; c < F->columns; c++)
    for (whole i = 0; i < nx; i++) F->turn[c * nx + i] = lanes_all((double)(c - D->k == i));
  log_given(F);
  for (whole part = 1; part <= D->parts; part++) {
    const double share = 1.0 / D->parts;
    log_step(F, h);
    for (whole i = 0; i < m; i++) F->shown[i] += share * ((1 - LOG_GAMMA) * F->y[0][i] + LOG_GAMMA * F->y[1][i]);
    if (slopes) log_slopes(F, step, h, share);
    memcpy(F->w[0], F->w[2], F->nw * sizeof(lanes));
  }
  for (whole i = 0; i < m; i++) {
    F->shown[i] *= F->scaled[i];
    for (whole c = 0; c < F->columns; c++) F->shown_by[c * m + i] *= F->scaled[i];
  }
}

/* One sample of all lanes that are on. */
static void log_sample(Follow *F, const Told *told) {
  Runs *R = &F->runs;
  const Logs *D = F->logs;
  const whole m = F->reads;
  lanes counts = lanes_all(0.0), corrects = counts, ends = counts;
  whole at[LANES];
  EACH {
    at[l] = R->run[l] * D->L + F->t;
    counts[l] = R->on[l] && D->counts[at[l]];
    corrects[l] = R->on[l] && !D->counts[at[l]];
    ends[l] = R->on[l] && D->ends[at[l]];
  }
  const int slopes = D->k || lanes_any(lanes_where(corrects != 0));
  log_steps(F, slopes);
  for (whole i = 0; i < m; i++) {
    const lanes y = F->shown[i] + F->offset[i];
    EACH {
      const double e = D->read[at[l] * m + i] - y[l], own = D->scatter[i] * D->scatter[i];
      F->e[i][l] = isfinite(e) ? e : 0, F->variance[i][l] = isfinite(e) ? own : MISSING * own;
      if (R->on[l]) told->shown[at[l] * m + i] = y[l];
    }
  }
  if (slopes) log_correct(F, corrects, counts, ends);
}

static void log_placed(Follow *F, Room *room) {
  Runs *R = &F->runs;
  const Plant *P = R->plant;
  const whole nx = F->nx, nw = F->nw, m = F->reads, k = F->logs->k, pivots = nw * LANES * sizeof(whole);
  R->p = vectors(room, P->np), R->c = vectors(room, P->nc), R->u = vectors(room, P->nu);
  R->r = vectors(room, nw), R->left = vectors(room, nw);
  R->sparse = vectors(room, P->most), R->direct = vectors(room, P->most);
  R->LU = vectors(room, nw * nw), R->pivot = bytes(room, pivots);
  F->factor = vectors(room, P->given), F->shift = vectors(room, P->given), F->offset = vectors(room, m);
  F->scaled = vectors(room, m);
  F->turn = vectors(room, F->columns * nx);
  F->shown = vectors(room, m), F->shown_by = vectors(room, F->columns * m);
  F->dp = vectors(room, P->knobs * k), F->base = vectors(room, nx);
  for (int stage = 0; stage < 3; stage++) F->w[stage] = vectors(room, nw);
  for (int stage = 0; stage < 2; stage++) {
    F->LU[stage] = vectors(room, nw * nw), F->pivot[stage] = bytes(room, pivots), F->y[stage] = vectors(room, m);
    F->d[stage] = vectors(room, nw * F->columns), F->by[stage] = vectors(room, m * F->columns);
  }
  F->e = vectors(room, m), F->variance = vectors(room, m);
  F->many = vectors(room, m), F->sum = vectors(room, m), F->sum_by = vectors(room, m * k);
  F->S = vectors(room, nx * k), F->S_new = vectors(room, nx * k), F->P = vectors(room, nx * nx);
  F->AP = vectors(room, nx * nx), F->CP = vectors(room, m * nx), F->cross = vectors(room, nx * m);
  F->gain = vectors(room, nx * m), F->V = vectors(room, m * m);
  F->pivot_V = bytes(room, m * LANES * (whole)sizeof(whole));
  F->slope = vectors(room, k), F->curvature = vectors(room, k * k);
}

/* Windows from a number on; lanes without one repeat the last, and are never on. */
static void log_begun(Follow *F, whole from, whole to) {
  Runs *R = &F->runs;
  const Plant *P = R->plant;
  const Logs *D = F->logs;
  begun(R, D->p, from, to), across(F->dp, D->dp, from, to, P->knobs * D->k);
  across(F->factor, D->factor, from, to, P->given), across(F->shift, D->shift, from, to, P->given);
  across(F->scaled, D->scaled, from, to, F->reads);
  across(F->offset, D->offset, from, to, F->reads), across(F->w[0], D->x0, from, to, F->nx);
  for (whole i = 0; i < P->nu; i++) R->u[i] = lanes_all(D->u[i]);
  for (whole i = F->nx; i < F->nw; i++) F->w[0][i] = lanes_all(D->z0[i - F->nx]);
  memset(F->P, 0, F->nx * F->nx * sizeof(lanes)), across(F->S, D->S0, from, to, F->nx * D->k);
  for (whole i = 0; i < F->nx; i++) F->P[i * F->nx + i] = lanes_all(D->P0[i]);
  memset(F->many, 0, F->reads * sizeof(lanes)), memset(F->sum, 0, F->reads * sizeof(lanes));
  memset(F->sum_by, 0, F->reads * D->k * sizeof(lanes));
  memset(F->slope, 0, D->k * sizeof(lanes)), memset(F->curvature, 0, D->k * D->k * sizeof(lanes));
}

/* The windows from the first to before the second number; 0 where memory runs out. */
__attribute__((visibility("default"))) int follow(const Plant *plant, const Logs *logs, const Told *told, whole from,
                                                  whole to) {
  const whole row = 0;
  const Duty one = {.S = 1, .H = 1, .row = &row};
  Follow F = {.runs = {.plant = plant, .duty = &one}, .logs = logs, .nx = plant->nx, .nw = plant->nw,
              .reads = plant->shown, .columns = logs->k + plant->nx + plant->given};
  Room room = {0};
  void *block;
  log_placed(&F, &room);
  room.begin = aligned(room.used, &block), room.used = 0;
  if (!room.begin) return 0;
  log_placed(&F, &room);
  for (whole first = from; first < to; first += LANES) {
    log_begun(&F, first, to);
    for (F.t = 0; F.t < logs->L; F.t++) {
      EACH F.runs.on[l] = F.runs.fine[l] && F.t < logs->length[F.runs.run[l]];
      if (!any(F.runs.on)) break;
      log_sample(&F, told);
    }
    for (int l = 0; l < LANES && first + l < to; l++) {
      const whole run = first + l;
      for (whole i = 0; i < logs->k; i++) told->slope[run * logs->k + i] = F.slope[i][l];
      for (whole i = 0; i < logs->k * logs->k; i++) told->curvature[run * logs->k * logs->k + i] = F.curvature[i][l];
    }
  }
  free(block);
  return 1;
}
