/* contact_float.c - rbd_contact.h in float: the same behaviour at its tolerance, 1e-5 m/s. */
#define RBD_REAL float
#define RBD_IMPLEMENTATION
#include "rbd_contact.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "models/hyq.h"

enum { FEET = 4, LEGS = 12 };
static const float stance[LEGS] = {0, 0, 0, 0, 0.7f, 0.7f, -0.7f, -0.7f, -1.4f, -1.4f, 1.4f, 1.4f};

static int failures;
static void expect(int holds, const char *what, double value) {
    if (holds) return;
    failures++;
    printf("FAILED: %s: %g\n", what, value);
}

/* HyQ drops by 5 cm onto its feet, and stands. */
static void drop(float dt) {
    static unsigned char model_memory[RBD_MODEL_SIZE(HYQ_NB)], work_memory[RBD_WORK_SIZE(HYQ_NB, HYQ_NV)];
    static unsigned char memory[100000];
    float q[HYQ_NQ], v[HYQ_NV] = {0}, tau[HYQ_NV] = {0}, damping[HYQ_NV] = {0}, p[3], force[3], worst = 0;
    rbd_contact foot[FEET];
    const rbd_model *m;
    rbd_work *w;
    rbd_contact_set *c;
    const float point[3] = {0.33f, 0, 0};
    double sum = 0;
    int unsolved = 0;
    if (rbd_model_build(hyq_bodies, HYQ_NB, model_memory, sizeof model_memory, &m, NULL) != RBD_OK ||
        rbd_work_init(m, work_memory, sizeof work_memory, &w) != RBD_OK)
        exit(2);
    for (int i = 0; i < FEET; i++)
        foot[i] = (rbd_contact){
            .body1 = HYQ_BODY_LF_LOWERLEG + i, .body2 = -1, .point = {0.33, 0, 0}, .friction = 0.7};
    if (rbd_contact_set_init(m, w, foot, FEET, NULL, 0, NULL, memory, sizeof memory, &c, NULL) != RBD_OK)
        exit(2);
    rbd_neutral(m, q);
    for (int k = 0; k < LEGS; k++) q[7 + k] = stance[k], damping[6 + k] = 8 + dt * 300;
    rbd_kinematics(m, w, q, NULL, NULL);
    rbd_point_position(m, w, HYQ_BODY_LF_LOWERLEG, point, p);
    q[2] = 0.05f - p[2];
    for (int n = (int)(2 / dt); n > 0; n--) {
        for (int k = 0; k < LEGS; k++) tau[6 + k] = 300 * (stance[k] - q[7 + k]);
        expect(rbd_contact_step(m, c, q, v, tau, NULL, damping, dt, q, v) == RBD_OK, "step", n);
        worst = fmaxf(worst, rbd_contact_last(c).residual);
        unsolved += rbd_contact_last(c).residual > 1e-5f;
        for (int i = 0; i < FEET; i++) {
            rbd_contact_get(c, i, NULL, force);
            expect(force[2] >= 0 && hypotf(force[0], force[1]) <= 0.70001f * force[2], "cone", force[2]);
        }
    }
    for (int i = 0; i < FEET; i++) rbd_contact_get(c, i, NULL, force), sum += (double)force[2];
    expect(fabs(sum - 9.81 * (double)rbd_mass(m)) < 5, "weight", sum);
    expect((float)unsolved * dt <= 0.02f, "steps that are not solved", unsolved);
    expect(worst < 1e-4f, "residual", (double)worst);
    expect(q[2] > 0.4f, "height", (double)q[2]);
    printf("dt %g: residual %.1e at most, %d steps not solved\n", (double)dt, (double)worst, unsolved);
}

int main(void) {
    drop(5e-4f), drop(1e-3f), drop(1e-2f);
    return failures != 0;
}
