/* library.c - what the figures are of: all that firmware calls. SPDX-License-Identifier: MIT */
#define RBD_IMPLEMENTATION
#include "rbd.h"
#include "rbd_derivatives.h"
#ifdef FIGURES_CONTACTS
#include "rbd_constraints.h"
#endif
