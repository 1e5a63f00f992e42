/* contact_differences.h - HyQ on its feet in double, which contact_float.c compares its derivatives with. */
#ifndef CONTACT_DIFFERENCES_H
#define CONTACT_DIFFERENCES_H

#include "models/hyq.h"

enum { FEET = 4, LEGS = 12 };

/* A step of HyQ from these, and its derivatives by differences, nv x nv: of q_next by q, v and tau, then of
   v_next. */
typedef struct hyq_step {
    double q[HYQ_NQ], v[HYQ_NV], tau[HYQ_NV], damping[HYQ_NV], dt;
    double by[6][HYQ_NV * HYQ_NV];
    int state[FEET]; /* rbd_contact_state */
} hyq_step;

void differentiate_hyq(hyq_step *x);

#endif
