/* test_tasks.c - whole-body control: tasks, contacts, friction, limits, levels, bad input. Kinematics,
   inverse dynamics, simulation and closed forms judge. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "rbd_contact.h"
#include "rbd_tasks.h"

#include "models/hyq.h"
#include "models/iiwa.h"
#include "suites.h"
#include "support.h"

enum { FEET = 4, LEAST = 5 };

static const double mu = 0.4, toe[3] = {0.33, 0, 0}, tool[3] = {0, 0, 0.15};
static const double pi = 3.14159265358979323846;

/* ---- calls, whose answers are judged ---- */

static void expect_answer(const rbd_tasks_result *result, rbd_tasks_status status,
                          rbd_tasks_status expected) {
    char text[200];
    ck_assert_msg(status == expected, "%d, not %d: %s, level %d, QP %d, %g, %g", status, expected,
                  rbd_tasks_text(status, result, text, sizeof text), result->level, result->qp,
                  result->primal, result->dual);
}

/* With memory of exactly its size. */
static rbd_tasks_status move_by(const robot *r, const rbd_tasks *p, const double *q, double *v,
                                rbd_tasks_result *result) {
    const size_t size = rbd_tasks_size(r->m, p);
    void *memory = memset(malloc(size), 0x41, size); /* old bytes: 2261634.5 each */
    const rbd_tasks_status status = rbd_tasks_velocity(r->m, r->w, p, q, memory, size, v, result);
    free(memory);
    return status;
}

static rbd_tasks_status push_by(const robot *r, const rbd_tasks *p, const double *q, const double *v,
                                double *a, double *f, double *tau, rbd_tasks_result *result) {
    const size_t size = rbd_tasks_size(r->m, p);
    void *memory = memset(malloc(size), 0x41, size);
    const rbd_tasks_status status =
        rbd_tasks_acceleration(r->m, r->w, p, q, v, memory, size, a, f, tau, result);
    free(memory);
    return status;
}

/* tau are the torques of inverse dynamics with these accelerations and forces, and 0 of dofs without a motor;
   contacts stay where they are, and push within friction. */
static void expect_dynamics(const robot *r, const rbd_tasks *p, const double *q, const double *v,
                            const double *a, const double *f, const double *tau) {
    double f_ext[6 * MAX_BODIES] = {0}, expected[MAX_V], motion[6], row[6];
    ck_assert_int_eq(rbd_kinematics(r->m, r->w, q, v, a), RBD_OK);
    for (int i = 0; i < p->contacts; i++) {
        const rbd_task_contact *c = &p->contact[i];
        const double wrench[6] = {0, 0, 0, f[3 * i], f[3 * i + 1], f[3 * i + 2]};
        const double *given = c->normal, z[3] = {0, 0, 1};
        const double *n = dot(given, given, 3) > 0 ? given : z;
        const double normal = dot(&f[3 * i], n, 3) / sqrt(dot(n, n, 3));
        const double slope = sqrt(larger(0, dot(&f[3 * i], &f[3 * i], 3) - normal * normal));
        if (c->open) {
            ck_assert(f[3 * i] == 0 && f[3 * i + 1] == 0 && f[3 * i + 2] == 0);
            continue;
        }
        ck_assert_msg(slope <= c->friction * normal + 1e-8, "slope %g at %g", slope, normal);
        ck_assert(normal >= c->least - 1e-8 && (c->most <= 0 || normal <= c->most + 1e-8));

        ck_assert_int_eq(rbd_point_wrench(r->m, r->w, c->body, c->point, RBD_WORLD_AXES, wrench, row),
                         RBD_OK);
        for (int k = 0; k < 6; k++) f_ext[6 * c->body + k] += row[k];
        ck_assert_int_eq(rbd_point_acceleration(r->m, r->w, c->body, c->point, RBD_WORLD_AXES, motion),
                         RBD_OK);
        for (int k = 0; k < 3; k++) row[k] = motion[3 + k];
        ck_assert_int_eq(rbd_point_velocity(r->m, r->w, c->body, c->point, RBD_WORLD_AXES, motion), RBD_OK);
        for (int k = 0; k < 3; k++)
            ck_assert(fabs(row[k] + (c->gain > 0 ? c->gain : 20) * motion[3 + k]) <
                      1e-8 * (1 + largest(a, r->nv)));
    }
    ck_assert_int_eq(rbd_rnea(r->m, r->w, q, v, a, f_ext, expected), RBD_OK);
    ck_assert_msg(relative_error(tau, expected, r->nv) < 1e-9, "%g", relative_error(tau, expected, r->nv));
}

/* ---- one joint: closed forms ---- */

static const rbd_body slide[1] = {
    {.joint = "slide", .parent = -1, .type = RBD_PRISMATIC, .axis = {1, 0, 0}, .mass = 2}};

/* y of both orders, through x = y of a task that is alone. */
START_TEST(gains_are_what_the_header_says) {
    robot r = BUILD(slide);
    const double q[1] = {0.3}, v[1] = {0.7}, wanted[1] = {1};
    for (int kind = 0; kind < 3; kind++) {
        rbd_task t = {.kind = kind == 0   ? RBD_TASK_POINT
                              : kind == 1 ? RBD_TASK_COM
                                          : RBD_TASK_POSTURE,
                      .position = {1, 0, 0},
                      .q = wanted,
                      .gain = 3,
                      .damping = 0.5};
        const double speed[1] = {0.2}, rate[1] = {0.4};
        rbd_tasks p = {.task = &t, .tasks = 1, .dt = 0.01, .motion_cost = 1e-9};
        rbd_tasks_result result;
        double x[1] = {0}, a[1], tau[1];
        if (kind < 2) t.velocity[3] = speed[0], t.acceleration[3] = rate[0];
        t.v = speed, t.a = rate;

        expect_answer(&result, move_by(&r, &p, q, x, &result), RBD_TASKS_OK);
        ck_assert(fabs(x[0] - (0.2 + 3 * 0.7)) < 1e-7);
        expect_answer(&result, push_by(&r, &p, q, v, a, NULL, tau, &result), RBD_TASKS_OK);
        ck_assert(fabs(a[0] - (0.4 + 9 * 0.7 + 3 * (0.2 - 0.7))) < 1e-7);
        ck_assert(fabs(tau[0] - 2 * a[0]) < 1e-12);
        t.damping = 0; /* critical */
        expect_answer(&result, push_by(&r, &p, q, v, a, NULL, tau, &result), RBD_TASKS_OK);
        ck_assert(fabs(a[0] - (0.4 + 9 * 0.7 + 6 * (0.2 - 0.7))) < 1e-7);
    }
    robot_free(&r);
}
END_TEST

/* A soft limit that level 0 misses stays where it is for level 1, which it would contradict if it were hard.
   */
START_TEST(soft_limits_give_way_to_the_next_level) {
    robot r = BUILD(slide);
    const double q[1] = {0}, speed[1] = {1};
    for (int side = -1; side <= 1; side += 2) {
        const rbd_task t[2] = {{.kind = RBD_TASK_POINT, .velocity = {0, 0, 0, 9. * side}},
                               {.kind = RBD_TASK_POINT, .level = 1}};
        const rbd_tasks p = {
            .task = t, .tasks = 2, .dt = 0.1, .speed = speed, .limit_weight = 3, .motion_cost = 1e-9};
        rbd_tasks_result result;
        double x[1];
        expect_answer(&result, move_by(&r, &p, q, x, &result), RBD_TASKS_OK);
        ck_assert(fabs(x[0] - 3. * side) < 1e-7 && result.level == 1); /* (x - 9)^2 + 3 (x - 1)^2 */
    }
    robot_free(&r);
}
END_TEST

/* Momentum h has no place: its rate is what is asked for, and gain times what is missed. What stands on the
   world has none. */
START_TEST(momentum_decays_by_its_gain) {
    const rbd_body bodies[2] = {{.parent = -1, .type = RBD_FIXED, .mass = 5}, slide[0]};
    robot r = BUILD(bodies);
    const double q[1] = {0.3}, v[1] = {0.7};
    const rbd_task t = {.kind = RBD_TASK_MOMENTUM,
                        .velocity = {0, 0, 0, 0.2},
                        .acceleration = {0, 0, 0, 0.4},
                        .gain = 3,
                        .damping = 2}; /* counts for places alone */
    const rbd_tasks p = {.task = &t, .tasks = 1, .dt = 0.01, .motion_cost = 1e-9};
    rbd_tasks_result result;
    double x[1] = {0}, a[1], tau[1];
    expect_answer(&result, move_by(&r, &p, q, x, &result), RBD_TASKS_OK);
    ck_assert(fabs(2 * x[0] - 0.2) < 1e-8);
    expect_answer(&result, push_by(&r, &p, q, v, a, NULL, tau, &result), RBD_TASKS_OK);
    ck_assert(fabs(2 * a[0] - (0.4 + 3 * (0.2 - 2 * 0.7))) < 1e-8);
    robot_free(&r);
}
END_TEST

/* Weights 3 and 1 share; 0 counts as 1; a higher level has nothing left; rows of the caller's are rows. */
START_TEST(weights_share_and_levels_do_not) {
    robot r = BUILD(slide);
    const double q[1] = {0}, J[2] = {1, 2}, y[2] = {1, 6}, none[1] = {0};
    rbd_task t[2] = {{.kind = RBD_TASK_POINT, .velocity = {0, 0, 0, 1}, .weight = 3},
                     {.kind = RBD_TASK_POINT, .velocity = {0, 0, 0, 5}}};
    rbd_tasks p = {.task = t, .tasks = 2, .dt = 0.01, .motion_cost = 1e-9};
    rbd_tasks_result result;
    double x[1];
    expect_answer(&result, move_by(&r, &p, q, x, &result), RBD_TASKS_OK);
    ck_assert(fabs(x[0] - 2) < 1e-8);
    t[1].level = 2;
    expect_answer(&result, move_by(&r, &p, q, x, &result), RBD_TASKS_OK);
    ck_assert(fabs(x[0] - 1) < 1e-8 && result.level == 2);
    t[0].level = 1, t[1].level = 0;
    expect_answer(&result, move_by(&r, &p, q, x, &result), RBD_TASKS_OK);
    ck_assert(fabs(x[0] - 5) < 1e-7 && result.level == 1);

    t[0] = (rbd_task){.kind = RBD_TASK_ROWS, .rows = 2, .jacobian = J, .y = y};
    p.tasks = 1;
    expect_answer(&result, move_by(&r, &p, q, x, &result), RBD_TASKS_OK);
    ck_assert(fabs(x[0] - 13. / 5) < 1e-8);

    t[0] = (rbd_task){.kind = RBD_TASK_POSTURE, .q = y, .gain = 1, .weights = none};
    expect_answer(&result, move_by(&r, &p, q, x, &result), RBD_TASKS_OK);
    ck_assert(fabs(x[0]) < 1e-12); /* it does not count */
    p.tasks = 0;
    expect_answer(&result, move_by(&r, &p, q, x, &result), RBD_TASKS_OK);
    ck_assert(fabs(x[0]) < 1e-12);
    robot_free(&r);
}
END_TEST

/* A slide is driven at its stop by 1 m/s^2 at most, and by velocities, from rest or with too much speed. In
   simulations of first and second order it does not pass the stop, but for b dt^2 / 2. */
