/* The precision of MPFR numbers in bits. The program raises it, up to MOST_PRECISION, while the ends of an interval are
 * more than 2^-CLOSE units apart. */
enum { PRECISION = 96, MOST_PRECISION = 6144, CLOSE = 20 };

/* An interval that contains a value; its ends are NaN if the value does not exist. If the value is known to be rational, the
 * exact value is stored too. */
typedef struct {
    mpfr_t low, high;
    mpq_t exact;
    int known;
} limits;

/* Whether exact rational values are stored. Some operands need them, because no precision decides them: for example,
 * x = 30 in floor(x * 0.1). */
static int exactly;

/* The intervals of one evaluation, and the number of intervals in use. */
static limits values[${ values }$];
static size_t used;

static inline limits *fresh(void)
{
    limits *it = &values[used++];
    it->known = 0;
    return it;
}

/* The interval of an exact value. */
static inline limits *known(limits *it)
{
    mpfr_set_q(it->low, it->exact, MPFR_RNDD);
    mpfr_set_q(it->high, it->exact, MPFR_RNDU);
    it->known = 1;
    return it;
}

/* If both ends of the interval are equal, the value is exact. */
static inline limits *noticed(limits *it)
{
    if (exactly && mpfr_number_p(it->low) && mpfr_equal_p(it->low, it->high)) {
        mpfr_get_q(it->exact, it->low);
        it->known = 1;
    }
    return it;
}

static inline limits *same(const limits *a)
{
    limits *it = fresh();
    mpfr_set(it->low, a->low, MPFR_RNDD);
    mpfr_set(it->high, a->high, MPFR_RNDU);
    mpq_set(it->exact, a->exact);
    it->known = a->known;
    return it;
}

static inline limits *between(mpfr_srcptr low, mpfr_srcptr high)
{
    limits *it = fresh();
    mpfr_set(it->low, low, MPFR_RNDD);
    mpfr_set(it->high, high, MPFR_RNDU);
    return it;
}

static inline limits *without_value(void)
{
    limits *it = fresh();
    mpfr_set_nan(it->low);
    mpfr_set_nan(it->high);
    return it;
}

static int holds_zero(const limits *a)
{
    return mpfr_sgn(a->low) <= 0 && mpfr_sgn(a->high) >= 0;
}

/* The value of a number in decimal notation, such as 1.5e-3. */
static inline limits *known_number(const char *text)
{
    limits *it = fresh();
    mpz_ptr numerator = mpq_numref(it->exact), denominator = mpq_denref(it->exact);
    mpz_set_ui(numerator, 0);
    mpz_set_ui(denominator, 1);
    int behind = 0;
    for (; *text != '\0' && *text != 'e' && *text != 'E'; ++text) {
        if (*text == '.') {
            behind = 1;
            continue;
        }
        mpz_mul_ui(numerator, numerator, 10);
        mpz_add_ui(numerator, numerator, (unsigned long)(*text - '0'));
        if (behind) {
            mpz_mul_ui(denominator, denominator, 10);
        }
    }
    const long power = *text == '\0' ? 0 : strtol(text + 1, NULL, 10);
    for (long at = power; at != 0; at += power < 0 ? 1 : -1) {
        mpz_ptr into = power < 0 ? denominator : numerator;
        mpz_mul_ui(into, into, 10);
    }
    mpq_canonicalize(it->exact);
    return known(it);
}

static inline limits *number(const char *text)
{
    if (exactly) {
        return known_number(text);
    }
    limits *it = fresh();
    mpfr_set_str(it->low, text, 10, MPFR_RNDD);
    mpfr_set_str(it->high, text, 10, MPFR_RNDU);
    return it;
}

typedef int of_none(mpfr_ptr, mpfr_rnd_t);
typedef int of_one(mpfr_ptr, mpfr_srcptr, mpfr_rnd_t);
typedef int of_two(mpfr_ptr, mpfr_srcptr, mpfr_srcptr, mpfr_rnd_t);

