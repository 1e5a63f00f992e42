/* test_contact_step.c - rbd_contact.h: steps of scenes with known answers, and of robots. */
#include <math.h>
#include <string.h>

#include "rbd_contact.h"

#include "suites.h"
#include "support.h"

#include "models/atlas.h"
#include "models/hyq.h"

static const double pi = 3.14159265358979323846;

enum { MOST = 24 };

/* ---- scenes ---- */

/* A robot, its contacts, and the state that steps take it through. */
typedef struct scene {
    robot r;
    rbd_contact list[MOST];
    rbd_constraint held[4];
    int n, n_held;
    rbd_contact_options options;
    rbd_contact_set *c;
    void *memory;
    double q[MAX_Q], v[MAX_V], tau[MAX_V], damping[MAX_V], h, t;
    double worst; /* residual */
} scene;

static void open_scene(scene *s, const char *name, const rbd_body *bodies, int nb, double h) {
    memset(s, 0, sizeof *s);
    s->r = robot_build(name, bodies, nb);
    s->options.tolerance = 1e-8, s->options.iterations = 200;
    s->h = h;
    rbd_neutral(s->r.m, s->q);
}

static rbd_contact *add_contact(scene *s, int body1, int body2, double x, double y, double z) {
    rbd_contact *a = &s->list[s->n++];
    ck_assert_int_le(s->n, MOST);
    a->body1 = body1, a->body2 = body2, a->on_body = body2 >= 0;
    a->point[0] = x, a->point[1] = y, a->point[2] = z, a->friction = 0.5;
    return a;
}

/* Four corners of a rectangle at height z of a body, over a plane of body 2. */
static void add_corners(scene *s, int body1, int body2, double lx, double ly, double z, double height) {
    for (int i = 0; i < 4; i++)
        add_contact(s, body1, body2, i & 1 ? lx / 2 : -lx / 2, i & 2 ? ly / 2 : -ly / 2, z)->height = height;
}

static void begin_scene(scene *s) {
    const size_t size = rbd_contact_set_size(s->r.m, s->n, s->held, s->n_held, &s->options);
    const rbd_contact_options *o = &s->options;
    const int others = s->n_held || o->joint_limits || o->joint_friction;
    const int bounded = others ? 6 * s->n_held + 3 * s->r.nv : 0;
    rbd_report report;
    char text[200];
    ck_assert_uint_le(size, RBD_CONTACT_SET_SIZE(s->r.nv, s->n, bounded));
    s->memory = memset(malloc(size), 0xff, size); /* NaN: what was never written shows */
    ck_assert_msg(rbd_contact_set_init(s->r.m, s->r.w, s->list, s->n, s->held, s->n_held, &s->options,
                                       s->memory, size, &s->c, &report) == RBD_OK,
                  "%s: %s", s->r.name, rbd_contact_finding_text(&report.error, s->n, text, sizeof text));
}

static void close_scene(scene *s) {
    free(s->memory);
    robot_free(&s->r);
}

static void step(scene *s) {
    const rbd_status status =
        rbd_contact_step(s->r.m, s->c, s->q, s->v, s->tau, NULL, s->damping, s->h, s->q, s->v);
    ck_assert_msg(status == RBD_OK, "%s: %s", s->r.name, rbd_status_string(status));
    s->worst = larger(s->worst, rbd_contact_last(s->c).residual);
    s->t += s->h;
}

static void run(scene *s, double seconds) {
    for (int n = (int)(seconds / s->h + 0.5); n > 0; n--) step(s);
}

static double energy(const scene *s, double *kinetic) {
    double K, U;
    ck_assert_int_eq(rbd_kinematics(s->r.m, s->r.w, s->q, s->v, NULL), RBD_OK);
    ck_assert_int_eq(rbd_energy(s->r.m, s->r.w, &K, &U), RBD_OK);
    if (kinetic) *kinetic = K;
    return K + U;
}

static rbd_body box(double lx, double ly, double lz, double mass) {
    rbd_body b = {.parent = -1, .type = RBD_FLOATING, .mass = mass};
    b.inertia[0] = mass * (ly * ly + lz * lz) / 12, b.inertia[3] = mass * (lx * lx + lz * lz) / 12;
    b.inertia[5] = mass * (lx * lx + ly * ly) / 12;
    return b;
}

static rbd_body ball(double mass, double inertia) {
    rbd_body b = {.parent = -1, .type = RBD_FLOATING, .mass = mass};
    b.inertia[0] = b.inertia[3] = b.inertia[5] = inertia;
    return b;
}

static const double steps[3] = {5e-4, 1e-3, 1e-2};

/* ---- a block on a slope ---- */

/* Gravity is turned instead of the ground; the block is turned about the normal by yaw. Returns the speed
   downhill after a second. */
static double slide(double slope, double yaw, double mu, double h) {
    const rbd_body block = box(0.4, 0.3, 0.2, 3);
    const double gravity[3] = {9.81 * sin(slope), 0, -9.81 * cos(slope)};
    scene s;
    double speed;
    open_scene(&s, "block", &block, 1, h);
    add_corners(&s, 0, -1, 0.4, 0.3, -0.1, 0);
    for (int i = 0; i < 4; i++) s.list[i].friction = mu;
    s.options.tolerance = 1e-12;
    begin_scene(&s);
    rbd_set_gravity(s.r.w, gravity);
    s.q[2] = 0.1, s.q[5] = sin(yaw / 2), s.q[6] = cos(yaw / 2);
    run(&s, 1);
    speed = s.v[3] * cos(yaw) - s.v[4] * sin(yaw);
    ck_assert_double_eq_tol(s.v[3] * sin(yaw) + s.v[4] * cos(yaw), 0, 1e-8);
    ck_assert_double_eq_tol(s.q[2], 0.1, 1e-6);
    ck_assert_double_le(s.worst, 1e-8);
    close_scene(&s);
    return speed;
}

START_TEST(block_sticks_and_slides) {
    const double degrees = pi / 180;
    for (int k = 0; k < 3; k++)
        for (int turned = 0; turned < 2; turned++) {
            const double h = steps[k], yaw = turned ? 0.7 : 0;
            expect_figure(3, "block on 26 degrees, mu 0.5: m/s after 1 s", slide(26 * degrees, yaw, 0.5, h),
                          0, 1e-9);
            expect_figure(3, "block on 27 degrees, mu 0.5: m/s after 1 s", slide(27 * degrees, yaw, 0.5, h),
                          0.083259801, 1e-9);
            expect_figure(3, "block on 40 degrees, mu 0.5: m/s after 1 s", slide(40 * degrees, yaw, 0.5, h),
                          2.548298458, 1e-9);
            expect_figure(3, "block on 30 degrees, mu 0: m/s after 1 s", slide(30 * degrees, yaw, 0, h),
                          4.905, 1e-9);
        }
    ck_assert_double_eq_tol(slide(50 * degrees, 0, 1e6, 1e-3), 0, 1e-8);
}
END_TEST

/* Where nothing turns, corrections change nothing, and the first solution is the last. A block that spins in
   the same place takes two. */
START_TEST(what_does_not_turn_takes_one_solution) {
    const double slope = 30 * pi / 180, gravity[3] = {9.81 * sin(slope), 0, -9.81 * cos(slope)};
    const rbd_body block = box(0.4, 0.3, 0.2, 3);
    for (int spins = 0; spins < 2; spins++) {
        scene s;
        open_scene(&s, "block", &block, 1, 1e-3);
        add_corners(&s, 0, -1, 0.4, 0.3, -0.1, 0);
        begin_scene(&s);
        rbd_set_gravity(s.r.w, gravity);
        s.q[2] = 0.1, s.v[2] = spins ? 5 : 0;
        run(&s, 0.05);
        for (int i = 0; i < 20; i++) {
            step(&s);
            ck_assert_int_eq(rbd_contact_last(s.c).sweeps, 1 + spins);
        }
        close_scene(&s);
    }
}
END_TEST

/* ---- far levers ---- */

/* A cube of 0.1 m on three points far from it, symmetric to x. */
static void open_tripod(scene *s, double mass, double lever, double h) {
    const rbd_body body = box(0.1, 0.1, 0.1, mass);
    open_scene(s, "tripod", &body, 1, h);
    add_contact(s, 0, -1, 4 * lever, 0, -0.1);
    add_contact(s, 0, -1, -lever, lever, -0.1);
    add_contact(s, 0, -1, -lever, -lever, -0.1);
    s->options.tolerance = 1e-12;
    begin_scene(s);
    s->q[2] = 0.1;
}

/* Moments tell the forces at rest: 1/5, 2/5 and 2/5 of the weight. On a slope it slides as any block. */
START_TEST(tripod_rests_and_slides) {
    const double slope = 40 * pi / 180, gravity[3] = {9.81 * sin(slope), 0, -9.81 * cos(slope)};
    for (int k = 0; k < 3; k++)
        for (int far = 0; far < 2; far++)
            for (int light = 0; light < 2; light++) {
                const double lever = far ? 20 : 1, mass = light ? 1e-3 : 1;
                scene s;
                double force[3];
                open_tripod(&s, mass, lever, steps[k]);
                run(&s, 0.2);
                for (int i = 0; i < 3; i++) {
                    rbd_contact_get(s.c, i, NULL, force);
                    expect_figure(11, "cube on points up to 80 m away: force, share of the weight",
                                  force[2] / (mass * 9.81), i ? 0.4 : 0.2, 1e-9);
                }
                expect_figure(11, "cube on points up to 80 m away: speed at rest", largest(s.v, 6), 0, 1e-9);
                close_scene(&s);
                open_tripod(&s, mass, lever, steps[k]);
                rbd_set_gravity(s.r.w, gravity);
                run(&s, 1);
                expect_figure(11, "cube on points up to 80 m away, on 40 degrees: m/s after 1 s", s.v[3],
                              2.548298458, 1e-8);
                close_scene(&s);
            }
}
END_TEST

/* A point at (L, 0, 0) of a ball with the inertia I meets the ground: Delta is 1/m + L^2/I across the lever,
   and 1/m along it. */
START_TEST(far_point_meets_the_ground) {
    for (int far = 0; far < 3; far++)
        for (int light = 0; light < 2; light++) {
            const double L = far == 0   ? 3
                             : far == 1 ? 30
                                        : 300,
                         mass = light ? 1e-3 : 2, inertia = 1e-3 * mass;
            const double none[3] = {0, 0, 0}, delta = 1 / mass + L * L / inertia;
            const rbd_body body = ball(mass, inertia);
            scene s;
            double force[3];
            open_scene(&s, "ball", &body, 1, 1e-3);
            add_contact(&s, 0, -1, L, 0, 0)->friction = 0.8;
            begin_scene(&s);
            rbd_set_gravity(s.r.w, none);
            s.v[4] = 0.5, s.v[5] = -1;
            ck_assert_int_eq(rbd_contact_step(s.r.m, s.c, s.q, s.v, s.tau, NULL, NULL, s.h, s.q, s.v),
                             RBD_OK);
            ck_assert_int_eq(rbd_contact_get(s.c, 0, NULL, force), RBD_STICKS);
            expect_figure(11, "point up to 300 m from a ball hits the ground: impulse over 1/Delta, across",
                          force[1] * s.h * delta, -0.5, 1e-9);
            expect_figure(11, "point up to 300 m from a ball hits the ground: impulse over 1/Delta, upward",
                          force[2] * s.h * delta, 1, 1e-9);
            close_scene(&s);
        }
}
END_TEST

