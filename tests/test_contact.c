/* test_contact.c - rbd_contact.h: the solver alone. The step is in test_contact_step.c. */
#include <float.h>
#include <limits.h>
#include <math.h>
#include <string.h>

#include "rbd_contact.h"

#include "suites.h"
#include "support.h"

static const double pi = 3.14159265358979323846;

enum { MOST = 24, MOST_ROWS = 3 * MOST };

/* A problem and its solution. */
typedef struct problem {
    int n, bounded, rows;
    double delta[MOST_ROWS * MOST_ROWS], b[MOST_ROWS], mu[MOST], lower[MOST_ROWS], upper[MOST_ROWS];
    double p[MOST_ROWS], u[MOST_ROWS];
    rbd_contact_state state[MOST];
    rbd_contact_solution solution;
    double tolerance;
    int iterations;
} problem;

static rbd_status solve(problem *x) {
    const rbd_contact_problem given = {x->n,     x->bounded, x->delta,     x->b,         x->mu,
                                       x->lower, x->upper,   x->tolerance, x->iterations};
    const size_t size = rbd_contact_solve_size(x->n, x->bounded);
    void *memory = memset(malloc(size), 0xff, size); /* NaN: what was never written shows */
    const rbd_status status = rbd_contact_solve(&given, memory, size, x->p, x->state, &x->solution);
    x->rows = 3 * x->n + x->bounded;
    for (int r = 0; r < x->rows; r++) x->u[r] = x->b[r] + dot(&x->delta[r * x->rows], x->p, x->rows);
    free(memory);
    return status;
}

/* The largest violation of the laws, of Le Lidec and others (2023): m/s, N s times m/s, N s. */
typedef struct violation {
    double into, signorini, dissipation, cone;
} violation;

static violation violation_of(const problem *x) {
    violation v = {0, 0, 0, 0};
    for (int i = 0; i < x->n; i++) {
        const double *p = &x->p[3 * i], *u = &x->u[3 * i], size = hypot(p[0], p[1]),
                     speed = hypot(u[0], u[1]);
        if (x->state[i] == RBD_APART) continue;
        v.into = larger(v.into, -u[2]);
        v.signorini = larger(v.signorini, fabs(p[2] * u[2]));
        v.dissipation = larger(v.dissipation, fabs(p[0] * u[0] + p[1] * u[1] + x->mu[i] * p[2] * speed));
        v.cone = larger(v.cone, larger(size - x->mu[i] * p[2] * (1 + 4 * DBL_EPSILON), -p[2]));
    }
    for (int i = 0, r = 3 * x->n; i < x->bounded; i++, r++) {
        const double low = fmin(x->p[r] - x->lower[i], 1), high = fmin(x->upper[i] - x->p[r], 1);
        v.cone = larger(v.cone, larger(-low, -high));
        v.signorini = larger(v.signorini, x->u[r] > 0 ? x->u[r] * low : -x->u[r] * high);
    }
    return v;
}

/* Delta = J M^-1 J' of random rows and `dofs` degrees of freedom. */
static void draw_delta(uint64_t *seed, problem *x, int dofs, double spread) {
    double J[MOST_ROWS * MOST_ROWS], inverse[MOST_ROWS];
    x->rows = 3 * x->n + x->bounded;
    ck_assert_int_le(dofs, MOST_ROWS);
    for (int k = 0; k < dofs; k++) inverse[k] = pow(10, uniform(seed, -spread, spread));
    for (int k = 0; k < x->rows * dofs; k++) J[k] = uniform(seed, -1, 1);
    for (int i = 0; i < x->rows; i++)
        for (int j = 0; j < x->rows; j++) {
            double sum = 0;
            for (int k = 0; k < dofs; k++) sum += J[i * dofs + k] * inverse[k] * J[j * dofs + k];
            x->delta[i * x->rows + j] = sum;
        }
    for (int r = 0; r < x->rows; r++) x->b[r] = uniform(seed, -1, 1), x->p[r] = 0;
}

/* ---- one contact ---- */

/* Across its friction along the angle: u where u_n = 0 with p = p_n (mu cos, mu sin, 1), which comes back. */
static double across(const problem *x, double angle, double p[3]) {
    const double e[2] = {cos(angle), sin(angle)}, *D = x->delta, mu = x->mu[0];
    double u[2];
    p[2] = -x->b[2] / (D[8] + mu * (D[6] * e[0] + D[7] * e[1]));
    p[0] = mu * p[2] * e[0], p[1] = mu * p[2] * e[1];
    for (int i = 0; i < 2; i++) u[i] = x->b[i] + dot(&D[3 * i], p, 3);
    return u[1] * e[0] - u[0] * e[1];
}

