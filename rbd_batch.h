/* rbd_batch.h - many states at once, in the lanes of SIMD instructions, for rbd.h and the headers on it.
   Made by src/amalgamate.py from src/rbd_batch.h and the files that it includes: edit those.
   SPDX-License-Identifier: MIT. Copyright (c) 2026 the rbd authors. Licence in full at the end of rbd.h.

   Each call computes n states, RBD_LANES of them by each instruction, from and to ordinary arrays. A separate
   file implements the calls, compiled for the SIMD unit that is there:

       #define RBD_LANES 8               (double: 8 with AVX-512, 4 with AVX, 2 else; float: twice that)
       #define RBD_BATCH_IMPLEMENTATION
       #include "rbd_batch.h"

   Other files include rbd_batch.h without these macros; one of them implements rbd.h. Where rbd_derivatives.h
   or rbd_constraints.h is included before rbd_batch.h, its batch calls are declared, and implemented, too.
   Forward dynamics of 1000 states:

       rbd_batch *b;
       rbd_batch_init(m, memory, rbd_batch_size(m), &b);
       rbd_batch_aba(m, b, 1000, q, v, tau, NULL, a);

   CONTENTS (search for the tag)
     [conventions]
     [batch] [derivatives] [constraints]
     --- stop here if you only use it ---
     [lanes] [tasks] [batch code] [derivatives code] [constraints code]

   [conventions] Beyond those of rbd.h:
     states       n states are one after the other, unless rbd_batch_set_layout changes this: q is n x nq,
                  v, a, tau n x nv, f_ext n x nb x 6 or NULL, mass_matrix n x nv x nv, packed
                  n x rbd_packed_size(m). With n <= 0 a call does nothing
     results      those of the single calls, to rounding. An output may be NULL, or an input, as there
     errors       those of the single calls. With RBD_ERR_SINGULAR the results of the other states stand, and
                  rbd_batch_singular names the first singular state
*/
#include "rbd.h"

#ifndef RBD_BATCH_H
#if RBD_VERSION_NUMBER < 400 || RBD_MODEL_VERSION != 6
#error "rbd_batch.h: belongs to another version of rbd.h"
#endif
#ifdef RBD_BATCH_IMPLEMENTATION
#ifndef RBD_LANES
#error "rbd: RBD_BATCH_IMPLEMENTATION needs RBD_LANES"
#undef RBD_BATCH_IMPLEMENTATION
#elif defined RBD_NO_CHOLESKY
#error "rbd: the batch calls need RBD_NO_CHOLESKY undefined"
#undef RBD_BATCH_IMPLEMENTATION
#elif !defined RBDI_IMPLEMENTED
#error "rbd: define RBD_BATCH_IMPLEMENTATION before the first header of rbd is included"
#undef RBD_BATCH_IMPLEMENTATION
#endif
#endif
#endif

