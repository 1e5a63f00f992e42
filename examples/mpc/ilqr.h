/* ilqr.h - iterative LQR with limits on the controls, for robots by rbd.h: nonlinear optimal control in
   one file. SPDX-License-Identifier: MIT

   Finds controls u_0 .. u_{N-1} within their limits that make the sum of the costs l_k(q, v, u) of a
   horizon of N steps, and of the cost of its end, least, where step k is

       v+ = f_k(q, v, u)                the caller's: v + dt a(q, v, u); contacts; an impact, at dt = 0
       q+ = rbd_integrate(q, v+, dt_k)  on the configuration manifold

   by Newton's method on Bellman's equation, in which the dynamics is linearised and the costs have their
   Gauss-Newton Hessian: Li and Todorov (2004), called LT below; regularised and with a line search as
   Tassa, Erez and Todorov (2012), TET; box limits by a projected Newton step in each knot, Tassa, Mansard
   and Todorov (2014), TMT. Differences of states are tangent vectors, as rbd_difference gives them. It is
   single shooting: the trajectory is always one that the robot can move along, so that the cost alone
   tells whether a step was good, and half of the memory of multiple shooting is enough; what keeps a
   rollout of an unstable robot together are the gains K.

   USE
       static rbd_real memory[ILQR_REALS(NQ, NV, NU, N)];
       ilqr s;
       ilqr_init(&s, &problem, memory, sizeof memory / sizeof *memory);
       ... the first guess of the controls in s.u ...
       ilqr_start(&s, q, v);                                the trajectory from here
       for (...) ilqr_iterate(&s, &better);
       ... the answer in s.q, s.v, s.u, and the gains s.K: u = s.u + s.K (x - (s.q, s.v)) ...

   In a control loop: ilqr_shift, ilqr_start, one ilqr_iterate or a few, and s.u is the torque.

   A number that is not finite, measured, given, or returned by one of the caller's functions, is an error:
   RBD_ERR_NAN, and s.refused says which. The trajectory then stays as it was, finite, and so do the gains;
   the next good state goes on from there.

   The caller's memory, no allocation, no recursion, double or float (RBD_REAL). ILQR_NV and ILQR_NU may be
   defined as the sizes of the one robot: on a Cortex-M7 the Riccati step of an arm then takes 2 % less. */
#ifndef ILQR_H
#define ILQR_H

#include <limits.h>
#include <stdint.h>
#include <string.h>

#include "rbd_derivatives.h"

/* ---- the problem ---- */

typedef struct ilqr_problem {
    const rbd_model *m;
    int knots;  /* N, steps of the horizon */
    int nu;     /* controls, nv at most */
    int curved; /* the first so many v are those of joints whose q does not just add up: 6 with a floating
                   base and one-axis joints behind it, 0 without, nv always suffices */
    const rbd_real *dt;    /* N, s, 0 or more */
    const rbd_real *lower; /* nu, limits of the controls, lower <= upper; infinite where there is none */
    const rbd_real *upper;
    void *user; /* what the functions below are called with */

    /* v_next = f_k(q, v, u). */
    rbd_status (*step)(void *user, int k, const rbd_real *q, const rbd_real *v, const rbd_real *u,
                       rbd_real *v_next);

    /* Derivatives of v_next by z = (q, v, u), f_z, nv x (2 nv + nu), for all N knots, one after the
       other: so that one batch call can have them all. q (N + 1) x nq, v (N + 1) x nv, u N x nu. See
       ilqr_accelerations. */
    rbd_status (*derivatives)(void *user, const rbd_real *q, const rbd_real *v, const rbd_real *u,
                              rbd_real *f_z);

    /* Cost of knot k; at the end, k = N, u is NULL. Where l_z is not NULL also its gradient by z, 2 nv +
       nu, and Hessian or its Gauss-Newton part l_zz, (2 nv + nu)^2, of which the upper triangle is read,
       positive semidefinite, definite in u; at the end without u, but of the same shape. Both are 0
       before the call. */
    rbd_status (*cost)(void *user, int k, const rbd_real *q, const rbd_real *v, const rbd_real *u,
                       rbd_real *l, rbd_real *l_z, rbd_real *l_zz);
} ilqr_problem;

/* ---- the solver ---- */

typedef struct ilqr {
    const ilqr_problem *p;
    const char *refused; /* after an error: what of the problem, or which result, was refused; else NULL */
    int nq, nv, nu, knots;
    rbd_real *q, *v, *u;                 /* the trajectory: (N + 1) x nq, (N + 1) x nv, N x nu */
    rbd_real *q_try, *v_try, *u_try;     /* that of the line search */
    rbd_real *f_z;                       /* N x nv x (2 nv + nu) */
    rbd_real *k, *K;                     /* change of u, N x nu, and gains, N x nu x 2 nv */
    rbd_real *V_x, *V_xx;                /* derivatives of the cost to go, 2 nv and its square */
    rbd_real *Q_z, *Q_zz;                /* of that of the knot, 2 nv + nu and its square */
    rbd_real *PF;                        /* nv x (2 nv + nu) */
    rbd_real *U, *D;                     /* Q_uu of the free controls = U' D U; -U is kept */
    rbd_real *gradient, *change, *trial; /* nu each, of the box */
    rbd_real *clamped;                   /* nu: 1 for a control that stays at its limit, else 0 */
    rbd_real *T, *S;                     /* derivatives of q+, nv x nv */
    rbd_real *dx;                        /* 2 nv */
    rbd_real cost;                       /* of the trajectory */
    rbd_real mu;                         /* regularisation: Q_uu is taken with (1 + mu) times its diagonal */
    int tries;          /* backward passes of an iteration at most, with mu rising: 10; in real time 1 */
    int rollouts;       /* of a line search at most, each of half the step before: 7; in real time 2 */
    rbd_real tolerance; /* an iteration that promises less, relative to the cost, is not tried */
    rbd_real slope, curvature; /* of the cost along k: t k changes it by slope t + curvature t^2 / 2 */
} ilqr;

