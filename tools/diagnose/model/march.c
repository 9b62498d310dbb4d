/* Runs of a rig, one after the other: dwells by a singly diagonally implicit Runge-Kutta method, and the exact
   derivatives of what is read, by the adjoint of the discrete solution. Some runs go side by side, one in each lane of
   a vector, and know nothing of one another.

   Arrays lie row by row. w is (states, algebraic variables), c counts what is read: reading after reading, each with
   all that the plant shows. The text of lanes.h stands above this one. */

typedef long long whole;
/* Two results by (w, u, p, c); the second may have no entries. c are constants that follow from p. */
typedef void (*Formula)(const lanes *, const lanes *, const lanes *, const lanes *, lanes *, lanes *);

/* Columns of a sparse matrix: where each begins, and the row of each entry. */
typedef struct { const whole *begin, *row; } Pattern;

/* A rig: sizes, compiled formulas, patterns of their matrices. */
typedef struct {
  whole nx, nw, nu, np, knobs, given, shown, tried, most, nc;
  Formula constants, rates, slopes, readings, reading_slopes, trials;
  Pattern rates_w, rates_by, shown_w, shown_by, rates_tried, shown_tried;
  const double *scale, *guess, *thermal;
} Plant;

/* What n runs go through: F phases in H rows, K steps and R readings in all; derivatives at S settings. */
typedef struct {
  whole n, S, H, F, K, R;
  whole steady;                               /* whether steady states are read, which no step before has a part in */
  const whole *row, *first, *read;            /* of each phase (F), (F + 1), of each step (K): number of the reading or -1 */
  const whole *paced;                         /* whether its row's pace is that of a phase (F) */
  const whole *wanted;                        /* whether derivatives by a column are: knobs, pace, given inputs, tried
                                                 knobs of one further setting after the other */
  const double *share;                        /* where each step ends (K) */
  const double *length, *u0, *u1, *p, *pace;  /* (n, F), (n, F, nu), (n, F, nu), (S, n, H, np), (n, H) */
  const double *local0, *local1, *start, *x0; /* (n, F, given, H), (n, F, given, H), (n, given), (n, nx) */
} Duty;

/* What is shown (n, R, shown) and its derivatives: by knobs and pace (n, H, knobs + 1, R, shown), by given readings
   (n, given, H, R, shown), by the tried knobs at the further settings (n, S - 1, H, tried, R, shown); all are left out
   where `by` is none. */
typedef struct { double *y, *by, *local, *tried; } Found;

/* The method of Alexander (1977): third order, L-stable, stiffly accurate. A holds the weights over the diagonal's. */
#define STAGES 3
#define GAMMA 0.43586652150845899942
static const double C[STAGES] = {GAMMA, 0.5 * (1 + GAMMA), 1};
static const double A[STAGES][STAGES] = {
    {1, 0, 0},
    {0.5 * (1 - GAMMA) / GAMMA, 1, 0},
    {(-1.5 * GAMMA + 4 - 0.25 / GAMMA), (1.5 * GAMMA - 5 + 1.25 / GAMMA), 1}};

/* Newton's corrections at most, and those taken whole: halves meet at the steep middle of a thermostat, where whole ones
   go to and fro. Size over the nominals of the last; of one that moves no derivative; longest one; a temperature of a
   runaway [K]. */
enum { MOST = 34, WHOLE = 14 };
static const double SETTLED = 1e-4, NOTHING = 1e-6, LONGEST = 10, RUNAWAY = 700;

#define EACH for (int l = 0; l < LANES; l++)

/* One solved stage: which lanes took part, and what each has of it. */
typedef struct {
  lanes *w, *r, *LU, time, length;
  double share;
  whole *pivot, phase, read;
  int on[LANES];
} Stage;

