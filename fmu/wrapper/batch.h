/* Many rows in one call: what steady states and warm-ups share. The model's sizes, tables and functions stand above
   this text: N states and N_OUTPUTS outputs are the model's own. Every row stands for itself: it knows nothing of the
   rows beside it, so rows may be cut into blocks, shared among threads and computed again with the same bits. */

#include <complex.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#if defined _WIN32
#define BATCH_EXPORT __declspec(dllexport)
#else
#define BATCH_EXPORT __attribute__((visibility("default")))
#endif

#define AT_LEAST_1(n) ((n) > 0 ? (n) : 1)

/* What became of a row; the same numbers as gearheat.fmu.batch.Status. */
enum { ROW_OK, ROW_NO_EQUILIBRIUM, ROW_UNSTABLE, ROW_NOT_FINITE, ROW_STOPPED, ROW_OUT_OF_RANGE, ROW_NO_SOLUTION,
       ROW_CONTRADICTION };

static int all_finite(const double *v, int n)
{
    int i;
    for (i = 0; i < n; i++)
        if (!isfinite(v[i])) return 0;
    return 1;
}

/* Numbers of a row that failed. */
static void nothing(double *v, int64_t n)
{
    int64_t i;
    for (i = 0; i < n; i++) v[i] = NAN;
}
