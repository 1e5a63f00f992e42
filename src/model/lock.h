#ifndef RBDI_MODEL_LOCK_H
#define RBDI_MODEL_LOCK_H
#include "api/model.h"
#include "model/links.h"

/* -- joints held still -- */

/* Sine and cosine of an angle of any size. Long division by the right angle gives the number of right angles
   and the rest. Only the right angle is rounded, so the error is at most that of one more rounding of x. */
RBDI_LOCAL void rbdi_w_sincos(rbdi_wide x, rbdi_wide *s, rbdi_wide *c) {
    const rbdi_wide right_angle = RBDI_PI(rbdi_wide) / 2;
    rbdi_wide rest = rbdi_w_abs(x), part = right_angle, sine, cosine;
    int quarters = 0;

    while (part <= rest / 2) part += part;
    for (; part >= right_angle; part /= 2) {
        quarters = 2 * quarters & 3;
        if (rest < part) continue;
        rest -= part;
        ++quarters;
    }

    rbdi_w_series(rest, &sine, &cosine);
    *s = quarters & 1 ? cosine : sine;
    *c = quarters & 1 ? sine : cosine;
    if (((quarters & 2) != 0) != (x < 0)) *s = -*s;
    if ((quarters + 1) & 2) *c = -*c;
}

/* u = q, n numbers, of unit length; if q is shorter than 1e-15, component `one` is 1 and the others are 0. */
RBDI_LOCAL void rbdi_w_direction(const double *q, int n, int one, rbdi_wide *u) {
    rbdi_wide largest = 0, sum = 0, length;

    for (int k = 0; k < n; ++k)
        if (rbdi_w_abs(q[k]) > largest) largest = rbdi_w_abs(q[k]);
    for (int k = 0; k < n; ++k) u[k] = largest > 0 ? q[k] / largest : 0;
    for (int k = 0; k < n; ++k) sum += u[k] * u[k];
    length = RBDI_WIDE_LIBM(rbdi_root)(sum);

    if (largest * length < (rbdi_wide)1e-15) {
        for (int k = 0; k < n; ++k) u[k] = k == one;
        return;
    }

    for (int k = 0; k < n; ++k) u[k] /= length;
}

/* E of a turn about a unit vector n: c 1 + (1 - c) n n' - s [n]x (Rodrigues, transposed). */
RBDI_LOCAL void rbdi_w_turn(const rbdi_wide n[3], rbdi_wide c, rbdi_wide s, rbdi_wide E[9]) {
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        E[4 * i] = c + (1 - c) * n[i] * n[i];
        E[3 * i + j] = (1 - c) * n[i] * n[j] + s * n[k];
        E[3 * i + k] = (1 - c) * n[i] * n[k] - s * n[j];
    }
}

/* E of a quaternion (v; w) of any length: a turn about v with cosine w w - v'v and sine 2 w |v|. */
RBDI_LOCAL void rbdi_w_quaternion(const double *q, rbdi_wide E[9]) {
    rbdi_wide u[4], length;
    rbdi_w_direction(q, 4, 3, u);
    length = rbdi_w_length(u);
    for (int k = 0; k < 3 && length > 0; ++k) u[k] /= length;
    rbdi_w_turn(u, u[3] * u[3] - length * length, 2 * u[3] * length, E);
}

/* Motion of a link by its joint: its pose at q in its frame at q = 0. */
RBDI_LOCAL rbdi_wide_pose rbdi_axis_motion_at(const rbdi_build_link *l, const double *q) {
    rbdi_wide_pose X;
    rbdi_wide u[2], c, s;

    if (l->kind == RBDI_REVOLUTE_CS) {
        rbdi_w_direction(q, 2, 0, u);
        c = u[0];
        s = u[1];
    } else {
        rbdi_w_sincos(l->rho * q[l->iq], &s, &c);
    }

    rbdi_w_turn(l->axis, c, s, X.E);
    for (int k = 0; k < 3; ++k) X.r[k] = l->kappa * q[l->iq] * l->axis[k];
    return X;
}

RBDI_LOCAL rbdi_wide_pose rbdi_block_motion_at(int type, const double *q) {
    rbdi_wide_pose X;
    rbdi_wide c, s;

    rbdi_w_identity(X.E);
    for (int k = 0; k < 3; ++k) X.r[k] = type == RBD_SPHERICAL || (type == RBD_PLANAR && k == 2) ? 0 : q[k];
    if (type == RBD_SPHERICAL) rbdi_w_quaternion(q, X.E);
    if (type == RBD_FLOATING) rbdi_w_quaternion(q + 3, X.E);

    if (type == RBD_PLANAR) {
        rbdi_w_sincos(q[2], &s, &c);
        rbdi_w_turn_z(c, s, X.E);
    }

    return X;
}

/* Pose of a body in its parent at the coordinates q of its joint: that at q = 0, then the motion of each link
   that the joint has in the build. */
