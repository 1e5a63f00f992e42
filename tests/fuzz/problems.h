/* problems.h - the robots and constraints of the fuzzer of rbd_constraints.h. A problem is told by its class
   and its number: the same on every machine. */
#ifndef PROBLEMS_H
#define PROBLEMS_H

#include "rbd_constraints.h"

#include "robots.h"

enum {
    CONTACTS,  /* points, surfaces and other axes of bodies of any tree, held to the world */
    DEPENDENT, /* heel and toe: several points of one link, constraints twice */
    STANCES,   /* legs on their feet, knees 1e-1 to 1e-13 rad from straight */
    BRAKES,    /* legs on their feet, and rows between links of a leg, or of two */
    LOOPS,     /* balls, hinges and other axes between bodies of any tree */
    LOOPS_AND_CONTACTS,
    LIMBS,         /* several roots, constraints between legs, the world as either body */
    CONTRADICTORY, /* constraints twice, with other gains */
    FOLLOWING,     /* mimic joints, any constraints */
    ANY,           /* any robot, constraints of several of these kinds */
    STRETCHED,     /* as stances, legs like HyQ's and a human's alone, which lose rank when straight */
    PROBLEM_CLASSES
};
extern const char *const problem_names[PROBLEM_CLASSES];

enum { PROBLEM_CONSTRAINTS = 12, PROBLEM_ROWS = 48 };

enum { RESTING, NEARLY_RESTING, HELD, MOVING }; /* v = 0; 1e-17 or 0; as the constraints allow it; any */

typedef struct problem {
    sample robot;
    sample_state state; /* tau in N m */
    rbd_constraint list[PROBLEM_CONSTRAINTS];
    int n, rows;
    int motion;
    uint64_t seed; /* for what else is drawn */
} problem;

void draw_problem(problem *p, int class_number, int number);
int below(uint64_t *seed, int n);

void print_problem(const problem *p);

#endif
