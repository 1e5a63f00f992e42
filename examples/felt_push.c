/* felt_push.c - an iiwa with friction is pushed while it moves and while it rests. A momentum observer feels
   the push from motors and encoders, and knows how much of what it feels may be friction: the band. Its
   friction is a seventh less than the true one, as of an identification on another day. It writes a table. */
#define RBD_IMPLEMENTATION
#include "rbd_estimate.h"
#include "models/iiwa.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { NB = IIWA_NB, NV = IIWA_NV, PUSHED = IIWA_BODY_LBR_IIWA_LINK_4, STEPS = 6000 };
static const double dt = 1e-3, point[3] = {0, 0.2, 0};

/* Friction of the joints, N m and N m s. */
static const double coulomb[NV] = {3, 4, 2, 2.5, 1, 0.8, 0.4}, viscous[NV] = {1, 1.5, 0.8, 1, 0.4, 0.3, 0.1};

/* Pushes: from, to, s, and the force on link 4, N, world axes. The arm moves up to 3 s, then it rests. The
   last one is below the friction of the joints at rest. */
static const struct push {
    double from, to, force[3];
    int felt; /* what must be */
} pushes[] = {{1, 1.5, {20, -25, 10}, 1}, {3.8, 4.3, {20, -25, 10}, 1}, {5, 5.5, {3, -3, 1}, 0}};
enum { PUSHES = sizeof pushes / sizeof *pushes };

static unsigned char model_memory[RBD_MODEL_SIZE(NB)], work_memory[RBD_WORK_SIZE(NB, NV)];
static const rbd_model *m;
static rbd_work *w;

static void check(rbd_status status) {
    if (status != RBD_OK) exit((fprintf(stderr, "%s\n", rbd_status_string(status)), EXIT_FAILURE));
}

/* Every joint swings at a frequency of its own, softly to rest between 2 and 3 s: its phase is f s(t), and s
   has the speed `rate`, of which `slope` is the slope. */
static void motion(double t, double q[NV], double v[NV], double a[NV]) {
    const double x = t < 2 ? 0 : t > 3 ? 1 : t - 2, rate = t > 3 ? 0 : 1 - x * x * (3 - 2 * x);
    const double s = t < 2 ? t : 2 + x - x * x * x + x * x * x * x / 2, slope = t > 3 ? 0 : -6 * x * (1 - x);
    for (int k = 0; k < NV; k++) {
        const double f = 1.1 + 0.37 * k;
        q[k] = 0.6 * sin(f * s + k);
        v[k] = 0.6 * f * cos(f * s + k) * rate;
        a[k] = 0.6 * f * cos(f * s + k) * slope - 0.6 * f * f * sin(f * s + k) * rate * rate;
    }
}

/* The push at t, or NULL; late: the time after its end in which the observer still feels it. */
static const struct push *push_at(double t, double late) {
    for (int k = 0; k < PUSHES; k++)
        if (t > pushes[k].from && t <= pushes[k].to + late) return &pushes[k];
    return NULL;
}

/* The motors' torques that make the motion, and the torques of the push. At rest friction takes what it can
   of the push. */
static void measure(double t, double q[NV], double v[NV], double tau[NV], double outside[NV]) {
    const struct push *push = push_at(t, 0);
    double a[NV], wrench[6] = {0};
    for (int k = 0; k < 3 && push; k++) wrench[3 + k] = push->force[k];

    motion(t, q, v, a);
    check(rbd_rnea(m, w, q, v, a, NULL, tau));
    check(rbd_kinematics(m, w, q, v, NULL));
    check(rbd_jacobian_transpose(m, w, PUSHED, point, RBD_WORLD_AXES, wrench, outside));
    for (int i = 0; i < NV; i++) {
        const double rest = fmax(-coulomb[i], fmin(coulomb[i], outside[i]));
        tau[i] += (v[i] != 0 ? coulomb[i] * (v[i] > 0 ? 1 : -1) + viscous[i] * v[i] : rest) - outside[i];
    }
}

int main(void) {
    static unsigned char memory[RBD_OBSERVER_SIZE(NV)];
    rbd_joint_friction known[NV];
    double q[NV], v[NV], tau[NV], outside[NV], r[NV], band[NV], delay[PUSHES];
    int alarms[PUSHES] = {0}, wrong = 0;
    rbd_observer *o;
    check(rbd_model_build(iiwa_bodies, NB, model_memory, sizeof model_memory, &m, NULL));
    check(rbd_work_init(m, work_memory, sizeof work_memory, &w));
    for (int i = 0; i < NV; i++)
        known[i] = (rbd_joint_friction){.coulomb = coulomb[i] * 6 / 7, .viscous = viscous[i] * 6 / 7};
    const rbd_observer_options options = {.gain = 40, .share = 0.2, .least = 0.3, .friction = known};
    check(rbd_observer_init(m, &options, memory, sizeof memory, &o, NULL));

    for (int step = 0; step < STEPS; step++) {
        const double t = dt * step;
        const struct push *push = push_at(t, 0.15);
        int alarm = 0;
        measure(t, q, v, tau, outside);
        check(rbd_observer_step(m, w, o, q, v, tau, dt, r, band, NULL));
        for (int i = 0; i < NV; i++) alarm |= fabs(r[i]) > band[i];
        wrong += alarm && !push;
        if (alarm && push && !alarms[push - pushes]++) delay[push - pushes] = t - push->from;
        if (step % 10 == 0)
            printf("%g,%g,%g,%g,%g,%g,%g\n", t, r[1], band[1], outside[1], r[3], band[3], outside[3]);
    }

    fprintf(stderr, "alarms without a push: %d\n", wrong);
    for (int k = 0; k < PUSHES; k++) {
        const double *f = pushes[k].force;
        fprintf(stderr, "%.0f N while it %s: ", sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]),
                pushes[k].from < 3 ? "moves" : "rests");
        fprintf(stderr, alarms[k] ? "felt after %.0f ms\n" : "not felt: friction holds it\n",
                alarms[k] ? 1e3 * delay[k] : 0);
        if ((alarms[k] > 0) != pushes[k].felt) return EXIT_FAILURE;
    }
    return wrong ? EXIT_FAILURE : EXIT_SUCCESS;
}
