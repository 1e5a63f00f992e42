/* quadratic_programs.c - forces of HyQ's feet by rbd_qp on a microcontroller, in float: 12 forces alone, and
   18 accelerations with 12 forces; for wishes that are mild, and such that feet would slip and motors be too
   weak. Each is solved from nothing, without a warm start. SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <string.h>

#define HYQ_MODEL_IMPLEMENTATION
#include "cost.h"
#include "rbd.h"
#include "rbd_qp.h"
#include "models/hyq_model.h"

enum {
    NQ = HYQ_NQ,
    NV = HYQ_NV,
    FEET = 4,
    BASE = 6,
    MOTORS = NV - BASE,
    FORCES = 3 * FEET,
    ALL = NV + FORCES
};
enum { PYRAMID = 4 * FEET, FEW_ROWS = PYRAMID + MOTORS, ROWS = FORCES + BASE + FEW_ROWS };
enum { FIRST = 1000, LAST = 1256, EVERY = 8, PROBLEMS = (LAST - FIRST) / EVERY };

/* s, N, N m: of the feet and the motors */
static const rbd_real slope = 0.424264f, least = 5, most = 1500, strongest = 150;
static const rbd_real none = (rbd_real)RBD_QP_NONE;
static const rbd_real toe[3] = {0.33f, 0, 0};

static unsigned char work_memory[HYQ_WORK_SIZE], memory[RBD_QP_SIZE(ALL, ALL, ROWS, 0)];
static rbd_work *w;

/* The state walks at random: distance from the stance, velocity, wished acceleration of the trunk. */
static rbd_real away[NV], v[NV], wish[BASE], q[NQ], home[NQ];
static rbd_real M[NV * NV], h[NV], J[FORCES][NV], bias[FORCES], still[NV];
static rbd_real H[ALL * ALL], f[ALL], C[ROWS * ALL], lower[ALL + ROWS], upper[ALL + ROWS];

/* What calls of rbd_qp_solve took together. */
typedef struct cost {
    uint64_t instructions, steps;
    uint32_t worst, stack, solved;
} cost;

/* ---- states ---- */

static rbd_real draw(uint32_t *seed) { /* of -1 to 1 */
    *seed = *seed * 1664525u + 1013904223u;
    return (rbd_real)*seed * 0x1p-31f - 1;
}

static void walk(rbd_real boldness, uint32_t *seed) {
    for (int i = 0; i < NV; i++) {
        away[i] = 0.98f * away[i] + 0.1f * (i < BASE ? 0.05f : 0.2f) * draw(seed);
        v[i] = 0.98f * v[i] + 0.1f * (i < BASE ? 0.3f : 1) * draw(seed);
    }
    for (int i = 0; i < BASE; i++)
        wish[i] = 0.95f * wish[i] + 0.05f * boldness * (i < 3 ? 1.5f : 1) * draw(seed);
}

/* x = A^-1 b by Cramer's rule. */
static void solve3(rbd_real A[3][3], const rbd_real *b, rbd_real *x) {
    rbd_real minors[3][3], det;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            minors[i][j] = A[(i + 1) % 3][(j + 1) % 3] * A[(i + 2) % 3][(j + 2) % 3] -
                           A[(i + 1) % 3][(j + 2) % 3] * A[(i + 2) % 3][(j + 1) % 3];
    det = A[0][0] * minors[0][0] + A[0][1] * minors[0][1] + A[0][2] * minors[0][2];
    for (int j = 0; j < 3; j++)
        x[j] = (minors[0][j] * b[0] + minors[1][j] * b[1] + minors[2][j] * b[2]) / det;
}

/* Mass matrix, bias, Jacobians of the feet, and the torques that would give the trunk its wish without any
   foot's force, the feet held. */
