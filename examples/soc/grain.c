/* Highlights of a rough surface by `rough`: by the core, by its model in C, and by C that was written by hand. */
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
    return grain_read(core, GRAIN_REG_ID) == GRAIN_ID &&
           grain_read(core, GRAIN_REG_CONFIGURATION) == GRAIN_CONFIGURATION;
}

/* By the core: the operands of the next point are written while one is computed, and the last of them starts it. */
static void by_core(const point *points, uint32_t *colours, unsigned count)
{
    volatile uint32_t *const cos_gamma = GRAIN_CORE + GRAIN_REG_COS_GAMMA / 4u;
    volatile uint32_t *const cos_dgamma = GRAIN_CORE + GRAIN_REG_COS_DGAMMA / 4u;
    volatile uint32_t *const dgamma_negative = GRAIN_CORE + GRAIN_REG_DGAMMA_NEGATIVE / 4u;
    const volatile uint32_t *const results = GRAIN_CORE + GRAIN_REG_RESULTS / 4u;
    *cos_dgamma = points[0].cos_dgamma;
    *dgamma_negative = points[0].dgamma_negative;
    *cos_gamma = points[0].cos_gamma;
#pragma GCC unroll 16
    for (unsigned at = 1; at < count; at++) {
        *cos_dgamma = points[at].cos_dgamma;
        *dgamma_negative = points[at].dgamma_negative;
        const uint32_t next = points[at].cos_gamma;
        const uint32_t result = *results;
        *cos_gamma = next;
        colours[at - 1] = result;
    }
    colours[count - 1] = *results;
}

/* The same where dgamma is 0: the core keeps an operand that does not change. */
static void by_core_smooth(const point *points, uint32_t *colours, unsigned count)
{
    volatile uint32_t *const cos_gamma = GRAIN_CORE + GRAIN_REG_COS_GAMMA / 4u;
    const volatile uint32_t *const results = GRAIN_CORE + GRAIN_REG_RESULTS / 4u;
    grain_write(GRAIN_CORE, GRAIN_REG_COS_DGAMMA, 0x100000u);
    *cos_gamma = points[0].cos_gamma;
#pragma GCC unroll 16
    for (unsigned at = 1; at < count; at++) {
        const uint32_t next = points[at].cos_gamma;
        const uint32_t result = *results;
        *cos_gamma = next;
        colours[at - 1] = result;
    }
    colours[count - 1] = *results;
}

/* By the processor alone, bit for bit: the model. */
static void by_model(const point *points, uint32_t *colours, unsigned count)
{
    for (unsigned at = 0; at < count; at++) {
        const grain_operands operands = {
            .cos_gamma = points[at].cos_gamma,
            .cos_dgamma = points[at].cos_dgamma,
            .exponent = EXPONENT,
            .dgamma_negative = points[at].dgamma_negative,
            .red = full,
            .green = full,
            .blue = full,
        };
        const grain_results results = grain_model(operands);
        colours[at] = results.red_out | results.green_out << 8 | results.blue_out << 16;
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

/* And the fastest that we could write, for every operand that the core takes. */
static void by_hand(const point *points, uint32_t *colours, unsigned count)
{
    /* The exponent and the colours are those of this picture, and not known to the compiler. */
    uint32_t exponent = EXPONENT, red = full, green = full, blue = full;
    __asm__("" : "+r"(exponent), "+r"(red), "+r"(green), "+r"(blue));
    for (unsigned at = 0; at < count; at++) {
        const uint32_t one = 0x100000u;
        const uint32_t cosine = points[at].cos_gamma > one ? one : points[at].cos_gamma;
        const uint32_t other = points[at].cos_dgamma > one ? one : points[at].cos_dgamma;
        /* cos(gamma +- dgamma) - 1, s1.22; where the surface is smooth, there is no product of sines. */
        int32_t fall;
        if (other == one) {
            fall = (int32_t)(cosine << 2) - 0x400000;
        } else {
            const int32_t sines = (int32_t)((uint64_t)sine(cosine) * sine(other) >> 22);
            const int32_t cosines = (int32_t)((uint64_t)cosine * other >> 18);
            fall = (points[at].dgamma_negative ? cosines + sines : cosines - sines) - 0x400000;
        }
        const int64_t scaled = (int64_t)fall * (int32_t)exponent >> 7;
        uint32_t f = 0;
        if (cosine != 0 && scaled > -0x10000) {
            const uint32_t base = (uint32_t)(int32_t)scaled + 0x10000u;
            f = scaled >= 0 ? 0xffffu : base * base >> 16;
        }
        colours[at] = (f * red + 0x8000u) >> 16 | ((f * green + 0x8000u) >> 16) << 8 |
                      ((f * blue + 0x8000u) >> 16) << 16;
    }
}

/* (n/2 * (cos(gamma +- dgamma) - 1) + 1)^2 */
const ways grain_ways = {2u << 20, by_core, by_model, by_hand};
const ways smooth_ways = {2u << 20, by_core_smooth, by_model, by_hand};
