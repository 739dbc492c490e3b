/* Sets up the lines of the file `lines`, one a row, by the C of NAME, and writes their operands into `in_c`. */
#include <stdio.h>
#include "NAME_setup.h"
int main(void) {
    FILE *in = fopen("lines", "r");
    if (freopen("in_c", "w", stdout) == NULL) return 1;
    double v[12], intensity, exponent, points;
    for (;;) {
        for (int at = 0; at < 12; ++at)
            if (fscanf(in, "%lf", &v[at]) != 1) return fclose(in);
        if (fscanf(in, "%lf %lf %lf", &intensity, &exponent, &points) != 3) return 1;
        NAME_line line = {intensity, (uint32_t)exponent, (uint32_t)points};
        NAME_operands of;
        if (NAME_setup(v, v + 3, v + 6, v + 9, line, &of) != 0) {
            puts("refused");
            continue;
        }
        printf("amplitude %ld delta_zeta %ld ", (long)of.amplitude, (long)of.delta_zeta);
#ifdef QUAD_COSINE_EXPONENT_WIDTH
        printf("exponent %ld ", (long)of.exponent);
#endif
        printf("length %ld zeta_start %ld\n", (long)of.length, (long)of.zeta_start);
    }
}
