/* A cushion that `lit` shades. */
#ifndef CUSHION_H
#define CUSHION_H

#include "ways.h"

/* Half of the picture's width and height. */
#define CUSHION_HALF 1.1

/* Whether the pixel in this column and row shows the cushion. Then `normal` gets the operand of `lit`. */
int cushion(unsigned column, unsigned row, uint32_t *normal);

#endif
