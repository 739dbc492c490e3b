/* A cushion, x^4 + y^4 + z^2 = 1, as cushion.py draws it: parallel rays, and normals that are not normalised. */
#include "cushion.h"

#include "ball.h"

int cushion(unsigned column, unsigned row, uint32_t *normal)
{
    const double x = ((2.0 * column + 1.0) / WIDTH - 1.0) * CUSHION_HALF;
    const double y = (1.0 - (2.0 * row + 1.0) / HEIGHT) * CUSHION_HALF;
    const double above = 1.0 - x * x * x * x - y * y * y * y;
    if (above < 0.0) {
        return 0;
    }
    /* Half of the gradient. */
    *normal = lit_normal(2.0 * (x * x * x), 2.0 * (y * y * y), root(above));
    return 1;
}
