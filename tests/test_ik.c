/* test_ik.c - inverse kinematics: targets within reach and beyond it, limits, all joint types, bad input.
   Forward kinematics judges reached targets; geometry, or differences of the error, judge the others. */
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "ik_robots.h"
#include "models/hyq.h"
#include "models/iiwa.h"
#include "suites.h"
#include "support.h"

enum { POSES = 500 / PART_OF_TREES, MAX_TARGETS = 8 };

static const double pi = 3.14159265358979323846;

/* ---- forward kinematics as the judge ---- */

/* Distance and angle by which a target is missed at the state of the last rbd_kinematics. */
static void miss(const robot *r, const rbd_ik_target *t, double *metres, double *radians) {
    double R[9], p[3], sum = 0, s[3] = {0}, square = 0, a2 = 0, d2 = 0;
    const int turns = t->kind == RBD_IK_POSE || t->kind == RBD_IK_ROTATION, axis = t->kind == RBD_IK_AXIS;
    *metres = *radians = 0;
    if (t->kind == RBD_IK_COM) {
        ck_assert_int_eq(rbd_com(r->m, r->w, p, NULL, NULL), RBD_OK);
    } else {
        ck_assert_int_eq(rbd_body_pose(r->m, r->w, t->body, R, NULL), RBD_OK);
        ck_assert_int_eq(rbd_point_position(r->m, r->w, t->body, t->point, p), RBD_OK);
    }
    for (int i = 0; i < 9 && turns; i++) sum += (R[i] - t->rotation[i]) * (R[i] - t->rotation[i]);
    if (turns) *radians = 2 * asin(fmin(1, sqrt(sum / 8))); /* |R - R'| = 2 sqrt(2) sin(angle / 2) */
    for (int i = 0; i < 3 && axis; i++) {
        for (int j = 0; j < 3; j++) s[i] += R[3 * i + j] * t->axis[j];
        a2 += t->axis[i] * t->axis[i], d2 += t->direction[i] * t->direction[i];
    }
    for (int i = 0; i < 3 && axis; i++) sum += pow(s[i] / sqrt(a2) - t->direction[i] / sqrt(d2), 2);
    if (axis) *radians = 2 * asin(fmin(1, sqrt(sum) / 2));
    if (!turns || t->kind == RBD_IK_POSE)
        for (int i = 0; i < 3 && !axis; i++) square += (p[i] - t->position[i]) * (p[i] - t->position[i]);
    *metres = sqrt(square);
}

/* The sum that the search minimises, at q; also the largest distance and angle. */
static double error_at(const robot *r, const rbd_ik_target *t, int n, double length, const double *q,
                       double *metres, double *radians) {
    double sum = 0;
    ck_assert_int_eq(rbd_kinematics(r->m, r->w, q, NULL, NULL), RBD_OK);
    *metres = *radians = 0;
    for (int i = 0; i < n; i++) {
        double distance, angle;
        miss(r, &t[i], &distance, &angle);
        *metres = larger(*metres, distance), *radians = larger(*radians, angle);
        sum += (t[i].weight > 0 ? t[i].weight : 1) * (distance * distance + length * length * angle * angle);
    }
    return sum;
}

/* The targets that the robot has at q: fills place, rotation and direction. */
static void aim(const robot *r, const double *q, rbd_ik_target *t, int n) {
    ck_assert_int_eq(rbd_kinematics(r->m, r->w, q, NULL, NULL), RBD_OK);
    for (int i = 0; i < n; i++) {
        if (t[i].kind == RBD_IK_COM) {
            ck_assert_int_eq(rbd_com(r->m, r->w, t[i].position, NULL, NULL), RBD_OK);
            continue;
        }
        double R[9];
        ck_assert_int_eq(rbd_body_pose(r->m, r->w, t[i].body, R, NULL), RBD_OK);
        ck_assert_int_eq(rbd_point_position(r->m, r->w, t[i].body, t[i].point, t[i].position), RBD_OK);
        memcpy(t[i].rotation, R, sizeof R);
        for (int a = 0; a < 3; a++) {
            t[i].direction[a] = 0;
            for (int b = 0; b < 3; b++) t[i].direction[a] += R[3 * a + b] * t[i].axis[b];
        }
    }
}

/* All coordinates are finite and, but those that stay, within the limits of their joints, to the bit. */
static void expect_within(const robot *r, const double *start, const double *q) {
    ck_assert(largest(q, r->nq) < INFINITY);
    for (int body = 0; body < r->nb; body++) {
        rbd_joint_info j;
        ck_assert_int_eq(rbd_joint(r->m, body, &j), RBD_OK);
        if (j.nv == 1 && j.lower < j.upper && q[j.iq] != start[j.iq])
            ck_assert(j.lower <= q[j.iq] && q[j.iq] <= j.upper);
    }
}

/* ---- calls ---- */

/* rbd_ik with memory of exactly its size, and every answer judged. */
static rbd_ik_status solve_with(const robot *r, const rbd_ik_target *t, int n, const rbd_ik_options *o,
                                double *q, rbd_ik_result *result) {
    const size_t size = rbd_ik_size(r->m, n);
    const double length = o && o->length > 0 ? o->length : 0.3;
    double metres, radians;
    double start[MAX_Q];
    void *memory = malloc(size);
    memcpy(start, q, (size_t)r->nq * sizeof *q);
    const rbd_ik_status status = rbd_ik(r->m, r->w, t, n, o, memory, size, q, result);
    char text[120];
    free(memory);
    ck_assert_msg(status != RBD_IK_ERROR, "%s: %s", r->name, rbd_ik_text(status, result, text, sizeof text));
    expect_within(r, start, q);
    error_at(r, t, n, length, q, &metres, &radians);
    ck_assert_msg(fabs(metres - result->metres) < 1e-10 * (1 + metres), "%s: %g, not %g m", r->name,
                  result->metres, metres);
    ck_assert_msg(fabs(radians - result->radians) < 1e-7, "%s: %g, not %g rad", r->name, result->radians,
                  radians);
    if (status == RBD_IK_REACHED) {
        ck_assert(metres <= (o && o->metres > 0 ? o->metres : 1e-6) + 1e-12);
        ck_assert(radians <= (o && o->radians > 0 ? o->radians : 1e-6) + 1e-12);
    }
    return status;
}

static rbd_ik_status solve(const robot *r, const rbd_ik_target *t, int n, double *q, rbd_ik_result *result) {
    return solve_with(r, t, n, NULL, q, result);
}

static void expect_status(const char *what, rbd_ik_status found, rbd_ik_status expected,
                          const rbd_ik_result *x) {
    ck_assert_msg(found == expected, "%s: status %d, not %d: %g m, %g rad, %d starts, %d evaluations", what,
                  found, expected, x->metres, x->radians, x->starts, x->evaluations);
}

/* ---- arms ---- */

static const struct {
    const char *name;
    const rbd_body *bodies;
    int nb;
    const double *tool;
} arm[] = {{"iiwa", iiwa_bodies, 7, iiwa_tool},
           {"UR10e", ur10e, 6, ur10e_tool},
           {"Panda", panda, 7, panda_tool},
           {"hobby arm", hobby_arm, 5, hobby_tool}};

/* Random poses, each from a random start: all are reached. */
START_TEST(arms_reach_random_poses) {
    robot r = robot_build(arm[_i].name, arm[_i].bodies, arm[_i].nb);
    uint64_t seed = 1;
    long evaluations = 0;
    for (int k = 0; k < POSES; k++) {
        rbd_ik_target t = {.kind = RBD_IK_POSE, .body = r.nb - 1};
        rbd_ik_result result;
        double q[MAX_Q];
        memcpy(t.point, arm[_i].tool, sizeof t.point);
        rbd_random(r.m, &seed, q);
        aim(&r, q, &t, 1);
        rbd_random(r.m, &seed, q);
        expect_status(r.name, solve(&r, &t, 1, q, &result), RBD_IK_REACHED, &result);
        evaluations += result.evaluations;
        ck_assert_int_le(result.evaluations, 1000);
    }
    ck_assert_int_le(evaluations / POSES, 30); /* 15 to 25 */
    robot_free(&r);
}
END_TEST

