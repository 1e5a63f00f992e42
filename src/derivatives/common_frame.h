#ifndef RBDI_DERIVATIVES_COMMON_FRAME_H
#define RBDI_DERIVATIVES_COMMON_FRAME_H
#include "dynamics/state.h"
#include "motion/axes.h"
#include "derivatives/layout.h"

/* Interface: RBDI_OF */

RBDI_CODE_BEGIN
#if RBDI_GCC && RBDI_FOR_SPEED
#define RBDI_UNROLL_SUMS _Pragma("GCC unroll 14")
#else
#define RBDI_UNROLL_SUMS
#endif

/* ---- common frame [common frame] ----
   All spatial quantities of a tree are in one frame with the axes of the world. Its origin is the origin of
   the first rotating link from the root, and it moves with that link's origin at this instant. Any frame that
   moves uniformly gives the same matrices. This one keeps the place and velocity of a root out of the
   differences that give small inertias. Seen from it, the world moves with -v of that origin. Every
   recursion is a sum over ancestors or over a subtree. All else is computed for each dof alone: the dofs,
   in the caller's order, are the SIMD lanes.

   A joint of several dofs is a chain of dofs without mass between; all of them see the same parent and link.
   R = (ex ey ez): axes of the dof's link, its own axis on ez; x: origin. V_p, A_p: parent's, V, A: link's.

       S = (rho ez; rho x x ez + kappa ez)         revolute: rho, kappa = 1, 0; sliding 0, 1; screw 1, pitch
       Psi = V_p x S                               V = V_p + sum over the joint of S qd
       U = Psi + V x S                             (one dof: 2 Psi)
       Phi = A_p x S + V_p x Psi                   A = A_p + sum over the joint of Psi qd + S qdd
                                                   A of the world: (0; -gravity)

   A body: second moment Sigma = R Sigma_b R' + x (R h_b)' + h x', first h = R h_b + m x. The model's
   regrouped constants give the same sums: bodies that move alike have the same momentum and force. With acc
   = a + omega x v and Omega = [omega_dot]x + [omega]x [omega]x

       X = [omega]x Sigma + v h'    the integral of x_dot x' dm
       P = m v + omega x h          linear momentum
       f = wrench (n; f) of rbd.h's [state], less the external ones

   These 27 numbers and m are summed over subtrees. With I = [tr(Sigma) - Sigma, [h]x; -[h]x, m] and
   2 B = [G, 0; -2 [P]x, 0], G = 2 (tr(X) - X), of the subtree of its link each dof has the columns

       F = I S     D = 2 B S + I U     E = 2 B Psi + I Phi + S x* f     T = 2 B' S: a moment without force

   and the entries of [entries] are products of two columns, one of a dof and one of an ancestor.

   With a free base, whose subtree has all other dofs (d->base), the frame can have the base's axes. There
   its S are unit vectors e and its V = (w; 0), its velocity v being that of the frame; A = (w_dot; v_dot +
   w x v - gravity). Its dofs then have

       turns   U = (w x e; e x v), Phi = (0; -gravity x e)      shifts   U = (0; w x e), Phi = 0
   Featherstone's book, sections 2.9, 2.10 and 5.3, has the two cross products; Echeandia and Wensing (2021)
   B. */

#if RBDI_BATCH > 1
typedef rbdi_batch rbdi_cbatch; /* a batch of constants */
#else
typedef rbd_const rbdi_cbatch;
#endif

typedef struct rbdi_b3 {
    rbdi_batch x, y, z;
} rbdi_b3;

typedef struct rbdi_bmotion {
    rbdi_b3 omega, v;
} rbdi_bmotion;

typedef struct rbdi_bforce {
    rbdi_b3 n, f;
} rbdi_bforce;

