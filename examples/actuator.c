/* actuator.c - an arm of two joints from a data sheet: what its motors hold, what friction hides, and how
   far it is off a plan with and without a table of them; by rbd_actuator.h.
   actuator curves: friction and limits of the shoulder's motor as a table, for actuator.gp. */
#define RBD_IMPLEMENTATION
#include "rbd_actuator.h"
#include "larger.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { N = 2 };

static const rbd_body arm[N] = {{.name = "upper arm",
                                 .joint = "shoulder",
                                 .parent = -1,
                                 .type = RBD_REVOLUTE,
                                 .axis = {0, 1, 0},
                                 .mass = 1.5,
                                 .com = {0.15, 0, 0},
                                 .inertia = {0.001, 0, 0, 0.012, 0, 0.012}},
                                {.name = "forearm",
                                 .joint = "elbow",
                                 .parent = 0,
                                 .type = RBD_REVOLUTE,
                                 .axis = {0, 1, 0},
                                 .position = {0.3, 0, 0},
                                 .mass = 0.8,
                                 .com = {0.12, 0, 0},
                                 .inertia = {0.0005, 0, 0, 0.006, 0, 0.006}}};

/* The data sheet: 0.05 N m/A, 0.6 ohm, rotor 1.2e-5 kg m^2, 24 V, 10 A; gears of 50 and 30 with an
   efficiency of 0.9. Measured: what moves the unloaded joints, slowly and fast. */
static const rbd_motor motors[N] = {
    {.name = "M1",
     .joint = "shoulder",
     .gear = 50,
     .constant = 0.05,
     .inertia = 1.2e-5,
     .resistance = 0.6,
     .voltage = 24,
     .current = 10,
     .friction =
         {.coulomb = 0.5, .viscous = 0.1, .load_motor = 0.1, .rest = 0.3, .speed = 0.2, .power = 1.5}},
    {.name = "M2",
     .joint = "elbow",
     .gear = 30,
     .constant = 0.05,
     .inertia = 1.2e-5,
     .resistance = 0.6,
     .voltage = 24,
     .current = 10,
     .friction = {
         .coulomb = 0.3, .viscous = 0.06, .load_motor = 0.1, .rest = 0.2, .speed = 0.2, .power = 1.5}}};

static unsigned char model_memory[RBD_MODEL_SIZE(N)], work_memory[RBD_WORK_SIZE(N, N)];
static unsigned char memory[2][RBD_ACTUATORS_SIZE(N, 0, 0)];
static const rbd_model *m;
static rbd_work *w;
static const double dt = 1e-3;

static void check(rbd_status status) {
    if (status != RBD_OK) exit((fprintf(stderr, "%s\n", rbd_status_string(status)), EXIT_FAILURE));
}

static rbd_actuators *make(const rbd_motor *table, int which) {
    rbd_report report;
    rbd_actuators *a;
    char text[200];
    if (rbd_actuators_init(m, table, N, NULL, 0, memory[which], sizeof memory[which], &a, &report) != RBD_OK)
        exit((fprintf(stderr, "%s\n", rbd_actuators_finding_text(&report.error, N, text, sizeof text)),
              EXIT_FAILURE));
    return a;
}

/* A step of the arm under motor torques. */
static void step(rbd_actuators *a, const rbd_command *commands, double *q, double *v) {
    double tau[N], damping[N], q_next[N], v_next[N];
    check(rbd_actuators_begin(a, commands, q, v, dt, 0, tau, damping));
    do check(rbd_free_step(m, w, q, v, tau, NULL, damping, dt, q_next, v_next));
    while (rbd_actuators_again(a, v_next, tau, damping));
    for (int k = 0; k < N; k++) q[k] = q_next[k], v[k] = v_next[k];
}

