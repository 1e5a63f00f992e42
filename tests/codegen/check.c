/* check.c - generated code of the first ROBOTS of the chosen robots against rbd.h, on random and bad states.
   ROBOTS is 3 or 8, NAME what write.cpp was given, REAL the scalar, CODE_LANES the lanes. What is no number
   is wrong where rbd.h has one, and so is any status that is not rbd.h's. rbd.h judges pivots in one step,
   as generated code does. */
#define RBD_REAL REAL
#define RBD_STATIC
#define RBD_SPECIALISE
#define RBD_IMPLEMENTATION
#include "chosen.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PASTE_(a, b) a##b
#define PASTE(a, b) PASTE_(a, b)

#if CODE_LANES > 1
typedef REAL real __attribute__((vector_size(CODE_LANES * sizeof(REAL))));
#define LANE(x, j) ((x)[j])
#else
typedef REAL real;
#define LANE(x, j) ((void)(j), (x))
#endif

enum { RANDOM = 57, ZERO = RANDOM, NOT_A_NUMBER, LOCKED, STATES, MOST = 64 };

typedef struct code {
    void (*id)(const real *q, const real *v, const real *a, const real *f_ext, const real *gravity,
               real *tau);
    void (*bias)(const real *q, const real *v, const real *f_ext, const real *gravity, real *c);
    void (*gravity)(const real *q, const real *gravity, real *tau);
    void (*mm)(const real *q, real *M);
    void (*mm_packed)(const real *q, real *H);
    int (*fd)(const real *q, const real *v, const real *tau, const real *f_ext, const real *gravity, real *a);
    int (*fd_cholesky)(const real *q, const real *v, const real *tau, const real *f_ext, const real *gravity,
                       real *a);
} code;

#define ONE(n) \
    {PASTE(n, _id),        PASTE(n, _bias), PASTE(n, _gravity),    PASTE(n, _mm), \
     PASTE(n, _mm_packed), PASTE(n, _fd),   PASTE(n, _fd_cholesky)}
#define DECLARE(n) \
    void PASTE(n, _id)(const real *, const real *, const real *, const real *, const real *, real *); \
    void PASTE(n, _bias)(const real *, const real *, const real *, const real *, real *); \
    void PASTE(n, _gravity)(const real *, const real *, real *); \
    void PASTE(n, _mm)(const real *, real *); \
    void PASTE(n, _mm_packed)(const real *, real *); \
    int PASTE(n, _fd)(const real *, const real *, const real *, const real *, const real *, real *); \
    int PASTE(n, _fd_cholesky)(const real *, const real *, const real *, const real *, const real *, real *);
DECLARE(PASTE(NAME, 0))
DECLARE(PASTE(NAME, 1))
DECLARE(PASTE(NAME, 2))
#if ROBOTS > 3
DECLARE(PASTE(NAME, 3))
DECLARE(PASTE(NAME, 4))
DECLARE(PASTE(NAME, 5))
DECLARE(PASTE(NAME, 6))
DECLARE(PASTE(NAME, 7))
#endif
static const code codes[ROBOTS] = {
    ONE(PASTE(NAME, 0)), ONE(PASTE(NAME, 1)), ONE(PASTE(NAME, 2)),
#if ROBOTS > 3
    ONE(PASTE(NAME, 3)), ONE(PASTE(NAME, 4)), ONE(PASTE(NAME, 5)), ONE(PASTE(NAME, 6)), ONE(PASTE(NAME, 7)),
#endif
};

/* ---- states: random ones; all zeros; NaN in the first coordinate; Euler angles in gimbal lock ---- */

static sample robot;
static sample_state states[STATES];
static const rbd_model *m;
static rbd_work *w;
static int failures, singular, skipped;
static double worst;

static void draw_states(void) {
    for (int k = 0; k < STATES; k++) draw_state(&robot, &states[k]);
    memset(states[ZERO].q, 0, sizeof states[ZERO].q);
    states[NOT_A_NUMBER] = states[0];
    states[NOT_A_NUMBER].q[0] = nan("");
    states[LOCKED].q[1] = acos(-1) / 2;
}

