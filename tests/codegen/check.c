/* check.c - generated code of the first ROBOTS of the chosen robots against rbd.h, on random and bad states.
   ROBOTS is 3, 8 or 10, NAME what write.cpp was given, REAL the scalar, CODE_LANES the lanes, CODE_BOUNDED
   whether angles are. NaN is wrong where rbd.h has a number, and so is any status that is not rbd.h's,
   except for angles out of bounds. */
#define RBD_REAL REAL
#if CODE_REPRODUCIBLE /* to the bit then, but for the signs of zeros */
#define RBD_REPRODUCIBLE
static int refined; /* whether rbd.h refined its rows, which generated code does not */
#define RBDI_NOTE_REFINED() (refined = 1)
#endif
#ifndef RBDI_IMPLEMENTED /* it is linked else */
#define RBD_STATIC
#endif
#define RBD_IMPLEMENTATION
#include "rbd_constraints.h"
#include "rbd_derivatives.h"

#include "chosen.h"
#include "../larger.h"

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

enum { RANDOM = 57, ZERO = RANDOM, NOT_A_NUMBER, LOCKED, BEYOND, STATES, MOST = 64 };

/* All functions, with their arguments, of robot n. */
typedef const real *in;
#if CODE_REPRODUCIBLE
#define DELTA(x, n)
#define CONSTRAINED_ID(x, n)
enum { call_delta = -2, call_constrained_id = -1 };
#else
#define DELTA(x, n) x(n, int, delta, (in q, real * Delta))
#define CONSTRAINED_ID(x, n) \
    x(n, int, constrained_id, (in q, in v, in a, in f_ext, in gravity, real * tau, real * lambda))
#endif
#define FUNCTIONS(x, n) \
    x(n, void, id, (in q, in v, in a, in f_ext, in gravity, real * tau)) x( \
        n, void, bias, (in q, in v, in f_ext, in gravity, real * c)) x(n, void, gravity_torque, \
                                                                       (in q, in gravity, real * tau)) \
        x(n, void, mm, (in q, real * M)) x(n, void, mm_packed, (in q, real * H)) x( \
            n, void, gravity_torque_derivatives, (in q, in gravity, real * dg_dq)) x(n, void, coriolis, \
                                                                                     (in q, in v, real * C)) \
            x(n, void, momentum_matrix, (in q, real * A)) x(n, void, com_jacobian, (in q, real * J)) x( \
                n, void, jacobian_tip, (in q, real * J)) x(n, void, pose_tip, (in q, real * R, real * p)) \
                x(n, void, id_derivatives, \
                  (in q, in v, in a, in f_ext, in gravity, real * dtau_dq, real * dtau_dv)) \
                    x(n, int, minv, (in q, real * Minv)) \
                        x(n, int, fd_derivatives, \
                          (in q, in v, in tau, in f_ext, in gravity, real * a, real * da_dq, real * da_dv, \
                           real * Minv)) x(n, int, fd, (in q, in v, in tau, in f_ext, in gravity, real * a)) \
                            x(n, int, fd_cholesky, (in q, in v, in tau, in f_ext, in gravity, real * a)) \
                                DELTA(x, n) \
                                    x(n, int, constrained, \
                                      (in q, in v, in tau, in f_ext, in gravity, real * a, real * lambda)) \
                                        x(n, int, impact, \
                                          (in q, in v, in restitution, real * v_plus, real * impulse)) \
                                            CONSTRAINED_ID(x, n)

#define NUMBER(n, result, function, arguments) call_##function,
enum { FUNCTIONS(NUMBER, ) CALLS, FIRST_WITH_PIVOTS = call_minv, FIRST_HELD = call_constrained };
#define WORD(n, result, function, arguments) #function,
static const char *const names[CALLS] = {FUNCTIONS(WORD, )};
#define POINTER(n, result, function, arguments) result(*function) arguments;
typedef struct code {
    FUNCTIONS(POINTER, )
} code;

