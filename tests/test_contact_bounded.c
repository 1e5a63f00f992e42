/* test_contact_bounded.c - rbd_contact.h: bounded rows, dry friction as rows, and a matrix added to M. */
#include <math.h>
#include <string.h>

#include "rbd_contact.h"

#include "suites.h"
#include "support.h"

#include "models/hyq.h"
#include "models/iiwa.h"

enum { ROWS = 12 };

static const double steps[3] = {5e-4, 1e-3, 1e-2};

/* ---- scenes ---- */

/* A robot with so many bounded rows and no contacts, and the state that steps take it through. */
typedef struct scene {
    robot r;
    rbd_contact_options options;
    rbd_contact_set *c;
    void *memory;
    double q[MAX_Q], v[MAX_V], tau[MAX_V], damping[MAX_V], h;
} scene;

static void open_scene(scene *s, const char *name, const rbd_body *bodies, int nb, int rows, double h) {
    memset(s, 0, sizeof *s);
    s->r = robot_build(name, bodies, nb);
    s->options.rows = rows;
    s->options.tolerance = 1e-13, s->options.iterations = 1000;
    s->h = h;
    rbd_neutral(s->r.m, s->q);
}

static void begin_scene(scene *s) {
    const size_t size = rbd_contact_set_size(s->r.m, 0, NULL, 0, &s->options);
    ck_assert_uint_gt(size, 0);
    ck_assert_uint_le(size, RBD_CONTACT_SET_SIZE(s->r.nv, 0, 3 * s->r.nv + s->options.rows));
    s->memory = memset(malloc(size), 0xff, size); /* NaN: what was never written shows */
    ck_assert_int_eq(
        rbd_contact_set_init(s->r.m, s->r.w, NULL, 0, NULL, 0, &s->options, s->memory, size, &s->c, NULL),
        RBD_OK);
}

static void close_scene(scene *s) {
    free(s->memory);
    robot_free(&s->r);
}

static void step(scene *s) {
    ck_assert_int_eq(rbd_contact_step(s->r.m, s->c, s->q, s->v, s->tau, NULL, s->damping, s->h, s->q, s->v),
                     RBD_OK);
    ck_assert_double_le(rbd_contact_last(s->c).residual, 1e-6);
}

static void set_row(scene *s, int i, rbd_contact_row row) {
    ck_assert_int_eq(rbd_contact_row_set(s->r.m, s->c, i, &row), RBD_OK);
}

/* The row of one dof that brakes with up to `bound`. */
static rbd_contact_row friction_row(int dof, double bound) {
    const rbd_contact_row row = {.dofs = 1, .dof = {dof}, .jacobian = {1}, .lower = -bound, .upper = bound};
    return row;
}

static double energy(const scene *s) {
    double K, U;
    ck_assert_int_eq(rbd_kinematics(s->r.m, s->r.w, s->q, s->v, NULL), RBD_OK);
    ck_assert_int_eq(rbd_energy(s->r.m, s->r.w, &K, &U), RBD_OK);
    return K + U;
}

static double speed_of(const rbd_contact_row *row, const double *v) {
    double u = 0;
    for (int j = 0; j < row->dofs; j++) u += row->jacobian[j] * v[row->dof[j]];
    return u;
}

/* A mass on a rail. */
static rbd_body slider(int parent, double x, double y, double mass) {
    rbd_body b = {.parent = parent, .type = RBD_PRISMATIC, .axis = {x, y, 0}, .mass = mass};
    if (mass > 0) b.inertia[0] = b.inertia[3] = b.inertia[5] = 0.1 * mass;
    return b;
}

/* A row of one to three dofs of the robot, drawn. */
static rbd_contact_row draw_row(const robot *r, uint64_t *seed, double most) {
    rbd_contact_row row = {0};
    const int n = r->nv < 3 ? r->nv : 3, first = below(seed, r->nv);
    row.dofs = 1 + below(seed, n);
    for (int j = 0; j < row.dofs; j++) {
        row.dof[j] = (first + j) % r->nv;
        row.jacobian[j] = uniform(seed, -2, 2);
    }
    row.lower = -uniform(seed, 0, most);
    row.upper = uniform(seed, 0, most);
    return row;
}

/* ---- dry friction ---- */

static const double bent[IIWA_NV] = {0.3, 0.8, -0.5, -1.2, 0.6, 0.9, 0.2};

