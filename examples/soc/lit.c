/* Colours of a surface by `lit` in every way. */
#include "ways.h"

#include "lit_model.h"
#include "system.h"

static uint32_t albedo; /* red, green and blue in the lowest bytes */

void lit_begin(uint32_t red, uint32_t green, uint32_t blue)
{
    albedo = red | green << 8 | blue << 16;
    LIT_SPANS->exponent = EXPONENT;
    LIT_SPANS->colour = albedo;
}

uint32_t lit_normal(double x, double y, double z)
{
    const uint32_t mask = (1u << LIT_NX_WIDTH) - 1u;
    return ((uint32_t)lit_nx_from(x) & mask) | ((uint32_t)lit_ny_from(y) & mask) << 10 |
           ((uint32_t)lit_nz_from(z) & mask) << 20;
}

static void by_spans(const span *spans, unsigned count, const uint32_t *operands, uint32_t *frame)
{
    run_spans(LIT_SPANS, 1, spans, count, operands, frame);
}

/* By the processor alone, bit for bit: the model, which ignores the bits above each number. */
static void by_model(const span *spans, unsigned count, const uint32_t *operands, uint32_t *frame)
{
    for (const span *span = spans; span < spans + count; span++) {
        for (unsigned at = span->first; at < span->first + span->count; at++) {
            const lit_results results = lit_model((lit_operands){
                .nx = (int32_t)(operands[at] & 0x3ffu),
                .ny = (int32_t)(operands[at] >> 10 & 0x3ffu),
                .nz = (int32_t)(operands[at] >> 20 & 0x3ffu),
                .exponent = EXPONENT,
                .kr = albedo & 0xffu,
                .kg = albedo >> 8 & 0xffu,
                .kb = albedo >> 16,
            });
            frame[at] = results.pr_out | results.pg_out << 8 | results.pb_out << 16;
        }
    }
}

/* A number of 10 bits with its sign, from the bits above the place `low` of a word. */
static inline int32_t number_at(uint32_t word, unsigned low) { return (int32_t)(word << (22u - low)) >> 22; }

/* 1/sqrt(f) in u1.15, for f in u0.16 from 1/4 on: a straight line, and three steps of Newton's. */
static inline uint32_t reciprocal_root(uint32_t f)
{
    uint32_t y = 76000u - (f * 43000u >> 16);
    for (unsigned step = 0; step < 3; step++) {
        const uint32_t square = (uint32_t)((uint64_t)y * y >> 16);
        y = y * (49152u - (f * square >> 16)) >> 15;
        y = y > 0xffffu ? 0xffffu : y;
    }
    return y;
}

/* The cosine in u0.16 between a vector and a direction, from the dot product with the direction in units of 2^-15. The vector's square
 * was shifted by 2 * `half` bits, and `y` is 1/sqrt of the result. */
static inline uint32_t cosine(int32_t dot, unsigned half, uint32_t y)
{
    if (dot <= 0) {
        return 0;
    }
    const uint32_t value = ((uint32_t)dot << half >> 14) * y >> 15;
    return value > 0xffffu ? 0xffffu : value;
}

/* The core's result, up to one unit a colour, as fast as we could write it. */
static inline uint32_t colour(uint32_t normal, uint32_t exponent, uint32_t red, uint32_t green, uint32_t blue)
{
    const int32_t x = number_at(normal, 0), y = number_at(normal, 10), z = number_at(normal, 20);
    uint32_t square = (uint32_t)(x * x + y * y + z * z);
    if (square == 0) {
        square = 1;
    }
    unsigned half = 0;
    for (unsigned bits = 8; bits > 0; bits >>= 1) {
        if (square >> (30u - 2u * bits) == 0) {
            square <<= 2u * bits;
            half += bits;
        }
    }
    const uint32_t root = reciprocal_root(square >> 14);
    /* The unit vectors along (-0.6, 0.8, 0.9) and (-0.6, 0.8, 2.2454). */
    const uint32_t facing = cosine(-14614 * x + 19485 * y + 21921 * z, half, root);
    const uint32_t c = cosine(-7999 * x + 10665 * y + 29934 * z, half, root);
    const uint32_t share = 7864u + (facing * 49152u >> 16);
    const uint32_t product = (0x10000u - c) * exponent >> 4;
    uint32_t light = 0x8000u;
    if (product < 0x10000u) {
        uint32_t base = 0x10000u - product;
        base = base > 0xffffu ? 0xffffu : base;
        for (unsigned step = 0; step < 4; step++) {
            base = base * base >> 16;
        }
        light += 178u * base;
    }
    red = (red * share + light) >> 16;
    green = (green * share + light) >> 16;
    blue = (blue * share + light) >> 16;
    return (red > 255u ? 255u : red) | (green > 255u ? 255u : green) << 8 | (blue > 255u ? 255u : blue) << 16;
}

/* By the processor alone, by hand. */
static void by_hand(const span *spans, unsigned count, const uint32_t *operands, uint32_t *frame)
{
    /* The exponent and the colours are those of this picture, and not known to the compiler. */
    uint32_t exponent = EXPONENT, red = albedo & 0xffu, green = albedo >> 8 & 0xffu, blue = albedo >> 16;
    __asm__("" : "+r"(exponent), "+r"(red), "+r"(green), "+r"(blue));
    for (const span *span = spans; span < spans + count; span++) {
        for (unsigned at = span->first; at < span->first + span->count; at++) {
            frame[at] = colour(operands[at], exponent, red, green, blue);
        }
    }
}

const device lit = {1, 1, {by_spans, 0, by_hand, by_model}};