/* Places and directions alone are reached too, also from a start that is singular. */
START_TEST(arms_reach_places_directions_and_turns) {
    robot r = robot_build(arm[_i].name, arm[_i].bodies, arm[_i].nb);
    uint64_t seed = 2;
    for (int k = 0; k < POSES / 2; k++) {
        rbd_ik_target t[2] = {{.kind = RBD_IK_POINT, .body = r.nb - 1, .weight = 4},
                              {.kind = RBD_IK_AXIS, .body = r.nb - 1, .axis = {0.5, 0, 0}}};
        rbd_ik_result result;
        double q[MAX_Q], start[MAX_Q] = {0};
        const int n = 1 + k % 2;
        if (k % 3 == 2) t[0].kind = RBD_IK_ROTATION;
        rbd_random(r.m, &seed, q);
        aim(&r, q, t, 2);
        for (int i = 0; i < 3; i++) t[1].direction[i] *= 1 + k; /* of any length */
        if (k % 5) rbd_random(r.m, &seed, start);
        if (k % 5 == 1) rbd_random(r.m, &seed, start);
        expect_status(r.name, solve(&r, t, n, start, &result), RBD_IK_REACHED, &result);
    }
    robot_free(&r);
}
END_TEST

/* ---- out of reach ---- */

/* A planar arm of two links, 0.5 m and 0.3 m, that turns about z. */
static const rbd_body two_links[2] = {
    {.parent = -1, .type = RBD_REVOLUTE, .axis = {0, 0, 1}, .armature = {1}, .lower = -3, .upper = 3},
    {.parent = 0, .type = RBD_REVOLUTE, .axis = {0, 0, 1}, .position = {0.5, 0, 0}, .armature = {1}}};

static rbd_ik_target tip(double distance, double angle) {
    const rbd_ik_target t = {.kind = RBD_IK_POINT,
                             .body = 1,
                             .point = {0.3, 0, 0},
                             .position = {distance * cos(angle), distance * sin(angle), 0}};
    return t;
}

START_TEST(a_planar_arm_comes_as_near_as_geometry_allows) {
    robot r = BUILD(two_links);
    for (int k = 0; k < 40; k++) {
        const double angle = 0.1 * (k - 20), far = 0.801 + 0.05 * k, near = 0.199 - 0.004 * k;
        double q[2] = {angle / 2, 1};
        rbd_ik_result result;
        rbd_ik_target t = tip(far, angle);
        expect_status("too far", solve(&r, &t, 1, q, &result), RBD_IK_NEAREST, &result);
        ck_assert(fabs(result.metres - (far - 0.8)) < 1e-11);
        ck_assert(fabs(sin((q[0] - angle) / 2)) < 1e-4 && fabs(sin(q[1] / 2)) < 1e-4);
        ck_assert(result.limit == -1 && result.limits == 0 && result.radians == 0);

        t = tip(near, angle);
        expect_status("too near", solve(&r, &t, 1, q, &result), RBD_IK_NEAREST, &result);
        ck_assert(fabs(result.metres - (0.2 - near)) < 1e-11);
    }
    robot_free(&r);
}
END_TEST

/* With one start, as in a control loop: from the stretched arm, where no joint moves the tip inwards, it
   folds; and an arm that points away from its target turns to it, or to a limit. */
START_TEST(a_stretched_arm_folds) {
    const rbd_ik_options once = {.starts = 1};
    rbd_ik_result result;

    robot r = BUILD(two_links);
    double q[2] = {0};
    for (int k = 1; k < 50; k++) {
        const rbd_ik_target t = tip(0.8 - 0.01 * k, 0);
        expect_status("inwards", solve_with(&r, &t, 1, &once, q, &result), RBD_IK_REACHED, &result);
        ck_assert(result.metres <= 1e-6 && fabs(sin(q[1])) > 0.01);
    }
    robot_free(&r);

    rbd_body one[1] = {two_links[0]};
    const rbd_ik_target behind = {
        .kind = RBD_IK_POINT, .body = 0, .point = {1, 0, 0}, .position = {-1, 0, 0}};
    one[0].lower = -1, one[0].upper = 1;
    r = BUILD(one);
    q[0] = 0;
    expect_status("behind", solve_with(&r, &behind, 1, &once, q, &result), RBD_IK_AT_LIMIT, &result);
    ck_assert(fabs(q[0]) == 1 && fabs(result.metres - 2 * cos(0.5)) < 1e-12);
    robot_free(&r);
}
END_TEST

/* The elbow can neither stretch nor turn the other way: the nearest place is with the elbow at its limit, on
   the circle of radius |(0.5, 0) + 0.3 (cos, sin)(0.6)|. */
START_TEST(a_limit_that_keeps_the_tip_away_is_named) {
    rbd_body bodies[2] = {two_links[0], two_links[1]};
    const double reach = sqrt(0.25 + 0.09 + 0.3 * cos(0.6));
    bodies[1].lower = 0.6, bodies[1].upper = 2;
    robot r = BUILD(bodies);
    for (int k = 0; k < 20; k++) {
        const double distance = reach + 0.001 + 0.01 * k, angle = 0.1 * (k - 10);
        const rbd_ik_target t = tip(distance, angle);
        double q[2] = {0, 1.2};
        rbd_ik_result result;
        expect_status("elbow", solve(&r, &t, 1, q, &result), RBD_IK_AT_LIMIT, &result);
        ck_assert(fabs(result.metres - (distance - reach)) < 1e-11);
        ck_assert(result.limit == 1 && result.limits == 1 && q[1] == 0.6);
        char text[100];
        ck_assert_str_eq(rbd_ik_text(RBD_IK_AT_LIMIT, &result, text, sizeof text),
                         "dof 1: not reached: the limit of this joint keeps the targets away");
    }
    robot_free(&r);
}
END_TEST

/* The shoulder of an iiwa is a centre: beyond the stretched arm the nearest point is on a sphere. */
START_TEST(an_iiwa_stretches_to_places_beyond_its_reach) {
    robot r = robot_build("iiwa", iiwa_bodies, 7);
    const double straight[7] = {0};
    double shoulder[3], end[3];
    uint64_t seed = 3;
    ck_assert_int_eq(rbd_kinematics(r.m, r.w, straight, NULL, NULL), RBD_OK);
    rbd_body_pose(r.m, r.w, 1, NULL, shoulder);
    rbd_point_position(r.m, r.w, 6, iiwa_tool, end);
    const double reach = end[2] - shoulder[2];
    for (int k = 0; k < 40 / PART_OF_TREES; k++) {
        rbd_ik_target t = {.kind = RBD_IK_POINT, .body = 6, .point = {0, 0, 0.15}};
        const double beyond = uniform(&seed, 0.001, 0.5), up = uniform(&seed, 0, 0.95),
                     turn = uniform(&seed, -pi, pi);
        double q[7];
        rbd_ik_result result;
        t.position[0] = (reach + beyond) * sqrt(1 - up * up) * cos(turn);
        t.position[1] = (reach + beyond) * sqrt(1 - up * up) * sin(turn);
        t.position[2] = shoulder[2] + (reach + beyond) * up;
        rbd_random(r.m, &seed, q);
        expect_status("iiwa", solve(&r, &t, 1, q, &result), RBD_IK_NEAREST, &result);
        ck_assert_msg(fabs(result.metres - beyond) < 1e-10, "%g", result.metres - beyond);
    }
    robot_free(&r);
}
END_TEST

/* The error is the least nearby, by differences: no free dof brings it down, and each limit that counts keeps
   it up. */