START_TEST(a_stop_is_approached_without_a_jump) {
    rbd_body bodies[1] = {slide[0]};
    bodies[0].lower = -0.2, bodies[0].upper = 0.1, bodies[0].velocity = 0.3;
    robot r = BUILD(bodies);
    const rbd_task t = {
        .kind = RBD_TASK_POINT, .velocity = {0, 0, 0, 9}, .acceleration = {0, 0, 0, 9}, .gain = 0};
    const double dt = 1e-3, most[1] = {1};
    for (int k = 0; k < 8; k++) {
        const int order = k & 1, second = k & 2, limited = k & 4;
        const rbd_tasks p = {
            .task = &t, .tasks = 1, .dt = dt, .braking = 1, .acceleration = limited ? most : NULL};
        double q[1] = {-0.15}, v[1] = {0}, a[1], tau[1], fastest = 0;
        for (int step = 0; step < 3000; step++) {
            rbd_tasks_result result;
            double next[1] = {v[0]};
            expect_answer(&result,
                          order ? push_by(&r, &p, q, v, a, NULL, tau, &result)
                                : move_by(&r, &p, q, next, &result),
                          RBD_TASKS_OK);
            if (order) next[0] = v[0] + dt * a[0];
            ck_assert_msg(next[0] - v[0] > -(1 + 1e-9) * dt, "step %d brakes by %g", step,
                          (v[0] - next[0]) / dt);
            if (limited) ck_assert(next[0] - v[0] < (1 + 1e-9) * dt);
            q[0] += dt * (second ? (v[0] + next[0]) / 2 : next[0]);
            v[0] = next[0];
            fastest = larger(fastest, v[0]);
            ck_assert_msg(q[0] < 0.1 + (second ? 0.51 * dt * dt : 1e-12), "%g beyond", q[0] - 0.1);
        }
        ck_assert(fabs(q[0] - 0.1) < 1e-5 && fabs(fastest - 0.3) < 1e-9);
    }

    /* too fast to stop: it brakes by no more, passes, and comes back */
    const rbd_tasks p = {.task = &t, .tasks = 1, .dt = dt, .braking = 1};
    double q[1] = {0.09}, v[1] = {1}, a[1], tau[1], hardest = 0;
    for (int step = 0; step < 4000; step++) {
        rbd_tasks_result result;
        expect_answer(&result, push_by(&r, &p, q, v, a, NULL, tau, &result), RBD_TASKS_OK);
        hardest = fmin(hardest, a[0]);
        v[0] += dt * a[0], q[0] += dt * v[0];
    }
    ck_assert(fabs(hardest + 1) < 1e-9 && fabs(q[0] - 0.1) < 1e-4);
    robot_free(&r);
}
END_TEST

/* Limits of the problem stand for the model's; those of joints that follow bind their leader; some are left
   out. */
START_TEST(limits_come_from_model_or_problem) {
    rbd_body bodies[2] = {slide[0], slide[0]};
    bodies[0].velocity = 2, bodies[0].effort = 3, bodies[0].lower = -100, bodies[0].upper = 100;
    bodies[1].joint = NULL, bodies[1].mimic = "slide", bodies[1].mimic_ratio = -4, bodies[1].velocity = 4;
    robot r = BUILD(bodies);
    const rbd_task t = {.kind = RBD_TASK_POINT, .velocity = {0, 0, 0, 9}, .acceleration = {0, 0, 0, 9}};
    const double q[1] = {0}, v[1] = {0}, speed[1] = {5}, torque[1] = {17}, lower[1] = {-1e30}, upper[1] = {0};
    rbd_tasks p = {.task = &t, .tasks = 1, .dt = 0.1, .braking = 1e6, .motion_cost = 1e-9};
    rbd_tasks_result result;
    double x[1], a[1], tau[1];
    expect_answer(&result, move_by(&r, &p, q, x, &result), RBD_TASKS_OK);
    ck_assert(x[0] == 1); /* 4 / |-4| */
    expect_answer(&result, push_by(&r, &p, q, v, a, NULL, tau, &result), RBD_TASKS_OK);
    ck_assert(fabs(tau[0] - 3) < 1e-9 && fabs(a[0] - 3. / 34) < 1e-9); /* M = 2 + 16 * 2 */

    /* the joint that follows has a limit too, -4 times of which counts */
    const double efforts[4][3] = {{3, 0.5, 2}, {3, 0.9, 3}, {0, 0.9, 3.6}, {0, 0, 34. * 9}};
    for (int k = 0; k < 4; k++) {
        bodies[0].effort = efforts[k][0], bodies[1].effort = efforts[k][1];
        robot both = BUILD(bodies);
        expect_answer(&result, push_by(&both, &p, q, v, a, NULL, tau, &result), RBD_TASKS_OK);
        ck_assert(fabs(tau[0] - efforts[k][2]) < 1e-4 && fabs(tau[0] - 34 * a[0]) < 1e-9);
        robot_free(&both);
    }

    p.speed = speed, p.torque = torque;
    expect_answer(&result, move_by(&r, &p, q, x, &result), RBD_TASKS_OK);
    ck_assert(x[0] == 5);
    expect_answer(&result, push_by(&r, &p, q, v, a, NULL, tau, &result), RBD_TASKS_OK);
    ck_assert(fabs(tau[0] - 17) < 1e-9);
    p.without = RBD_WITHOUT_SPEED + RBD_WITHOUT_TORQUE;
    expect_answer(&result, move_by(&r, &p, q, x, &result), RBD_TASKS_OK);
    ck_assert(fabs(x[0] - 9) < 1e-7);
    expect_answer(&result, push_by(&r, &p, q, v, a, NULL, tau, &result), RBD_TASKS_OK);
    ck_assert(fabs(a[0] - 9) < 1e-7);

    p.lower = lower, p.upper = upper;
    expect_answer(&result, move_by(&r, &p, q, x, &result), RBD_TASKS_OK);
    ck_assert(fabs(x[0]) < 1e-12);
    p.without = RBD_WITHOUT_POSITION + RBD_WITHOUT_SPEED;
    expect_answer(&result, move_by(&r, &p, q, x, &result), RBD_TASKS_OK);
    ck_assert(fabs(x[0] - 9) < 1e-7);

    p = (rbd_tasks){.task = &t,
                    .tasks = 1,
                    .dt = 0.1,
                    .lower = lower,
                    .limit_weight = 3,
                    .without = RBD_WITHOUT_SPEED,
                    .upper = upper,
                    .motion_cost = 1e-9};
    expect_answer(&result, move_by(&r, &p, q, x, &result), RBD_TASKS_OK);
    ck_assert(fabs(x[0] - 9. / 4) < 1e-7); /* soft: (x - 9)^2 + 3 x^2 */
    p = (rbd_tasks){.task = &t, .tasks = 1, .dt = 0.1, .torque_weight = 1, .motion_cost = 1e-9};
    expect_answer(&result, push_by(&r, &p, q, v, a, NULL, tau, &result), RBD_TASKS_OK);
    ck_assert(fabs(a[0] - (9 + 34. * 3) / (1 + 34. * 34)) < 1e-7); /* (a - 9)^2 + (34 a - 3)^2 */
    robot_free(&r);
}
END_TEST

/* A limit of 0 is none, though the model has one; so is the side that is not given. */
START_TEST(zeros_and_missing_sides_are_no_limits) {
    rbd_body bodies[1] = {slide[0]};
    bodies[0].velocity = 2, bodies[0].effort = 3, bodies[0].lower = -0.01, bodies[0].upper = 0.01;
    robot r = BUILD(bodies);
    const rbd_task t = {.kind = RBD_TASK_POINT, .velocity = {0, 0, 0, 9}, .acceleration = {0, 0, 0, 9}};
    const double q[1] = {0}, v[1] = {0}, none[1] = {0}, lower[1] = {-0.01}, upper[1] = {0.01};
    const rbd_tasks p = {.task = &t,
                         .tasks = 1,
                         .dt = 0.1,
                         .speed = none,
                         .torque = none,
                         .acceleration = none,
                         .lower = lower,
                         .motion_cost = 1e-9};
    rbd_tasks other = p;
    rbd_task back = t;
    rbd_tasks_result result;
    double x[1] = {0}, a[1], tau[1];
    expect_answer(&result, move_by(&r, &p, q, x, &result), RBD_TASKS_OK);
    ck_assert(fabs(x[0] - 9) < 1e-7);
    expect_answer(&result, push_by(&r, &p, q, v, a, NULL, tau, &result), RBD_TASKS_OK);
    ck_assert(fabs(a[0] - 9) < 1e-7 && fabs(tau[0] - 18) < 1e-7);

    back.velocity[3] = -9;
    other.task = &back, other.lower = NULL, other.upper = upper;
    expect_answer(&result, move_by(&r, &other, q, x, &result), RBD_TASKS_OK);
    ck_assert(fabs(x[0] + 9) < 1e-7);
    robot_free(&r);
}
END_TEST

/* A slide that is held and drawn by 10 N: its motor gives 10 - f, softly 1 at most, and f costs something. */
START_TEST(forces_cost_what_the_problem_says) {
    robot r = BUILD(slide);
    const double q[1] = {0}, v[1] = {0}, torque[1] = {1}, drawn[6] = {0, 0, 0, -10, 0, 0};
    double a[1], f[3], tau[1];
    rbd_tasks_result result;
    for (int own = 0; own < 2; own++) {
        const rbd_task_contact c = {.normal = {1, 0, 0}, .cost = own ? 0.5 : 0};
        const rbd_tasks p = {.contact = &c,
                             .contacts = 1,
                             .dt = 0.1,
                             .torque = torque,
                             .torque_weight = 3,
                             .force_cost = own ? 7 : 0.5,
                             .f_ext = drawn};
        expect_answer(&result, push_by(&r, &p, q, v, a, f, tau, &result), RBD_TASKS_OK);
        ck_assert(fabs(f[0] - 9 * 3 / 3.5) < 1e-9 && fabs(tau[0] - (10 - f[0])) < 1e-9); /* least of
                                                                        0.5 f^2 + 3 (9 - f)^2 */
    }
    robot_free(&r);
}
END_TEST

/* The ground pushes along its normal, whichever axis that is. */
START_TEST(a_normal_may_be_any_axis) {
    robot r = BUILD(slide);
    const double q[1] = {0}, v[1] = {0};
    for (int k = 0; k < 6; k++) {
        rbd_task_contact c = {.least = 5};
        const rbd_tasks p = {.contact = &c, .contacts = 1, .dt = 0.1};
        double a[1], f[3], tau[1];
        rbd_tasks_result result;
        c.normal[k % 3] = k < 3 ? 2 : -2;
        expect_answer(&result, push_by(&r, &p, q, v, a, f, tau, &result), RBD_TASKS_OK);
        for (int i = 0; i < 3; i++) ck_assert(fabs(f[i] - (i == k % 3 ? k < 3 ? 5 : -5 : 0)) < 1e-9);
    }
    robot_free(&r);
}
END_TEST

/* Limits so far away that the way back overflows what a tick can do: the answer is not called exact. */
START_TEST(answers_beyond_all_measure_are_inexact) {
    const rbd_body bodies[2] = {
        {.joint = "a", .parent = -1, .type = RBD_PRISMATIC, .axis = {1, 0, 0}, .mass = 2},
        {.joint = "b", .parent = 0, .type = RBD_PRISMATIC, .axis = {0, 1, 0}, .mass = 1}};
    robot r = BUILD(bodies);
    const double q[2] = {0}, lower[2] = {1e20, 1e20}, upper[2] = {1e29, 1e29};
    double x[2] = {0};
    rbd_tasks_result result;
    const rbd_tasks p = {.dt = 1, .lower = lower, .upper = upper};
    expect_answer(&result, move_by(&r, &p, q, x, &result), RBD_TASKS_INEXACT);
    ck_assert(x[0] > 1e9 && x[0] < 1e11 && result.qp == RBD_QP_INACCURATE && result.primal < 1e-12);
    robot_free(&r);
}
END_TEST

/* The squares of two thousand rows of 1e9, by a weight of 1e9, are no number that the QP takes. */
START_TEST(squares_without_measure_are_an_error) {
    enum { ROWS = 1000 };
    static double J[ROWS], y[ROWS];
    robot r = BUILD(slide);
    const rbd_task once = {.kind = RBD_TASK_ROWS, .rows = ROWS, .jacobian = J, .y = y, .weight = 1e9};
    const rbd_task t[2] = {once, once};
    const rbd_tasks p = {.task = t, .tasks = 2, .dt = 1};
    const double q[1] = {0};
    double x[1] = {7};
    rbd_tasks_result result;
    for (int i = 0; i < ROWS; i++) J[i] = 1e9;
    expect_answer(&result, move_by(&r, &p, q, x, &result), RBD_TASKS_ERROR);
    ck_assert(result.error == RBD_ERR_NAN && result.qp == RBD_QP_NAN && x[0] == 7);
    robot_free(&r);
}
END_TEST

