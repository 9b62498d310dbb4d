/* Arithmetic of some rows side by side, one in each lane of a vector: what a straight-line function of the model asks
   for. A lane knows nothing of the others, and a result does not depend on how many there are nor on the instructions
   that make it: exp, log, pow and tanh are sums, products and quotients. What they do not cover, a lane asks of the C
   library. */

#ifndef LANES
#define LANES 4
#endif
typedef double lanes __attribute__((vector_size(8 * LANES)));
typedef uint64_t lanes_bits __attribute__((vector_size(8 * LANES)));

#if LANES == 2
#define lanes_all(v) ((lanes){v, v})
#elif LANES == 8
#define lanes_all(v) ((lanes){v, v, v, v, v, v, v, v})
#else
#define lanes_all(v) ((lanes){v, v, v, v})
#endif
#define lanes_where(condition) ((lanes_bits)(condition))               /* all bits of a lane or none */
#define lanes_true(condition) ((lanes)(lanes_where(condition) & (lanes_bits)lanes_all(1.0)))
#define lanes_only(condition, a) ((lanes)(lanes_where(condition) & (lanes_bits)(a)))
#define LANES_SIGN ((lanes_bits)lanes_all(-0.0))
#define LANES_FUNCTION static __attribute__((noinline, unused)) lanes

static inline lanes lanes_select(lanes_bits where, lanes a, lanes b)
{
    return (lanes)((where & (lanes_bits)a) | (~where & (lanes_bits)b));
}

static inline int lanes_any(lanes_bits where)
{
    uint64_t any = 0;
    int i;
    for (i = 0; i < LANES; i++) any |= where[i];
    return any != 0;
}

/* The function of the C library in the lanes where something holds. */
static __attribute__((noinline)) lanes lanes_each_1(lanes_bits where, double (*f)(double), lanes a, lanes otherwise)
{
    int i;
    for (i = 0; i < LANES; i++)
        if (where[i]) otherwise[i] = f(a[i]);
    return otherwise;
}

static __attribute__((noinline)) lanes lanes_each_2(lanes_bits where, double (*f)(double, double), lanes a, lanes b,
                                                    lanes otherwise)
{
    int i;
    for (i = 0; i < LANES; i++)
        if (where[i]) otherwise[i] = f(a[i], b[i]);
    return otherwise;
}

#define LANES_EACH_1(f) static inline lanes lanes_##f(lanes a) { return lanes_each_1(~(lanes_bits){0}, f, a, a); }
#define LANES_EACH_2(f) \
    static inline lanes lanes_##f(lanes a, lanes b) { return lanes_each_2(~(lanes_bits){0}, f, a, b, a); }
LANES_EACH_1(sin) LANES_EACH_1(cos) LANES_EACH_1(tan) LANES_EACH_1(asin) LANES_EACH_1(acos) LANES_EACH_1(atan)
LANES_EACH_1(sinh) LANES_EACH_1(cosh) LANES_EACH_1(asinh) LANES_EACH_1(acosh) LANES_EACH_1(atanh) LANES_EACH_1(erf)
LANES_EACH_1(log1p) LANES_EACH_1(expm1) LANES_EACH_1(floor) LANES_EACH_1(ceil)
LANES_EACH_2(fmod) LANES_EACH_2(atan2) LANES_EACH_2(hypot)

static inline lanes lanes_sqrt(lanes a) { return __builtin_elementwise_sqrt(a); }
static inline lanes lanes_fabs(lanes a) { return (lanes)((lanes_bits)a & ~LANES_SIGN); }
static inline lanes lanes_fmax(lanes a, lanes b) { return lanes_select(lanes_where((a > b) | (b != b)), a, b); }
static inline lanes lanes_fmin(lanes a, lanes b) { return lanes_select(lanes_where((a < b) | (b != b)), a, b); }
static inline lanes lanes_copysign(lanes a, lanes b)
{
    return (lanes)(((lanes_bits)a & ~LANES_SIGN) | ((lanes_bits)b & LANES_SIGN));
}

/* Adding this rounds to the nearest integer, which then stands in the lowest bits. */
#define LANES_ROUND 0x1.8p52
/* ln 2 in two parts, the first short enough that its products with exponents are exact. */
#define LANES_LN2 0x1.62e42fefa39efp-1
#define LANES_LN2_HIGH 0x1.62e42feep-1
#define LANES_LN2_LOW 0x1.a39ef35793c76p-33
#define LANES_LOG2E 0x1.71547652b82fep0

/* 2^n of integers from -1022 to 1023. */
static inline lanes lanes_power_of_2(lanes n) { return (lanes)((lanes_bits)(n + (LANES_ROUND + 1023)) << 52); }

/* exp(r) - 1 for |r| <= ln(2)/2, within 2e-17: r + r^2 P(r), where P meets (exp(r) - 1 - r)/r^2 at the ten zeros of a
   Chebyshev polynomial on this interval. Even and odd terms are summed apart, which is faster. */
