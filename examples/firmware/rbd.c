/* rbd.c - the one file that holds the library. SPDX-License-Identifier: MIT */
#define RBD_IMPLEMENTATION
#include "rbd_derivatives.h"

#include "rbd_contact.h"

#include "rbd_ik.h"
#include "rbd_estimate.h"

#include "rbd_actuator.h"

#include "rbd_qp.h"

#include "rbd_tasks.h"