static rbd_status prepare(void) {
    rbd_real a[NV], row[6 * NV], twist[6], free[3], block[3][3];
    rbd_status status = rbd_integrate(&hyq_model, home, away, 1, q);
    if (status == RBD_OK) status = rbd_crba(&hyq_model, w, q, M);
    if (status == RBD_OK) status = rbd_bias(&hyq_model, w, q, v, NULL, h);
    if (status == RBD_OK) status = rbd_kinematics(&hyq_model, w, q, v, NULL);

    for (int k = 0; k < BASE; k++) a[k] = wish[k];
    for (int i = 0; i < FEET && status == RBD_OK; i++) {
        const int leg = HYQ_BODY_LF_LOWERLEG + i;
        status = rbd_jacobian(&hyq_model, w, leg, toe, RBD_WORLD_AXES, row);
        if (status == RBD_OK) status = rbd_point_acceleration(&hyq_model, w, leg, toe, RBD_WORLD_AXES, twist);
        for (int r = 0; r < 3; r++) {
            memcpy(J[3 * i + r], row + (3 + r) * NV, sizeof J[0]);
            bias[3 * i + r] = twist[3 + r];
            free[r] = -twist[3 + r];
            for (int k = 0; k < BASE; k++) free[r] -= J[3 * i + r][k] * a[k];
            for (int k = 0; k < 3; k++) block[r][k] = J[3 * i + r][BASE + 4 * k + i];
        }
        solve3(block, free, twist);
        for (int k = 0; k < 3; k++) a[BASE + 4 * k + i] = twist[k];
    }
    return status == RBD_OK ? rbd_rnea(&hyq_model, w, q, v, a, NULL, still) : status;
}

/* ---- problems ---- */

/* Rows of friction and motors, the last ones of C, of n variables whose last are the forces: |f_x|, |f_y| <=
   slope f_z, and torques M a + h - J'f within limits; without accelerations `still` stands for M a + h. */
static void limits(int n, int first_row) {
    const int at = n - FORCES;
    const rbd_real *fixed = at ? h : still;
    for (int i = 0; i < n; i++) {
        const int normal = i >= at && (i - at) % 3 == 2;
        lower[i] = normal ? least : -none;
        upper[i] = normal ? most : none;
    }

    for (int k = 0; k < PYRAMID; k++) {
        rbd_real *row = C + (first_row + k) * n + at + k / 4 * 3;
        row[k % 4 / 2] = k % 2 ? -1 : 1;
        row[2] = -slope;
        lower[n + first_row + k] = -none;
        upper[n + first_row + k] = 0;
    }
    for (int k = 0; k < MOTORS; k++) {
        rbd_real *row = C + (first_row + PYRAMID + k) * n;
        for (int j = 0; j < at; j++) row[j] = M[(BASE + k) * NV + j];
        for (int j = 0; j < FORCES; j++) row[at + j] = -J[j][BASE + k];
        lower[n + first_row + PYRAMID + k] = -strongest - fixed[BASE + k];
        upper[n + first_row + PYRAMID + k] = strongest - fixed[BASE + k];
    }
}

static rbd_qp_problem problem(int n, int rows) {
    const rbd_qp_problem p = {
        .n = n, .bounds = n, .rows = rows, .H = H, .f = f, .C = C, .lower = lower, .upper = upper};
    memset(H, 0, sizeof H);
    memset(f, 0, sizeof f);
    memset(C, 0, sizeof C);
    return p;
}

/* 12 forces: the wrench on the trunk as well as they can, small ones. */
static rbd_qp_problem forces_alone(void) {
    const rbd_qp_problem p = problem(FORCES, FEW_ROWS);
    for (int i = 0; i < FORCES; i++) {
        for (int r = 0; r < BASE; r++) {
            const rbd_real weight = r < 3 ? 10 : 1;
            f[i] -= weight * J[i][r] * still[r];
            for (int j = 0; j < FORCES; j++) H[i * FORCES + j] += weight * J[i][r] * J[j][r];
        }
        H[i * FORCES + i] += 1e-3f;
    }
    limits(FORCES, 0);
    return p;
}