/* Runs side by side; lanes without one repeat the last, and are not fine. */
typedef struct {
  const Plant *plant;
  const Duty *duty;
  whole run[LANES], phase, stages;
  int fine[LANES], on[LANES];        /* has not failed; takes part in the step */
  lanes *p, *c, *u, *sparse, *direct, *r, *x, *base, *d;
  lanes *w, *last, *trial;           /* unknowns now, those of the stage before, those tried */
  double now, before;                /* shares of the phase at w and last; equal where the last is none */
  lanes *left, *LU;
  lanes *lambda, *mu, *later;        /* derivatives by the states of a step, a stage's unknowns, its difference */
  lanes *behind;                     /* derivatives by the base of each stage of a step */
  whole *pivot;
  Stage *stage;                      /* those solved so far, where derivatives are asked for */
} Runs;

static int any(const int *which) {
  int found = 0;
  EACH found |= which[l];
  return found;
}

static void inputs(Runs *R, double share) {
  const Plant *P = R->plant;
  EACH {
    const whole at = (R->run[l] * R->duty->F + R->phase) * P->nu;
    const double *a = R->duty->u0 + at, *b = R->duty->u1 + at;
    for (whole i = 0; i < P->nu; i++) R->u[i][l] = a[i] + share * (b[i] - a[i]);
  }
}

static void call(Runs *R, Formula formula, whole setting, const lanes *w, lanes *first, lanes *second) {
  const whole row = setting * R->duty->H + R->duty->row[R->phase];
  formula(w, R->u, R->p + row * R->plant->np, R->c + row * R->plant->nc, first, second);
}

/* Exchanges row k of b (n, width) with the pivot's in the lanes where that is another one. */
static void exchanged(lanes *b, whole k, const whole *pivot, whole from, whole to, whole width) {
  EACH if (pivot[l] != k)
    for (whole c = from; c < to; c++) {
      const double kept = b[k * width + c][l];
      b[k * width + c][l] = b[pivot[l] * width + c][l], b[pivot[l] * width + c][l] = kept;
    }
}

/* Factors of n x n matrices, rows exchanged; clears the lanes of `fine` that have none. */
static void factored(lanes *a, whole *pivot, whole n, int *fine) {
  for (whole k = 0; k < n; k++, pivot += LANES) {
    EACH {
      pivot[l] = k;
      for (whole i = k + 1; i < n; i++)
        if (fabs(a[i * n + k][l]) > fabs(a[pivot[l] * n + k][l])) pivot[l] = i;
      const double best = fabs(a[pivot[l] * n + k][l]);
      if (!(best > 0) || !isfinite(best)) fine[l] = 0;
    }
    exchanged(a, k, pivot, k, n, n);
    for (whole i = k + 1; i < n; i++) {
      if (!lanes_any(lanes_where(a[i * n + k] != 0))) continue;
      const lanes part = a[i * n + k] /= a[k * n + k];
      for (whole j = k + 1; j < n; j++) a[i * n + j] -= part * a[k * n + j];
    }
  }
}

static void solved(const lanes *a, const whole *pivot, whole n, lanes *b) {
  for (whole k = 0; k < n; k++) {
    exchanged(b, k, pivot + k * LANES, 0, 1, 1);
    for (whole i = k + 1; i < n; i++) b[i] -= a[i * n + k] * b[k];
  }
  for (whole k = n - 1; k >= 0; k--) {
    b[k] /= a[k * n + k];
    for (whole i = 0; i < k; i++) b[i] -= a[i * n + k] * b[k];
  }
}

/* The same with the transposed matrix and columns from `from` to before `to` of b (n, width). */
static void turned(const lanes *a, const whole *pivot, whole n, lanes *b, whole from, whole to, whole width) {
  for (whole k = 0; k < n; k++) {
    for (whole i = 0; i < k; i++)
      if (lanes_any(lanes_where(a[i * n + k] != 0)))
        for (whole c = from; c < to; c++) b[k * width + c] -= a[i * n + k] * b[i * width + c];
    for (whole c = from; c < to; c++) b[k * width + c] /= a[k * n + k];
  }
  for (whole k = n - 1; k >= 0; k--) {
    for (whole i = k + 1; i < n; i++)
      if (lanes_any(lanes_where(a[i * n + k] != 0)))
        for (whole c = from; c < to; c++) b[k * width + c] -= a[i * n + k] * b[i * width + c];
    exchanged(b, k, pivot + k * LANES, from, to, width);
  }
}

