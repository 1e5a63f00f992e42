/* contact_float.c - rbd_contact.h in float: the same behaviour at its tolerance, 1e-5 m/s, and its
   derivatives beside differences in double. */
#define RBD_REAL float
#define RBD_STATIC
#define RBD_IMPLEMENTATION
#include "larger.h"
#include "rbd_derivatives.h"
#include "rbd_contact.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "contact_differences.h"

static const float stance[LEGS] = {0, 0, 0, 0, 0.7f, 0.7f, -0.7f, -0.7f, -1.4f, -1.4f, 1.4f, 1.4f};

static int failures;
static void expect(int holds, const char *what, double value) {
    if (holds) return;
    failures++;
    printf("FAILED: %s: %g\n", what, value);
}

static const rbd_model *model;
static rbd_work *work;
static rbd_contact_set *set;
static float q[HYQ_NQ], v[HYQ_NV], tau[HYQ_NV], damping[HYQ_NV];

/* HyQ in its stance, its feet at this height. */
static void open_hyq(float dt, float height, const rbd_contact_options *options) {
    static unsigned char model_memory[RBD_MODEL_SIZE(HYQ_NB)], work_memory[RBD_WORK_SIZE(HYQ_NB, HYQ_NV)];
    static unsigned char memory[100000];
    const float point[3] = {0.33f, 0, 0};
    float p[3];
    rbd_contact foot[FEET];
    if (rbd_model_build(hyq_bodies, HYQ_NB, model_memory, sizeof model_memory, &model, NULL) != RBD_OK ||
        rbd_work_init(model, work_memory, sizeof work_memory, &work) != RBD_OK)
        exit(2);
    for (int i = 0; i < FEET; i++)
        foot[i] = (rbd_contact){
            .body1 = HYQ_BODY_LF_LOWERLEG + i, .body2 = -1, .point = {0.33, 0, 0}, .friction = 0.7};
    if (rbd_contact_set_init(model, work, foot, FEET, NULL, 0, options, memory, sizeof memory, &set, NULL) !=
        RBD_OK)
        exit(2);
    rbd_neutral(model, q);
    for (int k = 0; k < HYQ_NV; k++) v[k] = tau[k] = damping[k] = 0;
    for (int k = 0; k < LEGS; k++) q[7 + k] = stance[k], damping[6 + k] = 8 + dt * 300;
    rbd_kinematics(model, work, q, NULL, NULL);
    rbd_point_position(model, work, HYQ_BODY_LF_LOWERLEG, point, p);
    q[2] = height - p[2];
}

static void control(void) {
    for (int k = 0; k < LEGS; k++) tau[6 + k] = 300 * (stance[k] - q[7 + k]);
}

/* HyQ drops by 5 cm onto its feet, and stands. */
static void drop(float dt) {
    float force[3];
    double worst = 0, sum = 0;
    int unsolved = 0;
    open_hyq(dt, 0.05f, NULL);
    for (int n = (int)(2 / dt); n > 0; n--) {
        control();
        expect(rbd_contact_step(model, set, q, v, tau, NULL, damping, dt, q, v) == RBD_OK, "step", n);
        worst = larger(worst, rbd_contact_last(set).residual);
        unsolved += rbd_contact_last(set).residual > 1e-5f;
        for (int i = 0; i < FEET; i++) {
            rbd_contact_get(set, i, NULL, force);
            expect(force[2] >= 0 && hypotf(force[0], force[1]) <= 0.70001f * force[2], "cone", force[2]);
        }
    }
    for (int i = 0; i < FEET; i++) rbd_contact_get(set, i, NULL, force), sum += (double)force[2];
    expect(fabs(sum - 9.81 * (double)rbd_mass(model)) < 5, "weight", sum);
    expect((float)unsolved * dt <= 0.02f, "steps that are not solved", unsolved);
    expect(worst < 1e-4f, "residual", (double)worst);
    expect(q[2] > 0.4f, "height", (double)q[2]);
    printf("13 float, HyQ lands, dt %g: residual %.1e m/s at most, %d steps above 1e-5\n", (double)dt,
           (double)worst, unsolved);
}

