/* Highlights of a rough surface by `rough` in every way. */
#include "ways.h"

#include "grain_model.h"
#include "grain_registers.h"
#include "sine.h"
#include "system.h"

static uint32_t full; /* of red, green and blue, as the light is white */

int grain_begin(double specular)
{
    volatile uint32_t *const core = GRAIN_CORE;
    full = grain_red_from(specular * 255.0);
    grain_write(core, GRAIN_REG_EXPONENT, EXPONENT);
    grain_write(core, GRAIN_REG_RED, full);
    grain_write(core, GRAIN_REG_GREEN, full);
    grain_write(core, GRAIN_REG_BLUE, full);
    grain_write(core, GRAIN_REG_CONTROL,
                GRAIN_CONTROL_START_ON_WRITE_MASK |
                    GRAIN_REG_COS_GAMMA / 4u << GRAIN_CONTROL_START_WORD_SHIFT);
    GRAIN_SPANS->exponent = EXPONENT;
    GRAIN_SPANS->colour = full | full << 8 | full << 16;
    return grain_read(core, GRAIN_REG_ID) == GRAIN_ID &&
           grain_read(core, GRAIN_REG_CONFIGURATION) == GRAIN_CONFIGURATION;
}

static void by_spans(const span *spans, unsigned count, const uint32_t *operands, uint32_t *frame)
{
    run_spans(GRAIN_SPANS, 2, spans, count, operands, frame);
}

/* By the core behind registers: the operands of the next point are written while one is computed, and the last of them starts it.
 * The core keeps dgamma where it does not change. */
static void by_registers(const span *spans, unsigned count, const uint32_t *operands, uint32_t *frame)
{
    volatile uint32_t *const cos_gamma = GRAIN_CORE + GRAIN_REG_COS_GAMMA / 4u;
    volatile uint32_t *const cos_dgamma = GRAIN_CORE + GRAIN_REG_COS_DGAMMA / 4u;
    volatile uint32_t *const dgamma_negative = GRAIN_CORE + GRAIN_REG_DGAMMA_NEGATIVE / 4u;
    const volatile uint32_t *const results = GRAIN_CORE + GRAIN_REG_RESULTS / 4u;
    for (const span *span = spans; span < spans + count; span++) {
        const uint32_t *const from = operands + 2 * span->first;
        uint32_t *const to = frame + span->first;
        uint32_t before = from[1];
        *cos_dgamma = before & ~NEGATIVE;
        *dgamma_negative = before >> 31;
        *cos_gamma = from[0];
#pragma GCC unroll 4
        for (unsigned at = 1; at < span->count; at++) {
            const uint32_t next = from[2 * at], dgamma = from[2 * at + 1];
            if (dgamma != before) {
                *cos_dgamma = dgamma & ~NEGATIVE;
                *dgamma_negative = dgamma >> 31;
                before = dgamma;
            }
            const uint32_t result = *results;
            *cos_gamma = next;
            to[at - 1] = result;
        }
        to[span->count - 1] = *results;
    }
}

/* By the processor alone, bit for bit: the model. */
static void by_model(const span *spans, unsigned count, const uint32_t *operands, uint32_t *frame)
{
    for (const span *span = spans; span < spans + count; span++) {
        for (unsigned at = span->first; at < span->first + span->count; at++) {
            const grain_results results = grain_model((grain_operands){
                .cos_gamma = operands[2 * at],
                .cos_dgamma = operands[2 * at + 1] & ~NEGATIVE,
                .exponent = EXPONENT,
                .dgamma_negative = operands[2 * at + 1] >> 31,
                .red = full,
                .green = full,
                .blue = full,
            });
            frame[at] = results.red_out | results.green_out << 8 | results.blue_out << 16;
        }
    }
}

