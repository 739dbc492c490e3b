/* A ball as `glint render` sees it with the options that `run` gives, all but its highlight. */
#ifndef BALL_H
#define BALL_H

#include <stdint.h>

enum { WIDTH = 48, HEIGHT = 48 };

/* The share of the light that becomes highlights. */
#define SPECULAR 0.7

typedef struct {
    double x, y, z;
} vector;

/* A pixel before its highlight: the operand, the light without it (0 ... 255), and whether there is a highlight. */
typedef struct {
    uint32_t cos_gamma; /* u1.20 */
    uint32_t lit;
    double base[3];
} pixel;

/* The square root as IEEE 754 rounds it. */
double root(double value);

/* The vector of length 1. */
vector unit(vector v);

/* The pixel in this column and row, in light from this direction. */
pixel geometry(unsigned column, unsigned row, vector light);

#endif
