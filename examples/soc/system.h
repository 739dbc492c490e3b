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
#define LIT_SPANS ((span_engine *)0x60000000u)

/* Has an engine shade a span, when it is through with the one before. */
static inline void begin_span(span_engine *engine, unsigned words, const span *span, const uint32_t *operands,
                              uint32_t *frame)
{
    engine->source = (uint32_t)(uintptr_t)&operands[words * span->first];
    engine->destination = (uint32_t)(uintptr_t)&frame[span->first];
    engine->count = span->count;
}

/* Waits until an engine is through. */
static inline void end_spans(span_engine *engine) { (void)engine->count; }

/* Has an engine shade these spans. */
static inline void run_spans(span_engine *engine, unsigned words, const span *spans, unsigned count,
                             const uint32_t *operands, uint32_t *frame)
{
    for (const span *at = spans; at < spans + count; at++) {
        begin_span(engine, words, at, operands, frame);
    }
    end_spans(engine);
}

/* The three pictures, one a device. */
enum picture { SHADE_PICTURE = 0, GRAIN_PICTURE = 3, LIT_PICTURE = 4 };

/* A byte of a picture. */
static inline void show(enum picture picture, uint32_t byte)
{
    ((volatile uint32_t *)0x20000000u)[picture] = byte;
}

/* A number that is printed. */
static inline void number(uint32_t value) { ((volatile uint32_t *)0x20000000u)[1] = value; }

/* There is no string.h. */
void *memcpy(void *restrict to, const void *restrict from, size_t count);

static inline uint32_t clocks(void)
{
    uint32_t now;
    __asm__ volatile("rdcycle %0" : "=r"(now) : : "memory");
    return now;
}

#endif
