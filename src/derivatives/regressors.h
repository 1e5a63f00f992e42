#ifndef RBDI_DERIVATIVES_REGRESSORS_H
#define RBDI_DERIVATIVES_REGRESSORS_H
#include "model/wide.h"
#include "derivatives/momentum.h"

/* Interface: rbdi_regress_body, rbdi_regressor_motion */

/* ---- regressors and inertial parameters [identification code] ----
   f = I a + v x* I v (RBDA table 5.1) is linear in a body's parameters, f = K pi: row i of Y is S_i' K. */

/* Four parameters of a body, or their factors. A row of K has three such parts: m and m c; xx xy xz yy; xz yy
   yz zz, where the last two overlap. All formulas below are the same for each of the four, as for the
   components of a vector. add: y += factor x; scale: y = factor x. */
typedef struct rbdi_four {
    rbd_real x, y, z, w;
} rbdi_four;

RBDI_INLINE void rbdi_set_four(rbdi_four *y, rbd_real a, rbd_real b, rbd_real c, rbd_real d) {
    y->x = a;
    y->y = b;
    y->z = c;
    y->w = d;
}

RBDI_INLINE void rbdi_scale_four(rbdi_four *y, rbd_real factor, const rbdi_four *x) {
    rbdi_set_four(y, x->x * factor, x->y * factor, x->z * factor, x->w * factor);
}

RBDI_INLINE void rbdi_add_four(rbdi_four *y, rbd_real factor, const rbdi_four *x) {
    rbdi_set_four(y, y->x + x->x * factor, y->y + x->y * factor, y->z + x->z * factor, y->w + x->w * factor);
}

/* y += a_1 x_1 + a_2 x_2 + a_3 x_3; and y = this sum. */
RBDI_INLINE void rbdi_add_fours(rbdi_four *y, rbdi_v3 a, const rbdi_four x[3]) {
    rbdi_add_four(y, a.x, &x[0]);
    rbdi_add_four(y, a.y, &x[1]);
    rbdi_add_four(y, a.z, &x[2]);
}

RBDI_INLINE void rbdi_combine_fours(rbdi_four *y, rbdi_v3 a, const rbdi_four x[3]) {
    rbdi_scale_four(y, a.x, &x[0]);
    rbdi_add_four(y, a.y, &x[1]);
    rbdi_add_four(y, a.z, &x[2]);
}

/* (x R) of a body as described: its origin and axes in the common frame. A row is four scalars, for the
   parameters m and m c: a' (x R) = (a' x; R' a). */
typedef struct rbdi_placement {
    rbdi_four row[3];
} rbdi_placement;

/* (x R) = (r 0) + E' (r_b E_b'), with the pose (E, r) of the link, and r_b and E_b of the body on it. */
RBDI_INLINE void rbdi_place_body(const rbd_model *m, const rbd_derivatives *d, const rbdi_frame *body,
                                 rbdi_placement *p) {
    const rbdi_pose X = rbdi_common_pose(m, d, body->link);
    const rbd_real o = rbdi_zero();
    const rbd_const *E = body->E;
    rbdi_four own[3]; /* (r_b E_b') */

    rbdi_set_four(&own[0], rbdi_set(body->r.x), rbdi_set(E[0]), rbdi_set(E[3]), rbdi_set(E[6]));
    rbdi_set_four(&own[1], rbdi_set(body->r.y), rbdi_set(E[1]), rbdi_set(E[4]), rbdi_set(E[7]));
    rbdi_set_four(&own[2], rbdi_set(body->r.z), rbdi_set(E[2]), rbdi_set(E[5]), rbdi_set(E[8]));

    rbdi_set_four(&p->row[0], X.r.x, o, o, o);
    rbdi_set_four(&p->row[1], X.r.y, o, o, o);
    rbdi_set_four(&p->row[2], X.r.z, o, o, o);

    rbdi_add_fours(&p->row[0], rbdi_vec(X.E.xx, X.E.yx, X.E.zx), own);
    rbdi_add_fours(&p->row[1], rbdi_vec(X.E.xy, X.E.yy, X.E.zy), own);
    rbdi_add_fours(&p->row[2], rbdi_vec(X.E.xz, X.E.yz, X.E.zz), own);
}

