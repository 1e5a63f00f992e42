/* test_actuator.c - motors, friction, springs and transmissions: known answers, identities, other
   descriptions of the same mechanism, energy, bad input. */
#include <float.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "rbd_actuator.h"
#include "rbd_constraints.h"
#include "rbd_contact.h"

#include "models/hyq.h"
#include "models/iiwa.h"
#include "servos.h"
#include "suites.h"
#include "support.h"

enum { MOST = 16 };

static const double pi = 3.14159265358979323846;
static const double steps[3] = {5e-4, 1e-3, 1e-2};

/* ---- robots with motors ---- */

/* A robot with its actuators and, to step it, a contact set. */
typedef struct driven {
    robot r;
    rbd_actuators *a;
    rbd_contact_set *c;
    void *memory[2];
    double q[MAX_Q], v[MAX_V], tau[MAX_V], damping[MAX_V], other[MAX_V];
    rbd_command command[MOST];
    int first_order;
    int repeats, unsettled; /* of all steps */
} driven;

static rbd_status init(const robot *r, const rbd_motor *motors, int n, const rbd_transmission *t, int groups,
                       rbd_actuators **a, void **memory, rbd_report *report) {
    const size_t size = rbd_actuators_size(n, groups, 1000);
    *memory = malloc(size);
    return rbd_actuators_init(r->m, motors, n, t, groups, *memory, size, a, report);
}

static driven drive(const char *name, const rbd_body *bodies, int nb, const rbd_motor *motors, int n,
                    const rbd_transmission *t, int groups, const rbd_contact *contacts, int n_contacts,
                    const rbd_contact_options *options) {
    driven d;
    rbd_report report;
    char text[200];
    memset(&d, 0, sizeof d);
    d.r = robot_build(name, bodies, nb);
    ck_assert_msg(init(&d.r, motors, n, t, groups, &d.a, &d.memory[0], &report) == RBD_OK, "%s",
                  rbd_actuators_finding_text(&report.error, n, text, sizeof text));
    const size_t size = rbd_contact_set_size(d.r.m, n_contacts, NULL, 0, options);
    d.memory[1] = malloc(size);
    ck_assert_int_eq(rbd_contact_set_init(d.r.m, d.r.w, contacts, n_contacts, NULL, 0, options, d.memory[1],
                                          size, &d.c, NULL),
                     RBD_OK);
    d.first_order = options && options->first_order;
    rbd_neutral(d.r.m, d.q);
    return d;
}

static void drive_free(driven *d) {
    robot_free(&d->r);
    free(d->memory[0]);
    free(d->memory[1]);
}

/* One step. `other`: further joint torques. */
static void step(driven *d, double dt) {
    double q[MAX_Q], v[MAX_V];
    rbd_actuator_state state;
    int again;
    ck_assert_int_eq(
        rbd_actuators_begin(d->a, d->command, d->q, d->v, dt, d->first_order, d->tau, d->damping), RBD_OK);
    do {
        double tau[MAX_V];
        for (int k = 0; k < d->r.nv; k++) tau[k] = d->tau[k] + d->other[k];
        ck_assert_int_eq(rbd_contact_step(d->r.m, d->c, d->q, d->v, tau, NULL, d->damping, dt, q, v), RBD_OK);
        again = rbd_actuators_again(d->a, v, d->tau, d->damping);
    } while (again);
    ck_assert_int_eq(rbd_actuators_get(d->a, 0, &state), RBD_OK);
    d->repeats += state.repeats;
    d->unsettled += state.repeats >= 50;
    memcpy(d->q, q, sizeof q);
    memcpy(d->v, v, sizeof v);
}

/* One body on a joint about z, or along x, in no gravity's way. */
static const rbd_body wheel[1] = {{.name = "wheel",
                                   .joint = "axle",
                                   .parent = -1,
                                   .type = RBD_REVOLUTE,
                                   .axis = {0, 0, 1},
                                   .mass = 1,
                                   .inertia = {0.1, 0, 0, 0.1, 0, 0.1}}};

static const rbd_contact_options first_order = {.first_order = 1};

static driven drive_wheel(const rbd_motor *motor) {
    return drive("wheel", wheel, 1, motor, 1, NULL, 0, NULL, 0, NULL);
}

static driven drive_wheel_with(const rbd_motor *motor, const rbd_contact_options *options) {
    return drive("wheel", wheel, 1, motor, 1, NULL, 0, NULL, 0, options);
}

static const double bent[7] = {0, 0.7, 0.2, -1, 0.3, 0.6, 0};

static const char *const iiwa_joints[7] = {"lbr_iiwa_joint_1", "lbr_iiwa_joint_2", "lbr_iiwa_joint_3",
                                           "lbr_iiwa_joint_4", "lbr_iiwa_joint_5", "lbr_iiwa_joint_6",
                                           "lbr_iiwa_joint_7"};

/* ---- friction ---- */

/* What BAM's paper gives as its sixth model, by libm. */
static double published(const rbd_gear_friction *f, double x, double t_m, double t_x) {
    const int opposed = (t_x > 0) - (t_x < 0) != (t_m > 0) - (t_m < 0);
    const double S = exp(-pow(fabs(x / f->speed), f->power));
    double rest = f->rest + fabs(f->rest_joint * t_x - f->rest_motor * t_m);
    if (opposed && fabs(t_x) < fabs(t_m)) rest += f->square_joint * t_x * t_x;
    if (opposed && fabs(t_x) > fabs(t_m)) rest += f->square_motor * t_m * t_m;
    return f->coulomb + fabs(f->load_joint * t_x - f->load_motor * t_m) + S * rest;
}

START_TEST(friction_of_seven_servos_is_the_published_formula) {
    const rbd_gear_friction *f = &servos[_i].friction;
    for (int i = -20; i <= 20; i++)
        for (int j = -20; j <= 20; j++)
            for (int k = -20; k <= 20; k++) {
                const double x = 0.3 * i * fabs(0.1 * i), t_m = 0.4 * j, t_x = 0.35 * k;
                const double expected = published(f, x, t_m, t_x);
                ck_assert_msg(fabs(rbd_friction_level(f, x, t_m, t_x) - expected) <= 1e-14 * (1 + expected),
                              "%s at %g rad/s, %g and %g N m: %.17g, not %.17g", servos[_i].name, x, t_m, t_x,
                              rbd_friction_level(f, x, t_m, t_x), expected);
            }
}
END_TEST

/* With fewer fields: Coulomb alone, and the same load on both sides. */
START_TEST(simpler_laws_of_friction_are_special_cases) {
    const rbd_gear_friction one = {.coulomb = 0.3, .viscous = 2},
                            three = {.coulomb = 0.3, .load_motor = 0.2, .load_joint = 0.2};
    ck_assert(rbd_friction_level(&one, 3, 10, -4) == 0.3);
    ck_assert(fabs(rbd_friction_level(&three, 3, 10, -4) - (0.3 + 0.2 * 14)) < 1e-15);
    ck_assert(rbd_friction_level(NULL, 1, 1, 1) == 0);

    /* the squares where one torque is the larger one, and neither is */
    const rbd_gear_friction six = {.square_motor = 0.1, .square_joint = 0.2, .speed = 1, .power = 1};
    ck_assert(rbd_friction_level(&six, 0, 2, -2) == 0);
    ck_assert(fabs(rbd_friction_level(&six, 0, 2, -3) - 0.4) < 1e-15);
    ck_assert(fabs(rbd_friction_level(&six, 0, 2, -1) - 0.2) < 1e-15);
    ck_assert(rbd_friction_level(&six, 0, 2, 3) == 0);
}
END_TEST

/* An iiwa in a bent posture, which friction of `share` of each gravity torque holds or not. */
static double slides(double share, double bristle, double dt) {
    rbd_body bodies[7];
    rbd_motor motors[7];
    double g[7], moved = 0;
    memcpy(bodies, iiwa_bodies, sizeof bodies);
    memset(motors, 0, sizeof motors);
    robot r = robot_build("iiwa", bodies, 7);
    ck_assert_int_eq(rbd_gravity_torque(r.m, r.w, bent, g), RBD_OK);
    robot_free(&r);
    for (int i = 0; i < 7; i++) {
        motors[i] = (rbd_motor){.joint = iiwa_joints[i], .gear = 1, .constant = 1};
        motors[i].friction.coulomb = fabs(g[i]) * (i == 1 ? share : 1 + 1e-9) + (i % 6 == 0 ? 0.1 : 0);
        motors[i].friction.bristle = bristle;
    }
    driven d = drive("iiwa", bodies, 7, motors, 7, NULL, 0, NULL, 0, NULL);
    memcpy(d.q, bent, sizeof bent);
    for (int k = 0; k < (int)(2 / dt); k++) step(&d, dt);
    for (int i = 0; i < 7; i++) moved = larger(moved, fabs(d.q[i] - bent[i]));
    ck_assert_int_eq(d.unsettled, 0);
    drive_free(&d);
    return moved;
}

START_TEST(friction_holds_up_to_its_level_and_not_beyond) {
    ck_assert(slides(1 + 1e-9, 0, steps[_i]) < 5e-9);
    ck_assert(slides(0.99, 0, steps[_i]) > 0.05);
}
END_TEST

/* A bristle gives way by load / stiffness and no more. */
START_TEST(a_bristle_gives_way_and_does_not_drift) {
    const rbd_motor motor = {
        .joint = "axle", .gear = 1, .constant = 1, .friction = {.coulomb = 1, .bristle = 1e4}};
    const double dt = steps[_i];
    driven d = drive_wheel(&motor);
    double at_1 = 0, at_9 = 0;
    const int n = (int)(10 / dt);
    for (int k = 0; k < n; k++) {
        d.other[0] = 0.3 + 0.3 * sin(10 * pi * k * dt);
        step(&d, dt);
        if (k == n / 10 - 1) at_1 = d.q[0];
        if (k == 9 * n / 10 - 1) at_9 = d.q[0];
    }
    ck_assert(fabs(at_9 - at_1) < 1e-9);
    ck_assert(at_9 < 0.6e-4 && at_9 > 0);
    d.other[0] = 0.5;
    for (int k = 0; k < n; k++) step(&d, dt);
    ck_assert(fabs(d.q[0] - 0.5e-4) < 1e-9);
    drive_free(&d);
}
END_TEST

/* Sliding and sticking as the rows of rbd_contact_step do it, but for the creep. */
START_TEST(dry_friction_is_that_of_the_contact_step) {
    rbd_body bodies[7];
    rbd_motor motors[7];
    memcpy(bodies, iiwa_bodies, sizeof bodies);
    for (int i = 0; i < 7; i++) {
        motors[i] = (rbd_motor){.joint = iiwa_joints[i], .gear = 1, .constant = 1};
        motors[i].friction.coulomb = 4 - 0.5 * i;
        bodies[i].friction[0] = 0;
    }
    driven d = drive("iiwa", bodies, 7, motors, 7, NULL, 0, NULL, 0, &first_order);
    for (int i = 0; i < 7; i++) bodies[i].friction[0] = 4 - 0.5 * i;
    const rbd_contact_options rows = {
        .first_order = 1, .joint_friction = 1, .tolerance = 1e-13, .iterations = 200};
    const rbd_motor none = {.joint = iiwa_joints[0], .gear = 1, .constant = 1};
    driven e = drive("iiwa", bodies, 7, &none, 1, NULL, 0, NULL, 0, &rows);
    const double v[7] = {0.5, 0, -0.4, 0, 0.3, 0, 1};
    memcpy(d.q, bent, sizeof bent), memcpy(e.q, bent, sizeof bent);
    memcpy(d.v, v, sizeof v), memcpy(e.v, v, sizeof v);
    for (int k = 0; k < 1000; k++) {
        step(&d, 1e-3), step(&e, 1e-3);
        for (int i = 0; i < 7; i++) {
            ck_assert(fabs(d.q[i] - e.q[i]) < 1e-8);
            ck_assert(fabs(d.v[i] - e.v[i]) < 2e-7);
        }
    }
    ck_assert_int_eq(d.unsettled, 0);
    drive_free(&d), drive_free(&e);
}
END_TEST

/* ---- friction as rows of the contact step ----
   Motors without dry friction in their table; its level goes to the step. */

/* Motor torques carry half of an iiwa, friction of `share` of what it needs the other half, by
   rbd_contact_friction. How far it moves. */
static double slides_by_rows(double share, double dt) {
    const rbd_contact_options rows = {.joint_friction = 1, .tolerance = 1e-13, .iterations = 200};
    rbd_body bodies[7];
    rbd_motor motors[7];
    rbd_gear_friction friction[7] = {{0}};
    double g[7], moved = 0;
    memcpy(bodies, iiwa_bodies, sizeof bodies);
    for (int i = 0; i < 7; i++) {
        motors[i] = (rbd_motor){.joint = iiwa_joints[i], .gear = 1, .constant = 1};
        bodies[i].friction[0] = 1;
    }
    driven d = drive("iiwa", bodies, 7, motors, 7, NULL, 0, NULL, 0, &rows);
    memcpy(d.q, bent, sizeof bent);
    ck_assert_int_eq(rbd_gravity_torque(d.r.m, d.r.w, d.q, g), RBD_OK);
    for (int i = 0; i < 7; i++) {
        friction[i].load_joint = friction[i].load_motor = 0.2; /* 0.2 |g + g/2| */
        friction[i].coulomb = fabs(0.2 * g[i]) * (i == 1 ? share : 1 + 1e-9) + (i % 6 == 0 ? 0.1 : 0);
        d.command[i].torque = g[i] / 2;
    }

    for (int k = 0; k < (int)(2 / dt); k++) {
        ck_assert_int_eq(rbd_gravity_torque(d.r.m, d.r.w, d.q, g), RBD_OK);
        for (int i = 0; i < 7; i++) {
            const double level = rbd_friction_level(&friction[i], d.v[i], d.command[i].torque, -g[i]);
            ck_assert_int_eq(rbd_contact_friction(d.r.m, d.c, i, level), RBD_OK);
        }
        step(&d, dt);
    }
    for (int i = 0; i < 7; i++) moved = larger(moved, fabs(d.q[i] - bent[i]));
    drive_free(&d);
    return moved;
}

/* A thousandth of the creep of the actuators' own law, at most. */
START_TEST(friction_as_rows_holds_without_creep) {
    ck_assert(slides_by_rows(1 + 1e-9, steps[_i]) < 1e-12);
    ck_assert(slides_by_rows(0.95, steps[_i]) > 0.01);
}
END_TEST

/* One step of the robot d, whose n shafts turn by G v and have the level of `friction` in rows. load: torque
   of the joint on each shaft in the last step; receives that of this one. */
static void step_by_rows(driven *d, const rbd_gear_friction *friction, const double *G, int n, double *load,
                         double dt) {
    rbd_actuator_state s;
    double f, speed[7];
    ck_assert_int_eq(rbd_actuators_map(d->a, d->q, d->v, NULL, speed), RBD_OK);
    for (int i = 0; i < n; i++) {
        rbd_contact_row row = {.dofs = 0};
        ck_assert_int_eq(rbd_actuators_get(d->a, i, &s), RBD_OK);
        row.upper = rbd_friction_level(&friction[i], speed[i], s.motor, load[i]);
        row.lower = -row.upper;
        for (int j = 0; j < n; j++) {
            if (!(fabs(G[n * i + j]) > 0)) continue;
            row.dof[row.dofs] = j;
            row.jacobian[row.dofs++] = G[n * i + j];
        }
        ck_assert_int_eq(rbd_contact_row_set(d->r.m, d->c, i, &row), RBD_OK);
    }
    step(d, dt);
    for (int i = 0; i < n; i++) {
        ck_assert_int_eq(rbd_actuators_get(d->a, i, &s), RBD_OK);
        rbd_contact_row_get(d->c, i, &f);
        load[i] = -(s.joint + f);
    }
}

/* How far an iiwa that slides, sticks and turns back under loads is off, in a second, if its friction is in
   rows. */
static double difference_by_rows(double dt) {
    const rbd_contact_options rows = {.rows = 7, .tolerance = 1e-13, .iterations = 200};
    rbd_motor motors[7], without[7];
    rbd_gear_friction friction[7];
    double load[7] = {0}, G[49] = {0}, most = 0, moved = 0;
    int stuck = 0;
    for (int i = 0; i < 7; i++) {
        friction[i] = (rbd_gear_friction){.coulomb = 1 - 0.1 * i,
                                          .viscous = 0.4,
                                          .load_motor = 0.1,
                                          .load_joint = 0.15,
                                          .rest = 0.3,
                                          .rest_joint = 0.05,
                                          .speed = 0.2,
                                          .power = 1.5};
        motors[i] = (rbd_motor){.joint = iiwa_joints[i], .gear = 1, .constant = 1, .friction = friction[i]};
        without[i] = motors[i];
        without[i].friction = (rbd_gear_friction){.viscous = friction[i].viscous};
        G[8 * i] = 1;
    }
    driven d = drive("iiwa", iiwa_bodies, 7, motors, 7, NULL, 0, NULL, 0, NULL);
    driven e = drive("iiwa", iiwa_bodies, 7, without, 7, NULL, 0, NULL, 0, &rows);
    memcpy(d.q, bent, sizeof bent), memcpy(e.q, bent, sizeof bent);
    for (int k = 0; k * dt < 1; k++) {
        for (int i = 0; i < 7; i++)
            d.command[i] = (rbd_command){.q = bent[i] + 0.3 * sin(3 * k * dt + i), .kp = 200, .kd = 10};
        memcpy(e.command, d.command, sizeof d.command);
        step(&d, dt);
        step_by_rows(&e, friction, G, 7, load, dt);
        for (int i = 0; i < 7; i++) {
            most = larger(most, fabs(d.q[i] - e.q[i]));
            moved = larger(moved, fabs(d.q[i] - bent[i]));
            stuck += fabs(e.v[i]) < 1e-8;
        }
    }
    ck_assert(moved > 0.2);
    ck_assert_int_gt(stuck, 50);
    drive_free(&d), drive_free(&e);
    return most;
}

/* In steps in which a row turns around too. They differ by the creep, and where friction turns a shaft back,
   which the actuators do within a thousandth of its speed. */
START_TEST(friction_as_rows_is_that_of_the_actuators) {
    const double coarse = difference_by_rows(1e-3), fine = difference_by_rows(2e-4);
    ck_assert_msg(coarse < 5e-6 && fine < 5e-8, "%g rad, %g rad", coarse, fine);
}
END_TEST

/* Half of the level is held still after the first step, whatever the step is; friction takes energy
   always. */
START_TEST(what_sticks_does_not_chatter) {
    const rbd_motor motor = {
        .joint = "axle",
        .gear = 1,
        .constant = 1,
        .friction = {.coulomb = 0.6, .rest = 0.4, .speed = 0.1, .power = 2, .viscous = 0.01}};
    driven d = drive_wheel(&motor);
    d.v[0] = 0.01, d.other[0] = 0.3;
    for (int k = 0; k < 2000; k++) {
        step(&d, steps[_i]);
        if (k > 1000) ck_assert(fabs(d.v[0]) < 1e-9);
    }

    /* a spring pulls it along: it sticks and slips again and again */
    int slips = 0;
    memset(d.q, 0, sizeof d.q), memset(d.v, 0, sizeof d.v);
    ck_assert_int_eq(rbd_actuators_reset(d.a, d.q, 25), RBD_OK);
    for (int k = 0; k * steps[_i] < 20; k++) {
        const double before = d.v[0];
        rbd_actuator_state s;
        d.other[0] = 5 * (0.3 * k * steps[_i] - d.q[0]);
        step(&d, steps[_i]);
        ck_assert_int_eq(rbd_actuators_get(d.a, 0, &s), RBD_OK);
        ck_assert(s.joint * d.v[0] <= 0); /* without a motor all of it is friction's */
        slips += fabs(before) < 1e-8 && d.v[0] > 1e-8;
    }
    ck_assert_int_ge(slips, 10);
    ck_assert_int_le(slips, 30);
    drive_free(&d);
}
END_TEST

/* Friction that would stop a wheel in a small part of a step is a piece of the law that is 1e-9 rad/s wide,
   on a way of a million: it is found, and the wheel stops and stays. */
START_TEST(friction_stops_a_fast_shaft_within_a_step) {
    uint64_t seed = 11;
    for (int k = 0; k < 300; k++) {
        const double dt = steps[k % 3], before = pow(10, uniform(&seed, 3, 5));
        const rbd_motor motor = {.joint = "axle",
                                 .gear = 1,
                                 .constant = 1,
                                 .friction = {.coulomb = uniform(&seed, 2.1, 20) * before * 0.1 / dt}};
        driven d = drive_wheel(&motor);
        d.v[0] = k % 2 ? before : -before;
        for (int i = 0; i < 3; i++) step(&d, dt);
        ck_assert_int_eq(d.unsettled, 0);
        ck_assert_msg(fabs(d.v[0]) <= 1e-14 * before + 1e-9, "%g of %g rad/s are left", d.v[0], before);
        drive_free(&d);
    }
}
END_TEST

/* In a step of second order the work of a torque is that at the mean speed. A wheel under a constant load
   turns around in many of these steps: its friction takes energy or keeps it, is within its level and, if the
   shaft goes on, all of the level. A wheel on a spring, of the same steps, never gains. */
