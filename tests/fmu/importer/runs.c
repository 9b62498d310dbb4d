/* Runs that must agree bit for bit, or within the tolerance: order of setting, reset, rollback, threads, step sizes. */

#include "checks.h"

#include <pthread.h>

enum { MOST = 1024, STEPS = 40 };

/* A duty of some steps from a ready instance on, all variables after each. */
static void trajectory(const Fmu *m, fmi2Component c, double step, double *rows)
{
    double t = 0.0;
    int k;
    for (k = 0; k < STEPS; k++) {
        MUST(advance(m, c, &t, step, k, k % 2));
        MUST(read_all(m, c, rows + k * m->n));
    }
}

static double *rows_of(const Fmu *m) { return malloc((size_t)(STEPS * m->n) * sizeof(double)); }

static int equal(const Fmu *m, const double *a, const double *b)
{
    return memcmp(a, b, (size_t)(STEPS * m->n) * sizeof *a) == 0;
}

/* All that may be set before a run, each a little off its start, within its range. */
static int settables(const Fmu *m, Random *r, fmi2ValueReference *refs, double *values)
{
    int i, n = 0;
    for (i = 0; i < m->n; i++) {
        const Variable *v = &m->all[i];
        double value = v->start + 0.02 * v->swing * (uniform(r) - 0.5);
        if (v->kind == 'd' || v->kind == 'y') continue;
        refs[n] = v->r, values[n++] = fmin(fmax(value, v->low), v->high);
    }
    return n;
}

static void shuffle(Random *r, int n, int *order)
{
    int i, k, kept;
    for (i = 0; i < n; i++) order[i] = i;
    for (i = n - 1; i > 0; i--) {
        k = (int)below(r, (unsigned)i + 1);
        kept = order[i], order[i] = order[k], order[k] = kept;
    }
}

/* Sets everything in a random order, in groups of random size, some before and some in initialization mode, some
   twice, and reads in between. */
static void set_shuffled(const Fmu *m, fmi2Component c, Random *r, int n, const fmi2ValueReference *refs,
                         const double *values)
{
    fmi2ValueReference some[MOST];
    double value[MOST], seen[MOST];
    int order[MOST], i, k, before = (int)below(r, (unsigned)n + 1), begun = 0;
    shuffle(r, n, order);
    for (i = 0; i < n; i += k) {
        int most = n - i < 9 ? n - i : 9, j;
        k = 1 + (int)below(r, (unsigned)most);
        if (!begun && i >= before) {
            MUST(m->f.SetupExperiment(c, fmi2False, 0.0, 0.0, fmi2False, 0.0));
            MUST(m->f.EnterInitializationMode(c));
            begun = 1;
        }
        for (j = 0; j < k; j++) some[j] = refs[order[i + j]], value[j] = values[order[i + j]];
        if (below(r, 4) == 0) {
            double first = m->p[0].start;
            MUST(m->f.SetReal(c, &m->p[0].r, 1, &first));
        }
        MUST(m->f.SetReal(c, some, (size_t)k, value));
        for (j = 0; j < n; j++)
            if (refs[j] == m->p[0].r) MUST(m->f.SetReal(c, &refs[j], 1, &values[j]));
        if (begun && below(r, 3) == 0) MUST(read_all(m, c, seen));
    }
    if (!begun) {
        MUST(m->f.SetupExperiment(c, fmi2False, 0.0, 0.0, fmi2False, 0.0));
        MUST(m->f.EnterInitializationMode(c));
    }
    MUST(m->f.ExitInitializationMode(c));
}

