/* feet_forces.c - a quadruped's trunk is to be pushed sideways, and its feet must neither slip nor pull:
   which forces do it? The least ones that do, without and with the limits of friction, by rbd_qp.h alone;
   then a push that no forces can give. */
#define RBD_IMPLEMENTATION
#include "rbd_qp.h"
#include "larger.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { FEET = 4, N = 3 * FEET, WRENCH = 6, PYRAMID = 4 * FEET, ROWS = WRENCH + PYRAMID };

static const double place[FEET][3] = {
    {0.37, 0.32, -0.5}, {0.37, -0.32, -0.5}, {-0.37, 0.32, -0.5}, {-0.37, -0.32, -0.5}};
static const double weight = 85 * 9.81;  /* N */
static const double mu = 0.5, least = 5; /* N, so that each foot keeps its contact */

static double H[N * N], f[N], C[ROWS * N], lower[N + ROWS], upper[N + ROWS], soft[N + ROWS];

/* Unknown: the force on each foot, world axes. Its cost: the sum of all squares. */
static rbd_qp_problem make(double sideways) {
    const double wanted[WRENCH] = {0, 0, 0, 0, sideways, weight}; /* moment about the trunk's centre, force */
    const rbd_qp_problem p = {
        .n = N, .bounds = N, .rows = ROWS, .H = H, .f = f, .C = C, .lower = lower, .upper = upper};

    for (int i = 0; i < N; i++) {
        H[i * N + i] = 1;
        lower[i] = i % 3 == 2 ? least : -RBD_QP_NONE;
        upper[i] = RBD_QP_NONE;
    }
    for (int i = 0; i < FEET; i++) {
        const double *r = place[i];
        const double moment[3][3] = {{0, -r[2], r[1]}, {r[2], 0, -r[0]}, {-r[1], r[0], 0}}; /* r x force */
        for (int k = 0; k < 3; k++) {
            for (int j = 0; j < 3; j++) C[k * N + 3 * i + j] = moment[k][j];
            C[(3 + k) * N + 3 * i + k] = 1;
        }

        /* |f_x|, |f_y| <= mu f_z / sqrt(2): a pyramid inside the cone */
        for (int k = 0; k < 4; k++) {
            double *row = C + (WRENCH + 4 * i + k) * N + 3 * i;
            row[k / 2] = k % 2 ? -1 : 1;
            row[2] = -mu / sqrt(2);
        }
    }
    for (int k = 0; k < WRENCH; k++) lower[N + k] = upper[N + k] = wanted[k];
    for (int k = WRENCH; k < ROWS; k++) {
        lower[N + k] = -RBD_QP_NONE;
        upper[N + k] = 0;
    }
    return p;
}

/* The largest slope of a force; negative where a foot would have to pull. */
static double slope(const double *x) {
    double largest = 0;
    for (int i = 0; i < FEET; i++) {
        const double tangent = hypot(x[3 * i], x[3 * i + 1]), normal = x[3 * i + 2];
        if (normal <= 0) return -1;
        largest = larger(largest, tangent / normal);
    }
    return largest;
}

int main(void) {
    static unsigned char memory[RBD_QP_SIZE(N, N, ROWS, N + ROWS)];
    double x[N], lambda[N + ROWS];
    signed char side[N + ROWS];
    rbd_qp_result result;
    char text[100];
    int good = 1;

    for (int k = 1; k <= 4; k++) {
        const double sideways = 100 * k;
        const rbd_qp_problem p = make(sideways);
        rbd_qp_problem equalities = p;
        rbd_qp_status status;

        equalities.bounds = 0;
        equalities.rows = WRENCH;
        equalities.lower = lower + N;
        equalities.upper = upper + N;
        rbd_qp_solve(&equalities, NULL, memory, sizeof memory, x, lambda, side, NULL);
        printf("%.0f N: least forces have a slope of %5.2f;", sideways, slope(x));

        status = rbd_qp_solve(&p, NULL, memory, sizeof memory, x, lambda, side, &result);
        if (status == RBD_QP_OK) {
            printf(" within friction %.2f, after %d steps\n", slope(x), result.steps);
            good = good && slope(x) > 0 && slope(x) <= mu;
        } else {
            printf(" no forces within friction: %s\n", rbd_qp_text(status, &result, text, sizeof text));
            good = good && status == RBD_QP_INFEASIBLE && sideways > mu / sqrt(2) * weight;
        }
    }

    /* As much of the push as can be had: the wrench soft, friction hard. */
    rbd_qp_problem p = make(400);
    double given = 0;
    for (int k = 0; k < WRENCH; k++) soft[N + k] = 1e4;
    p.soft = soft;
    good = good && rbd_qp_solve(&p, NULL, memory, sizeof memory, x, lambda, side, &result) == RBD_QP_OK;
    for (int i = 0; i < FEET; i++) given += x[3 * i + 1];
    good = good && slope(x) <= mu;
    printf("400 N asked for softly: %.0f N, slope %.2f\n", given, slope(x));
    printf("no foot slips or pulls: %s\n", good ? "yes" : "no");
    return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
