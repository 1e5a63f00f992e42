/* constraints.h - a table of constraints by the names of links. SPDX-License-Identifier: MIT */
#ifndef TOOLS_CONSTRAINTS_H
#define TOOLS_CONSTRAINTS_H

#include "rbd_constraints.h"
#include "robot.h"

/* Reads the table, docs/tools.md says how, and prepares the set. The caller frees list and memory, NULL or
   not. Returns how many there are, or -1 after a message. */
int constraints_read(const char *path, const robot *r, rbd_work *w, rbd_constraint **list, void **memory,
                     rbd_constraint_set **c);

#endif