#if defined __cplusplus && !defined RBD_REAL_CUSTOM /* with RBD_STATIC too: other files call them */
extern "C" {
#endif

#ifndef RBD_BATCH_H
#define RBD_BATCH_H

/* ==== src/api/batch.h ==== */
#define rbd_batch_lanes RBDI_OF_SCALAR(rbd_batch_lanes)
#define rbd_batch_size RBDI_OF_SCALAR(rbd_batch_size)
#define rbd_batch_init RBDI_OF_SCALAR(rbd_batch_init)
#define rbd_batch_set_gravity RBDI_OF_SCALAR(rbd_batch_set_gravity)
#define rbd_batch_set_layout RBDI_OF_SCALAR(rbd_batch_set_layout)
#define rbd_batch_rnea RBDI_OF_SCALAR(rbd_batch_rnea)
#define rbd_batch_bias RBDI_OF_SCALAR(rbd_batch_bias)
#define rbd_batch_crba RBDI_OF_SCALAR(rbd_batch_crba)
#define rbd_batch_crba_packed RBDI_OF_SCALAR(rbd_batch_crba_packed)
#define rbd_batch_aba RBDI_OF_SCALAR(rbd_batch_aba)
#define rbd_batch_fd_cholesky RBDI_OF_SCALAR(rbd_batch_fd_cholesky)
#define rbd_batch_minverse RBDI_OF_SCALAR(rbd_batch_minverse)
#define rbd_batch_jacobian RBDI_OF_SCALAR(rbd_batch_jacobian)
#define rbd_batch_momentum RBDI_OF_SCALAR(rbd_batch_momentum)
#define rbd_batch_singular RBDI_OF_SCALAR(rbd_batch_singular)

#define RBDI_BATCH_API RBDI_EXTENSION extern

/* ---- the calls of rbd.h [batch] ---- */

typedef struct rbd_batch rbd_batch; /* scratch of one thread */

/* The order of the states in the arrays of a batch call, inputs and results. Rows are transposed before and
   after the computation; blocks are not. A block has L = rbd_batch_lanes() states, each in a lane:
   component k of state s of a quantity of this width (nq, nv, 6 nb, nv nv and so on) is

       x[(s / L * width + k) * L + s % L]

   An array has whole blocks, n / L rounded up; entries of states beyond the n-th are not read or written.
   Calls are fastest with arrays at multiples of L * sizeof(RBD_REAL) bytes. */
typedef enum rbd_layout {
    RBD_ROWS,  /* x[s * width + k] */
    RBD_BLOCKS /* as above */
} rbd_layout;

RBDI_BATCH_API int rbd_batch_lanes(void); /* the number of states in one block, RBD_LANES */

/* As rbd_work_size, rbd_work_init and rbd_set_gravity, of a batch instead of a work. */
RBDI_BATCH_API size_t rbd_batch_size(const rbd_model *m);
RBDI_BATCH_API rbd_status rbd_batch_init(const rbd_model *m, void *memory, size_t size, rbd_batch **batch);
RBDI_BATCH_API rbd_status rbd_batch_set_gravity(rbd_batch *b, const rbd_const gravity[3]);

/* Sets the layout of all arrays for the calls that follow; it is RBD_ROWS after rbd_batch_init. Both give the
   same bits. Error: RBD_ERR_NULL. */
RBDI_BATCH_API rbd_status rbd_batch_set_layout(rbd_batch *b, rbd_layout layout);

/* As the calls without _batch, for n states. */
RBDI_BATCH_API rbd_status rbd_batch_rnea(const rbd_model *m, rbd_batch *b, int n, const RBD_REAL *q,
                                         const RBD_REAL *v, const RBD_REAL *a, const RBD_REAL *f_ext,
                                         RBD_REAL *tau);
RBDI_BATCH_API rbd_status rbd_batch_bias(const rbd_model *m, rbd_batch *b, int n, const RBD_REAL *q,
                                         const RBD_REAL *v, const RBD_REAL *f_ext, RBD_REAL *c);
RBDI_BATCH_API rbd_status rbd_batch_crba(const rbd_model *m, rbd_batch *b, int n, const RBD_REAL *q,
                                         RBD_REAL *mass_matrix);
RBDI_BATCH_API rbd_status rbd_batch_crba_packed(const rbd_model *m, rbd_batch *b, int n, const RBD_REAL *q,
                                                RBD_REAL *packed);
RBDI_BATCH_API rbd_status rbd_batch_aba(const rbd_model *m, rbd_batch *b, int n, const RBD_REAL *q,
                                        const RBD_REAL *v, const RBD_REAL *tau, const RBD_REAL *f_ext,
                                        RBD_REAL *a);
RBDI_BATCH_API rbd_status rbd_batch_fd_cholesky(const rbd_model *m, rbd_batch *b, int n, const RBD_REAL *q,
                                                const RBD_REAL *v, const RBD_REAL *tau, const RBD_REAL *f_ext,
                                                RBD_REAL *a);
RBDI_BATCH_API rbd_status rbd_batch_minverse(const rbd_model *m, rbd_batch *b, int n, const RBD_REAL *q,
                                             RBD_REAL *Minv); /* n x nv x nv */

/* rbd_kinematics and then rbd_jacobian, rbd_momentum, with the same body and point in all states. jacobian is
   n x 6 x nv; h and h_dot are n x 6, and each may be NULL. */
RBDI_BATCH_API rbd_status rbd_batch_jacobian(const rbd_model *m, rbd_batch *b, int n, const RBD_REAL *q,
                                             int body, const RBD_REAL point[3], rbd_axes axes,
                                             RBD_REAL *jacobian);
RBDI_BATCH_API rbd_status rbd_batch_momentum(const rbd_model *m, rbd_batch *b, int n, const RBD_REAL *q,
                                             const RBD_REAL *v, const RBD_REAL *a, RBD_REAL *h,
                                             RBD_REAL *h_dot);

/* Returns, after RBD_ERR_SINGULAR, the first singular state of the last call, else -1. dof, which may be
   NULL, receives its singular degree of freedom, as from rbd_singular_dof. */
RBDI_BATCH_API int rbd_batch_singular(const rbd_batch *b, int *dof);

/* ==== src/rbd_batch.h ==== */
#endif

#if defined RBD_DERIVATIVES_H && !defined RBDI_BATCH_DERIVATIVES
#define RBDI_BATCH_DERIVATIVES

/* ==== src/api/batch_derivatives.h ==== */
#define rbd_batch_derivatives_size RBDI_OF_SCALAR(rbd_batch_derivatives_size)
#define rbd_batch_derivatives_init RBDI_OF_SCALAR(rbd_batch_derivatives_init)
#define rbd_batch_momentum_matrix RBDI_OF_SCALAR(rbd_batch_momentum_matrix)
#define rbd_batch_coriolis RBDI_OF_SCALAR(rbd_batch_coriolis)
#define rbd_batch_id_derivatives RBDI_OF_SCALAR(rbd_batch_id_derivatives)
#define rbd_batch_fd_derivatives RBDI_OF_SCALAR(rbd_batch_fd_derivatives)
#define rbd_batch_regressor RBDI_OF_SCALAR(rbd_batch_regressor)

/* ---- the calls of rbd_derivatives.h [derivatives] ---- */

typedef struct rbd_batch_derivatives rbd_batch_derivatives; /* scratch of one thread */

/* Bytes that rbd_batch_derivatives_init needs, and the call itself: as rbd_derivatives_size and _init, of a
   batch b of the model instead of a work. */
RBDI_BATCH_API size_t rbd_batch_derivatives_size(const rbd_model *m);
RBDI_BATCH_API rbd_status rbd_batch_derivatives_init(const rbd_model *m, rbd_batch *b, void *memory,
                                                     size_t size, rbd_batch_derivatives **d);
RBDI_BATCH_API rbd_status rbd_batch_momentum_matrix(const rbd_model *m, rbd_batch_derivatives *d, int n,
                                                    const RBD_REAL *q, const RBD_REAL *v, RBD_REAL *matrix,
                                                    RBD_REAL *A_dot_v);
RBDI_BATCH_API rbd_status rbd_batch_coriolis(const rbd_model *m, rbd_batch_derivatives *d, int n,
                                             const RBD_REAL *q, const RBD_REAL *v, RBD_REAL *matrix);
RBDI_BATCH_API rbd_status rbd_batch_id_derivatives(const rbd_model *m, rbd_batch_derivatives *d, int n,
                                                   const RBD_REAL *q, const RBD_REAL *v, const RBD_REAL *a,
                                                   const RBD_REAL *f_ext, RBD_REAL *dtau_dq,
                                                   RBD_REAL *dtau_dv, RBD_REAL *mass_matrix);
RBDI_BATCH_API rbd_status rbd_batch_fd_derivatives(const rbd_model *m, rbd_batch_derivatives *d, int n,
                                                   const RBD_REAL *q, const RBD_REAL *v, const RBD_REAL *tau,
                                                   const RBD_REAL *f_ext, RBD_REAL *a, RBD_REAL *da_dq,
                                                   RBD_REAL *da_dv, RBD_REAL *Minv);
RBDI_BATCH_API rbd_status rbd_batch_regressor(const rbd_model *m, rbd_batch_derivatives *d, int n,
                                              const RBD_REAL *q, const RBD_REAL *v, const RBD_REAL *a,
                                              RBD_REAL *regressor);

/* ==== src/rbd_batch.h ==== */
#endif

#if defined RBD_CONSTRAINTS_H && !defined RBDI_BATCH_CONSTRAINTS
#define RBDI_BATCH_CONSTRAINTS

/* ==== src/api/batch_constraints.h ==== */
#define rbd_batch_constraint_set_size RBDI_OF_SCALAR(rbd_batch_constraint_set_size)
#define rbd_batch_constraint_set_init RBDI_OF_SCALAR(rbd_batch_constraint_set_init)
#define rbd_batch_constrained_fd RBDI_OF_SCALAR(rbd_batch_constrained_fd)

/* ---- the calls of rbd_constraints.h [constraints] ----
   All states have the same constraints. */

typedef struct rbd_batch_constraint_set rbd_batch_constraint_set; /* scratch of one thread */

/* Bytes that rbd_batch_constraint_set_init needs, and the call itself: as rbd_constraint_set_size and _init,
   of a batch b of the model instead of a work. */
RBDI_BATCH_API size_t rbd_batch_constraint_set_size(const rbd_model *m, const rbd_constraint *list, int n);
RBDI_BATCH_API rbd_status rbd_batch_constraint_set_init(const rbd_model *m, rbd_batch *b,
                                                        const rbd_constraint *list, int n, void *memory,
                                                        size_t size, rbd_batch_constraint_set **c,
                                                        rbd_report *report);

/* rbd_constrained_fd. Singular states as in [conventions]; RBD_ERR_INFEASIBLE if a state has contradicting
   rows and none after it is singular. */
RBDI_BATCH_API rbd_status rbd_batch_constrained_fd(const rbd_model *m, rbd_batch_constraint_set *c, int n,
                                                   const RBD_REAL *q, const RBD_REAL *v, const RBD_REAL *tau,
                                                   const RBD_REAL *f_ext, RBD_REAL *a, RBD_REAL *lambda);

/* ==== src/rbd_batch.h ==== */
#endif

#if defined __cplusplus && !defined RBD_REAL_CUSTOM
}
#endif

