/* test_singular.c - systems without an acceleration: an error that names the degree of freedom. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "rbd_derivatives.h"

#include "rbd_constraints.h"

#include "suites.h"
#include "support.h"

#define BOX .mass = 1, .com = {0.1, -0.2, 0.15}, .inertia = {0.2, 0.01, -0.02, 0.25, 0.03, 0.3}

/* Begins anew in memory of zeros: what one call leaves there is no help to the next. */
static rbd_work *fresh_work(const robot *r) {
    rbd_work *w;
    memset(r->memory[1], 0, rbd_work_size(r->m));
    ck_assert_int_eq(rbd_work_init(r->m, r->memory[1], rbd_work_size(r->m), &w), RBD_OK);
    return w;
}

/* Both forward dynamics and the factorisation refuse, name a degree of freedom from first to last,
   and leave zeros. */
static void expect_singular(const char *what, const robot *r, const double *q, int first, int last) {
    double v[MAX_V], tau[MAX_V], a[2][MAX_V], L[MAX_V * MAX_V], M[MAX_V * MAX_V];
    for (int k = 0; k < r->nv; k++) {
        v[k] = 0.5 + k;
        tau[k] = 1 - k;
    }
    rbd_status status[5];
    int dof[5];
    status[0] = rbd_aba(r->m, r->w, q, v, tau, NULL, a[0]);
    dof[0] = rbd_singular_dof(r->w);
    status[1] = rbd_fd_cholesky(r->m, r->w, q, v, tau, NULL, a[1]);
    dof[1] = rbd_singular_dof(r->w);
    ck_assert_int_eq(rbd_crba(r->m, r->w, q, M), RBD_OK);
    rbd_work *w = fresh_work(r);
    status[2] = rbd_cholesky_factor(r->m, w, M, L);
    dof[2] = rbd_singular_dof(w);
    ck_assert_msg(largest(L, rbd_packed_size(r->m)) == 0, "%s: factor not zero", what);
    ck_assert_int_eq(rbd_crba_packed(r->m, w, q, L), RBD_OK);
    w = fresh_work(r);
    status[3] = rbd_cholesky_factor_packed(r->m, w, L);
    dof[3] = rbd_singular_dof(w);
    ck_assert_msg(largest(L, rbd_packed_size(r->m)) == 0, "%s: packed factor not zero", what);
    w = fresh_work(r);
    status[4] = rbd_minverse(r->m, w, q, M);
    dof[4] = rbd_singular_dof(w);
    ck_assert_msg(largest(M, r->nv * r->nv) == 0, "%s: inverse not zero", what);
    for (int i = 0; i < 5; i++) {
        ck_assert_msg(status[i] == RBD_ERR_SINGULAR, "%s: call %d gives %d", what, i, status[i]);
        ck_assert_msg(first <= dof[i] && dof[i] <= last, "%s: call %d names dof %d", what, i, dof[i]);
    }
    for (int i = 0; i < 2; i++) ck_assert_msg(largest(a[i], r->nv) == 0, "%s: call %d is not zero", what, i);
}

START_TEST(point_mass_on_the_axis_is_singular) {
    const rbd_body bead[2] = {
        {.parent = -1, .type = RBD_PRISMATIC, .axis = {1, 0, 0}, BOX},
        {.parent = 0, .type = RBD_REVOLUTE, .axis = {0, 0, 1}, .mass = 1, .com = {0, 0, 0.3}}};
    robot r = BUILD(bead);
    const double q[2] = {0.1, 0.2};
    expect_singular("point mass on the axis", &r, q, 1, 1);
    robot_free(&r);
}
END_TEST

/* The same with an axis and a place that rounding cannot hold exactly. */
START_TEST(point_mass_on_a_skew_axis_is_singular) {
    uint64_t seed = 91;
    for (int i = 0; i < 200; i++) {
        rbd_body b[3];
        state s;
        for (int k = 0; k < 3; k++) {
            random_joint(&seed, b, k, RBD_REVOLUTE);
            random_mass(&seed, &b[k]);
            b[k].parent = k - 1;
        }
        const double along = uniform(&seed, -1, 1) / sqrt(dot(b[2].axis, b[2].axis, 3));
        memset(b[2].inertia, 0, sizeof b[2].inertia);
        for (int k = 0; k < 3; k++) b[2].com[k] = along * b[2].axis[k];
        robot r = robot_build("point mass on a skew axis", b, 3);
        draw_state(&r, &seed, &s);
        expect_singular(r.name, &r, s.q, 2, 2);
        robot_free(&r);
    }
}
END_TEST

