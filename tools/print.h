/* print.h - what rbd-model writes, all to standard output. SPDX-License-Identifier: MIT */
#ifndef TOOLS_PRINT_H
#define TOOLS_PRINT_H

#include "rbd_constraints.h"
#include "robot.h"

void print_summary(const robot *r);
void print_c(const robot *r, const char *name);         /* the description as a C table */
void print_c_model(const robot *r, const char *name);   /* the built model as a C table */
void print_c_indices(const robot *r, const char *name); /* what both begin with: sizes, and indices by name */
void print_c_constraints(const robot *r, const char *name, const rbd_constraint *list, int n);
void print_urdf(const robot *r);
void print_dot(const robot *r);

/* The shortest text that reads back as the same double, e.g. "-0.25"; -0 is written 0. */
enum { NUMBER_SIZE = 32 };
const char *number_text(double x, char text[NUMBER_SIZE]);

/* A string as in C, "..." or NULL; the same in upper case, bare; a name inside a comment. */
void print_c_string(const char *s);
void print_upper(const char *s);
void print_in_comment(const char *s);

/* Of a file's head: the file that it was written from, and the command if it is known. */
void print_origin(const robot *r, const char *writer);

/* The part of a path after the last slash. */
const char *file_name(const char *path);

/* Of a joint: "revolute", as URDF and the summary call it; "RBD_REVOLUTE", as C does. */
const char *joint_type_name(rbd_joint_type type);
const char *joint_type_constant(rbd_joint_type type);

/* Names of a joint's coordinates and degrees of freedom, added to its own name: "" if there is one. */
const char *const *coordinate_names(rbd_joint_type type);
const char *const *dof_names(rbd_joint_type type);

#endif
