#ifndef RBDI_DERIVATIVES_COMMON_FRAME_H
#define RBDI_DERIVATIVES_COMMON_FRAME_H
#include "dynamics/state.h"
#include "motion/axes.h"
#include "derivatives/columns.h"

/* ---- motion in the common frame [common motion] ---- */

/* The last dof of a link, in the solver's order. */
RBDI_INLINE int rbdi_last_dof(const rbd_model *m, int link) {
    return m->link[link].first + rbdi_link_dofs(m, &m->link[link]) - 1;
}

/* The axis of dof k of a link: 0 to 2 for x, y, z. */
RBDI_INLINE int rbdi_dof_axis(const rbd_model *m, const rbdi_link *l, int k) {
    return rbdi_is(l, RBDI_BLOCK) ? (rbdi_block_of(m, l)->first + k - l->first) % 3 : 2;
}

/* Stores axes and origin of a link for dof k. e: the axes, cycled so that the last is the dof's own. */
RBDI_INLINE void rbdi_put_axes(rbd_derivatives *d, int k, rbdi_v3 ex, rbdi_v3 ey, rbdi_v3 ez,
                               rbdi_v3 origin) {
    rbdi_store_vec(RBDI_OF(d, k, ex), RBDI_BATCH, ex);
    rbdi_store_vec(RBDI_OF(d, k, ey), RBDI_BATCH, ey);
    rbdi_store_vec(RBDI_OF(d, k, ez), RBDI_BATCH, ez);
    rbdi_store_vec(RBDI_OF(d, k, x), RBDI_BATCH, origin);
}

/* The same for the dofs of a block from k on. */
RBDI_PART void rbdi_put_block_axes(const rbd_model *m, rbd_derivatives *d, const rbdi_link *l, int k,
                                   const rbdi_pose *p) {
    const rbdi_v3 e[3] = {rbdi_vec(p->E.xx, p->E.xy, p->E.xz), rbdi_vec(p->E.yx, p->E.yy, p->E.yz),
                          rbdi_vec(p->E.zx, p->E.zy, p->E.zz)};

    for (; k < d->entry[l->first].joint; ++k) {
        const int axis = rbdi_dof_axis(m, l, k);
        rbdi_put_axes(d, k, e[(axis + 1) % 3], e[(axis + 2) % 3], e[axis], p->r);
    }
}

/* Pose of a link in the common frame, x_link = E (x - r), from its last dof. */
RBDI_INLINE rbdi_pose rbdi_common_pose(const rbd_model *m, const rbd_derivatives *d, int link) {
    const int last = rbdi_last_dof(m, link), axis = rbdi_dof_axis(m, &m->link[link], last);
    rbdi_v3 e[3];
    rbdi_pose pose;

    e[(axis + 1) % 3] = rbdi_load_vec(RBDI_OF(d, last, ex), RBDI_BATCH);
    e[(axis + 2) % 3] = rbdi_load_vec(RBDI_OF(d, last, ey), RBDI_BATCH);
    e[axis] = rbdi_load_vec(RBDI_OF(d, last, ez), RBDI_BATCH);

    pose.E.xx = e[0].x;
    pose.E.xy = e[0].y;
    pose.E.xz = e[0].z;
    pose.E.yx = e[1].x;
    pose.E.yy = e[1].y;
    pose.E.yz = e[1].z;
    pose.E.zx = e[2].x;
    pose.E.zy = e[2].y;
    pose.E.zz = e[2].z;
    pose.r = rbdi_load_vec(RBDI_OF(d, last, x), RBDI_BATCH);
    return pose;
}

/* Moves the common origin from the root's origin to that of link i, which is at x. */
RBDI_PART void rbdi_move_origin(const rbd_model *m, rbd_derivatives *d, int i, rbdi_v3 x) {
    for (int k = m->link[d->origin[i]].first; k < m->link[i].first; ++k)
        rbdi_store_vec(RBDI_OF(d, k, x), RBDI_BATCH,
                       rbdi_sub(rbdi_load_vec(RBDI_OF(d, k, x), RBDI_BATCH), x));
}