START_TEST(coincident_axes_with_nothing_between_are_singular) {
    uint64_t seed = 92;
    for (int i = 0; i < 200; i++) {
        rbd_body b[4];
        state s;
        for (int k = 0; k < 4; k++) {
            random_joint(&seed, b, k, RBD_REVOLUTE);
            random_mass(&seed, &b[k]);
            b[k].parent = k - 1;
        }
        b[1].mass = 0;
        memset(b[1].inertia, 0, sizeof b[1].inertia);
        memset(b[2].rotation, 0, sizeof b[2].rotation);
        const double along = uniform(&seed, -1, 1), sign = i & 1 ? 1 : -1;
        for (int k = 0; k < 3; k++) {
            b[2].axis[k] = sign * b[1].axis[k];
            b[2].position[k] = along * b[1].axis[k];
        }
        robot r = robot_build("coincident axes", b, 4);
        draw_state(&r, &seed, &s);
        expect_singular(r.name, &r, s.q, 1, 2);
        robot_free(&r);
    }
}
END_TEST

/* The same where the second axis has an armature that is lost in rounding: what its inertia leaves of the
   first's pivot is noise. */
START_TEST(coincident_axes_with_a_vanishing_armature_are_singular) {
    uint64_t seed = 94;
    for (int i = 0; i < 200; i++) {
        const double I = uniform(&seed, 1, 10), x = uniform(&seed, -1, 1), y = uniform(&seed, -1, 1);
        const rbd_body b[2] = {{.parent = -1, .type = RBD_REVOLUTE, .axis = {0, 0, 1}},
                               {.parent = 0,
                                .type = RBD_REVOLUTE,
                                .axis = {0, 0, 1},
                                .mass = 1,
                                .com = {x, y, 0},
                                .inertia = {I, 0, 0, I, 0, I},
                                .armature = {1e-20}}};
        const double q[2] = {0.1, 0.2};
        robot r = BUILD(b);
        expect_singular("coincident axes with a vanishing armature", &r, q, 0, 1);
        robot_free(&r);
    }
}
END_TEST

START_TEST(massless_chain_with_too_many_slides_is_singular) {
    const rbd_body slides[4] = {{.parent = -1, .type = RBD_PRISMATIC, .axis = {1, 0, 0}},
                                {.parent = 0, .type = RBD_PRISMATIC, .axis = {0, 1, 0}},
                                {.parent = 1, .type = RBD_PRISMATIC, .axis = {1, 1, 0}},
                                {.parent = 2, .type = RBD_PRISMATIC, .axis = {0, 0, 1}, BOX}};
    robot r = BUILD(slides);
    const double q[4] = {0.1, 0.2, 0.3, 0.4};
    expect_singular("too many slides", &r, q, 0, 2);
    robot_free(&r);
}
END_TEST

START_TEST(universal_joint_with_point_mass_at_its_centre_is_singular) {
    const rbd_body bead[1] = {
        {.parent = -1, .type = RBD_UNIVERSAL, .axis = {1, 0, 0}, .axis2 = {0, 1, 0}, .mass = 1}};
    robot r = BUILD(bead);
    const double q[2] = {0.1, 0.2};
    expect_singular("bead in a universal joint", &r, q, 0, 1);
    robot_free(&r);
}
END_TEST

START_TEST(ball_joint_with_a_rod_is_singular) {
    const rbd_body rod[2] = {{.parent = -1,
                              .type = RBD_SPHERICAL,
                              .mass = 1,
                              .com = {0, 0, 0.5},
                              .inertia = {0.1, 0, 0, 0.1, 0, 0}},
                             {.parent = -1, .type = RBD_FLOATING, .mass = 1}};
    robot r = BUILD(rod);
    const double q[11] = {0.5, -0.5, 0.5, 0.5, 1, 2, 3, 0.1, 0.2, 0.3, 0.4};
    expect_singular("rod on a ball joint, free point mass", &r, q, 0, 8);
    robot_free(&r);
}
END_TEST

