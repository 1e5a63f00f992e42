/* ik_scalars.c - rbd_ik.h in double and in float: rows and gradients beside differences, poses of four arms,
   places out of reach. */
#define RBD_STATIC
#define RBD_IMPLEMENTATION
#include "larger.h"
#include "ik_robots.h"

#include "models/hyq.h"
#include "models/iiwa.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { MOST_Q = 32, IN_FLOAT = sizeof(rbd_real) == 4 };

static int failures;
static void expect(int holds, const char *what, double value) {
    if (holds) return;
    failures++;
    printf("FAILED: %s: %g\n", what, value);
}

static const rbd_model *m;
static rbd_work *w;
static unsigned char model_memory[100000], work_memory[200000], memory[100000];
static uint64_t seed = 1;

static void build(const rbd_body *bodies, int nb) {
    rbd_report report;
    if (rbd_model_build(bodies, nb, model_memory, sizeof model_memory, &m, &report) != RBD_OK ||
        rbd_work_init(m, work_memory, sizeof work_memory, &w) != RBD_OK)
        exit(2);
}

/* The targets that the robot has at q. */
static void aim(const rbd_real *q, rbd_ik_target *t, int n) {
    rbd_kinematics(m, w, q, NULL, NULL);
    for (int i = 0; i < n; i++) {
        rbd_real *R = t[i].rotation;
        if (t[i].kind == RBD_IK_COM) {
            rbd_com(m, w, t[i].position, NULL, NULL);
            continue;
        }
        rbd_body_pose(m, w, t[i].body, R, NULL);
        rbd_point_position(m, w, t[i].body, t[i].point, t[i].position);
        for (int a = 0; a < 3; a++)
            t[i].direction[a] =
                R[3 * a] * t[i].axis[0] + R[3 * a + 1] * t[i].axis[1] + R[3 * a + 2] * t[i].axis[2];
    }
}

/* A random state q, and a target of each of the first n kinds, on the last two bodies; the state that has
   them is q moved by `away`. */
static void draw_targets(int nb, int n, double away, rbd_real *q, rbd_ik_target *t) {
    rbd_real there[MOST_Q], v[MOST_Q];

    for (int i = 0; i < n; i++)
        t[i] = (rbd_ik_target){.kind = (rbd_ik_kind)(1 + i),
                               .body = nb - 1 - i % 2,
                               .point = {0, (rbd_real)0.1, (rbd_real)0.2},
                               .axis = {1, 2, -2},
                               .weight = (rbd_real)(0.5 + i)};

    rbd_random(m, &seed, q);
    for (int i = 0; i < m->nv; i++) v[i] = (rbd_real)(away * cos(i));
    rbd_integrate(m, q, v, 1, there);
    aim(there, t, n);
}

/* ---- rows and gradients by differences, in double ---- */

/* Of every kind of target, at a state that is `away` from where they are reached: g = J'e is the slope of
   -|e|^2/2 anywhere, and J that of -e where angles are small; of lengths anywhere. */
