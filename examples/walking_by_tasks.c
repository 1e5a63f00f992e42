/* walking_by_tasks.c - HyQ walks up and down two steps of 5 cm on a floor of friction 0.5, one foot after the
   other. A plan says where the trunk and each foot shall be; rbd_tasks_acceleration makes torques of it: feet
   that stand are contacts, the foot that swings is open and has a wish of its own. The robot is
   rbd_contact_step, which knows the height of the ground. */
#define RBD_IMPLEMENTATION
#include "rbd_contact.h"

#include "rbd_tasks.h"
#include "larger.h"
#include "models/hyq_model.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NQ = HYQ_NQ, NV = HYQ_NV, FEET = 4, STRIDES = 7, SWINGS = FEET * STRIDES };
enum { STEPS = 20000, STEPS_PER_ROW = 2500, TRUNK = 0, POSTURE, SWING, WISHES };

static const double dt = 1e-3, mu = 0.5, strongest = 150;                   /* s, of the floor, N m */
static const double stride = 0.25, shifts = 0.4, swings = 0.3, lift = 0.06; /* m, s, s, m */
static const double toe[3] = {0.33, 0, 0};
static const int turn[FEET] = {3, 1, 2, 0}; /* which foot swings after which */

static unsigned char memory[HYQ_WORK_SIZE], floor_memory[HYQ_WORK_SIZE],
    contact_memory[RBD_CONTACT_SET_SIZE(NV, FEET, 0)],
    tasks_memory[RBD_TASKS_SIZE(NV, 6 + NV + 3, FEET, 2 * NV)];
static rbd_work *w, *floor_w;
static rbd_contact_set *ground;
static double home[NQ];

/* What the plan wants at a time. */
typedef struct plan {
    double foot[FEET][3], trunk[3];
    int swing; /* which foot swings; -1: none */
} plan;

static void check(rbd_status status) {
    if (status == RBD_OK) return;
    fprintf(stderr, "%s\n", rbd_status_string(status));
    exit(EXIT_FAILURE);
}

static int leg(int foot) { return HYQ_BODY_LF_LOWERLEG + foot; }

/* ---- the plan ---- */

static double height_at(double x) {
    static const double edge[] = {0.5, 0.75, 1.0, 1.25}, rise[] = {0.05, 0.05, -0.05, -0.05};
    double height = 0;
    for (int i = 0; i < 4; i++) height += x > edge[i] ? rise[i] : 0;
    return height;
}

static double smooth(double x) { return x < 0 ? 0 : x > 1 ? 1 : x * x * x * (10 + x * (6 * x - 15)); }

/* The place of a foot after so many of its steps. */
static void foothold(int foot, int steps, double p[3]) {
    p[0] = (foot < 2 ? 0.37 : -0.37) + stride * steps;
    p[1] = foot % 2 ? -0.32 : 0.32;
    p[2] = height_at(p[0]);
}

/* Where the trunk leans so that a foot may lift; -1: none. */
static void lean(int foot, double to[2]) {
    to[0] = foot < 0 ? 0 : foot < 2 ? -0.05 : 0.05;
    to[1] = foot < 0 ? 0 : foot % 2 ? 0.05 : -0.05;
}