START_TEST(friction_takes_energy_where_a_shaft_turns_around) {
    uint64_t seed = 5;
    int turned = 0, coasted = 0;
    for (int k = 0; k < 2000; k++) {
        const double dt = steps[k % 3], F = pow(10, uniform(&seed, -2, 1)), load = uniform(&seed, -20, 20);
        const double D = below(&seed, 2) ? pow(10, uniform(&seed, -2, 1)) : 0;
        const rbd_motor motor = {
            .joint = "axle", .gear = 1, .constant = 1, .friction = {.coulomb = F, .viscous = D}};
        driven d = drive_wheel(&motor);
        rbd_actuator_state s;
        const double before = d.v[0] = uniform(&seed, -1, 1) * (F + 20) * dt / 0.1;
        d.other[0] = load;
        step(&d, dt);
        ck_assert_int_eq(rbd_actuators_get(d.a, 0, &s), RBD_OK);
        const double x = d.v[0], mean = (before + x) / 2, rounding = 1e-13 * (F + fabs(load) + D * fabs(x));
        ck_assert_msg(s.joint * mean <= rounding * fabs(mean), "%g N m at the mean speed %g", s.joint, mean);
        ck_assert(fabs(s.joint) <= F + D * fabs(x) + rounding);
        if (fabs(x) > 1e-8)
            ck_assert(fabs(0.1 * (x - before) - dt * (load + s.joint)) <
                      1e-14 * fabs(before) + 10 * dt * rounding);
        if (before * x > 0 && fabs(x) > 1e-8) ck_assert(fabs(s.joint + copysign(F, x) + D * x) <= rounding);
        turned += before * x < 0;
        coasted += before * x < 0 && fabs(s.joint) < rounding;
        drive_free(&d);
    }
    ck_assert_int_gt(turned, 200);
    ck_assert_int_gt(coasted, 50);

    for (int k = 0; k < 60; k++) {
        const double dt = steps[k % 3], stiffness = pow(10, uniform(&seed, 1, 4));
        const rbd_motor motor = {.joint = "axle",
                                 .gear = 1,
                                 .constant = 1,
                                 .friction = {.coulomb = k % 2 ? pow(10, uniform(&seed, -2, 0)) : 0,
                                              .viscous = pow(10, uniform(&seed, -2, 1))}};
        driven d = drive_wheel(&motor);
        d.v[0] = uniform(&seed, 0.5, 3);
        d.command[0].kp = stiffness; /* a spring to 0 */
        double last = 0.05 * d.v[0] * d.v[0];
        const double first = last;
        for (int n = 0; n < 300; n++) {
            step(&d, dt);
            const double energy = 0.05 * d.v[0] * d.v[0] + stiffness / 2 * d.q[0] * d.q[0];
            ck_assert_msg(energy <= last + 1e-14 * first, "%g J of %g in step %d", energy - last, first, n);
            last = energy;
        }
        drive_free(&d);
    }
}
END_TEST

/* ---- motor and drive ---- */

START_TEST(a_motor_has_its_torque_speed_line) {
    const rbd_motor motor = {
        .joint = "axle", .gear = 50, .constant = 0.03, .resistance = 0.6, .voltage = 24, .current = 15};
    const double expected[5] = {22.5, 22.5, 22.5, 15, 0};
    driven d = drive_wheel(&motor);
    d.command[0].torque = 1000;
    for (int sign = -1; sign <= 1; sign += 2)
        for (int k = 0; k < 5; k++) {
            d.command[0].torque = 1000 * sign;
            d.v[0] = 4 * k * sign;
            ck_assert_int_eq(rbd_actuators_begin(d.a, d.command, d.q, d.v, 1e-3, 0, d.tau, d.damping),
                             RBD_OK);
            ck_assert(fabs(d.tau[0] - d.damping[0] * d.v[0] - sign * expected[k]) < 1e-12);
        }
    drive_free(&d);
}
END_TEST

/* The inverse obeys the same limits: 22.5 N m, 15 A; braking takes a lower voltage. */
START_TEST(the_inverse_says_where_a_limit_cuts) {
    const rbd_motor motor = {
        .joint = "axle", .gear = -50, .constant = 0.03, .resistance = 0.6, .voltage = 24, .current = 15};
    const double asked[4] = {30, -30, 20, 20}, speed[4] = {4, 4, 12, -12};
    const double torque[4] = {22.5, -22.5, 15, 20}, current[4] = {-15, 15, -10, -20 / 1.5};
    const int saturated[4] = {1, -1, 1, 0};
    driven d = drive_wheel(&motor);
    for (int k = 0; k < 4; k++) {
        const double zero[1] = {0};
        rbd_drive o;
        ck_assert_int_eq(rbd_actuators_inverse(d.a, d.q, &speed[k], zero, &asked[k], &o), RBD_OK);
        ck_assert(fabs(o.torque - torque[k]) < 1e-12);
        ck_assert(fabs(o.current - current[k]) < 1e-12);
        ck_assert(fabs(o.voltage - (0.6 * current[k] - 1.5 * speed[k])) < 1e-12);
        ck_assert_int_eq(o.saturated, saturated[k]);
    }
    drive_free(&d);
}
END_TEST

/* A light wheel at the limit of the voltage runs up to V / (gear constant), and not beyond, in long steps. */
START_TEST(a_light_wheel_ends_at_the_speed_without_load) {
    const rbd_motor motor = {.joint = "axle", .gear = 50, .constant = 0.03, .resistance = 0.6, .voltage = 24};
    rbd_body light[1];
    memcpy(light, wheel, sizeof light);
    light[0].inertia[5] = 0.002;
    driven d = drive("light wheel", light, 1, &motor, 1, NULL, 0, NULL, 0, NULL);
    d.command[0].torque = 1000;
    for (int k = 0; k < 200; k++) {
        step(&d, 1e-2);
        ck_assert(d.v[0] <= 16 + 1e-12);
    }
    ck_assert(fabs(d.v[0] - 16) < 1e-12);
    drive_free(&d);
}
END_TEST

/* 4 A through 0.5 ohm are 8 W, over 1.5 and 3 K/W: 25 + 36 and 25 + 24 degrees. With copper, 25 + 36 / (1
   - 0.0039 36). One node: 25 + 12. */
START_TEST(temperatures_are_those_of_the_network) {
    rbd_motor motor = {.joint = "axle",
                       .gear = 1,
                       .constant = 1,
                       .resistance = 0.5,
                       .heat_winding = 20,
                       .heat_case = 300,
                       .flow_winding = 1.5,
                       .flow_case = 3};
    const double winding[3] = {61, 25 + 36 / (1 - 0.0039 * 36), 37}, housing[3] = {49, 0, 25};
    rbd_body heavy[1];
    memcpy(heavy, wheel, sizeof heavy);
    heavy[0].inertia[5] = 1e12;
    motor.copper = _i == 1 ? 0.0039 : 0;
    motor.heat_case = _i == 2 ? 0 : 300;
    motor.flow_case = _i == 2 ? 0 : 3;
    driven d = drive("heavy wheel", heavy, 1, &motor, 1, NULL, 0, NULL, 0, NULL);
    rbd_actuator_state s;
    d.command[0].torque = 4;
    for (int k = 0; k < 4000; k++) step(&d, 5);
    ck_assert_int_eq(rbd_actuators_get(d.a, 0, &s), RBD_OK);
    ck_assert(fabs(s.winding - winding[_i]) < 1e-6);
    if (_i != 1) ck_assert(fabs(s.housing - housing[_i]) < 1e-6);
    ck_assert(fabs(s.current - 4) < 1e-9);
    drive_free(&d);
}
END_TEST

/* A case that is joined to its winding 1e13 times better than to the air: 1 mW over 1e4 K/W are 10
   degrees. */
START_TEST(a_winding_may_be_joined_closely_to_its_case) {
    const rbd_motor motor = {.joint = "axle",
                             .gear = 1,
                             .constant = 1,
                             .resistance = 1e-3,
                             .heat_winding = 1,
                             .heat_case = 1,
                             .flow_winding = 1e-9,
                             .flow_case = 1e4};
    rbd_body heavy[1];
    memcpy(heavy, wheel, sizeof heavy);
    heavy[0].inertia[5] = 1e12;
    driven d = drive("heavy wheel", heavy, 1, &motor, 1, NULL, 0, NULL, 0, NULL);
    rbd_actuator_state s;
    d.command[0].torque = 1;
    for (int k = 0; k < 1000; k++) step(&d, 1000);
    ck_assert_int_eq(rbd_actuators_get(d.a, 0, &s), RBD_OK);
    ck_assert_double_eq_tol(s.winding, 35, 1e-5);
    ck_assert_double_eq_tol(s.housing, 35, 1e-5);
    drive_free(&d);
}
END_TEST

/* Between 60 and 80 degrees the limit of 10 A falls to 0: the winding stops where it heats as fast as it
   cools. */
START_TEST(heat_lowers_the_limit_of_the_current) {
    const rbd_motor motor = {.joint = "axle",
                             .gear = 1,
                             .constant = 1,
                             .resistance = 0.5,
                             .heat_winding = 20,
                             .flow_winding = 1.5,
                             .current = 10,
                             .hot = 60,
                             .hottest = 80};
    rbd_body heavy[1];
    memcpy(heavy, wheel, sizeof heavy);
    heavy[0].inertia[5] = 1e12;
    driven d = drive("heavy wheel", heavy, 1, &motor, 1, NULL, 0, NULL, 0, NULL);
    rbd_actuator_state s;
    d.command[0].torque = 1000;
    for (int k = 0; k < 3000; k++) {
        step(&d, 0.1);
        ck_assert_int_eq(rbd_actuators_get(d.a, 0, &s), RBD_OK);
        ck_assert(s.winding < 80);
        ck_assert_int_eq(s.saturated, 1);
    }
    ck_assert(fabs(s.current * s.current * 0.5 * 1.5 - (s.winding - 25)) < 1e-6);
    ck_assert(fabs(s.current - 10 * (80 - s.winding) / 20) < 1e-4);
    drive_free(&d);
}
END_TEST

/* A quick drive is stable in a long step; one that samples is not, as the real one. */
START_TEST(an_implicit_drive_is_stable_in_long_steps) {
    rbd_motor motor = {.joint = "axle", .gear = 10, .constant = 1, .inertia = 1e-5, .sampled = _i};
    rbd_body light[1];
    memcpy(light, wheel, sizeof light);
    light[0].inertia[5] = 1e-3;
    driven d = drive("light wheel", light, 1, &motor, 1, NULL, 0, NULL, 0, NULL);
    double fastest = 0;
    d.command[0] = (rbd_command){.q = 1, .kp = 300, .kd = 5};
    for (int k = 0; k < 400 && fastest < 1e6; k++) {
        step(&d, 5e-3);
        fastest = larger(fastest, fabs(d.v[0]));
    }
    if (_i) ck_assert(fastest >= 1e6);
    if (!_i) ck_assert(fabs(d.q[0] - 1) < 1e-9 && fastest < 200);
    drive_free(&d);
}
END_TEST

/* A command arrives after exactly so many steps. */
START_TEST(a_command_is_late_by_its_delay) {
    const rbd_motor motor = {.joint = "axle", .gear = 1, .constant = 1, .delay = _i};
    driven d = drive_wheel(&motor);
    for (int k = 0; k < 12; k++) {
        d.command[0].torque = k + 1;
        ck_assert_int_eq(rbd_actuators_begin(d.a, d.command, d.q, d.v, 1e-3, 0, d.tau, d.damping), RBD_OK);
        ck_assert(d.tau[0] == (k < _i ? 0 : k + 1 - _i));
        ck_assert_int_eq(rbd_actuators_again(d.a, d.v, d.tau, d.damping), 0);
    }
    drive_free(&d);
}
END_TEST

/* The encoder is off by 0.003 and sees steps of 0.01; a gain of 100 makes torques of that. Cogging has
   four periods in a turn of the rotor. */
START_TEST(encoder_and_cogging_are_seen) {
    const rbd_motor motor = {.joint = "axle",
                             .gear = 2,
                             .constant = 1,
                             .step = 0.01,
                             .offset = 0.003,
                             .cogging = 0.2,
                             .teeth = 4,
                             .phase = 0.1};
    driven d = drive_wheel(&motor);
    for (int k = -50; k < 50; k++) {
        const double q = 0.0037 * k, seen = 0.01 * floor((q + 0.003) / 0.01 + 0.5);
        const double zero[1] = {0};
        rbd_drive o;
        d.q[0] = q;
        d.command[0].kp = 100;
        ck_assert_int_eq(rbd_actuators_inverse(d.a, d.q, zero, zero, zero, &o), RBD_OK);
        ck_assert(fabs(o.torque + 2 * 0.2 * sin(4 * 2 * q + 0.1)) < 1e-12);
        ck_assert_int_eq(rbd_actuators_begin(d.a, d.command, d.q, d.v, 1e-3, 0, d.tau, d.damping), RBD_OK);
        ck_assert(fabs(d.tau[0] - (-100 * seen + 2 * 0.2 * sin(4 * 2 * q + 0.1))) < 1e-12);
        while (rbd_actuators_again(d.a, zero, d.tau, d.damping)) continue;
    }
    drive_free(&d);
}
END_TEST

/* Cogging is a field of force: a rotor that swings between two teeth, or runs over them by a quarter of a
   radian in a step, gains no more than a tenth of their height, by both kinds of steps. behind: whether a
   spring lies between. Energy of the cogging: (cos(1200 angle) + 1) / 1200. */
START_TEST(cogging_makes_no_energy) {
    const int behind = _i % 2;
    const rbd_motor motor = {.joint = "axle",
                             .gear = -100,
                             .constant = 1,
                             .inertia = behind ? 1e-5 : 0,
                             .stiffness = behind ? 1e4 : 0,
                             .cogging = 0.01,
                             .teeth = 12};
    const double starts[3] = {1e-3, 0.1, 0.2};
    for (int k = 0; k < 3; k++) {
        driven d = drive_wheel_with(&motor, _i < 2 ? &first_order : NULL);
        double first = 0, largest_energy = 0;
        d.q[0] = pi / 1200, d.v[0] = starts[k];
        ck_assert_int_eq(rbd_actuators_reset(d.a, d.q, 25), RBD_OK);
        for (int i = 0; i < 10000; i++) {
            rbd_actuator_state s;
            step(&d, 1e-3);
            ck_assert_int_eq(rbd_actuators_get(d.a, 0, &s), RBD_OK);
            const double wound = s.angle - d.q[0];
            double energy = 0.05 * d.v[0] * d.v[0] + (cos(1200 * s.angle) + 1) / 1200;
            if (behind) energy += 0.05 * s.speed * s.speed + 0.5e4 * wound * wound;
            if (i == 0) first = energy;
            largest_energy = larger(largest_energy, energy);
        }
        ck_assert_msg(largest_energy <= first + 1e-4, "%g after %g", largest_energy, first);
        drive_free(&d);
    }
}
END_TEST

/* However long the steps are, and however fast the rotor: what cogging gives in all is no more than its
   height, 2 cogging / teeth. So it is while teeth gear^2 cogging dt^2 is below twice the inertia. */
static void expect_no_more_than_a_height(const rbd_motor *motor, const rbd_contact_options *order, double dt,
                                         double speed) {
    const double height = motor->cogging / 6, rate = 12 * motor->gear;
    driven d = drive_wheel_with(motor, order);
    d.q[0] = 0.36 / rate, d.v[0] = speed;
    ck_assert_int_eq(rbd_actuators_reset(d.a, d.q, 25), RBD_OK);
    const double first = 0.05 * d.v[0] * d.v[0] + height / 2 * cos(rate * d.q[0]);
    for (int i = 0; i < 600; i++) {
        step(&d, dt);
        const double gained = 0.05 * d.v[0] * d.v[0] + height / 2 * cos(rate * d.q[0]) - first;
        ck_assert_msg(gained <= height, "%g J, height %g, gear %g, steps of %g s, from %g rad/s", gained,
                      height, motor->gear, dt, speed);
    }
    drive_free(&d);
}

START_TEST(cogging_gains_at_most_its_height) {
    const double dt = (const double[4]){1e-3, 3e-3, 5e-3, 1e-2}[_i / 2], cogging[3] = {0.02, 0.2, 1};
    for (int k = 0; k < 3; k++) {
        const double largest_gear = sqrt(2 * 0.1 / (12 * cogging[k])) / dt;
        rbd_motor motor = {.joint = "axle", .constant = 1, .cogging = cogging[k], .teeth = 12};
        for (int n = 1; n <= 40; n++) {
            motor.gear = n > 20 ? largest_gear : 10;
            expect_no_more_than_a_height(&motor, _i % 2 ? &first_order : NULL, dt,
                                         n > 20 ? 3 * (n - 20) / motor.gear : 0.3 * n);
        }
    }
}
END_TEST

/* What a state says of the last step stays while the next one is under way: its cogging is another, and a
   limit cuts there. */
START_TEST(a_state_is_that_of_the_last_step) {
    const rbd_motor motor = {.joint = "axle",
                             .gear = 5,
                             .constant = 0.1,
                             .current = 40,
                             .inertia = 1e-3,
                             .cogging = 0.2,
                             .teeth = 12,
                             .phase = 0.7};
    driven d = drive_wheel(&motor);
    rbd_actuator_state last, now;
    d.command[0].torque = 2;
    for (int k = 0; k < 20; k++) step(&d, 1e-3);
    ck_assert_int_eq(rbd_actuators_get(d.a, 0, &last), RBD_OK);
    ck_assert_double_eq_tol(last.current, 4, 1e-12); /* 2 N m at the shaft, of 0.5 N m/A */

    d.command[0].torque = 1000;
    ck_assert_int_eq(rbd_actuators_begin(d.a, d.command, d.q, d.v, 1e-3, 0, d.tau, d.damping), RBD_OK);
    ck_assert_int_eq(rbd_actuators_get(d.a, 0, &now), RBD_OK);
    ck_assert(now.current == last.current && now.motor == last.motor && now.joint == last.joint);
    ck_assert_int_eq(now.saturated, last.saturated);
    drive_free(&d);
}
END_TEST

/* ---- limits at the step's end ---- */

/* The torque that a motor has after a step is what its drive asks for at the angle and speed of the step's
   end, cut by the limits there. */
static void expect_within_limits(const driven *d, int i, const rbd_motor *m, double encoder) {
    const double K = m->gear * m->constant;
    rbd_actuator_state s;
    ck_assert_int_eq(rbd_actuators_get(d->a, i, &s), RBD_OK);
    const rbd_command *c = &d->command[i];
    const double asked = c->torque + c->kp * (c->q - encoder) + c->kd * (c->v - s.speed);
    double low = -fabs(K) * m->current, high = -low;
    if (m->voltage > 0) {
        const double line = fabs(K) * m->voltage / m->resistance, back = K * K / m->resistance * s.speed;
        low = larger(low, fmin(-line - back, high));
        high = fmin(high, fmax(line - back, low));
    }
    const double expected = fmin(fmax(asked, low), high);
    ck_assert_msg(fabs(s.motor - expected) <= 1e-9 * (1 + fabs(asked) + c->kp), "%g, not %g", s.motor,
                  expected);
    ck_assert_msg(fabs(s.current) <= m->current * (1 + 1e-12), "%g A", s.current);
    if (fabs(asked - expected) > 1e-6) ck_assert_int_eq(s.saturated, asked > expected ? 1 : -1);
}

/* A stiff drive whose limit cuts it in most steps. _i & 1: a limit of the voltage, too; & 2: behind a spring;
   & 4: the gear turns the other way. */
START_TEST(a_limit_is_decided_at_the_steps_end) {
    rbd_motor motor = {
        .joint = "axle", .gear = _i & 4 ? -50 : 50, .constant = 0.03, .current = 4, .inertia = 1e-5};
    if (_i & 1) motor.voltage = 12, motor.resistance = 0.6;
    if (_i & 2) motor.stiffness = 500, motor.damping = 1;
    uint64_t seed = 17;
    int cut = 0, free = 0;
    for (int h = 0; h < 3; h++) {
        driven d = drive_wheel(&motor);
        double rotor = 0;
        for (int k = 0; k < 500; k++) {
            const double kp = pow(10, uniform(&seed, 0, 4));
            d.command[0] = (rbd_command){.q = uniform(&seed, -1, 1), .kp = kp, .kd = kp / 10};
            const double J = 2500 * 1e-5, dt = steps[h], before = _i & 2 ? rotor : d.v[0], v = d.v[0];
            rbd_actuator_state s;
            step(&d, dt);
            ck_assert_int_eq(rbd_actuators_get(d.a, 0, &s), RBD_OK);
            expect_within_limits(&d, 0, &motor, s.angle);

            /* and it is what rotor and wheel got */
            const double kept = 1e-9 * (1 + fabs(s.motor)) + 1e-12 * fabs(s.speed) / dt;
            ck_assert(fabs(s.motor - s.joint - J * (s.speed - before) / dt) <= kept);
            ck_assert(fabs(s.joint - 0.1 * (d.v[0] - v) / dt) <= kept);
            rotor = s.speed;
            cut += s.saturated != 0, free += s.saturated == 0;
        }
        ck_assert_int_eq(d.unsettled, 0);
        drive_free(&d);
    }
    ck_assert_int_gt(cut, 100);
    ck_assert_int_gt(free, 10);
}
END_TEST

/* While the limit cuts it, a drive is a constant torque: 6 N m on 0.1 kg m^2, whatever the gains are. */
START_TEST(a_drive_at_its_limit_is_a_constant_torque) {
    const rbd_motor motor = {.joint = "axle", .gear = 50, .constant = 0.03, .current = 4};
    driven d = drive_wheel(&motor);
    d.command[0] = (rbd_command){.q = 1000, .kp = 1e5, .kd = 1e3};
    for (int k = 1; k <= 20; k++) {
        step(&d, 1e-2);
        ck_assert_double_eq_tol(d.v[0], 60 * 1e-2 * k, 1e-12);
    }
    drive_free(&d);
}
END_TEST

/* ---- drives by voltage ---- */

static const rbd_motor by_voltage = {
    .joint = "axle", .gear = 50, .constant = 0.03, .resistance = 0.6, .voltage = 24, .by_voltage = 1};

/* 12 V through 0.6 ohm and 1.5 V s: 30 N m at a standstill, 8 rad/s without a load; the supply's 24 V are the
   most it gets. A time constant of I R / K^2. */
START_TEST(a_voltage_makes_a_torque_speed_line) {
    const double volts[3] = {12, -6, 100}, stall[3] = {30, -15, 60}, speed[3] = {8, -4, 16};
    for (int k = 0; k < 6; k++) {
        rbd_motor motor = by_voltage;
        const double sign = k < 3 ? 1 : -1; /* a gear that turns the other way */
        motor.gear = 50 * sign;
        driven d = drive_wheel(&motor);
        d.command[0].voltage = volts[k % 3];
        ck_assert_int_eq(rbd_actuators_begin(d.a, d.command, d.q, d.v, 1e-3, 0, d.tau, d.damping), RBD_OK);
        ck_assert_double_eq_tol(d.tau[0], sign * stall[k % 3], 1e-12);
        ck_assert_double_eq_tol(d.damping[0], 1.5 * 1.5 / 0.6, 1e-12);
        for (int i = 0; i < 300; i++) step(&d, 1e-2);
        ck_assert_double_eq_tol(d.v[0], sign * speed[k % 3], 1e-10);

        /* a run-up in short steps against its exponential */
        const double rate = 1.5 * 1.5 / 0.6 / 0.1;
        memset(d.v, 0, sizeof d.v), memset(d.q, 0, sizeof d.q);
        ck_assert_int_eq(rbd_actuators_reset(d.a, d.q, 25), RBD_OK);
        for (int i = 0; i < 2000; i++) step(&d, 1e-5);
        ck_assert_double_eq_tol(d.v[0], sign * speed[k % 3] * (1 - exp(-rate * 0.02)),
                                2e-4 * fabs(speed[k % 3]));
        drive_free(&d);
    }
}
END_TEST

