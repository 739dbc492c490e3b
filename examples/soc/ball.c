/* Geometry, ambient and diffuse light in double, as the host's part of `glint render` is. */
#include "ball.h"

#include "shade_model.h"

/* The root as IEEE 754 rounds it: bit by bit, of a mantissa of 53 bits and an even exponent. */
double root(double value)
{
    union {
        double value;
        uint64_t bits;
    } it = {value};
    int exponent = (int)(it.bits >> 52) - 1075;
    if (exponent == -1075) {
        return 0.0; /* no subnormal numbers here */
    }
    uint64_t rest = (it.bits & 0xfffffffffffffu) | 0x10000000000000u;
    if (exponent & 1) {
        rest <<= 1;
        exponent -= 1;
    }
    /* The root of rest * 2^54, in 54 bits: one more than are kept. */
    uint64_t result = 0, left = 0;
    for (int step = 0; step < 54; step++) {
        /* Two bits at a time: 54 of `rest`, and 54 zeros below. */
        const unsigned two = step < 27 ? (unsigned)(rest >> (52 - 2 * step)) & 3u : 0u;
        left = (left << 2) | two;
        const uint64_t trial = (result << 2) | 1u;
        result <<= 1;
        if (left >= trial) {
            left -= trial;
            result |= 1u;
        }
    }
    /* Never a tie: a root with one bit more would have a square with two bits more. */
    result = (result + 1u) >> 1;
    /* result * 2^(exponent/2 - 26) */
    it.bits = ((uint64_t)(exponent / 2 - 26 + 1075) << 52) + (result - 0x10000000000000u);
    return it.value;
}

static vector scaled(vector v, double by)
{
    const vector result = {v.x * by, v.y * by, v.z * by};
    return result;
}

static double dot(vector a, vector b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

static double larger(double a, double b) { return a > b ? a : b; }

static double size(double a) { return a < 0.0 ? -a : a; }

vector unit(vector v)
{
    const double largest = larger(larger(size(v.x), size(v.y)), size(v.z));
    const vector part = scaled(v, 1.0 / largest);
    return scaled(part, 1.0 / root(dot(part, part)));
}

static const double BALL[3] = {0.08, 0.35, 0.54};
static const double BACKGROUND[3] = {0.05, 0.06, 0.08};
static const double AMBIENT = 0.12, DIFFUSE = 0.75;
static const double HALF = 0.2679491924311227; /* tan 15 degrees */
static const double FAR = 4.0;

pixel geometry(unsigned column, unsigned row, vector light)
{
    pixel result = {0, 0, {BACKGROUND[0] * 255.0, BACKGROUND[1] * 255.0, BACKGROUND[2] * 255.0}};
    const vector ray = {
        ((2.0 * column + 1.0) / WIDTH - 1.0) * HALF,
        (1.0 - (2.0 * row + 1.0) / HEIGHT) * HALF,
        -1.0,
    };
    const double square = dot(ray, ray);
    const double discriminant = FAR * FAR - square * (FAR * FAR - 1.0);
    if (discriminant < 0.0) {
        return result;
    }
    const double depth = (FAR - root(discriminant)) / square;
    const vector along = scaled(ray, depth);
    const vector place = {along.x, along.y, FAR + along.z};
    const vector normal = unit(place);
    const vector toward_eye = unit(scaled(ray, -1.0));
    const double facing = dot(normal, light);
    const double share = AMBIENT + DIFFUSE * larger(facing, 0.0);
    for (int channel = 0; channel < 3; channel++) {
        result.base[channel] = BALL[channel] * share * 255.0;
    }
    if (facing > 0.0) {
        const vector sum = {light.x + toward_eye.x, light.y + toward_eye.y, light.z + toward_eye.z};
        const double cosine = dot(normal, unit(sum));
        result.lit = 1;
        result.cos_gamma = shade_cos_gamma_from(cosine > 1.0 ? 1.0 : cosine);
    }
    return result;
}