/* The derivatives of a step of HyQ that stands, or slips; an error is a share of the largest entry of its
   row, or of 1. */
static void differentiate(const char *what, float speed, rbd_contact_state state, double bound) {
    static unsigned char memory[200000];
    static float by[6][HYQ_NV * HYQ_NV];
    static hyq_step exact;
    const rbd_contact_options options = {.slop = 1e-3, .derivatives = 1, .iterations = 200};
    const rbd_contact_step_results out = {NULL, NULL, by[0], by[1], by[2], by[3], by[4], by[5]};
    const float dt = 1e-3f;
    double worst = 0;
    rbd_derivatives *d;
    open_hyq(dt, -5e-4f, &options);
    if (rbd_derivatives_size(model) > sizeof memory ||
        rbd_derivatives_init(model, work, memory, sizeof memory, &d) != RBD_OK)
        exit(2);
    for (int n = 0; n < 50; n++) {
        control();
        rbd_contact_step(model, set, q, v, tau, NULL, damping, dt, q, v);
    }
    control();
    v[3] += speed, v[4] += speed;
    exact.dt = (double)dt;
    for (int k = 0; k < HYQ_NQ; k++) exact.q[k] = (double)q[k];
    for (int k = 0; k < HYQ_NV; k++)
        exact.v[k] = (double)v[k], exact.tau[k] = (double)tau[k], exact.damping[k] = (double)damping[k];
    differentiate_hyq(&exact);
    rbd_contact_reset(set);
    expect(rbd_contact_step_derivatives(model, set, d, q, v, tau, NULL, damping, dt, &out) == RBD_OK, what,
           0);
    for (int i = 0; i < FEET; i++)
        expect(rbd_contact_get(set, i, NULL, NULL) == state && exact.state[i] == (int)state,
               "state of a foot", i);
    for (int x = 0; x < 6; x++)
        for (int r = 0; r < HYQ_NV; r++) {
            const double *row = &exact.by[x][r * HYQ_NV];
            double size = 1, error = 0;
            for (int k = 0; k < HYQ_NV; k++) {
                size = larger(size, fabs(row[k]));
                error = larger(error, fabs((double)by[x][r * HYQ_NV + k] - row[k]));
            }
            worst = larger(worst, error / size);
        }
    expect(worst <= bound, what, worst);
    printf("13 float, %s: derivatives off by %.1e of a row's largest, allowed %.0e\n", what, worst, bound);
}

/* A lift of a tonne stands on a tip that slides of a gram carry. */
static void lift(void) {
    const rbd_body bodies[3] = {{.parent = -1, .type = RBD_PRISMATIC, .axis = {0, 0, 1}, .mass = 1000},
                                {.parent = 0, .type = RBD_PRISMATIC, .axis = {1, 0, 0}, .mass = 1e-3},
                                {.parent = 1, .type = RBD_PRISMATIC, .axis = {0, 1, 0}, .mass = 1e-3}};
    const rbd_contact tip = {.body1 = 2, .body2 = -1, .friction = 0.5};
    static unsigned char model_memory[RBD_MODEL_SIZE(3)], work_memory[RBD_WORK_SIZE(3, 3)], memory[20000];
    float force[3], at[3] = {0, 0, 0}, speed[3] = {0, 0, 0};
    const float none[3] = {0, 0, 0};
    if (rbd_model_build(bodies, 3, model_memory, sizeof model_memory, &model, NULL) != RBD_OK ||
        rbd_work_init(model, work_memory, sizeof work_memory, &work) != RBD_OK ||
        rbd_contact_set_init(model, work, &tip, 1, NULL, 0, NULL, memory, sizeof memory, &set, NULL) !=
            RBD_OK)
        exit(2);
    for (int k = 0; k < 100; k++)
        (void)rbd_contact_step(model, set, at, speed, none, NULL, NULL, 1e-3f, at, speed);
    expect(rbd_contact_get(set, 0, NULL, force) == RBD_STICKS, "the lift's tip sticks", 0);
    expect(fabsf(force[2] - 9810.02f) < 1, "its force, N", force[2]);
    expect(fabsf(at[0]) < 1e-6f, "the lift's height, m", at[0]);
}