/* An iiwa whose joints brake with so many times its gravity torque. Returns how far it moves in 2 s. */
static double held_iiwa(double share, int rows, double h, double tolerance) {
    rbd_body bodies[IIWA_NB];
    double g[IIWA_NV], far = 0;
    scene s;
    robot r = robot_build("iiwa", iiwa_bodies, IIWA_NB);
    memcpy(bodies, iiwa_bodies, sizeof bodies);
    ck_assert_int_eq(rbd_gravity_torque(r.m, r.w, bent, g), RBD_OK);
    for (int k = 0; k < IIWA_NV; k++) bodies[k].friction[0] = fabs(g[k]) * share;
    robot_free(&r);

    open_scene(&s, "iiwa", bodies, IIWA_NB, rows ? IIWA_NV : 0, h);
    s.options.joint_friction = !rows;
    s.options.tolerance = tolerance;
    begin_scene(&s);
    for (int k = 0; rows && k < IIWA_NV; k++) set_row(&s, k, friction_row(k, fabs(g[k]) * share));
    memcpy(s.q, bent, sizeof bent);
    for (int n = (int)(2 / h + 0.5); n > 0; n--) step(&s);

    for (int k = 0; k < IIWA_NV; k++) far = larger(far, fabs(s.q[k] - bent[k]));
    close_scene(&s);
    return far;
}

START_TEST(iiwa_is_held_by_a_billionth_more_than_its_weight) {
    for (int k = 0; k < 3; k++)
        for (int rows = 0; rows < 2; rows++) {
            expect_figure(15, "iiwa held by a billionth more than its weight: moves by, rad",
                          held_iiwa(1 + 1e-9, rows, steps[k], 1e-13), 0, 1e-15);
            expect_figure(15, "the same with the default tolerance: moves by, rad",
                          held_iiwa(1 + 1e-9, rows, steps[k], 0), 0, 1e-6);
            ck_assert_double_gt(held_iiwa(0.99, rows, steps[k], 1e-13), 1e-3);
        }
}
END_TEST

/* An iiwa that slides and sticks: by friction of its description, by rows, and by friction that is set. */
START_TEST(rows_are_as_the_friction_of_the_description) {
    rbd_body bodies[IIWA_NB];
    scene s[3];
    int sticks = 0, slips = 0, turns = 0;
    memcpy(bodies, iiwa_bodies, sizeof bodies);
    for (int x = 0; x < 3; x++) {
        for (int k = 0; k < IIWA_NV; k++) bodies[k].friction[0] = x == 2 ? 100 : 3 - 0.3 * k;
        open_scene(&s[x], "iiwa", bodies, IIWA_NB, x == 1 ? IIWA_NV : 0, 1e-3);
        s[x].options.joint_friction = x != 1;
        begin_scene(&s[x]);
        memcpy(s[x].q, bent, sizeof bent);
        for (int k = 0; x == 1 && k < IIWA_NV; k++) set_row(&s[x], k, friction_row(k, 3 - 0.3 * k));
        for (int k = 0; x == 2 && k < IIWA_NV; k++)
            ck_assert_int_eq(rbd_contact_friction(s[x].r.m, s[x].c, k, 3 - 0.3 * k), RBD_OK);
    }

    for (int n = 0; n < 1000; n++) {
        double g[IIWA_NV];
        ck_assert_int_eq(rbd_gravity_torque(s[0].r.m, s[0].r.w, s[0].q, g), RBD_OK);
        for (int x = 0; x < 3; x++)
            for (int k = 0; k < IIWA_NV; k++) s[x].tau[k] = g[k] + (4 - 0.4 * k) * sin(0.01 * n * (1 + k));
        for (int x = 0; x < 3; x++) step(&s[x]);
        for (int k = 0; k < IIWA_NV; k++) {
            double f;
            const rbd_contact_state state = rbd_contact_row_get(s[1].c, k, &f);
            sticks += state == RBD_STICKS;
            slips += state == RBD_SLIPS;
            turns += state == RBD_SLIPS && fabs(f) < 3 - 0.3 * k;
            if (state == RBD_STICKS) ck_assert_double_le(fabs(s[1].v[k]), 1e-12);
        }
    }
    for (int x = 1; x < 3; x++) {
        ck_assert_double_le(relative_error(s[x].q, s[0].q, IIWA_NV), 1e-12);
        ck_assert_double_le(relative_error(s[x].v, s[0].v, IIWA_NV), 1e-12);
    }
    ck_assert_int_gt(sticks, 500);
    ck_assert_int_gt(slips, 500);
    ck_assert_int_lt(turns, slips / 10);
    for (int x = 0; x < 3; x++) close_scene(&s[x]);
}
END_TEST

/* A mass of 2 kg at 3 m/s, braked with 5 N by the cable of a lever: J = 2 gives 10 N. Before it stops it has
   v = 3 - 5 t exactly; then it stands. A motor of 9 N does not move it, one of 11 N by 0.5 m/s^2. */
