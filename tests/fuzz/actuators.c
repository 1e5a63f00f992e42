/* actuators.c - random tables, states and commands for rbd_actuator.h.

   usage: actuators [--problems N | --seconds N] [--seed N]     so many problems of each kind, 300

   Kinds: an iiwa with random motors under random commands, whose states stay finite, and whose steps and
   inverse stay within limits of current and voltage; a wheel whose inverse is put forward again, by the
   formulas of the header; a wheel behind a spring with play and friction, to which no step of 0.5 to 10 ms
   that settles adds energy (runs in which another one does are counted); three joints that a matrix couples,
   with friction, which takes energy and never more than its level; limbs of up to 13 joints with up to three
   transmissions and any springs, friction and drives, whose energy does not grow if they slide; a table with
   one field that is NaN, infinite, 1e30 or -1, which is refused by that name. Prints a line. Fails if
   anything is wrong, or if more than one in 5000 steps does not settle. */
#define RBD_IMPLEMENTATION
#include "../larger.h"
#include "rbd_actuator.h"
#include "rbd_contact.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "models/iiwa.h"
#include "robots.h"

enum { TRANSMISSIONS = 3, MOST = 3 * TRANSMISSIONS + 4 }; /* of a limb; its joints */

static const int in_float = sizeof(rbd_real) == 4;

static const char *const joints[IIWA_NB] = {"lbr_iiwa_joint_1", "lbr_iiwa_joint_2", "lbr_iiwa_joint_3",
                                            "lbr_iiwa_joint_4", "lbr_iiwa_joint_5", "lbr_iiwa_joint_6",
                                            "lbr_iiwa_joint_7"};
static const rbd_body wheel[1] = {{.joint = "axle",
                                   .parent = -1,
                                   .type = RBD_CONTINUOUS,
                                   .axis = {0, 0, 1},
                                   .mass = 1,
                                   .inertia = {0.1, 0, 0, 0.1, 0, 0.1}}};

typedef struct driven {
    const rbd_model *m;
    rbd_work *w;
    rbd_contact_set *c;
    rbd_actuators *a;
    int n, first_order;
    rbd_command command[MOST];
    rbd_real q[MOST], v[MOST], tau[MOST], damping[MOST];
} driven;

static unsigned char model_memory[100000], work_memory[100000], contact_memory[400000], memory[400000];
static driven d;
static long wrong, steps, unsettled, gains;
static uint64_t number;

static void fail(const char *what, double by) {
    if (wrong++ < 30) printf("--seed %llu: %s: %g\n", (unsigned long long)number, what, by);
}

static int below(uint64_t *seed, int n) { return (int)uniform(seed, 0, n); }

static double power_of_ten(uint64_t *seed, double low, double high) {
    return pow(10, uniform(seed, low, high));
}

/* ---- a robot and its motors ---- */

static void build(const rbd_body *bodies, int nb, const rbd_motor *motors, const rbd_transmission *t,
                  int groups, int first_order) {
    const rbd_contact_options options = {.first_order = first_order};
    rbd_report report;
    char text[200];
    memset(&d, 0, sizeof d);
    d.n = nb;
    d.first_order = first_order;
    if (rbd_model_build(bodies, nb, model_memory, sizeof model_memory, &d.m, NULL) != RBD_OK ||
        rbd_work_init(d.m, work_memory, sizeof work_memory, &d.w) != RBD_OK ||
        rbd_contact_set_init(d.m, d.w, NULL, 0, NULL, 0, &options, contact_memory, sizeof contact_memory,
                             &d.c, NULL) != RBD_OK)
        exit(2);
    if (rbd_actuators_init(d.m, motors, nb, t, groups, memory, sizeof memory, &d.a, &report) == RBD_OK)
        return;
    printf("%s\n", rbd_actuators_finding_text(&report.error, nb, text, sizeof text));
    exit(2);
}

static void draw_friction(uint64_t *seed, rbd_gear_friction *f) {
    f->coulomb = (rbd_const)uniform(seed, 0, 0.5);
    f->viscous = (rbd_const)uniform(seed, 0, 0.2);
    f->load_motor = (rbd_const)uniform(seed, 0, 0.25);
    f->load_joint = (rbd_const)uniform(seed, 0, 0.25);
    f->rest = (rbd_const)uniform(seed, 0, 0.5);
    f->rest_motor = (rbd_const)uniform(seed, 0, 0.2);
    f->rest_joint = (rbd_const)uniform(seed, 0, 0.2);
    f->square_motor = (rbd_const)uniform(seed, 0, 0.005);
    f->square_joint = (rbd_const)uniform(seed, 0, 0.005);
    f->speed = (rbd_const)uniform(seed, 0.1, 0.6);
    f->power = (rbd_const)uniform(seed, 0.7, 3);
    if (below(seed, 3) == 0) f->still = (rbd_const)power_of_ten(seed, -3, -1);
}