/* ---- random trees ---- */

/* Contacts anywhere, any joints: an answer satisfies the dynamics. A robot at rest with motors has one. */
static int solved;
static void check_tree(const robot *r, const state *s, int number) {
    uint64_t seed = (uint64_t)number * 77 + (uint64_t)r->nb;
    const int rests = number % 2;
    const unsigned char none[MAX_V] = {0};
    const double zero[MAX_V] = {0}, *v = rests ? zero : s->v;
    rbd_task_contact c[3] = {{0}};
    const rbd_task t[2] = {
        {.kind = RBD_TASK_POSE, .body = below(&seed, r->nb), .gain = 3, .position = {0, 1, 0}},
        {.kind = RBD_TASK_POSTURE, .q = s->q, .gain = 2, .level = number % 4 / 2}};
    const rbd_tasks p = {.task = t,
                         .tasks = 2,
                         .contact = c,
                         .contacts = 3,
                         .dt = 0.01,
                         .without = RBD_WITHOUT_POSITION + RBD_WITHOUT_SPEED + RBD_WITHOUT_TORQUE,
                         .passive = rests ? none : NULL,
                         .motion_cost = 1e-3};
    rbd_tasks_result result;
    double a[MAX_V], f[9], tau[MAX_V];
    for (int i = 0; i < 3; i++) {
        c[i].body = below(&seed, r->nb), c[i].friction = uniform(&seed, 0.1, 1), c[i].sides = i == 1 ? 8 : 4;
        c[i].open = i == 2 && number % 3;
        for (int k = 0; k < 3; k++)
            c[i].point[k] = uniform(&seed, -1, 1), c[i].normal[k] = uniform(&seed, -1, 1);
        c[i].gain = uniform(&seed, 1, 30);
    }
    const rbd_tasks_status status = push_by(r, &p, s->q, v, a, f, tau, &result);
    if (rests || status != RBD_TASKS_INFEASIBLE) expect_answer(&result, status, RBD_TASKS_OK);
    solved += status == RBD_TASKS_OK;
    if (status == RBD_TASKS_OK) expect_dynamics(r, &p, s->q, v, a, f, tau);
}

START_TEST(answers_satisfy_the_dynamics_of_random_trees) {
    solved = 0;
    for_random_trees(150, check_tree);
    ck_assert_int_ge(solved, OF_TREES(150) + OF_TREES(20));
}
END_TEST

/* ---- HyQ ---- */

/* HyQ on z = 0, at q; its feet. */
static void stand(const robot *r, double *q, rbd_task_contact *feet) {
    double p[3];
    ck_assert_int_eq(rbd_neutral(r->m, q), RBD_OK);
    memset(feet, 0, FEET * sizeof *feet);
    for (int i = 0; i < FEET; i++) {
        q[HYQ_Q_LF_HFE_JOINT + i] = i < 2 ? 0.7 : -0.7;
        q[HYQ_Q_LF_KFE_JOINT + i] = i < 2 ? -1.4 : 1.4;
        feet[i].body = HYQ_BODY_LF_LOWERLEG + i;
        feet[i].point[0] = toe[0];
        feet[i].friction = mu;
    }
    ck_assert_int_eq(rbd_kinematics(r->m, r->w, q, NULL, NULL), RBD_OK);
    ck_assert_int_eq(rbd_point_position(r->m, r->w, feet[0].body, toe, p), RBD_OK);
    q[HYQ_Q_ROOT_Z] -= p[2];
}

/* A task that holds the trunk where it is at q. */
static rbd_task hold_trunk(const robot *r, const double *q) {
    rbd_task t = {.kind = RBD_TASK_POSE, .body = HYQ_BODY_BASE_LINK_0, .gain = 10};
    double R[9];
    ck_assert_int_eq(rbd_kinematics(r->m, r->w, q, NULL, NULL), RBD_OK);
    ck_assert_int_eq(rbd_body_pose(r->m, r->w, t.body, R, t.position), RBD_OK);
    memcpy(t.rotation, R, sizeof R);
    return t;
}

/* Without contacts the centre of mass falls with g, whatever the joints are asked to do. */
START_TEST(a_robot_in_the_air_falls) {
    robot r = robot_build("hyq", hyq_bodies, HYQ_NB);
    uint64_t seed = 1;
    for (int k = 0; k < 20; k++) {
        state s;
        double a[MAX_V], tau[MAX_V], f[3 * FEET], com[3], home[MAX_Q];
        rbd_task_contact feet[FEET];
        rbd_tasks_result result;
        stand(&r, home, feet);
        for (int i = 0; i < FEET; i++) feet[i].open = 1;
        draw_state(&r, &seed, &s);
        const rbd_task t[2] = {hold_trunk(&r, home), {.kind = RBD_TASK_POSTURE, .q = home, .gain = 5}};
        const rbd_tasks p = {.task = t,
                             .tasks = 2,
                             .contact = feet,
                             .contacts = k % 2 ? FEET : 0,
                             .dt = 1e-3,
                             .without = RBD_WITHOUT_POSITION + RBD_WITHOUT_TORQUE};
        expect_answer(&result, push_by(&r, &p, s.q, s.v, a, f, tau, &result), RBD_TASKS_OK);
        expect_dynamics(&r, &p, s.q, s.v, a, f, tau);
        ck_assert_int_eq(rbd_kinematics(r.m, r.w, s.q, s.v, a), RBD_OK);
        ck_assert_int_eq(rbd_com(r.m, r.w, NULL, NULL, com), RBD_OK);
        expect_close("com", &r, k, com, s.gravity, 3, 1e-9);
    }
    robot_free(&r);
}
END_TEST

/* It stands: forces bear the weight, torques are those of inverse dynamics, and three feet do as well. */
START_TEST(feet_bear_the_weight) {
    robot r = robot_build("hyq", hyq_bodies, HYQ_NB);
    double q[MAX_Q], v[MAX_V] = {0}, a[MAX_V], tau[MAX_V], f[3 * FEET];
    rbd_task_contact feet[FEET];
    rbd_tasks_result result;
    stand(&r, q, feet);
    for (int k = 0; k < 3; k++) {
        const rbd_task t[2] = {hold_trunk(&r, q),
                               {.kind = RBD_TASK_POSTURE, .q = q, .gain = 10, .weight = 1e-3}};
        const rbd_tasks p = {
            .task = t, .tasks = 2, .contact = feet, .contacts = FEET, .dt = 1e-3, .motion_cost = 1e-9};
        double sum[3] = {0};
        feet[1].open = k == 1;
        feet[2].cost = k == 2 ? 1 : 0;
        expect_answer(&result, push_by(&r, &p, q, v, a, f, tau, &result), RBD_TASKS_OK);
        expect_dynamics(&r, &p, q, v, a, f, tau);
        for (int i = 0; i < FEET; i++)
            for (int d = 0; d < 3; d++) sum[d] += f[3 * i + d];
        if (k == 0) ck_assert(fabs(sum[2] - 9.81 * rbd_mass(r.m)) < 1e-4 && hypot(sum[0], sum[1]) < 1e-4);
        if (k == 0) ck_assert(largest(a, r.nv) < 1e-5);
        if (k == 2) ck_assert(f[8] < 5 && f[2] > 100); /* the foot that costs is spared */
    }
    robot_free(&r);
}
END_TEST

/* Feet on slopes: each pushes within the cone about its own normal, whatever the normal's length, and some
   forces lie on a cone. */
START_TEST(feet_push_along_their_normals) {
    robot r = robot_build("hyq", hyq_bodies, HYQ_NB);
    double q[MAX_Q], v[MAX_V] = {0}, a[MAX_V], tau[MAX_V], f[3 * FEET];
    rbd_task_contact feet[FEET];
    rbd_tasks_result result;
    stand(&r, q, feet);
    const rbd_task t[2] = {hold_trunk(&r, q), {.kind = RBD_TASK_POSTURE, .q = q, .gain = 10, .weight = 1e-3}};
    const rbd_tasks p = {.task = t, .tasks = 2, .contact = feet, .contacts = FEET, .dt = 1e-3};
    for (int k = 0; k < 4; k++) {
        int steep = 0;
        for (int i = 0; i < FEET; i++) {
            feet[i].normal[0] = k * (i == 0  ? 0
                                     : i < 2 ? 0.1
                                             : -0.2),
            feet[i].normal[1] = k * (i % 2 ? 0.15 : -0.1);
            feet[i].normal[2] = 0.5 + i, feet[i].least = 30, feet[i].friction = 0.2;
            feet[i].sides = k % 2 ? 4 : 8;
        }
        expect_answer(&result, push_by(&r, &p, q, v, a, f, tau, &result), RBD_TASKS_OK);
        expect_dynamics(&r, &p, q, v, a, f, tau);
        for (int i = 0; i < FEET; i++) {
            const double *n = feet[i].normal;
            const double normal = dot(&f[3 * i], n, 3) / sqrt(dot(n, n, 3));
            const double slope = sqrt(larger(0, dot(&f[3 * i], &f[3 * i], 3) - normal * normal));
            steep += slope > 0.69 * 0.2 * normal; /* at least cos(pi / 4) of mu where a side holds */
        }
        ck_assert_int_ge(steep, k < 2 ? 0 : 1);
    }
    robot_free(&r);
}
END_TEST

/* Pushed by 400 N for a tenth of a second on a floor with mu = 0.4, in rbd_contact_step: no foot slips, and
   the trunk comes back. */
START_TEST(a_pushed_robot_keeps_its_feet) {
    robot r = robot_build("hyq", hyq_bodies, HYQ_NB), plant = robot_build("hyq", hyq_bodies, HYQ_NB);
    double q[MAX_Q], home[MAX_Q], v[MAX_V] = {0}, a[MAX_V], tau[MAX_V], f[3 * FEET], p0[FEET][3], p[3],
                                  far = 0;
    rbd_task_contact feet[FEET];
    rbd_contact ground[FEET] = {{0}};
    rbd_contact_set *set;
    rbd_tasks_result result;
    stand(&r, home, feet);
    ck_assert_int_eq(rbd_kinematics(r.m, r.w, home, NULL, NULL), RBD_OK);
    for (int i = 0; i < FEET; i++) {
        feet[i].friction = 0.9 * mu, feet[i].least = LEAST, feet[i].most = 1500;
        ground[i] = (rbd_contact){.body1 = feet[i].body, .body2 = -1, .point = {0.33, 0, 0}, .friction = mu};
        ck_assert_int_eq(rbd_point_position(r.m, r.w, feet[i].body, toe, p0[i]), RBD_OK);
    }
    const size_t size = rbd_contact_set_size(plant.m, FEET, NULL, 0, NULL);
    void *memory = malloc(size);
    ck_assert_int_eq(
        rbd_contact_set_init(plant.m, plant.w, ground, FEET, NULL, 0, NULL, memory, size, &set, NULL),
        RBD_OK);

    const rbd_task t[2] = {hold_trunk(&r, home),
                           {.kind = RBD_TASK_POSTURE, .q = home, .gain = 10, .weight = 1e-4}};
    rbd_tasks problem = {.task = t, .tasks = 2, .contact = feet, .contacts = FEET, .dt = 1e-3};
    const size_t needed = rbd_tasks_size(r.m, &problem);
    void *kept = malloc(needed);
    int steps = 0;
    memcpy(q, home, sizeof q);
    for (int step = 0; step < 1500; step++) {
        double push[6 * HYQ_NB] = {0};
        if (step >= 100 && step < 200) push[4] = 400;
        const rbd_tasks_status status =
            rbd_tasks_acceleration(r.m, r.w, &problem, q, v, kept, needed, a, f, tau, &result);
        expect_answer(&result, status, RBD_TASKS_OK);
        expect_dynamics(&r, &problem, q, v, a, f, tau);
        for (int i = 0; i < r.nv; i++) ck_assert(i < 6 ? tau[i] == 0 : fabs(tau[i]) < 150 + 1e-6);
        problem.warm = 1;
        steps += result.steps;
        ck_assert_int_eq(rbd_contact_step(plant.m, set, q, v, tau, push, NULL, 1e-3, q, v), RBD_OK);
        ck_assert_int_eq(rbd_kinematics(r.m, r.w, q, NULL, NULL), RBD_OK);
        for (int i = 0; i < FEET; i++) {
            ck_assert_int_eq(rbd_point_position(r.m, r.w, feet[i].body, toe, p), RBD_OK);
            ck_assert(hypot(p[0] - p0[i][0], p[1] - p0[i][1]) < 1e-4);
        }
        far = larger(far, fabs(q[HYQ_Q_ROOT_Y] - home[HYQ_Q_ROOT_Y]));
    }
    ck_assert(far > 0.01 && far < 0.05 && fabs(q[HYQ_Q_ROOT_Y] - home[HYQ_Q_ROOT_Y]) < 1e-4);
    ck_assert_int_lt(steps, 300); /* warm: a few rows change */
    free(kept), free(memory), robot_free(&r), robot_free(&plant);
}
END_TEST

