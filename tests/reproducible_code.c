/* reproducible_code.c - a hash over the results of all functions that rbd-codegen --reproducible --name code
   wrote. With -DBY_LIBRARY and -DMODEL_FILE the hash of rbd.h's results under RBD_REPRODUCIBLE, which is the
   same: reproducible_code.txt has it. ROBOT is the robot's name, REAL the scalar, LINK the link of jacobian
   and pose. */
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#define QUOTE_OF(x) #x
#define QUOTE(x) QUOTE_OF(x)
#define PASTE_OF(a, b) a##b
#define PASTE(a, b) PASTE_OF(a, b)

#ifdef BY_LIBRARY
#define RBD_REAL REAL
#define RBD_REPRODUCIBLE
#define RBD_IMPLEMENTATION
#include "rbd_derivatives.h"
#include MODEL_FILE
#elif defined __clang__ /* states are the same too */
#pragma clang fp contract(off)
#elif defined __GNUC__
#pragma GCC optimize("fp-contract=off")
#endif

#include "code_code.h"

enum { NB = CODE_NB, NQ = CODE_NQ, NV = CODE_NV, ROOM = 4 * NV * NV + NV };

#ifdef BY_LIBRARY
static const rbd_model *const m = &PASTE(ROBOT, _model);
static rbd_work *w;
static rbd_derivatives *d;
static const REAL *q_of_kinematics(const REAL *q) {
    rbd_kinematics(m, w, q, NULL, NULL);
    return q;
}
#define TIP rbd_body_index(m, QUOTE(LINK))
#define code_id(q, v, a, f, tau) rbd_rnea(m, w, q, v, a, f, tau)
#define code_bias(q, v, f, c) rbd_bias(m, w, q, v, f, c)
#define code_gravity_torque(q, tau) rbd_gravity_torque(m, w, q, tau)
#define code_mm(q, M) rbd_crba(m, w, q, M)
#define code_mm_packed(q, H) rbd_crba_packed(m, w, q, H)
#define code_minv(q, Minv) rbd_minverse(m, w, q, Minv)
#define code_fd(q, v, tau, f, a) rbd_aba(m, w, q, v, tau, f, a)
#define code_fd_cholesky(q, v, tau, f, a) rbd_fd_cholesky(m, w, q, v, tau, f, a)
#define code_id_derivatives(q, v, a, f, dq, dv) rbd_id_derivatives(m, d, q, v, a, f, dq, dv, NULL)
#define code_fd_derivatives(q, v, tau, f, a, dq, dv, Minv) \
    rbd_fd_derivatives(m, d, q, v, tau, f, a, dq, dv, Minv)
#define code_gravity_torque_derivatives(q, dq) rbd_gravity_torque_derivatives(m, d, q, dq)
#define code_coriolis(q, v, C) rbd_coriolis(m, d, q, v, C)
#define code_momentum_matrix(q, A) rbd_momentum_matrix(m, d, q, NULL, A, NULL)
#define code_com_jacobian(q, J) rbd_com_jacobian(m, d, q, J)
#define code_jacobian(q, J) (q_of_kinematics(q), rbd_jacobian(m, w, TIP, NULL, RBD_WORLD_AXES, J))
#define code_pose(q, R, p) (q_of_kinematics(q), rbd_body_pose(m, w, TIP, R, p))
#else
#define code_jacobian PASTE(code_jacobian_, LINK)
#define code_pose PASTE(code_pose_, LINK)
#endif

/* FNV-1a, over the bits of numbers, the least first. Both zeros count as one, and so do all that are no
   numbers. */
static void hash_bits(uint64_t *hash, uint64_t bits, int bytes) {
    for (int i = 0; i < bytes; i++) *hash = (*hash ^ (bits >> 8 * i & 255)) * UINT64_C(0x100000001b3);
}
static void hash_number(uint64_t *hash, REAL x) {
    union {
        REAL x;
        uint32_t single;
        uint64_t whole;
    } u;
    u.x = x == 0 ? 0 : x;
    if (x != x)
        hash_bits(hash, 1, 8);
    else
        hash_bits(hash, sizeof x == 4 ? u.single : u.whole, (int)sizeof x);
}

