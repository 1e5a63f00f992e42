#ifndef RBDI_DERIVATIVES_SOLVE_TWO_H
#define RBDI_DERIVATIVES_SOLVE_TWO_H
#include "dynamics/packed.h"

/* X = sign M^-1 X and Y = sign M^-1 Y: n columns each, with rows a stride apart. Both in one pass, as long as
   their rows fit into registers: each entry of L is loaded once, and the two do not wait for each other. */
RBDI_PART void rbdi_solve_two(const rbd_model *m, rbd_work *w, const rbd_real *L, int sign, ptrdiff_t stride,
                              int n, rbd_real *X, rbd_real *Y) {
#ifdef RBDI_ROWS
    if (RBDI_ROWS(solve)(m, L, sign, stride, n, X, Y)) return;
#endif

    if (n < RBDI_BATCH || 2 * n > RBDI_ROW * RBDI_BATCH) {
        rbdi_solve_columns(m, w, L, sign, stride, n, X);
        rbdi_solve_columns(m, w, L, sign, stride, n, Y);
        return;
    }
    rbdi_solve_half(m, w, L, 1, 1, stride, 2, n, X, Y);
    rbdi_solve_half(m, w, L, 0, sign, stride, 2, n, X, Y);
}

#endif