/* Rates at w into R->r, and the factors of (1 - length d rate / dw; d residual / dw) from row and column `from` on. */
static void linear(Runs *R, const lanes *w, lanes length, whole from, lanes *LU, whole *pivot, int *fine) {
  const Plant *P = R->plant;
  const whole n = P->nw - from;
  call(R, P->rates, 0, w, R->r, R->sparse);
  memset(LU, 0, n * n * sizeof *LU);
  for (whole j = from; j < P->nw; j++) {
    for (whole e = P->rates_w.begin[j]; e < P->rates_w.begin[j + 1]; e++) {
      const whole i = P->rates_w.row[e];
      if (i >= from) LU[(i - from) * n + j - from] = i < P->nx ? -length * R->sparse[e] : R->sparse[e];
    }
    if (j < P->nx) LU[(j - from) * n + j - from] += 1.0;
  }
  factored(LU, pivot, n, fine);
}

/* Newton's method for w from row `from` on in the lanes of `left`, which keeps those without a solution; the states
   solve w = R->base + length rate(w). Returns the size of the last correction. */
static double newton(Runs *R, lanes *w, lanes length, whole from, int *left) {
  const Plant *P = R->plant;
  double last = INFINITY;
  int open[LANES];
  memcpy(open, left, sizeof open);
  for (int tries = 0; tries < MOST && any(open); tries++) {
    last = 0;
    linear(R, w, length, from, R->LU, R->pivot, open);
    for (whole i = from; i < P->nw; i++) R->left[i - from] = i < P->nx ? w[i] - R->base[i] - length * R->r[i] : R->r[i];
    solved(R->LU, R->pivot, P->nw - from, R->left);
    EACH {
      double size = 0;
      for (whole i = from; i < P->nw && open[l]; i++) {
        const double own = fabs(R->left[i - from][l] / P->scale[i]);
        if (!(own <= size)) size = own;
      }
      if (!isfinite(size)) open[l] = 0;
      const double part = size > LONGEST ? LONGEST / size : tries < WHOLE || size < SETTLED ? 1 : 0.5;
      for (whole i = from; i < P->nw && open[l]; i++) w[i][l] -= part * R->left[i - from][l];
      if (open[l] && size > last) last = size;
      if (open[l] && size < SETTLED) open[l] = left[l] = 0;
    }
  }
  return last;
}

/* The algebraic variables after a jump of the inputs, from the last ones or from the model's guess. */
static void consistent(Runs *R) {
  const Plant *P = R->plant;
  int left[LANES], before[LANES];
  memcpy(left, R->fine, sizeof left);
  inputs(R, 0);
  R->now = R->before = 0;
  for (int guess = 0; guess < 2 && P->nw > P->nx; guess++) {
    memcpy(before, left, sizeof left);
    memcpy(R->trial, R->w, P->nw * sizeof *R->w);
    for (whole i = P->nx; i < P->nw && guess; i++) R->trial[i] = lanes_all(P->guess[i - P->nx]);
    newton(R, R->trial, lanes_all(0.0), P->nx, left);
    EACH if (before[l] && !left[l])
      for (whole i = P->nx; i < P->nw; i++) R->w[i][l] = R->trial[i][l];
  }
}

/* A stage at a share of the phase, from a line through the last two or else from the last; lanes that fail are out. In
   the long steps to a steady state, which grow, such a line overshoots, and may end in a hotter steady state. */