/* Length of the memory in scalars, of sizes that are not negative; more than an int holds is refused. */
#define ILQR_REALS(nq, nv, nu, knots) \
    ILQR_SUM((uint64_t)(nq), (uint64_t)(nv), (uint64_t)(nu), (uint64_t)(knots))
#define ILQR_SUM(nq, nv, nu, knots) \
    (2 * (((knots) + 1) * ((nq) + (nv)) + (knots) * (nu)) +                      /* trajectories */ \
     (knots) * ((nv) * ILQR_NZ(nv, nu) + (nu) * (1 + ILQR_NX(nv))) +             /* f_z, k, K */ \
     ILQR_NX(nv) * (ILQR_NX(nv) + 2) + ILQR_NZ(nv, nu) * (ILQR_NZ(nv, nu) + 1) + /* V, dx, Q */ \
     (nv) * ILQR_NZ(nv, nu) + (nu) * ((nu) + 5) + 2 * (nv) * (nv))
#define ILQR_NX(nv) (2 * (nv))
#define ILQR_NZ(nv, nu) (2 * (nv) + (nu))

/* nv, nu, and the lengths of x = (q, v) as a tangent and of z = (x, u): constants where ILQR_NV says so. */
#ifdef ILQR_NV
static inline int ilqr_nv(const ilqr *s) { return (void)s, ILQR_NV; }
static inline int ilqr_nu(const ilqr *s) { return (void)s, ILQR_NU; }
#else
static inline int ilqr_nv(const ilqr *s) { return s->nv; }
static inline int ilqr_nu(const ilqr *s) { return s->nu; }
#endif
static inline int ilqr_nx(const ilqr *s) { return ILQR_NX(ilqr_nv(s)); }
static inline int ilqr_nz(const ilqr *s) { return ILQR_NZ(ilqr_nv(s), ilqr_nu(s)); }

static inline rbd_real *ilqr_take(rbd_real **memory, int count) {
    rbd_real *taken = *memory;
    *memory += count;
    return taken;
}

/* An error that says what was refused. */
static inline rbd_status ilqr_refuse(ilqr *s, rbd_status status, const char *what) {
    s->refused = what;
    return status;
}

/* Whether all of count numbers are finite: x - x is 0, else NaN. */
static inline int ilqr_finite(int count, const rbd_real *x) {
    rbd_real sum = 0;
    for (int i = 0; i < count; i++) sum += x[i] - x[i];
    return sum >= 0;
}

/* Times are finite and not negative; limits are not crossed, and leave a number between them. */
static inline rbd_status ilqr_check_numbers(ilqr *s, const ilqr_problem *p) {
    for (int k = 0; k < p->knots; k++)
        if (!ilqr_finite(1, &p->dt[k]) || p->dt[k] < 0) return ilqr_refuse(s, RBD_ERR_LIMITS, "dt");
    for (int i = 0; i < p->nu; i++) {
        const rbd_real lower = p->lower[i], upper = p->upper[i];
        if (!(lower <= upper)) return ilqr_refuse(s, RBD_ERR_LIMITS, "lower, upper");
        if (!ilqr_finite(1, &lower) && lower > 0) return ilqr_refuse(s, RBD_ERR_LIMITS, "lower");
        if (!ilqr_finite(1, &upper) && upper < 0) return ilqr_refuse(s, RBD_ERR_LIMITS, "upper");
    }
    return RBD_OK;
}

static inline rbd_status ilqr_check_problem(ilqr *s, const ilqr_problem *p) {
    const int n = rbd_nv(p->m);
    if (p->knots < 1) return ilqr_refuse(s, RBD_ERR_COUNT, "knots");
    if (p->nu < 1 || p->nu > n) return ilqr_refuse(s, RBD_ERR_COUNT, "nu");
    if (p->curved < 0 || p->curved > n) return ilqr_refuse(s, RBD_ERR_COUNT, "curved");
#ifdef ILQR_NV
    if (n != ILQR_NV || p->nu != ILQR_NU) return ilqr_refuse(s, RBD_ERR_COUNT, "ILQR_NV, ILQR_NU");
#endif
    if (ILQR_REALS(rbd_nq(p->m), n, p->nu, p->knots) > INT_MAX) return ilqr_refuse(s, RBD_ERR_COUNT, "knots");
    if (!p->step || !p->derivatives || !p->cost)
        return ilqr_refuse(s, RBD_ERR_NULL, "step, derivatives, cost");
    if (!p->dt || !p->lower || !p->upper) return ilqr_refuse(s, RBD_ERR_NULL, "dt, lower, upper");
    return ilqr_check_numbers(s, p);
}

