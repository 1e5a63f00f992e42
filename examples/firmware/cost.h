/* cost.h - what a call takes on a microcontroller: instructions and stack. SPDX-License-Identifier: MIT */
#ifndef COST_H
#define COST_H

#include "board.h"

/* Under QEMU as run here an instruction takes 16 ns. */
#define COST_INSTRUCTIONS(ticks) ((uint32_t)((uint64_t)(ticks) * BOARD_TICK_PS / 16000))

#ifdef __riscv
#define COST_STACK_POINTER(sp) __asm__ volatile("mv %0, sp" : "=r"(sp))
#else
#define COST_STACK_POINTER(sp) __asm__ volatile("mov %0, sp" : "=r"(sp))
#endif

/* Paints what lies below the stack pointer, or with look tells how much of that paint is gone. */
static __attribute__((noinline, unused)) uint32_t cost_stack(int look) {
    enum { PAINT = 0xa5, PAINTED = 6000 };
    volatile unsigned char *sp;
    uint32_t depth = PAINTED;
    COST_STACK_POINTER(sp);
    for (int i = 256; i <= PAINTED && !look; i++) sp[-i] = PAINT;
    while (depth > 256 && look && sp[-(int)depth] == PAINT) depth--;
    return depth;
}

static inline uint32_t cost_since(uint32_t *start) {
    const uint32_t now = board_now(), ticks = (now - *start) & BOARD_TICK_MASK;
    *start = now;
    return ticks;
}

#endif
