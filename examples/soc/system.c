#include "system.h"

/* What the compiler may ask for. */
void *memset(void *to, int byte, size_t count)
{
    for (unsigned char *at = to; count--; at++) {
        *at = (unsigned char)byte;
    }
    return to;
}

void *memcpy(void *restrict to, const void *restrict from, size_t count)
{
    unsigned char *into = to;
    for (const unsigned char *at = from; count--; at++) {
        *into++ = *at;
    }
    return to;
}
