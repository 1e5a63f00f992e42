/* walking_quadruped.c - HyQ walks up and down two steps, one foot after the other, stands, and is pushed from
   the side. Its controller knows where the feet shall be and holds the joints there by springs and dampers;
   the simulation knows the height of the ground under each foot. The step finds which feet stand, slip and
   lift. Prints tables for walking_quadruped.gp. */
#define RBD_IMPLEMENTATION
#include "rbd_contact.h"
#include "models/hyq_model.h"
#include "../larger.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NQ = HYQ_NQ, NV = HYQ_NV, FEET = 4, LEG = HYQ_DOF_LF_HAA_JOINT, LEGS = NV - LEG };
enum {
    STRIDES = 7,
    SWINGS = FEET * STRIDES,
    STEPS = 27500,
    STEPS_PER_TICK = 10,
    TICKS = STEPS / STEPS_PER_TICK
};
static const double dt = 1e-3, kp = 2500, kd = 50; /* s, N m/rad, N m s/rad */
static const double stride = 0.25, shifts = 0.5, swings = 0.4, lift = 0.06, radius = 0.02, friction = 0.7;
static const double follow = 0.01; /* of a foot that slips, in a tick: no strain between the feet stays */
static const double toe[3] = {0.33, 0, 0};
static const char *const names[FEET] = {"left fore", "right fore", "left hind", "right hind"};
static const int turn[FEET] = {3, 1, 2, 0}; /* which foot swings after which */

static unsigned char work_memory[HYQ_WORK_SIZE], aim_memory[RBD_CONSTRAINT_SET_SIZE(NV, 3 * FEET + 6)];
static rbd_work *w;
static rbd_contact_set *ground;
static double q[NQ], v[NV], wanted[NQ], landed[FEET][3];

static struct tick {
    double q[NQ], force[FEET][3];
} past[TICKS];

static void check(rbd_status status) {
    if (status == RBD_OK) return;
    fprintf(stderr, "%s\n", rbd_status_string(status));
    exit(EXIT_FAILURE);
}

/* ---- the ground ---- */

static double height_at(double x) {
    static const double edge[] = {0.5, 0.75, 1.0, 1.25}, rise[] = {0.08, 0.08, -0.08, -0.08};
    double height = 0;
    for (int i = 0; i < 4; i++) height += x > edge[i] ? rise[i] : 0;
    return height;
}

/* The plane under each foot. */
static void look_down(void) {
    static const double up[3] = {0, 0, 1};
    check(rbd_kinematics(&hyq_model, w, q, NULL, NULL));
    for (int i = 0; i < FEET; i++) {
        double p[3];
        check(rbd_point_position(&hyq_model, w, HYQ_BODY_LF_LOWERLEG + i, toe, p));
        check(rbd_contact_plane(&hyq_model, ground, i, up, height_at(p[0])));
    }
}

/* ---- the controller ---- */

static double smooth(double x) { return x < 0 ? 0 : x > 1 ? 1 : x * x * (3 - 2 * x); }

/* The place of a foot after so many steps. */
static void foothold(int foot, int steps, double p[3]) {
    p[0] = (foot < 2 ? 0.37 : -0.37) + stride * steps;
    p[1] = foot % 2 ? -0.32 : 0.32;
    p[2] = height_at(p[0]) + radius;
}

/* The middle of the feet but one, -1: of all; with the trunk's height over them. */
static void middle(double place[FEET][3], int without, double p[3]) {
    const int feet = without < 0 ? FEET : FEET - 1;
    memset(p, 0, 3 * sizeof *p);
    for (int i = 0; i < FEET; i++)
        for (int j = 0; j < 3 && i != without; j++) p[j] += place[i][j] / feet;
}

/* Where feet and trunk shall be: the trunk goes over the three feet that will stand, then the fourth swings.
   Gives the foot that swings, or -1. */