START_TEST(a_lever_slides_and_sticks_exactly) {
    for (int k = 0; k < 3; k++) {
        const rbd_body body = slider(-1, 1, 0, 2);
        rbd_contact_row row = friction_row(0, 5);
        double f;
        scene s;
        open_scene(&s, "slider", &body, 1, 1, steps[k]);
        begin_scene(&s);
        row.jacobian[0] = 2;
        set_row(&s, 0, row);

        s.v[0] = 3;
        for (int n = (int)(0.5 / s.h + 0.5); n > 0; n--) step(&s);
        ck_assert_double_eq_tol(s.v[0], 0.5, 1e-12);
        ck_assert_int_eq(rbd_contact_row_get(s.c, 0, &f), RBD_SLIPS);
        ck_assert_double_eq(f, -5);

        for (int n = (int)(0.2 / s.h + 0.5); n > 0; n--) step(&s);
        s.tau[0] = 9;
        step(&s);
        ck_assert_double_le(fabs(s.v[0]), 1e-15);
        ck_assert_int_eq(rbd_contact_row_get(s.c, 0, &f), RBD_STICKS);
        ck_assert_double_eq_tol(f, -4.5, 1e-12);

        s.tau[0] = 11;
        step(&s);
        ck_assert_double_eq_tol(s.v[0], 0.5 * s.h, 1e-14);
        close_scene(&s);
    }
}
END_TEST

/* A row with a bias is a motor of so much speed, up to its force; one whose bounds are equal is a force,
   with a bias or without. */
START_TEST(a_bias_drives_and_equal_bounds_push) {
    const rbd_body body = slider(-1, 1, 0, 2);
    rbd_contact_row row = friction_row(0, 10);
    double f;
    scene s;
    open_scene(&s, "slider", &body, 1, 1, 1e-3);
    begin_scene(&s);
    row.bias = -0.1;
    set_row(&s, 0, row);
    for (int n = 0; n < 10; n++) step(&s);
    ck_assert_double_eq_tol(s.v[0], 0.05, 1e-13); /* 10 N on 2 kg */
    for (int n = 0; n < 20; n++) step(&s);
    ck_assert_double_eq_tol(s.v[0], 0.1, 1e-13);

    row.lower = row.upper = 4;
    set_row(&s, 0, row);
    step(&s);
    ck_assert_double_eq_tol(s.v[0], 0.102, 1e-13);
    (void)rbd_contact_row_get(s.c, 0, &f);
    ck_assert_double_eq(f, 4);

    row.bias = 0;
    for (int k = 0; k < 2; k++) {
        row.lower = row.upper = k ? 4 : -4;
        set_row(&s, 0, row);
        step(&s);
        ck_assert_double_eq_tol(s.v[0], k ? 0.102 : 0.1, 1e-13);
        (void)rbd_contact_row_get(s.c, 0, &f);
        ck_assert_double_eq(f, row.lower);
    }

    row.dofs = 0;
    set_row(&s, 0, row);
    step(&s);
    ck_assert_double_eq_tol(s.v[0], 0.102, 1e-13);
    ck_assert_int_eq(rbd_contact_row_get(s.c, 0, &f), RBD_APART);
    ck_assert_double_eq(f, 0);
    close_scene(&s);
}
END_TEST

/* ---- bristles ---- */

/* The bristle of 1e4 N/m in a rail whose breakaway is 1 N holds 0.3 N: 30 um, after 1 s and after 9 s, at
   every dt. Released, it gives back what it took; above breakaway it slides. */
START_TEST(a_bristle_holds_below_breakaway_without_drift) {
    for (int k = 0; k < 3; k++) {
        const rbd_body body = slider(-1, 1, 0, 0.5);
        const double stiffness = 1e4;
        rbd_contact_row row = friction_row(0, 1);
        double z = 0, f = 0;
        scene s;
        open_scene(&s, "slider", &body, 1, 1, steps[k]);
        begin_scene(&s);
        s.damping[0] = 100;
        row.compliance = 1 / (s.h * s.h * stiffness);
        for (int n = 0, seconds = (int)(1 / s.h + 0.5); n < 11 * seconds; n++) {
            s.tau[0] = n < 9 * seconds ? 0.3 : n < 10 * seconds ? 0 : 1.5;
            row.bias = z / s.h;
            set_row(&s, 0, row);
            step(&s);
            (void)rbd_contact_row_get(s.c, 0, &f);
            z = -f / stiffness;
            if (n == seconds - 1) ck_assert_double_eq_tol(s.q[0], 3e-5, 1e-12);
            if (n == 9 * seconds - 1) ck_assert_double_eq_tol(s.q[0], 3e-5, 1e-15);
            if (n == 10 * seconds - 1) ck_assert_double_eq_tol(s.q[0], 0, 1e-12);
        }
        ck_assert_double_eq(f, -1);
        ck_assert_double_eq_tol(s.v[0], 0.005, 1e-4); /* 0.5 N of 100 N s/m */
        close_scene(&s);
    }
}
END_TEST

/* ---- energy ---- */

/* Rows that oppose any motion: one is drawn anew at each step, the others stay until the masses stop or turn
   around under their weight. Masses on rails have no velocity terms, so only rows change their energy. */