/* Gains in volts are gains in torque times K / R, and the back-EMF is damping. With the gear turned around it
   is the same motion. */
START_TEST(gains_in_volts_turn_the_shaft_the_same_way) {
    rbd_motor volts = by_voltage;
    const rbd_motor torque = {.joint = "axle", .gear = 50, .constant = 0.03};
    const double per_volt = 1.5 / 0.6;
    volts.gear = _i ? -50 : 50, volts.voltage = 0;
    driven d = drive_wheel(&volts), e = drive_wheel(&torque);
    for (int k = 0; k < 300; k++) {
        d.command[0] = (rbd_command){.q = sin(0.05 * k), .kp = 40, .kd = 0.5, .voltage = _i ? -2 : 2};
        e.command[0] = (rbd_command){
            .q = sin(0.05 * k), .kp = 40 * per_volt, .kd = (0.5 + 1.5) * per_volt, .torque = 2 * per_volt};
        step(&d, 5e-3), step(&e, 5e-3);
        ck_assert_double_eq_tol(d.q[0], e.q[0], 1e-12);
    }
    drive_free(&d), drive_free(&e);
}
END_TEST

/* The voltage that the inverse asks for gives the wanted torque at that speed; what the supply does not have
   is told. */
START_TEST(a_voltage_of_the_inverse_gives_the_torque) {
    uint64_t seed = 23;
    int cut = 0;
    for (int k = 0; k < 200; k++) {
        rbd_motor motor = by_voltage;
        const double zero[1] = {0}, v[1] = {uniform(&seed, -20, 20)}, tau[1] = {uniform(&seed, -40, 40)};
        rbd_drive o;
        motor.gear = k % 2 ? 50 : -50;
        driven d = drive_wheel(&motor);
        ck_assert_int_eq(rbd_actuators_inverse(d.a, d.q, v, zero, tau, &o), RBD_OK);
        const double needed = 0.6 * tau[0] / (motor.gear * 0.03) + motor.gear * 0.03 * v[0];
        ck_assert_int_eq(o.saturated != 0, fabs(needed) > 24);
        ck_assert_double_eq_tol(o.voltage, fmax(-24, fmin(24, needed)), 1e-11);
        d.command[0].voltage = o.voltage;
        ck_assert_int_eq(rbd_actuators_begin(d.a, d.command, d.q, v, 1e-3, 0, d.tau, d.damping), RBD_OK);
        ck_assert_double_eq_tol(d.tau[0] - d.damping[0] * v[0], o.torque, 1e-10);
        cut += o.saturated != 0;
        drive_free(&d);
    }
    ck_assert(cut > 20 && cut < 180);
}
END_TEST

START_TEST(a_command_is_a_torque_or_a_voltage) {
    const rbd_motor torque = {.joint = "axle", .gear = 50, .constant = 0.03};
    driven d = drive_wheel(&torque), e = drive_wheel(&by_voltage);
    d.command[0].voltage = 1, e.command[0].torque = 1;
    ck_assert_int_eq(rbd_actuators_begin(d.a, d.command, d.q, d.v, 1e-3, 0, d.tau, d.damping), RBD_ERR_RANGE);
    ck_assert_int_eq(rbd_actuators_begin(e.a, e.command, e.q, e.v, 1e-3, 0, e.tau, e.damping), RBD_ERR_RANGE);
    drive_free(&d), drive_free(&e);
}
END_TEST

/* A step that was begun and has no end is none: commands under way stay in their places. */
START_TEST(a_step_may_be_begun_again) {
    const rbd_motor motor = {.joint = "axle", .gear = 1, .constant = 1, .delay = 3};
    driven d = drive_wheel(&motor);
    const double nan[1] = {NAN};
    for (int k = 0; k < 12; k++) {
        for (int n = 0; n < 4; n++) {
            d.command[0].torque = 100 * (n + 1);
            ck_assert_int_eq(rbd_actuators_begin(d.a, d.command, d.q, d.v, 1e-3, 0, d.tau, d.damping),
                             RBD_OK);
            if (n % 2) ck_assert_int_eq(rbd_actuators_again(d.a, nan, d.tau, d.damping), 0);
        }
        d.command[0].torque = k + 1;
        ck_assert_int_eq(rbd_actuators_begin(d.a, d.command, d.q, d.v, 1e-3, 0, d.tau, d.damping), RBD_OK);
        ck_assert(d.tau[0] == (k < 3 ? 0 : k - 2));
        ck_assert_int_eq(rbd_actuators_again(d.a, d.v, d.tau, d.damping), 0);
    }
    drive_free(&d);
}
END_TEST

/* ---- inverse ---- */

/* With efficiency 0.8 a torque of 8 N m out needs 10 of the motor; lowering 8 N m, the motor holds 6.667.
   A gear with load_joint 1 locks itself: to lower, the motor must push. */
START_TEST(efficiency_and_self_locking) {
    rbd_motor motor = {.joint = "axle", .gear = 1, .constant = 1, .friction = {.load_motor = 0.2}};
    const double zero[1] = {0}, tau[1] = {8}, up[1] = {1}, down[1] = {-1};
    driven d = drive_wheel(&motor);
    rbd_drive o;
    ck_assert_int_eq(rbd_actuators_inverse(d.a, d.q, up, zero, tau, &o), RBD_OK);
    ck_assert(fabs(o.torque - 10) < 1e-12);
    ck_assert_int_eq(rbd_actuators_inverse(d.a, d.q, down, zero, tau, &o), RBD_OK);
    ck_assert(fabs(o.torque - 8 / 1.2) < 1e-12);
    for (int k = 0; k < 3; k++) { /* the least efficiency that a table may have is 0.001 */
        motor.friction.load_motor = k == 0 ? 0.96 : k == 1 ? 0.99 : 0.999;
        ck_assert_int_eq(rbd_actuators_inverse(d.a, d.q, up, zero, tau, &o), RBD_OK);
        ck_assert_msg(fabs(o.torque * (1 - motor.friction.load_motor) - 8) < 1e-12, "%g", o.torque);
    }
    motor.friction.load_motor = 0.2;
    motor.friction.load_joint = 1.1;
    ck_assert_int_eq(rbd_actuators_inverse(d.a, d.q, down, zero, tau, &o), RBD_OK);
    ck_assert(o.torque < 0);

    /* nor does any torque on its side move it for long: the level follows the load by a step */
    motor.inertia = 0.01;
    d.other[0] = 100;
    for (int k = 0; k < 1000; k++) step(&d, 1e-3);
    ck_assert(fabs(d.v[0]) < 1e-8);
    ck_assert(d.q[0] < 0.2);
    drive_free(&d);
}
END_TEST

static void draw_friction(uint64_t *seed, rbd_gear_friction *f) {
    f->coulomb = uniform(seed, 0, 0.5), f->viscous = uniform(seed, 0, 0.2);
    f->rest = uniform(seed, 0, 0.5), f->speed = uniform(seed, 0.1, 0.6), f->power = uniform(seed, 0.7, 3);
    f->load_motor = uniform(seed, 0, 0.25), f->load_joint = uniform(seed, 0, 0.25);
    f->rest_motor = uniform(seed, 0, 0.2), f->rest_joint = uniform(seed, 0, 0.2);
    f->square_motor = uniform(seed, 0, 0.005), f->square_joint = uniform(seed, 0, 0.005);
}

/* What the inverse asks of the motor gives the wanted torque: torque, inertia and friction from their
   formulas. One motor in thousands sits on the jump of the squares, where nothing does. The slopes are
   those of differences. */
START_TEST(forward_of_the_inverse_is_the_identity) {
    uint64_t seed = 3;
    rbd_motor motor = {.joint = "axle", .constant = 0.05, .resistance = 0.5};
    motor.gear = 1;
    driven d = drive_wheel(&motor);
    int jumps = 0, kinks = 0;
    for (int k = 0; k < 20000 / PART_OF_TREES; k++) {
        double tau[1], v[1], acc[1];
        rbd_drive o, high, low;
        motor.gear = uniform(&seed, 20, 100) * (below(&seed, 2) ? 1 : -1);
        motor.inertia = uniform(&seed, 1e-5, 2e-5);
        draw_friction(&seed, &motor.friction);
        tau[0] = uniform(&seed, -20, 20), v[0] = uniform(&seed, -3, 3), acc[0] = uniform(&seed, -10, 10);
        ck_assert_int_eq(rbd_actuators_inverse(d.a, d.q, v, acc, tau, &o), RBD_OK);
        const double level = published(&motor.friction, v[0], o.torque, -tau[0]),
                     J = motor.gear * motor.gear * motor.inertia;
        const double out =
            o.torque - J * acc[0] - motor.friction.viscous * v[0] - (v[0] > 0 ? 1 : -1) * level;
        const double error = fabs(out - tau[0]) / (1 + fabs(tau[0]) + fabs(o.torque));
        jumps += error > 1e-13;
        ck_assert(fabs(o.current * motor.gear * motor.constant - o.torque) < 1e-12 * (1 + fabs(o.torque)));

        const double h = 1e-6;
        double *argument[3] = {tau, v, acc};
        const double slope[3] = {o.by_torque, o.by_speed, o.by_acceleration};
        for (int j = 0; j < 3; j++) {
            const double x = *argument[j];
            if (j == 1) continue; /* the level falls with the speed, too */
            *argument[j] = x + h;
            ck_assert_int_eq(rbd_actuators_inverse(d.a, d.q, v, acc, tau, &high), RBD_OK);
            *argument[j] = x - h;
            ck_assert_int_eq(rbd_actuators_inverse(d.a, d.q, v, acc, tau, &low), RBD_OK);
            *argument[j] = x;
            kinks += fabs((high.torque - low.torque) / (2 * h) - slope[j]) > 1e-6 * (1 + fabs(slope[j]));
        }
    }
    ck_assert_int_le(jumps, 10);
    ck_assert_int_le(kinks, 20);
    drive_free(&d);
}
END_TEST

/* Below the speed `still` friction is compensated in proportion; at rest not at all. */
START_TEST(compensation_is_softened_near_rest) {
    const rbd_motor motor = {
        .joint = "axle", .gear = 1, .constant = 1, .friction = {.coulomb = 2, .still = 0.1}};
    const double zero[1] = {0}, speed[5] = {-1, -0.05, 0, 0.025, 0.2}, expected[5] = {-2, -1, 0, 0.5, 2};
    driven d = drive_wheel(&motor);
    for (int k = 0; k < 5; k++) {
        rbd_drive o;
        ck_assert_int_eq(rbd_actuators_inverse(d.a, d.q, &speed[k], zero, zero, &o), RBD_OK);
        ck_assert(fabs(o.torque - expected[k]) < 1e-15);
    }
    drive_free(&d);
}
END_TEST

/* A plan for the iiwa's joints. */
static void plan(double t, double *q, double *v, double *a) {
    for (int k = 0; k < 7; k++) {
        const double f = 1.1 + 0.37 * k, g = 2.3 - 0.19 * k;
        q[k] = 0.6 * sin(f * t + k) + 0.3 * cos(g * t);
        v[k] = 0.6 * f * cos(f * t + k) - 0.3 * g * sin(g * t);
        a[k] = -0.6 * f * f * sin(f * t + k) - 0.3 * g * g * cos(g * t);
    }
}

/* How far an arm is off its plan after half a second of feed-forward alone. */
static double follow(double dt, int compensated) {
    rbd_motor motors[7], known[7];
    double off = 0, q[7], v[7], acc[7];
    void *memory;
    rbd_actuators *inverse;
    for (int i = 0; i < 7; i++) {
        motors[i] = (rbd_motor){.joint = iiwa_joints[i],
                                .gear = 100,
                                .constant = 0.1,
                                .resistance = 0.5,
                                .inertia = i < 5 ? 1e-4 : 4e-5,
                                .friction = {.coulomb = 1,
                                             .viscous = 0.5,
                                             .rest = 0.5,
                                             .speed = 0.1,
                                             .power = 1.4,
                                             .load_motor = 0.05,
                                             .load_joint = 0.05,
                                             .rest_motor = 0.03,
                                             .rest_joint = 0.03}};
        known[i] = motors[i];
        if (!compensated) memset(&known[i].friction, 0, sizeof known[i].friction);
    }
    driven d = drive("iiwa", iiwa_bodies, 7, motors, 7, NULL, 0, NULL, 0, NULL);
    ck_assert_int_eq(init(&d.r, known, 7, NULL, 0, &inverse, &memory, NULL), RBD_OK);
    plan(0, d.q, d.v, acc);
    for (int k = 0; k < (int)(0.5 / dt); k++) {
        double tau[7];
        rbd_drive drives[7];
        plan((k + 0.5) * dt, q, v, acc);
        ck_assert_int_eq(rbd_rnea(d.r.m, d.r.w, q, v, acc, NULL, tau), RBD_OK);
        ck_assert_int_eq(rbd_actuators_inverse(inverse, q, v, acc, tau, drives), RBD_OK);
        for (int i = 0; i < 7; i++) d.command[i].torque = drives[i].torque;
        step(&d, dt);
        plan((k + 1) * dt, q, v, acc);
        for (int i = 0; i < 7; i++) off = larger(off, fabs(d.q[i] - q[i]));
    }
    free(memory);
    drive_free(&d);
    return off;
}

START_TEST(feed_forward_follows_a_plan_to_first_order) {
    const double coarse = follow(1e-3, 1), fine = follow(2.5e-4, 1), without = follow(1e-3, 0);
    ck_assert_msg(without > 0.1 && coarse < 5e-3 && fine < coarse / 2, "%g without, %g, %g", without, coarse,
                  fine);
}
END_TEST

/* ---- springs and play ---- */

/* A wheel of 0.1 kg m^2 and a rotor of 0.05 on a spring: no step adds energy; momentum stays with play
   alone. */
START_TEST(springs_and_play_make_no_energy) {
    const double stiffness[3] = {100, 1e4, 1e6}, J = 0.05;
    const double k = stiffness[_i / 6 % 3], dt = steps[_i / 2 % 3];
    const int play = _i % 2;
    const rbd_motor motor = {.joint = "axle",
                             .gear = 50,
                             .constant = 1,
                             .inertia = J / 2500,
                             .stiffness = k,
                             .damping = 0.01,
                             .backlash = play ? 0.01 : 0,
                             .friction = {.coulomb = play ? 0 : 0.02}};
    driven d = drive_wheel_with(&motor, _i < 18 ? &first_order : NULL);
    double last = INFINITY, momentum = 0;
    d.v[0] = 2;
    for (int i = 0; i * dt < 2; i++) {
        rbd_actuator_state s;
        double energy;
        step(&d, dt);
        ck_assert_int_eq(rbd_actuators_get(d.a, 0, &s), RBD_OK);
        const double wound = larger(0, fabs(s.angle - d.q[0]) - motor.backlash / 2);
        energy = 0.05 * d.v[0] * d.v[0] + 0.5 * J * s.speed * s.speed + 0.5 * k * wound * wound;
        ck_assert_msg(energy <= last + 1e-14, "step %d: %.17g after %.17g", i, energy, last);
        last = energy;
        momentum = 0.1 * d.v[0] + J * s.speed;
    }
    if (play) ck_assert(fabs(momentum - 0.2) < 1e-13);
    ck_assert_int_eq(d.unsettled, 0);
    drive_free(&d);
}
END_TEST

/* A load of 0.45 comes suddenly, and winds the spring up to 0.9: less than the friction, so the rotor
   stands still to the bit, and the joint ends at load / stiffness. */
START_TEST(friction_holds_a_rotor_behind_its_spring) {
    const rbd_motor motor = {.joint = "axle",
                             .gear = 50,
                             .constant = 1,
                             .inertia = 2e-5,
                             .stiffness = 300,
                             .damping = 1,
                             .friction = {.coulomb = 1}};
    driven d = drive_wheel(&motor);
    d.other[0] = 0.45;
    for (int k = 0; k < 5000; k++) {
        rbd_actuator_state s;
        step(&d, 1e-3);
        ck_assert_int_eq(rbd_actuators_get(d.a, 0, &s), RBD_OK);
        ck_assert(s.speed == 0);
        ck_assert(s.angle == 0);
    }
    ck_assert(fabs(d.q[0] - 0.45 / 300) < 1e-12);
    drive_free(&d);
}
END_TEST

/* A servo at the inverse's angle holds a load at the planned position: it stands beyond the play, and has the
   spring wound up. */
START_TEST(a_servo_behind_play_holds_the_plan) {
    const rbd_motor motor = {.joint = "axle",
                             .gear = 50,
                             .constant = 1,
                             .inertia = 2e-5,
                             .stiffness = 300,
                             .damping = 1,
                             .backlash = 0.02};
    const double wanted = _i ? -0.45 : 0.45, zero = 0;
    driven d = drive_wheel(&motor);
    rbd_drive servo;
    ck_assert_int_eq(rbd_actuators_inverse(d.a, &zero, &zero, &zero, &wanted, &servo), RBD_OK);

    d.other[0] = -wanted;
    d.command[0] = (rbd_command){.q = servo.angle, .kp = 1e4, .kd = 10, .torque = servo.torque};
    for (int k = 0; k < 5000; k++) step(&d, 1e-3);
    ck_assert_msg(fabs(d.v[0]) < 1e-9, "%g", d.v[0]);
    ck_assert_msg(fabs(d.q[0]) < 1e-9, "%g", d.q[0]);
    drive_free(&d);
}
END_TEST

/* Free vibration of both masses against its cosine, at two steps: first order. */
START_TEST(a_spring_vibrates_as_theory_says) {
    const rbd_motor motor = {.joint = "axle", .gear = 50, .constant = 1, .inertia = 2e-5, .stiffness = 300};
    const double omega = sqrt(300 * (1 / 0.1 + 1 / 0.05));
    double error[2];
    for (int h = 0; h < 2; h++) {
        const double dt = h ? 5e-6 : 1e-5;
        const int n = (int)(0.05 / dt + 0.5);
        driven d = drive_wheel_with(&motor, &first_order);
        rbd_actuator_state s;
        d.q[0] = -0.1;
        for (int k = 0; k < n; k++) step(&d, dt);
        ck_assert_int_eq(rbd_actuators_get(d.a, 0, &s), RBD_OK);
        error[h] = fabs((s.angle - d.q[0]) - 0.1 * cos(omega * n * dt));
        drive_free(&d);
    }
    ck_assert(error[0] < 1e-3);
    ck_assert(fabs(error[0] / error[1] - 2) < 0.05);
}
END_TEST

/* The laws of a spring at the speeds of the settled step, from their text: what the joint was told is
   what the spring gives, the rotor obeys Newton, and friction opposes it within its level. Returns the
   largest error, N m. */
static double law_error(const rbd_motor *m, const rbd_actuator_state *before, const rbd_actuator_state *after,
                        double g, double x, double told, double t, double dt) {
    const double J = m->gear * m->gear * m->inertia, h = m->backlash / 2;
    const double wound = before->angle + dt * (after->speed - x) - g, rate = after->speed - x;
    double p = 0;
    if (m->stiffness * (wound - h) + m->damping * rate > 0)
        p = dt * (m->stiffness * (wound - h) + m->damping * rate);
    if (m->stiffness * (wound + h) + m->damping * rate < 0)
        p = dt * (m->stiffness * (wound + h) + m->damping * rate);
    const double friction =
        J * (after->speed - before->speed) - dt * (t - m->friction.viscous * after->speed) + p;
    const double level = dt * after->friction;
    double error = larger(fabs(told - p / dt), larger(0, fabs(friction) - level) / dt);
    if (after->speed != 0) error = larger(error, fabs(friction + (after->speed > 0 ? level : -level)) / dt);
    return error;
}

static void expect_laws(driven *d, const rbd_motor *motors, int n, int first, double dt) {
    rbd_actuator_state before[MOST];
    double g[MOST], v[MAX_V];
    memcpy(v, d->v, sizeof v);
    for (int i = 0; i < n; i++) ck_assert_int_eq(rbd_actuators_get(d->a, i, &before[i]), RBD_OK);
    ck_assert_int_eq(rbd_actuators_map(d->a, d->q, NULL, g, NULL), RBD_OK);
    step(d, dt);
    for (int i = 0; i < n; i++) {
        const int k = first + i;
        const double told = d->tau[k] - d->damping[k] * d->v[k], size = 1 + fabs(told);
        rbd_actuator_state after;
        ck_assert_int_eq(rbd_actuators_get(d->a, i, &after), RBD_OK);
        const double x = d->first_order ? d->v[k] : (d->v[k] + v[k]) / 2;
        const double error = law_error(&motors[i], &before[i], &after, g[i], x, told, after.motor, dt);
        ck_assert_msg(error <= 1e-9 * size / dt * 1e-3, "shaft %d: %g N m of %g", i, error, size);
    }
}

/* Seven elastic shafts with friction of M5 and play under gravity, and a drive that holds. */
START_TEST(repeated_steps_obey_the_laws_of_all_shafts_at_once) {
    const double dt = steps[_i % 3];
    rbd_motor motors[7];
    for (int i = 0; i < 7; i++)
        motors[i] = (rbd_motor){.joint = iiwa_joints[i],
                                .gear = 100,
                                .constant = 1,
                                .inertia = 1e-4,
                                .stiffness = 1e4,
                                .damping = 5,
                                .backlash = 2e-3,
                                .friction = {.coulomb = 5,
                                             .viscous = 1,
                                             .rest = 2,
                                             .speed = 0.1,
                                             .power = 1.4,
                                             .load_motor = 0.05,
                                             .load_joint = 0.05}};
    driven d = drive("iiwa", iiwa_bodies, 7, motors, 7, NULL, 0, NULL, 0, _i < 3 ? NULL : &first_order);
    memcpy(d.q, bent, sizeof bent);
    ck_assert_int_eq(rbd_actuators_reset(d.a, d.q, 25), RBD_OK);
    const int n = (int)(1 / dt);
    for (int k = 0; k < n; k++) expect_laws(&d, motors, 7, 0, dt);
    ck_assert_int_eq(d.unsettled, 0);
    ck_assert_int_le(d.repeats, 3 * n);
    drive_free(&d);
}
END_TEST