static int plan(double t, double place[FEET][3], double trunk[3]) {
    const double period = shifts + swings;
    const int k = (int)(t / period), swing = k < SWINGS ? k : SWINGS, foot = turn[swing % FEET];
    const double phase = t - swing * period, x = (phase - shifts) / swings;
    double before[3], after[3], start[3];
    for (int i = 0; i < FEET; i++) {
        int steps = 0;
        for (int j = 0; j < swing; j++) steps += turn[j % FEET] == i;
        foothold(i, steps, place[i]);
    }
    middle(place, swing > 0 ? turn[(swing + FEET - 1) % FEET] : -1, before);
    middle(place, swing < SWINGS ? foot : -1, after);
    for (int j = 0; j < 3; j++) trunk[j] = before[j] + smooth(phase / shifts) * (after[j] - before[j]);
    trunk[0] -= 0.05, trunk[2] += 0.5;
    if (swing == SWINGS || x < 0) return -1;
    memcpy(start, place[foot], sizeof start);
    foothold(foot, 1 + swing / FEET, place[foot]);
    const double top = fmax(start[2], place[foot][2]) + lift, end = place[foot][2];
    place[foot][0] = start[0] + smooth((x - 0.2) / 0.6) * (place[foot][0] - start[0]);
    place[foot][2] = start[2] + smooth(x / 0.3) * (top - start[2]) - smooth((x - 0.7) / 0.3) * (top - end);
    return foot;
}

/* wanted: the configuration with feet and trunk there, near the one before. */
static void reach(double place[FEET][3], const double trunk[3]) {
    static const double origin[3] = {0, 0, 0};
    double near[NQ];
    rbd_constraint list[FEET + 1];
    rbd_constraint_set *c;
    for (int i = 0; i < FEET; i++) list[i] = rbd_point_contact(HYQ_BODY_LF_LOWERLEG + i, toe, place[i]);
    list[FEET] = rbd_flat_contact(HYQ_BODY_BASE_LINK_0, origin, trunk);
    check(rbd_constraint_set_init(&hyq_model, w, list, FEET + 1, aim_memory, sizeof aim_memory, &c, NULL));
    check(rbd_assemble(&hyq_model, c, wanted, NULL, NULL, near, NULL));
    memcpy(wanted, near, sizeof near);
}

/* The joint angles that bring the trunk to its place over the feet that stand, wherever they landed, and the
   foot that swings to its place as seen from where the trunk is. */
static void aim(double t) {
    double place[FEET][3], trunk[3], R[9], p[3], at[3];
    const int swing = plan(t, place, trunk);
    check(rbd_kinematics(&hyq_model, w, q, NULL, NULL));
    check(rbd_body_pose(&hyq_model, w, HYQ_BODY_BASE_LINK_0, R, p));
    for (int i = 0; i < FEET; i++) {
        check(rbd_point_position(&hyq_model, w, HYQ_BODY_LF_LOWERLEG + i, toe, at));
        for (int j = 0; j < 2; j++) {
            landed[i][j] += (i == swing || t < dt ? 1 : follow) * (at[j] - landed[i][j]);
            if (i != swing) place[i][j] = landed[i][j];
        }
        for (int j = 0; j < 3; j++) at[j] = place[i][j] - p[j];
        for (int j = 0; j < 3 && i == swing; j++)
            place[i][j] = trunk[j] + R[j] * at[0] + R[3 + j] * at[1] + R[6 + j] * at[2];
    }
    reach(place, trunk);
}

static void start(void) {
    static const double stance[LEGS] = {0, 0, 0, 0, 0.7, 0.7, -0.7, -0.7, -1.4, -1.4, 1.4, 1.4}; /* rad */
    double place[FEET][3], trunk[3];
    check(rbd_work_init(&hyq_model, work_memory, sizeof work_memory, &w));
    check(rbd_neutral(&hyq_model, wanted));
    memcpy(&wanted[HYQ_Q_LF_HAA_JOINT], stance, sizeof stance);
    plan(0, place, trunk);
    reach(place, trunk);
    memcpy(q, wanted, sizeof q);
}

/* ---- the tables ---- */

/* Side view at a tick: legs from hip to toe, the trunk and the ground, moved to the right. */
static void figure(const double *at, double right) {
    static const int body[3] = {HYQ_BODY_LF_UPPERLEG, HYQ_BODY_LF_LOWERLEG, HYQ_BODY_LF_LOWERLEG};
    static const double corner[5][3] = {
        {0.5, 0, -0.07}, {0.5, 0, 0.1}, {-0.5, 0, 0.1}, {-0.5, 0, -0.07}, {0.5, 0, -0.07}};
    double p[3];
    check(rbd_kinematics(&hyq_model, w, at, NULL, NULL));
    for (int foot = FEET; foot >= 0; foot--, puts(""))
        for (int j = 0; j < (foot < FEET ? 3 : 5); j++) {
            const int link = foot < FEET ? body[j] + foot : HYQ_BODY_BASE_LINK_0;
            const double *point = foot == FEET ? corner[j] : j == 2 ? toe : NULL;
            check(rbd_point_position(&hyq_model, w, link, point, p));
            printf("%.3f,%.3f,%d\n", p[0] - at[0] + right, p[2], foot < FEET ? 1 + foot % 2 : 0);
        }
    for (int k = -70; k <= 70; k++) printf("%.3f,%.3f,3\n", right + 0.01 * k, height_at(at[0] + 0.01 * k));
    puts("");
}