static void expect_least(const robot *r, const rbd_ik_target *t, int n, const double *q,
                         const rbd_ik_result *result) {
    double x[MAX_Q], v[MAX_V] = {0}, metres, radians, steepest = 0, slopes[MAX_V];
    const double h = 1e-5, size = error_at(r, t, n, 0.3, q, &metres, &radians);
    int limits = 0;
    for (int k = 0; k < r->nv; k++) {
        rbd_joint_info j;
        double E[2];
        ck_assert_int_eq(rbd_joint(r->m, rbd_dof_body(r->m, k), &j), RBD_OK);
        const int limited = j.nv == 1 && j.lower < j.upper;
        const int low = limited && q[j.iq] <= j.lower, high = limited && q[j.iq] >= j.upper;
        for (int side = 0; side < 2; side++) {
            v[k] = side ? h : -h;
            rbd_integrate(r->m, q, v, 1, x);
            E[side] = error_at(r, t, n, 0.3, x, &metres, &radians);
        }
        v[k] = 0;
        const double slope = (E[1] - E[0]) / (2 * h); /* of the squared error */
        slopes[k] = 0;
        if ((low && slope > 1e-3 * size) || (high && slope < -1e-3 * size)) {
            limits++;
            slopes[k] = fabs(slope);
            steepest = larger(steepest, fabs(slope));
        } else {
            ck_assert_msg(fabs(slope) < 2e-3 * sqrt(size), "%s, dof %d: %g of %g", r->name, k, slope, size);
        }
    }
    ck_assert_int_ge(result->limits, limits);
    ck_assert(limits == 0 || (result->limit >= 0 && slopes[result->limit] >= 0.99 * steepest));
}

START_TEST(poses_out_of_reach_end_at_a_least_error) {
    robot r = robot_build(arm[_i].name, arm[_i].bodies, arm[_i].nb);
    uint64_t seed = 4;
    int missed = 0, settled = 0;
    for (int k = 0; k < 40 / PART_OF_TREES; k++) {
        rbd_ik_target t[2] = {{.kind = RBD_IK_POSE, .body = r.nb - 1},
                              {.kind = RBD_IK_AXIS, .body = r.nb - 1, .axis = {0, 0, 1}, .weight = 0.5}};
        const rbd_ik_options few = {.starts = 3};
        double q[MAX_Q];
        rbd_ik_result result;
        rbd_random(r.m, &seed, q);
        aim(&r, q, t, 2);
        random_rotation(&seed, t[0].rotation);
        for (int i = 0; i < 3; i++) t[0].position[i] *= 2;
        const rbd_ik_status status = solve_with(&r, t, 1 + k % 2, &few, q, &result);
        if (status == RBD_IK_REACHED) continue;
        missed++;
        settled += status != RBD_IK_EVALUATIONS;
        if (status != RBD_IK_EVALUATIONS) expect_least(&r, t, 1 + k % 2, q, &result);
        ck_assert_int_eq(status == RBD_IK_AT_LIMIT, result.limits > 0 && status != RBD_IK_EVALUATIONS);
    }
    ck_assert_msg(missed >= 20 / PART_OF_TREES && settled >= missed * 9 / 10, "%d of %d", settled, missed);
    robot_free(&r);
}
END_TEST

/* Straight, with the target on its line: the error cannot fall in the first step. Another start reaches it;
   of one start the last descent does, which leaves the saddle. */
START_TEST(starts_where_no_step_comes_nearer_are_left) {
    robot r = BUILD(two_links);
    const rbd_ik_target t = tip(0.4, 0);
    const rbd_ik_options once = {.starts = 1};
    rbd_ik_result result;
    double q[2] = {0, 0};
    expect_status("once", solve_with(&r, &t, 1, &once, q, &result), RBD_IK_REACHED, &result);
    ck_assert_int_eq(result.starts, 1);
    q[0] = q[1] = 0;
    expect_status("more", solve(&r, &t, 1, q, &result), RBD_IK_REACHED, &result);
    ck_assert_int_ge(result.starts, 2);
    robot_free(&r);
}
END_TEST

/* Limits that are as good as none: other starts are around the caller's q, so that the answer may be the next
   start. Straight, with the target on its line: the first start does not reach it. */
START_TEST(wide_limits_are_not_searched_through) {
    static const rbd_real wide[] = {50, 1e6, 1e12, 1e30, 1e308};
    rbd_body bodies[3] = {{.parent = -1, .type = RBD_PRISMATIC, .axis = {1, 0, 0}, .armature = {1}},
                          two_links[0],
                          two_links[1]};
    bodies[1].parent = 0, bodies[2].parent = 1;
    for (int k = 0; k < 2 * LENGTH(wide); k++) {
        const int slides = k % 2;
        for (int i = 0; i < 3; i++) bodies[i].upper = wide[k / 2], bodies[i].lower = -wide[k / 2];
        bodies[1].parent = slides ? 0 : -1, bodies[2].parent = slides;
        robot r = robot_build("wide", slides ? bodies : bodies + 1, slides ? 3 : 2);
        rbd_ik_target t = tip(0.4, 0.3);
        t.body = slides + 1;
        double q[3] = {0, 0, 0};
        rbd_ik_result result;
        for (int again = 0; again < 2; again++) {
            q[slides] = 0.3, q[slides + 1] = 0;
            if (slides) q[0] = 0.1 * cos(0.3), t.position[1] = 0.3 * sin(0.3);
            expect_status("wide", solve(&r, &t, 1, q, &result), RBD_IK_REACHED, &result);
            ck_assert_msg(largest(q, r.nq) < 20, "%g: q = %g, %g", wide[k / 2], q[0], q[1]);
            ck_assert_int_lt(result.evaluations, 60);
        }
        robot_free(&r);
    }
}
END_TEST

/* Joints that follow motors, which turn a hundred times: starts spread over the joints, not the motors. */
START_TEST(a_geared_arm_reaches_what_its_joints_can) {
    static const char *const motor[6] = {"a", "b", "c", "d", "e", "f"};
    rbd_body bodies[12] = {{0}};
    for (int i = 0; i < 6; i++) {
        bodies[i] = ur10e[i], bodies[i].parent = -1, bodies[i].joint = motor[i];
        bodies[i].lower *= 100, bodies[i].upper *= 100;
        bodies[6 + i] = ur10e[i], bodies[6 + i].parent = i > 0 ? 5 + i : -1;
        bodies[6 + i].mimic = motor[i], bodies[6 + i].mimic_ratio = 0.01;
    }
    robot r = BUILD(bodies);
    uint64_t seed = 13;
    int there = 0;
    for (int k = 0; k < 20; k++) {
        rbd_ik_target t = {.kind = RBD_IK_POSE, .body = 11};
        rbd_ik_result result;
        double q[6];
        rbd_random(r.m, &seed, q);
        aim(&r, q, &t, 1);
        rbd_random(r.m, &seed, q);
        there += solve(&r, &t, 1, q, &result) == RBD_IK_REACHED;
    }
    ck_assert_int_ge(there, 19);
    robot_free(&r);
}
END_TEST

/* An axis that points the wrong way, exactly, turns round. */
START_TEST(an_axis_turns_round) {
    static const rbd_body ball[1] = {{.parent = -1, .type = RBD_SPHERICAL, .armature = {1, 1, 1}}};
    robot r = BUILD(ball);
    for (int k = 0; k < 6; k++) {
        rbd_ik_target t = {.kind = RBD_IK_AXIS};
        double q[4] = {0, 0, 0, 1};
        rbd_ik_result result;
        t.axis[k % 3] = k < 3 ? 2 : -2, t.direction[k % 3] = k < 3 ? -3 : 3;
        expect_status("axis", solve(&r, &t, 1, q, &result), RBD_IK_REACHED, &result);
    }
    robot_free(&r);
}
END_TEST

