#ifndef RBDI_API_PARTS_H
#define RBDI_API_PARTS_H
#include "api/configuration.h"

#if defined RBD_BATCH_IMPLEMENTATION && defined RBD_NO_CHOLESKY
#error "rbd: the batch calls need RBD_NO_CHOLESKY undefined"
#endif

#define RBD_C(x) ((rbd_const)(x)) /* a literal as a constant of the model, without a warning */

#endif
