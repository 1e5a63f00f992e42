/* five_bar.c - a five-bar mechanism, from its description to torques: a chain of two rods on either side,
   whose ends a loop joint holds together. Motors in the two cranks alone lead the tip along a circle: inverse
   kinematics of two rods each, computed torque, and rbd_constrained_id for the motors. Moved by
   rbd_constrained_fd. */
#define RBD_IMPLEMENTATION
#include "rbd_constraints.h"
#include "larger.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { NB = 4, NV = 4, ROWS = 2, STEPS = 2000 };

static const double ground = 0.2, crank = 0.25, rod = 0.35; /* m: between the motors; of both sides */

/* Rods along their x in the x-z plane, turning against y, so that angles run from x to z. */
#define ROD(parent_, x, length, mass_) \
    {.parent = parent_, \
     .type = RBD_REVOLUTE, \
     .axis = {0, -1, 0}, \
     .position = {x, 0, 0}, \
     .mass = mass_, \
     .com = {length / 2, 0, 0}, \
     .inertia = {1e-5, 0, 0, mass_ * length * length / 12, 0, mass_ * length * length / 12}}
static const rbd_body bodies[NB] = {ROD(-1, -0.1, 0.25, 0.6), ROD(0, 0.25, 0.35, 0.3),
                                    ROD(-1, 0.1, 0.25, 0.6), ROD(2, 0.25, 0.35, 0.3)};

static unsigned char model_memory[RBD_MODEL_SIZE(NB)], memory[RBD_WORK_SIZE(NB, NV)],
    set_memory[RBD_CONSTRAINT_SET_SIZE(NV, ROWS)];
static const rbd_model *m;
static rbd_work *w;
static rbd_constraint_set *loop;

static void check(rbd_status status) {
    if (status != RBD_OK) exit((fprintf(stderr, "%s\n", rbd_status_string(status)), EXIT_FAILURE));
}

/* In a plane two rows hold two points together; a ball's third would only be dependent. */
static void describe(void) {
    const double end[3] = {rod, 0, 0};
    rbd_constraint k = rbd_ball_loop(1, end, 3, end);
    k.axes[4] = 0;
    k.kp = 400, k.kd = 40; /* drift comes back within 0.1 s */
    check(rbd_model_build(bodies, NB, model_memory, sizeof model_memory, &m, NULL));
    check(rbd_work_init(m, memory, sizeof memory, &w));
    check(rbd_constraint_set_init(m, w, &k, 1, set_memory, sizeof set_memory, &loop, NULL));
}

/* Velocities or accelerations of all joints with which the tip has x, z, and each side by itself: two
   equations each. q_dot: NULL for velocities. */
static void follow(const double q[NV], const double q_dot[NV], double x, double z, double out[NV]) {
    for (int side = 0; side < NV; side += 2) {
        const double a = q[side], b = a + q[side + 1], ca = crank * cos(a), sa = crank * sin(a),
                     cb = rod * cos(b), sb = rod * sin(b);
        const double wa = q_dot ? q_dot[side] : 0, wb = q_dot ? wa + q_dot[side + 1] : 0;
        const double ex = x + wa * wa * ca + wb * wb * cb, ez = z + wa * wa * sa + wb * wb * sb;
        const double D = sa * cb - ca * sb; /* of (-sa -sb; ca cb), with the other sign */
        out[side] = -(cb * ex + sb * ez) / D;
        out[side + 1] = (ca * ex + sa * ez) / D - out[side];
    }
}

/* The tip, and its velocity. */
static void tip(const double q[NV], const double v[NV], double at[2], double moves[2]) {
    const double a = q[0], b = q[0] + q[1], wb = v[0] + v[1];
    at[0] = -ground / 2 + crank * cos(a) + rod * cos(b);
    at[1] = crank * sin(a) + rod * sin(b);
    moves[0] = -crank * sin(a) * v[0] - rod * sin(b) * wb;
    moves[1] = crank * cos(a) * v[0] + rod * cos(b) * wb;
}

int main(void) {
    const double guess[NV] = {2.2, -1.2, 0.9, 1.2}, pi = 3.14159265358979;
    const unsigned char motors[NV] = {1, 0, 1, 0};
    double q[NV], v[NV] = {0}, a[NV], tau[NV], e[ROWS], open = 0, passive = 0, late = 0;
    describe();
    check(rbd_assemble(m, loop, guess, NULL, NULL, q, NULL));
    for (int step = 0; step <= STEPS; step++) {
        const double t = step * 1e-3, phase = pi * t, radius = 0.05;
        const double want[2] = {radius * sin(phase), 0.45 - radius * cos(phase)};
        const double moving[2] = {pi * radius * cos(phase), pi * radius * sin(phase)};
        const double turning[2] = {-pi * pi * radius * sin(phase), pi * pi * radius * cos(phase)};
        double at[2], moves[2], x[2];
        tip(q, v, at, moves);
        for (int i = 0; i < 2; i++) x[i] = turning[i] + 20 * (moving[i] - moves[i]) + 100 * (want[i] - at[i]);
        follow(q, v, x[0], x[1], a);
        check(rbd_constrained_id(m, loop, q, v, a, NULL, motors, NULL, tau, NULL));
        passive = larger(passive, larger(fabs(tau[1]), fabs(tau[3])));
        if (step >= 1000) late = larger(late, hypot(at[0] - want[0], at[1] - want[1]));
        if (step % 500 == 0)
            printf("%.1f s: torques %6.3f %6.3f N m, tip off by %6.3f mm\n", t, tau[0], tau[2],
                   1e3 * hypot(at[0] - want[0], at[1] - want[1]));
        tau[1] = tau[3] = 0;
        check(rbd_constrained_fd(m, loop, q, v, tau, NULL, a, NULL));
        check(rbd_step(m, q, v, a, 1e-3, q, v));
        check(rbd_constraint_jacobian(m, loop, q, v, NULL, NULL, e));
        open = larger(open, hypot(e[0], e[1]));
    }
    printf("the loop opens by less than 0.1 mm, motors suffice, the tip follows to 1 mm: %s\n",
           open < 1e-4 && passive < 1e-9 && late < 1e-3 ? "yes" : "no");
    return open < 1e-4 && passive < 1e-9 && late < 1e-3 ? EXIT_SUCCESS : EXIT_FAILURE;
}