/* Quantities that are summed over subtrees. */
typedef struct rbdi_sums {
    rbdi_batch xx, xy, xz, yy, yz, zz; /* Sigma */
    rbdi_b3 h;
    rbdi_b3 Xx, Xy, Xz; /* rows of X */
    rbdi_b3 P;
    rbdi_bforce f;
} rbdi_sums;

struct rbdi_columns {
    rbdi_b3 ex, ey, ez, x;
    rbdi_bmotion S, Vp, dV, Psi, U, Ap, dA, Phi; /* dV = V - V_p, dA = A - A_p; rbdi_sum_ancestors needs
                                                    this order */
    rbdi_sums sum;
    rbdi_bforce F, D, E;
    rbdi_b3 T;
    rbdi_batch qd, qdd;
};

struct rbdi_constants {
    rbdi_cbatch xx, xy, xz, yy, yz, zz, hx, hy, hz, m; /* regrouped: of a link's last dof, else 0 */
    rbdi_cbatch subtree;                               /* mass of the subtree */
    rbdi_cbatch rho, kappa;
    rbdi_cbatch all_hx, all_hy, all_hz, all_m; /* of the bodies as described, no mass moved between links */
};

typedef char
    rbdi_columns_check[sizeof(rbdi_columns) == RBDI_COLUMN_SIZE * RBDI_BATCH * sizeof(rbd_real) ? 1 : -1];
typedef char
    rbdi_constants_check[sizeof(rbdi_constants) == RBDI_CONSTANT * RBDI_BATCH * sizeof(rbd_const) ? 1 : -1];

