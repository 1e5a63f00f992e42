#ifndef RBDI_ALGEBRA_VECTORS_H
#define RBDI_ALGEBRA_VECTORS_H
#include "algebra/types.h"
#include "base/scalar.h"

/* ---- spatial algebra [spatial algebra] ----
   Frames: "down" goes from parent to child, "up" from child to parent. Everything is built from the
   turn about z and the shift along z; those about and along x are the same after the cyclic change
   of axes (x, y, z) -> (y, z, x). */

/* Vectors, motions and forces; algebra/batch_vectors.h has the same of batches. */
#define RBDI_T rbd_real
#include "algebra/vectors_of.h"
#undef RBDI_T

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
RBDI_INLINE rbdi_v3 rbdi_sub(rbdi_v3 a, rbdi_v3 b) { return rbdi_vec(a.x - b.x, a.y - b.y, a.z - b.z); }
RBDI_INLINE rbd_real rbdi_dot(rbdi_v3 a, rbdi_v3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

RBDI_INLINE rbdi_v3 rbdi_cycle(rbdi_v3 v) { return rbdi_vec(v.y, v.z, v.x); }
RBDI_INLINE rbdi_v3 rbdi_uncycle(rbdi_v3 v) { return rbdi_vec(v.z, v.x, v.y); }

/* A matrix by rows. */
RBDI_INLINE rbdi_mat rbdi_mat_of(rbd_real xx, rbd_real xy, rbd_real xz, rbd_real yx, rbd_real yy, rbd_real yz,
                                 rbd_real zx, rbd_real zy, rbd_real zz) {
    const rbdi_mat A = {xx, xy, xz, yx, yy, yz, zx, zy, zz};
    return A;
}

RBDI_INLINE rbdi_mat rbdi_mat_c(const rbd_const A[9]) {
    rbdi_mat B;

    B.xx = rbdi_set(A[0]);
    B.xy = rbdi_set(A[1]);
    B.xz = rbdi_set(A[2]);
    B.yx = rbdi_set(A[3]);
    B.yy = rbdi_set(A[4]);
    B.yz = rbdi_set(A[5]);
    B.zx = rbdi_set(A[6]);
    B.zy = rbdi_set(A[7]);
    B.zz = rbdi_set(A[8]);
    return B;
}

RBDI_INLINE rbdi_sym rbdi_sym_c(rbdi_csym A) {
    rbdi_sym B;

    B.xx = rbdi_set(A.xx);
    B.xy = rbdi_set(A.xy);
    B.xz = rbdi_set(A.xz);
    B.yy = rbdi_set(A.yy);
    B.yz = rbdi_set(A.yz);
    B.zz = rbdi_set(A.zz);
    return B;
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
    rbdi_v3 x = rbdi_mul(A, rbdi_vec(B.xx, B.yx, B.zx)), y = rbdi_mul(A, rbdi_vec(B.xy, B.yy, B.zy)),
            z = rbdi_mul(A, rbdi_vec(B.xz, B.yz, B.zz));
    rbdi_mat C;

    C.xx = x.x;
    C.xy = y.x;
    C.xz = z.x;
    C.yx = x.y;
    C.yy = y.y;
    C.yz = z.y;
    C.zx = x.z;
    C.zy = y.z;
    C.zz = z.z;
    return C;
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
    rbdi_sym B;
    if (flags & RBDI_TWIST_0) return A;

    B.zz = A.zz;
    if (flags & RBDI_TWIST_90) {
        B.xx = A.yy;
        B.yy = A.xx;
        B.xy = -A.xy;
        B.xz = -A.yz;
        B.yz = A.xz;
        return B;
    }

    /* t = s (A_yy - A_xx) - 2 c A_xy:  xx += s t,  yy -= s t,  xy = -c t - A_xy */
    t = s * (A.yy - A.xx) - (c + c) * A.xy;
    B.xx = A.xx + s * t;
    B.yy = A.yy - s * t;
    B.xy = -(c * t) - A.xy;
    B.xz = c * A.xz - s * A.yz;
    B.yz = s * A.xz + c * A.yz;
    return B;
}

RBDI_INLINE rbdi_sym rbdi_sym_cycle(rbdi_sym A) {
    rbdi_sym B;

    B.xx = A.yy;
    B.xy = A.yz;
    B.xz = A.xy;
    B.yy = A.zz;
    B.yz = A.xz;
    B.zz = A.xx;
    return B;
}

/* The same of any matrix. */
RBDI_INLINE rbdi_mat rbdi_mat_up_z(int flags, rbd_real c, rbd_real s, rbdi_mat A) {
    rbd_real t;
    rbdi_mat B;
    if (flags & RBDI_TWIST_0) return A;

    B.zz = A.zz;
    if (flags & RBDI_TWIST_90) {
        B.xx = A.yy;
        B.yy = A.xx;
        B.xy = -A.yx;
        B.yx = -A.xy;
        B.xz = -A.yz;
        B.yz = A.xz;
        B.zx = -A.zy;
        B.zy = A.zx;
        return B;
    }

    /* t = s (A_yy - A_xx) - c (A_xy + A_yx):  xx += s t,  yy -= s t,  xy = -c t - A_yx,  yx = -c t - A_xy */
    t = s * (A.yy - A.xx) - c * (A.xy + A.yx);
    B.xx = A.xx + s * t;
    B.yy = A.yy - s * t;
    B.xy = -(c * t) - A.yx;
    B.yx = -(c * t) - A.xy;
    B.xz = c * A.xz - s * A.yz;
    B.yz = s * A.xz + c * A.yz;
    B.zx = c * A.zx - s * A.zy;
    B.zy = s * A.zx + c * A.zy;
    return B;
}

RBDI_INLINE rbdi_mat rbdi_mat_cycle(rbdi_mat A) {
    rbdi_mat B;

    B.xx = A.yy;
    B.xy = A.yz;
    B.xz = A.yx;
    B.yx = A.zy;
    B.yy = A.zz;
    B.yz = A.zx;
    B.zx = A.xy;
    B.zy = A.xz;
    B.zz = A.xx;
    return B;
}

#endif