/* The trunk leans away from a foot, then that swings. The trunk is over the middle of the footholds. */
static plan plan_at(double t) {
    const double period = shifts + swings;
    const int k = t < 0 ? 0 : (int)(t / period), swing = k < SWINGS ? k : SWINGS, foot = turn[swing % FEET];
    const double phase = t - swing * period, x = (phase - shifts) / swings, done = smooth(phase / shifts);
    double before[2], after[2], start[3], end[3];
    plan p = {.swing = -1};

    for (int i = 0; i < FEET; i++) {
        int steps = 0;
        for (int j = 0; j < swing; j++) steps += turn[j % FEET] == i;
        foothold(i, steps, p.foot[i]);
        for (int j = 0; j < 3; j++) p.trunk[j] += p.foot[i][j] / FEET;
    }
    lean(swing > 0 ? turn[(swing + FEET - 1) % FEET] : -1, before);
    lean(swing < SWINGS ? foot : -1, after);
    for (int j = 0; j < 2; j++) p.trunk[j] += before[j] + done * (after[j] - before[j]);
    p.trunk[0] -= 0.02; /* where its centre of mass is */
    p.trunk[2] += 0.5;
    if (swing == SWINGS || x < 0) return p;

    p.swing = foot;
    memcpy(start, p.foot[foot], sizeof start);
    foothold(foot, 1 + swing / FEET, end);
    for (int j = 0; j < 3; j++) p.trunk[j] += smooth(x) * (end[j] - start[j]) / FEET;
    const double top = fmax(start[2], end[2]) + lift;
    p.foot[foot][0] = start[0] + smooth((x - 0.1) / 0.8) * (end[0] - start[0]);
    p.foot[foot][2] =
        start[2] + smooth(x / 0.5) * (top - start[2]) - smooth((x - 0.5) / 0.5) * (top - end[2]);
    return p;
}

/* Velocity and acceleration of a place in the plan, by differences. */
static void rates(const double *before, const double *now, const double *after, double h, rbd_task *wish) {
    for (int i = 0; i < 3; i++) {
        wish->position[i] = now[i];
        wish->velocity[3 + i] = (after[i] - before[i]) / (2 * h);
        wish->acceleration[3 + i] = (after[i] - 2 * now[i] + before[i]) / (h * h);
    }
}

/* ---- the controller ---- */

/* Torques for a time; forces of the feet. Returns whether there were any. */
static int control(double t, const double *q, const double *v, double forces[FEET][3], double *tau) {
    static int warm;
    const double h = 1e-4;
    const plan before = plan_at(t - h), now = plan_at(t), after = plan_at(t + h);
    rbd_task wish[WISHES] = {{.kind = RBD_TASK_POSE, .body = HYQ_BODY_BASE_LINK_0, .gain = 15, .weight = 10},
                             {.kind = RBD_TASK_POSTURE, .q = home, .gain = 5, .weight = 1e-4},
                             {.kind = RBD_TASK_POINT, .gain = 40}};
    rbd_task_contact feet[FEET] = {{0}};
    const rbd_tasks problem = {.task = wish,
                               .tasks = now.swing < 0 ? SWING : WISHES,
                               .contact = feet,
                               .contacts = FEET,
                               .dt = dt,
                               .braking = 200,
                               .limit_weight = 10,
                               .torque_weight = 10,
                               .warm = warm};
    rbd_tasks_result result;
    double a[NV];

    rates(before.trunk, now.trunk, after.trunk, h, &wish[TRUNK]);
    for (int i = 0; i < FEET; i++) {
        feet[i].body = leg(i);
        memcpy(feet[i].point, toe, sizeof toe);
        feet[i].friction = 0.9 * mu;
        feet[i].least = 10;
        feet[i].open = i == now.swing;
        if (i != now.swing) continue;
        wish[SWING].body = leg(i);
        memcpy(wish[SWING].point, toe, sizeof toe);
        rates(before.foot[i], now.foot[i], after.foot[i], h, &wish[SWING]);
    }
    const rbd_tasks_status status = rbd_tasks_acceleration(&hyq_model, w, &problem, q, v, tasks_memory,
                                                           sizeof tasks_memory, a, forces[0], tau, &result);
    for (int i = 0; i < NV; i++) tau[i] = fmin(fmax(tau[i], -strongest), strongest); /* limits are soft */
    warm = status >= RBD_TASKS_OK;
    return warm;
}

/* ---- the robot ---- */