START_TEST(rows_never_raise_the_energy) {
    uint64_t seed = 1;
    for (int k = 0; k < 3; k++) {
        const rbd_body bodies[4] = {slider(-1, 1, 0, 2), slider(0, 1, 1, 0.5), slider(1, 0, 1, 1),
                                    slider(2, 1, -3, 0.1)};
        double before;
        scene s;
        open_scene(&s, "rails", bodies, 4, 4, steps[k]);
        begin_scene(&s);
        ck_assert_int_eq(rbd_set_gravity(s.r.w, (const double[3]){1, -2, 0}), RBD_OK);
        for (int n = 0; n < 2000; n++) {
            if (n % 100 == 0)
                for (int i = 0; i < 4; i++) s.v[i] = uniform(&seed, -0.3, 0.3);
            for (int i = 0; i < 4; i++)
                if (i < 1 || n % 100 == 0) set_row(&s, i, draw_row(&s.r, &seed, 8));
            before = energy(&s);
            step(&s);
            ck_assert_msg(energy(&s) - before < 1e-12, "%g at %d dt %g", energy(&s) - before, n, s.h);
        }
        close_scene(&s);
    }
}
END_TEST

/* Bristles of all stiffnesses between the same masses: kinetic energy and that in the bristles. */
START_TEST(bristles_never_raise_the_energy) {
    uint64_t seed = 2;
    for (int k = 0; k < 3; k++) {
        const rbd_body bodies[4] = {slider(-1, 1, 0, 2), slider(0, 1, 1, 0.5), slider(1, 0, 1, 1),
                                    slider(2, 1, -3, 0.1)};
        rbd_contact_row row[ROWS];
        double z[ROWS] = {0}, stiffness[ROWS], before;
        scene s;
        open_scene(&s, "rails", bodies, 4, ROWS, steps[k]);
        begin_scene(&s);
        for (int i = 0; i < 4; i++) s.v[i] = uniform(&seed, -3, 3);
        for (int i = 0; i < ROWS; i++) {
            row[i] = draw_row(&s.r, &seed, 2);
            stiffness[i] = pow(10, uniform(&seed, 1, 7));
            row[i].compliance = 1 / (s.h * s.h * stiffness[i]);
        }
        before = energy(&s);
        for (int n = 0; n < 1000; n++) {
            double after;
            for (int i = 0; i < ROWS; i++) {
                row[i].bias = z[i] / s.h;
                set_row(&s, i, row[i]);
            }
            step(&s);
            after = energy(&s);
            for (int i = 0; i < ROWS; i++) {
                double f;
                (void)rbd_contact_row_get(s.c, i, &f);
                z[i] = -f / stiffness[i];
                after += stiffness[i] * z[i] * z[i] / 2;
            }
            ck_assert_msg(after <= before * (1 + 1e-13) + 1e-25, "%g of %g at step %d", after - before,
                          before, n);
            before = after;
        }
        close_scene(&s);
    }
}
END_TEST

/* Rows of the tree's joints of one dof, whose v_next is the solution's. Returns how many. */
static int draw_rows(const robot *r, uint64_t *seed, rbd_contact_row *row) {
    int dof[MAX_V], dofs = 0;
    for (int k = 0; k < r->nv; k++) {
        rbd_joint_info info;
        ck_assert_int_eq(rbd_joint(r->m, rbd_dof_body(r->m, k), &info), RBD_OK);
        if (info.nv == 1) dof[dofs++] = k;
    }

    for (int i = 0; i < ROWS && dofs > 0; i++) {
        const int first = below(seed, dofs);
        row[i] = draw_row(r, seed, 20);
        if (row[i].dofs > dofs) row[i].dofs = dofs;
        for (int j = 0; j < row[i].dofs; j++) row[i].dof[j] = dof[(first + j) % dofs];
    }
    return dofs > 0 ? ROWS : 0;
}

static int powers[2]; /* rows that stuck, and that slipped */

/* The force of a row opposes its speed with all that it has, or the row sticks: at the end of a step of first
   order. */
static void check_power(const robot *r, const state *x, int number) {
    const double tolerance = 1e-10;
    uint64_t seed = (uint64_t)number + 1;
    rbd_contact_options options = {.rows = ROWS, .tolerance = tolerance, .iterations = 400, .first_order = 1};
    const size_t size = rbd_contact_set_size(r->m, 0, NULL, 0, &options);
    void *memory = memset(malloc(size), 0xff, size);
    rbd_contact_row row[ROWS];
    double q[MAX_Q], v[MAX_V];
    rbd_contact_set *c;
    const int n = draw_rows(r, &seed, row);
    ck_assert_int_eq(rbd_contact_set_init(r->m, r->w, NULL, 0, NULL, 0, &options, memory, size, &c, NULL),
                     RBD_OK);
    for (int i = 0; i < n; i++) ck_assert_int_eq(rbd_contact_row_set(r->m, c, i, &row[i]), RBD_OK);

    if (rbd_contact_step(r->m, c, x->q, x->v, x->tau, NULL, NULL, 1e-3, q, v) == RBD_OK)
        for (int i = 0; i < n && rbd_contact_last(c).residual <= tolerance; i++) {
            double f;
            const rbd_contact_state state = rbd_contact_row_get(c, i, &f);
            const double u = speed_of(&row[i], v), rounding = 1e-9 * (1 + largest(v, r->nv));
            ck_assert_double_ge(f, row[i].lower * (1 + 1e-15));
            ck_assert_double_le(f, row[i].upper * (1 + 1e-15));
            if (state == RBD_STICKS) ck_assert_double_le(fabs(u), rounding);
            if (state == RBD_SLIPS && fabs(u) > rounding)
                ck_assert_double_eq(f, u > 0 ? row[i].lower : row[i].upper);
            ++powers[state == RBD_SLIPS];
        }
    free(memory);
}