/* ---- a ball ---- */

START_TEST(ball_rolls_without_gain) {
    const double v0 = 2, mu = 0.3, radius = 0.1;
    for (int k = 0; k < 3; k++) {
        const rbd_body body = ball(2, 0.4 * 2 * radius * radius);
        scene s;
        double before, rolls = 0, velocity[6];
        open_scene(&s, "ball", &body, 1, steps[k]);
        add_contact(&s, 0, -1, 0, 0, 0)->radius = radius;
        s.list[0].friction = mu;
        begin_scene(&s);
        s.q[2] = radius, s.v[3] = v0;
        before = energy(&s, NULL);
        while (s.t < 1 - s.h / 2) {
            step(&s);
            rbd_kinematics(s.r.m, s.r.w, s.q, s.v, NULL);
            rbd_point_velocity(s.r.m, s.r.w, 0, NULL, RBD_WORLD_AXES, velocity);
            if (!(rolls > 0) && fabs(velocity[3] - radius * velocity[1]) < 1e-6) rolls = s.t;
        }
        expect_figure(4, "ball thrown with 2 m/s: it rolls with, m/s", velocity[3], 5. / 7 * v0, 1e-9);
        expect_figure(4, "ball: speed of its turn, m/s", radius * velocity[1], 5. / 7 * v0, 1e-9);
        ck_assert_double_eq_tol(s.q[2], radius, 1e-12);
        expect_figure(4, "ball: energy gained, J", energy(&s, NULL) - before, -v0 * v0 * 2 / 7, 1e-8);
        expect_figure(4, "ball: begins to roll, s, to two steps of 0.5 to 10 ms", rolls,
                      2 * v0 / (7 * mu * 9.81), 2 * s.h);
        ck_assert_double_ge(rolls, 2 * v0 / (7 * mu * 9.81) - 1e-12);
        ck_assert_double_le(rolls, 2 * v0 / (7 * mu * 9.81) + 2 * s.h);
        close_scene(&s);
    }
}
END_TEST

START_TEST(ball_sinks_by_its_stiffness) {
    const rbd_body body = ball(3, 0.012);
    scene s;
    double force[3], gap;
    open_scene(&s, "ball", &body, 1, 2e-3);
    add_contact(&s, 0, -1, 0, 0, 0)->radius = 0.1;
    s.list[0].stiffness = 1e4, s.list[0].damping = 100;
    begin_scene(&s);
    s.q[2] = 0.12;
    run(&s, 2);
    expect_figure(6, "ball of 3 kg on 10 kN/m sinks by, m", 0.1 - s.q[2], 3 * 9.81 / 1e4, 1e-9);
    ck_assert_int_eq(rbd_contact_get(s.c, 0, &gap, force), RBD_STICKS);
    ck_assert_double_eq_tol(force[2], 3 * 9.81, 1e-6);
    ck_assert_double_eq_tol(gap, -3 * 9.81 / 1e4, 1e-9);
    close_scene(&s);
}
END_TEST

START_TEST(ball_rebounds_to_a_quarter) {
    for (int k = 0; k < 3; k++) {
        const rbd_body body = ball(3, 0.012);
        scene s;
        double top = 0;
        int touched = 0;
        open_scene(&s, "ball", &body, 1, steps[k]);
        add_contact(&s, 0, -1, 0, 0, 0)->radius = 0.1;
        s.list[0].restitution = 0.5, s.options.bounce = 0.25;
        begin_scene(&s);
        s.q[2] = 1.1;
        while (s.t < 0.9) {
            step(&s);
            touched |= rbd_contact_get(s.c, 0, NULL, NULL) > RBD_OPENS;
            if (touched) top = larger(top, s.q[2] - 0.1);
        }
        static const char *const words[3] = {"ball, restitution 0.5, from 1 m: rebounds to, m, at 0.5 ms",
                                             "ball, restitution 0.5, from 1 m: rebounds to, m, at 1 ms",
                                             "ball, restitution 0.5, from 1 m: rebounds to, m, at 10 ms"};
        expect_figure(6, words[k], top, 0.25, 9.81 * s.h * s.h / 8 + 1e-12); /* seen up to h/2 from the top */
        close_scene(&s);
    }
}
END_TEST

/* ---- one joint ---- */

static rbd_body rod(void) {
    rbd_body b = box(1, 0.01, 0.01, 1);
    b.type = RBD_REVOLUTE, b.axis[1] = 1, b.com[0] = 0.5;
    return b;
}

START_TEST(rod_lies_on_its_limit) {
    for (int upper = 0; upper < 2; upper++)
        for (int k = 0; k < 3; k++) {
            rbd_body body = rod();
            scene s;
            double deepest = 0, a;
            if (!upper) body.axis[1] = -1;
            body.lower = upper ? -2 : -0.5, body.upper = upper ? 0.5 : 2;
            open_scene(&s, "rod", &body, 1, steps[k]);
            s.options.joint_limits = 1;
            begin_scene(&s);
            s.q[0] = upper ? -1 : 1;
            while (s.t < 2) step(&s), deepest = larger(deepest, upper ? s.q[0] - 0.5 : -0.5 - s.q[0]);
            expect_figure(5, "rod: beyond its limit, rad", larger(deepest, 0), 0, 1e-12);
            ck_assert_double_eq_tol(fabs(s.q[0]), 0.5, 1e-12);
            ck_assert_double_eq_tol(s.v[0], 0, 1e-12);
            /* the limit's torque is what gravity's is */
            ck_assert_int_eq(rbd_rnea(s.r.m, s.r.w, s.q, s.v, s.damping, NULL, &a), RBD_OK);
            expect_figure(5, "rod on its limit: torque, N m", fabs(a), 4.304542466, 1e-9);
            ck_assert_int_eq(rbd_contact_fd(s.r.m, s.c, s.q, s.v, s.tau, NULL, NULL, s.h, &a), RBD_OK);
            ck_assert_double_eq_tol(a, 0, 1e-9);
            close_scene(&s);
        }
}
END_TEST

/* A rod on a joint without limits turns on past those that its description names. */
START_TEST(wheel_has_no_limit) {
    static const rbd_joint_type types[] = {RBD_CONTINUOUS, RBD_CONTINUOUS_CS};
    for (int k = 0; k < 2; k++) {
        const double none[3] = {0, 0, 0};
        rbd_body body = rod();
        scene s;
        body.type = types[k], body.lower = -0.1, body.upper = 0.1;
        open_scene(&s, "wheel", &body, 1, 1e-3);
        s.options.joint_limits = 1;
        begin_scene(&s);
        rbd_set_gravity(s.r.w, none);
        s.v[0] = 1;
        run(&s, 1);
        ck_assert_double_eq_tol(s.v[0], 1, 1e-12);
        ck_assert_double_eq_tol(k ? atan2(s.q[1], s.q[0]) : s.q[0], 1, 1e-9);
        close_scene(&s);
    }
}
END_TEST

/* In one step a joint may reach either of its limits, the farther one too: by its speed, or by its motor. */
START_TEST(joint_stops_at_both_limits) {
    static const double starts[4][4] = {/* half of the range, q, v, tau */
                                        {1e-3, 4e-4, 2, 0},
                                        {1e-3, -4e-4, 2, 0},
                                        {1e-3, -1e-4, 0, 300},
                                        {0.05, -0.01, 20, 0}};
    for (int k = 0; k < 8; k++) {
        const double *start = starts[k / 2], sign = k % 2 ? -1 : 1;
        rbd_body arm = rod();
        scene s;
        arm.lower = -start[0], arm.upper = start[0];
        open_scene(&s, "arm", &arm, 1, 1e-2);
        s.options.joint_limits = 1;
        begin_scene(&s);
        s.q[0] = sign * start[1], s.v[0] = sign * start[2], s.tau[0] = sign * start[3];
        step(&s);
        ck_assert_double_eq_tol(s.q[0], sign * start[0], 1e-10);
        ck_assert_double_le(s.worst, 1e-8);
        close_scene(&s);
    }
}
END_TEST

/* A slide and two that follow it, one of them backwards: passive torques are those of rbd_passive, and each
   limit stops all three. */
START_TEST(followers_are_braked_and_stopped) {
    rbd_body bodies[3] = {
        {.joint = "x", .parent = -1, .type = RBD_PRISMATIC, .axis = {1, 0, 0}, .mass = 1, .friction = {1}},
        {.parent = -1,
         .type = RBD_PRISMATIC,
         .axis = {1, 0, 0},
         .mass = 1,
         .mimic = "x",
         .mimic_ratio = -2,
         .mimic_offset = 0.5,
         .damping = {3},
         .friction = {5},
         .lower = 0.1,
         .upper = 0.7},
        {.parent = 1,
         .type = RBD_PRISMATIC,
         .axis = {0, 1, 0},
         .mass = 1,
         .mimic = "x",
         .mimic_ratio = 0.5,
         .damping = {2},
         .lower = -1,
         .upper = 0.05}};
    static const double ends[3] = {-0.1, 0.1, 0.08}; /* (0.7 - 0.5) / -2, 0.05 / 0.5, its own */
    for (int k = 0; k < 3; k++) {
        double passive, a, step_a, v = k ? 1 : -1;
        scene s;
        bodies[0].lower = k == 2 ? -1 : 0, bodies[0].upper = k == 2 ? 0.08 : 0;
        open_scene(&s, "followers", bodies, 3, 1e-3);
        s.options.joint_limits = s.options.joint_friction = s.options.joint_damping = 1;
        begin_scene(&s);
        ck_assert_int_eq(rbd_passive(s.r.m, s.r.w, &v, &passive), RBD_OK);
        ck_assert_int_eq(rbd_aba(s.r.m, s.r.w, s.q, &v, &passive, NULL, &a), RBD_OK);
        ck_assert_int_eq(rbd_contact_fd(s.r.m, s.c, s.q, &v, s.tau, NULL, NULL, 1e-9, &step_a), RBD_OK);
        ck_assert_double_eq_tol(step_a, a, 1e-6 * fabs(a));
        s.tau[0] = k ? 50 : -50;
        run(&s, 1);
        ck_assert_double_eq_tol(s.q[0], ends[k], 1e-6);
        close_scene(&s);
    }
}
END_TEST

/* Without friction no rebound makes energy, whatever the restitutions: a box with a hinged rod hits planes
   with some corners, leaves others, and the rod is at its limit. */
