/* hopper.c - a leg finds out when to touch the ground: it stands, and shall stand half a metre further on
   after 0.7 s. Nobody tells it that it has to hop. The cost knows the place of the trunk, motion and
   effort, but no contacts; iterative LQR gets the derivatives of whole steps with contact, and decides
   when the foot lifts, lands, sticks and slips. Then the plan is tried with steps a tenth as long. Prints
   a table for hopper.gp. SPDX-License-Identifier: MIT */
#define RBD_IMPLEMENTATION
#include "check.h"
#include "rbd_contact.h"
#include "squares.h"
#include "../larger.h"

#include <stdio.h>
#include <stdlib.h>

enum { SLIDE, TRUNK, THIGH, SHIN, NB };                       /* bodies */
enum { X, Z, HIP, LEG, NV, NU = NV - HIP, NZ = 2 * NV + NU }; /* degrees of freedom */
enum { N = 100, SETTLED = 70, STEPS = 10 };                   /* knots; of the robot in each */
static const double tick = 0.01, forward = 0.5, height = 0.5; /* s, m: of the trunk, and of the leg */
static const double friction = 1, lower[NU] = {-30, -120}, upper[NU] = {30, 120}; /* N m, N */

/* A trunk that does not turn, as on a boom, and a leg that swings and gets longer. */
/* clang-format off */
static const rbd_body bodies[NB] = {
    {.name = "slide", .parent = -1, .type = RBD_PRISMATIC, .axis = {1, 0, 0}},
    {.name = "trunk", .parent = SLIDE, .type = RBD_PRISMATIC, .axis = {0, 0, 1}, .mass = 2},
    {.name = "thigh", .parent = TRUNK, .type = RBD_REVOLUTE, .axis = {0, -1, 0}, .mass = 0.3,
     .com = {0, 0, -0.1}, .inertia = {1e-3, 0, 0, 1e-3, 0, 1e-4}},
    {.name = "shin", .parent = THIGH, .type = RBD_PRISMATIC, .axis = {0, 0, -1}, .mass = 0.2,
     .com = {0, 0, -0.4}, .inertia = {6e-4, 0, 0, 6e-4, 0, 1e-4}, .armature = {0.2}},
};
/* clang-format on */
static const rbd_contact foot = {.body1 = SHIN, .body2 = -1, .point = {0, 0, -height}, .friction = friction};

static const rbd_model *m;
static rbd_work *w;
static rbd_derivatives *d;
static rbd_contact_set *c;

static struct { /* what the foot did in each step of the last rollout */
    rbd_contact_state state;
    double height, force[3];
} past[N];

static void check(rbd_status status) {
    if (status == RBD_OK) return;
    fprintf(stderr, "%s\n", rbd_status_string(status));
    exit(EXIT_FAILURE);
}

/* ---- the problem ---- */

/* The step is a function of its inputs alone: it forgets the impulses of the one before. */
static rbd_status step(void *user, int k, const double *q, const double *v, const double *u, double *v_next) {
    const double tau[NV] = {0, 0, u[0], u[1]};
    double q_next[NV];
    (void)user;
    rbd_contact_reset(c);
    const rbd_status status = rbd_contact_step(m, c, q, v, tau, NULL, NULL, tick, q_next, v_next);
    past[k].state = rbd_contact_get(c, 0, &past[k].height, past[k].force);
    return status;
}

static rbd_status derivatives(void *user, const double *q, const double *v, const double *u, double *f_z) {
    static double q_next[NV], v_next[NV], unused[3][NV * NV], by_q[NV * NV], by_v[NV * NV], by_tau[NV * NV];
    static const rbd_contact_step_results out = {q_next,    v_next, unused[0], unused[1],
                                                 unused[2], by_q,   by_v,      by_tau};
    rbd_status status = RBD_OK;
    (void)user;
    for (int k = 0; k < N && status == RBD_OK; k++, q += NV, v += NV, u += NU) {
        const double tau[NV] = {0, 0, u[0], u[1]};
        rbd_contact_reset(c);
        status = rbd_contact_step_derivatives(m, c, d, q, v, tau, NULL, NULL, tick, &out);
        for (int i = 0; i < NV * NV; i += NV) {
            for (int j = 0; j < NV; j++) *f_z++ = by_q[i + j];
            for (int j = 0; j < NV; j++) *f_z++ = by_v[i + j];
            for (int j = HIP; j < NV; j++) *f_z++ = by_tau[i + j];
        }
    }
    return status;
}