/* HyQ falls on its feet with elastic legs, and stands. */
START_TEST(a_robot_stands_on_elastic_legs) {
    const double dt = steps[_i];
    static const char *const foot[4] = {"lf_lowerleg", "rf_lowerleg", "lh_lowerleg", "rh_lowerleg"};
    rbd_contact feet[4] = {{0}};
    rbd_motor motors[12];
    robot r = BUILD(hyq_bodies);
    double q0[12];
    for (int i = 0; i < 4; i++)
        feet[i] = (rbd_contact){
            .body1 = rbd_body_index(r.m, foot[i]), .body2 = -1, .point = {0.33, 0, 0}, .friction = 0.7};
    for (int i = 0; i < 12; i++) {
        const char *name = rbd_joint_name(r.m, rbd_dof_body(r.m, 6 + i));
        const double hind = name[1] == 'h' ? -1 : 1;
        q0[i] = hind * (strstr(name, "kfe") ? -1.4 : strstr(name, "hfe") ? 0.7 : 0);
        motors[i] = (rbd_motor){.joint = name,
                                .gear = 20,
                                .constant = 1,
                                .inertia = 1e-4,
                                .stiffness = 3000,
                                .damping = 3,
                                .backlash = 2e-3,
                                .friction = {.coulomb = 2, .viscous = 0.1}};
    }
    robot_free(&r);
    driven d = drive("HyQ", hyq_bodies, HYQ_NB, motors, 12, NULL, 0, feet, 4, NULL);
    d.q[2] = 0.62;
    for (int i = 0; i < 12; i++) {
        d.q[7 + i] = q0[i];
        d.command[i] = (rbd_command){.q = q0[i], .kp = 400, .kd = 10};
    }
    ck_assert_int_eq(rbd_actuators_reset(d.a, d.q, 25), RBD_OK);
    for (int k = 0; k * dt < 1.5; k++) step(&d, dt);
    ck_assert(d.q[2] > 0.4);
    ck_assert(largest(d.v, d.r.nv) < 0.2);
    ck_assert_int_eq(d.unsettled, 0);
    drive_free(&d);
}
END_TEST

/* ---- transmissions ---- */

/* Two joints in series: a leg in the air. */
static const rbd_body leg[2] = {{.name = "thigh",
                                 .joint = "hip",
                                 .parent = -1,
                                 .type = RBD_REVOLUTE,
                                 .axis = {0, 1, 0},
                                 .mass = 4,
                                 .com = {0.01, 0, -0.2},
                                 .inertia = {0.05, 0, 0.001, 0.05, 0, 0.01}},
                                {.name = "shank",
                                 .joint = "knee",
                                 .parent = 0,
                                 .type = RBD_REVOLUTE,
                                 .axis = {0, 1, 0},
                                 .position = {0, 0, -0.4},
                                 .mass = 1.5,
                                 .com = {0, 0.01, -0.2},
                                 .inertia = {0.02, 0, 0, 0.02, 0, 0.002}}};
static const rbd_transmission belt = {
    .name = "belt", .kind = RBD_BY_MATRIX, .n = 2, .joint = {"hip", "knee"}, .matrix = {1, 0, 1, 1}};

/* A knee driven by a belt from a motor on the hip's base: the step is that of M + G' (J + dt D) G, solved
   densely. */
START_TEST(coupled_shafts_have_the_inertia_and_damping_of_the_matrix) {
    const double J = 2500 * 1e-5, D = 3, kd = 2, kp = 50, dt = 1e-3, G[4] = {1, 0, 1, _i ? -1 : 1};
    rbd_transmission coupled = belt;
    rbd_motor motors[2];
    coupled.matrix[3] = G[3];
    for (int i = 0; i < 2; i++)
        motors[i] = (rbd_motor){.gear = 50, .constant = 1, .inertia = 1e-5, .friction = {.viscous = D}};
    driven d = drive("leg", leg, 2, motors, 2, &coupled, 1, NULL, 0, &first_order);
    d.q[0] = 0.3, d.q[1] = -0.7, d.v[0] = 1, d.v[1] = -2;
    for (int i = 0; i < 2; i++) d.command[i] = (rbd_command){.q = 0.2, .kp = kp, .kd = kd, .torque = 1 - i};
    for (int k = 0; k < 100; k++) {
        double M[4], c[2], b[2], A[4], expected[2];
        ck_assert_int_eq(rbd_crba(d.r.m, d.r.w, d.q, M), RBD_OK);
        ck_assert_int_eq(rbd_bias(d.r.m, d.r.w, d.q, d.v, NULL, c), RBD_OK);
        memcpy(A, M, sizeof A);
        for (int j = 0; j < 2; j++) b[j] = M[2 * j] * d.v[0] + M[2 * j + 1] * d.v[1] - dt * c[j];
        for (int i = 0; i < 2; i++) {
            const double g = G[2 * i] * d.q[0] + G[2 * i + 1] * d.q[1],
                         x = G[2 * i] * d.v[0] + G[2 * i + 1] * d.v[1];
            for (int j = 0; j < 2; j++) {
                b[j] += G[2 * i + j] * (J * x + dt * (1 - i + kp * (0.2 - g)));
                for (int l = 0; l < 2; l++)
                    A[2 * j + l] += G[2 * i + j] * (J + dt * (D + kd + dt * kp)) * G[2 * i + l];
            }
        }
        expected[0] = (A[3] * b[0] - A[1] * b[1]) / (A[0] * A[3] - A[1] * A[2]);
        expected[1] = (A[0] * b[1] - A[2] * b[0]) / (A[0] * A[3] - A[1] * A[2]);
        step(&d, dt);
        for (int j = 0; j < 2; j++) ck_assert(fabs(d.v[j] - expected[j]) < 1e-10 * (1 + fabs(expected[j])));
    }
    ck_assert_int_eq(d.unsettled, 0);
    drive_free(&d);
}
END_TEST

/* Friction of coupled shafts as rows, rotors and viscous friction as a matrix A = G' (J + dt D) G: each step
   is (M + A) (v_next - v) = dt (tau - c + G' f), where f holds a shaft still or brakes it with its level. */
START_TEST(coupled_shafts_stick_and_slide_as_rows) {
    const double J = 2500 * 1e-5, D = 3, G[4] = {1, 0, 1, 1}, dt = steps[_i];
    const rbd_contact_options rows = {.first_order = 1, .rows = 2, .tolerance = 1e-13, .iterations = 200};
    const rbd_gear_friction friction[2] = {{.coulomb = 6}, {.coulomb = 2}};
    const rbd_motor motors[2] = {{.gear = 50, .constant = 1}, {.gear = 50, .constant = 1}};
    double load[2] = {0}, added[3] = {0};
    int stuck[2] = {0}, slid[2] = {0};
    driven d = drive("leg", leg, 2, motors, 2, &belt, 1, NULL, 0, &rows);
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < 2; j++)
            for (int k = 0; k <= j; k++)
                added[rbd_packed_index(d.r.m, j, k)] += G[2 * i + j] * (J + dt * D) * G[2 * i + k];
    ck_assert_int_eq(rbd_contact_inertia(d.r.m, d.c, added), RBD_OK);
    d.q[0] = 0.3, d.q[1] = -0.7, d.v[0] = 1, d.v[1] = -2;

    for (int k = 0; k * dt < 2; k++) {
        double M[4], c[2], f[2], v[2], x[2];
        ck_assert_int_eq(rbd_crba(d.r.m, d.r.w, d.q, M), RBD_OK);
        ck_assert_int_eq(rbd_bias(d.r.m, d.r.w, d.q, d.v, NULL, c), RBD_OK);
        for (int j = 0; j < 2; j++) {
            v[j] = d.v[j];
            d.other[j] = -40 * d.q[j] + 25 * sin(5 * k * dt);
            for (int i = 0; i < 2; i++)
                d.other[j] -= G[2 * i + j] * D * (G[2 * i] * d.v[0] + G[2 * i + 1] * d.v[1]);
        }
        step_by_rows(&d, friction, G, 2, load, dt);

        for (int i = 0; i < 2; i++) {
            const double before = G[2 * i] * v[0] + G[2 * i + 1] * v[1], F = friction[i].coulomb;
            x[i] = G[2 * i] * d.v[0] + G[2 * i + 1] * d.v[1];
            rbd_contact_row_get(d.c, i, &f[i]);
            ck_assert(fabs(f[i]) <= F * (1 + 1e-12));
            if (fabs(x[i]) > 1e-9 && before * x[i] > 0) ck_assert(fabs(f[i] + copysign(F, x[i])) < 1e-9);
            stuck[i] += fabs(x[i]) < 1e-12;
            slid[i] += fabs(x[i]) > 0.1;
        }
        for (int j = 0; j < 2; j++) {
            double rest = dt * (c[j] - d.other[j]);
            for (int l = 0; l < 2; l++)
                rest += (M[2 * j + l] + added[rbd_packed_index(d.r.m, j, l)]) * (d.v[l] - v[l]) -
                        dt * G[2 * l + j] * f[l];
            ck_assert(fabs(rest) < 1e-11);
        }
    }
    for (int i = 0; i < 2; i++) {
        ck_assert_int_gt(stuck[i], (int)(0.04 / dt));
        ck_assert_int_gt(slid[i], (int)(0.1 / dt));
    }
    ck_assert_int_eq(d.repeats, 0);
    drive_free(&d);
}
END_TEST

/* Stuck and sliding coupled shafts by their own law: M (v_next - v) = dt (other - c + G' t). Each shaft's
   torque t is that of rotor, viscous friction and dry friction, which is the level against the motion, or
   holds the shaft. Returns 1 if a shaft sticks and another one slides. */
static int expect_coupled_laws(driven *d, const double *G, const rbd_motor *motors, int n, double dt) {
    double M[9], c[3], v[3], t[3];
    double momentum = 0;
    int stuck = 0, slid = 0;
    ck_assert_int_eq(rbd_crba(d->r.m, d->r.w, d->q, M), RBD_OK);
    ck_assert_int_eq(rbd_bias(d->r.m, d->r.w, d->q, d->v, NULL, c), RBD_OK);
    memcpy(v, d->v, sizeof v);
    step(d, dt);
    for (int k = 0; k < n * n; k++) momentum += fabs(M[k] * d->v[k % n]);
    for (int i = 0; i < n; i++) {
        const double J = motors[i].gear * motors[i].gear * motors[i].inertia, F = motors[i].friction.coulomb;
        double x = 0, before = 0;
        rbd_actuator_state s;
        ck_assert_int_eq(rbd_actuators_get(d->a, i, &s), RBD_OK);
        for (int j = 0; j < n; j++) x += G[n * i + j] * d->v[j], before += G[n * i + j] * v[j];
        t[i] = s.joint;
        const double f = t[i] + J * (x - before) / dt + motors[i].friction.viscous * x;
        const double rounding = 1e-9 * (1 + fabs(t[i]) + F) + 1e-10 * momentum / dt;
        ck_assert_msg(fabs(f) <= F + rounding, "%g N m beyond %g at %g, momentum %g", fabs(f) - F, F, x,
                      momentum);
        if (fabs(x) > 2e-9)
            ck_assert_msg(fabs(f + copysign(F, x)) <= rounding, "%g N m off at %g", f + copysign(F, x), x);
        ck_assert(f * x <= 1e-8 * F);
        stuck += fabs(x) < 1e-8, slid += fabs(x) > 1e-3;
    }
    for (int j = 0; j < n; j++) {
        double rest = dt * (c[j] - d->other[j]);
        for (int l = 0; l < n; l++) rest += M[n * j + l] * (d->v[l] - v[l]) - dt * G[n * l + j] * t[l];
        ck_assert_msg(fabs(rest) < 1e-9, "%g", rest);
    }
    return stuck > 0 && slid > 0;
}

/* Three joints in series, 0.1 to 10 kg. */
static void draw_chain(uint64_t *seed, rbd_body *bodies, rbd_motor *motors, rbd_transmission *t) {
    static const char *const joints[3] = {"one", "two", "three"};
    memset(bodies, 0, 3 * sizeof *bodies);
    memset(motors, 0, 3 * sizeof *motors);
    *t = (rbd_transmission){.kind = RBD_BY_MATRIX, .n = 3};
    for (int i = 0; i < 3; i++) {
        const double mass = pow(10, uniform(seed, -1, 1));
        bodies[i] = (rbd_body){.joint = joints[i], .parent = i - 1, .type = RBD_REVOLUTE, .mass = mass};
        for (int k = 0; k < 3; k++) bodies[i].axis[k] = uniform(seed, -1, 1);
        bodies[i].position[2] = i ? -0.3 : 0, bodies[i].com[2] = -0.2;
        bodies[i].inertia[0] = bodies[i].inertia[3] = bodies[i].inertia[5] = 0.02 * mass;
        motors[i] = (rbd_motor){.gear = 50, .constant = 1, .inertia = below(seed, 2) ? 1e-5 : 0};
        motors[i].friction.coulomb = pow(10, uniform(seed, -2, 1.3));
        motors[i].friction.viscous = below(seed, 2) ? uniform(seed, 0, 1) : 0;
        t->joint[i] = joints[i];
        for (int k = 0; k < 3; k++) t->matrix[3 * i + k] = uniform(seed, -0.5, 0.5) + (k == i ? 1.5 : 0);
    }
}

START_TEST(coupled_shafts_stick_and_slide_exactly) {
    uint64_t seed = 31;
    int mixed = 0, made = 0, repeats = 0;
    for (int k = 0; k < 30; k++) {
        rbd_body bodies[3];
        rbd_motor motors[3];
        rbd_transmission t;
        draw_chain(&seed, bodies, motors, &t);
        driven d = drive("chain", bodies, 3, motors, 3, &t, 1, NULL, 0, &first_order);
        const double dt = steps[k % 3];
        for (int i = 0; i < 3; i++) d.q[i] = uniform(&seed, -1, 1), d.v[i] = uniform(&seed, -2, 2);
        for (int n = 0; n < 200; n++) {
            for (int i = 0; i < 3; i++) d.other[i] = 5 * sin((7 + i) * n * dt);
            mixed += expect_coupled_laws(&d, t.matrix, motors, 3, dt);
            made++;
        }
        ck_assert_int_eq(d.unsettled, 0);
        repeats += d.repeats;
        drive_free(&d);
    }
    ck_assert_int_gt(mixed, made / 10);
    ck_assert_int_lt(repeats, 4 * made);
}
END_TEST

/* ---- transmissions along one limb ----
   Sliding joints in series, whose mass matrix is constant: what a step does can be computed by hand. */

enum { LIMB = 9 };

typedef struct limb {
    rbd_body bodies[LIMB];
    rbd_motor motors[LIMB];
    rbd_transmission t[3];
    double G[LIMB * LIMB]; /* shaft speeds by joint speeds */
    int n, groups;
} limb;

static const char *const limb_joints[LIMB] = {"a", "b", "c", "d", "e", "f", "g", "h", "i"};

static void draw_limb_motor(uint64_t *seed, rbd_motor *m) {
    *m = (rbd_motor){.gear = 50, .constant = 1, .inertia = below(seed, 2) ? 1e-5 : 0};
    if (below(seed, 3)) m->friction.coulomb = pow(10, uniform(seed, -2, 1.3));
    if (below(seed, 2)) m->friction.viscous = pow(10, uniform(seed, -2, 1));
    if (below(seed, 3)) return;
    m->inertia = 1e-5 * pow(10, uniform(seed, -2, 2));
    m->stiffness = pow(10, uniform(seed, 2, 7));
    m->backlash = below(seed, 2) ? 0.01 : 0;
}

/* Two or three transmissions, and perhaps a motor of its own. Every second time the joints of one are not
   neighbours. */
static void draw_limb(uint64_t *seed, limb *l) {
    int order[LIMB];
    memset(l, 0, sizeof *l);
    l->groups = 2 + below(seed, 2);
    for (int k = 0; k < l->groups; k++) {
        l->t[k] = (rbd_transmission){.kind = RBD_BY_MATRIX, .n = 1 + below(seed, 3), .motor = l->n};
        l->n += l->t[k].n;
    }
    const int coupled = l->n;
    if (l->n < LIMB) l->n += below(seed, 2);

    for (int i = 0; i < l->n; i++) order[i] = i;
    for (int i = l->n - 1, mix = below(seed, 2); i > 0 && mix; i--) {
        const int j = below(seed, i + 1), other = order[i];
        order[i] = order[j], order[j] = other;
    }
    for (int i = 0; i < l->n; i++) {
        rbd_body *b = &l->bodies[i];
        *b = (rbd_body){.joint = limb_joints[i], .parent = i - 1, .type = RBD_PRISMATIC};
        b->mass = pow(10, uniform(seed, -1, 1));
        b->inertia[0] = b->inertia[3] = b->inertia[5] = 0.02 * b->mass;
        for (int k = 0; k < 3; k++) b->axis[k] = uniform(seed, -1, 1);
        draw_limb_motor(seed, &l->motors[i]);
    }
    for (int k = 0; k < l->groups; k++) {
        rbd_transmission *t = &l->t[k];
        for (int i = 0; i < t->n; i++) {
            t->joint[i] = limb_joints[order[t->motor + i]];
            for (int j = 0; j < t->n; j++) {
                t->matrix[t->n * i + j] = uniform(seed, -0.5, 0.5) + (i == j ? 1.5 : 0);
                l->G[LIMB * (t->motor + i) + order[t->motor + j]] = t->matrix[t->n * i + j];
            }
        }
    }
    if (coupled < l->n) {
        l->motors[coupled].joint = limb_joints[order[coupled]];
        l->G[LIMB * coupled + order[coupled]] = 1;
    }
}

/* Energy of the bodies, and of rotors and springs. */
static double limb_energy(driven *d, const limb *l) {
    double M[LIMB * LIMB], angle[LIMB], speed[LIMB], energy = 0;
    ck_assert_int_eq(rbd_crba(d->r.m, d->r.w, d->q, M), RBD_OK);
    ck_assert_int_eq(rbd_actuators_map(d->a, d->q, d->v, angle, speed), RBD_OK);
    for (int i = 0; i < l->n; i++) {
        const rbd_motor *m = &l->motors[i];
        rbd_actuator_state s;
        ck_assert_int_eq(rbd_actuators_get(d->a, i, &s), RBD_OK);
        const double y = m->stiffness > 0 ? s.speed : speed[i];
        const double wound = larger(0, fabs(s.angle - angle[i]) - m->backlash / 2);
        energy += m->gear * m->gear * m->inertia * y * y / 2;
        if (m->stiffness > 0) energy += m->stiffness * wound * wound / 2;
        for (int j = 0; j < l->n; j++) energy += d->v[i] * M[l->n * i + j] * d->v[j] / 2;
    }
    return energy;
}

/* A step, in which the momentum changes by the shafts' torques: M (v_next - v) = dt G'T. */
static void step_limb(driven *d, const limb *l, double dt) {
    double M[LIMB * LIMB], v[LIMB], T[LIMB];
    const int n = l->n;
    ck_assert_int_eq(rbd_crba(d->r.m, d->r.w, d->q, M), RBD_OK);
    memcpy(v, d->v, sizeof v);
    step(d, dt);
    for (int i = 0; i < n; i++) {
        rbd_actuator_state s;
        ck_assert_int_eq(rbd_actuators_get(d->a, i, &s), RBD_OK);
        T[i] = s.joint;
    }
    for (int j = 0; j < n; j++) {
        double rest = 0, size = 1;
        for (int i = 0; i < n; i++) {
            rest += M[n * j + i] * (d->v[i] - v[i]) - dt * l->G[LIMB * i + j] * T[i];
            size += fabs(M[n * j + i] * v[i]) + dt * fabs(l->G[LIMB * i + j] * T[i]);
        }
        ck_assert_msg(fabs(rest) <= 1e-10 * size, "%g of %g", rest, size);
    }
}

/* No motor drives them: each step settles, in few repeats, and none adds energy. */
START_TEST(transmissions_along_one_limb_settle_and_make_no_energy) {
    uint64_t seed = 77;
    int made = 0, repeats = 0;
    for (int k = 0; k < 40; k++) {
        const double dt = steps[k % 3];
        limb l;
        draw_limb(&seed, &l);
        driven d = drive("limb", l.bodies, l.n, l.motors, l.n, l.t, l.groups, NULL, 0,
                         below(&seed, 2) ? &first_order : NULL);
        const double down[3] = {0};
        ck_assert_int_eq(rbd_set_gravity(d.r.w, down), RBD_OK);
        for (int i = 0; i < l.n; i++) d.v[i] = uniform(&seed, -3, 3);
        const double first = limb_energy(&d, &l);
        double last = first;
        for (int n = 0; n < 100; n++) {
            step_limb(&d, &l, dt);
            const double energy = limb_energy(&d, &l);
            ck_assert_msg(energy <= last + 1e-10 * first, "%g J of %g, %d shafts, step %d of %g s",
                          energy - last, first, l.n, n, dt);
            last = energy;
            made++;
        }
        ck_assert_int_eq(d.unsettled, 0);
        repeats += d.repeats;
        drive_free(&d);
    }
    ck_assert_msg(repeats < 2 * made, "%d repeats in %d steps", repeats, made);
}
END_TEST