static void check_rows(const rbd_body *bodies, int nb, double away) {
    rbd_ik_target t[5];
    rbd_ik_result result = {0};
    rbd_real q[MOST_Q], x[MOST_Q], v[MOST_Q];
    double worst_row = 0, worst_slope = 0;
    const double h = 1e-6;
    int kinds;
    rbdi_ik *k;

    build(bodies, nb);
    kinds = rbd_mass(m) > 0 ? 5 : 4; /* a centre of mass needs one */
    draw_targets(nb, kinds, away, q, t);
    k = rbdi_ik_begin(m, w, t, kinds, NULL, memory, q, &result);
    rbdi_ik_errors(k, q);
    rbdi_ik_jacobian(k);
    rbdi_ik_normal(k);
    expect(k->rows == (rbd_mass(m) > 0 ? 18 : 15), "rows", k->rows);
    expect(k->dofs > 3, "dofs", k->dofs);

    for (int i = 0; i < k->dofs; i++) {
        double e[2][18], cost[2];
        const double slope = (double)k->g[i];
        for (int side = 0; side < 2; side++) {
            for (int j = 0; j < m->nv; j++) v[j] = 0;
            v[k->dof[i].dof] = (rbd_real)(side ? h : -h);
            rbd_integrate(m, q, v, 1, x);
            rbdi_ik_errors(k, x);
            cost[side] = (double)k->cost;
            for (int r = 0; r < k->rows; r++) e[side][r] = (double)k->e[r];
        }
        worst_slope = larger(worst_slope, fabs(slope + (cost[1] - cost[0]) / (4 * h)));
        for (int r = 0; r < k->rows; r++) {
            const int turn = (r >= 3 && r < 6) || (r >= 9 && r < 15); /* of the pose, rotation and axis */
            if (turn && away > 0.1) continue;
            worst_row =
                larger(worst_row, fabs((double)k->J[i * k->rows + r] + (e[1][r] - e[0][r]) / (2 * h)));
        }
    }
    /* rows of turns are off by some half of the angle */
    expect(worst_row < (away > 0.1 ? 1e-8 : 5 * away), "rows by differences", worst_row);
    expect(worst_slope < 1e-7, "slope by differences", worst_slope);
}

/* H after rbdi_ik_curve is the second derivative of |e|^2/2, by differences: of points, poses, rotations and
   axes, not of centres of mass, and without mimic joints. */
static void check_curvature(const rbd_body *bodies, int nb, double away) {
    rbd_ik_target t[4];
    rbd_ik_result result = {0};
    rbd_real q[MOST_Q], x[MOST_Q], v[MOST_Q];
    double H[MOST_Q * MOST_Q], worst = 0;
    const double h = 1e-4;
    rbdi_ik *k;

    build(bodies, nb);
    draw_targets(nb, 4, away, q, t);
    k = rbdi_ik_begin(m, w, t, 4, NULL, memory, q, &result);
    rbdi_ik_errors(k, q);
    rbdi_ik_jacobian(k);
    rbdi_ik_normal(k);
    rbdi_ik_curve(k);
    for (int i = 0; i < k->dofs * (k->dofs + 1) / 2; i++) H[i] = (double)k->H[i];
    for (int i = 0, at = 0; i < k->dofs; i++) {
        for (int j = i; j < k->dofs; j++, at++) {
            double sum = 0;
            for (int side = 0; side < 4; side++) {
                for (int l = 0; l < m->nv; l++) v[l] = 0;
                v[k->dof[i].dof] += (rbd_real)(side / 2 ? h : -h);
                v[k->dof[j].dof] += (rbd_real)(side % 2 ? h : -h);
                rbd_integrate(m, q, v, 1, x);
                rbdi_ik_errors(k, x);
                sum += (side == 0 || side == 3 ? 0.5 : -0.5) * (double)k->cost;
            }
            worst = larger(worst, fabs(H[at] - sum / (4 * h * h)));
        }
    }
    expect(worst < 1e-5, "curvature by differences", worst);
}

/* A step is within limits; it solves the equations of the dofs that no limit holds, with what the others do.
   Which dofs turn follows from their joints. */
