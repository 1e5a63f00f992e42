#ifndef RBDI_MODEL_JOINTS_H
#define RBDI_MODEL_JOINTS_H
#include "model/work.h"
#include "algebra/spatial.h"
#include "algebra/rotations.h"
#include "model/features.h"

/* Interface: rbdi_along_axis, rbdi_array_up, rbdi_batch_up, rbdi_block_link, rbdi_block_motion,
   rbdi_cross_shift, rbdi_down, rbdi_force_up, rbdi_force_up_block, rbdi_joint_attitude, rbdi_joint_origin,
   rbdi_joints, rbdi_link_dofs, rbdi_range_joints, rbdi_trig_of, RBDI_BY_FLAGS, RBDI_BY_FLAGS_OF, RBDI_CASES,
   RBDI_NO_CASES */

/* ---- joints [joints] ----
   Transforms of joints at q, and what the algorithms do with them. [joint types] lists the places where joint
   types differ. */

/* Whether a link is a block. All have RBDI_MASS_KEPT, so that with the common flags this is a constant. */
RBDI_INLINE int rbdi_block_link(const rbdi_link *l, int flags) {
    return (flags & RBDI_MASS_KEPT) && rbdi_is(l, RBDI_BLOCK);
}

/* Number of dofs of a link. */
RBDI_INLINE int rbdi_link_dofs(const rbd_model *m, const rbdi_link *l) {
    return rbdi_is(l, RBDI_BLOCK) ? rbdi_block_of(m, l)->n : 1;
}

/* E of a block that turns: from the axes of the joint frame to those of the body. */
RBDI_INLINE rbdi_mat rbdi_joint_attitude(int type, const rbd_real *q) {
    const rbd_real o = rbdi_zero();
    rbd_real c, s;
    if (type == RBD_SPHERICAL) return rbdi_quaternion_down(q);
    if (type != RBD_PLANAR) return rbdi_quaternion_down(q + 3);

    rbdi_sincos(q[2], &s, &c);
    return rbdi_mat_of(c, s, o, -s, c, o, o, o, rbdi_set(RBD_C(1)));
}

/* The body's origin in the joint frame of a block, or its rates if q are the rates of the coordinates. */
RBDI_INLINE rbdi_v3 rbdi_joint_origin(int type, const rbd_real *q) {
    if (type == RBD_SPHERICAL) return rbdi_vec0();
    return rbdi_vec(q[0], q[1], type == RBD_PLANAR ? rbdi_zero() : q[2]);
}

/* Pose of a block: E from parent to link, r = the link's origin in parent axes. */
RBDI_INLINE rbdi_pose rbdi_block_pose(const rbdi_link *l, const rbdi_block *b, const rbd_real *q) {
    const int slides = b->type == RBD_TRANSLATION;
    rbdi_pose X;

    X.r = rbdi_joint_origin(b->type, q);
    X.E = slides ? rbdi_mat_c(b->E) : rbdi_joint_attitude(b->type, q);

    if (!b->identity) {
        const rbdi_mat joint = rbdi_mat_c(b->E);
        if (!slides) X.E = rbdi_mul_mat(X.E, joint);
        X.r = rbdi_mul_t(joint, X.r);
    }

    X.r = rbdi_add(rbdi_vec_c(l->r), X.r);
    return X;
}

/* Sine and cosine of a link's joint angle, where rbdi_sincos_array is not there. */
RBDI_PART void rbdi_sincos_link(const rbdi_link *l, rbd_real angle, rbd_real *sine, rbd_real *cosine) {
    rbd_real s, c;

    rbdi_sincos(angle, &s, &c);
    switch ((int)l->quarters) {
    case 1:
        *sine = c;
        *cosine = -s;
        break;
    case 2:
        *sine = -s;
        *cosine = -c;
        break;
    case 3:
        *sine = -c;
        *cosine = s;
        break;
    default:
        *sine = s;
        *cosine = c;
        break;
    }
}

/* Computes all quantities of the links first .. end - 1 that depend on q alone: slides, poses of blocks,
   sines and cosines. Those of other links are lost: rbdi_sincos_array writes whole batches. The
   angle q + gamma is rounded before its sine is computed: by one more rounding of q, 6e-11 rad at q = 1e6 in
   double, or not at all if gamma is 0, because the joint angle at q = 0 is a multiple of 90 degrees. */
