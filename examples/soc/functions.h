/* The functions of the unit `sfu`: each by an instruction of the processor, by C by hand, and by the model in C. */
#ifndef FUNCTIONS_H
#define FUNCTIONS_H

#include <stdint.h>

enum { FUNCTIONS = 3, FUNCTION_WAYS = 3, VALUES = 100 };

/* Computes VALUES values of each function in every way. Fills the clocks of each way, and returns 0 if an instruction and the model
 * disagree, or if C by hand differs from them by more than two units of the last place. */
int compute_functions(uint32_t clocks[FUNCTIONS][FUNCTION_WAYS]);

#endif