static void draw_heat(uint64_t *seed, rbd_motor *m) {
    m->heat_winding = (rbd_const)uniform(seed, 1, 50);
    m->flow_winding = (rbd_const)uniform(seed, 0.1, 5);
    if (below(seed, 2)) {
        m->heat_case = (rbd_const)uniform(seed, 10, 500);
        m->flow_case = (rbd_const)uniform(seed, 0.1, 5);
    }
    if (m->current > 0) {
        m->hot = 60;
        m->hottest = 100;
    }
}

static void draw_motor(uint64_t *seed, rbd_motor *m) {
    memset(m, 0, sizeof *m);
    m->gear = (rbd_const)(uniform(seed, 1, 150) * (below(seed, 2) ? 1 : -1));
    m->constant = (rbd_const)uniform(seed, 0.01, 2);
    m->inertia = (rbd_const)power_of_ten(seed, -6, -3);
    if (below(seed, 2)) m->current = (rbd_const)uniform(seed, 0.1, 30);
    if (below(seed, 2)) m->voltage = (rbd_const)uniform(seed, 1, 48);
    m->resistance = (rbd_const)uniform(seed, 0.05, 5);
    m->copper = (rbd_const)0.0039;
    if (below(seed, 2)) draw_heat(seed, m);
    if (below(seed, 3) == 0) {
        m->cogging = (rbd_const)0.01;
        m->teeth = (rbd_const)(1 + below(seed, 40));
        m->phase = (rbd_const)uniform(seed, -3, 3);
    }
    if (below(seed, 3) == 0) m->step = (rbd_const)1e-3;
    if (below(seed, 3) == 0) m->offset = (rbd_const)uniform(seed, -0.1, 0.1);
    if (below(seed, 2)) {
        m->stiffness = (rbd_const)power_of_ten(seed, 1, 5);
        m->damping = (rbd_const)uniform(seed, 0, 5);
        if (below(seed, 2)) m->backlash = (rbd_const)uniform(seed, 0, 0.02);
    }
    m->delay = below(seed, 4);
    m->by_voltage = below(seed, 4) == 0;
    draw_friction(seed, &m->friction);
    if (!(m->stiffness > 0) && below(seed, 2)) m->friction.bristle = (rbd_const)power_of_ten(seed, 2, 5);
}

/* One step of the simulation. */
static void step(double dt) {
    rbd_real q[MOST], v[MOST];
    rbd_actuator_state s;
    if (rbd_actuators_begin(d.a, d.command, d.q, d.v, (rbd_real)dt, d.first_order, d.tau, d.damping) !=
        RBD_OK)
        fail("rbd_actuators_begin", dt);
    do {
        if (rbd_contact_step(d.m, d.c, d.q, d.v, d.tau, NULL, d.damping, (rbd_real)dt, q, v) != RBD_OK)
            fail("rbd_contact_step", dt);
    } while (rbd_actuators_again(d.a, v, d.tau, d.damping));
    rbd_actuators_get(d.a, 0, &s);
    steps++;
    unsettled += s.repeats >= 50;
    memcpy(d.q, q, (size_t)d.n * sizeof *q);
    memcpy(d.v, v, (size_t)d.n * sizeof *v);
}

/* ---- a robot under random commands ---- */

static void judge_shaft(const rbd_motor *m, const rbd_actuator_state *s, const rbd_drive *o) {
    const double off = in_float ? 1e-4 : 1e-9;
    const double numbers[10] = {
        (double)s->angle,   (double)s->speed,   (double)s->motor,   (double)s->joint,   (double)s->friction,
        (double)s->current, (double)s->winding, (double)s->housing, (double)o->voltage, (double)o->angle};
    for (int i = 0; i < 10; i++)
        if (!(fabs(numbers[i]) < 1e12)) fail("a number of a shaft is not bounded", numbers[i]);
    if (!(s->friction >= 0)) fail("friction is negative", (double)s->friction);
    if (m->current > 0 && !(fabs((double)o->current) <= (double)m->current * (1 + off)))
        fail("the inverse passes the limit of the current", (double)o->current);
    if (m->current > 0 && !(fabs((double)s->current) <= (double)m->current * (1 + off)))
        fail("a step passes the limit of the current", (double)s->current / (double)m->current);
    if (m->voltage > 0 && !(m->current > 0) && !(fabs((double)o->voltage) <= (double)m->voltage * (1 + off)))
        fail("the inverse passes the limit of the voltage", (double)o->voltage);
}