/* Axes and origins of all links. base: dofs of a free base whose axes the frame has, or 0. */
RBDI_PART void rbdi_poses(const rbd_model *m, rbd_derivatives *d, int base) {
    const int frame = base ? 0 : -1; /* the link, or the world, whose axes the common frame has */
    rbdi_pose p = rbdi_world_pose(); /* of the link before, then of link i */

    for (int i = 0; i < m->nl; ++i) {
        const rbdi_link *l = &m->link[i];

        /* the parent's pose, unless p is that already */
        if (l->parent <= frame) {
            p = rbdi_world_pose();
        } else if (l->parent != i - 1) {
            p = rbdi_common_pose(m, d, l->parent);
        }

        /* link i's. A root block has the common origin, and a base its axes too */
        if (!rbdi_is(l, RBDI_BLOCK))
            RBDI_BY_FLAGS(const int flags, l,
                          p = rbdi_pose_step(l, flags, rbdi_trig_of(m, d->work, i, flags), p));
        else if (!rbdi_on_world(l))
            p = rbdi_pose_block(&d->work->block[l->block].X, p);
        else if (!base || i > 0)
            p.E = d->work->block[l->block].X.E;

        /* the common origin is that of this link */
        if (d->origin[i] >= 0) {
            if (d->origin[i] < i) rbdi_move_origin(m, d, i, p.r);
            p.r = rbdi_vec0();
        }

        /* of a base only the last dof, which has the inertia, needs axes */
        if (rbdi_is(l, RBDI_BLOCK)) {
            const rbdi_pose own = p; /* an address of p would keep it in memory */
            rbdi_put_block_axes(m, d, l, i == 0 && base ? base - 1 : l->first, &own);
        } else {
            rbdi_put_axes(d, l->first, rbdi_vec(p.E.xx, p.E.xy, p.E.xz), rbdi_vec(p.E.yx, p.E.yy, p.E.yz),
                          rbdi_vec(p.E.zx, p.E.zy, p.E.zz), p.r);
        }
    }
}

/* S = (rho ez; kappa ez + x x rho ez) of the dofs from batch b on. */
RBDI_PART void rbdi_motion_columns(rbd_derivatives *d, int b) {
    for (; b < d->batches; ++b) {
        rbdi_columns *cols = &d->columns[b];
        const rbdi_constants *own = &d->constants[b];
        const rbdi_b3 ez = cols->ez;
        const rbdi_b3 turn = rbdi_b_vec(ez.x * own->rho, ez.y * own->rho, ez.z * own->rho);
        const rbdi_b3 slide = rbdi_b_vec(ez.x * own->kappa, ez.y * own->kappa, ez.z * own->kappa);

        cols->S.omega = turn;
        cols->S.v = rbdi_b_cross_add(slide, cols->x, turn);
    }
}

/* Sums over ancestors: p of an rbdi_carried from the joints' parts.
   Vp      the first scalar of p in d->columns
   world   the motion of the roots' parent or, with a base, of the base
   moves   whether the motion is a velocity, which is taken relative to that of the common origin */
RBDI_INLINE void rbdi_sum_ancestors(rbd_derivatives *d, int base, rbd_real *Vp, rbdi_motion world,
                                    int moves) {
    const ptrdiff_t apart = offsetof(rbdi_carried, joint) / sizeof(rbd_real); /* from p to joint */
    const rbdi_entry *entry = d->entry;
    const rbdi_segment *seg = d->segment + (base > 0), *end = d->segment + d->segments;

    if (base) { /* as if its joint did not move */
        rbdi_store_motion(Vp + entry[base - 1].at, RBDI_BATCH, world);
        rbdi_store_motion(Vp + entry[base - 1].at + apart, RBDI_BATCH, rbdi_motion0());
    }

    for (; seg < end; ++seg) {
        rbdi_motion V = world;

        /* the motion of the parent, the last dof of another segment */
        if (seg->parent >= base) {
            const rbd_real *in = Vp + entry[seg->parent].at;
            V = rbdi_motion_add(rbdi_load_motion(in, RBDI_BATCH), rbdi_load_motion(in + apart, RBDI_BATCH));
        }

        /* of a root: that of the world, -v of the common origin */
        if (moves) {
            for (int k = seg->first; k < seg->origin; ++k)
                V.v = rbdi_sub(V.v, rbdi_load_vec(Vp + entry[k].at + apart + 3 * RBDI_BATCH, RBDI_BATCH));
        }

        /* of a block: all dofs have its p and its joint's sum */
        if (seg->block) {
            rbdi_motion all = rbdi_motion0();
            for (int k = seg->first; k < seg->end; ++k)
                all = rbdi_motion_add(all, rbdi_load_motion(Vp + entry[k].at + apart, RBDI_BATCH));
            for (int k = seg->first; k < seg->end; ++k) {
                rbdi_store_motion(Vp + entry[k].at, RBDI_BATCH, V);
                rbdi_store_motion(Vp + entry[k].at + apart, RBDI_BATCH, all);
            }
            continue;
        }

        /* of a chain: dof by dof */
        for (int k = seg->first; k < seg->end; ++k) {
            rbd_real *out = Vp + entry[k].at;
            RBDI_ONE_INDEX(out);
            rbdi_store_motion(out, RBDI_BATCH, V);
            V = rbdi_motion_add(V, rbdi_load_motion(out + apart, RBDI_BATCH));
        }
    }
}

/* Copies v or a into the lanes, which have the same order, from dof k on: 0, or the first behind a base. out:
   the first scalar of the field in d->columns. */