START_TEST(rebounds_without_friction_take_energy) {
    int solved = 0;
    for (uint64_t number = 0; number < 400; number++) {
        rbd_body bodies[2] = {box(0.6, 0.4, 0.3, 2), rod()};
        const double none[3] = {0, 0, 0};
        double before, after;
        uint64_t seed = number;
        scene s;
        bodies[1].parent = 0, bodies[1].lower = 0, bodies[1].upper = 1;
        open_scene(&s, "box and rod", bodies, 2, 1e-7);
        s.options.joint_limits = 1;
        for (int i = 0; i < 6; i++) {
            rbd_contact *a =
                add_contact(&s, 0, -1, i & 1 ? 0.3 : -0.3, i & 2 ? 0.2 : -0.2, i & 4 ? 0.15 : -0.15);
            double length = 0;
            for (int j = 0; j < 3; j++) a->normal[j] = uniform(&seed, -1, 1) - 3 * a->point[j];
            for (int j = 0; j < 3; j++) length += a->normal[j] * a->normal[j];
            for (int j = 0; j < 3; j++) a->height += a->normal[j] * a->point[j] / sqrt(length); /* gap 0 */
            a->friction = 0;
            a->restitution = number % 2 ? 1 : uniform(&seed, 0, 1);
        }
        begin_scene(&s);
        rbd_set_gravity(s.r.w, none);
        for (int k = 0; k < s.r.nv; k++) s.v[k] = uniform(&seed, -1, 1);
        energy(&s, &before);
        step(&s);
        energy(&s, &after);
        if (s.worst <= 1e-8) { /* planes from all sides: not each problem has a solution */
            ck_assert_msg(after <= before * (1 + 1e-6), "%d: %g J after %g J", (int)number, after, before);
            solved++;
        }
        close_scene(&s);
    }
    ck_assert_int_ge(solved, 300);
}
END_TEST

START_TEST(dry_friction_holds_and_brakes) {
    for (int k = 0; k < 3; k++) {
        rbd_body body = rod();
        scene s;
        double stopped = 0;
        body.friction[0] = 9.81 * 0.5 * cos(1.2) * 1.001;
        open_scene(&s, "rod", &body, 1, steps[k]);
        s.options.joint_friction = 1;
        begin_scene(&s);
        s.q[0] = 1.2;
        run(&s, 2);
        expect_figure(5, "arm that dry friction holds: angle, rad", s.q[0], 1.2, 1e-12);
        close_scene(&s);
        body.com[0] = 0, body.friction[0] = 0.5;
        open_scene(&s, "disc", &body, 1, steps[k]);
        s.options.joint_friction = 1;
        begin_scene(&s);
        s.v[0] = 6;
        while (s.t < 2) {
            step(&s);
            if (!(stopped > 0) && fabs(s.v[0]) < 1e-12) stopped = s.t;
        }
        expect_figure(5, "disc that dry friction brakes: stops, s, to a step of 0.5 to 10 ms", stopped,
                      6 * body.inertia[3] / 0.5, s.h + 1e-12);
        ck_assert_double_eq_tol(s.v[0], 0, 1e-12);
        close_scene(&s);
    }
}
END_TEST

/* tau - d v at the end of each step: v falls by 1 + h d / I a step. */
START_TEST(damping_is_implicit) {
    for (int described = 0; described < 2; described++) {
        rbd_body body = rod();
        scene s;
        body.com[0] = 0;
        if (described) body.damping[0] = 30;
        open_scene(&s, "disc", &body, 1, 1e-2);
        s.options.joint_damping = described;
        begin_scene(&s);
        s.damping[0] = described ? 0 : 30, s.v[0] = 6;
        step(&s);
        ck_assert_double_eq_tol(s.v[0], 6 / (1 + 1e-2 * 30 / body.inertia[3]), 1e-12);
        close_scene(&s);
    }
}
END_TEST

/* ---- several bodies ---- */

START_TEST(thrown_box_comes_to_rest) {
    for (int k = 0; k < 2; k++) {
        const rbd_body body = box(0.4, 0.3, 0.2, 3);
        scene s;
        double before, gain = 0, deepest = 0, kinetic, gap;
        open_scene(&s, "box", &body, 1, steps[k]);
        add_corners(&s, 0, -1, 0.4, 0.3, -0.1, 0);
        add_corners(&s, 0, -1, 0.4, 0.3, 0.1, 0);
        begin_scene(&s);
        s.q[2] = 1, s.v[0] = 3, s.v[1] = 5, s.v[2] = 2, s.v[3] = 2;
        before = energy(&s, NULL);
        while (s.t < 4) {
            double now;
            int touches = 0;
            step(&s);
            now = energy(&s, &kinetic);
            for (int i = 0; i < 8; i++) {
                touches |= rbd_contact_get(s.c, i, &gap, NULL) > RBD_OPENS;
                deepest = fmin(deepest, gap);
            }
            if (touches) gain = larger(gain, now - before);
            before = now;
        }
        expect_figure(7, "thrown box, 36 J: energy at rest, J", before, 2.943, 1e-3);
        expect_figure(7, "thrown box: kinetic energy at the end, J", kinetic, 0, 1e-20);
        expect_figure(7, "thrown box: largest gain of a step with contact, J", gain, 0, 1e-9);
        expect_figure(7, "thrown box: deepest corner, m", -deepest, 0, 1e-4);
        close_scene(&s);
    }
}
END_TEST

/* 1, 1 and 100 kg: 36 rows of rank 18. Contacts between bodies. */
START_TEST(stack_carries_its_weight) {
    const rbd_body body[3] = {box(0.2, 0.2, 0.2, 1), box(0.2, 0.2, 0.2, 1), box(0.2, 0.2, 0.2, 100)};
    for (int k = 0; k < 2; k++) {
        scene s;
        double sum = 0, force[3];
        int iterations = 0;
        open_scene(&s, "stack", body, 3, k ? 5e-3 : 1e-3);
        for (int i = 0; i < 3; i++)
            add_corners(&s, i, i - 1, 0.2, 0.2, -0.1, i ? 0.1 : 0), s.q[7 * i + 2] = 0.1 + 0.2 * i;
        begin_scene(&s);
        while (s.t < 1) {
            step(&s);
            iterations += rbd_contact_last(s.c).sweeps + rbd_contact_last(s.c).newton_steps;
        }
        for (int i = 0; i < 4; i++) rbd_contact_get(s.c, i, NULL, force), sum += force[2];
        expect_figure(8, "stack of 1, 1, 100 kg: force over weight", sum / (102 * 9.81), 1, 1e-6);
        expect_figure(8, "stack: residual, m/s", s.worst, 0, 1e-8);
        expect_figure(8, "stack: iterations per step", iterations * s.h, 0, 2.5);
        close_scene(&s);
    }
}
END_TEST

START_TEST(painleves_rod_jams) {
    const double slope = pi / 3;
    for (int k = 0; k < 2; k++)
        for (int strong = 0; strong < 2; strong++) {
            const rbd_body body = box(1, 0.01, 0.01, 1);
            scene s;
            double before, impulse = 0, force[3];
            open_scene(&s, "rod", &body, 1, k ? 1e-2 : 1e-3);
            add_contact(&s, 0, -1, 0.5, 0, 0)->friction = strong ? 3 : 1.5;
            begin_scene(&s);
            s.q[4] = sin(slope / 2), s.q[6] = cos(slope / 2), s.q[2] = 0.5 * sin(slope);
            s.v[3] = cos(slope), s.v[5] = sin(slope);
            before = energy(&s, NULL);
            while (s.t < 0.2) {
                double now;
                step(&s);
                now = energy(&s, NULL);
                expect_figure(9, "Painleve's rod: energy gained in a step over dt squared, J/s^2",
                              larger(now - before, 0) / (s.h * s.h), 0, 0.2); /* second order: it turns */
                before = now;
                rbd_contact_get(s.c, 0, NULL, force);
                impulse = larger(impulse, force[2] * s.h);
            }
            expect_figure(9, "Painleve's rod: residual, m/s", s.worst, 0, 1e-8);
            expect_figure(9, "Painleve's rod: impulse, N s", impulse, 0.365, 0.045);
            close_scene(&s);
        }
}
END_TEST

/* A strut leans by 0.2 on its hinge 1 m above the ground, and its foot slides towards the place below.
   Friction above 0.2 presses it into the ground: no impulse lifts it. Its depth stays, and does not grow. */
START_TEST(strut_that_jams_does_not_sink) {
    for (int k = 0; k < 2; k++) {
        const rbd_body body = {.parent = -1,
                               .type = RBD_REVOLUTE,
                               .axis = {0, 1, 0},
                               .position = {0, 0, 1},
                               .mass = 1,
                               .com = {0, 0, -0.5},
                               .inertia = {0.1, 0, 0, 0.1, 0, 0.1}};
        const double deep = 1e-4, lean = 0.2;
        scene s;
        double gap;
        open_scene(&s, "strut", &body, 1, k ? 5e-3 : 1e-3);
        s.options.tolerance = 0, s.options.iterations = 0; /* the defaults */
        add_contact(&s, 0, -1, lean, 0, -1 - deep)->friction = 0.8;
        begin_scene(&s);
        s.tau[0] = 20; /* towards the place below the hinge */
        for (int i = 0; i < 3000; i++) step(&s);
        rbd_contact_get(s.c, 0, &gap, NULL);
        ck_assert_msg(gap >= -1.01 * deep && fabs(s.v[0]) < 1e-9, "gap %g, speed %g", gap, s.v[0]);
        close_scene(&s);
    }
}
END_TEST

/* A leg of two links jams and rebounds, in two iterations: both solutions miss the laws, the second by more.
   Then positions move by the first: not by the mean of the speeds, as what jams does. */
START_TEST(positions_move_by_the_better_of_two_unsolved_steps) {
    const rbd_body link = {.parent = -1,
                           .type = RBD_REVOLUTE,
                           .axis = {0, 1, 0},
                           .position = {0, 0, 1},
                           .mass = 1,
                           .com = {0, 0, -0.5},
                           .inertia = {0.1, 0, 0, 0.1, 0, 0.1}};
    rbd_body leg[2] = {link, link};
    const double q[2] = {0.01, -0.02}, v[2] = {1.8, -0.2};
    scene s;
    leg[1].parent = 0;
    leg[1].position[2] = -0.5;
    leg[1].com[2] = -0.25;
    open_scene(&s, "leg", leg, 2, 1e-2);
    s.options.iterations = 2;
    add_contact(&s, 0, -1, 0.06, 0, -1.00003)->friction = 0.5;
    add_contact(&s, 1, -1, 0.16, 0, -0.50024)->friction = 0.3;
    add_contact(&s, 0, -1, 0.26, 0, -1.00001)->friction = 0.5;
    s.list[2].restitution = 0.9;
    begin_scene(&s);
    memcpy(s.q, q, sizeof q);
    memcpy(s.v, v, sizeof v);
    s.tau[0] = 17;
    s.tau[1] = -3;
    ck_assert_int_eq(rbd_contact_step(s.r.m, s.c, s.q, s.v, s.tau, NULL, NULL, s.h, s.q, s.v), RBD_OK);
    ck_assert_double_gt(rbd_contact_last(s.c).residual, 0.01);
    ck_assert_double_gt(fabs(s.q[0] - q[0] - s.h / 2 * (v[0] + s.v[0])), 1e-3);
    close_scene(&s);
}
END_TEST

/* A loop, held together with contacts: two rods on hinges, joined at their ends, on a box that slides. */
START_TEST(held_constraints_stay_closed) {
    rbd_body body[3] = {box(0.4, 0.3, 0.2, 3), rod(), rod()};
    scene s;
    const double end[3] = {1, 0, 0};
    double p[2][3], worst = 0;
    body[1].parent = body[2].parent = 0, body[2].position[0] = 0.3;
    open_scene(&s, "loop", body, 3, 1e-3);
    add_corners(&s, 0, -1, 0.4, 0.3, -0.1, 0);
    s.held[s.n_held++] = rbd_ball_loop(1, end, 2, end);
    s.held[0].axes[4] = 0; /* the plane of the rods holds y */
    begin_scene(&s);
    s.q[2] = 0.1, s.q[7] = -acos(0.15), s.q[8] = -(pi - acos(0.15));
    s.v[3] = 1;
    while (s.t < 0.5) {
        step(&s);
        rbd_kinematics(s.r.m, s.r.w, s.q, s.v, NULL);
        for (int i = 0; i < 2; i++) rbd_point_position(s.r.m, s.r.w, 1 + i, end, p[i]);
        for (int j = 0; j < 3; j++) worst = larger(worst, fabs(p[0][j] - p[1][j]));
    }
    ck_assert_double_le(worst, 1e-4);
    ck_assert_double_le(s.worst, 1e-7);
    ck_assert_double_eq_tol(s.q[2], 0.1, 1e-4);
    close_scene(&s);
}
END_TEST

