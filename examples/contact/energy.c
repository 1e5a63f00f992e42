/* energy.c - how energy changes over time by steps of first and second order and by Runge and Kutta's method:
   of a box that tumbles in space, and of an arm that swings on a trunk, whose feet stick to the ground.
   Writes two tables to standard output: energy.gp draws them. */
#define RBD_IMPLEMENTATION
#include "rbd_contact.h"
#include "../larger.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_Q = 9, MOST_V = 8, FEET = 3 };

static const rbd_body box = {.parent = -1, .type = RBD_FLOATING, .mass = 1, .inertia = {1, 0, 0, 2, 0, 3}};

static const rbd_body trunk[3] = {
    {.parent = -1, .type = RBD_FLOATING, .mass = 20, .com = {0, 0, 0.1}, .inertia = {1, 0, 0, 1, 0, 1}},
    {.parent = 0,
     .type = RBD_REVOLUTE,
     .axis = {0.3, 1, 0},
     .position = {0, 0, 0.3},
     .mass = 1,
     .com = {0, 0, -0.2},
     .inertia = {0.02, 0, 0, 0.02, 0, 0.002}},
    {.parent = 1,
     .type = RBD_REVOLUTE,
     .axis = {0, 1, 0},
     .position = {0, 0, -0.4},
     .mass = 1,
     .com = {0, 0, -0.2},
     .inertia = {0.02, 0, 0, 0.02, 0, 0.002}}};

static const rbd_contact feet[FEET] = {
    {.body1 = 0, .body2 = -1, .point = {0.4, 0, 0}, .friction = 2},
    {.body1 = 0, .body2 = -1, .point = {-0.2, 0.35, 0}, .friction = 2},
    {.body1 = 0, .body2 = -1, .point = {-0.2, -0.35, 0}, .friction = 2},
};

static void check(rbd_status status) {
    if (status == RBD_OK) return;
    fprintf(stderr, "%s\n", rbd_status_string(status));
    exit(EXIT_FAILURE);
}

/* ---- a robot, and its energy ---- */

typedef struct robot {
    const rbd_model *m;
    rbd_work *w;
    rbd_contact_set *c;
    double q[MOST_Q], v[MOST_V], start;
    unsigned char model[RBD_MODEL_SIZE(3)], work[RBD_WORK_SIZE(3, MOST_V)],
        contacts[RBD_CONTACT_SET_SIZE(MOST_V, FEET, 0)];
} robot;

static double energy(robot *r) {
    double kinetic, potential;
    check(rbd_kinematics(r->m, r->w, r->q, r->v, NULL));
    check(rbd_energy(r->m, r->w, &kinetic, &potential));
    return kinetic + potential;
}

static void build(robot *r, const rbd_body *bodies, int n, const rbd_contact *list, int contacts,
                  int first_order) {
    const rbd_contact_options options = {.first_order = first_order};
    memset(r, 0, sizeof *r);
    check(rbd_model_build(bodies, n, r->model, sizeof r->model, &r->m, NULL));
    check(rbd_work_init(r->m, r->work, sizeof r->work, &r->w));
    check(rbd_contact_set_init(r->m, r->w, list, contacts, NULL, 0, &options, r->contacts, sizeof r->contacts,
                               &r->c, NULL));
    check(rbd_neutral(r->m, r->q));
}

/* A box that turns about the axis that is not stable, with 900 J. */
static void throw_box(robot *r, int first_order) {
    static const double none[3] = {0, 0, 0};
    build(r, &box, 1, NULL, 0, first_order);
    check(rbd_set_gravity(r->w, none));
    r->v[0] = 0.1, r->v[1] = 30, r->v[2] = 0.1;
    r->start = energy(r);
}

static void swing_arm(robot *r, int first_order) {
    build(r, trunk, 3, feet, FEET, first_order);
    r->q[7] = 1.2, r->q[8] = 0.5, r->v[6] = 2, r->v[7] = 3;
    r->start = energy(r);
}

/* ---- Runge and Kutta's method of order four ---- */

