/* board.c - see board.h; start-up code and linker script are picolibc's. SPDX-License-Identifier: MIT */
#include "board.h"

#define REGISTER(address) (*(volatile uint32_t *)(address))

#ifdef __riscv
void board_start(void) {}

uint32_t board_now(void) { return REGISTER(0x0200bff8); /* low half of the CLINT's mtime */ }
#else
enum { ENABLE = 1, PROCESSOR_CLOCK = 4 };

void board_start(void) {
    REGISTER(0xe000e014) = BOARD_TICK_MASK; /* SYST_RVR: reload */
    REGISTER(0xe000e018) = 0;               /* SYST_CVR: any write clears the count */
    REGISTER(0xe000e010) = ENABLE | PROCESSOR_CLOCK;
}

uint32_t board_now(void) { return BOARD_TICK_MASK - REGISTER(0xe000e018); /* which counts down */ }
#endif

int board_wait(uint32_t *start, uint32_t period) {
    const uint32_t half = BOARD_TICK_MASK / 2 + 1, end = *start + period;
    const int in_time = ((board_now() - end) & BOARD_TICK_MASK) >= half;
    while (((board_now() - end) & BOARD_TICK_MASK) >= half)
        for (int i = 0; i < 30; i++) __asm__ volatile(""); /* what takes an emulator time is the bus */
    *start = end;
    return in_time;
}
