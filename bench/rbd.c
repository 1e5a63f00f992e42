/* The library, compiled as a program does that calls it from other files: without inlining into the
   bench's loops. SPDX-License-Identifier: MIT */
#define RBD_IMPLEMENTATION
#include "rbd.h"