static void stage(Runs *R, lanes time, double share, whole read, int kept) {
  const Plant *P = R->plant;
  const double ahead = R->now > R->before && !R->duty->steady ? (share - R->now) / (R->now - R->before) : 0;
  lanes length = time;
  int left[LANES];
  if (R->duty->paced[R->phase])
    EACH length[l] *= R->duty->pace[R->run[l] * R->duty->H + R->duty->row[R->phase]];
  memcpy(left, R->on, sizeof left);
  inputs(R, share);
  for (whole i = 0; i < P->nw; i++) {
    R->trial[i] = R->w[i];
    EACH if (left[l] && ahead != 0) R->trial[i][l] = R->w[i][l] + ahead * (R->w[i][l] - R->last[i][l]);
  }
  double last = newton(R, R->trial, length, 0, left);
  if (any(left) && ahead != 0) {
    EACH if (left[l])
      for (whole i = 0; i < P->nw; i++) R->trial[i][l] = R->w[i][l];
    last = newton(R, R->trial, length, 0, left);
  }
  lanes *old = R->last;
  R->last = R->w, R->w = R->trial, R->trial = old;
  R->before = R->now, R->now = share;
  EACH if (left[l]) R->on[l] = R->fine[l] = 0;
  if (!kept) return;
  Stage *s = R->stage + R->stages++;
  memcpy(s->w, R->w, P->nw * sizeof *R->w);
  s->time = time, s->length = length, s->share = share, s->phase = R->phase, s->read = read;
  memcpy(left, R->on, sizeof left);
  if (last < NOTHING)
    memcpy(s->LU, R->LU, P->nw * P->nw * sizeof *s->LU), memcpy(s->pivot, R->pivot, P->nw * LANES * sizeof *s->pivot);
  else linear(R, s->w, length, 0, s->LU, s->pivot, left);
  memcpy(s->r, R->r, P->nx * sizeof *R->r);
  EACH if (R->on[l] && !left[l]) R->on[l] = R->fine[l] = 0;
  memcpy(s->on, R->on, sizeof s->on);
}

/* A step of the phase to a share of it, h long in each lane. */
static void step(Runs *R, lanes h, double begin, double end, whole read, int kept) {
  const Plant *P = R->plant;
  memcpy(R->x, R->w, P->nx * sizeof *R->x);
  for (int k = 0; k < STAGES; k++) {
    memcpy(R->base, R->x, P->nx * sizeof *R->x);
    for (int j = 0; j < k; j++)
      for (whole i = 0; i < P->nx; i++) R->base[i] += A[k][j] * R->d[j * P->nx + i];
    stage(R, h * GAMMA, begin + C[k] * (end - begin), k == STAGES - 1 ? read : -1, kept);
    for (whole i = 0; i < P->nx; i++) R->d[k * P->nx + i] = R->w[i] - R->base[i];
  }
}

/* All phases of the runs; one of no length is one step without time where it is read, else none. Long steps of Euler's
   implicit method meet a steady state whatever came before. */
static void forward(Runs *R, double *y, int kept) {
  const Plant *P = R->plant;
  const Duty *D = R->duty;
  for (whole i = 0; i < P->nx; i++) EACH R->w[i][l] = D->x0[R->run[l] * P->nx + i];
  for (whole i = P->nx; i < P->nw; i++) R->w[i] = lanes_all(P->guess[i - P->nx]);
  R->stages = 0;
  for (R->phase = 0; R->phase < D->F && any(R->fine); R->phase++) {
    double begin = 0;
    lanes h;
    consistent(R);
    for (whole k = D->first[R->phase]; k < D->first[R->phase + 1]; begin = D->share[k++]) {
      EACH h[l] = (D->share[k] - begin) * D->length[R->run[l] * D->F + R->phase];
      EACH R->on[l] = R->fine[l] && (h[l] > 0 || D->read[k] >= 0);
      if (!any(R->on)) continue;
      if (D->steady) {
        memcpy(R->base, R->w, P->nx * sizeof *R->base);
        stage(R, h, D->share[k], D->read[k], kept && D->read[k] >= 0);
      } else step(R, h, begin, D->share[k], D->read[k], kept);
      for (whole i = 0; i < P->nw; i++)
        EACH if (R->on[l] && P->thermal[i] != 0 && !(R->w[i][l] < RUNAWAY)) R->on[l] = R->fine[l] = 0;
      if (D->read[k] < 0) continue;
      call(R, P->readings, 0, R->w, R->direct, 0);
      EACH if (R->on[l])
        for (whole i = 0; i < P->shown; i++) y[(R->run[l] * D->R + D->read[k]) * P->shown + i] = R->direct[i][l];
    }
  }
}