/* Prepares s in the memory, of at least ILQR_REALS(nq, nv, nu, knots) scalars, with all of u and K zero.
   Errors, s->refused says of what: RBD_ERR_NULL; RBD_ERR_COUNT: knots or nu below 1, more than the robot's
   nv, or too many for an int; RBD_ERR_LIMITS: dt, or limits, not as ilqr_problem says; RBD_ERR_MEMORY. */
static inline rbd_status ilqr_init(ilqr *s, const ilqr_problem *p, rbd_real *memory, size_t reals) {
    if (!s) return RBD_ERR_NULL;
    s->refused = NULL;
    if (!p || !p->m || !memory) return ilqr_refuse(s, RBD_ERR_NULL, !p ? "problem" : !p->m ? "m" : "memory");
    const rbd_status status = ilqr_check_problem(s, p);
    if (status) return status;
    const int nq = rbd_nq(p->m), n = rbd_nv(p->m), m = p->nu, nx = 2 * n, nz = nx + m, knots = p->knots;
    if (reals < ILQR_REALS(nq, n, m, knots)) return ilqr_refuse(s, RBD_ERR_MEMORY, "memory");
    memset(s, 0, sizeof *s);
    memset(memory, 0, sizeof *memory * reals);
    s->p = p, s->nq = nq, s->nv = n, s->nu = m, s->knots = knots;
    s->tries = 10, s->rollouts = 7, s->tolerance = sizeof(rbd_real) > 4 ? (rbd_real)1e-9 : (rbd_real)1e-6;
    s->q = ilqr_take(&memory, (knots + 1) * nq), s->q_try = ilqr_take(&memory, (knots + 1) * nq);
    s->v = ilqr_take(&memory, (knots + 1) * n), s->v_try = ilqr_take(&memory, (knots + 1) * n);
    s->u = ilqr_take(&memory, knots * m), s->u_try = ilqr_take(&memory, knots * m);
    s->f_z = ilqr_take(&memory, knots * n * nz);
    s->k = ilqr_take(&memory, knots * m), s->K = ilqr_take(&memory, knots * m * nx);
    s->V_x = ilqr_take(&memory, nx), s->V_xx = ilqr_take(&memory, nx * nx), s->dx = ilqr_take(&memory, nx);
    s->Q_z = ilqr_take(&memory, nz), s->Q_zz = ilqr_take(&memory, nz * nz);
    s->PF = ilqr_take(&memory, n * nz);
    s->U = ilqr_take(&memory, m * m), s->D = ilqr_take(&memory, m);
    s->gradient = ilqr_take(&memory, m), s->change = ilqr_take(&memory, m), s->trial = ilqr_take(&memory, m);
    s->clamped = ilqr_take(&memory, m);
    s->T = ilqr_take(&memory, n * n), s->S = ilqr_take(&memory, n * n);
    for (int k = 0; k <= knots; k++) rbd_neutral(p->m, s->q + k * nq);
    return RBD_OK;
}

/* f_z of one knot from derivatives of the acceleration, nv x nv each, for v_next = v + dt a: what
   rbd_fd_derivatives and rbd_constrained_fd_derivatives give. The controls drive the dofs from first on. */
static inline void ilqr_accelerations(const ilqr_problem *p, int first, rbd_real dt, const rbd_real *da_dq,
                                      const rbd_real *da_dv, const rbd_real *da_dtau, rbd_real *f_z) {
    const int n = rbd_nv(p->m), m = p->nu;
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++) *f_z++ = dt * da_dq[i * n + j];
        for (int j = 0; j < n; j++) *f_z++ = (rbd_real)(i == j) + dt * da_dv[i * n + j];
        for (int j = 0; j < m; j++) *f_z++ = dt * da_dtau[i * n + first + j];
    }
}

/* ---- products of small matrices: all that the Riccati step takes its time for ---- */

#if defined __GNUC__
#define ILQR_INLINE static inline __attribute__((always_inline))
#define ILQR_PART static __attribute__((noinline, unused))
#define ILQR_UNROLL _Pragma("GCC unroll 8")
#else
#define ILQR_INLINE static inline
#define ILQR_PART static inline
#define ILQR_UNROLL
#endif

/* height x width entries of C += A' B, height and width constants up to 4: the sums stay in registers, so
   that what is read serves up to four products. */
ILQR_INLINE void ilqr_block(const int height, const int width, int rows, const rbd_real *A, int lda,
                            const rbd_real *B, int ldb, rbd_real *C, int ldc) {
    rbd_real sum[4][4];
    ILQR_UNROLL for (int i = 0; i < height; i++) {
        ILQR_UNROLL for (int j = 0; j < width; j++) sum[i][j] = C[i * ldc + j];
    }
    for (int r = 0; r < rows; r++, A += lda, B += ldb) {
        ILQR_UNROLL for (int i = 0; i < height; i++) {
            ILQR_UNROLL for (int j = 0; j < width; j++) sum[i][j] += A[i] * B[j];
        }
    }
    ILQR_UNROLL for (int i = 0; i < height; i++) {
        ILQR_UNROLL for (int j = 0; j < width; j++) C[i * ldc + j] = sum[i][j];
    }
}