static void stand(double *q) {
    const plan p = plan_at(0);
    rbd_contact foot[FEET] = {{0}};
    rbd_ik_target target[FEET + 1] = {{.kind = RBD_IK_POSE, .body = HYQ_BODY_BASE_LINK_0}};
    static unsigned char ik_memory[RBD_IK_SIZE(HYQ_NB, NV, FEET + 1)];
    rbd_ik_result result;

    check(rbd_work_init(&hyq_model, memory, sizeof memory, &w));
    check(rbd_work_init(&hyq_model, floor_memory, sizeof floor_memory, &floor_w));
    check(rbd_neutral(&hyq_model, home));
    memcpy(target[FEET].position, p.trunk, sizeof p.trunk);
    for (int i = 0; i < FEET; i++) {
        home[HYQ_Q_LF_HFE_JOINT + i] = i < 2 ? 0.7 : -0.7;
        home[HYQ_Q_LF_KFE_JOINT + i] = i < 2 ? -1.4 : 1.4;
        foot[i].body1 = leg(i);
        foot[i].body2 = -1;
        memcpy(foot[i].point, toe, sizeof toe);
        foot[i].friction = mu;
        target[i] = (rbd_ik_target){.kind = RBD_IK_POINT, .body = leg(i)};
        memcpy(target[i].point, toe, sizeof toe);
        memcpy(target[i].position, p.foot[i], sizeof p.foot[i]);
    }
    target[FEET] = (rbd_ik_target){.kind = RBD_IK_POSE, .body = HYQ_BODY_BASE_LINK_0};
    memcpy(target[FEET].position, p.trunk, sizeof p.trunk);
    memcpy(q, home, sizeof home);
    rbd_ik(&hyq_model, w, target, FEET + 1, NULL, ik_memory, sizeof ik_memory, q, &result);
    check(result.error);
    check(rbd_contact_set_init(&hyq_model, floor_w, foot, FEET, NULL, 0, NULL, contact_memory,
                               sizeof contact_memory, &ground, NULL));
}

/* The plane under each foot; returns by how much the feet that shall stand are off their footholds. */
static double look_down(const plan *p, const double *q) {
    static const double up[3] = {0, 0, 1};
    double off = 0;
    check(rbd_kinematics(&hyq_model, w, q, NULL, NULL));
    for (int i = 0; i < FEET; i++) {
        double at[3];
        check(rbd_point_position(&hyq_model, w, leg(i), toe, at));
        check(rbd_contact_plane(&hyq_model, ground, i, up, height_at(at[0])));
        if (i != p->swing) off = larger(off, hypot(at[0] - p->foot[i][0], at[1] - p->foot[i][1]));
    }
    return off;
}

int main(void) {
    double q[NQ], v[NV] = {0}, tau[NV] = {0}, forces[FEET][3];
    const double damping[NV] = {0};
    double off = 0, tilt = 0, astray = 0;
    int unsolved = 0;
    stand(q);

    for (int k = 0; k < STEPS; k++) {
        const double t = k * dt;
        const plan p = plan_at(t);
        off = larger(off, look_down(&p, q));
        unsolved += !control(t, q, v, forces, tau);
        check(rbd_contact_step(&hyq_model, ground, q, v, tau, NULL, damping, dt, q, v));

        for (int i = 0; i < FEET; i++) rbd_contact_get(ground, i, NULL, forces[i]);
        for (int i = 0; i < 3; i++) astray = larger(astray, fabs(q[HYQ_Q_ROOT_X + i] - p.trunk[i]));
        tilt = larger(tilt, 2 * hypot(q[HYQ_Q_ROOT_QX], q[HYQ_Q_ROOT_QY]));
        if (k % STEPS_PER_ROW) continue;
        printf("%4.1f s: %4.2f m forward, %4.2f m high; the feet carry %4.0f N\n", t, q[HYQ_Q_ROOT_X],
               q[HYQ_Q_ROOT_Z], forces[0][2] + forces[1][2] + forces[2][2] + forces[3][2]);
    }

    const int good = q[HYQ_Q_ROOT_X] > 1.6 && off < 0.01 && astray < 0.06 && tilt < 0.02 && unsolved == 0;
    printf(
        "feet at most %.0f mm off their footholds, the trunk %.0f mm from its way and tilted by %.2f rad\n",
        1e3 * off, 1e3 * astray, tilt);
    printf("up and down two steps, and each tick had an answer: %s\n", good ? "yes" : "no");
    return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