/* The same motion as with friction in rows of the contact step: a leg with a belt that sticks and slides. */
START_TEST(coupled_shafts_move_as_by_rows) {
    const double dt = steps[_i];
    const double G[4] = {1, 0, 1, 1};
    const rbd_contact_options rows = {.first_order = 1, .rows = 2, .tolerance = 1e-13, .iterations = 200};
    const rbd_gear_friction friction[2] = {{.coulomb = 6}, {.coulomb = 2}};
    const rbd_motor plain = {.gear = 50, .constant = 1, .friction = {.viscous = 3}};
    const rbd_motor without[2] = {plain, plain};
    rbd_motor motors[2] = {plain, plain};
    double load[2] = {0}, most = 0;
    int stuck = 0;
    for (int i = 0; i < 2; i++) motors[i].friction.coulomb = friction[i].coulomb;
    driven d = drive("leg", leg, 2, motors, 2, &belt, 1, NULL, 0, &first_order);
    driven e = drive("leg", leg, 2, without, 2, &belt, 1, NULL, 0, &rows);
    d.q[0] = e.q[0] = 0.3, d.q[1] = e.q[1] = -0.7;
    for (int k = 0; k * dt < 1; k++) {
        for (int j = 0; j < 2; j++) d.other[j] = e.other[j] = -40 * d.q[j] + 25 * sin(5 * k * dt);
        step(&d, dt);
        step_by_rows(&e, friction, G, 2, load, dt);
        for (int j = 0; j < 2; j++) most = larger(most, fabs(d.q[j] - e.q[j]));
        stuck += (fabs(d.v[0]) < 1e-8) != (fabs(d.v[0] + d.v[1]) < 1e-8);
    }
    ck_assert_int_gt(stuck, (int)(0.05 / dt));
    ck_assert_int_eq(d.unsettled, 0);
    drive_free(&d), drive_free(&e);
    ck_assert_msg(most < 1e-8, "%g rad", most);
}
END_TEST

/* What was learnt of the joints' inertia is forgotten where it makes speeds without bound: the step is asked
   for once more, and settles at the same speeds as that of actuators that learnt nothing wrong. A step that
   fails twice ends. */
START_TEST(coupled_shafts_forget_what_makes_no_sense) {
    const rbd_motor motors[2] = {{.gear = 50, .constant = 1, .friction = {.coulomb = 2, .viscous = 1}},
                                 {.gear = 50, .constant = 1, .friction = {.coulomb = 1, .viscous = 1}}};
    const double far[2] = {3e12, -2e11}, none[2] = {NAN, 0}, dt = 1e-3;
    driven d = drive("leg", leg, 2, motors, 2, &belt, 1, NULL, 0, NULL);
    double q[2], v[2], tau[2], damping[2];
    d.v[0] = 2, d.v[1] = -1;
    for (int k = 0; k < 5; k++) step(&d, dt);

    ck_assert_int_eq(rbd_actuators_begin(d.a, d.command, d.q, d.v, dt, 0, tau, damping), RBD_OK);
    ck_assert_int_eq(rbd_actuators_again(d.a, far, tau, damping), 1);
    do {
        for (int i = 0; i < 2; i++) ck_assert(fabs(tau[i]) < 1e3 && damping[i] >= 0 && damping[i] < 1e12);
        ck_assert_int_eq(rbd_contact_step(d.r.m, d.c, d.q, d.v, tau, NULL, damping, dt, q, v), RBD_OK);
    } while (rbd_actuators_again(d.a, v, tau, damping));
    ck_assert_int_eq(rbd_actuators_begin(d.a, d.command, d.q, d.v, dt, 0, tau, damping), RBD_OK);
    ck_assert_int_eq(rbd_actuators_again(d.a, none, tau, damping), 1);
    ck_assert_int_eq(rbd_actuators_again(d.a, none, tau, damping), 0);

    step(&d, dt);
    ck_assert_int_eq(d.unsettled, 0);
    for (int i = 0; i < 2; i++) ck_assert(fabs(d.v[i] - v[i]) < 1e-9);
    drive_free(&d);
}
END_TEST

/* Power on both sides is the same, and the inverse undoes the matrix. */
START_TEST(a_matrix_keeps_the_power) {
    const rbd_motor motors[2] = {{.gear = 2, .constant = 1}, {.gear = 3, .constant = 1}};
    driven d = drive("leg", leg, 2, motors, 2, &belt, 1, NULL, 0, NULL);
    const double tau[2] = {3, -5}, zero[2] = {0}, v[2] = {0.5, 2}, q[2] = {0.1, 0.2};
    double angle[2], speed[2];
    rbd_drive o[2];
    ck_assert_int_eq(rbd_actuators_map(d.a, q, v, angle, speed), RBD_OK);
    ck_assert(fabs(angle[0] - 0.1) < 1e-15 && fabs(angle[1] - 0.3) < 1e-15);
    ck_assert_int_eq(rbd_actuators_inverse(d.a, q, v, zero, tau, o), RBD_OK);
    ck_assert(fabs(o[0].torque * speed[0] + o[1].torque * speed[1] - (tau[0] * v[0] + tau[1] * v[1])) <
              1e-14);
    ck_assert(fabs(o[0].torque - 8) < 1e-14 && fabs(o[1].torque + 5) < 1e-14);
    drive_free(&d);
}
END_TEST

/* A floating shank with a foot on two joints that two cranks move, and one on a single joint with one
   crank. */
static const rbd_body shank_and_foot[3] = {{.name = "shank",
                                            .joint = "base",
                                            .parent = -1,
                                            .type = RBD_FLOATING,
                                            .mass = 4,
                                            .com = {0.01, 0, -0.2},
                                            .inertia = {0.05, 0, 0.001, 0.05, 0, 0.01}},
                                           {.name = "cross",
                                            .joint = "pitch",
                                            .parent = 0,
                                            .type = RBD_REVOLUTE,
                                            .axis = {0, 2, 0},
                                            .position = {0.02, 0, -0.4},
                                            .rotation = {0.8, 0, 0.6, 0, 1, 0, -0.6, 0, 0.8},
                                            .mass = 0.1,
                                            .com = {0.04, 0.01, -0.04},
                                            .inertia = {0.002, 0, 0.0003, 0.005, 0, 0.005}},
                                           {.name = "foot",
                                            .joint = "roll",
                                            .parent = 1,
                                            .type = RBD_REVOLUTE,
                                            .axis = {0.8, 0, 0.6},
                                            .position = {0.018, 0, -0.024},
                                            .mass = 1.2,
                                            .com = {0.04, 0.01, -0.04},
                                            .inertia = {0.002, 0, 0.0003, 0.005, 0, 0.005}}};
static const rbd_transmission ankles[2] = {{.name = "ankle",
                                            .kind = RBD_BY_RODS,
                                            .n = 2,
                                            .joint = {"pitch", "roll"},
                                            .rod = {{.place = {0, 0.05, -0.1},
                                                     .axis = {0, 1, 0},
                                                     .zero = {-1, 0, 0},
                                                     .crank = 0.06,
                                                     .length = 0.3,
                                                     .point = {-0.046, 0.045, -0.022},
                                                     .elbow = 1},
                                                    {.place = {0, -0.05, -0.15},
                                                     .axis = {0, 1, 0},
                                                     .zero = {-1, 0, 0},
                                                     .crank = 0.065,
                                                     .length = 0.26,
                                                     .point = {-0.053, -0.045, -0.021},
                                                     .elbow = 1}}},
                                           {.name = "rocker",
                                            .kind = RBD_BY_RODS,
                                            .n = 1,
                                            .joint = {"pitch"},
                                            .rod = {{.place = {0, 0.05, -0.1},
                                                     .axis = {0, 1, 0},
                                                     .zero = {-1, 0, 0},
                                                     .crank = 0.04,
                                                     .length = 0.3,
                                                     .point = {-0.046, 0.05, -0.022},
                                                     .elbow = 1}}}};
static const rbd_motor cranks[2] = {{.gear = 1, .constant = 1, .inertia = 0.02},
                                    {.gear = 1, .constant = 1, .inertia = 0.03}};

/* Speeds and bias of the map are the differences of its angles. */
START_TEST(rods_have_the_derivatives_of_their_angles) {
    driven d = drive("ankle", shank_and_foot, 3 - _i, cranks, 2 - _i, &ankles[_i], 1, NULL, 0, NULL);
    uint64_t seed = 5;
    for (int k = 0; k < 300; k++) {
        double q[MAX_Q], v[MAX_V], high[2], low[2], speed[2];
        const double h = 1e-6;
        memcpy(q, d.q, sizeof q);
        for (int i = 0; i < d.r.nv; i++) v[i] = uniform(&seed, -2, 2);
        q[7] = uniform(&seed, -0.35, 0.35), q[8] = uniform(&seed, -0.2, 0.2);
        ck_assert_int_eq(rbd_actuators_map(d.a, q, v, low, speed), RBD_OK);
        double next[MAX_Q], back[MAX_Q], step_v[MAX_V];
        for (int i = 0; i < d.r.nv; i++) step_v[i] = v[i];
        ck_assert_int_eq(rbd_integrate(d.r.m, q, step_v, h, next), RBD_OK);
        ck_assert_int_eq(rbd_integrate(d.r.m, q, step_v, -h, back), RBD_OK);
        ck_assert_int_eq(rbd_actuators_map(d.a, next, NULL, high, NULL), RBD_OK);
        ck_assert_int_eq(rbd_actuators_map(d.a, back, NULL, low, NULL), RBD_OK);
        for (int i = 0; i < 2 - _i; i++)
            ck_assert(fabs((high[i] - low[i]) / (2 * h) - speed[i]) < 1e-8 * (1 + fabs(speed[i])));
    }
    drive_free(&d);
}
END_TEST

/* The same mechanism with cranks and rods as bodies, whose rods weigh `mass`, closed by loops. */
typedef struct loop {
    robot r;
    rbd_body bodies[8];
    rbd_constraint_set *set;
    void *memory;
    int joints;
} loop;

static void close_loops(loop *l, const rbd_transmission *t, double mass) {
    rbd_constraint list[2];
    int n = 1 + t->n;
    l->joints = t->n;
    memcpy(l->bodies, shank_and_foot, sizeof shank_and_foot);
    for (int i = 0; i < t->n; i++) {
        const rbd_rod *rod = &t->rod[i];
        static const char *const names[4] = {"crank 0", "crank 1", "rod 0", "rod 1"};
        const double L = rod->length;
        rbd_body *crank = &l->bodies[n++], *link = &l->bodies[n++];
        memset(crank, 0, sizeof *crank);
        *crank = (rbd_body){.name = names[i],
                            .parent = 0,
                            .type = RBD_REVOLUTE,
                            .axis = {0, 0, 1},
                            .armature = {cranks[i].inertia}};
        const double *x = rod->zero, *z = rod->axis;
        const double y[3] = {z[1] * x[2] - z[2] * x[1], z[2] * x[0] - z[0] * x[2], z[0] * x[1] - z[1] * x[0]};
        for (int k = 0; k < 3; k++) {
            crank->position[k] = rod->place[k];
            crank->rotation[3 * k] = x[k], crank->rotation[3 * k + 1] = y[k],
                                crank->rotation[3 * k + 2] = z[k];
        }
        *link = (rbd_body){.name = names[2 + i],
                           .parent = n - 2,
                           .type = RBD_SPHERICAL,
                           .position = {rod->crank, 0, 0},
                           .mass = mass,
                           .com = {L / 2, 0, 0},
                           .inertia = {mass * 1e-3, 0, 0, mass * L * L / 12, 0, mass * L * L / 12}};
        list[i] = rbd_ball_loop(n - 1, (const double[3]){L, 0, 0}, t->n, rod->point);
    }
    l->r = robot_build("ankle with loops", l->bodies, n);
    const size_t size = rbd_constraint_set_size(l->r.m, list, t->n);
    l->memory = malloc(size);
    ck_assert_int_eq(rbd_constraint_set_init(l->r.m, l->r.w, list, t->n, l->memory, size, &l->set, NULL),
                     RBD_OK);
}

/* Accelerations of the loops in the state of the open chain; the closure and the cranks' speeds are
   compared. */
static void loop_acceleration(loop *l, const rbd_transmission *t, const double *q, const double *v,
                              const double *angle, const double *speed, const double *torque, double *a) {
    double all_q[MAX_Q] = {0}, all_v[MAX_V] = {0}, near_q[MAX_Q], near_v[MAX_V], tau[MAX_V] = {0},
           full[MAX_V];
    double e[6], weight[MAX_V];
    const int nv = 6 + t->n;
    memcpy(all_q, q, (size_t)(7 + t->n) * sizeof *q);
    memcpy(all_v, v, (size_t)nv * sizeof *v);
    for (int i = 0; i < l->r.nv; i++) weight[i] = i < nv ? 1e16 : 1; /* the open chain stays */
    for (int i = 0; i < t->n; i++) {
        all_q[7 + t->n + 5 * i] = angle[i];
        all_q[7 + t->n + 5 * i + 4] = 1;
        all_v[nv + 4 * i] = speed[i];
        weight[nv + 4 * i] = 1e8;
    }
    for (int i = 0; i < t->n; i++) { /* a first guess: the rod along the line to its end */
        double p[3], C[3], R[9];
        ck_assert_int_eq(rbd_kinematics(l->r.m, l->r.w, all_q, NULL, NULL), RBD_OK);
        ck_assert_int_eq(rbd_point_position(l->r.m, l->r.w, t->n, t->rod[i].point, p), RBD_OK);
        ck_assert_int_eq(rbd_body_pose(l->r.m, l->r.w, 1 + t->n + 2 * i + 1, R, C), RBD_OK);
        double dir[3] = {0}, length = 0, qu[4], norm;
        for (int k = 0; k < 3; k++)
            for (int j = 0; j < 3; j++)
                dir[k] += R[3 * j + k] * (p[j] - C[j]); /* in the rod's axes at q = 0 */
        length = sqrt(dir[0] * dir[0] + dir[1] * dir[1] + dir[2] * dir[2]);
        ck_assert(fabs(length - t->rod[i].length) < 1e-14);
        qu[0] = 0, qu[1] = -dir[2], qu[2] = dir[1], qu[3] = length + dir[0];
        norm = sqrt(qu[1] * qu[1] + qu[2] * qu[2] + qu[3] * qu[3]);
        for (int k = 0; k < 4; k++) all_q[7 + t->n + 5 * i + 1 + k] = qu[k] / norm;
        tau[nv + 4 * i] = torque[i];
    }
    ck_assert_int_eq(rbd_assemble(l->r.m, l->set, all_q, all_v, weight, near_q, near_v), RBD_OK);
    for (int i = 0; i < t->n; i++) ck_assert(fabs(near_v[nv + 4 * i] - speed[i]) < 1e-9);
    for (int i = 0; i < nv; i++) ck_assert(fabs(near_v[i] - v[i]) < 1e-12);
    ck_assert_int_eq(rbd_constraint_jacobian(l->r.m, l->set, near_q, near_v, NULL, NULL, e), RBD_OK);
    ck_assert(largest(e, 3 * t->n) < 1e-12);
    ck_assert_int_eq(rbd_constrained_fd(l->r.m, l->set, near_q, near_v, tau, NULL, full, NULL), RBD_OK);
    memcpy(a, full, (size_t)nv * sizeof *a);
}

/* Accelerations of the open chain with M + G' J G, and the bias G' J b, from the map alone: rods without
   mass. The loops' rods weigh 0.1, 0.2 and 0.4 g, extrapolated to 0. The forward law with dt -> 0 is the
   same. */
START_TEST(rods_are_the_loops_of_the_same_mechanism) {
    const rbd_transmission *t = &ankles[_i];
    driven d = drive("ankle", shank_and_foot, 1 + t->n, cranks, t->n, t, 1, NULL, 0, NULL);
    const int nv = d.r.nv;
    loop loops[3];
    uint64_t seed = 5;
    for (int k = 0; k < 3; k++) close_loops(&loops[k], t, 1e-4 * (1 << k));
    for (int s = 0; s < 100 / PART_OF_TREES + 1; s++) {
        double q[MAX_Q], v[MAX_V], torque[2], angle[2], speed[2], a[3][MAX_V], M[MAX_V * MAX_V], c[MAX_V],
            x[MAX_V];
        double G[2][2], zero[MAX_V] = {0}, tau[MAX_V], factor[MAX_V * MAX_V];
        rbd_drive o[2];
        rbd_random(d.r.m, &seed, q);
        for (int i = 0; i < 3; i++) q[i] = uniform(&seed, -1, 1);
        q[7] = uniform(&seed, -0.35, 0.35), q[8] = uniform(&seed, -0.2, 0.2);
        for (int i = 0; i < nv; i++) v[i] = uniform(&seed, -2, 2);
        for (int i = 0; i < 2; i++) torque[i] = uniform(&seed, -10, 10);
        ck_assert_int_eq(rbd_actuators_map(d.a, q, v, angle, speed), RBD_OK);
        for (int k = 0; k < 3; k++) {
            loop_acceleration(&loops[k], t, q, v, angle, speed, torque, a[k]);
        }

        /* G and the bias from the inverse: u = G^-T tau + J (G v' + b) */
        for (int j = 0; j < t->n; j++) {
            double unit[MAX_V] = {0}, none[2];
            unit[6 + j] = 1;
            ck_assert_int_eq(rbd_actuators_map(d.a, q, unit, none, x), RBD_OK);
            for (int i = 0; i < t->n; i++) G[i][j] = x[i];
        }
        ck_assert_int_eq(rbd_actuators_inverse(d.a, q, v, zero, zero, o), RBD_OK);
        ck_assert_int_eq(rbd_crba(d.r.m, d.r.w, q, M), RBD_OK);
        ck_assert_int_eq(rbd_bias(d.r.m, d.r.w, q, v, NULL, c), RBD_OK);
        for (int i = 0; i < nv; i++) tau[i] = -c[i];
        for (int i = 0; i < t->n; i++)
            for (int j = 0; j < t->n; j++) {
                tau[6 + j] += G[i][j] * (torque[i] - o[i].torque); /* o is J b */
                for (int k = 0; k < t->n; k++)
                    M[(6 + j) * nv + 6 + k] += G[i][j] * cranks[i].inertia * G[i][k];
            }
        ck_assert_int_eq(rbd_cholesky_factor(d.r.m, d.r.w, M, factor), RBD_OK);
        ck_assert_int_eq(rbd_cholesky_solve(d.r.m, d.r.w, factor, tau, x), RBD_OK);
        double size = largest(x, nv);
        for (int i = 0; i < nv; i++) {
            const double massless = (8 * a[0][i] - 6 * a[1][i] + a[2][i]) / 3;
            ck_assert_msg(fabs(massless - x[i]) < 1e-10 * size, "dof %d: %.14g, not %.14g", i, x[i],
                          massless);
        }
    }
    for (int k = 0; k < 3; k++) robot_free(&loops[k].r), free(loops[k].memory);
    drive_free(&d);
}
END_TEST

/* A rod that does not reach, and one at its dead centre: the transmission is named. */
START_TEST(rods_out_of_reach_are_errors) {
    driven d = drive("ankle", shank_and_foot, 2, cranks, 1, &ankles[1], 1, NULL, 0, NULL);
    double angle[2];
    int missed = 0;
    for (int k = 0; k < 63; k++) {
        d.q[7] = 0.1 * k - 3.1;
        const rbd_status status = rbd_actuators_map(d.a, d.q, NULL, angle, NULL);
        ck_assert(status == RBD_OK || status == RBD_ERR_INFEASIBLE);
        ck_assert_int_eq(rbd_actuators_fault(d.a), status ? 0 : -1);
        missed += status != RBD_OK;
        if (status)
            ck_assert_int_eq(rbd_actuators_begin(d.a, d.command, d.q, d.v, 1e-3, 0, d.tau, d.damping),
                             status);
    }
    ck_assert_int_gt(missed, 5);
    drive_free(&d);
}
END_TEST

/* Each array that a call needs is missed by its status. */
START_TEST(calls_without_their_arrays_are_refused) {
    driven d = drive("ankle", shank_and_foot, 2, cranks, 1, &ankles[1], 1, NULL, 0, NULL);
    double one[4];
    rbd_actuator_state s;
    rbd_drive o[2];
#define NEEDS(call) ck_assert_int_eq(call, RBD_ERR_NULL)

    NEEDS(rbd_actuators_map(NULL, d.q, NULL, one, NULL));
    NEEDS(rbd_actuators_map(d.a, NULL, NULL, one, NULL));
    NEEDS(rbd_actuators_inverse(NULL, d.q, d.v, d.v, d.tau, o));
    NEEDS(rbd_actuators_inverse(d.a, NULL, d.v, d.v, d.tau, o));
    NEEDS(rbd_actuators_inverse(d.a, d.q, NULL, d.v, d.tau, o));
    NEEDS(rbd_actuators_inverse(d.a, d.q, d.v, NULL, d.tau, o));
    NEEDS(rbd_actuators_inverse(d.a, d.q, d.v, d.v, NULL, o));
    NEEDS(rbd_actuators_inverse(d.a, d.q, d.v, d.v, d.tau, NULL));
    NEEDS(rbd_actuators_reset(NULL, d.q, 25));
    NEEDS(rbd_actuators_reset(d.a, NULL, 25));
    NEEDS(rbd_actuators_begin(NULL, d.command, d.q, d.v, 1e-3, 0, d.tau, d.damping));
    NEEDS(rbd_actuators_begin(d.a, NULL, d.q, d.v, 1e-3, 0, d.tau, d.damping));
    NEEDS(rbd_actuators_begin(d.a, d.command, NULL, d.v, 1e-3, 0, d.tau, d.damping));
    NEEDS(rbd_actuators_begin(d.a, d.command, d.q, NULL, 1e-3, 0, d.tau, d.damping));
    NEEDS(rbd_actuators_begin(d.a, d.command, d.q, d.v, 1e-3, 0, NULL, d.damping));
    NEEDS(rbd_actuators_begin(d.a, d.command, d.q, d.v, 1e-3, 0, d.tau, NULL));
    NEEDS(rbd_actuators_get(NULL, 0, &s));
    NEEDS(rbd_actuators_get(d.a, 0, NULL));
    drive_free(&d);
#undef NEEDS
}
END_TEST

/* ---- derivatives ---- */

/* Ends a step, and leaves the shafts as they are. */
static const double no_number[MAX_V] = {NAN};

/* tau - damping v of a step that is next to nothing is the torque in continuous time. */
static void torque_at(driven *d, const double *q, const double *v, double *tau) {
    ck_assert_int_eq(rbd_actuators_begin(d->a, d->command, q, v, 1e-9, 0, d->tau, d->damping), RBD_OK);
    for (int k = 0; k < d->r.nv; k++) tau[k] = d->tau[k] - d->damping[k] * v[k];
    ck_assert_int_eq(rbd_actuators_again(d->a, no_number, d->tau, d->damping), 0);
}

