/* What C has since 1999 and a compiler of 1990 lacks: bounds of numbers, and messages that fit into their space. */
#if !defined(__STDC_VERSION__) || __STDC_VERSION__ < 199901L
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#undef INFINITY
#undef NAN
#undef isfinite
#define INFINITY HUGE_VAL
#define NAN (HUGE_VAL - HUGE_VAL)
#define isfinite(x) ((x) - (x) == 0.0)
#define fmin c90_fmin
#define fmax c90_fmax
#define vsnprintf c90_format

static double c90_fmin(double a, double b)
{
    return b < a || a != a ? b : a;
}

static double c90_fmax(double a, double b)
{
    return b > a || a != a ? b : a;
}

/* As vsnprintf for the conversions d, u, ld, lu, g and s with a precision: a number never needs more than `one` holds. */
static void c90_format(char *text, size_t size, const char *format, va_list rest)
{
    char one[64], how[16];
    size_t length, most;
    for (; *format && size > 1; text += length, size -= length) {
        const char *from = format;
        length = *format == '%' ? strcspn(format, "dugs") + 1 : 1;
        format += length;
        if (*from == '%') {
            memcpy(how, from, length), how[length] = '\0';
            most = how[1] == '.' ? (size_t)atoi(how + 2) : size, from = one;
            if (how[length - 1] == 's') from = va_arg(rest, const char *);
            else if (how[length - 1] == 'g') sprintf(one, how, va_arg(rest, double));
            else if (how[length - 2] == 'l') sprintf(one, how, va_arg(rest, long));
            else sprintf(one, how, va_arg(rest, int));
            length = strlen(from);
            if (from != one && most < length) length = most;
        }
        if (length > size - 1) length = size - 1;
        memcpy(text, from, length);
    }
    *text = '\0';
}
#endif