START_TEST(rows_of_trees_oppose_motion) {
    for_random_trees(400, check_power);
    ck_assert_int_ge(powers[0], OF_TREES(400));
    ck_assert_int_ge(powers[1], OF_TREES(1000));
}
END_TEST

/* ---- a matrix added to M ---- */

/* Two motors drive a head of 3 kg in a plane by one belt: their speeds are x + y and x - y. In coordinates
   along the diagonals each motor has a joint of its own: with speed s of such a joint the motor turns by
   sqrt(2) s. There armature, damping and friction of the description are the same machine. */
START_TEST(a_belt_of_two_motors_is_as_joints_along_the_diagonals) {
    for (int k = 0; k < 3; k++) {
        const double J = 0.7, D = 1.5, F = 2, half = sqrt(0.5), h = steps[k];
        const rbd_body belt[2] = {slider(-1, 1, 0, 0), slider(0, 0, 1, 3)};
        rbd_body diagonal[2] = {slider(-1, 1, 1, 0), slider(0, 1, -1, 3)};
        double added[3] = {0}, worst = 0;
        int sticks = 0, slips = 0;
        scene s[2];
        for (int i = 0; i < 2; i++) {
            diagonal[i].armature[0] = 2 * J, diagonal[i].damping[0] = 2 * D;
            diagonal[i].friction[0] = sqrt(2) * F;
        }
        open_scene(&s[0], "belt", belt, 2, 2, h);
        open_scene(&s[1], "diagonal", diagonal, 2, 0, h);
        s[1].options.joint_friction = s[1].options.joint_damping = 1;
        for (int x = 0; x < 2; x++) {
            begin_scene(&s[x]);
        }

        /* G = [1 1; 1 -1], G'(J + h D)G = 2 (J + h D) 1 */
        for (int i = 0; i < 2; i++) {
            const rbd_contact_row row = {
                .dofs = 2, .dof = {1, 0}, .jacobian = {i == 0 ? 1 : -1, 1}, .lower = -F, .upper = F};
            added[rbd_packed_index(s[0].r.m, i, i)] = 2 * (J + h * D);
            set_row(&s[0], i, row);
        }
        ck_assert_int_eq(rbd_contact_inertia(s[0].r.m, s[0].c, added), RBD_OK);

        for (int n = 0; n < 1000; n++) {
            double along[2], wanted[2], torque[2];
            for (int i = 0; i < 2; i++) torque[i] = 4 * sin(0.02 * n * (1 + 0.3 * i)); /* of the motors */
            s[0].tau[0] = torque[0] + torque[1] - 2 * D * s[0].v[0];
            s[0].tau[1] = torque[0] - torque[1] - 2 * D * s[0].v[1];
            for (int i = 0; i < 2; i++) s[1].tau[i] = sqrt(2) * torque[i];
            for (int x = 0; x < 2; x++) step(&s[x]);
            for (int i = 0; i < 2; i++) {
                const rbd_contact_state state = rbd_contact_row_get(s[0].c, i, NULL);
                sticks += state == RBD_STICKS;
                slips += state == RBD_SLIPS;
            }
            along[0] = half * (s[1].v[0] + s[1].v[1]), along[1] = half * (s[1].v[0] - s[1].v[1]);
            wanted[0] = half * (s[1].q[0] + s[1].q[1]), wanted[1] = half * (s[1].q[0] - s[1].q[1]);
            for (int i = 0; i < 2; i++)
                worst = larger(worst, fabs(s[0].v[i] - along[i]) + fabs(s[0].q[i] - wanted[i]));
        }
        ck_assert_msg(worst <= 1e-12, "differ by %g", worst);
        ck_assert_int_gt(sticks, 50);
        ck_assert_int_gt(slips, 500);
        for (int x = 0; x < 2; x++) close_scene(&s[x]);
    }
}
END_TEST

/* (M + A) a + c = tau - J' f of the dense M, for three joints that share motors in an iiwa, and armature as a
   diagonal of A. */
