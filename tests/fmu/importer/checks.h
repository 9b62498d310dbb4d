/* Checks of an FMU from C. A check says what it found wrong and goes on; the program ends with 1 when any did. */

#ifndef CHECKS_H
#define CHECKS_H

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "importer.h"

extern int failures;

#define EXPECT(condition, ...) \
    do { \
        if (!(condition) && failures++ < 40) printf("WRONG: " __VA_ARGS__), printf(" (%s:%d)\n", __FILE__, __LINE__); \
    } while (0)

#define NEEDS(condition, usage) \
    do { \
        if (!(condition)) { \
            fprintf(stderr, "arguments: %s\n", usage); \
            exit(2); \
        } \
    } while (0)

typedef void Check(const Fmu *m, int n, char **arguments);

Check check_order, check_birth, check_shuffle, check_reset, check_rollback, check_save, check_restore, check_threads,
    check_cycles, check_drift, check_steps, check_exchange, check_trace, check_slopes;

#endif