START_TEST(gimbal_lock_is_singular) {
    const rbd_joint_type types[4] = {RBD_EULER_ZYX, RBD_EULER_XYZ, RBD_EULER_YXZ, RBD_EULER_ZXY};
    for (int i = 0; i < 4; i++) {
        const rbd_body gimbal[1] = {{.parent = -1, .type = types[i], BOX}};
        robot r = BUILD(gimbal);
        const double q[3] = {0.3, 1.57079632679489661923, -0.4};
        expect_singular("gimbal lock", &r, q, 0, 2);
        robot_free(&r);
    }
}
END_TEST

/* Whichever of the three pivots rounding leaves a little of: a point mass does not turn about itself. */
START_TEST(point_mass_on_a_ball_joint_is_singular) {
    const rbd_body bead[1] = {{.parent = -1, .type = RBD_SPHERICAL, .mass = 1, .com = {-0.1, -0.8, 0.6}}};
    const double q[4] = {0, 0, 0, 1}, v[3] = {0}, tau[3] = {1, 0, 0};
    double a[3] = {1, 1, 1};
    robot r = BUILD(bead);
    ck_assert_int_eq(rbd_aba(r.m, r.w, q, v, tau, NULL, a), RBD_ERR_SINGULAR);
    ck_assert(largest(a, 3) == 0);
    expect_singular("point mass on a ball joint", &r, q, 0, 2);
    robot_free(&r);
}
END_TEST

START_TEST(point_mass_on_any_three_turns_is_singular) {
    static const rbd_joint_type types[5] = {RBD_SPHERICAL, RBD_EULER_ZYX, RBD_EULER_XYZ, RBD_EULER_YXZ,
                                            RBD_EULER_ZXY};
    uint64_t seed = 93;
    for (int i = 0; i < 500; i++) {
        rbd_body b[2];
        state s;
        for (int k = 0; k < 2; k++) {
            random_joint(&seed, b, k, k ? types[i % 5] : RBD_REVOLUTE);
            random_mass(&seed, &b[k]);
            b[k].parent = k - 1;
        }
        memset(b[1].inertia, 0, sizeof b[1].inertia);
        memset(b[1].armature, 0, sizeof b[1].armature);
        robot r = robot_build("point mass on three turns", b, 2);
        draw_state(&r, &seed, &s);
        expect_singular(r.name, &r, s.q, 0, 3);
        robot_free(&r);
    }
}
END_TEST

/* Masses that are hardly numbers, or whose moments are none: an acceleration, a huge one, or an error, but no
   NaN. */
START_TEST(denormal_masses_give_finite_numbers) {
    static const double masses[4] = {1e-300, 1e-308, 1e-310, 5e-324};
    for (int i = 0; i < 4; i++)
        for (rbd_joint_type type = RBD_REVOLUTE; type <= RBD_FLOATING; type++) {
            const double m = masses[i], q[7] = {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7};
            const double x[6] = {1, 2, 3, 4, 5, 6};
            const rbd_body b[1] = {{.parent = -1,
                                    .type = type,
                                    .axis = {0, 0.6, 0.8},
                                    .axis2 = {1, 0, 0},
                                    .pitch = 0.1,
                                    .mass = m,
                                    .com = {0.1, 0, 0.2},
                                    .inertia = {m, 0, 0, m, 0, m}}};
            double a[2][6];
            robot r = BUILD(b);
            const rbd_status status[2] = {rbd_aba(r.m, r.w, q, x, x, NULL, a[0]),
                                          rbd_fd_cholesky(r.m, r.w, q, x, x, NULL, a[1])};
            for (int k = 0; k < 2; k++) {
                for (int j = 0; j < r.nv; j++)
                    ck_assert_msg(!isnan(a[k][j]), "mass %g, joint type %d, call %d: NaN", m, (int)type, k);
                const double most = largest(a[k], r.nv);
                ck_assert_msg(status[k] == RBD_OK ? most > 1e290 : most == 0, "mass %g, type %d, call %d: %g",
                              m, (int)type, k, most);
            }
            robot_free(&r);
        }
}
END_TEST

