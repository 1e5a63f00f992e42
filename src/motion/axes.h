#ifndef RBDI_MOTION_AXES_H
#define RBDI_MOTION_AXES_H
#include "model/layout.h"
#include "base/simd.h"
#include "algebra/vectors.h"

/* Interface: rbdi_axes, rbdi_axes_block, rbdi_axes_step, rbdi_axis_vec, rbdi_load_axes, rbdi_set_axis,
   rbdi_world_axes */

/* ---- axes and origins of links [axes] ---- */

/* Axes and origin of a link, in the axes of the world or of a base. */
typedef struct rbdi_axes {
    rbdi_four x, y, z, origin;
} rbdi_axes;
/* A vector to and from a rbdi_four; the fourth is not used. */
RBDI_INLINE void rbdi_set_axis(rbdi_four *a, rbdi_v3 v) { rbdi_set_four(a, v.x, v.y, v.z, v.z); }
RBDI_INLINE rbdi_v3 rbdi_axis_vec(const rbdi_four *a) {
    return rbdi_vec(rbdi_one_of(a, 0), rbdi_one_of(a, 1), rbdi_one_of(a, 2));
}

/* From a pose, and back. */
RBDI_INLINE void rbdi_load_axes(rbdi_axes *p, const rbdi_pose *X) {
    rbdi_set_axis(&p->x, rbdi_vec(X->E.xx, X->E.xy, X->E.xz));
    rbdi_set_axis(&p->y, rbdi_vec(X->E.yx, X->E.yy, X->E.yz));
    rbdi_set_axis(&p->z, rbdi_vec(X->E.zx, X->E.zy, X->E.zz));
    rbdi_set_axis(&p->origin, X->r);
}

RBDI_INLINE void rbdi_store_axes(rbdi_pose *X, const rbdi_axes *p) {
    rbdi_put_four(&X->E.xx, &p->x); /* the fourth goes to the next row, which is stored next */
    rbdi_put_four(&X->E.yx, &p->y);
    X->E.zx = rbdi_one_of(&p->z, 0);
    X->E.zy = rbdi_one_of(&p->z, 1);
    X->E.zz = rbdi_one_of(&p->z, 2);
    X->r = rbdi_axis_vec(&p->origin);
}

/* The world's own axes, with its origin. */
RBDI_INLINE void rbdi_world_axes(rbdi_axes *p) {
    const rbd_real one = rbdi_set(RBD_C(1)), o = rbdi_zero();
    rbdi_set_axis(&p->x, rbdi_vec(one, o, o));
    rbdi_set_axis(&p->y, rbdi_vec(o, one, o));
    rbdi_set_axis(&p->z, rbdi_vec(o, o, one));
    rbdi_set_axis(&p->origin, rbdi_vec(o, o, o));
}

/* Turns the axes a, b in their plane, as rbdi_turn_z turns x, y. */
RBDI_INLINE void rbdi_turn_axes(int flags, rbd_real c, rbd_real s, rbdi_four *a, rbdi_four *b) {
    const rbdi_four from = *a;
    if (flags & RBDI_TWIST_0) return;

    if (flags & RBDI_TWIST_90) {
        *a = *b;
        rbdi_scale_four(b, rbdi_set(RBD_C(-1)), &from);
        return;
    }

    rbdi_scale_four(a, c, a);
    rbdi_add_four(a, s, b);
    rbdi_scale_four(b, c, b);
    rbdi_add_four(b, -s, &from);
}

/* The parent's axes and origin become those of a one-axis link; a root keeps the origin. */
RBDI_INLINE void rbdi_axes_step(const rbdi_link *l, int flags, rbdi_trig t, rbdi_axes *p) {
    if ((flags & RBDI_SHIFT_R) && !(flags & RBDI_ROOT)) {
        rbdi_add_four(&p->origin, rbdi_set(l->r.x), &p->x);
        if (flags & RBDI_SHIFT_XYZ) {
            rbdi_add_four(&p->origin, rbdi_set(l->r.y), &p->y);
            rbdi_add_four(&p->origin, rbdi_set(l->r.z), &p->z);
        }
    }

    if (flags & RBDI_BRANCH_TURN) rbdi_turn_axes(0, rbdi_set(l->cb), rbdi_set(l->sb), &p->x, &p->y);
    rbdi_turn_axes(flags, rbdi_set(l->ca), rbdi_set(l->sa), &p->y, &p->z);
    rbdi_turn_axes(0, t.c, t.s, &p->x, &p->y);
    if ((flags & RBDI_SHIFT_Z) && !(flags & RBDI_ROOT)) rbdi_add_four(&p->origin, t.d, &p->z);
}

/* The same of a block. */
RBDI_INLINE void rbdi_axes_block(const rbdi_pose *X, int root, rbdi_axes *p) {
    const rbdi_four x = p->x, y = p->y, z = p->z;

    if (!root) rbdi_add_four(&p->origin, X->r.x, &x);
    if (!root) rbdi_add_four(&p->origin, X->r.y, &y);
    if (!root) rbdi_add_four(&p->origin, X->r.z, &z);
    rbdi_scale_four(&p->x, X->E.xx, &x);
    rbdi_add_four(&p->x, X->E.xy, &y);
    rbdi_scale_four(&p->y, X->E.yx, &x);
    rbdi_add_four(&p->y, X->E.yy, &y);
    rbdi_scale_four(&p->z, X->E.zx, &x);
    rbdi_add_four(&p->z, X->E.zy, &y);
    rbdi_add_four(&p->x, X->E.xz, &z);
    rbdi_add_four(&p->y, X->E.yz, &z);
    rbdi_add_four(&p->z, X->E.zz, &z);
}

#endif