/* Adds part of one lane's derivatives v of what is read by one column (knob, pace, then given input), c from `from` to
   `to`. */
static void added(Runs *R, int l, const Found *found, const Stage *s, whole column, double part, const lanes *v,
                  whole from, whole to) {
  const Plant *P = R->plant;
  const Duty *D = R->duty;
  const whole width = D->R * P->shown, g = column - P->knobs - 1;
  if (g < 0) {
    const whole row = R->run[l] * D->H + D->row[s->phase];
    double *by = found->by + (row * (P->knobs + 1) + column) * width;
    for (whole c = from; c < to; c++) by[c] += part * v[c][l];
    return;
  }
  const whole at = ((R->run[l] * D->F + s->phase) * P->given + g) * D->H;
  for (whole h = 0; h < D->H; h++) {
    const double weight = (D->local0[at + h] + s->share * (D->local1[at + h] - D->local0[at + h])) * part;
    double *local = found->local + ((R->run[l] * P->given + g) * D->H + h) * width;
    for (whole c = from; c < to && weight != 0; c++) local[c] += weight * v[c][l];
  }
}

/* What is read after a stage: adds its own derivatives, and those by the unknowns to R->mu. */
static void reading(Runs *R, const Found *found, const Stage *s) {
  const Plant *P = R->plant;
  const whole width = R->duty->R * P->shown, c = s->read * P->shown;
  const lanes one = lanes_all(1.0);
  call(R, P->reading_slopes, 0, s->w, R->sparse, R->direct);
  for (whole j = 0; j < P->nw; j++)
    for (whole e = P->shown_w.begin[j]; e < P->shown_w.begin[j + 1]; e++)
      R->mu[j * width + c + P->shown_w.row[e]] += R->sparse[e];
  for (whole j = 0; j < P->knobs + P->given; j++)
    for (whole e = P->shown_by.begin[j]; e < P->shown_by.begin[j + 1]; e++) {
      const whole own = c + P->shown_by.row[e];
      EACH if (s->on[l]) added(R, l, found, s, j + (j >= P->knobs), R->direct[e][l], &one - own, own, own + 1);
    }
}

/* Derivatives by the tried knobs at a further setting. */
static void tried(Runs *R, const Found *found, const Stage *s, whole setting, whole from) {
  const Plant *P = R->plant;
  const Duty *D = R->duty;
  const whole width = D->R * P->shown, *wanted = D->wanted + P->knobs + 1 + P->given + (setting - 1) * P->tried;
  call(R, P->trials, setting, s->w, R->sparse, R->direct);
  EACH for (whole j = 0; j < P->tried && s->on[l]; j++) {
    if (!wanted[j]) continue;
    const whole row = (R->run[l] * (D->S - 1) + setting - 1) * D->H + D->row[s->phase];
    double *own = found->tried + (row * P->tried + j) * width;
    for (whole e = P->rates_tried.begin[j]; e < P->rates_tried.begin[j + 1]; e++) {
      const whole i = P->rates_tried.row[e];
      const double part = R->sparse[e][l] * (i < P->nx ? s->length[l] : -1);
      for (whole c = from; c < width && part != 0; c++) own[c] += part * R->mu[i * width + c][l];
    }
    for (whole e = P->shown_tried.begin[j]; e < P->shown_tried.begin[j + 1] && s->read >= 0; e++)
      own[s->read * P->shown + P->shown_tried.row[e]] += R->direct[e][l];
  }
}