RBDI_PART void rbdi_range_joints(const rbd_model *m, rbd_work *w, int first, int end, const rbd_real *q) {
    int plain = 1;    /* whether no link slides or has (cos, sin) as coordinates */
    int from = first; /* of the sines: blocks at the beginning have none */

    /* angles of turning links, slides, poses of blocks */
    for (int i = first; i < end; ++i) {
        const rbdi_link *l = &m->link[i];
        w->quarters[i] = rbdi_set(l->quarters);

        if (rbdi_is(l, RBDI_REVOLUTE)) {
            w->angle[i] = q[l->iq] + l->gamma;
        } else if (rbdi_is(l, RBDI_BLOCK)) {
            from += i == from;
            w->angle[i] = rbdi_zero();
            w->block[l->block].X = rbdi_block_pose(l, rbdi_block_of(m, l), &q[l->iq]);
        } else {
            plain = 0;
            w->angle[i] = rbdi_zero();
            if (l->rho > 0 && rbdi_is(l, RBDI_SCREW)) w->angle[i] = q[l->iq] + l->gamma;
            if (rbdi_is(l, RBDI_SCREW)) w->d[i] = q[l->iq] * l->kappa + l->d;
        }
    }

#ifdef RBDI_POLYNOMIAL_SINCOS
    rbdi_sincos_array(w->angle, w->quarters, from, end, w->sine, w->cosine);
#elif defined RBDI_SINCOS /* rbd-codegen records the two for itself */
    for (int i = from; i < end; ++i)
        RBDI_SINCOS(w->angle[i], (int)m->link[i].quarters, &w->sine[i], &w->cosine[i]);
#else
    for (int i = from; i < end; ++i) rbdi_sincos_link(&m->link[i], w->angle[i], &w->sine[i], &w->cosine[i]);
#endif
    if (plain) return;

    /* joints whose q is (cos, sin), and links that only slide */
    for (int i = from; i < end; ++i) {
        const rbdi_link *l = &m->link[i];

        if (rbdi_is(l, RBDI_REVOLUTE_CS)) {
            rbd_real c, s;
            rbdi_unit_cs(&q[l->iq], &c, &s);
            w->cosine[i] = c * l->cg - s * l->sg;
            w->sine[i] = c * l->sg + s * l->cg;
        } else if (rbdi_is(l, RBDI_SCREW) && !(l->rho > 0)) {
            w->cosine[i] = rbdi_set(l->cg);
            w->sine[i] = rbdi_set(l->sg);
        }
    }
}

/* The same of all links. */
RBDI_INLINE void rbdi_joints(const rbd_model *m, rbd_work *w, const rbd_real *q) {
    rbdi_range_joints(m, w, 0, m->nl, q);
}

/* The state of a one-axis joint after rbdi_joints or rbdi_range_joints. */
RBDI_INLINE rbdi_trig rbdi_trig_of(const rbd_model *m, const rbd_work *w, int i, int flags) {
    rbdi_trig t;
    t.c = w->cosine[i];
    t.s = w->sine[i];
    t.d = flags & RBDI_SLIDES ? w->d[i] : rbdi_set(m->link[i].d);
    return t;
}

/* RBDI_BY_FLAGS(const int flags, link, call) makes the call with the link's flags in a constant that it
   declares, here `flags`. It dispatches on them, so that the most common ones are known to the compiler:
   revolute links without armature in Denavit and Hartenberg's form, parallel to their parent or at a right
   angle, and the first links of a branch at such an angle. Each case is a copy of the code. Targets without
   SIMD, such as microcontrollers, have one case for right angles, which tests the shifts. Its empty assembly
   hides from clang that shifts_ equals flags_: clang would replace it, and lose the constants. Targets
   without a floating-point unit have no case, which would save two per cent there. */
#define RBDI_CASE(known, constant, call) \
    case known: { \
        constant = known; \
        call; \
    } break;
#if !defined __OPTIMIZE__ || !RBDI_HARD_FLOAT || RBDI_REAL_KIND % 3 == 0
#define RBDI_CASES(constant, call)
#elif RBDI_SIMD > 0 && RBDI_FOR_SPEED
#define RBDI_CASES(constant, call) \
    RBDI_CASE(RBDI_TWIST_90, constant, call) \
    RBDI_CASE(RBDI_TWIST_90 | RBDI_SHIFT_Z, constant, call) \
    RBDI_CASE(RBDI_TWIST_90 | RBDI_SHIFT_R, constant, call) \
    RBDI_CASE(RBDI_TWIST_90 | RBDI_SHIFT_R | RBDI_SHIFT_Z, constant, call) \
    RBDI_CASE(RBDI_TWIST_0 | RBDI_SHIFT_R, constant, call) \
    RBDI_CASE(RBDI_OFF_CHAIN | RBDI_TWIST_90 | RBDI_SHIFT_R | RBDI_SHIFT_XYZ | RBDI_BRANCH_TURN, constant, \
              call) \
    RBDI_CASE(RBDI_OFF_CHAIN | RBDI_TWIST_0 | RBDI_SHIFT_R | RBDI_SHIFT_XYZ, constant, call)