/* The same with a width of 4: a row is one SIMD register, or two. */
ILQR_INLINE void ilqr_block_of_four(const int height, int rows, const rbd_real *A, int lda, const rbd_real *B,
                                    int ldb, rbd_real *C, int ldc) {
#if defined __SSE2__ || defined __ARM_NEON
    typedef rbd_real four __attribute__((vector_size(4 * sizeof(rbd_real))));
    four sum[4], b;
    ILQR_UNROLL for (int i = 0; i < height; i++) { memcpy(&sum[i], C + i * ldc, sizeof b); }
    for (int r = 0; r < rows; r++, A += lda, B += ldb) {
        memcpy(&b, B, sizeof b);
        ILQR_UNROLL for (int i = 0; i < height; i++) { sum[i] += A[i] * b; }
    }
    ILQR_UNROLL for (int i = 0; i < height; i++) { memcpy(C + i * ldc, &sum[i], sizeof b); }
#else
    ilqr_block(height, 4, rows, A, lda, B, ldb, C, ldc);
#endif
}

/* The same for any width. */
ILQR_INLINE void ilqr_strip(const int height, int rows, const rbd_real *A, int lda, const rbd_real *B,
                            int ldb, int width, rbd_real *C, int ldc) {
    for (; width >= 4; width -= 4, B += 4, C += 4) ilqr_block_of_four(height, rows, A, lda, B, ldb, C, ldc);
    if (width == 3) ilqr_block(height, 3, rows, A, lda, B, ldb, C, ldc);
    if (width == 2) ilqr_block(height, 2, rows, A, lda, B, ldb, C, ldc);
    if (width == 1) ilqr_block(height, 1, rows, A, lda, B, ldb, C, ldc);
}

/* C += A' B with A rows x height, B rows x width, whose rows are lda, ldb and ldc apart. upper: of C only
   the upper triangle is wanted; at least that is written. */
ILQR_PART void ilqr_product(int rows, const rbd_real *A, int lda, int height, const rbd_real *B, int ldb,
                            int width, int upper, rbd_real *C, int ldc) {
    for (; height >= 4; height -= 4) {
        ilqr_strip(4, rows, A, lda, B, ldb, width, C, ldc);
        A += 4, C += 4 * ldc;
        if (upper) B += 4, C += 4, width -= 4;
    }
    if (height == 3) ilqr_strip(3, rows, A, lda, B, ldb, width, C, ldc);
    if (height == 2) ilqr_strip(2, rows, A, lda, B, ldb, width, C, ldc);
    if (height == 1) ilqr_strip(1, rows, A, lda, B, ldb, width, C, ldc);
}

static inline void ilqr_zero(int count, rbd_real *x) {
    for (int i = 0; i < count; i++) x[i] = 0;
}

static inline void ilqr_copy(int count, const rbd_real *x, rbd_real *y) {
    for (int i = 0; i < count; i++) y[i] = x[i];
}

static inline rbd_real ilqr_dot(int length, const rbd_real *x, const rbd_real *y) {
    rbd_real sum = 0;
    for (int i = 0; i < length; i++) sum += x[i] * y[i];
    return sum;
}

static inline rbd_real ilqr_clamp(rbd_real x, rbd_real lower, rbd_real upper) {
    return x < lower ? lower : x > upper ? upper : x;
}

/* ---- forward: the trajectory of a policy (TMT, forward pass) ---- */

/* dx = x - xbar_k of a state on the manifold. */
static inline rbd_status ilqr_state_difference(ilqr *s, int k, const rbd_real *q, const rbd_real *v) {
    for (int i = 0; i < s->nv; i++) s->dx[s->nv + i] = v[i] - s->v[k * s->nv + i];
    return rbd_difference(s->p->m, s->q + k * s->nq, q, s->dx);
}

/* Checks the results of the caller's functions, and the controls, in a knot of a rollout. */
static inline rbd_status ilqr_check_knot(ilqr *s, int k, rbd_real l) {
    const int n = ilqr_nv(s), m = ilqr_nu(s), nq = s->nq;
    if (k < s->knots) {
        if (!ilqr_finite(m, s->u_try + k * m)) return ilqr_refuse(s, RBD_ERR_NAN, "u");
        if (!ilqr_finite(n, s->v_try + (k + 1) * n)) return ilqr_refuse(s, RBD_ERR_NAN, "v_next");
        if (!ilqr_finite(nq, s->q_try + (k + 1) * nq)) return ilqr_refuse(s, RBD_ERR_NAN, "q");
    }
    return ilqr_finite(1, &l) ? RBD_OK : ilqr_refuse(s, RBD_ERR_NAN, "l");
}

