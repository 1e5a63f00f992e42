/* control_loop.c - what each call leaves of what a later call can see, for control_loop.sh, which compares it
   with the table of docs/control_loop.md. A line for each call: name, what rbd_kinematics left, and
   rbd_singular_dof. No result hangs on what was called before, nor on what failed before. */
#define RBD_IMPLEMENTATION
#include "rbd_derivatives.h"

#include "rbd_contact.h"
#include "rbd_tasks.h"

#include "models/hyq_model.h"
#include <stdio.h>
#include <string.h>

enum { NB = HYQ_NB, NQ = HYQ_NQ, NV = HYQ_NV, ROWS = 12, MARK = 77, SIZE = 40 * NV * 10 };

static unsigned char work_memory[HYQ_WORK_SIZE], d_memory[RBD_DERIVATIVES_SIZE(NB, NV)],
    c_memory[RBD_CONSTRAINT_SET_SIZE(NV, ROWS)], ground_memory[RBD_CONTACT_SET_SIZE(NV, 4, 0)],
    ik_memory[RBD_IK_SIZE(NB, NV, 1)], tasks_memory[RBD_TASKS_SIZE(NV, 3 + NV, 4, 0)];
static rbd_work *w;
static rbd_derivatives *d;
static rbd_constraint_set *c;
static rbd_contact_set *ground;
static const rbd_model *const m = &hyq_model;

static rbd_real q[NQ], v[NV], tau[NV], a[NV], q_before[NQ], M[NV * NV], L[NV * NV];
static rbd_real out[SIZE], expected[SIZE]; /* results of the call */
static const rbd_real dt = 1e-3;
static const rbd_real point[3] = {0.1, 0.2, 0.3};
static unsigned char given[NV];

/* Inverse kinematics of the last body; a q that is not finite is an error. */
static rbd_status solve(void) {
    const rbd_ik_target t = {.kind = RBD_IK_POINT, .body = NB - 1, .point = {0.1, 0.2, 0.3}};
    const rbd_ik_options o = {.starts = 1, .evaluations = 5};
    rbd_ik_result result;
    memcpy(out, q, sizeof q);
    rbd_ik(m, w, &t, 1, &o, ik_memory, sizeof ik_memory, out, &result);
    return result.error;
}

/* Whole-body control: the last body's point at a place, joints as they are, four feet on the ground. */
static rbd_status control(int accelerations) {
    const rbd_task wishes[2] = {{.kind = RBD_TASK_POINT, .body = NB - 1, .gain = 10},
                                {.kind = RBD_TASK_POSTURE, .q = q, .gain = 10, .weight = (rbd_real)1e-3}};
    rbd_task_contact feet[4] = {{0}};
    const rbd_tasks problem = {.task = wishes, .tasks = 2, .contact = feet, .contacts = 4, .dt = dt};
    rbd_tasks_result result;
    for (int i = 0; i < 4; i++) {
        feet[i].body = HYQ_BODY_LF_LOWERLEG + i;
        feet[i].point[0] = (rbd_real)0.33;
        feet[i].friction = 1;
    }
    if (accelerations)
        rbd_tasks_acceleration(m, w, &problem, q, v, tasks_memory, sizeof tasks_memory, out, out + NV,
                               out + NV + 12, &result);
    else
        rbd_tasks_velocity(m, w, &problem, q, tasks_memory, sizeof tasks_memory, out, &result);
    return result.error;
}