/* The distance of x->p from the nearest of all slips, found by trying directions and halving. */
static double nearest_slip(const problem *x) {
    const int tried = 720;
    double nearest = HUGE_VAL, p[3];
    for (int k = 0; k < tried; k++) {
        double low = 2 * pi * k / tried, high = 2 * pi * (k + 1) / tried, at_low = across(x, low, p);
        if (at_low * across(x, high, p) > 0) continue;
        for (int i = 0; i < 60; i++) {
            const double middle = (low + high) / 2;
            if (at_low * across(x, middle, p) > 0)
                low = middle;
            else
                high = middle;
        }
        across(x, low, p);
        if (p[2] > 0 &&
            (x->b[0] + dot(x->delta, p, 3)) * p[0] + (x->b[1] + dot(x->delta + 3, p, 3)) * p[1] <= 0)
            nearest = fmin(nearest, hypot(hypot(p[0] - x->p[0], p[1] - x->p[1]), p[2] - x->p[2]));
    }
    return nearest;
}

START_TEST(one_contact_is_one_of_all_solutions) {
    uint64_t seed = 1;
    int slips = 0, sticks = 0, opens = 0;
    for (int k = 0; k < 4000; k++) {
        problem x = {.n = 1, .tolerance = 1e-12};
        draw_delta(&seed, &x, 4, 0.5);
        x.mu[0] = pow(10, uniform(&seed, -1.5, 0.5));
        ck_assert_int_eq(solve(&x), RBD_OK);
        if (x.b[2] >= 0) {
            ck_assert_int_eq(x.state[0], RBD_OPENS);
            ck_assert_double_eq(largest(x.p, 3), 0);
            opens++;
        } else if (x.state[0] == RBD_STICKS) {
            ck_assert_double_le(largest(x.u, 3), 1e-12);
            sticks++;
        } else {
            ck_assert_int_eq(x.state[0], RBD_SLIPS);
            expect_figure(1, "one contact: distance from the nearest of all slips, share of p",
                          nearest_slip(&x) / largest(x.p, 3), 0, 1e-9);
            slips++;
        }
    }
    ck_assert_int_ge(slips, 500);
    ck_assert_int_ge(sticks, 200);
    ck_assert_int_ge(opens, 1000);
}
END_TEST

/* Conditions of Delta up to 1e9, mu from 0.01 to 10. */
START_TEST(one_contact_obeys_its_laws) {
    uint64_t seed = 2;
    for (int k = 0; k < 100000; k++) {
        problem x = {.n = 1};
        violation v;
        double noise; /* of the product Delta p, too */
        draw_delta(&seed, &x, 3, 2.2);
        x.mu[0] = pow(10, uniform(&seed, -2, 1));
        ck_assert_int_eq(solve(&x), RBD_OK);
        v = violation_of(&x);
        noise = 1e-6 + 16 * DBL_EPSILON * (x.delta[0] + x.delta[4] + x.delta[8]) * largest(x.p, 3);
        ck_assert_msg(v.cone <= 0, "block %d: cone %g", k, v.cone);
        expect_figure(1, "one contact, condition to 1e9: residual, m/s", x.solution.residual, 0, noise);
        expect_figure(1, "one contact, condition to 1e9: -u_n, m/s", v.into, 0, noise);
        expect_figure(1, "one contact, condition to 1e9: dissipation over 1 + |p|, m/s",
                      v.dissipation / (1 + largest(x.p, 3)), 0, 4 * noise);
    }
}
END_TEST

START_TEST(known_impulses_of_one_contact) {
    problem x = {.n = 1, .delta = {1, 0, 0, 0, 1, 0, 0, 0, 1}, .b = {0.3, 0.4, -1}, .mu = {0.25}};
    ck_assert_int_eq(solve(&x), RBD_OK); /* a mass of 1 kg: friction is mu p_n against the motion */
    ck_assert_double_eq_tol(x.p[0], -0.15, 1e-12);
    ck_assert_double_eq_tol(x.p[1], -0.2, 1e-12);
    ck_assert_double_eq_tol(x.p[2], 1, 1e-12);
    ck_assert_int_eq(x.state[0], RBD_SLIPS);
    x.mu[0] = 0.6;
    ck_assert_int_eq(solve(&x), RBD_OK);
    ck_assert_double_le(largest(x.u, 3), 1e-12);
    ck_assert_int_eq(x.state[0], RBD_STICKS);
    x.mu[0] = 0;
    ck_assert_int_eq(solve(&x), RBD_OK);
    ck_assert_double_eq(x.p[0], 0);
    ck_assert_double_eq_tol(x.u[2], 0, 1e-15);
    x.b[0] = x.b[1] = 0; /* nor does anything move along */
    ck_assert_int_eq(solve(&x), RBD_OK);
    ck_assert_double_eq_tol(x.p[2], 1, 1e-15);
    ck_assert_int_eq(x.state[0], RBD_SLIPS);
    x.b[2] = 0.1;
    ck_assert_int_eq(solve(&x), RBD_OK);
    ck_assert_double_eq(x.p[2], 0);
    ck_assert_int_eq(x.state[0], RBD_OPENS);
}
END_TEST