static inline limits *constant(of_none *function)
{
    limits *it = fresh();
    function(it->low, MPFR_RNDD);
    function(it->high, MPFR_RNDU);
    return it;
}

/* A function that increases with its operand. */
static inline limits *rising(of_one *function, const limits *a)
{
    limits *it = fresh();
    function(it->low, a->low, MPFR_RNDD);
    function(it->high, a->high, MPFR_RNDU);
    return noticed(it);
}

/* A function that increases with both operands. */
static inline limits *rising_in_both(of_two *function, const limits *a, const limits *b)
{
    limits *it = fresh();
    function(it->low, a->low, b->low, MPFR_RNDD);
    function(it->high, a->high, b->high, MPFR_RNDU);
    return it;
}

/* A function that is monotone in each of two operands: its extremes are at the ends of their intervals. */
static inline limits *at_corners(of_two *function, const limits *a, const limits *b)
{
    limits *it = fresh(), *corner = fresh();
    for (int at = 0; at < 4; ++at) {
        mpfr_srcptr x = at & 1 ? a->high : a->low, y = at & 2 ? b->high : b->low;
        function(corner->low, x, y, MPFR_RNDD);
        function(corner->high, x, y, MPFR_RNDU);
        if (at == 0 || mpfr_nan_p(corner->low) || mpfr_less_p(corner->low, it->low)) {
            mpfr_set(it->low, corner->low, MPFR_RNDD);
        }
        if (at == 0 || mpfr_nan_p(corner->high) || mpfr_greater_p(corner->high, it->high)) {
            mpfr_set(it->high, corner->high, MPFR_RNDU);
        }
    }
    return it;
}

/* A function with a slope from -1 to 1: its value at the lower end, plus or minus the width of the interval. */
static inline limits *wave(of_one *function, const limits *a)
{
    limits *it = fresh(), *distance = fresh();
    mpfr_sub(distance->high, a->high, a->low, MPFR_RNDU);
    function(it->low, a->low, MPFR_RNDD);
    function(it->high, a->low, MPFR_RNDU);
    mpfr_sub(it->low, it->low, distance->high, MPFR_RNDD);
    mpfr_add(it->high, it->high, distance->high, MPFR_RNDU);
    return noticed(it);
}

static inline limits *negate(const limits *a)
{
    limits *it = fresh();
    if (a->known) {
        mpq_neg(it->exact, a->exact);
        return known(it);
    }
    mpfr_neg(it->low, a->high, MPFR_RNDD);
    mpfr_neg(it->high, a->low, MPFR_RNDU);
    return it;
}

static inline limits *add(const limits *a, const limits *b)
{
    if (a->known && b->known) {
        limits *it = fresh();
        mpq_add(it->exact, a->exact, b->exact);
        return known(it);
    }
    return rising_in_both(mpfr_add, a, b);
}

static inline limits *subtract(const limits *a, const limits *b)
{
    return add(a, negate(b));
}

static inline limits *multiply(const limits *a, const limits *b)
{
    if (a->known && b->known) {
        limits *it = fresh();
        mpq_mul(it->exact, a->exact, b->exact);
        return known(it);
    }
    return at_corners(mpfr_mul, a, b);
}

static inline limits *divide(const limits *a, const limits *b)
{
    if (a->known && b->known && mpq_sgn(b->exact) != 0) {
        limits *it = fresh();
        mpq_div(it->exact, a->exact, b->exact);
        return known(it);
    }
    return holds_zero(b) ? without_value() : at_corners(mpfr_div, a, b);
}

/* mpfr_min and mpfr_max ignore a NaN, which must not get lost here. */
static inline int smaller(mpfr_ptr it, mpfr_srcptr a, mpfr_srcptr b, mpfr_rnd_t rounding)
{
    return mpfr_set(it, mpfr_nan_p(a) || mpfr_less_p(a, b) ? a : b, rounding);
}

