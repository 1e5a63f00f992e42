#ifndef RBDI_CONSTRAINTS_ROWS_H
#define RBDI_CONSTRAINTS_ROWS_H
#include "dynamics/crba.h"
#include "constraints/kinematics.h"

/* Interface: rbdi_constraint_columns, rbdi_constraint_rows, rbdi_constraint_state, rbdi_next_link, rbdi_walk,
   rbdi_walk_of */

/* ---- rows [rows] ---- */

/* Adds a motion, world axes, that a dof gives to body 1 at the origin of frame 1, to the dof's column of J.
   sign: -1 if it gives the motion to body 2. A mimic joint's goes to the joint that it follows. */
RBDI_ONCE void rbdi_constraint_column(const rbd_model *m, rbd_constraint_set *c, const rbdi_constraint *con,
                                      const rbdi_axes_held *h, int dof, int sign, rbdi_v3 angular,
                                      rbdi_v3 linear) {
    if (sign < 0 || dof >= m->nv) {
        const rbd_real ratio = sign < 0 ? -rbdi_ratio(m, dof) : rbdi_ratio(m, dof);
        angular = rbdi_scale(ratio, angular);
        linear = rbdi_scale(ratio, linear);
    }

    rbdi_add_held(con, h, angular, linear, &c->Y[rbdi_source(m, dof) * c->stride + con->row]);
}

/* Columns of the dofs of a link on a path. p: origin of frame 1, arm = p less the link's origin.

       turn about z         (z; z x arm)
       slide along z        (0; z)
       screw                (rho z; kappa z + rho z x arm)

   A block has turns about x, y, z and slides along them, in this order, from its first axis on. */
RBDI_INLINE void rbdi_constraint_link(const rbd_model *m, rbd_constraint_set *c, const rbdi_constraint *con,
                                      const rbdi_axes_held *h, rbdi_v3 p, int link, int sign) {
    const rbdi_link *l = &m->link[link];
    const rbdi_pose X = c->w->kin[link].X;
    const rbdi_v3 arm = rbdi_sub(p, X.r), z = rbdi_vec(X.E.zx, X.E.zy, X.E.zz), o = rbdi_vec0();

    if (rbdi_is(l, RBDI_REVOLUTE) || rbdi_is(l, RBDI_REVOLUTE_CS)) {
        rbdi_constraint_column(m, c, con, h, l->iv, sign, z, rbdi_cross(z, arm));
    } else if (rbdi_is(l, RBDI_SCREW)) {
        const rbdi_v3 turn = rbdi_scale(rbdi_set(l->rho), z), slide = rbdi_scale(rbdi_set(l->kappa), z);
        rbdi_constraint_column(m, c, con, h, l->iv, sign, turn, rbdi_add(slide, rbdi_cross(turn, arm)));
    } else {
        const rbdi_v3 axis[3] = {rbdi_vec(X.E.xx, X.E.xy, X.E.xz), rbdi_vec(X.E.yx, X.E.yy, X.E.yz), z};
        const int first = rbdi_block_of(m, l)->first;
        for (int j = 0; j < rbdi_link_dofs(m, l); ++j) {
            const int at = first + j;
            rbdi_constraint_column(m, c, con, h, l->iv + j, sign, at < 3 ? axis[at] : o,
                                   at < 3 ? rbdi_cross(axis[at], arm) : axis[at - 3]);
        }
    }
}

/* A walk over the links that move only one of a constraint's two bodies, from the bodies to their common
   ancestor. The motions of links on both paths cancel. */
typedef struct rbdi_walk {
    int end[2]; /* the next link on the path of body 1 and of body 2 */
    int link;   /* the link that the walk is at */
    int side;   /* 0 if it moves body 1, 1 if body 2 */
} rbdi_walk;

RBDI_INLINE rbdi_walk rbdi_walk_of(const rbdi_constraint *con) {
    const rbdi_walk walk = {{con->link[0], con->link[1]}, -1, 0};
    return walk;
}

/* Steps to the next link: of the two ends the one with the larger index, which its parent replaces. Returns
   0 at the common ancestor. */
RBDI_INLINE int rbdi_next_link(const rbd_model *m, rbdi_walk *walk) {
    if (walk->end[0] == walk->end[1]) return 0;

    walk->side = walk->end[0] < walk->end[1];
    walk->link = walk->end[walk->side];
    walk->end[walk->side] = m->link[walk->link].parent;
    return 1;
}

/* Poses of the links on a path and, if `moving`, velocities of their origins, from the angular velocities. */
RBDI_LOCAL void rbdi_kin_of_paths(const rbd_model *m, rbd_constraint_set *c, const rbd_real *v, int moving) {
    for (int n = 0; n < c->links;) {
        const int first = c->link[n];
        int end = first;

        /* consecutive links in one call */
        for (; n < c->links && c->link[n] == end; ++n) ++end;
        rbdi_kin_links(m, c->w, first, end, v, moving);
    }

    if (rbdi_mimics(m)) rbdi_kin_links(m, c->w, 0, m->nl, v, moving);
}

/* Writes the motion of all links and the poses of those on a path into the work, over the results of
   rbd_kinematics; if `wrench`, also the wrenches of inverse dynamics. Gravity is an acceleration of the
   world. Call rbdi_joints before. */
RBDI_INLINE void rbdi_constraint_state(const rbd_model *m, rbd_constraint_set *c, const rbd_real *v,
                                       const rbd_real *a, rbdi_c3 gravity, int wrench) {
    rbd_work *w = c->w;
    const rbdi_state world = rbdi_world_state(gravity);
    c->world = world.acc;
    w->kinematics_of = RBDI_NO_KINEMATICS;

    rbdi_forward(m, w, 0, m->nl, &world, v, a, wrench, 1);
    rbdi_kin_of_paths(m, c, v, 1);
}

/* Clears J v, gamma, e, Y and R. Articulated bodies read entries of Y and R that they do not write. */
RBDI_LOCAL void rbdi_clear_rows(const rbd_model *m, rbd_constraint_set *c) {
    rbdi_clear(c->Y, m->nv * c->stride);
    rbdi_clear(c->R, c->rows * c->stride);
    rbdi_clear(c->velocity, 3 * c->stride);
    c->dirty = 1;
}

/* Adds Y = J' of a constraint. p: origin of frame 1. */
RBDI_LOCAL void rbdi_constraint_columns(const rbd_model *m, rbd_constraint_set *c, const rbdi_constraint *con,
                                        const rbdi_axes_held *h, rbdi_v3 p) {
    for (rbdi_walk walk = rbdi_walk_of(con); rbdi_next_link(m, &walk);)
        rbdi_constraint_link(m, c, con, h, p, walk.link, walk.side ? -1 : 1);
}

enum { RBDI_SLOPES = 2 };

/* Adds Y = J', gamma and J v of a constraint and, if `errors`, e. With errors = RBDI_SLOPES, Y = (de/dq)',
   which differs from J' in the row of a single angular axis. */
RBDI_LOCAL void rbdi_constraint_rows(const rbd_model *m, rbd_constraint_set *c, const rbdi_constraint *con,
                                     int errors) {
    rbdi_axes_held h;
    rbdi_v3 p;

    rbdi_set_axes(c, con, &h);
    p = rbdi_constraint_motion(c, con, &h, errors);

    if (errors == RBDI_SLOPES && con->angular == 1) rbdi_bend_axis(c, con, &h);
    rbdi_constraint_columns(m, c, con, &h, p);
}

#endif