static void try_robot(uint64_t seed) {
    const double dt = power_of_ten(&seed, -4, -2);
    const int first_order = below(&seed, 2);
    rbd_motor motors[IIWA_NB];
    rbd_drive drives[IIWA_NB];
    rbd_actuator_state s;
    for (int i = 0; i < IIWA_NB; i++) {
        draw_motor(&seed, &motors[i]);
        motors[i].joint = joints[i];
    }
    build(iiwa_bodies, IIWA_NB, motors, NULL, 0, first_order);
    rbd_random(d.m, &seed, d.q);
    if (rbd_actuators_reset(d.a, d.q, 20) != RBD_OK) fail("rbd_actuators_reset", 0);

    for (int n = 0; n < 50; n++) {
        for (int i = 0; i < IIWA_NB; i++) {
            d.command[i].q = (rbd_real)uniform(&seed, -1, 1);
            d.command[i].kp = (rbd_real)uniform(&seed, 0, 500);
            d.command[i].kd = (rbd_real)uniform(&seed, 0, 20);
            d.command[i].torque = motors[i].by_voltage ? 0 : (rbd_real)uniform(&seed, -50, 50);
            d.command[i].voltage = motors[i].by_voltage ? (rbd_real)uniform(&seed, -50, 50) : 0;
        }
        step(dt);
        for (int i = 0; i < IIWA_NB; i++)
            if (!(fabs((double)d.q[i]) < 1e9 && fabs((double)d.v[i]) < 1e9))
                fail("not finite", (double)d.v[i]);
        if (rbd_actuators_inverse(d.a, d.q, d.v, d.v, d.tau, drives) != RBD_OK) fail("inverse", 0);
        for (int i = 0; i < IIWA_NB; i++) {
            rbd_actuators_get(d.a, i, &s);
            judge_shaft(&motors[i], &s, &drives[i]);
        }
    }
}

/* ---- inverse and forward ---- */

/* The level of friction, as the header says. */
static double level_of(const rbd_gear_friction *f, double x, double motor, double joint) {
    const double S = exp(-pow(fabs(x) / (double)f->speed, (double)f->power));
    double Q = 0;
    if (!(motor * joint > 0) && fabs(joint) < fabs(motor)) Q = (double)f->square_joint * joint * joint;
    if (!(motor * joint > 0) && fabs(joint) > fabs(motor)) Q = (double)f->square_motor * motor * motor;
    return (double)f->coulomb + fabs((double)f->load_joint * joint - (double)f->load_motor * motor) +
           S * ((double)f->rest + fabs((double)f->rest_joint * joint - (double)f->rest_motor * motor) + Q);
}

/* What the inverse asks of a motor without limits gives the wanted torque. Where the squares jump, nothing
   does: that is rare. */
static int try_inverse(uint64_t seed) {
    rbd_motor m;
    rbd_drive o;
    rbd_real tau[1], v[1], acceleration[1];
    memset(&m, 0, sizeof m);
    m.joint = "axle";
    m.constant = (rbd_const)uniform(&seed, 0.01, 1);
    m.gear = (rbd_const)(uniform(&seed, 20, 100) * (below(&seed, 2) ? 1 : -1));
    m.inertia = (rbd_const)uniform(&seed, 1e-6, 2e-5);
    m.resistance = (rbd_const)0.5;
    draw_friction(&seed, &m.friction);
    m.friction.still = 0;
    build(wheel, 1, &m, NULL, 0, 0);
    d.q[0] = 1;
    tau[0] = (rbd_real)uniform(&seed, -20, 20);
    v[0] = (rbd_real)uniform(&seed, -3, 3);
    acceleration[0] = (rbd_real)uniform(&seed, -10, 10);
    if (rbd_actuators_inverse(d.a, d.q, v, acceleration, tau, &o) != RBD_OK) fail("inverse", 0);

    const double motor = (double)o.torque,
                 level = level_of(&m.friction, (double)v[0], motor, -(double)tau[0]);
    const double J = pow((double)m.gear, 2) * (double)m.inertia;
    const double out = motor - J * (double)acceleration[0] - (double)m.friction.viscous * (double)v[0] -
                       (v[0] > 0 ? 1 : -1) * level;
    const double by = fabs(out - (double)tau[0]) / (1 + fabs((double)tau[0]) + fabs(motor));
    const double current =
        fabs((double)o.current * (double)m.gear * (double)m.constant - motor) / (1 + fabs(motor));
    if (!(current < (in_float ? 1e-5 : 1e-12))) fail("current and torque differ", current);
    if (!(fabs(out) < 1e9)) fail("the inverse is not finite", out);
    return by > (in_float ? 1e-4 : 1e-10);
}

/* ---- energy of springs ---- */

/* A wheel of 0.1 kg m^2 that turns, and a rotor on a spring, perhaps with play and friction: no motor drives
   them. */
