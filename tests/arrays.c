/* arrays.c - every description of up to three bodies (all joint types, parents, and joints that follow
   others), built and run through every algorithm, where each array of model, work, input and output is an
   object of its own and exactly as long as stated: under the sanitizers no access can leave an array for its
   neighbour, and no index, size or shift overflows. The numbers are two sets, one of them with parallel axes,
   zeros and a singular mass matrix.
   usage: arrays [SHARE]: of the descriptions of three bodies only every SHARE-th */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_ARRAYS = 256, MAX_NB = 3, MAX_V = 6 * MAX_NB };
static void *arrays[MAX_ARRAYS];
static int array_count;

static void *own_array(size_t bytes) {
    void *array = malloc(bytes);
    if (!array || array_count == MAX_ARRAYS) {
        printf("FAILED: no memory for an array\n");
        exit(EXIT_FAILURE);
    }
    return arrays[array_count++] = array;
}
#include "proof/arrays.h"
#include "rbd_derivatives.h"
#include "plain_calls.h"

static void free_arrays(void) {
    while (array_count > 0) free(arrays[--array_count]);
}

static rbd_body bodies[MAX_NB];
static int nb;
static long built, refused;

static void claim(int condition, const char *what) {
    if (condition) return;
    printf("FAILED: %s:", what);
    for (int i = 0; i < nb; i++)
        printf(" type %d, parent %d, follows %s;", (int)bodies[i].type, bodies[i].parent,
               bodies[i].mimic ? bodies[i].mimic : "none");
    printf("\n");
    exit(EXIT_FAILURE);
}
#define CLAIM(condition) claim(condition, #condition)

static rbd_real *numbers(int n) {
    rbd_real *x = own_array((size_t)n * sizeof *x);
    for (int i = 0; i < n; i++) x[i] = (rbd_real)0.3 + (rbd_real)0.1 * (rbd_real)i;
    return x;
}

/* ---- the plain calls ---- */

/* The arrays of one model's calls, by their use and length. */
static struct {
    int use, n;
    rbd_real *x;
} known[MAX_ARRAYS];
static int known_count;

enum { FIRST_CONFIGURATION = 100, WEIGHT = 200, FIRST_RESULT = 300 };

static rbd_real *array_for(int use, int n) {
    for (int i = 0; i < known_count; i++)
        if (known[i].use == use && known[i].n == n) return known[i].x;
    known[known_count].use = use;
    known[known_count].n = n;
    return known[known_count++].x = numbers(n);
}