static void expect_nan(const char *what, const robot *r, rbd_status status, const double *x, int n) {
    ck_assert_msg(status == RBD_ERR_NAN, "%s: %d", what, status);
    ck_assert_msg(rbd_singular_dof(r->w) >= 0, "%s: no degree of freedom is named", what);
    ck_assert_msg(largest(x, n) == 0, "%s: not zero", what);
}

/* A joint value that is not a number, for each that the mass matrix depends on: it is no singular system. */
START_TEST(configuration_that_is_not_a_number_is_an_error) {
    const rbd_body b[3] = {{.parent = -1, .type = RBD_EULER_ZYX, BOX},
                           {.parent = 0, .type = RBD_REVOLUTE, .axis = {0, 0.6, 0.8}, BOX},
                           {.parent = 1, .type = RBD_SPHERICAL, .position = {0.1, 0.2, 0.3}, BOX}};
    const double no_numbers[3] = {NAN, INFINITY, -INFINITY}, x[7] = {1, 2, 3, 4, 5, 6, 7};
    robot r = BUILD(b);
    for (int k = 1; k < 8; k++)
        for (int i = 0; i < 3; i++) {
            double q[8] = {0.1, 0.2, 0.3, 0.4, 0.5, -0.5, 0.5, 0.5}, a[7], M[49], L[49];
            q[k] = no_numbers[i];
            rbd_status status = rbd_aba(r.m, r.w, q, x, x, NULL, a);
            expect_nan("aba", &r, status, a, 7);
            status = rbd_fd_cholesky(r.m, r.w, q, x, x, NULL, a);
            expect_nan("fd_cholesky", &r, status, a, 7);
            ck_assert_int_eq(rbd_crba(r.m, r.w, q, M), RBD_OK);
            status = rbd_cholesky_factor(r.m, r.w, M, L);
            expect_nan("cholesky_factor", &r, status, L, rbd_packed_size(r.m));
            ck_assert_int_eq(rbd_crba_packed(r.m, r.w, q, L), RBD_OK);
            status = rbd_cholesky_factor_packed(r.m, r.w, L);
            expect_nan("cholesky_factor_packed", &r, status, L, rbd_packed_size(r.m));
            status = rbd_minverse(r.m, r.w, q, M);
            expect_nan("minverse", &r, status, M, 49);
            q[k] = 0.4; /* and the call after is clean */
            ck_assert_int_eq(rbd_aba(r.m, r.w, q, x, x, NULL, a), RBD_OK);
            ck_assert_int_eq(rbd_singular_dof(r.w), -1);
        }
    robot_free(&r);
}
END_TEST

/* Status of each call that factors M, and the dof that it names. */
enum { NAMING = 10 };
typedef struct naming {
    rbd_derivatives *d;
    rbd_constraint_set *c;
    rbd_status status[NAMING];
    int dof[NAMING];
} naming;

static rbd_status call_that_factors(const robot *r, const naming *n, int call, const double *q) {
    static double M[MAX_V * MAX_V], N[MAX_V * MAX_V], P[MAX_V * MAX_V];
    const unsigned char given[MAX_V] = {0};
    double v[MAX_V], tau[MAX_V], a[MAX_V], lambda[3], rows[3][3 * MAX_V];
    for (int k = 0; k < r->nv; k++) v[k] = 0.5 + k, tau[k] = 1 - k;
    switch (call) {
    case 0: return rbd_aba(r->m, r->w, q, v, tau, NULL, a);
    case 1: return rbd_fd_cholesky(r->m, r->w, q, v, tau, NULL, a);
    case 2: return rbd_minverse(r->m, r->w, q, M);
    case 3:
        ck_assert_int_eq(rbd_crba(r->m, r->w, q, N), RBD_OK);
        return rbd_cholesky_factor(r->m, r->w, N, M);
    case 4:
        ck_assert_int_eq(rbd_crba_packed(r->m, r->w, q, M), RBD_OK);
        return rbd_cholesky_factor_packed(r->m, r->w, M);
    case 5: return rbd_hybrid(r->m, r->w, q, v, given, a, tau, NULL);
    case 6: return rbd_fd_derivatives(r->m, n->d, q, v, tau, NULL, a, M, N, P);
    case 7: return rbd_constrained_fd(r->m, n->c, q, v, tau, NULL, a, lambda);
    case 8: return rbd_impact(r->m, n->c, q, v, 0.5, a, lambda);
    default:
        return rbd_constrained_fd_derivatives(r->m, n->c, n->d, q, v, tau, NULL,
                                              &(rbd_constrained_fd_results){.a = a,
                                                                            .lambda = lambda,
                                                                            .da_dq = M,
                                                                            .da_dv = N,
                                                                            .da_dtau = P,
                                                                            .dlambda_dq = rows[0],
                                                                            .dlambda_dv = rows[1],
                                                                            .dlambda_dtau = rows[2]});
    }
}

