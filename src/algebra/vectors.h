#ifndef RBDI_ALGEBRA_VECTORS_H
#define RBDI_ALGEBRA_VECTORS_H
#include "algebra/types.h"
#include "base/scalar.h"

/* ---- spatial algebra [spatial algebra] ----
   Frames: "down" goes from parent to child, "up" from child to parent. Everything is built from the
   turn about z and the shift along z; those about and along x are the same after the cyclic change
   of axes (x, y, z) -> (y, z, x). */

RBDI_INLINE rbdi_v3 rbdi_vec(rbd_real x, rbd_real y, rbd_real z) {
    const rbdi_v3 v = {x, y, z};
    return v;
}

/* A vector to and from an array, whose components are a stride apart. */
RBDI_INLINE void rbdi_store_vec(rbd_real *array, ptrdiff_t stride, rbdi_v3 v) {
    array[0] = v.x;
    array[stride] = v.y;
    array[2 * stride] = v.z;
}

RBDI_INLINE rbdi_v3 rbdi_load_vec(const rbd_real *array, ptrdiff_t stride) {
    return rbdi_vec(array[0], array[stride], array[2 * stride]);
}

/* _c: from constants of the model. */
RBDI_INLINE rbdi_v3 rbdi_vec_c(rbdi_c3 a) { return rbdi_vec(rbdi_set(a.x), rbdi_set(a.y), rbdi_set(a.z)); }
RBDI_INLINE rbdi_v3 rbdi_vec0(void) { return rbdi_vec(rbdi_zero(), rbdi_zero(), rbdi_zero()); }
RBDI_INLINE rbdi_v3 rbdi_add(rbdi_v3 a, rbdi_v3 b) { return rbdi_vec(a.x + b.x, a.y + b.y, a.z + b.z); }
RBDI_INLINE rbdi_v3 rbdi_sub(rbdi_v3 a, rbdi_v3 b) { return rbdi_vec(a.x - b.x, a.y - b.y, a.z - b.z); }
RBDI_INLINE rbdi_v3 rbdi_scale(rbd_real k, rbdi_v3 a) { return rbdi_vec(k * a.x, k * a.y, k * a.z); }
RBDI_INLINE rbd_real rbdi_dot(rbdi_v3 a, rbdi_v3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
RBDI_INLINE rbdi_v3 rbdi_cross(rbdi_v3 a, rbdi_v3 b) {
    return rbdi_vec(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

RBDI_INLINE rbdi_v3 rbdi_cycle(rbdi_v3 v) { return rbdi_vec(v.y, v.z, v.x); }
RBDI_INLINE rbdi_v3 rbdi_uncycle(rbdi_v3 v) { return rbdi_vec(v.z, v.x, v.y); }

/* Matrices by rows: all nine entries, or the upper triangle of a symmetric one. */
RBDI_INLINE rbdi_mat rbdi_mat_of(rbd_real xx, rbd_real xy, rbd_real xz, rbd_real yx, rbd_real yy, rbd_real yz,
                                 rbd_real zx, rbd_real zy, rbd_real zz) {
    const rbdi_mat A = {xx, xy, xz, yx, yy, yz, zx, zy, zz};
    return A;
}

RBDI_INLINE rbdi_sym rbdi_sym_of(rbd_real xx, rbd_real xy, rbd_real xz, rbd_real yy, rbd_real yz,
                                 rbd_real zz) {
    const rbdi_sym A = {xx, xy, xz, yy, yz, zz};
    return A;
}

RBDI_INLINE rbdi_mat rbdi_mat_c(const rbd_const A[9]) {
    return rbdi_mat_of(rbdi_set(A[0]), rbdi_set(A[1]), rbdi_set(A[2]), rbdi_set(A[3]), rbdi_set(A[4]),
                       rbdi_set(A[5]), rbdi_set(A[6]), rbdi_set(A[7]), rbdi_set(A[8]));
}

RBDI_INLINE rbdi_sym rbdi_sym_c(rbdi_csym A) {
    return rbdi_sym_of(rbdi_set(A.xx), rbdi_set(A.xy), rbdi_set(A.xz), rbdi_set(A.yy), rbdi_set(A.yz),
                       rbdi_set(A.zz));
}

/* A v, A' v, A B, and A v of a symmetric matrix. */
RBDI_INLINE rbdi_v3 rbdi_mul(rbdi_mat A, rbdi_v3 v) {
    return rbdi_vec(A.xx * v.x + A.xy * v.y + A.xz * v.z, A.yx * v.x + A.yy * v.y + A.yz * v.z,
                    A.zx * v.x + A.zy * v.y + A.zz * v.z);
}

RBDI_INLINE rbdi_mat rbdi_transpose(rbdi_mat A) {
    return rbdi_mat_of(A.xx, A.yx, A.zx, A.xy, A.yy, A.zy, A.xz, A.yz, A.zz);
}

RBDI_INLINE rbdi_v3 rbdi_mul_t(rbdi_mat A, rbdi_v3 v) { return rbdi_mul(rbdi_transpose(A), v); }
RBDI_INLINE rbdi_mat rbdi_mul_mat(rbdi_mat A, rbdi_mat B) {
    const rbdi_v3 x = rbdi_mul(A, rbdi_vec(B.xx, B.yx, B.zx)); /* the columns of A B */
    const rbdi_v3 y = rbdi_mul(A, rbdi_vec(B.xy, B.yy, B.zy));
    const rbdi_v3 z = rbdi_mul(A, rbdi_vec(B.xz, B.yz, B.zz));
    return rbdi_mat_of(x.x, y.x, z.x, x.y, y.y, z.y, x.z, y.z, z.z);
}

RBDI_INLINE rbdi_v3 rbdi_mul_sym(rbdi_sym A, rbdi_v3 v) {
    return rbdi_vec(A.xx * v.x + A.xy * v.y + A.xz * v.z, A.xy * v.x + A.yy * v.y + A.yz * v.z,
                    A.xz * v.x + A.yz * v.y + A.zz * v.z);
}

/* Change of axes by a turn about z with cosine c and sine s. rbdi_turn_z: from the axes before the turn to
   those after it, as from a parent's to its child's; rbdi_turn_up_z: back. flags: RBDI_TWIST_0 if (c, s) is
   (1, 0), RBDI_TWIST_90 if (0, 1), else neither. */
RBDI_INLINE rbdi_v3 rbdi_turn_z(int flags, rbd_real c, rbd_real s, rbdi_v3 v) {
    if (flags & RBDI_TWIST_0) return v;
    if (flags & RBDI_TWIST_90) return rbdi_vec(v.y, -v.x, v.z);
    return rbdi_vec(c * v.x + s * v.y, c * v.y - s * v.x, v.z);
}

RBDI_INLINE rbdi_v3 rbdi_turn_up_z(int flags, rbd_real c, rbd_real s, rbdi_v3 v) {
    if (flags & RBDI_TWIST_0) return v;
    if (flags & RBDI_TWIST_90) return rbdi_vec(-v.y, v.x, v.z);
    return rbdi_vec(c * v.x - s * v.y, c * v.y + s * v.x, v.z);
}

/* E' A E of a symmetric matrix A, for the turn E: from the axes after the turn to those before it. The block
   (x, y) takes four multiplications, the plain product twelve. */
RBDI_INLINE rbdi_sym rbdi_sym_up_z(int flags, rbd_real c, rbd_real s, rbdi_sym A) {
    rbd_real t;
    if (flags & RBDI_TWIST_0) return A;
    if (flags & RBDI_TWIST_90) return rbdi_sym_of(A.yy, -A.xy, -A.yz, A.xx, A.xz, A.zz);

    /* t = s (A_yy - A_xx) - 2 c A_xy:  xx += s t,  yy -= s t,  xy = -c t - A_xy */
    t = s * (A.yy - A.xx) - (c + c) * A.xy;
    return rbdi_sym_of(A.xx + s * t, -(c * t) - A.xy, c * A.xz - s * A.yz, A.yy - s * t, s * A.xz + c * A.yz,
                       A.zz);
}

RBDI_INLINE rbdi_sym rbdi_sym_cycle(rbdi_sym A) { return rbdi_sym_of(A.yy, A.yz, A.xy, A.zz, A.xz, A.xx); }

/* The same of any matrix. */
RBDI_INLINE rbdi_mat rbdi_mat_up_z(int flags, rbd_real c, rbd_real s, rbdi_mat A) {
    rbd_real t;
    if (flags & RBDI_TWIST_0) return A;
    if (flags & RBDI_TWIST_90) return rbdi_mat_of(A.yy, -A.yx, -A.yz, -A.xy, A.xx, A.xz, -A.zy, A.zx, A.zz);

    /* t = s (A_yy - A_xx) - c (A_xy + A_yx):  xx += s t,  yy -= s t,  xy = -c t - A_yx,  yx = -c t - A_xy */
    t = s * (A.yy - A.xx) - c * (A.xy + A.yx);
    return rbdi_mat_of(A.xx + s * t, -(c * t) - A.yx, c * A.xz - s * A.yz, /* row x */
                       -(c * t) - A.xy, A.yy - s * t, s * A.xz + c * A.yz, /* row y */
                       c * A.zx - s * A.zy, s * A.zx + c * A.zy, A.zz);
}

RBDI_INLINE rbdi_mat rbdi_mat_cycle(rbdi_mat A) {
    return rbdi_mat_of(A.yy, A.yz, A.yx, A.zy, A.zz, A.zx, A.xy, A.xz, A.xx);
}

#endif
