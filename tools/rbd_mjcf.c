/* The library rbd_mjcf: rbd_mjcf.h's functions for C programs. It has the checks of rbd.h inside, so that it
   links with a program whatever that one's scalar. SPDX-License-Identifier: MIT. */
#define RBD_STATIC
#define RBD_IMPLEMENTATION
#define RBD_MJCF_IMPLEMENTATION
#include "rbd_mjcf.h"
