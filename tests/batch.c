/* batch.c - the batch calls as a program has them: in a file of their own, -DBATCH_LANES at a time. */
#define RBD_LANES BATCH_LANES
#define RBD_BATCH_IMPLEMENTATION
#include "rbd_derivatives.h"
#include "rbd_constraints.h"
#include "rbd_batch.h"