static inline lanes lanes_series(lanes r)
{
    lanes z = r * r;
    lanes even = 0.5 + z * (0.04166666666662413 + z * (0.0013888888917213717 + z * (2.4801521295954376e-05
                 + z * 2.7620088445409746e-07)));
    lanes odd = 0.16666666666666669 + z * (0.008333333333330062 + z * (0.00019841269863053618
                + z * (2.7557268459997064e-06 + z * 2.510038549551032e-08)));
    return r + z * (even + r * odd);
}

/* The nearest n with a = n ln(2) + r. */
static inline lanes lanes_reduced(lanes a, lanes *r)
{
    lanes n = (a * LANES_LOG2E + LANES_ROUND) - LANES_ROUND;
    *r = (a - n * LANES_LN2_HIGH) - n * LANES_LN2_LOW;
    return n;
}

LANES_FUNCTION lanes_exp(lanes a)
{
    lanes r, n = lanes_reduced(a, &r), result = (1.0 + lanes_series(r)) * lanes_power_of_2(n);
    lanes_bits unusual = ~lanes_where(lanes_fabs(a) < 708.0);
    return lanes_any(unusual) ? lanes_each_1(unusual, exp, a, result) : result;
}

/* Odd, by (e^2a - 1)/(e^2a + 1); the quotient is 1 long before a = 20. */
LANES_FUNCTION lanes_tanh(lanes a)
{
    lanes r, size = lanes_fabs(a), n, power, t;
    size = lanes_select(lanes_where(size > 20.0), lanes_all(20.0), size);
    n = lanes_reduced(size + size, &r);
    power = lanes_power_of_2(n);
    t = power * lanes_series(r) + (power - 1.0);
    return lanes_copysign(t / (t + 2.0), a);
}

/* a = (1 + f) 2^k with 1 + f between sqrt(1/2) and sqrt(2), for positive normal numbers. */
static inline lanes lanes_parted(lanes a, lanes *f)
{
    lanes_bits one = (lanes_bits)lanes_all(1.0), root = (lanes_bits)lanes_all(0x1.6a09e667f3bcdp-1);
    lanes_bits k = ((lanes_bits)a + (one - root)) >> 52;
    *f = (lanes)((lanes_bits)a - (k << 52) + one) - 1.0;
    return (lanes)(k | (lanes_bits)lanes_all(0x1p52)) - (0x1p52 + 1023);
}

/* f - ln(1 + f) - more, where ln(1 + f) = 2 artanh(s) with s = f/(2 + f) is written as f - (f^2/2 - s (f^2/2 + z Q(z)))
   with z = s^2, which keeps the digits of a small f. Q meets its function at the seven zeros of a Chebyshev polynomial,
   which leaves 2e-18 of the result. */
static inline lanes lanes_log_rest(lanes f, lanes more)
{
    lanes s = f / (2.0 + f), z = s * s, w = z * z, square = 0.5 * f * f;
    lanes even = w * (0.39999999999899444 + w * (0.22222211130259875 + w * 0.1533171061820642));
    lanes odd = z * (0.666666666666667 + w * (0.2857142862600327 + w * (0.18182889455675105
                + w * 0.14616585424934123)));
    return square - (s * (square + (odd + even)) + more);
}

/* Zero, negative, subnormal, infinite or no number at all. */
static inline lanes_bits lanes_unusual(lanes a)
{
    return ~(lanes_where(a >= 0x1p-1022) & lanes_where(a <= 0x1.fffffffffffffp1023));
}

LANES_FUNCTION lanes_log(lanes a)
{
    lanes f, k = lanes_parted(a, &f), result = k * LANES_LN2_HIGH - (lanes_log_rest(f, k * LANES_LN2_LOW) - f);
    lanes_bits unusual = lanes_unusual(a);
    return lanes_any(unusual) ? lanes_each_1(unusual, log, a, result) : result;
}

/* 2^(b log2 a) with log2 a = k + log2(1 + f): b k is exact in two parts, so a large exponent costs no digits. */
LANES_FUNCTION lanes_pow(lanes a, lanes b)
{
    lanes f, k = lanes_parted(a, &f), log2_m = (f - lanes_log_rest(f, lanes_all(0.0))) * LANES_LOG2E;
    lanes b_high = (lanes)((lanes_bits)b >> 20 << 20);
    lanes n = (b * (k + log2_m) + LANES_ROUND) - LANES_ROUND;
    lanes r = ((b_high * k - n) + (b - b_high) * k) + b * log2_m;
    lanes result = (1.0 + lanes_series(r * LANES_LN2)) * lanes_power_of_2(n);
    lanes_bits unusual = lanes_unusual(a) | ~lanes_where(lanes_fabs(n) < 1022.0);
    return lanes_any(unusual) ? lanes_each_2(unusual, pow, a, b, result) : result;
}
