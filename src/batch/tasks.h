#ifndef RBDI_BATCH_TASKS_H
#define RBDI_BATCH_TASKS_H
#include "model/calls.h"
#include "api/batch.h"
#include "batch/lanes.h"

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

#endif
