/* The library rbd_mjcf as C++, where there is a compiler for it: exceptions of MuJoCo's are errors then.
   SPDX-License-Identifier: MIT. */
#include "rbd_mjcf.c"