static void expect_derivatives(driven *d, int n, const double *q, const double *v) {
    double dq[MAX_V * MAX_V], dv[MAX_V * MAX_V], dcommand[MAX_V * 2], plus[MAX_V], minus[MAX_V];
    const int nv = d->r.nv;
    ck_assert_int_eq(rbd_actuators_begin(d->a, d->command, q, v, 1e-9, 0, d->tau, d->damping), RBD_OK);
    for (int k = 0; k < nv * nv; k++) dq[k] = dv[k] = NAN;
    for (int k = 0; k < nv * n; k++) dcommand[k] = NAN;
    ck_assert_int_eq(rbd_actuators_derivatives(d->a, dq, dv, dcommand), RBD_OK);
    ck_assert_int_eq(rbd_actuators_again(d->a, no_number, d->tau, d->damping), 0);
    ck_assert_int_eq(rbd_actuators_derivatives(d->a, dq, dv, dcommand), RBD_ERR_ORDER);
    for (int k = 0; k < nv; k++) {
        const double h = 1e-5;
        double unit[MAX_V] = {0}, moved[MAX_Q], speeds[MAX_V];
        unit[k] = 1;
        rbd_integrate(d->r.m, q, unit, h, moved), torque_at(d, moved, v, plus);
        rbd_integrate(d->r.m, q, unit, -h, moved), torque_at(d, moved, v, minus);
        for (int j = 0; j < nv; j++)
            ck_assert(fabs((plus[j] - minus[j]) / (2 * h) - dq[nv * j + k]) <
                      1e-6 * (1 + fabs(dq[nv * j + k])));
        memcpy(speeds, v, sizeof speeds);
        speeds[k] = v[k] + h, torque_at(d, q, speeds, plus);
        speeds[k] = v[k] - h, torque_at(d, q, speeds, minus);
        for (int j = 0; j < nv; j++)
            ck_assert(fabs((plus[j] - minus[j]) / (2 * h) - dv[nv * j + k]) <
                      1e-6 * (1 + fabs(dv[nv * j + k])));
    }
    for (int i = 0; i < n; i++) {
        const double torque = d->command[i].torque;
        d->command[i].torque = torque + 1, torque_at(d, q, v, plus);
        d->command[i].torque = torque - 1, torque_at(d, q, v, minus);
        d->command[i].torque = torque;
        for (int j = 0; j < nv; j++) ck_assert(fabs((plus[j] - minus[j]) / 2 - dcommand[n * j + i]) < 1e-7);
    }
}

START_TEST(derivatives_are_those_of_differences) {
    rbd_motor motors[2];
    uint64_t seed = 9;
    for (int i = 0; i < 2; i++)
        motors[i] = (rbd_motor){.gear = 10, .constant = 1, .friction = {.viscous = 0.7, .coulomb = 0.3}};
    if (_i == 2) motors[0].stiffness = 500, motors[0].damping = 2, motors[0].inertia = 1e-3;
    if (_i == 3) motors[1].voltage = 10, motors[1].resistance = 1;
    if (_i == 4) motors[0].joint = "hip", motors[1].joint = "knee";
    const rbd_transmission *t = _i == 1 ? &belt : &ankles[0];
    driven d = _i == 1   ? drive("leg", leg, 2, motors, 2, t, 1, NULL, 0, NULL)
               : _i == 4 ? drive("leg", leg, 2, motors, 2, NULL, 0, NULL, 0, NULL)
                         : drive("ankle", shank_and_foot, 3, motors, 2, t, 1, NULL, 0, NULL);
    for (int k = 0; k < 20; k++) {
        double q[MAX_Q], v[MAX_V];
        rbd_neutral(d.r.m, q);
        ck_assert_int_eq(rbd_actuators_reset(d.a, q, 25), RBD_OK);
        q[d.r.nq - 2] = uniform(&seed, -0.25, 0.25), q[d.r.nq - 1] = uniform(&seed, -0.2, 0.2);
        for (int i = 0; i < d.r.nv; i++) v[i] = uniform(&seed, 1, 3);
        for (int i = 0; i < 2; i++)
            d.command[i] = (rbd_command){.q = 1, .kp = 50, .kd = 2, .torque = _i == 3 ? 900 : 3 - 7 * i};
        expect_derivatives(&d, 2, q, v);
    }
    drive_free(&d);
}
END_TEST

/* ---- rotors ---- */

/* The robot with rotors as bodies that follow their joints, beside the robot whose links carry them at a
   standstill and whose joints have armature. */
typedef struct spinning {
    rbd_body locked[40], free[40];
    rbd_rotor rotor[20];
    char name[80][24];
    int n, n_locked, n_free;
} spinning;

static void add_rotors(spinning *s, const rbd_body *bodies, int nb, double gear, double inertia) {
    s->n = 0;
    s->n_locked = s->n_free = nb;
    memcpy(s->locked, bodies, (size_t)nb * sizeof *bodies),
        memcpy(s->free, bodies, (size_t)nb * sizeof *bodies);
    for (int i = 0; i < nb; i++) {
        const rbd_body *b = &bodies[i];
        if (b->type != RBD_REVOLUTE && b->type != RBD_CONTINUOUS) continue;
        rbd_body r = {.parent = b->parent, .mass = 0.3};
        const double *e = b->axis, across = 0.7 * inertia, length2 = dot(e, e, 3);
        for (int k = 0; k < 3; k++) r.position[k] = b->position[k] + 0.01 * (k - 1) + 0.02;
        memcpy(r.rotation, b->rotation, sizeof r.rotation);
        for (int j = 0, at = 0; j < 3; j++)
            for (int k = j; k < 3; k++, at++)
                r.inertia[at] = across * (j == k) + (inertia - across) * e[j] * e[k] / length2;
        r.name = s->name[2 * i];
        snprintf(s->name[2 * i], sizeof s->name[0], "rotor %d", i);
        if (b->parent >= 0) s->locked[s->n_locked] = r, s->locked[s->n_locked++].type = RBD_FIXED;
        r.type = RBD_REVOLUTE, r.mimic = b->joint, r.mimic_ratio = gear, r.joint = s->name[2 * i + 1];
        memcpy(r.axis, e, sizeof r.axis);
        snprintf(s->name[2 * i + 1], sizeof s->name[0], "spin %d", i);
        s->free[s->n_free++] = r;
        s->locked[i].armature[0] = gear * gear * inertia;
        rbd_rotor *rotor = &s->rotor[s->n++];
        *rotor = (rbd_rotor){.body = b->parent, .gear = gear, .inertia = inertia};
        int identity = 1;
        for (int k = 0; k < 9; k++) identity &= b->rotation[k] == 0;
        for (int k = 0; k < 3; k++) rotor->axis[k] = identity ? e[k] : dot(&b->rotation[3 * k], e, 3);
    }
}

START_TEST(rotors_are_those_bodies) {
    const struct {
        const char *name;
        const rbd_body *bodies;
        int nb;
        double gear, inertia;
    } of[3] = {{"iiwa", iiwa_bodies, IIWA_NB, 160, 1.3e-4},
               {"iiwa", iiwa_bodies, IIWA_NB, -1, 2e-3},
               {"HyQ", hyq_bodies, HYQ_NB, 9, 1e-3}};
    spinning s;
    uint64_t seed = 7;
    double armature_error = 0, slow_error = 0;
    add_rotors(&s, of[_i].bodies, of[_i].nb, of[_i].gear, of[_i].inertia);
    robot a = robot_build(of[_i].name, s.locked, s.n_locked),
          b = robot_build("with rotors", s.free, s.n_free);
    ck_assert_int_eq(a.nv, b.nv);
    for (int i = 0, k = 0; k < s.n; i++)
        if (s.locked[rbd_dof_body(a.m, i)].armature[0] > 0) s.rotor[k++].dof = i;
    for (int t = 0; t < 100; t++) {
        double q[MAX_Q], v[MAX_V], acc[MAX_V], f_ext[6 * 40] = {0}, all[6 * 40] = {0}, found[MAX_V],
                                                         expected[MAX_V], without[MAX_V];
        rbd_random(a.m, &seed, q);
        for (int i = 0; i < a.nv; i++) v[i] = uniform(&seed, -3, 3), acc[i] = uniform(&seed, -20, 20);
        for (int i = 0; i < 6; i++) f_ext[6 + i] = all[6 + i] = uniform(&seed, -5, 5);
        ck_assert_int_eq(rbd_rnea(b.m, b.w, q, v, acc, all, expected), RBD_OK);
        ck_assert_int_eq(rbd_rnea(a.m, a.w, q, v, acc, all, without), RBD_OK);
        ck_assert_int_eq(rbd_rotor_torque(a.m, a.w, s.rotor, s.n, q, v, acc, f_ext, found), RBD_OK);
        ck_assert(relative_error(found, expected, a.nv) < 1e-12);
        armature_error = larger(armature_error, relative_error(without, expected, a.nv));

        /* in slow motion: what docs/actuators.md says */
        for (int i = 0; i < a.nv; i++) v[i] /= 2, acc[i] /= 4;
        ck_assert_int_eq(rbd_rnea(b.m, b.w, q, v, acc, NULL, expected), RBD_OK);
        ck_assert_int_eq(rbd_rnea(a.m, a.w, q, v, acc, NULL, without), RBD_OK);
        for (int i = 0; i < a.nv; i++) slow_error = larger(slow_error, fabs(without[i] - expected[i]));
    }
    ck_assert(armature_error > 1e-5);
    if (_i == 0) ck_assert(slow_error > 0.1 && slow_error < 0.5);
    robot_free(&a), robot_free(&b);
}
END_TEST

START_TEST(bad_rotors_are_refused) {
    robot r = BUILD(iiwa_bodies);
    double q[7] = {0}, v[7] = {0}, f_ext[42] = {0}, tau[7];
    const rbd_rotor good = {.body = 0, .dof = 1, .axis = {0, 0, 1}, .gear = 2, .inertia = 1};
    rbd_rotor x;
#define REFUSES(status, change) \
    do { \
        x = good; \
        change; \
        ck_assert_int_eq(rbd_rotor_torque(r.m, r.w, &x, 1, q, v, v, f_ext, tau), status); \
    } while (0)
    REFUSES(RBD_OK, (void)0);
    REFUSES(RBD_ERR_INDEX, x.body = 7);
    REFUSES(RBD_ERR_INDEX, x.body = -2);
    REFUSES(RBD_ERR_INDEX, x.dof = 7);
    REFUSES(RBD_ERR_INDEX, x.dof = -1);
    REFUSES(RBD_ERR_AXIS, x.axis[2] = 0);
    REFUSES(RBD_ERR_AXIS, x.axis[1] = NAN);
    REFUSES(RBD_ERR_RANGE, x.inertia = -1);
    REFUSES(RBD_ERR_RANGE, x.inertia = NAN);
    REFUSES(RBD_ERR_RANGE, x.gear = INFINITY);
    REFUSES(RBD_ERR_RANGE, x.gear = 0);
    ck_assert_int_eq(rbd_rotor_torque(r.m, r.w, &good, -1, q, v, v, f_ext, tau), RBD_ERR_COUNT);
    ck_assert_int_eq(rbd_rotor_torque(r.m, r.w, NULL, 1, q, v, v, f_ext, tau), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_rotor_torque(r.m, NULL, &good, 1, q, v, v, f_ext, tau), RBD_ERR_NULL);
    robot_free(&r);
}
END_TEST

/* ---- arrays that a call is not given ---- */

/* A step that settles late: the wheel turns around against its dry friction. */
static driven drive_against_friction(void) {
    static const rbd_motor motor = {.joint = "axle", .gear = 1, .constant = 1, .friction = {.coulomb = 0.5}};
    driven d = drive_wheel(&motor);
    d.v[0] = 1e-3;
    d.other[0] = -20;
    return d;
}

/* A call of rbd_actuators_again that lacks an array says that no step is to be repeated, and does nothing:
   the step stays begun, and ends at the speed of one without such a call. */
START_TEST(a_repeat_without_its_arrays_does_nothing) {
    driven d = drive_against_friction(), undisturbed = drive_against_friction();
    const double dt = 1e-3, slow[1] = {-0.2};
    double tau[1], damping[1], seen[2];

    ck_assert_int_eq(rbd_actuators_begin(d.a, d.command, d.q, d.v, dt, 0, tau, damping), RBD_OK);
    seen[0] = tau[0], seen[1] = damping[0];
    ck_assert_int_eq(rbd_actuators_again(NULL, slow, tau, damping), 0);
    ck_assert_int_eq(rbd_actuators_again(d.a, NULL, tau, damping), 0);
    ck_assert_int_eq(rbd_actuators_again(d.a, slow, NULL, damping), 0);
    ck_assert_int_eq(rbd_actuators_again(d.a, slow, tau, NULL), 0);
    ck_assert(tau[0] == seen[0] && damping[0] == seen[1]);
    ck_assert_int_eq(rbd_actuators_map(d.a, d.q, d.v, NULL, NULL), RBD_ERR_ORDER);

    ck_assert_int_eq(rbd_actuators_again(d.a, slow, tau, damping), 1);
    ck_assert_int_eq(rbd_actuators_begin(d.a, d.command, d.q, d.v, dt, 0, tau, damping), RBD_OK);
    ck_assert(tau[0] == seen[0] && damping[0] == seen[1]);
    step(&d, dt);
    step(&undisturbed, dt);
    ck_assert(d.v[0] == undisturbed.v[0] && d.q[0] == undisturbed.q[0] && d.v[0] < 0);
    drive_free(&d);
    drive_free(&undisturbed);
}
END_TEST

/* Speeds that never settle end the step after 50 repeats; one that is no number there ends it without an
   answer. The shafts are those of before, and the next step is one. */
START_TEST(a_step_ends_after_its_last_repeat) {
    driven d = drive_against_friction();
    const double dt = 1e-3, none[1] = {NAN}, ways[2][1] = {{1}, {-1}};
    double tau[1], damping[1];
    rbd_actuator_state s;

    ck_assert_int_eq(rbd_actuators_begin(d.a, d.command, d.q, d.v, dt, 0, tau, damping), RBD_OK);
    for (int k = 0; k < 50; k++) {
        ck_assert_int_eq(rbd_actuators_again(d.a, ways[(k + 1) % 2], tau, damping), 1);
        ck_assert_int_eq(rbd_actuators_derivatives(d.a, NULL, NULL, NULL), RBD_ERR_ORDER);
    }
    ck_assert_int_eq(rbd_actuators_again(d.a, none, tau, damping), 0);
    ck_assert_int_eq(rbd_actuators_get(d.a, 0, &s), RBD_OK);
    ck_assert_int_eq(s.repeats, 50);
    ck_assert(s.angle == 0);
    ck_assert_int_eq(rbd_actuators_map(d.a, d.q, d.v, NULL, NULL), RBD_OK);

    step(&d, dt);
    ck_assert(d.v[0] < 0 && d.v[0] > -1);
    drive_free(&d);
}
END_TEST

/* Each array of derivatives alone has what all together have. */
static void expect_each_alone(driven *d, int n) {
    enum { MOST_ENTRIES = 9 * 9 };
    double all[3][MOST_ENTRIES], one[3][MOST_ENTRIES];
    const int nv = d->r.nv, size[3] = {nv * nv, nv * nv, nv * n};

    ck_assert_int_eq(rbd_actuators_begin(d->a, d->command, d->q, d->v, 1e-3, 0, d->tau, d->damping), RBD_OK);
    ck_assert_int_eq(rbd_actuators_derivatives(d->a, all[0], all[1], all[2]), RBD_OK);
    ck_assert_int_eq(rbd_actuators_derivatives(d->a, NULL, NULL, NULL), RBD_OK);
    for (int k = 0; k < 3; k++) {
        ck_assert_int_eq(rbd_actuators_derivatives(d->a, k == 0 ? one[0] : NULL, k == 1 ? one[1] : NULL,
                                                   k == 2 ? one[2] : NULL),
                         RBD_OK);
        for (int i = 0; i < size[k]; i++) ck_assert(one[k][i] == all[k][i]);
    }
}

START_TEST(derivatives_need_not_all_be_asked_for) {
    const rbd_motor direct[2] = {{.joint = "hip", .gear = 2, .constant = 1, .friction = {.viscous = 1}},
                                 {.joint = "knee", .gear = 2, .constant = 1, .delay = 1}};
    const rbd_motor coupled[2] = {{.gear = 2, .constant = 1, .friction = {.viscous = 1}},
                                  {.gear = 2, .constant = 1, .delay = 1}};
    for (int k = 0; k < 2; k++) {
        driven d = drive("leg", leg, 2, k ? coupled : direct, 2, &belt, k, NULL, 0, NULL);
        d.v[0] = 1, d.v[1] = -1;
        for (int i = 0; i < 2; i++) d.command[i] = (rbd_command){.kp = 20 + i, .kd = 3};
        expect_each_alone(&d, 2);
        drive_free(&d);
    }
}
END_TEST

/* A motor at rest has the slopes of its gains, and its friction that of `viscous`; of a command that comes
   later the torque has none. */
START_TEST(derivatives_at_rest_are_the_gains) {
    const double kp = 20, kd = 3, viscous = 0.5;
    for (int delay = 0; delay < 2; delay++) {
        const rbd_motor motor = {.joint = "axle",
                                 .gear = 2,
                                 .constant = 1,
                                 .delay = delay,
                                 .friction = {.coulomb = 1, .viscous = viscous}};
        driven d = drive_wheel(&motor);
        double dq[1], dv[1], dcommand[1];
        d.command[0] = (rbd_command){.kp = kp, .kd = kd};
        for (int k = 0; k < 2; k++) {
            ck_assert_int_eq(rbd_actuators_begin(d.a, d.command, d.q, d.v, 1e-3, 0, d.tau, d.damping),
                             RBD_OK);
            ck_assert_int_eq(rbd_actuators_derivatives(d.a, dq, dv, dcommand), RBD_OK);
            ck_assert_int_eq(rbd_actuators_again(d.a, d.v, d.tau, d.damping), 0);
        }
        ck_assert(dq[0] == -kp && dv[0] == -(kd + viscous) && dcommand[0] == (delay ? 0 : 1));
        drive_free(&d);
    }
}
END_TEST

/* Within the play of a gear nothing is felt of the joint; beyond it, the spring. */
START_TEST(derivatives_within_a_play_are_0) {
    const rbd_motor motor = {.joint = "axle",
                             .gear = 50,
                             .constant = 1,
                             .inertia = 2e-5,
                             .stiffness = 300,
                             .damping = 2,
                             .backlash = 0.02};
    const double at[3] = {0.005, 0.05, -0.05};
    driven d = drive_wheel(&motor);
    for (int k = 0; k < 3; k++) {
        double dq[1], dv[1], dcommand[1];
        d.q[0] = at[k];
        ck_assert_int_eq(rbd_actuators_begin(d.a, d.command, d.q, d.v, 1e-3, 0, d.tau, d.damping), RBD_OK);
        ck_assert_int_eq(rbd_actuators_derivatives(d.a, dq, dv, dcommand), RBD_OK);
        ck_assert(dq[0] == (k ? -300 : 0) && dv[0] == (k ? -2 : 0) && dcommand[0] == 0);
    }
    drive_free(&d);
}
END_TEST

START_TEST(rotors_without_their_arrays_are_refused) {
    robot r = BUILD(iiwa_bodies);
    const double q[7] = {0}, v[7] = {1, 2, 3}, acc[7] = {4, 5, 6};
    double f_ext[42] = {0}, tau[7], expected[7], seen[7];
    const rbd_rotor good = {.body = 0, .dof = 1, .axis = {0, 0, 1}, .gear = 2, .inertia = 1};
    rbd_rotor x = good;
    for (int i = 0; i < 7; i++) tau[i] = seen[i] = 100 + i;
#define NEEDS(call) ck_assert_int_eq(call, RBD_ERR_NULL)
    NEEDS(rbd_rotor_torque(NULL, r.w, &good, 1, q, v, acc, f_ext, tau));
    NEEDS(rbd_rotor_torque(r.m, r.w, &good, 1, NULL, v, acc, f_ext, tau));
    NEEDS(rbd_rotor_torque(r.m, r.w, &good, 1, q, NULL, acc, f_ext, tau));
    NEEDS(rbd_rotor_torque(r.m, r.w, &good, 1, q, v, NULL, f_ext, tau));
    NEEDS(rbd_rotor_torque(r.m, r.w, &good, 1, q, v, acc, NULL, tau));
    NEEDS(rbd_rotor_torque(r.m, r.w, &good, 1, q, v, acc, f_ext, NULL));
#undef NEEDS
    x.axis[0] = 2e9;
    ck_assert_int_eq(rbd_rotor_torque(r.m, r.w, &x, 1, q, v, acc, f_ext, tau), RBD_ERR_AXIS);
    x = good, x.inertia = 2e9;
    ck_assert_int_eq(rbd_rotor_torque(r.m, r.w, &x, 1, q, v, acc, f_ext, tau), RBD_ERR_RANGE);
    for (int i = 0; i < 42; i++) ck_assert(f_ext[i] == 0);
    ck_assert(memcmp(tau, seen, sizeof tau) == 0);

    /* none at all leave the inverse dynamics */
    ck_assert_int_eq(rbd_rnea(r.m, r.w, q, v, acc, NULL, expected), RBD_OK);
    ck_assert_int_eq(rbd_rotor_torque(r.m, r.w, NULL, 0, q, v, acc, f_ext, tau), RBD_OK);
    for (int i = 0; i < 7; i++) ck_assert(fabs(tau[i] - expected[i]) <= 1e-13 * (1 + fabs(expected[i])));
    robot_free(&r);
}
END_TEST

/* ---- singular cases ---- */

/* A rod in line with its crank, 0.625 + 0.125 from the crank's axis, which is as far as it reaches: there the
   crank has no speed by the joint's, and beside it too much. Farther off the joint turns either way. */
