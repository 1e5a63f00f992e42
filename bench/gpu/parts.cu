/* parts.cu - derivatives of the forward dynamics of ROBOT in parts: the acceleration, the derivatives of
   the inverse dynamics there, M^-1, and the product of these. SPDX-License-Identifier: MIT */
#include "kernel.h"

#include REFERENCE_HEADER

#include "../../examples/gpu/product.h"

namespace robot = ROBOT;

enum { Q = robot::NQ, V = robot::NV, M = V * V, FLOATING = Q != V };

typedef rbd::blocks layout;
typedef SCALAR S;

/* Between the parts. */
static S *dtau_dq, *dtau_dv;
static int *status;

/* Kernels of other files, which take minutes to compile. */
static void all_parts(int n, const S *q, const S *v, const S *tau, S *a, S *da_dq, S *da_dv, S *Minv) {
    launch_blocks("fd", n, {q, v, tau, a, status});
    launch_blocks("id_derivatives", n, {q, v, a, dtau_dq, dtau_dv});
    launch_blocks("minv", n, {q, Minv, status});
    multiply<layout, V>(n, (const S *)Minv, (const S *)dtau_dq, (const S *)dtau_dv, da_dq, da_dv);
}

static bool run(const options &o) {
    static const int sizes[] = {Q, V, V, V, M, M, M};
    const double tolerance = sizeof(S) == 4 ? 5e-3 : 1e-7;
    bool right = true;
    for (int n = o.least_states; n <= o.most_states; n *= 4) {
        typedef kernel_calls<layout, const S *, const S *, const S *, S *, S *, S *, S *> calls_of;
        calls_of calls(all_parts, sizes, FLOATING, false);
        const size_t between = stored(n) * (2 * M * sizeof(S) + 4);
        if (stored(n) * (size_t)calls.bytes_a_state() + between + 8192 > memory_pool::get().capacity()) break;
        calls.prepare(n, 1);
        dtau_dq = (S *)memory_pool::get().take(stored(n) * M * sizeof(S));
        dtau_dv = (S *)memory_pool::get().take(stored(n) * M * sizeof(S));
        status = (int *)memory_pool::get().take(stored(n) * 4);
        if (o.profile) {
            calls(n, 0);
            device_wait();
            break;
        }
        const double error = calls.error(n, REFERENCE(fd_derivatives));
        right &= error <= tolerance;
        const double seconds = median_seconds(o.groups, o.least_seconds, [&](int) { calls(n, 0); });
        print_row("generated", "fd_derivatives_in_parts", "blocks", n, error, error <= tolerance, seconds,
                  calls.bytes_a_state() + 5 * M * (int)sizeof(S));
        const double product = median_seconds(o.groups, o.least_seconds, [&](int) {
            multiply<layout, V>(n, (const S *)calls.argument(6), (const S *)dtau_dq, (const S *)dtau_dv,
                                (S *)calls.argument(4), (S *)calls.argument(5));
        });
        print_row("generated", "product", "blocks", n, error, error <= tolerance, product,
                  5 * M * (int)sizeof(S));
    }
    return right;
}

static measurement own("fd_derivatives_in_parts", run);