#define CALLS(CALL) \
    CALL(rbd_rnea, rbd_rnea(m, w, q, v, a, NULL, out)) \
    CALL(rbd_bias, rbd_bias(m, w, q, v, NULL, out)) \
    CALL(rbd_gravity_torque, rbd_gravity_torque(m, w, q, out)) \
    CALL(rbd_generalized_momentum, rbd_generalized_momentum(m, w, q, v, out, out + NV)) \
    CALL(rbd_crba, rbd_crba(m, w, q, out)) \
    CALL(rbd_crba_packed, rbd_crba_packed(m, w, q, out)) \
    CALL(rbd_passive, rbd_passive(m, w, v, out)) \
    CALL(rbd_cholesky_solve, rbd_cholesky_solve(m, w, L, tau, out)) \
    CALL(rbd_cholesky_solve_many, rbd_cholesky_solve_many(m, w, L, 1, tau, out)) \
    CALL(rbd_jacobian, rbd_jacobian(m, w, NB - 1, point, RBD_WORLD_AXES, out)) \
    CALL(rbd_jacobian_derivative, rbd_jacobian_derivative(m, w, NB - 1, point, RBD_WORLD_AXES, out)) \
    CALL(rbd_point_position, rbd_point_position(m, w, NB - 1, point, out)) \
    CALL(rbd_com, rbd_com(m, w, out, NULL, NULL)) \
    CALL(rbd_energy, rbd_energy(m, w, out, out + 1)) \
    CALL(rbd_momentum, rbd_momentum(m, w, out, NULL)) \
    CALL(rbd_aba, rbd_aba(m, w, q, v, tau, NULL, out)) \
    CALL(rbd_hybrid, (memcpy(out, a, sizeof a), memcpy(out + NV, tau, sizeof tau), \
                      rbd_hybrid(m, w, q, v, given, out, out + NV, NULL))) \
    CALL(rbd_fd_cholesky, rbd_fd_cholesky(m, w, q, v, tau, NULL, out)) \
    CALL(rbd_cholesky_factor, rbd_cholesky_factor(m, w, M, out)) \
    CALL(rbd_cholesky_factor_packed, (rbd_crba_packed(m, w, q, out), rbd_cholesky_factor_packed(m, w, out))) \
    CALL(rbd_minverse, rbd_minverse(m, w, q, out)) \
    CALL(rbd_kinematics, rbd_kinematics(m, w, q, v, a)) \
    CALL(rbd_body_kinematics, rbd_body_kinematics(m, w, NB - 1, q, v, a)) \
    CALL(rbd_ik, solve()) \
    CALL(rbd_tasks_velocity, control(0)) \
    CALL(rbd_tasks_acceleration, control(1)) \
    CALL(rbd_joint_wrench, rbd_joint_wrench(m, w, q, v, a, NULL, out)) \
    CALL(rbd_momentum_matrix, rbd_momentum_matrix(m, d, q, v, out, out + 6 * NV)) \
    CALL(rbd_com_jacobian, rbd_com_jacobian(m, d, q, out)) \
    CALL(rbd_coriolis, rbd_coriolis(m, d, q, v, out)) \
    CALL(rbd_id_derivatives, rbd_id_derivatives(m, d, q, v, a, NULL, out, out + NV * NV, NULL)) \
    CALL(rbd_gravity_torque_derivatives, rbd_gravity_torque_derivatives(m, d, q, out)) \
    CALL(rbd_regressor, rbd_regressor(m, d, q, v, a, out)) \
    CALL(rbd_energy_regressors, rbd_energy_regressors(m, d, q, v, out, out + 10 * NB)) \
    CALL(rbd_id_free_base, (memcpy(out, a, sizeof a), rbd_id_free_base(m, d, q, v, out, out + NV, NULL))) \
    CALL(rbd_fd_derivatives, \
         rbd_fd_derivatives(m, d, q, v, tau, NULL, out, out + NV, out + NV + NV * NV, NULL)) \
    CALL(rbd_constraint_jacobian, rbd_constraint_jacobian(m, c, q, v, out, out + ROWS * NV, NULL)) \
    CALL(rbd_constrained_fd, rbd_constrained_fd(m, c, q, v, tau, NULL, out, out + NV)) \
    CALL(rbd_impact, rbd_impact(m, c, q, v, 0, out, out + NV)) \
    CALL(rbd_constrained_id, rbd_constrained_id(m, c, q, v, a, NULL, NULL, NULL, out, out + NV)) \
    CALL(rbd_assemble, (rbd_assemble(m, c, q, v, NULL, out, out + NQ), RBD_OK)) \
    CALL(rbd_contact_step, \
         (rbd_contact_reset(ground), rbd_contact_step(m, ground, q, v, tau, NULL, NULL, dt, out, out + NQ))) \
    CALL(rbd_contact_fd, \
         (rbd_contact_reset(ground), rbd_contact_fd(m, ground, q, v, tau, NULL, NULL, dt, out))) \
    CALL(rbd_constrained_fd_derivatives, \
         rbd_constrained_fd_derivatives( \
             m, c, d, q, v, tau, NULL, \
             &(rbd_constrained_fd_results){ \
                 .a = out, .lambda = out + NV, .da_dq = out + 1000, .dlambda_dq = out + 1000 + NV * NV}))