/* R' a, and the origin x. */
RBDI_INLINE rbdi_v3 rbdi_to_body(const rbdi_placement *p, rbdi_v3 a) {
    rbdi_four y;
    rbdi_combine_fours(&y, a, p->row);
    return rbdi_vec(y.y, y.z, y.w);
}

RBDI_INLINE rbdi_v3 rbdi_origin_of(const rbdi_placement *p) {
    return rbdi_vec(p->row[0].x, p->row[1].x, p->row[2].x);
}

/* The motion of all links. base: dofs of a free base whose axes the frame has, or 0. */
RBDI_PART void rbdi_link_motions(rbd_derivatives *d, int base) {
    for (int b = rbdi_first_inertia(d, base); b < d->batches; ++b) {
        rbdi_columns *cols = &d->columns[b];
        const rbdi_bmotion V = rbdi_b_motion_add(cols->V.p, cols->V.joint),
                           A = rbdi_b_motion_add(cols->A.p, cols->A.joint);

        cols->stage.link.Omega = rbdi_b_omega(V.omega, A.omega);
        cols->stage.link.acc = rbdi_b_classical(V, A);
        cols->stage.link.omega = V.omega;
        cols->stage.link.omega_dot = A.omega;
    }
}

/* The columns of I w_dot + w x I w by xx xy xz yy yz zz of I, three rows: `some` has xx xy xz yy, `rest`
   has xz yy yz zz. */
RBDI_INLINE void rbdi_unit_moments(rbdi_v3 w, rbdi_v3 w_dot, rbdi_four some[3], rbdi_four rest[3]) {
    const rbd_real x = w_dot.x, y = w_dot.y, z = w_dot.z;
    const rbd_real xy = w.x * w.y, xz = w.x * w.z, yz = w.y * w.z, xx = w.x * w.x, yy = w.y * w.y,
                   zz = w.z * w.z;

    rbdi_set_four(&some[0], x, y - xz, z + xy, -yz);
    rbdi_set_four(&some[1], xz, x + yz, zz - xx, y);
    rbdi_set_four(&some[2], -xy, xx - yy, x - yz, xy);

    rbdi_set_four(&rest[0], z + xy, -yz, yy - zz, yz);
    rbdi_set_four(&rest[1], zz - xx, y, z - xy, -xz);
    rbdi_set_four(&rest[2], x - yz, xy, y + xz, z);
}

/* K of a body, its wrenches for unit parameters in the common frame: six rows of ten, moments and forces.
   last: the last dof of its link. With its origin x and its axes e, and acc of the link-fixed point there,

       m         (x x acc; acc)
       m c       (e x acc + x x Omega e; Omega e)
       inertia   (I omega_dot + omega x I omega, in body axes; 0), where the zeros are not written */
RBDI_PART void rbdi_unit_wrenches(const rbd_derivatives *d, int last, const rbdi_placement *p, rbd_real *K,
                                  ptrdiff_t stride) {
    const rbd_real *w_in = RBDI_OF(d, last, stage.link.omega),
                   *w_dot_in = RBDI_OF(d, last, stage.link.omega_dot);
    const rbdi_v3 w = rbdi_to_body(p, rbdi_load_vec(w_in, RBDI_BATCH)),
                  w_dot = rbdi_to_body(p, rbdi_load_vec(w_dot_in, RBDI_BATCH));
    const rbd_real *Omega = RBDI_OF(d, last, stage.link.Omega), *acc = RBDI_OF(d, last, stage.link.acc),
                   o = rbdi_zero();
    rbdi_four f[3], some[3], rest[3];

    rbdi_unit_moments(w, w_dot, some, rest);

    /* row i of the forces: (acc_i 0 0 0) + Omega_i (x R); of the moments of inertia: R_i times those in
       body axes */
    RBDI_UNROLL_SIX for (int i = 0; i < 3; ++i) {
        const rbdi_v3 R = rbdi_vec(p->row[i].y, p->row[i].z, p->row[i].w);
        rbdi_set_four(&f[i], acc[i * RBDI_BATCH], o, o, o);
        rbdi_add_fours(&f[i], rbdi_load_vec(Omega + 3 * i * RBDI_BATCH, RBDI_BATCH), p->row);
        *(rbdi_four *)&K[(3 + i) * stride] = f[i];
        rbdi_combine_fours((rbdi_four *)&K[i * stride + 4], R, some);
        rbdi_combine_fours((rbdi_four *)&K[i * stride + 6], R, rest);
    }

    /* row i of the moments of m and m c: (x R) x acc + x x f. The first has x x acc twice */
    RBDI_UNROLL_SIX for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        rbdi_four n;
        rbdi_scale_four(&n, f[k].x, &p->row[j]);
        rbdi_add_four(&n, -f[j].x, &p->row[k]);
        rbdi_add_four(&n, p->row[j].x, &f[k]);
        rbdi_add_four(&n, -p->row[k].x, &f[j]);
        *(rbdi_four *)&K[i * stride] = n;
        K[i * stride] = K[i * stride] * RBD_C(0.5);
    }
}

