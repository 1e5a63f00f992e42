/* iiwa_code.h - iiwa, functions of this robot alone, straight-line code.
   Written by rbd-codegen 0.3.0 from iiwa.urdf: change that instead.
       rbd-codegen --name iiwa --algorithm id,mm,fd iiwa.urdf


   Compile iiwa_code.c, a file of its own, with
       cc -O3 -march=native -c iiwa_code.c                               (a computer)
       arm-none-eabi-gcc -O2 -mcpu=... -mfloat-abi=... -c iiwa_code.c    (a microcontroller)
   without -ffast-math. With -DIIWA_SELFTEST it has int iiwa_selftest(void), which runs all functions
   on known states: 0, or the number of the first that is wrong; -DIIWA_SELFTEST_MAIN adds a main
   that prints what it found.

   Units are SI, matrices row-major; coordinates and frames are those of rbd.h. Arrays must not
   overlap. Functions that return int give 0, or, all results being 0 then, 1 + the degree of freedom
   at which the mass matrix is singular, or -1 - that at which it is not a number. */
#ifndef IIWA_CODE_H
#define IIWA_CODE_H

/* clang-format off */

#define IIWA_NB 7 /* bodies */
#define IIWA_NQ 7 /* length of q */
#define IIWA_NV 7 /* degrees of freedom: length of v, a and tau */

#ifndef IIWA_INDICES /* the description and the built model have the same */
#define IIWA_INDICES
enum { /* bodies; Q: in q; DOF: in v, a and tau */
    IIWA_BODY_LBR_IIWA_LINK_1 = 0,
    IIWA_BODY_LBR_IIWA_LINK_2 = 1,
    IIWA_BODY_LBR_IIWA_LINK_3 = 2,
    IIWA_BODY_LBR_IIWA_LINK_4 = 3,
    IIWA_BODY_LBR_IIWA_LINK_5 = 4,
    IIWA_BODY_LBR_IIWA_LINK_6 = 5,
    IIWA_BODY_LBR_IIWA_LINK_7 = 6,
    IIWA_Q_LBR_IIWA_JOINT_1 = 0,
    IIWA_Q_LBR_IIWA_JOINT_2 = 1,
    IIWA_Q_LBR_IIWA_JOINT_3 = 2,
    IIWA_Q_LBR_IIWA_JOINT_4 = 3,
    IIWA_Q_LBR_IIWA_JOINT_5 = 4,
    IIWA_Q_LBR_IIWA_JOINT_6 = 5,
    IIWA_Q_LBR_IIWA_JOINT_7 = 6,
    IIWA_DOF_LBR_IIWA_JOINT_1 = 0,
    IIWA_DOF_LBR_IIWA_JOINT_2 = 1,
    IIWA_DOF_LBR_IIWA_JOINT_3 = 2,
    IIWA_DOF_LBR_IIWA_JOINT_4 = 3,
    IIWA_DOF_LBR_IIWA_JOINT_5 = 4,
    IIWA_DOF_LBR_IIWA_JOINT_6 = 5,
    IIWA_DOF_LBR_IIWA_JOINT_7 = 6,
};
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* Inverse dynamics tau = M(q) a + c(q, v) - sum J' f_ext: rbd_rnea.
   q        nq
   v        nv
   a        nv
   tau      nv
   Angles: any; from 1e6 rad on by libm.
   Not checked: pointers, lengths, overlap; that input is finite: what depends on NaN is NaN.
   Operations: 236 multiplications, 199 additions, 0 divisions, 0 roots, 6 sines and cosines. */
void iiwa_id(const double q[7], const double v[7], const double a[7], double tau[7]);

/* Mass matrix: rbd_crba.
   q        nq
   M        nv x nv, both triangles
   Angles: any; from 1e6 rad on by libm.
   Not checked: pointers, lengths, overlap; that input is finite: what depends on NaN is NaN.
   Operations: 114 multiplications, 90 additions, 0 divisions, 0 roots, 5 sines and cosines. */
void iiwa_mm(const double q[7], double M[49]);

/* Forward dynamics a = M^-1 (tau - c + sum J' f_ext) by articulated bodies: rbd_aba.
   q        nq
   v        nv
   tau      nv
   a        nv
   Angles: any; from 1e6 rad on by libm.
   Pivots: M counts as singular where one is at most 7.1e-15 of the largest inertia that its joint can move.
   Not checked: pointers, lengths, overlap; that input is finite: what depends on NaN is NaN;
      it returns 0 unless M depends on it.
   Operations: 493 multiplications, 405 additions, 5 divisions, 0 roots, 6 sines and cosines. */
int iiwa_fd(const double q[7], const double v[7], const double tau[7], double a[7]);

#ifdef __cplusplus
}
#endif

#endif