/* Warm or cold, in any order of tasks, the answer is the same. */
START_TEST(the_answer_depends_on_the_problem_alone) {
    robot r = robot_build("hyq", hyq_bodies, HYQ_NB);
    double q[MAX_Q], v[MAX_V] = {0}, x[3][MAX_V], tau[MAX_V], f[3 * FEET];
    rbd_task_contact feet[FEET];
    rbd_tasks_result result;
    stand(&r, q, feet);
    for (int i = 0; i < FEET; i++) feet[i].least = 1;
    rbd_task t[3] = {hold_trunk(&r, q),
                     {.kind = RBD_TASK_POSTURE, .q = q, .gain = 10, .weight = 1e-2},
                     {.kind = RBD_TASK_MOMENTUM, .gain = 3, .weight = 1e-2}};
    for (int k = 0; k < 3; k++) t[0].position[k] += 0.05 * (k - 1); /* with limits that hold */
    t[2].level = _i;
    rbd_tasks p = {.task = t, .tasks = 3, .contact = feet, .contacts = FEET, .dt = 1e-3};
    const size_t size = rbd_tasks_size(r.m, &p);
    void *memory = malloc(size);
    for (int k = 0; k < 3; k++) {
        const rbd_task first = t[0];
        p.warm = k == 1;
        if (k == 2) t[0] = t[2], t[2] = first;
        expect_answer(&result,
                      rbd_tasks_acceleration(r.m, r.w, &p, q, v, memory, size, x[k], f, tau, &result),
                      RBD_TASKS_OK);
        if (k == 1) ck_assert_int_le(result.steps, 2 * (1 + _i));
    }
    ck_assert(relative_error(x[1], x[0], r.nv) < 1e-7 && relative_error(x[2], x[0], r.nv) < 1e-7);
    free(memory), robot_free(&r);
}
END_TEST

/* Nor do the memory's old bytes: a cold tick of one level, then a warm one of two, whose second has no guess
   yet. */
START_TEST(old_bytes_of_the_memory_do_not_count) {
    robot r = robot_build("hyq", hyq_bodies, HYQ_NB);
    double q[MAX_Q], v[MAX_V] = {0}, x[3][MAX_V], tau[MAX_V], f[3 * FEET];
    int steps[3];
    rbd_task_contact feet[FEET];
    rbd_tasks_result result;
    stand(&r, q, feet);
    rbd_task t[2] = {hold_trunk(&r, q), {.kind = RBD_TASK_POSTURE, .q = q, .gain = 10}};
    for (int k = 0; k < 3; k++) t[0].position[k] += 0.05 * (k - 1); /* with limits that hold */
    rbd_tasks p = {.task = t, .tasks = 2, .contact = feet, .contacts = FEET, .dt = 1e-3};
    const size_t size = rbd_tasks_size(r.m, &p);
    unsigned char *memory = malloc(size);
    for (int k = 0; k < 3; k++) {
        memset(memory, k == 0 ? 0 : k == 1 ? 1 : 0xff, size);
        for (int warm = 0; warm < 2; warm++) {
            p.warm = warm;
            t[1].level = warm;
            expect_answer(&result,
                          rbd_tasks_acceleration(r.m, r.w, &p, q, v, memory, size, x[k], f, tau, &result),
                          RBD_TASKS_OK);
        }
        steps[k] = result.steps;
        ck_assert(steps[k] == steps[0] && !memcmp(x[k], x[0], sizeof(double) * (size_t)r.nv));
    }
    free(memory), robot_free(&r);
}
END_TEST

/* Too few steps leave an answer that is not the best, and say so; of a next level the one before stands. */
START_TEST(work_is_bounded) {
    robot r = robot_build("hyq", hyq_bodies, HYQ_NB);
    double q[MAX_Q], v[MAX_V] = {0}, a[MAX_V], tau[MAX_V], f[3 * FEET];
    rbd_task_contact feet[FEET];
    rbd_tasks_result result;
    stand(&r, q, feet);
    for (int i = 0; i < FEET; i++) feet[i].least = 1;
    rbd_task t[2] = {{.kind = RBD_TASK_COM, .acceleration = {0, 0, 0, 50, 50, 50}},
                     {.kind = RBD_TASK_MOMENTUM, .acceleration = {900, 900}, .level = 1}};
    rbd_tasks p = {.task = t, .tasks = 2, .contact = feet, .contacts = FEET, .dt = 1e-3, .steps = 1};
    expect_answer(&result, push_by(&r, &p, q, v, a, f, tau, &result), RBD_TASKS_INEXACT);
    ck_assert(result.qp == RBD_QP_ITERATIONS && result.level == 0 && result.primal > 1e-6);
    ck_assert(largest(a, r.nv) < 1e9 && largest(f, 3 * FEET) < 1e9 && largest(tau, r.nv) < 1e9);

    t[0].level = 0, t[0].weight = 0, memset(t[0].acceleration, 0, sizeof t[0].acceleration);
    expect_answer(&result, push_by(&r, &p, q, v, a, f, tau, &result), RBD_TASKS_INEXACT);
    ck_assert(result.qp == RBD_QP_ITERATIONS && result.level == 1);
    expect_dynamics(&r, &p, q, v, a, f, tau);

    /* the answer is that of level 0 alone, and so is what the result says of it */
    const double primal = result.primal, dual = result.dual;
    double alone[MAX_V];
    p.tasks = 1;
    expect_answer(&result, push_by(&r, &p, q, v, alone, f, tau, &result), RBD_TASKS_OK);
    ck_assert(memcmp(a, alone, (size_t)r.nv * sizeof *a) == 0);
    ck_assert(primal == result.primal && primal < 1e-7 && dual == result.dual && dual < 1e-7);
    p.tasks = 2;
    p.steps = 0;
    expect_answer(&result, push_by(&r, &p, q, v, a, f, tau, &result), RBD_TASKS_OK);
    ck_assert_int_gt(result.steps, 2);
    robot_free(&r);
}
END_TEST

/* Nothing that moves: nothing to do. */
START_TEST(a_robot_without_joints_has_an_answer) {
    static const rbd_body fixed[1] = {{.parent = -1, .type = RBD_FIXED, .mass = 1}};
    robot r = BUILD(fixed);
    const rbd_task t = {.kind = RBD_TASK_POSE};
    const rbd_tasks p = {.task = &t, .tasks = 1, .dt = 1e-3};
    double x[1] = {7};
    rbd_tasks_result result;
    expect_answer(&result, move_by(&r, &p, x, x, &result), RBD_TASKS_OK);
    ck_assert(x[0] == 7);
    robot_free(&r);
}
END_TEST

/* Each kind of task alone is reached in a closed loop of velocities and of accelerations. */
START_TEST(tasks_are_reached) {
    robot r = robot_build("hyq", hyq_bodies, HYQ_NB);
    uint64_t seed = 3;
    for (int k = 0; k < 2 * RBD_TASK_POSTURE; k++) {
        const int order = k % 2, kind = k / 2 + 1;
        const double dt = order ? 2e-3 : 2e-2;
        double q[MAX_Q], v[MAX_V] = {0}, a[MAX_V], tau[MAX_V], there[MAX_Q], R[9] = {0}, S[9], p[3] = {0},
                         h[6];
        rbd_task t = {.kind = (rbd_task_kind)kind,
                      .gain = 10,
                      .body = HYQ_BODY_LF_LOWERLEG,
                      .point = {0.33, 0, 0},
                      .reference = HYQ_BODY_RH_LOWERLEG,
                      .axis = {1, 2, 3},
                      .q = there};
        if (kind == RBD_TASK_MOMENTUM && !order) continue;
        rbd_random(r.m, &seed, q);
        rbd_random(r.m, &seed, there);
        memcpy(there, q, 3 * sizeof *q);
        for (int i = 3; i < r.nq; i++) there[i] = q[i] + 0.2 * there[i];
        ck_assert_int_eq(rbd_kinematics(r.m, r.w, there, NULL, NULL), RBD_OK);
        if (kind == RBD_TASK_COM) rbd_com(r.m, r.w, t.position, NULL, NULL);
        if (kind < RBD_TASK_COM || kind == RBD_TASK_RELATIVE) {
            rbd_body_pose(r.m, r.w, t.body, R, NULL),
                rbd_point_position(r.m, r.w, t.body, t.point, t.position);
            memcpy(t.rotation, R, sizeof R);
            multiply(R, t.axis, 3, 3, t.direction);
        }
        if (kind == RBD_TASK_RELATIVE) {
            rbd_body_pose(r.m, r.w, t.reference, S, p);
            for (int i = 0; i < 3; i++) p[i] = t.position[i] - p[i];
            for (int i = 0; i < 9; i++) t.rotation[i] = 0;
            for (int i = 0; i < 3; i++) {
                t.position[i] = S[i] * p[0] + S[3 + i] * p[1] + S[6 + i] * p[2];
                for (int j = 0; j < 9; j++)
                    t.rotation[3 * i + j % 3] += S[3 * (j / 3) + i] * R[3 * (j / 3) + j % 3];
            }
        }
        unsigned char none[MAX_V] = {0};
        const rbd_tasks problem = {.task = &t,
                                   .tasks = 1,
                                   .dt = dt,
                                   .passive = none,
                                   .without = RBD_WITHOUT_POSITION + RBD_WITHOUT_SPEED + RBD_WITHOUT_TORQUE};
        for (int step = 0; step < (order ? 1000 : 200); step++) {
            rbd_tasks_result result;
            expect_answer(&result,
                          order ? push_by(&r, &problem, q, v, a, NULL, tau, &result)
                                : move_by(&r, &problem, q, v, &result),
                          RBD_TASKS_OK);
            if (order)
                rbd_step(r.m, q, v, a, dt, q, v);
            else
                rbd_integrate(r.m, q, v, dt, q);
        }

        double error = 0;
        ck_assert_int_eq(rbd_kinematics(r.m, r.w, q, v, NULL), RBD_OK);
        rbd_momentum(r.m, r.w, h, NULL);
        if (kind == RBD_TASK_MOMENTUM) error = largest(h, 6);
        if (kind == RBD_TASK_COM) rbd_com(r.m, r.w, p, NULL, NULL);
        if (kind == RBD_TASK_POINT || kind == RBD_TASK_POSE) rbd_point_position(r.m, r.w, t.body, t.point, p);
        if (kind == RBD_TASK_POSTURE) rbd_distance(r.m, q, there, NULL, &error);
        if (kind < RBD_TASK_COM || kind == RBD_TASK_RELATIVE) rbd_body_pose(r.m, r.w, t.body, R, NULL);
        if (kind == RBD_TASK_RELATIVE) {
            double o[3], B[9];
            memcpy(B, R, sizeof B);
            rbd_body_pose(r.m, r.w, t.reference, S, o), rbd_point_position(r.m, r.w, t.body, t.point, h);
            for (int i = 0; i < 3; i++) {
                p[i] = 0;
                for (int j = 0; j < 3; j++) {
                    p[i] += S[3 * j + i] * (h[j] - o[j]);
                    R[3 * i + j] = S[i] * B[j] + S[3 + i] * B[3 + j] + S[6 + i] * B[6 + j];
                }
            }
        }
        for (int i = 0; i < 3; i++) {
            if (kind == RBD_TASK_AXIS)
                error = larger(error, fabs(dot(&R[3 * i], t.axis, 3) - t.direction[i]));
            if (kind != RBD_TASK_AXIS && kind != RBD_TASK_ROTATION && kind != RBD_TASK_MOMENTUM &&
                kind != RBD_TASK_POSTURE)
                error = larger(error, fabs(p[i] - t.position[i]));
        }
        for (int i = 0; i < 9; i++)
            if (kind == RBD_TASK_POSE || kind == RBD_TASK_ROTATION || kind == RBD_TASK_RELATIVE)
                error = larger(error, fabs(R[i] - t.rotation[i]));
        ck_assert_msg(error < (kind == RBD_TASK_MOMENTUM ? 1e-3 : 1e-5), "kind %d, order %d: %g", kind, order,
                      error);
    }
    robot_free(&r);
}
END_TEST