/* Two motors move a head of 3 kg by one belt, at speeds x + y and x - y. They hold it with 2 N each, also
   under 3.9 N along x; 6 N give (6 - 4) / (3 + 2 J) m/s^2, J = 0.5 kg of each rotor. */
static void belt(void) {
    const rbd_body head[2] = {
        {.parent = -1, .type = RBD_PRISMATIC, .axis = {1, 0, 0}},
        {.parent = 0, .type = RBD_PRISMATIC, .axis = {0, 1, 0}, .mass = 3, .inertia = {1, 0, 0, 1, 0, 1}}};
    static unsigned char model_memory[RBD_MODEL_SIZE(2)], work_memory[RBD_WORK_SIZE(2, 2)], memory[20000];
    const rbd_contact_options options = {.rows = 2};
    float at[2] = {0, 0}, speed[2] = {0, 0}, tau[2] = {3.9f, 0}, added[3] = {0}, force[2];
    if (rbd_model_build(head, 2, model_memory, sizeof model_memory, &model, NULL) != RBD_OK ||
        rbd_work_init(model, work_memory, sizeof work_memory, &work) != RBD_OK ||
        rbd_contact_set_init(model, work, NULL, 0, NULL, 0, &options, memory, sizeof memory, &set, NULL) !=
            RBD_OK)
        exit(2);
    for (int i = 0; i < 2; i++) {
        const rbd_contact_row motor = {
            .dofs = 2, .dof = {0, 1}, .jacobian = {1, i == 0 ? 1.f : -1.f}, .lower = -2, .upper = 2};
        added[rbd_packed_index(model, i, i)] = 2 * 0.5f;
        expect(rbd_contact_row_set(model, set, i, &motor) == RBD_OK, "a motor of the belt", i);
    }
    expect(rbd_contact_inertia(model, set, added) == RBD_OK, "its rotors", 0);

    for (int k = 0; k < 1000; k++)
        (void)rbd_contact_step(model, set, at, speed, tau, NULL, NULL, 1e-3f, at, speed);
    expect(fabsf(at[0]) < 1e-7f && fabsf(at[1]) < 1e-7f, "the belt holds, m", at[0]);
    for (int i = 0; i < 2; i++)
        expect(rbd_contact_row_get(set, i, &force[i]) == RBD_STICKS, "a motor sticks", i);
    expect(fabsf(force[0] + force[1] + 3.9f) < 1e-5f, "their force, N", force[0] + force[1]);

    tau[0] = 6;
    for (int k = 0; k < 1000; k++)
        (void)rbd_contact_step(model, set, at, speed, tau, NULL, NULL, 1e-3f, at, speed);
    expect(fabsf(speed[0] - 0.5f) < 1e-5f && fabsf(speed[1]) < 1e-6f, "the belt slides, m/s", speed[0]);
    expect(rbd_contact_row_get(set, 0, force) == RBD_SLIPS && !(force[0] < -2) && !(force[0] > -2),
           "at its bound", force[0]);
}

/* Limits that are equal in float mean none, which is a warning. */
static void narrow(void) {
    const rbd_body slide = {.parent = -1,
                            .type = RBD_PRISMATIC,
                            .axis = {1, 0, 0},
                            .mass = 1,
                            .inertia = {1, 0, 0, 1, 0, 1},
                            .lower = 1,
                            .upper = 1 + 1e-9};
    static unsigned char memory[RBD_MODEL_SIZE(1)];
    const rbd_model *m;
    rbd_report report;
    rbd_joint_info info;
    expect(rbd_model_build(&slide, 1, memory, sizeof memory, &m, &report) == RBD_OK, "a narrow slide", 0);
    expect(report.warnings == 1 && report.warning[0].status == RBD_WARN_LIMITS, "its warning",
           report.warnings);
    expect(rbd_joint(m, 0, &info) == RBD_OK && !(info.lower < 0) && !(info.upper > 0), "its limits", 0);
}