/* The trunk shall be at its place and everything at rest from 0.7 s on; the leg rather straight down. */
static rbd_status cost(void *user, int k, const double *q, const double *v, const double *u, double *l,
                       double *l_z, double *l_zz) {
    const squares s = {l, l_z, l_zz, NZ};
    const double place = k < SETTLED ? 1 : 1000, motion = k < SETTLED ? 0 : 10;
    static const double effort[NU] = {1e-3, 1e-4};
    (void)user;
    *l = 0;
    squares_entry(&s, place, q[X] - forward, X);
    squares_entry(&s, place, q[Z] - height, Z);
    squares_entry(&s, 3, q[HIP], HIP);
    squares_entry(&s, 30, q[LEG], LEG);
    for (int i = 0; i < NV; i++) squares_entry(&s, motion, v[i], NV + i);
    for (int i = 0; i < NU && u; i++) squares_entry(&s, effort[i], u[i], 2 * NV + i);
    return RBD_OK;
}

/* ---- the plan ---- */

static ilqr s;
static const double start[NV] = {0, height}, still[NV];

/* Everything in static memory. The first guess: it stands. */
static void prepare(void) {
    static unsigned char model_memory[RBD_MODEL_SIZE(NB)], work_memory[RBD_WORK_SIZE(NB, NV)],
        derivatives_memory[RBD_DERIVATIVES_SIZE(NB, NV)], contact_memory[1 << 13];
    static double reals[ILQR_REALS(NV, NV, NU, N)], dt[N];
    static ilqr_problem p = {.knots = N,
                             .nu = NU,
                             .dt = dt,
                             .lower = lower,
                             .upper = upper,
                             .step = step,
                             .derivatives = derivatives,
                             .cost = cost};
    /* A row of every step: in one tick the motor may push the foot down by more than the default margin. */
    /* The planner moves q by v_next: first order. */
    const rbd_contact_options options = {.margin = 1, .tolerance = 1e-10, .derivatives = 1, .first_order = 1};
    check(rbd_model_build(bodies, NB, model_memory, sizeof model_memory, &m, NULL));
    check(rbd_work_init(m, work_memory, sizeof work_memory, &w));
    check(rbd_derivatives_init(m, w, derivatives_memory, sizeof derivatives_memory, &d));
    check(rbd_contact_set_init(m, w, &foot, 1, NULL, 0, &options, contact_memory, sizeof contact_memory, &c,
                               NULL));
    p.m = m;
    check(ilqr_init(&s, &p, reals, sizeof reals / sizeof *reals));
    for (int k = 0; k < N; k++) {
        dt[k] = tick;
        s.u[k * NU + LEG - HIP] = 9.81 * (bodies[TRUNK].mass + bodies[THIGH].mass);
    }
    check(ilqr_start(&s, start, still));
}

/* Iterates until nothing is to be gained. Returns whether the cost fell in each of fewer than 100. There are
   many ways to hop: rounding errors decide which one it finds, and after how many iterations. */
static int converge(void) {
    int better = 1, falling = 1, iterations = 0;
    s.tolerance = 1e-5;
    while (better && iterations < 100) {
        const double before = s.cost;
        check(ilqr_iterate(&s, &better));
        falling = falling && (better ? s.cost < before : s.cost == before);
        iterations += better;
    }
    check(ilqr_start(&s, start, still)); /* once more, for what the foot does */
    return falling && !better;
}