/* A point on a joint's axis stays: its rows are zero but for rounding, and must not bind the next level. */
START_TEST(rounding_is_not_held_for_the_next_level) {
    static const rbd_body bodies[1] = {{.parent = -1,
                                        .type = RBD_REVOLUTE,
                                        .axis = {0.3, 0.5, 0.7},
                                        .position = {0.1, 0.7, 0.3},
                                        .mass = 1}};
    robot r = BUILD(bodies);
    const double wanted[1] = {0.7};
    for (int k = 0; k < 100; k++) {
        const double q[1] = {0.1 + 0.37 * k}, far = 0.1 + 0.01 * k;
        const rbd_task t[2] = {{.kind = RBD_TASK_POINT, .point = {0.3 * far, 0.5 * far, 0.7 * far}},
                               {.kind = RBD_TASK_POSTURE, .q = q, .v = wanted, .level = 1}};
        const rbd_tasks p = {.task = t, .tasks = 2, .dt = 0.01, .motion_cost = 1e-9};
        rbd_tasks_result result;
        double x[1] = {0};
        expect_answer(&result, move_by(&r, &p, q, x, &result), RBD_TASKS_OK);
        ck_assert_msg(fabs(x[0] - wanted[0]) < 1e-7, "state %d: %g", k, x[0]);
    }
    robot_free(&r);
}
END_TEST

/* A task of level 1 leaves one of level 0 as it is, to 1e-8, though it moves what is left; loose rows are
   left. */
START_TEST(a_level_never_worsens_the_one_before) {
    robot r = robot_build("hyq", hyq_bodies, HYQ_NB);
    uint64_t seed = 5;
    int moved = 0;
    for (int k = 0; k < 30; k++) {
        state s;
        double x[2][MAX_V] = {{0}}, a[2][6], tau[MAX_V], f[3 * FEET];
        rbd_task_contact feet[FEET];
        rbd_tasks_result result;
        draw_state(&r, &seed, &s);
        stand(&r, s.q, feet);
        for (int i = 0; i < r.nv; i++) s.v[i] *= 0.1;
        rbd_task t[3] = {
            {.kind = RBD_TASK_POINT, .gain = 5, .position = {0.3, 0.1, 0.5}, .loose = {0, 0, 0, 0, 0, 1}},
            {.kind = RBD_TASK_AXIS, .gain = 5, .axis = {0, 0, 1}, .direction = {0.1, 0, 1}, .level = 1},
            {.kind = RBD_TASK_MOMENTUM, .gain = 5, .level = 2}};
        rbd_tasks p = {.task = t, .tasks = 1, .contact = feet, .contacts = FEET, .dt = 1e-3};
        for (int n = 1; n <= 3; n += 2) {
            double *to = x[n / 2];
            p.tasks = n;
            expect_answer(&result,
                          k % 2 ? push_by(&r, &p, s.q, s.v, to, f, tau, &result)
                                : move_by(&r, &p, s.q, to, &result),
                          RBD_TASKS_OK);
            ck_assert_int_eq(rbd_kinematics(r.m, r.w, s.q, k % 2 ? s.v : to, k % 2 ? to : NULL), RBD_OK);
            if (k % 2)
                rbd_point_acceleration(r.m, r.w, 0, NULL, RBD_WORLD_AXES, a[n / 2]);
            else
                rbd_point_velocity(r.m, r.w, 0, NULL, RBD_WORLD_AXES, a[n / 2]);
        }
        for (int i = 3; i < 5; i++) ck_assert(fabs(a[1][i] - a[0][i]) < 1e-8 * (1 + fabs(a[0][i])));
        moved += fabs(a[1][5] - a[0][5]) > 1e-3 || fabs(a[1][0] - a[0][0]) > 1e-3;
    }
    ck_assert_int_ge(moved, 20);
    robot_free(&r);
}
END_TEST

/* ---- an arm on a circle ---- */

/* Damped least squares for a velocity of a point, clamped: what controllers do without a QP. */
static void damped(const double *J, const double *v, double *x) {
    double A[3][4];
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) A[i][j] = (i == j ? 1e-4 : 0) + dot(&J[7 * i], &J[7 * j], 7);
        A[i][3] = v[i];
    }
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 3; i++)
            for (int j = 3; j >= k && i != k; j--) A[i][j] -= A[i][k] / A[k][k] * A[k][j];
    for (int k = 0; k < 7; k++) {
        x[k] = 0;
        for (int i = 0; i < 3; i++) x[k] += J[7 * i + k] * A[i][3] / A[i][i];
        x[k] = fmin(fmax(x[k], -1.5), 1.5);
    }
}

/* The tool of an iiwa follows a circle in the plane of the arm. by_tasks: or by damped least squares.
   Returns the worst error; *mean: in the mean. */
static double follow(const robot *r, double beyond, const double *lower, const double *upper, int by_tasks,
                     double *mean) {
    const double dt = 2e-3, speed[7] = {1.5, 1.5, 1.5, 1.5, 1.5, 1.5, 1.5}, zero[7] = {0};
    double q[7] = {0, 0.5, 0, -1.4, 0, 1.2, 0}, v[7], p[3], top[3], shoulder[3], centre[3], worst = 0,
           sum = 0;
    rbd_task t[2] = {{.kind = RBD_TASK_POINT, .body = 6, .point = {0, 0, 0.15}, .gain = 20},
                     {.kind = RBD_TASK_POSTURE, .q = zero, .gain = 0.5, .level = 1}};
    rbd_tasks problem = {
        .task = t, .tasks = 2, .dt = dt, .lower = lower, .upper = upper, .speed = speed, .braking = 30};
    const double radius = beyond > -1 ? 0.25 : 0.2;
    int count = 0;
    rbd_kinematics(r->m, r->w, zero, NULL, NULL);
    rbd_point_position(r->m, r->w, 6, tool, top);
    rbd_body_pose(r->m, r->w, 1, NULL, shoulder);
    rbd_kinematics(r->m, r->w, q, NULL, NULL);
    rbd_point_position(r->m, r->w, 6, tool, centre);
    double x = centre[0], z = centre[2] - shoulder[2];
    const double d = hypot(x, z), reach = top[2] - shoulder[2];
    x /= d, z /= d;
    if (beyond > -1)
        centre[0] = x * (reach - radius + beyond), centre[2] = shoulder[2] + z * (reach - radius + beyond);

    for (int step = 0; step < 4000; step++) {
        const double time = step * dt - 2, phase = time < 0 ? 0 : 2 * pi * time / 6,
                     rate = time < 0 ? 0 : 2 * pi / 6;
        double J[42], wanted[3], error = 0;
        for (int i = 0; i < 3; i++) {
            const double along = i == 0 ? x : i == 2 ? z : 0, across = i == 1;
            t[0].position[i] = centre[i] + radius * (across * sin(phase) - along * cos(phase));
            t[0].velocity[3 + i] = radius * rate * (across * cos(phase) + along * sin(phase));
        }
        rbd_kinematics(r->m, r->w, q, NULL, NULL);
        rbd_point_position(r->m, r->w, 6, tool, p);
        rbd_jacobian(r->m, r->w, 6, tool, RBD_WORLD_AXES, J);
        for (int i = 0; i < 3; i++) {
            wanted[i] = t[0].velocity[3 + i] + 20 * (t[0].position[i] - p[i]);
            error += pow(t[0].position[i] - p[i], 2);
        }
        if (time > 0) worst = larger(worst, sqrt(error)), sum += sqrt(error), count++;

        rbd_tasks_result result;
        if (by_tasks)
            expect_answer(&result, move_by(r, &problem, q, v, &result), RBD_TASKS_OK);
        else
            damped(J + 21, wanted, v);
        for (int i = 0; i < 7; i++) {
            q[i] += dt * v[i];
            if (!by_tasks) q[i] = fmin(fmax(q[i], lower[i]), upper[i]);
            ck_assert(fabs(v[i]) <= 1.5 + 1e-9 && q[i] >= lower[i] - 1e-12 && q[i] <= upper[i] + 1e-12);
        }
    }
    *mean = sum / count;
    return worst;
}

START_TEST(an_arm_follows_a_circle_as_near_as_geometry_allows) {
    robot r = robot_build("iiwa", iiwa_bodies, 7);
    double lower[7], upper[7], mean, mean_damped;
    for (int i = 0; i < 7; i++) lower[i] = iiwa_bodies[i].lower, upper[i] = iiwa_bodies[i].upper;

    /* 30 mm out of reach at the furthest: 30 mm is the optimum */
    double worst = follow(&r, 0.03, lower, upper, 1, &mean), worst_damped;
    worst_damped = follow(&r, 0.03, lower, upper, 0, &mean_damped);
    ck_assert_msg(fabs(worst - 0.03) < 1e-5 && worst_damped > 0.04, "%g, %g", worst, worst_damped);

    /* within reach: to a hundredth of a millimetre, also near the stretched arm */
    worst = follow(&r, -0.001, lower, upper, 1, &mean);
    worst_damped = follow(&r, -0.001, lower, upper, 0, &mean_damped);
    ck_assert_msg(worst < 5e-5 && worst_damped > 1e-4, "%g, %g", worst, worst_damped);

    /* two joints at limits on the way */
    upper[1] = 0.62, lower[3] = -1.5;
    worst = follow(&r, -2, lower, upper, 1, &mean);
    worst_damped = follow(&r, -2, lower, upper, 0, &mean_damped);
    ck_assert_msg(worst < worst_damped / 5 && mean < mean_damped / 20, "%g, %g, %g, %g", worst, mean,
                  worst_damped, mean_damped);
    robot_free(&r);
}
END_TEST

/* ---- what contradicts is named ---- */