/* ====================================================================================================
   Stop here if you only use it.
   ================================================================================================= */

/* As in rbd.h: the caller's macros of these names come back at the end. */

/* ==== src/base/letters_begin.h ==== */
#pragma push_macro("A")
#undef A
#pragma push_macro("C")
#undef C
#pragma push_macro("H")
#undef H
#pragma push_macro("J")
#undef J
#pragma push_macro("M")
#undef M
#pragma push_macro("Y")
#undef Y

/* ==== src/rbd_batch.h ==== */
#if defined RBD_BATCH_IMPLEMENTATION && !defined RBDI_BATCH_IMPLEMENTED
#define RBDI_BATCH_IMPLEMENTED

/* ==== src/batch/lanes.h ==== */
/* ---- lanes [lanes] ---- */

/* Transposes RBD_LANES vectors in place. Of each two vectors that are 1, 2, 4 apart it exchanges the blocks
   of as many lanes that are off the diagonal: with lanes a b of the one and c d of the other these become a
   c and b d. */
#if RBDI_HAS_SHUFFLE && (RBD_LANES == 2 || RBD_LANES == 4 || RBD_LANES == 8)
#if RBD_LANES == 2
#define RBDI_EACH_LANE(f, step) f(0, step), f(1, step)
#elif RBD_LANES == 4
#define RBDI_EACH_LANE(f, step) f(0, step), f(1, step), f(2, step), f(3, step)
#else
#define RBDI_EACH_LANE(f, step) \
    f(0, step), f(1, step), f(2, step), f(3, step), f(4, step), f(5, step), f(6, step), f(7, step)
#endif

/* Lane i of the new vectors: a lane of the first one, or RBD_LANES + a lane of the second one. */
#define RBDI_LOW_BLOCKS(i, step) ((i) & (step) ? RBD_LANES + (i) - (step) : (i))
#define RBDI_HIGH_BLOCKS(i, step) ((i) & (step) ? RBD_LANES + (i) : (i) + (step))

RBDI_INLINE void rbdi_exchange_lanes(rbd_real *x, rbd_real *y) {
    const rbd_real a = *x, b = *y;
    *x = __builtin_shufflevector(a, b, RBDI_EACH_LANE(RBDI_LOW_BLOCKS, 1));
    *y = __builtin_shufflevector(a, b, RBDI_EACH_LANE(RBDI_HIGH_BLOCKS, 1));
}

#if RBD_LANES >= 4
RBDI_INLINE void rbdi_exchange_pairs(rbd_real *x, rbd_real *y) {
    const rbd_real a = *x, b = *y;
    *x = __builtin_shufflevector(a, b, RBDI_EACH_LANE(RBDI_LOW_BLOCKS, 2));
    *y = __builtin_shufflevector(a, b, RBDI_EACH_LANE(RBDI_HIGH_BLOCKS, 2));
}
#endif

#if RBD_LANES >= 8
RBDI_INLINE void rbdi_exchange_fours(rbd_real *x, rbd_real *y) {
    const rbd_real a = *x, b = *y;
    *x = __builtin_shufflevector(a, b, RBDI_EACH_LANE(RBDI_LOW_BLOCKS, 4));
    *y = __builtin_shufflevector(a, b, RBDI_EACH_LANE(RBDI_HIGH_BLOCKS, 4));
}
#endif

RBDI_INLINE void rbdi_transpose_lanes(rbd_real x[RBD_LANES]) {
    for (int i = 0; i < RBD_LANES; i += 2) rbdi_exchange_lanes(&x[i], &x[i + 1]);
#if RBD_LANES >= 4
    for (int i = 0; i < RBD_LANES; ++i)
        if (!(i & 2)) rbdi_exchange_pairs(&x[i], &x[i + 2]);
#endif
#if RBD_LANES >= 8
    for (int i = 0; i < 4; ++i) rbdi_exchange_fours(&x[i], &x[i + 4]);
#endif
}
#else
RBDI_INLINE void rbdi_transpose_lanes(rbd_real x[RBD_LANES]) {
    for (int i = 0; i < RBD_LANES; ++i)
        for (int j = 0; j < i; ++j) {
            const RBD_REAL old = x[i][j];
            x[i][j] = x[j][i];
            x[j][i] = old;
        }
}
#endif

typedef RBD_REAL rbdi_lane_row
    __attribute__((vector_size(sizeof(rbd_real)), aligned(sizeof(RBD_REAL)), may_alias));

/* Lane s of x[k] becomes component k of state s. A state has `width` components, and `rest` states are in the
   array; lanes beyond these repeat the last one. blocks: whether the layout is RBD_BLOCKS.

   In rows, RBD_LANES components of RBD_LANES states are transposed at a time; the last components may overlap
   those before. The rows of the next states are prefetched, because the processor does not predict so many
   streams. */