RBDI_INLINE rbdi_b3 rbdi_b_vec(rbdi_batch x, rbdi_batch y, rbdi_batch z) {
    const rbdi_b3 v = {x, y, z};
    return v;
}
/* The vector in all lanes. */
RBDI_INLINE rbdi_b3 rbdi_b_all(rbdi_v3 a) {
    return rbdi_b_vec(rbdi_all_lanes(a.x), rbdi_all_lanes(a.y), rbdi_all_lanes(a.z));
}
RBDI_INLINE rbdi_b3 rbdi_b_add(rbdi_b3 a, rbdi_b3 b) { return rbdi_b_vec(a.x + b.x, a.y + b.y, a.z + b.z); }
RBDI_INLINE rbdi_b3 rbdi_b_scale(rbdi_batch k, rbdi_b3 a) { return rbdi_b_vec(k * a.x, k * a.y, k * a.z); }
/* c + a x b: sums before products are contracted to FMA best. */
RBDI_INLINE rbdi_b3 rbdi_b_cross_add(rbdi_b3 c, rbdi_b3 a, rbdi_b3 b) {
    return rbdi_b_vec(c.x + a.y * b.z - a.z * b.y, c.y + a.z * b.x - a.x * b.z, c.z + a.x * b.y - a.y * b.x);
}
RBDI_INLINE rbdi_b3 rbdi_b_cross(rbdi_b3 a, rbdi_b3 b) {
    return rbdi_b_vec(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}
RBDI_INLINE rbdi_bmotion rbdi_b_motion_add(rbdi_bmotion a, rbdi_bmotion b) {
    a.omega = rbdi_b_add(a.omega, b.omega);
    a.v = rbdi_b_add(a.v, b.v);
    return a;
}
/* S' f. */
RBDI_INLINE rbdi_batch rbdi_b_power(rbdi_bmotion S, rbdi_bforce f) {
    return (f.n.x * S.omega.x + f.n.y * S.omega.y + f.n.z * S.omega.z) +
           (f.f.x * S.v.x + f.f.y * S.v.y + f.f.z * S.v.z);
}
RBDI_INLINE rbdi_bmotion rbdi_b_motion_scale(rbdi_batch k, rbdi_bmotion a) {
    const rbdi_bmotion b = {rbdi_b_scale(k, a.omega), rbdi_b_scale(k, a.v)};
    return b;
}
/* V x S, and with c added. */
RBDI_INLINE rbdi_bmotion rbdi_b_motion_cross_add(rbdi_bmotion c, rbdi_bmotion V, rbdi_bmotion S) {
    c.omega = rbdi_b_cross_add(c.omega, V.omega, S.omega);
    c.v = rbdi_b_cross_add(rbdi_b_cross_add(c.v, V.v, S.omega), V.omega, S.v);
    return c;
}
RBDI_INLINE rbdi_bmotion rbdi_b_motion_cross(rbdi_bmotion V, rbdi_bmotion S) {
    rbdi_bmotion c;
    c.omega = rbdi_b_cross(V.omega, S.omega);
    c.v = rbdi_b_cross_add(rbdi_b_cross(V.v, S.omega), V.omega, S.v);
    return c;
}

/* The first component of a field of dof k. The next components follow RBDI_BATCH scalars apart. */
#define RBDI_OF(d, k, field) ((rbd_real *)&(d)->columns->field + (d)->entry[k].at)

RBDI_INLINE int rbdi_last_dof(const rbd_model *m, int link) {
    return m->link[link].first + rbdi_link_dofs(m, &m->link[link]) - 1;
}

/* The axis of dof k of a link: 0 to 2 for x, y, z. */
RBDI_INLINE int rbdi_dof_axis(const rbd_model *m, const rbdi_link *l, int k) {
    return rbdi_is(l, RBDI_BLOCK) ? (rbdi_block_of(m, l)->first + k - l->first) % 3 : 2;
}

/* Stores axes and origin of a link for one of its dofs. The axes are cycled so that z is the dof's own. */
RBDI_INLINE void rbdi_put_axes(rbd_real *out, const rbdi_four *ex, const rbdi_four *ey, const rbdi_four *ez,
                               const rbdi_four *origin) {
    rbdi_store_vec(out, RBDI_BATCH, rbdi_axis_vec(ex));
    rbdi_store_vec(out + 3 * RBDI_BATCH, RBDI_BATCH, rbdi_axis_vec(ey));
    rbdi_store_vec(out + 6 * RBDI_BATCH, RBDI_BATCH, rbdi_axis_vec(ez));
    rbdi_store_vec(out + 9 * RBDI_BATCH, RBDI_BATCH, rbdi_axis_vec(origin));
}
/* The same for the dofs of a block from k on. */
RBDI_PART void rbdi_put_block_axes(const rbd_model *m, rbd_derivatives *d, const rbdi_link *l, int k,
                                   const rbdi_axes *p) {
    const rbdi_four *const e[3] = {&p->x, &p->y, &p->z};
    for (; k < d->entry[l->first].joint; ++k) {
        const int axis = rbdi_dof_axis(m, l, k);
        rbdi_put_axes(RBDI_OF(d, k, ex), e[(axis + 1) % 3], e[(axis + 2) % 3], e[axis], &p->origin);
    }
}
/* Pose of a link in the common frame, x_link = E (x - r), from its last dof. */
RBDI_INLINE rbdi_pose rbdi_common_pose(const rbd_model *m, const rbd_derivatives *d, int link) {
    const int last = rbdi_last_dof(m, link), axis = rbdi_dof_axis(m, &m->link[link], last);
    const rbd_real *in = RBDI_OF(d, last, ex);
    rbdi_v3 e[3];
    rbdi_pose pose;
    for (int k = 0; k < 3; ++k) e[(axis + 1 + k) % 3] = rbdi_load_vec(in + 3 * k * RBDI_BATCH, RBDI_BATCH);
    pose.E.xx = e[0].x, pose.E.xy = e[0].y, pose.E.xz = e[0].z;
    pose.E.yx = e[1].x, pose.E.yy = e[1].y, pose.E.yz = e[1].z;
    pose.E.zx = e[2].x, pose.E.zy = e[2].y, pose.E.zz = e[2].z;
    pose.r = rbdi_load_vec(in + 9 * RBDI_BATCH, RBDI_BATCH);
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
    const int known = base ? 0 : -1; /* the last link that is where the root is */
    rbdi_axes p;
    rbdi_world_axes(&p);
    for (int i = 0; i < m->nl; ++i) {
        const rbdi_link *l = &m->link[i];
        if (l->parent <= known) {
            rbdi_world_axes(&p);
        } else if (l->parent != i - 1) {
            const rbdi_pose parent = rbdi_common_pose(m, d, l->parent);
            rbdi_load_axes(&p, &parent);
        }
        if (!rbdi_is(l, RBDI_BLOCK))
            RBDI_BY_FLAGS(const int flags, l,
                          rbdi_axes_step(l, flags, rbdi_trig_of(m, d->work, i, flags), &p));
        else if (i > 0 || !base)
            rbdi_axes_block(&d->work->block[l->block].X, rbdi_on_world(l), &p);
        if (d->origin[i] >= 0) {
            if (d->origin[i] < i) rbdi_move_origin(m, d, i, rbdi_axis_vec(&p.origin));
            rbdi_set_axis(&p.origin, rbdi_vec0());
        }
        if (rbdi_is(l, RBDI_BLOCK)) {
            const rbdi_axes own = p; /* an address of p would keep it in memory */
            rbdi_put_block_axes(m, d, l, i == 0 && base ? base - 1 : l->first, &own);
        } else
            rbdi_put_axes(RBDI_OF(d, l->first, ex), &p.x, &p.y, &p.z, &p.origin);
    }
}

/* S of the dofs from a batch on. */
RBDI_PART void rbdi_motion_columns(rbd_derivatives *d, int b) {
    for (; b < d->batches; ++b) {
        rbdi_columns *c = &d->columns[b];
        const rbdi_constants *own = &d->constants[b];
        const rbdi_b3 turn = rbdi_b_vec(c->ez.x * own->rho, c->ez.y * own->rho, c->ez.z * own->rho);
        const rbdi_b3 slide = rbdi_b_vec(c->ez.x * own->kappa, c->ez.y * own->kappa, c->ez.z * own->kappa);
        c->S.omega = turn;
        c->S.v = rbdi_b_cross_add(slide, c->x, turn);
    }
}

/* Sums over ancestors: Vp from dV, or Ap from dA, which begins `apart` scalars behind. world: V or A of the
   roots' parent or, with a base, of the base. moves: whether the frame moves with its origin, so that the
   velocity of that is subtracted. */
RBDI_INLINE void rbdi_sum_ancestors(rbd_derivatives *d, int base, rbd_real *Vp, ptrdiff_t apart,
                                    rbdi_motion world, int moves) {
    const rbdi_entry *entry = d->entry;
    if (base) {
        rbdi_store_motion(Vp + entry[base - 1].at, RBDI_BATCH, world);
        rbdi_store_motion(Vp + entry[base - 1].at + apart, RBDI_BATCH, rbdi_motion0());
    }
    for (const rbdi_segment *seg = d->segment + (base > 0), *last = d->segment + d->segments; seg < last;
         ++seg) {
        rbdi_motion V = world;
        if (seg->parent >= base) {
            const rbd_real *in = Vp + entry[seg->parent].at;
            V = rbdi_motion_add(rbdi_load_motion(in, RBDI_BATCH), rbdi_load_motion(in + apart, RBDI_BATCH));
        }
        for (int k = seg->first; moves && k < seg->origin; ++k)
            V.v = rbdi_sub(V.v, rbdi_load_vec(Vp + entry[k].at + apart + 3 * RBDI_BATCH, RBDI_BATCH));
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
        for (int k = seg->first; k < seg->end; ++k) {
            rbd_real *out = Vp + entry[k].at;
            RBDI_ONE_INDEX(out);
            rbdi_store_motion(out, RBDI_BATCH, V);
            V = rbdi_motion_add(V, rbdi_load_motion(out + apart, RBDI_BATCH));
        }
    }
}

/* Copies so many scalars, a batch at a time. */
RBDI_INLINE void rbdi_copy(const rbd_real *x, int count, rbd_real *y) {
    int k = 0;
    for (; k + RBDI_BATCH <= count; k += RBDI_BATCH) *(rbdi_batch *)&y[k] = *(const rbdi_batch *)&x[k];
    for (; k < count; ++k) y[k] = x[k];
}
/* Copies v or a into the lanes, which have the same order, from dof k on: 0 or the first behind a base. */
RBDI_INLINE void rbdi_spread(const rbd_derivatives *d, int k, const rbd_real *v, rbd_real *out) {
    const int n = d->n;
    for (; k < d->base; ++k) out[d->entry[k].at] = v[k];
    out += d->behind * RBDI_COLUMN_SIZE * RBDI_BATCH;
    for (; k < n; k += RBDI_BATCH, out += RBDI_COLUMN_SIZE * RBDI_BATCH)
        rbdi_copy(v + k, n - k < RBDI_BATCH ? n - k : RBDI_BATCH, out);
}

/* Quantities that a call needs beyond F. F depends on q only. */
enum {
    RBDI_NEED_V = 1,        /* D and T, from v */
    RBDI_NEED_WRENCH = 2,   /* sums of f, from v and a; Phi and E by rbdi_columns_by_q */
    RBDI_NEED_CORIOLIS = 4, /* B instead of 2 B: X and P from V, not from 2 V, and U = V x S */
    RBDI_NEED_WHOLE = 16    /* with the linear velocity of a free base and gravity */
};

/* V_p, dV, Psi and, if needed, U. */
RBDI_INLINE void rbdi_velocities(const rbd_model *m, rbd_derivatives *d, int base, const rbd_real *v,
                                 int need) {
    const int first = base ? d->behind : 0;
    rbdi_motion world = rbdi_motion0();
    if (base) world.omega = d->V.omega;
    rbdi_spread(d, base, rbdi_expand_v(m, v, d->work->vx), (rbd_real *)&d->columns->qd);
    for (int b = first; b < d->batches; ++b) {
        rbdi_columns *c = &d->columns[b];
        c->dV = rbdi_b_motion_scale(c->qd, c->S);
    }
    rbdi_sum_ancestors(d, base, (rbd_real *)&d->columns->Vp, 6 * RBDI_BATCH, world, 1);
    for (int b = first; b < d->batches; ++b) {
        rbdi_columns *c = &d->columns[b];
        const rbdi_bmotion V = rbdi_b_motion_add(c->Vp, c->dV), S = c->S, Psi = rbdi_b_motion_cross(c->Vp, S);
        c->Psi = Psi;
        if (need & RBDI_NEED_CORIOLIS)
            c->U = rbdi_b_motion_cross(V, S);
        else if (need & RBDI_NEED_V)
            c->U = rbdi_b_motion_cross_add(Psi, V, S);
    }
}

/* A_p and dA. The world accelerates by -gravity. */
RBDI_INLINE void rbdi_accelerations(const rbd_model *m, rbd_derivatives *d, int base, const rbd_real *a,
                                    rbdi_c3 gravity) {
    const int first = base ? d->behind : 0;
    rbdi_motion A = rbdi_motion0();
    A.v = rbdi_sub(A.v, rbdi_vec_c(gravity));
    if (base) {
        A = rbdi_load_motion(a, 1);
        A.v = rbdi_add(rbdi_add(A.v, d->up), rbdi_cross(d->V.omega, d->V.v));
    }
    rbdi_spread(d, base, rbdi_expand_v(m, a, d->work->ax), (rbd_real *)&d->columns->qdd);
    for (int b = first; b < d->batches; ++b) {
        rbdi_columns *c = &d->columns[b];
        c->dA = rbdi_b_motion_add(rbdi_b_motion_scale(c->qd, c->Psi), rbdi_b_motion_scale(c->qdd, c->S));
    }
    rbdi_sum_ancestors(d, base, (rbd_real *)&d->columns->Ap, 6 * RBDI_BATCH, A, 0);
}

/* R (x; y; z) of constants in the axes of the links. */
RBDI_INLINE rbdi_b3 rbdi_b_rotate(const rbdi_columns *c, rbdi_cbatch x, rbdi_cbatch y, rbdi_cbatch z) {
    const rbdi_b3 ex = c->ex, ey = c->ey, ez = c->ez;
    return rbdi_b_vec(ex.x * x + ey.x * y + ez.x * z, ex.y * x + ey.y * y + ez.y * z,
                      ex.z * x + ey.z * y + ez.z * z);
}
/* Sigma and h of the links, from R h_b and the columns of R Sigma_b. */
RBDI_INLINE void rbdi_own_inertia(const rbdi_columns *c, const rbdi_constants *own, rbdi_sums *s) {
    const rbdi_b3 ex = c->ex, ey = c->ey, ez = c->ez, x = c->x;
    const rbdi_b3 h = rbdi_b_rotate(c, own->hx, own->hy, own->hz),
                  col_x = rbdi_b_rotate(c, own->xx, own->xy, own->xz),
                  col_y = rbdi_b_rotate(c, own->xy, own->yy, own->yz),
                  col_z = rbdi_b_rotate(c, own->xz, own->yz, own->zz);
    s->h = rbdi_b_vec(h.x + x.x * own->m, h.y + x.y * own->m, h.z + x.z * own->m);
    s->xx = col_x.x * ex.x + col_y.x * ey.x + col_z.x * ez.x + x.x * h.x + s->h.x * x.x;
    s->xy = col_x.x * ex.y + col_y.x * ey.y + col_z.x * ez.y + x.x * h.y + s->h.x * x.y;
    s->xz = col_x.x * ex.z + col_y.x * ey.z + col_z.x * ez.z + x.x * h.z + s->h.x * x.z;
    s->yy = col_x.y * ex.y + col_y.y * ey.y + col_z.y * ez.y + x.y * h.y + s->h.y * x.y;
    s->yz = col_x.y * ex.z + col_y.y * ey.z + col_z.y * ez.z + x.y * h.z + s->h.y * x.z;
    s->zz = col_x.z * ex.z + col_y.z * ey.z + col_z.z * ez.z + x.z * h.z + s->h.z * x.z;
}

/* X and P of the links. V is their velocity or, for 2 B in place of B, twice that. */
RBDI_INLINE void rbdi_own_momentum(rbdi_bmotion V, const rbdi_constants *own, rbdi_sums *s) {
    const rbdi_b3 w = V.omega, v = V.v, h = s->h;
    const rbdi_b3 sx = rbdi_b_vec(s->xx, s->xy, s->xz), sy = rbdi_b_vec(s->xy, s->yy, s->yz),
                  sz = rbdi_b_vec(s->xz, s->yz, s->zz);
    s->Xx = rbdi_b_vec(w.y * sz.x - w.z * sy.x + v.x * h.x, w.y * sz.y - w.z * sy.y + v.x * h.y,
                       w.y * sz.z - w.z * sy.z + v.x * h.z);
    s->Xy = rbdi_b_vec(w.z * sx.x - w.x * sz.x + v.y * h.x, w.z * sx.y - w.x * sz.y + v.y * h.y,
                       w.z * sx.z - w.x * sz.z + v.y * h.z);
    s->Xz = rbdi_b_vec(w.x * sy.x - w.y * sx.x + v.z * h.x, w.x * sy.y - w.y * sx.y + v.z * h.y,
                       w.x * sy.z - w.y * sx.z + v.z * h.z);
    s->P = rbdi_b_cross_add(rbdi_b_vec(v.x * own->m, v.y * own->m, v.z * own->m), w, h);
}

/* The rows of Omega. */
typedef struct rbdi_b33 {
    rbdi_b3 x, y, z;
} rbdi_b33;
RBDI_INLINE rbdi_b33 rbdi_b_omega(rbdi_b3 w, rbdi_b3 alpha) {
    rbdi_b33 O;
    O.x = rbdi_b_vec(-(w.y * w.y + w.z * w.z), w.x * w.y - alpha.z, w.x * w.z + alpha.y);
    O.y = rbdi_b_vec(w.x * w.y + alpha.z, -(w.x * w.x + w.z * w.z), w.y * w.z - alpha.x);
    O.z = rbdi_b_vec(w.x * w.z - alpha.y, w.y * w.z + alpha.x, -(w.x * w.x + w.y * w.y));
    return O;
}

/* The wrench that moves each link: n_x = K_zy - K_yz of K = Omega Sigma + acc h', as in rbdi_wrench. */
RBDI_INLINE void rbdi_own_wrench(rbdi_bmotion V, rbdi_bmotion A, const rbdi_constants *own, rbdi_sums *s) {
    const rbdi_b3 h = s->h, acc = rbdi_b_cross_add(A.v, V.omega, V.v);
    const rbdi_b33 O = rbdi_b_omega(V.omega, A.omega);
    const rbdi_b3 n =
        rbdi_b_vec(O.z.x * s->xy + O.z.y * s->yy + (O.z.z - O.y.y) * s->yz - O.y.x * s->xz - O.y.z * s->zz,
                   O.x.y * s->yz + (O.x.x - O.z.z) * s->xz + O.x.z * s->zz - O.z.x * s->xx - O.z.y * s->xy,
                   O.y.x * s->xx + (O.y.y - O.x.x) * s->xy + O.y.z * s->xz - O.x.y * s->yy - O.x.z * s->yz);
    s->f.n = rbdi_b_cross_add(n, h, acc);
    s->f.f = rbdi_b_vec(O.x.x * h.x + O.x.y * h.y + O.x.z * h.z + acc.x * own->m,
                        O.y.x * h.x + O.y.y * h.y + O.y.z * h.z + acc.y * own->m,
                        O.z.x * h.x + O.z.y * h.y + O.z.z * h.z + acc.z * own->m);
}

/* Stores the sums that need asks for. */
RBDI_INLINE void rbdi_store_sums(const rbdi_sums *s, int need, rbdi_sums *out) {
    out->xx = s->xx, out->xy = s->xy, out->xz = s->xz, out->yy = s->yy, out->yz = s->yz, out->zz = s->zz;
    out->h = s->h;
    if (need & RBDI_NEED_V) out->Xx = s->Xx, out->Xy = s->Xy, out->Xz = s->Xz, out->P = s->P;
    if (need & RBDI_NEED_WRENCH) out->f = s->f;
}

/* Subtracts external wrenches from those of the links. */
RBDI_PART void rbdi_common_external(const rbd_model *m, rbd_derivatives *d, const rbd_real *f_ext) {
    const int bodies = f_ext ? m->nb : 0;
    for (int body = 0; body < bodies; ++body) {
        const rbdi_frame *u = &m->frame[body];
        rbdi_pose pose;
        rbdi_force F;
        rbd_real *out;
        if (u->link < 0) continue;
        pose.E = rbdi_mat_c(u->E);
        pose.r = rbdi_vec_c(u->r);
        F = rbdi_force_up_block(&pose, rbdi_load_force(f_ext + 6 * body, 1)); /* to the link */
        pose = rbdi_common_pose(m, d, u->link);
        F = rbdi_force_up_block(&pose, F);
        out = RBDI_OF(d, rbdi_last_dof(m, u->link), sum.f);
        rbdi_store_force(out, RBDI_BATCH, rbdi_force_sub(rbdi_load_force(out, RBDI_BATCH), F));
    }
}

#endif