/* Two wishes for one slide, weights 3 and 1: a quarter of the way to the second. */
START_TEST(weights_decide_between_targets) {
    static const rbd_body slide[1] = {
        {.parent = -1, .type = RBD_PRISMATIC, .axis = {1, 0, 0}, .armature = {1}}};
    robot r = BUILD(slide);
    const rbd_ik_target t[2] = {{.kind = RBD_IK_POINT, .weight = 3},
                                {.kind = RBD_IK_POINT, .position = {1, 0, 0}}};
    double q[1] = {5};
    rbd_ik_result result;
    expect_status("weights", solve(&r, t, 2, q, &result), RBD_IK_NEAREST, &result);
    ck_assert(fabs(q[0] - 0.25) < 1e-9 && fabs(result.metres - 0.75) < 1e-9);
    robot_free(&r);
}
END_TEST

/* ---- whole robots ---- */

/* HyQ: four feet, the trunk's pose or the centre of mass, from far away. */
START_TEST(a_floating_robot_takes_feet_and_centre_of_mass) {
    robot r = robot_build("hyq", hyq_bodies, HYQ_NB);
    uint64_t seed = 5;
    for (int k = 0; k < 40 / PART_OF_TREES; k++) {
        rbd_ik_target t[6] = {{0}};
        double q[MAX_Q], start[MAX_Q];
        rbd_ik_result result;
        for (int i = 0; i < 4; i++) {
            t[i].kind = RBD_IK_POINT;
            t[i].body = HYQ_BODY_LF_LOWERLEG + i;
            t[i].point[0] = 0.33;
        }
        t[4].kind = RBD_IK_COM;
        t[5].kind = k % 2 ? RBD_IK_AXIS : RBD_IK_ROTATION, t[5].axis[2] = 1;
        rbd_random(r.m, &seed, q);
        aim(&r, q, t, 6);
        rbd_random(r.m, &seed, start);
        for (int i = 0; i < 3; i++) start[i] += 5 * (k % 3);
        expect_status("hyq", solve(&r, t, 4 + k % 3, start, &result), RBD_IK_REACHED, &result);
    }
    robot_free(&r);
}
END_TEST

/* The centre of mass of an arm on the ground alone. */
START_TEST(an_arm_moves_its_centre_of_mass) {
    robot r = robot_build("iiwa", iiwa_bodies, 7);
    uint64_t seed = 6;
    for (int k = 0; k < 40 / PART_OF_TREES; k++) {
        rbd_ik_target t = {.kind = RBD_IK_COM, .body = -7};
        double q[7];
        rbd_ik_result result;
        rbd_random(r.m, &seed, q);
        aim(&r, q, &t, 1);
        rbd_random(r.m, &seed, q);
        expect_status("com", solve(&r, &t, 1, q, &result), RBD_IK_REACHED, &result);
    }
    robot_free(&r);
}
END_TEST

/* Random trees of all joint types, mimic joints too: a body and the centre of mass of a random state. */
static int trees, reached;
static void check_tree(const robot *r, const state *s, int number) {
    rbd_ik_target t[2] = {{.kind = RBD_IK_POSE}, {.kind = RBD_IK_COM}};
    uint64_t seed = (uint64_t)number * 77 + (uint64_t)r->nb;
    double q[MAX_Q];
    rbd_ik_result result;
    (void)s;
    t[0].body = below(&seed, r->nb);
    t[0].point[1] = 0.2;
    rbd_random(r->m, &seed, q);
    aim(r, q, t, 2);
    rbd_random(r->m, &seed, q);
    const rbd_ik_status status = solve(r, t, rbd_mass(r->m) > 0 ? 1 + number % 2 : 1, q, &result);
    trees++;
    reached += status == RBD_IK_REACHED;
}

static void expect_trees(int number) {
    trees = reached = 0;
    for_random_trees(number, check_tree);
    ck_assert_msg(reached >= trees * 19 / 20, "%d of %d", reached, trees);
}

START_TEST(random_trees_reach_what_they_can) { expect_trees(200); }
END_TEST

/* Where slow tests are left out, as under sanitizers. */
START_TEST(a_tenth_of_the_random_trees) { expect_trees(20 * PART_OF_TREES); }
END_TEST

/* ---- limits, mimic joints, held dofs ---- */

/* A joint with limits -2 and 2, and one on it that follows: q1 = offset + ratio q0, with limits of its
   own. */
static void make_finger(rbd_body finger[2], double ratio, double offset, double lower, double upper) {
    finger[0] = (rbd_body){.joint = "one",
                           .parent = -1,
                           .type = RBD_REVOLUTE,
                           .axis = {0, 0, 1},
                           .armature = {1},
                           .lower = -2,
                           .upper = 2};
    finger[1] = (rbd_body){.parent = 0,
                           .type = RBD_REVOLUTE,
                           .axis = {0, 0, 1},
                           .position = {0.5, 0, 0},
                           .armature = {1},
                           .mimic = "one",
                           .mimic_ratio = ratio,
                           .mimic_offset = offset,
                           .lower = lower,
                           .upper = upper};
}

/* A finger that turns with another, half as far and back, and whose limits bind it: q1 = 0.1 - q0 / 2 in
   [-0.4, 0.3]: q0 in [-0.4, 1]. */
START_TEST(limits_of_a_mimic_joint_bind_what_it_follows) {
    rbd_body finger[2];
    make_finger(finger, -0.5, 0.1, -0.4, 0.3);
    robot r = BUILD(finger);
    for (int k = 0; k < 3; k++) {
        const double wanted = k == 0 ? 0.7 : k == 1 ? 1.5 : -1.5, limit = k == 1 ? 1 : -0.4;
        rbd_ik_target t = {.kind = RBD_IK_POSE, .body = 1, .point = {0.3, 0, 0}};
        double q[1] = {wanted};
        rbd_ik_result result;
        aim(&r, q, &t, 1);
        q[0] = -1.9;
        const rbd_ik_status status = solve(&r, &t, 1, q, &result);
        expect_status("mimic", status, k == 0 ? RBD_IK_REACHED : RBD_IK_AT_LIMIT, &result);
        ck_assert(fabs(q[0] - (k == 0 ? wanted : limit)) < 1e-6);
        if (k > 0) ck_assert(result.limit == 0 && fabs(q[0] - limit) < 1e-15);
    }
    robot_free(&r);
}
END_TEST

/* Limits of a mimic joint that leave nothing of the leader's do not count: the build warns of them. */
START_TEST(limits_that_contradict_do_not_count) {
    rbd_body finger[2];
    make_finger(finger, 1, 0, 3, 4);
    robot r = BUILD(finger);
    rbd_ik_target t = {.kind = RBD_IK_POSE, .body = 1};
    double q[1] = {1.5};
    rbd_ik_result result;
    aim(&r, q, &t, 1);
    q[0] = 0;
    expect_status("mimic", solve(&r, &t, 1, q, &result), RBD_IK_REACHED, &result);
    robot_free(&r);
}
END_TEST

/* Two fingers, right = -left, both in [0, 0.04]: ranges that touch leave one place. */
START_TEST(limits_that_touch_leave_one_place) {
    const rbd_body finger[2] = {{.joint = "left",
                                 .parent = -1,
                                 .type = RBD_PRISMATIC,
                                 .axis = {1, 0, 0},
                                 .armature = {1},
                                 .upper = 0.04},
                                {.parent = -1,
                                 .type = RBD_PRISMATIC,
                                 .axis = {1, 0, 0},
                                 .armature = {1},
                                 .mimic = "left",
                                 .mimic_ratio = -1,
                                 .upper = 0.04}};
    robot r = BUILD(finger);
    for (int k = 0; k < 3; k++) {
        const rbd_ik_target t = {.kind = RBD_IK_POINT, .body = k % 2, .position = {k == 2 ? 0 : 0.02, 0, 0}};
        double q[1] = {0.03};
        rbd_ik_result result;
        expect_status("touch", solve(&r, &t, 1, q, &result), k == 2 ? RBD_IK_REACHED : RBD_IK_AT_LIMIT,
                      &result);
        ck_assert(q[0] == 0 && (k == 2 || result.limit == 0));
    }
    robot_free(&r);
}
END_TEST