RBDI_LOCAL void rbdi_gather(const RBD_REAL *in, int width, int blocks, int rest, rbd_real *x) {
    const int last = (rest < RBD_LANES ? rest : RBD_LANES) - 1;
    const int across = blocks ? 1 : width, along = blocks ? RBD_LANES : 1;
    const RBD_REAL *next = rest < 2 * RBD_LANES ? in : in + RBD_LANES * width;

    if (blocks || width < RBD_LANES) {
        for (int k = 0; k < width; ++k)
            if (blocks && rest >= RBD_LANES)
                x[k] = *(const rbdi_lane_row *)&in[k * RBD_LANES];
            else
                for (int s = 0; s < RBD_LANES; ++s) x[k][s] = in[k * along + (s < last ? s : last) * across];
        return;
    }

    for (int k = 0; k < width; k += RBD_LANES) {
        const int at = k + RBD_LANES <= width ? k : width - RBD_LANES;
        rbd_real block[RBD_LANES];

        for (int s = 0; s < RBD_LANES; ++s)
            block[s] = *(const rbdi_lane_row *)&in[(s < last ? s : last) * width + at];
        for (int s = 0; s < RBD_LANES; ++s)
            if (s <= last) __builtin_prefetch(&next[s * width + at]);

        rbdi_transpose_lanes(block);
        for (int s = 0; s < RBD_LANES; ++s) x[at + s] = block[s];
    }
}

/* The reverse, for the first count states. */
RBDI_LOCAL void rbdi_scatter(const rbd_real *x, int width, int blocks, int count, RBD_REAL *out) {
    const int across = blocks ? 1 : width, along = blocks ? RBD_LANES : 1;

    if (blocks || width < RBD_LANES) {
        for (int k = 0; k < width; ++k)
            if (blocks && count == RBD_LANES)
                *(rbdi_lane_row *)&out[k * RBD_LANES] = x[k];
            else
                for (int s = 0; s < count; ++s) out[k * along + s * across] = x[k][s];
        return;
    }

    for (int k = 0; k < width; k += RBD_LANES) {
        const int at = k + RBD_LANES <= width ? k : width - RBD_LANES;
        rbd_real block[RBD_LANES];

        for (int s = 0; s < RBD_LANES; ++s) block[s] = x[at + s];
        rbdi_transpose_lanes(block);
        for (int s = 0; s < RBD_LANES; ++s)
            if (s < count) *(rbdi_lane_row *)&out[s * width + at] = block[s];
    }
}

/* ==== src/batch/tasks.h ==== */
/* ---- tasks [tasks] ---- */

enum { RBDI_ARGUMENTS = 4 };

struct rbd_batch {
    rbd_work *w;
    rbd_real *x[RBDI_ARGUMENTS]; /* inputs of RBD_LANES states, a lane each */
    rbd_real *y;                 /* outputs likewise */
    int state, dof;              /* first singular state of the last call and its dof, -1 = none */
    rbd_layout layout;
};

/* A batch call. NULL = none. */
typedef struct rbdi_task {
    const RBD_REAL *in[RBDI_ARGUMENTS]; /* q, v, a (or tau) and f_ext of all states */
    RBD_REAL *out[RBDI_ARGUMENTS];      /* outputs of all states */
    int width[RBDI_ARGUMENTS];          /* components of each output */
    const rbd_real *x[RBDI_ARGUMENTS];  /* inputs of RBD_LANES states */
    rbd_real *y[RBDI_ARGUMENTS];        /* outputs of RBD_LANES states */
    rbd_work *w;
    void *more; /* other arguments of the call */
} rbdi_task;
typedef rbd_status rbdi_lane_call(const rbd_model *m, const rbdi_task *t);

/* Components of an input. */
RBDI_LOCAL int rbdi_batch_width(const rbd_model *m, int k) {
    return k == 0 ? m->nq : k < 3 ? m->nv : 6 * m->nb;
}

/* Largest outputs of a call: M, or a Jacobian, or a momentum and its rate. */
RBDI_LOCAL int rbdi_batch_output(const rbd_model *m) { return (m->nv > 6 ? m->nv : 6) * m->nv + 12; }

/* Whether a call can use the caller's array of these states: a whole block at an aligned address. */
RBDI_LOCAL int rbdi_usable(const rbd_batch *b, const RBD_REAL *x, int rest) {
    return b->layout == RBD_BLOCKS && rest >= RBD_LANES && (uintptr_t)x % sizeof(rbd_real) == 0;
}

/* Sets x to the inputs of the states from s on. */
RBDI_LOCAL void rbdi_task_gather(const rbd_model *m, rbdi_task *t, const rbd_batch *b, int s, int rest) {
    for (int k = 0; k < RBDI_ARGUMENTS; ++k) {
        const int width = rbdi_batch_width(m, k);
        const RBD_REAL *x = t->in[k] ? t->in[k] + (size_t)s * (size_t)width : NULL;
        const int usable = !x || rbdi_usable(b, x, rest);

        t->x[k] = usable ? (const rbd_real *)x : b->x[k];
        if (!usable) rbdi_gather(x, width, b->layout == RBD_BLOCKS, rest, b->x[k]);
    }
}

/* Sets t->y to the outputs of the states from s on: the caller's array, or y, for rbdi_task_scatter.
   With RBD_REPRODUCIBLE it is y, because rbdi_batch_singly reads the inputs again, which may be the
   same arrays. */
RBDI_LOCAL void rbdi_task_targets(rbdi_task *t, const rbd_batch *b, rbd_real *y, int s, int rest) {
    for (int k = 0; k < RBDI_ARGUMENTS; ++k) {
        RBD_REAL *out = t->out[k] ? t->out[k] + (size_t)s * (size_t)t->width[k] : NULL;
        t->y[k] = !out || (!RBDI_REPRODUCIBLE && rbdi_usable(b, out, rest)) ? (rbd_real *)out : y;
        y += t->width[k];
    }
}

/* Writes those of the first count states that are not in the caller's arrays. */
RBDI_LOCAL void rbdi_task_scatter(const rbdi_task *t, const rbd_batch *b, int s, int count) {
    for (int k = 0; k < RBDI_ARGUMENTS; ++k) {
        RBD_REAL *out = t->out[k] ? t->out[k] + (size_t)s * (size_t)t->width[k] : NULL;
        if ((RBD_REAL *)t->y[k] == out) continue;
        rbdi_scatter(t->y[k], t->width[k], b->layout == RBD_BLOCKS, count, out);
    }
}

