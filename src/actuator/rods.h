#ifndef RBDI_ACTUATOR_RODS_H
#define RBDI_ACTUATOR_RODS_H
#include "algebra/rotations.h"
#include "actuator/layout.h"

/* ---- rods [rods] ----
   The rod of length L joins the crank's end C(theta) = place + c (zero cos + across sin), across = axis x
   zero, to the point P(q). With r = P - place, r_x = r.zero, r_y = r.across, rho = r_x^2 + r_y^2, |P - C| = L
   is

       r_x cos + r_y sin = h,   h = (r.r + c^2 - L^2) / (2 c)

   with d = P - C, primes by theta and indices by q:

       theta_k = d.P_k / w,  w = d.C'
       theta_jk = (d_k.P_j + d.P_jk - theta_j (d_k.C' + d.C'' theta_k)) / w,   d_k = P_k - C' theta_k
       P_k = e_k x (P - o_k),  P_jk = e_j x P_k, j the joint nearer to the base */

/* The rotation about the unit vector e whose sine and cosine are these. */
RBDI_LOCAL rbdi_mat rbdi_act_turn_about(rbdi_v3 e, rbd_real s, rbd_real c) {
    const rbdi_v3 u = rbdi_scale(1 - c, e);
    return rbdi_mat_of(c + u.x * e.x, u.x * e.y - s * e.z, u.x * e.z + s * e.y, u.y * e.x + s * e.z,
                       c + u.y * e.y, u.y * e.z - s * e.x, u.z * e.x - s * e.y, u.z * e.y + s * e.x,
                       c + u.z * e.z);
}

RBDI_INLINE rbdi_v3 rbdi_act_vec_of(const rbd_const x[3]) { return rbdi_vec(x[0], x[1], x[2]); }

/* The joints at q: where they are, and the pose of the last one's body; in the base's axes. */
typedef struct rbdi_act_rod_joints {
    int n;
    rbdi_v3 origin[2], axis[2];
    rbdi_mat turn;
} rbdi_act_rod_joints;

RBDI_LOCAL rbdi_act_rod_joints rbdi_act_place_joints(const rbdi_act_group *g, const rbd_real *q) {
    rbdi_act_rod_joints J;
    rbdi_v3 at = rbdi_vec0();
    J.n = g->n;
    J.turn = rbdi_mat_of(1, 0, 0, 0, 1, 0, 0, 0, 1);
    J.origin[1] = J.axis[1] = at;
    for (int j = 0; j < g->n; ++j) {
        rbd_real s, c;
        at = rbdi_add(at, rbdi_mul(J.turn, g->origin[j]));
        J.turn = rbdi_mul_mat(J.turn, g->turn[j]);
        J.origin[j] = at;
        J.axis[j] = rbdi_mul(J.turn, g->axis[j]);

        rbdi_sincos(q[g->at[j]], &s, &c);
        J.turn = rbdi_mul_mat(J.turn, rbdi_act_turn_about(g->axis[j], s, c));
    }
    return J;
}

/* Cosine and sine of the crank, for the rod's end at r from its axis. Whether it reaches. */
RBDI_LOCAL int rbdi_act_find_crank(const rbd_rod *rod, rbdi_v3 r, rbdi_v3 zero, rbdi_v3 across,
                                   rbd_real *cosine, rbd_real *sine) {
    const rbd_real c = rod->crank, L = rod->length, r_x = rbdi_dot(r, zero), r_y = rbdi_dot(r, across);
    const rbd_real rho = r_x * r_x + r_y * r_y;
    const rbd_real h = (rbdi_dot(r, r) + (c - L) * (c + L)) / (2 * c);
    const rbd_real left = rho - h * h;
    rbd_real root;
    if (!(left >= 0) || !(rho > 0)) return 0;

    root = rod->elbow < 0 ? -rbdi_sqrt(left) : rbdi_sqrt(left);
    *cosine = (h * r_x - root * r_y) / rho;
    *sine = (h * r_y + root * r_x) / rho;
    return 1;
}

/* Row i of G, its derivatives in H, and the crank's angle. */
RBDI_LOCAL rbd_status rbdi_act_map_rod(rbdi_act_group *g, const rbdi_act_rod_joints *J, int i,
                                       rbd_real *angle) {
    const rbd_rod *rod = &g->by->rod[i];
    const rbdi_v3 zero = rbdi_act_vec_of(rod->zero), across = rbdi_cross(rbdi_act_vec_of(rod->axis), zero);
    const rbdi_v3 P = rbdi_add(J->origin[J->n - 1], rbdi_mul(J->turn, rbdi_act_vec_of(rod->point)));
    const rbdi_v3 r = rbdi_sub(P, rbdi_act_vec_of(rod->place));
    rbdi_v3 C1, C2, d, P_j[2];
    rbd_real cosine, sine, w, *G = &g->G[i * J->n];
    if (!rbdi_act_find_crank(rod, r, zero, across, &cosine, &sine)) return RBD_ERR_INFEASIBLE;

    C2 = rbdi_scale(-(rbd_real)rod->crank, rbdi_add(rbdi_scale(cosine, zero), rbdi_scale(sine, across)));
    C1 = rbdi_scale(rod->crank, rbdi_sub(rbdi_scale(cosine, across), rbdi_scale(sine, zero)));
    d = rbdi_add(r, C2);
    w = rbdi_dot(d, C1);
    if (!(rbdi_abs(w) > RBDI_ACTUATOR_DEAD * rod->crank * rod->length)) return RBD_ERR_SINGULAR;

    *angle = rbdi_signed_angle(sine, cosine);
    for (int j = 0; j < J->n; ++j) {
        P_j[j] = rbdi_cross(J->axis[j], rbdi_sub(P, J->origin[j]));
        G[j] = rbdi_dot(d, P_j[j]) / w;
    }
    for (int j = 0; j < J->n; ++j)
        for (int k = 0; k < J->n; ++k) {
            const int nearer = j < k ? j : k, farther = j < k ? k : j;
            const rbdi_v3 P_jk = rbdi_cross(J->axis[nearer], P_j[farther]);
            const rbdi_v3 d_k = rbdi_sub(P_j[k], rbdi_scale(G[k], C1));
            const rbd_real turns = rbdi_dot(d_k, C1) + rbdi_dot(d, C2) * G[k];
            g->H[(i * J->n + j) * J->n + k] = (rbdi_dot(d_k, P_j[j]) + rbdi_dot(d, P_jk) - G[j] * turns) / w;
        }
    return RBD_OK;
}

/* G, H and the cranks' angles at q. */
RBDI_LOCAL rbd_status rbdi_act_map_rods(rbdi_act_group *g, const rbd_real *q, rbd_real *angle) {
    const rbdi_act_rod_joints J = rbdi_act_place_joints(g, q);
    rbd_status status = RBD_OK;
    for (int i = 0; i < g->n && !status; ++i) status = rbdi_act_map_rod(g, &J, i, &angle[i]);
    return status;
}

#endif
