/* What the program sees of the system, soc.v. */
#ifndef SYSTEM_H
#define SYSTEM_H

#include <stddef.h>
#include <stdint.h>

/* The registers of the cores. */
#define SHADE_CORE ((volatile uint32_t *)0x10000000u)
#define GRAIN_CORE ((volatile uint32_t *)0x30000000u)

/* The two pictures, one a core. */
enum picture { SHADE_PICTURE = 0, GRAIN_PICTURE = 3 };

/* A byte of a picture. */
static inline void show(enum picture picture, uint32_t byte)
{
    ((volatile uint32_t *)0x20000000u)[picture] = byte;
}

/* A number that is printed. */
static inline void number(uint32_t value) { ((volatile uint32_t *)0x20000000u)[1] = value; }

static inline uint32_t clocks(void)
{
    uint32_t now;
    __asm__ volatile("rdcycle %0" : "=r"(now));
    return now;
}

#endif
