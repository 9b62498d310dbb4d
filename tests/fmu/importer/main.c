/* checks FACTS CHECK [ARGUMENT...]: exit code 0 when all is well, 1 with what is wrong on standard output. */

#include "checks.h"

int failures;

int main(int n, char **arguments)
{
    static const struct {
        const char *name;
        Check *check;
    } checks[] = {
#ifndef _WIN32 /* threads and what memory is in use are asked of Linux */
        {"shuffle", check_shuffle}, {"reset", check_reset},   {"rollback", check_rollback}, {"save", check_save},
        {"restore", check_restore}, {"threads", check_threads}, {"cycles", check_cycles},   {"drift", check_drift},
        {"steps", check_steps},     {"exchange", check_exchange}, {"slopes", check_slopes},
#endif
        {"order", check_order},     {"birth", check_birth},   {"trace", check_trace}};
    size_t k;
    Fmu m;
    NEEDS(n >= 3, "FACTS CHECK [ARGUMENT...]");
    for (k = 0; k < sizeof checks / sizeof *checks; k++) {
        if (strcmp(arguments[2], checks[k].name) != 0) continue;
        load(&m, arguments[1], NULL);
        checks[k].check(&m, n - 3, arguments + 3);
        return failures > 0;
    }
    fprintf(stderr, "there is no check %s\n", arguments[2]);
    return 2;
}