START_TEST(an_added_matrix_is_in_the_equations) {
    uint64_t seed = 3;
    for (int number = 0; number < 20; number++) {
        double M[IIWA_NV * IIWA_NV], A[28], G[9], bias[IIWA_NV], a[IIWA_NV], left[IIWA_NV];
        scene s;
        open_scene(&s, "iiwa", iiwa_bodies, IIWA_NB, 0, 1e-3);
        begin_scene(&s);
        for (int k = 0; k < IIWA_NV; k++) {
            s.q[k] = uniform(&seed, -2, 2);
            s.v[k] = uniform(&seed, -2, 2);
            s.tau[k] = uniform(&seed, -20, 20);
        }
        ck_assert_int_eq(rbd_packed_size(s.r.m), LENGTH(A));
        memset(A, 0, sizeof A);
        for (int k = 0; k < 9; k++) G[k] = uniform(&seed, -1, 1);
        ck_assert_int_eq(rbd_crba(s.r.m, s.r.w, s.q, M), RBD_OK);
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++) {
                const double entry = 0.3 * (G[i] * G[j] + G[3 + i] * G[3 + j] + G[6 + i] * G[6 + j]);
                M[(4 + i) * IIWA_NV + 4 + j] += entry;
                A[rbd_packed_index(s.r.m, 4 + i, 4 + j)] = entry;
            }
        ck_assert_int_eq(rbd_contact_inertia(s.r.m, s.c, A), RBD_OK);
        ck_assert_int_eq(rbd_contact_fd(s.r.m, s.c, s.q, s.v, s.tau, NULL, NULL, 1e-3, a), RBD_OK);
        ck_assert_int_eq(rbd_bias(s.r.m, s.r.w, s.q, s.v, NULL, bias), RBD_OK);
        multiply(M, a, IIWA_NV, IIWA_NV, left);
        for (int k = 0; k < IIWA_NV; k++) left[k] += bias[k];
        ck_assert_double_le(relative_error(left, s.tau, IIWA_NV), 1e-11);

        /* without it again */
        ck_assert_int_eq(rbd_contact_inertia(s.r.m, s.c, NULL), RBD_OK);
        ck_assert_int_eq(rbd_contact_fd(s.r.m, s.c, s.q, s.v, s.tau, NULL, NULL, 1e-3, a), RBD_OK);
        ck_assert_int_eq(rbd_aba(s.r.m, s.r.w, s.q, s.v, s.tau, NULL, left), RBD_OK);
        ck_assert_double_le(relative_error(a, left, IIWA_NV), 1e-10);
        close_scene(&s);
    }
}
END_TEST

/* ---- what goes with a step ---- */

/* Momentum of HyQ in space stays to rounding with rows on its legs and one that is not set, and is not
   touched where one is on the base, which brakes it, or where inertia is added there, which has a momentum
   of its own. */
START_TEST(momentum_stays_with_rows_inside) {
    enum { INSIDE, BASE, ADDED, CASES };
    for (int which = 0; which < CASES; which++) {
        static double added[18 * 19 / 2];
        uint64_t seed = 5;
        double h[2][6];
        scene s;
        open_scene(&s, "hyq", hyq_bodies, HYQ_NB, 4, 1e-3);
        s.options.momentum = 1;
        begin_scene(&s);
        ck_assert_int_eq(rbd_set_gravity(s.r.w, (const double[3]){0, 0, 0}), RBD_OK);
        for (int k = 0; k < s.r.nv; k++) s.v[k] = uniform(&seed, -2, 2);
        for (int i = 0; i < 3; i++) {
            const rbd_contact_row row = {
                .dofs = 3, .dof = {6 + i, 9 + i, 12 + i}, .jacobian = {1, -1, 0.5}, .lower = -5, .upper = 5};
            set_row(&s, i, i == 0 && which == BASE ? friction_row(0, 1) : row);
        }
        added[rbd_packed_index(s.r.m, 1, 1)] = 20;
        if (which == ADDED) ck_assert_int_eq(rbd_contact_inertia(s.r.m, s.c, added), RBD_OK);
        for (int x = 0; x < 2; x++) {
            double cm[6];
            if (x == 1)
                for (int n = 0; n < 500; n++) step(&s);
            ck_assert_int_eq(rbd_kinematics(s.r.m, s.r.w, s.q, s.v, NULL), RBD_OK);
            ck_assert_int_eq(rbd_momentum(s.r.m, s.r.w, cm, NULL), RBD_OK);
            memcpy(h[x], cm, sizeof cm);
        }
        if (which == INSIDE)
            ck_assert_double_le(relative_error(h[1], h[0], 6), 1e-11);
        else
            ck_assert_double_gt(relative_error(h[1], h[0], 6), 1e-3);
        close_scene(&s);
    }
}
END_TEST

