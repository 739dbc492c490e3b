/* The ways to colours: a pipeline that a span engine feeds, a core behind registers, its model in C, and C by hand. All have to
 * agree. */
#ifndef WAYS_H
#define WAYS_H

#include <stdint.h>

/* The specular exponent n of everything. */
enum { EXPONENT = 80 };

/* Pixels side by side in a row that are in the light: the first, as an index of the frame buffer, and how many. */
typedef struct {
    unsigned first, count;
} span;

/* From the operands of so many spans to the frame buffer, both indexed by pixels: colours have red, green and blue in their lowest
 * bytes. */
typedef void shader(const span *spans, unsigned count, const uint32_t *operands, uint32_t *frame);

enum way { BY_SPANS, BY_REGISTERS, BY_HAND, BY_MODEL, WAYS };

typedef struct {
    unsigned words;     /* of operands a pixel */
    unsigned tolerance; /* the largest difference of C by hand, in units of a colour; the other ways are equal */
    shader *ways[WAYS]; /* 0 for a way that the device does not have */
} device;

/* cosine-power: a word a pixel, cos gamma in u1.20. */
extern const device shade;

/* rough: cos gamma, then cos dgamma in u1.20, whose highest bit says that dgamma is negative. */
extern const device grain;
#define ONE 0x100000u
#define NEGATIVE 0x80000000u

/* lit, of which there is only a pipeline: a word a pixel, the three numbers of a normal of any length, 10 bits each. */
extern const device lit;

/* Sets the colours of the surface for lit. */
void lit_begin(uint32_t red, uint32_t green, uint32_t blue);

/* The operand of lit for a normal. */
uint32_t lit_normal(double x, double y, double z);

/* Sets a device up. Whether it is there, with the configuration of its header. */
int shade_begin(double specular);
int grain_begin(double specular);

#endif