static REAL q[NQ], v[NV], a[NV], tau[NV], f_ext[6 * NB], out[ROOM];
static uint64_t hash = UINT64_C(0xcbf29ce484222325), seed = 1;

/* A call, its results behind a status that says whether it failed. */
#define RUN(call) (memset(out, 0, sizeof out), call, hash_out(0))
#define RUN_WITH_STATUS(call) (memset(out, 0, sizeof out), hash_out((call) != 0))
static void hash_out(int failed) {
    hash_bits(&hash, (uint64_t)failed, 1);
    for (int k = 0; k < ROOM; k++) hash_number(&hash, out[k]);
#ifdef EACH_CALL
    printf("%08lx%08lx\n", (unsigned long)(hash >> 32), (unsigned long)(hash & UINT32_MAX));
#endif
}

/* From -size to size, by Lehmer's generator. */
static void draw(REAL size, REAL *x, int n) {
    for (int k = 0; k < n; k++) {
        seed = seed * 48271u % 2147483647u;
        x[k] = size * (REAL)((double)(int64_t)(seed % 2097152u) / 1048576 - 1);
    }
}

/* States at random; all joints at multiples of 45 degrees, where quadrants meet; many turns away; zeros. */
enum { ORDINARY = 2, QUADRANTS = 2, TURNS, ZERO, STATES };
static void choose_state(int state) {
    static const REAL turned[STATES][4] = {{(REAL)0.5, (REAL)-0.5, (REAL)0.5, (REAL)0.5},
                                           {(REAL)0.6, 0, (REAL)0.8, 0},
                                           {0, (REAL)0.28, 0, (REAL)0.96},
                                           {0, 0, 0, 1},
                                           {0, 0, 0, 1}};
    const REAL size = state == ZERO ? 0 : 1;
    draw(state < ORDINARY ? 3 : state == TURNS ? (REAL)3e7 : 0, q, NQ);
    for (int k = 0; k < NQ && state == QUADRANTS; k++) q[k] = (REAL)(0.78539816339744831 * (k % 15 - 7));
    if (NQ > NV) draw(2 * size, q, 3), memcpy(q + 3, turned[state], sizeof turned[state]);
    draw(3 * size, v, NV), draw(9 * size, a, NV), draw(50 * size, tau, NV), draw(30 * size, f_ext, 6 * NB);
}

static void run_all(void) {
    REAL *o = out;
    const int n = NV * NV;
    RUN(code_id(q, v, a, f_ext, o));
    RUN(code_bias(q, v, f_ext, o));
    RUN(code_gravity_torque(q, o));
    RUN(code_mm(q, o));
    RUN(code_mm_packed(q, o));
    RUN_WITH_STATUS(code_minv(q, o));
    RUN_WITH_STATUS(code_fd(q, v, tau, f_ext, o));
    RUN_WITH_STATUS(code_fd_cholesky(q, v, tau, f_ext, o));
    RUN(code_id_derivatives(q, v, a, f_ext, o, o + n));
    RUN_WITH_STATUS(code_fd_derivatives(q, v, tau, f_ext, o, o + NV, o + NV + n, o + NV + 2 * n));
    RUN(code_gravity_torque_derivatives(q, o));
    RUN(code_coriolis(q, v, o));
    RUN(code_momentum_matrix(q, o));
    RUN(code_com_jacobian(q, o));
    RUN(code_jacobian(q, o));
    RUN(code_pose(q, o, o + 9));
}

int main(void) {
#ifdef BY_LIBRARY
    static unsigned char work[RBD_WORK_SIZE(NB, NV)], derivatives[RBD_DERIVATIVES_SIZE(NB, NV)];
    if (rbd_work_init(m, work, sizeof work, &w) ||
        rbd_derivatives_init(m, w, derivatives, sizeof derivatives, &d))
        return 1;
#endif
    for (int state = 0; state < STATES; state++) choose_state(state), run_all();
    printf("%s %s %08lx%08lx\n", QUOTE(REAL), QUOTE(ROBOT), (unsigned long)(hash >> 32),
           (unsigned long)(hash & UINT32_MAX));
    return 0;
}