/* One stage back: R->lambda is by the states after a step, and becomes that by those before it. */
static void back(Runs *R, const Found *found, const Stage *s, int k, whole from) {
  const Plant *P = R->plant;
  const whole width = R->duty->R * P->shown, all = P->nx * width;
  lanes on = lanes_all(0.0);
  EACH on[l] = s->on[l];
  const lanes_bits own = lanes_where(on != 0);
  R->phase = s->phase;
  inputs(R, s->share);
  memset(R->mu, 0, P->nw * width * sizeof *R->mu);
  memset(R->later, 0, all * sizeof *R->later);
  if (s->read >= 0) reading(R, found, s);
  for (int m = k + 1; m < STAGES; m++)
    for (whole i = 0; i < all; i++) R->later[i] += A[m][k] * R->behind[m * all + i];
  for (whole i = 0; i < all && k == STAGES - 1; i++) {
    R->mu[i] += R->lambda[i];
    R->lambda[i] = lanes_select(own, lanes_all(0.0), R->lambda[i]);
  }
  for (whole i = 0; i < all; i++) R->mu[i] += R->later[i];
  turned(s->LU, s->pivot, P->nw, R->mu, from, width, width);
  for (whole i = 0; i < all; i++) {
    R->behind[k * all + i] = R->mu[i] - R->later[i];
    R->lambda[i] += lanes_only(on != 0, R->behind[k * all + i]);
  }
  call(R, P->slopes, 0, s->w, R->sparse, R->direct);
  for (whole j = 0; j < P->knobs + P->given; j++)
    for (whole e = P->rates_by.begin[j]; e < P->rates_by.begin[j + 1] && (j >= P->knobs || R->duty->wanted[j]); e++) {
      const whole i = P->rates_by.row[e];
      const lanes part = R->sparse[e] * (i < P->nx ? s->length : lanes_all(-1.0));
      EACH if (s->on[l] && part[l] != 0)
        added(R, l, found, s, j + (j >= P->knobs), part[l], R->mu + i * width, from, width);
    }
  for (whole i = 0; i < P->nx && R->duty->paced[s->phase]; i++)
    EACH if (s->on[l]) added(R, l, found, s, P->knobs, s->time[l] * s->r[i][l], R->mu + i * width, from, width);
  for (whole setting = 1; setting < R->duty->S; setting++) tried(R, found, s, setting, from);
}

/* Derivatives of what is read, from the last stage back. */
static void backward(Runs *R, const Found *found) {
  const Plant *P = R->plant;
  const Duty *D = R->duty;
  const whole width = D->R * P->shown;
  whole from = width;
  memset(R->lambda, 0, P->nx * width * sizeof *R->lambda);
  for (whole n = R->stages - 1; n >= 0; n--) {
    const whole read = R->stage[n].read;
    if (read >= 0 && read * P->shown < from) from = read * P->shown;
    back(R, found, R->stage + n, D->steady ? STAGES - 1 : (int)(n % STAGES), from);
  }
  EACH for (whole g = 0; g < P->given && R->fine[l]; g++) {
    double *local = found->local + (R->run[l] * P->given + g) * D->H * width;
    for (whole i = 0; i < P->nx; i++)
      for (whole c = 0; c < width; c++)
        local[c] += P->thermal[i] * D->start[R->run[l] * P->given + g] * R->lambda[i * width + c][l];
  }
}

static void lost(double *a, whole n) {
  for (whole i = 0; i < n; i++) a[i] = NAN;
}

/* Room for arrays of vectors, one behind the other; only counted where it begins nowhere. */
typedef struct { lanes *begin; whole used; } Room;

static lanes *vectors(Room *room, whole n) {
  lanes *own = room->begin ? room->begin + room->used : 0;
  room->used += n;
  return own;
}

/* Other things, which fill whole vectors. */
static void *bytes(Room *room, whole n) { return vectors(room, (n + (whole)sizeof(lanes) - 1) / (whole)sizeof(lanes)); }

