#ifndef RBDI_API_PARTS_H
#define RBDI_API_PARTS_H
#include "api/configuration.h"

#if defined RBD_NO_RNEA || defined RBD_NO_CRBA || defined RBD_NO_CHOLESKY
#define RBDI_NO_FD_CHOLESKY
#endif
#if defined RBDI_NO_FD_CHOLESKY && !defined RBD_NO_HYBRID
#define RBD_NO_HYBRID
#endif
#if defined RBD_NO_MINVERSE || defined RBD_NO_CRBA || defined RBD_NO_CHOLESKY
#define RBDI_NO_MINVERSE
#endif
#if !defined RBD_NO_CRBA && !defined RBD_NO_CHOLESKY
#define RBDI_JUDGE /* of states in doubt: see [pivots] */
#endif
#if defined RBD_NO_KINEMATICS && !defined RBD_NO_POINTS
#define RBD_NO_POINTS
#endif
#if defined RBD_BATCH_IMPLEMENTATION && (defined RBDI_NO_FD_CHOLESKY || defined RBD_NO_ABA)
#error "rbd: the batch calls need RBD_NO_RNEA, RBD_NO_CRBA, RBD_NO_ABA and RBD_NO_CHOLESKY undefined"
#endif

#define RBD_C(x) ((rbd_const)(x)) /* a literal as a constant of the model, without a warning */

#endif