/* Notes the first of these states that is singular: one of its pivots is not 1, after rbdi_check_factor. */
RBDI_LOCAL void rbdi_note_singular(const rbd_model *m, rbd_batch *b, int first, int count) {
    for (int i = 0; i < count && b->state < 0; ++i)
        for (int k = m->nv - 1; k >= 0 && b->state < 0; --k)
            if (!(b->w->pivot[k][i] > 0)) {
                b->state = first + i;
                b->dof = k;
            }
}

#if RBDI_REPRODUCIBLE
/* The states s to s + count - 1, each alone in all lanes. If a pivot is in doubt, all lanes take the path
   that one of them needs; so a state's bits would depend on the states beside it. */
RBDI_LOCAL rbd_status rbdi_batch_singly(rbdi_lane_call *call, const rbd_model *m, rbd_batch *b, int s,
                                        int count, rbd_real *y, rbdi_task *t) {
    const int blocks = b->layout == RBD_BLOCKS;
    rbd_status result = RBD_OK;

    for (int i = 0; i < count; ++i) {
        rbd_real *to = y;
        rbd_status status;

        for (int k = 0; k < RBDI_ARGUMENTS; ++k) {
            const int width = rbdi_batch_width(m, k);
            const size_t at = (size_t)s * (size_t)width + (size_t)(blocks ? i : i * width);
            t->x[k] = t->in[k] ? b->x[k] : NULL;
            if (t->in[k]) rbdi_gather(t->in[k] + at, width, blocks, 1, b->x[k]);
            t->y[k] = t->out[k] ? to : NULL;
            to += t->width[k];
        }

        status = call(m, t);
        if (status) {
            rbdi_note_singular(m, b, s + i, 1);
            result = status;
        }

        for (int k = 0; k < RBDI_ARGUMENTS; ++k) {
            const int width = t->width[k];
            const size_t at = (size_t)s * (size_t)width + (size_t)(blocks ? i : i * width);
            if (t->out[k]) rbdi_scatter(t->y[k], width, blocks, 1, t->out[k] + at);
        }
    }
    return result;
}
#endif

/* Makes a call for n states. y: memory for its outputs of RBD_LANES states. */
RBDI_LOCAL rbd_status rbdi_batch_run(rbdi_lane_call *call, const rbd_model *m, rbd_batch *b, int n,
                                     rbd_real *y, rbdi_task *t) {
    rbd_status result = b ? rbdi_check(m, b->w, t->in[0] != NULL) : RBD_ERR_NULL;
    if (result) return result;

    t->w = b->w;
    b->state = b->dof = -1;
    for (int s = 0; s < n; s += RBD_LANES) {
        const int count = n - s < RBD_LANES ? n - s : RBD_LANES;
        rbd_status status;

        rbdi_task_gather(m, t, b, s, n - s);
        rbdi_task_targets(t, b, y, s, n - s);
        RBDI_NOTE_DOUBT(b->w, 0);
        status = call(m, t);
#if RBDI_REPRODUCIBLE
        if (b->w->doubt) {
            status = rbdi_batch_singly(call, m, b, s, count, y, t);
            if (status) result = status;
            continue;
        }
#endif

        /* other states are computed after an error of one of them, but not after one of the arguments */
        if (status && status != RBD_ERR_SINGULAR && status != RBD_ERR_NAN && status != RBD_ERR_INFEASIBLE)
            return status;
        if (status) {
            rbdi_note_singular(m, b, s, count);
            result = status;
        }
        rbdi_task_scatter(t, b, s, count);
    }
    return result;
}

/* A call with these inputs and, so far, no outputs. */
RBDI_LOCAL rbdi_task rbdi_task_of(const RBD_REAL *q, const RBD_REAL *v, const RBD_REAL *a,
                                  const RBD_REAL *f_ext) {
    rbdi_task t;
    t.in[0] = q;
    t.in[1] = v;
    t.in[2] = a;
    t.in[3] = f_ext;
    for (int k = 0; k < RBDI_ARGUMENTS; ++k) {
        t.out[k] = NULL;
        t.width[k] = 0;
    }
    t.w = NULL;
    t.more = NULL;
    return t;
}

RBDI_LOCAL void rbdi_task_output(rbdi_task *t, int k, RBD_REAL *out, int width) {
    t->out[k] = out;
    t->width[k] = width;
}

/* ==== src/batch/calls.h ==== */
/* ---- batches [batch code] ---- */

/* A call with one output, which must not be NULL. */
RBDI_LOCAL rbd_status rbdi_batch_one(rbdi_lane_call *call, const rbd_model *m, rbd_batch *b, int n,
                                     const RBD_REAL *q, const RBD_REAL *v, const RBD_REAL *a,
                                     const RBD_REAL *f_ext, RBD_REAL *out, int width) {
    rbdi_task t = rbdi_task_of(q, v, a, f_ext);
    rbdi_task_output(&t, 0, out, width);
    return out ? rbdi_batch_run(call, m, b, n, b ? b->y : NULL, &t) : RBD_ERR_NULL;
}

RBDI_BATCH_API int rbd_batch_lanes(void) { return RBD_LANES; }

RBDI_BATCH_API size_t rbd_batch_size(const rbd_model *m) {
    if (!m) return 0;

    return RBDI_ALIGN + RBDI_ROUND(sizeof(rbd_batch)) + RBDI_ROUND(rbd_work_size(m)) +
           sizeof(rbd_real) * (size_t)(m->nq + 2 * m->nv + 6 * m->nb + rbdi_batch_output(m));
}

RBDI_BATCH_API rbd_status rbd_batch_init(const rbd_model *m, void *memory, size_t size, rbd_batch **batch) {
    unsigned char *p;
    rbd_batch *b;
    rbd_status status;
    if (batch) *batch = NULL;
    if (!m || !memory || !batch) return RBD_ERR_NULL;
    if (size < rbd_batch_size(m)) return RBD_ERR_MEMORY;

    p = rbdi_aligned(memory);
    b = (rbd_batch *)rbdi_take(&p, 1, RBDI_ROUND(sizeof(rbd_batch)));
    for (int k = 0; k < RBDI_ARGUMENTS; ++k)
        b->x[k] = (rbd_real *)rbdi_take(&p, rbdi_batch_width(m, k), sizeof(rbd_real));
    b->y = (rbd_real *)rbdi_take(&p, rbdi_batch_output(m), sizeof(rbd_real));

    b->state = b->dof = -1;
    b->layout = RBD_ROWS;
    status = rbd_work_init(m, p, rbd_work_size(m), &b->w);
    if (!status) *batch = b;
    return status;
}

