#if FLT_EVAL_METHOD != 0
#error "operations on double must round to double: on x86, compile with -msse2 -mfpmath=sse"
#endif
#ifdef __FAST_MATH__
#error "the margins hold without -ffast-math alone"
#endif
#ifdef __clang__
#pragma STDC FP_CONTRACT OFF
#endif

/* A double that is near a real number: the number is no further from the value than the margin. The margin is 0 if the value is
 * exact, and not a number if nothing is known. For example, 1.0 / 3.0 has a margin of about 2^-55. */
typedef struct {
    double value, margin;
} near;

/* The largest relative error of a rounding to double. */
#define ROUNDING 0x1p-53

/* The relative error that a function of the C library may have: 8 units of the last place of a double. The GNU C library states at
 * most 2 units for these functions on x86-64. This program compares samples with MPFR. */
#define LIBRARY 0x1p-49

/* More than any error that an underflow makes. */
#define TINY 0x1p-900

static inline near near_unknown(void)
{
    return (near){NAN, NAN};
}

static inline near near_exactly(double value)
{
    return (near){value, 0};
}

/* A number that was rounded to double. */
static inline near near_rounded(double value)
{
    return (near){value, fabs(value) * (2 * ROUNDING) + TINY};
}

/* A raw operand or result, times the weight of its last place, which is a power of two. */
static inline near near_raw(int64_t raw, double unit)
{
    const double value = (double)raw * unit;
    const int fits = raw >= -(INT64_C(1) << 53) && raw <= INT64_C(1) << 53;
    return fits ? near_exactly(value) : near_rounded(value);
}

/* A margin that is larger than a computed one by more than the roundings that computed it. */
static inline double wider(double margin)
{
    return margin * (1 + 0x1p-46) + TINY;
}

/* A value with the margin `margin`, which is exact if `margin` is 0 and both operands are. */
static inline near near_from(near a, near b, double value, double margin)
{
    const int is_exact = a.margin == 0 && b.margin == 0 && margin == 0;
    return (near){value, is_exact ? 0 : wider(margin)};
}

/* The lower and the upper end of the numbers that a value is near to. */
static inline double low_end(near a)
{
    return a.margin == 0 ? a.value : a.value - (wider(a.margin) + fabs(a.value) * (2 * ROUNDING));
}

static inline double high_end(near a)
{
    return a.margin == 0 ? a.value : a.value + (wider(a.margin) + fabs(a.value) * (2 * ROUNDING));
}

static inline near near_negate(near a)
{
    return (near){-a.value, a.margin};
}

static inline near near_absolute(near a)
{
    return (near){fabs(a.value), a.margin};
}

/* The error of the rounded sum is a double itself: D. E. Knuth, The Art of Computer Programming, volume 2, section 4.2.2. */
static inline near near_add(near a, near b)
{
    const double sum = a.value + b.value, from_b = sum - a.value;
    const double lost = (a.value - (sum - from_b)) + (b.value - from_b);
    return near_from(a, b, sum, fabs(lost) + a.margin + b.margin);
}

static inline near near_subtract(near a, near b)
{
    return near_add(a, near_negate(b));
}

/* The upper 26 bits of a double. */
static inline double upper_half(double a)
{
    const double scaled = a * 134217729.0; /* 2^27 + 1 */
    return scaled - (scaled - a);
}

/* The error of a rounded product, which is a double too: T. J. Dekker, Numerische Mathematik 18 (1971). */
static inline double lost_in_product(double a, double b, double product)
{
    if (fabs(product) < TINY) {
        return a == 0 || b == 0 ? 0 : TINY;
    }
#ifdef FP_FAST_FMA
    return fma(a, b, -product);
#else
    const double upper_a = upper_half(a), lower_a = a - upper_a;
    const double upper_b = upper_half(b), lower_b = b - upper_b;
    return ((upper_a * upper_b - product) + upper_a * lower_b + lower_a * upper_b) + lower_a * lower_b;
#endif
}

static inline near near_multiply(near a, near b)
{
    const double product = a.value * b.value, lost = lost_in_product(a.value, b.value, product);
    const double spread = fabs(a.value) * b.margin + fabs(b.value) * a.margin + a.margin * b.margin;
    return near_from(a, b, product, fabs(lost) + spread);
}

static inline near near_square(near a)
{
    return near_multiply(a, a);
}

static inline near near_divide(near a, near b)
{
    const double least = fabs(b.value) - b.margin * (1 + 2 * ROUNDING);
    if (!(least > 0)) {
        return near_unknown();
    }
    const double quotient = a.value / b.value, product = quotient * b.value;
    const double rest = fabs(product - a.value) + fabs(lost_in_product(quotient, b.value, product));
    return near_from(a, b, quotient, (rest + a.margin + fabs(quotient) * b.margin) / least);
}