static void try_spring(uint64_t seed) {
    const double dt = power_of_ten(&seed, log10(0.5e-3), -2), J = power_of_ten(&seed, -3, 0);
    const double rounding = in_float ? 1e-5 : 1e-13;
    double last = 1e30;
    rbd_motor m;
    memset(&m, 0, sizeof m);
    m.joint = "axle";
    m.gear = (rbd_const)uniform(&seed, 10, 100);
    m.constant = 1;
    m.inertia = (rbd_const)(J / ((double)m.gear * (double)m.gear));
    m.stiffness = (rbd_const)power_of_ten(&seed, 0, 6);
    m.damping = (rbd_const)(below(&seed, 2) ? power_of_ten(&seed, -3, 1) : 0);
    m.backlash = (rbd_const)(below(&seed, 2) ? power_of_ten(&seed, -3, -1) : 0);
    if (below(&seed, 2)) m.friction.coulomb = (rbd_const)power_of_ten(&seed, -3, 0);
    if (below(&seed, 2)) m.friction.viscous = (rbd_const)power_of_ten(&seed, -3, 0);
    if (below(&seed, 3) == 0) m.friction.load_joint = (rbd_const)uniform(&seed, 0, 0.5);
    if (below(&seed, 3) == 0) {
        m.friction.rest = (rbd_const)power_of_ten(&seed, -3, 0);
        m.friction.speed = (rbd_const)0.2;
        m.friction.power = 2;
    }
    build(wheel, 1, &m, NULL, 0, below(&seed, 2));
    rbd_neutral(d.m, d.q);
    if (rbd_actuators_reset(d.a, d.q, 20) != RBD_OK) fail("rbd_actuators_reset", 0);
    d.v[0] = (rbd_real)uniform(&seed, 0.5, 5);

    const double first = 0.05 * (double)d.v[0] * (double)d.v[0];
    for (int i = 0; i < 1000; i++) {
        rbd_actuator_state s;
        step(dt);
        rbd_actuators_get(d.a, 0, &s);
        const double turn = fabs((double)s.angle - (double)d.q[0]), free = (double)m.backlash / 2;
        const double wound = turn > free ? turn - free : 0, k = (double)m.stiffness;
        const double energy =
            0.05 * pow((double)d.v[0], 2) + 0.5 * J * pow((double)s.speed, 2) + 0.5 * k * wound * wound;
        const double lost = rounding * (1 + (fabs((double)d.q[0]) + 1) * k * (wound + rounding) / first);
        if (!(energy <= last + first * lost)) {
            gains += s.repeats >= 50;
            if (s.repeats < 50) fail("a step adds energy", (energy - last) / first);
            return;
        }
        last = energy;
    }
}

/* ---- coupled shafts ---- */

static const rbd_body chain[3] = {{.joint = "one",
                                   .parent = -1,
                                   .type = RBD_CONTINUOUS,
                                   .axis = {0, 0, 1},
                                   .mass = 4,
                                   .com = {0, 0, -0.2},
                                   .inertia = {0.1, 0, 0, 0.1, 0, 0.05}},
                                  {.joint = "two",
                                   .parent = 0,
                                   .type = RBD_CONTINUOUS,
                                   .axis = {0, 1, 0},
                                   .position = {0, 0, -0.3},
                                   .mass = 1,
                                   .com = {0.05, 0, -0.2},
                                   .inertia = {0.02, 0, 0, 0.02, 0, 0.01}},
                                  {.joint = "three",
                                   .parent = 1,
                                   .type = RBD_CONTINUOUS,
                                   .axis = {0, 1, 0},
                                   .position = {0, 0, -0.4},
                                   .mass = 0.3,
                                   .com = {0, 0.02, -0.1},
                                   .inertia = {0.002, 0, 0, 0.002, 0, 0.001}}};

/* A matrix of good condition, and shafts whose friction sometimes holds the chain. */
static void try_coupled(uint64_t seed) {
    const double dt = power_of_ten(&seed, -4, -2), creep = in_float ? 1e-6 : 1e-9;
    rbd_transmission t;
    rbd_motor motors[3];
    memset(motors, 0, sizeof motors);
    memset(&t, 0, sizeof t);
    t.n = 3;
    for (int i = 0; i < 3; i++) {
        t.joint[i] = chain[i].joint;
        for (int k = 0; k < 3; k++)
            t.matrix[3 * i + k] = (rbd_const)(uniform(&seed, -0.5, 0.5) + (i == k ? 1.5 : 0));
        motors[i].gear = (rbd_const)(below(&seed, 2) ? 50 : -50);
        motors[i].constant = 1;
        motors[i].friction.coulomb = (rbd_const)power_of_ten(&seed, -2, 1.3);
        if (below(&seed, 2)) motors[i].friction.viscous = (rbd_const)uniform(&seed, 0, 1);
        if (below(&seed, 4) == 0) motors[i].friction.bristle = (rbd_const)power_of_ten(&seed, 2, 5);
    }
    build(chain, 3, motors, &t, 1, below(&seed, 2));
    for (int i = 0; i < 3; i++) {
        d.q[i] = (rbd_real)uniform(&seed, -1, 1);
        d.v[i] = (rbd_real)uniform(&seed, -2, 2);
    }
    if (rbd_actuators_reset(d.a, d.q, 20) != RBD_OK) fail("rbd_actuators_reset", 0);

    for (int n = 0; n < 200; n++) {
        rbd_real before[3];
        if (rbd_actuators_map(d.a, d.q, d.v, NULL, before) != RBD_OK) fail("rbd_actuators_map", n);
        step(dt);
        for (int i = 0; i < 3; i++) {
            rbd_actuator_state s;
            rbd_actuators_get(d.a, i, &s);
            if (s.repeats >= 50) break;
            const double end = (double)s.speed, x_0 = (double)before[i], level = (double)s.friction;
            const double off = (in_float ? 1e-2 : 1e-8) * (1 + level + (fabs(x_0) + fabs(end)) / dt);
            /* in a step of second order friction at the mean speed takes energy, but for what creeps */
            const double work = (double)s.joint * (x_0 + end),
                         most = off * fabs(x_0 + end) + 100 * creep * level;
            if (!(motors[i].friction.bristle > 0) && !d.first_order && work > most)
                fail("friction of a shaft that turns adds energy", work);
            const int turns = !d.first_order && x_0 * end < 0;
            const double turned = fabs(end) < fabs(x_0) ? end : -x_0, x = turns ? end - turned : end;
            const double f = (double)s.joint + (double)motors[i].friction.viscous * x;
            if (!(fabs(f) <= level + off)) fail("friction is above its level", fabs(f) - level);
            if (motors[i].friction.bristle > 0) continue;
            if (fabs(x) > creep * 100 + (turns ? 2e-3 * fabs(x_0) : 0) &&
                !(fabs(f + copysign(level, x)) <= off))
                fail("friction of a shaft that slides is not its level", f);
        }
    }
}

