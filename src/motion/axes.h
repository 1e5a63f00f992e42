#ifndef RBDI_MOTION_AXES_H
#define RBDI_MOTION_AXES_H
#include "model/joints.h"

/* Interface: rbdi_pose_block, rbdi_pose_step, rbdi_world_pose */

/* ---- axes and origins of links [axes] ----
   Poses of links in one frame, that of the world or of a base: the rows of E are a link's axes, r is its
   origin. */

/* The pose of that frame itself. */
RBDI_INLINE rbdi_pose rbdi_world_pose(void) {
    const rbd_real o = rbdi_zero(), one = rbdi_set(RBD_C(1));
    rbdi_pose p;
    p.E = rbdi_mat_of(one, o, o, o, one, o, o, o, one);
    p.r = rbdi_vec0();
    return p;
}

/* The pose of a one-axis link from its parent's, p: E = turns E_p, r = r_p + E_p' r_l + E' d z. A root keeps
   the origin. */
RBDI_INLINE rbdi_pose rbdi_pose_step(const rbdi_link *l, int flags, rbdi_trig t, rbdi_pose p) {
    rbdi_v3 x = rbdi_vec(p.E.xx, p.E.yx, p.E.zx); /* the columns of E: the frame's axes in the link's */
    rbdi_v3 y = rbdi_vec(p.E.xy, p.E.yy, p.E.zy);
    rbdi_v3 z = rbdi_vec(p.E.xz, p.E.yz, p.E.zz);

    if ((flags & RBDI_SHIFT_R) && !(flags & RBDI_ROOT)) {
        p.r = rbdi_add(p.r, rbdi_scale(rbdi_set(l->r.x), rbdi_vec(p.E.xx, p.E.xy, p.E.xz)));
        if (flags & RBDI_SHIFT_XYZ) {
            p.r = rbdi_add(p.r, rbdi_scale(rbdi_set(l->r.y), rbdi_vec(p.E.yx, p.E.yy, p.E.yz)));
            p.r = rbdi_add(p.r, rbdi_scale(rbdi_set(l->r.z), rbdi_vec(p.E.zx, p.E.zy, p.E.zz)));
        }
    }

    x = rbdi_down(l, flags, t, x);
    y = rbdi_down(l, flags, t, y);
    z = rbdi_down(l, flags, t, z);
    p.E = rbdi_mat_of(x.x, y.x, z.x, x.y, y.y, z.y, x.z, y.z, z.z);

    if ((flags & RBDI_SHIFT_Z) && !(flags & RBDI_ROOT))
        p.r = rbdi_add(p.r, rbdi_scale(t.d, rbdi_vec(p.E.zx, p.E.zy, p.E.zz)));
    return p;
}

/* The same of a block with the pose X in its parent. */
RBDI_INLINE rbdi_pose rbdi_pose_block(const rbdi_pose *X, rbdi_pose p) {
    p.r = rbdi_add(p.r, rbdi_mul_t(p.E, X->r));
    p.E = rbdi_mul_mat(X->E, p.E);
    return p;
}

#endif