/* ---- several ---- */

/* p = P(p - u/d) step after step, which is slow but another way: u of the solution. */
static void iterate_projection(const problem *x, double u[MOST_ROWS]) {
    double p[MOST_ROWS] = {0}, trace = 0;
    for (int r = 0; r < x->rows; r++) trace += x->delta[r * x->rows + r];
    for (int k = 0; k < 400000; k++) {
        double change = 0;
        for (int r = 0; r < x->rows; r++) u[r] = x->b[r] + dot(&x->delta[r * x->rows], p, x->rows);
        for (int i = 0; i < x->n; i++) {
            double z[3], size;
            for (int j = 0; j < 3; j++) z[j] = p[3 * i + j] - u[3 * i + j] / trace;
            size = hypot(z[0], z[1]), z[2] = larger(z[2], 0);
            for (int j = 0; size > x->mu[i] * z[2] && j < 2; j++) z[j] *= x->mu[i] * z[2] / size;
            for (int j = 0; j < 3; j++)
                change = larger(change, fabs(z[j] - p[3 * i + j])), p[3 * i + j] = z[j];
        }
        for (int i = 0, r = 3 * x->n; i < x->bounded; i++, r++) {
            const double z = fmin(fmax(p[r] - u[r] / trace, x->lower[i]), x->upper[i]);
            change = larger(change, fabs(z - p[r])), p[r] = z;
        }
        if (change * trace < 1e-13) return;
    }
    ck_abort_msg("the projection does not converge");
}

static void draw_laws(uint64_t *seed, problem *x, double most) {
    for (int i = 0; i < x->n; i++) x->mu[i] = uniform(seed, 0, most);
    for (int i = 0; i < x->bounded; i++) { /* a limit, dry friction, something held */
        const int kind = below(seed, 3);
        x->lower[i] = kind == 0 ? 0 : kind == 1 ? -0.1 : -1e30, x->upper[i] = kind == 1 ? 0.1 : 1e30;
    }
}

START_TEST(two_methods_agree) {
    uint64_t seed = 3;
    for (int k = 0; k < 300; k++) {
        problem x = {.n = below(&seed, 4), .tolerance = 1e-12, .iterations = 200};
        double u[MOST_ROWS];
        x.bounded = below(&seed, 3) + !x.n;
        draw_delta(&seed, &x, 3 * x.n + x.bounded + 2, 0.1);
        draw_laws(&seed, &x, 0.4);
        ck_assert_int_eq(solve(&x), RBD_OK);
        ck_assert_double_le(x.solution.residual, 1e-12);
        iterate_projection(&x, u);
        for (int r = 0; r < x.rows; r++)
            expect_figure(2, "u by Newton's method and by projections, m/s", x.u[r], u[r], 1e-9);
    }
}
END_TEST

/* Redundant rows, up to 60; every problem is solved or says that it is not. */
START_TEST(random_problems_obey_their_laws) {
    uint64_t seed = 4;
    int unsolved = 0, steps = 0;
    const int problems = 3000;
    for (int k = 0; k < problems; k++) {
        problem x = {.n = below(&seed, 17), .tolerance = 1e-8, .iterations = 200};
        violation v;
        double scale;
        x.bounded = below(&seed, 12) + !x.n;
        draw_delta(&seed, &x, 3 + below(&seed, 30), 0.5);
        draw_laws(&seed, &x, 1);
        { /* velocities that some motion has, as J v: dependent rows do not contradict each other */
            double c[MOST_ROWS];
            for (int r = 0; r < x.rows; r++) c[r] = uniform(&seed, -1, 1);
            multiply(x.delta, c, x.rows, x.rows, x.b);
            for (int r = 0; r < x.rows; r++) x.b[r] *= 0.1;
        }
        ck_assert_int_eq(solve(&x), RBD_OK);
        v = violation_of(&x);
        scale = 1 + largest(x.p, x.rows);
        ck_assert_double_le(v.cone, 0);
        ck_assert_double_le(v.into, 2 * x.solution.residual + 1e-12);
        ck_assert_double_le(v.signorini, 4 * x.solution.residual * scale + 1e-12);
        ck_assert_double_le(v.dissipation, 8 * x.solution.residual * scale + 1e-12);
        unsolved += x.solution.residual > x.tolerance;
        steps += x.solution.newton_steps;
    }
    expect_figure(10, "random problems of up to 60 rows that are not solved, share",
                  (double)unsolved / problems, 0, 0.02);
    ck_assert_msg(steps <= 8 * problems, "%d Newton steps in %d problems", steps, problems);
}
END_TEST