/* By time: where trunk and foot are, and the force of the ground on the foot. */
static void print_table(void) {
    puts("t s,trunk's x m,its height m,foot's x m,its height m,force along N,force up N");
    for (int k = 0; k < N; k++) {
        const double *q = s.q + k * NV;
        double toe[3];
        check(rbd_kinematics(m, w, q, NULL, NULL));
        check(rbd_point_position(m, w, SHIN, foot.point, toe));
        printf("%.2f,%.4f,%.4f,%.4f,%.4f,%.2f,%.2f\n", k * tick, q[X], q[Z], toe[0], toe[2], past[k].force[0],
               past[k].force[2]);
    }
}

/* ---- what must be true of it ---- */

/* Does the state stand where it shall? Within 1 cm, and 10 cm/s. */
static int stands(const double *q, const double *v) {
    double motion = 0;
    for (int i = 0; i < NV; i++) motion = larger(motion, fabs(v[i]));
    return fabs(q[X] - forward) < 0.01 && fabs(q[Z] - height) < 0.01 && motion < 0.1;
}

/* Does it hop? The foot pushes, lifts for more than 50 ms in all, and pushes at the end. */
static int hops(void) {
    int air = 0;
    for (int k = 0; k < N; k++) air += !(past[k].force[2] > 0);
    return past[0].force[2] > 0 && air * tick > 0.05 && past[N - 1].force[2] > 0;
}

/* In each knot: the force is within the cone, and 0 above the ground but for a rounding of the step: it
   turns a leg by a finite angle. The foot is not in the ground. */
static int keeps_laws(void) {
    int keeps = 1;
    for (int k = 0; k < N; k++) {
        const double *f = past[k].force, after = k < N - 1 ? past[k + 1].height : 0;
        keeps = keeps && f[2] >= 0 && fabs(f[0]) <= friction * f[2] * (1 + 1e-9);
        keeps = keeps && past[k].height > -1e-4 && (f[2] <= 0 || after < 5e-3);
    }
    return keeps;
}

/* The robot: steps of a millisecond, and in each the plan's torques and gains, between the knots. */
static int replay_stands(void) {
    double q[NV], v[NV] = {0}, u[NU];
    memcpy(q, start, sizeof q);
    for (int i = 0; i < N * STEPS; i++) {
        const int k = i / STEPS;
        const double part = (double)(i % STEPS) / STEPS, *q_k = s.q + k * NV, *v_k = s.v + k * NV;
        for (int r = 0; r < NU; r++) {
            const double *K = s.K + (k * NU + r) * 2 * NV;
            u[r] = s.u[k * NU + r];
            for (int j = 0; j < NV; j++) {
                u[r] += K[j] * (q[j] - q_k[j] - part * (q_k[j + NV] - q_k[j]));
                u[r] += K[j + NV] * (v[j] - v_k[j] - part * (v_k[j + NV] - v_k[j]));
            }
            u[r] = ilqr_clamp(u[r], lower[r], upper[r]);
        }
        const double tau[NV] = {0, 0, u[0], u[1]};
        check(rbd_contact_step(m, c, q, v, tau, NULL, NULL, tick / STEPS, q, v));
    }
    return stands(q, v);
}

/* Prints what should be so, and whether it is. */
static int fact(const char *what, int is) {
    fprintf(stderr, "%s: %s\n", what, is ? "yes" : "no");
    return is;
}

int main(void) {
    prepare();
    const double standing = s.cost;
    int good = fact("the cost fell in each iteration, fewer than 100", converge());
    good = fact("to less than a hundredth of what standing costs", s.cost < 0.01 * standing) && good;
    good = fact("the foot lifts and lands, and is in the air for more than 50 ms", hops()) && good;
    good = fact("forces within the cone, and none above the ground, in all knots", keeps_laws()) && good;
    good = fact("stands within 10 mm of the goal at the end", stands(s.q + N * NV, s.v + N * NV)) && good;
    print_table();
    good = fact("so does a robot that follows the plan with steps of 1 ms", replay_stands()) && good;
    return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