/* ---- limbs ---- */

static const char *const letter[MOST] = {"a", "b", "c", "d", "e", "f", "g", "h", "i", "j", "k", "l", "m"};

/* A limb: joints in a row or a tree, which all slide or all turn. Transmissions move some of them. */
typedef struct limb {
    int n, coupled, groups, turns, driven; /* joints, of which so many have transmissions */
    double dt;
    rbd_body bodies[MOST];
    rbd_motor motors[MOST];
    rbd_transmission by[TRANSMISSIONS];
    double bristle[MOST], from[MOST]; /* torques of the bristles; shaft angles before the step */
    double quickest;                  /* speed of a joint */
} limb;

static void draw_bodies(uint64_t *seed, limb *l) {
    const double wide = uniform(seed, 0, in_float ? 1 : 2); /* float: else some masses are singular */
    const int tree = below(seed, 3) == 0;
    for (int i = 0; i < l->n; i++) {
        rbd_body *b = &l->bodies[i];
        b->joint = letter[i];
        b->parent = tree ? below(seed, i + 1) - 1 : i - 1;
        b->type = l->turns ? RBD_CONTINUOUS : RBD_PRISMATIC;
        b->mass = (rbd_const)power_of_ten(seed, -wide, wide);
        for (int k = 0; k < 3; k++) b->axis[k] = (rbd_const)uniform(seed, -1, 1);
        b->position[2] = (rbd_const)(i ? -0.3 : 0);
        b->com[2] = (rbd_const)-0.1;
        b->inertia[0] = b->inertia[3] = b->inertia[5] = (rbd_const)(0.02 * (double)b->mass);
    }
}

/* Gives the joints, in any order, to the transmissions and to motors of their own. */
static void draw_transmissions(uint64_t *seed, limb *l) {
    int order[MOST], at = 0;
    for (int i = 0; i < l->n; i++) order[i] = i;
    for (int i = l->n - 1; i > 0; i--) {
        const int k = below(seed, i + 1), kept = order[i];
        order[i] = order[k];
        order[k] = kept;
    }
    for (int g = 0; g < l->groups; at += l->by[g++].n) {
        rbd_transmission *t = &l->by[g];
        t->motor = at;
        for (int i = 0; i < t->n; i++) {
            t->joint[i] = letter[order[at + i]];
            for (int k = 0; k < t->n; k++)
                t->matrix[t->n * i + k] = (rbd_const)(uniform(seed, -0.5, 0.5) + (i == k ? 1.5 : 0));
        }
    }
    for (int i = at; i < l->n; i++) l->motors[i].joint = letter[order[i]];
}

static void draw_wide_friction(uint64_t *seed, rbd_gear_friction *f, int rigid) {
    if (below(seed, 2)) f->coulomb = (rbd_const)power_of_ten(seed, -3, 2);
    if (below(seed, 2)) f->viscous = (rbd_const)power_of_ten(seed, -3, 2);
    if (below(seed, 4) == 0) f->load_joint = (rbd_const)uniform(seed, 0, 0.5);
    if (below(seed, 4) == 0) f->load_motor = (rbd_const)uniform(seed, 0, 0.5);
    if (below(seed, 4) == 0) {
        f->rest = (rbd_const)power_of_ten(seed, -3, 1);
        f->speed = (rbd_const)power_of_ten(seed, -2, 0);
        f->power = 2;
    }
    if (rigid && f->coulomb > 0 && below(seed, 6) == 0) f->bristle = (rbd_const)power_of_ten(seed, 2, 6);
}

