/* library.c - what the figures are of: all that firmware calls. SPDX-License-Identifier: MIT */
#define RBD_IMPLEMENTATION
#ifdef ROBOT_HEADER /* a library for one robot alone */
#define RBD_FEATURES ROBOT_FEATURES
#include ROBOT_HEADER
#endif
#include "rbd.h"
#include "rbd_derivatives.h"
#ifdef FIGURES_CONTACTS
#include "rbd_constraints.h"
#endif
#ifdef FIGURES_ESTIMATE
#include "rbd_estimate.h"
#endif