void check_shuffle(const Fmu *m, int n, char **arguments)
{
    fmi2ValueReference refs[MOST];
    double values[MOST], begun[MOST], seen[MOST], *first = rows_of(m), *other = rows_of(m);
    int round, rounds, count, i;
    Random r;
    NEEDS(n == 1, "shuffle ROUNDS");
    rounds = atoi(arguments[0]);
    seed(&r, 1);
    count = settables(m, &r, refs, values);
    for (round = 0; round < rounds; round++) {
        fmi2Component c = instantiate(m, fmi2CoSimulation, NULL);
        set_shuffled(m, c, &r, count, refs, values);
        MUST(read_all(m, c, round ? seen : begun));
        if (round) EXPECT(memcmp(seen, begun, (size_t)m->n * sizeof *seen) == 0, "order %d begins otherwise", round);
        trajectory(m, c, 7.0, round ? other : first);
        if (round) EXPECT(equal(m, first, other), "order %d of setting gives another run", round);
        m->f.FreeInstance(c);
    }
    /* at communication points one by one, backwards */
    for (round = 0; round < 2; round++) {
        fmi2Component c = ready(m, 0.0);
        double u[MOST];
        int k;
        for (k = 0; k < STEPS; k++) {
            duty(m, k, u);
            if (round == 0) MUST(m->f.SetReal(c, m->refs + 2 * m->nx, (size_t)m->nu, u));
            else for (i = m->nu - 1; i >= 0; i--) MUST(m->f.SetReal(c, &m->u[i].r, 1, &u[i]));
            MUST(m->f.DoStep(c, 5.0 * k, 5.0, fmi2True));
            MUST(read_all(m, c, (round ? other : first) + k * m->n));
        }
        m->f.FreeInstance(c);
    }
    EXPECT(equal(m, first, other), "inputs set one by one backwards give another run");
    printf("%d orders of %d variables\n", rounds, count);
    free(first), free(other);
}

void check_reset(const Fmu *m, int n, char **arguments)
{
    fmi2ValueReference refs[MOST];
    double values[MOST], *first = rows_of(m), *other = rows_of(m), t;
    int round, count, k;
    fmi2Component c;
    Random r;
    (void)n, (void)arguments;
    seed(&r, 2);
    c = ready(m, 0.0);
    trajectory(m, c, 11.0, first);
    m->f.FreeInstance(c);
    c = instantiate(m, fmi2CoSimulation, NULL);
    for (round = 0; round < 12; round++) { /* left in any mode, by any path */
        count = settables(m, &r, refs, values);
        if (round > 0) MUST(m->f.SetReal(c, refs, (size_t)count, values));
        if (round > 1) MUST(m->f.SetupExperiment(c, fmi2True, 1e-3, 50.0, fmi2True, 1e6));
        if (round > 2) MUST(m->f.EnterInitializationMode(c));
        if (round > 3) MUST(m->f.ExitInitializationMode(c));
        for (t = 50.0, k = 0; round > 4 && k < round; k++) MUST(advance(m, c, &t, 100.0 * uniform(&r), k, 1));
        if (round > 7) MUST(m->f.Terminate(c));
        MUST(m->f.Reset(c));
        MUST(m->f.SetupExperiment(c, fmi2False, 0.0, 0.0, fmi2False, 0.0));
        MUST(m->f.EnterInitializationMode(c));
        MUST(m->f.ExitInitializationMode(c));
        trajectory(m, c, 11.0, other);
        EXPECT(equal(m, first, other), "run %d after a reset differs from a fresh one", round);
        MUST(m->f.Reset(c));
    }
    m->f.FreeInstance(c);
    printf("12 resets\n");
    free(first), free(other);
}

/* A step of random length with random inputs, slopes, parameter changes and readings. */
static void wander(const Fmu *m, fmi2Component c, Random *r, double *time, double *row)
{
    static const double lengths[] = {0.0, 0.01, 0.1, 1.0, 10.0, 60.0, 300.0};
    double k = 100.0 * uniform(r), length = lengths[below(r, 7)] * (below(r, 2) ? 1.0 : uniform(r));
    if (below(r, 5) == 0) {
        const Variable *p = &m->p[below(r, (unsigned)m->np)];
        double value = fmin(fmax(p->start + 0.1 * p->swing * uniform(r), p->low), p->high);
        MUST(m->f.SetReal(c, &p->r, 1, &value));
    }
    if (below(r, 3) == 0) MUST(read_all(m, c, row));
    MUST(advance(m, c, time, length, k, (int)below(r, 2)));
    MUST(read_all(m, c, row));
}

