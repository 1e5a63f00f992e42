/* stepping_down.c - HyQ stands with its fore feet on a step and sets them down, one after the other. Which
   feet stand is the program's to say: constraints for each phase, torques that share the weight between them,
   an impact where one lands. The wanted acceleration comes from constraints as well: all feet and the trunk
   are drawn to where they shall be. Prints a table for stepping_down.gp. */
#define RBD_IMPLEMENTATION
#include "rbd_constraints.h"
#include "models/hyq_model.h"
#include "larger.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { NQ = HYQ_NQ, NV = HYQ_NV, FEET = 4, STEPS = 4200, STEPS_PER_ROW = 10 };

static const double dt = 1e-3, step_height = 0.08, forward = 0.1, sideways = 0.08, cycle = 1.8;
static const int leg[FEET] = {HYQ_BODY_LF_LOWERLEG, HYQ_BODY_RF_LOWERLEG, HYQ_BODY_LH_LOWERLEG,
                              HYQ_BODY_RH_LOWERLEG};
static const double toe[3] = {0.33, 0, 0};

static unsigned char memory[HYQ_WORK_SIZE], set_memory[RBD_CONSTRAINT_SET_SIZE(NV, 3 * FEET)],
    aim_memory[RBD_CONSTRAINT_SET_SIZE(NV, 3 * FEET + 6)];
static rbd_work *w;
static double q[NQ], v[NV];
static double place[FEET][3], trunk[3]; /* where they stand or shall be */

static void check(rbd_status status) {
    if (status != RBD_OK) exit((fprintf(stderr, "%s\n", rbd_status_string(status)), EXIT_FAILURE));
}

static double smooth(double x) { return x < 0 ? 0 : x > 1 ? 1 : x * x * (3 - 2 * x); }

/* Each fore foot has its cycle: the trunk goes to where the other three carry it, the foot is moved, and the
   trunk comes back. Returns the feet that stand, bit by bit. */
static int plan(double t) {
    const int foot = t < 2 * cycle ? (int)(t / cycle) : 2;
    const double phase = t - foot * cycle, away = smooth(phase / 0.5) - smooth((phase - 1.3) / 0.5);
    trunk[0] = -0.06,
    trunk[1] = foot == 0   ? -sideways * away
               : foot == 1 ? sideways * away
                           : 0,
    trunk[2] = 0.52;
    for (int i = 0; i < FEET; i++) {
        const double x = i >= 2 || i > foot ? 0 : i < foot ? 1 : smooth((phase - 0.6) / 0.4);
        place[i][0] = i < 2 ? 0.37 + forward * x : -0.37;
        place[i][1] = i % 2 ? -0.32 : 0.32;
        place[i][2] = i < 2 ? step_height * (1 - x) + 0.25 * x * (1 - x) : 0;
    }
    return foot < 2 && phase > 0.6 && phase < 1.3 ? 15 & ~(1 << foot) : 15;
}

/* The feet of these bits at their places, with the stiffness of their rows. */
static int list_feet(int standing, double kp, rbd_constraint *list) {
    int n = 0;
    for (int i = 0; i < FEET; i++) {
        if (!(standing >> i & 1)) continue;
        list[n] = rbd_point_contact(leg[i], toe, place[i]);
        list[n].kp = kp, list[n++].kd = 2 * sqrt(kp);
    }
    return n;
}

static rbd_constraint_set *feet_down(int standing) {
    rbd_constraint list[FEET];
    rbd_constraint_set *c;
    const int n = list_feet(standing, 2500, list);
    check(rbd_constraint_set_init(&hyq_model, w, list, n, set_memory, sizeof set_memory, &c, NULL));
    return c;
}

/* Acceleration that draws all feet and the trunk to their places. */
static void aim(double *a) {
    const double origin[3] = {0, 0, 0};
    double tau[NV];
    rbd_constraint list[FEET + 1];
    rbd_constraint_set *c;
    const int n = list_feet(15, 900, list);
    list[n] = rbd_flat_contact(HYQ_BODY_BASE_LINK_0, origin, trunk);
    list[n].kp = 100, list[n].kd = 20;
    check(rbd_constraint_set_init(&hyq_model, w, list, n + 1, aim_memory, sizeof aim_memory, &c, NULL));
    check(rbd_bias(&hyq_model, w, q, v, NULL, tau));
    check(rbd_constrained_fd(&hyq_model, c, q, v, tau, NULL, a, NULL));
}

/* Stands on all feet as planned. */
static void stand(void) {
    double start[NQ], weight[NV];
    check(rbd_neutral(&hyq_model, start));
    for (int i = 0; i < 3; i++) start[HYQ_Q_ROOT_X + i] = trunk[i];
    start[HYQ_Q_LF_HFE_JOINT] = start[HYQ_Q_RF_HFE_JOINT] = 0.7;
    start[HYQ_Q_LF_KFE_JOINT] = start[HYQ_Q_RF_KFE_JOINT] = -1.4;
    start[HYQ_Q_LH_HFE_JOINT] = start[HYQ_Q_RH_HFE_JOINT] = -0.7;
    start[HYQ_Q_LH_KFE_JOINT] = start[HYQ_Q_RH_KFE_JOINT] = 1.4;
    for (int i = 0; i < NV; i++) weight[i] = i < 6 ? 1000 : 1; /* the trunk stays, the legs move */
    check(rbd_assemble(&hyq_model, feet_down(15), start, NULL, weight, q, NULL));
}

static void row(double t, const double load[FEET]) {
    printf("%.2f", t);
    for (int i = 0; i < FEET; i++) printf(",%.1f", load[i]);
    check(rbd_kinematics(&hyq_model, w, q, NULL, NULL));
    for (int i = 0; i < 2; i++) {
        double at[3];
        check(rbd_point_position(&hyq_model, w, leg[i], toe, at));
        printf(",%.4f", at[2]);
    }
    printf(",%.4f\n", q[HYQ_Q_ROOT_Y]);
}

int main(void) {
    double a[NV], tau[NV], force[3 * FEET], least = 1e9, jolt = 0;
    int standing = 15;
    check(rbd_work_init(&hyq_model, memory, sizeof memory, &w));
    plan(0);
    stand();
    puts(
        "t s,left fore N,right fore N,left hind N,right hind N,left foot m,right foot m,trunk to the left m");
    for (int step = 0; step <= STEPS; step++) {
        const int before = standing;
        double load[FEET] = {0};
        standing = plan(step * dt);
        aim(a);
        rbd_constraint_set *feet = feet_down(standing);
        if (standing & ~before) { /* one lands */
            check(rbd_impact(&hyq_model, feet, q, v, 0, v, force));
            for (int i = 0; i < 3 * FEET; i++) jolt = larger(jolt, fabs(force[i]));
        }
        check(rbd_constrained_id(&hyq_model, feet, q, v, a, NULL, NULL, NULL, tau, NULL));
        for (int i = 0; i < 6; i++) tau[i] = 0; /* no motors there */
        check(rbd_constrained_fd(&hyq_model, feet, q, v, tau, NULL, a, force));
        for (int i = 0, k = 2; i < FEET; i++) {
            if (!(standing >> i & 1)) continue;
            load[i] = force[k], k += 3;
            least = fmin(least, load[i]);
        }
        if (step % STEPS_PER_ROW == 0) row(step * dt, load);
        check(rbd_step(&hyq_model, q, v, a, dt, q, v));
    }
    fprintf(stderr, "every foot that stands pushes with %.0f N at least; landing takes %.3f N s at most\n",
            least, jolt);
    return least > 0 && jolt < 1 ? EXIT_SUCCESS : EXIT_FAILURE;
}