/* u = u_k + t k_k + K_k (x - xbar_k) within the limits, from q_try_0 and v_try_0 on; and what it costs. */
static inline rbd_status ilqr_rollout(ilqr *s, rbd_real t, rbd_real *cost) {
    const int n = ilqr_nv(s), m = ilqr_nu(s), nx = ilqr_nx(s);
    const ilqr_problem *p = s->p;
    const int nq = s->nq;
    rbd_status status = RBD_OK;
    *cost = 0;
    for (int k = 0; k <= s->knots && status == RBD_OK; k++) {
        rbd_real *q = s->q_try + k * nq, *v = s->v_try + k * n, *u = s->u_try + k * m, l = 0;
        if (k < s->knots) {
            status = ilqr_state_difference(s, k, q, v);
            for (int i = 0; i < m; i++)
                u[i] = ilqr_clamp(s->u[k * m + i] + t * s->k[k * m + i] +
                                      ilqr_dot(nx, s->K + (k * m + i) * nx, s->dx),
                                  p->lower[i], p->upper[i]);
            if (status == RBD_OK) status = p->step(p->user, k, q, v, u, v + n);
            if (status == RBD_OK) status = rbd_integrate(p->m, q, v + n, p->dt[k], q + nq);
        }
        if (status == RBD_OK) status = p->cost(p->user, k, q, v, k < s->knots ? u : NULL, &l, NULL, NULL);
        *cost += l;
        if (status == RBD_OK) status = ilqr_check_knot(s, k, *cost);
    }
    return status;
}

static inline void ilqr_swap(rbd_real **x, rbd_real **y) {
    rbd_real *z = *x;
    *x = *y, *y = z;
}

/* The trajectory that was tried replaces the old one. */
static inline void ilqr_accept(ilqr *s, rbd_real cost) {
    ilqr_swap(&s->q, &s->q_try), ilqr_swap(&s->v, &s->v_try), ilqr_swap(&s->u, &s->u_try);
    s->cost = cost;
}

/* Makes (q, v) the first state: the controls and gains that are there, from it. After an error the
   trajectory is the one before. Errors: RBD_ERR_NULL; RBD_ERR_NAN: q, v, u or what the problem's functions
   gave is not finite; those of the problem's functions. */
static inline rbd_status ilqr_start(ilqr *s, const rbd_real *q, const rbd_real *v) {
    rbd_real cost;
    if (!s || !q || !v) return RBD_ERR_NULL;
    s->refused = NULL;
    if (!ilqr_finite(s->nq, q)) return ilqr_refuse(s, RBD_ERR_NAN, "q");
    if (!ilqr_finite(s->nv, v)) return ilqr_refuse(s, RBD_ERR_NAN, "v");
    memcpy(s->q_try, q, sizeof *q * (size_t)s->nq);
    memcpy(s->v_try, v, sizeof *v * (size_t)s->nv);
    const rbd_status status = ilqr_rollout(s, 0, &cost);
    if (status == RBD_OK) ilqr_accept(s, cost);
    return status;
}

/* ---- backward: the cost to go (LT; TET, backward pass) ---- */

/* Upper triangle to lower. */
static inline void ilqr_mirror(int size, rbd_real *M) {
    for (int i = 1; i < size; i++)
        for (int j = 0; j < i; j++) M[i * size + j] = M[j * size + i];
}

/* V of (q+, v+) becomes that of (q, v+), G' V_xx G and G' V_x: with dq+ = T dq + S dv+, G = [T S; 0 1].
   But for the joints that are curved T = 1 and S = dt. */
static inline rbd_status ilqr_value_through_step(ilqr *s, int k) {
    const int n = ilqr_nv(s), nx = ilqr_nx(s), c = s->p->curved;
    const rbd_real dt = s->p->dt[k];
    rbd_real *V = s->V_xx, *kept = s->PF; /* the rows of the curved joints */
    rbd_status status = RBD_OK;
    if (c > 0) {
        status = rbd_integrate_derivatives(s->p->m, s->v + (k + 1) * n, dt, s->T, s->S);
        ilqr_copy(c * nx, V, kept);
        ilqr_zero(c * nx, V);
        ilqr_product(c, s->T, n, c, kept, nx, nx, 0, V, nx);
        ilqr_product(c, s->S, n, c, kept, nx, nx, 0, V + n * nx, nx);
    }
    for (int i = c * nx; i < n * nx; i++) V[n * nx + i] += dt * V[i]; /* G' V_xx */
    for (int i = 0; i <= nx; i++) {                                   /* times G; and V_x */
        rbd_real *row = i < nx ? V + i * nx : s->V_x;
        for (int j = c; j < n; j++) row[n + j] += dt * row[j];
        if (c == 0) continue;
        ilqr_copy(c, row, kept);
        ilqr_zero(c, row);
        ilqr_product(c, kept, 1, 1, s->S, n, c, 0, row + n, nx);
        ilqr_product(c, kept, 1, 1, s->T, n, c, 0, row, nx);
    }
    return status;
}

/* Q(z) = l(z) + V(q, f(z)): with P for V_xx, split at v, and F for f_z (TET's expansion of Q, without f_zz)
       Q_z  = l_z + (P_q, 0, 0) + F' P_v
       Q_zz = l_zz + [P_qq 0 0; ...] + [P_qv F; 0; 0] + [P_qv F; 0; 0]' + F' P_vv F,
   the upper triangle; that F has only the velocity's rows is what the split of the step brings. */