#define DECLARATION(n, result, function, arguments) result PASTE(PASTE(NAME, n), _##function) arguments;
#define ENTRY(n, result, function, arguments) PASTE(PASTE(NAME, n), _##function),
FUNCTIONS(DECLARATION, 0)
FUNCTIONS(DECLARATION, 1)
FUNCTIONS(DECLARATION, 2)
#if ROBOTS > 3
FUNCTIONS(DECLARATION, 3)
FUNCTIONS(DECLARATION, 4)
FUNCTIONS(DECLARATION, 5)
FUNCTIONS(DECLARATION, 6)
FUNCTIONS(DECLARATION, 7)
#endif
#if ROBOTS > 8
FUNCTIONS(DECLARATION, 8)
FUNCTIONS(DECLARATION, 9)
#endif
static const code codes[ROBOTS] = {
    {FUNCTIONS(ENTRY, 0)}, {FUNCTIONS(ENTRY, 1)}, {FUNCTIONS(ENTRY, 2)},
#if ROBOTS > 3
    {FUNCTIONS(ENTRY, 3)}, {FUNCTIONS(ENTRY, 4)}, {FUNCTIONS(ENTRY, 5)},
    {FUNCTIONS(ENTRY, 6)}, {FUNCTIONS(ENTRY, 7)},
#endif
#if ROBOTS > 8
    {FUNCTIONS(ENTRY, 8)}, {FUNCTIONS(ENTRY, 9)},
#endif
};

/* ---- states: random ones; all zeros; NaN in the first coordinate; Euler angles in gimbal lock; an angle
   out of bounds ---- */

static sample robot;
static sample_state states[STATES];
static const rbd_model *m;
static rbd_work *w;
static rbd_derivatives *d;
static rbd_constraint_set *set;
static unsigned char motors[MOST];
static int unlike;      /* random states that constrained_id refuses */
static int in_doubt[2]; /* states in which rows held twice are refused, and other rows */
static int failures, singular, skipped, refused[CALLS];
static double worst;

static void draw_states(void) {
    for (int k = 0; k < STATES; k++) draw_state(&robot, &states[k]);
    memset(states[ZERO].q, 0, sizeof states[ZERO].q);
    states[NOT_A_NUMBER] = states[0];
    states[NOT_A_NUMBER].q[0] = nan("");
    states[LOCKED].q[1] = acos(-1) / 2;
    states[BEYOND] = states[0];
}

/* Whether q[k] is an angle that turns something. */
static int is_angle(int k) {
    for (int b = 0; b < rbd_nb(m); b++) {
        rbd_joint_info j;
        rbd_joint(m, b, &j);
        if (k < j.iq || k >= j.iq + j.nq) continue;
        switch (j.type) {
        case RBD_REVOLUTE:
        case RBD_CONTINUOUS:
        case RBD_HELICAL:
        case RBD_UNIVERSAL:
        case RBD_EULER_ZYX:
        case RBD_EULER_XYZ:
        case RBD_EULER_YXZ:
        case RBD_EULER_ZXY: return 1;
        case RBD_CYLINDRICAL: return k == j.iq;
        case RBD_PLANAR: return k == j.iq + 2;
        default: return 0;
        }
    }
    return 0;
}

/* ---- comparison, relative to the largest entry ---- */

/* Anything is right where rbd.h has NaN, of a state with NaN or an angle out of bounds; NaN anywhere if it
   may stand there. Returns how often it does. */