/* A block that a force pushes off its place: friction, or the least force, cannot hold it there. */
START_TEST(contradictions_are_named) {
    static const rbd_body block[1] = {{.parent = -1, .type = RBD_TRANSLATION, .mass = 1}};
    const unsigned char passive[3] = {1, 1, 1};
    const double wrench[6] = {0, 0, 0, 5, 0, 0}, zero[3] = {0};
    rbd_task_contact foot = {.friction = 0.6};
    rbd_tasks p = {.contact = &foot, .contacts = 1, .dt = 1e-3, .passive = passive, .f_ext = wrench};
    rbd_tasks_result result;
    double a[3] = {7}, tau[3] = {7}, f[3] = {7};
    char text[200];
    robot r = BUILD(block);
    foot.sides = 8; /* 0.6 is enough with 8 sides, 5 / (9.81 cos(pi / 8)) = 0.552, not with 4 */
    expect_answer(&result, push_by(&r, &p, zero, zero, a, f, tau, &result), RBD_TASKS_OK);
    expect_dynamics(&r, &(rbd_tasks){.contact = &foot, .contacts = 1}, zero, zero, a, f,
                    (double[3]){5, 0, 0});
    a[0] = tau[0] = f[0] = 7;
    for (int k = 0; k < 2; k++) {
        foot.sides = 4, foot.friction = k ? 10 : 0.6, foot.least = k ? 20 : 0;
        const rbd_tasks_status status = push_by(&r, &p, zero, zero, a, f, tau, &result);
        expect_answer(&result, status, RBD_TASKS_INFEASIBLE);
        ck_assert(result.part[0] == (k ? RBD_TASKS_FORCE : RBD_TASKS_FRICTION) && result.at[0] == 0);
        ck_assert(a[0] == 7 && tau[0] == 7 && f[0] == 7);
        ck_assert_str_eq(rbd_tasks_text(status, &result, text, sizeof text),
                         k ? "the least or largest force of contact 0 contradicts the missing motor of dof 2"
                           : "the friction of contact 0 contradicts the missing motor of dof 0");
    }
    robot_free(&r);

    /* a slide that must stay, and must not */
    static const rbd_body heavy[1] = {
        {.joint = "slide", .parent = -1, .type = RBD_PRISMATIC, .axis = {0, 0, 1}, .mass = 1, .effort = 5}};
    const double high[MAX_Q] = {1};
    const double lower[1] = {1}, upper[1] = {1};
    r = BUILD(heavy);
    p = (rbd_tasks){.dt = 1e-3, .lower = lower, .upper = upper};
    a[0] = 7;
    const rbd_tasks_status status = push_by(&r, &p, high, zero, a, NULL, tau, &result);
    expect_answer(&result, status, RBD_TASKS_INFEASIBLE);
    ck_assert(a[0] == 7 && result.part[0] != result.part[1]);
    ck_assert_str_eq(rbd_tasks_text(status, &result, text, sizeof text),
                     result.part[0] == RBD_TASKS_TORQUE_LIMIT
                         ? "the torque limit of dof 0 contradicts the limit of motion of dof 0"
                         : "the limit of motion of dof 0 contradicts the torque limit of dof 0");
    p.torque_weight = 1; /* soft: it is kept by a larger torque */
    expect_answer(&result, push_by(&r, &p, high, zero, a, NULL, tau, &result), RBD_TASKS_OK);
    ck_assert(fabs(tau[0] - 9.81) < 1e-9 && fabs(a[0]) < 1e-9);

    /* velocities: it is behind its limit, and held */
    const rbd_task_contact held = {.normal = {0, 0, 1}};
    const rbd_tasks moves = {.contact = &held, .contacts = 1, .dt = 1e-3, .lower = lower};
    a[0] = 7;
    expect_answer(&result, move_by(&r, &moves, zero, a, &result), RBD_TASKS_INFEASIBLE);
    ck_assert(a[0] == 7 && result.part[0] == RBD_TASKS_MOTION_LIMIT && result.part[1] == RBD_TASKS_HELD);
    robot_free(&r);
}
END_TEST

/* ---- bad input ---- */

typedef struct input {
    rbd_task task[2];
    rbd_task_contact contact[1];
    rbd_tasks problem;
    double q[7], v[7], arrays[6][7];
} input;
typedef void spoil(input *x);
#define SPOIL(name, change) \
    static void name(input *x) { change; }
SPOIL(bad_kind, x->task[1].kind = (rbd_task_kind)(RBD_TASK_ROWS + 1))
SPOIL(no_kind, x->task[1].kind = (rbd_task_kind)0)
SPOIL(velocity_of_turn, x->task[1].kind = RBD_TASK_POINT; x->task[1].velocity[2] = 1)
SPOIL(acceleration_of_place, x->task[1].kind = RBD_TASK_ROTATION; x->task[1].acceleration[3] = -1)
SPOIL(loose_turn, x->task[1].kind = RBD_TASK_COM; x->task[1].loose[0] = 1)
SPOIL(velocity_of_posture, x->task[1].kind = RBD_TASK_POSTURE; x->task[1].q = x->q;
      x->task[1].velocity[5] = 1)
SPOIL(level_above, x->task[1].level = RBD_TASK_LEVELS)
SPOIL(level_below, x->task[1].level = -1)
SPOIL(negative_weight, x->task[1].weight = -1)
SPOIL(nan_weight, x->task[0].weight = NAN)
SPOIL(tiny_weight, x->task[0].weight = 1e-10)
SPOIL(negative_gain, x->task[1].gain = -1)
SPOIL(nan_damping, x->task[1].damping = NAN)
SPOIL(nan_velocity, x->task[1].velocity[5] = NAN)
SPOIL(infinite_acceleration, x->task[1].acceleration[0] = INFINITY)
SPOIL(body_above, x->task[1].body = 7)
SPOIL(body_below, x->task[1].body = -1)
SPOIL(reference_below, x->task[1].kind = RBD_TASK_RELATIVE; x->task[1].reference = -2)
SPOIL(bad_reference, x->task[1].kind = RBD_TASK_RELATIVE; x->task[1].reference = 7)
SPOIL(nan_point, x->task[1].point[0] = NAN)
SPOIL(nan_position, x->task[1].position[1] = NAN)
SPOIL(sheared, x->task[1].rotation[1] = 0.1)
SPOIL(no_axis, x->task[1].kind = RBD_TASK_AXIS)
SPOIL(no_direction, x->task[1].kind = RBD_TASK_AXIS; x->task[1].axis[0] = 1)
SPOIL(no_posture, x->task[1].kind = RBD_TASK_POSTURE)
SPOIL(nan_posture, x->task[1].kind = RBD_TASK_POSTURE; x->task[1].q = x->arrays[0]; x->arrays[0][3] = NAN)
SPOIL(negative_posture, x->task[1].kind = RBD_TASK_POSTURE; x->task[1].q = x->q;
      x->task[1].weights = x->arrays[0]; x->arrays[0][6] = -1)
SPOIL(nan_posture_v, x->task[1].kind = RBD_TASK_POSTURE; x->task[1].q = x->q; x->task[1].v = x->arrays[0];
      x->arrays[0][6] = NAN)
SPOIL(nan_posture_a, x->task[1].kind = RBD_TASK_POSTURE; x->task[1].q = x->q; x->task[1].a = x->arrays[0];
      x->arrays[0][6] = NAN)
SPOIL(negative_rows, x->task[1].kind = RBD_TASK_ROWS; x->task[1].rows = -1)
SPOIL(many_rows, x->task[1].kind = RBD_TASK_ROWS; x->task[1].rows = 1001)
SPOIL(no_jacobian, x->task[1].kind = RBD_TASK_ROWS; x->task[1].rows = 1)
SPOIL(no_y, x->task[1].kind = RBD_TASK_ROWS; x->task[1].rows = 1; x->task[1].jacobian = x->arrays[0])
SPOIL(nan_jacobian, x->task[1].kind = RBD_TASK_ROWS; x->task[1].rows = 1; x->task[1].jacobian = x->arrays[0];
      x->task[1].y = x->arrays[1]; x->arrays[0][6] = NAN)
SPOIL(nan_y, x->task[1].kind = RBD_TASK_ROWS; x->task[1].rows = 1; x->task[1].jacobian = x->arrays[0];
      x->task[1].y = x->arrays[1]; x->arrays[1][0] = NAN)
SPOIL(contact_body_below, x->contact->body = -1)
SPOIL(contact_body, x->contact->body = 7)
SPOIL(contact_point, x->contact->point[2] = NAN)
SPOIL(contact_normal, x->contact->normal[2] = NAN)
SPOIL(short_normal, x->contact->normal[2] = 1e-10)
SPOIL(short_normal_x, x->contact->normal[0] = 1e-10)
SPOIL(short_normal_y, x->contact->normal[1] = 1e-10)
SPOIL(short_normal_back, x->contact->normal[0] = -1e-10)
SPOIL(short_normal_right, x->contact->normal[1] = -1e-10)
SPOIL(short_normal_down, x->contact->normal[2] = -1e-10)
SPOIL(negative_friction, x->contact->friction = -0.1)
SPOIL(nan_friction, x->contact->friction = NAN)
SPOIL(five_sides, x->contact->sides = 5)
SPOIL(negative_least, x->contact->least = -1)
SPOIL(least_above_most, x->contact->most = 1; x->contact->least = 2)
SPOIL(nan_most, x->contact->most = NAN)
SPOIL(nan_cost, x->contact->cost = NAN)
SPOIL(nan_gain, x->contact->gain = NAN)
SPOIL(infinite_dt, x->problem.dt = INFINITY)
SPOIL(no_dt, x->problem.dt = 0)
SPOIL(negative_dt, x->problem.dt = -1e-3)
SPOIL(nan_dt, x->problem.dt = NAN)
SPOIL(nan_speed, x->problem.speed = x->arrays[0]; x->arrays[0][5] = NAN)
SPOIL(negative_torque, x->problem.torque = x->arrays[0]; x->arrays[0][5] = -1)
SPOIL(nan_limit_of_acceleration, x->problem.acceleration = x->arrays[0]; x->arrays[0][5] = NAN)
SPOIL(nan_lower, x->problem.lower = x->arrays[0]; x->arrays[0][5] = NAN)
SPOIL(nan_upper, x->problem.upper = x->arrays[0]; x->arrays[0][5] = NAN)
SPOIL(crossed, x->problem.lower = x->arrays[0]; x->problem.upper = x->arrays[1]; x->arrays[0][5] = 1)
SPOIL(nan_braking, x->problem.braking = NAN)
SPOIL(negative_limit_weight, x->problem.limit_weight = -1)
SPOIL(negative_torque_weight, x->problem.torque_weight = -1)
SPOIL(nan_motion_cost, x->problem.motion_cost = NAN)
SPOIL(nan_force_cost, x->problem.force_cost = NAN)
SPOIL(negative_steps, x->problem.steps = -1)
SPOIL(without_unknown, x->problem.without = 8)
SPOIL(without_negative, x->problem.without = -1)
SPOIL(nan_q, x->q[2] = NAN)
SPOIL(nan_v, x->v[2] = NAN)
SPOIL(nan_force, x->problem.f_ext = x->arrays[0]; x->arrays[0][4] = NAN)
SPOIL(many_tasks, x->problem.tasks = 1001)
SPOIL(many_contacts, x->problem.contacts = 1001)
SPOIL(negative_count, x->problem.tasks = -1)
SPOIL(negative_contacts, x->problem.contacts = -1)
SPOIL(no_tasks, x->problem.task = NULL)
SPOIL(no_contacts, x->problem.contact = NULL)