/* A hinge along the axis of a joint that is there already: its rows move by rounding alone, and hold
   nothing. */
START_TEST(held_rows_that_nothing_moves_are_idle) {
    const double axis[3] = {1, 2, 3}, point[3] = {0.2, 0.4, 0.6}, place[3] = {0.3, 0.6, 0.9};
    rbd_body body = rod();
    scene s;
    for (int j = 0; j < 3; j++) body.axis[j] = axis[j], body.position[j] = place[j] - point[j];
    open_scene(&s, "hinge", &body, 1, 1e-3);
    s.held[s.n_held++] = rbd_hinge_loop(0, point, axis, -1, place, axis);
    begin_scene(&s);
    for (int i = 0; i < 5; i++) {
        double a, expected;
        s.q[0] = 0.1 + 0.7 * i, s.v[0] = 2, s.tau[0] = 1;
        ck_assert_int_eq(rbd_aba(s.r.m, s.r.w, s.q, s.v, s.tau, NULL, &expected), RBD_OK);
        ck_assert_int_eq(rbd_contact_fd(s.r.m, s.c, s.q, s.v, s.tau, NULL, NULL, s.h, &a), RBD_OK);
        ck_assert_double_eq_tol(a, expected, 1e-9);
    }
    close_scene(&s);
}
END_TEST

/* ---- robots ---- */

static const double hyq_stance[12] = {0, 0, 0, 0, 0.7, 0.7, -0.7, -0.7, -1.4, -1.4, 1.4, 1.4};

static void open_hyq(scene *s, double h, double drop) {
    double p[3];
    open_scene(s, "hyq", hyq_bodies, HYQ_NB, h);
    for (int k = 0; k < 4; k++) add_contact(s, HYQ_BODY_LF_LOWERLEG + k, -1, 0.33, 0, 0)->friction = 0.7;
    begin_scene(s);
    for (int k = 0; k < 12; k++) s->q[7 + k] = hyq_stance[k], s->damping[6 + k] = 8 + h * 300;
    rbd_kinematics(s->r.m, s->r.w, s->q, NULL, NULL);
    rbd_point_position(s->r.m, s->r.w, HYQ_BODY_LF_LOWERLEG, s->list[0].point, p);
    s->q[2] = drop - p[2];
}

/* A trot of 2 Hz: diagonal legs lift in turns. */
static void hyq_controller(scene *s, int trots) {
    for (int k = 0; k < 12; k++) {
        const int leg = k % 4, pair = leg == 0 || leg == 3;
        const double side = leg < 2 ? 1 : -1, phase = 4 * pi * s->t + (pair ? 0 : pi);
        double wanted = hyq_stance[k];
        if (trots && k >= 8) wanted -= 0.5 * side * fmax(sin(phase), 0);
        if (trots && k >= 4 && k < 8) wanted += 0.25 * side * fmax(sin(phase), 0) - 0.1 * cos(phase);
        s->tau[6 + k] = 300 * (wanted - s->q[7 + k]);
    }
}

/* Violations of the laws that show from outside. */
static void check_contacts(const scene *s) {
    for (int i = 0; i < s->n; i++) {
        double gap, f[3];
        const rbd_contact_state state = rbd_contact_get(s->c, i, &gap, f);
        expect_figure(10, "HyQ and Atlas: penetration, m", larger(-gap, 0), 0, 2e-5 + 0.5 * s->h * s->h);
        ck_assert_double_ge(f[2], 0);
        if (!(f[2] > 0))
            ck_assert_double_eq(hypot(f[0], f[1]), 0);
        else
            expect_figure(10, "HyQ and Atlas: friction beyond its cone, share",
                          larger(hypot(f[0], f[1]) / (s->list[i].friction * f[2]) - 1, 0), 0, 1e-14);
        if (state <= RBD_OPENS) ck_assert_double_eq(f[2], 0);
    }
}

START_TEST(hyq_drops_stands_and_trots) {
    for (int k = 0; k < 3; k++)
        for (int trots = 0; trots < 2; trots++) {
            scene s;
            double sum = 0, f[3];
            int newton = 0;
            open_hyq(&s, steps[k], trots ? 0 : 0.05);
            while (s.t < 2) {
                hyq_controller(&s, trots);
                step(&s);
                check_contacts(&s);
                newton += rbd_contact_last(s.c).newton_steps;
            }
            expect_figure(10, "HyQ stands and trots, 0.5 to 10 ms: residual, m/s", s.worst, 0, 1e-8);
            expect_figure(10, "HyQ stands and trots: Newton steps per step", newton * s.h / 2, 0,
                          3.5); /* of two or three solutions */
            ck_assert_double_ge(s.q[2], 0.4);
            for (int i = 0; i < 4; i++) rbd_contact_get(s.c, i, NULL, f), sum += f[2];
            if (!trots) ck_assert_double_eq_tol(sum, rbd_mass(s.r.m) * 9.81, 1);
            close_scene(&s);
        }
}
END_TEST

/* On flat feet, four points each: 24 rows of rank 12. */
START_TEST(atlas_stands) {
    for (int k = 0; k < 3; k++) {
        scene s;
        double wanted[MAX_Q], p[3], f[3], sum = 0;
        int q_of[MAX_V];
        const int bend[6] = {ATLAS_DOF_L_LEG_HPY, ATLAS_DOF_R_LEG_HPY, ATLAS_DOF_L_LEG_KNY,
                             ATLAS_DOF_R_LEG_KNY, ATLAS_DOF_L_LEG_AKY, ATLAS_DOF_R_LEG_AKY};
        open_scene(&s, "atlas", atlas_bodies, ATLAS_NB, steps[k]);
        for (int b = 0; b < s.r.nb; b++) {
            rbd_joint_info joint;
            rbd_joint(s.r.m, b, &joint);
            if (joint.nv == 1) q_of[joint.iv] = joint.iq;
        }
        const int foot[2] = {rbd_body_index(s.r.m, "l_foot"), rbd_body_index(s.r.m, "r_foot")};
        for (int i = 0; i < 8; i++)
            add_contact(&s, foot[i / 4], -1, i & 1 ? 0.17 : -0.08, i & 2 ? 0.06 : -0.06, -0.08)->friction =
                0.8;
        begin_scene(&s);
        for (int i = 0; i < 6; i++) s.q[q_of[bend[i]]] = i / 2 == 1 ? 0.8 : -0.4;
        for (int i = 0; i < 20; i++) { /* the centre of mass comes over the feet */
            const double middle[3] = {0.045, 0, -0.08};
            double com[3];
            rbd_kinematics(s.r.m, s.r.w, s.q, NULL, NULL);
            rbd_com(s.r.m, s.r.w, com, NULL, NULL);
            rbd_point_position(s.r.m, s.r.w, foot[0], middle, p);
            for (int j = 0; j < 2; j++)
                s.q[q_of[bend[j]]] -= com[0] - p[0], s.q[q_of[bend[4 + j]]] += com[0] - p[0];
        }
        rbd_kinematics(s.r.m, s.r.w, s.q, NULL, NULL);
        rbd_point_position(s.r.m, s.r.w, foot[0], s.list[0].point, p);
        s.q[2] -= p[2];
        memcpy(wanted, s.q, sizeof wanted);
        for (int i = 6; i < s.r.nv; i++) s.damping[i] = 100 + s.h * 5000;
        while (s.t < 1) {
            for (int i = 6; i < s.r.nv; i++) s.tau[i] = 5000 * (wanted[q_of[i]] - s.q[q_of[i]]);
            step(&s);
            check_contacts(&s);
        }
        expect_figure(10, "Atlas stands, 0.5 to 10 ms: residual, m/s", s.worst, 0, 1e-8);
        ck_assert_double_eq_tol(s.q[2], wanted[2], 0.02);
        for (int i = 0; i < 8; i++) rbd_contact_get(s.c, i, NULL, f), sum += f[2];
        ck_assert_double_eq_tol(sum, rbd_mass(s.r.m) * 9.81, 0.02 * rbd_mass(s.r.m) * 9.81);
        close_scene(&s);
    }
}
END_TEST

/* ---- the calls ---- */

/* rbd_contact_fd and rbd_step are a step of first order, rbd_contact_step one of second: between contacts
   they differ by the square of dt. */
START_TEST(acceleration_and_step_agree) {
    double worst[2][2] = {{0, 0}, {0, 0}};
    for (int half = 0; half < 2; half++) {
        scene s;
        double a[MAX_V], q[MAX_Q], v[MAX_V], d[MAX_V], q0[MAX_Q], v0[MAX_V];
        open_hyq(&s, 1e-3, 0.5);
        for (int n = 0; n < 200; n++) {
            hyq_controller(&s, 1);
            memcpy(q0, s.q, sizeof q0), memcpy(v0, s.v, sizeof v0);
            step(&s);
        }
        s.h /= 1 + half;
        rbd_contact_reset(s.c);
        ck_assert_int_eq(rbd_contact_fd(s.r.m, s.c, q0, v0, s.tau, NULL, s.damping, s.h, a), RBD_OK);
        ck_assert_int_eq(rbd_step(s.r.m, q0, v0, a, s.h, q, v), RBD_OK);
        rbd_contact_reset(s.c);
        memcpy(s.q, q0, sizeof q0), memcpy(s.v, v0, sizeof v0);
        step(&s);
        ck_assert_int_eq(rbd_difference(s.r.m, s.q, q, d), RBD_OK);
        worst[half][0] = largest(d, s.r.nv);
        for (int k = 0; k < s.r.nv; k++) d[k] = s.v[k] - v[k];
        worst[half][1] = largest(d, s.r.nv);
        close_scene(&s);
    }
    ck_assert_double_le(worst[0][0], 1e-4);
    ck_assert_double_le(worst[0][1], 1e-2);
    for (int k = 0; k < 2; k++) ck_assert_double_ge(worst[0][k] / worst[1][k], 3);
}
END_TEST

/* Without contacts it is forward dynamics: external wrenches, mimic joints and all. */
static void check_free(const robot *r, const state *s, int number) {
    double a[MAX_V], expected[MAX_V];
    const size_t size = rbd_contact_set_size(r->m, 0, NULL, 0, NULL);
    void *memory = malloc(size);
    rbd_contact_set *c;
    RUN(rbd_contact_set_init(r->m, r->w, NULL, 0, NULL, 0, NULL, memory, size, &c, NULL));
    const rbd_status status = rbd_fd_cholesky(r->m, r->w, s->q, s->v, s->tau, s->f_ext, expected);
    ck_assert_int_eq(rbd_contact_fd(r->m, c, s->q, s->v, s->tau, s->f_ext, NULL, 1, a), status);
    expect_close("without contacts", r, number, a, expected, r->nv, 1e-9);
    expect_figure(11, "no contact: acceleration beside rbd_fd_cholesky's, share",
                  relative_error(a, expected, r->nv), 0, 1e-9);
    free(memory);
}
START_TEST(empty_set_is_forward_dynamics) { for_random_trees(40, check_free); }
END_TEST

