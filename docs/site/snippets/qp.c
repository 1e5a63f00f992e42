#include "rbd.h"

#include "rbd_qp.h"

rbd_status status;

/* The place nearest to (1, 0.5) with x + y <= 1 and x >= 0. */
void example_rbd_qp_solve(void) {
    const double H[4] = {1, 0, 0, 1}, f[2] = {-1, -0.5}, C[2] = {1, 1};
    const double lower[2] = {0, -RBD_QP_NONE}, upper[2] = {RBD_QP_NONE, 1};
    const rbd_qp_problem p = {
        .n = 2, .bounds = 1, .rows = 1, .H = H, .f = f, .C = C, .lower = lower, .upper = upper};
    static unsigned char memory[RBD_QP_SIZE(2, 1, 1, 0)];
    double x[2], lambda[2];
    signed char side[2];
    rbd_qp_result result;
    const rbd_qp_status found = rbd_qp_solve(&p, NULL, memory, sizeof memory, x, lambda, side, &result);
    char text[100];
    if (found != RBD_QP_OK) rbd_qp_text(found, &result, text, sizeof text);
    if (x[0] < 0.74 || x[0] > 0.76) status = RBD_ERR_RANGE; /* x = (0.75, 0.25) */
}