#define MODEL m
#define WORK w
#define DERIVATIVES d
#define BODY b
#define OTHER_BODY nb - 1 - b
#define AXES (rbd_axes) axes
#define NUMBER (rbd_real)0.01
#define NQ rbd_nq(m)
#define NV rbd_nv(m)
#define NB nb
#define NH rbd_packed_size(m)
#define Q(k) array_for(FIRST_CONFIGURATION + k, NQ)
#define IN(k, n) array_for(k, n)
#define WEIGHTS(n) array_for(WEIGHT, n)
#define OUT(at, n) array_for(FIRST_RESULT + (at), n)
#define RUN_OF_BODY(header, name, may_fail, arguments, total) \
    { \
        const rbd_status status = name arguments; \
        claim(status == RBD_OK || (may_fail && status == RBD_ERR_SINGULAR), #name); \
    }
#define RUN_PLAIN(header, name, may_fail, arguments, total) \
    CLAIM(rbd_kinematics(m, w, Q(0), IN(0, NV), IN(1, NV)) == RBD_OK); \
    RUN_OF_BODY(header, name, may_fail, arguments, total)

static void run_plain(const rbd_model *m, rbd_work *w, rbd_derivatives *d) {
    known_count = 0;
    PLAIN_CALLS(RUN_PLAIN)
    CLAIM(rbd_kinematics(m, w, Q(0), IN(0, NV), IN(1, NV)) == RBD_OK);
    for (int b = 0; b < nb; b++)
        for (int axes = RBD_WORLD_AXES; axes <= RBD_LINK_AXES; axes++) {
            BODY_CALLS(RUN_OF_BODY)
        }
}

/* ---- the others ---- */

static void run_algorithms(const rbd_model *m, rbd_work *w, rbd_derivatives *d) {
    const int nq = rbd_nq(m), nv = rbd_nv(m);
    rbd_real *q = numbers(nq), *v = numbers(nv), *f = numbers(6 * nb), *out = numbers(nv),
             *next = numbers(nq), *M = numbers(nv * nv), *H = numbers(rbd_packed_size(m)), *x = numbers(6);
    for (int way = 0; way < 2; way++) { /* every second dof; all but those on the world */
        unsigned char *given = own_array((size_t)nv);
        for (int k = 0; k < nv; k++) given[k] = way ? m->link[0].iv != k : k % 2 == 0;
        (void)rbd_hybrid(m, w, q, v, given, out, numbers(nv), f);
    }
    (void)rbd_id_free_base(m, d, q, v, numbers(nv), numbers(nv), f); /* may be singular */
    CLAIM(rbd_crba(m, w, q, M) == RBD_OK);
    CLAIM(rbd_crba_packed(m, w, q, H) == RBD_OK);
    (void)rbd_cholesky_factor_packed(m, w, H);
    (void)rbd_cholesky_factor(m, w, M, H);
    CLAIM(rbd_cholesky_solve(m, w, H, v, out) == RBD_OK);
    CLAIM(rbd_cholesky_solve_many(m, w, H, nv, M, M) == RBD_OK);
    CLAIM(rbd_kinematics(m, w, q, v, v) == RBD_OK);
    CLAIM(rbd_point_acceleration(m, w, 0, NULL, RBD_LINK_AXES, x) == RBD_OK);
    CLAIM(rbd_point_wrench(m, w, 0, x, RBD_LINK_AXES, x, x) == RBD_OK);
    CLAIM(rbd_integrate(m, q, v, (rbd_real)0.01, next) == RBD_OK);
    CLAIM(rbd_interpolate(m, q, next, (rbd_real)0.5, next) == RBD_OK);
    CLAIM(rbd_rates_from_velocity(m, q, v, next) == RBD_OK);
    CLAIM(rbd_velocity_from_rates(m, q, next, out) == RBD_OK);
    uint64_t seed = 1;
    CLAIM(rbd_random(m, &seed, q) == RBD_OK);
}

static void run_lookup(const rbd_model *m) {
    const int nv = rbd_nv(m), size = rbd_packed_size(m);
    CLAIM(size >= nv && size <= nv * (nv + 1) / 2);
    for (int i = -1; i <= nv; i++) {
        CLAIM(i < 0 || i == nv ? rbd_dof_body(m, i) == -1
                               : rbd_dof_body(m, i) >= 0 && rbd_dof_body(m, i) < nb);
        for (int j = -1; j <= nv; j++) {
            const int at = rbd_packed_index(m, i, j), valid = i >= 0 && j >= 0 && i < nv && j < nv;
            CLAIM(at >= -1 && at < size && (valid || at == -1) && (!valid || i != j || at >= 0));
        }
    }
    for (int b = 0; b < nb; b++) {
        rbd_joint_info joint;
        rbd_body row;
        CLAIM(rbd_describe(m, b, &row) == RBD_OK);
        CLAIM(rbd_joint(m, b, &joint) == RBD_OK);
        CLAIM(joint.nv == 0 ? joint.iq == -1 && joint.iv == -1
                            : joint.iq >= 0 && joint.iq + joint.nq <= rbd_nq(m) && joint.iv >= 0 &&
                                  joint.iv + joint.nv <= nv);
        CLAIM(rbd_body_index(m, bodies[b].name) == b);
    }
}

/* The sizes that rbd.h states for any model of so many bodies and dofs. */
static size_t work_bound(const rbd_model *m) {
    int mimics = 0;
    for (int b = 0; b < nb; b++) mimics += bodies[b].mimic != NULL;
    return mimics ? RBD_WORK_SIZE_MIMIC(nb, rbd_nv(m)) : RBD_WORK_SIZE(nb, rbd_nv(m));
}

/* Each joint held alone, in a description of its own length. */
static void run_lock(void) {
    rbd_body *rows = own_array((size_t)nb * sizeof *rows);
    unsigned char *locked = own_array((size_t)nb);
    int nq = 0;
    for (int i = 0; i < nb; i++) nq += bodies[i].mimic ? 0 : rbdi_joint_facts((int)bodies[i].type)->nq;
    double *q = own_array((size_t)nq * sizeof *q);
    for (int k = 0; k < nq; k++) q[k] = 0.3 + 0.1 * k;
    for (int held = 0; held < nb; held++) {
        for (int i = 0; i < nb; i++) locked[i] = i == held;
        CLAIM(rbd_lock_joints(bodies, nb, locked, q, rows, NULL) == RBD_OK);
        CLAIM(rows[held].type == RBD_FIXED);
    }
}

static void run(void) {
    static unsigned char memory[1]; /* only its address counts */
    const rbd_model *m;
    rbd_work *w;
    size_t size = rbd_model_size(bodies, nb);
    taken = 0;
    if (rbd_model_build(bodies, nb, memory, size, &m, NULL) != RBD_OK) {
        refused++;
        return free_arrays();
    }
    built++;
    run_lock();
    CLAIM(size <= RBD_MODEL_SIZE(nb));
    CLAIM(taken + RBDI_ALIGN <= size);
    run_lookup(m);
    size = rbd_work_size(m);
    taken = 0;
    CLAIM(rbd_work_init(m, memory, size, &w) == RBD_OK);
    CLAIM(size <= work_bound(m));
    CLAIM(taken + RBDI_ALIGN <= size);
    size = rbd_derivatives_size(m);
    taken = 0;
    rbd_derivatives *d;
    CLAIM(rbd_derivatives_init(m, w, memory, size, &d) == RBD_OK);
    CLAIM(taken + RBDI_ALIGN <= size);
    run_plain(m, w, d);
    run_algorithms(m, w, d);
    free_arrays();
}

static void describe(int i, int type, int parent, int follows, int skew) {
    static const char *const names[MAX_NB] = {"a", "b", "c"};
    rbd_body *b = &bodies[i];
    memset(b, 0, sizeof *b);
    b->name = b->joint = names[i];
    b->parent = parent;
    b->type = (rbd_joint_type)type;
    b->mimic = follows < 0 ? NULL : names[follows];
    b->mimic_ratio = 0.5;
    b->mass = 1;
    b->com[2] = 0.1;
    if (type != RBD_FIXED) /* which must not have an axis */
        b->axis[2] = b->axis2[1] = 1;
    if (!skew) return;
    if (type != RBD_FIXED) b->axis[0] = 0.2 + 0.1 * i, b->axis[1] = -0.3;
    b->pitch = 0.1;
    b->position[0] = 0.3, b->position[1] = 0.1, b->position[2] = -0.2;
    b->com[0] = 0.05;
    b->inertia[0] = b->inertia[3] = b->inertia[5] = 0.01;
    for (int k = 0; k < 6; k++) b->armature[k] = 0.1;
}

int main(int argc, char **argv) {
    const long share = argc > 1 ? atol(argv[1]) : 1;
    long number = 0;
    for (int skew = 0; skew < 2; skew++)
        for (nb = 1; nb <= MAX_NB; nb++) {
            int follow_patterns = 1, types = 1, parents = 1;
            for (int i = 0; i < nb; i++) follow_patterns *= nb, types *= RBD_JOINT_TYPES, parents *= i + 1;
            for (int t = 0; t < types; t++)
                for (int p = 0; p < parents; p++)
                    for (int f = 0; f < follow_patterns; f++) {
                        if (nb == MAX_NB && number++ % share != 0) continue;
                        for (int i = 0, a = t, b = p, c = f; i < nb; i++) {
                            describe(i, a % RBD_JOINT_TYPES, b % (i + 1) - 1, c % nb == i ? -1 : c % nb,
                                     skew);
                            a /= RBD_JOINT_TYPES, b /= i + 1, c /= nb;
                        }
                        run();
                    }
        }
    printf("%ld models built, %ld descriptions refused\n", built, refused);
    return built > 0 && refused > 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
