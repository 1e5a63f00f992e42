/* board.h - what the examples need of a board: a fixed period. SPDX-License-Identifier: MIT */
#ifndef BOARD_H
#define BOARD_H

#include <stdint.h>

/* The board's timer: SysTick on Arm, which counts 24 bits; mtime on RISC-V (QEMU's virt: 10 MHz). */
#ifdef __riscv
#define BOARD_TICK_PS 100000 /* picoseconds per tick; of an Arm board, the cross file says it */
#define BOARD_TICK_MASK 0xffffffffu
#else
#define BOARD_TICK_MASK 0xffffffu
#endif
#define BOARD_TICKS(microseconds) ((uint32_t)((microseconds) * 1000000ull / BOARD_TICK_PS))

void board_start(void);   /* starts the timer */
uint32_t board_now(void); /* counts ticks up, modulo BOARD_TICK_MASK + 1 */

/* Waits until `period` ticks after *start and moves *start there. Returns 0 if that was already over; a
   period must be below half of what the timer counts. */
int board_wait(uint32_t *start, uint32_t period);

#endif
