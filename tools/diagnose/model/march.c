/* Runs of a rig, one after the other: dwells by a singly diagonally implicit Runge-Kutta method, and the exact
   derivatives of what is read, by the adjoint of the discrete solution.

   Arrays lie row by row. w is (states, algebraic variables), c counts what is read: reading after reading, each with
   all that the plant shows. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef long long whole;
typedef int (*Formula)(const double **, double **, whole *, double *, int);

/* Columns of a sparse matrix: where each begins, and the row of each entry. */
typedef struct { const whole *begin, *row; } Pattern;

/* A rig: sizes, compiled formulas of (w, u, p), patterns of their matrices. */
typedef struct {
  whole nx, nw, nu, np, knobs, given, shown, tried;
  whole n_arg, n_res, n_iw, n_work, most;
  Formula rates, slopes, readings, reading_slopes, trials;
  Pattern rates_w, rates_by, shown_w, shown_by, rates_tried, shown_tried;
  const double *scale, *guess, *thermal;
} Plant;

/* What n runs go through: F phases in H rows, K steps and R readings in all; derivatives at S settings. */
typedef struct {
  whole n, S, H, F, K, R;
  const whole *row, *first, *read;            /* of each phase (F), (F + 1), of each step (K): number of the reading or -1 */
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

/* Newton's corrections at most; size over the nominals of the last; longest one; a temperature of a runaway [K]. */
enum { MOST = 14 };
static const double SETTLED = 1e-4, LONGEST = 10, RUNAWAY = 700;

/* One solved stage. */
typedef struct {
  double *w, *r, *LU, time, length, share;
  whole *pivot, phase, read;
} Stage;

typedef struct {
  const Plant *plant;
  const Duty *duty;
  whole run, phase, stages, setting;
  const double **arg;
  double **res, *work, *sparse, *direct, *r, *x, *base, *d, *left, *u, *LU;
  double *w, *last, *trial;         /* unknowns now, those of the stage before, those tried */
  double now, before;               /* shares of the phase at w and last; equal where the last is none */
  double *lambda, *mu, *later;      /* derivatives by the states of a step, a stage's unknowns, its difference */
  double *behind, *store;           /* derivatives by the base of each stage of a step */
  whole *iw, *pivot;
  Stage *stage;                     /* those solved so far, where derivatives are asked for */
} Run;

static void inputs(Run *R, double share) {
  const Plant *P = R->plant;
  const whole at = (R->run * R->duty->F + R->phase) * P->nu;
  const double *a = R->duty->u0 + at, *b = R->duty->u1 + at;
  for (whole i = 0; i < P->nu; i++) R->u[i] = a[i] + share * (b[i] - a[i]);
}

static void call(Run *R, Formula formula, const double *w, double *first, double *second) {
  const Duty *D = R->duty;
  const whole row = (R->setting * D->n + R->run) * D->H + D->row[R->phase];
  R->arg[0] = w, R->arg[1] = R->u, R->arg[2] = D->p + row * R->plant->np;
  R->res[0] = first, R->res[1] = second;
  formula(R->arg, R->res, R->iw, R->work, 0);
}

/* Factors of an n x n matrix, rows exchanged; zero where it has none. */
static int factored(double *a, whole *pivot, whole n) {
  for (whole k = 0; k < n; k++) {
    whole best = k;
    for (whole i = k + 1; i < n; i++)
      if (fabs(a[i * n + k]) > fabs(a[best * n + k])) best = i;
    pivot[k] = best;
    if (!(fabs(a[best * n + k]) > 0) || !isfinite(a[best * n + k])) return 0;
    if (best != k)
      for (whole j = k; j < n; j++) {
        const double kept = a[k * n + j];
        a[k * n + j] = a[best * n + j], a[best * n + j] = kept;
      }
    for (whole i = k + 1; i < n; i++) {
      if (a[i * n + k] == 0) continue;
      const double l = a[i * n + k] /= a[k * n + k];
      for (whole j = k + 1; j < n; j++) a[i * n + j] -= l * a[k * n + j];
    }
  }
  return 1;
}

static void solved(const double *a, const whole *pivot, whole n, double *b) {
  for (whole k = 0; k < n; k++) {
    const double kept = b[pivot[k]];
    b[pivot[k]] = b[k], b[k] = kept;
    for (whole i = k + 1; i < n; i++) b[i] -= a[i * n + k] * kept;
  }
  for (whole k = n - 1; k >= 0; k--) {
    b[k] /= a[k * n + k];
    for (whole i = 0; i < k; i++) b[i] -= a[i * n + k] * b[k];
  }
}

/* The same with the transposed matrix and columns from `from` to before `to` of b (n, width). */
static void turned(const double *a, const whole *pivot, whole n, double *b, whole from, whole to, whole width) {
  for (whole k = 0; k < n; k++) {
    double *own = b + k * width;
    for (whole i = 0; i < k; i++) {
      const double u = a[i * n + k], *other = b + i * width;
      if (u != 0)
        for (whole c = from; c < to; c++) own[c] -= u * other[c];
    }
    for (whole c = from; c < to; c++) own[c] /= a[k * n + k];
  }
  for (whole k = n - 1; k >= 0; k--) {
    double *own = b + k * width, *swapped = b + pivot[k] * width;
    for (whole i = k + 1; i < n; i++) {
      const double l = a[i * n + k], *other = b + i * width;
      if (l != 0)
        for (whole c = from; c < to; c++) own[c] -= l * other[c];
    }
    if (own != swapped)
      for (whole c = from; c < to; c++) {
        const double kept = own[c];
        own[c] = swapped[c], swapped[c] = kept;
      }
  }
}

/* Rates at w into R->r, and the factors of (1 - length d rate / dw; d residual / dw) from row and column `from` on. */
static int linear(Run *R, const double *w, double length, whole from, double *LU, whole *pivot) {
  const Plant *P = R->plant;
  const whole n = P->nw - from;
  call(R, P->rates, w, R->r, R->sparse);
  memset(LU, 0, n * n * sizeof *LU);
  for (whole j = from; j < P->nw; j++) {
    for (whole e = P->rates_w.begin[j]; e < P->rates_w.begin[j + 1]; e++) {
      const whole i = P->rates_w.row[e];
      if (i >= from) LU[(i - from) * n + j - from] = i < P->nx ? -length * R->sparse[e] : R->sparse[e];
    }
    if (j < P->nx) LU[(j - from) * n + j - from] += 1;
  }
  return factored(LU, pivot, n);
}

/* Newton's method for w from row `from` on; the states solve w = R->base + length rate(w). */
static int newton(Run *R, double *w, double length, whole from) {
  const Plant *P = R->plant;
  for (int tries = 0; tries < MOST; tries++) {
    if (!linear(R, w, length, from, R->LU, R->pivot)) return 0;
    for (whole i = from; i < P->nw; i++) R->left[i - from] = i < P->nx ? w[i] - R->base[i] - length * R->r[i] : R->r[i];
    solved(R->LU, R->pivot, P->nw - from, R->left);
    double size = 0;
    for (whole i = from; i < P->nw; i++) {
      const double own = fabs(R->left[i - from] / P->scale[i]);
      if (!(own <= size)) size = own;
    }
    if (!isfinite(size)) return 0;
    const double part = size > LONGEST ? LONGEST / size : 1;
    for (whole i = from; i < P->nw; i++) w[i] -= part * R->left[i - from];
    if (size < SETTLED) return 1;
  }
  return 0;
}

/* The algebraic variables after a jump of the inputs, from the last ones or from the model's guess. */
static void consistent(Run *R) {
  const Plant *P = R->plant;
  inputs(R, 0);
  R->now = R->before = 0;
  for (int guess = 0; guess < 2 && P->nw > P->nx; guess++) {
    memcpy(R->trial, R->w, P->nw * sizeof *R->w);
    if (guess) memcpy(R->trial + P->nx, P->guess, (P->nw - P->nx) * sizeof *R->w);
    if (newton(R, R->trial, 0, P->nx)) {
      memcpy(R->w, R->trial, P->nw * sizeof *R->w);
      return;
    }
  }
}

/* A stage at a share of the phase, from a line through the last two or else from the last. */
static int stage(Run *R, double time, double share, whole read, int kept) {
  const Plant *P = R->plant;
  const double length = time * R->duty->pace[R->run * R->duty->H + R->duty->row[R->phase]];
  const double ahead = R->now > R->before ? (share - R->now) / (R->now - R->before) : 0;
  inputs(R, share);
  for (int line = 1; line >= 0; line--) {
    for (whole i = 0; i < P->nw; i++) R->trial[i] = R->w[i] + (line && ahead != 0 ? ahead * (R->w[i] - R->last[i]) : 0);
    if (newton(R, R->trial, length, 0)) break;
    if (!line || ahead == 0) return 0;
  }
  double *old = R->last;
  R->last = R->w, R->w = R->trial, R->trial = old;
  R->before = R->now, R->now = share;
  if (!kept) return 1;
  Stage *s = R->stage + R->stages++;
  memcpy(s->w, R->w, P->nw * sizeof *R->w);
  s->time = time, s->length = length, s->share = share, s->phase = R->phase, s->read = read;
  const int fine = linear(R, s->w, length, 0, s->LU, s->pivot);
  memcpy(s->r, R->r, P->nx * sizeof *R->r);
  return fine;
}

/* A step of the phase to a share of it. */
static int step(Run *R, double h, double begin, double end, whole read, int kept) {
  const Plant *P = R->plant;
  memcpy(R->x, R->w, P->nx * sizeof *R->x);
  for (int k = 0; k < STAGES; k++) {
    memcpy(R->base, R->x, P->nx * sizeof *R->x);
    for (int j = 0; j < k; j++)
      for (whole i = 0; i < P->nx; i++) R->base[i] += A[k][j] * R->d[j * P->nx + i];
    if (!stage(R, h * GAMMA, begin + C[k] * (end - begin), k == STAGES - 1 ? read : -1, kept)) return 0;
    for (whole i = 0; i < P->nx; i++) R->d[k * P->nx + i] = R->w[i] - R->base[i];
  }
  for (whole i = 0; i < P->nw; i++)
    if (P->thermal[i] != 0 && !(R->w[i] < RUNAWAY)) return 0;
  return 1;
}

/* All phases of a run; one of no length is one step without time where it is read, else none. */
static int forward(Run *R, double *y, int kept) {
  const Plant *P = R->plant;
  const Duty *D = R->duty;
  memcpy(R->w, D->x0 + R->run * P->nx, P->nx * sizeof *R->w);
  memcpy(R->w + P->nx, P->guess, (P->nw - P->nx) * sizeof *R->w);
  R->stages = 0;
  for (R->phase = 0; R->phase < D->F; R->phase++) {
    const double span = D->length[R->run * D->F + R->phase];
    double begin = 0;
    consistent(R);
    for (whole k = D->first[R->phase]; k < D->first[R->phase + 1]; k++) {
      const double end = D->share[k];
      if (span > 0 || D->read[k] >= 0) {
        if (!step(R, (end - begin) * span, begin, end, D->read[k], kept)) return 0;
        if (D->read[k] >= 0) call(R, P->readings, R->w, y + D->read[k] * P->shown, 0);
      }
      begin = end;
    }
  }
  return 1;
}

/* Adds part of the derivatives v of what is read by one column (knob, pace, then given input), c from `from` to `to`. */
static void added(Run *R, const Found *found, const Stage *s, whole column, double part, const double *v, whole from,
                  whole to) {
  const Plant *P = R->plant;
  const Duty *D = R->duty;
  const whole width = D->R * P->shown, g = column - P->knobs - 1;
  if (g < 0) {
    const whole row = R->run * D->H + D->row[s->phase];
    double *by = found->by + (row * (P->knobs + 1) + column) * width + from;
    for (whole c = 0; c < to - from; c++) by[c] += part * v[c];
    return;
  }
  const whole at = ((R->run * D->F + s->phase) * P->given + g) * D->H;
  for (whole h = 0; h < D->H; h++) {
    const double weight = (D->local0[at + h] + s->share * (D->local1[at + h] - D->local0[at + h])) * part;
    double *local = found->local + ((R->run * P->given + g) * D->H + h) * width + from;
    if (weight != 0)
      for (whole c = 0; c < to - from; c++) local[c] += weight * v[c];
  }
}

/* What a reading after a stage follows: adds its own derivatives, and those by the unknowns to R->mu. */
static void reading(Run *R, const Found *found, const Stage *s) {
  const Plant *P = R->plant;
  const whole width = R->duty->R * P->shown, c = s->read * P->shown;
  const double one = 1;
  call(R, P->reading_slopes, s->w, R->sparse, R->direct);
  for (whole j = 0; j < P->nw; j++)
    for (whole e = P->shown_w.begin[j]; e < P->shown_w.begin[j + 1]; e++)
      R->mu[j * width + c + P->shown_w.row[e]] += R->sparse[e];
  for (whole j = 0; j < P->knobs + P->given; j++)
    for (whole e = P->shown_by.begin[j]; e < P->shown_by.begin[j + 1]; e++) {
      const whole own = c + P->shown_by.row[e];
      added(R, found, s, j + (j >= P->knobs), R->direct[e], &one, own, own + 1);
    }
}

/* Derivatives by the tried knobs at the further settings. */
static void tried(Run *R, const Found *found, const Stage *s, whole from) {
  const Plant *P = R->plant;
  const Duty *D = R->duty;
  const whole width = D->R * P->shown;
  for (R->setting = 1; R->setting < D->S; R->setting++) {
    const whole row = (R->run * (D->S - 1) + R->setting - 1) * D->H + D->row[s->phase];
    call(R, P->trials, s->w, R->sparse, R->direct);
    for (whole j = 0; j < P->tried; j++) {
      double *own = found->tried + (row * P->tried + j) * width;
      for (whole e = P->rates_tried.begin[j]; e < P->rates_tried.begin[j + 1]; e++) {
        const whole i = P->rates_tried.row[e];
        const double part = R->sparse[e] * (i < P->nx ? s->length : -1), *mu = R->mu + i * width;
        if (part != 0)
          for (whole c = from; c < width; c++) own[c] += part * mu[c];
      }
      for (whole e = P->shown_tried.begin[j]; e < P->shown_tried.begin[j + 1] && s->read >= 0; e++)
        own[s->read * P->shown + P->shown_tried.row[e]] += R->direct[e];
    }
  }
  R->setting = 0;
}

/* One stage back: R->lambda is by the states after a step, and becomes that by those before it. */
static void back(Run *R, const Found *found, const Stage *s, int k, whole from) {
  const Plant *P = R->plant;
  const whole width = R->duty->R * P->shown, all = P->nx * width;
  R->phase = s->phase;
  inputs(R, s->share);
  memset(R->mu, 0, P->nw * width * sizeof *R->mu);
  memset(R->later, 0, all * sizeof *R->later);
  if (s->read >= 0) reading(R, found, s);
  for (int l = k + 1; l < STAGES; l++)
    for (whole i = 0; i < all; i++) R->later[i] += A[l][k] * R->behind[l * all + i];
  if (k == STAGES - 1) {
    for (whole i = 0; i < all; i++) R->mu[i] += R->lambda[i];
    memset(R->lambda, 0, all * sizeof *R->lambda);
  }
  for (whole i = 0; i < all; i++) R->mu[i] += R->later[i];
  turned(s->LU, s->pivot, P->nw, R->mu, from, width, width);
  for (whole i = 0; i < all; i++) {
    R->behind[k * all + i] = R->mu[i] - R->later[i];
    R->lambda[i] += R->behind[k * all + i];
  }
  call(R, P->slopes, s->w, R->sparse, 0);
  for (whole j = 0; j < P->knobs + P->given; j++)
    for (whole e = P->rates_by.begin[j]; e < P->rates_by.begin[j + 1]; e++) {
      const whole i = P->rates_by.row[e];
      const double part = R->sparse[e] * (i < P->nx ? s->length : -1);
      if (part != 0) added(R, found, s, j + (j >= P->knobs), part, R->mu + i * width + from, from, width);
    }
  for (whole i = 0; i < P->nx; i++)
    added(R, found, s, P->knobs, s->time * s->r[i], R->mu + i * width + from, from, width);
  tried(R, found, s, from);
}

/* Derivatives of what is read, from the last stage back. */
static void backward(Run *R, const Found *found) {
  const Plant *P = R->plant;
  const Duty *D = R->duty;
  const whole width = D->R * P->shown;
  whole from = width;
  memset(R->lambda, 0, P->nx * width * sizeof *R->lambda);
  for (whole n = R->stages - 1; n >= 0; n--) {
    const whole read = R->stage[n].read;
    if (read >= 0 && read * P->shown < from) from = read * P->shown;
    back(R, found, R->stage + n, (int)(n % STAGES), from);
  }
  for (whole g = 0; g < P->given; g++) {
    double *local = found->local + (R->run * P->given + g) * D->H * width;
    for (whole i = 0; i < P->nx; i++)
      for (whole c = 0; c < width; c++)
        local[c] += P->thermal[i] * D->start[R->run * P->given + g] * R->lambda[i * width + c];
  }
}

static void lost(double *a, whole n) {
  for (whole i = 0; i < n; i++) a[i] = NAN;
}

/* Memory of a thread: pieces of one block; none where it runs out. */
static void *prepared(Run *R, int kept) {
  const Plant *P = R->plant;
  const whole nw = P->nw, nx = P->nx, width = R->duty->R * P->shown;
  const whole stages = kept ? R->duty->K * STAGES : 0, each = nw + nx + nw * nw;
  const struct { double **place; whole size; } parts[] = {
      {&R->work, P->n_work}, {&R->sparse, P->most}, {&R->direct, P->most}, {&R->r, nw}, {&R->d, STAGES * nx},
      {&R->left, nw}, {&R->u, P->nu}, {&R->LU, nw * nw}, {&R->w, nw}, {&R->last, nw}, {&R->trial, nw},
      {&R->lambda, nx * width}, {&R->later, nx * width}, {&R->mu, nw * width}, {&R->behind, STAGES * nx * width},
      {&R->x, nx}, {&R->base, nx},
      {&R->store, stages * each}};
  const whole n = sizeof parts / sizeof *parts, integers = P->n_iw + nw * (stages + 1);
  whole size = 0;
  for (whole i = 0; i < n; i++) size += parts[i].size;
  char *block = calloc(1, size * sizeof(double) + integers * sizeof(whole) + stages * sizeof(Stage) +
                              (P->n_arg + P->n_res) * sizeof(double *));
  if (!block) return 0;
  double *next = (double *)block;
  for (whole i = 0; i < n; i++) *parts[i].place = next, next += parts[i].size;
  R->iw = (whole *)next, R->pivot = R->iw + P->n_iw;
  R->stage = (Stage *)(R->iw + integers);
  R->arg = (const double **)(R->stage + stages), R->res = (double **)(R->arg + P->n_arg);
  for (whole i = 0; i < stages; i++) {
    double *own = R->store + i * each;
    R->stage[i].w = own, R->stage[i].r = own + nw, R->stage[i].LU = own + nw + nx;
    R->stage[i].pivot = R->pivot + nw * (i + 1);
  }
  return block;
}

/* The runs from the first to before the second number; 0 where memory runs out. */
__attribute__((visibility("default"))) int march(const Plant *plant, const Duty *duty, const Found *found, whole from,
                                                 whole to) {
  const int kept = found->by != 0;
  const whole shown = duty->R * plant->shown, by = duty->H * (plant->knobs + 1) * shown;
  const whole local = plant->given * duty->H * shown, others = (duty->S - 1) * duty->H * plant->tried * shown;
  Run R = {.plant = plant, .duty = duty};
  void *block = prepared(&R, kept);
  if (!block) return 0;
  for (R.run = from; R.run < to; R.run++) {
    double *y = found->y + R.run * shown;
    const int fine = forward(&R, y, kept);
    if (fine && kept) backward(&R, found);
    if (fine) continue;
    lost(y, shown);
    if (!kept) continue;
    lost(found->by + R.run * by, by), lost(found->local + R.run * local, local);
    lost(found->tried + R.run * others, others);
  }
  free(block);
  return 1;
}

/* A formula at n points, a row each: what it has in two results of so many entries; 0 where memory runs out. */
__attribute__((visibility("default"))) int many(const Plant *plant, Formula formula, whole n, const double *w,
                                                const double *u, const double *p, double *first, whole entries,
                                                double *second, whole others) {
  const whole numbers = plant->n_work * sizeof(double), integers = plant->n_iw * sizeof(whole);
  const double **arg = malloc((plant->n_arg + plant->n_res) * sizeof *arg + numbers + integers);
  if (!arg) return 0;
  double **res = (double **)(arg + plant->n_arg), *work = (double *)(res + plant->n_res);
  for (whole i = 0; i < n; i++) {
    arg[0] = w + i * plant->nw, arg[1] = u + i * plant->nu, arg[2] = p + i * plant->np;
    res[0] = first + i * entries, res[1] = second + i * others;
    formula(arg, res, (whole *)(work + plant->n_work), work, 0);
  }
  free(arg);
  return 1;
}