/* Screws of either hand: steep, fine, and so fine that no turn within reason moves the target. */
START_TEST(screws_go_where_they_lead) {
    static const double pitches[] = {5, -5, 0.02, -0.02, 1e-10};
    for (int k = 0; k < LENGTH(pitches); k++) {
        const rbd_body bodies[2] = {{.parent = -1,
                                     .type = RBD_HELICAL,
                                     .axis = {0, 0, k % 2 ? -1 : 1},
                                     .pitch = pitches[k],
                                     .lower = -1e8,
                                     .upper = 1e8,
                                     .armature = {1}},
                                    {.parent = 0, .type = RBD_PRISMATIC, .axis = {0, 0, 1}, .armature = {1}}};
        robot r = BUILD(bodies);
        for (int i = 0; i < 8; i++) {
            const double there[2] = {0.5 * i, 0.3 + 0.1 * i};
            rbd_ik_target t = {.kind = RBD_IK_POINT, .body = 1, .point = {0.3, 0, 0}};
            double q[2] = {-1, 0};
            rbd_ik_result result;
            aim(&r, there, &t, 1);
            expect_status("screw", solve(&r, &t, 1, q, &result), RBD_IK_REACHED, &result);

            t.position[0] *= 2; /* twice as far from the axis */
            t.position[1] *= 2;
            expect_status("screw", solve(&r, &t, 1, q, &result), RBD_IK_NEAREST, &result);
            ck_assert(fabs(result.metres - 0.3) < 1e-6);
        }
        robot_free(&r);
    }
}
END_TEST

/* A slide with an upper limit alone. */
START_TEST(one_limit_is_enough) {
    const rbd_body bodies[1] = {{.parent = -1,
                                 .type = RBD_PRISMATIC,
                                 .axis = {1, 0, 0},
                                 .armature = {1},
                                 .lower = -1e30,
                                 .upper = 0.5}};
    robot r = BUILD(bodies);
    for (int k = 0; k < 2; k++) {
        const rbd_ik_target t = {.kind = RBD_IK_POINT, .position = {k ? -7 : 0.75, 0, 0}};
        double q[1] = {0};
        rbd_ik_result result;
        expect_status("limit", solve(&r, &t, 1, q, &result), k ? RBD_IK_REACHED : RBD_IK_AT_LIMIT, &result);
        ck_assert(fabs(q[0] - (k ? -7 : 0.5)) < 1e-6);
    }
    robot_free(&r);
}
END_TEST

/* A tool without mass has no part in the centre of mass. */
START_TEST(what_has_no_mass_does_not_move_the_centre_of_mass) {
    const rbd_body bodies[2] = {{.parent = -1,
                                 .type = RBD_PRISMATIC,
                                 .axis = {1, 0, 0},
                                 .mass = 2,
                                 .com = {0.1, 0, 0},
                                 .inertia = {1, 0, 0, 1, 0, 1}},
                                {.parent = 0, .type = RBD_PRISMATIC, .axis = {1, 0, 0}, .armature = {1}}};
    robot r = BUILD(bodies);
    const rbd_ik_target t = {.kind = RBD_IK_COM, .position = {0.4, 0, 0}};
    double q[2] = {0, 0.25};
    rbd_ik_result result;
    expect_status("tool", solve(&r, &t, 1, q, &result), RBD_IK_REACHED, &result);
    ck_assert(fabs(q[0] - 0.3) < 1e-6 && q[1] == 0.25);
    robot_free(&r);
}
END_TEST

/* Joints that move no target stay to the bit, held ones too; a start out of the limits is put within them. */
START_TEST(what_need_not_move_stays) {
    robot r = robot_build("hyq", hyq_bodies, HYQ_NB);
    const int haa = HYQ_Q_LF_HAA_JOINT, hfe = HYQ_Q_LF_HFE_JOINT;
    unsigned char held[HYQ_NV] = {1, 1, 1, 1, 1, 1};
    const rbd_ik_options o = {.held = held};
    rbd_ik_target t = {.kind = RBD_IK_POINT, .body = HYQ_BODY_LF_LOWERLEG, .point = {0.33, 0, 0}};
    double q[MAX_Q], start[MAX_Q];
    rbd_ik_result result;
    uint64_t seed = 9;
    for (int k = 0; k < 20; k++) {
        rbd_random(r.m, &seed, q);
        memcpy(start, q, sizeof start);
        start[haa] = -start[haa], start[hfe] = 100; /* above its limit */
        held[HYQ_Q_LF_KFE_JOINT - 1] = 1;
        aim(&r, q, &t, 1);
        memcpy(q, start, sizeof q);
        solve_with(&r, &t, 1, &o, q, &result);
        for (int i = 0; i < r.nq; i++)
            if (i != haa && i != hfe) ck_assert(q[i] == start[i]);
        ck_assert(q[haa] != start[haa] && q[hfe] < 2);
    }
    robot_free(&r);
}
END_TEST

/* A joint whose coordinates move together is held as a whole or not at all; others dof by dof. */
START_TEST(a_joint_is_held_as_a_whole) {
    static const rbd_joint_type type[] = {RBD_SPHERICAL, RBD_PLANAR,      RBD_FLOATING,
                                          RBD_UNIVERSAL, RBD_CYLINDRICAL, RBD_TRANSLATION};
    for (int k = 0; k < LENGTH(type); k++) {
        const rbd_body body[2] = {{.parent = -1, .type = RBD_REVOLUTE, .axis = {0, 0, 1}, .armature = {1}},
                                  {.parent = 0,
                                   .type = type[k],
                                   .axis = {1, 0, 0},
                                   .axis2 = {0, 1, 0},
                                   .armature = {1, 1, 1, 1, 1, 1}}};
        robot r = BUILD(body);
        const rbd_ik_target t = {
            .kind = RBD_IK_POINT, .body = 1, .point = {0.1, 0.2, 0.3}, .position = {0.2, 0.1, 0.25}};
        void *memory = malloc(rbd_ik_size(r.m, 1));
        for (int set = 0; set < 1 << (r.nv - 1); set++) {
            unsigned char held[MAX_V] = {0};
            const rbd_ik_options o = {.held = held, .starts = 1};
            const int part = set != 0 && set != (1 << (r.nv - 1)) - 1;
            double q[MAX_Q], start[MAX_Q];
            rbd_ik_result x;
            for (int i = 1; i < r.nv; i++) held[i] = (unsigned char)(2 * (set >> (i - 1) & 1));
            ck_assert_int_eq(rbd_neutral(r.m, q), RBD_OK);
            memcpy(start, q, sizeof start);
            const rbd_ik_status status = rbd_ik(r.m, r.w, &t, 1, &o, memory, rbd_ik_size(r.m, 1), q, &x);
            ck_assert_int_eq(status == RBD_IK_ERROR, k < 3 && part);
            ck_assert(status != RBD_IK_ERROR || !memcmp(q, start, (size_t)r.nq * sizeof *q));
            if (k < 3 && part) {
                char text[120];
                ck_assert(x.error == RBD_ERR_INFEASIBLE && x.target == -1);
                ck_assert_str_eq(
                    rbd_ik_text(status, &x, text, sizeof text),
                    "field 'held': only a part of a spherical, planar or floating joint is held");
            }
            for (int i = 1; i < r.nv && k >= 3; i++) ck_assert(!held[i] || q[i] == start[i]);
        }
        free(memory);
        robot_free(&r);
    }
}
END_TEST