static inline near near_minimum(near a, near b)
{
    if (high_end(a) <= low_end(b)) {
        return a;
    }
    if (high_end(b) <= low_end(a)) {
        return b;
    }
    return (near){a.value < b.value ? a.value : b.value, a.margin + b.margin};
}

static inline near near_maximum(near a, near b)
{
    return near_negate(near_minimum(near_negate(a), near_negate(b)));
}

/* A value that the C library computed for an exact operand. */
static inline near from_library(double value)
{
    return (near){value, wider(fabs(value) * LIBRARY)};
}

/* Any value between two that the C library computed. */
static inline near between_from_library(double low, double high)
{
    const double middle = low + (high - low) / 2;
    return (near){middle, wider(fabs(high - low) / 2 + (fabs(low) + fabs(high)) * LIBRARY)};
}

/* A function of the C library that increases with its operand. */
static inline near near_rising(double (*function)(double), near a)
{
    if (a.margin == 0) {
        return from_library(function(a.value));
    }
    return between_from_library(function(low_end(a)), function(high_end(a)));
}

/* A function of the C library with a slope from -1 to 1. */
static inline near near_wave(double (*function)(double), near a)
{
    const near wave = from_library(function(a.value));
    return (near){wave.value, wider(wave.margin + a.margin)};
}

static inline near near_tangent(near a)
{
    return near_divide(near_wave(sin, a), near_wave(cos, a));
}

/* The remainder of a divided by b, between 0 and b. */
static inline near near_remainder_of(near a, near b)
{
    const near times = near_divide(a, b);
    const double least = floor(low_end(times)), most = floor(high_end(times));
    return least == most ? near_subtract(a, near_multiply(near_exactly(least), b)) : near_unknown();
}

/* The direction of the point (x, y), from -pi to pi. A displacement of the point by d turns it by at most pi/2 * d / distance. */
static inline near near_direction(near y, near x)
{
    const double displacement = x.margin + y.margin, distance = fmax(fabs(x.value), fabs(y.value));
    const int may_cross_cut = y.margin != 0 && fabs(y.value) <= y.margin && low_end(x) <= 0;
    if (!(distance > 2 * displacement) || may_cross_cut) {
        return near_unknown();
    }
    const near direction = from_library(atan2(y.value + 0.0, x.value)); /* -0.0 becomes 0.0 */
    return (near){direction.value, wider(direction.margin + 2 * displacement / distance)};
}

/* a to the power of a whole number, by products. */
static inline near near_whole_power(near a, int exponent)
{
    near product = near_exactly(1);
    for (int at = 0; at < abs(exponent); ++at) {
        product = near_multiply(product, a);
    }
    return exponent < 0 ? near_divide(near_exactly(1), product) : product;
}

static inline near near_power(near a, near b)
{
    if (b.margin == 0 && b.value == floor(b.value) && fabs(b.value) <= 64) {
        return near_whole_power(a, (int)b.value);
    }
    if (!(low_end(a) > 0) || isnan(b.margin)) {
        return near_unknown();
    }
    if (a.margin == 0 && b.margin == 0) {
        return from_library(pow(a.value, b.value));
    }
    /* A power is monotone in base and exponent, so that its limits are at their limits. */
    const double corners[] = {pow(low_end(a), low_end(b)), pow(low_end(a), high_end(b)), pow(high_end(a), low_end(b)),
                              pow(high_end(a), high_end(b))};
    double low = corners[0], high = corners[0];
    for (int at = 1; at < 4; ++at) {
        low = fmin(low, corners[at]);
        high = fmax(high, corners[at]);
    }
    return between_from_library(low, high);
}

/* Whether left exceeds right, or equals right if `or_equal` is set. */
static inline truth near_exceeds(near left, near right, int or_equal)
{
    const near by = near_subtract(left, right);
    if (by.value > by.margin || (or_equal && by.value == 0 && by.margin == 0)) {
        return YES;
    }
    if (-by.value > by.margin || (!or_equal && by.value == 0 && by.margin == 0)) {
        return NO;
    }
    return UNKNOWN;
}

/* Returns `one` if left exceeds right, or equals right if `or_equal` is set, and otherwise `other`. If the comparison is unknown,
 * so is the result. */
static inline near near_choose(near left, near right, int or_equal, near one, near other)
{
    switch (near_exceeds(left, right, or_equal)) {
    case YES:
        return one;
    case NO:
        return other;
    default:
        return near_unknown();
    }
}