/* A wedge under a point mass, and a terrain that rises: the plane is that of the last call. */
START_TEST(planes_may_change) {
    const rbd_body body = ball(1, 0.01);
    const double slope[3] = {-0.3, 0, 3}, none[3] = {0, 0, 0};
    scene s;
    double gap, force[3];
    open_scene(&s, "ball", &body, 1, 1e-3);
    add_contact(&s, 0, -1, 0, 0, 0)->radius = 0.1;
    begin_scene(&s);
    s.q[2] = 0.1 + 0.05;
    run(&s, 0.5);
    ck_assert_double_eq_tol(s.q[2], 0.1, 1e-4);
    ck_assert_int_eq(rbd_contact_plane(s.r.m, s.c, 0, none, -0.2), RBD_OK);
    step(&s);
    ck_assert_int_eq(rbd_contact_get(s.c, 0, &gap, force), RBD_APART);
    ck_assert_double_eq_tol(gap, 0.2, 1e-4);
    ck_assert_double_eq(largest(force, 3), 0);
    ck_assert_int_eq(rbd_contact_plane(s.r.m, s.c, 0, slope, 0.0), RBD_OK);
    s.q[0] = 0, s.q[2] = 0.2, s.v[0] = s.v[1] = s.v[2] = s.v[3] = s.v[4] = s.v[5] = 0;
    rbd_contact_reset(s.c);
    run(&s, 0.5);
    rbd_contact_get(s.c, 0, &gap, force); /* it rolls down, to -x: 5/7 g sin */
    ck_assert_double_eq_tol(gap, 0, 2e-5);
    ck_assert_double_le(s.q[0], -0.01);
    ck_assert_int_eq(rbd_contact_plane(NULL, s.c, 0, slope, 0), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_contact_plane(s.r.m, NULL, 0, slope, 0), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_contact_plane(s.r.m, s.c, 0, NULL, 0), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_contact_plane(s.r.m, s.c, 1, slope, 0), RBD_ERR_INDEX);
    ck_assert_int_eq(rbd_contact_plane(s.r.m, s.c, -1, slope, 0), RBD_ERR_INDEX);
    ck_assert_int_eq(rbd_contact_plane(s.r.m, s.c, 0, slope, NAN), RBD_ERR_POSITION);
    const double bad[3] = {0, INFINITY, 0};
    ck_assert_int_eq(rbd_contact_plane(s.r.m, s.c, 0, bad, 0), RBD_ERR_AXIS);
    const rbd_body two[2] = {ball(1, 0.01), ball(1, 0.01)};
    robot other = robot_build("two balls", two, 2);
    ck_assert_int_eq(rbd_contact_plane(other.m, s.c, 0, slope, 0), RBD_ERR_WORK);
    robot_free(&other);
    close_scene(&s);
}
END_TEST

/* The world's point over a plane of the body, which falls away; each corner twice; points at one place. */
START_TEST(odd_sets_of_contacts) {
    const double slope = 40 * pi / 180, gravity[3] = {9.81 * sin(slope), 0, -9.81 * cos(slope)};
    for (int kind = 0; kind < 4; kind++) {
        const rbd_body block = box(0.4, 0.3, 0.2, kind == 3 ? 1e-6 : 3);
        scene s;
        open_scene(&s, "block", &block, 1, 1e-3);
        add_corners(&s, 0, -1, 0.4, 0.3, -0.1, 0);
        if (kind == 1) add_corners(&s, 0, -1, 0.4, 0.3, -0.1, 0);
        if (kind == 2) add_contact(&s, -1, 0, 0, 0, 3)->height = 0.2;
        begin_scene(&s);
        rbd_set_gravity(s.r.w, gravity);
        s.q[2] = 0.1;
        run(&s, 1);
        static const char *const words[4] = {"four corners on 40 degrees: m/s after 1 s", "each corner twice",
                                             "a point of the world over the block's plane", "1e-6 kg"};
        expect_figure(11, words[kind], s.v[3], 2.548298458, 1e-8);
        close_scene(&s);
    }
}
END_TEST

START_TEST(same_bits_on_each_run) {
    double first[MAX_Q] = {0};
    for (int k = 0; k < 2; k++) {
        scene s;
        open_hyq(&s, 1e-3, 0.01);
        while (s.t < 0.3) hyq_controller(&s, 1), step(&s);
        if (k == 0) memcpy(first, s.q, sizeof first);
        expect_figure(14, "HyQ trots a second time: states that differ",
                      memcmp(first, s.q, sizeof(double) * (size_t)s.r.nq) != 0, 0, 0.5);
        close_scene(&s);
    }
}
END_TEST

/* Each wrong field is reported by its own status. */
static void refuse(const robot *r, rbd_contact a, const rbd_contact_options *o, rbd_status status,
                   const char *field) {
    unsigned char memory[20000];
    rbd_contact_set *c = (rbd_contact_set *)memory;
    rbd_report report;
    ck_assert_int_eq(rbd_contact_set_init(r->m, r->w, &a, 1, NULL, 0, o, memory, sizeof memory, &c, &report),
                     status);
    ck_assert_ptr_null(c);
    ck_assert_int_eq(report.error.status, status);
    ck_assert_str_eq(report.error.field, field);
    ck_assert_int_eq(report.error.body, o ? -1 : 0);
}

/* A heavy lift stands on a tip that light slides carry: its 1/mass is small beside theirs, not rounding. */
START_TEST(heavy_lift_on_light_slides_stands) {
    for (int k = 0; k <= 18; k += 3) {
        const double light = 1000 * pow(10, -k);
        const rbd_body bodies[3] = {{.parent = -1, .type = RBD_PRISMATIC, .axis = {0, 0, 1}, .mass = 1000},
                                    {.parent = 0, .type = RBD_PRISMATIC, .axis = {1, 0, 0}, .mass = light},
                                    {.parent = 1, .type = RBD_PRISMATIC, .axis = {0, 1, 0}, .mass = light}};
        scene s;
        double force[3];
        open_scene(&s, "lift", bodies, 3, 1e-3);
        add_contact(&s, 2, -1, 0, 0, 0);
        begin_scene(&s);
        run(&s, 0.1);
        ck_assert_int_eq(rbd_contact_get(s.c, 0, NULL, force), RBD_STICKS);
        ck_assert_double_eq_tol(force[2], (1000 + 2 * light) * 9.81, 1e-4);
        ck_assert_double_eq_tol(s.q[0], 0, 1e-9);
        close_scene(&s);
    }
}
END_TEST

/* A box between two floors that close in on it: each of the step's three solutions keeps to the
   iterations. */
START_TEST(iterations_have_their_bound) {
    for (int most = 1; most < 50; most += most) {
        const rbd_body body = box(0.2, 0.2, 0.2, 1);
        scene s;
        open_scene(&s, "squeezed box", &body, 1, 1e-3);
        s.options.iterations = most;
        for (int i = 0; i < 8; i++) {
            rbd_contact *a =
                add_contact(&s, 0, -1, i & 1 ? 0.1 : -0.1, i & 2 ? 0.1 : -0.1, i & 4 ? 0.1 : -0.1);
            a->normal[0] = 0.1 * (i & 1), a->normal[2] = i & 4 ? -1 : 1, a->height = -0.098;
        }
        begin_scene(&s);
        for (int k = 0; k < 6; k++) s.v[k] = k % 2 ? -1 : 2;
        for (int k = 0; k < 50; k++) {
            step(&s);
            const rbd_contact_solution x = rbd_contact_last(s.c);
            ck_assert_int_le(x.sweeps + x.newton_steps, 3 * most);
        }
        close_scene(&s);
    }
}
END_TEST

START_TEST(bad_sets_are_refused_by_name) {
    const rbd_body body = box(1, 1, 1, 1);
    const robot r = robot_build("box", &body, 1);
    const rbd_contact good = {.body1 = 0, .body2 = -1};
    rbd_contact a;
#define BAD(change, status, name) a = good, a.change, refuse(&r, a, NULL, status, name)
    BAD(body1 = 1, RBD_ERR_INDEX, "body1");
    BAD(body2 = 1, RBD_ERR_INDEX, "body2");
    BAD(body2 = 0, RBD_ERR_INDEX, "body2");
    BAD(on_body = 1, RBD_ERR_INDEX, "body2");
    BAD(body1 = -1, RBD_ERR_INDEX, "body1");
    BAD(point[1] = NAN, RBD_ERR_POSITION, "point");
    BAD(normal[2] = INFINITY, RBD_ERR_AXIS, "normal");
    BAD(height = NAN, RBD_ERR_POSITION, "height");
    BAD(radius = -1, RBD_ERR_RANGE, "radius");
    BAD(friction = NAN, RBD_ERR_RANGE, "friction");
    BAD(restitution = 1.1, RBD_ERR_RANGE, "restitution");
    BAD(stiffness = -1, RBD_ERR_RANGE, "stiffness");
    BAD(damping = INFINITY, RBD_ERR_RANGE, "damping");
    BAD(damping = 1e-300, RBD_ERR_RANGE, "damping"); /* without stiffness */
#undef BAD
    rbd_contact_options o;
#define BAD(change, name) memset(&o, 0, sizeof o), o.change, refuse(&r, good, &o, RBD_ERR_RANGE, name)
    BAD(margin = -1, "margin");
    BAD(slop = NAN, "slop");
    BAD(correction = -1, "correction");
    BAD(correction = 1.0001, "correction");
    BAD(bounce = INFINITY, "bounce");
    BAD(tolerance = -1, "tolerance");
    BAD(iterations = -1, "iterations");
    BAD(momentum = o.first_order = 1, "momentum");
#undef BAD
    robot other = r;
    robot_free(&other);
}
END_TEST

/* A row that leaves body2 out names body 0: it is refused where body 0 could be meant as well. */
START_TEST(contacts_without_body2_are_refused) {
    const rbd_body bodies[2] = {box(1, 1, 1, 1), rod()};
    robot r = robot_build("box and rod", bodies, 2);
    const rbd_constraint held = rbd_point_contact(7, NULL, NULL);
    rbd_contact list[2] = {{.body1 = 0, .body2 = -1}, {.name = "tip", .body1 = 1, .friction = 0.5}};
    char text[200];
    void *memory = malloc(20000);
    rbd_contact_set *c;
    rbd_report report;
#define INIT(held, n_held) \
    rbd_contact_set_init(r.m, r.w, list, 2, held, n_held, NULL, memory, 20000, &c, &report)
    ck_assert_int_eq(INIT(NULL, 0), RBD_ERR_INDEX);
    ck_assert_str_eq(
        rbd_contact_finding_text(&report.error, 2, text, sizeof text),
        "contact 1 'tip', field 'body2': it is 0, or was left out: the world is -1; for body 0 set "
        "on_body");

    list[1].on_body = 1; /* body 0 is meant */
    ck_assert_int_eq(INIT(NULL, 0), RBD_OK);

    list[1].body2 = -1; /* on a body: on which? */
    ck_assert_int_eq(INIT(NULL, 0), RBD_ERR_INDEX);
    ck_assert_str_eq(
        rbd_contact_finding_text(&report.error, 2, text, sizeof text),
        "contact 1 'tip', field 'body2': on_body is set, and it is -1: the world, or a name that no "
        "body has");

    list[1].on_body = 0; /* errors of what is held speak of it; errors of numbers of contacts */
    ck_assert_int_eq(INIT(&held, 1), RBD_ERR_INDEX);
    ck_assert_str_eq(rbd_contact_finding_text(&report.error, 2, text, sizeof text),
                     "held constraint 0, field 'body1': no such body");
    ck_assert_int_eq(INIT(&held, -1), RBD_ERR_COUNT);
    ck_assert_str_eq(rbd_contact_finding_text(&report.error, 2, text, sizeof text),
                     "a number of contacts, constraints or rows is below 0, or above 1000");
    ck_assert_ptr_eq(rbd_contact_finding_text(NULL, 2, text, sizeof text), text);
#undef INIT
    free(memory);
    robot_free(&r);
}
END_TEST

