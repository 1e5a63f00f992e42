/* constraints.h - a table of constraints by the names of links. SPDX-License-Identifier: MIT */
#ifndef TOOLS_CONSTRAINTS_H
#define TOOLS_CONSTRAINTS_H

#include "rbd_constraints.h"

/* Reads the table and prepares the set: a row each with body1,x1,y1,z1,r1_0..r1_8,body2,x2,y2,z2,r2_0..r2_8,
   axes, in any order; links by name, 'world', rotations row by row, axes as six characters 0 or 1 in the
   order wx wy wz vx vy vz; kp and kd, if there are such columns.
   The caller frees list and memory, NULL or not. Returns how many there
   are, or -1 after a message. */
int constraints_read(const char *path, const rbd_model *m, rbd_work *w, rbd_constraint **list, void **memory,
                     rbd_constraints **c);

#endif
