#ifndef RBDI_ALGEBRA_SPATIAL_H
#define RBDI_ALGEBRA_SPATIAL_H
#include "algebra/vectors.h"

RBDI_INLINE rbdi_sym rbdi_sym_add(rbdi_sym A, rbdi_sym B) {
    A.xx = A.xx + B.xx;
    A.xy = A.xy + B.xy;
    A.xz = A.xz + B.xz;
    A.yy = A.yy + B.yy;
    A.yz = A.yz + B.yz;
    A.zz = A.zz + B.zz;
    return A;
}

/* E' A E: to the parent's axes, for E from these to the child's. */
RBDI_INLINE rbdi_mat rbdi_mat_up(rbdi_mat E, rbdi_mat A) {
    return rbdi_mul_mat(rbdi_transpose(E), rbdi_mul_mat(A, E));
}

RBDI_INLINE rbdi_sym rbdi_sym_up(rbdi_mat E, rbdi_sym A) {
    rbdi_mat full;
    rbdi_sym B;

    full.xx = A.xx;
    full.xy = A.xy;
    full.xz = A.xz;
    full.yx = A.xy;
    full.yy = A.yy;
    full.yz = A.yz;
    full.zx = A.xz;
    full.zy = A.yz;
    full.zz = A.zz;
    full = rbdi_mat_up(E, full);
    B.xx = full.xx;
    B.xy = full.xy;
    B.xz = full.xz;
    B.yy = full.yy;
    B.yz = full.yz;
    B.zz = full.zz;
    return B;
}

/* [omega]x [omega]x = omega omega' - omega'omega 1. */
RBDI_INLINE rbdi_mat rbdi_omega_steady(rbdi_v3 omega) {
    rbd_real xx = omega.x * omega.x, yy = omega.y * omega.y, zz = omega.z * omega.z;
    rbdi_mat O;

    O.xx = -(yy + zz);
    O.yy = -(xx + zz);
    O.zz = -(xx + yy);
    O.xy = O.yx = omega.x * omega.y;
    O.xz = O.zx = omega.x * omega.z;
    O.yz = O.zy = omega.y * omega.z;
    return O;
}

/* Omega = [omega_dot]x + [omega]x [omega]x: a point x of the body has the acceleration acc + Omega x. */
RBDI_INLINE rbdi_mat rbdi_omega(rbdi_v3 omega, rbdi_v3 omega_dot) {
    rbdi_mat O = rbdi_omega_steady(omega);

    O.xy = O.xy - omega_dot.z;
    O.yx = O.yx + omega_dot.z;
    O.xz = O.xz + omega_dot.y;
    O.zx = O.zx - omega_dot.y;
    O.yz = O.yz - omega_dot.x;
    O.zy = O.zy + omega_dot.x;
    return O;
}

RBDI_INLINE rbdi_force rbdi_force_sub(rbdi_force A, rbdi_force B) {
    A.n = rbdi_sub(A.n, B.n);
    A.f = rbdi_sub(A.f, B.f);
    return A;
}

RBDI_INLINE rbdi_force rbdi_force0(void) {
    rbdi_force F;
    F.n = F.f = rbdi_vec0();
    return F;
}

RBDI_INLINE rbdi_motion rbdi_motion0(void) {
    rbdi_motion V;
    V.omega = V.v = rbdi_vec0();
    return V;
}

/* -- composite bodies: (Sigma, h) and a mass m -- */

/* To a frame whose origin is at -r, r = d z: h_new = h + m r, Sigma_new = Sigma + r h' + h_new r'. */
RBDI_INLINE rbdi_rbi rbdi_rbi_shift_z(rbd_real d, rbd_const m, rbdi_rbi C) {
    rbd_real h_new = C.h.z + d * m;
    C.Sigma.xz = C.Sigma.xz + d * C.h.x;
    C.Sigma.yz = C.Sigma.yz + d * C.h.y;
    C.Sigma.zz = C.Sigma.zz + d * (C.h.z + h_new);
    C.h.z = h_new;
    return C;
}

RBDI_INLINE rbdi_rbi rbdi_rbi_up_z(int flags, rbd_real c, rbd_real s, rbdi_rbi C) {
    C.Sigma = rbdi_sym_up_z(flags, c, s, C.Sigma);
    C.h = rbdi_turn_up_z(flags, c, s, C.h);
    return C;
}

RBDI_INLINE rbdi_rbi rbdi_rbi_cycle(rbdi_rbi C) {
    C.Sigma = rbdi_sym_cycle(C.Sigma);
    C.h = rbdi_cycle(C.h);
    return C;
}