static int compare(const char *what, int state, const REAL *right, const real *found, int n, int lane,
                   double tolerance, int may_be_nan) {
    const int anything = state == NOT_A_NUMBER || state == BEYOND;
    double largest = 0;
    int count = 0;
    for (int k = 0; k < n; k++)
        if (!isnan(right[k])) largest = larger(largest, fabs((double)right[k]));
    if (CODE_REPRODUCIBLE) largest = 1; /* to the bit, beside infinite entries too */
    for (int k = 0; k < n; k++) {
        const double error =
            fabs((double)LANE(found[k], lane) - (double)right[k]) / (largest > 0 ? largest : 1);
        count += isnan((double)LANE(found[k], lane)) != 0;
        if ((anything && isnan(right[k])) || (double)LANE(found[k], lane) == (double)right[k] ||
            (may_be_nan && isnan((double)LANE(found[k], lane))))
            continue;
        if (!(error <= tolerance)) {
            if (failures++ < 10)
                printf("%s: state %d, lane %d, entry %d: %.17g, not %.17g, tolerance %g\n", what, state, lane,
                       k, (double)LANE(found[k], lane), (double)right[k], tolerance);
        } else if (error / tolerance > worst)
            worst = error / tolerance;
    }
    return count;
}

/* Condition number of M in the norm of the largest column sum. */
static double condition(const REAL *M) {
    static REAL L[4 * MOST * MOST], x[MOST];
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
        norm = larger(norm, column);
        inverse = larger(inverse, column_of_inverse);
    }
    return norm * inverse;
}

/* The same of J M^-1 J' = R'R in rbd.h's last call, by sums of squares. */
static double rows_condition(void) {
    double norm = 0, inverse = 0, x[MOST];
    for (int j = 0; j < set->rows && set->R_inverse[j] != 0; j++) /* those that are independent come first */
        for (int i = j; i >= 0; i--) {                            /* R x = column j of 1 */
            const REAL *R = &set->R[i * set->stride];
            x[i] = i == j;
            for (int t = i + 1; t <= j; t++) x[i] -= (double)R[t] * x[t];
            x[i] *= (double)set->R_inverse[i];
            norm += (double)R[j] * (double)R[j], inverse += x[i] * x[i];
        }
    return norm * inverse;
}

static int expected_status(rbd_status status) {
    if (status == RBD_OK || status == RBD_ERR_INFEASIBLE) return 0;
    return status == RBD_ERR_NAN ? -1 - rbd_singular_dof(w) : 1 + rbd_singular_dof(w);
}

/* ---- random states k, k + 1 and so on in the lanes; of the bad ones one, in the last ---- */

static real q[5 * WORLD_BODIES + WORLD_COORDINATES], v[MOST], a[MOST], tau[MOST], f_ext[6 * WORLD_BODIES],
    gravity[3], restitution[1], found[4 * MOST * MOST];

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

/* The functions with two results have them one behind the other. */
static int run_code(const code *c, int call) {
    const int nv = rbd_nv(m);
    switch (call) {
    case call_id: c->id(q, v, a, f_ext, gravity, found); break;
    case call_bias: c->bias(q, v, f_ext, gravity, found); break;
    case call_gravity_torque: c->gravity_torque(q, gravity, found); break;
    case call_mm: c->mm(q, found); break;
    case call_mm_packed: c->mm_packed(q, found); break;
    case call_gravity_torque_derivatives: c->gravity_torque_derivatives(q, gravity, found); break;
    case call_coriolis: c->coriolis(q, v, found); break;
    case call_momentum_matrix: c->momentum_matrix(q, found); break;
    case call_com_jacobian: c->com_jacobian(q, found); break;
    case call_jacobian_tip: c->jacobian_tip(q, found); break;
    case call_pose_tip: c->pose_tip(q, found, found + 9); break;
    case call_id_derivatives: c->id_derivatives(q, v, a, f_ext, gravity, found, found + nv * nv); break;
    case call_minv: return c->minv(q, found);
    case call_fd_derivatives:
        return c->fd_derivatives(q, v, tau, f_ext, gravity, found, found + nv, found + nv + nv * nv,
                                 found + nv + 2 * nv * nv);
    case call_fd: return c->fd(q, v, tau, f_ext, gravity, found);
    case call_constrained: return c->constrained(q, v, tau, f_ext, gravity, found, found + nv);
#if !CODE_REPRODUCIBLE
    case call_delta: return c->delta(q, found);
    case call_constrained_id: return c->constrained_id(q, v, a, f_ext, gravity, found, found + nv);
#endif
    case call_impact: return c->impact(q, v, restitution, found, found + nv);
    default: return c->fd_cholesky(q, v, tau, f_ext, gravity, found);
    }
    return 0;
}

