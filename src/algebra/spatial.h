#ifndef RBDI_ALGEBRA_SPATIAL_H
#define RBDI_ALGEBRA_SPATIAL_H
#include "algebra/vectors.h"

RBDI_INLINE rbdi_force rbdi_force_add(rbdi_force A, rbdi_force B) {
    A.n = rbdi_add(A.n, B.n);
    A.f = rbdi_add(A.f, B.f);
    return A;
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
RBDI_INLINE rbdi_motion rbdi_motion_add(rbdi_motion A, rbdi_motion B) {
    A.omega = rbdi_add(A.omega, B.omega);
    A.v = rbdi_add(A.v, B.v);
    return A;
}

/* Composite body (Sigma, h, m): same moves. Sigma_new = Sigma + r h' + h_new r', h_new = h + m r. */
RBDI_INLINE rbdi_rbi rbdi_rbi_shift_z(rbd_real d, rbd_const m, rbdi_rbi C) {
    rbd_real k = C.h.z + d * m;
    C.Sigma.xz = C.Sigma.xz + d * C.h.x;
    C.Sigma.yz = C.Sigma.yz + d * C.h.y;
    C.Sigma.zz = C.Sigma.zz + d * (C.h.z + k);
    C.h.z = k;
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
RBDI_INLINE rbdi_sym rbdi_sym_add(rbdi_sym A, rbdi_sym B) {
    A.xx = A.xx + B.xx, A.xy = A.xy + B.xy, A.xz = A.xz + B.xz;
    A.yy = A.yy + B.yy, A.yz = A.yz + B.yz, A.zz = A.zz + B.zz;
    return A;
}
RBDI_INLINE rbdi_rbi rbdi_rbi_add(rbdi_rbi A, rbdi_rbi B) {
    A.Sigma = rbdi_sym_add(A.Sigma, B.Sigma);
    A.h = rbdi_add(A.h, B.h);
    return A;
}

/* Articulated-body inertia [I H; H' M]: H_new = H + [r]x M, I_new = I - H [r]x + [r]x H_new' for r = d z.
   full = 0: row z of I and H is zero and stays so. */
RBDI_INLINE rbdi_abi rbdi_abi_shift_z(rbd_real d, int full, rbdi_abi IA) {
    rbdi_abi Y = IA;
    Y.H.xx = IA.H.xx - d * IA.M.xy;
    Y.H.xy = IA.H.xy - d * IA.M.yy;
    Y.H.xz = IA.H.xz - d * IA.M.yz;
    Y.H.yx = IA.H.yx + d * IA.M.xx;
    Y.H.yy = IA.H.yy + d * IA.M.xy;
    Y.H.yz = IA.H.yz + d * IA.M.xz;
    Y.I.xx = IA.I.xx - d * (IA.H.xy + Y.H.xy);
    Y.I.xy = IA.I.xy + d * (IA.H.xx - Y.H.yy);
    Y.I.yy = IA.I.yy + d * (IA.H.yx + Y.H.yx);
    if (full) {
        Y.I.xz = IA.I.xz - d * IA.H.zy;
        Y.I.yz = IA.I.yz + d * IA.H.zx;
    }
    return Y;
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
    A.H.xx = A.H.xx + B.H.xx, A.H.xy = A.H.xy + B.H.xy, A.H.xz = A.H.xz + B.H.xz;
    A.H.yx = A.H.yx + B.H.yx, A.H.yy = A.H.yy + B.H.yy, A.H.yz = A.H.yz + B.H.yz;
    A.H.zx = A.H.zx + B.H.zx, A.H.zy = A.H.zy + B.H.zy, A.H.zz = A.H.zz + B.H.zz;
    return A;
}

/* [omega]x [omega]x. */
RBDI_INLINE rbdi_mat rbdi_omega_steady(rbdi_v3 omega) {
    rbd_real xx = omega.x * omega.x, yy = omega.y * omega.y, zz = omega.z * omega.z;
    rbdi_mat O;
    O.xx = -(yy + zz), O.yy = -(xx + zz), O.zz = -(xx + yy);
    O.xy = O.yx = omega.x * omega.y;
    O.xz = O.zx = omega.x * omega.z;
    O.yz = O.zy = omega.y * omega.z;
    return O;
}
/* Omega = [omega_dot]x + [omega]x [omega]x: a point x of the body accelerates with acc + Omega x. */
RBDI_INLINE rbdi_mat rbdi_omega(rbdi_v3 omega, rbdi_v3 omega_dot) {
    rbdi_mat O = rbdi_omega_steady(omega);
    O.xy = O.xy - omega_dot.z, O.yx = O.yx + omega_dot.z;
    O.xz = O.xz + omega_dot.y, O.zx = O.zx - omega_dot.y;
    O.yz = O.yz - omega_dot.x, O.zy = O.zy + omega_dot.x;
    return O;
}

RBDI_INLINE rbdi_rbi rbdi_rbi_shift(rbdi_v3 r, rbd_const m, rbdi_rbi C) {
    C = rbdi_rbi_shift_z(r.x, m, rbdi_rbi_cycle(C));
    C = rbdi_rbi_shift_z(r.y, m, rbdi_rbi_cycle(C));
    return rbdi_rbi_shift_z(r.z, m, rbdi_rbi_cycle(C));
}

RBDI_INLINE rbdi_rbi rbdi_rbi_zero(void) {
    const rbd_real o = rbdi_zero();
    rbdi_rbi C;
    C.Sigma.xx = C.Sigma.xy = C.Sigma.xz = C.Sigma.yy = C.Sigma.yz = C.Sigma.zz = o;
    C.h = rbdi_vec0();
    return C;
}

/* E' A E. */
RBDI_INLINE rbdi_mat rbdi_mat_up(rbdi_mat E, rbdi_mat A) {
    return rbdi_mul_mat(rbdi_transpose(E), rbdi_mul_mat(A, E));
}

RBDI_INLINE rbdi_sym rbdi_sym_up(rbdi_mat E, rbdi_sym A) {
    rbdi_mat M;
    rbdi_sym B;
    M.xx = A.xx, M.xy = A.xy, M.xz = A.xz;
    M.yx = A.xy, M.yy = A.yy, M.yz = A.yz;
    M.zx = A.xz, M.zy = A.yz, M.zz = A.zz;
    M = rbdi_mat_up(E, M);
    B.xx = M.xx, B.xy = M.xy, B.xz = M.xz, B.yy = M.yy, B.yz = M.yz, B.zz = M.zz;
    return B;
}

RBDI_INLINE rbdi_abi rbdi_abi_shift(rbdi_v3 r, rbdi_abi IA) {
    IA = rbdi_abi_shift_z(r.x, 1, rbdi_abi_cycle(IA));
    IA = rbdi_abi_shift_z(r.y, 1, rbdi_abi_cycle(IA));
    return rbdi_abi_shift_z(r.z, 1, rbdi_abi_cycle(IA));
}

RBDI_INLINE rbdi_abi rbdi_abi_zero(void) {
    const rbd_real o = rbdi_zero();
    rbdi_abi X;
    X.I.xx = X.I.xy = X.I.xz = X.I.yy = X.I.yz = X.I.zz = o;
    X.H.xx = X.H.xy = X.H.xz = X.H.yx = X.H.yy = X.H.yz = X.H.zx = X.H.zy = X.H.zz = o;
    X.M.xx = X.M.xy = X.M.xz = X.M.yy = X.M.yz = X.M.zz = o;
    return X;
}

/* IA of a composite body: I = tr(Sigma) - Sigma, H = [h]x, M = m. */
RBDI_INLINE rbdi_abi rbdi_abi_of_rbi(rbdi_rbi C, rbd_const m) {
    const rbd_real trace = C.Sigma.xx + C.Sigma.yy + C.Sigma.zz;
    rbdi_abi IA = rbdi_abi_zero();
    IA.I.xx = trace - C.Sigma.xx, IA.I.xy = -C.Sigma.xy, IA.I.xz = -C.Sigma.xz;
    IA.I.yy = trace - C.Sigma.yy, IA.I.yz = -C.Sigma.yz, IA.I.zz = trace - C.Sigma.zz;
    IA.H.xy = -C.h.z, IA.H.xz = C.h.y, IA.H.yz = -C.h.x;
    IA.H.yx = C.h.z, IA.H.zx = -C.h.y, IA.H.zy = C.h.x;
    IA.M.xx = IA.M.yy = IA.M.zz = rbdi_set(m);
    return IA;
}

/* The lower triangle of [I H; H' M]. */
RBDI_INLINE void rbdi_abi_to_array(rbdi_abi IA, rbd_real A[6][6]) {
    A[0][0] = IA.I.xx;
    A[1][0] = IA.I.xy, A[1][1] = IA.I.yy;
    A[2][0] = IA.I.xz, A[2][1] = IA.I.yz, A[2][2] = IA.I.zz;
    A[3][0] = IA.H.xx, A[3][1] = IA.H.yx, A[3][2] = IA.H.zx, A[3][3] = IA.M.xx;
    A[4][0] = IA.H.xy, A[4][1] = IA.H.yy, A[4][2] = IA.H.zy, A[4][3] = IA.M.xy, A[4][4] = IA.M.yy;
    A[5][0] = IA.H.xz, A[5][1] = IA.H.yz, A[5][2] = IA.H.zz;
    A[5][3] = IA.M.xz, A[5][4] = IA.M.yz, A[5][5] = IA.M.zz;
}

RBDI_INLINE rbdi_abi rbdi_abi_from_array(rbd_real A[6][6]) {
    rbdi_abi IA;
    IA.I.xx = A[0][0];
    IA.I.xy = A[1][0], IA.I.yy = A[1][1];
    IA.I.xz = A[2][0], IA.I.yz = A[2][1], IA.I.zz = A[2][2];
    IA.H.xx = A[3][0], IA.H.yx = A[3][1], IA.H.zx = A[3][2], IA.M.xx = A[3][3];
    IA.H.xy = A[4][0], IA.H.yy = A[4][1], IA.H.zy = A[4][2], IA.M.xy = A[4][3], IA.M.yy = A[4][4];
    IA.H.xz = A[5][0], IA.H.yz = A[5][1], IA.H.zz = A[5][2];
    IA.M.xz = A[5][3], IA.M.yz = A[5][4], IA.M.zz = A[5][5];
    return IA;
}

/* Spatial vectors to and from six scalars, a stride apart. */
RBDI_INLINE void rbdi_store_motion(rbd_real *a, ptrdiff_t stride, rbdi_motion V) {
    rbdi_store_vec(a, stride, V.omega);
    rbdi_store_vec(a + 3 * stride, stride, V.v);
}
RBDI_INLINE rbdi_motion rbdi_load_motion(const rbd_real *a, ptrdiff_t stride) {
    rbdi_motion V;
    V.omega = rbdi_load_vec(a, stride), V.v = rbdi_load_vec(a + 3 * stride, stride);
    return V;
}
RBDI_INLINE void rbdi_store_force(rbd_real *a, ptrdiff_t stride, rbdi_force F) {
    rbdi_store_vec(a, stride, F.n);
    rbdi_store_vec(a + 3 * stride, stride, F.f);
}
RBDI_INLINE rbdi_force rbdi_load_force(const rbd_real *a, ptrdiff_t stride) {
    rbdi_force F;
    F.n = rbdi_load_vec(a, stride), F.f = rbdi_load_vec(a + 3 * stride, stride);
    return F;
}

#endif