RBDI_BATCH_API rbd_status rbd_batch_set_gravity(rbd_batch *b, const rbd_const gravity[3]) {
    return b ? rbd_set_gravity(b->w, gravity) : RBD_ERR_NULL;
}

RBDI_BATCH_API rbd_status rbd_batch_set_layout(rbd_batch *b, rbd_layout layout) {
    if (!b) return RBD_ERR_NULL;
    b->layout = layout;
    return RBD_OK;
}

/* The calls in lanes. x: q, v, a or tau, f_ext. */
RBDI_LOCAL rbd_status rbdi_lanes_rnea(const rbd_model *m, const rbdi_task *t) {
    const rbd_real *a = t->x[2] ? t->x[2] : t->w->zero;
    return rbd_rnea(m, t->w, t->x[0], t->x[1], a, t->x[3], t->y[0]);
}

RBDI_LOCAL rbd_status rbdi_lanes_aba(const rbd_model *m, const rbdi_task *t) {
    return rbd_aba(m, t->w, t->x[0], t->x[1], t->x[2], t->x[3], t->y[0]);
}

RBDI_LOCAL rbd_status rbdi_lanes_fd_cholesky(const rbd_model *m, const rbdi_task *t) {
    return rbd_fd_cholesky(m, t->w, t->x[0], t->x[1], t->x[2], t->x[3], t->y[0]);
}

RBDI_LOCAL rbd_status rbdi_lanes_crba(const rbd_model *m, const rbdi_task *t) {
    return rbd_crba(m, t->w, t->x[0], t->y[0]);
}

RBDI_LOCAL rbd_status rbdi_lanes_crba_packed(const rbd_model *m, const rbdi_task *t) {
    return rbd_crba_packed(m, t->w, t->x[0], t->y[0]);
}

RBDI_LOCAL rbd_status rbdi_lanes_minverse(const rbd_model *m, const rbdi_task *t) {
    return rbd_minverse(m, t->w, t->x[0], t->y[0]);
}

RBDI_BATCH_API rbd_status rbd_batch_rnea(const rbd_model *m, rbd_batch *b, int n, const RBD_REAL *q,
                                         const RBD_REAL *v, const RBD_REAL *a, const RBD_REAL *f_ext,
                                         RBD_REAL *tau) {
    if (!v || !a) return RBD_ERR_NULL;
    return rbdi_batch_one(rbdi_lanes_rnea, m, b, n, q, v, a, f_ext, tau, rbd_nv(m));
}

RBDI_BATCH_API rbd_status rbd_batch_bias(const rbd_model *m, rbd_batch *b, int n, const RBD_REAL *q,
                                         const RBD_REAL *v, const RBD_REAL *f_ext, RBD_REAL *c) {
    if (!v) return RBD_ERR_NULL;
    return rbdi_batch_one(rbdi_lanes_rnea, m, b, n, q, v, NULL, f_ext, c, rbd_nv(m));
}

RBDI_BATCH_API rbd_status rbd_batch_crba(const rbd_model *m, rbd_batch *b, int n, const RBD_REAL *q,
                                         RBD_REAL *M) {
    return rbdi_batch_one(rbdi_lanes_crba, m, b, n, q, NULL, NULL, NULL, M, rbd_nv(m) * rbd_nv(m));
}

RBDI_BATCH_API rbd_status rbd_batch_crba_packed(const rbd_model *m, rbd_batch *b, int n, const RBD_REAL *q,
                                                RBD_REAL *H) {
    return rbdi_batch_one(rbdi_lanes_crba_packed, m, b, n, q, NULL, NULL, NULL, H, rbd_packed_size(m));
}

RBDI_BATCH_API rbd_status rbd_batch_aba(const rbd_model *m, rbd_batch *b, int n, const RBD_REAL *q,
                                        const RBD_REAL *v, const RBD_REAL *tau, const RBD_REAL *f_ext,
                                        RBD_REAL *a) {
    if (!v || !tau) return RBD_ERR_NULL;
    return rbdi_batch_one(rbdi_lanes_aba, m, b, n, q, v, tau, f_ext, a, rbd_nv(m));
}

RBDI_BATCH_API rbd_status rbd_batch_fd_cholesky(const rbd_model *m, rbd_batch *b, int n, const RBD_REAL *q,
                                                const RBD_REAL *v, const RBD_REAL *tau, const RBD_REAL *f_ext,
                                                RBD_REAL *a) {
    if (!v || !tau) return RBD_ERR_NULL;
    return rbdi_batch_one(rbdi_lanes_fd_cholesky, m, b, n, q, v, tau, f_ext, a, rbd_nv(m));
}

RBDI_BATCH_API rbd_status rbd_batch_minverse(const rbd_model *m, rbd_batch *b, int n, const RBD_REAL *q,
                                             RBD_REAL *Minv) {
    return rbdi_batch_one(rbdi_lanes_minverse, m, b, n, q, NULL, NULL, NULL, Minv, rbd_nv(m) * rbd_nv(m));
}

/* Arguments of rbd_jacobian beside q. */
typedef struct rbdi_lane_point {
    int body;
    rbd_axes axes;
    const rbd_real *point;
} rbdi_lane_point;

RBDI_LOCAL rbd_status rbdi_lanes_jacobian(const rbd_model *m, const rbdi_task *t) {
    const rbdi_lane_point *at = (const rbdi_lane_point *)t->more;
    (void)rbd_kinematics(m, t->w, t->x[0], NULL, NULL); /* arguments are checked */
    return rbd_jacobian(m, t->w, at->body, at->point, at->axes, t->y[0]);
}

RBDI_BATCH_API rbd_status rbd_batch_jacobian(const rbd_model *m, rbd_batch *b, int n, const RBD_REAL *q,
                                             int body, const RBD_REAL point[3], rbd_axes axes, RBD_REAL *J) {
    rbdi_task t = rbdi_task_of(q, NULL, NULL, NULL);
    rbdi_lane_point at;
    rbd_real lanes[3];

    for (int k = 0; k < 3; ++k) lanes[k] = rbdi_set(point ? point[k] : RBD_C(0));
    at.body = body;
    at.axes = axes;
    at.point = lanes;
    t.more = &at;

    rbdi_task_output(&t, 0, J, 6 * rbd_nv(m));
    return J ? rbdi_batch_run(rbdi_lanes_jacobian, m, b, n, b ? b->y : NULL, &t) : RBD_ERR_NULL;
}

