/* library.c - what the figures are of: all that firmware calls. SPDX-License-Identifier: MIT */
#define RBD_IMPLEMENTATION
#include "rbd.h"
#include "rbd_derivatives.h"
