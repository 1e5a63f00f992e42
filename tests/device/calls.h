/* calls.h - the calls of the test of code of a GPU, for one state of HyQ: plain C, which the host compiles as
   usual, and a compiler for GPUs as code of both. HERE: the words before a function. */
#include "rbd.h"
#include "rbd_constraints.h"
#include "rbd_contact.h"
#include "rbd_derivatives.h"
#include "rbd_ik.h"
#include "rbd_estimate.h"
#include "rbd_actuator.h"
#include "rbd_qp.h"
#include "rbd_tasks.h"
#include "models/hyq_model.h"

enum { NQ = HYQ_NQ, NV = HYQ_NV, FEET = 4, LEGS_DOFS = NV - 6, LARGEST = 2 * NV * NV + NV };

typedef struct state {
    rbd_real q[NQ], v[NV], x[NV]; /* x: accelerations or torques */
} state;

HERE int inverse_dynamics(const rbd_model *m, const state *s, rbd_real *out) {
    unsigned char work[HYQ_WORK_SIZE];
    rbd_work *w;
    const rbd_status status = rbd_work_init(m, work, sizeof work, &w);
    if (status) return status;
    return rbd_rnea(m, w, s->q, s->v, s->x, NULL, out);
}

HERE int forward_dynamics(const rbd_model *m, const state *s, rbd_real *out) {
    unsigned char work[HYQ_WORK_SIZE];
    rbd_work *w;
    const rbd_status status = rbd_work_init(m, work, sizeof work, &w);
    if (status) return status;
    return rbd_aba(m, w, s->q, s->v, s->x, NULL, out);
}

HERE int mass_matrix(const rbd_model *m, const state *s, rbd_real *out) {
    unsigned char work[HYQ_WORK_SIZE];
    rbd_work *w;
    const rbd_status status = rbd_work_init(m, work, sizeof work, &w);
    if (status) return status;
    return rbd_crba(m, w, s->q, out);
}

HERE int derivatives(const rbd_model *m, const state *s, rbd_real *out) {
    unsigned char work[HYQ_WORK_SIZE], more[RBD_DERIVATIVES_SIZE(HYQ_NB, HYQ_NV)];
    rbd_work *w;
    rbd_derivatives *d;
    rbd_status status = rbd_work_init(m, work, sizeof work, &w);
    if (!status) status = rbd_derivatives_init(m, w, more, sizeof more, &d);
    if (status) return status;
    return rbd_fd_derivatives(m, d, s->q, s->v, s->x, NULL, out, out + NV, out + NV + NV * NV, NULL);
}

/* Accelerations and the forces of the feet, which are bolted down. */
HERE int constrained(const rbd_model *m, const state *s, rbd_real *out) {
    unsigned char work[HYQ_WORK_SIZE], more[RBD_CONSTRAINT_SET_SIZE(HYQ_NV, 3 * FEET)];
    rbd_work *w;
    const double toe[3] = {0.33, 0, 0};
    rbd_constraint foot[FEET];
    rbd_constraint_set *c;
    rbd_status status = rbd_work_init(m, work, sizeof work, &w);

    for (int k = 0; k < FEET; ++k) foot[k] = rbd_point_contact(HYQ_BODY_LF_LOWERLEG + k, toe, NULL);
    if (!status) status = rbd_constraint_set_init(m, w, foot, FEET, more, sizeof more, &c, NULL);
    if (status) return status;
    return rbd_constrained_fd(m, c, s->q, s->v, s->x, NULL, out, out + NV);
}

/* The state after a step on four feet, and their impulses. */
HERE int contact_step(const rbd_model *m, const state *s, rbd_real *out) {
    unsigned char work[HYQ_WORK_SIZE], more[RBD_CONTACT_SET_SIZE(HYQ_NV, FEET, 0)];
    rbd_work *w;
    rbd_contact foot[FEET];
    rbd_contact_set *c;
    const rbd_real dt = (rbd_real)1e-3;
    rbd_real *impulse = out + NQ + NV;
    rbd_status status = rbd_work_init(m, work, sizeof work, &w);

    for (int k = 0; k < FEET; ++k) {
        const rbd_contact none = {0};
        foot[k] = none;
        foot[k].body1 = HYQ_BODY_LF_LOWERLEG + k;
        foot[k].body2 = -1;
        foot[k].point[0] = 0.33;
        foot[k].friction = 0.5;
    }

    if (!status) status = rbd_contact_set_init(m, w, foot, FEET, NULL, 0, NULL, more, sizeof more, &c, NULL);
    if (status) return status;
    status = rbd_contact_step(m, c, s->q, s->v, s->x, NULL, NULL, dt, out, out + NQ);
    for (int k = 0; k < FEET; ++k) rbd_contact_get(c, k, NULL, impulse + 3 * k);
    for (int k = 0; k < 3 * FEET; ++k) impulse[k] *= dt;
    return status;
}

/* The point nearest to x, with component k at most k/2 - 4 and the sum 1; and the multipliers. */
HERE int quadratic_program(const rbd_model *m, const state *s, rbd_real *out) {
    unsigned char memory[RBD_QP_SIZE(NV, NV, 1, 0)];
    rbd_real hessian[NV * NV] = {0}, f[NV], row[NV], lower[NV + 1], upper[NV + 1];
    signed char side[NV + 1];
    rbd_qp_problem p = {NV, NV, 1, NULL, NULL, NULL, NULL, NULL, NULL};

    for (int k = 0; k < NV; ++k) {
        hessian[k * NV + k] = 1;
        f[k] = -s->x[k];
        row[k] = 1;
        lower[k] = -(rbd_real)RBD_QP_NONE;
        upper[k] = (rbd_real)k / 2 - 4;
    }

    lower[NV] = upper[NV] = 1;
    p.H = hessian;
    p.f = f;
    p.C = row;
    p.lower = lower;
    p.upper = upper;
    return m ? (int)rbd_qp_solve(&p, NULL, memory, sizeof memory, out, out + NV, side, NULL) : 1;
}