/* Nothing moves a body that is fixed to the world: the distance is what it is. */
START_TEST(a_fixed_body_is_where_it_is) {
    static const rbd_body fixed[2] = {
        {.parent = -1, .type = RBD_FIXED, .position = {1, 2, 3}},
        {.parent = -1, .type = RBD_REVOLUTE, .axis = {0, 0, 1}, .armature = {1}}};
    robot r = BUILD(fixed);
    rbd_ik_target t = {.kind = RBD_IK_POINT, .position = {1, 2, 3}};
    double q[1] = {0.5};
    rbd_ik_result result;
    expect_status("there", solve(&r, &t, 1, q, &result), RBD_IK_REACHED, &result);
    t.position[2] = 7;
    expect_status("elsewhere", solve(&r, &t, 1, q, &result), RBD_IK_NEAREST, &result);
    ck_assert(result.metres == 4 && q[0] == 0.5);
    robot_free(&r);
}
END_TEST

/* ---- work and bits ---- */

START_TEST(work_is_bounded_and_the_same_each_time) {
    robot r = robot_build("Panda", panda, 7);
    uint64_t seed = 10;
    for (int k = 0; k < 60; k++) {
        const rbd_ik_options o = {.evaluations = k + 2, .starts = k % 4};
        rbd_ik_target t = {.kind = RBD_IK_POSE, .body = 6};
        double q[7], again[7];
        rbd_ik_result result, second;
        rbd_random(r.m, &seed, q);
        aim(&r, q, &t, 1);
        t.position[0] += 3; /* out of reach */
        rbd_random(r.m, &seed, q);
        memcpy(again, q, sizeof q);
        const rbd_ik_status status = solve_with(&r, &t, 1, &o, q, &result);
        ck_assert_int_le(result.evaluations, k + 2);
        ck_assert_int_eq(solve_with(&r, &t, 1, &o, again, &second), status);
        ck_assert(!memcmp(q, again, sizeof q) && result.evaluations == second.evaluations);
        if (k < 10) expect_status("few", status, RBD_IK_EVALUATIONS, &result);
    }
    robot_free(&r);
}
END_TEST

/* A wider tolerance ends sooner; the length decides between place and turn. */
START_TEST(options_do_what_they_say) {
    robot r = robot_build("hobby arm", hobby_arm, 5);
    uint64_t seed = 11;
    int sooner = 0, nearer = 0;
    for (int k = 0; k < 20; k++) {
        const rbd_ik_options wide = {.metres = 0.01, .radians = 0.05}, one = {.starts = 1, .length = 0.01},
                             turn = {.starts = 1, .length = 10};
        rbd_ik_target t = {.kind = RBD_IK_POSE, .body = 4};
        double q[5], start[5], x[5];
        rbd_ik_result a, b;
        rbd_random(r.m, &seed, q);
        aim(&r, q, &t, 1);
        rbd_random(r.m, &seed, start);
        memcpy(x, start, sizeof x);
        solve(&r, &t, 1, x, &a);
        memcpy(x, start, sizeof x);
        expect_status("wide", solve_with(&r, &t, 1, &wide, x, &b), RBD_IK_REACHED, &b);
        sooner += b.evaluations < a.evaluations && b.metres > 1e-6;

        random_rotation(&seed, t.rotation); /* five axes: hardly any is reached */
        memcpy(x, start, sizeof x);
        solve_with(&r, &t, 1, &one, x, &a);
        memcpy(x, start, sizeof x);
        solve_with(&r, &t, 1, &turn, x, &b);
        nearer += a.metres < b.metres && a.radians > b.radians;
    }
    ck_assert_int_ge(sooner, 18);
    ck_assert_int_ge(nearer, 15);
    robot_free(&r);
}
END_TEST

START_TEST(a_constant_has_room_for_any_robot) {
    ck_assert_uint_ge(RBD_IK_SIZE(7, 7, 3), 1);
    for (int i = 0; i < LENGTH(arm); i++) {
        robot r = robot_build(arm[i].name, arm[i].bodies, arm[i].nb);
        for (int n = 1; n < 5; n++)
            ck_assert_uint_ge(RBD_IK_SIZE((size_t)r.nb, (size_t)r.nv, n), rbd_ik_size(r.m, n));
        ck_assert_uint_eq(rbd_ik_size(r.m, 0), 0);
        ck_assert_uint_eq(rbd_ik_size(r.m, 1001), 0);
        ck_assert_uint_gt(rbd_ik_size(r.m, 1000), rbd_ik_size(r.m, 999));
        robot_free(&r);
    }
    ck_assert_uint_eq(rbd_ik_size(NULL, 1), 0);
}
END_TEST

/* ---- bad input ---- */

typedef void spoil(rbd_ik_target *t, rbd_ik_options *o, double *q);
#define SPOIL(name, change) \
    static void name(rbd_ik_target *t, rbd_ik_options *o, double *q) { \
        (void)t, (void)o, (void)q; \
        change; \
    }
SPOIL(bad_kind, t->kind = (rbd_ik_kind)6)
SPOIL(no_kind, memset(&t->kind, 0, sizeof t->kind))
SPOIL(bad_kind_below, *(int *)&t->kind = -1)
SPOIL(body_below, t->body = -1)
SPOIL(body_above, t->body = 7)
SPOIL(nan_point, t->point[1] = NAN)
SPOIL(far_point, t->point[2] = 2e9)
SPOIL(nan_position, t->position[2] = NAN)
SPOIL(infinite_position, t->position[0] = -INFINITY)
SPOIL(nan_rotation, t->rotation[8] = NAN)
SPOIL(nan_first_row, t->rotation[2] = NAN)
SPOIL(nan_second_row, t->rotation[3] = NAN)
SPOIL(stretched, t->rotation[0] = 1.1)
SPOIL(stretched_y, t->rotation[4] = 1.1)
SPOIL(stretched_z, t->rotation[8] = 1.1)
SPOIL(sheared_xy, t->rotation[0] = cos(0.01); t->rotation[1] = sin(0.01))
SPOIL(sheared_xz, t->rotation[0] = cos(0.01); t->rotation[2] = sin(0.01))
SPOIL(sheared_yz, t->rotation[4] = cos(0.01); t->rotation[5] = sin(0.01))
SPOIL(sheared, t->rotation[1] = 0.01)
SPOIL(mirrored, t->rotation[0] = -1)
SPOIL(no_axis, t->kind = RBD_IK_AXIS; t->axis[0] = 0)
SPOIL(short_axis, t->kind = RBD_IK_AXIS; t->axis[0] = 0.9e-9)
SPOIL(long_direction, t->kind = RBD_IK_AXIS; t->direction[1] = 1.1e9)
SPOIL(nan_axis, t->kind = RBD_IK_AXIS; t->axis[0] = NAN)
SPOIL(no_direction, t->kind = RBD_IK_AXIS; t->direction[1] = 0)
SPOIL(nan_weight, t->weight = NAN)
SPOIL(negative_weight, t->weight = -1)
SPOIL(tiny_weight, t->weight = 1e-9)
SPOIL(huge_weight, t->weight = 1e9)
SPOIL(negative_starts, o->starts = -1)
static const unsigned char nothing_held[7];
SPOIL(negative_starts_of_a_held_robot, o->starts = -1; o->held = nothing_held)
SPOIL(negative_evaluations, o->evaluations = -5)
SPOIL(one_evaluation, o->evaluations = 1)
SPOIL(nan_metres, o->metres = NAN)
SPOIL(negative_radians, o->radians = -1)
SPOIL(tiny_length, o->length = 0.9e-9)
SPOIL(infinite_length, o->length = INFINITY)
SPOIL(nan_q, q[3] = NAN)
SPOIL(infinite_q, q[6] = INFINITY)
SPOIL(far_q, q[0] = -1e10)