/* good: a state of no error, before each call: what the last one left is gone. */
static void name_dofs(const robot *r, naming *n, const double *good, const double *q) {
    for (int call = 0; call < NAMING; call++) {
        ck_assert_int_eq(call_that_factors(r, n, call, good), RBD_OK);
        ck_assert_int_eq(rbd_singular_dof(r->w), -1);
        n->status[call] = call_that_factors(r, n, call, q);
        n->dof[call] = rbd_singular_dof(r->w);
    }
}

/* The joint of the coordinate turns what the dof before it carries: of all pivots, from the last dof on,
   that dof's is the first that is not a number. M does not depend on a root joint's. */
static void expect_dof_before(const robot *r, naming *n, const double *good, int body) {
    const double no_numbers[3] = {NAN, INFINITY, -INFINITY};
    rbd_joint_info j, before = {.iv = 0, .nv = 0};
    rbd_joint(r->m, body, &j);
    if (r->bodies[body].parent >= 0) rbd_joint(r->m, r->bodies[body].parent, &before);
    for (int i = 0; i < 3; i++) {
        double q[MAX_Q];
        memcpy(q, good, (size_t)r->nq * sizeof *q);
        q[j.iq] = no_numbers[i];
        name_dofs(r, n, good, q);
        for (int call = 0; call < NAMING; call++) {
            ck_assert_msg(n->status[call] == (before.nv ? RBD_ERR_NAN : RBD_OK),
                          "body %d, call %d: status %d", body, call, n->status[call]);
            ck_assert_msg(n->dof[call] == before.iv + before.nv - 1, "body %d, call %d: dof %d, not %d", body,
                          call, n->dof[call], before.iv + before.nv - 1);
        }
    }
}

START_TEST(dof_before_the_coordinate_that_is_not_a_number_is_named) {
    uint64_t seed = 31;
    for (int tree = 0; tree < 20; tree++) {
        rbd_body b[8];
        naming n;
        state s;
        rbd_constraint k;
        const double point[3] = {0.1, 0.2, 0.3};
        for (int i = 0; i < 8; i++) {
            memset(&b[i], 0, sizeof b[i]);
            b[i].type = i || tree % 2 ? RBD_REVOLUTE : RBD_FLOATING;
            b[i].parent = i ? below(&seed, i) : -1;
            for (int x = 0; x < 3 && b[i].type == RBD_REVOLUTE; x++) b[i].axis[x] = uniform(&seed, 0.2, 1);
            for (int x = 0; x < 3; x++) b[i].position[x] = uniform(&seed, 0.1, 1);
            random_mass(&seed, &b[i]);
        }
        robot r = BUILD(b);
        const size_t size = rbd_derivatives_size(r.m);
        void *memory = malloc(size), *more;
        ck_assert_int_eq(rbd_derivatives_init(r.m, r.w, memory, size, &n.d), RBD_OK);
        k = rbd_point_contact(7, point, NULL);
        more = malloc(rbd_constraint_set_size(r.m, &k, 1));
        ck_assert_int_eq(
            rbd_constraint_set_init(r.m, r.w, &k, 1, more, rbd_constraint_set_size(r.m, &k, 1), &n.c, NULL),
            RBD_OK);
        draw_state(&r, &seed, &s);
        for (int i = 0; i < 8; i++)
            if (b[i].type == RBD_REVOLUTE) expect_dof_before(&r, &n, s.q, i);
        free(memory);
        free(more);
        robot_free(&r);
    }
}
END_TEST

