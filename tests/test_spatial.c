/* test_spatial.c - rbd_spatial.h: identities, closed forms, reference results. One source for all scalars:
       -DRBD_REAL=float, __float128, -DRBD_LANES=4, nothing (double).
   In a build of n lanes each lane draws numbers of its own. */
#include "larger.h"
#include "rbd_spatial.h"
#define RBD_IMPLEMENTATION
#include "rbd.h"

#include "reference.h"

#include "quiet_check.h"
#include <math.h>

/* A file may include it as often as it likes. */
#include "rbd_spatial.h"

/* Quad loses more where rbd.h adds 1e-30 to the square of an angle (RBDI_NO_ANGLE). */
#define BOUND fmax(100 * (double)RBDI_EPS, 1e-29)
#define DOUBLE_BOUND fmax(BOUND, 1e-14) /* where the reference's digits end */
#define PI 3.14159265358979323846

enum { BASE, HAND, TOOL, TRIALS = 200 };

/* ---- numbers in every lane ---- */

#ifdef RBD_LANES
enum { LANES = RBD_LANES };
static void put(rbd_real *x, int lane, double value) { (*x)[lane] = (RBD_REAL)value; }
static double get(rbd_real x, int lane) { return (double)x[lane]; }
#else
enum { LANES = 1 };
static void put(rbd_real *x, int lane, double value) { (void)lane, *x = (rbd_real)value; }
static double get(rbd_real x, int lane) { return (void)lane, (double)x; }
#endif

static uint64_t seed;

/* xorshift64*, of Vigna */
static double uniform(double low, double high) {
    seed ^= seed >> 12;
    seed ^= seed << 25;
    seed ^= seed >> 27;
    return low + (high - low) * ((double)(seed * UINT64_C(2685821657736338717) >> 11) / 9007199254740992.0);
}

static rbd_real draw(double size) {
    rbd_real x = rbdi_zero();
    for (int lane = 0; lane < LANES; lane++) put(&x, lane, uniform(-size, size));
    return x;
}
static rbd_real all(double value) {
    rbd_real x = rbdi_zero();
    for (int lane = 0; lane < LANES; lane++) put(&x, lane, value);
    return x;
}

static rbd_vec3 draw_vec(double size) { return rbd_vec3_of(draw(size), draw(size), draw(size)); }
static rbd_motion draw_motion(int frame) { return rbd_motion_of(draw_vec(1), draw_vec(1), frame); }
static rbd_force draw_force(int frame) { return rbd_force_of(draw_vec(1), draw_vec(1), frame); }
static rbd_rotation draw_rotation(void) {
    rbd_real q[4];
    for (int k = 0; k < 4; k++) q[k] = draw(1);
    q[3] = q[3] + all(0.1);
    return rbd_rotation_from_quaternion(q);
}
static rbd_placement draw_placement(int of, int in) {
    return rbd_placement_of(draw_rotation(), draw_vec(1), of, in);
}
static rbd_inertia draw_inertia(int frame) {
    const rbd_const com[3] = {(rbd_const)uniform(-1, 1), (rbd_const)uniform(-1, 1),
                              (rbd_const)uniform(-1, 1)};
    const rbd_const inertia[6] = {(rbd_const)uniform(1, 2),      (rbd_const)uniform(-0.3, 0.3),
                                  (rbd_const)uniform(-0.3, 0.3), (rbd_const)uniform(1, 2),
                                  (rbd_const)uniform(-0.3, 0.3), (rbd_const)uniform(1, 2)};
    return rbd_inertia_of((rbd_const)uniform(0.1, 3), com, inertia, frame);
}

/* ---- comparison: the largest difference in any lane, infinite if something is not finite ---- */

static double worst(const rbd_real *found, const rbd_real *expected, int n) {
    double error = 0;
    for (int i = 0; i < n; i++)
        for (int lane = 0; lane < LANES; lane++) {
            const double difference = get(found[i] - expected[i], lane);
            error = larger(error, fabs(difference));
        }
    return error;
}