static const struct {
    spoil *spoil;
    rbd_status error;
    int task, contact, dof;
    const char *field;
} wrong[] = {
    {bad_kind, RBD_ERR_TYPE, 1, -1, -1, "kind"},
    {no_kind, RBD_ERR_TYPE, 1, -1, -1, "kind"},
    {velocity_of_turn, RBD_ERR_RANGE, 1, -1, -1, "velocity"},
    {acceleration_of_place, RBD_ERR_RANGE, 1, -1, -1, "acceleration"},
    {loose_turn, RBD_ERR_RANGE, 1, -1, -1, "loose"},
    {velocity_of_posture, RBD_ERR_RANGE, 1, -1, -1, "velocity"},
    {level_above, RBD_ERR_RANGE, 1, -1, -1, "level"},
    {level_below, RBD_ERR_RANGE, 1, -1, -1, "level"},
    {negative_weight, RBD_ERR_RANGE, 1, -1, -1, "weight"},
    {nan_weight, RBD_ERR_RANGE, 0, -1, -1, "weight"},
    {tiny_weight, RBD_ERR_RANGE, 0, -1, -1, "weight"},
    {negative_gain, RBD_ERR_RANGE, 1, -1, -1, "gain"},
    {nan_damping, RBD_ERR_RANGE, 1, -1, -1, "damping"},
    {nan_velocity, RBD_ERR_RANGE, 1, -1, -1, "velocity"},
    {infinite_acceleration, RBD_ERR_RANGE, 1, -1, -1, "acceleration"},
    {body_above, RBD_ERR_INDEX, 1, -1, -1, "body"},
    {body_below, RBD_ERR_INDEX, 1, -1, -1, "body"},
    {reference_below, RBD_ERR_INDEX, 1, -1, -1, "reference"},
    {bad_reference, RBD_ERR_INDEX, 1, -1, -1, "reference"},
    {nan_point, RBD_ERR_POSITION, 1, -1, -1, "point"},
    {nan_position, RBD_ERR_POSITION, 1, -1, -1, "position"},
    {sheared, RBD_ERR_ROTATION, 1, -1, -1, "rotation"},
    {no_axis, RBD_ERR_AXIS, 1, -1, -1, "axis"},
    {no_direction, RBD_ERR_AXIS, 1, -1, -1, "direction"},
    {no_posture, RBD_ERR_NULL, 1, -1, -1, "q"},
    {nan_posture, RBD_ERR_RANGE, 1, -1, -1, "q"},
    {nan_posture_v, RBD_ERR_RANGE, 1, -1, -1, "v"},
    {nan_posture_a, RBD_ERR_RANGE, 1, -1, -1, "a"},
    {negative_posture, RBD_ERR_RANGE, 1, -1, -1, "weights"},
    {negative_rows, RBD_ERR_COUNT, 1, -1, -1, "rows"},
    {many_rows, RBD_ERR_COUNT, 1, -1, -1, "rows"},
    {no_jacobian, RBD_ERR_NULL, 1, -1, -1, "jacobian"},
    {no_y, RBD_ERR_NULL, 1, -1, -1, "y"},
    {nan_jacobian, RBD_ERR_RANGE, 1, -1, -1, "jacobian"},
    {nan_y, RBD_ERR_RANGE, 1, -1, -1, "y"},
    {contact_body_below, RBD_ERR_INDEX, -1, 0, -1, "body"},
    {contact_body, RBD_ERR_INDEX, -1, 0, -1, "body"},
    {contact_point, RBD_ERR_POSITION, -1, 0, -1, "point"},
    {contact_normal, RBD_ERR_AXIS, -1, 0, -1, "normal"},
    {short_normal, RBD_ERR_AXIS, -1, 0, -1, "normal"},
    {short_normal_x, RBD_ERR_AXIS, -1, 0, -1, "normal"},
    {short_normal_y, RBD_ERR_AXIS, -1, 0, -1, "normal"},
    {short_normal_back, RBD_ERR_AXIS, -1, 0, -1, "normal"},
    {short_normal_right, RBD_ERR_AXIS, -1, 0, -1, "normal"},
    {short_normal_down, RBD_ERR_AXIS, -1, 0, -1, "normal"},
    {negative_friction, RBD_ERR_RANGE, -1, 0, -1, "friction"},
    {nan_friction, RBD_ERR_RANGE, -1, 0, -1, "friction"},
    {five_sides, RBD_ERR_RANGE, -1, 0, -1, "sides"},
    {negative_least, RBD_ERR_RANGE, -1, 0, -1, "least"},
    {least_above_most, RBD_ERR_RANGE, -1, 0, -1, "least"},
    {nan_most, RBD_ERR_RANGE, -1, 0, -1, "most"},
    {nan_cost, RBD_ERR_RANGE, -1, 0, -1, "cost"},
    {nan_gain, RBD_ERR_RANGE, -1, 0, -1, "gain"},
    {infinite_dt, RBD_ERR_RANGE, -1, -1, -1, "dt"},
    {no_dt, RBD_ERR_RANGE, -1, -1, -1, "dt"},
    {negative_dt, RBD_ERR_RANGE, -1, -1, -1, "dt"},
    {nan_dt, RBD_ERR_RANGE, -1, -1, -1, "dt"},
    {nan_speed, RBD_ERR_RANGE, -1, -1, 5, "speed"},
    {negative_torque, RBD_ERR_RANGE, -1, -1, 5, "torque"},
    {nan_limit_of_acceleration, RBD_ERR_RANGE, -1, -1, 5, "acceleration"},
    {nan_lower, RBD_ERR_LIMITS, -1, -1, 5, "lower"},
    {nan_upper, RBD_ERR_LIMITS, -1, -1, 5, "upper"},
    {crossed, RBD_ERR_LIMITS, -1, -1, 5, "lower"},
    {nan_braking, RBD_ERR_RANGE, -1, -1, -1, "braking"},
    {negative_limit_weight, RBD_ERR_RANGE, -1, -1, -1, "limit_weight"},
    {negative_torque_weight, RBD_ERR_RANGE, -1, -1, -1, "torque_weight"},
    {nan_motion_cost, RBD_ERR_RANGE, -1, -1, -1, "motion_cost"},
    {nan_force_cost, RBD_ERR_RANGE, -1, -1, -1, "force_cost"},
    {negative_steps, RBD_ERR_RANGE, -1, -1, -1, "steps"},
    {without_unknown, RBD_ERR_RANGE, -1, -1, -1, "without"},
    {without_negative, RBD_ERR_RANGE, -1, -1, -1, "without"},
    {nan_q, RBD_ERR_NAN, -1, -1, -1, "q"},
    {nan_v, RBD_ERR_NAN, -1, -1, -1, "v"},
    {nan_force, RBD_ERR_NAN, -1, -1, -1, "f_ext"},
    {many_tasks, RBD_ERR_COUNT, -1, -1, -1, "tasks"},
    {many_contacts, RBD_ERR_COUNT, -1, -1, -1, "contacts"},
    {negative_count, RBD_ERR_COUNT, -1, -1, -1, "tasks"},
    {negative_contacts, RBD_ERR_COUNT, -1, -1, -1, "contacts"},
    {no_tasks, RBD_ERR_NULL, -1, -1, -1, "task"},
    {no_contacts, RBD_ERR_NULL, -1, -1, -1, "contact"},
};

START_TEST(bad_input_is_named) {
    robot r = robot_build("iiwa", iiwa_bodies, 7);
    static unsigned char memory[RBD_TASKS_SIZE(7, 12 + 7, 1, 0)];
    for (int k = -1; k < LENGTH(wrong); k++) {
        static input x;
        double a[7] = {7}, tau[7] = {7}, f[3] = {7};
        rbd_tasks_result result;
        memset(&x, 0, sizeof x);
        x.task[0].kind = x.task[1].kind = RBD_TASK_POSE;
        x.contact->body = 6, x.contact->friction = 1;
        x.problem = (rbd_tasks){.task = x.task, .tasks = 2, .contact = x.contact, .contacts = 1, .dt = 1e-3};
        if (k >= 0) wrong[k].spoil(&x);
        const rbd_tasks_status status =
            rbd_tasks_acceleration(r.m, r.w, &x.problem, x.q, x.v, memory, sizeof memory, a, f, tau, &result);
        if (k < 0) {
            expect_answer(&result, status, RBD_TASKS_OK);
            continue;
        }
        ck_assert_msg(status == RBD_TASKS_ERROR && result.error == wrong[k].error &&
                          result.task == wrong[k].task && result.contact == wrong[k].contact &&
                          result.dof == wrong[k].dof && result.field && !strcmp(result.field, wrong[k].field),
                      "%s: %d, error %d, task %d, contact %d, dof %d, %s", wrong[k].field, status,
                      result.error, result.task, result.contact, result.dof,
                      result.field ? result.field : "no field");
        ck_assert(a[0] == 7 && tau[0] == 7 && f[0] == 7);
    }
    robot_free(&r);
}
END_TEST

/* The QP takes 20000 rows at most. More are counted before anything is laid out. */
START_TEST(too_many_rows_are_refused) {
    enum { TASKS = 30, ROWS = 1000 };
    static const double zero[ROWS * 7];
    robot r = robot_build("iiwa", iiwa_bodies, 7);
    double q[7] = {0}, v[7] = {0};
    unsigned char memory[1000];
    rbd_task task[TASKS];
    rbd_tasks p = {.task = task, .tasks = TASKS, .dt = 1e-3};
    rbd_tasks_result x;
    char text[100];

    memset(task, 0, sizeof task);
    for (int i = 0; i < TASKS; i++) {
        task[i].kind = RBD_TASK_ROWS;
        task[i].rows = ROWS;
        task[i].jacobian = zero;
        task[i].y = zero;
    }
    ck_assert_uint_eq(rbd_tasks_size(r.m, &p), 0);
    ck_assert_int_eq(rbd_tasks_velocity(r.m, r.w, &p, q, memory, sizeof memory, v, &x), RBD_TASKS_ERROR);
    ck_assert_int_eq(x.error, RBD_ERR_COUNT);
    ck_assert_str_eq(rbd_tasks_text(RBD_TASKS_ERROR, &x, text, sizeof text),
                     "field 'tasks': below 0 or above 1000, or more than 20000 rows in all");

    p.tasks = 19;
    ck_assert_uint_gt(rbd_tasks_size(r.m, &p), 0);
    robot_free(&r);
}
END_TEST

/* NULL, a work of another robot, too little memory, no mass. */
START_TEST(calls_without_what_they_need_are_refused) {
    static const rbd_body light[1] = {
        {.parent = -1, .type = RBD_REVOLUTE, .axis = {0, 0, 1}, .armature = {1}}};
    robot r = robot_build("iiwa", iiwa_bodies, 7), other = BUILD(light);
    const rbd_task t = {.kind = RBD_TASK_COM};
    const rbd_tasks p = {.task = &t, .tasks = 1, .dt = 1e-3};
    const size_t size = rbd_tasks_size(r.m, &p);
    double q[7] = {0}, v[7] = {0}, a[7], tau[7];
    void *memory = malloc(size);
    rbd_tasks_result x;
    char text[100];
#define REFUSED(m, w, p, q, v, memory, size, a, tau, expected) \
    ck_assert_int_eq(rbd_tasks_acceleration(m, w, p, q, v, memory, size, a, NULL, tau, &x), \
                     RBD_TASKS_ERROR); \
    ck_assert_int_eq(x.error, expected)
    REFUSED(NULL, r.w, &p, q, v, memory, size, a, tau, RBD_ERR_NULL);
    REFUSED(r.m, NULL, &p, q, v, memory, size, a, tau, RBD_ERR_NULL);
    REFUSED(r.m, r.w, NULL, q, v, memory, size, a, tau, RBD_ERR_NULL);
    REFUSED(r.m, r.w, &p, NULL, v, memory, size, a, tau, RBD_ERR_NULL);
    REFUSED(r.m, r.w, &p, q, NULL, memory, size, a, tau, RBD_ERR_NULL);
    REFUSED(r.m, r.w, &p, q, v, NULL, size, a, tau, RBD_ERR_NULL);
    REFUSED(r.m, r.w, &p, q, v, memory, size, NULL, tau, RBD_ERR_NULL);
    REFUSED(r.m, r.w, &p, q, v, memory, size, a, NULL, RBD_ERR_NULL);
    REFUSED(r.m, other.w, &p, q, v, memory, size, a, tau, RBD_ERR_WORK);
    REFUSED(r.m, r.w, &p, q, v, memory, size - 1, a, tau, RBD_ERR_MEMORY);
    ck_assert_str_eq(rbd_tasks_text(RBD_TASKS_ERROR, &x, text, sizeof text),
                     rbd_status_string(RBD_ERR_MEMORY));
    REFUSED(other.m, other.w, &p, q, v, memory, size, a, tau, RBD_ERR_MASS);
    ck_assert_str_eq(rbd_tasks_text(RBD_TASKS_ERROR, &x, text, sizeof text),
                     "task 0, field 'kind': a centre of mass or momentum, but the robot has no mass");
    ck_assert_int_eq(rbd_tasks_velocity(r.m, r.w, &p, q, memory, size, NULL, &x), RBD_TASKS_ERROR);
    ck_assert_int_eq(rbd_tasks_velocity(r.m, r.w, &p, NULL, memory, size, v, &x), RBD_TASKS_ERROR);
    ck_assert_int_eq(x.error, RBD_ERR_NULL);
    ck_assert_int_eq(rbd_tasks_velocity(r.m, r.w, &p, q, NULL, size, v, &x), RBD_TASKS_ERROR);
    ck_assert_int_eq(x.error, RBD_ERR_NULL);
    q[3] = NAN;
    ck_assert_int_eq(rbd_tasks_velocity(r.m, r.w, &p, q, memory, size, v, &x), RBD_TASKS_ERROR);
    ck_assert(x.error == RBD_ERR_NAN && !strcmp(x.field, "q"));
    ck_assert_int_eq(rbd_tasks_velocity(r.m, r.w, &p, q, memory, size, v, NULL), RBD_TASKS_ERROR);
    ck_assert_int_eq(rbd_tasks_acceleration(r.m, r.w, &p, q, v, memory, size, a, NULL, tau, NULL),
                     RBD_TASKS_ERROR);
    ck_assert_uint_eq(rbd_tasks_size(NULL, &p), 0);
    ck_assert_uint_eq(rbd_tasks_size(r.m, NULL), 0);
    for (int k = 0; k < 7; k++) {
        rbd_task rows = {.kind = RBD_TASK_ROWS};
        rbd_tasks out = {.task = k == 4 ? NULL : &rows, .tasks = 1, .dt = 1e-3};
        if (k < 2) out.tasks = k ? 1001 : -1;
        if (k == 2 || k == 3) out.contacts = k == 2 ? 1001 : -1;
        if (k > 4) rows.rows = k == 5 ? 1001 : -1;
        ck_assert_uint_eq(rbd_tasks_size(r.m, &out), 0);
    }
    free(memory), robot_free(&r), robot_free(&other);
}
END_TEST

