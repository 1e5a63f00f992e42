/* generated.h - what rbd-codegen wrote for one robot, CODE_ROBOT: CODE_HEADER declares it, its names begin
   with CODE, its scalar is CODE_REAL; WITH_DERIVATIVES: and its derivatives; CODE_FIXED: of the robot with a
   fixed base. Code for CODE_LANES states at once is given the same batches as lanes.h, which are brought lane
   by lane and back, or in blocks. SPDX-License-Identifier: MIT */
#include "../bench.h"
#include <string.h>
#include CODE_HEADER

#define FUNCTION(name) PASTE(CODE, _##name)
#define PASTE(a, b) PASTE_NOW(a, b)
#define PASTE_NOW(a, b) a##b

#define SCALAR CODE_REAL
#define N_LANES CODE_LANES
#define ONLY_ROBOT CODE_ROBOT
#define FIXED_BASE CODE_FIXED

enum { NQ = CODE_NQ, NV = CODE_NV, SQUARE = NV * NV };

#if CODE_LANES > 1
#define VARIANT GENERATED_LANES
#define BLOCKS_VARIANT GENERATED_BLOCKS
#define WIDTH BATCH
typedef FUNCTION(real) real;
#else
#define VARIANT GENERATED
#define WIDTH 1
typedef CODE_REAL real;
#endif

/* The states of one call: one, or as many as there are lanes. */
struct group {
    const real *q, *v, *x;
    real *out;
};

typedef rbd_status group_call(const struct group *g);

enum takes { ONLY_Q, STATE };
enum { PACKED = -1 }; /* as many results as the packed mass matrix has entries */

/* ---- states, brought as the code takes them ---- */

#if CODE_LANES > 1
enum { LARGEST = 3 * SQUARE, ALIGNMENT = 64 };

struct lane_memory {
    real q[NQ], v[NV], x[NV], out[LARGEST];
    bool blocks;
};

/* The states from s on; those beyond the last are the last once more. */
static void gather(const void *rows, int n, int s, int states, real *lanes) {
    const SCALAR *row[CODE_LANES];
    for (int j = 0; j < CODE_LANES; j++)
        row[j] = (const SCALAR *)rows + (s + j < states ? s + j : states - 1) * n;
    for (int k = 0; k < n; k++)
#if CODE_LANES == 2
        lanes[k] = (real){row[0][k], row[1][k]};
#elif CODE_LANES == 4
        lanes[k] = (real){row[0][k], row[1][k], row[2][k], row[3][k]};
#else
        lanes[k] =
            (real){row[0][k], row[1][k], row[2][k], row[3][k], row[4][k], row[5][k], row[6][k], row[7][k]};
#endif
}

static void scatter(const real *lanes, int n, int s, int states, SCALAR *rows) {
    for (int j = 0; j < CODE_LANES && s + j < states; j++)
        for (int k = 0; k < n; k++) rows[(s + j) * n + k] = lanes[k][j];
}

/* The states from s on stand in lanes already, the last block filled; a result of several parts is copied. */
static rbd_status run_block(group_call *call, int parts, int results, struct lane_memory *l, int s,
                            const SCALAR *q, const SCALAR *v, const SCALAR *x, SCALAR *out) {
    const struct group g = {(const real *)(q + s * NQ), (const real *)(v + s * NV),
                            (const real *)(x + s * NV), parts > 1 ? l->out : (real *)(out + s * results)};
    const rbd_status status = call(&g);
    for (int p = 0; p < parts && parts > 1; p++)
        memcpy(out + (p * BATCH + s) * results, l->out + p * results, (size_t)results * sizeof *l->out);
    return status;
}

/* parts: of the result, with so many numbers each for a state. */
static rbd_status run(group_call *call, enum takes takes, int parts, int results, const void *model,
                      void *work, int states, const void *q, const void *v, const void *x, void *out) {
    struct lane_memory *l = work;
    const struct group g = {l->q, l->v, l->x, l->out};
    if (results == PACKED) results = rbd_packed_size(model);
    for (int s = 0; s < states && l->blocks; s += CODE_LANES) {
        const rbd_status status = run_block(call, parts, results, l, s, q, v, x, out);
        if (status != RBD_OK) return status;
    }
    for (int s = 0; s < states && !l->blocks; s += CODE_LANES) {
        gather(q, NQ, s, states, l->q);
        if (takes == STATE) {
            gather(v, NV, s, states, l->v);
            gather(x, NV, s, states, l->x);
        }
        const rbd_status status = call(&g);
        if (status != RBD_OK) return status;
        for (int p = 0; p < parts; p++)
            scatter(l->out + p * results, results, s, states, (SCALAR *)out + p * BATCH * results);
    }
    return RBD_OK;
}