static inline rbd_status ilqr_expand(ilqr *s, int k) {
    const int n = ilqr_nv(s), m = ilqr_nu(s), nx = ilqr_nx(s), nz = ilqr_nz(s);
    const rbd_real *F = s->f_z + k * n * nz, *P_vq = s->V_xx + n * nx, *P_vv = P_vq + n;
    rbd_real l;
    ilqr_zero(nz, s->Q_z);
    ilqr_zero(nz * nz, s->Q_zz);
    ilqr_zero(n * nz, s->PF);
    const rbd_status status =
        s->p->cost(s->p->user, k, s->q + k * s->nq, s->v + k * n, s->u + k * m, &l, s->Q_z, s->Q_zz);
    for (int i = 0; i < n; i++) ilqr_copy(n, P_vq + i * nx, s->PF + i * nz);
    ilqr_product(n, P_vv, nx, n, F, nz, nz, 0, s->PF, nz);     /* PF = (P_vq, 0, 0) + P_vv F */
    ilqr_product(n, s->PF, nz, nz, F, nz, nz, 1, s->Q_zz, nz); /* in q the transpose is missing: */
    ilqr_product(n, F, nz, n, P_vq, nx, n, 1, s->Q_zz, nz);
    for (int i = 0; i < n; i++) {
        s->Q_z[i] += s->V_x[i];
        for (int j = i; j < n; j++) s->Q_zz[i * nz + j] += s->V_xx[i * nx + j];
    }
    ilqr_product(n, s->V_x + n, 1, 1, F, nz, nz, 0, s->Q_z, nz);
    return status;
}

/* Q_uu of the free controls = U' D U, with U a unit upper triangle, of which -U is stored; rows and
   columns of those that are clamped are the identity's. Returns whether it is positive definite, and finite.
   */
static inline int ilqr_factor(ilqr *s) {
    const int m = ilqr_nu(s), nx = ilqr_nx(s), nz = ilqr_nz(s);
    const rbd_real *Q_uu = s->Q_zz + nx * nz + nx;
    for (int i = 0; i < m; i++) {
        rbd_real *row = s->U + i * m;
        for (int j = i; j < m; j++)
            row[j] = s->clamped[i] + s->clamped[j] > 0 ? (rbd_real)(i == j) : Q_uu[i * nz + j];
        for (int r = 0; r < i; r++) { /* less U_r' D_r U_r */
            const rbd_real factor = s->U[r * m + i] * s->D[r];
            for (int j = i; j < m; j++) row[j] -= factor * s->U[r * m + j];
        }
        s->D[i] = row[i];
        if (!(s->D[i] > 0) || !ilqr_finite(1, &s->D[i])) return 0;
        const rbd_real factor = -1 / row[i];
        for (int j = i; j < m; j++) row[j] *= factor;
    }
    return 1;
}

/* X = -Q_uu^-1 X in the rows of the free controls, 0 in the others; X nu x columns. */
static inline void ilqr_solve(ilqr *s, int columns, rbd_real *X) {
    const int m = ilqr_nu(s);
    for (int i = 0; i < m; i++) {
        if (s->clamped[i] > 0) ilqr_zero(columns, X + i * columns);
        ilqr_strip(1, i, s->U + i, m, X, columns, columns, X + i * columns, columns);
    }
    for (int i = m - 1; i >= 0; i--) {
        rbd_real *row = X + i * columns;
        const rbd_real factor = -1 / s->D[i];
        for (int j = 0; j < columns; j++) row[j] *= factor;
        ilqr_strip(1, m - 1 - i, s->U + i * m + i + 1, 1, row + columns, columns, columns, row, columns);
    }
}

/* The Newton step of the box, projected: k moves by as much of the change, within the limits, as makes k'
   Q_uu k / 2 + Q_u' k fall (TMT, the line search of Projected-Newton). Returns whether it was the whole
   change. */
static inline int ilqr_projected_step(ilqr *s, const rbd_real *u, rbd_real *k) {
    const int m = ilqr_nu(s), nx = ilqr_nx(s), nz = ilqr_nz(s);
    const rbd_real *Q_uu = s->Q_zz + nx * nz + nx, *lower = s->p->lower, *upper = s->p->upper;
    for (rbd_real t = 1; t > (rbd_real)1e-3; t /= 2) {
        rbd_real linear = 0, quadratic = 0;
        int whole = t >= 1;
        for (int i = 0; i < m; i++) {
            const rbd_real wanted = k[i] + t * s->change[i];
            s->trial[i] = ilqr_clamp(wanted, lower[i] - u[i], upper[i] - u[i]) - k[i];
            whole = whole && wanted >= lower[i] - u[i] && wanted <= upper[i] - u[i];
        }
        for (int i = 0; i < m; i++) {
            linear += s->gradient[i] * s->trial[i];
            quadratic += s->trial[i] * ilqr_dot(m, Q_uu + i * nz, s->trial);
        }
        if (!whole && linear + quadratic / 2 > linear / 10) continue;
        for (int i = 0; i < m; i++) /* to the limit itself: k + (limit - k) may miss it by a rounding */
            k[i] = ilqr_clamp(k[i] + t * s->change[i], lower[i] - u[i], upper[i] - u[i]);
        return whole;
    }
    return 0;
}

