/* Highlights by cosine-power in every way. */
#include "ways.h"

#include "shade_model.h"
#include "shade_registers.h"
#include "system.h"

static uint32_t full; /* of red, green and blue, as the light is white */

int shade_begin(double specular)
{
    volatile uint32_t *const core = SHADE_CORE;
    full = shade_red_from(specular * 255.0);
    shade_write(core, SHADE_REG_EXPONENT, EXPONENT);
    shade_write(core, SHADE_REG_RED, full);
    shade_write(core, SHADE_REG_GREEN, full);
    shade_write(core, SHADE_REG_BLUE, full);
    shade_write(core, SHADE_REG_CONTROL,
                SHADE_CONTROL_START_ON_WRITE_MASK |
                    SHADE_REG_COS_GAMMA / 4u << SHADE_CONTROL_START_WORD_SHIFT);
    SHADE_SPANS->exponent = EXPONENT;
    SHADE_SPANS->colour = full | full << 8 | full << 16;
    return shade_read(core, SHADE_REG_ID) == SHADE_ID &&
           shade_read(core, SHADE_REG_CONFIGURATION) == SHADE_CONFIGURATION;
}

static void by_spans(const span *spans, unsigned count, const uint32_t *operands, uint32_t *frame)
{
    run_spans(SHADE_SPANS, 1, spans, count, operands, frame);
}

/* By the core behind registers: a store starts a point, a load waits for it. While one is computed, the one before goes to memory
 * and the next comes from there. */
static void by_registers(const span *spans, unsigned count, const uint32_t *operands, uint32_t *frame)
{
    volatile uint32_t *const operand = SHADE_CORE + SHADE_REG_COS_GAMMA / 4u;
    const volatile uint32_t *const results = SHADE_CORE + SHADE_REG_RESULTS / 4u;
    for (const span *span = spans; span < spans + count; span++) {
        const uint32_t *const from = operands + span->first;
        uint32_t *const to = frame + span->first;
        *operand = from[0];
#pragma GCC unroll 4
        for (unsigned at = 1; at < span->count; at++) {
            const uint32_t next = from[at];
            const uint32_t result = *results;
            *operand = next;
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
            const shade_results results =
                shade_model((shade_operands){operands[at], EXPONENT, full, full, full});
            frame[at] = results.red_out | results.green_out << 8 | results.blue_out << 16;
        }
    }
}

/* The smallest (1 - cos gamma) * n, u10.20, at which every colour of 8 bits comes out as 0: f, u0.16, is 128 or less, so that
 * f * 255 rounds to 0. The formula itself is 0 only from 16 on. */
#define DARK (21137u << 8)

/* The core's result, as fast as we could write it, for every operand that the core takes. */
static inline uint32_t highlight(uint32_t cosine, uint32_t exponent, uint32_t red, uint32_t green, uint32_t blue)
{
    if (cosine - 1u >= ONE) { /* out of (0, 1] */
        if (cosine == 0) {
            return 0;
        }
        cosine = ONE;
    }
    const uint32_t product = (ONE - cosine) * exponent;
    if (product >= DARK) {
        return 0;
    }
    uint32_t base = (product >> 8) ^ 0xffffu;
    base = base * base >> 16;
    base = base * base >> 16;
    base = base * base >> 16;
    base = base * base >> 16;
    return (base * red + 0x8000u) >> 16 | ((base * green + 0x8000u) >> 16) << 8 |
           ((base * blue + 0x8000u) >> 16) << 16;
}

/* By the processor alone, by hand. */
static void by_hand(const span *spans, unsigned count, const uint32_t *operands, uint32_t *frame)
{
    /* The exponent and the colours are those of this picture, and not known to the compiler. */
    uint32_t exponent = EXPONENT, red = full, green = full, blue = full;
    __asm__("" : "+r"(exponent), "+r"(red), "+r"(green), "+r"(blue));
    for (const span *span = spans; span < spans + count; span++) {
        for (unsigned at = span->first; at < span->first + span->count; at++) {
            frame[at] = highlight(operands[at], exponent, red, green, blue);
        }
    }
}

const device shade = {1, 0, {by_spans, by_registers, by_hand, by_model}};
