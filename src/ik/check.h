#ifndef RBDI_IK_CHECK_H
#define RBDI_IK_CHECK_H
#include "motion/manifold.h"
#include "ik/targets.h"

/* Interface: rbdi_ik_is_axis, rbdi_ik_is_place, rbdi_ik_is_rotation, rbdi_ik_within */

/* ---- checks [checks] ---- */

/* Notes an error; returns it. */
RBDI_LOCAL rbd_status rbdi_ik_refuse(rbd_ik_result *result, rbd_status error, int target, const char *field) {
    result->error = error;
    result->target = target;
    result->field = field;
    return error;
}

/* Whether x is not negative and at most `most`; not of NaN. */
RBDI_INLINE int rbdi_ik_within(rbd_real x, rbd_const most) { return x >= 0 && x <= most; }

/* Whether three components are finite and not too large to compute with. */
RBDI_LOCAL int rbdi_ik_is_place(const rbd_real *x) {
    for (int i = 0; i < 3; ++i)
        if (!rbdi_ik_within(rbdi_abs(x[i]), RBDI_IK_MOST)) return 0;
    return 1;
}

/* Whether x is finite and not too short for an axis. */
RBDI_LOCAL int rbdi_ik_is_axis(const rbd_real *x) {
    const rbd_real least = RBD_C(1) / RBDI_IK_MOST;
    return rbdi_ik_is_place(x) && rbdi_dot(rbdi_load_vec(x, 1), rbdi_load_vec(x, 1)) >= least * least;
}

/* Whether R is a rotation to some six decimals, or all 0. */
RBDI_LOCAL int rbdi_ik_is_rotation(const rbd_real *R) {
    const rbd_real most = rbdi_set(RBD_C(RBDI_ORTHONORMAL)) + RBDI_IK_ROUNDED;
    rbdi_mat A, P;
    rbdi_v3 x;
    if (!rbdi_ik_is_place(R) || !rbdi_ik_is_place(R + 3) || !rbdi_ik_is_place(R + 6)) return 0;

    A = rbdi_ik_rotation(R);
    P = rbdi_mul_mat(A, rbdi_transpose(A));
    x = rbdi_cross(rbdi_vec(A.xx, A.xy, A.xz), rbdi_vec(A.yx, A.yy, A.yz));
    return rbdi_abs(P.xx - 1) <= most && rbdi_abs(P.yy - 1) <= most && rbdi_abs(P.zz - 1) <= most &&
           rbdi_abs(P.xy) <= most && rbdi_abs(P.xz) <= most && rbdi_abs(P.yz) <= most &&
           rbdi_dot(x, rbdi_vec(A.zx, A.zy, A.zz)) > 0;
}

RBDI_LOCAL rbd_status rbdi_ik_check_target(const rbd_model *m, const rbd_ik_target *t, int i,
                                           rbd_ik_result *result) {
    const int kind = (int)t->kind;
    const int com = t->kind == RBD_IK_COM;
    if (kind < (int)RBD_IK_POINT || kind > (int)RBD_IK_COM)
        return rbdi_ik_refuse(result, RBD_ERR_TYPE, i, "kind");
    if (!com && (t->body < 0 || t->body >= m->nb)) return rbdi_ik_refuse(result, RBD_ERR_INDEX, i, "body");
    if (com && !(rbd_mass(m) > 0)) return rbdi_ik_refuse(result, RBD_ERR_MASS, i, "kind");
    if (com && rbdi_massless_dof(m) >= 0) return rbdi_ik_refuse(result, RBD_ERR_MASSLESS, i, "kind");

    if (!com && !rbdi_ik_is_place(t->point)) return rbdi_ik_refuse(result, RBD_ERR_POSITION, i, "point");
    if ((com || rbdi_ik_moves_point(t->kind)) && !rbdi_ik_is_place(t->position))
        return rbdi_ik_refuse(result, RBD_ERR_POSITION, i, "position");
    if (rbdi_ik_turns_body(t->kind) && !rbdi_ik_is_rotation(t->rotation))
        return rbdi_ik_refuse(result, RBD_ERR_ROTATION, i, "rotation");
    if (t->kind == RBD_IK_AXIS && !rbdi_ik_is_axis(t->axis))
        return rbdi_ik_refuse(result, RBD_ERR_AXIS, i, "axis");
    if (t->kind == RBD_IK_AXIS && !rbdi_ik_is_axis(t->direction))
        return rbdi_ik_refuse(result, RBD_ERR_AXIS, i, "direction");

    if (!rbdi_ik_within(t->weight, RBDI_IK_MOST_WEIGHT) ||
        (t->weight > 0 && t->weight < RBD_C(1) / RBDI_IK_MOST_WEIGHT))
        return rbdi_ik_refuse(result, RBD_ERR_RANGE, i, "weight");
    return RBD_OK;
}

