/* One instance of the FMU. Everything a saved FMU state holds is in State: plain data without pointers, so saving,
   restoring and serializing are copies. Behind an instance with a mixture lie N_SIDES copies of it, whose parameters are
   others (uncertain.c). The model's sizes, tables and functions stand above this text. */

#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define AT_LEAST_1(n) ((n) > 0 ? (n) : 1)

/* Value references: states, inputs, outputs, parameters, derivatives, choices, standard deviations. */
enum {
    FIRST_X = 0,
    FIRST_U = FIRST_X + NX,
    FIRST_Y = FIRST_U + NU,
    FIRST_P = FIRST_Y + NY,
    FIRST_DX = FIRST_P + NP,
    FIRST_CHOICE = FIRST_DX + NX,
    FIRST_SD = FIRST_CHOICE + N_CHOICES,
    N_VARIABLES = FIRST_SD + NSD
};

/* Types of variables, one bit each, so that a function names those it takes by a mask. */
enum { REAL_NUMBER = 1, WHOLE_NUMBER = 2, ENUMERATION = 4 };

/* With an audit the last two states are its; the error control looks at all but the last. */
enum { N_MODEL = NX - 2 * AUDIT, SUPPLIED = AUDIT ? NX - 2 : -1, THROUGHPUT = NX - 1, N_CONTROLLED = NX - AUDIT };

/* The mode of an instance, one bit each, so that a function names the modes it is allowed in by a mask. */
enum {
    INSTANTIATED = 1,
    INITIALIZATION = 2,
    EVENT = 4,
    CONTINUOUS_TIME = 8,
    STEP_COMPLETE = 16,
    STEP_FAILED = 32,
    TERMINATED = 64,
    ANY_MODE = 127
};

typedef struct {
    int mode;
    int type;              /* fmi2ModelExchange or fmi2CoSimulation */
    int stop_defined;
    int jumped;            /* an input or a parameter has jumped since the last step */
    int states_touched;    /* ModelExchange: the integrator has to restart at the end of event mode */
    int stepped;           /* a communication step has been done */
    double refused_step;   /* length of the last step that was refused, NAN when there is none, */
    unsigned refused_from; /* and where it began, as a hash */
    unsigned char wrong[AT_LEAST_1(NU)];   /* an input was last given a value out of its range, before the run */
    double time;
    double stop;
    double tolerance;
    double h_first;        /* step proposed after the first accepted step of the last communication step */
    double h_last;         /* step proposed after the last one */
    double x[AT_LEAST_1(NX)];
    double z[AT_LEAST_1(NZ)];   /* algebraic variables at the last accepted step: where an iteration begins */
    double u[AT_LEAST_1(NU)];
    double slope[AT_LEAST_1(NU)];
    double p[AT_LEAST_1(NP)];   /* in use, see choices.c */
    double own[AT_LEAST_1(NP)]; /* as set */
    double choice[AT_LEAST_1(N_CHOICES)];
    double s[AT_LEAST_1(ND * NS)];   /* sensitivities of the states, direction by direction */
} State;

typedef struct {
    State s;
    int constants_known;   /* c belongs to s.p */
    int relations_hold;    /* all relations between the parameters hold at s.p */
    int algebra_known;     /* z belongs to s, or there is none: then the number of an equation without a solution is */
    int unsolved;          /* here, else -1 */
    int outputs_known;     /* y and dx belong to s */
    unsigned log_mask;
    unsigned log_mask_at_start;
    fmi2CallbackFunctions callbacks;
    char *name;
    double c[AT_LEAST_1(NC)];
    double z[AT_LEAST_1(NZ)];
    double y[AT_LEAST_1(NY)];
    double dx[AT_LEAST_1(NX)];
    int directions_known;  /* p_dot and c_dot belong to s.p */
    int deviations_known;  /* deviation belongs to s */
    double p_dot[AT_LEAST_1(ND * NP)];
    double c_dot[AT_LEAST_1(ND * NC)];
    double deviation[AT_LEAST_1(NSD)];
    unsigned char warned[AT_LEAST_1(NK)];
    unsigned char kept[AT_LEAST_1(NU)];    /* it was told that an input keeps its value */
    double asked[AT_LEAST_1(NU)];   /* the last value of an input that was out of its range, before the run */
    int order_told;        /* that higher derivatives of inputs are ignored */
    int outputs_wanted;    /* outputs or derivatives have been read since the last step */
    const char *refused_by;   /* name of what ended the last step that was refused */
} Instance;

/* Log categories, in the order of the model description. */
enum { LOG_ERROR, LOG_DISCARD, LOG_WARNING, LOG_SOLVER, N_CATEGORIES };