/* A free body that turns slowly keeps its energy: also corrections that are smaller than rounding count. */
static void spin(void) {
    static unsigned char model_memory[RBD_MODEL_SIZE(1)], work_memory[RBD_WORK_SIZE(1, 6)], memory[10000];
    static const rbd_body body[1] = {{.joint = "free",
                                      .parent = -1,
                                      .type = RBD_FLOATING,
                                      .mass = 1,
                                      .inertia = {0.1f, 0, 0, 0.2f, 0, 0.25f}}};
    const float none[6] = {0}, weightless[3] = {0};
    float at[7], next[7], speed[6] = {0.1f, 1, 0.3f}, after[6];
    if (rbd_model_build(body, 1, model_memory, sizeof model_memory, &model, NULL) != RBD_OK ||
        rbd_work_init(model, work_memory, sizeof work_memory, &work) != RBD_OK ||
        rbd_contact_set_init(model, work, NULL, 0, NULL, 0, NULL, memory, sizeof memory, &set, NULL) !=
            RBD_OK)
        exit(2);
    rbd_set_gravity(work, weightless);
    rbd_neutral(model, at);

    const double first = 0.1 * 0.01 + 0.2 + 0.25 * 0.09;
    for (int k = 0; k < 100000; k++) {
        if (rbd_contact_step(model, set, at, speed, none, NULL, NULL, 1e-3f, next, after) != RBD_OK) exit(2);
        for (int i = 0; i < 7; i++) at[i] = next[i];
        for (int i = 0; i < 6; i++) speed[i] = after[i];
    }
    const double x = speed[0], y = speed[1], z = speed[2];
    const double change = (0.1 * x * x + 0.2 * y * y + 0.25 * z * z) / first - 1;
    expect(fabs(change) < 1e-4, "a slow spin keeps its energy", change);
}

/* A slide that a stop takes from 1e30 m/s to rest in 1e-20 s: its acceleration is above the largest float. In
   double all are finite that the bounds of speed and step let through. */
static void overflow(void) {
    const rbd_body slide = {
        .parent = -1, .type = RBD_PRISMATIC, .axis = {0, 0, 1}, .mass = 1, .lower = -1, .upper = 1};
    static unsigned char model_memory[RBD_MODEL_SIZE(1)], work_memory[RBD_WORK_SIZE(1, 1)], memory[10000];
    const rbd_contact_options options = {.joint_limits = 1};
    const float at = -1, fast = -1e30f, none = 0;
    float a = 7;
    if (rbd_model_build(&slide, 1, model_memory, sizeof model_memory, &model, NULL) != RBD_OK ||
        rbd_work_init(model, work_memory, sizeof work_memory, &work) != RBD_OK ||
        rbd_contact_set_init(model, work, NULL, 0, NULL, 0, &options, memory, sizeof memory, &set, NULL) !=
            RBD_OK)
        exit(2);

    expect(rbd_contact_fd(model, set, &at, &fast, &none, NULL, NULL, 1e-20f, &a) == RBD_ERR_NAN, "infinite",
           a);
    expect(fabs((double)a) <= 0, "no acceleration", a);
}

int main(void) {
    overflow();
    lift();
    belt();
    narrow();
    spin();
    drop(5e-4f), drop(1e-3f), drop(1e-2f);
    differentiate("HyQ stands", 0, RBD_STICKS, 1e-3);
    differentiate("HyQ slips", 1, RBD_SLIPS, 1e-3);
    return failures != 0;
}