/* J M^-1 J' by its definition. */
static rbd_status run_delta(const REAL *x, REAL *out) {
    static REAL Minv[MOST * MOST], J[18 * MOST], y[MOST];
    const int nv = rbd_nv(m), rows = rbd_constraint_rows(set);
    const rbd_status status = rbd_minverse(m, w, x, Minv);
    rbd_constraint_jacobian(m, set, x, NULL, J, NULL, NULL);
    for (int i = 0; i < rows; i++) {
        memset(y, 0, sizeof y);
        for (int k = 0; k < nv * nv; k++) y[k % nv] += J[i * nv + k / nv] * Minv[k];
        for (int j = 0; j < rows; j++) {
            out[i * rows + j] = 0;
            for (int k = 0; k < nv && !status; k++) out[i * rows + j] += y[k] * J[j * nv + k];
        }
    }
    return status;
}

static rbd_status run_rbd(const sample_state *s, int call, REAL *out) {
    static REAL x[WORLD_COORDINATES], xv[MOST], xa[MOST], xtau[MOST], f[6 * WORLD_BODIES], g[3];
    const int nv = rbd_nv(m), tip = rbd_body_index(m, "tip");
    for (int k = 0; k < robot.nq; k++) x[k] = (REAL)s->q[k];
    for (int k = 0; k < nv; k++) xv[k] = (REAL)s->v[k], xa[k] = (REAL)s->a[k], xtau[k] = (REAL)s->tau[k];
    for (int k = 0; k < 6 * robot.nb; k++) f[k] = (REAL)s->f_ext[k];
    for (int k = 0; k < 3; k++) g[k] = (REAL)s->gravity[k];
    rbd_set_gravity(w, g);
    rbd_kinematics(m, w, x, NULL, NULL);
    switch (call) {
    case call_id: return rbd_rnea(m, w, x, xv, xa, f, out);
    case call_bias: return rbd_bias(m, w, x, xv, f, out);
    case call_gravity_torque: return rbd_gravity_torque(m, w, x, out);
    case call_mm: return rbd_crba(m, w, x, out);
    case call_mm_packed: return rbd_crba_packed(m, w, x, out);
    case call_gravity_torque_derivatives: return rbd_gravity_torque_derivatives(m, d, x, out);
    case call_coriolis: return rbd_coriolis(m, d, x, xv, out);
    case call_momentum_matrix: return rbd_momentum_matrix(m, d, x, NULL, out, NULL);
    case call_com_jacobian: return rbd_com_jacobian(m, d, x, out);
    case call_jacobian_tip: return rbd_jacobian(m, w, tip, NULL, RBD_WORLD_AXES, out);
    case call_pose_tip: return rbd_body_pose(m, w, tip, out, out + 9);
    case call_id_derivatives: return rbd_id_derivatives(m, d, x, xv, xa, f, out, out + nv * nv, NULL);
    case call_minv: return rbd_minverse(m, w, x, out);
    case call_fd_derivatives:
        return rbd_fd_derivatives(m, d, x, xv, xtau, f, out, out + nv, out + nv + nv * nv,
                                  out + nv + 2 * nv * nv);
    case call_fd: return rbd_aba(m, w, x, xv, xtau, f, out);
    case call_constrained: return rbd_constrained_fd(m, set, x, xv, xtau, f, out, out + nv);
    case call_delta: return run_delta(x, out);
    case call_constrained_id: return rbd_constrained_id(m, set, x, xv, xa, f, motors, NULL, out, out + nv);
    case call_impact: return rbd_impact(m, set, x, xv, (REAL)0.25, out, out + nv);
    default: return rbd_fd_cholesky(m, w, x, xv, xtau, f, out);
    }
}

