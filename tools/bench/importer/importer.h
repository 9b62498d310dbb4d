/* A small importer of FMI 2.0 FMUs: the binary's functions, the facts about its variables, instances, a duty. */

#ifndef IMPORTER_H
#define IMPORTER_H

#include <stddef.h>

#include "fmi2FunctionTypes.h"

/* Every function of FMI 2.0 for model exchange and co-simulation. */
#define FMI2_FUNCTIONS(F) \
    F(GetTypesPlatform) F(GetVersion) F(SetDebugLogging) F(Instantiate) F(FreeInstance) F(SetupExperiment) \
    F(EnterInitializationMode) F(ExitInitializationMode) F(Terminate) F(Reset) F(GetReal) F(GetInteger) F(GetBoolean) \
    F(GetString) F(SetReal) F(SetInteger) F(SetBoolean) F(SetString) F(GetFMUstate) F(SetFMUstate) F(FreeFMUstate) \
    F(SerializedFMUstateSize) F(SerializeFMUstate) F(DeSerializeFMUstate) F(GetDirectionalDerivative) \
    F(EnterEventMode) F(NewDiscreteStates) F(EnterContinuousTimeMode) F(CompletedIntegratorStep) F(SetTime) \
    F(SetContinuousStates) F(GetDerivatives) F(GetEventIndicators) F(GetContinuousStates) \
    F(GetNominalsOfContinuousStates) F(SetRealInputDerivatives) F(GetRealOutputDerivatives) F(DoStep) F(CancelStep) \
    F(GetStatus) F(GetRealStatus) F(GetIntegerStatus) F(GetBooleanStatus) F(GetStringStatus)

typedef struct {
#define F(name) fmi2##name##TYPE *name;
    FMI2_FUNCTIONS(F)
#undef F
} Functions;

typedef struct {
    fmi2ValueReference r;
    char kind;                     /* x state, d its derivative, u input, y output, p parameter */
    double start, low, high, nominal, swing;
    char name[128];
} Variable;

typedef struct {
    Functions f;
    char library[4096], guid[64];
    Variable *all;
    fmi2ValueReference *refs;      /* of all variables, in the order of the facts */
    Variable *x, *d, *u, *y, *p;   /* the first of each kind; kinds follow each other in this order: x d u y p */
    int n, nx, nu, ny, np;
} Fmu;

/* Loads the library named in the facts; ends the program with a message when that fails. `library` may replace it. */
void load(Fmu *m, const char *facts, const char *library);

/* Position of a variable by name among all; ends the program when there is none. */
int position(const Fmu *m, const char *name);

/* What an instance says: HEARD(name) declares one, and its callbacks go with the instance. */
typedef struct {
    fmi2CallbackFunctions callbacks;
    int count, errors;
    char last[1200];
} Heard;
void hear(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status, fmi2String category,
          fmi2String message, ...);
#define HEARD(name) Heard name = {{hear, calloc, free, NULL, &name}, 0, 0, ""}

/* A fresh instance whose messages are heard (or printed when heard is NULL), and one brought to its first step. */
fmi2Component instantiate(const Fmu *m, fmi2Type type, Heard *heard);
fmi2Component ready(const Fmu *m, double tolerance);

/* The inputs of the tests' duty at communication point k, each moved around its start by its swing. */
void duty(const Fmu *m, double k, double *u);

/* Sets the duty's inputs, with slopes to the next point when `slopes`, else held, and steps; the first status that is
   not OK is returned. */
fmi2Status advance(const Fmu *m, fmi2Component c, double *time, double step, double k, int slopes);

/* Reads all variables. */
fmi2Status read_all(const Fmu *m, fmi2Component c, double *values);

/* Ends the program unless a call that must succeed did. */
#define MUST(call) must((call), #call, __FILE__, __LINE__)
void must(fmi2Status status, const char *call, const char *file, int line);

double clock_now(void);            /* s, for differences */
double processor_now(void);        /* s of this process, for differences: other work on the machine does not count */

/* A function of another library; ends the program with a message when it cannot be had. */
void *function(const char *library, const char *name);

/* Random numbers, the same on every machine. */
typedef struct {
    unsigned long long s[2];
} Random;
void seed(Random *r, unsigned long long n);
unsigned below(Random *r, unsigned n);
double uniform(Random *r);

#endif