#define FUNCTION(name, call) \
    static rbd_status call_##name(void) { return call; }
CALLS(FUNCTION)
#define ROW(name, call) {#name, call_##name},
static const struct {
    const char *name;
    rbd_status (*call)(void);
} calls[] = {CALLS(ROW)};
enum { N_CALLS = sizeof calls / sizeof *calls };

/* Reads the results of rbd_kinematics; returns of how many bodies they are there: rbd_body_kinematics leaves
   those of a path. */
static int read_kinematics(rbd_real x[NB][24]) {
    int there = 0;
    memset(x, 0, NB * sizeof *x);
    for (int i = 0; i < NB; i++)
        there += rbd_body_pose(m, w, i, x[i], x[i] + 9) == RBD_OK &&
                 rbd_body_velocity(m, w, i, x[i] + 12) == RBD_OK &&
                 rbd_body_acceleration(m, w, i, x[i] + 18) == RBD_OK;
    return there;
}

/* A call on a work in which rbd_kinematics has been called; all that it gives is in out. */
static rbd_status run(int i) {
    memset(out, 0, sizeof out);
    return calls[i].call();
}

static void prepare(void) {
    if (rbd_kinematics(m, w, q_before, v, a) != RBD_OK) puts("rbd_kinematics fails");
    w->singular = MARK; /* as a call before it might have left it */
}

int main(void) {
    static rbd_real before[NB][24], after[NB][24];
    static const double sole[3] = {0.33, 0, 0};
    const int feet[4] = {HYQ_BODY_LF_LOWERLEG, HYQ_BODY_RF_LOWERLEG, HYQ_BODY_LH_LOWERLEG,
                         HYQ_BODY_RH_LOWERLEG};
    rbd_constraint list[4];
    rbd_contact touching[4];
    uint64_t seed = 3;
    for (int i = 0; i < 4; i++) {
        list[i] = rbd_point_contact(feet[i], sole, NULL);
        touching[i] = (rbd_contact){.body1 = feet[i], .body2 = -1, .point = {0.33, 0, 0}, .height = -0.5};
    }
    if (rbd_work_init(m, work_memory, sizeof work_memory, &w) ||
        rbd_derivatives_init(m, w, d_memory, sizeof d_memory, &d) ||
        rbd_constraint_set_init(m, w, list, 4, c_memory, sizeof c_memory, &c, NULL) ||
        rbd_contact_set_init(m, w, touching, 4, NULL, 0, NULL, ground_memory, sizeof ground_memory, &ground,
                             NULL) ||
        rbd_random(m, &seed, q_before) || rbd_random(m, &seed, q))
        return 1;
    for (int i = 0; i < NV; i++) v[i] = 0.1 * (i - 8), a[i] = 0.3 * (7 - i), tau[i] = i % 5, given[i] = i % 2;
    if (rbd_crba(m, w, q, M) || rbd_cholesky_factor(m, w, M, L)) return 2;
    for (int i = 0; i < N_CALLS; i++) {
        const char *kinematics;
        prepare();
        if (read_kinematics(before) != NB) return 3;
        if (run(i) != RBD_OK) printf("%s fails\n", calls[i].name);
        kinematics = !read_kinematics(after)                ? "gone"
                     : memcmp(before, after, sizeof before) ? "replaced"
                                                            : "stays";
        printf("%s %s %s\n", calls[i].name, kinematics, w->singular == MARK ? "stays" : "set");
        /* whatever was called before, and failed before, the result has the same bits */
        prepare();
        run(i);
        memcpy(expected, out, sizeof out);
        for (int k = 0; k < N_CALLS; k++) {
            const rbd_real good = q[NQ - 1];
            q[NQ - 1] =
                k % 2 ? good : 0 / (good - good); /* NaN: every other call before it fails, or gives NaN */
            run(k);
            q[NQ - 1] = good;
            prepare();
            run(i);
            if (memcmp(expected, out, sizeof out) != 0)
                printf("%s after %s: another result\n", calls[i].name, calls[k].name);
        }
    }
    return 0;
}