#else
#define RBDI_CASES(constant, call) \
    case RBDI_TWIST_90: \
    case RBDI_TWIST_90 | RBDI_SHIFT_Z: \
    case RBDI_TWIST_90 | RBDI_SHIFT_R: \
    case RBDI_TWIST_90 | RBDI_SHIFT_R | RBDI_SHIFT_Z: { \
        int shifts_ = flags_; \
        RBDI_ONE_INDEX(shifts_); \
        constant = RBDI_TWIST_90 | (shifts_ & (RBDI_SHIFT_R | RBDI_SHIFT_Z)); \
        call; \
    } break; \
        RBDI_CASE(RBDI_TWIST_0 | RBDI_SHIFT_R, constant, call)
#endif
#define RBDI_NO_CASES(constant, call)
#define RBDI_BY_FLAGS_OF(cases, constant, link, call) \
    do { \
        const int flags_ = rbdi_flags(link); \
        switch (flags_) { \
        default: { \
            constant = flags_; \
            call; \
        } break; \
            cases(constant, call) \
        } \
    } while (0)
#if RBDI_FOR_SPEED
#define RBDI_BY_FLAGS(constant, link, call) RBDI_BY_FLAGS_OF(RBDI_CASES, constant, link, call)
#else
#define RBDI_BY_FLAGS(constant, link, call) RBDI_BY_FLAGS_OF(RBDI_NO_CASES, constant, link, call)
#endif

/* The vector x from the parent's axes to those of a one-axis link. */
RBDI_INLINE rbdi_v3 rbdi_down(const rbdi_link *l, int flags, rbdi_trig t, rbdi_v3 x) {
    if (flags & RBDI_BRANCH_TURN) x = rbdi_turn_z(0, rbdi_set(l->cb), rbdi_set(l->sb), x);
    x = rbdi_uncycle(rbdi_turn_z(flags, rbdi_set(l->ca), rbdi_set(l->sa), rbdi_cycle(x)));
    return rbdi_turn_z(0, t.c, t.s, x);
}

/* omega x r, for the parent-side shift r. */
RBDI_INLINE rbdi_v3 rbdi_cross_shift(const rbdi_link *l, int flags, rbdi_v3 omega) {
    rbdi_v3 x = rbdi_vec(rbdi_zero(), omega.z * l->r.x, -(omega.y * l->r.x));
    if (flags & RBDI_SHIFT_XYZ) {
        x.x = omega.y * l->r.z - omega.z * l->r.y;
        x.y = x.y - omega.x * l->r.z;
        x.z = x.z + omega.x * l->r.y;
    }
    return x;
}

/* The force F of a one-axis link to the parent's axes and origin: rbdi_array_up of six scalars, rbdi_batch_up
   of six batches. */
#define RBDI_T rbd_real
#include "model/force_up.h"
#undef RBDI_T
#if RBDI_BATCH > 1
#define RBDI_T rbdi_batch
#define rbdi_array_turn rbdi_batch_turn
#define rbdi_array_up rbdi_batch_up
#include "model/force_up.h"
#undef rbdi_array_up
#undef rbdi_array_turn
#undef RBDI_T
#endif

RBDI_INLINE rbdi_force rbdi_force_up(const rbdi_link *l, int flags, rbdi_trig t, rbdi_force F) {
    rbd_real array[6];
    rbdi_store_force(array, 1, F);
    rbdi_array_up(l, flags, t, array);
    return rbdi_load_force(array, 1);
}

/* The same of a block. */
RBDI_INLINE rbdi_force rbdi_force_up_block(const rbdi_pose *X, rbdi_force F) {
    F.f = rbdi_mul_t(X->E, F.f);
    F.n = rbdi_add(rbdi_mul_t(X->E, F.n), rbdi_cross(X->r, F.f));
    return F;
}

/* S' F of a one-axis joint. */
RBDI_INLINE rbd_real rbdi_along_axis(const rbdi_link *l, int flags, rbdi_force F) {
    return flags & RBDI_SLIDES ? F.n.z * l->rho + F.f.z * l->kappa : F.n.z;
}

/* S v of a block. */
RBDI_INLINE rbdi_motion rbdi_block_motion(const rbdi_block *b, const rbd_real *v) {
    rbd_real array[6];
    if (b->n == 6) return rbdi_load_motion(v, 1);
    for (int k = 0; k < 6; ++k) array[k] = rbdi_zero();
    for (int k = 0; k < b->n; ++k) array[b->first + k] = v[k];
    return rbdi_load_motion(array, 1);
}

#endif