static inline int larger(mpfr_ptr it, mpfr_srcptr a, mpfr_srcptr b, mpfr_rnd_t rounding)
{
    return mpfr_set(it, mpfr_nan_p(a) || mpfr_greater_p(a, b) ? a : b, rounding);
}

static inline limits *minimum(const limits *a, const limits *b)
{
    if (a->known && b->known) {
        return same(mpq_cmp(a->exact, b->exact) < 0 ? a : b);
    }
    return rising_in_both(smaller, a, b);
}

static inline limits *maximum(const limits *a, const limits *b)
{
    if (a->known && b->known) {
        return same(mpq_cmp(a->exact, b->exact) > 0 ? a : b);
    }
    return rising_in_both(larger, a, b);
}

static inline limits *absolute(const limits *a)
{
    limits *it = maximum(a, negate(a));
    if (mpfr_sgn(a->low) < 0 && mpfr_sgn(a->high) > 0) {
        mpfr_set_zero(it->low, 1); /* so that its root has an interval */
    }
    return it;
}

static inline limits *tangent(const limits *a)
{
    return divide(wave(mpfr_sin, a), wave(mpfr_cos, a));
}

/* The remainder of a divided by b, between 0 and b. */
static inline limits *remainder_of(const limits *a, const limits *b)
{
    limits *times = divide(a, b);
    if (times->known) {
        mpz_fdiv_q(mpq_numref(times->exact), mpq_numref(times->exact), mpq_denref(times->exact));
        mpz_set_ui(mpq_denref(times->exact), 1);
        return subtract(a, multiply(known(times), b));
    }
    mpfr_floor(times->low, times->low);
    mpfr_floor(times->high, times->high);
    if (mpfr_equal_p(times->low, times->high)) {
        return subtract(a, multiply(times, b));
    }
    limits *none = number("0");
    return between(minimum(none, b)->low, maximum(none, b)->high);
}

/* The direction of the point (x, y), from -pi to pi. The half plane of the point selects the formula. */
static inline limits *direction(const limits *y, const limits *x)
{
    const limits *half_turn = constant(mpfr_const_pi);
    if (mpfr_sgn(x->low) > 0) {
        return rising(mpfr_atan, divide(y, x));
    }
    if (mpfr_sgn(y->low) > 0 || mpfr_sgn(y->high) < 0) {
        limits *quarter_turn = divide(half_turn, number("2"));
        const limits *axis = mpfr_sgn(y->low) > 0 ? quarter_turn : negate(quarter_turn);
        return subtract(axis, rising(mpfr_atan, divide(x, y)));
    }
    if (mpfr_sgn(x->high) >= 0) {
        return without_value();
    }
    limits *from_left = rising(mpfr_atan, divide(y, x));
    limits *above = add(from_left, half_turn);
    if (mpfr_sgn(y->low) >= 0) {
        return above;
    }
    limits *below = subtract(from_left, half_turn);
    return between(minimum(above, below)->low, maximum(above, below)->high);
}

static inline limits *power(const limits *a, const limits *b)
{
    const int whole = mpfr_equal_p(b->low, b->high) && mpfr_integer_p(b->low);
    if (holds_zero(a) && (mpfr_sgn(b->low) < 0 || (mpfr_zero_p(b->low) && !whole))) {
        return without_value();
    }
    if (whole && a->known && mpfr_fits_slong_p(b->low, MPFR_RNDZ) && labs(mpfr_get_si(b->low, MPFR_RNDZ)) <= 64) {
        const long exponent = mpfr_get_si(b->low, MPFR_RNDZ);
        limits *it = fresh();
        mpq_set_ui(it->exact, 1, 1);
        for (long at = 0; at < labs(exponent); ++at) {
            mpq_mul(it->exact, it->exact, a->exact);
        }
        if (exponent < 0) {
            mpq_inv(it->exact, it->exact);
        }
        return known(it);
    }
    limits *it = at_corners(mpfr_pow, a, b);
    if (whole && holds_zero(a) && mpfr_sgn(it->low) > 0 && mpfr_sgn(b->low) > 0) {
        mpfr_set_zero(it->low, 1); /* an even power decreases and then increases */
    }
    return noticed(it);
}

