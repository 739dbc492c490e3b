#include "cosine_power_registers.h"
int main(void)
{
    const uint32_t seen[] = {
        cosine_power_cos_gamma_from_fixed(INT64_C(1) << 30, 30),
        cosine_power_cos_gamma_from_fixed(3, 21),
        cosine_power_cos_gamma_from_fixed(5, 22),
        cosine_power_cos_gamma_from_fixed(-1, 2),
        cosine_power_cos_gamma_from_fixed(INT64_MAX, 0),
        cosine_power_exponent_from_fixed(INT64_C(1023) << 20, 20),
        cosine_power_exponent_from_fixed(INT64_C(1024) << 20, 20),
    };
    const uint32_t wanted[] = {1u << 20, 2, 1, 0, 0x1fffff, 1023, 1023};
    for (unsigned at = 0; at < sizeof seen / sizeof *seen; at++) {
        if (seen[at] != wanted[at]) {
            return (int)at + 1;
        }
    }
    return COSINE_POWER_REG_RESULTS == 0x34u && COSINE_POWER_RESULTS_BLUE_OUT_SHIFT == 16 ? 0 : 99;
}