/* The sine, u0.22, for a cosine in u1.20: by the core's table, whose segments become finer toward cosine 1.0. */
static inline uint32_t sine(uint32_t cosine)
{
    const uint32_t x = 0x100000u - cosine;
    uint32_t word, rest;
    if (x >> 16) {
        word = x >> 18 ? 384u + (x >> 14 & 63u) : x >> 10;
        rest = x >> 18 ? x & 0x3fffu : (x & 0x3ffu) << 4;
    } else if (x >> 12) {
        word = x >> 14 ? 256u + (x >> 9) : 448u + (x >> 8 & 63u);
        rest = x >> 14 ? (x & 0x1ffu) << 5 : (x & 0xffu) << 6;
    } else if (x >> 8) {
        word = x >> 10 ? 512u + (x >> 7) : 544u + (x >> 6);
        rest = x >> 10 ? (x & 0x7fu) << 7 : (x & 0x3fu) << 8;
    } else if (x >> 4) {
        word = x >> 6 ? 560u + (x >> 5) : 568u + (x >> 3);
        rest = x >> 6 ? (x & 0x1fu) << 9 : (x & 7u) << 11;
    } else {
        word = x >> 2 ? 576u + (x >> 2) : 580u + x;
        rest = x >> 2 ? (x & 3u) << 12 : 0;
    }
    const uint32_t value = sine_table[word].start + (sine_table[word].slope * rest >> 10);
    return value >> 22 ? 0x3fffffu : value;
}

/* The largest n/2 * (1 - cos(gamma +- dgamma)), u.23, with any colour of 8 bits that is not 0: above it f, u0.16, is 128 or less,
 * so that f * 255 rounds to 0. The formula itself is 0 only from 1 on. */
#define LIT (62628u << 7)

/* The core's result, as fast as we could write it, for every operand that the core takes. */
static inline uint32_t highlight(uint32_t cosine, uint32_t dgamma, uint32_t exponent, uint32_t red, uint32_t green,
                                 uint32_t blue)
{
    if (cosine - 1u >= ONE) { /* out of (0, 1] */
        if (cosine == 0) {
            return 0;
        }
        cosine = ONE;
    }
    const uint32_t other = dgamma & ~NEGATIVE;
    uint32_t product;
    if (other >= ONE) { /* smooth, and no product of sines */
        product = ((ONE - cosine) << 2) * exponent;
    } else {
        const int32_t sines = (int32_t)((uint64_t)(sine(cosine) << 10) * sine(other) >> 32);
        const int32_t cosines = (int32_t)((uint64_t)(cosine << 11) * (other << 3) >> 32);
        const int32_t drop = 0x400000 - (dgamma & NEGATIVE ? cosines + sines : cosines - sines);
        if (drop >= 0x400000 && exponent > 1) { /* above 90 degrees; there the product can have 33 bits */
            return 0;
        }
        product = drop > 0 ? (uint32_t)drop * exponent : 0;
    }
    if (product > LIT) {
        return 0;
    }
    const uint32_t base = 0x10000u - ((product + 127u) >> 7);
    const uint32_t f = product == 0 ? 0xffffu : base * base >> 16;
    return (f * red + 0x8000u) >> 16 | ((f * green + 0x8000u) >> 16) << 8 | ((f * blue + 0x8000u) >> 16) << 16;
}

/* By the processor alone, by hand. */
static void by_hand(const span *spans, unsigned count, const uint32_t *operands, uint32_t *frame)
{
    /* The exponent and the colours are those of this picture, and not known to the compiler. */
    uint32_t exponent = EXPONENT, red = full, green = full, blue = full;
    __asm__("" : "+r"(exponent), "+r"(red), "+r"(green), "+r"(blue));
    for (const span *span = spans; span < spans + count; span++) {
        for (unsigned at = span->first; at < span->first + span->count; at++) {
            frame[at] = highlight(operands[2 * at], operands[2 * at + 1], exponent, red, green, blue);
        }
    }
}

const device grain = {2, 0, {by_spans, by_registers, by_hand, by_model}};
