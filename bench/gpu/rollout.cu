/* rollout.cu - 64 steps of ROBOT by generated forward dynamics, the state in registers from the first step
   to the last. SPDX-License-Identifier: MIT */
#include "kernel.h"

#include REFERENCE_HEADER

namespace robot = ROBOT;

enum { Q = robot::NQ, V = robot::NV, FLOATING = Q != V, STEPS = 64 };

struct generated {
    template <class S> RBD_HD static void accelerate(const S *q, const S *v, const S *tau, S *a) {
        robot::fd(q, v, tau, a);
    }
};

struct reference {
    static void accelerate(const double *q, const double *v, const double *tau, double *a) {
        REFERENCE(fd)(q, v, tau, a);
    }
};

/* Moves a floating base for dt: place and quaternion (x, y, z, w) q, velocity v in the base's axes,
   angular first. */
template <class S> RBD_HD void move_base(S *q, const S *v, S dt) {
    const S x = q[3], y = q[4], z = q[5], w = q[6];
    const S tx = 2 * (y * v[5] - z * v[4]);
    const S ty = 2 * (z * v[3] - x * v[5]);
    const S tz = 2 * (x * v[4] - y * v[3]);
    q[0] += dt * (v[3] + w * tx + y * tz - z * ty);
    q[1] += dt * (v[4] + w * ty + z * tx - x * tz);
    q[2] += dt * (v[5] + w * tz + x * ty - y * tx);

    const S h = dt / 2;
    const S turned[4] = {x + h * (w * v[0] + y * v[2] - z * v[1]), y + h * (w * v[1] + z * v[0] - x * v[2]),
                         z + h * (w * v[2] + x * v[1] - y * v[0]), w - h * (x * v[0] + y * v[1] + z * v[2])};
    S squares = 0;
    for (int k = 0; k < 4; ++k) squares += turned[k] * turned[k];
    const S scale = 1 / (S)sqrt(squares);
    for (int k = 0; k < 4; ++k) q[3 + k] = turned[k] * scale;
}

/* v += dt a, then q by the new v. */
#ifdef __CUDACC__
#pragma nv_exec_check_disable /* reference is for the host alone */
#endif
template <class Dynamics, class S> RBD_HD void simulate(int steps, S dt, S *q, S *v, const S *tau) {
    S a[V];
    for (int step = 0; step < steps; ++step) {
        Dynamics::accelerate(q, v, tau, a);
        for (int k = 0; k < V; ++k) v[k] += dt * a[k];
        if (FLOATING) move_base(q, v, dt);
        for (int k = FLOATING ? 6 : 0; k < V; ++k) q[k + Q - V] += dt * v[k];
    }
}

template <class L>
RBD_KERNEL rollout_kernel(int n, const SCALAR *q, const SCALAR *v, const SCALAR *tau, SCALAR *q_end,
                          SCALAR *v_end) {
    RBD_EACH_STATE(i, n) {
        SCALAR x[Q], y[V], u[V];
        const auto q0 = L::at(q, Q, n, i);
        const auto v0 = L::at(v, V, n, i);
        const auto tau0 = L::at(tau, V, n, i);
        for (int k = 0; k < Q; ++k) x[k] = q0[k];
        for (int k = 0; k < V; ++k) y[k] = v0[k];
        for (int k = 0; k < V; ++k) u[k] = tau0[k] * (SCALAR)0.01;
        simulate<generated>(STEPS, (SCALAR)1e-3, x, y, u);
        auto q1 = L::at(q_end, Q, n, i);
        auto v1 = L::at(v_end, V, n, i);
        for (int k = 0; k < Q; ++k) q1[k] = x[k];
        for (int k = 0; k < V; ++k) v1[k] = y[k];
    }
}

static void in_double(const double *q, const double *v, const double *tau, double *q_end, double *v_end) {
    double u[V];
    for (int k = 0; k < Q; ++k) q_end[k] = q[k];
    for (int k = 0; k < V; ++k) v_end[k] = v[k];
    for (int k = 0; k < V; ++k) u[k] = tau[k] * 0.01;
    simulate<reference>(STEPS, 1e-3, q_end, v_end, u);
}

static bool run(const options &o) {
    static const int sizes[] = {Q, V, V, Q, V};
    const double tolerance = sizeof(SCALAR) == 4 ? 1e-2 : 1e-7;
    return measure<rbd::blocks>(o, "rollout", "blocks", rollout_kernel<rbd::blocks>, sizes, FLOATING,
                                in_double, tolerance);
}

static measurement own("rollout", run);