START_TEST(a_rod_at_its_dead_centre_is_named) {
    const rbd_transmission t = {.name = "rocker",
                                .kind = RBD_BY_RODS,
                                .n = 1,
                                .joint = {"hip"},
                                .rod = {{.place = {-0.25, 0, 0},
                                         .axis = {0, 1, 0},
                                         .zero = {1, 0, 0},
                                         .crank = 0.125,
                                         .length = 0.625,
                                         .point = {0.5, 0, 0},
                                         .elbow = 1}}};
    driven d = drive("leg", leg, 2, cranks, 1, &t, 1, NULL, 0, NULL);
    const double at[5] = {-0.3, -1e-7, 0, 1e-7, 0.3};
    rbd_drive o;
    double angle;
    for (int k = 0; k < LENGTH(at); k++) {
        const int dead = fabs(at[k]) < 1e-6;
        const rbd_status expected = dead ? RBD_ERR_SINGULAR : RBD_OK;
        d.q[0] = at[k];
        ck_assert_int_eq(rbd_actuators_map(d.a, d.q, NULL, &angle, NULL), expected);
        ck_assert_int_eq(rbd_actuators_fault(d.a), dead ? 0 : -1);
        ck_assert_int_eq(rbd_actuators_inverse(d.a, d.q, d.v, d.v, d.tau, &o), expected);
        ck_assert_int_eq(rbd_actuators_begin(d.a, d.command, d.q, d.v, 1e-3, 0, d.tau, d.damping), expected);
        ck_assert_int_eq(rbd_actuators_again(d.a, no_number, d.tau, d.damping), 0);
    }
    drive_free(&d);
}
END_TEST

/* A rod's end on the crank's axis, at its own length from the crank's end: every angle of the crank fits. */
START_TEST(a_rod_on_its_cranks_axis_has_no_angle) {
    const rbd_transmission t = {.kind = RBD_BY_RODS,
                                .n = 1,
                                .joint = {"hip"},
                                .rod = {{.place = {0.25, 0, 0},
                                         .axis = {0, 1, 0},
                                         .zero = {1, 0, 0},
                                         .crank = 0.375,
                                         .length = 0.625,
                                         .point = {0.25, 0.5, 0},
                                         .elbow = 1}}};
    driven d = drive("leg", leg, 2, cranks, 1, &t, 1, NULL, 0, NULL);
    double angle;
    ck_assert_int_eq(rbd_actuators_map(d.a, d.q, NULL, &angle, NULL), RBD_ERR_INFEASIBLE);
    ck_assert_int_eq(rbd_actuators_fault(d.a), 0);
    drive_free(&d);
}
END_TEST

/* Two rods side by side turn as one, and cannot hold a joint with two degrees of freedom. Where the first
   does not reach, the second is not asked. */
START_TEST(two_rods_that_are_one_are_singular) {
    rbd_transmission t = ankles[0];
    double angle[2];
    t.rod[1] = t.rod[0];
    for (int k = 0; k < 2; k++) {
        if (k) t.rod[0].length = 0.01;
        driven d = drive("ankle", shank_and_foot, 3, cranks, 2, &t, 1, NULL, 0, NULL);
        const rbd_status expected = k ? RBD_ERR_INFEASIBLE : RBD_ERR_SINGULAR;
        ck_assert_int_eq(rbd_actuators_map(d.a, d.q, NULL, angle, NULL), expected);
        ck_assert_int_eq(rbd_actuators_fault(d.a), 0);
        drive_free(&d);
    }
}
END_TEST

/* ---- known answers at the ends of ranges ---- */

/* Parts of the friction at rest one by one, and levels at the ends: M6 as the header has it. */
START_TEST(each_part_of_rest_counts_alone) {
    const rbd_gear_friction shares = {.rest_joint = 0.5, .speed = 1, .power = 1};
    const rbd_gear_friction squares = {.square_joint = 0.25, .speed = 1, .power = 1};
    const rbd_gear_friction fast = {.coulomb = 3, .rest = 2, .speed = 1e-9, .power = 1};
    const rbd_gear_friction huge = {.square_joint = 1, .speed = 1, .power = 1};
    ck_assert(rbd_friction_level(&shares, 0, 8, -6) == 3);
    ck_assert(rbd_friction_level(&squares, 0, 8, -6) == 9);
    ck_assert(rbd_friction_level(&squares, 0, 8, 6) == 0);
    ck_assert(rbd_friction_level(&fast, 0, 0, 0) == 5);
    ck_assert(rbd_friction_level(&fast, 1e25, 0, 0) == 3);
    ck_assert(rbd_friction_level(&huge, 0, 1e11, -1e10) == 1e12);
    ck_assert(rbd_friction_level(NULL, 1, 2, 3) == 0);
}
END_TEST

static rbd_drive invert_wheel(const rbd_motor *motor, double air, double v, double acc, double tau) {
    const double q[1] = {0};
    driven d = drive_wheel(motor);
    rbd_drive o;
    ck_assert_int_eq(rbd_actuators_reset(d.a, d.q, air), RBD_OK);
    ck_assert_int_eq(rbd_actuators_inverse(d.a, q, &v, &acc, &tau, &o), RBD_OK);
    drive_free(&d);
    return o;
}

/* The inverse carries a load of the joint or of rest alone. Squares: the rotor slows down by 6, so that 2 are
   left of 8; with friction 0.3 u^2 the motor would need ever more, until it drives the joint, and friction is
   0.3 8^2. */
START_TEST(the_inverse_carries_each_load_alone) {
    const rbd_motor joint = {.joint = "axle", .gear = 1, .constant = 1, .friction = {.load_joint = 0.125}};
    const rbd_motor rest = {
        .joint = "axle", .gear = 1, .constant = 1, .friction = {.rest = 0.5, .speed = 1, .power = 1}};
    const rbd_motor squares = {
        .joint = "axle",
        .gear = 1,
        .constant = 1,
        .inertia = 1,
        .friction = {.square_motor = 0.3, .square_joint = 0.3, .speed = 1, .power = 1}};
    rbd_drive o = invert_wheel(&joint, 25, 2, 0, 8);
    ck_assert(fabs(o.torque - 9) < 1e-14 && o.by_torque == 1.125);
    o = invert_wheel(&joint, 25, -2, 0, 8);
    ck_assert(fabs(o.torque - 7) < 1e-14 && o.by_torque == 0.875);
    o = invert_wheel(&rest, 25, 1e-40, 0, 8);
    ck_assert(fabs(o.torque - 8.5) < 1e-14 && o.by_torque == 1);
    o = invert_wheel(&squares, 25, 1e-40, -6, 8);
    ck_assert(fabs(o.torque - 21.2) < 1e-13 && fabs(o.by_torque - 5.8) < 1e-14);
}
END_TEST

/* At -273 degrees the line of copper's resistance is below 0; a tenth of it stays. */
START_TEST(a_cold_winding_keeps_a_tenth) {
    const rbd_motor motor = {.joint = "axle", .gear = 1, .constant = 1, .resistance = 2, .copper = 0.0039};
    ck_assert(fabs(invert_wheel(&motor, 25, 0, 0, 3).voltage - 6) < 1e-14);
    ck_assert(fabs(invert_wheel(&motor, -273, 0, 0, 3).voltage - 0.6) < 1e-14);
}
END_TEST

/* An encoder with more steps than an int32_t has says the angle itself. */
START_TEST(an_encoder_beyond_its_steps_says_the_angle) {
    const rbd_motor motor = {.joint = "axle", .gear = 1, .constant = 1, .step = 1e-9, .sampled = 1};
    driven d = drive_wheel(&motor);
    d.q[0] = 2.00000000025;
    d.command[0] = (rbd_command){.q = 3, .kp = 10};
    ck_assert_int_eq(rbd_actuators_begin(d.a, d.command, d.q, d.v, 1e-3, 0, d.tau, d.damping), RBD_OK);
    ck_assert(d.tau[0] - d.damping[0] * d.v[0] == 10 * (3 - d.q[0]));
    ck_assert_int_eq(rbd_actuators_again(d.a, no_number, d.tau, d.damping), 0);

    d.q[0] = 0.50000000025;
    ck_assert_int_eq(rbd_actuators_begin(d.a, d.command, d.q, d.v, 1e-3, 0, d.tau, d.damping), RBD_OK);
    ck_assert(fabs(d.tau[0] - d.damping[0] * d.v[0] - 25) < 1e-12);
    drive_free(&d);
}
END_TEST

/* Bristles of coupled shafts: at rest each shaft is wound up by its load over its stiffness; the loads are
   G^-T tau. */
START_TEST(bristles_of_coupled_shafts_give_way) {
    const rbd_motor motors[2] = {{.gear = 1, .constant = 1, .friction = {.coulomb = 3, .bristle = 1e4}},
                                 {.gear = 1, .constant = 1, .friction = {.coulomb = 2, .bristle = 2e4}}};
    rbd_body light[2];
    memcpy(light, leg, sizeof light);
    for (int i = 0; i < 2; i++) light[i].axis[1] = 0, light[i].axis[2] = 1;
    driven d = drive("leg that lies", light, 2, motors, 2, &belt, 1, NULL, 0, NULL);
    d.other[0] = 1.5, d.other[1] = 0.5;
    for (int k = 0; k < 2000; k++) step(&d, 1e-2);

    /* angles (q_0, q_0 + q_1), torques (tau_0 - tau_1, tau_1) */
    ck_assert_msg(fabs(d.q[0] - 1 / 1e4) < 1e-9, "%.12g", d.q[0]);
    ck_assert_msg(fabs(d.q[0] + d.q[1] - 0.5 / 2e4) < 1e-9, "%.12g", d.q[0] + d.q[1]);
    drive_free(&d);
}
END_TEST

/* ---- random tables ---- */

static void draw_motor(uint64_t *seed, rbd_motor *m) {
    m->gear = uniform(seed, 1, 150) * (below(seed, 2) ? 1 : -1);
    m->constant = uniform(seed, 0.01, 2);
    m->inertia = pow(10, uniform(seed, -6, -3));
    if (below(seed, 2)) m->current = uniform(seed, 0.1, 30);
    if (below(seed, 2)) m->voltage = uniform(seed, 1, 48);
    m->resistance = uniform(seed, 0.05, 5), m->copper = 0.0039;
    if (below(seed, 2)) {
        m->heat_winding = uniform(seed, 1, 50), m->flow_winding = uniform(seed, 0.1, 5);
        if (below(seed, 2)) m->heat_case = uniform(seed, 10, 500), m->flow_case = uniform(seed, 0.1, 5);
        if (m->current > 0) m->hot = 60, m->hottest = 100;
    }
    if (below(seed, 3) == 0) m->step = 1e-3, m->offset = uniform(seed, -0.1, 0.1);
    if (below(seed, 3) == 0) m->cogging = 0.01, m->teeth = 12;
    m->delay = below(seed, 4);
    if (below(seed, 2)) {
        m->stiffness = pow(10, uniform(seed, 1, 5)), m->damping = uniform(seed, 0, 5);
        if (below(seed, 2)) m->backlash = uniform(seed, 0, 0.02);
    }
    draw_friction(seed, &m->friction);
    if (!(m->stiffness > 0) && below(seed, 2)) m->friction.bristle = pow(10, uniform(seed, 2, 5));
}

/* Random motors of an iiwa under random commands: every answer is finite, and within the motor's limits. */
START_TEST(random_tables_give_finite_answers_within_limits) {
    uint64_t seed = 11;
    int steps_made = 0, unsettled = 0;
    for (int k = 0; k < 60 / PART_OF_TREES; k++) {
        const double dt = pow(10, uniform(&seed, -4, -2));
        rbd_motor motors[7];
        memset(motors, 0, sizeof motors);
        for (int i = 0; i < 7; i++) {
            draw_motor(&seed, &motors[i]);
            motors[i].joint = iiwa_joints[i];
        }
        driven d = drive("iiwa", iiwa_bodies, 7, motors, 7, NULL, 0, NULL, 0, NULL);
        memcpy(d.q, bent, sizeof bent);
        ck_assert_int_eq(rbd_actuators_reset(d.a, d.q, 20), RBD_OK);
        for (int n = 0; n < 50; n++) {
            rbd_drive drives[7];
            for (int i = 0; i < 7; i++)
                d.command[i] = (rbd_command){.q = uniform(&seed, -1, 1),
                                             .kp = uniform(&seed, 0, 500),
                                             .kd = uniform(&seed, 0, 20),
                                             .torque = uniform(&seed, -50, 50)};
            step(&d, dt);
            ck_assert(largest(d.q, 7) < INFINITY && largest(d.v, 7) < INFINITY);
            ck_assert_int_eq(rbd_actuators_inverse(d.a, d.q, d.v, d.v, d.tau, drives), RBD_OK);
            for (int i = 0; i < 7; i++) {
                rbd_actuator_state s;
                ck_assert_int_eq(rbd_actuators_get(d.a, i, &s), RBD_OK);
                ck_assert(fabs(s.motor) < 1e9 && fabs(s.joint) < 1e9 && s.friction >= 0 && s.winding < 1e6);
                const double most = motors[i].current > 0 ? motors[i].current : 1e15;
                ck_assert(fabs(s.current) <= most * (1 + 1e-12));
                ck_assert(fabs(drives[i].current) <= most && fabs(drives[i].torque) < 1e9);
                if (motors[i].voltage > 0 && motors[i].current <= 0)
                    ck_assert(fabs(drives[i].voltage) <= motors[i].voltage * (1 + 1e-9));
            }
            steps_made++;
        }
        unsettled += d.unsettled;
        drive_free(&d);
    }
    ck_assert_msg(unsettled * 10000 <= steps_made, "%d of %d", unsettled, steps_made);
}
END_TEST

/* ---- bad input ---- */