RBDI_LOCAL rbdi_wide_pose rbdi_body_pose_at(const rbd_body *b, const double *q) {
    rbd_body alone = *b;
    rbdi_build_link links[3];
    rbdi_place place;
    rbdi_build build;
    rbdi_wide_pose X;
    int n = 0;

    alone.parent = -1;
    place.iq = place.iv = 0;
    build.bodies = &alone;
    build.links = links;
    build.place = &place;
    rbdi_build_joint(&build, 0, &n);

    X = links[0].X;
    for (int k = 0; k < n; ++k) {
        const rbdi_wide_pose motion = links[k].kind == RBDI_BLOCK ? rbdi_block_motion_at(links[k].type, q)
                                                                  : rbdi_axis_motion_at(&links[k], q);
        X = rbdi_w_compose(&motion, &X);
    }

    return X;
}

/* Where the coordinates of body i begin in q. */
RBDI_LOCAL int rbdi_first_coordinate(const rbd_body *bodies, int i) {
    int iq = 0;
    for (int k = 0; k < i; ++k)
        if (!bodies[k].mimic) iq += rbdi_joint_facts((int)bodies[k].type)->nq;
    return iq;
}

/* The coordinates at q of body i's joint, of one that mimics from those of the joint that it follows; returns
   their number. */
RBDI_LOCAL int rbdi_own_coordinates(const rbd_body *bodies, int nb, int i, const double *q, double own[7]) {
    const rbd_body *b = &bodies[i];
    const int from = b->mimic ? rbdi_mimic_source(bodies, nb, i) : i;
    const int first = rbdi_first_coordinate(bodies, from), n = rbdi_joint_facts((int)b->type)->nq;
    for (int k = 0; k < n; ++k) own[k] = q[first + k];
    if (b->mimic) own[0] = b->mimic_ratio * own[0] + b->mimic_offset;
    return n;
}

/* Whether body i's joint shall be held: its flag is set, or that of the joint that it mimics. */
RBDI_LOCAL int rbdi_is_held(const rbd_body *bodies, int nb, int i, const unsigned char *locked) {
    if (bodies[i].type == RBD_FIXED) return 0;
    return locked[i] || (bodies[i].mimic && locked[rbdi_mimic_source(bodies, nb, i)]);
}

/* Makes the joint of a row fixed at its coordinates q. */
RBDI_LOCAL void rbdi_hold(rbd_body *row, const double *q) {
    const rbdi_wide_pose X = rbdi_body_pose_at(row, q);
    rbdi_wide R[9];

    rbdi_w_transpose(X.E, R);
    for (int k = 0; k < 9; ++k) row->rotation[k] = (double)R[k];

    for (int k = 0; k < 3; ++k) {
        row->position[k] = (double)X.r[k];
        row->axis[k] = row->axis2[k] = 0;
    }

    for (int k = 0; k < 6; ++k) row->armature[k] = row->damping[k] = row->friction[k] = 0;
    row->type = RBD_FIXED;
    row->pitch = row->lower = row->upper = row->velocity = row->effort = 0;
    row->mimic = NULL;
    row->mimic_ratio = row->mimic_offset = 0;
}

RBDI_API rbd_status rbd_lock_joints(const rbd_body *bodies, int nb, const unsigned char *locked,
                                    const double *q, rbd_body *rows, rbd_report *report) {
    rbd_report own;
    double x[7];

    if (!report) report = &own;
    report->warnings = 0;
    rbdi_refuse(report, RBD_OK, -1, NULL, NULL);

    if (!bodies || !locked || !q || !rows) return rbdi_refuse(report, RBD_ERR_NULL, -1, NULL, NULL);
    if (nb < 1 || nb > RBD_MAX_BODIES) return rbdi_refuse(report, RBD_ERR_COUNT, -1, NULL, NULL);

    for (int i = 0; i < nb; ++i) {
        const rbd_status status = rbdi_check_body(bodies, nb, i, report);
        if (status) return status;
    }

    for (int i = 0; i < nb; ++i) {
        if (!rbdi_is_held(bodies, nb, i, locked)) continue;
        if (rbdi_finite(x, rbdi_own_coordinates(bodies, nb, i, q, x))) continue;
        return rbdi_refuse_saying(report, RBD_ERR_RANGE, i, bodies[i].name, "q",
                                  "a coordinate of its joint, which shall be held, is not finite");
    }

    /* Followers first, then from the last to the first: of each row those that it depends on are still as
       they were, even if rows is bodies. */
    for (int i = 0; i < nb; ++i) rows[i] = bodies[i];

    for (int followers = 1; followers >= 0; --followers)
        for (int i = nb - 1; i >= 0; --i) {
            if ((rows[i].mimic != NULL) != followers || !rbdi_is_held(rows, nb, i, locked)) continue;
            (void)rbdi_own_coordinates(rows, nb, i, q, x);
            rbdi_hold(&rows[i], x);
        }

    return RBD_OK;
}

#endif
