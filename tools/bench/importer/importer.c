/* A small importer of FMI 2.0 FMUs; see importer.h. */

#include "importer.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#ifdef _WIN32
#include <windows.h>
static void *open_library(const char *path) { return (void *)LoadLibraryA(path); }
static void *symbol(void *library, const char *name) { return (void *)(size_t)GetProcAddress(library, name); }
static const char *why(void) { return "LoadLibrary failed"; }
double clock_now(void) { return (double)clock() / CLOCKS_PER_SEC; }
double processor_now(void) { return clock_now(); }
#else
#include <dlfcn.h>
static void *open_library(const char *path) { return dlopen(path, RTLD_NOW | RTLD_LOCAL); }
static void *symbol(void *library, const char *name) { return dlsym(library, name); }
static const char *why(void) { return dlerror(); }
double clock_now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}
double processor_now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}
#endif

static void give_up(const char *what, const char *which)
{
    fprintf(stderr, "importer: %s %s\n", what, which);
    exit(3);
}

static void read_facts(Fmu *m, const char *path)
{
    char line[8192];
    int room = 0;
    FILE *file = fopen(path, "r");
    if (!file) give_up("cannot read", path);
    while (fgets(line, sizeof line, file)) {
        Variable v;
        line[strcspn(line, "\r\n")] = 0;
        if (strncmp(line, "library ", 8) == 0) snprintf(m->library, sizeof m->library, "%.4000s", line + 8);
        else if (strncmp(line, "guid ", 5) == 0) snprintf(m->guid, sizeof m->guid, "%.60s", line + 5);
        else if (sscanf(line, "variable %u %c %lf %lf %lf %lf %lf %127s", &v.r, &v.kind, &v.start, &v.low, &v.high,
                        &v.nominal, &v.swing, v.name) == 8) {
            if (m->n == room) m->all = realloc(m->all, (size_t)(room = 2 * room + 64) * sizeof v);
            m->all[m->n++] = v;
        } else give_up("cannot understand", line);
    }
    fclose(file);
}

static void group(Fmu *m)
{
    Variable *sorted = malloc((size_t)m->n * sizeof *sorted);
    const char *kinds = "xduyp";
    int count[5] = {0}, k, i, n = 0;
    for (k = 0; k < 5; k++)
        for (i = 0; i < m->n; i++)
            if (m->all[i].kind == kinds[k]) sorted[n++] = m->all[i], count[k]++;
    free(m->all);
    m->all = sorted;
    m->nx = count[0], m->nu = count[2], m->ny = count[3], m->np = count[4];
    m->x = sorted, m->d = m->x + m->nx, m->u = m->d + m->nx, m->y = m->u + m->nu, m->p = m->y + m->ny;
    m->refs = malloc((size_t)m->n * sizeof *m->refs);
    for (i = 0; i < m->n; i++) m->refs[i] = sorted[i].r;
}

void *function(const char *library, const char *name)
{
    void *handle = open_library(library), *found = handle ? symbol(handle, name) : NULL;
    if (!handle) give_up("cannot load the binary:", why());
    if (!found) give_up("the binary lacks", name);
    return found;
}

void load(Fmu *m, const char *facts, const char *library)
{
    memset(m, 0, sizeof *m);
    read_facts(m, facts);
    group(m);
    if (!library) library = m->library;
#define F(name) \
    { \
        void *found = function(library, "fmi2" #name); \
        memcpy(&m->f.name, &found, sizeof found); \
    }
    FMI2_FUNCTIONS(F)
#undef F
}

int position(const Fmu *m, const char *name)
{
    int i;
    for (i = 0; i < m->n; i++)
        if (strcmp(m->all[i].name, name) == 0) return i;
    give_up("there is no variable", name);
    return -1;
}

void hear(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status, fmi2String category,
          fmi2String message, ...)
{
    Heard *heard = environment;
    if (!heard) {
        fprintf(stderr, "[%s %d %s] %s\n", name, (int)status, category, message);
        return;
    }
    heard->count++;
    if (status >= fmi2Error) heard->errors++;
    snprintf(heard->last, sizeof heard->last, "%s", message);
}

fmi2Component instantiate(const Fmu *m, fmi2Type type, Heard *heard)
{
    static const fmi2CallbackFunctions aloud = {hear, calloc, free, NULL, NULL};
    const fmi2CallbackFunctions *callbacks = heard ? &heard->callbacks : &aloud;
    fmi2Component c = m->f.Instantiate("one", type, m->guid, NULL, callbacks, fmi2False, fmi2False);
    if (!c) give_up("cannot instantiate", m->guid);
    return c;
}

fmi2Component ready(const Fmu *m, double tolerance)
{
    fmi2Component c = instantiate(m, fmi2CoSimulation, NULL);
    MUST(m->f.SetupExperiment(c, tolerance > 0, tolerance, 0.0, fmi2False, 0.0));
    MUST(m->f.EnterInitializationMode(c));
    MUST(m->f.ExitInitializationMode(c));
    return c;
}

void duty(const Fmu *m, double k, double *u)
{
    int i;
    for (i = 0; i < m->nu; i++) u[i] = m->u[i].start + m->u[i].swing * sin(0.7 * k + i);
}

fmi2Status advance(const Fmu *m, fmi2Component c, double *time, double step, double k, int slopes)
{
    double u[256], next[256];
    fmi2Integer order[256];
    fmi2Status status;
    int i;
    duty(m, k, u);
    status = m->f.SetReal(c, m->refs + 2 * m->nx, (size_t)m->nu, u);
    if (status != fmi2OK) return status;
    duty(m, k + 1, next);
    for (i = 0; i < m->nu; i++) order[i] = 1, next[i] = slopes && step > 0 ? (next[i] - u[i]) / step : 0.0;
    status = m->f.SetRealInputDerivatives(c, m->refs + 2 * m->nx, (size_t)m->nu, order, next);
    if (status != fmi2OK) return status;
    status = m->f.DoStep(c, *time, step, fmi2True);
    if (status == fmi2OK) *time += step;
    return status;
}

fmi2Status read_all(const Fmu *m, fmi2Component c, double *values)
{
    return m->f.GetReal(c, m->refs, (size_t)m->n, values);
}

void must(fmi2Status status, const char *call, const char *file, int line)
{
    if (status == fmi2OK) return;
    fprintf(stderr, "%s:%d: status %d from %s\n", file, line, (int)status, call);
    exit(1);
}

void seed(Random *r, unsigned long long n)
{
    int i;
    r->s[0] = n * 0x9E3779B97F4A7C15ull + 1, r->s[1] = n ^ 0xD1B54A32D192ED03ull;
    for (i = 0; i < 8; i++) below(r, 2);
}

/* xorshift128+ */
static unsigned long long draw(Random *r)
{
    unsigned long long a = r->s[0], b = r->s[1];
    r->s[0] = b;
    a ^= a << 23;
    r->s[1] = a ^ b ^ (a >> 17) ^ (b >> 26);
    return r->s[1] + b;
}

unsigned below(Random *r, unsigned n) { return (unsigned)((draw(r) >> 32) * n >> 32); }

double uniform(Random *r) { return (double)(draw(r) >> 11) / 9007199254740992.0; }
