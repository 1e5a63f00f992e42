#ifndef RBDI_ALGEBRA_BATCH_VECTORS_H
#define RBDI_ALGEBRA_BATCH_VECTORS_H
#include "base/simd.h"

/* Vectors, motions and forces of batches. */

typedef struct rbdi_b3 {
    rbdi_batch x, y, z;
} rbdi_b3;

typedef struct rbdi_bmotion {
    rbdi_b3 omega, v;
} rbdi_bmotion;

typedef struct rbdi_bforce {
    rbdi_b3 n, f;
} rbdi_bforce;

/* rbdi_b_vec, rbdi_b_add and so on. */
#define RBDI_T rbdi_batch
#define rbdi_v3 rbdi_b3
#define rbdi_motion rbdi_bmotion
#define rbdi_force rbdi_bforce
#define rbdi_vec rbdi_b_vec
#define rbdi_add rbdi_b_add
#define rbdi_scale rbdi_b_scale
#define rbdi_cross rbdi_b_cross
#define rbdi_motion_add rbdi_b_motion_add
#define rbdi_force_add rbdi_b_force_add
#define rbdi_power rbdi_b_power
#include "algebra/vectors_of.h"
#undef RBDI_T
#undef rbdi_v3
#undef rbdi_motion
#undef rbdi_force
#undef rbdi_vec
#undef rbdi_add
#undef rbdi_scale
#undef rbdi_cross
#undef rbdi_motion_add
#undef rbdi_force_add
#undef rbdi_power

#endif