/* The legs' joints with which the feet are under the hips of the state, and how near they come. */
HERE int inverse_kinematics(const rbd_model *m, const state *s, rbd_real *out) {
    unsigned char work[HYQ_WORK_SIZE], memory[RBD_IK_SIZE(HYQ_NB, HYQ_NV, FEET)], held[NV] = {0};
    rbd_ik_target target[FEET];
    rbd_ik_options options = {0};
    rbd_ik_result result;
    rbd_work *w;
    rbd_status status = rbd_work_init(m, work, sizeof work, &w);
    if (status) return status;

    for (int k = 0; k < NV; ++k) held[k] = k < 6;
    for (int k = 0; k < NQ; ++k) out[k] = s->q[k];
    for (int k = 0; k < FEET; ++k) {
        const rbd_ik_target none = {RBD_IK_POINT, 0, {0, 0, 0}, {0, 0, 0}, {0}, {0, 0, 0}, {0, 0, 0}, 0};
        target[k] = none;
        target[k].body = HYQ_BODY_LF_LOWERLEG + k;
        target[k].point[0] = (rbd_real)0.33;
        target[k].position[0] = s->q[0] + (k < 2 ? (rbd_real)0.37 : -(rbd_real)0.37);
        target[k].position[1] = s->q[1] + (k % 2 ? -(rbd_real)0.3 : (rbd_real)0.3);
        target[k].position[2] = s->q[2] - (rbd_real)0.5;
    }

    options.held = held;
    options.starts = 1;
    if (rbd_ik(m, w, target, FEET, &options, memory, sizeof memory, out, &result) == RBD_IK_ERROR)
        return result.error;
    return RBD_OK;
}

/* Velocities that lift a foot, within the limits of the joints. */
HERE int whole_body(const rbd_model *m, const state *s, rbd_real *out) {
    unsigned char work[HYQ_WORK_SIZE], memory[RBD_TASKS_SIZE(NV, 3, 0, 0)];
    const rbd_task none = {RBD_TASK_POINT};
    const rbd_tasks nothing = {0};
    rbd_task task = none;
    rbd_tasks p = nothing;
    rbd_tasks_result result;
    rbd_work *w;
    const rbd_status status = rbd_work_init(m, work, sizeof work, &w);
    if (status) return status;

    task.body = HYQ_BODY_LF_LOWERLEG;
    task.point[0] = (rbd_real)0.33;
    task.velocity[5] = (rbd_real)0.1;
    p.task = &task;
    p.tasks = 1;
    p.dt = (rbd_real)1e-3;
    if (rbd_tasks_velocity(m, w, &p, s->q, memory, sizeof memory, out, &result) == RBD_TASKS_ERROR)
        return result.error;
    return RBD_OK;
}

/* Currents of the legs' motors, and the level of their friction. */
HERE int motor_currents(const rbd_model *m, const state *s, rbd_real *out) {
    unsigned char memory[RBD_ACTUATORS_SIZE(LEGS_DOFS, 0, 0)];
    rbd_motor motors[LEGS_DOFS];
    rbd_drive drives[LEGS_DOFS];
    rbd_actuators *a;
    rbd_status status;
    for (int k = 0; k < LEGS_DOFS; ++k) {
        const rbd_motor none = {0};
        motors[k] = none;
        motors[k].joint = rbd_joint_name(m, rbd_dof_body(m, 6 + k));
        motors[k].gear = 20;
        motors[k].constant = (rbd_const)0.0625;
        motors[k].inertia = (rbd_const)0.0001;
        motors[k].friction.coulomb = (rbd_const)(k + 1);
        motors[k].friction.rest = (rbd_const)0.5;
        motors[k].friction.speed = (rbd_const)0.25;
        motors[k].friction.power = (rbd_const)1.5;
        motors[k].friction.load_motor = (rbd_const)0.125;
    }

    status = rbd_actuators_init(m, motors, LEGS_DOFS, NULL, 0, memory, sizeof memory, &a, NULL);
    if (!status) status = rbd_actuators_inverse(a, s->q, s->v, s->x, s->x, drives);
    for (int k = 0; k < LEGS_DOFS; ++k) {
        out[k] = status ? 0 : drives[k].current;
        out[LEGS_DOFS + k] = rbd_friction_level(&motors[k].friction, s->v[6 + k], s->x[6 + k], -s->x[6 + k]);
    }
    return status;
}

/* name, numbers of results */
#define EACH_CALL(CALL) \
    CALL(inverse_dynamics, NV) \
    CALL(forward_dynamics, NV) \
    CALL(mass_matrix, NV *NV) \
    CALL(derivatives, NV + 2 * NV * NV) \
    CALL(constrained, NV + 3 * FEET) \
    CALL(quadratic_program, 2 * NV + 1) \
    CALL(inverse_kinematics, NQ) \
    CALL(whole_body, NV) \
    CALL(motor_currents, 2 * LEGS_DOFS) \
    CALL(contact_step, NQ + NV + 3 * FEET)
