/* program.c - a whole program for one robot alone: its table, rbd_work_init, and the call that CALL names.
   SPDX-License-Identifier: MIT */
#include "rbd.h"
#include "rbd_constraints.h"
#include "rbd_derivatives.h"
#include ROBOT_HEADER

#define PASTE(a, b) a##b
#define JOIN(a, b) PASTE(a, b)
#define ROBOT(name) JOIN(ROBOT_PREFIX, name)
enum { NV = ROBOT(_NV), ROWS = 6 };

unsigned char memory[ROBOT(_WORK_SIZE)], of_derivatives[RBD_DERIVATIVES_SIZE(ROBOT(_NB), NV)],
    of_set[RBD_CONSTRAINT_SET_SIZE(NV, ROWS)];
rbd_real q[ROBOT(_NQ)], v[NV], a[NV], tau[NV], out[NV * NV], by_v[NV * NV], lambda[ROWS];
rbd_work *w;
rbd_derivatives *d;
rbd_constraint_set *c;
rbd_constraint contact; /* of zeros: the program is not run */

#define DERIVATIVES(m) rbd_derivatives_init(m, w, of_derivatives, sizeof of_derivatives, &d)
#define SET(m) rbd_constraint_set_init(m, w, &contact, 1, of_set, sizeof of_set, &c, NULL)

#define CALL_id(m) rbd_rnea(m, w, q, v, a, NULL, out)
#define CALL_mm(m) rbd_crba(m, w, q, out)
#define CALL_fd(m) rbd_aba(m, w, q, v, tau, NULL, out)
#define CALL_id_derivatives(m) DERIVATIVES(m) || rbd_id_derivatives(m, d, q, v, a, NULL, out, by_v, NULL)
#define CALL_fd_derivatives(m) \
    DERIVATIVES(m) || rbd_fd_derivatives(m, d, q, v, tau, NULL, NULL, out, by_v, NULL)
#define CALL_constrained_fd(m) SET(m) || rbd_constrained_fd(m, c, q, v, tau, NULL, out, lambda)

int main(void) {
    const rbd_model *m = &ROBOT_MODEL;
    return rbd_work_init(m, memory, sizeof memory, &w) || JOIN(CALL_, CALL)(m);
}