static const struct {
    spoil *spoil;
    rbd_status error;
    int target;
    const char *field, *text; /* NULL: that of the status */
} bad[] = {
    {bad_kind, RBD_ERR_TYPE, 1, "kind", "no kind of target"},
    {no_kind, RBD_ERR_TYPE, 1, "kind", "no kind of target"},
    {bad_kind_below, RBD_ERR_TYPE, 1, "kind", "no kind of target"},
    {body_below, RBD_ERR_INDEX, 1, "body", NULL},
    {body_above, RBD_ERR_INDEX, 1, "body", NULL},
    {nan_point, RBD_ERR_POSITION, 1, "point", "not finite, or farther than 1e9 m"},
    {far_point, RBD_ERR_POSITION, 1, "point", "not finite, or farther than 1e9 m"},
    {nan_position, RBD_ERR_POSITION, 1, "position", "not finite, or farther than 1e9 m"},
    {infinite_position, RBD_ERR_POSITION, 1, "position", "not finite, or farther than 1e9 m"},
    {nan_rotation, RBD_ERR_ROTATION, 1, "rotation", NULL},
    {nan_first_row, RBD_ERR_ROTATION, 1, "rotation", NULL},
    {nan_second_row, RBD_ERR_ROTATION, 1, "rotation", NULL},
    {stretched, RBD_ERR_ROTATION, 1, "rotation", NULL},
    {stretched_y, RBD_ERR_ROTATION, 1, "rotation", NULL},
    {stretched_z, RBD_ERR_ROTATION, 1, "rotation", NULL},
    {sheared_xy, RBD_ERR_ROTATION, 1, "rotation", NULL},
    {sheared_xz, RBD_ERR_ROTATION, 1, "rotation", NULL},
    {sheared_yz, RBD_ERR_ROTATION, 1, "rotation", NULL},
    {sheared, RBD_ERR_ROTATION, 1, "rotation", NULL},
    {mirrored, RBD_ERR_ROTATION, 1, "rotation", NULL},
    {no_axis, RBD_ERR_AXIS, 1, "axis", "not finite, or of a length out of 1e-9 to 1e9"},
    {short_axis, RBD_ERR_AXIS, 1, "axis", "not finite, or of a length out of 1e-9 to 1e9"},
    {long_direction, RBD_ERR_AXIS, 1, "direction", "not finite, or of a length out of 1e-9 to 1e9"},
    {nan_axis, RBD_ERR_AXIS, 1, "axis", "not finite, or of a length out of 1e-9 to 1e9"},
    {no_direction, RBD_ERR_AXIS, 1, "direction", "not finite, or of a length out of 1e-9 to 1e9"},
    {nan_weight, RBD_ERR_RANGE, 1, "weight", NULL},
    {negative_weight, RBD_ERR_RANGE, 1, "weight", NULL},
    {tiny_weight, RBD_ERR_RANGE, 1, "weight", NULL},
    {huge_weight, RBD_ERR_RANGE, 1, "weight", NULL},
    {negative_starts, RBD_ERR_RANGE, -1, "starts", NULL},
    {negative_starts_of_a_held_robot, RBD_ERR_RANGE, -1, "starts", NULL},
    {negative_evaluations, RBD_ERR_RANGE, -1, "evaluations", NULL},
    {one_evaluation, RBD_ERR_RANGE, -1, "evaluations", NULL},
    {nan_metres, RBD_ERR_RANGE, -1, "metres", NULL},
    {negative_radians, RBD_ERR_RANGE, -1, "radians", NULL},
    {tiny_length, RBD_ERR_RANGE, -1, "length", NULL},
    {infinite_length, RBD_ERR_RANGE, -1, "length", NULL},
    {nan_q, RBD_ERR_NAN, -1, "q", "not finite, or the errors overflow"},
    {infinite_q, RBD_ERR_NAN, -1, "q", "not finite, or the errors overflow"},
    {far_q, RBD_ERR_RANGE, -1, "q", NULL},
};

START_TEST(bad_input_is_named_and_changes_nothing) {
    robot r = robot_build("iiwa", iiwa_bodies, 7);
    unsigned char memory[RBD_IK_SIZE(7, 7, 2)];
    rbd_ik_target t[2] = {{.kind = RBD_IK_POINT, .body = 3},
                          {.kind = RBD_IK_POSE,
                           .body = 6,
                           .rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1},
                           .axis = {1, 0, 0},
                           .direction = {0, 1, 0}}};
    rbd_ik_options o = {0};
    double q[7] = {0}, before[7];
    rbd_ik_result result;
    bad[_i].spoil(&t[1], &o, q);
    memcpy(before, q, sizeof q);
    ck_assert_int_eq(rbd_ik(r.m, r.w, t, 2, &o, memory, sizeof memory, q, &result), RBD_IK_ERROR);
    ck_assert_msg(result.error == bad[_i].error, "%s: %s", bad[_i].field, rbd_status_string(result.error));
    ck_assert_int_eq(result.target, bad[_i].target);
    ck_assert_str_eq(result.field, bad[_i].field);
    ck_assert(!memcmp(before, q, sizeof q) && result.evaluations == 0);
    const char *sentence = bad[_i].text ? bad[_i].text : rbd_status_string(bad[_i].error);
    char text[200], expected[200];
    if (bad[_i].target < 0)
        snprintf(expected, sizeof expected, "field '%s': %s", bad[_i].field, sentence);
    else
        snprintf(expected, sizeof expected, "target 1, field '%s': %s", bad[_i].field, sentence);
    ck_assert_str_eq(rbd_ik_text(RBD_IK_ERROR, &result, text, sizeof text), expected);
    robot_free(&r);
}
END_TEST

START_TEST(missing_arguments_are_errors) {
    robot r = robot_build("iiwa", iiwa_bodies, 7), other = robot_build("UR10e", ur10e, 6);
    unsigned char memory[RBD_IK_SIZE(7, 7, 1)];
    const rbd_ik_target t = {.kind = RBD_IK_POINT, .body = 3};
    const size_t size = rbd_ik_size(r.m, 1);
    double q[7] = {0};
    rbd_ik_result x;
    ck_assert_int_eq(rbd_ik(r.m, r.w, &t, 1, NULL, memory, size, q, NULL), RBD_IK_ERROR);
    ck_assert_int_eq(rbd_ik(NULL, r.w, &t, 1, NULL, memory, size, q, &x), RBD_IK_ERROR);
    ck_assert_int_eq(x.error, RBD_ERR_NULL);
    ck_assert_int_eq(rbd_ik(r.m, NULL, &t, 1, NULL, memory, size, q, &x), RBD_IK_ERROR);
    ck_assert_int_eq(x.error, RBD_ERR_NULL);
    ck_assert_int_eq(rbd_ik(r.m, r.w, NULL, 1, NULL, memory, size, q, &x), RBD_IK_ERROR);
    ck_assert_int_eq(x.error, RBD_ERR_NULL);
    ck_assert_int_eq(rbd_ik(r.m, r.w, &t, 1, NULL, NULL, size, q, &x), RBD_IK_ERROR);
    ck_assert_int_eq(x.error, RBD_ERR_NULL);
    ck_assert_int_eq(rbd_ik(r.m, r.w, &t, 1, NULL, memory, size, NULL, &x), RBD_IK_ERROR);
    ck_assert_int_eq(x.error, RBD_ERR_NULL);
    ck_assert_int_eq(rbd_ik(r.m, other.w, &t, 1, NULL, memory, size, q, &x), RBD_IK_ERROR);
    ck_assert_int_eq(x.error, RBD_ERR_WORK);
    ck_assert_int_eq(rbd_ik(r.m, r.w, &t, 1, NULL, memory, size - 1, q, &x), RBD_IK_ERROR);
    ck_assert_int_eq(x.error, RBD_ERR_MEMORY);
    const rbd_ik_target forgotten[2] = {{.body = 3}, t};
    ck_assert_int_eq(rbd_ik(r.m, r.w, forgotten, 2, NULL, memory, size, q, &x), RBD_IK_ERROR);
    ck_assert(x.error == RBD_ERR_TYPE && x.target == 0);
    ck_assert_int_eq(rbd_ik(r.m, r.w, &t, 0, NULL, memory, size, q, &x), RBD_IK_ERROR);
    ck_assert_int_eq(x.error, RBD_ERR_COUNT);
    ck_assert_int_eq(rbd_ik(r.m, r.w, &t, 1001, NULL, memory, size, q, &x), RBD_IK_ERROR);
    ck_assert_int_eq(x.error, RBD_ERR_COUNT);
    char text[60];
    ck_assert_str_eq(rbd_ik_text(RBD_IK_ERROR, &x, text, sizeof text),
                     "fewer than 1 target, or more than 1000");
    ck_assert_str_eq(rbd_ik_text(RBD_IK_ERROR, NULL, text, sizeof text),
                     "an error, and no result that says which");
    ck_assert_str_eq(rbd_ik_text(RBD_IK_REACHED, &x, text, sizeof text), "all targets are reached");
    ck_assert_str_eq(rbd_ik_text(RBD_IK_NEAREST, NULL, text, 12), "not reached");
    ck_assert_str_eq(rbd_ik_text(RBD_IK_EVALUATIONS, NULL, text, sizeof text),
                     "not reached: more evaluations might come nearer");
    x.limit = -1;
    ck_assert_str_eq(rbd_ik_text(RBD_IK_AT_LIMIT, &x, text, 12), "not reached");
    ck_assert_str_eq(rbd_ik_text(RBD_IK_AT_LIMIT, NULL, text, 12), "not reached");
    ck_assert_ptr_eq(rbd_ik_text(RBD_IK_REACHED, NULL, text, 0), text);
    ck_assert_str_eq(text, "not reached");
    ck_assert_str_eq(rbd_ik_text((rbd_ik_status)9, NULL, text, sizeof text), "unknown status");
    ck_assert_ptr_null(rbd_ik_text(RBD_IK_REACHED, NULL, NULL, 5));
    robot_free(&r);
    robot_free(&other);
}
END_TEST

