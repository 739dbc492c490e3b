# The first instruction; the processor sets the stack pointer.
    .section .text.start
    .globl _start
_start:
    call main
    li t0, 0x20000000
    sw a0, 8(t0)
1:  j 1b