static void check_step(void) {
    rbd_ik_target t = {.kind = RBD_IK_POSE, .body = 6, .point = {iiwa_tool[0], iiwa_tool[1], iiwa_tool[2]}};
    rbd_ik_result result = {0};
    rbd_real q[MOST_Q];
    int on_limits = 0;
    build(iiwa_bodies, IIWA_NB);
    for (int n = 0; n < 200; n++) {
        const rbd_real damping = (rbd_real)1e-4;
        rbdi_ik *k;
        double worst = 0, size = 0;
        rbd_random(m, &seed, q);
        aim(q, &t, 1);
        rbd_random(m, &seed, q);
        k = rbdi_ik_begin(m, w, &t, 1, NULL, memory, q, &result);
        rbdi_ik_start(k, 0);
        rbdi_ik_errors(k, k->q);
        rbdi_ik_jacobian(k);
        rbdi_ik_normal(k);
        expect(rbdi_ik_step(k, damping, 0), "definite", n);
        for (int i = 0; i < k->dofs; i++) {
            const double to = (double)(k->q[k->dof[i].at] + k->d[i]);
            double sum = (double)(damping * k->d[i] - k->g[i]);
            for (int j = 0; j < k->dofs; j++) sum += (double)(rbdi_ik_entry(k, i, j) * k->d[j]);
            size = larger(size, fabs((double)k->g[i]));
            if (k->dof[i].hold == RBDI_IK_FREE) worst = larger(worst, fabs(sum));
            on_limits += k->dof[i].hold > RBDI_IK_STAYS;
            expect(to > (double)k->dof[i].lower - 1e-6 && to < (double)k->dof[i].upper + 1e-6, "step", to);
        }
        expect(worst < (IN_FLOAT ? 1e-3 : 1e-11) * (1 + size), "equations of the step", worst);
    }
    expect(on_limits > 50, "dofs on limits", on_limits);

    build(hyq_bodies, HYQ_NB);
    t.kind = RBD_IK_POINT;
    t.body = HYQ_BODY_LF_LOWERLEG;
    rbd_neutral(m, q);
    rbdi_ik *k = rbdi_ik_begin(m, w, &t, 1, NULL, memory, q, &result);
    expect(k->dofs == 9, "dofs of a leg", k->dofs);
    for (int i = 0; i < k->dofs; i++) expect(k->dof[i].turns == (i < 3 || i > 5), "turns", i);
}

/* Of a screw, a slide and a joint with both. */
static void check_turns(void) {
    static const rbd_body bodies[3] = {
        {.parent = -1, .type = RBD_HELICAL, .axis = {0, 0, 1}, .pitch = 0.1, .armature = {1}},
        {.parent = 0, .type = RBD_PRISMATIC, .axis = {0, 0, 1}, .armature = {1}},
        {.parent = 1, .type = RBD_CYLINDRICAL, .axis = {0, 0, 1}, .armature = {1, 1}}};
    const rbd_ik_target t = {.kind = RBD_IK_POINT, .body = 2};
    rbd_ik_result result = {0};
    rbd_real q[MOST_Q] = {0};
    build(bodies, 3);
    rbdi_ik *k = rbdi_ik_begin(m, w, &t, 1, NULL, memory, q, &result);
    expect(k->dofs == 4 && k->dof[0].turns && !k->dof[1].turns && k->dof[2].turns && !k->dof[3].turns,
           "turns", k->dofs);
    for (int n = 1; n < 12; n++) { /* x^(n + 1) = x + 1 */
        const double x = (double)rbdi_ik_golden(n);
        expect(fabs(pow(x, n + 1) - x - 1) < (IN_FLOAT ? 1e-5 : 1e-13) && x > 1, "golden", x);
    }
}

/* On a floating robot, arms, and a tree of other joints, one of which mimics another. */
static void check_all_rows(void) {
    static const rbd_body mimic[4] = {
        {.joint = "a",
         .parent = -1,
         .type = RBD_UNIVERSAL,
         .axis = {0, 0, 1},
         .axis2 = {1, 0, 0},
         .mass = 1,
         .com = {0, 0, 0.1}},
        {.joint = "b",
         .parent = 0,
         .type = RBD_HELICAL,
         .axis = {0, 1, 1},
         .pitch = 0.1,
         .position = {0.3, 0, 0},
         .mass = 2},
        {.joint = "c",
         .parent = 1,
         .type = RBD_PRISMATIC,
         .axis = {1, 1, 0},
         .position = {0, 0.2, 0},
         .mass = 1},
        {.joint = "d",
         .parent = 2,
         .type = RBD_REVOLUTE,
         .axis = {1, 0, 0},
         .position = {0, 0, 0.4},
         .mass = 1,
         .com = {0.1, 0, 0},
         .inertia = {1, 0, 0, 1, 0, 1},
         .mimic = "b",
         .mimic_ratio = -0.7,
         .mimic_offset = 0.2},
    };
    for (int i = 0; i < 20; i++) {
        check_rows(hyq_bodies, HYQ_NB, i % 2 ? 0.7 : 1e-4);
        check_rows(iiwa_bodies, IIWA_NB, i % 2 ? 0.7 : 1e-4);
        check_rows(hobby_arm, 5, i % 2 ? 0.7 : 1e-4);
        check_rows(mimic, 4, i % 2 ? 0.7 : 1e-4);
        check_curvature(hyq_bodies, HYQ_NB, i % 2 ? 0.2 : 1e-5);
        check_curvature(iiwa_bodies, IIWA_NB, i % 2 ? 0.2 : 1e-5);
        check_curvature(mimic, 3, i % 2 ? 0.2 : 1e-5);
    }
}

