/* constraints.h - tables of constraints and contacts by the names of links. SPDX-License-Identifier: MIT */
#ifndef TOOLS_CONSTRAINTS_H
#define TOOLS_CONSTRAINTS_H

#include "rbd_contact.h"
#include "robot.h"

/* Reads the table, docs/tools.md says how, or takes those of the robot's MJCF file, if that is the path; and
   prepares the set. The caller frees list and memory, NULL or not. Returns how many there are, or -1 after a
   message. */
int constraints_read(const char *path, const robot *r, rbd_work *w, rbd_constraint **list, void **memory,
                     rbd_constraint_set **c);

enum { ITEM_NAME = 64 }; /* bytes of a contact's name */

/* The same of contacts, with constraints that hold at the same time. name: of each, the cell or its number;
   the caller frees it and the memory, NULL or not. */
int contacts_read(const char *path, const robot *r, rbd_work *w, const rbd_constraint *held, int n_held,
                  char (**name)[ITEM_NAME], void **memory, rbd_contact_set **c);

#endif
