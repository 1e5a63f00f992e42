/* The library rbd_urdf: rbd_urdf.h's functions for C programs. It has the checks of rbd.h inside, so that it
   links with a program whatever that one's scalar. SPDX-License-Identifier: MIT. */
#define RBD_STATIC
#define RBD_IMPLEMENTATION
#define RBD_URDF_IMPLEMENTATION
#include "rbd_urdf.h"