/* A motor with rotor, spring, play and friction of any size. */
static void draw_wide_motor(uint64_t *seed, rbd_motor *m, int drives) {
    const int spring = below(seed, 3) == 0;
    m->gear = (rbd_const)(power_of_ten(seed, 0, 2) * (below(seed, 2) ? 1 : -1));
    m->constant = (rbd_const)power_of_ten(seed, -2, 0);
    if (spring || below(seed, 2)) m->inertia = (rbd_const)power_of_ten(seed, -6, 2) / (m->gear * m->gear);
    if (spring) {
        m->stiffness = (rbd_const)power_of_ten(seed, 0, 9);
        if (below(seed, 2)) m->damping = (rbd_const)power_of_ten(seed, -3, 3);
        if (below(seed, 2)) m->backlash = (rbd_const)power_of_ten(seed, -4, -1);
    }
    draw_wide_friction(seed, &m->friction, !spring);
    if (!drives) return;

    if (below(seed, 2)) m->current = (rbd_const)power_of_ten(seed, -1, 2);
    if (below(seed, 2)) m->voltage = (rbd_const)power_of_ten(seed, 0, 2);
    if (m->voltage > 0 || below(seed, 3) == 0) m->resistance = (rbd_const)power_of_ten(seed, -2, 1);
    m->by_voltage = m->resistance > 0 && below(seed, 3) == 0;
}

static void draw_limb(uint64_t *seed, limb *l) {
    const double dt[6] = {5e-4, 1e-3, 2e-3, 3e-3, 5e-3, 1e-2};
    memset(l, 0, sizeof *l);
    l->dt = dt[below(seed, 6)];
    l->turns = below(seed, 2);
    l->driven = below(seed, 2);
    l->groups = below(seed, TRANSMISSIONS + 1);
    for (int g = 0; g < l->groups; g++) l->coupled += l->by[g].n = 1 + below(seed, 3);
    l->n = l->coupled + (l->groups ? below(seed, 4) : 1 + below(seed, 4));
    draw_bodies(seed, l);
    for (int i = 0; i < l->n; i++) draw_wide_motor(seed, &l->motors[i], l->driven);
    draw_transmissions(seed, l);
    build(l->bodies, l->n, l->motors, l->by, l->groups, below(seed, 2));

    const rbd_real none[3] = {0, 0, 0};
    if (rbd_set_gravity(d.w, none) != RBD_OK) exit(2);
    for (int i = 0; i < l->n; i++) {
        d.q[i] = (rbd_real)(l->turns ? uniform(seed, -1, 1) : 0);
        d.v[i] = (rbd_real)uniform(seed, -3, 3);
        if (!l->driven) continue;
        d.command[i].q = (rbd_real)uniform(seed, -1, 1);
        if (below(seed, 2)) d.command[i].kp = (rbd_real)power_of_ten(seed, 0, 6);
        if (below(seed, 2)) d.command[i].kd = (rbd_real)power_of_ten(seed, -1, 4);
    }
    if (rbd_actuators_reset(d.a, d.q, 25) != RBD_OK) fail("rbd_actuators_reset", 0);
}

/* Gains of a drive are volts, if it sets those: the torque for a volt. */
static double by_volt(const rbd_motor *m) {
    return m->by_voltage ? fabs((double)m->gear * (double)m->constant) / (double)m->resistance : 1;
}

/* Energy of a drive that holds its command's angle: of a spring kp whose torque its limits cut. */
static double energy_of_drive(const rbd_motor *m, const rbd_command *c, double angle) {
    const double kp = (double)c->kp * by_volt(m), off = fabs((double)c->q - angle);
    const double constant = fabs((double)m->gear * (double)m->constant);
    double most = INFINITY;
    if (m->current > 0) most = constant * (double)m->current;
    if (m->voltage > 0) most = fmin(most, constant * (double)m->voltage / (double)m->resistance);
    return kp * off <= most ? 0.5 * kp * off * off : most * off - 0.5 * most * most / kp;
}

/* What kd and the back-EMF of a rigid shaft may give in a step of second order, docs/actuators.md. */
static double lent_by_damping(const limb *l, int i, double speed) {
    const rbd_motor *m = &l->motors[i];
    const double constant = (double)m->gear * (double)m->constant;
    double damping = (double)d.command[i].kd * by_volt(m);
    if (!l->driven || d.first_order || m->stiffness > 0) return 0;
    if (m->voltage > 0 || m->by_voltage) damping += constant * constant / (double)m->resistance;
    return l->dt * damping * speed * speed / 8;
}

/* Energy of shaft i beyond that of the bodies. Adds to *terms what its differences are made of. The torques
   of coupled joints are rounded by the damping that they are told. */