RBDI_INLINE void rbdi_spread(const rbd_derivatives *d, int k, const rbd_real *v, rbd_real *out) {
    const int n = d->n;

    for (; k < d->base; ++k) out[d->entry[k].at] = v[k];

    out += d->behind * RBDI_COLUMN_SIZE * RBDI_BATCH;
    for (; k < n; k += RBDI_BATCH, out += RBDI_COLUMN_SIZE * RBDI_BATCH) rbdi_copy_batch(v + k, n - k, out);
}

/* Quantities that a call needs beyond F. F depends on q only. */
enum {
    RBDI_NEED_V = 1,        /* D and T, from v */
    RBDI_NEED_WRENCH = 2,   /* sums of f, from v and a; then rbdi_columns_by_q gives Phi and E */
    RBDI_NEED_CORIOLIS = 4, /* W = V, not 2 V, for X and P; U = V x S */
    RBDI_NEED_WHOLE = 16    /* with the linear velocity of a free base and gravity, else both are 0 */
};

/* V_p, the joints' S qd, Psi = V_p x S and, if needed, U. */
RBDI_INLINE void rbdi_velocities(const rbd_model *m, rbd_derivatives *d, int base, const rbd_real *v,
                                 int need) {
    const int first = base ? d->behind : 0;
    rbdi_motion world = rbdi_motion0();
    if (base) world.omega = d->V.omega;

    rbdi_spread(d, base, rbdi_expand_v(m, v, d->work->vx), RBDI_FIELD(d, qd));
    for (int b = first; b < d->batches; ++b) {
        rbdi_columns *cols = &d->columns[b];
        cols->V.joint = rbdi_b_motion_scale(cols->qd, cols->S);
    }

    rbdi_sum_ancestors(d, base, RBDI_FIELD(d, V), world, 1);

    for (int b = first; b < d->batches; ++b) {
        rbdi_columns *cols = &d->columns[b];
        const rbdi_bmotion V = rbdi_b_motion_add(cols->V.p, cols->V.joint), S = cols->S,
                           Psi = rbdi_b_motion_cross(cols->V.p, S);
        cols->Psi = Psi;

        if (need & RBDI_NEED_CORIOLIS)
            cols->U = rbdi_b_motion_cross(V, S);
        else if (need & RBDI_NEED_V)
            cols->U = rbdi_b_motion_cross_add(Psi, V, S);
    }
}

/* A_p and the joints' Psi qd + S qdd. The world accelerates by -gravity, a free base by
   (w_dot; v_dot + w x v - gravity). */
RBDI_INLINE void rbdi_accelerations(const rbd_model *m, rbd_derivatives *d, int base, const rbd_real *a,
                                    rbdi_c3 gravity) {
    const int first = base ? d->behind : 0;
    rbdi_motion A = rbdi_motion0();
    A.v = rbdi_sub(A.v, rbdi_vec_c(gravity));
    if (base) {
        A = rbdi_load_motion(a, 1);
        A.v = rbdi_add(rbdi_add(A.v, d->minus_g), rbdi_cross(d->V.omega, d->V.v));
    }

    rbdi_spread(d, base, rbdi_expand_v(m, a, d->work->ax), RBDI_FIELD(d, qdd));
    for (int b = first; b < d->batches; ++b) {
        rbdi_columns *cols = &d->columns[b];
        cols->A.joint = rbdi_b_motion_add(rbdi_b_motion_scale(cols->qd, cols->Psi),
                                          rbdi_b_motion_scale(cols->qdd, cols->S));
    }

    rbdi_sum_ancestors(d, base, RBDI_FIELD(d, A), A, 0);
}

/* The sweep towards the leaves: the motion of all dofs. Reads v, a and gravity only if need asks for them. */
RBDI_INLINE void rbdi_common_motion(const rbd_model *m, rbd_derivatives *d, int base, const rbd_real *q,
                                    const rbd_real *v, const rbd_real *a, rbdi_c3 gravity, int need) {
    rbdi_joints(m, d->work, rbdi_expand_q(m, d->work, q));

    if (base && need) {
        d->V.omega = rbdi_load_vec(v, 1);
        d->V.v = d->minus_g = rbdi_vec0();
    }
    if (base && need & RBDI_NEED_WHOLE) {
        d->V.v = rbdi_load_vec(v + 3, 1);
        d->minus_g = rbdi_sub(d->minus_g, rbdi_mul(d->work->block[0].X.E, rbdi_vec_c(gravity)));
    }

    rbdi_poses(m, d, base);
    rbdi_motion_columns(d, base ? d->behind : 0);
    if (need) rbdi_velocities(m, d, base, v, need);
    if (need & RBDI_NEED_WRENCH) rbdi_accelerations(m, d, base, a, gravity);
}

#endif
