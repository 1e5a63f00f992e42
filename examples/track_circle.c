/* track_circle.c - the tool of an iiwa follows a circle by joint velocities, 1000 times a second: freely,
   with limits of two joints on the way, near the stretched arm, and out of reach. Once by damped least
   squares whose result is clipped, as is often done, once by rbd_tasks_velocity: its place is level 0, a
   posture near the middle of the joints level 1, limits are rows that both keep. */
#define RBD_IMPLEMENTATION
#include "rbd_tasks.h"
#include "models/iiwa_model.h"
#include "larger.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NQ = IIWA_NQ, NV = IIWA_NV, TOOL = IIWA_BODY_LBR_IIWA_LINK_7, STEPS = 14000, SETTLED = 2000 };
enum { FREELY, LIMITED, STRETCHED, BEYOND, CIRCLES };

static const double dt = 1e-3, turn = 6, gain = 20, fastest = 1.5; /* s, s, 1/s, rad/s */
static const double tip[3] = {0, 0, 0.15}, pi = 3.14159265358979323846;
static const char *const names[CIRCLES] = {"freely", "limits of joints 2 and 4 on the way",
                                           "1 mm inside the stretched arm", "30 mm out of reach"};

static unsigned char memory[IIWA_WORK_SIZE];
static rbd_work *w;
static double lower[NV], upper[NV], speed[NV];

/* A circle about `centre`, with a radius in a plane that holds the way from the shoulder and the y axis. */
typedef struct circle {
    double centre[3], radial[3], radius;
} circle;

/* What came of following it. */
typedef struct outcome {
    double worst, mean; /* m: distance from the circle */
    double outside;     /* rad: beyond a limit */
    int unsolved;       /* ticks */
} outcome;

static void check(rbd_status status) {
    if (status == RBD_OK) return;
    fprintf(stderr, "%s\n", rbd_status_string(status));
    exit(EXIT_FAILURE);
}

/* ---- circles ---- */

static void tool_at(const double *q, double p[3]) {
    check(rbd_kinematics(&iiwa_model, w, q, NULL, NULL));
    check(rbd_point_position(&iiwa_model, w, TOOL, tip, p));
}

/* The circle of a case through the place where the arm begins; limits of the joints. */
static circle describe(int kind, const double *q) {
    const double zero[NQ] = {0};
    double p[3], stretched[3], shoulder[3], R[9], distance = 0;
    circle c = {.radius = kind < STRETCHED ? 0.2 : 0.25};

    for (int i = 0; i < NV; i++) {
        rbd_joint_info joint;
        check(rbd_joint(&iiwa_model, rbd_dof_body(&iiwa_model, i), &joint));
        lower[i] = joint.lower;
        upper[i] = joint.upper;
        speed[i] = fastest;
    }
    if (kind == LIMITED) {
        upper[1] = 0.62;
        lower[3] = -1.5;
    }

    tool_at(zero, stretched);
    check(rbd_body_pose(&iiwa_model, w, IIWA_BODY_LBR_IIWA_LINK_2, R, shoulder));
    tool_at(q, p);
    for (int i = 0; i < 3; i++) c.radial[i] = p[i] - shoulder[i];
    for (int i = 0; i < 3; i++) distance += c.radial[i] * c.radial[i];
    distance = sqrt(distance);
    const double reach = stretched[2] - shoulder[2] + (kind == STRETCHED ? -0.001 : 0.03);
    const double from = kind < STRETCHED ? distance : reach - c.radius; /* of the centre from the shoulder */
    for (int i = 0; i < 3; i++) {
        c.radial[i] /= distance;
        c.centre[i] = shoulder[i] + from * c.radial[i];
    }
    return c;
}

/* The place on it and its velocity, after two seconds at its start. */
static void wanted(const circle *c, double t, double p[3], double v[3]) {
    const double rate = t < 2 ? 0 : 2 * pi / turn, angle = t < 2 ? 0 : rate * (t - 2);
    for (int i = 0; i < 3; i++) {
        const double r = c->radial[i], s = i == 1;
        p[i] = c->centre[i] + c->radius * (-cos(angle) * r + sin(angle) * s);
        v[i] = c->radius * rate * (sin(angle) * r + cos(angle) * s);
    }
}

/* ---- controllers: joint velocities for a velocity of the tool, and what it misses ---- */