static void print_tables(void) {
    static const double shown[] = {0, 5.0, 9.4, 14.0, 18.0, 24.5, 26.35};
    puts("t s,trunk x m,trunk y m,trunk z m,left fore N,right fore N,left hind N,right hind N");
    for (int i = 0; i < TICKS; i++) {
        printf("%.2f", i * STEPS_PER_TICK * dt);
        for (int j = 0; j < 3; j++) printf(",%.4f", past[i].q[HYQ_Q_ROOT_X + j]);
        for (int j = 0; j < FEET; j++) printf(",%.1f", past[i].force[j][2]);
        puts("");
    }
    puts("\n\nx m,z m,what");
    for (int i = 0; i < 7; i++) figure(past[(int)(shown[i] / dt + 0.5) / STEPS_PER_TICK].q, 1.5 * i);
}

/* ---- the walk ---- */

int main(void) {
    rbd_contact foot[FEET];
    double tau[NV] = {0}, damping[NV] = {0}, wrench[6 * HYQ_NB] = {0};
    double residual = 0, steepest = 0, deepest = 0, tilt = 0, lowest = 1;
    for (int i = 0; i < FEET; i++)
        foot[i] = (rbd_contact){.name = names[i],
                                .body1 = HYQ_BODY_LF_LOWERLEG + i,
                                .body2 = -1,
                                .point = {toe[0], toe[1], toe[2]},
                                .radius = radius,
                                .friction = friction};
    start();
    const size_t size = rbd_contact_set_size(&hyq_model, FEET, NULL, 0, NULL);
    void *memory = malloc(size);
    if (!memory) return EXIT_FAILURE;
    check(rbd_contact_set_init(&hyq_model, w, foot, FEET, NULL, 0, NULL, memory, size, &ground, NULL));
    for (int k = LEG; k < NV; k++) damping[k] = kd + dt * kp / 2; /* implicit: neutral */

    for (int k = 0; k < STEPS; k++) {
        const double t = k * dt;
        struct tick *now = &past[k / STEPS_PER_TICK];
        if (k % STEPS_PER_TICK == 0) aim(t);
        look_down();
        for (int i = LEG; i < NV; i++) tau[i] = kp * (wanted[i + NQ - NV] - q[i + NQ - NV]);
        wrench[4] = t >= 26 && t < 26.1 ? 800 : 0; /* along the trunk's y axis */
        check(rbd_contact_step(&hyq_model, ground, q, v, tau, wrench, damping, dt, q, v));
        residual = larger(residual, rbd_contact_last(ground).residual);
        memcpy(now->q, q, sizeof q);
        for (int i = 0; i < FEET; i++) {
            double gap, *f = now->force[i];
            rbd_contact_get(ground, i, &gap, f);
            deepest = larger(deepest, -gap);
            if (f[2] > 0) steepest = larger(steepest, hypot(f[0], f[1]) / f[2]);
        }
        lowest = fmin(lowest, q[HYQ_Q_ROOT_Z] - height_at(q[HYQ_Q_ROOT_X]));
        tilt = larger(tilt, 2 * hypot(q[HYQ_Q_ROOT_QX], q[HYQ_Q_ROOT_QY]));
    }
    print_tables();

    const struct tick *last = &past[TICKS - 1];
    const double sum = last->force[0][2] + last->force[1][2] + last->force[2][2] + last->force[3][2];
    const int walked = last->q[HYQ_Q_ROOT_X] > 1.6;
    const int stands = lowest > 0.35 && tilt < 0.15 && fabs(sum - rbd_mass(&hyq_model) * 9.81) < 5;
    const int right = residual <= 1e-6 && steepest <= friction * (1 + 1e-9) && deepest < 1e-3;
    fprintf(stderr, "up and down both steps: %s\n", walked ? "yes" : "no");
    fprintf(stderr, "pushed with 800 N it stands; the trunk was never tilted by 0.15 rad: %s\n",
            stands ? "yes" : "no");
    fprintf(stderr, "every step solved, forces within the cones, no foot ever 1 mm deep: %s\n",
            right ? "yes" : "no");
    free(memory);
    return walked && stands && right ? EXIT_SUCCESS : EXIT_FAILURE;
}