/* y = S' K, ten scalars: 0 to 3, 4 to 7 and 6 to 9, where the last two overlap. */
RBDI_INLINE void rbdi_regress(const rbd_real *K, ptrdiff_t stride, rbdi_motion S, rbd_real *y) {
    static const int at[3] = {0, 4, 6};
    rbdi_four sum[3];

    RBDI_UNROLL_SIX for (int j = 0; j < 3; ++j) {
        const rbd_real *k = K + at[j];
        rbdi_scale_four(&sum[j], S.omega.x, (const rbdi_four *)k);
        rbdi_add_four(&sum[j], S.omega.y, (const rbdi_four *)(k + stride));
        rbdi_add_four(&sum[j], S.omega.z, (const rbdi_four *)(k + 2 * stride));
    }

    rbdi_add_four(&sum[0], S.v.x, (const rbdi_four *)(K + 3 * stride));
    rbdi_add_four(&sum[0], S.v.y, (const rbdi_four *)(K + 4 * stride));
    rbdi_add_four(&sum[0], S.v.z, (const rbdi_four *)(K + 5 * stride));

    RBDI_UNROLL_SIX for (int j = 0; j < 3; ++j) { *(rbdi_four *)&y[at[j]] = sum[j]; }
}

/* A body's ten columns of the regressor, Y, whose rows are `columns` apart; after rbdi_link_motions. A free
   base's six rows are the unit wrenches themselves. */
RBDI_PART void rbdi_regress_body(const rbd_model *m, const rbd_derivatives *d, const rbdi_frame *body,
                                 rbd_real *Y, ptrdiff_t columns) {
    /* copies, which no store can change */
    const rbdi_entry *entry = d->entry;
    const rbd_real *S = RBDI_FIELD(d, S);
    const int base = d->base;
    const ptrdiff_t stride = base ? columns : 10;
    rbd_real own[60], *K = base ? Y : own;
    rbdi_placement p;
    int k = rbdi_last_dof(m, body->link);

    rbdi_place_body(m, d, body, &p);
    rbdi_unit_wrenches(d, k, &p, K, stride);

    for (; k >= base; k = entry[k].parent) {
        rbd_real *y = Y + entry[k].user * columns;
        const rbdi_motion S_k = rbdi_load_motion(S + entry[k].at, RBDI_BATCH);

        if (rbdi_mimics(m)) {
            const rbd_real ratio = rbdi_ratio(m, entry[k].source);
            rbd_real part[10];
            rbdi_regress(K, stride, S_k, part);
            for (int j = 0; j < 10; ++j) y[j] = y[j] + part[j] * ratio;
        } else {
            rbdi_regress(K, stride, S_k, y);
        }
    }
}

/* The motion that the regressor of every body is made of. */
RBDI_PART void rbdi_regressor_motion(const rbd_model *m, rbd_derivatives *d, const rbd_real *q,
                                     const rbd_real *v, const rbd_real *a) {
    const int base = d->base;
    rbdi_common_motion(m, d, base, q, v, a, d->work->gravity, RBDI_NEED_WRENCH | RBDI_NEED_WHOLE);
    rbdi_link_motions(d, base);
}