START_TEST(a_robot_without_mass_has_no_centre_of_mass) {
    robot r = robot_build("hobby arm", hobby_arm, 5);
    unsigned char memory[RBD_IK_SIZE(5, 5, 1)];
    const rbd_ik_target t = {.kind = RBD_IK_COM};
    double q[5] = {0};
    rbd_ik_result x;
    ck_assert_int_eq(rbd_ik(r.m, r.w, &t, 1, NULL, memory, sizeof memory, q, &x), RBD_IK_ERROR);
    ck_assert(x.error == RBD_ERR_MASS && x.target == 0 && !strcmp(x.field, "kind"));
    char text[100];
    ck_assert_str_eq(rbd_ik_text(RBD_IK_ERROR, &x, text, sizeof text),
                     "target 0, field 'kind': a centre of mass, but the robot has no mass");
    robot_free(&r);
}
END_TEST

/* Lengths whose squares overflow: no place has a finite error; q stays. */
START_TEST(lengths_that_overflow_are_an_error) {
    rbd_body bodies[2] = {two_links[0], two_links[1]};
    bodies[1].position[0] = 1e200;
    robot r = BUILD(bodies);
    unsigned char memory[RBD_IK_SIZE(2, 2, 1)];
    const rbd_ik_target t = tip(0.4, 0);
    double q[2] = {0.1, 0.2};
    rbd_ik_result x;
    ck_assert_int_eq(rbd_ik(r.m, r.w, &t, 1, NULL, memory, sizeof memory, q, &x), RBD_IK_ERROR);
    ck_assert(x.error == RBD_ERR_NAN && !strcmp(x.field, "q") && q[0] == 0.1 && q[1] == 0.2);
    robot_free(&r);
}
END_TEST

/* The joints of random trees stay finite whatever the targets. */
START_TEST(strange_targets_leave_finite_answers) {
    robot r = robot_build("hyq", hyq_bodies, HYQ_NB);
    const double values[] = {0, 1e9, -1e9, 1e-300, -0.0, 1e5};
    uint64_t seed = 12;
    for (int k = 0; k < 60 / PART_OF_TREES; k++) {
        rbd_ik_target t = {.kind = (rbd_ik_kind)(1 + k % 5),
                           .body = below(&seed, r.nb),
                           .axis = {1e9, 1, 0},
                           .direction = {0, 0, 1e-9}};
        const rbd_ik_options o = {.starts = 2};
        double q[MAX_Q], start[MAX_Q];
        rbd_ik_result result;
        for (int i = 0; i < 3; i++)
            t.position[i] = values[below(&seed, 6)], t.point[i] = values[below(&seed, 6)];
        t.weight = k % 7 == 0 ? 1e6 : 0;
        rbd_random(r.m, &seed, q);
        if (k % 4 == 0) q[0] = 1e9, q[9] = -1e9;
        memcpy(start, q, sizeof start);
        const size_t size = rbd_ik_size(r.m, 1);
        void *memory = malloc(size);
        ck_assert_int_ge(rbd_ik(r.m, r.w, &t, 1, &o, memory, size, q, &result), RBD_IK_REACHED);
        expect_within(&r, start, q);
        ck_assert(isfinite(result.metres) && isfinite(result.radians));
        free(memory);
    }
    robot_free(&r);
}
END_TEST

Suite *ik_suite(void) {
    Suite *suite = suite_create("ik");
    TCase *c = tcase_create("ik"), *slow = slow_tests(suite);
    tcase_set_timeout(c, 60);
    tcase_add_loop_test(slow, arms_reach_random_poses, 0, LENGTH(arm));
    tcase_add_loop_test(c, arms_reach_places_directions_and_turns, 0, LENGTH(arm));
    tcase_add_test(c, a_planar_arm_comes_as_near_as_geometry_allows);
    tcase_add_test(c, a_stretched_arm_folds);
    tcase_add_test(c, a_limit_that_keeps_the_tip_away_is_named);
    tcase_add_test(c, an_iiwa_stretches_to_places_beyond_its_reach);
    tcase_add_loop_test(slow, poses_out_of_reach_end_at_a_least_error, 0, LENGTH(arm));
    tcase_add_test(c, starts_where_no_step_comes_nearer_are_left);
    tcase_add_test(c, wide_limits_are_not_searched_through);
    tcase_add_test(c, a_geared_arm_reaches_what_its_joints_can);
    tcase_add_test(c, an_axis_turns_round);
    tcase_add_test(c, weights_decide_between_targets);
    tcase_add_test(c, a_floating_robot_takes_feet_and_centre_of_mass);
    tcase_add_test(c, an_arm_moves_its_centre_of_mass);
    tcase_add_test(slow, random_trees_reach_what_they_can);
    tcase_add_test(c, a_tenth_of_the_random_trees);
    tcase_add_test(c, limits_of_a_mimic_joint_bind_what_it_follows);
    tcase_add_test(c, limits_that_contradict_do_not_count);
    tcase_add_test(c, limits_that_touch_leave_one_place);
    tcase_add_test(c, screws_go_where_they_lead);
    tcase_add_test(c, one_limit_is_enough);
    tcase_add_test(c, what_has_no_mass_does_not_move_the_centre_of_mass);
    tcase_add_test(c, what_need_not_move_stays);
    tcase_add_test(c, a_joint_is_held_as_a_whole);
    tcase_add_test(c, a_fixed_body_is_where_it_is);
    tcase_add_test(c, work_is_bounded_and_the_same_each_time);
    tcase_add_test(c, options_do_what_they_say);
    tcase_add_test(c, a_constant_has_room_for_any_robot);
    tcase_add_loop_test(c, bad_input_is_named_and_changes_nothing, 0, LENGTH(bad));
    tcase_add_test(c, missing_arguments_are_errors);
    tcase_add_test(c, a_robot_without_mass_has_no_centre_of_mass);
    tcase_add_test(c, lengths_that_overflow_are_an_error);
    tcase_add_test(c, strange_targets_leave_finite_answers);
    suite_add_tcase(suite, c);
    return suite;
}