/* 18 accelerations and 12 forces: feet held, the trunk pushed by nothing else. */
static rbd_qp_problem whole_body(void) {
    const rbd_qp_problem p = problem(ALL, ROWS);
    for (int i = 0; i < ALL; i++) H[i * ALL + i] = i < BASE ? 1 : i < NV ? 1e-3f : 1e-5f;
    for (int i = 0; i < BASE; i++) f[i] = -wish[i];
    for (int r = 0; r < FORCES; r++) {
        memcpy(C + r * ALL, J[r], sizeof J[0]);
        lower[ALL + r] = upper[ALL + r] = -bias[r];
    }
    for (int r = 0; r < BASE; r++) {
        rbd_real *row = C + (FORCES + r) * ALL;
        memcpy(row, M + r * NV, NV * sizeof *M);
        for (int j = 0; j < FORCES; j++) row[NV + j] = -J[j][r];
        lower[ALL + FORCES + r] = upper[ALL + FORCES + r] = -h[r];
    }
    limits(ALL, FORCES + BASE);
    return p;
}

static void solve(const rbd_qp_problem *p, cost *c) {
    static rbd_real x[ALL], lambda[ALL + ROWS];
    static signed char side[ALL + ROWS];
    rbd_qp_result result;
    cost_stack(0);
    uint32_t start = board_now();
    const rbd_qp_status status = rbd_qp_solve(p, NULL, memory, sizeof memory, x, lambda, side, &result);
    const uint32_t took = COST_INSTRUCTIONS(cost_since(&start)), used = cost_stack(1);
    c->instructions += took;
    c->worst = took > c->worst ? took : c->worst;
    c->stack = used > c->stack ? used : c->stack;
    c->steps += (uint32_t)result.steps;
    c->solved += status == RBD_QP_OK;
}

int main(void) {
    static const char *const names[2] = {"mild", "hard"};
    static cost forces[2], bodies[2];
    uint32_t solved = 0, stack = 0;
    rbd_status status = rbd_work_init(&hyq_model, work_memory, sizeof work_memory, &w);
    rbd_neutral(&hyq_model, home);
    for (int i = 0; i < FEET; i++) {
        home[HYQ_Q_LF_HFE_JOINT + i] = i < 2 ? 0.7f : -0.7f;
        home[HYQ_Q_LF_KFE_JOINT + i] = i < 2 ? -1.4f : 1.4f;
    }
    board_start();

    for (int k = 0; k < 2; k++) {
        uint32_t seed = 1;
        memset(away, 0, sizeof away);
        memset(v, 0, sizeof v);
        memset(wish, 0, sizeof wish);
        for (int n = 0; n < LAST && status == RBD_OK; n++) {
            walk(k ? 80 : 20, &seed);
            if (n < FIRST || n % EVERY) continue;
            status = prepare();
            rbd_qp_problem p = forces_alone();
            solve(&p, &forces[k]);
            p = whole_body();
            solve(&p, &bodies[k]);
        }
        solved += forces[k].solved + bodies[k].solved;
        stack = bodies[k].stack > stack ? bodies[k].stack : stack;
    }

    for (int k = 0; k < 2; k++)
        printf("%s: 12 forces %lu instructions (at most %lu), accelerations too %lu (at most %lu); steps %lu "
               "and %lu in %d problems each\n",
               names[k], (unsigned long)(forces[k].instructions / PROBLEMS), (unsigned long)forces[k].worst,
               (unsigned long)(bodies[k].instructions / PROBLEMS), (unsigned long)bodies[k].worst,
               (unsigned long)forces[k].steps, (unsigned long)bodies[k].steps, PROBLEMS);
    printf("memory %u, stack %lu bytes; solved %lu of %d: %s\n", (unsigned)sizeof memory,
           (unsigned long)stack, (unsigned long)solved, 4 * PROBLEMS, rbd_status_string(status));
    return !(status == RBD_OK && solved == 4 * PROBLEMS);
}
