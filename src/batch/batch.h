#ifndef RBDI_BATCH_BATCH_H
#define RBDI_BATCH_BATCH_H
#include "api/model.h"
#include "api/dynamics.h"
#include "api/kinematics.h"
#include "api/lookup.h"
#include "api/batch.h"
#include "base/memory.h"
#include "model/calls.h"

/* Interface: rbdi_batch_run, rbdi_task, rbdi_task_of, rbdi_task_output */

/* ---- batches [batch code] ---- */

#ifdef RBD_BATCH_IMPLEMENTATION
#ifndef RBD_LANES
#error "RBD_BATCH_IMPLEMENTATION needs RBD_LANES"
#endif

RBDI_EXTERN_C_BEGIN

enum { RBDI_ARGUMENTS = 4 };

struct rbd_batch {
    rbd_work *w;
    rbd_real *x[RBDI_ARGUMENTS], *y; /* inputs and outputs of the states at hand, a lane each */
    int state, dof;                  /* first singular state of the last call, -1 = none */
    rbd_layout layout;
};

/* A call: its inputs q, v, a (or tau) and f_ext, its outputs with the lengths of their rows, of all states;
   and of those at hand in lanes. NULL = none. */
typedef struct rbdi_task {
    const RBD_REAL *in[RBDI_ARGUMENTS];
    RBD_REAL *out[RBDI_ARGUMENTS];
    int width[RBDI_ARGUMENTS];
    const rbd_real *x[RBDI_ARGUMENTS];
    rbd_real *y[RBDI_ARGUMENTS];
    rbd_work *w;
    void *more; /* what else the call needs */
} rbdi_task;
typedef rbd_status rbdi_lane_call(const rbd_model *m, const rbdi_task *t);

/* Components of an input. */
static int rbdi_batch_width(const rbd_model *m, int k) { return k == 0 ? m->nq : k < 3 ? m->nv : 6 * m->nb; }
/* Largest outputs of a call: M, or a Jacobian, or a momentum and its rate. */
static int rbdi_batch_output(const rbd_model *m) { return (m->nv > 6 ? m->nv : 6) * m->nv + 12; }

/* Transposes RBD_LANES vectors in place by exchanging ever larger blocks off the diagonal. */
#if RBDI_HAS_SHUFFLE && (RBD_LANES == 2 || RBD_LANES == 4 || RBD_LANES == 8)
#if RBD_LANES == 2
#define RBDI_EACH_LANE(f, step) f(0, step), f(1, step)
#elif RBD_LANES == 4
#define RBDI_EACH_LANE(f, step) f(0, step), f(1, step), f(2, step), f(3, step)
#else
#define RBDI_EACH_LANE(f, step) \
    f(0, step), f(1, step), f(2, step), f(3, step), f(4, step), f(5, step), f(6, step), f(7, step)
#endif
#define RBDI_LOW_BLOCKS(i, step) ((i) & (step) ? RBD_LANES + (i) - (step) : (i))
#define RBDI_HIGH_BLOCKS(i, step) ((i) & (step) ? RBD_LANES + (i) : (i) + (step))
#define RBDI_EXCHANGE(x, step) \
    for (int i = 0; i < RBD_LANES; ++i) \
        if (!(i & (step))) { \
            const rbd_real a = x[i], b = x[i + (step)]; \
            x[i] = __builtin_shufflevector(a, b, RBDI_EACH_LANE(RBDI_LOW_BLOCKS, step)); \
            x[i + (step)] = __builtin_shufflevector(a, b, RBDI_EACH_LANE(RBDI_HIGH_BLOCKS, step)); \
        }