static int size_of(int call) {
    const int nv = rbd_nv(m);
    switch (call) {
    case call_mm_packed: return rbd_packed_size(m);
    case call_mm:
    case call_minv:
    case call_gravity_torque_derivatives:
    case call_coriolis: return nv * nv;
    case call_id_derivatives: return 2 * nv * nv;
    case call_fd_derivatives: return nv + 3 * nv * nv;
    case call_momentum_matrix:
    case call_jacobian_tip: return 6 * nv;
    case call_com_jacobian: return 3 * nv;
    case call_pose_tip: return 12;
    case call_delta: return rbd_constraint_rows(set) * rbd_constraint_rows(set);
    case call_constrained:
    case call_constrained_id:
    case call_impact: return nv + rbd_constraint_rows(set);
    default: return nv;
    }
}

/* Of the results of M^-1 relative to the largest. */
static double tolerance_of(int state, int call) {
    static REAL M[4 * MOST * MOST];
    const sample_state *s = &states[state == NOT_A_NUMBER || state == BEYOND ? 0 : state];
    const double eps = sizeof(REAL) == 4 ? 1e-7 : 2e-16;
    if (call < FIRST_WITH_PIVOTS || state == LOCKED) return 5e4 * eps;
    run_rbd(s, call_mm, M);
    return fmax(5e4 * eps, 10 * eps * condition(M));
}

/* NaN in q reaches the pivots of fd_derivatives, which are those of M in another frame, also where M does not
   depend on it: rbd.h then judges by M itself, and NaN is in its results. */
static int is_judged_alone(int k, int call, int status) {
    return k == NOT_A_NUMBER && call == call_fd_derivatives && status < 0;
}

/* An angle of the last lane is out of bounds: whether it is refused, by a status and zeros, or NaN. Results
   that are numbers all the same are right. */
static int is_refused(int k, int call, int status, const REAL *right) {
    const int lane = CODE_LANES - 1;
    if (call >= FIRST_WITH_PIVOTS && (status == -1 - rbd_nv(m) || is_judged_alone(k, call, status))) {
        for (int i = 0; i < size_of(call); i++)
            if (LANE(found[i], lane) != 0) check_status("not zero", k, i, -1);
        return 1;
    }
    return compare(names[call], k, right, found, size_of(call), lane, tolerance_of(k, call),
                   call < FIRST_WITH_PIVOTS) > 0;
}

/* Rows that rbd.h finds dependent, or nearly, are refused by a status. */
static void check_refused_rows(int k, int call, int status) {
    const int first = rbd_nv(m) + 1, rows = rbd_constraint_rows(set), twice = set->n > 2;
    in_doubt[!twice]++;
    if (twice && k != NOT_A_NUMBER)
        check_status(names[call], k, status, first + rbd_constraint_first(set, 2));
    else if (status < first || status >= first + rows)
        check_status(names[call], k, status, first);
}

static int is_zero(int lane, int n) {
    for (int k = 0; k < n; k++)
        if (LANE(found[k], lane) != 0) return 0;
    return 1;
}