/* A box that rests on both ends of two sides, 3 kg on four points: rank 6 of 12 rows. */
static problem box_on_four_points(double slope, double mu) {
    problem x = {.n = 4, .rows = 12};
    const double mass = 3, size[3] = {0.4, 0.3, 0.2}, h = 1e-3;
    for (int r = 0; r < 12; r++)
        for (int s = 0; s < 12; s++) {
            double row[2][3], place[2][3], sum = r % 3 == s % 3 ? 1 / mass : 0;
            for (int k = 0; k < 2; k++) {
                const int i = (k ? s : r) / 3, j = (k ? s : r) % 3;
                const double c[3] = {i & 1 ? 0.2 : -0.2, i & 2 ? 0.15 : -0.15, -0.1};
                memcpy(place[k], c, sizeof c);
                for (int a = 0; a < 3; a++) row[k][a] = 0; /* c x axis j: the moment of a unit force */
                row[k][(j + 1) % 3] = c[(j + 2) % 3], row[k][(j + 2) % 3] = -c[(j + 1) % 3];
            }
            for (int a = 0; a < 3; a++) {
                const double b = size[(a + 1) % 3], d = size[(a + 2) % 3];
                sum += row[0][a] * row[1][a] * 12 / (mass * (b * b + d * d));
            }
            x.delta[12 * r + s] = sum;
        }
    for (int i = 0; i < 4; i++)
        x.b[3 * i] = 9.81 * h * sin(slope), x.b[3 * i + 2] = -9.81 * h * cos(slope), x.mu[i] = mu;
    x.tolerance = 1e-12;
    return x;
}

START_TEST(box_on_a_slope) {
    const double h = 1e-3, degrees = pi / 180;
    for (int k = 0; k < 3; k++) {
        const double slope = (k == 0 ? 26 : k == 1 ? 27 : 40) * degrees;
        problem x = box_on_four_points(slope, 0.5);
        double sum = 0;
        ck_assert_int_eq(solve(&x), RBD_OK);
        ck_assert_double_le(x.solution.residual, 1e-12);
        for (int i = 0; i < 4; i++) {
            sum += x.p[3 * i + 2];
            ck_assert_double_eq_tol(x.u[3 * i], k == 0 ? 0 : h * 9.81 * (sin(slope) - 0.5 * cos(slope)),
                                    1e-12);
            if (k > 0) ck_assert_int_eq(x.state[i], RBD_SLIPS);
        }
        ck_assert_double_eq_tol(sum, 3 * 9.81 * h * cos(slope), 1e-9);
    }
}
END_TEST

START_TEST(warm_start_is_kept) {
    problem x = box_on_four_points(0.3, 0.7);
    double before[12];
    ck_assert_int_eq(solve(&x), RBD_OK);
    memcpy(before, x.p, sizeof before);
    ck_assert_int_eq(solve(&x), RBD_OK);
    ck_assert_int_eq(x.solution.sweeps, 1);
    ck_assert_int_eq(x.solution.newton_steps, 0);
    for (int r = 0; r < 12; r++) ck_assert_double_eq_tol(x.p[r], before[r], 1e-11);
}
END_TEST

START_TEST(few_iterations_leave_the_cones_intact) {
    uint64_t seed = 5;
    for (int k = 0; k < 500; k++) {
        problem x = {.n = 8, .bounded = 4, .tolerance = 1e-12, .iterations = 1 + below(&seed, 6)};
        draw_delta(&seed, &x, 12, 1.5);
        draw_laws(&seed, &x, 2);
        for (int r = 0; r < x.rows; r++) x.p[r] = uniform(&seed, -1, 1);
        ck_assert_int_eq(solve(&x), RBD_OK);
        ck_assert_double_le(violation_of(&x).cone, 0);
        ck_assert_int_le(x.solution.sweeps + x.solution.newton_steps, x.iterations);
    }
}
END_TEST

