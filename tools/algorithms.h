/* algorithms.h - what rbd-eval can evaluate, and what the columns are called. SPDX-License-Identifier: MIT */
#ifndef TOOLS_ALGORITHMS_H
#define TOOLS_ALGORITHMS_H

#include "constraints.h"
#include "nearest.h"
#include "print.h"

#include "rbd_derivatives.h"

/* A state, and what a call needs. */
typedef struct state {
    const rbd_model *m;
    rbd_work *w;
    rbd_derivatives *d;
    rbd_constraint_set *c; /* NULL: none given */
    rbd_contact_set *contacts;
    char (*contact_name)[ITEM_NAME]; /* ncontacts */
    int ncontacts;
    double dt;
    double *q, *v, *a, *tau;
    void *memory; /* of w, d and given */
    int body;     /* where the algorithm is one of a point */
    double point[3];
    unsigned char *given; /* dofs whose acceleration hybrid dynamics takes */
} state;

/* Meaning of the rows or columns of an output: none, x y z, a motion or force, coordinates, degrees of
   freedom, inertial parameters of the links, wrenches, poses, the axes that constraints hold, contacts. */
typedef enum axis { ONE, XYZ, SIX, COORDINATES, DOFS, PARAMETERS, WRENCHES, POSES, HELD, TOUCHES } axis;

typedef struct output {
    const char *name; /* NULL: no more */
    axis rows, columns;
} output;

enum {
    TAKES_V = 1,
    TAKES_A = 2,
    TAKES_TAU = 4,
    TAKES_POINT = 8,
    TAKES_GIVEN = 16,
    TAKES_CONSTRAINTS = 32,
    TAKES_CONTACTS = 64,
    NO_MASS = 128 /* kinematics alone: of a robot without masses too */
}; /* beside q */

typedef struct algorithm {
    const char *name, *what;
    int takes;
    output gives[5];
    rbd_status (*run)(const state *s, double *out);
} algorithm;

/* The algorithm of this name, or NULL; all of them with what they take and give, to standard output. */
const algorithm *find_algorithm(const char *name);
void print_algorithms(void);
void see_algorithms(nearest *n); /* all their names */

/* Names of columns. Zeroed before the first is added. */
typedef struct columns {
    char **name;
    int n, max;
} columns;

void free_columns(columns *c);
void add_inputs(columns *c, const rbd_model *m, const algorithm *a);
void add_outputs(columns *c, const state *s, const algorithm *a);
/* Names of the degrees of freedom, with "a." before, or what else is given; "" for the bare names. */
void add_dofs(columns *c, const rbd_model *m, const char *before);

/* Marks the degree of freedom of this name, or all those of the joint of this name. Returns 0, or -1 if there
   is none. */
int mark_dofs(const rbd_model *m, const char *name, unsigned char *marks);

#endif
