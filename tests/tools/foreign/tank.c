/* A small FMU as another tool would write it: variables of every type, fixed steps, no slopes, no reset, no states.
   A tank of water: dT/dt = -k (T - T_room), by explicit Euler in steps of 1 s. */
#include <stdlib.h>
#include <string.h>

#ifdef _WIN32
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

typedef void *C;
typedef unsigned int R;
typedef const char *S;
enum { OK = 0, ERROR = 3 };

typedef void (*Logger)(void *, S, int, S, S, ...);
typedef struct {
    Logger logger;
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void *finished;
    void *environment;
} Callbacks;

typedef struct {
    double values[4]; /* T, T_room, k, dT */
    int steps;
    Callbacks callbacks;
} Tank;

EXPORT S fmi2GetTypesPlatform(void) { return "default"; }
EXPORT S fmi2GetVersion(void) { return "2.0"; }

EXPORT C fmi2Instantiate(S name, int type, S guid, S place, const Callbacks *callbacks, int visible, int logging) {
    (void)name, (void)type, (void)guid, (void)place, (void)visible, (void)logging;
    Tank *tank = calloc(1, sizeof *tank);
    tank->values[0] = 350, tank->values[1] = 290, tank->values[2] = 0.01, tank->values[3] = 60;
    tank->callbacks = *callbacks;
    return tank;
}
EXPORT void fmi2FreeInstance(C c) { free(c); }

EXPORT int fmi2GetReal(C c, const R *refs, size_t n, double *values) {
    for (size_t i = 0; i < n; i++) values[i] = ((Tank *)c)->values[refs[i]];
    return OK;
}
EXPORT int fmi2SetReal(C c, const R *refs, size_t n, const double *values) {
    for (size_t i = 0; i < n; i++) ((Tank *)c)->values[refs[i]] = values[i];
    return OK;
}
EXPORT int fmi2GetInteger(C c, const R *refs, size_t n, int *values) {
    (void)refs;
    for (size_t i = 0; i < n; i++) values[i] = ((Tank *)c)->steps;
    return OK;
}

EXPORT int fmi2DoStep(C c, double now, double step, int keep) {
    (void)now, (void)keep;
    Tank *tank = c;
    switch ((int)tank->values[2]) { /* what no FMU should do */
    case 96: *(volatile int *)0 = 1; break;
    case 97: for (volatile int on = 1; on;) {} break;
    case 98: abort();
    case 99: exit(0);
    }
    double *v = tank->values;
    if (v[0] > 1000) {
        tank->callbacks.logger(0, "tank", ERROR, 0, "the tank boils");
        return ERROR;
    }
    for (int k = 0; k < (int)(step + 0.5); k++) v[0] -= v[2] * (v[0] - v[1]);
    v[3] = v[0] - v[1];
    tank->steps++;
    return OK;
}

#define FINE(name, ...) EXPORT int name(C c, ##__VA_ARGS__) { (void)c; return OK; }
#define CANNOT(name, ...) EXPORT int name(C c, ##__VA_ARGS__) { (void)c; return ERROR; }
FINE(fmi2SetDebugLogging, int a, size_t b, const S *d)
FINE(fmi2SetupExperiment, int a, double b, double d, int e, double f)
FINE(fmi2EnterInitializationMode)
FINE(fmi2ExitInitializationMode)
FINE(fmi2Terminate)
CANNOT(fmi2Reset)
CANNOT(fmi2GetBoolean, const R *a, size_t b, int *d)
CANNOT(fmi2GetString, const R *a, size_t b, S *d)
CANNOT(fmi2SetInteger, const R *a, size_t b, const int *d)
CANNOT(fmi2SetBoolean, const R *a, size_t b, const int *d)
CANNOT(fmi2SetString, const R *a, size_t b, const S *d)
CANNOT(fmi2GetFMUstate, void **a)
CANNOT(fmi2SetFMUstate, void *a)
CANNOT(fmi2FreeFMUstate, void **a)
CANNOT(fmi2SerializedFMUstateSize, void *a, size_t *b)
CANNOT(fmi2SerializeFMUstate, void *a, char *b, size_t d)
CANNOT(fmi2DeSerializeFMUstate, const char *a, size_t b, void **d)
CANNOT(fmi2GetDirectionalDerivative, const R *a, size_t b, const R *d, size_t e, const double *f, double *g)
CANNOT(fmi2SetRealInputDerivatives, const R *a, size_t b, const int *d, const double *e)
CANNOT(fmi2GetRealOutputDerivatives, const R *a, size_t b, const int *d, double *e)
CANNOT(fmi2CancelStep)
CANNOT(fmi2GetStatus, int a, int *b)
CANNOT(fmi2GetRealStatus, int a, double *b)
CANNOT(fmi2GetIntegerStatus, int a, int *b)
CANNOT(fmi2GetBooleanStatus, int a, int *b)
CANNOT(fmi2GetStringStatus, int a, S *b)