/* k = what makes k' Q_uu k / 2 + Q_u' k least with u + k within the limits, by projected Newton steps in
   the controls that are free: a clamped one's gradient points out of the box (TMT, Box-DDP). Leaves
   the factor of the free ones. Returns whether it is positive definite. */
static inline int ilqr_box(ilqr *s, const rbd_real *u, rbd_real *k) {
    const int m = ilqr_nu(s), nx = ilqr_nx(s), nz = ilqr_nz(s);
    const rbd_real *Q_u = s->Q_z + nx, *Q_uu = s->Q_zz + nx * nz + nx;
    int whole = 0;
    ilqr_zero(m, k);
    for (int round = 0; round < 20; round++) {
        int same = whole;
        for (int i = 0; i < m; i++) {
            const rbd_real g = Q_u[i] + ilqr_dot(m, Q_uu + i * nz, k);
            const int clamped =
                (k[i] <= s->p->lower[i] - u[i] && g > 0) || (k[i] >= s->p->upper[i] - u[i] && g < 0);
            same = same && clamped == (s->clamped[i] > 0);
            s->clamped[i] = (rbd_real)clamped;
            s->gradient[i] = s->change[i] = g;
        }
        if (same) break;
        if (!ilqr_factor(s)) return 0;
        ilqr_solve(s, 1, s->change);
        whole = ilqr_projected_step(s, u, k);
    }
    return 1;
}

/* Which of what the caller's functions gave, from this knot on, is not finite; if it is none of them, the
   gains themselves overflowed. */
static inline const char *ilqr_culprit(ilqr *s, int knot) {
    const int n = ilqr_nv(s), m = ilqr_nu(s), nz = ilqr_nz(s);
    for (int k = knot; k <= s->knots; k++) {
        rbd_real l;
        if (k < s->knots && !ilqr_finite(n * nz, s->f_z + k * n * nz)) return "f_z";
        ilqr_zero(nz, s->Q_z);
        ilqr_zero(nz * nz, s->Q_zz);
        s->p->cost(s->p->user, k, s->q + k * s->nq, s->v + k * n, k < s->knots ? s->u + k * m : NULL, &l,
                   s->Q_z, s->Q_zz);
        if (!ilqr_finite(nz, s->Q_z)) return "l_z";
        if (!ilqr_finite(nz * nz, s->Q_zz)) return "l_zz";
    }
    return "k, K";
}

/* k and K of the knot, and V of its state (TMT, Box-DDP; TET's update, in which the gradient of
   the free controls is zero):  V_x = Q_x + Q_xu k,  V_xx = Q_xx + Q_xu K,  K = -Q_uu^-1 Q_ux.
   A number of the expansion that is not finite makes Q_uu, k, K or the slope so, in this knot or an earlier
   one: there it is seen. Gains that are not finite become 0. */
static inline rbd_status ilqr_improve(ilqr *s, int knot) {
    const int m = ilqr_nu(s), nx = ilqr_nx(s), nz = ilqr_nz(s);
    rbd_real *k = s->k + knot * m, *K = s->K + knot * m * nx, *Q_ux = s->PF;
    rbd_real *Q_xu = s->Q_zz + nx, *Q_uu = s->Q_zz + nx * nz + nx, *Q_u = s->Q_z + nx;
    for (int i = 0; i < m; i++) {
        Q_uu[i * nz + i] += s->mu * Q_uu[i * nz + i];
        for (int j = 0; j < i; j++) Q_uu[i * nz + j] = Q_uu[j * nz + i];
        for (int j = 0; j < nx; j++) Q_ux[i * nx + j] = Q_xu[j * nz + i];
    }
    if (!ilqr_box(s, s->u + knot * m, k)) {
        int finite = 1;
        for (int i = 0; i < m; i++) finite = finite && ilqr_finite(m, Q_uu + i * nz);
        ilqr_zero(m, k);
        return finite ? RBD_ERR_SINGULAR : ilqr_refuse(s, RBD_ERR_NAN, ilqr_culprit(s, knot));
    }
    ilqr_copy(m * nx, Q_ux, K);
    for (int i = 0; i < m; i++) {
        s->slope += k[i] * Q_u[i];
        s->curvature += k[i] * ilqr_dot(m, Q_uu + i * nz, k);
    }
    ilqr_solve(s, nx, K);
    if (!ilqr_finite(1, &s->slope) || !ilqr_finite(1, &s->curvature) || !ilqr_finite(m * nx, K)) {
        ilqr_zero(m, k);
        ilqr_zero(m * nx, K);
        return ilqr_refuse(s, RBD_ERR_NAN, ilqr_culprit(s, knot));
    }
    ilqr_copy(nx, s->Q_z, s->V_x);
    for (int i = 0; i < nx; i++) ilqr_copy(nx, s->Q_zz + i * nz, s->V_xx + i * nx);
    ilqr_product(m, k, 1, 1, Q_ux, nx, nx, 0, s->V_x, nx);
    ilqr_product(m, Q_ux, nx, nx, K, nx, nx, 1, s->V_xx, nx);
    ilqr_mirror(nx, s->V_xx);
    return RBD_OK;
}