RBDI_INLINE void rbdi_transpose_lanes(rbd_real x[RBD_LANES]) {
    RBDI_EXCHANGE(x, 1)
#if RBD_LANES >= 4
    RBDI_EXCHANGE(x, 2)
#endif
#if RBD_LANES >= 8
    RBDI_EXCHANGE(x, 4)
#endif
}
#else
RBDI_INLINE void rbdi_transpose_lanes(rbd_real x[RBD_LANES]) {
    for (int i = 0; i < RBD_LANES; ++i)
        for (int j = 0; j < i; ++j) {
            const RBD_REAL t = x[i][j];
            x[i][j] = x[j][i];
            x[j][i] = t;
        }
}
#endif

typedef RBD_REAL rbdi_lane_row
    __attribute__((vector_size(sizeof(rbd_real)), aligned(sizeof(RBD_REAL)), may_alias));

/* x[k] lane s = component k of state s, of `width` components; the lanes of states beyond the rest repeat the
   last one. Rows go in blocks of RBD_LANES columns; the last block may overlap the one before. The rows of
   the next states are fetched meanwhile: the processor does not foresee so many streams. */
static void rbdi_gather(const RBD_REAL *in, int width, int blocks, int rest, rbd_real *x) {
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

/* The reverse, of the first count states. */
static void rbdi_scatter(const rbd_real *x, int width, int blocks, int count, RBD_REAL *out) {
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

/* Whether a call can work where the caller has these states: in a whole block, where lanes may stand. */
static int rbdi_usable(const rbd_batch *b, const RBD_REAL *x, int rest) {
    return b->layout == RBD_BLOCKS && rest >= RBD_LANES && (uintptr_t)x % sizeof(rbd_real) == 0;
}

/* The inputs of the states from s on, in lanes. */
static void rbdi_task_gather(const rbd_model *m, rbdi_task *t, const rbd_batch *b, int s, int rest) {
    for (int k = 0; k < RBDI_ARGUMENTS; ++k) {
        const int width = rbdi_batch_width(m, k);
        const RBD_REAL *x = t->in[k] ? t->in[k] + (size_t)s * (size_t)width : NULL;
        const int usable = !x || rbdi_usable(b, x, rest);
        t->x[k] = usable ? (const rbd_real *)x : b->x[k];
        if (!usable) rbdi_gather(x, width, b->layout == RBD_BLOCKS, rest, b->x[k]);
    }
}

/* Where the outputs of the states from s on go: to the caller, or to y, from where rbdi_task_scatter takes
   them. */
static void rbdi_task_aim(rbdi_task *t, const rbd_batch *b, rbd_real *y, int s, int rest) {
    for (int k = 0; k < RBDI_ARGUMENTS; y += t->width[k++]) {
        RBD_REAL *out = t->out[k] ? t->out[k] + (size_t)s * (size_t)t->width[k] : NULL;
        t->y[k] = !out || rbdi_usable(b, out, rest) ? (rbd_real *)out : y;
    }
}
static void rbdi_task_scatter(const rbdi_task *t, const rbd_batch *b, int s, int count) {
    for (int k = 0; k < RBDI_ARGUMENTS; ++k) {
        RBD_REAL *out = t->out[k] ? t->out[k] + (size_t)s * (size_t)t->width[k] : NULL;
        if ((RBD_REAL *)t->y[k] == out) continue;
        rbdi_scatter(t->y[k], t->width[k], b->layout == RBD_BLOCKS, count, out);
    }
}

/* Notes the first of these states that is singular. */
static void rbdi_note_singular(const rbd_model *m, rbd_batch *b, int first, int count) {
    for (int i = 0; i < count && b->state < 0; ++i)
        for (int k = m->nv - 1; k >= 0 && b->state < 0; --k)
            if (!(b->w->pivot[k][i] > 0)) b->state = first + i, b->dof = k; /* judged */
}

/* Runs a call on n states; y: lanes for its outputs, one after the other. */
static rbd_status rbdi_batch_run(rbdi_lane_call *call, const rbd_model *m, rbd_batch *b, int n, rbd_real *y,
                                 rbdi_task *t) {
    rbd_status result = b ? rbdi_check(m, b->w, t->in[0] != NULL) : RBD_ERR_NULL;
    if (result) return result;
    t->w = b->w;
    b->state = b->dof = -1;
    for (int s = 0; s < n; s += RBD_LANES) {
        const int count = n - s < RBD_LANES ? n - s : RBD_LANES;
        rbd_status status;
        rbdi_task_gather(m, t, b, s, n - s);
        rbdi_task_aim(t, b, y, s, n - s);
        status = call(m, t);
        if (status && status != RBD_ERR_SINGULAR && status != RBD_ERR_NAN && status != RBD_ERR_INFEASIBLE)
            return status;
        if (status) rbdi_note_singular(m, b, s, count), result = status;
        rbdi_task_scatter(t, b, s, count);
    }
    return result;
}

static rbdi_task rbdi_task_of(const RBD_REAL *q, const RBD_REAL *v, const RBD_REAL *a,
                              const RBD_REAL *f_ext) {
    rbdi_task t;
    t.in[0] = q, t.in[1] = v, t.in[2] = a, t.in[3] = f_ext;
    for (int k = 0; k < RBDI_ARGUMENTS; ++k) t.out[k] = NULL, t.width[k] = 0;
    t.w = NULL, t.more = NULL;
    return t;
}
static void rbdi_task_output(rbdi_task *t, int k, RBD_REAL *out, int width) {
    t->out[k] = out, t->width[k] = width;
}

/* A call with one output. */
static rbd_status rbdi_batch_one(rbdi_lane_call *call, const rbd_model *m, rbd_batch *b, int n,
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

#define RBDI_DEFINE_LANES(name, ...) \
    static rbd_status rbdi_lanes_##name(const rbd_model *m, const rbdi_task *t) { \
        return rbd_##name(m, t->w, t->x[0], __VA_ARGS__); \
    }
RBDI_DEFINE_LANES(rnea, t->x[1], t->x[2] ? t->x[2] : t->w->zero, t->x[3], t->y[0])
RBDI_DEFINE_LANES(aba, t->x[1], t->x[2], t->x[3], t->y[0])
RBDI_DEFINE_LANES(fd_cholesky, t->x[1], t->x[2], t->x[3], t->y[0])
RBDI_DEFINE_LANES(crba, t->y[0])
RBDI_DEFINE_LANES(crba_packed, t->y[0])
RBDI_DEFINE_LANES(minverse, t->y[0])

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

typedef struct rbdi_lane_point {
    int body;
    rbd_axes axes;
    const rbd_real *point;
} rbdi_lane_point;

static rbd_status rbdi_lanes_jacobian(const rbd_model *m, const rbdi_task *t) {
    const rbdi_lane_point *p = (const rbdi_lane_point *)t->more;
    (void)rbd_kinematics(m, t->w, t->x[0], NULL, NULL); /* arguments are checked */
    return rbd_jacobian(m, t->w, p->body, p->point, p->axes, t->y[0]);
}
RBDI_BATCH_API rbd_status rbd_batch_jacobian(const rbd_model *m, rbd_batch *b, int n, const RBD_REAL *q,
                                             int body, const RBD_REAL point[3], rbd_axes axes, RBD_REAL *J) {
    rbdi_task t = rbdi_task_of(q, NULL, NULL, NULL);
    rbdi_lane_point p;
    rbd_real lanes[3];
    for (int k = 0; k < 3; ++k) lanes[k] = rbdi_set(point ? point[k] : RBD_C(0));
    p.body = body, p.axes = axes, p.point = lanes;
    t.more = &p;
    rbdi_task_output(&t, 0, J, 6 * rbd_nv(m));
    return J ? rbdi_batch_run(rbdi_lanes_jacobian, m, b, n, b ? b->y : NULL, &t) : RBD_ERR_NULL;
}

static rbd_status rbdi_lanes_momentum(const rbd_model *m, const rbdi_task *t) {
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

RBDI_EXTERN_C_CLOSE
#endif /* RBD_BATCH_IMPLEMENTATION */

#endif