/* The fields of a motor: its limits, and what 0 means. */
static const struct {
    const char *name;
    size_t at;
    int needed, sign; /* whether 0 is refused, and a negative number is not */
    const char *with; /* field that does nothing without it */
} field[] = {
#define MOTOR(name, needed, sign) {#name, offsetof(rbd_motor, name), needed, sign, NULL}
#define PARTNER(name, with) {#name, offsetof(rbd_motor, name), 1, 0, with}
#define FRICTION(name, needed) \
    {#name, offsetof(rbd_motor, friction) + offsetof(rbd_gear_friction, name), needed, 0, NULL}
    MOTOR(gear, 1, 1),         MOTOR(constant, 1, 0),     MOTOR(inertia, 1, 0),
    MOTOR(resistance, 1, 0),   MOTOR(current, 1, 0),      MOTOR(voltage, 0, 0),
    MOTOR(copper, 0, 0),       MOTOR(heat_winding, 1, 0), PARTNER(heat_case, "flow_case"),
    MOTOR(flow_winding, 1, 0), MOTOR(flow_case, 1, 0),    MOTOR(hot, 1, 0),
    MOTOR(hottest, 1, 0),      PARTNER(cogging, "teeth"), MOTOR(teeth, 1, 0),
    MOTOR(phase, 0, 1),        MOTOR(step, 0, 0),         MOTOR(offset, 0, 1),
    MOTOR(stiffness, 1, 0),    MOTOR(damping, 0, 0),      MOTOR(backlash, 0, 0),
    FRICTION(coulomb, 0),      FRICTION(viscous, 0),      FRICTION(load_motor, 0),
    FRICTION(load_joint, 0),   FRICTION(rest, 0),         FRICTION(rest_motor, 0),
    FRICTION(rest_joint, 0),   FRICTION(square_motor, 0), FRICTION(square_joint, 0),
    FRICTION(speed, 1),        FRICTION(power, 1),        FRICTION(bristle, 0),
    FRICTION(still, 0)};

/* A motor in which each field but the bristle, which goes without a spring, is used. */
static const rbd_motor whole = {.name = "elbow",
                                .joint = "knee",
                                .gear = 50,
                                .constant = 0.05,
                                .inertia = 1e-5,
                                .resistance = 1,
                                .current = 10,
                                .voltage = 24,
                                .copper = 0.0039,
                                .heat_winding = 10,
                                .heat_case = 100,
                                .flow_winding = 1,
                                .flow_case = 2,
                                .hot = 80,
                                .hottest = 100,
                                .cogging = 0.01,
                                .teeth = 12,
                                .phase = 1,
                                .step = 1e-3,
                                .offset = 0.01,
                                .stiffness = 1000,
                                .damping = 1,
                                .backlash = 0.01,
                                .delay = 2,
                                .friction = {.coulomb = 1,
                                             .viscous = 0.1,
                                             .load_motor = 0.1,
                                             .load_joint = 0.1,
                                             .rest = 0.1,
                                             .rest_motor = 0.1,
                                             .rest_joint = 0.1,
                                             .square_motor = 0.01,
                                             .square_joint = 0.01,
                                             .speed = 0.1,
                                             .power = 2,
                                             .still = 0.01}};

/* Refused with this status: motor 1 of the leg, the field by name. Nothing is made. */
static void expect_refused(const robot *r, const rbd_motor *second, rbd_status status, const char *name) {
    const rbd_motor motors[2] = {{.joint = "hip", .gear = 1, .constant = 1}, *second};
    rbd_actuators *a;
    rbd_report report;
    void *memory;
    char text[200];
    const rbd_status found = init(r, motors, 2, NULL, 0, &a, &memory, &report);
    free(memory);
    rbd_actuators_finding_text(&report.error, 2, text, sizeof text);
    ck_assert_msg(found == status, "%s: status %d: %s", name, found, text);
    ck_assert_ptr_null(a);
    ck_assert_int_eq(report.error.status, status);
    ck_assert_int_eq(report.error.body, 1);
    ck_assert_str_eq(report.error.field, name);
    ck_assert(strncmp(text, "motor 1 'elbow', field '", 24) == 0);
    ck_assert(strstr(text, name) != NULL);
}

START_TEST(each_field_is_checked_by_name) {
    const double bad[6] = {NAN, INFINITY, -INFINITY, 1e30, -1e30, -1};
    robot r = BUILD(leg);
    rbd_actuators *a;
    void *memory;
    rbd_motor one = whole;
    double *x = (double *)(void *)((char *)&one + field[_i].at);
    const int bristle = strcmp(field[_i].name, "bristle") == 0;
    if (bristle) one.stiffness = one.damping = one.backlash = 0;
    ck_assert_int_eq(init(&r, &one, 1, NULL, 0, &a, &memory, NULL), RBD_OK);
    free(memory);
    for (int k = 0; k < 6; k++) {
        if (field[_i].sign && k == 5) continue;
        *x = bad[k];
        expect_refused(&r, &one, RBD_ERR_RANGE, field[_i].name);
    }
    *x = 0;
    if (field[_i].needed) {
        expect_refused(&r, &one, RBD_ERR_RANGE, field[_i].with ? field[_i].with : field[_i].name);
    } else {
        ck_assert_int_eq(init(&r, &one, 1, NULL, 0, &a, &memory, NULL), RBD_OK);
        free(memory);
    }
    robot_free(&r);
}
END_TEST

/* What is forgotten, contradicts itself or counts twice. */
START_TEST(mistakes_in_a_table_are_named) {
    rbd_body bodies[2];
    memcpy(bodies, leg, sizeof leg);
    robot r = BUILD(leg);
    rbd_motor x = {.name = "elbow"};
    expect_refused(&r, &x, RBD_ERR_RANGE, "gear");
#define MISTAKE(status, field, change) (x = whole, change, expect_refused(&r, &x, status, field))
    MISTAKE(RBD_ERR_INDEX, "joint", x.joint = NULL);
    MISTAKE(RBD_ERR_INDEX, "joint", x.joint = "ankle");
    MISTAKE(RBD_ERR_INDEX, "joint", x.joint = "hip");
    MISTAKE(RBD_ERR_RANGE, "hottest", x.hottest = 70);
    MISTAKE(RBD_ERR_RANGE, "heat_winding", x.heat_winding = x.hot = x.hottest = 0);
    MISTAKE(RBD_ERR_RANGE, "delay", x.delay = -1);
    MISTAKE(RBD_ERR_RANGE, "delay", x.delay = 1001);
    MISTAKE(RBD_ERR_RANGE, "sampled", x.sampled = 2);
    MISTAKE(RBD_ERR_RANGE, "by_voltage", x.by_voltage = 2);
    MISTAKE(RBD_ERR_RANGE, "bristle", x.friction.bristle = 100);

    /* a field that does nothing without another */
    x = (rbd_motor){.name = "elbow", .joint = "knee", .gear = 50, .constant = 1};
    const rbd_motor plain = x;
#define LONELY(field, change) (x = plain, change, expect_refused(&r, &x, RBD_ERR_RANGE, field))
    LONELY("teeth", x.teeth = 12);
    LONELY("phase", x.phase = -1);
    LONELY("copper", x.copper = 0.0039);
    LONELY("speed", (x.friction.coulomb = 1, x.friction.speed = 0.1));
    LONELY("power", (x.friction.coulomb = 1, x.friction.power = 2));
    LONELY("bristle", x.friction.bristle = 100);
    LONELY("still", x.friction.still = 0.1);
    LONELY("resistance", x.by_voltage = 1);
    MISTAKE(RBD_ERR_RANGE, "load_motor", x.friction.load_motor = 1);
    MISTAKE(RBD_ERR_RANGE, "rest_motor", (x.friction.load_motor = 0.75, x.friction.rest_motor = 0.25));
    MISTAKE(RBD_ERR_RANGE, "power", x.friction.power = 0.05);
    LONELY("heat_winding", x.flow_case = 2);
    robot_free(&r);

    /* the rotor's inertia in model and table */
    bodies[1].armature[0] = 0.1;
    r = robot_build("leg with armature", bodies, 2);
    MISTAKE(RBD_ERR_ARMATURE, "inertia", x.delay = 0);
    x.stiffness = x.damping = x.backlash = 0;
    expect_refused(&r, &x, RBD_ERR_ARMATURE, "inertia");
    x.inertia = 0;
    const rbd_motor motors[2] = {{.joint = "hip", .gear = 1, .constant = 1}, x};
    rbd_actuators *a;
    void *memory;
    ck_assert_int_eq(init(&r, motors, 2, NULL, 0, &a, &memory, NULL), RBD_OK);
    free(memory);
    robot_free(&r);

    /* a joint that follows another, and one with several dofs */
    memcpy(bodies, leg, sizeof leg);
    bodies[1].mimic = "hip", bodies[1].mimic_ratio = -2;
    r = robot_build("leg that folds", bodies, 2);
    MISTAKE(RBD_ERR_INDEX, "joint", (void)0);
    robot_free(&r);
    bodies[1].mimic = NULL, bodies[1].type = RBD_CONTINUOUS_CS;
    r = robot_build("leg by sine and cosine", bodies, 2);
    MISTAKE(RBD_ERR_INDEX, "joint", (void)0);
    robot_free(&r);
    bodies[1].type = RBD_SPHERICAL;
    r = robot_build("leg on a ball", bodies, 2);
    MISTAKE(RBD_ERR_INDEX, "joint", (void)0);
    robot_free(&r);
}
END_TEST

static void expect_transmission_refused(const robot *r, const rbd_motor *motors, int n,
                                        const rbd_transmission *t, rbd_status status, const char *name) {
    rbd_actuators *a;
    rbd_report report;
    void *memory;
    char text[200];
    const rbd_status found = init(r, motors, n, t, 1, &a, &memory, &report);
    free(memory);
    rbd_actuators_finding_text(&report.error, n, text, sizeof text);
    ck_assert_msg(found == status, "%s: status %d: %s", name, found, text);
    ck_assert_int_eq(report.error.body, n);
    ck_assert_str_eq(report.error.field, name);
    ck_assert(strncmp(text, "transmission 0 '", 16) == 0);
}

START_TEST(mistakes_in_a_transmission_are_named) {
    robot r = BUILD(leg);
    rbd_motor two[2] = {{.gear = 2, .constant = 1}, {.gear = 3, .constant = 1}};
    rbd_transmission t;
#define WRONG(status, field, change) \
    (t = belt, change, expect_transmission_refused(&r, two, 2, &t, status, field))
    WRONG(RBD_ERR_TYPE, "kind", t.kind = (rbd_transmission_kind)2);
    WRONG(RBD_ERR_TYPE, "kind", t.kind = (rbd_transmission_kind)-1);
    WRONG(RBD_ERR_COUNT, "n", t.n = 0);
    WRONG(RBD_ERR_COUNT, "n", t.n = 4);
    WRONG(RBD_ERR_INDEX, "motor", t.motor = 1);
    WRONG(RBD_ERR_INDEX, "motor", t.motor = -1);
    WRONG(RBD_ERR_INDEX, "joint", t.joint[1] = "ankle");
    WRONG(RBD_ERR_INDEX, "joint", t.joint[1] = "hip");
    WRONG(RBD_ERR_INDEX, "joint", t.joint[0] = NULL);
    WRONG(RBD_ERR_RANGE, "matrix", t.matrix[2] = NAN);
    WRONG(RBD_ERR_RANGE, "matrix", t.matrix[3] = 1e30);
    WRONG(RBD_ERR_SINGULAR, "matrix", t.matrix[3] = 0);
    WRONG(RBD_ERR_SINGULAR, "matrix", memset(t.matrix, 0, sizeof t.matrix));
    WRONG(RBD_ERR_SINGULAR, "matrix", (t.matrix[0] = t.matrix[3] = 1e-300, t.matrix[1] = t.matrix[2] = 0));
    two[1].joint = "knee";
    WRONG(RBD_ERR_INDEX, "motor", (void)0);
    two[1].joint = NULL;
    robot_free(&r);

    r = BUILD(shank_and_foot);
#undef WRONG
#define WRONG(status, field, change) \
    (t = ankles[0], change, expect_transmission_refused(&r, cranks, 2, &t, status, field))
    WRONG(RBD_ERR_COUNT, "n", t.n = 3);
    WRONG(RBD_ERR_RANGE, "crank", t.rod[1].crank = 0);
    WRONG(RBD_ERR_RANGE, "crank", t.rod[0].crank = NAN);
    WRONG(RBD_ERR_RANGE, "length", t.rod[0].length = 1e30);
    WRONG(RBD_ERR_RANGE, "place", t.rod[0].place[2] = NAN);
    WRONG(RBD_ERR_RANGE, "point", t.rod[0].point[2] = 1e30);
    WRONG(RBD_ERR_AXIS, "axis", t.rod[0].axis[1] = 2);
    WRONG(RBD_ERR_AXIS, "axis", t.rod[0].axis[1] = NAN);
    WRONG(RBD_ERR_AXIS, "zero", t.rod[0].zero[0] = 0);
    WRONG(RBD_ERR_AXIS, "zero", t.rod[0].zero[0] = NAN);
    WRONG(RBD_ERR_AXIS, "zero", memcpy(t.rod[0].zero, t.rod[0].axis, sizeof t.rod[0].axis));
    WRONG(RBD_ERR_RANGE, "elbow", t.rod[1].elbow = 0);
    WRONG(RBD_ERR_INDEX, "joint", (t.joint[0] = "roll", t.joint[1] = "pitch"));
    robot_free(&r);
}
END_TEST

/* What two rows of a table ask for at once: the transmission or motor that is too many is named. */
static void expect_clash(const robot *r, const rbd_motor *motors, int n, const rbd_transmission *t, int at,
                         const char *named, const char *text) {
    rbd_actuators *a;
    rbd_report report;
    void *memory;
    char found[200];
    ck_assert_int_eq(init(r, motors, n, t, 2, &a, &memory, &report), RBD_ERR_INDEX);
    free(memory);
    ck_assert_ptr_null(a);
    ck_assert_int_eq(report.error.body, at);
    if (named) ck_assert_str_eq(report.error.field, named);
    if (!named) ck_assert_ptr_null(report.error.field);
    ck_assert_ptr_eq(rbd_actuators_finding_text(&report.error, n, found, sizeof found), found);
    ck_assert_msg(strstr(found, text) != NULL, "%s", found);
}

START_TEST(transmissions_that_share_are_refused) {
    const rbd_motor motors[3] = {{.name = "left", .gear = 1, .constant = 1},
                                 {.name = "middle", .gear = 1, .constant = 1},
                                 {.name = "right", .gear = 1, .constant = 1}};
    const rbd_transmission one = {.kind = RBD_BY_MATRIX, .n = 1, .joint = {"knee"}, .matrix = {1}};
    rbd_transmission t[2] = {belt, one};
    robot r = BUILD(leg);
    t[1].motor = 1;
    expect_clash(&r, motors, 2, t, 1, NULL, "motor 1 'middle', in two transmissions");
    t[1].motor = 2;
    t[1].name = "chain";
    expect_clash(&r, motors, 3, t, 4, "joint",
                 "transmission 1 'chain', field 'joint': another motor moves this joint");
    robot_free(&r);
}
END_TEST

START_TEST(rods_of_a_joint_that_slides_are_refused) {
    rbd_body bodies[2];
    rbd_transmission t = ankles[1];
    memcpy(bodies, leg, sizeof leg);
    bodies[1].type = RBD_PRISMATIC;
    t.joint[0] = "knee";
    robot r = robot_build("leg that slides", bodies, 2);
    expect_transmission_refused(&r, cranks, 1, &t, RBD_ERR_INDEX, "joint");
    robot_free(&r);
}
END_TEST

/* Numbers at the far ends of what a call takes; nothing has changed after a refusal. */
START_TEST(numbers_out_of_range_change_nothing) {
    const rbd_motor motor = {.joint = "axle", .gear = 1, .constant = 1};
    const rbd_motor volts = {
        .joint = "axle", .gear = 1, .constant = 1, .resistance = 1, .voltage = 24, .by_voltage = 1};
    rbd_actuator_state before, after;
    char text[8] = "kept";
    for (int k = 0; k < 2; k++) {
        driven d = drive_wheel(k ? &volts : &motor);
        step(&d, 1e-3);
        memset(&before, 0, sizeof before);
        memset(&after, 0, sizeof after);
        ck_assert_int_eq(rbd_actuators_get(d.a, 0, &before), RBD_OK);

        ck_assert_int_eq(rbd_actuators_reset(d.a, d.q, 1001), RBD_ERR_RANGE);
        ck_assert_int_eq(rbd_actuators_begin(d.a, d.command, d.q, d.v, 1001, 0, d.tau, d.damping),
                         RBD_ERR_RANGE);
        for (int sign = -1; sign <= 1; sign += 2) {
            d.command[0] = k ? (rbd_command){.torque = sign} : (rbd_command){.voltage = sign};
            ck_assert_int_eq(rbd_actuators_begin(d.a, d.command, d.q, d.v, 1e-3, 0, d.tau, d.damping),
                             RBD_ERR_RANGE);
        }
        ck_assert_int_eq(rbd_actuators_map(d.a, d.q, d.v, NULL, NULL), RBD_OK);
        ck_assert_int_eq(rbd_actuators_get(d.a, 0, &after), RBD_OK);
        ck_assert(memcmp(&before, &after, sizeof after) == 0);
        drive_free(&d);
    }
    ck_assert(rbd_actuators_size(2, 0, -1) == 0);
    ck_assert_ptr_eq(rbd_actuators_finding_text(NULL, 2, text, sizeof text), text);
    ck_assert_str_eq(text, "kept");
}
END_TEST

START_TEST(arguments_are_checked) {
    const rbd_motor motors[2] = {{.joint = "hip", .gear = 1, .constant = 1},
                                 {.joint = "knee", .gear = 1, .constant = 1}};
    driven d = drive("leg", leg, 2, motors, 2, NULL, 0, NULL, 0, NULL);
    static unsigned char memory[RBD_ACTUATORS_SIZE(2, 0, 0)];
    const double nan[2] = {0, NAN}, huge[2] = {0, 1e30}, q[2] = {0};
    rbd_drive o[2];
    rbd_actuators *a;
    rbd_actuator_state s;
    rbd_report report;
    ck_assert_int_eq(rbd_actuators_init(d.r.m, motors, 2, NULL, 0, memory, sizeof memory, &a, &report),
                     RBD_OK);
    ck_assert_int_eq(report.error.status, RBD_OK);
    ck_assert_int_eq(rbd_actuators_init(d.r.m, motors, 2, NULL, 0, memory, sizeof memory - 1, &a, NULL),
                     RBD_ERR_MEMORY);
    ck_assert_int_eq(rbd_actuators_init(NULL, motors, 2, NULL, 0, memory, sizeof memory, &a, NULL),
                     RBD_ERR_NULL);
    ck_assert_int_eq(rbd_actuators_init(d.r.m, NULL, 2, NULL, 0, memory, sizeof memory, &a, NULL),
                     RBD_ERR_NULL);
    ck_assert_int_eq(rbd_actuators_init(d.r.m, motors, 2, NULL, 1, memory, sizeof memory, &a, NULL),
                     RBD_ERR_NULL);
    ck_assert_int_eq(rbd_actuators_init(d.r.m, motors, 2, NULL, 0, NULL, sizeof memory, &a, NULL),
                     RBD_ERR_NULL);
    ck_assert_int_eq(rbd_actuators_init(d.r.m, motors, 2, NULL, 0, memory, sizeof memory, NULL, NULL),
                     RBD_ERR_NULL);
    ck_assert_int_eq(rbd_actuators_init(d.r.m, motors, 0, NULL, 0, memory, sizeof memory, &a, NULL),
                     RBD_ERR_COUNT);
    ck_assert_int_eq(rbd_actuators_init(d.r.m, motors, 1001, NULL, 0, memory, sizeof memory, &a, NULL),
                     RBD_ERR_COUNT);
    ck_assert(rbd_actuators_size(0, 0, 0) == 0 && rbd_actuators_size(2, 3, 0) == 0);
    ck_assert(rbd_actuators_size(2, 0, 1001) == 0 && rbd_actuators_size(2, -1, 0) == 0);

    for (int k = 0; k < 2; k++) {
        const double *bad = k ? huge : nan;
        ck_assert_int_eq(rbd_actuators_map(d.a, bad, q, NULL, NULL), RBD_ERR_NAN);
        ck_assert_int_eq(rbd_actuators_map(d.a, q, bad, NULL, NULL), RBD_ERR_NAN);
        ck_assert_int_eq(rbd_actuators_reset(d.a, bad, 25), RBD_ERR_NAN);
        ck_assert_int_eq(rbd_actuators_inverse(d.a, bad, q, q, q, o), RBD_ERR_NAN);
        ck_assert_int_eq(rbd_actuators_inverse(d.a, q, bad, q, q, o), RBD_ERR_NAN);
        ck_assert_int_eq(rbd_actuators_inverse(d.a, q, q, bad, q, o), RBD_ERR_NAN);
        ck_assert_int_eq(rbd_actuators_inverse(d.a, q, q, q, bad, o), RBD_ERR_NAN);
        ck_assert_int_eq(rbd_actuators_begin(d.a, d.command, q, bad, 1e-3, 0, d.tau, d.damping), RBD_ERR_NAN);
        for (int i = 0; i < 6; i++) {
            rbd_command command[2] = {{0}};
            ((double *)(void *)&command[1])[i] = bad[1];
            ck_assert_int_eq(rbd_actuators_begin(d.a, command, q, q, 1e-3, 0, d.tau, d.damping),
                             RBD_ERR_RANGE);
        }
    }
    d.command[0].kp = -1;
    ck_assert_int_eq(rbd_actuators_begin(d.a, d.command, q, q, 1e-3, 0, d.tau, d.damping), RBD_ERR_RANGE);
    d.command[0].kp = 0, d.command[0].kd = -1;
    ck_assert_int_eq(rbd_actuators_begin(d.a, d.command, q, q, 1e-3, 0, d.tau, d.damping), RBD_ERR_RANGE);
    d.command[0].kd = 0;
    ck_assert_int_eq(rbd_actuators_begin(d.a, d.command, q, q, 0, 0, d.tau, d.damping), RBD_ERR_RANGE);
    ck_assert_int_eq(rbd_actuators_begin(d.a, d.command, q, q, NAN, 0, d.tau, d.damping), RBD_ERR_RANGE);
    ck_assert_int_eq(rbd_actuators_begin(d.a, NULL, q, q, 1e-3, 0, d.tau, d.damping), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_actuators_reset(d.a, q, NAN), RBD_ERR_RANGE);
    ck_assert_int_eq(rbd_actuators_reset(d.a, q, -274), RBD_ERR_RANGE);
    ck_assert_int_eq(rbd_actuators_reset(NULL, q, 25), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_actuators_map(d.a, NULL, q, NULL, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_actuators_inverse(d.a, q, q, q, q, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_actuators_get(d.a, 2, &s), RBD_ERR_INDEX);
    ck_assert_int_eq(rbd_actuators_get(d.a, -1, &s), RBD_ERR_INDEX);
    ck_assert_int_eq(rbd_actuators_get(NULL, 0, &s), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_actuators_derivatives(NULL, NULL, NULL, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_actuators_fault(NULL), -1);

    /* a step that gave no number ends, and the shafts stay; within it no other state is looked at */
    ck_assert_int_eq(rbd_actuators_begin(d.a, d.command, q, q, 1e-3, 0, d.tau, d.damping), RBD_OK);
    ck_assert_int_eq(rbd_actuators_map(d.a, q, q, NULL, NULL), RBD_ERR_ORDER);
    ck_assert_int_eq(rbd_actuators_inverse(d.a, q, q, q, q, o), RBD_ERR_ORDER);
    ck_assert_int_eq(rbd_actuators_again(d.a, nan, d.tau, d.damping), 0);
    ck_assert_int_eq(rbd_actuators_get(d.a, 1, &s), RBD_OK);
    ck_assert(s.speed == 0 && s.angle == 0);
    ck_assert_int_eq(rbd_actuators_again(d.a, q, d.tau, d.damping), 0);
    ck_assert_int_eq(rbd_actuators_map(d.a, q, q, NULL, NULL), RBD_OK);

    /* one that could not begin is none */
    ck_assert_int_eq(rbd_actuators_begin(d.a, d.command, q, q, 1e-3, 0, d.tau, d.damping), RBD_OK);
    ck_assert_int_eq(rbd_actuators_begin(d.a, d.command, q, q, 0, 0, d.tau, d.damping), RBD_ERR_RANGE);
    ck_assert_int_eq(rbd_actuators_derivatives(d.a, NULL, NULL, NULL), RBD_ERR_ORDER);
    drive_free(&d);
}
END_TEST

Suite *actuator_suite(void) {
    Suite *suite = suite_create("actuator");
    TCase *c = tcase_create("actuator"), *slow = slow_tests(suite);
    tcase_set_timeout(c, 60);
    tcase_add_loop_test(c, friction_of_seven_servos_is_the_published_formula, 0, LENGTH(servos));
    tcase_add_test(c, simpler_laws_of_friction_are_special_cases);
    tcase_add_loop_test(slow, friction_holds_up_to_its_level_and_not_beyond, 0, LENGTH(steps));
    tcase_add_loop_test(c, a_bristle_gives_way_and_does_not_drift, 0, LENGTH(steps));
    tcase_add_test(c, dry_friction_is_that_of_the_contact_step);
    tcase_add_loop_test(slow, friction_as_rows_holds_without_creep, 0, LENGTH(steps));
    tcase_add_test(slow, friction_as_rows_is_that_of_the_actuators);
    tcase_add_loop_test(c, what_sticks_does_not_chatter, 0, LENGTH(steps));
    tcase_add_test(c, friction_stops_a_fast_shaft_within_a_step);
    tcase_add_test(c, friction_takes_energy_where_a_shaft_turns_around);
    tcase_add_test(c, a_motor_has_its_torque_speed_line);
    tcase_add_test(c, the_inverse_says_where_a_limit_cuts);
    tcase_add_test(c, a_light_wheel_ends_at_the_speed_without_load);
    tcase_add_loop_test(c, temperatures_are_those_of_the_network, 0, 3);
    tcase_add_test(c, a_winding_may_be_joined_closely_to_its_case);
    tcase_add_test(c, heat_lowers_the_limit_of_the_current);
    tcase_add_loop_test(c, an_implicit_drive_is_stable_in_long_steps, 0, 2);
    tcase_add_loop_test(c, a_command_is_late_by_its_delay, 0, 4);
    tcase_add_test(c, encoder_and_cogging_are_seen);
    tcase_add_loop_test(c, cogging_makes_no_energy, 0, 4);
    tcase_add_loop_test(c, cogging_gains_at_most_its_height, 0, 8);
    tcase_add_test(c, a_state_is_that_of_the_last_step);
    tcase_add_loop_test(c, a_limit_is_decided_at_the_steps_end, 0, 8);
    tcase_add_test(c, a_drive_at_its_limit_is_a_constant_torque);
    tcase_add_test(c, a_voltage_makes_a_torque_speed_line);
    tcase_add_loop_test(c, gains_in_volts_turn_the_shaft_the_same_way, 0, 2);
    tcase_add_test(c, a_voltage_of_the_inverse_gives_the_torque);
    tcase_add_test(c, a_command_is_a_torque_or_a_voltage);
    tcase_add_test(c, a_step_may_be_begun_again);
    tcase_add_test(c, efficiency_and_self_locking);
    tcase_add_test(c, forward_of_the_inverse_is_the_identity);
    tcase_add_test(c, compensation_is_softened_near_rest);
    tcase_add_test(slow, feed_forward_follows_a_plan_to_first_order);
    tcase_add_loop_test(c, springs_and_play_make_no_energy, 0, 36);
    tcase_add_test(c, friction_holds_a_rotor_behind_its_spring);
    tcase_add_loop_test(c, a_servo_behind_play_holds_the_plan, 0, 2);
    tcase_add_test(c, a_spring_vibrates_as_theory_says);
    tcase_add_loop_test(slow, repeated_steps_obey_the_laws_of_all_shafts_at_once, 0, 2 * LENGTH(steps));
    tcase_add_loop_test(slow, a_robot_stands_on_elastic_legs, 0, LENGTH(steps));
    tcase_add_loop_test(c, coupled_shafts_have_the_inertia_and_damping_of_the_matrix, 0, 2);
    tcase_add_loop_test(c, coupled_shafts_stick_and_slide_as_rows, 0, LENGTH(steps));
    tcase_add_test(c, coupled_shafts_stick_and_slide_exactly);
    tcase_add_test(c, transmissions_along_one_limb_settle_and_make_no_energy);
    tcase_add_loop_test(c, coupled_shafts_move_as_by_rows, 0, LENGTH(steps));
    tcase_add_test(c, coupled_shafts_forget_what_makes_no_sense);
    tcase_add_test(c, a_matrix_keeps_the_power);
    tcase_add_loop_test(c, rods_have_the_derivatives_of_their_angles, 0, 2);
    tcase_add_loop_test(c, rods_are_the_loops_of_the_same_mechanism, 0, 2);
    tcase_add_test(c, rods_out_of_reach_are_errors);
    tcase_add_test(c, calls_without_their_arrays_are_refused);
    tcase_add_loop_test(c, derivatives_are_those_of_differences, 0, 5);
    tcase_add_loop_test(c, rotors_are_those_bodies, 0, 3);
    tcase_add_test(c, bad_rotors_are_refused);
    tcase_add_test(c, a_repeat_without_its_arrays_does_nothing);
    tcase_add_test(c, a_step_ends_after_its_last_repeat);
    tcase_add_test(c, derivatives_need_not_all_be_asked_for);
    tcase_add_test(c, derivatives_at_rest_are_the_gains);
    tcase_add_test(c, derivatives_within_a_play_are_0);
    tcase_add_test(c, rotors_without_their_arrays_are_refused);
    tcase_add_test(c, a_rod_at_its_dead_centre_is_named);
    tcase_add_test(c, a_rod_on_its_cranks_axis_has_no_angle);
    tcase_add_test(c, two_rods_that_are_one_are_singular);
    tcase_add_test(c, each_part_of_rest_counts_alone);
    tcase_add_test(c, the_inverse_carries_each_load_alone);
    tcase_add_test(c, a_cold_winding_keeps_a_tenth);
    tcase_add_test(c, an_encoder_beyond_its_steps_says_the_angle);
    tcase_add_test(c, bristles_of_coupled_shafts_give_way);
    tcase_add_test(slow, random_tables_give_finite_answers_within_limits);
    tcase_add_loop_test(c, each_field_is_checked_by_name, 0, LENGTH(field));
    tcase_add_test(c, mistakes_in_a_table_are_named);
    tcase_add_test(c, mistakes_in_a_transmission_are_named);
    tcase_add_test(c, transmissions_that_share_are_refused);
    tcase_add_test(c, rods_of_a_joint_that_slides_are_refused);
    tcase_add_test(c, numbers_out_of_range_change_nothing);
    tcase_add_test(c, arguments_are_checked);
    suite_add_tcase(suite, c);
    return suite;
}