void check_rollback(const Fmu *m, int n, char **arguments)
{
    double *first, *other, at[MOST], seen[MOST];
    fmi2Component c = ready(m, 0.0);
    fmi2FMUstate state = NULL, later = NULL;
    double t = 0.0;
    int round, rounds, k;
    Random r;
    NEEDS(n == 1, "rollback ROUNDS");
    rounds = atoi(arguments[0]);
    seed(&r, 3);
    first = rows_of(m), other = rows_of(m);
    for (round = 0; round < rounds; round++) {
        int length = 1 + (int)below(&r, 9), before = (int)below(&r, 4);
        double back;
        Random again;
        for (k = 0; k < before; k++) wander(m, c, &r, &t, first);
        if (below(&r, 3) == 0 && state) MUST(m->f.FreeFMUstate(c, &state)); /* else the old memory is used again */
        if (below(&r, 2)) MUST(read_all(m, c, at)); /* with and without values computed before saving */
        MUST(m->f.GetFMUstate(c, &state));
        MUST(read_all(m, c, at));
        again = r, back = t;
        memset(first, 0, (size_t)(STEPS * m->n) * sizeof *first);
        memset(other, 0, (size_t)(STEPS * m->n) * sizeof *other);
        for (k = 0; k < length; k++) wander(m, c, &r, &t, first + k * m->n);
        MUST(m->f.GetFMUstate(c, &later));
        if (below(&r, 2)) MUST(m->f.Reset(c));
        MUST(m->f.SetFMUstate(c, state));
        if (round % 2) {
            MUST(read_all(m, c, seen));
            EXPECT(memcmp(at, seen, (size_t)m->n * sizeof *at) == 0, "rollback %d gives other values at once", round);
        }
        t = back;
        for (k = 0; k < length; k++) wander(m, c, &again, &t, other + k * m->n);
        EXPECT(equal(m, first, other), "rollback %d gives another run", round);
        MUST(m->f.SetFMUstate(c, later));
        if (t > 1e5) { /* a new beginning, so that times stay comparable */
            MUST(m->f.Reset(c));
            MUST(m->f.SetupExperiment(c, fmi2False, 0.0, 0.0, fmi2False, 0.0));
            MUST(m->f.EnterInitializationMode(c));
            MUST(m->f.ExitInitializationMode(c));
            t = 0.0;
        }
    }
    MUST(m->f.FreeFMUstate(c, &state));
    MUST(m->f.FreeFMUstate(c, &later));
    m->f.FreeInstance(c);
    printf("%d rollbacks\n", rounds);
    free(first), free(other);
}

/* The same random way on, told in hexadecimal so that two processes can be compared. */
static void tell(const Fmu *m, fmi2Component c, double t)
{
    double row[MOST];
    int i, k;
    Random r;
    seed(&r, 4);
    for (k = 0; k < 20; k++) {
        wander(m, c, &r, &t, row);
        for (i = 0; i < m->n; i++) printf("%a%c", row[i], i < m->n - 1 ? ' ' : '\n');
    }
}

void check_save(const Fmu *m, int n, char **arguments)
{
    fmi2Component c = ready(m, 1e-6);
    fmi2FMUstate state = NULL;
    double row[MOST], t = 0.0;
    size_t size;
    char *bytes;
    FILE *file;
    Random r;
    int k;
    NEEDS(n == 1, "save FILE");
    seed(&r, 5);
    for (k = 0; k < 17; k++) wander(m, c, &r, &t, row);
    MUST(m->f.GetFMUstate(c, &state));
    MUST(m->f.SerializedFMUstateSize(c, state, &size));
    bytes = malloc(size);
    MUST(m->f.SerializeFMUstate(c, state, bytes, size));
    MUST(m->f.FreeFMUstate(c, &state));
    if (!(file = fopen(arguments[0], "wb"))) exit(2);
    fwrite(&t, sizeof t, 1, file), fwrite(bytes, 1, size, file), fclose(file);
    free(bytes);
    tell(m, c, t);
    m->f.FreeInstance(c);
}

void check_restore(const Fmu *m, int n, char **arguments)
{
    HEARD(heard);
    fmi2Component c = instantiate(m, fmi2CoSimulation, &heard);
    fmi2FMUstate state = NULL;
    char bytes[1 << 16];
    double t;
    size_t size, i;
    FILE *file;
    NEEDS(n == 1, "restore FILE");
    if (!(file = fopen(arguments[0], "rb")) || fread(&t, sizeof t, 1, file) != 1) exit(2);
    size = fread(bytes, 1, sizeof bytes, file), fclose(file);
    for (i = 0; i < size; i++) { /* one flipped bit anywhere, or a byte too few */
        bytes[i] ^= (char)(1 << i % 8);
        EXPECT(m->f.DeSerializeFMUstate(c, bytes, size, &state) == fmi2Error, "damage of byte %d is accepted", (int)i);
        EXPECT(!state, "a damaged state leaves a state");
        bytes[i] ^= (char)(1 << i % 8);
        EXPECT(m->f.DeSerializeFMUstate(c, bytes, i, &state) == fmi2Error, "%d bytes are accepted", (int)i);
    }
    if (m->f.DeSerializeFMUstate(c, bytes, size, &state) != fmi2OK) {
        EXPECT(0, "the state is refused: %s", heard.last);
        return;
    }
    MUST(m->f.SetFMUstate(c, state));
    MUST(m->f.FreeFMUstate(c, &state));
    tell(m, c, t);
    m->f.FreeInstance(c);
}