/* V at the end is the cost there. */
static inline rbd_status ilqr_end_value(ilqr *s) {
    const int n = ilqr_nv(s), nx = ilqr_nx(s), nz = ilqr_nz(s);
    const int N = s->knots;
    rbd_real l;
    ilqr_zero(nz, s->Q_z);
    ilqr_zero(nz * nz, s->Q_zz);
    const rbd_status status =
        s->p->cost(s->p->user, N, s->q + N * s->nq, s->v + N * n, NULL, &l, s->Q_z, s->Q_zz);
    ilqr_copy(nx, s->Q_z, s->V_x);
    for (int i = 0; i < nx; i++) ilqr_copy(nx, s->Q_zz + i * nz, s->V_xx + i * nx);
    ilqr_mirror(nx, s->V_xx);
    return status;
}

/* Derivatives of the dynamics along the trajectory. */
static inline rbd_status ilqr_linearise(ilqr *s) {
    return s->p->derivatives(s->p->user, s->q, s->v, s->u, s->f_z);
}

/* Bellman's equation from the end on: k and K of all knots. RBD_ERR_SINGULAR: Q_uu is not positive
   definite; RBD_ERR_NAN: something is not finite. K of earlier knots is then that of the iteration before. */
static inline rbd_status ilqr_backward(ilqr *s) {
    rbd_status status = ilqr_end_value(s);
    s->slope = s->curvature = 0;
    for (int k = s->knots - 1; k >= 0 && status == RBD_OK; k--) {
        status = ilqr_value_through_step(s, k);
        if (status == RBD_OK) status = ilqr_expand(s, k);
        if (status == RBD_OK) status = ilqr_improve(s, k);
    }
    return status;
}

/* Less regularisation after a step that was good, more after one that was not. */
static inline void ilqr_regularise(ilqr *s, int good) {
    if (good)
        s->mu = s->mu > (rbd_real)1e-4 ? s->mu / 5 : 0;
    else
        s->mu = 5 * s->mu + (rbd_real)1e-3;
}

/* Takes as much of k as makes the cost fall by a part of what the model promises, and returns 1; else the
   trajectory stays, 0. A rollout that fails, of a state that is out of all bounds, counts as one that
   costs too much. */
static inline int ilqr_line_search(ilqr *s) {
    rbd_real t = 1, cost;
    int good = 0;
    memcpy(s->q_try, s->q, sizeof t * (size_t)s->nq);
    memcpy(s->v_try, s->v, sizeof t * (size_t)s->nv);
    for (int i = 0; i < s->rollouts && !good; i++, t /= 2) {
        const rbd_real promised = s->slope * t + s->curvature * t * t / 2;
        const rbd_status status = ilqr_rollout(s, t, &cost);
        good = status == RBD_OK && cost - s->cost <= promised / 10;
    }
    if (good) ilqr_accept(s, cost);
    ilqr_regularise(s, good);
    return good;
}

/* One iteration: derivatives, backward pass and line search, the latter two again with more
   regularisation if there is nothing to find along k. *better: 1 if the trajectory is another one that
   costs less, else 0: there is hardly one, or none was found. Errors, the trajectory as it was: RBD_ERR_NAN:
   derivatives of the dynamics or of the cost are not finite; those of the problem's functions. */
static inline rbd_status ilqr_iterate(ilqr *s, int *better) {
    s->refused = NULL;
    *better = 0;
    rbd_status status = ilqr_linearise(s);
    for (int round = 0; round < s->tries && status == RBD_OK && !*better; round++) {
        status = ilqr_backward(s);
        if (status == RBD_ERR_SINGULAR) {
            ilqr_regularise(s, 0);
            status = RBD_OK;
        } else if (status == RBD_OK) {
            if (-s->slope - s->curvature / 2 <= s->tolerance * s->cost) return RBD_OK;
            *better = ilqr_line_search(s);
        }
    }
    return status;
}

/* ---- in a control loop ---- */

/* Moves trajectory, controls and gains on by a fraction of a knot, 0 to 1, by interpolation: the next
   horizon begins so much later. Then ilqr_start with the state that was measured. Errors: RBD_ERR_NAN, of the
   fraction. */
static inline rbd_status ilqr_shift(ilqr *s, rbd_real fraction) {
    s->refused = NULL;
    if (!ilqr_finite(1, &fraction)) return ilqr_refuse(s, RBD_ERR_NAN, "fraction");
    const int nq = s->nq, n = s->nv, N = s->knots;
    const int controls = s->nu, gains = s->nu * 2 * n;
    rbd_status status = RBD_OK;
    for (int k = 0; k < N && status == RBD_OK; k++) {
        status = rbd_difference(s->p->m, s->q + k * nq, s->q + (k + 1) * nq, s->dx);
        if (status == RBD_OK) status = rbd_integrate(s->p->m, s->q + k * nq, s->dx, fraction, s->q + k * nq);
        for (int i = k * n; i < (k + 1) * n; i++) s->v[i] += fraction * (s->v[i + n] - s->v[i]);
        if (k == N - 1) break;
        for (int i = k * controls; i < (k + 1) * controls; i++)
            s->u[i] += fraction * (s->u[i + controls] - s->u[i]);
        for (int i = k * gains; i < (k + 1) * gains; i++) s->K[i] += fraction * (s->K[i + gains] - s->K[i]);
    }
    return status;
}

#endif