/* A step that begins with the force of the last one is solved at once. */
START_TEST(rows_begin_with_their_last_force) {
    scene s;
    rbd_contact_solution first, next;
    double f, after;
    open_scene(&s, "iiwa", iiwa_bodies, IIWA_NB, IIWA_NV, 1e-3);
    begin_scene(&s);
    memcpy(s.q, bent, sizeof bent);
    for (int k = 0; k < IIWA_NV; k++) set_row(&s, k, friction_row(k, 200));
    step(&s);
    first = rbd_contact_last(s.c);
    (void)rbd_contact_row_get(s.c, 1, &f);
    step(&s);
    next = rbd_contact_last(s.c);
    ck_assert_int_gt(first.newton_steps, 0);
    ck_assert_int_eq(next.newton_steps, 0);
    (void)rbd_contact_row_get(s.c, 1, &after);
    ck_assert_double_eq_tol(f, after, 1e-9);

    rbd_contact_reset(s.c);
    ck_assert_int_eq(rbd_contact_row_get(s.c, 1, &after), RBD_APART);
    ck_assert_double_eq(after, 0);
    step(&s);
    ck_assert_int_eq(rbd_contact_last(s.c).newton_steps, first.newton_steps);
    close_scene(&s);
}
END_TEST

/* A set of one slider does not take the dofs of a robot of two. */
static void refuse_another_robot(rbd_contact_set *c) {
    const rbd_body bodies[2] = {slider(-1, 1, 0, 2), slider(0, 0, 1, 2)};
    const rbd_contact_row row = friction_row(1, 1);
    robot other = robot_build("two sliders", bodies, 2);
    ck_assert_int_eq(rbd_contact_row_set(other.m, c, 1, &row), RBD_ERR_WORK);
    ck_assert_int_eq(rbd_contact_friction(other.m, c, 0, 1), RBD_ERR_WORK);
    ck_assert_int_eq(rbd_contact_inertia(other.m, c, NULL), RBD_ERR_WORK);
    robot_free(&other);
}