typedef struct {
    const Fmu *m;
    double *rows;
    int number, rounds;
    pthread_barrier_t *gate;       /* all begin at once; NULL when alone */
} Job;

static void *work(void *job)
{
    const Job *j = job;
    const Fmu *m = j->m;
    fmi2Component c = NULL;
    int round, k;
    if (j->gate) pthread_barrier_wait(j->gate);
    for (round = 0; round < j->rounds; round++) { /* instances come and go while others run */
        double t = 0.0;
        if (c) m->f.FreeInstance(c);
        c = ready(m, 1e-6);
        for (k = 0; k < STEPS; k++) {
            MUST(advance(m, c, &t, 1.0 + j->number, k + 3 * j->number, k % 2));
            MUST(read_all(m, c, j->rows + k * m->n));
        }
    }
    m->f.FreeInstance(c);
    return NULL;
}

void check_threads(const Fmu *m, int n, char **arguments)
{
    enum { MANY = 16 };
    pthread_t threads[MANY];
    pthread_barrier_t gate;
    Job alone[MANY], among[MANY];
    int i, rounds;
    NEEDS(n == 1, "threads ROUNDS");
    rounds = atoi(arguments[0]);
    pthread_barrier_init(&gate, NULL, MANY);
    for (i = 0; i < MANY; i++) {
        alone[i] = (Job){m, rows_of(m), i, rounds, NULL}, among[i] = (Job){m, rows_of(m), i, rounds, &gate};
        work(&alone[i]);
    }
    for (i = 0; i < MANY; i++)
        if (pthread_create(&threads[i], NULL, work, &among[i]) != 0) exit(2);
    for (i = 0; i < MANY; i++) {
        pthread_join(threads[i], NULL);
        EXPECT(equal(m, alone[i].rows, among[i].rows), "thread %d differs from the same run alone", i);
        free(alone[i].rows), free(among[i].rows);
    }
    pthread_barrier_destroy(&gate);
    printf("16 threads\n");
}

/* Runs of one duty with the given steps; the inputs change every 1000 s only, at a point of each of them. */
void check_steps(const Fmu *m, int n, char **arguments)
{
    double stop, tolerance, bound, exact[MOST], found[MOST], u[MOST];
    int i, k;
    NEEDS(n >= 4, "steps STOP TOLERANCE BOUND STEP...");
    stop = atof(arguments[0]), tolerance = atof(arguments[1]), bound = atof(arguments[2]);
    for (k = 2; k < n; k++) {
        double step = k == 2 ? 1000.0 : atof(arguments[k]), t = 0.0, worst = 0.0;
        fmi2Component c = ready(m, k == 2 ? 1e-4 * tolerance : tolerance);
        long j, jumps = lround(1000.0 / step), count = lround(stop / step);
        int which = 0;
        for (j = 0; j < count; j++) {
            if (j % jumps == 0) {
                duty(m, (double)(j / jumps), u);
                MUST(m->f.SetReal(c, m->refs + 2 * m->nx, (size_t)m->nu, u));
            }
            MUST(m->f.DoStep(c, t, step, fmi2True));
            t = (double)(j + 1) * step;
        }
        MUST(m->f.GetReal(c, m->refs, (size_t)m->nx, k == 2 ? exact : found));
        m->f.FreeInstance(c);
        if (k == 2) continue;
        for (i = 0; i < m->nx; i++) {
            double e = fabs(found[i] - exact[i]) / m->x[i].nominal;
            if (e > worst) worst = e, which = i;
        }
        printf("step %g s: %.3g of the nominal off at %s\n", step, worst, m->x[which].name);
        EXPECT(worst <= bound, "step %g s is off by %.3g of the nominal of %s", step, worst, m->x[which].name);
    }
}
