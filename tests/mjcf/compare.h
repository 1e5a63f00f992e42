/* compare.h - rbd beside MuJoCo: random states of one mjModel by both. SPDX-License-Identifier: MIT */
#ifndef TESTS_MJCF_COMPARE_H
#define TESTS_MJCF_COMPARE_H

#include "rbd_mjcf.h"

/* The largest difference of each kind, relative to the largest entry of what is compared. */
typedef struct differences {
    double mass, bias, poses, kinetic, potential, coordinates;
    int nb, nq, nv, nconstraints, nwarnings;
    char reason[500]; /* why the robot is not loaded or built, "" if it is */
} differences;

/* Loads m by rbd_mjcf_convert and compares this many random states: mass matrix, bias forces, poses of all
   frames, energies. MuJoCo's springs, tendons and constraints do not count. */
differences compare(const struct mjModel_ *m, const rbd_mjcf_options *options, int states);

/* A loaded robot with memory of its own. */
typedef struct loaded {
    rbd_mjcf robot;
    const rbd_model *model;
    rbd_work *w;
    void *memory[8];
} loaded;

/* Counts, makes room, loads and builds; the finding is in robot.error, or the text in reason. */
int load_robot(loaded *to, const struct mjModel_ *m, const rbd_mjcf_options *options, char reason[500]);
void free_robot(loaded *r);

/* The matrix T of qvel = T v at qpos: rows of MuJoCo's dofs, columns of rbd's. */
void velocity_matrix(const loaded *r, const double *qpos, int rows, double *T);

/* A number between -1 and 1, and unit quaternions and numbers for all of qpos. */
double random_number(void);
void random_qpos(const struct mjModel_ *m, double *qpos);

#endif