static double energy_of_shaft(limb *l, int i, double joint_angle, double joint_speed, double *terms) {
    const rbd_motor *m = &l->motors[i];
    const double J = (double)m->gear * (double)m->gear * (double)m->inertia, k = (double)m->stiffness;
    rbd_actuator_state s;
    rbd_actuators_get(d.a, i, &s);
    const double angle = k > 0 ? (double)s.angle : joint_angle, speed = k > 0 ? (double)s.speed : joint_speed;
    const double wound = larger(0, fabs(angle - joint_angle) - (double)m->backlash / 2);
    double energy = 0.5 * J * speed * speed + 0.5 * k * wound * wound;
    *terms += k * wound * (fabs(angle) + fabs(joint_angle));
    if (l->coupled) *terms += 0.1 * l->dt * (l->dt * k + (double)m->damping) * l->quickest * l->quickest;

    if (m->friction.bristle > 0) {
        const double stiffness = (double)m->friction.bristle, level = (double)s.friction;
        l->bristle[i] += stiffness * (joint_angle - l->from[i]);
        l->bristle[i] = fmin(level, fmax(-level, l->bristle[i]));
        energy += 0.5 * l->bristle[i] * l->bristle[i] / stiffness;
    }
    if (l->driven && d.command[i].kp > 0) {
        energy += energy_of_drive(m, &d.command[i], angle);
        *terms +=
            (double)d.command[i].kp * by_volt(m) * fabs((double)d.command[i].q - angle) * (fabs(angle) + 1);
    }
    l->from[i] = joint_angle;
    return energy;
}

static double energy_of_limb(limb *l, double *terms) {
    rbd_real mass[MOST * MOST], angle[MOST], speed[MOST];
    double energy = 0;
    l->quickest = 0;
    for (int i = 0; i < l->n; i++) l->quickest = larger(l->quickest, fabs((double)d.v[i]));
    if (rbd_crba(d.m, d.w, d.q, mass) != RBD_OK || rbd_actuators_map(d.a, d.q, d.v, angle, speed) != RBD_OK)
        fail("rbd_crba", 0);
    for (int i = 0; i < l->n; i++) {
        for (int k = 0; k < l->n; k++)
            energy += 0.5 * (double)d.v[i] * (double)mass[l->n * i + k] * (double)d.v[k];
        energy += energy_of_shaft(l, i, (double)angle[i], (double)speed[i], terms);
    }
    *terms += energy;
    return energy;
}

/* Joints that slide have a constant mass: no step that settles adds energy to theirs. Some that turn become
   so quick that rbd_contact_step, which takes what is square in the speeds as constant, is no step. */
static void try_limb(uint64_t seed) {
    limb l;
    double terms = 0;
    draw_limb(&seed, &l);
    rbd_real angle[MOST], speed[MOST];
    if (rbd_actuators_map(d.a, d.q, d.v, angle, speed) != RBD_OK) fail("rbd_actuators_map", 0);
    for (int i = 0; i < l.n; i++) l.from[i] = (double)angle[i];

    const double first = energy_of_limb(&l, &terms);
    double last = first;
    for (int n = 0; n < 60 && l.quickest < 300; n++) {
        const long before = unsettled;
        double lent = 0;
        if (rbd_actuators_map(d.a, d.q, d.v, NULL, speed) != RBD_OK) fail("rbd_actuators_map", n);
        for (int i = 0; i < l.n; i++) lent += lent_by_damping(&l, i, (double)speed[i]);
        step(l.dt);

        terms = first;
        const double energy = energy_of_limb(&l, &terms);
        if (!(energy < 1e30)) fail("energy of a limb is not finite", energy);
        if (!l.turns && unsettled == before &&
            !(energy <= last + lent + 200 * (double)RBDI_EPS * terms + 1e-13))
            fail("a step adds energy to a limb", (energy - last) / first);
        last = energy;
    }
}

/* ---- bad tables ---- */

static const struct {
    const char *name;
    size_t at;
    int sign; /* a negative number is right */
} field[] = {
#define MOTOR(name, sign) {#name, offsetof(rbd_motor, name), sign}
#define FRICTION(name) {#name, offsetof(rbd_motor, friction) + offsetof(rbd_gear_friction, name), 0}
    MOTOR(gear, 1),         MOTOR(constant, 0),     MOTOR(inertia, 0),    MOTOR(resistance, 0),
    MOTOR(current, 0),      MOTOR(voltage, 0),      MOTOR(copper, 0),     MOTOR(heat_winding, 0),
    MOTOR(heat_case, 0),    MOTOR(flow_winding, 0), MOTOR(flow_case, 0),  MOTOR(hot, 0),
    MOTOR(hottest, 0),      MOTOR(cogging, 0),      MOTOR(teeth, 0),      MOTOR(phase, 1),
    MOTOR(step, 0),         MOTOR(offset, 1),       MOTOR(stiffness, 0),  MOTOR(damping, 0),
    MOTOR(backlash, 0),     FRICTION(coulomb),      FRICTION(viscous),    FRICTION(load_motor),
    FRICTION(load_joint),   FRICTION(rest),         FRICTION(rest_motor), FRICTION(rest_joint),
    FRICTION(square_motor), FRICTION(square_joint), FRICTION(speed),      FRICTION(power),
    FRICTION(bristle),      FRICTION(still)};
enum { FIELDS = sizeof field / sizeof *field };