/* Rates of the box: of its place and quaternion, and of its velocity. */
static void rates(robot *r, const double *q, const double *v, double *q_rate, double *v_rate) {
    static const double none[6] = {0};
    const double *u = q + 3, x = u[0], y = u[1], z = u[2], s = u[3];
    double R[9];
    check(rbd_aba(r->m, r->w, q, v, none, NULL, v_rate));
    check(rbd_kinematics(r->m, r->w, q, v, NULL));
    check(rbd_body_pose(r->m, r->w, 0, R, q_rate));
    for (int i = 0; i < 3; i++) q_rate[i] = R[3 * i] * v[3] + R[3 * i + 1] * v[4] + R[3 * i + 2] * v[5];
    q_rate[3] = (s * v[0] + y * v[2] - z * v[1]) / 2;
    q_rate[4] = (s * v[1] + z * v[0] - x * v[2]) / 2;
    q_rate[5] = (s * v[2] + x * v[1] - y * v[0]) / 2;
    q_rate[6] = -(x * v[0] + y * v[1] + z * v[2]) / 2;
}

static void runge_kutta(robot *r, double dt) {
    static const double part[4] = {0, 0.5, 0.5, 1}, weight[4] = {1, 2, 2, 1};
    double q[7], v[6], dq[7] = {0}, dv[6] = {0}, q_sum[7] = {0}, v_sum[6] = {0};
    for (int stage = 0; stage < 4; stage++) {
        for (int k = 0; k < 7; k++) q[k] = r->q[k] + part[stage] * dt * dq[k];
        for (int k = 0; k < 6; k++) v[k] = r->v[k] + part[stage] * dt * dv[k];
        rates(r, q, v, dq, dv);
        for (int k = 0; k < 7; k++) q_sum[k] += weight[stage] * dq[k] / 6;
        for (int k = 0; k < 6; k++) v_sum[k] += weight[stage] * dv[k] / 6;
    }
    for (int k = 0; k < 7; k++) r->q[k] += dt * q_sum[k];
    for (int k = 0; k < 6; k++) r->v[k] += dt * v_sum[k];
}

/* ---- the tables ---- */

static void step(robot *r, double dt) {
    static const double none[MOST_V] = {0};
    check(rbd_contact_step(r->m, r->c, r->q, r->v, none, NULL, NULL, dt, r->q, r->v));
}

static double change(robot *r) { return energy(r) - r->start; }

/* 20 s by steps of 5 ms, in shares of the energy. Returns the largest change by steps of second order. */
static double print_box(void) {
    static robot first, runge, second;
    const double dt = 5e-3;
    double worst = 0;
    int lost = 0;
    throw_box(&first, 1), throw_box(&runge, 0), throw_box(&second, 0);
    puts("t s,first order,Runge-Kutta,second order");
    for (int k = 0; k <= 4000; k++) {
        lost = lost || !(fabs(change(&first)) < 3 * first.start);
        if (k % 10 == 0) {
            printf("%.2f,", k * dt);
            if (!lost) printf("%.9f", change(&first) / first.start);
            printf(",%.9f,%.9f\n", change(&runge) / runge.start, change(&second) / second.start);
        }
        worst = larger(worst, fabs(change(&second)) / second.start);
        if (!lost) step(&first, dt);
        runge_kutta(&runge, dt);
        step(&second, dt);
    }
    return worst;
}

/* 2 s by steps of 1 ms, in joules. */
static double print_arm(void) {
    static robot first, second;
    const double dt = 1e-3;
    double worst = 0;
    swing_arm(&first, 1), swing_arm(&second, 0);
    puts("t s,first order,second order");
    for (int k = 0; k <= 2000; k++) {
        if (k % 10 == 0) printf("%.2f,%.9f,%.9f\n", k * dt, change(&first), change(&second));
        worst = larger(worst, fabs(change(&second)));
        step(&first, dt);
        step(&second, dt);
    }
    return worst;
}

int main(void) {
    const double box_off = print_box();
    puts("\n");
    const double arm_off = print_arm();
    fprintf(stderr, "the box keeps 900 J to %.0f J in 20 s of steps of 5 ms\n", 900 * box_off);
    fprintf(stderr, "the arm on its trunk keeps its energy to %.1f mJ in 2 s of steps of 1 ms\n",
            1e3 * arm_off);
    return box_off < 1e-2 && arm_off < 2e-3 ? EXIT_SUCCESS : EXIT_FAILURE;
}