RBDI_LOCAL rbd_status rbdi_lanes_momentum(const rbd_model *m, const rbdi_task *t) {
    (void)rbd_kinematics(m, t->w, t->x[0], t->x[1], t->x[2]);
    return rbd_momentum(m, t->w, t->y[0], t->y[1]);
}

RBDI_BATCH_API rbd_status rbd_batch_momentum(const rbd_model *m, rbd_batch *b, int n, const RBD_REAL *q,
                                             const RBD_REAL *v, const RBD_REAL *a, RBD_REAL *h,
                                             RBD_REAL *h_dot) {
    rbdi_task t = rbdi_task_of(q, v, a, NULL);
    rbdi_task_output(&t, 0, h, 6);
    rbdi_task_output(&t, 1, h_dot, 6);
    return rbdi_batch_run(rbdi_lanes_momentum, m, b, n, b ? b->y : NULL, &t);
}

RBDI_BATCH_API int rbd_batch_singular(const rbd_batch *b, int *dof) {
    if (dof) *dof = b ? b->dof : -1;
    return b ? b->state : -1;
}

/* ==== src/rbd_batch.h ==== */
#endif

#if defined RBD_BATCH_IMPLEMENTATION && defined RBDI_BATCH_DERIVATIVES && \
    !defined RBDI_BATCH_DERIVATIVES_IMPLEMENTED
#define RBDI_BATCH_DERIVATIVES_IMPLEMENTED

/* ==== src/batch/derivatives.h ==== */
/* ---- derivatives [derivatives code] ---- */

struct rbd_batch_derivatives {
    rbd_batch *b;
    rbd_derivatives *d;
    rbd_real *y; /* outputs of RBD_LANES states */
};

/* Largest outputs of a call: three square matrices and an acceleration, a momentum matrix and its bias, or a
   regressor. */
RBDI_LOCAL int rbdi_derivatives_output(const rbd_model *m) {
    int most = (3 * m->nv + 6) * m->nv + 6;
    if (most < 10 * m->nb * m->nv) most = 10 * m->nb * m->nv;
    return most;
}

RBDI_BATCH_API size_t rbd_batch_derivatives_size(const rbd_model *m) {
    if (!m) return 0;

    return RBDI_ALIGN + RBDI_ROUND(sizeof(rbd_batch_derivatives)) + rbd_derivatives_size(m) +
           sizeof(rbd_real) * (size_t)rbdi_derivatives_output(m);
}

RBDI_BATCH_API rbd_status rbd_batch_derivatives_init(const rbd_model *m, rbd_batch *b, void *memory,
                                                     size_t size, rbd_batch_derivatives **derivatives) {
    unsigned char *p;
    rbd_batch_derivatives *d;
    rbd_status status;
    if (derivatives) *derivatives = NULL;
    if (!m || !b || !memory || !derivatives) return RBD_ERR_NULL;
    if (size < rbd_batch_derivatives_size(m)) return RBD_ERR_MEMORY;

    p = rbdi_aligned(memory);
    d = (rbd_batch_derivatives *)rbdi_take(&p, 1, RBDI_ROUND(sizeof(rbd_batch_derivatives)));
    d->b = b;
    d->y = (rbd_real *)rbdi_take(&p, rbdi_derivatives_output(m), sizeof(rbd_real));
    status = rbd_derivatives_init(m, b->w, p, rbd_derivatives_size(m), &d->d);
    if (!status) *derivatives = d;
    return status;
}

RBDI_LOCAL rbd_status rbdi_batch_derivatives_run(rbdi_lane_call *call, const rbd_model *m,
                                                 rbd_batch_derivatives *d, int n, rbdi_task *t) {
    if (!d) return RBD_ERR_NULL;
    t->more = d->d;
    return rbdi_batch_run(call, m, d->b, n, d->y, t);
}

RBDI_LOCAL rbd_status rbdi_lanes_momentum_matrix(const rbd_model *m, const rbdi_task *t) {
    return rbd_momentum_matrix(m, (rbd_derivatives *)t->more, t->x[0], t->x[1], t->y[0], t->y[1]);
}

RBDI_BATCH_API rbd_status rbd_batch_momentum_matrix(const rbd_model *m, rbd_batch_derivatives *d, int n,
                                                    const RBD_REAL *q, const RBD_REAL *v, RBD_REAL *A,
                                                    RBD_REAL *A_dot_v) {
    rbdi_task t = rbdi_task_of(q, v, NULL, NULL);
    rbdi_task_output(&t, 0, A, 6 * rbd_nv(m));
    rbdi_task_output(&t, 1, A_dot_v, 6);
    return rbdi_batch_derivatives_run(rbdi_lanes_momentum_matrix, m, d, n, &t);
}

RBDI_LOCAL rbd_status rbdi_lanes_coriolis(const rbd_model *m, const rbdi_task *t) {
    return rbd_coriolis(m, (rbd_derivatives *)t->more, t->x[0], t->x[1], t->y[0]);
}

RBDI_BATCH_API rbd_status rbd_batch_coriolis(const rbd_model *m, rbd_batch_derivatives *d, int n,
                                             const RBD_REAL *q, const RBD_REAL *v, RBD_REAL *C) {
    rbdi_task t = rbdi_task_of(q, v, NULL, NULL);
    rbdi_task_output(&t, 0, C, rbd_nv(m) * rbd_nv(m));
    return rbdi_batch_derivatives_run(rbdi_lanes_coriolis, m, d, n, &t);
}

RBDI_LOCAL rbd_status rbdi_lanes_id_derivatives(const rbd_model *m, const rbdi_task *t) {
    return rbd_id_derivatives(m, (rbd_derivatives *)t->more, t->x[0], t->x[1], t->x[2], t->x[3], t->y[0],
                              t->y[1], t->y[2]);
}

RBDI_BATCH_API rbd_status rbd_batch_id_derivatives(const rbd_model *m, rbd_batch_derivatives *d, int n,
                                                   const RBD_REAL *q, const RBD_REAL *v, const RBD_REAL *a,
                                                   const RBD_REAL *f_ext, RBD_REAL *dtau_dq,
                                                   RBD_REAL *dtau_dv, RBD_REAL *M) {
    rbdi_task t = rbdi_task_of(q, v, a, f_ext);
    rbdi_task_output(&t, 0, dtau_dq, rbd_nv(m) * rbd_nv(m));
    rbdi_task_output(&t, 1, dtau_dv, rbd_nv(m) * rbd_nv(m));
    rbdi_task_output(&t, 2, M, rbd_nv(m) * rbd_nv(m));
    return rbdi_batch_derivatives_run(rbdi_lanes_id_derivatives, m, d, n, &t);
}