/* The outcome of a comparison of intervals. */
typedef enum { NO, YES, UNKNOWN } truth;

/* Whether left exceeds right, or equals right if `or_equal` is set. */
static inline truth exceeds(const limits *left, const limits *right, int or_equal)
{
    const limits *by = subtract(left, right);
    if (mpfr_sgn(by->low) > 0 || (or_equal && mpfr_zero_p(by->low))) {
        return YES;
    }
    if (mpfr_sgn(by->high) < 0 || (!or_equal && mpfr_zero_p(by->high))) {
        return NO;
    }
    return UNKNOWN;
}

/* Returns `one` if left exceeds right, or equals right if `or_equal` is set, and otherwise `other`. If the comparison is unknown,
 * the interval contains both. */
static inline limits *choose(const limits *left, const limits *right, int or_equal, const limits *one, const limits *other)
{
    switch (exceeds(left, right, or_equal)) {
    case YES:
        return same(one);
    case NO:
        return same(other);
    default:
        return between(minimum(one, other)->low, maximum(one, other)->high);
    }
}

/* The interval of a raw operand or result, whose last place has the weight 2^exponent. */
static inline limits *raw_number(int64_t raw, int exponent)
{
    limits *it = fresh();
    mpfr_set_sj_2exp(it->low, raw, exponent, MPFR_RNDD);
    mpfr_set_sj_2exp(it->high, raw, exponent, MPFR_RNDU);
    return noticed(it);
}

/* The outcome of an attempt to bound the error of a result. */
typedef enum { UNDECIDED, DECIDED, NOT_PROMISED } outcome;

/* Sets `error` to an upper bound of the error of a result, in units of its last place 2^exponent. The outcome is DECIDED if the
 * formula has a value and its interval is narrow enough. */
static outcome limit_error(mpfr_ptr error, const limits *value, int64_t result, int exponent)
{
    if (!mpfr_number_p(value->low) || !mpfr_number_p(value->high)) {
        return UNDECIDED;
    }
    limits *off = subtract(raw_number(result, exponent), value), *apart = fresh();
    mpfr_sub(apart->high, value->high, value->low, MPFR_RNDU);
    mpfr_mul_2si(error, absolute(off)->high, -exponent, MPFR_RNDU);
    return mpfr_cmp_ui_2exp(apart->high, 1, exponent - CLOSE) < 0 ? DECIDED : UNDECIDED;
}

static void make_values(void)
{
    for (size_t at = 0; at < sizeof values / sizeof *values; ++at) {
        mpfr_inits2(PRECISION, values[at].low, values[at].high, (mpfr_ptr)0);
        mpq_init(values[at].exact);
    }
}

static void set_precision(mpfr_prec_t bits)
{
    for (size_t at = 0; at < sizeof values / sizeof *values; ++at) {
        mpfr_set_prec(values[at].low, bits);
        mpfr_set_prec(values[at].high, bits);
    }
}

/* A function that bounds the error of a result for raw operands, with the current precision. */
typedef outcome attempt(mpfr_ptr error, const int64_t *operands, int64_t result);

/* Bounds the error with increasing precision, and then with rational values, until the outcome is not UNDECIDED. */
static outcome has_error(attempt *with_present_precision, mpfr_ptr error, const int64_t *operands, int64_t result)
{
    outcome reached = with_present_precision(error, operands, result);
    if (reached != UNDECIDED) {
        return reached;
    }
    mpfr_prec_t bits = PRECISION;
    exactly = 1;
    while ((reached = with_present_precision(error, operands, result)) == UNDECIDED && bits < MOST_PRECISION) {
        set_precision(bits *= 2);
    }
    exactly = 0;
    set_precision(PRECISION);
    return reached;
}