START_TEST(bad_rows_are_refused) {
    const rbd_body body = slider(-1, 1, 0, 2);
    const rbd_contact_row good = friction_row(0, 1);
    rbd_contact_row row;
    double f = 7, nothing[1] = {NAN};
    rbd_report report;
    char text[200];
    scene s;
    open_scene(&s, "slider", &body, 1, 2, 1e-3);
    begin_scene(&s);
    set_row(&s, 1, good);
#define BAD(change, error) \
    do { \
        row = good; \
        row.change; \
        ck_assert_int_eq(rbd_contact_row_set(s.r.m, s.c, 1, &row), error); \
    } while (0)
    BAD(dofs = -1, RBD_ERR_COUNT);
    BAD(dofs = 4, RBD_ERR_COUNT);
    BAD(dofs = 2, RBD_ERR_INDEX); /* 0 twice */
    BAD(dof[0] = 1, RBD_ERR_INDEX);
    BAD(dof[0] = -1, RBD_ERR_INDEX);
    BAD(jacobian[0] = NAN, RBD_ERR_RANGE);
    BAD(bias = INFINITY, RBD_ERR_RANGE);
    BAD(lower = NAN, RBD_ERR_RANGE);
    BAD(upper = NAN, RBD_ERR_RANGE);
    BAD(lower = 2, RBD_ERR_RANGE);
    BAD(upper = -2, RBD_ERR_RANGE);
    BAD(lower = 1e30; row.upper = 1e31, RBD_ERR_RANGE);
    BAD(lower = -1e31; row.upper = -1e30, RBD_ERR_RANGE);
    BAD(compliance = -1, RBD_ERR_RANGE);
    BAD(compliance = NAN, RBD_ERR_RANGE);
    BAD(compliance = INFINITY, RBD_ERR_RANGE);
#undef BAD
    ck_assert_int_eq(rbd_contact_row_set(NULL, s.c, 1, &good), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_contact_row_set(s.r.m, NULL, 1, &good), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_contact_row_set(s.r.m, s.c, 1, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_contact_row_set(s.r.m, s.c, 2, &good), RBD_ERR_INDEX);
    ck_assert_int_eq(rbd_contact_row_set(s.r.m, s.c, -1, &good), RBD_ERR_INDEX);
    ck_assert_int_eq(rbd_contact_friction(s.r.m, s.c, 0, 1), RBD_ERR_INDEX);
    ck_assert_int_eq(rbd_contact_friction(NULL, s.c, 0, 1), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_contact_friction(s.r.m, NULL, 0, 1), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_contact_inertia(NULL, s.c, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_contact_inertia(s.r.m, NULL, NULL), RBD_ERR_NULL);
    refuse_another_robot(s.c);
    ck_assert_int_eq(rbd_contact_row_get(NULL, 0, &f), RBD_APART);
    ck_assert_double_eq(f, 0);
    ck_assert_int_eq(rbd_contact_row_get(s.c, 2, NULL), RBD_APART);
    ck_assert_int_eq(rbd_contact_row_get(s.c, -1, NULL), RBD_APART);

    /* the row is as it was: 1 N brake 2 kg; and without bounds it stops at once */
    s.v[0] = 1;
    step(&s);
    ck_assert_double_eq_tol(s.v[0], 1 - 0.0005, 1e-15);
    set_row(&s, 0, friction_row(0, INFINITY));
    step(&s);
    ck_assert_double_le(fabs(s.v[0]), 1e-15);

    ck_assert_int_eq(rbd_contact_inertia(s.r.m, s.c, nothing), RBD_OK);
    ck_assert_int_eq(rbd_contact_step(s.r.m, s.c, s.q, s.v, s.tau, NULL, NULL, 1e-3, s.q, s.v), RBD_ERR_NAN);
    ck_assert_double_eq(s.v[0], 0);
    for (int sign = -1; sign <= 1; sign += 2) { /* in M an infinity would stop the dof, without a word */
        s.v[0] = 1;
        for (int k = 0; k < LENGTH(nothing); k++) nothing[k] = 0;
        nothing[0] = sign * INFINITY;
        ck_assert_int_eq(rbd_contact_step(s.r.m, s.c, s.q, s.v, s.tau, NULL, NULL, 1e-3, s.q, s.v),
                         RBD_ERR_NAN);
        ck_assert_double_eq(s.v[0], 0);
    }

    for (int wrong = 0; wrong < 2; wrong++) {
        rbd_contact_set *c;
        s.options.rows = wrong ? RBD_MAX_CONSTRAINTS + 1 : -1;
        ck_assert_uint_eq(rbd_contact_set_size(s.r.m, 0, NULL, 0, &s.options), 0);
        ck_assert_int_eq(
            rbd_contact_set_init(s.r.m, s.r.w, NULL, 0, NULL, 0, &s.options, s.memory, 1 << 20, &c, &report),
            RBD_ERR_COUNT);
        ck_assert_str_eq(rbd_contact_finding_text(&report.error, 0, text, sizeof text),
                         "a number of contacts, constraints or rows is below 0, or above 1000");
    }
    close_scene(&s);
}
END_TEST

/* Friction of a dof that the description has is changed alone, and 0 takes it away. */
START_TEST(friction_changes_from_the_next_step_on) {
    rbd_body bodies[2] = {slider(-1, 1, 0, 2), slider(-1, 0, 1, 2)};
    scene s;
    bodies[1].friction[0] = 4;
    open_scene(&s, "sliders", bodies, 2, 0, 1e-3);
    s.options.joint_friction = 1;
    begin_scene(&s);
    s.v[0] = s.v[1] = 1;
    step(&s);
    ck_assert_double_eq_tol(s.v[0], 1, 1e-15);
    ck_assert_double_eq_tol(s.v[1], 1 - 0.002, 1e-15);
    ck_assert_int_eq(rbd_contact_friction(s.r.m, s.c, 0, 1), RBD_ERR_INDEX);
    ck_assert_int_eq(rbd_contact_friction(s.r.m, s.c, 2, 1), RBD_ERR_INDEX);
    ck_assert_int_eq(rbd_contact_friction(s.r.m, s.c, 1, -1), RBD_ERR_RANGE);
    ck_assert_int_eq(rbd_contact_friction(s.r.m, s.c, 1, NAN), RBD_ERR_RANGE);
    ck_assert_int_eq(rbd_contact_friction(s.r.m, s.c, 1, INFINITY), RBD_ERR_RANGE);
    step(&s);
    ck_assert_double_eq_tol(s.v[1], 1 - 0.004, 1e-15);
    ck_assert_int_eq(rbd_contact_friction(s.r.m, s.c, 1, 1), RBD_OK);
    step(&s);
    ck_assert_double_eq_tol(s.v[1], 1 - 0.0045, 1e-15);
    ck_assert_int_eq(rbd_contact_friction(s.r.m, s.c, 1, 0), RBD_OK);
    step(&s);
    ck_assert_double_eq_tol(s.v[1], 1 - 0.0045, 1e-15);
    close_scene(&s);
}
END_TEST

Suite *contact_bounded_suite(void) {
    Suite *suite = suite_create("contact_bounded");
    TCase *c = tcase_create("contact_bounded"), *slow = slow_tests(suite);
    suite_add_tcase(suite, c);
    tcase_add_test(slow, iiwa_is_held_by_a_billionth_more_than_its_weight);
    tcase_add_test(c, rows_are_as_the_friction_of_the_description);
    tcase_add_test(c, a_lever_slides_and_sticks_exactly);
    tcase_add_test(c, a_bias_drives_and_equal_bounds_push);
    tcase_add_test(c, a_bristle_holds_below_breakaway_without_drift);
    tcase_add_test(c, rows_never_raise_the_energy);
    tcase_add_test(c, bristles_never_raise_the_energy);
    tcase_add_test(slow, rows_of_trees_oppose_motion);
    tcase_add_test(c, a_belt_of_two_motors_is_as_joints_along_the_diagonals);
    tcase_add_test(c, an_added_matrix_is_in_the_equations);
    tcase_add_test(c, momentum_stays_with_rows_inside);
    tcase_add_test(c, rows_begin_with_their_last_force);
    tcase_add_test(c, bad_rows_are_refused);
    tcase_add_test(c, friction_changes_from_the_next_step_on);
    return suite;
}