/* Where the mass matrix does not depend on it, nobody looks for it, and it is in the results. */
START_TEST(what_is_not_a_number_and_no_error_is_in_the_results) {
    const rbd_body b[2] = {
        {.parent = -1, .type = RBD_REVOLUTE, .axis = {0, 0.6, 0.8}, BOX},
        {.parent = 0, .type = RBD_REVOLUTE, .axis = {0, 0.6, 0.8}, .position = {1, 0, 0}, BOX}};
    robot r = BUILD(b);
    for (int k = 0; k < 6; k++) {
        double x[6] = {0.1, 0.2, 0.3, 0.4, 0.5, 0.6}, out[2]; /* q, v, and a or tau */
        if (k == 1) continue;                                 /* the mass matrix does depend on q[1] */
        x[k] = NAN;
        ck_assert_int_eq(rbd_rnea(r.m, r.w, x, x + 2, x + 4, NULL, out), RBD_OK);
        ck_assert_msg(isnan(out[0]) || isnan(out[1]), "rnea, input %d: %g %g", k, out[0], out[1]);
        ck_assert_int_eq(rbd_aba(r.m, r.w, x, x + 2, x + 4, NULL, out), RBD_OK);
        ck_assert_msg(isnan(out[0]) && isnan(out[1]), "aba, input %d: %g %g", k, out[0], out[1]);
        ck_assert_int_eq(rbd_fd_cholesky(r.m, r.w, x, x + 2, x + 4, NULL, out), RBD_OK);
        ck_assert_msg(isnan(out[0]) && isnan(out[1]), "fd_cholesky, input %d: %g %g", k, out[0], out[1]);
    }
    robot_free(&r);
}
END_TEST

/* Mimic joints too: leader and follower cancel out. */
START_TEST(mimic_that_undoes_its_leader_is_singular) {
    const rbd_body pair[2] = {
        {.joint = "a", .parent = -1, .type = RBD_PRISMATIC, .axis = {1, 0, 0}},
        {.parent = 0, .type = RBD_PRISMATIC, .axis = {1, 0, 0}, BOX, .mimic = "a", .mimic_ratio = -1}};
    robot r = BUILD(pair);
    const double q[1] = {0.3};
    expect_singular("mimic that undoes its leader", &r, q, 0, 0);
    robot_free(&r);
}
END_TEST

/* The error is of that call alone: the next regular one is clean again. */
START_TEST(regular_call_after_a_singular_one_is_clean) {
    const rbd_body gimbal[1] = {{.parent = -1, .type = RBD_EULER_ZYX, BOX}};
    robot r = BUILD(gimbal);
    const double locked[3] = {0.3, 1.57079632679489661923, -0.4}, open[3] = {0.3, 0.2, -0.4},
                 v[3] = {1, 2, 3};
    double a[3], M[9];
    ck_assert_int_eq(rbd_aba(r.m, r.w, locked, v, v, NULL, a), RBD_ERR_SINGULAR);
    ck_assert_int_ge(rbd_singular_dof(r.w), 0);
    ck_assert_int_eq(rbd_aba(r.m, r.w, open, v, v, NULL, a), RBD_OK);
    ck_assert_int_eq(rbd_singular_dof(r.w), -1);
    ck_assert_int_eq(rbd_fd_cholesky(r.m, r.w, locked, v, v, NULL, a), RBD_ERR_SINGULAR);
    ck_assert_int_eq(rbd_fd_cholesky(r.m, r.w, open, v, v, NULL, a), RBD_OK);
    ck_assert_int_eq(rbd_singular_dof(r.w), -1);
    ck_assert_int_eq(rbd_crba(r.m, r.w, locked, M), RBD_OK);
    robot_free(&r);
}
END_TEST