/* ---- arms ---- */

static void check_arm(const char *name, const rbd_body *bodies, int nb, const rbd_real tool[3]) {
    int missed = 0;
    build(bodies, nb);
    for (int i = 0; i < 300; i++) {
        rbd_ik_target t = {.kind = RBD_IK_POSE, .body = nb - 1, .point = {tool[0], tool[1], tool[2]}};
        rbd_real q[MOST_Q];
        rbd_ik_result result;
        rbd_random(m, &seed, q);
        aim(q, &t, 1);
        rbd_random(m, &seed, q);
        missed += rbd_ik(m, w, &t, 1, NULL, memory, sizeof memory, q, &result) != RBD_IK_REACHED;
        expect(result.metres <= (IN_FLOAT ? 1e-5f : 1e-6f) || missed, "metres", (double)result.metres);
        for (int k = 0; k < nb; k++)
            expect(q[k] >= (rbd_real)bodies[k].lower && q[k] <= (rbd_real)bodies[k].upper, name,
                   (double)q[k]);
    }
    expect(missed == 0, name, missed);
}

/* A planar arm of 0.5 m and 0.3 m, too short, and with an elbow that does not stretch. */
static void check_planar(void) {
    rbd_body bodies[2] = {
        {.parent = -1, .type = RBD_REVOLUTE, .axis = {0, 0, 1}, .armature = {1}},
        {.parent = 0, .type = RBD_REVOLUTE, .axis = {0, 0, 1}, .position = {0.5, 0, 0}, .armature = {1}}};
    const double bound = IN_FLOAT ? 2e-6 : 1e-11;
    for (int limited = 0; limited < 2; limited++) {
        const double reach = limited ? sqrt(0.34 + 0.3 * cos(0.6)) : 0.8;
        bodies[1].lower = limited ? 0.6 : 0, bodies[1].upper = limited ? 2 : 0;
        build(bodies, 2);
        for (int i = 0; i < 20; i++) {
            const double beyond = 0.05 * (i + 1), angle = 0.1 * i;
            rbd_ik_target t = {.kind = RBD_IK_POINT, .body = 1, .point = {(rbd_real)0.3, 0, 0}};
            rbd_real q[2] = {0, 1};
            rbd_ik_result result;
            t.position[0] = (rbd_real)((reach + beyond) * cos(angle));
            t.position[1] = (rbd_real)((reach + beyond) * sin(angle));
            expect(rbd_ik(m, w, &t, 1, NULL, memory, sizeof memory, q, &result) ==
                       (limited ? RBD_IK_AT_LIMIT : RBD_IK_NEAREST),
                   "status out of reach", i);
            expect(result.limit == (limited ? 1 : -1), "limit", result.limit);
            expect(fabs((double)result.metres - beyond) < bound, "distance", (double)result.metres - beyond);
        }
    }
}

int main(void) {
    if (!IN_FLOAT) check_all_rows();
    check_arm("iiwa", iiwa_bodies, 7, iiwa_tool);
    check_arm("UR10e", ur10e, 6, ur10e_tool);
    check_arm("Panda", panda, 7, panda_tool);
    check_arm("hobby arm", hobby_arm, 5, hobby_tool);
    check_planar();
    check_step();
    check_turns();
    printf("%s\n", failures ? "FAILED" : "rbd_ik.h: ok");
    return failures > 0;
}