/* ---- comparison, relative to the largest entry ---- */

static void compare(const char *what, int state, const REAL *right, const real *found, int n, int lane,
                    double tolerance) {
    double largest = 0;
    for (int k = 0; k < n; k++) largest = fmax(largest, fabs((double)right[k]));
    for (int k = 0; k < n; k++) {
        const double error =
            fabs((double)LANE(found[k], lane) - (double)right[k]) / (largest > 0 ? largest : 1);
        if (isnan(right[k]) && isnan(error)) continue;
        if (!(error <= tolerance)) {
            if (failures++ < 10)
                printf("%s: state %d, lane %d, entry %d: %.17g, not %.17g, tolerance %g\n", what, state, lane,
                       k, (double)LANE(found[k], lane), (double)right[k], tolerance);
        } else if (error / tolerance > worst)
            worst = error / tolerance;
    }
}

/* Condition number of M in the norm of the largest column sum. */
static double condition(const REAL *M) {
    static REAL L[MOST * MOST], x[MOST];
    const int n = rbd_nv(m);
    double norm = 0, inverse = 0;
    if (rbd_cholesky_factor(m, w, M, L) != RBD_OK) return HUGE_VAL;
    for (int j = 0; j < n; j++) {
        double column = 0, column_of_inverse = 0;
        memset(x, 0, sizeof x);
        x[j] = 1;
        rbd_cholesky_solve(m, w, L, x, x);
        for (int i = 0; i < n; i++)
            column += fabs((double)M[n * i + j]), column_of_inverse += fabs((double)x[i]);
        norm = fmax(norm, column);
        inverse = fmax(inverse, column_of_inverse);
    }
    return norm * inverse;
}

static int expected_status(rbd_status status) {
    if (status == RBD_OK) return 0;
    return status == RBD_ERR_NAN ? -1 - rbd_singular_dof(w) : 1 + rbd_singular_dof(w);
}

/* ---- random states k, k + 1 and so on in the lanes; of the bad ones one, in the last ---- */

static real q[5 * WORLD_BODIES + WORLD_COORDINATES], v[MOST], a[MOST], tau[MOST], f_ext[6 * WORLD_BODIES],
    gravity[3], found[MOST * MOST];

static int state_of(int k, int lane) {
    return k >= RANDOM && lane == CODE_LANES - 1 ? k : (k + lane) % RANDOM;
}

static void give(const double *x, int n, int lane, real *y) {
    for (int k = 0; k < n; k++) {
#if CODE_LANES > 1
        y[k][lane] = (REAL)x[k];
#else
        y[k] = (REAL)x[k];
        (void)lane;
#endif
    }
}

static void check_status(const char *what, int k, int found_status, int status) {
    if (found_status == status) return;
    if (failures++ < 10) printf("%s: state %d: status %d, not %d\n", what, k, found_status, status);
}

enum { ID, BIAS, GRAVITY, MM, MM_PACKED, FD, FD_CHOLESKY, CALLS };
static const char *const names[CALLS] = {"id", "bias", "gravity", "mm", "mm_packed", "fd", "fd_cholesky"};

static int run_code(const code *c, int call) {
    switch (call) {
    case ID: c->id(q, v, a, f_ext, gravity, found); break;
    case BIAS: c->bias(q, v, f_ext, gravity, found); break;
    case GRAVITY: c->gravity(q, gravity, found); break;
    case MM: c->mm(q, found); break;
    case MM_PACKED: c->mm_packed(q, found); break;
    case FD: return c->fd(q, v, tau, f_ext, gravity, found);
    default: return c->fd_cholesky(q, v, tau, f_ext, gravity, found);
    }
    return 0;
}