/* v = J' (J J' + 1e-4)^-1 y, clipped. */
static int least_squares(const double *q, const double p[3], const double velocity[3], double *v) {
    double at[3], J[6 * NV], A[3][4];
    tool_at(q, at);
    check(rbd_jacobian(&iiwa_model, w, TOOL, tip, RBD_WORLD_AXES, J));
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            A[i][j] = i == j ? 1e-4 : 0;
            for (int k = 0; k < NV; k++) A[i][j] += J[(3 + i) * NV + k] * J[(3 + j) * NV + k];
        }
        A[i][3] = velocity[i] + gain * (p[i] - at[i]);
    }

    for (int k = 0; k < 3; k++) { /* by Gauss and Jordan; A is positive definite */
        for (int i = 0; i < 3; i++) {
            const double factor = A[i][k] / A[k][k];
            for (int j = k; j < 4 && i != k; j++) A[i][j] -= factor * A[k][j];
        }
    }
    for (int k = 0; k < NV; k++) {
        v[k] = 0;
        for (int i = 0; i < 3; i++) v[k] += J[(3 + i) * NV + k] * A[i][3] / A[i][i];
        v[k] = fmin(fmax(v[k], -speed[k]), speed[k]);
        v[k] = fmin(fmax(v[k], (lower[k] - q[k]) / dt), (upper[k] - q[k]) / dt);
    }
    return 1;
}

static int by_tasks(const double *q, const double p[3], const double velocity[3], double *v) {
    static unsigned char tasks_memory[RBD_TASKS_SIZE(NV, 3 + NV, 0, 0)];
    const double middle[NQ] = {0};
    const rbd_task wishes[2] = {{.kind = RBD_TASK_POINT,
                                 .body = TOOL,
                                 .point = {tip[0], tip[1], tip[2]},
                                 .position = {p[0], p[1], p[2]},
                                 .velocity = {0, 0, 0, velocity[0], velocity[1], velocity[2]},
                                 .gain = gain},
                                {.kind = RBD_TASK_POSTURE, .level = 1, .q = middle, .gain = 0.5}};
    const rbd_tasks problem = {
        .task = wishes, .tasks = 2, .dt = dt, .lower = lower, .upper = upper, .speed = speed};
    rbd_tasks_result result;
    return rbd_tasks_velocity(&iiwa_model, w, &problem, q, tasks_memory, sizeof tasks_memory, v, &result) >=
           RBD_TASKS_OK; /* INEXACT: usable */
}

static outcome track(int kind, int with_tasks) {
    double q[NQ] = {0, 0.5, 0, -1.4, 0, 1.2, 0};
    const circle c = describe(kind, q);
    outcome o = {0};

    for (int step = 0; step < STEPS; step++) {
        double p[3], velocity[3], v[NV] = {0}, at[3], away = 0;
        tool_at(q, at);
        wanted(&c, step * dt, p, velocity);
        for (int i = 0; i < 3; i++) away += (p[i] - at[i]) * (p[i] - at[i]);
        away = sqrt(away);
        if (step > SETTLED) {
            o.worst = larger(o.worst, away);
            o.mean += away / (STEPS - SETTLED - 1);
        }

        o.unsolved += !(with_tasks ? by_tasks : least_squares)(q, p, velocity, v);
        for (int i = 0; i < NV; i++) {
            q[i] += dt * v[i];
            o.outside = larger(o.outside, larger(lower[i] - q[i], q[i] - upper[i]));
        }
    }
    return o;
}

int main(void) {
    int good = 1;
    check(rbd_work_init(&iiwa_model, memory, sizeof memory, &w));
    printf("%-38s %-22s %s\n", "mm off the circle, worst (mean)", "damped least squares", "tasks");
    for (int kind = 0; kind < CIRCLES; kind++) {
        const outcome clipped = track(kind, 0), ours = track(kind, 1);
        printf("%-38s %8.3f (%.3f)%*s %8.3f (%.3f)\n", names[kind], 1e3 * clipped.worst, 1e3 * clipped.mean,
               5, "", 1e3 * ours.worst, 1e3 * ours.mean);
        good &= !ours.unsolved && ours.outside < 1e-9 && ours.worst < 0.5 * clipped.worst + 1e-5;
    }
    return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