RBDI_API rbd_status rbd_regressor(const rbd_model *m, rbd_derivatives *d, const rbd_real *q,
                                  const rbd_real *v, const rbd_real *a, rbd_real *Y) {
    const rbd_status status = rbdi_check_derivatives(m, d, q && v && a && Y);
    const ptrdiff_t columns = m ? 10 * m->nb : 0;
    if (status) return status;

    rbdi_regressor_motion(m, d, q, v, a);
    if (!d->keep_zeros || rbdi_mimics(m)) rbdi_clear(Y, m->nv * 10 * m->nb);

    for (int i = 0; i < m->nb; ++i, Y += 10)
        if (m->frame[i].link >= 0) rbdi_regress_body(m, d, &m->frame[i], Y, columns);
    return RBD_OK;
}

/* v' I v / 2 = y pi of a body on a link, with velocity omega and v_o of the body's origin in its axes:

       y = (v_o' v_o / 2; v_o x omega; omega_x^2 / 2, omega_x omega_y, omega_x omega_z, omega_y^2 / 2,
            omega_y omega_z, omega_z^2 / 2)

   The common frame moves: the world has the velocity `world` in it. */
RBDI_PART void rbdi_put_kinetic(const rbd_model *m, const rbd_derivatives *d, int link, rbdi_motion world,
                                const rbdi_placement *p, rbd_real *y) {
    const int last = rbdi_last_dof(m, link);
    const rbd_const half = RBD_C(0.5);
    const rbdi_motion V = rbdi_motion_add(rbdi_load_motion(RBDI_OF(d, last, V.p), RBDI_BATCH),
                                          rbdi_load_motion(RBDI_OF(d, last, V.joint), RBDI_BATCH));
    const rbdi_v3 v = rbdi_add(rbdi_sub(V.v, world.v), rbdi_cross(V.omega, rbdi_origin_of(p)));
    const rbdi_v3 omega = rbdi_to_body(p, V.omega), v_o = rbdi_to_body(p, v);

    y[0] = rbdi_dot(v_o, v_o) * half;
    rbdi_store_vec(y + 1, 1, rbdi_cross(v_o, omega));
    y[4] = omega.x * omega.x * half;
    y[5] = omega.x * omega.y;
    y[6] = omega.x * omega.z;
    y[7] = omega.y * omega.y * half;
    y[8] = omega.y * omega.z;
    y[9] = omega.z * omega.z * half;
}

/* m minus_g' (place of c) = y pi: y = (minus_g' (place + x); R' minus_g), with the place of the common
   origin. */
RBDI_PART void rbdi_put_potential(const rbd_derivatives *d, rbdi_v3 place, const rbdi_placement *p,
                                  rbd_real *Y) {
    const rbdi_v3 minus_g = rbdi_sub(rbdi_vec0(), rbdi_vec_c(d->work->gravity));
    rbdi_four *y = (rbdi_four *)Y;
    rbdi_set_four(y, rbdi_dot(minus_g, place), rbdi_zero(), rbdi_zero(), rbdi_zero());
    rbdi_add_fours(y, minus_g, p->row);
}

/* The frame has the axes of the world here, with a free base too. Its dofs then have columns S like all
   others; at the end they get back their unit vectors. */
RBDI_API rbd_status rbd_energy_regressors(const rbd_model *m, rbd_derivatives *d, const rbd_real *q,
                                          const rbd_real *v, rbd_real *Y_kinetic, rbd_real *Y_potential) {
    const rbd_status status = rbdi_check_derivatives(m, d, q && (v || !Y_kinetic));
    if (status) return status;

    rbdi_common_motion(m, d, 0, q, v, NULL, d->work->gravity, Y_kinetic ? RBDI_NEED_V : 0);
    if (Y_kinetic) rbdi_clear(Y_kinetic, 10 * m->nb);
    if (Y_potential) rbdi_clear(Y_potential, 10 * m->nb);

    for (int i = 0; i < m->nb; ++i) {
        const rbdi_frame *body = &m->frame[i];
        int root = body->link;
        rbdi_placement p;
        if (root < 0) continue;

        while (m->link[root].parent >= 0) root = m->link[root].parent;
        rbdi_place_body(m, d, body, &p);

        if (Y_kinetic) {
            const rbd_real *world = RBDI_OF(d, m->link[root].first, V.p);
            rbdi_put_kinetic(m, d, body->link, rbdi_load_motion(world, RBDI_BATCH), &p, Y_kinetic + 10 * i);
        }
        if (Y_potential) rbdi_put_potential(d, rbdi_place_of(m, d, root), &p, &Y_potential[10 * i]);
    }

    rbdi_init_base(d);
    return RBD_OK;
}