/* How far the arm sinks in a second if its motors give `share` of the gravity torque. */
static double sink(double share) {
    double q[N] = {0.3, -0.6}, v[N] = {0}, g[N];
    const double start = q[0];
    rbd_actuators *a = make(motors, 0);
    check(rbd_actuators_reset(a, q, 25));
    for (int k = 0; k < 1000; k++) {
        rbd_command commands[N] = {{0}};
        check(rbd_gravity_torque(m, w, q, g));
        for (int i = 0; i < N; i++) commands[i].torque = share * g[i];
        step(a, commands, q, v);
    }
    return fabs(q[0] - start);
}

/* How far the arm is off a plan after a second of feed-forward alone, by a controller with this table. */
static double follow(const rbd_motor *table) {
    double q[N] = {0.3, -0.6}, v[N] = {0}, off = 0;
    rbd_actuators *robot = make(motors, 0), *own = make(table, 1);
    check(rbd_actuators_reset(robot, q, 25));
    for (int k = 0; k < 1000; k++) {
        double plan[N], speed[N], acc[N], tau[N];
        rbd_command commands[N] = {{0}};
        rbd_drive drives[N];
        for (int i = 0; i < N; i++) {
            const double rate = 3 + i, t = (k + 0.5) * dt, size = i ? -0.4 : 0.3;
            plan[i] = (i ? -0.6 : 0.3) + size * (1 - cos(rate * t));
            speed[i] = size * rate * sin(rate * t), acc[i] = size * rate * rate * cos(rate * t);
        }
        check(rbd_rnea(m, w, plan, speed, acc, NULL, tau));
        check(rbd_actuators_inverse(own, plan, speed, acc, tau, drives));
        for (int i = 0; i < N; i++)
            commands[i].torque = drives[i].torque, off = larger(off, fabs(q[i] - plan[i]));
        step(robot, commands, q, v);
    }
    return off;
}

/* Columns: speed, friction without load and with 4 N m on the joint, the largest torque of the motor. */
static int curves(void) {
    rbd_actuators *a = make(motors, 0);
    const double zero[N] = {0}, q[N] = {0}, most[N] = {1000, 0};
    for (int k = 0; k <= 200; k++) {
        const double x = 0.05 * k, v[N] = {x, 0};
        rbd_drive drives[N];
        check(rbd_actuators_inverse(a, q, v, zero, most, drives));
        printf("%g,%g,%g,%g\n", x,
               rbd_friction_level(&motors[0].friction, x, 0, 0) + motors[0].friction.viscous * x,
               rbd_friction_level(&motors[0].friction, x, 5, -4) + motors[0].friction.viscous * x,
               drives[0].torque);
    }
    return EXIT_SUCCESS;
}

int main(int arguments, char **argument) {
    const double zero[N] = {0}, q[N] = {0};
    rbd_motor smooth[N];
    rbd_drive drives[N];
    double tau[N];
    check(rbd_model_build(arm, N, model_memory, sizeof model_memory, &m, NULL));
    check(rbd_work_init(m, work_memory, sizeof work_memory, &w));
    if (arguments > 1 && argument[1][0] == 'c') return curves();

    /* stretched out */
    check(rbd_gravity_torque(m, w, q, tau));
    check(rbd_actuators_inverse(make(motors, 0), q, zero, zero, tau, drives));
    printf("stretched out, at rest: %.2f and %.2f N m, %.2f and %.2f A\n", tau[0], tau[1], drives[0].current,
           drives[1].current);

    const double all = sink(1), most = sink(0.85), none = sink(0);
    printf(
        "in a second it sinks by %.3f rad with all of gravity compensated, %.3f with 85 %%, %.3f with none\n",
        all, most, none);

    for (int i = 0; i < N; i++) smooth[i] = motors[i], smooth[i].friction = (rbd_gear_friction){0};
    const double known = follow(motors), unknown = follow(smooth);
    printf("off the plan by %.3f rad with friction in the table, %.2f without\n", known, unknown);
    return all < 1e-6 && most < 1e-6 && none > 0.1 && known < 0.1 && unknown > 10 * known ? EXIT_SUCCESS
                                                                                          : EXIT_FAILURE;
}