/* Whether a field is 0: one that the bad one needs is told as missing first. */
static int is_missing(const rbd_motor *m, const char *name) {
    for (int f = 0; f < FIELDS; f++) {
        rbd_const x;
        memcpy(&x, (const char *)m + field[f].at, sizeof x);
        if (strcmp(field[f].name, name) == 0) return x <= 0 && x >= 0;
    }
    return 0;
}

/* A field of one of the motors is bad: its name and motor are told, and nothing is made. */
static void try_table(uint64_t seed) {
    const double bad[5] = {NAN, INFINITY, 1e30, -1e30, -1};
    const int at = below(&seed, IIWA_NB), f = below(&seed, FIELDS), k = below(&seed, field[f].sign ? 4 : 5);
    const rbd_const value = (rbd_const)bad[k];
    rbd_motor motors[IIWA_NB];
    rbd_report report;
    rbd_status status;
    for (int i = 0; i < IIWA_NB; i++) {
        draw_motor(&seed, &motors[i]);
        motors[i].joint = joints[i];
    }
    build(iiwa_bodies, IIWA_NB, motors, NULL, 0, 0);
    memcpy((char *)&motors[at] + field[f].at, &value, sizeof value);
    status = rbd_actuators_init(d.m, motors, IIWA_NB, NULL, 0, memory, sizeof memory, &d.a, &report);
    if (status != RBD_ERR_RANGE || report.error.body != at || d.a) {
        printf("motor %d, %s = %g\n", at, field[f].name, bad[k]);
        fail("a bad field is not refused", status);
    } else if (strcmp(report.error.field, field[f].name) != 0 &&
               !is_missing(&motors[at], report.error.field)) {
        printf("%s, not %s, is named\n", report.error.field, field[f].name);
        fail("another field is named", bad[k]);
    }
}

/* Commands and states that are not right are refused, and the next step is as without them. */
static void try_command(uint64_t seed) {
    rbd_motor m;
    rbd_real *const where[8] = {
        &d.command[0].q,      &d.command[0].v,       &d.command[0].kp, &d.command[0].kd,
        &d.command[0].torque, &d.command[0].voltage, &d.q[0],          &d.v[0]};
    rbd_real tau[2], damping[2];
    draw_motor(&seed, &m);
    m.joint = "axle";
    build(wheel, 1, &m, NULL, 0, 0);
    d.q[0] = 1;
    if (rbd_actuators_reset(d.a, d.q, 20) != RBD_OK) fail("rbd_actuators_reset", 0);
    *(m.by_voltage ? &d.command[0].voltage : &d.command[0].torque) = 1;
    for (int i = 0; i < 8; i++) {
        const double bad[3] = {NAN, 1e30, -1};
        for (int k = 0; k < (i == 2 || i == 3 ? 3 : 2); k++) {
            const rbd_real kept = *where[i];
            *where[i] = (rbd_real)bad[k];
            tau[0] = damping[0] = 7;
            const rbd_status status =
                rbd_actuators_begin(d.a, d.command, d.q, d.v, (rbd_real)1e-3, 0, tau, damping);
            *where[i] = kept;
            if (status != (i < 6 ? RBD_ERR_RANGE : RBD_ERR_NAN))
                fail("a bad command or state is not refused", i);
            if (!(tau[0] >= 7 && tau[0] <= 7 && damping[0] >= 7 && damping[0] <= 7))
                fail("a refusal changed tau", i);
        }
    }
    step(1e-3);
    if (!(fabs((double)d.v[0]) < 1e6)) fail("the step after a refusal is not finite", (double)d.v[0]);
}

/* ---- run ---- */

int main(int count, char **arguments) {
    long problems = 300, seconds = 0, tried = 0, jumps = 0;
    const time_t begin = time(NULL);
    uint64_t start = 1;

    for (int i = 1; i + 1 < count; i += 2) {
        if (!strcmp(arguments[i], "--problems")) problems = atol(arguments[i + 1]);
        if (!strcmp(arguments[i], "--seconds")) seconds = atol(arguments[i + 1]);
        if (!strcmp(arguments[i], "--seed")) start = strtoull(arguments[i + 1], NULL, 10);
    }
    for (; seconds ? time(NULL) - begin < seconds : tried < problems; tried++) {
        number = start + (uint64_t)tried;
        try_robot(number);
        for (uint64_t k = 0; k < 20; k++) jumps += try_inverse(20 * number + k);
        try_spring(number);
        try_coupled(number);
        for (uint64_t k = 0; k < 3; k++) try_limb(3 * number + k);
        for (uint64_t k = 0; k < 20; k++) try_table(20 * number + k);
        try_command(number);
    }
    printf(
        "%ld problems of each kind, %ld steps, %ld not settled, %ld of %ld inverses at a jump, %ld runs gain "
        "energy in a step that does not settle, wrong: %ld\n",
        tried, steps, unsettled, jumps, 20 * tried, gains, wrong);
    return wrong > 0 || steps == 0 || unsettled * 5000 > steps || jumps * 100 > 20 * tried;
}
