/* test_contact_derivatives.c - derivatives of the contact step, against differences of the step itself. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "rbd_derivatives.h"
#include "rbd_contact.h"

#include "suites.h"
#include "support.h"

#include "models/atlas.h"
#include "models/hyq.h"

enum { MOST = 12 };

/* ---- scenes ---- */

/* A robot, its contacts, and a state. Penetration up to half a millimetre is within the slop, so that
   differences stay there. */
typedef struct scene {
    robot r;
    rbd_contact list[MOST];
    rbd_constraint held[2];
    int n, n_held;
    rbd_contact_options options;
    rbd_contact_set *c;
    rbd_derivatives *d;
    int redundant; /* shares of points in the force of their body, and so their states, may change */
    void *memory[2];
    double q[MAX_Q], v[MAX_V], tau[MAX_V], damping[MAX_V], f_ext[6 * MAX_BODIES], h;
} scene;

static void open_scene(scene *s, const char *name, const rbd_body *bodies, int nb, double h) {
    memset(s, 0, sizeof *s);
    s->r = robot_build(name, bodies, nb);
    s->options.tolerance = 1e-13, s->options.iterations = 2000, s->options.slop = 1e-3;
    s->options.derivatives = 1;
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

/* Returns 0 if the contacts are refused. */
static int try_scene(scene *s) {
    const size_t size = rbd_contact_set_size(s->r.m, s->n, s->held, s->n_held, &s->options),
                 more = rbd_derivatives_size(s->r.m);
    s->memory[0] = memset(malloc(size), 0xff, size), s->memory[1] = memset(malloc(more), 0xff, more);
    ck_assert_int_eq(rbd_derivatives_init(s->r.m, s->r.w, s->memory[1], more, &s->d), RBD_OK);
    return rbd_contact_set_init(s->r.m, s->r.w, s->list, s->n, s->held, s->n_held, &s->options, s->memory[0],
                                size, &s->c, NULL) == RBD_OK;
}
static void begin_scene(scene *s) { ck_assert(try_scene(s)); }

static void close_scene(scene *s) {
    for (int i = 0; i < 2; i++) free(s->memory[i]);
    robot_free(&s->r);
}

static rbd_body box(double lx, double ly, double lz, double mass) {
    rbd_body b = {.parent = -1, .type = RBD_FLOATING, .mass = mass};
    b.inertia[0] = mass * (ly * ly + lz * lz) / 12, b.inertia[3] = mass * (lx * lx + lz * lz) / 12;
    b.inertia[5] = mass * (lx * lx + ly * ly) / 12;
    return b;
}

/* ---- differences ---- */

/* Results of a step, and the state of each contact in it. */
typedef struct end {
    double q[MAX_Q], v[MAX_V];
    rbd_contact_state state[MOST];
    double residual;
} end;

static end step_from(scene *s, const double *q, const double *v, const double *tau) {
    end e;
    rbd_contact_reset(s->c);
    ck_assert_int_eq(rbd_contact_step(s->r.m, s->c, q, v, tau, s->f_ext, s->damping, s->h, e.q, e.v), RBD_OK);
    for (int i = 0; i < s->n; i++) e.state[i] = rbd_contact_get(s->c, i, NULL, NULL);
    e.residual = rbd_contact_last(s->c).residual;
    return e;
}

/* A step after component k of q, v or tau (x = 0, 1, 2) has moved by t. */
static end moved_step(scene *s, int x, int k, double t) {
    double q[MAX_Q], v[MAX_V], tau[MAX_V], unit[MAX_V] = {0};
    memcpy(q, s->q, sizeof q), memcpy(v, s->v, sizeof v), memcpy(tau, s->tau, sizeof tau);
    unit[k] = 1;
    if (x == 0) rbd_integrate(s->r.m, s->q, unit, t, q);
    if (x == 1) v[k] += t;
    if (x == 2) tau[k] += t;
    return step_from(s, q, v, tau);
}

/* Differences of order four: columns of dq_next and dv_next. Returns 0 if a state changes in between, or if
   the middle is not near the mean: some problems have two solutions. */
static int differences(scene *s, int x, int k, double t, double *dq, double *dv) {
    const double factor[4] = {1, -8, 8, -1};
    double mean[MAX_V] = {0};
    const end here = moved_step(s, x, k, 0);
    memset(dq, 0, sizeof(double) * MAX_V), memset(dv, 0, sizeof(double) * MAX_V);
    for (int j = 0; j < 4; j++) {
        const end e = moved_step(s, x, k, t * (j < 2 ? j - 2 : j - 1));
        double d[MAX_V];
        rbd_difference(s->r.m, here.q, e.q, d);
        for (int i = 0; i < s->r.nv; i++)
            dq[i] += factor[j] * d[i] / (12 * t), dv[i] += factor[j] * e.v[i] / (12 * t),
                mean[i] += e.v[i] / 4;
        if (e.residual > 1e-11) return 0;
        for (int i = 0; i < s->n; i++)
            if (e.state[i] != here.state[i] && !s->redundant) return 0;
    }
    for (int i = 0; i < s->r.nv; i++)
        if (!(fabs(mean[i] - here.v[i]) <= 1e-3)) return 0;
    return 1;
}

/* The same, dq_next and dv_next, if half of the step says so too: limits and friction of joints, whose
   states do not show, stay as well. */
static int reference(scene *s, int x, int k, double bound, double expected[2][MAX_V]) {
    const double t = x == 0 ? 1e-5 : x == 1 ? 1e-4 : 1e-3;
    double half[2][MAX_V];
    if (!differences(s, x, k, t, expected[0], expected[1])) return 0;
    if (!differences(s, x, k, t / 2, half[0], half[1])) return 0;
    for (int i = 0; i < 2 * MAX_V; i++) {
        const double y = expected[i / MAX_V][i % MAX_V];
        if (!(fabs(half[i / MAX_V][i % MAX_V] - y) <= 0.2 * bound * fmax(fabs(y), 1))) return 0;
    }
    return 1;
}

typedef struct columns {
    double by[6][MAX_V * MAX_V];
} columns;

static rbd_status differentiate(scene *s, columns *x, double *q_next, double *v_next) {
    const rbd_contact_step_results out = {q_next,   v_next,   x->by[0], x->by[1],
                                          x->by[2], x->by[3], x->by[4], x->by[5]};
    return rbd_contact_step_derivatives(s->r.m, s->c, s->d, s->q, s->v, s->tau, s->f_ext, s->damping, s->h,
                                        &out);
}

static columns found;

/* Compares all columns whose states stay; returns their number. Each error is a share of the largest entry of
   its row, or of 1. */
static int compare(scene *s, const char *what, double bound) {
    const int n = s->r.nv;
    static const char *const by[3] = {"q", "v", "tau"};
    double q[MAX_Q], v[MAX_V], expected[2][MAX_V], worst = 0;
    char figure[80];
    int compared = 0;
    const end e = step_from(s, s->q, s->v, s->tau);
    memset(&found, 0xff, sizeof found);
    rbd_contact_reset(s->c);
    ck_assert_int_eq(differentiate(s, &found, q, v), RBD_OK);
    ck_assert_mem_eq(q, e.q, sizeof(double) * (size_t)s->r.nq);
    ck_assert_mem_eq(v, e.v, sizeof(double) * (size_t)n);
    for (int x = 0; x < 3; x++)
        for (int k = 0; k < n; k++) {
            if (!reference(s, x, k, bound, expected)) continue;
            ++compared;
            for (int i = 0; i < 2 * n; i++) {
                const double *row = &found.by[3 * (i >= n) + x][(i % n) * n], y = expected[i >= n][i % n];
                const double error = fabs(row[k] - y) / fmax(largest(row, n), 1);
                worst = larger(worst, error);
                ck_assert_msg(error <= bound, "%s %s: d%s_next[%d] / d%s[%d] is %.12g, differences say %.12g",
                              s->r.name, what, i < n ? "q" : "v", i % n, by[x], k, row[k], y);
            }
        }
    snprintf(figure, sizeof figure, "derivatives beside differences: %s", what);
    expect_figure(12, figure, worst, 0, bound);
    return compared;
}

static int count(scene *s, rbd_contact_state state) {
    int n = 0;
    for (int i = 0; i < s->n; i++) n += rbd_contact_get(s->c, i, NULL, NULL) == state;
    return n;
}

/* All columns, and so many contacts that stick and slip. */
static void expect(scene *s, const char *what, int sticks, int slips, double bound) {
    ck_assert_int_eq(compare(s, what, bound), 3 * s->r.nv);
    rbd_contact_reset(s->c);
    ck_assert_int_eq(differentiate(s, &found, NULL, NULL), RBD_OK);
    ck_assert_int_eq(count(s, RBD_STICKS), sticks);
    ck_assert_int_eq(count(s, RBD_SLIPS), slips);
}

/* ---- balls and boxes ---- */

/* Puts contact i at this gap by moving coordinate k, along which the gap grows. */
static void put_at(scene *s, int i, int k, double gap) {
    double now;
    for (int n = 0; n < 3; n++) {
        (void)step_from(s, s->q, s->v, s->tau);
        (void)rbd_contact_get(s->c, i, &now, NULL);
        s->q[k] += gap - now;
    }
}

static void spin(scene *s, double factor) {
    for (int k = 0; k < s->r.nv; k++) s->v[k] = factor * sin(3 * k + 1), s->tau[k] = 2 * cos(5 * k);
    for (int k = 0; k < 6 * s->r.nb; k++) s->f_ext[k] = sin(k + 0.5);
}

/* Gaps that are taken for 0, corrected, and closed in the step. */
static const double gaps[3] = {-5e-4, -2e-3, 5e-4};
static const double presses[3] = {0, 0, -4000}; /* as gravity */

/* A ball about a point beside the centre of mass, which rolls or slides on a plane that leans. */
START_TEST(ball_rolls_and_slides) {
    const rbd_body body = box(0.1, 0.12, 0.14, 2);
    const double normal[3] = {0.2, -0.1, 1};
    for (int slides = 0; slides < 2; slides++)
        for (int k = 0; k < 3; k++)
            for (int stiff = 0; stiff < 2; stiff++) {
                scene s;
                open_scene(&s, "ball", &body, 1, 1e-3);
                add_contact(&s, 0, -1, 0.02, 0.01, 0)->radius = 0.1;
                s.list[0].friction = slides ? 0.1 : 3;
                if (stiff) s.list[0].stiffness = 1e4, s.list[0].damping = 50;
                begin_scene(&s);
                ck_assert_int_eq(rbd_contact_plane(s.r.m, s.c, 0, normal, 0.1), RBD_OK);
                spin(&s, slides ? 1.5 : 0.02);
                rbd_set_gravity(s.r.w, presses);
                s.q[3] = 0.5, s.q[4] = 0.5, s.q[5] = -0.5, s.q[6] = 0.5;
                put_at(&s, 0, 2, gaps[k]);
                expect(&s, "a ball rolls and slides", !slides, slides, 1e-6);
                close_scene(&s);
            }
}
END_TEST

/* On four corners, of which three would do: at rest, and sliding without a turn. */
START_TEST(box_rests_and_slides) {
    const rbd_body body = box(0.4, 0.3, 0.2, 3);
    for (int slides = 0; slides < 2; slides++)
        for (int stiff = 0; stiff < 2; stiff++) {
            scene s;
            open_scene(&s, "box", &body, 1, 1e-3);
            for (int i = 0; i < 4; i++) {
                rbd_contact *a = add_contact(&s, 0, -1, i & 1 ? 0.2 : -0.2, i & 2 ? 0.15 : -0.15, -0.1);
                if (stiff) a->stiffness = 1e4, a->damping = 100;
            }
            s.redundant = !slides;
            if (stiff) s.options.slip = 1e-4;
            begin_scene(&s);
            s.q[2] = 0.1 - 5e-4, s.q[5] = 0.6, s.q[6] = 0.8;
            if (slides) s.v[3] = 0.3, s.v[4] = 1;
            expect(&s, "a box rests and slides", slides ? 0 : 4, slides ? 4 : 0, 1e-7);
            close_scene(&s);
        }
}
END_TEST

/* Derivatives by q, v and tau alone are those of the call that `found` is of. */
static void expect_parts(scene *s, int size) {
    static columns part;
    for (int x = 0; x < 3; x++) {
        rbd_contact_step_results out = {NULL, NULL, NULL, NULL, NULL, NULL, NULL, NULL};
        if (x == 0) out.dq_next_dq = part.by[0], out.dv_next_dq = part.by[3];
        if (x == 1) out.dq_next_dv = part.by[1], out.dv_next_dv = part.by[4];
        if (x == 2) out.dq_next_dtau = part.by[2], out.dv_next_dtau = part.by[5];
        rbd_contact_reset(s->c);
        memset(&part, 0xff, sizeof part);
        ck_assert_int_eq(rbd_contact_step_derivatives(s->r.m, s->c, s->d, s->q, s->v, s->tau, s->f_ext,
                                                      s->damping, s->h, &out),
                         RBD_OK);
        for (int k = 0; k < 2; k++)
            ck_assert_double_le(relative_error(part.by[3 * k + x], found.by[3 * k + x], size), 1e-12);
    }
}

/* A corner hits the ground and rebounds: positions and velocities are two solutions. */
START_TEST(corner_rebounds) {
    const rbd_body body = box(0.4, 0.3, 0.2, 3);
    for (int k = 0; k < 3; k++)
        for (int slides = 0; slides < 2; slides++) {
            scene s;
            open_scene(&s, "box", &body, 1, 1e-3);
            add_contact(&s, 0, -1, 0.2, 0.15, -0.1)->restitution = 0.6;
            add_contact(&s, 0, -1, 0, 0, 5)->restitution = 0.6; /* far away */
            s.list[0].friction = slides ? 0.1 : 2;
            begin_scene(&s);
            spin(&s, 1);
            s.q[3] = 0.1, s.q[4] = 0.7, s.q[5] = 0.1, s.q[6] = 0.7, s.v[3] = 3;
            put_at(&s, 0, 2, gaps[k]);
            expect(&s, "a corner rebounds", !slides, slides, 1e-7);
            expect_parts(&s, 36);
            close_scene(&s);
        }
}
END_TEST

/* Two roots: a ball on the upper face of a box that leans and turns; the box against a ball of the world. */
START_TEST(bodies_touch_each_other) {
    const rbd_body body[2] = {box(0.4, 0.3, 0.2, 3), box(0.1, 0.12, 0.14, 2)};
    for (int slides = 0; slides < 2; slides++)
        for (int k = 0; k < 3; k++) {
            scene s;
            open_scene(&s, "ball on box", body, 2, 1e-3);
            add_contact(&s, 1, 0, 0.01, 0.02, 0)->radius = 0.1;
            s.list[0].height = 0.1;
            add_contact(&s, -1, 0, 0, 0, -0.25)->radius = 0.15;
            s.list[1].height = 0.1, s.list[1].normal[2] = -1;
            for (int i = 0; i < 2; i++) s.list[i].friction = slides ? 0.05 : 3;
            begin_scene(&s);
            rbd_set_gravity(s.r.w, presses);
            spin(&s, slides ? 2 : 0.02);
            s.q[5] = 0.6, s.q[6] = 0.8, s.q[3] = s.q[4] = 0.02, s.q[9] = 0.2, s.q[10] = 0.6, s.q[13] = 0.8;
            put_at(&s, 1, 2, gaps[k]);
            put_at(&s, 0, 9, gaps[k]);
            expect(&s, "bodies touch each other", slides ? 0 : 2, slides ? 2 : 0, 1e-7);
            close_scene(&s);
        }
}
END_TEST

/* Three points or balls of a box on a plane of the world, or of a second box that leans and turns, at depths
   that differ by millimetres: they act on the plane, and move over the box as it turns. */
START_TEST(three_feet_act_on_the_plane) {
    const rbd_body body[2] = {box(0.4, 0.3, 0.2, 3), box(0.5, 0.6, 0.2, 20)};
    static const double places[3][2] = {{0.2, 0.1}, {-0.2, 0.15}, {-0.05, -0.15}};
    for (int kind = 0; kind < 8; kind++) {
        const int slides = kind & 1, balls = kind & 2, on_body = kind & 4;
        scene s;
        open_scene(&s, "box", body, on_body ? 2 : 1, 1e-3);
        for (int i = 0; i < 3; i++) {
            rbd_contact *a = add_contact(&s, 0, on_body ? 1 : -1, places[i][0], places[i][1], -0.1);
            a->radius = balls ? 0.05 : 0;
            a->friction = slides ? 0.05 : 3;
            a->height = 0.1;
        }
        s.redundant = !slides;
        begin_scene(&s);
        spin(&s, slides ? 1.5 : 0); /* what sticks and turns about the normal contradicts itself a little */
        s.tau[5] = -12000;          /* presses the box down */
        s.q[3] = -0.004;
        s.q[4] = 0.003;
        s.q[5] = 0.6;
        s.q[6] = 0.8;
        if (on_body) {
            s.q[10] = -0.002;
            s.q[13] = sqrt(1 - 4e-6);
        }
        put_at(&s, 0, 2, -3e-3);
        ck_assert_int_ge(compare(&s, "three feet act on the plane", 1e-7), 3 * s.r.nv - 2);
        (void)step_from(&s, s.q, s.v, s.tau);
        ck_assert_int_eq(count(&s, slides ? RBD_SLIPS : RBD_STICKS), 3);
        close_scene(&s);
    }
}
END_TEST

/* With `slip` a block that sticks creeps by so much per newton, and the slopes know it. */
START_TEST(slip_lets_contacts_creep) {
    const rbd_body body = box(0.4, 0.3, 0.2, 3);
    const double gravity[3] = {2, 0, -9};
    scene s;
    double force[3];
    end e;
    open_scene(&s, "box", &body, 1, 1e-3);
    for (int i = 0; i < 4; i++) add_contact(&s, 0, -1, i & 1 ? 0.2 : -0.2, i & 2 ? 0.15 : -0.15, -0.1);
    s.options.slip = 1e-3;
    begin_scene(&s);
    rbd_set_gravity(s.r.w, gravity);
    s.q[2] = 0.1 - 5e-4, s.v[3] = 1e-3;
    e = step_from(&s, s.q, s.v, s.tau);
    for (int i = 0; i < 4; i++) {
        rbd_contact_get(s.c, i, NULL, force);
        ck_assert_double_lt(force[0], -1e-2);
        ck_assert_double_eq_tol(e.v[3], -1e-3 * force[0], 1e-10);
    }
    expect(&s, "slip: a box creeps", 4, 0, 1e-7);
    s.v[3] = 1;
    expect(&s, "slip: a box slides", 0, 4, 1e-7);
    close_scene(&s);
}
END_TEST

/* ---- robots ---- */

static const double hyq_stance[12] = {0, 0, 0, 0, 0.7, 0.7, -0.7, -0.7, -1.4, -1.4, 1.4, 1.4};

/* Stands with its feet in the ground by `depth`, on position controllers. */
static void open_hyq(scene *s, const rbd_body *bodies, double stiffness) {
    open_scene(s, "hyq", bodies, HYQ_NB, 1e-3);
    for (int k = 0; k < 4; k++) {
        rbd_contact *a = add_contact(s, HYQ_BODY_LF_LOWERLEG + k, -1, 0.33, 0, 0);
        a->radius = 0.02, a->friction = 0.7, a->stiffness = stiffness, a->damping = stiffness / 50;
    }
    for (int k = 0; k < 12; k++) s->q[7 + k] = hyq_stance[k], s->damping[6 + k] = 8 + s->h * 300;
}
static void run_hyq(scene *s, int steps, double lift) {
    put_at(s, 0, 2, -5e-4);
    rbd_contact_reset(s->c);
    for (int n = 0; n <= steps; n++) {
        for (int k = 0; k < 12; k++) {
            double wanted = hyq_stance[k];
            if (k % 4 == 0 || k % 4 == 3) wanted += lift * hyq_stance[k] * n / steps;
            s->tau[6 + k] = 300 * (wanted - s->q[7 + k]);
        }
        if (n < steps)
            ck_assert_int_eq(
                rbd_contact_step(s->r.m, s->c, s->q, s->v, s->tau, NULL, s->damping, s->h, s->q, s->v),
                RBD_OK);
    }
}

START_TEST(hyq_stands_trots_and_slips) {
    for (int stiff = 0; stiff < 2; stiff++) {
        scene s;
        open_hyq(&s, hyq_bodies, stiff ? 2e4 : 0);
        begin_scene(&s);
        run_hyq(&s, 50, 0);
        expect(&s, "HyQ stands", 4, 0, 1e-6);
        for (int k = 0; k < 2; k++) s.v[3 + k] += 1;
        expect(&s, "HyQ slips", 0, 4, 1e-6);
        close_scene(&s);
        open_hyq(&s, hyq_bodies, stiff ? 2e4 : 0);
        begin_scene(&s);
        run_hyq(&s, 60, 0.4);
        expect(&s, "HyQ trots", 2, 0, 1e-6);
        close_scene(&s);
    }
}
END_TEST

/* Knees within their limits' reach, dry friction and damping in all joints. */
START_TEST(hyq_at_its_limits) {
    rbd_body bodies[HYQ_NB];
    int at_limit = 0;
    scene s;
    memcpy(bodies, hyq_bodies, sizeof bodies);
    for (int b = 1; b < HYQ_NB; b++) bodies[b].friction[0] = 2, bodies[b].damping[0] = 1;
    for (int b = 1; b < HYQ_NB; b++) bodies[b].lower = -1.4, bodies[b].upper = 1.4;
    open_hyq(&s, bodies, 0);
    s.options.joint_limits = s.options.joint_friction = s.options.joint_damping = 1;
    begin_scene(&s);
    run_hyq(&s, 40, 0);
    for (int k = 8; k < 12; k++) {
        const double side = hyq_stance[k] > 0 ? 1 : -1;
        s.q[7 + k] = side * (k == 8 ? 1.4005 : k == 9 ? 1.404 : k == 10 ? 1.398 : 1.3);
        s.tau[6 + k] = side * 60, s.v[6 + k] = side * (k == 10 ? 3 : 0.9), at_limit += k < 11;
    }
    s.v[6] = 1, s.v[7] = -1;
    expect(&s, "HyQ at its limits", 0, 1, 1e-5);
    ck_assert_int_eq(at_limit, 3);
    close_scene(&s);
}
END_TEST

/* 2 kg at 1 mm/s with 2 N of friction, which a load turns around within the step: it coasts, leaves as fast
   as it came, or slides away. */
START_TEST(dry_friction_turns_around) {
    const double load[3] = {-3, -5, -8}, end[3] = {-0.0005, -0.001, -0.002}, by_v[3] = {1, -1, 1};
    for (int k = 0; k < 3; k++) {
        rbd_body body = {
            .parent = -1, .type = RBD_PRISMATIC, .axis = {1}, .mass = 2, .inertia = {1, 0, 0, 1, 0, 1}};
        double q, v;
        scene s;
        body.friction[0] = 2;
        open_scene(&s, "slider", &body, 1, 1e-3);
        s.options.joint_friction = 1;
        begin_scene(&s);
        s.v[0] = 1e-3, s.tau[0] = load[k];
        ck_assert_int_eq(differentiate(&s, &found, &q, &v), RBD_OK);
        ck_assert_double_eq_tol(v, end[k], 1e-15);
        ck_assert_double_eq_tol(found.by[4][0], by_v[k], 1e-10);
        ck_assert_double_eq_tol(found.by[5][0], k == 1 ? 0 : 5e-4, 1e-10);
        ck_assert_double_eq_tol(found.by[1][0], s.h * (1 + by_v[k]) / 2, 1e-12);
        close_scene(&s);
    }
}
END_TEST

/* Bounded rows of HyQ's legs: one that holds, one that slides, a bristle, one that drives against its bound,
   and one that is not set; and motors that three joints share. In flight, and on the feet. */
START_TEST(hyq_with_bounded_rows) {
    for (int stands = 0; stands < 2; stands++) {
        const rbd_contact_row row[4] = {
            {.dofs = 3, .dof = {6, 10, 14}, .jacobian = {1, -0.5, 0.7}, .lower = -900, .upper = 900},
            {.dofs = 2, .dof = {11, 7}, .jacobian = {1, 2}, .lower = -3, .upper = 2},
            {.dofs = 2,
             .dof = {8, 12},
             .jacobian = {1, -1},
             .bias = 0.2,
             .lower = -500,
             .upper = 500,
             .compliance = 0.4},
            {.dofs = 1, .dof = {17}, .jacobian = {1.5}, .bias = -90, .lower = -30, .upper = 30}};
        const rbd_contact_state wanted[4] = {RBD_STICKS, RBD_SLIPS, RBD_STICKS, RBD_SLIPS};
        double added[18 * 19 / 2] = {0};
        scene s;
        open_hyq(&s, hyq_bodies, 0);
        s.options.rows = 5;
        begin_scene(&s);
        if (stands) run_hyq(&s, 30, 0);
        if (!stands) s.q[2] = 5;
        for (int k = 0; k < s.r.nv; k++) s.v[k] += 0.3 * sin(1 + 5 * k);
        for (int i = 0; i < 4; i++) ck_assert_int_eq(rbd_contact_row_set(s.r.m, s.c, i, &row[i]), RBD_OK);
        for (int i = 0; i < 9; i++)
            added[rbd_packed_index(s.r.m, 9 + i / 3 * 4, 9 + i % 3 * 4)] = i % 4 == 0 ? 0.5 : 0.1;
        ck_assert_int_eq(rbd_contact_inertia(s.r.m, s.c, added), RBD_OK);

        ck_assert_int_eq(compare(&s, stands ? "rows of HyQ on its feet" : "rows of HyQ in flight", 1e-6),
                         3 * s.r.nv);
        for (int i = 0; i < 4; i++) ck_assert_int_eq(rbd_contact_row_get(s.c, i, NULL), wanted[i]);
        expect_parts(&s, s.r.nv * s.r.nv);
        close_scene(&s);
    }
}
END_TEST

/* Both feet flat on the ground, four points each: 24 rows of rank 12. */
START_TEST(atlas_stands) {
    scene s;
    open_scene(&s, "atlas", atlas_bodies, ATLAS_NB, 1e-3);
    const int foot[2] = {rbd_body_index(s.r.m, "l_foot"), rbd_body_index(s.r.m, "r_foot")};
    for (int i = 0; i < 8; i++)
        add_contact(&s, foot[i / 4], -1, i & 1 ? 0.17 : -0.08, i & 2 ? 0.06 : -0.06, -0.08)->friction = 0.8;
    begin_scene(&s);
    for (int k = 6; k < s.r.nv; k++) s.damping[k] = 50;
    put_at(&s, 0, 2, -5e-4);
    expect(&s, "Atlas stands", 8, 0, 1e-6);
    close_scene(&s);
}
END_TEST

/* ---- random trees ---- */

/* A contact between random bodies, at a random gap: of a few kinds that begin_scene's caller meets by gap. */
static void random_contact(scene *s, uint64_t *seed) {
    const int body = below(seed, s->r.nb), other = below(seed, 3) ? -1 : below(seed, s->r.nb);
    rbd_contact *a;
    if (body == other) return;
    a = below(seed, 2) ? add_contact(s, body, other, 0, 0, 0) : add_contact(s, other, body, 0, 0, 0);
    for (int j = 0; j < 3; j++) a->point[j] = uniform(seed, -0.5, 0.5), a->normal[j] = uniform(seed, -1, 1);
    if (below(seed, 2)) a->radius = 0.2;
    a->friction = below(seed, 3) ? uniform(seed, 0.1, 0.6) : 0;
    if (!below(seed, 3)) a->restitution = 0.5;
    if (!below(seed, 3)) a->stiffness = 1e4, a->damping = 100;
}

/* Planes come to gaps of all kinds: in the slop, deeper, apart. */
static void place_planes(scene *s, uint64_t *seed) {
    static const double gaps[3] = {-5e-4, -2e-3, 5e-4};
    (void)step_from(s, s->q, s->v, s->tau);
    for (int i = 0; i < s->n; i++) {
        double gap;
        (void)rbd_contact_get(s->c, i, &gap, NULL);
        ck_assert_int_eq(rbd_contact_plane(s->r.m, s->c, i, s->list[i].normal, gap - gaps[below(seed, 3)]),
                         RBD_OK);
    }
}

/* States of a tree that is not solved mean nothing: its rigid contacts may ask for what no motion has. */
static int agreed, sticking, slipping, unsolved;

static void check_tree(uint64_t *seed, int number) {
    rbd_body bodies[MAX_BODIES];
    const int nb = 1 + below(seed, 10);
    char name[32];
    state x;
    scene s;
    random_tree(seed, bodies, nb);
    for (int i = 0; i < nb; i++)
        if (bodies[i].type == RBD_REVOLUTE && !bodies[i].mimic) {
            bodies[i].friction[0] = 1, bodies[i].damping[0] = 0.3;
            bodies[i].lower = -1, bodies[i].upper = 1;
        }
    snprintf(name, sizeof name, "tree %d", number);
    open_scene(&s, name, bodies, nb, below(seed, 2) ? 1e-3 : 1e-2);
    s.options.joint_limits = s.options.joint_friction = s.options.joint_damping = 1;
    s.options.first_order = number % 4 == 3;
    if (below(seed, 2)) s.options.slip = 1e-5;
    if (nb > 1 && below(seed, 2)) s.held[s.n_held++] = rbd_point_contact(nb - 1, NULL, NULL);
    if (s.n_held) s.held[0].axes[0] = (unsigned char)below(seed, 2), s.held[0].axes[1] = 1;
    for (int k = 0; k < 3; k++) random_contact(&s, seed);
    for (int k = 0; k < s.n && number % 3 == 0; k++) s.list[k].friction *= 20; /* so that more stick */
    if (!try_scene(&s)) { /* two bodies that are fixed to each other */
        close_scene(&s);
        return;
    }
    draw_state(&s.r, seed, &x);
    memcpy(s.q, x.q, sizeof s.q), memcpy(s.v, x.v, sizeof s.v), memcpy(s.tau, x.tau, sizeof s.tau);
    memcpy(s.f_ext, x.f_ext, sizeof s.f_ext);
    for (int k = 0; k < s.r.nv; k++) s.damping[k] = uniform(seed, 0, 2);
    place_planes(&s, seed);
    agreed += compare(&s, "random trees", 1e-5);
    (void)step_from(&s, s.q, s.v, s.tau);
    if (rbd_contact_last(s.c).residual <= 1e-11)
        sticking += count(&s, RBD_STICKS), slipping += count(&s, RBD_SLIPS);
    else
        unsolved++;
    close_scene(&s);
}

START_TEST(random_trees) {
    agreed = sticking = slipping = unsolved = 0;
    for (int i = 0; i < 120 / PART_OF_TREES; i++) {
        uint64_t seed = 500 + (uint64_t)i;
        check_tree(&seed, i);
    }
    ck_assert_int_ge(agreed, OF_TREES(2850));
    ck_assert_int_ge(sticking, OF_TREES(10));
    ck_assert_int_ge(slipping, OF_TREES(95));
    ck_assert_int_le(unsolved, PART_OF_TREES == 1 ? 30 : 60 / PART_OF_TREES);
}
END_TEST

/* ---- the calls ---- */

/* A hinged rod with a ball at its end, on a floating box. */
static void open_rod(scene *s, const rbd_body bodies[2]) {
    open_scene(s, "rod", bodies, 2, 1e-3);
    add_contact(s, 1, -1, 0.5, 0, 0)->radius = 0.05;
    s->list[0].height = -0.6;
}
static rbd_body rod(void) {
    rbd_body b = {.parent = 0, .type = RBD_REVOLUTE, .axis = {0, 1, 0}, .mass = 1, .com = {0.25, 0, 0}};
    b.inertia[0] = 0.001, b.inertia[3] = b.inertia[5] = 0.02;
    return b;
}

/* A strut that jams, as in test_contact_step.c: it is not lifted, so positions have no derivatives of their
   own, and move as velocities do. */
START_TEST(strut_jams) {
    const rbd_body body = {.parent = -1,
                           .type = RBD_REVOLUTE,
                           .axis = {0, 1, 0},
                           .position = {0, 0, 1},
                           .mass = 1,
                           .com = {0, 0, -0.5},
                           .inertia = {0.1, 0, 0, 0.1, 0, 0.1}};
    const double t = 1e-7;
    double q[3], v[3], by_q, by_v, by_tau, dv_dq, dv_dv, dv_dtau;
    scene s;
    open_scene(&s, "strut", &body, 1, 1e-3);
    s.options.tolerance = 0, s.options.iterations = 0, s.options.slop = 0; /* the defaults */
    add_contact(&s, 0, -1, 0.2, 0, -1 - 1e-3)->friction = 0.8;
    begin_scene(&s);
    s.tau[0] = 20;
    for (int k = 0; k < 3; k++) {
        const double at = (k - 1) * t;
        rbd_contact_reset(s.c);
        ck_assert_int_eq(rbd_contact_step(s.r.m, s.c, &at, s.v, s.tau, NULL, s.damping, s.h, &q[k], &v[k]),
                         RBD_OK);
        ck_assert_double_gt(rbd_contact_last(s.c).residual, 1e-2);
    }

    const rbd_contact_step_results out = {q, v, &by_q, &by_v, &by_tau, &dv_dq, &dv_dv, &dv_dtau};
    const double difference = (q[2] - q[0]) / (2 * t), of_speeds = (v[2] - v[0]) / (2 * t);
    rbd_contact_reset(s.c);
    ck_assert_int_eq(
        rbd_contact_step_derivatives(s.r.m, s.c, s.d, s.q, s.v, s.tau, NULL, s.damping, s.h, &out), RBD_OK);
    ck_assert_double_eq_tol(difference, 1, 1e-6); /* it stays where it is */
    ck_assert_double_eq_tol(by_q, difference, 1e-6);
    ck_assert_double_eq_tol(by_v, s.h / 2, 1e-9);
    ck_assert_double_eq_tol(by_tau, 0, 1e-9);

    ck_assert_double_eq_tol(dv_dq, of_speeds, 1e-6);
    ck_assert_double_eq_tol(dv_dv, 0, 1e-9); /* what jams stops */
    ck_assert_double_eq_tol(dv_dtau, 0, 1e-9);
    close_scene(&s);
}
END_TEST

/* Results left out change nothing in the others; without contacts it is rbd_fd_derivatives; zeros that
   rbd_keep_zeros leaves out are written. */
START_TEST(parts_are_as_the_whole) {
    const rbd_body bodies[2] = {box(0.4, 0.3, 0.2, 3), rod()};
    const double rest[MAX_V] = {0}, gravity[3] = {0, 0, -9.81};
    double q[MAX_Q], v[MAX_V], tau[MAX_V], f_ext[6 * MAX_BODIES], a[MAX_V], Minv[MAX_V * MAX_V];
    scene s;
    open_rod(&s, bodies);
    begin_scene(&s);
    spin(&s, 1);
    expect(&s, "a rod in the air", 0, 0, 1e-7);
    rbd_set_gravity(s.r.w, rest);
    ck_assert_int_eq(rbd_fd_derivatives(s.r.m, s.d, s.q, rest, rest, NULL, a, NULL, NULL, Minv), RBD_OK);
    memcpy(v, s.v, sizeof v), memcpy(tau, s.tau, sizeof tau), memcpy(f_ext, s.f_ext, sizeof f_ext);
    memset(s.v, 0, sizeof s.v), memset(s.tau, 0, sizeof s.tau), memset(s.f_ext, 0, sizeof s.f_ext);
    ck_assert_int_eq(differentiate(&s, &found, NULL, NULL), RBD_OK);
    for (int k = 0; k < 7; k++) /* of the rod, whose step is a sum, at rest */
        ck_assert_double_eq_tol(found.by[5][6 * 7 + k], s.h * Minv[6 * 7 + k], 1e-12);
    memcpy(s.v, v, sizeof v), memcpy(s.tau, tau, sizeof tau), memcpy(s.f_ext, f_ext, sizeof f_ext);
    rbd_set_gravity(s.r.w, gravity);
    put_at(&s, 0, 2, -5e-4);
    for (int keep = 0; keep < 2; keep++) {
        ck_assert_int_eq(rbd_keep_zeros(s.d, keep), RBD_OK);
        expect(&s, "a rod touches", 0, 1, 1e-7);
        expect_parts(&s, 49);
    }
    memcpy(q, s.q, sizeof q), memcpy(v, s.v, sizeof v); /* in place */
    rbd_contact_reset(s.c);
    ck_assert_int_eq(differentiate(&s, &found, s.q, s.v), RBD_OK);
    {
        const end e = step_from(&s, q, v, s.tau);
        ck_assert_mem_eq(s.q, e.q, 8 * sizeof(double));
        ck_assert_mem_eq(s.v, e.v, 7 * sizeof(double));
    }
    close_scene(&s);
}
END_TEST

START_TEST(bad_calls_are_refused) {
    const rbd_body bodies[2] = {box(0.4, 0.3, 0.2, 3), rod()};
    static columns x;
    const rbd_contact_step_results whole = {NULL, NULL, x.by[0], x.by[1], x.by[2], x.by[3], x.by[4], x.by[5]};
    rbd_contact_step_results out;
    scene s, other;
    double q[MAX_Q], v[MAX_V];
    open_rod(&s, bodies);
    begin_scene(&s);
    open_rod(&other, bodies);
    other.options.derivatives = 0;
    begin_scene(&other);
    ck_assert_uint_lt(rbd_contact_set_size(s.r.m, s.n, NULL, 0, &other.options),
                      rbd_contact_set_size(s.r.m, s.n, NULL, 0, &s.options));
#define CALL(m, c, d, q, v, tau, h, out) rbd_contact_step_derivatives(m, c, d, q, v, tau, NULL, NULL, h, out)
    ck_assert_int_eq(CALL(NULL, s.c, s.d, s.q, s.v, s.tau, s.h, &whole), RBD_ERR_NULL);
    ck_assert_int_eq(CALL(s.r.m, NULL, s.d, s.q, s.v, s.tau, s.h, &whole), RBD_ERR_NULL);
    ck_assert_int_eq(CALL(s.r.m, s.c, NULL, s.q, s.v, s.tau, s.h, &whole), RBD_ERR_NULL);
    ck_assert_int_eq(CALL(s.r.m, s.c, s.d, NULL, s.v, s.tau, s.h, &whole), RBD_ERR_NULL);
    ck_assert_int_eq(CALL(s.r.m, s.c, s.d, s.q, NULL, s.tau, s.h, &whole), RBD_ERR_NULL);
    ck_assert_int_eq(CALL(s.r.m, s.c, s.d, s.q, s.v, NULL, s.h, &whole), RBD_ERR_NULL);
    ck_assert_int_eq(CALL(s.r.m, s.c, s.d, s.q, s.v, s.tau, s.h, NULL), RBD_ERR_NULL);
    out = whole, out.q_next = q;
    ck_assert_int_eq(CALL(s.r.m, s.c, s.d, s.q, s.v, s.tau, s.h, &out), RBD_ERR_NULL);
    out = whole, out.dq_next_dq = NULL;
    ck_assert_int_eq(CALL(s.r.m, s.c, s.d, s.q, s.v, s.tau, s.h, &out), RBD_ERR_NULL);
    out = whole, out.dv_next_dtau = NULL;
    ck_assert_int_eq(CALL(s.r.m, s.c, s.d, s.q, s.v, s.tau, s.h, &out), RBD_ERR_NULL);
    ck_assert_int_eq(CALL(s.r.m, s.c, s.d, s.q, s.v, s.tau, 0, &whole), RBD_ERR_RANGE);
    ck_assert_int_eq(CALL(s.r.m, s.c, other.d, s.q, s.v, s.tau, s.h, &whole), RBD_ERR_WORK);
    {
        const size_t size[2] = {rbd_work_size(s.r.m), rbd_derivatives_size(s.r.m)};
        void *memory[2] = {malloc(size[0]), malloc(size[1])};
        rbd_derivatives *d;
        rbd_work *w;
        ck_assert_int_eq(rbd_work_init(s.r.m, memory[0], size[0], &w), RBD_OK);
        ck_assert_int_eq(rbd_derivatives_init(s.r.m, w, memory[1], size[1], &d), RBD_OK);
        ck_assert_int_eq(CALL(s.r.m, s.c, d, s.q, s.v, s.tau, s.h, &whole), RBD_ERR_WORK);
        for (int i = 0; i < 2; i++) free(memory[i]);
    }
    ck_assert_int_eq(CALL(other.r.m, other.c, other.d, s.q, s.v, s.tau, s.h, &whole), RBD_ERR_MEMORY);
    ck_assert_int_eq(CALL(s.r.m, s.c, s.d, s.q, s.v, s.tau, s.h, &whole), RBD_OK);
    out = whole, out.q_next = q, out.v_next = v;
    s.q[7] = NAN;
    ck_assert_int_eq(CALL(s.r.m, s.c, s.d, s.q, s.v, s.tau, s.h, &out), RBD_ERR_NAN);
    ck_assert_double_eq(largest(v, 7), 0);
    for (int k = 0; k < 6; k++) ck_assert_double_eq(largest(x.by[k], 49), 0);
    out.dq_next_dv = out.dv_next_dv = NULL;
    ck_assert_int_eq(CALL(s.r.m, s.c, s.d, s.q, s.v, s.tau, s.h, &out), RBD_ERR_NAN);
    out = whole, out.q_next = q, out.v_next = v;
    s.q[7] = 0, s.v[0] = NAN;
    memset(&x, 0xff, sizeof x);
    ck_assert_int_eq(CALL(s.r.m, s.c, s.d, s.q, s.v, s.tau, s.h, &out), RBD_ERR_NAN);
    ck_assert_double_eq(largest(v, 7), 0);
    for (int k = 0; k < 6; k++) ck_assert_double_eq(largest(x.by[k], 49), 0);
#undef CALL
    other.options.slip = -1;
    ck_assert_int_eq(rbd_contact_set_init(s.r.m, s.r.w, s.list, 1, NULL, 0, &other.options, s.memory[0],
                                          1 << 20, &s.c, NULL),
                     RBD_ERR_RANGE);
    close_scene(&s), close_scene(&other);
}
END_TEST

Suite *contact_derivatives_suite(void) {
    Suite *suite = suite_create("contact_derivatives");
    TCase *c = tcase_create("contact_derivatives"), *slow = slow_tests(suite);
    tcase_set_timeout(c, 60);
    suite_add_tcase(suite, c);
    tcase_add_test(c, ball_rolls_and_slides);
    tcase_add_test(c, box_rests_and_slides);
    tcase_add_test(c, corner_rebounds);
    tcase_add_test(c, bodies_touch_each_other);
    tcase_add_test(c, three_feet_act_on_the_plane);
    tcase_add_test(c, slip_lets_contacts_creep);
    tcase_add_test(slow, hyq_stands_trots_and_slips);
    tcase_add_test(slow, hyq_at_its_limits);
    tcase_add_test(slow, hyq_with_bounded_rows);
    tcase_add_test(c, dry_friction_turns_around);
    tcase_add_test(slow, atlas_stands);
    tcase_add_test(slow, random_trees);
    tcase_add_test(c, strut_jams);
    tcase_add_test(c, parts_are_as_the_whole);
    tcase_add_test(c, bad_calls_are_refused);
    return suite;
}