/* Rows of Delta scaled by 0 to 1e120, b and mu by 1e-300 to 1e300. */
START_TEST(strange_numbers_stay_finite) {
    uint64_t seed = 6;
    for (int k = 0; k < 2000; k++) {
        problem x = {.n = 1 + below(&seed, 6), .bounded = below(&seed, 3)};
        draw_delta(&seed, &x, 1 + below(&seed, 8), 1);
        draw_laws(&seed, &x, 1);
        for (int r = 0; r < x.rows; r++) {
            const int kind = below(&seed, 8);
            const double f = kind < 4 ? 1 : kind == 4 ? 0 : kind == 5 ? 1e-150 : kind == 6 ? 1e120 : 1e-9;
            if (below(&seed, 4) == 0) x.b[r] *= pow(10, uniform(&seed, -300, 300));
            for (int s = 0; s < x.rows; s++) x.delta[r * x.rows + s] *= f, x.delta[s * x.rows + r] *= f;
        }
        if (below(&seed, 4) == 0) x.mu[0] = pow(10, uniform(&seed, -300, 300));
        ck_assert_int_eq(solve(&x), RBD_OK);
        expect_figure(11, "strange numbers, 1e-300 to 1e300: answers that are not finite",
                      !(isfinite(largest(x.p, x.rows)) && isfinite(x.solution.residual)), 0, 0.5);
        for (int i = 0; i < x.n; i++) ck_assert_double_ge(x.p[3 * i + 2], 0);
    }
}
END_TEST

/* Contacts that move each other more than themselves: no robot has such a Delta, and Cholesky fails. */
START_TEST(indefinite_delta_stays_finite) {
    problem x = {.n = 2, .rows = 6, .mu = {0.5, 0.5}};
    for (int r = 0; r < 6; r++) x.delta[7 * r] = 1, x.delta[6 * r + (r + 3) % 6] = -4;
    x.b[2] = -1, x.b[5] = -2;
    ck_assert_int_eq(solve(&x), RBD_OK);
    ck_assert(isfinite(largest(x.p, 6)) && isfinite(x.solution.residual));
    ck_assert_double_eq(violation_of(&x).cone, 0);
}
END_TEST

START_TEST(contact_that_nothing_moves_is_apart) {
    problem x = {.n = 2, .rows = 6, .mu = {0.5, 0.5}};
    for (int r = 0; r < 3; r++) x.delta[7 * r] = 1, x.b[r] = x.b[r + 3] = -1;
    ck_assert_int_eq(solve(&x), RBD_OK);
    ck_assert_int_eq(x.state[1], RBD_APART);
    ck_assert_double_eq(largest(x.p + 3, 3), 0);
    ck_assert_int_eq(x.state[0], RBD_SLIPS);
    x.p[3] = x.p[5] = 1; /* nor does it keep what it begins with */
    ck_assert_int_eq(solve(&x), RBD_OK);
    ck_assert_double_eq(largest(x.p + 3, 3), 0);
}
END_TEST

/* A contact that jams, with impulses that grow from sweep to sweep, beside one that slips: rounding of the
   former's in u shall not hide what the latter is off by. */
START_TEST(residual_belongs_to_the_impulses) {
    static const double delta[21] = {0.0047014311527762203, -0.054038763126700792, 0.023063390202048333,
                                     -0.039833116406557206, 0.045204513327529582,  -0.0097442173358714638,
                                     0.62112744510558038,   -0.26509312580089683,  0.45784619026509876,
                                     -0.51958561310031648,  0.11200109825224386,   0.11314000999415626,
                                     -0.195405755565633,    0.22175573689957503,   -0.0478013352376883,
                                     30.787011900919882,    4.0949266504693762,    -21.110040330661942,
                                     1.3573875433726017,    -3.4426839908942499,   14.974465893280104};
    static const double b[6] = {-0.045861825134135788, 0.52714082679234342, -0.42498025262414674,
                                5.4623562312626488,    -1.3178134740367049, -1.5087175712169505};
    problem x;
    double terms = 0;
    int k = 0;
    memset(&x, 0, sizeof x);
    x.n = 2, x.mu[0] = 1.2028081436985711, x.mu[1] = 0.45824592395264208;
    x.tolerance = 1e-13, x.iterations = 2000;
    for (int r = 0; r < 6; r++) {
        x.b[r] = b[r];
        for (int j = r; j < 6; j++, k++) x.delta[6 * r + j] = x.delta[6 * j + r] = delta[k];
    }
    ck_assert_int_eq(solve(&x), RBD_OK);
    ck_assert_double_gt(x.p[5], 0);
    for (int j = 0; j < 6; j++) terms += fabs(x.delta[30 + j] * x.p[j]);
    ck_assert_double_le(fabs(x.u[5]), 2 * x.solution.residual + 8 * DBL_EPSILON * terms + 1e-9);
}
END_TEST