static void check(const code *c, int k, int call) {
    static REAL right[4 * MOST * MOST];
    const double quarter = 0.25;
    const int bounded = CODE_BOUNDED && (k == BEYOND || (k == NOT_A_NUMBER && is_angle(0)));
    int status = 0, expected = 0, refused_rows = 0;
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
        give(&quarter, 1, lane, restitution);
    }
    status = run_code(c, call);
    for (int lane = 0; lane < CODE_LANES; lane++) {
        const sample_state *s = &states[state_of(k, lane)];
        double tolerance = CODE_REPRODUCIBLE ? 0 : tolerance_of(state_of(k, lane), call);
        set->pivoted = 0;
#if CODE_REPRODUCIBLE
        refined = 0;
#endif
        expected = expected_status(run_rbd(s, call, right));
        if (lane == CODE_LANES - 1 && (bounded || (expected == 0 && is_judged_alone(k, call, status))) &&
            is_refused(k, call, status, right)) {
            refused[call] += bounded;
            return;
        }
        if (call == call_constrained_id) { /* refuses by other pivots than rbd.h's */
            set->pivoted = status > rbd_nv(m) && is_zero(lane, size_of(call));
            unlike += set->pivoted && k < RANDOM;
        }
        if (set->pivoted)
            memset(right, 0, sizeof right);
        else if (call >= FIRST_HELD && !CODE_REPRODUCIBLE)
            tolerance = fmax(tolerance, 10 * (sizeof(REAL) == 4 ? 1e-7 : 2e-16) * rows_condition());
#if CODE_REPRODUCIBLE
        for (int i = 0; refined && i < size_of(call); i++)
            tolerance = fmax(tolerance, 1e3 * (sizeof(REAL) == 4 ? 1e-7 : 2e-16) * fabs((double)right[i]));
#endif
        refused_rows |= set->pivoted;
        compare(names[call], k, right, found, size_of(call), lane, tolerance, 0);
    }
    if (refused_rows && expected == 0)
        check_refused_rows(k, call, status);
    else
        check_status(names[call], k, status, expected);
    singular += expected > 0;
}

int main(void) {
    static unsigned char model_memory[RBD_MODEL_SIZE(WORLD_BODIES)];
    static unsigned char work_memory[RBD_WORK_SIZE_MIMIC(WORLD_BODIES, MOST)];
    static unsigned char derivatives_memory[RBD_DERIVATIVES_SIZE_MIMIC(WORLD_BODIES, MOST)];
    static unsigned char set_memory[RBD_CONSTRAINT_SET_SIZE(MOST, 18)];
    rbd_constraint list[4];
    for (int r = 0; r < ROBOTS; r++) {
        choose_robot(&robot, r);
        if (rbd_model_build(robot.bodies, robot.nb, model_memory, sizeof model_memory, &m, NULL) != RBD_OK ||
            rbd_work_init(m, work_memory, sizeof work_memory, &w) != RBD_OK ||
            rbd_derivatives_init(m, w, derivatives_memory, sizeof derivatives_memory, &d) != RBD_OK ||
            rbd_constraint_set_init(m, w, list, choose_constraints(&robot, r, list), set_memory,
                                    sizeof set_memory, &set, NULL) != RBD_OK)
            return 1;
        choose_motors(&robot, motors);
        draw_states();
        worst = 0;
        for (int k = 0; k < BEYOND; k++)
            for (int call = 0; call < CALLS; call++)
                if (k < LOCKED || r == 0) check(&codes[r], k, call);
        for (int k = 0; k < 4 * robot.nq; k++) {
            const double beyond[] = {sizeof(REAL) == 4 ? 3e4 : 3e9, -1e30, HUGE_VAL, nan("")};
            if (!CODE_BOUNDED || !is_angle(k / 4)) continue;
            states[BEYOND].q[k / 4] = beyond[k % 4];
            for (int call = 0; call < CALLS; call++) check(&codes[r], BEYOND, call);
            states[BEYOND].q[k / 4] = states[0].q[k / 4];
        }
        printf("robot %d: largest error %.2g of its tolerance\n", r, worst);
    }
    if (!singular) puts("no singular state among them");
    printf("%d states refused by constrained_id\n", unlike);
    printf("%d refusals of rows held twice, %d of others\n", in_doubt[0], in_doubt[1]);
    for (int call = 0; call < CALLS && CODE_BOUNDED; call++)
        if (refused[call] < 4) printf("%s: %d angles refused\n", names[call], refused[call]), failures++;
    printf("%d skipped\n", skipped);
    return failures != 0 || unlike > RANDOM / 10 || !singular || (ROBOTS > HELD_TWICE && !in_doubt[0]) ||
           !in_doubt[1] || skipped > RANDOM;
}