/* Small is not singular: a light robot, a tiny one, a heavy one still have an acceleration. */
START_TEST(small_and_large_robots_are_not_singular) {
    const double scales[4] = {1e-9, 1e-6, 1e6, 1e9};
    for (int i = 0; i < 4; i++) {
        rbd_body b[MAX_BODIES];
        const ref_model *model = reference_model(2);
        memcpy(b, model->bodies, (size_t)model->nb * sizeof *b);
        for (int k = 0; k < model->nb; k++) {
            b[k].mass *= scales[i];
            for (int j = 0; j < 6; j++) b[k].inertia[j] *= scales[i];
        }
        robot r = robot_build("scaled iiwa", b, model->nb);
        const ref_state *s = &model->states[1];
        double tau[MAX_V], a[MAX_V];
        ck_assert_int_eq(rbd_rnea(r.m, r.w, s->q, s->v, s->vdot, NULL, tau), RBD_OK);
        expect_ok("aba", &r, i, rbd_aba(r.m, r.w, s->q, s->v, tau, NULL, a));
        expect_close("scaled robot, aba", &r, i, a, s->vdot, r.nv, inverse_bound(s->cond_M));
        expect_ok("fd_cholesky", &r, i, rbd_fd_cholesky(r.m, r.w, s->q, s->v, tau, NULL, a));
        expect_close("scaled robot, fd_cholesky", &r, i, a, s->vdot, r.nv, inverse_bound(s->cond_M));
        robot_free(&r);
    }
}
END_TEST

/* A fingertip at the end of a heavy arm: the pivots span nine orders of magnitude. */
START_TEST(light_link_on_a_heavy_one_is_not_singular) {
    const rbd_body arm[2] = {{.parent = -1,
                              .type = RBD_REVOLUTE,
                              .axis = {0, 1, 0},
                              .mass = 1000,
                              .com = {1, 0, 0},
                              .inertia = {100, 0, 0, 100, 0, 100}},
                             {.parent = 0,
                              .type = RBD_REVOLUTE,
                              .axis = {0, 0, 1},
                              .position = {2, 0, 0},
                              .mass = 1e-3,
                              .com = {0.01, 0, 0},
                              .inertia = {1e-7, 0, 0, 1e-7, 0, 1e-7}}};
    robot r = BUILD(arm);
    const double q[2] = {0.1, 0.2}, v[2] = {1, 1}, expected[2] = {0.3, -0.7};
    double tau[2], a[2];
    ck_assert_int_eq(rbd_rnea(r.m, r.w, q, v, expected, NULL, tau), RBD_OK);
    expect_ok("aba", &r, 0, rbd_aba(r.m, r.w, q, v, tau, NULL, a));
    expect_close("light link, aba", &r, 0, a, expected, 2, 1e-9);
    expect_ok("fd_cholesky", &r, 0, rbd_fd_cholesky(r.m, r.w, q, v, tau, NULL, a));
    expect_close("light link, fd_cholesky", &r, 0, a, expected, 2, 1e-6);
    robot_free(&r);
}
END_TEST

/* A point mass beside its axis, by a share of the lever L of a frame that its body carries. Of its inertia
   m (share L)^2 rounding of the description leaves all or nothing, see [tolerances]: it counts from 2.5e-26
   m L^2 on, by the factor from 6.3e-23 m L^2. */
static void expect_beside_axis(double share, double L, rbd_status by_bodies, rbd_status by_factor) {
    const rbd_body bead[2] = {
        {.parent = -1, .type = RBD_REVOLUTE, .axis = {0, 0, 1}, .mass = 2, .com = {share * L, 0, 0}},
        {.parent = 0, .type = RBD_FIXED, .position = {L, 0, 0}}};
    robot r = BUILD(bead);
    const double q[1] = {0.2}, v[1] = {0}, inertia = 2 * share * share * L * L, tau[1] = {3 * inertia};
    double a[2];
    ck_assert_int_eq(rbd_aba(r.m, r.w, q, v, tau, NULL, &a[0]), by_bodies);
    ck_assert_int_eq(rbd_fd_cholesky(r.m, r.w, q, v, tau, NULL, &a[1]), by_factor);
    const double expected[2] = {by_bodies == RBD_OK ? 3 : 0, by_factor == RBD_OK ? 3 : 0};
    expect_close("beside its axis", &r, 0, a, expected, 2, 1e-12);
    robot_free(&r);
}