static rbd_status work_init(const void *model, void *memory, size_t size, void **work) {
    (void)model, (void)size;
    struct lane_memory *l =
        (void *)((unsigned char *)memory + (ALIGNMENT - (uintptr_t)memory % ALIGNMENT) % ALIGNMENT);
    l->blocks = false;
    *work = l;
    return RBD_OK;
}

#ifdef BLOCKS_LIBRARY
static rbd_status work_init_blocks(const void *model, void *memory, size_t size, void **work) {
    const rbd_status status = work_init(model, memory, size, work);
    ((struct lane_memory *)*work)->blocks = true;
    return status;
}
#endif

static size_t work_size(const void *model) {
    (void)model;
    return sizeof(struct lane_memory) + ALIGNMENT;
}

#else

static rbd_status run(group_call *call, enum takes takes, int parts, int results, const void *model,
                      void *work, int states, const void *q, const void *v, const void *x, void *out) {
    (void)takes, (void)parts, (void)results, (void)model, (void)work, (void)states;
    return call(&(struct group){q, v, x, out});
}

static rbd_status work_init(const void *model, void *memory, size_t size, void **work) {
    (void)model, (void)size;
    *work = memory;
    return RBD_OK;
}

static size_t work_size(const void *model) {
    (void)model;
    return 1;
}

#endif

/* As unknown to the compiler as for the other variants. */
static real gravity_now[3];

static rbd_status set_gravity(void *work, const double gravity[3]) {
    (void)work;
    for (int i = 0; i < 3; i++) gravity_now[i] = (real){0} + (CODE_REAL)gravity[i];
    return RBD_OK;
}

/* ---- the calls ---- */

/* Of a function that tells where M is singular. */
static inline rbd_status judged(int singular) { return singular ? RBD_ERR_SINGULAR : RBD_OK; }

/* Defines the call of the table for a group's. */
#define CALL(name, takes, parts, results) \
    static rbd_status call_##name(const void *model, void *work, int n, const void *q, const void *v, \
                                  const void *x, void *out) { \
        return run(group_##name, takes, parts, results, model, work, n, q, v, x, out); \
    }

static rbd_status group_id(const struct group *g) {
    FUNCTION(id)(g->q, g->v, g->x, gravity_now, g->out);
    return RBD_OK;
}
CALL(id, STATE, 1, NV)

static rbd_status group_mm(const struct group *g) {
    FUNCTION(mm)(g->q, g->out);
    return RBD_OK;
}
CALL(mm, ONLY_Q, 1, SQUARE)

static rbd_status group_mm_packed(const struct group *g) {
    FUNCTION(mm_packed)(g->q, g->out);
    return RBD_OK;
}
CALL(mm_packed, ONLY_Q, 1, PACKED)

static rbd_status group_fd(const struct group *g) {
    return judged(FUNCTION(fd)(g->q, g->v, g->x, gravity_now, g->out));
}
CALL(fd, STATE, 1, NV)

#ifdef WITH_DERIVATIVES
static rbd_status group_minv(const struct group *g) { return judged(FUNCTION(minv)(g->q, g->out)); }
CALL(minv, ONLY_Q, 1, SQUARE)

static rbd_status group_id_derivatives(const struct group *g) {
    FUNCTION(id_derivatives)(g->q, g->v, g->x, gravity_now, g->out, g->out + SQUARE);
    return RBD_OK;
}
CALL(id_derivatives, STATE, 2, SQUARE)

static rbd_status group_fd_derivatives(const struct group *g) {
    real a[NV], *by_v = g->out + SQUARE, *Minv = by_v + SQUARE;
    return judged(FUNCTION(fd_derivatives)(g->q, g->v, g->x, gravity_now, a, g->out, by_v, Minv));
}
CALL(fd_derivatives, STATE, 3, SQUARE)

#define DERIVATIVES \
    , [MINV] = call_minv, [ID_DERIVATIVES] = call_id_derivatives, [FD_DERIVATIVES] = call_fd_derivatives
#else
#define DERIVATIVES
#endif

#define CAN NULL
#define CALLS [ID] = call_id, [MM] = call_mm, [MM_PACKED] = call_mm_packed, [FD] = call_fd DERIVATIVES