/* RBDA 2.63: the inertia about the origin is that about the centre of mass + m (c'c - c c'). */
RBDI_API rbd_status rbd_body_parameters(const rbd_model *m, int body, rbd_const pi[10]) {
    const rbdi_frame *u;
    rbd_const mass, x, y, z;
    if (!m || !pi) return RBD_ERR_NULL;
    if (body < 0 || body >= m->nb) return RBD_ERR_INDEX;

    u = &m->frame[body];
    mass = u->mass;
    x = u->com.x;
    y = u->com.y;
    z = u->com.z;

    pi[0] = mass;
    pi[1] = mass * x;
    pi[2] = mass * y;
    pi[3] = mass * z;
    pi[4] = u->I.xx + mass * (y * y + z * z);
    pi[5] = u->I.xy - mass * x * y;
    pi[6] = u->I.xz - mass * x * z;
    pi[7] = u->I.yy + mass * (x * x + z * z);
    pi[8] = u->I.yz - mass * y * z;
    pi[9] = u->I.zz + mass * (x * x + y * y);
    return RBD_OK;
}

#ifndef RBD_NO_BUILD
/* The reverse: com = pi[1 .. 3] / m, and the inertia about it. */
RBDI_API rbd_status rbd_set_parameters(rbd_body *body, const rbd_const pi[10]) {
    double com[3], mass;
    if (!body || !pi) return RBD_ERR_NULL;

    mass = (double)pi[0];
    for (int k = 0; k < 3; ++k) com[k] = mass > 0 || mass < 0 ? (double)pi[1 + k] / mass : 0;
    body->mass = mass;
    for (int k = 0; k < 3; ++k) body->com[k] = com[k];

    body->inertia[0] = (double)pi[4] - mass * (com[1] * com[1] + com[2] * com[2]);
    body->inertia[1] = (double)pi[5] + mass * com[0] * com[1];
    body->inertia[2] = (double)pi[6] + mass * com[0] * com[2];
    body->inertia[3] = (double)pi[7] - mass * (com[0] * com[0] + com[2] * com[2]);
    body->inertia[4] = (double)pi[8] + mass * com[1] * com[2];
    body->inertia[5] = (double)pi[9] - mass * (com[0] * com[0] + com[1] * com[1]);
    return RBD_OK;
}

/* Sigma = tr(I)/2 - I about the centre of mass must be semidefinite up to the rounding of pi. */
RBDI_API rbd_status rbd_check_parameters(const rbd_const pi[10]) {
    rbd_body b;
    double trace, size = 0, Sigma[6];
    if (!pi) return RBD_ERR_NULL;
    if (!(pi[0] >= 0 && rbdi_is_finite(rbdi_set(pi[0])))) return RBD_ERR_MASS;
    for (int k = 1; k < 4; ++k)
        if (!rbdi_is_finite(rbdi_set(pi[k])) || (!(pi[0] > 0) && (pi[k] < 0 || pi[k] > 0)))
            return RBD_ERR_COM;

    for (int k = 4; k < 10; ++k) size += (double)(pi[k] < 0 ? -pi[k] : pi[k]);
    if (size <= 0) return RBD_OK;

    rbd_set_parameters(&b, pi);
    trace = b.inertia[0] + b.inertia[3] + b.inertia[5];
    for (int k = 0; k < 6; ++k) Sigma[k] = (k == 0 || k == 3 || k == 5 ? trace / 2 : 0) - b.inertia[k];
    size = trace + 64 * (double)RBDI_EPS / RBDI_SEMIDEFINITE * size;
    return rbdi_semidefinite(Sigma, size) ? RBD_OK : RBD_ERR_INERTIA;
}
#endif

#endif
