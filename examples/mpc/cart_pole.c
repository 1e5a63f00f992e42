/* cart_pole.c - swing-up: a pole hangs from a cart whose motor is too weak to push it up at once. From
   rest, with no force as the first guess, iterative LQR finds how to swing it up within the motor's
   limit. SPDX-License-Identifier: MIT */
#define RBD_IMPLEMENTATION
#include "check.h"

#include "models/cart_pole_model.h"

#include <stdio.h>
#include <stdlib.h>

enum { NQ = CART_POLE_NQ, NV = CART_POLE_NV, NU = 1, N = 100 };

static const double pi = 3.14159265358979324, dt = 0.02, force = 10; /* s, N */
static const double running[2 * NV] = {0.1, 0.1, 0.01, 0.01}, last[2 * NV] = {500, 500, 50, 50},
                                effort = 0.001;

static unsigned char work_memory[CART_POLE_WORK_SIZE], memory[RBD_DERIVATIVES_SIZE(CART_POLE_NB, NV)];
static rbd_work *w;
static rbd_derivatives *d;

static void check(rbd_status status) {
    if (status != RBD_OK) exit((fprintf(stderr, "%s\n", rbd_status_string(status)), EXIT_FAILURE));
}

/* v_next = v + dt a: the motor drives the cart, not the hinge. */
static rbd_status step(void *user, int k, const double *q, const double *v, const double *u, double *v_next) {
    const double tau[NV] = {u[0], 0};
    double a[NV];
    (void)user, (void)k;
    const rbd_status status = rbd_aba(&cart_pole_model, w, q, v, tau, NULL, a);
    for (int i = 0; i < NV; i++) v_next[i] = v[i] + dt * a[i];
    return status;
}

static rbd_status derivatives(void *user, const double *q, const double *v, const double *u, double *f_z) {
    rbd_status status = RBD_OK;
    for (int k = 0; k < N && status == RBD_OK; k++, q += NQ, v += NV, f_z += NV * ILQR_NZ(NV, NU)) {
        const double tau[NV] = {u[k], 0};
        double by_q[NV * NV], by_v[NV * NV], by_tau[NV * NV];
        status = rbd_fd_derivatives(&cart_pole_model, d, q, v, tau, NULL, NULL, by_q, by_v, by_tau);
        ilqr_accelerations(user, 0, dt, by_q, by_v, by_tau, f_z);
    }
    return status;
}

/* Half the weighted squares of what is not upright, at the middle of the rail and still, and of the force. */
static rbd_status cost(void *user, int k, const double *q, const double *v, const double *u, double *l,
                       double *l_z, double *l_zz) {
    const double x[2 * NV] = {q[CART_POLE_Q_RAIL], q[CART_POLE_Q_HINGE] - pi, v[0], v[1]};
    const double *weight = k < N ? running : last;
    const int nz = ILQR_NZ(NV, NU);
    (void)user;
    *l = u ? effort * u[0] * u[0] / 2 : 0;
    for (int i = 0; i < 2 * NV; i++) *l += weight[i] * x[i] * x[i] / 2;
    if (!l_z) return RBD_OK;
    for (int i = 0; i < 2 * NV; i++) l_z[i] = weight[i] * x[i], l_zz[i * nz + i] = weight[i];
    if (u) l_z[2 * NV] = effort * u[0], l_zz[2 * NV * nz + 2 * NV] = effort;
    return RBD_OK;
}

int main(void) {
    static double reals[ILQR_REALS(NQ, NV, NU, N)], times[N], scratch[2 * (NQ + 2 * NV + NU)];
    const double lower = -force, upper = force, q[NQ] = {0}, v[NV] = {0};
    ilqr_problem p = {&cart_pole_model, N, NU, 0, times, &lower, &upper, NULL, step, derivatives, cost};
    ilqr s;
    p.user = &p;
    for (int k = 0; k < N; k++) times[k] = dt;
    check(rbd_work_init(&cart_pole_model, work_memory, sizeof work_memory, &w));
    check(rbd_derivatives_init(&cart_pole_model, w, memory, sizeof memory, &d));
    check(ilqr_init(&s, &p, reals, sizeof reals / sizeof *reals));
    s.tolerance = 1e-6;
    check(ilqr_start(&s, q, v));

    int iterations = 0, better = 1, falling = 1;
    printf("iteration  0: cost %8.2f\n", s.cost);
    while (better && iterations < 200) {
        const double before = s.cost;
        check(ilqr_iterate(&s, &better));
        falling = falling && (better ? s.cost < before : s.cost == before);
        iterations += better;
        if (better && iterations % 5 == 0) printf("iteration %2d: cost %8.2f\n", iterations, s.cost);
    }
    double largest = 0, error = ilqr_derivative_error(&s, scratch);
    int limited = 0;
    for (int k = 0; k < N; k++) {
        largest = fmax(largest, fabs(s.u[k]));
        limited += fabs(s.u[k]) >= force;
    }
    const double *end = s.q + N * NQ, *rest = s.v + N * NV;
    const double off = fmax(fmax(fabs(end[0]), fabs(end[1] - pi)), fmax(fabs(rest[0]), fabs(rest[1])));
    printf("converged after %d iterations, the cost fell in each: %s\n", iterations, falling ? "yes" : "no");
    printf("upright and still to %.3f; at the limit of %.0f N in %d of %d knots, never beyond: %s\n", off,
           largest, limited, N, largest <= force ? "yes" : "no");
    printf("derivatives agree with differences to 1e-6: %s\n", error < 1e-6 ? "yes" : "no");
    return !better && falling && off < 0.05 && largest <= force && error < 1e-6 ? EXIT_SUCCESS : EXIT_FAILURE;
}