/* Gives all arrays their place. */
static void placed(Runs *R, Room *room, whole stages) {
  const Plant *P = R->plant;
  const Duty *D = R->duty;
  const whole nw = P->nw, nx = P->nx, width = D->R * P->shown, pivots = nw * LANES * sizeof(whole);
  R->p = vectors(room, D->S * D->H * P->np), R->c = vectors(room, D->S * D->H * P->nc), R->u = vectors(room, P->nu);
  R->sparse = vectors(room, P->most), R->direct = vectors(room, P->most), R->r = vectors(room, nw);
  R->x = vectors(room, nx), R->base = vectors(room, nx), R->d = vectors(room, STAGES * nx);
  R->w = vectors(room, nw), R->last = vectors(room, nw), R->trial = vectors(room, nw);
  R->left = vectors(room, nw), R->LU = vectors(room, nw * nw), R->pivot = bytes(room, pivots);
  R->lambda = vectors(room, nx * width), R->mu = vectors(room, nw * width);
  R->later = vectors(room, nx * width), R->behind = vectors(room, STAGES * nx * width);
  R->stage = bytes(room, stages * sizeof(Stage));
  for (whole n = 0; n < stages; n++) {
    const Stage own = {.w = vectors(room, nw), .r = vectors(room, nx), .LU = vectors(room, nw * nw),
                       .pivot = bytes(room, pivots)};
    if (room->begin) R->stage[n] = own;
  }
}

/* Memory for vectors, none where it runs out; `block` is what to give back. */
static lanes *aligned(whole n, void **block) {
  *block = calloc(n + 1, sizeof(lanes));
  return *block ? (lanes *)(((uintptr_t)*block + sizeof(lanes) - 1) / sizeof(lanes) * sizeof(lanes)) : 0;
}

/* One row of numbers in each lane, from a row of n on; the last row stands in the lanes behind it. */
static void across(lanes *own, const double *rows, whole from, whole n, whole width) {
  EACH for (whole i = 0; i < width; i++) own[i][l] = rows[(from + l < n ? from + l : n - 1) * width + i];
}

/* Runs from a number on with S x H rows of parameters (S, n, H, np), and the constants that follow from them. */
static void begun(Runs *R, const double *p, whole from, whole to) {
  const Plant *P = R->plant;
  const Duty *D = R->duty;
  const whole size = D->H * P->np;
  EACH R->run[l] = from + l < to ? from + l : to - 1, R->fine[l] = from + l < to;
  for (whole s = 0; s < D->S; s++) across(R->p + s * size, p + s * D->n * size, from, to, size);
  for (whole k = 0; k < D->S * D->H; k++) P->constants(0, 0, R->p + k * P->np, 0, R->c + k * P->nc, 0);
}

/* The runs from the first to before the second number; 0 where memory runs out. */
__attribute__((visibility("default"))) int march(const Plant *plant, const Duty *duty, const Found *found, whole from,
                                                 whole to) {
  const int kept = found->by != 0;
  const whole shown = duty->R * plant->shown, by = duty->H * (plant->knobs + 1) * shown;
  const whole local = plant->given * duty->H * shown, others = (duty->S - 1) * duty->H * plant->tried * shown;
  const whole stages = kept ? duty->K * STAGES : 0;
  Runs R = {.plant = plant, .duty = duty};
  Room room = {0};
  void *block;
  placed(&R, &room, stages);
  room.begin = aligned(room.used, &block), room.used = 0;
  if (!room.begin) return 0;
  placed(&R, &room, stages);
  for (whole first = from; first < to; first += LANES) {
    begun(&R, duty->p, first, to);
    forward(&R, found->y, kept);
    for (whole k = 0; k < R.stages; k++) EACH R.stage[k].on[l] &= R.fine[l];
    if (kept && any(R.fine)) backward(&R, found);
    for (whole run = first; run < to && run < first + LANES; run++) {
      if (R.fine[run - first]) continue;
      lost(found->y + run * shown, shown);
      if (!kept) continue;
      lost(found->by + run * by, by), lost(found->local + run * local, local);
      lost(found->tried + run * others, others);
    }
  }
  free(block);
  return 1;
}