START_TEST(point_mass_beside_its_axis_counts_above_the_rounding_of_its_description) {
    const double levers[3] = {0.01, 1, 100};
    for (int i = 0; i < 3; i++) {
        expect_beside_axis(sqrt(1.2e-26), levers[i], RBD_ERR_SINGULAR, RBD_ERR_SINGULAR);
        expect_beside_axis(sqrt(5e-26), levers[i], RBD_OK, RBD_ERR_SINGULAR);
        expect_beside_axis(sqrt(3e-23), levers[i], RBD_OK, RBD_ERR_SINGULAR);
        expect_beside_axis(sqrt(1.3e-22), levers[i], RBD_OK, RBD_OK);
    }
}
END_TEST

/* The same behind two slides that lead there and back: by rbd_aba each change of frame rounds by a third of
   eps, of m L^2. */
START_TEST(point_mass_beside_its_axis_counts_above_the_rounding_of_frames) {
    const double squares[2] = {0.5 * DBL_EPSILON / 3, 5 * DBL_EPSILON / 3};
    for (int i = 0; i < 2; i++) {
        const double beside = sqrt(squares[i]), L = 3;
        const rbd_body bead[3] = {
            {.parent = -1, .type = RBD_REVOLUTE, .axis = {0, 0, 1}},
            {.parent = 0, .type = RBD_PRISMATIC, .axis = {0, 0, 1}, .position = {L, 0, 0}},
            {.parent = 1,
             .type = RBD_PRISMATIC,
             .axis = {1, 0, 0},
             .position = {-L, 0, 0},
             .mass = 1,
             .com = {beside * L, 0, 0}}};
        robot r = BUILD(bead);
        const double q[3] = {0}, v[3] = {0}, expected[3] = {i ? 3 : 0, 0, i ? 2 : 0};
        const double tau[3] = {expected[0] * squares[i] * L * L, 9.81, expected[2]};
        double a[3];
        ck_assert_int_eq(rbd_aba(r.m, r.w, q, v, tau, NULL, a), i ? RBD_OK : RBD_ERR_SINGULAR);
        expect_close("beside its axis, slides", &r, i, a, expected, 3, 1e-6);
        robot_free(&r);
    }
}
END_TEST

Suite *singular_suite(void) {
    Suite *suite = suite_create("singular");
    TCase *c = tcase_create("singular");
    tcase_add_test(c, point_mass_on_the_axis_is_singular);
    tcase_add_test(c, point_mass_on_a_skew_axis_is_singular);
    tcase_add_test(c, coincident_axes_with_nothing_between_are_singular);
    tcase_add_test(c, coincident_axes_with_a_vanishing_armature_are_singular);
    tcase_add_test(c, massless_chain_with_too_many_slides_is_singular);
    tcase_add_test(c, universal_joint_with_point_mass_at_its_centre_is_singular);
    tcase_add_test(c, ball_joint_with_a_rod_is_singular);
    tcase_add_test(c, gimbal_lock_is_singular);
    tcase_add_test(c, point_mass_on_a_ball_joint_is_singular);
    tcase_add_test(c, point_mass_on_any_three_turns_is_singular);
    tcase_add_test(c, denormal_masses_give_finite_numbers);
    tcase_add_test(c, configuration_that_is_not_a_number_is_an_error);
    tcase_add_test(c, dof_before_the_coordinate_that_is_not_a_number_is_named);
    tcase_add_test(c, what_is_not_a_number_and_no_error_is_in_the_results);
    tcase_add_test(c, mimic_that_undoes_its_leader_is_singular);
    tcase_add_test(c, regular_call_after_a_singular_one_is_clean);
    tcase_add_test(c, small_and_large_robots_are_not_singular);
    tcase_add_test(c, light_link_on_a_heavy_one_is_not_singular);
    tcase_add_test(c, point_mass_beside_its_axis_counts_above_the_rounding_of_its_description);
    tcase_add_test(c, point_mass_beside_its_axis_counts_above_the_rounding_of_frames);
    suite_add_tcase(suite, c);
    return suite;
}
