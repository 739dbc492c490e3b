/* What the program sees of the system, soc.v. */
#ifndef SYSTEM_H
#define SYSTEM_H

#include <stddef.h>
#include <stdint.h>

#include "ways.h"

/* The registers of the cores. */
#define SHADE_CORE ((volatile uint32_t *)0x10000000u)
#define GRAIN_CORE ((volatile uint32_t *)0x30000000u)

/* A span engine, span.v. */
typedef volatile struct {
    uint32_t source, destination, count, exponent, colour;
} span_engine;
#define SHADE_SPANS ((span_engine *)0x40000000u)
#define GRAIN_SPANS ((span_engine *)0x50000000u)

/* Has an engine shade these spans. A span waits for the one before in hardware, and the last read for the last of them. */
static inline void run_spans(span_engine *engine, unsigned words, const span *spans, unsigned count,
                             const uint32_t *operands, uint32_t *frame)
{
    for (const span *at = spans; at < spans + count; at++) {
        engine->source = (uint32_t)(uintptr_t)&operands[words * at->first];
        engine->destination = (uint32_t)(uintptr_t)&frame[at->first];
        engine->count = at->count;
    }
    (void)engine->count;
}

/* The two pictures, one a device. */
enum picture { SHADE_PICTURE = 0, GRAIN_PICTURE = 3 };

/* A byte of a picture. */
static inline void show(enum picture picture, uint32_t byte)
{
    ((volatile uint32_t *)0x20000000u)[picture] = byte;
}

/* A number that is printed. */
static inline void number(uint32_t value) { ((volatile uint32_t *)0x20000000u)[1] = value; }

static inline uint32_t clocks(void)
{
    uint32_t now;
    __asm__ volatile("rdcycle %0" : "=r"(now) : : "memory");
    return now;
}

#endif
