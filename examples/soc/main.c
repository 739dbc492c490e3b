/* A ball, pixel by pixel: what `glint render` draws with the options that `run` gives.
 *
 * Geometry, ambient and diffuse light are in double, as the host's part of `glint render` is; the highlight is
 * computed by the core, by the core's model in C, and by C that was written by hand for these 32 bits. All have to
 * agree, and the clocks of each are counted.
 */
#include "shade_model.h"
#include "shade_registers.h"

/* ROWS are worked on together, as many as there is memory for. */
enum { WIDTH = 48, HEIGHT = 48, ROWS = 8, EXPONENT = 80 };

static volatile uint32_t *const core = (volatile uint32_t *)0x10000000u;
static volatile uint32_t *const console = (volatile uint32_t *)0x20000000u;

static void show(uint32_t byte) { console[0] = byte; }
static void number(uint32_t value) { console[1] = value; }

static uint32_t clocks(void)
{
    uint32_t now;
    __asm__ volatile("rdcycle %0" : "=r"(now));
    return now;
}

/* What the compiler may ask for. */
void *memset(void *to, int byte, size_t count)
{
    for (unsigned char *at = to; count--; at++) {
        *at = (unsigned char)byte;
    }
    return to;
}

void *memcpy(void *restrict to, const void *restrict from, size_t count)
{
    unsigned char *into = to;
    for (const unsigned char *at = from; count--; at++) {
        *into++ = *at;
    }
    return to;
}

typedef struct {
    double x, y, z;
} vector;

/* The root as IEEE 754 rounds it: bit by bit, of a mantissa of 53 bits and an even exponent. */
static double root(double value)
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

static vector unit(vector v)
{
    const double largest = larger(larger(size(v.x), size(v.y)), size(v.z));
    const vector part = scaled(v, 1.0 / largest);
    return scaled(part, 1.0 / root(dot(part, part)));
}

/* A pixel before its highlight: the operand, the light without it (0 ... 255), and whether there is a highlight. */
typedef struct {
    uint32_t cos_gamma;
    uint32_t lit;
    double base[3];
} pixel;

static const double BALL[3] = {0.08, 0.35, 0.54};
static const double BACKGROUND[3] = {0.05, 0.06, 0.08};
static const double AMBIENT = 0.12, DIFFUSE = 0.75, SPECULAR = 0.7;
static const double HALF = 0.2679491924311227; /* tan 15 degrees */
static const double FAR = 4.0;

static pixel geometry(unsigned column, unsigned row, vector light)
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

/* The colours of highlights, one below the other in a word, by the core: a store starts a point, a load waits for it.
 * While one is computed, the one before goes to memory and the next comes from there. */
static void by_core(const uint32_t *cos_gamma, uint32_t *colours, unsigned count)
{
    volatile uint32_t *const operand = core + SHADE_REG_COS_GAMMA / 4u;
    const volatile uint32_t *const results = core + SHADE_REG_RESULTS / 4u;
    *operand = cos_gamma[0];
#pragma GCC unroll 32
    for (unsigned at = 1; at < count; at++) {
        const uint32_t next = cos_gamma[at];
        const uint32_t result = *results;
        *operand = next;
        colours[at - 1] = result;
    }
    colours[count - 1] = *results;
}

/* The same by the processor alone, bit for bit: the model. */
static void by_model(const uint32_t *cos_gamma, uint32_t *colours, unsigned count, uint32_t full)
{
    for (unsigned at = 0; at < count; at++) {
        const shade_operands operands = {cos_gamma[at], EXPONENT, full, full, full};
        const shade_results results = shade_model(operands);
        colours[at] = results.red_out | results.green_out << 8 | results.blue_out << 16;
    }
}

/* And the fastest that we could write: W(n, gamma) for every operand that the core takes, in 32 bits. */
static void by_hand(const uint32_t *cos_gamma, uint32_t *colours, unsigned count, uint32_t full)
{
    /* The exponent and the colours are those of this picture, and not known to the compiler. */
    uint32_t exponent = EXPONENT, red = full, green = full, blue = full;
    __asm__("" : "+r"(exponent), "+r"(red), "+r"(green), "+r"(blue));
    for (unsigned at = 0; at < count; at++) {
        /* As the core: a cosine above 1.0 is 1.0. */
        const uint32_t cosine = cos_gamma[at] > 0x100000u ? 0x100000u : cos_gamma[at];
        const uint32_t product = (0x100000u - cosine) * exponent;
        uint32_t base = product >> 24 || cosine == 0 ? 0 : (product >> 8) ^ 0xffffu;
        base = base * base >> 16;
        base = base * base >> 16;
        base = base * base >> 16;
        base = base * base >> 16;
        colours[at] = (base * red + 0x8000u) >> 16 | ((base * green + 0x8000u) >> 16) << 8 |
                      ((base * blue + 0x8000u) >> 16) << 16;
    }
}

int main(void)
{
    if (shade_read(core, SHADE_REG_ID) != SHADE_ID ||
        shade_read(core, SHADE_REG_CONFIGURATION) != SHADE_CONFIGURATION) {
        return 1;
    }
    const vector light = unit((vector){-0.6, 0.8, 0.9});
    const uint32_t full = shade_red_from(SPECULAR * 255.0);
    shade_write(core, SHADE_REG_EXPONENT, EXPONENT);
    shade_write(core, SHADE_REG_RED, full);
    shade_write(core, SHADE_REG_GREEN, full);
    shade_write(core, SHADE_REG_BLUE, full);
    shade_write(core, SHADE_REG_CONTROL,
                SHADE_CONTROL_START_ON_WRITE_MASK |
                    SHADE_REG_COS_GAMMA / 4u << SHADE_CONTROL_START_WORD_SHIFT);

    static pixel pixels[ROWS * WIDTH];
    static uint32_t cos_gamma[ROWS * WIDTH], colours[3][ROWS * WIDTH];
    uint32_t spent[3] = {0, 0, 0}, points = 0;
    for (unsigned row = 0; row < HEIGHT; row += ROWS) {
        unsigned count = 0;
        for (unsigned at = 0; at < ROWS * WIDTH; at++) {
            pixels[at] = geometry(at % WIDTH, row + at / WIDTH, light);
            if (pixels[at].lit) {
                cos_gamma[count++] = pixels[at].cos_gamma;
            }
        }
        if (count > 0) {
            const uint32_t start = clocks();
            by_core(cos_gamma, colours[0], count);
            const uint32_t second = clocks();
            by_model(cos_gamma, colours[1], count, full);
            const uint32_t third = clocks();
            by_hand(cos_gamma, colours[2], count, full);
            const uint32_t end = clocks();
            spent[0] += second - start;
            spent[1] += third - second;
            spent[2] += end - third;
            points += count;
        }
        unsigned shaded = 0;
        for (unsigned at = 0; at < ROWS * WIDTH; at++) {
            uint32_t colour = 0;
            if (pixels[at].lit) {
                colour = colours[0][shaded];
                if (colour != colours[1][shaded] || colour != colours[2][shaded]) {
                    return 2;
                }
                shaded++;
            }
            for (unsigned channel = 0; channel < 3; channel++) {
                const double sum =
                    pixels[at].base[channel] + (double)(colour >> (8 * channel) & 0xffu);
                show((uint32_t)((sum > 255.0 ? 255.0 : sum) + 0.5));
            }
        }
    }
    number(points);
    for (unsigned way = 0; way < 3; way++) {
        number(spent[way]);
    }
    return 0;
}