/* Four equal rows that ask for different velocities: forces change hands without any effect until three of
   them open. */
START_TEST(equal_contacts_at_different_gaps) {
    problem x = {.n = 4, .tolerance = 1e-9};
    for (int r = 0; r < 12; r++)
        for (int k = 0; k < 12; k++) x.delta[12 * r + k] = r % 3 == k % 3 ? 0.1 : 0;
    for (int i = 0; i < 4; i++) x.b[3 * i + 2] = -1 + 2e-4 * (3 - i), x.p[3 * i + 2] = i ? 0 : 9;
    ck_assert_int_eq(solve(&x), RBD_OK);
    ck_assert_double_le(x.solution.residual, 1e-9);
    ck_assert_double_eq_tol(x.p[11], 10, 1e-7);
    for (int i = 0; i < 4; i++) ck_assert_double_eq_tol(x.u[3 * i + 2], 2e-4 * (3 - i), 1e-8);
    for (int i = 0; i < 3; i++) ck_assert_double_eq(x.p[3 * i + 2], 0);
    problem y = {.bounded = 3, .tolerance = 1e-9, .upper = {8, 1, 9}}; /* the same with bounds */
    for (int k = 0; k < 9; k++) y.delta[k] = 0.1;
    for (int i = 0; i < 3; i++) y.b[i] = -1 + 2e-4 * i, y.p[i] = i ? 0 : 8;
    ck_assert_int_eq(solve(&y), RBD_OK);
    ck_assert_double_le(y.solution.residual, 1e-9);
    ck_assert_double_eq_tol(y.p[0] + y.p[1] + y.p[2], 9.996, 1e-7);
}
END_TEST

/* A point that only moves along one line, under a friction that blocks it: no impulse makes it open. The
   answer is no impulse that velocities are lost in. */
START_TEST(jammed_contact_has_a_bounded_answer) {
    problem x = {.n = 1, .mu = {2}, .b = {0, 0, -1}};
    const double line[3] = {1, 0, 0.7};
    for (int k = 0; k < 9; k++) x.delta[k] = line[k / 3] * line[k % 3];
    ck_assert_int_eq(solve(&x), RBD_OK);
    ck_assert_double_gt(x.solution.residual, 0.1);
    ck_assert_double_le(largest(x.p, 3), 1e9);
    ck_assert_double_le(violation_of(&x).cone, 0);
}
END_TEST

/* Not what is asked for, but answered: a Delta that is not positive semidefinite. */
START_TEST(indefinite_matrix_is_survived) {
    problem x = {.bounded = 2, .delta = {1, 2, 2, 1}, .b = {-1, 1}, .lower = {-1e30, -1e30}};
    x.upper[0] = x.upper[1] = 1e30;
    ck_assert_int_eq(solve(&x), RBD_OK);
    ck_assert(isfinite(x.p[0]) && isfinite(x.p[1]) && isfinite(x.solution.residual));
    ck_assert_double_le(larger(fabs(x.p[0]), fabs(x.p[1])), 1e30);
}
END_TEST

/* A row that nothing moves but rounding takes no force. */
START_TEST(row_that_is_rounding_is_apart) {
    problem x = {.bounded = 2, .delta = {1, 0, 0, 1e-33}, .b = {-1, -1}, .lower = {-1e30, -1e30}};
    x.upper[0] = x.upper[1] = 1e30;
    ck_assert_int_eq(solve(&x), RBD_OK);
    ck_assert_double_eq_tol(x.p[0], 1, 1e-12);
    ck_assert_double_eq(x.p[1], 0);
}
END_TEST