static double of_reals(rbd_real a, rbd_real b) { return worst(&a, &b, 1); }
static double of_vecs(rbd_vec3 a, rbd_vec3 b) {
    rbd_real x[3], y[3];
    rbd_vec3_to_array(a, x);
    rbd_vec3_to_array(b, y);
    return worst(x, y, 3);
}
static double of_rotations(rbd_rotation a, rbd_rotation b) {
    rbd_real x[9], y[9];
    rbd_rotation_to_array(a, x);
    rbd_rotation_to_array(b, y);
    return worst(x, y, 9);
}
static double of_placements(rbd_placement a, rbd_placement b) {
    return larger(of_rotations(a.rotation, b.rotation), of_vecs(a.position, b.position));
}
static double of_motions(rbd_motion a, rbd_motion b) {
    rbd_real x[6], y[6];
    rbd_motion_to_array(a, x);
    rbd_motion_to_array(b, y);
    return worst(x, y, 6);
}
static double of_forces(rbd_force a, rbd_force b) {
    rbd_real x[6], y[6];
    rbd_force_to_array(a, x);
    rbd_force_to_array(b, y);
    return worst(x, y, 6);
}
static double of_inertias(rbd_inertia a, rbd_inertia b) {
    rbd_real x[10], y[10];
    rbd_inertia_to_parameters(a, x);
    rbd_inertia_to_parameters(b, y);
    return worst(x, y, 10);
}
#define SMALL(error, bound) \
    do { \
        const double found_ = (error); \
        ck_assert_msg(found_ <= (bound), "%s: %.3g exceeds %.3g", #error, found_, (double)(bound)); \
    } while (0)
#define EQUAL(a, b, bound) SMALL(of_reals(a, b), bound)

/* ---- rotations ---- */

/* Rodrigues' formula. */
static rbd_vec3 turned(rbd_vec3 axis, double angle, rbd_vec3 v) {
    const rbd_real one = all(1);
    rbd_real s, c;
    rbdi_sincos(all(angle), &s, &c);
    return rbdi_add(rbdi_add(rbdi_scale(c, v), rbdi_scale(s, rbdi_cross(axis, v))),
                    rbdi_scale((one - c) * rbdi_dot(axis, v), axis));
}

static rbd_vec3 unit(rbd_vec3 v) { return rbdi_scale(all(1) / rbdi_sqrt(rbdi_dot(v, v)), v); }

START_TEST(rotations_turn_as_rodrigues_says) {
    const rbd_real o = all(0), one = all(1);
    const rbd_vec3 x = rbd_vec3_of(one, o, o), y = rbd_vec3_of(o, one, o), z = rbd_vec3_of(o, o, one);
    const rbd_rotation quarter = rbd_rotation_from_axis_angle(z, all(PI / 2));
    seed = 1;
    SMALL(of_vecs(rbd_rotate(quarter, x), y), DOUBLE_BOUND);
    SMALL(of_vecs(rbd_rotate_back(quarter, y), x), DOUBLE_BOUND);
    SMALL(of_vecs(rbd_rotate(rbd_rotation_inverse(quarter), y), x), DOUBLE_BOUND);
    for (int i = 0; i < TRIALS; i++) {
        const rbd_vec3 axis = unit(draw_vec(1)), v = draw_vec(1);
        const double angle = uniform(-7, 7);
        const rbd_vec3 expected = turned(axis, angle, v);
        rbd_real q[4], s, c;
        SMALL(of_vecs(rbd_rotate(rbd_rotation_from_axis_angle(rbdi_scale(all(17), axis), all(angle)), v),
                      expected),
              BOUND);
        SMALL(of_vecs(rbd_rotate(rbd_rotation_exp(rbdi_scale(all(angle), axis)), v), expected), BOUND);
        rbdi_sincos(all(angle / 2), &s, &c);
        rbd_vec3_to_array(rbdi_scale(s * all(-3), axis), q);
        q[3] = c * all(-3);
        SMALL(of_vecs(rbd_rotate(rbd_rotation_from_quaternion(q), v), expected), BOUND);
    }
    SMALL(of_rotations(rbd_rotation_from_axis_angle(rbdi_vec0(), one), rbd_rotation_identity()), 0);
    const rbd_vec3 none = rbd_rotate(rbd_rotation_from_axis_angle(rbd_vec3_of(all(NAN), one, one), one), x);
    ck_assert(!rbdi_any(rbdi_less(rbdi_dot(none, none), all(HUGE_VAL))));
}
END_TEST

START_TEST(quaternions_come_back) {
    seed = 2;
    for (int i = 0; i < TRIALS; i++) {
        rbd_real q[4], found[4];
        const int zero = i % 8;
        for (int k = 0; k < 4; k++) q[k] = draw(1);
        for (int k = 0; k < 3; k++)
            if (zero >> k & 1) q[k] = all(0); /* turns about axes and in planes; of 7 nothing but w is left */
        if (i % 3 == 0 && zero != 7) q[3] = all(0); /* half turns */
        rbdi_unit_quaternion(q, q);
        rbd_rotation_to_quaternion(rbd_rotation_from_quaternion(q), found);
        for (int lane = 0; lane < LANES; lane++) {
            double same = 0, opposite = 0;
            for (int k = 0; k < 4; k++) {
                same = larger(same, fabs(get(found[k] - q[k], lane)));
                opposite = larger(opposite, fabs(get(found[k] + q[k], lane)));
            }
            SMALL(fmin(same, opposite), BOUND);
            ck_assert(get(found[3], lane) >= 0);
        }
    }
}
END_TEST

START_TEST(roll_pitch_yaw_are_those_of_urdf_and_come_back) {
    const rbd_real o = all(0), one = all(1);
    const double edges[] = {0, 1e-30, 1e-12, 1e-8, 1e-3, -1e-8};
    seed = 3;
    for (int i = 0; i < TRIALS; i++) {
        const double edge = edges[i % 6], half = i & 1 ? PI / 2 : -PI / 2;
        const rbd_real roll = draw(3.1), yaw = draw(3.1), pitch = i % 4 ? draw(1.5) : all(half + edge);
        const rbd_rotation r = rbd_rotation_from_rpy(roll, pitch, yaw);
        const rbd_rotation z = rbd_rotation_from_axis_angle(rbd_vec3_of(o, o, one), yaw),
                           y = rbd_rotation_from_axis_angle(rbd_vec3_of(o, one, o), pitch),
                           x = rbd_rotation_from_axis_angle(rbd_vec3_of(one, o, o), roll);
        rbd_real rpy[3];
        SMALL(of_rotations(r, rbd_rotation_product(z, rbd_rotation_product(y, x))), BOUND);
        rbd_rotation_to_rpy(r, rpy);
        SMALL(of_rotations(rbd_rotation_from_rpy(rpy[0], rpy[1], rpy[2]), r), BOUND);
        for (int lane = 0; lane < LANES; lane++) ck_assert(fabs(get(rpy[1], lane)) <= PI / 2 + BOUND);
        if (i % 4 == 0) continue;
        EQUAL(rpy[0], roll, 20 * BOUND); /* near a pitch of 1.5 the angles lose a digit */
        EQUAL(rpy[1], pitch, 20 * BOUND);
        EQUAL(rpy[2], yaw, 20 * BOUND);
    }
}
END_TEST

static const double angles[] = {0, 1e-12, 1e-8,      1e-5,      1e-3,       0.1,        0.9,  1.1,
                                2, 3,     PI - 1e-3, PI - 1e-6, PI - 1e-10, PI - 1e-15, 1e-15};
enum { ANGLES = sizeof angles / sizeof *angles };

START_TEST(exp_and_log_of_rotations_undo_each_other) {
    seed = 4;
    for (int i = 0; i < TRIALS; i++) {
        const double angle = angles[i % ANGLES];
        const rbd_vec3 axis = unit(draw_vec(1)), turn = rbdi_scale(all(angle), axis);
        const rbd_rotation r = rbd_rotation_exp(turn);
        const rbd_vec3 log = rbd_rotation_log(r);
        rbd_real rows[9];
        rbd_vec3 found;
        rbd_rotation_to_array(r, rows);
        EQUAL(rows[1], r.xy, 0);
        EQUAL(rows[3], r.yx, 0);
        for (int k = 0; k < 3; k++) EQUAL(rows[6 + k], k == 0 ? r.zx : k == 1 ? r.zy : r.zz, 0);
        SMALL(of_rotations(rbd_rotation_from_array(rows), r), 0);
        SMALL(of_rotations(rbd_rotation_exp(log), r), BOUND);
        if (angle < PI - BOUND) SMALL(of_vecs(log, turn), BOUND * fmax(angle, 1e-12)); /* relative */
        EQUAL(rbd_rotation_to_axis_angle(r, &found), rbdi_sqrt(rbdi_dot(log, log)), 0);
        EQUAL(rbdi_dot(found, found), all(1), BOUND);
        SMALL(of_rotations(rbd_rotation_from_axis_angle(found, all(angle)), r), DOUBLE_BOUND);
    }
}
END_TEST

/* ---- placements ---- */

START_TEST(placements_compose_and_invert) {
    seed = 5;
    for (int i = 0; i < TRIALS; i++) {
        const rbd_placement hand = draw_placement(HAND, BASE), tool = draw_placement(TOOL, HAND),
                            camera = draw_placement(3, TOOL);
        const rbd_placement both = rbd_placement_compose(hand, tool);
        const rbd_vec3 point = draw_vec(1);
        SMALL(of_placements(rbd_placement_compose(hand, rbd_placement_inverse(hand)),
                            rbd_placement_identity(BASE, BASE)),
              BOUND);
        SMALL(of_placements(rbd_placement_compose(rbd_placement_inverse(hand), hand),
                            rbd_placement_identity(HAND, HAND)),
              BOUND);
        SMALL(of_placements(rbd_placement_compose(both, camera),
                            rbd_placement_compose(hand, rbd_placement_compose(tool, camera))),
              BOUND);
        SMALL(of_vecs(rbd_point_up(both, point), rbd_point_up(hand, rbd_point_up(tool, point))), BOUND);
        SMALL(of_vecs(rbd_point_down(both, rbd_point_up(both, point)), point), BOUND);
        SMALL(of_vecs(rbd_point_up(hand, rbdi_vec0()), hand.position), 0);
        SMALL(of_motions(rbd_motion_up(both, rbd_motion_of(point, point, TOOL)),
                         rbd_motion_up(hand, rbd_motion_up(tool, rbd_motion_of(point, point, TOOL)))),
              2 * BOUND);
    }
}
END_TEST

/* A screw by an angle about an axis through a point, with a slide along it. */
START_TEST(exp_of_placements_is_a_screw_and_log_undoes_it) {
    seed = 6;
    for (int i = 0; i < TRIALS; i++) {
        const double angle = angles[i % ANGLES];
        const rbd_vec3 axis = unit(draw_vec(1)), point = draw_vec(1), turn = rbdi_scale(all(angle), axis),
                       slide = rbdi_scale(draw(1), axis);
        const rbd_motion v = rbd_motion_of(turn, rbdi_sub(slide, rbdi_cross(turn, point)), BASE);
        const rbd_placement x = rbd_placement_exp(v, HAND);
        const rbd_motion log = rbd_placement_log(x);
        SMALL(of_vecs(rbd_point_up(x, point), rbdi_add(point, slide)), 2 * BOUND);
        for (int k = 0; k < 3; k++) {
            const rbd_vec3 arm = draw_vec(1);
            SMALL(of_vecs(rbd_point_up(x, rbdi_add(point, arm)),
                          rbdi_add(rbdi_add(point, slide), turned(axis, angle, arm))),
                  4 * BOUND);
        }
        SMALL(of_placements(rbd_placement_exp(log, HAND), x), 2 * BOUND);
        if (angle < PI - BOUND) SMALL(of_motions(log, v), 4 * BOUND);
        SMALL(of_motions(rbd_motion_up(x, rbd_motion_of(log.angular, log.linear, HAND)), log), 4 * BOUND);
    }
}
END_TEST

/* ---- motions and forces ---- */

START_TEST(what_goes_up_comes_down_and_power_stays) {
    seed = 7;
    for (int i = 0; i < TRIALS; i++) {
        const rbd_placement x = draw_placement(HAND, BASE);
        const rbd_motion m = draw_motion(HAND), n = draw_motion(BASE);
        const rbd_force f = draw_force(HAND), g = draw_force(BASE);
        SMALL(of_motions(rbd_motion_down(x, rbd_motion_up(x, m)), m), BOUND);
        SMALL(of_motions(rbd_motion_up(x, n), rbd_motion_down(rbd_placement_inverse(x), n)), BOUND);
        SMALL(of_forces(rbd_force_down(x, rbd_force_up(x, f)), f), BOUND);
        SMALL(of_forces(rbd_force_down(x, g), rbd_force_up(rbd_placement_inverse(x), g)), BOUND);
        EQUAL(rbd_power(rbd_motion_up(x, m), rbd_force_up(x, f)), rbd_power(m, f), BOUND);
        EQUAL(rbd_power(rbd_motion_down(x, n), rbd_force_down(x, g)), rbd_power(n, g), BOUND);
        /* a pure force at the hand's origin, seen from the base */
        SMALL(of_vecs(rbd_force_up(x, rbd_force_of(rbdi_vec0(), f.force, HAND)).moment,
                      rbdi_cross(x.position, rbd_rotate(x.rotation, f.force))),
              0);
        /* a body that turns about the hand's origin moves there with nothing, and at the base with this */
        SMALL(of_vecs(rbd_motion_up(x, rbd_motion_of(m.angular, rbdi_vec0(), HAND)).linear,
                      rbdi_cross(rbd_rotate(x.rotation, m.angular), rbdi_sub(rbdi_vec0(), x.position))),
              BOUND);
    }
}
END_TEST

static rbd_motion negative(rbd_motion m) { return rbd_motion_scale(all(-1), m); }

START_TEST(cross_products_have_their_identities) {
    seed = 8;
    for (int i = 0; i < TRIALS; i++) {
        const rbd_placement x = draw_placement(HAND, BASE);
        const rbd_motion u = draw_motion(HAND), v = draw_motion(HAND), w = draw_motion(HAND);
        const rbd_force f = draw_force(HAND);
        const rbd_motion uvw = rbd_motion_cross(u, rbd_motion_cross(v, w)),
                         vwu = rbd_motion_cross(v, rbd_motion_cross(w, u)),
                         wuv = rbd_motion_cross(w, rbd_motion_cross(u, v));
        SMALL(of_motions(rbd_motion_add(rbd_motion_add(uvw, vwu), wuv), rbd_motion_scale(all(0), u)), BOUND);
        SMALL(of_motions(rbd_motion_cross(u, v), negative(rbd_motion_cross(v, u))), 0);
        EQUAL(rbd_power(rbd_motion_cross(u, v), f), -rbd_power(v, rbd_force_cross(u, f)), BOUND);
        SMALL(of_motions(rbd_motion_up(x, rbd_motion_cross(u, v)),
                         rbd_motion_cross(rbd_motion_up(x, u), rbd_motion_up(x, v))),
              2 * BOUND);
        SMALL(of_forces(rbd_force_up(x, rbd_force_cross(u, f)),
                        rbd_force_cross(rbd_motion_up(x, u), rbd_force_up(x, f))),
              2 * BOUND);
        SMALL(of_forces(rbd_force_add(f, rbd_force_scale(all(-1), f)), rbd_force_scale(all(0), f)), 0);
    }
}
END_TEST

/* Carried along by v for a short time, a motion and a force change at the rates v x m and v x* f. */
START_TEST(cross_products_are_rates) {
    const double t = 1e-3; /* of fourth order: (8 (f(t) - f(-t)) - (f(2 t) - f(-2 t))) / 12 t */
    const double steps[4] = {t, -t, 2 * t, -2 * t}, weights[4] = {8, -8, -1, 1};
    seed = 9;
    for (int i = 0; i < TRIALS; i++) {
        const rbd_motion v = draw_motion(BASE), m = draw_motion(HAND);
        const rbd_force f = draw_force(HAND);
        rbd_motion rate = rbd_motion_of(rbdi_vec0(), rbdi_vec0(), BASE);
        rbd_force force_rate = rbd_force_of(rbdi_vec0(), rbdi_vec0(), BASE);
        for (int k = 0; k < 4; k++) {
            const rbd_placement x = rbd_placement_exp(rbd_motion_scale(all(steps[k]), v), HAND);
            const rbd_real weight = all(weights[k] / (12 * t));
            rate = rbd_motion_add(rate, rbd_motion_scale(weight, rbd_motion_up(x, m)));
            force_rate = rbd_force_add(force_rate, rbd_force_scale(weight, rbd_force_up(x, f)));
        }
        SMALL(of_motions(rate, rbd_motion_cross(v, rbd_motion_of(m.angular, m.linear, BASE))),
              1e-9 + BOUND / t);
        SMALL(of_forces(force_rate, rbd_force_cross(v, rbd_force_of(f.moment, f.force, BASE))),
              1e-9 + BOUND / t);
    }
}
END_TEST

/* ---- inertias ---- */

START_TEST(inertias_move_by_the_parallel_axis_theorem) {
    const rbd_const com[3] = {(rbd_const)0.5, (rbd_const)-0.25, 2},
                    inertia[6] = {2, (rbd_const)0.25, (rbd_const)-0.5, 3, (rbd_const)0.125, 4};
    const double expected[10] = {2,
                                 1,
                                 -0.5,
                                 4,
                                 2 + 2 * 4.0625,
                                 0.25 + 2 * 0.125,
                                 -0.5 - 2,
                                 3 + 2 * 4.25,
                                 0.125 + 2 * 0.5,
                                 4 + 2 * 0.3125};
    const rbd_inertia i = rbd_inertia_of(2, com, inertia, HAND);
    rbd_real found[10], wanted[10];
    rbd_inertia_to_parameters(i, found);
    for (int k = 0; k < 10; k++) wanted[k] = all(expected[k]);
    SMALL(worst(found, wanted, 10), BOUND);
    seed = 10;
    for (int k = 0; k < TRIALS; k++) { /* about the centre of mass, and on to the base */
        const rbd_vec3 c = rbd_vec3_of(rbdi_set(com[0]), rbdi_set(com[1]), rbdi_set(com[2]));
        const rbd_placement x = draw_placement(HAND, BASE),
                            at_com = rbd_placement_of(rbd_rotation_identity(), c, TOOL, HAND);
        const rbd_inertia central = rbd_inertia_down(at_com, i);
        SMALL(of_vecs(central.h, rbdi_vec0()), BOUND);
        SMALL(of_inertias(rbd_inertia_up(at_com, central), i), BOUND);
        SMALL(of_inertias(rbd_inertia_up(x, rbd_inertia_up(at_com, central)),
                          rbd_inertia_up(rbd_placement_compose(x, at_com), central)),
              20 * BOUND);
        SMALL(of_vecs(rbd_inertia_up(x, i).h, rbdi_scale(all(2), rbd_point_up(x, c))), 4 * BOUND);
        SMALL(of_inertias(rbd_inertia_down(x, rbd_inertia_up(x, i)), i), 20 * BOUND);
    }
}
END_TEST

START_TEST(momentum_and_energy_do_not_depend_on_the_frame) {
    seed = 11;
    for (int k = 0; k < TRIALS; k++) {
        const rbd_placement x = draw_placement(HAND, BASE);
        const rbd_inertia i = draw_inertia(HAND), other = draw_inertia(HAND);
        const rbd_motion v = draw_motion(HAND), w = draw_motion(HAND);
        const rbd_force p = rbd_inertia_times(i, v);
        SMALL(of_forces(rbd_inertia_times(rbd_inertia_up(x, i), rbd_motion_up(x, v)), rbd_force_up(x, p)),
              20 * BOUND);
        EQUAL(rbd_power(w, p), rbd_power(v, rbd_inertia_times(i, w)), 10 * BOUND); /* symmetry */
        SMALL(of_forces(rbd_inertia_times(rbd_inertia_add(i, other), v),
                        rbd_force_add(p, rbd_inertia_times(other, v))),
              10 * BOUND);
        /* momentum: mass times velocity of the centre of mass */
        const rbd_real mass = rbdi_set(i.mass);
        const rbd_vec3 com = rbdi_scale(all(1) / mass, i.h),
                       velocity = rbdi_add(v.linear, rbdi_cross(v.angular, com));
        SMALL(of_vecs(p.force, rbdi_scale(mass, velocity)), 10 * BOUND);
    }
}
END_TEST

/* ---- the reference results ---- */

static int moves(const ref_model *model, int body) {
    for (int b = body; b >= 0; b = model->bodies[b].parent)
        if (model->bodies[b].type != RBD_FIXED) return 1;
    return 0;
}

static void copy(const double *from, rbd_real *to, int n) {
    for (int k = 0; k < n; k++) to[k] = all(from[k]);
}

static void expect(const char *what, const ref_model *model, const rbd_real *found, const double *expected,
                   int n) {
    rbd_real wanted[6];
    double size = 1e-3;
    for (int k = 0; k < n; k++) size = larger(size, fabs(expected[k]));
    copy(expected, wanted, n);
    ck_assert_msg(worst(found, wanted, n) <= 10 * DOUBLE_BOUND * size, "%s: %s", model->name, what);
}

/* The bodies' inertias in the world, their sum, and the momentum about the centre of mass. */
static void check_momentum(const ref_model *model, const ref_state *s) {
    const rbd_const nothing[10] = {0};
    rbd_inertia whole = rbd_inertia_from_parameters(nothing, -1);
    rbd_force momentum = rbd_force_of(rbdi_vec0(), rbdi_vec0(), -1);
    rbd_real out[6], kinetic = all(0);
    for (int b = 0; b < model->nb; b++) {
        const rbd_body *body = &model->bodies[b];
        rbd_real rotation[9], position[3], velocity[6];
        rbd_const com[3], inertia[6], pi[10];
        for (int k = 0; k < 3; k++) com[k] = (rbd_const)body->com[k];
        for (int k = 0; k < 6; k++) inertia[k] = (rbd_const)body->inertia[k];
        for (int k = 0; k < 10; k++) pi[k] = (rbd_const)model->pi[10 * b + k];
        copy(s->body_R + 9 * b, rotation, 9);
        copy(s->body_p + 3 * b, position, 3);
        copy(s->body_vel + 6 * b, velocity, 6);
        const rbd_placement x = rbd_placement_from_arrays(rotation, position, b, -1);
        const rbd_inertia i = rbd_inertia_of((rbd_const)body->mass, com, inertia, b);
        const rbd_motion v = rbd_motion_from_array(velocity, b);
        SMALL(of_inertias(i, rbd_inertia_from_parameters(pi, b)), DOUBLE_BOUND * fmax(1, body->mass));
        if (!moves(model, b)) continue;
        whole = rbd_inertia_add(whole, rbd_inertia_up(x, i));
        momentum = rbd_force_add(momentum, rbd_force_up(x, rbd_inertia_times(i, v)));
        kinetic = kinetic + all(0.5) * rbd_power(v, rbd_inertia_times(i, v));
    }
    const rbd_real mass = rbdi_set(whole.mass);
    const rbd_placement com =
        rbd_placement_of(rbd_rotation_identity(), rbdi_scale(all(1) / mass, whole.h), 99, -1);
    rbd_vec3_to_array(com.position, out);
    expect("mass", model, &mass, &s->mass, 1);
    expect("com", model, out, s->com, 3);
    rbd_force_to_array(rbd_force_down(com, momentum), out);
    expect("momentum", model, out, s->h, 6);
    double rotors = 0;
    for (int b = 0; b < model->nb; b++)
        for (int k = 0; k < model->body_nv[b]; k++) {
            const double rate = s->v[model->body_iv[b] + k];
            rotors += model->bodies[b].armature[k] * rate * rate / 2;
        }
    kinetic = kinetic + all(rotors);
    expect("kinetic energy", model, &kinetic, &s->kinetic, 1);
}

START_TEST(momentum_is_that_of_the_reference) {
    for (int i = 0; i < reference_count; i++)
        for (int k = 0; k < reference_model(i)->nstates; k++)
            check_momentum(reference_model(i), &reference_model(i)->states[k]);
}
END_TEST

/* ---- structs ---- */

START_TEST(structs_are_their_numbers) {
    ck_assert_uint_eq(sizeof(rbd_motion), 6 * sizeof(rbd_real));
    ck_assert_uint_eq(sizeof(rbd_force), 6 * sizeof(rbd_real));
    ck_assert_uint_eq(sizeof(rbd_placement), 12 * sizeof(rbd_real));
    ck_assert_uint_eq(sizeof(rbd_inertia), 10 * sizeof(rbd_real));
}
END_TEST

int main(void) {
    Suite *suite = suite_create("spatial");
    SRunner *runner = srunner_create(suite);
    TCase *c = tcase_create("spatial");
    tcase_add_test(c, rotations_turn_as_rodrigues_says);
    tcase_add_test(c, quaternions_come_back);
    tcase_add_test(c, roll_pitch_yaw_are_those_of_urdf_and_come_back);
    tcase_add_test(c, exp_and_log_of_rotations_undo_each_other);
    tcase_add_test(c, placements_compose_and_invert);
    tcase_add_test(c, exp_of_placements_is_a_screw_and_log_undoes_it);
    tcase_add_test(c, what_goes_up_comes_down_and_power_stays);
    tcase_add_test(c, cross_products_have_their_identities);
    tcase_add_test(c, cross_products_are_rates);
    tcase_add_test(c, inertias_move_by_the_parallel_axis_theorem);
    tcase_add_test(c, momentum_and_energy_do_not_depend_on_the_frame);
    tcase_add_test(c, momentum_is_that_of_the_reference);
    tcase_add_test(c, structs_are_their_numbers);
    suite_add_tcase(suite, c);
    srunner_run_all(runner, CK_NORMAL);
    const int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}