RBDI_LOCAL rbd_status rbdi_ik_check_options(const rbd_ik_options *o, rbd_ik_result *result) {
    const rbd_real values[5] = {(rbd_real)o->starts, (rbd_real)o->evaluations, o->metres, o->radians,
                                o->length};
    const char *const names[5] = {"starts", "evaluations", "metres", "radians", "length"};
    for (int i = 0; i < 5; ++i)
        if (!rbdi_ik_within(values[i], RBDI_IK_MOST))
            return rbdi_ik_refuse(result, RBD_ERR_RANGE, -1, names[i]);
    if (o->length > 0 && o->length < RBD_C(1) / RBDI_IK_MOST)
        return rbdi_ik_refuse(result, RBD_ERR_RANGE, -1, "length");
    if (o->evaluations == 1) return rbdi_ik_refuse(result, RBD_ERR_RANGE, -1, "evaluations");
    return RBD_OK;
}

/* A joint that turns has no coordinate that stays if one of its dofs does: all of them are held, or none. */
RBDI_LOCAL rbd_status rbdi_ik_check_held(const rbd_model *m, const unsigned char *held,
                                         rbd_ik_result *result) {
    for (const rbdi_frame *u = m->frame; u < m->frame + m->nb; ++u)
        for (int k = 1; k < u->nv && rbdi_joint_turns(u); ++k)
            if (!held[u->iv + k] != !held[u->iv])
                return rbdi_ik_refuse(result, RBD_ERR_INFEASIBLE, -1, "held");
    return RBD_OK;
}

RBDI_LOCAL rbd_status rbdi_ik_check_q(const rbd_model *m, const rbd_real *q, rbd_ik_result *result) {
    for (int i = 0; i < m->nq; ++i) {
        if (!rbdi_is_finite(q[i])) return rbdi_ik_refuse(result, RBD_ERR_NAN, -1, "q");
        if (rbdi_abs(q[i]) > RBDI_IK_MOST) return rbdi_ik_refuse(result, RBD_ERR_RANGE, -1, "q");
    }
    return RBD_OK;
}

/* All checks, in the order of the arguments. */
RBDI_LOCAL rbd_status rbdi_ik_check(const rbd_model *m, const rbd_work *w, const rbd_ik_target *targets,
                                    int n, const rbd_ik_options *options, const void *memory, size_t size,
                                    const rbd_real *q, rbd_ik_result *result) {
    rbd_status status = rbdi_check(m, w, targets && memory && q);
    if (status) return rbdi_ik_refuse(result, status, -1, NULL);
    if (n < 1 || n > RBDI_IK_MOST_TARGETS) return rbdi_ik_refuse(result, RBD_ERR_COUNT, -1, NULL);

    for (int i = 0; i < n && !status; ++i) status = rbdi_ik_check_target(m, &targets[i], i, result);
    if (!status && options) status = rbdi_ik_check_options(options, result);
    if (!status && options && options->held) status = rbdi_ik_check_held(m, options->held, result);
    if (!status && size < rbd_ik_size(m, n)) status = rbdi_ik_refuse(result, RBD_ERR_MEMORY, -1, NULL);
    return status ? status : rbdi_ik_check_q(m, q, result);
}

#endif