/* Impulses whose squares vanish, or are not normal, are within their cones all the same. */
START_TEST(tiny_impulses_are_within_their_cones) {
    for (int k = 100; k <= 300; k += 20) {
        const double tiny = pow(10, -k);
        problem x = {
            .n = 1, .mu = {0.5}, .b = {3 * tiny, -tiny, -tiny}, .delta = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
        ck_assert_int_eq(solve(&x), RBD_OK);
        ck_assert_double_ge(x.p[2], 0);
        ck_assert_double_le(hypot(x.p[0] / tiny, x.p[1] / tiny), 0.5 * x.p[2] / tiny * (1 + 1e-12));
    }
}
END_TEST

START_TEST(same_bits_on_each_run) {
    uint64_t seed = 7;
    problem x = {.n = 12, .bounded = 6}, y;
    draw_delta(&seed, &x, 14, 0.5);
    draw_laws(&seed, &x, 1);
    y = x;
    ck_assert_int_eq(solve(&x), RBD_OK);
    ck_assert_int_eq(solve(&y), RBD_OK);
    expect_figure(14, "second solutions whose impulses differ", memcmp(x.p, y.p, sizeof x.p) != 0, 0, 0.5);
}
END_TEST

START_TEST(bad_problems_are_refused) {
    problem x = {
        .n = 1, .bounded = 1, .delta = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}, .upper = {1}};
    rbd_contact_problem given = {1, 1, x.delta, x.b, x.mu, x.lower, x.upper, 0, 0}, bad;
    unsigned char memory[4000];
    const size_t size = rbd_contact_solve_size(1, 1);
    ck_assert_uint_le(size, sizeof memory);
    ck_assert_int_eq(rbd_contact_solve(&given, memory, size, x.p, NULL, NULL), RBD_OK);
    ck_assert_int_eq(rbd_contact_solve(&given, memory, size - 1, x.p, NULL, NULL), RBD_ERR_MEMORY);
    ck_assert_int_eq(rbd_contact_solve(NULL, memory, size, x.p, NULL, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_contact_solve(&given, NULL, size, x.p, NULL, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_contact_solve(&given, memory, size, NULL, NULL, NULL), RBD_ERR_NULL);
    ck_assert_uint_eq(rbd_contact_solve_size(-1, 0), 0);
    ck_assert_uint_eq(rbd_contact_solve_size(0, -1), 0);
    ck_assert_uint_eq(rbd_contact_solve_size(15500, 0), 0);
    ck_assert_uint_eq(rbd_contact_solve_size(1, INT_MAX), 0);
    ck_assert_uint_eq(rbd_contact_solve_size(INT_MAX, 1), 0);
    ck_assert_uint_gt(rbd_contact_solve_size(15000, 0), 8u * 45000 * 45000);
#define REFUSED(change, status) \
    bad = given, bad.change; \
    ck_assert_int_eq(rbd_contact_solve(&bad, memory, size, x.p, NULL, NULL), status)
    REFUSED(contacts = -1, RBD_ERR_COUNT);
    REFUSED(bounded = -1, RBD_ERR_COUNT);
    REFUSED(contacts = 15500, RBD_ERR_COUNT); /* 46,500 rows: their matrix has no int for an index */
    REFUSED(bounded = 46500, RBD_ERR_COUNT);
    REFUSED(contacts = INT_MAX, RBD_ERR_COUNT);
    REFUSED(bounded = INT_MAX, RBD_ERR_COUNT);
    REFUSED(delta = NULL, RBD_ERR_NULL);
    REFUSED(b = NULL, RBD_ERR_NULL);
    REFUSED(friction = NULL, RBD_ERR_NULL);
    REFUSED(lower = NULL, RBD_ERR_NULL);
    REFUSED(upper = NULL, RBD_ERR_NULL);
    REFUSED(tolerance = -1, RBD_ERR_RANGE);
    REFUSED(tolerance = NAN, RBD_ERR_RANGE);
    REFUSED(iterations = -1, RBD_ERR_RANGE);
#undef REFUSED
    x.mu[0] = -1;
    ck_assert_int_eq(solve(&x), RBD_ERR_RANGE);
    x.mu[0] = NAN;
    ck_assert_int_eq(solve(&x), RBD_ERR_RANGE);
    x.mu[0] = 1, x.upper[0] = -1;
    ck_assert_int_eq(solve(&x), RBD_ERR_RANGE);
    x.upper[0] = 1, x.b[3] = INFINITY, x.p[0] = 1;
    ck_assert_int_eq(solve(&x), RBD_ERR_NAN);
    ck_assert_double_eq(largest(x.p, 4), 0);
    x.b[3] = 0, x.p[3] = NAN;
    ck_assert_int_eq(solve(&x), RBD_ERR_NAN);
    ck_assert_double_eq(largest(x.p, 4), 0);
    for (int k = 0; k < 16; k++) {
        const double entry = x.delta[k];
        x.delta[k] = k % 2 ? NAN : INFINITY;
        x.p[0] = 1;
        ck_assert_int_eq(solve(&x), RBD_ERR_NAN);
        ck_assert_double_eq(largest(x.p, 4), 0);
        x.delta[k] = entry;
    }
    ck_assert_int_eq(solve(&x), RBD_OK);
    given.contacts = given.bounded = 0, given.delta = given.b = given.friction = NULL;
    ck_assert_int_eq(rbd_contact_solve(&given, memory, size, NULL, NULL, NULL), RBD_OK);
}
END_TEST

/* A normal that tangents' rounding moves, 16 eps of them, is moved by nothing. */
START_TEST(normal_that_rounding_moves_is_apart) {
    const double share = 16 * DBL_EPSILON, trace = 2;
    problem x = {.n = 1, .mu = {0.5}, .b = {0, 0, -1}, .delta = {1, 0, 0, 0, 1, 0, 0, 0, 0}};
    x.delta[8] = trace * share * share / 4;
    ck_assert_int_eq(solve(&x), RBD_OK);
    ck_assert_int_eq(x.state[0], RBD_APART);
    x.delta[8] = trace * share * share * 4;
    ck_assert_int_eq(solve(&x), RBD_OK);
    ck_assert_int_ne(x.state[0], RBD_APART);
}
END_TEST

/* Rest at the edge of the cone is rest, to 16 eps: the state decides what derivatives are. */
START_TEST(rest_on_the_cone_sticks) {
    static const double beyond[4] = {-4, 4, 14, 40}; /* eps */
    for (int k = 0; k < 4; k++) {
        problem x = {.n = 1, .mu = {0.5}, .b = {0, 0, -1}, .delta = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
        x.b[0] = -0.5 * (1 + beyond[k] * DBL_EPSILON);
        ck_assert_int_eq(solve(&x), RBD_OK);
        ck_assert_int_eq(x.state[0], k < 3 ? RBD_STICKS : RBD_SLIPS);
        ck_assert_double_le(x.p[0], 0.5 * x.p[2]);
    }
}
END_TEST

/* A tolerance of 0 is that of 1e-6, to the bit, and no other; 0 iterations are 40. */
START_TEST(defaults_are_those_that_are_documented) {
    int others = 0;
    uint64_t seed = 8;
    for (int i = 0; i < 100; i++) {
        problem x = {.n = 6, .bounded = 3}, y;
        draw_delta(&seed, &x, 20, 0.5);
        draw_laws(&seed, &x, 1);
        x.tolerance = 0, x.iterations = 0;
        y = x;
        ck_assert_int_eq(solve(&x), RBD_OK);
        static const double tolerances[3] = {1e-6, 3e-6, 3e-7};
        for (int k = 0; k < 3; k++) {
            problem z = y;
            z.tolerance = tolerances[k], z.iterations = 40;
            ck_assert_int_eq(solve(&z), RBD_OK);
            if (k == 0) ck_assert_int_eq(memcmp(z.p, x.p, sizeof x.p), 0);
            others += memcmp(z.p, x.p, sizeof x.p) != 0;
        }
    }
    ck_assert_int_gt(others, 0);
}
END_TEST

Suite *contact_suite(void) {
    Suite *suite = suite_create("contact");
    TCase *c = tcase_create("contact");
    tcase_set_timeout(c, 60);
    tcase_add_test(c, one_contact_is_one_of_all_solutions);
    tcase_add_test(c, one_contact_obeys_its_laws);
    tcase_add_test(c, known_impulses_of_one_contact);
    tcase_add_test(c, two_methods_agree);
    tcase_add_test(c, random_problems_obey_their_laws);
    tcase_add_test(c, box_on_a_slope);
    tcase_add_test(c, warm_start_is_kept);
    tcase_add_test(c, few_iterations_leave_the_cones_intact);
    tcase_add_test(c, strange_numbers_stay_finite);
    tcase_add_test(c, indefinite_delta_stays_finite);
    tcase_add_test(c, contact_that_nothing_moves_is_apart);
    tcase_add_test(c, residual_belongs_to_the_impulses);
    tcase_add_test(c, equal_contacts_at_different_gaps);
    tcase_add_test(c, jammed_contact_has_a_bounded_answer);
    tcase_add_test(c, indefinite_matrix_is_survived);
    tcase_add_test(c, row_that_is_rounding_is_apart);
    tcase_add_test(c, tiny_impulses_are_within_their_cones);
    tcase_add_test(c, same_bits_on_each_run);
    tcase_add_test(c, bad_problems_are_refused);
    tcase_add_test(c, normal_that_rounding_moves_is_apart);
    tcase_add_test(c, rest_on_the_cone_sticks);
    tcase_add_test(c, defaults_are_those_that_are_documented);
    suite_add_tcase(suite, c);
    return suite;
}
