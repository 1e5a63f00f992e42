/* rbd.c - the library as a program has it: the implementation in one file. */
#define RBD_IMPLEMENTATION
#include "rbd_derivatives.h"
#include "rbd_constraints.h"
#include "rbd_contact.h"
#include "rbd_ik.h"
#include "rbd_estimate.h"
#include "rbd_actuator.h"
#include "rbd_qp.h"
#include "rbd_tasks.h"