RBDI_LOCAL rbd_status rbdi_lanes_fd_derivatives(const rbd_model *m, const rbdi_task *t) {
    return rbd_fd_derivatives(m, (rbd_derivatives *)t->more, t->x[0], t->x[1], t->x[2], t->x[3], t->y[0],
                              t->y[1], t->y[2], t->y[3]);
}

RBDI_BATCH_API rbd_status rbd_batch_fd_derivatives(const rbd_model *m, rbd_batch_derivatives *d, int n,
                                                   const RBD_REAL *q, const RBD_REAL *v, const RBD_REAL *tau,
                                                   const RBD_REAL *f_ext, RBD_REAL *a, RBD_REAL *da_dq,
                                                   RBD_REAL *da_dv, RBD_REAL *Minv) {
    rbdi_task t = rbdi_task_of(q, v, tau, f_ext);
    rbdi_task_output(&t, 0, a, rbd_nv(m));
    rbdi_task_output(&t, 1, da_dq, rbd_nv(m) * rbd_nv(m));
    rbdi_task_output(&t, 2, da_dv, rbd_nv(m) * rbd_nv(m));
    rbdi_task_output(&t, 3, Minv, rbd_nv(m) * rbd_nv(m));
    return rbdi_batch_derivatives_run(rbdi_lanes_fd_derivatives, m, d, n, &t);
}

RBDI_LOCAL rbd_status rbdi_lanes_regressor(const rbd_model *m, const rbdi_task *t) {
    return rbd_regressor(m, (rbd_derivatives *)t->more, t->x[0], t->x[1], t->x[2], t->y[0]);
}

RBDI_BATCH_API rbd_status rbd_batch_regressor(const rbd_model *m, rbd_batch_derivatives *d, int n,
                                              const RBD_REAL *q, const RBD_REAL *v, const RBD_REAL *a,
                                              RBD_REAL *Y) {
    rbdi_task t = rbdi_task_of(q, v, a, NULL);
    rbdi_task_output(&t, 0, Y, m ? 10 * m->nb * m->nv : 0);
    return rbdi_batch_derivatives_run(rbdi_lanes_regressor, m, d, n, &t);
}

/* ==== src/rbd_batch.h ==== */
#endif

#if defined RBD_BATCH_IMPLEMENTATION && defined RBDI_BATCH_CONSTRAINTS && \
    !defined RBDI_BATCH_CONSTRAINTS_IMPLEMENTED
#define RBDI_BATCH_CONSTRAINTS_IMPLEMENTED

/* ==== src/batch/constraints.h ==== */
/* ---- constraints [constraints code] ---- */

struct rbd_batch_constraint_set {
    rbd_batch *b;
    rbd_constraint_set *set;
    rbd_real *y; /* outputs of RBD_LANES states */
};

RBDI_LOCAL size_t rbdi_batch_constraints_own(const rbd_model *m, int rows) {
    return RBDI_ALIGN + RBDI_ROUND(sizeof(rbd_batch_constraint_set)) +
           RBDI_ROUND(sizeof(rbd_real) * (size_t)(m->nv + rows));
}

RBDI_BATCH_API size_t rbd_batch_constraint_set_size(const rbd_model *m, const rbd_constraint *list, int n) {
    const size_t size = rbd_constraint_set_size(m, list, n);
    return size ? size + rbdi_batch_constraints_own(m, rbdi_rows_of(list, n)) : 0;
}

RBDI_BATCH_API rbd_status rbd_batch_constraint_set_init(const rbd_model *m, rbd_batch *b,
                                                        const rbd_constraint *list, int n, void *memory,
                                                        size_t size, rbd_batch_constraint_set **constraints,
                                                        rbd_report *report) {
    rbd_batch_constraint_set *c;
    rbd_constraint_set *inner = NULL;
    unsigned char *p, *at;
    const size_t needed = rbd_batch_constraint_set_size(m, list, n);
    const int room = memory && needed && size >= needed;
    rbd_status status;
    int rows = 0;
    if (constraints) *constraints = NULL;

    /* The set lies behind the struct and its outputs. Without room its init finds the error. */
    if (room) rows = rbdi_rows_of(list, n);
    p = at = room ? rbdi_aligned(memory) : (unsigned char *)memory;
    if (room) at += rbdi_batch_constraints_own(m, rows) - RBDI_ALIGN;

    status = rbd_constraint_set_init(m, b && constraints ? b->w : NULL, list, n, at,
                                     room ? rbd_constraint_set_size(m, list, n) : 0, &inner, report);
    if (status) return status;

    c = (rbd_batch_constraint_set *)rbdi_take(&p, 1, RBDI_ROUND(sizeof(rbd_batch_constraint_set)));
    c->b = b;
    c->set = inner;
    c->y = (rbd_real *)rbdi_take(&p, m->nv + rows, sizeof(rbd_real));
    *constraints = c;
    return RBD_OK;
}

RBDI_LOCAL rbd_status rbdi_lanes_constrained_fd(const rbd_model *m, const rbdi_task *t) {
    return rbd_constrained_fd(m, (rbd_constraint_set *)t->more, t->x[0], t->x[1], t->x[2], t->x[3], t->y[0],
                              t->y[1]);
}

RBDI_BATCH_API rbd_status rbd_batch_constrained_fd(const rbd_model *m, rbd_batch_constraint_set *c, int n,
                                                   const RBD_REAL *q, const RBD_REAL *v, const RBD_REAL *tau,
                                                   const RBD_REAL *f_ext, RBD_REAL *a, RBD_REAL *lambda) {
    rbdi_task t = rbdi_task_of(q, v, tau, f_ext);
    if (!m || !c || !v || !tau || !a) return RBD_ERR_NULL;

    rbdi_task_output(&t, 0, a, rbd_nv(m));
    rbdi_task_output(&t, 1, lambda, c->set->rows);
    t.more = c->set;
    return rbdi_batch_run(rbdi_lanes_constrained_fd, m, c->b, n, c->y, &t);
}

/* ==== src/rbd_batch.h ==== */
#endif

/* ==== src/base/letters_end.h ==== */
#pragma pop_macro("A")
#pragma pop_macro("C")
#pragma pop_macro("H")
#pragma pop_macro("J")
#pragma pop_macro("M")
#pragma pop_macro("Y")