RBDI_INLINE rbdi_rbi rbdi_rbi_uncycle(rbdi_rbi C) { return rbdi_rbi_cycle(rbdi_rbi_cycle(C)); }
RBDI_INLINE rbdi_rbi rbdi_rbi_add(rbdi_rbi A, rbdi_rbi B) {
    A.Sigma = rbdi_sym_add(A.Sigma, B.Sigma);
    A.h = rbdi_add(A.h, B.h);
    return A;
}

RBDI_INLINE rbdi_rbi rbdi_rbi_zero(void) {
    const rbd_real o = rbdi_zero();
    rbdi_rbi C;
    C.Sigma.xx = C.Sigma.xy = C.Sigma.xz = C.Sigma.yy = C.Sigma.yz = C.Sigma.zz = o;
    C.h = rbdi_vec0();
    return C;
}

/* By any shift r, an axis after the other. */
RBDI_INLINE rbdi_rbi rbdi_rbi_shift(rbdi_v3 r, rbd_const m, rbdi_rbi C) {
    C = rbdi_rbi_shift_z(r.x, m, rbdi_rbi_cycle(C));
    C = rbdi_rbi_shift_z(r.y, m, rbdi_rbi_cycle(C));
    return rbdi_rbi_shift_z(r.z, m, rbdi_rbi_cycle(C));
}

/* -- articulated-body inertias [I H; H' M] -- */

/* To a frame whose origin is at -r, r = d z: H_new = H + [r]x M, I_new = I - H [r]x + [r]x H_new'. full = 0:
   row z of I and H is zero, and stays zero. */
RBDI_INLINE rbdi_abi rbdi_abi_shift_z(rbd_real d, int full, rbdi_abi IA) {
    rbdi_abi shifted = IA;

    shifted.H.xx = IA.H.xx - d * IA.M.xy;
    shifted.H.xy = IA.H.xy - d * IA.M.yy;
    shifted.H.xz = IA.H.xz - d * IA.M.yz;
    shifted.H.yx = IA.H.yx + d * IA.M.xx;
    shifted.H.yy = IA.H.yy + d * IA.M.xy;
    shifted.H.yz = IA.H.yz + d * IA.M.xz;

    shifted.I.xx = IA.I.xx - d * (IA.H.xy + shifted.H.xy);
    shifted.I.xy = IA.I.xy + d * (IA.H.xx - shifted.H.yy);
    shifted.I.yy = IA.I.yy + d * (IA.H.yx + shifted.H.yx);

    if (full) {
        shifted.I.xz = IA.I.xz - d * IA.H.zy;
        shifted.I.yz = IA.I.yz + d * IA.H.zx;
    }

    return shifted;
}

RBDI_INLINE rbdi_abi rbdi_abi_up_z(int flags, rbd_real c, rbd_real s, rbdi_abi IA) {
    IA.I = rbdi_sym_up_z(flags, c, s, IA.I);
    IA.H = rbdi_mat_up_z(flags, c, s, IA.H);
    IA.M = rbdi_sym_up_z(flags, c, s, IA.M);
    return IA;
}

RBDI_INLINE rbdi_abi rbdi_abi_cycle(rbdi_abi IA) {
    IA.I = rbdi_sym_cycle(IA.I);
    IA.H = rbdi_mat_cycle(IA.H);
    IA.M = rbdi_sym_cycle(IA.M);
    return IA;
}

RBDI_INLINE rbdi_abi rbdi_abi_uncycle(rbdi_abi IA) { return rbdi_abi_cycle(rbdi_abi_cycle(IA)); }
RBDI_INLINE rbdi_abi rbdi_abi_add(rbdi_abi A, rbdi_abi B) {
    A.I = rbdi_sym_add(A.I, B.I);
    A.M = rbdi_sym_add(A.M, B.M);
    A.H.xx = A.H.xx + B.H.xx;
    A.H.xy = A.H.xy + B.H.xy;
    A.H.xz = A.H.xz + B.H.xz;
    A.H.yx = A.H.yx + B.H.yx;
    A.H.yy = A.H.yy + B.H.yy;
    A.H.yz = A.H.yz + B.H.yz;
    A.H.zx = A.H.zx + B.H.zx;
    A.H.zy = A.H.zy + B.H.zy;
    A.H.zz = A.H.zz + B.H.zz;
    return A;
}

RBDI_INLINE rbdi_abi rbdi_abi_zero(void) {
    const rbd_real o = rbdi_zero();
    rbdi_abi IA;
    IA.I.xx = IA.I.xy = IA.I.xz = IA.I.yy = IA.I.yz = IA.I.zz = o;
    IA.H.xx = IA.H.xy = IA.H.xz = IA.H.yx = IA.H.yy = IA.H.yz = IA.H.zx = IA.H.zy = IA.H.zz = o;
    IA.M.xx = IA.M.xy = IA.M.xz = IA.M.yy = IA.M.yz = IA.M.zz = o;
    return IA;
}

