/* The ways to highlights: a core, its model in C, and C by hand. All have to agree. */
#ifndef WAYS_H
#define WAYS_H

#include <stdint.h>

/* The specular exponent n of everything. */
enum { EXPONENT = 80 };

/* What changes from point to point. Cosines are u1.20; cosine-power takes the first alone. */
typedef struct {
    uint32_t cos_gamma, cos_dgamma, dgamma_negative;
} point;

/* The colours of highlights: red, green and blue in the lowest bytes of a word. */
typedef struct {
    uint32_t limit; /* of (1 - cos gamma) * n, u11.20: from there on a smooth surface has no highlight */
    void (*core)(const point *points, uint32_t *colours, unsigned count);
    void (*model)(const point *points, uint32_t *colours, unsigned count);
    void (*hand)(const point *points, uint32_t *colours, unsigned count);
} ways;

/* `smooth_ways` is `grain_ways` where dgamma is 0: the core keeps an operand that does not change. */
extern const ways shade_ways, grain_ways, smooth_ways;

/* Sets a core up. Whether it is there, with the configuration of its header. */
int shade_begin(double specular);
int grain_begin(double specular);

#endif
