/* Three functions of the unit `sfu`, in every way. */
#include "functions.h"

#include "sfu_instructions.h"
#include "sfu_model.h"
#include "system.h"

static uint32_t xs[VALUES], ys[VALUES];
static int32_t results[FUNCTION_WAYS][VALUES];

/* Computes the results of all values. */
typedef void function_way(int32_t *results);

static void rcp_by_instruction(int32_t *to)
{
    for (unsigned at = 0; at < VALUES; at++) {
        to[at] = (int32_t)sfu_rcp(xs[at]);
    }
}

static void rsqrt_by_instruction(int32_t *to)
{
    for (unsigned at = 0; at < VALUES; at++) {
        to[at] = (int32_t)sfu_rsqrt(xs[at]);
    }
}

static void atan2_by_instruction(int32_t *to)
{
    for (unsigned at = 0; at < VALUES; at++) {
        to[at] = sfu_atan2((int32_t)xs[at], (int32_t)ys[at]);
    }
}

/* 2^16 / x: the processor has a divider. */
static void rcp_by_hand(int32_t *to)
{
    for (unsigned at = 0; at < VALUES; at++) {
        to[at] = (int32_t)((0x10000u + xs[at] / 2u) / xs[at]);
    }
}

/* The root of 2^32 / x, bit by bit. */
static void rsqrt_by_hand(int32_t *to)
{
    for (unsigned at = 0; at < VALUES; at++) {
        uint32_t rest = 0xffffffffu / xs[at];
        uint32_t root = 0;
        for (uint32_t bit = 1u << 30; bit; bit >>= 2) {
            if (rest >= root + bit) {
                rest -= root + bit;
                root = root / 2u + bit;
            } else {
                root /= 2u;
            }
        }
        to[at] = (int32_t)root;
    }
}

/* CORDIC in 16 steps; the angles are parts of half a turn with 28 fraction bits. */
static void atan2_by_hand(int32_t *to)
{
    static const int32_t angles[16] = {67108864, 39616676, 20932363, 10625595, 5333416, 2669308, 1334980, 667531,
                                       333770, 166886, 83443, 41722, 20861, 10430, 5215, 2608};
    enum { HALF_TURN = 1 << 28 };
    for (unsigned at = 0; at < VALUES; at++) {
        int32_t x = (int32_t)xs[at] * 4096;
        int32_t y = (int32_t)ys[at] * 4096;
        int32_t angle = 0;
        if (x < 0) {
            angle = y < 0 ? -HALF_TURN : HALF_TURN;
            x = -x;
            y = -y;
        }
        for (unsigned step = 0; step < 16; step++) {
            const int32_t dx = x >> step;
            const int32_t dy = y >> step;
            if (y > 0) {
                x += dy;
                y -= dx;
                angle += angles[step];
            } else {
                x -= dy;
                y += dx;
                angle -= angles[step];
            }
        }
        to[at] = (angle + (1 << 12)) >> 13;
    }
}

/* The word r_out of the model, as the function's result has it. */
static int32_t modelled(uint32_t opcode, uint32_t a, uint32_t b)
{
    return (int32_t)sfu_model((sfu_operands){.opcode = opcode, .a = a, .b = b}).r_out;
}

static void rcp_by_model(int32_t *to)
{
    for (unsigned at = 0; at < VALUES; at++) {
        to[at] = modelled(SFU_FUNCTION_RCP, xs[at], 0);
    }
}

static void rsqrt_by_model(int32_t *to)
{
    for (unsigned at = 0; at < VALUES; at++) {
        to[at] = modelled(SFU_FUNCTION_RSQRT, xs[at], 0);
    }
}

static void atan2_by_model(int32_t *to)
{
    enum { SHIFT = 32 - SFU_R_OUT_WIDTH };
    for (unsigned at = 0; at < VALUES; at++) {
        const uint32_t word = (uint32_t)modelled(SFU_FUNCTION_ATAN2, xs[at], ys[at]);
        to[at] = (int32_t)(word << SHIFT) >> SHIFT;
    }
}

static function_way *const ways[FUNCTIONS][FUNCTION_WAYS] = {
    {rcp_by_instruction, rcp_by_hand, rcp_by_model},
    {rsqrt_by_instruction, rsqrt_by_hand, rsqrt_by_model},
    {atan2_by_instruction, atan2_by_hand, atan2_by_model},
};

/* Operands that look random: of atan2 with signs, and otherwise above 0. */
static void draw(unsigned function)
{
    static uint32_t state = 1;
    for (unsigned at = 0; at < VALUES; at++) {
        state = state * 1664525u + 1013904223u;
        const uint32_t x = state >> 16;
        state = state * 1664525u + 1013904223u;
        const uint32_t y = state >> 16;
        const int has_sign = function == FUNCTIONS - 1;
        xs[at] = has_sign ? (uint32_t)(int16_t)(x | 1u) : x | 1u;
        ys[at] = (uint32_t)(int16_t)y;
    }
}

/* Whether two results differ by at most two units of the last place. The angles half a turn and minus half a turn are the same. */
static int near(int32_t result, int32_t other, int is_angle)
{
    int32_t apart = result < other ? other - result : result - other;
    if (is_angle && apart > 1 << 15) {
        apart = (1 << 16) - apart;
    }
    return apart <= 2;
}

int compute_functions(uint32_t spent[FUNCTIONS][FUNCTION_WAYS])
{
    for (unsigned function = 0; function < FUNCTIONS; function++) {
        draw(function);
        for (unsigned way = 0; way < FUNCTION_WAYS; way++) {
            const uint32_t start = clocks();
            ways[function][way](results[way]);
            spent[function][way] = clocks() - start;
        }
        for (unsigned at = 0; at < VALUES; at++) {
            const int32_t result = results[0][at];
            if (result != results[2][at] || !near(result, results[1][at], function == FUNCTIONS - 1)) {
                return 0;
            }
        }
    }
    return 1;
}