/* By any shift r, an axis after the other. */
RBDI_INLINE rbdi_abi rbdi_abi_shift(rbdi_v3 r, rbdi_abi IA) {
    IA = rbdi_abi_shift_z(r.x, 1, rbdi_abi_cycle(IA));
    IA = rbdi_abi_shift_z(r.y, 1, rbdi_abi_cycle(IA));
    return rbdi_abi_shift_z(r.z, 1, rbdi_abi_cycle(IA));
}

/* IA of a composite body of mass m: I = tr(Sigma) 1 - Sigma, H = [h]x, M = m 1. */
RBDI_INLINE rbdi_abi rbdi_abi_of_rbi(rbdi_rbi C, rbd_const m) {
    const rbd_real trace = C.Sigma.xx + C.Sigma.yy + C.Sigma.zz;
    rbdi_abi IA = rbdi_abi_zero();

    IA.I.xx = trace - C.Sigma.xx;
    IA.I.xy = -C.Sigma.xy;
    IA.I.xz = -C.Sigma.xz;
    IA.I.yy = trace - C.Sigma.yy;
    IA.I.yz = -C.Sigma.yz;
    IA.I.zz = trace - C.Sigma.zz;
    IA.H.xy = -C.h.z;
    IA.H.xz = C.h.y;
    IA.H.yz = -C.h.x;
    IA.H.yx = C.h.z;
    IA.H.zx = -C.h.y;
    IA.H.zy = C.h.x;
    IA.M.xx = IA.M.yy = IA.M.zz = rbdi_set(m);
    return IA;
}

/* The lower triangle of [I H; H' M]. */
RBDI_INLINE void rbdi_abi_to_array(rbdi_abi IA, rbd_real A[6][6]) {
    A[0][0] = IA.I.xx;
    A[1][0] = IA.I.xy;
    A[1][1] = IA.I.yy;
    A[2][0] = IA.I.xz;
    A[2][1] = IA.I.yz;
    A[2][2] = IA.I.zz;
    A[3][0] = IA.H.xx;
    A[3][1] = IA.H.yx;
    A[3][2] = IA.H.zx;
    A[3][3] = IA.M.xx;
    A[4][0] = IA.H.xy;
    A[4][1] = IA.H.yy;
    A[4][2] = IA.H.zy;
    A[4][3] = IA.M.xy;
    A[4][4] = IA.M.yy;
    A[5][0] = IA.H.xz;
    A[5][1] = IA.H.yz;
    A[5][2] = IA.H.zz;
    A[5][3] = IA.M.xz;
    A[5][4] = IA.M.yz;
    A[5][5] = IA.M.zz;
}

RBDI_INLINE rbdi_abi rbdi_abi_from_array(rbd_real A[6][6]) {
    rbdi_abi IA;

    IA.I.xx = A[0][0];
    IA.I.xy = A[1][0];
    IA.I.yy = A[1][1];
    IA.I.xz = A[2][0];
    IA.I.yz = A[2][1];
    IA.I.zz = A[2][2];
    IA.H.xx = A[3][0];
    IA.H.yx = A[3][1];
    IA.H.zx = A[3][2];
    IA.M.xx = A[3][3];
    IA.H.xy = A[4][0];
    IA.H.yy = A[4][1];
    IA.H.zy = A[4][2];
    IA.M.xy = A[4][3];
    IA.M.yy = A[4][4];
    IA.H.xz = A[5][0];
    IA.H.yz = A[5][1];
    IA.H.zz = A[5][2];
    IA.M.xz = A[5][3];
    IA.M.yz = A[5][4];
    IA.M.zz = A[5][5];
    return IA;
}

/* Spatial vectors to and from arrays, whose six components are a stride apart. */
RBDI_INLINE void rbdi_store_motion(rbd_real *array, ptrdiff_t stride, rbdi_motion V) {
    rbdi_store_vec(array, stride, V.omega);
    rbdi_store_vec(array + 3 * stride, stride, V.v);
}

RBDI_INLINE rbdi_motion rbdi_load_motion(const rbd_real *array, ptrdiff_t stride) {
    rbdi_motion V;
    V.omega = rbdi_load_vec(array, stride);
    V.v = rbdi_load_vec(array + 3 * stride, stride);
    return V;
}

RBDI_INLINE void rbdi_store_force(rbd_real *array, ptrdiff_t stride, rbdi_force F) {
    rbdi_store_vec(array, stride, F.n);
    rbdi_store_vec(array + 3 * stride, stride, F.f);
}

RBDI_INLINE rbdi_force rbdi_load_force(const rbd_real *array, ptrdiff_t stride) {
    rbdi_force F;
    F.n = rbdi_load_vec(array, stride);
    F.f = rbdi_load_vec(array + 3 * stride, stride);
    return F;
}

#endif