static rbd_status run_rbd(const sample_state *s, int call, REAL *out) {
    static REAL x[WORLD_COORDINATES], xv[MOST], xa[MOST], xtau[MOST], wrenches[6 * WORLD_BODIES], g[3];
    for (int k = 0; k < robot.nq; k++) x[k] = (REAL)s->q[k];
    for (int k = 0; k < robot.nv; k++)
        xv[k] = (REAL)s->v[k], xa[k] = (REAL)s->a[k], xtau[k] = (REAL)s->tau[k];
    for (int k = 0; k < 6 * robot.nb; k++) wrenches[k] = (REAL)s->f_ext[k];
    for (int k = 0; k < 3; k++) g[k] = (REAL)s->gravity[k];
    rbd_set_gravity(w, g);
    switch (call) {
    case ID: return rbd_rnea(m, w, x, xv, xa, wrenches, out);
    case BIAS: return rbd_bias(m, w, x, xv, wrenches, out);
    case GRAVITY: return rbd_gravity(m, w, x, out);
    case MM: return rbd_crba(m, w, x, out);
    case MM_PACKED: return rbd_crba_packed(m, w, x, out);
    case FD: return rbd_aba(m, w, x, xv, xtau, wrenches, out);
    default: return rbd_fd_cholesky(m, w, x, xv, xtau, wrenches, out);
    }
}

static int size_of(int call) {
    const int nv = rbd_nv(m);
    return call == MM ? nv * nv : call == MM_PACKED ? rbd_packed_size(m) : nv;
}

/* Of the results of M^-1 relative to the largest. */
static double tolerance_of(int state, int call) {
    static REAL M[MOST * MOST];
    const sample_state *s = &states[state == NOT_A_NUMBER ? 0 : state];
    const double eps = sizeof(REAL) == 4 ? 1e-7 : 2e-16;
    if (call < FD || state == LOCKED) return 5e4 * eps;
    run_rbd(s, MM, M);
    return fmax(5e4 * eps, 10 * eps * condition(M));
}

static void check(const code *c, int k, int call) {
    static REAL right[MOST * MOST];
    int status = 0, expected = 0;
    for (int lane = 0; lane < CODE_LANES; lane++) {
        const sample_state *s = &states[state_of(k, lane)];
        if (!(tolerance_of(state_of(k, lane), call) < 0.1)) { /* the scalar can tell nothing of M^-1 */
            skipped++;
            return;
        }
        give(s->q, robot.nq, lane, q);
        give(s->v, robot.nv, lane, v);
        give(s->a, robot.nv, lane, a);
        give(s->tau, robot.nv, lane, tau);
        give(s->f_ext, 6 * robot.nb, lane, f_ext);
        give(s->gravity, 3, lane, gravity);
    }
    status = run_code(c, call);
    for (int lane = 0; lane < CODE_LANES; lane++) {
        const sample_state *s = &states[state_of(k, lane)];
        const double tolerance = tolerance_of(state_of(k, lane), call);
        expected = expected_status(run_rbd(s, call, right));
        compare(names[call], k, right, found, size_of(call), lane, tolerance);
    }
    check_status(names[call], k, status, expected);
    singular += expected > 0;
}

int main(void) {
    static unsigned char model_memory[RBD_MODEL_SIZE(WORLD_BODIES)];
    static unsigned char work_memory[RBD_WORK_SIZE_MIMIC(WORLD_BODIES, MOST)] __attribute__((aligned(64)));
    for (int r = 0; r < ROBOTS; r++) {
        choose_robot(&robot, r);
        if (rbd_model_build(robot.bodies, robot.nb, model_memory, sizeof model_memory, &m, NULL) != RBD_OK ||
            rbd_work_init(m, work_memory, sizeof work_memory, &w) != RBD_OK)
            return 1;
        draw_states();
        worst = 0;
        for (int k = 0; k < STATES; k++)
            for (int call = 0; call < CALLS; call++)
                if (k < LOCKED || r == 0) check(&codes[r], k, call);
        printf("robot %d: largest error %.2g of its tolerance\n", r, worst);
    }
    if (!singular) puts("no singular state among them");
    printf("%d skipped\n", skipped);
    return failures != 0 || !singular || skipped > RANDOM * ROBOTS * CODE_LANES / 5;
}
