/* pushed_quadruped.c - HyQ stands on four feet, its joints held by springs and dampers, and is pushed from
   the side for a tenth of a second: with 300 N, which it takes standing; then with 600 N. That lifts two
   feet, and the robot comes down on them again. */
#define RBD_IMPLEMENTATION
#include "rbd_contact.h"
#include "models/hyq_model.h"
#include "../larger.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { FEET = 4, LEG = HYQ_DOF_LF_HAA_JOINT, LEGS = HYQ_NV - LEG, STEPS = 3000, STEPS_PER_ROW = 250 };
static const double dt = 1e-3, kp = 1500, kd = 40; /* s, N m/rad, N m s/rad */
static const double stance[LEGS] = {0, 0, 0, 0, 0.7, 0.7, -0.7, -0.7, -1.4, -1.4, 1.4, 1.4}; /* rad */
static const char *const names[FEET] = {"lf", "rf", "lh", "rh"};

static unsigned char work_memory[HYQ_WORK_SIZE];
static rbd_work *w;
static double q[HYQ_NQ], v[HYQ_NV];

static void check(rbd_status status) {
    if (status == RBD_OK) return;
    fprintf(stderr, "%s\n", rbd_status_string(status));
    exit(EXIT_FAILURE);
}

/* Stands with its feet on the ground. */
static void start(const rbd_contact *foot) {
    double p[3];
    check(rbd_work_init(&hyq_model, work_memory, sizeof work_memory, &w));
    check(rbd_neutral(&hyq_model, q));
    for (int k = 0; k < LEGS; k++) q[HYQ_Q_LF_HAA_JOINT + k] = stance[k];
    check(rbd_kinematics(&hyq_model, w, q, NULL, NULL));
    check(rbd_point_position(&hyq_model, w, foot->body1, foot->point, p));
    q[HYQ_Q_ROOT_Z] = -p[2];
}

/* A push along the trunk's y axis, at its origin. */
static double push(double t) { return t >= 0.5 && t < 0.6 ? 300 : t >= 1.5 && t < 1.6 ? 600 : 0; }

int main(void) {
    rbd_contact foot[FEET];
    rbd_contact_set *c;
    double wrench[6 * HYQ_NB] = {0}, tau[HYQ_NV] = {0}, damping[HYQ_NV] = {0}, worst = 0, sum = 0;
    int fewest[2] = {FEET, FEET}; /* feet on the ground, around each push */
    for (int i = 0; i < FEET; i++)
        foot[i] = (rbd_contact){.name = names[i],
                                .body1 = HYQ_BODY_LF_LOWERLEG + i,
                                .body2 = -1,
                                .point = {0.33, 0, 0},
                                .friction = 0.7};
    start(foot);
    const size_t size = rbd_contact_set_size(&hyq_model, FEET, NULL, 0, NULL);
    void *memory = malloc(size);
    if (!memory) return EXIT_FAILURE;
    check(rbd_contact_set_init(&hyq_model, w, foot, FEET, NULL, 0, NULL, memory, size, &c, NULL));
    for (int k = 0; k < LEGS; k++) damping[LEG + k] = kd + dt * kp / 2; /* implicit: neutral */

    printf("   t   trunk y      z   force under each foot, N\n");
    for (int k = 0; k <= STEPS; k++) {
        const double t = k * dt;
        int down = 0;
        double force[FEET][3];
        for (int i = 0; i < LEGS; i++) tau[LEG + i] = kp * (stance[i] - q[HYQ_Q_LF_HAA_JOINT + i]);
        wrench[4] = push(t);
        check(rbd_contact_step(&hyq_model, c, q, v, tau, wrench, damping, dt, q, v));
        worst = larger(worst, rbd_contact_last(c).residual);
        for (int i = 0; i < FEET; i++) down += rbd_contact_get(c, i, NULL, force[i]) >= RBD_STICKS;
        if (t >= 0.4 && down < fewest[t >= 1.4]) fewest[t >= 1.4] = down;
        sum = force[0][2] + force[1][2] + force[2][2] + force[3][2];
        if (k % STEPS_PER_ROW == 0)
            printf("%.2f s  %5.2f  %5.2f   %4.0f %4.0f %4.0f %4.0f\n", t, q[HYQ_Q_ROOT_Y], q[HYQ_Q_ROOT_Z],
                   force[0][2], force[1][2], force[2][2], force[3][2]);
    }
    printf("feet on the ground, at least: first push %d, second %d\n", fewest[0], fewest[1]);
    printf("stands at the end, its weight on the ground: %s\n",
           fabs(sum - rbd_mass(&hyq_model) * 9.81) < 10 && q[HYQ_Q_ROOT_Z] > 0.5 ? "yes" : "no");
    printf("all steps solved: %s\n", worst <= 1e-6 ? "yes" : "no");
    free(memory);
    return EXIT_SUCCESS;
}