/* A model of kinematics alone has velocities, even if nothing of it has a mass. */
START_TEST(joints_without_mass_have_velocities) {
    static const rbd_body arm[2] = {
        {.parent = -1, .type = RBD_REVOLUTE, .axis = {0, 0, 1}, .mass = 1},
        {.parent = 0, .type = RBD_PRISMATIC, .axis = {1, 0, 0}, .position = {0.5, 0, 0}}};
    unsigned char model_memory[RBD_MODEL_SIZE(2)], work_memory[RBD_WORK_SIZE(2, 2)];
    unsigned char memory[RBD_TASKS_SIZE(2, 3, 0, 0)];
    const rbd_model *m;
    rbd_work *w;
    ck_assert_int_eq(rbd_model_build_kinematic(arm, 2, model_memory, sizeof model_memory, &m, NULL), RBD_OK);
    ck_assert_int_eq(rbd_work_init(m, work_memory, sizeof work_memory, &w), RBD_OK);

    rbd_task t = {.kind = RBD_TASK_POINT, .body = 1, .velocity = {0, 0, 0, 1, 2, 0}};
    const rbd_tasks p = {.task = &t, .tasks = 1, .dt = 1e-3};
    const double q[2] = {0, 0.5};
    double v[2] = {0}, a[2], tau[2];
    rbd_tasks_result x;
    char text[120];
    rbd_tasks_status status = rbd_tasks_velocity(m, w, &p, q, memory, sizeof memory, v, &x);
    expect_answer(&x, status, RBD_TASKS_OK);
    ck_assert(fabs(v[0] - 2) < 1e-5 && fabs(v[1] - 1) < 1e-5); /* 1 m from the axis */
    status = rbd_tasks_acceleration(m, w, &p, q, v, memory, sizeof memory, a, NULL, tau, &x);
    ck_assert(status == RBD_TASKS_ERROR && x.error == RBD_ERR_MASSLESS);
    ck_assert_ptr_nonnull(strstr(rbd_tasks_text(status, &x, text, sizeof text), "mass"));
    t.kind = RBD_TASK_COM;
    ck_assert_int_eq(rbd_tasks_velocity(m, w, &p, q, memory, sizeof memory, v, &x), RBD_TASKS_ERROR);
    ck_assert(x.error == RBD_ERR_MASSLESS && x.task == 0);

    const rbd_body lines[2] = {{.parent = -1, .type = RBD_REVOLUTE, .axis = {0, 0, 1}}, arm[1]};
    ck_assert_int_eq(rbd_model_build_kinematic(lines, 2, model_memory, sizeof model_memory, &m, NULL),
                     RBD_OK);
    ck_assert_int_eq(rbd_work_init(m, work_memory, sizeof work_memory, &w), RBD_OK);
    t.kind = RBD_TASK_POINT;
    status = rbd_tasks_velocity(m, w, &p, q, memory, sizeof memory, v, &x);
    expect_answer(&x, status, RBD_TASKS_OK);
    ck_assert(fabs(v[0] - 2) < 1e-5 && fabs(v[1] - 1) < 1e-5);
}
END_TEST

START_TEST(a_constant_has_room) {
    robot r = robot_build("hyq", hyq_bodies, HYQ_NB);
    const rbd_task t[8] = {{.kind = RBD_TASK_POINT},    {.kind = RBD_TASK_POSE},
                           {.kind = RBD_TASK_ROTATION}, {.kind = RBD_TASK_AXIS},
                           {.kind = RBD_TASK_COM},      {.kind = RBD_TASK_MOMENTUM},
                           {.kind = RBD_TASK_RELATIVE}, {.kind = RBD_TASK_POSTURE}};
    const rbd_task_contact c[3] = {{0}};
    rbd_tasks p = {.task = t, .tasks = 8, .contact = c, .contacts = 3, .dt = 1};
    ck_assert_uint_eq(RBD_TASKS_SIZE(HYQ_NV, 30 + HYQ_NV, 3, 0), rbd_tasks_size(r.m, &p));
    p.limit_weight = p.torque_weight = 1;
    ck_assert_uint_eq(RBD_TASKS_SIZE(HYQ_NV, 30 + HYQ_NV, 3, 2 * HYQ_NV), rbd_tasks_size(r.m, &p));
    robot_free(&r);
}
END_TEST

START_TEST(every_status_has_a_sentence) {
    rbd_tasks_result x = {.task = -1, .contact = -1, .dof = -1};
    char text[100], other[100], cut[6];
    for (int status = -2; status <= 1; status++) {
        rbd_tasks_text((rbd_tasks_status)status, NULL, text, sizeof text);
        ck_assert(strlen(text) > 10 && strcmp(text, "unknown status"));
    }
    ck_assert_str_eq(rbd_tasks_text((rbd_tasks_status)9, &x, text, sizeof text), "unknown status");
    for (int part = 1; part <= RBD_TASKS_MOTION_LIMIT; part++) {
        x.part[0] = (rbd_tasks_part)part, x.at[0] = 3;
        ck_assert_str_eq(strstr(rbd_tasks_text(RBD_TASKS_INFEASIBLE, &x, text, sizeof text), " 3"),
                         " 3 cannot be kept");
    }
    x.part[0] = (rbd_tasks_part)99;
    ck_assert_str_eq(rbd_tasks_text(RBD_TASKS_INFEASIBLE, &x, text, sizeof text), "nothing 3 cannot be kept");
    x.part[0] = RBD_TASKS_NOTHING;
    ck_assert_str_eq(rbd_tasks_text(RBD_TASKS_INFEASIBLE, &x, text, sizeof text),
                     rbd_tasks_text(RBD_TASKS_INFEASIBLE, NULL, other, sizeof other));

    /* errors of tasks have sentences of their own, which do not speak of a model */
    const rbd_status own[] = {RBD_ERR_COUNT, RBD_ERR_TYPE,   RBD_ERR_POSITION, RBD_ERR_AXIS,
                              RBD_ERR_MASS,  RBD_ERR_LIMITS, RBD_ERR_RANGE,    RBD_ERR_NAN};
    for (int k = 0; k < LENGTH(own); k++) {
        x.error = own[k];
        rbd_tasks_text(RBD_TASKS_ERROR, &x, text, sizeof text);
        ck_assert(strlen(text) > 10 && strcmp(text, rbd_status_string(own[k])));
    }

    x.error = RBD_ERR_LIMITS, x.dof = 12, x.field = "lower";
    ck_assert_str_eq(rbd_tasks_text(RBD_TASKS_ERROR, &x, text, sizeof text),
                     "dof 12, field 'lower': not a number, or the lower limit is above the upper one");
    x.contact = 0, x.dof = -1;
    ck_assert_str_eq(rbd_tasks_text(RBD_TASKS_ERROR, &x, text, 24), "contact 0, field 'lower");
    x.task = 0, x.contact = -1;
    ck_assert_str_eq(rbd_tasks_text(RBD_TASKS_ERROR, &x, text, 21), "task 0, field 'lower");
    x.task = x.contact = -1, x.dof = 0;
    ck_assert_str_eq(rbd_tasks_text(RBD_TASKS_ERROR, &x, text, 20), "dof 0, field 'lower");
    x.contact = 2;
    ck_assert_str_eq(rbd_tasks_text(RBD_TASKS_ERROR, &x, cut, sizeof cut), "conta");
    ck_assert_ptr_null(rbd_tasks_text(RBD_TASKS_OK, NULL, NULL, 9));
    cut[0] = 7;
    ck_assert(rbd_tasks_text(RBD_TASKS_OK, NULL, cut, 0) == cut && cut[0] == 7);
}
END_TEST

Suite *tasks_suite(void) {
    Suite *suite = suite_create("tasks");
    TCase *c = tcase_create("tasks"), *slow = slow_tests(suite);
    tcase_add_test(c, gains_are_what_the_header_says);
    tcase_add_test(c, momentum_decays_by_its_gain);
    tcase_add_test(c, soft_limits_give_way_to_the_next_level);
    tcase_add_test(c, weights_share_and_levels_do_not);
    tcase_add_test(c, a_stop_is_approached_without_a_jump);
    tcase_add_test(c, limits_come_from_model_or_problem);
    tcase_add_test(c, zeros_and_missing_sides_are_no_limits);
    tcase_add_test(c, forces_cost_what_the_problem_says);
    tcase_add_test(c, a_normal_may_be_any_axis);
    tcase_add_test(c, answers_beyond_all_measure_are_inexact);
    tcase_add_test(c, squares_without_measure_are_an_error);
    tcase_add_test(c, a_robot_in_the_air_falls);
    tcase_add_test(c, feet_bear_the_weight);
    tcase_add_test(c, feet_push_along_their_normals);
    tcase_add_loop_test(c, the_answer_depends_on_the_problem_alone, 0, 2);
    tcase_add_test(c, rounding_is_not_held_for_the_next_level);
    tcase_add_test(c, a_level_never_worsens_the_one_before);
    tcase_add_test(c, work_is_bounded);
    tcase_add_test(c, old_bytes_of_the_memory_do_not_count);
    tcase_add_test(c, a_robot_without_joints_has_an_answer);
    tcase_add_test(c, contradictions_are_named);
    tcase_add_test(c, bad_input_is_named);
    tcase_add_test(c, too_many_rows_are_refused);
    tcase_add_test(c, calls_without_what_they_need_are_refused);
    tcase_add_test(c, joints_without_mass_have_velocities);
    tcase_add_test(c, a_constant_has_room);
    tcase_add_test(c, every_status_has_a_sentence);
    tcase_add_test(slow, answers_satisfy_the_dynamics_of_random_trees);
    tcase_add_test(slow, a_pushed_robot_keeps_its_feet);
    tcase_add_test(slow, tasks_are_reached);
    tcase_add_test(slow, an_arm_follows_a_circle_as_near_as_geometry_allows);
    suite_add_tcase(suite, c);
    return suite;
}
