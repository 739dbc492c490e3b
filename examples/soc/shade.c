/* Highlights by cosine-power: by the core, by its model in C, and by C that was written by hand. */
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
    return shade_read(core, SHADE_REG_ID) == SHADE_ID &&
           shade_read(core, SHADE_REG_CONFIGURATION) == SHADE_CONFIGURATION;
}

/* By the core: a store starts a point, a load waits for it. While one is computed, the one before goes to memory and the
 * next comes from there. */
static void by_core(const point *points, uint32_t *colours, unsigned count)
{
    volatile uint32_t *const operand = SHADE_CORE + SHADE_REG_COS_GAMMA / 4u;
    const volatile uint32_t *const results = SHADE_CORE + SHADE_REG_RESULTS / 4u;
    *operand = points[0].cos_gamma;
#pragma GCC unroll 16
    for (unsigned at = 1; at < count; at++) {
        const uint32_t next = points[at].cos_gamma;
        const uint32_t result = *results;
        *operand = next;
        colours[at - 1] = result;
    }
    colours[count - 1] = *results;
}

/* By the processor alone, bit for bit: the model. */
static void by_model(const point *points, uint32_t *colours, unsigned count)
{
    for (unsigned at = 0; at < count; at++) {
        const shade_operands operands = {points[at].cos_gamma, EXPONENT, full, full, full};
        const shade_results results = shade_model(operands);
        colours[at] = results.red_out | results.green_out << 8 | results.blue_out << 16;
    }
}

/* And the fastest that we could write: W(n, gamma) for every operand that the core takes, in 32 bits. */
static void by_hand(const point *points, uint32_t *colours, unsigned count)
{
    /* The exponent and the colours are those of this picture, and not known to the compiler. */
    uint32_t exponent = EXPONENT, red = full, green = full, blue = full;
    __asm__("" : "+r"(exponent), "+r"(red), "+r"(green), "+r"(blue));
    for (unsigned at = 0; at < count; at++) {
        /* As the core: a cosine above 1.0 is 1.0. */
        const uint32_t given = points[at].cos_gamma;
        const uint32_t cosine = given > 0x100000u ? 0x100000u : given;
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

/* (n/16 * (cos gamma - 1) + 1)^16 */
const ways shade_ways = {16u << 20, by_core, by_model, by_hand};
