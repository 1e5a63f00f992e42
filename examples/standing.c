/* standing.c - HyQ stands on four feet, which are constraints, and is pushed: torques that hold it, forces
   under the feet, and the way back. Contacts hold both ways here: that the feet push is checked. */
#define RBD_IMPLEMENTATION
#include "rbd_constraints.h"
#include "models/hyq_model.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { NQ = HYQ_NQ, NV = HYQ_NV, ROWS = 12, STEPS = 1000 };

static unsigned char memory[HYQ_WORK_SIZE], set_memory[RBD_CONSTRAINT_SET_SIZE(NV, ROWS)];
static rbd_work *w;
static rbd_constraint_set *feet;

static void check(rbd_status status) {
    if (status != RBD_OK) exit((fprintf(stderr, "%s\n", rbd_status_string(status)), EXIT_FAILURE));
}

/* Puts the feet on the ground, each at its place, the trunk 0.5 m above. */
static void stand(double *q) {
    static const int leg[4] = {HYQ_BODY_LF_LOWERLEG, HYQ_BODY_RF_LOWERLEG, HYQ_BODY_LH_LOWERLEG,
                               HYQ_BODY_RH_LOWERLEG};
    const double toe[3] = {0.33, 0, 0};
    double start[NQ], weight[NV];
    rbd_constraint list[4];
    for (int i = 0; i < 4; i++) {
        const double place[3] = {i < 2 ? 0.37 : -0.37, i % 2 ? -0.32 : 0.32, 0};
        list[i] = rbd_point_contact(leg[i], toe, place);
        list[i].kp = 2500, list[i].kd = 100;
    }
    check(rbd_constraint_set_init(&hyq_model, w, list, 4, set_memory, sizeof set_memory, &feet, NULL));
    check(rbd_neutral(&hyq_model, start));
    start[HYQ_Q_ROOT_Z] = 0.5;
    start[HYQ_Q_LF_HFE_JOINT] = start[HYQ_Q_RF_HFE_JOINT] = 0.7;
    start[HYQ_Q_LF_KFE_JOINT] = start[HYQ_Q_RF_KFE_JOINT] = -1.4;
    start[HYQ_Q_LH_HFE_JOINT] = start[HYQ_Q_RH_HFE_JOINT] = -0.7;
    start[HYQ_Q_LH_KFE_JOINT] = start[HYQ_Q_RH_KFE_JOINT] = 1.4;
    for (int i = 0; i < NV; i++) weight[i] = i < 6 ? 1000 : 1; /* the trunk stays, the legs move */
    check(rbd_assemble(&hyq_model, feet, start, NULL, weight, q, NULL));
}

int main(void) {
    double q[NQ], v[NV] = {0}, a[NV] = {0}, hold[NV], tau[NV], force[ROWS], home[NQ], total = 0, least = 1e9;
    check(rbd_work_init(&hyq_model, memory, sizeof memory, &w));
    stand(q);
    for (int i = 0; i < NQ; i++) home[i] = q[i];
    check(rbd_constrained_id(&hyq_model, feet, q, v, a, NULL, NULL, NULL, hold, force));
    printf("forces under the feet:");
    for (int i = 2; i < ROWS; i += 3) printf(" %.1f", force[i]), total += force[i];
    printf(" N, together %.1f; weight %.1f\n", total, rbd_mass(&hyq_model) * 9.81);
    for (int step = 0; step <= STEPS; step++) {
        double push[6 * HYQ_NB] = {0};
        if (step < 100) push[6 * HYQ_BODY_BASE_LINK_0 + 4] = 200; /* N, to the left, for 0.1 s */
        for (int i = 0; i < NV; i++)
            tau[i] = i < 6 ? 0 : hold[i] + 400 * (home[i + 1] - q[i + 1]) - 60 * v[i];
        check(rbd_constrained_fd(&hyq_model, feet, q, v, tau, push, a, force));
        for (int i = 2; i < ROWS; i += 3) least = fmin(least, force[i]);
        if (step % 200 == 0)
            printf("%.1f s: trunk %.1f mm to the left\n", step * 1e-3,
                   1e3 * (q[HYQ_Q_ROOT_Y] - home[HYQ_Q_ROOT_Y]));
        check(rbd_step(&hyq_model, q, v, a, 1e-3, q, v));
    }
    const int good = fabs(q[HYQ_Q_ROOT_Y] - home[HYQ_Q_ROOT_Y]) < 1e-3 && least > 0;
    printf("every foot pushed all the time, and it came back: %s\n", good ? "yes" : "no");
    return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