START_TEST(bad_calls_are_refused) {
    const rbd_body bodies[2] = {box(1, 1, 1, 1), rod()};
    robot r = robot_build("box", bodies, 1), other = robot_build("boxes", bodies, 2);
    const rbd_contact list[1] = {{.body1 = 0, .body2 = -1, .point = {0, 0, 0}}};
    const rbd_constraint held[1] = {rbd_point_contact(5, NULL, NULL)};
    const size_t size = rbd_contact_set_size(r.m, 1, NULL, 0, NULL);
    double q[7] = {0, 0, 1, 0, 0, 0, 1}, v[6] = {0}, a[6];
    void *memory = malloc(size);
    rbd_contact_set *c;
    rbd_report report;
    ck_assert_uint_eq(rbd_contact_set_size(NULL, 1, NULL, 0, NULL), 0);
    ck_assert_uint_eq(rbd_contact_set_size(r.m, -1, NULL, 0, NULL), 0);
    ck_assert_uint_eq(rbd_contact_set_size(r.m, 1, NULL, 1, NULL), 0);
    ck_assert_uint_eq(rbd_contact_set_size(r.m, 1, NULL, -1, NULL), 0);
    ck_assert_uint_eq(rbd_contact_set_size(r.m, RBD_MAX_CONSTRAINTS + 1, NULL, 0, NULL), 0);
    ck_assert_uint_eq(rbd_contact_set_size(r.m, RBD_MAX_CONSTRAINTS, held, 1, NULL), 0);
#define INIT(m, w, list, n, held, n_held, memory, size, c) \
    rbd_contact_set_init(m, w, list, n, held, n_held, NULL, memory, size, c, &report)
    ck_assert_int_eq(INIT(NULL, r.w, list, 1, NULL, 0, memory, size, &c), RBD_ERR_NULL);
    ck_assert_int_eq(INIT(r.m, NULL, list, 1, NULL, 0, memory, size, &c), RBD_ERR_NULL);
    ck_assert_int_eq(INIT(r.m, r.w, NULL, 1, NULL, 0, memory, size, &c), RBD_ERR_NULL);
    ck_assert_int_eq(INIT(r.m, r.w, list, 1, NULL, 0, NULL, size, &c), RBD_ERR_NULL);
    ck_assert_int_eq(INIT(r.m, r.w, list, 1, NULL, 0, memory, size, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(INIT(r.m, r.w, list, -1, NULL, 0, memory, size, &c), RBD_ERR_COUNT);
    ck_assert_int_eq(INIT(r.m, r.w, list, 1, NULL, 1, memory, size, &c), RBD_ERR_NULL);
    ck_assert_int_eq(INIT(r.m, other.w, list, 1, NULL, 0, memory, size, &c), RBD_ERR_WORK);
    ck_assert_int_eq(INIT(r.m, r.w, list, 1, NULL, 0, memory, size - 1, &c), RBD_ERR_MEMORY);
    ck_assert_int_eq(INIT(r.m, r.w, list, 1, held, 1, memory, size, &c), RBD_ERR_INDEX);
    ck_assert_int_eq(report.error.body, 1);
    ck_assert_int_eq(INIT(r.m, r.w, list, 1, NULL, 0, memory, size, &c), RBD_OK);
#undef INIT
#define STEP(m, c, q, v, dt, a) rbd_contact_fd(m, c, q, v, v, NULL, NULL, dt, a)
    ck_assert_int_eq(STEP(NULL, c, q, v, 1e-3, a), RBD_ERR_NULL);
    ck_assert_int_eq(STEP(r.m, NULL, q, v, 1e-3, a), RBD_ERR_NULL);
    ck_assert_int_eq(STEP(r.m, c, NULL, v, 1e-3, a), RBD_ERR_NULL);
    ck_assert_int_eq(STEP(r.m, c, q, NULL, 1e-3, a), RBD_ERR_NULL);
    ck_assert_int_eq(STEP(r.m, c, q, v, 1e-3, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(STEP(other.m, c, q, v, 1e-3, a), RBD_ERR_WORK);
    ck_assert_int_eq(STEP(r.m, c, q, v, 0, a), RBD_ERR_RANGE);
    ck_assert_int_eq(STEP(r.m, c, q, v, NAN, a), RBD_ERR_RANGE);
    ck_assert_int_eq(STEP(r.m, c, q, v, INFINITY, a), RBD_ERR_RANGE);
    ck_assert_int_eq(STEP(r.m, c, q, v, 1e-3, a), RBD_OK);
#undef STEP
    ck_assert_int_eq(rbd_contact_fd(r.m, c, q, v, NULL, NULL, NULL, 1e-3, a), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_contact_step(r.m, c, NULL, v, v, NULL, NULL, 1e-3, q, v), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_contact_step(r.m, c, q, NULL, v, NULL, NULL, 1e-3, q, v), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_contact_step(r.m, c, q, v, NULL, NULL, NULL, 1e-3, q, v), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_contact_step(r.m, c, q, v, v, NULL, NULL, 1e-3, NULL, v), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_contact_step(r.m, c, q, v, v, NULL, NULL, 1e-3, q, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_contact_get(c, 1, &a[0], a + 1), RBD_APART);
    ck_assert_int_eq(rbd_contact_get(c, -1, NULL, NULL), RBD_APART);
    ck_assert_int_eq(rbd_contact_get(NULL, 0, NULL, NULL), RBD_APART);
    ck_assert_int_eq(rbd_contact_last(NULL).sweeps, 0);
    rbd_contact_reset(NULL);
    free(memory);
    robot_free(&r), robot_free(&other);
}
END_TEST

/* A robot with joints of all kinds, some with limits or friction, begun beyond a limit and off its place:
   what was wrong is taken back, at rest. */
START_TEST(errors_are_taken_back) {
    rbd_body body[6] = {box(1, 1, 1, 1), rod(), rod(), rod(), rod(), rod()};
    rbd_contact_options o = {
        .margin = 0.01, .slop = 1e-9, .correction = 0.5, .bounce = 0.1, .tolerance = 1e-9};
    const double none[3] = {0, 0, 0};
    scene s;
    body[1].lower = -0.5, body[1].upper = 0.5;
    body[2].type = RBD_CONTINUOUS_CS, body[2].lower = -1, body[2].upper = 1; /* has no limit */
    body[3].type = RBD_FIXED, body[3].parent = 1, body[3].axis[1] = 0;
    body[4].friction[0] = 3;
    body[0].type = RBD_TRANSLATION;
    for (int k = 0; k < 3; k++) body[0].damping[k] = 1;
    open_scene(&s, "odds", body, 6, 1e-3);
    o.joint_limits = o.joint_friction = o.joint_damping = 1, o.iterations = 100, s.options = o;
    s.held[s.n_held++] = rbd_point_contact(0, none, none);
    begin_scene(&s);
    rbd_set_gravity(s.r.w, none);
    s.q[0] = 0.01, s.q[3] = 0.6; /* translation: 3 coordinates; the first rod */
    step(&s);
    ck_assert_double_eq_tol(s.q[0], 0.005, 1e-8);
    ck_assert_double_eq_tol(s.q[3], 0.55, 1e-8);
    ck_assert_double_le(largest(s.v, s.r.nv), 1e-8);
    run(&s, 0.1);
    ck_assert_double_eq_tol(s.q[0], 0, 2e-9);
    ck_assert_double_eq_tol(s.q[3], 0.5, 2e-9);
    close_scene(&s);
}
END_TEST

/* A ball that is fixed in the world, under a box whose lower face is the plane. */
START_TEST(box_rests_on_a_ball_of_the_world) {
    const rbd_body body[1] = {box(0.2, 0.2, 0.2, 1)};
    scene s;
    double force[3], gap;
    open_scene(&s, "box", body, 1, 1e-3);
    add_contact(&s, -1, 0, 0, 0, 0.3)->radius = 0.1;
    s.list[0].normal[2] = -1, s.list[0].height = 0.1;
    begin_scene(&s);
    s.q[2] = 0.5 + 1e-6;
    run(&s, 0.05);
    ck_assert_double_eq_tol(s.q[2], 0.5, 1e-7);
    rbd_contact_get(s.c, 0, &gap, force);
    ck_assert_double_eq_tol(gap, 0, 1e-7);
    ck_assert_double_eq_tol(force[2], -9.81, 1e-6); /* on the world, body 1 */
    close_scene(&s);
}
END_TEST

/* A ball falls on a spring of any stiffness, whose period may be a thousandth of the step: its energy, the
   spring's included, never grows. */
START_TEST(springs_make_no_energy_at_any_stiffness) {
    const double stiffness[3] = {1e4, 1e9, 1e12}, dt[2] = {1e-3, 1e-2};
    for (int k = 0; k < 6; k++) {
        const rbd_body body = ball(1, 0.004);
        double before, most = 0;
        scene s;
        open_scene(&s, "ball on a spring", &body, 1, dt[k % 2]);
        add_contact(&s, 0, -1, 0, 0, 0)->radius = 0.1;
        s.list[0].stiffness = stiffness[k / 2];
        begin_scene(&s);
        s.q[2] = 0.6;
        before = energy(&s, NULL);
        while (s.t < 2) {
            const double depth = larger(0, 0.1 - s.q[2]);
            const double now = energy(&s, NULL) + stiffness[k / 2] * depth * depth / 2;
            most = larger(most, now - before);
            before = now;
            step(&s);
        }
        expect_figure(9, "springs of 1e4 to 1e12 N/m: energy made in a step, J", most, 0, 1e-12);
        close_scene(&s);
    }
}
END_TEST

/* ---- contacts that are in the ground ---- */

/* The velocity along a ground at height 0 of the place below a corner, which is at the height z. */
static void velocity_of_foot(const scene *s, int corner, double out[2]) {
    double velocity[6], place[3];
    ck_assert_int_eq(rbd_kinematics(s->r.m, s->r.w, s->q, s->v, NULL), RBD_OK);
    rbd_point_position(s->r.m, s->r.w, 0, s->list[corner].point, place);
    rbd_point_velocity(s->r.m, s->r.w, 0, s->list[corner].point, RBD_WORLD_AXES, velocity);
    out[0] = velocity[3] - place[2] * velocity[1]; /* v - z omega x n */
    out[1] = velocity[4] + place[2] * velocity[0];
}

/* A box turns about three points of its edge that are a millimetre in the ground, with its centre above them:
   the places below them stay at rest on the ground, to second order in dt. */
START_TEST(box_turns_about_places_on_the_ground) {
    const rbd_body body = box(0.6, 0.4, 0.3, 1);
    const double lean = 1.1, turn = 2, dt[2] = {1e-3, 5e-4};
    double speed[2];
    for (int k = 0; k < 2; k++) {
        double foot[2], x, z;
        scene s;
        open_scene(&s, "box on its edge", &body, 1, dt[k]);
        for (int i = 0; i < 3; i++) add_contact(&s, 0, -1, 0.3, 0.2 * (i - 1), -0.15)->friction = 2;
        s.options.slop = 2e-3;
        s.options.tolerance = 1e-13;
        begin_scene(&s);
        s.q[4] = sin(lean / 2);
        s.q[6] = cos(lean / 2);
        x = -0.3 * cos(lean) + 0.15 * sin(lean); /* from the places to the centre, world axes */
        z = 0.3 * sin(lean) + 0.15 * cos(lean) - 1e-3;
        s.q[2] = z;
        s.v[1] = turn;
        s.v[3] = turn * (z * cos(lean) + x * sin(lean));
        s.v[5] = turn * (z * sin(lean) - x * cos(lean));
        velocity_of_foot(&s, 0, foot);
        ck_assert_double_le(hypot(foot[0], foot[1]), 1e-12);
        run(&s, 2e-3);
        velocity_of_foot(&s, 0, foot);
        speed[k] = hypot(foot[0], foot[1]);
        for (int i = 0; i < 3; i++) ck_assert_int_eq(rbd_contact_get(s.c, i, NULL, NULL), RBD_STICKS);
        close_scene(&s);
    }
    ck_assert_double_le(speed[0], 2e-6);
    expect_figure(9, "box about its edge: places on the ground move four times less by half of dt",
                  speed[0] / speed[1], 4, 0.2);
}
END_TEST

/* A floor that rises, tilts, and both, under a box that stands on it; in the end on four balls. */
START_TEST(box_stands_on_a_floor_that_moves) {
    const double cases[4][2] = {{0.05, 0}, {0, 0.2}, {0.05, 0.05}, {0.05, 0.05}};
    for (int k = 0; k < 4; k++) {
        const rbd_body body = box(0.6, 0.4, 0.3, 1);
        const double rise = cases[k][0], tilt = cases[k][1];
        int unsolved = 0;
        scene s;
        open_scene(&s, "box on a floor that moves", &body, 1, 1e-3);
        add_corners(&s, 0, -1, 0.6, 0.4, -0.15, 0);
        for (int i = 0; i < 4; i++) {
            s.list[i].friction = 0.6;
            if (k < 3) continue;
            s.list[i].point[2] = -0.11;
            s.list[i].radius = 0.04;
        }
        s.options.tolerance = 1e-6;
        s.options.iterations = 40;
        begin_scene(&s);
        s.q[2] = 0.15;
        while (s.t < 2) {
            const double normal[3] = {tilt * sin(3 * s.t), tilt * cos(2.3 * s.t), 1};
            for (int i = 0; i < s.n; i++)
                ck_assert_int_eq(rbd_contact_plane(s.r.m, s.c, i, normal, rise * sin(4 * pi * s.t)), RBD_OK);
            step(&s);
            unsolved += !(rbd_contact_last(s.c).residual <= 1e-6);
        }
        expect_figure(9, "floor that moves: steps of 2000 above 1e-6 m/s", unsolved, 0, 10);
        close_scene(&s);
    }
}
END_TEST

/* A torque that would make the rod faster than 1e12 rad/s, or its acceleration infinite. */
START_TEST(overflow_is_an_error) {
    const rbd_body body = rod();
    scene s;
    double a;
    open_scene(&s, "rod", &body, 1, 1e-3);
    begin_scene(&s);
    s.tau[0] = 1e20, s.q[0] = 0.3;
    ck_assert_int_eq(rbd_contact_step(s.r.m, s.c, s.q, s.v, s.tau, NULL, NULL, s.h, s.q, s.v), RBD_ERR_NAN);
    ck_assert_double_eq(s.v[0], 0);
    ck_assert_double_eq(s.q[0], 0.3);
    ck_assert_int_eq(rbd_contact_fd(s.r.m, s.c, s.q, s.v, s.tau, NULL, NULL, s.h, &a), RBD_ERR_NAN);
    ck_assert_double_eq(a, 0);
    ck_assert_int_eq(rbd_contact_fd(s.r.m, s.c, s.q, s.v, s.tau, NULL, NULL, 1e-31, &a), RBD_ERR_RANGE);
    s.tau[0] = NAN; /* says that it is not q */
    ck_assert_int_eq(rbd_contact_step(s.r.m, s.c, s.q, s.v, s.tau, NULL, NULL, s.h, s.q, s.v), RBD_ERR_NAN);
    ck_assert_int_eq(rbd_singular_dof(s.r.w), -1);
    ck_assert_ptr_nonnull(strstr(rbd_status_string(RBD_ERR_NAN), "a force"));
    s.tau[0] = 0; /* not fast, but it would turn by 1e19 rad */
    ck_assert_int_eq(rbd_contact_fd(s.r.m, s.c, s.q, s.v, s.tau, NULL, NULL, 1e9, &a), RBD_ERR_NAN);
    close_scene(&s);
}
END_TEST

/* Coordinates that are not in the mass matrix: without the rows of contact and limit the body would fall. */
START_TEST(distances_that_are_not_a_number_are_errors) {
    for (int k = 0; k < 2; k++) {
        rbd_body body = {.name = "body", .parent = -1, .type = RBD_TRANSLATION, .mass = 1};
        scene s;
        if (k == 1) body.type = RBD_PRISMATIC, body.axis[2] = 1, body.upper = 1;
        open_scene(&s, "body", &body, 1, 1e-3);
        s.options.joint_limits = k;
        if (k == 0) add_contact(&s, 0, -1, 0, 0, 0);
        begin_scene(&s);
        s.q[k == 0 ? 2 : 0] = NAN;
        rbd_status status = rbd_contact_step(s.r.m, s.c, s.q, s.v, s.tau, NULL, NULL, s.h, s.q, s.v);
        ck_assert_int_eq(status, RBD_ERR_NAN);
        for (int i = 0; i < rbd_nv(s.r.m); i++) ck_assert_double_eq(s.v[i], 0);
        for (int i = 0; i < rbd_nq(s.r.m); i++) s.q[i] = 0.5;
        status = rbd_contact_step(s.r.m, s.c, s.q, s.v, s.tau, NULL, NULL, s.h, s.q, s.v);
        ck_assert_int_eq(status, RBD_OK);
        ck_assert_double_eq_tol(s.v[k == 0 ? 2 : 0], -9.81e-3, 1e-12);
        close_scene(&s);
    }
}
END_TEST

/* The place of a free box in space is in no row and in no entry of M. */
START_TEST(places_that_are_not_a_number_are_errors) {
    const double bad[3] = {NAN, INFINITY, -INFINITY};
    for (int k = 0; k < 9; k++) {
        const rbd_body body = box(1, 1, 1, 1);
        const int first_order = k % 2;
        double a[6], p[3], R[9];
        rbd_status status;
        int at;
        scene s;
        open_scene(&s, "box", &body, 1, 1e-3);
        s.options.first_order = first_order;
        begin_scene(&s);
        for (at = 0; at < 7; at++) { /* where coordinate k % 3 of the place stands in q */
            s.q[at] += 1;
            ck_assert_int_eq(rbd_kinematics(s.r.m, s.r.w, s.q, NULL, NULL), RBD_OK);
            ck_assert_int_eq(rbd_body_pose(s.r.m, s.r.w, 0, R, p), RBD_OK);
            s.q[at] -= 1;
            if (p[k % 3] > 0.5) break;
        }
        s.q[at] = bad[k / 3];
        s.v[0] = 1;
        status = rbd_contact_fd(s.r.m, s.c, s.q, s.v, s.tau, NULL, NULL, s.h, a);
        ck_assert_int_eq(status, RBD_ERR_NAN);
        ck_assert_double_eq(a[5], 0);
        status = rbd_contact_step(s.r.m, s.c, s.q, s.v, s.tau, NULL, NULL, s.h, s.q, s.v);
        ck_assert_int_eq(status, RBD_ERR_NAN);
        ck_assert_int_eq(rbd_singular_dof(s.r.w), -1);
        ck_assert_double_eq(s.v[0], 0);
        close_scene(&s);
    }
}
END_TEST

/* 100 kg on 10 N/m, at 0.1 ms. What so soft a spring adds to Delta is large, but no mass: friction is as
   exact as on a rigid plane. */
START_TEST(friction_over_a_soft_spring_is_exact) {
    const rbd_body body = {.name = "body", .parent = -1, .type = RBD_TRANSLATION, .mass = 100};
    double force[3];
    scene s;
    open_scene(&s, "body", &body, 1, 1e-4);
    rbd_contact *a = add_contact(&s, 0, -1, 0, 0, 0);
    a->friction = 0.7, a->stiffness = 10;
    begin_scene(&s);
    s.q[2] = -981 / 10.0;
    s.tau[0] = 500;
    for (int i = 0; i < 100; i++) {
        ck_assert_int_eq(rbd_contact_step(s.r.m, s.c, s.q, s.v, s.tau, NULL, NULL, s.h, s.q, s.v), RBD_OK);
        ck_assert_int_eq(rbd_contact_get(s.c, 0, NULL, force), RBD_STICKS);
        ck_assert_double_eq_tol(force[0], -500, 1e-10);
        ck_assert_double_eq_tol(force[2], 981, 1e-9);
        ck_assert_double_le(rbd_contact_last(s.c).residual, 1e-15);
    }
    ck_assert_double_eq_tol(s.q[0], 0, 1e-19);
    close_scene(&s);
}
END_TEST

/* A slide that is guided 1 cm deep in a plane of 10 kN/m: nothing moves along the normal, and the spring's
   100 N give friction, up to 50 N. */
START_TEST(a_guided_slide_rubs_on_a_soft_plane) {
    static const double pull[2] = {20, 80}, friction[2] = {20, 50};
    for (int k = 0; k < 2; k++) {
        const rbd_body body = {
            .name = "slide", .parent = -1, .type = RBD_PRISMATIC, .axis = {1, 0, 0}, .mass = 2};
        double force[3];
        scene s;
        open_scene(&s, "slide", &body, 1, 1e-3);
        rbd_contact *a = add_contact(&s, 0, -1, 0, 0, -0.01);
        a->friction = 0.5, a->stiffness = 1e4;
        begin_scene(&s);
        s.tau[0] = pull[k];
        for (int i = 0; i < 10; i++) step(&s);
        ck_assert_int_eq(rbd_contact_get(s.c, 0, NULL, force), k ? RBD_SLIPS : RBD_STICKS);
        ck_assert_double_eq_tol(force[0], -friction[k], 1e-9);
        ck_assert_double_eq_tol(force[2], 100, 1e-9);
        ck_assert_double_eq_tol(s.v[0], (pull[k] - friction[k]) / 2 * 0.01, 1e-12);
        close_scene(&s);
    }
}
END_TEST

/* A velocity that is not a number, after a step in which the contact pushed: nothing of both is left. */
START_TEST(an_error_leaves_no_forces_and_gaps) {
    for (int call = 0; call < 2; call++) {
        const rbd_body body = {.name = "body", .parent = -1, .type = RBD_TRANSLATION, .mass = 1};
        double gap, force[3];
        scene s;
        open_scene(&s, "body", &body, 1, 1e-3);
        add_contact(&s, 0, -1, 0, 0, 0);
        begin_scene(&s);
        ck_assert_int_eq(rbd_contact_step(s.r.m, s.c, s.q, s.v, s.tau, NULL, NULL, s.h, s.q, s.v), RBD_OK);
        ck_assert_int_eq(rbd_contact_get(s.c, 0, NULL, force), RBD_STICKS);
        ck_assert_double_eq_tol(force[2], 9.81, 1e-9);

        s.v[2] = NAN;
        const rbd_status status =
            call ? rbd_contact_fd(s.r.m, s.c, s.q, s.v, s.tau, NULL, NULL, s.h, s.v)
                 : rbd_contact_step(s.r.m, s.c, s.q, s.v, s.tau, NULL, NULL, s.h, s.q, s.v);
        ck_assert_int_eq(status, RBD_ERR_NAN);
        ck_assert_int_eq(rbd_contact_get(s.c, 0, &gap, force), RBD_APART);
        ck_assert_double_eq(gap, 0);
        for (int j = 0; j < 3; j++) ck_assert_double_eq(force[j], 0);
        ck_assert_double_eq(rbd_contact_last(s.c).residual, 0);
        close_scene(&s);
    }
}
END_TEST

START_TEST(singular_states_are_errors) {
    rbd_body body[2] = {rod(), rod()};
    scene s;
    body[1].parent = 0, body[1].position[0] = 1;
    open_scene(&s, "rods", body, 2, 1e-3);
    add_contact(&s, 1, -1, 1, 0, 0);
    begin_scene(&s);
    s.q[1] = NAN, s.v[0] = s.v[1] = 1;
    ck_assert_int_eq(rbd_contact_step(s.r.m, s.c, s.q, s.v, s.tau, NULL, NULL, s.h, s.q, s.v), RBD_ERR_NAN);
    expect_figure(11, "a coordinate that is NaN: RBD_ERR_NAN and velocities", largest(s.v, 2), 0, 1e-300);
    ck_assert_int_eq(rbd_contact_fd(s.r.m, s.c, s.q, s.v, s.tau, NULL, NULL, s.h, s.v), RBD_ERR_NAN);
    ck_assert_double_eq(largest(s.v, 2), 0);
    close_scene(&s);
    body[1].position[0] = 0, body[1].com[0] = 0, body[1].mass = 0; /* no inertia about the second axis */
    memset(body[1].inertia, 0, sizeof body[1].inertia);
    body[1].armature[0] = 1e-300;
    open_scene(&s, "nothing", body, 2, 1e-3);
    begin_scene(&s);
    ck_assert_int_eq(rbd_contact_step(s.r.m, s.c, s.q, s.v, s.tau, NULL, NULL, s.h, s.q, s.v),
                     rbd_aba(s.r.m, s.r.w, s.q, s.v, s.tau, NULL, s.damping));
    close_scene(&s);
}
END_TEST

/* A hip 1e-4 rad from gimbal lock has a pivot in doubt. The damping of the knee, implicit, brakes it all the
   same: given for the step, or that of the joint. */
START_TEST(damping_is_kept_where_a_pivot_is_in_doubt) {
    const rbd_body leg[2] = {{.parent = -1,
                              .type = RBD_EULER_ZYX,
                              .mass = 5,
                              .com = {0, 0, -0.2},
                              .inertia = {0.05, 0, 0, 0.05, 0, 0.02}},
                             {.parent = 0,
                              .type = RBD_REVOLUTE,
                              .axis = {0, 1, 0},
                              .position = {0, 0, -0.4},
                              .mass = 2,
                              .com = {0, 0, -0.2},
                              .inertia = {0.02, 0, 0, 0.02, 0, 0.004}}};
    for (int own = 0; own < 2; own++) {
        rbd_body bodies[2];
        scene s;
        memcpy(bodies, leg, sizeof bodies);
        if (own) bodies[1].damping[0] = 100;
        open_scene(&s, "leg near gimbal lock", bodies, 2, 2e-3);
        s.options.joint_damping = own;
        if (!own) s.damping[3] = 100;
        s.q[1] = pi / 2 - 1e-4, s.q[3] = 0.5, s.v[3] = 3;
        begin_scene(&s);
        step(&s);
        ck_assert_msg(s.v[3] > 0 && s.v[3] < 1.5, "%s damping: knee at %g rad/s", own ? "own" : "given",
                      s.v[3]);
        close_scene(&s);
    }
}
END_TEST

/* ---- tolerances ---- */

/* A mass on a slide along z, without gravity. */
static void open_slide(scene *s, double h) {
    const rbd_body slide = {.parent = -1, .type = RBD_PRISMATIC, .axis = {0, 0, 1}, .mass = 1};
    const double none[3] = {0};
    open_scene(s, "slide", &slide, 1, h);
    ck_assert_int_eq(rbd_set_gravity(s->r.w, none), RBD_OK);
}

static rbd_status step_of(scene *s, double dt) {
    return rbd_contact_step(s->r.m, s->c, s->q, s->v, s->tau, NULL, NULL, dt, s->q, s->v);
}

/* Speeds are refused from 1e12 on, steps below 1e-30 s and above 1e30 s. */
START_TEST(speeds_and_steps_have_the_bounds_that_are_documented) {
    scene s;
    open_slide(&s, 1e-3);
    begin_scene(&s);
    s.v[0] = 5e11;
    ck_assert_int_eq(step_of(&s, 1e-3), RBD_OK);
    s.v[0] = 2e12;
    ck_assert_int_eq(step_of(&s, 1e-3), RBD_ERR_NAN);
    ck_assert_double_eq(s.v[0], 0);
    ck_assert_int_eq(step_of(&s, 2e-30), RBD_OK);
    ck_assert_int_eq(step_of(&s, 5e-31), RBD_ERR_RANGE);
    ck_assert_int_eq(step_of(&s, 5e29), RBD_OK);
    ck_assert_int_eq(step_of(&s, 2e30), RBD_ERR_RANGE);
    close_scene(&s);
}
END_TEST

/* What the first half of a step goes too deep is left, up to a hundredth of the slop, and taken back
   beyond. */
START_TEST(depth_of_half_a_step_is_left_up_to_a_hundredth_of_the_slop) {
    const double depth[2] = {5e-5, 2e-4}, dt = 1e-2, start = 1e-5;
    for (int i = 0; i < 2; i++) {
        scene s;
        open_slide(&s, dt);
        add_contact(&s, 0, -1, 0, 0, 0);
        s.options.slop = 1e-2, s.options.tolerance = 1e-12;
        begin_scene(&s);
        s.q[0] = start, s.v[0] = -(start + depth[i]) / (dt / 2);
        step(&s);
        ck_assert_double_eq_tol(s.q[0], i ? 0 : -depth[i], 1e-9);
        close_scene(&s);
    }
}
END_TEST

/* A limit that is nearer than 0.02 m is a row before anything moves. */
START_TEST(near_limits_stop_what_is_pushed_from_rest) {
    scene s;
    open_slide(&s, 1e-2);
    robot_free(&s.r);
    const rbd_body slide = {
        .parent = -1, .type = RBD_PRISMATIC, .axis = {0, 0, 1}, .mass = 1, .lower = -1, .upper = 0.015};
    s.r = robot_build("slide", &slide, 1);
    s.options.joint_limits = 1;
    begin_scene(&s);
    s.tau[0] = 1000; /* moves it by 0.05 m */
    step(&s);
    ck_assert_double_eq_tol(s.q[0], 0.015, 1e-9);
    close_scene(&s);
}
END_TEST

Suite *contact_step_suite(void) {
    Suite *suite = suite_create("contact_step");
    TCase *c = tcase_create("contact_step"), *tolerances = tcase_create("tolerances"),
          *slow = slow_tests(suite);
    tcase_set_timeout(c, 60);
    tcase_add_test(slow, block_sticks_and_slides);
    tcase_add_test(c, what_does_not_turn_takes_one_solution);
    tcase_add_test(slow, tripod_rests_and_slides);
    tcase_add_test(c, far_point_meets_the_ground);
    tcase_add_test(c, ball_rolls_without_gain);
    tcase_add_test(c, ball_sinks_by_its_stiffness);
    tcase_add_test(c, ball_rebounds_to_a_quarter);
    tcase_add_test(c, rod_lies_on_its_limit);
    tcase_add_test(c, wheel_has_no_limit);
    tcase_add_test(c, joint_stops_at_both_limits);
    tcase_add_test(c, followers_are_braked_and_stopped);
    tcase_add_test(c, rebounds_without_friction_take_energy);
    tcase_add_test(c, dry_friction_holds_and_brakes);
    tcase_add_test(c, damping_is_implicit);
    tcase_add_test(slow, thrown_box_comes_to_rest);
    tcase_add_test(c, stack_carries_its_weight);
    tcase_add_test(c, painleves_rod_jams);
    tcase_add_test(c, strut_that_jams_does_not_sink);
    tcase_add_test(c, positions_move_by_the_better_of_two_unsolved_steps);
    tcase_add_test(c, held_constraints_stay_closed);
    tcase_add_test(c, held_rows_that_nothing_moves_are_idle);
    tcase_add_test(slow, hyq_drops_stands_and_trots);
    tcase_add_test(slow, atlas_stands);
    tcase_add_test(c, acceleration_and_step_agree);
    tcase_add_test(c, empty_set_is_forward_dynamics);
    tcase_add_test(c, planes_may_change);
    tcase_add_test(c, odd_sets_of_contacts);
    tcase_add_test(c, same_bits_on_each_run);
    tcase_add_test(c, heavy_lift_on_light_slides_stands);
    tcase_add_test(c, iterations_have_their_bound);
    tcase_add_test(c, bad_sets_are_refused_by_name);
    tcase_add_test(c, contacts_without_body2_are_refused);
    tcase_add_test(c, bad_calls_are_refused);
    tcase_add_test(c, errors_are_taken_back);
    tcase_add_test(c, box_rests_on_a_ball_of_the_world);
    tcase_add_test(c, springs_make_no_energy_at_any_stiffness);
    tcase_add_test(c, box_turns_about_places_on_the_ground);
    tcase_add_test(c, box_stands_on_a_floor_that_moves);
    tcase_add_test(c, overflow_is_an_error);
    tcase_add_test(c, distances_that_are_not_a_number_are_errors);
    tcase_add_test(c, places_that_are_not_a_number_are_errors);
    tcase_add_test(c, an_error_leaves_no_forces_and_gaps);
    tcase_add_test(c, friction_over_a_soft_spring_is_exact);
    tcase_add_test(c, a_guided_slide_rubs_on_a_soft_plane);
    tcase_add_test(c, singular_states_are_errors);
    tcase_add_test(c, damping_is_kept_where_a_pivot_is_in_doubt);
    tcase_add_test(tolerances, speeds_and_steps_have_the_bounds_that_are_documented);
    tcase_add_test(tolerances, depth_of_half_a_step_is_left_up_to_a_hundredth_of_the_slop);
    tcase_add_test(tolerances, near_limits_stop_what_is_pushed_from_rest);
    suite_add_tcase(suite, c);
    suite_add_tcase(suite, tolerances);
    return suite;
}
