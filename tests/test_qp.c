/* test_qp.c - rbd_qp.h: known answers, the conditions of Karush, Kuhn and Tucker on random problems, a
   second method on small ones, proofs of contradiction, and every slip by its name. A program of its own,
   for double and float: RBD_REAL. */
#define RBD_IMPLEMENTATION
#include "rbd_qp.h"

#include <stdlib.h>
#include <string.h>

#include "larger.h"
#include "qp_problems.h"
#include "quiet_check.h"

#define LENGTH(array) ((int)(sizeof(array) / sizeof((array)[0])))

/* The sanitizers, which slow it down, see every fifth of the longest rows of random problems. */
#ifndef PART_OF_PROBLEMS
#define PART_OF_PROBLEMS 1
#endif

/* What a relative residual may be: a thousand roundings in the small, and the accuracy where H is singular.
   */
static const double tight = sizeof(rbd_real) == 4 ? 3e-4 : 1e-11;
static const double loose = sizeof(rbd_real) == 4 ? 1e-3 : 1e-9;

static void check_kkt(const rbd_qp_problem *p, double share, const char *what, int number) {
    const judgement worst = judge_solution(p);
    ck_assert_msg(worst.share <= share, "%s %d: %s, at %d, is off by %g", what, number, worst.condition,
                  worst.at, worst.share);
}
static void check_proof(const rbd_qp_problem *p, const char *what, int number) {
    const judgement worst = judge_proof(p);
    ck_assert_msg(worst.share <= tight, "%s %d: %s, at %d, is off by %g", what, number, worst.condition,
                  worst.at, worst.share);
}

static void set(rbd_real *to, const double *from, int n) {
    for (int i = 0; i < n; i++) to[i] = (rbd_real)from[i];
}

/* ---- known answers ---- */

typedef struct known {
    const char *name;
    int n, bounds, rows;
    double H[9], f[3], C[15], lower[8], upper[8], soft[8];
    rbd_qp_status status;
    double x[3], lambda[8];
} known;

#define I2 {1, 0, 0, 1}
#define I3 {1, 0, 0, 0, 1, 0, 0, 0, 1}
#define INF RBD_QP_NONE

static const known answers[] = {
    {"clip (3, 0.5) to the unit square",
     2,
     2,
     0,
     I2,
     {-3, -.5},
     {0},
     {0, 0},
     {1, 1},
     {0},
     RBD_QP_OK,
     {1, .5},
     {2, 0}},
    {"(1, 0.5, -0.5) onto the simplex",
     3,
     3,
     1,
     I3,
     {-1, -.5, .5},
     {1, 1, 1},
     {0, 0, 0, 1},
     {INF, INF, INF, 1},
     {0},
     RBD_QP_OK,
     {.75, .25, 0},
     {0, 0, -.75, .25}},
    {"x + y = 1, once, doubled, and again",
     2,
     0,
     3,
     I2,
     {0, 0},
     {1, 1, 2, 2, 1, 1},
     {1, 2, 1},
     {1, 2, 1},
     {0},
     RBD_QP_OK,
     {.5, .5},
     {-.5, 0, 0}},
    {"five rows through (1, 1)",
     2,
     0,
     5,
     I2,
     {0, 0},
     {1, 0, 1, 0, 0, 1, 1, 1, 2, 1},
     {1, 1, 1, 2, 3},
     {INF, INF, INF, INF, INF},
     {0},
     RBD_QP_OK,
     {1, 1},
     {0, 0, 0, -1, 0}},
    {"x >= 1 and x <= 0",
     2,
     0,
     2,
     I2,
     {0, 0},
     {1, 0, 1, 0},
     {1, -INF},
     {INF, 0},
     {0},
     RBD_QP_INFEASIBLE,
     {0},
     {-1, 1}},
    {"x + y = 1 and x + y = 2",
     2,
     0,
     2,
     I2,
     {0, 0},
     {1, 1, 1, 1},
     {1, 2},
     {1, 2},
     {0},
     RBD_QP_INFEASIBLE,
     {0},
     {1, -1}},
    {"x <= 1, y <= 2, x + y >= 4",
     2,
     0,
     3,
     I2,
     {0, 0},
     {1, 0, 0, 1, 1, 1},
     {-INF, -INF, 4},
     {1, 2, INF},
     {0},
     RBD_QP_INFEASIBLE,
     {0},
     {1, 1, -1}},
    {"0 x >= 1", 2, 0, 1, I2, {0, 0}, {0, 0}, {1}, {INF}, {0}, RBD_QP_INFEASIBLE, {0}, {-1}},
    {"a linear program",
     2,
     2,
     2,
     {0},
     {-1, -1},
     {1, 2, 4, 2},
     {0, 0, -INF, -INF},
     {INF, INF, 4, 12},
     {0},
     RBD_QP_OK,
     {8. / 3, 2. / 3},
     {0, 0, 1. / 3, 1. / 6}},
    {"y is free and costs nothing",
     2,
     0,
     0,
     {1, 0, 0, 0},
     {-1, 0},
     {0},
     {0},
     {0},
     {0},
     RBD_QP_OK,
     {1, 0},
     {0}},
    {"y falls for ever", 2, 0, 0, {1, 0, 0, 0}, {0, -1}, {0}, {0}, {0}, {0}, RBD_QP_UNBOUNDED, {0}, {0}},
    {"y falls, to 5",
     2,
     2,
     0,
     {1, 0, 0, 0},
     {0, -1},
     {0},
     {-INF, -INF},
     {INF, 5},
     {0},
     RBD_QP_OK,
     {0, 5},
     {0, 1}},
    {"x >= 1, weight 3",
     2,
     2,
     0,
     I2,
     {0, 0},
     {0},
     {1, -INF},
     {INF, INF},
     {3, 0},
     RBD_QP_OK,
     {.75, 0},
     {-.75, 0}},
    {"x >= 1, weight 3, and x <= 0, weight 1",
     2,
     0,
     2,
     I2,
     {0, 0},
     {1, 0, 1, 0},
     {1, -INF},
     {INF, 0},
     {3, 1},
     RBD_QP_OK,
     {.6, 0},
     {-1.2, .6}},
    {"x = 1, weight 1", 1, 1, 0, {1}, {0}, {0}, {1}, {1}, {1}, RBD_QP_OK, {.5}, {-.5}},
    {"(8, 0, 10) into the cone |fx| <= fz / 2",
     3,
     0,
     2,
     I3,
     {-8, 0, -10},
     {1, 0, -.5, -1, 0, -.5},
     {-INF, -INF},
     {0, 0},
     {0},
     RBD_QP_OK,
     {5.6, 0, 11.2},
     {2.4, 0}},
    {"a saddle", 2, 0, 0, {1, 2, 2, 1}, {0, 0}, {0}, {0}, {0}, {0}, RBD_QP_CONVEX, {0}, {0}},
    {"x = 1, twice", 1, 1, 1, {1}, {0}, {1}, {1, 1}, {1, 1}, {0}, RBD_QP_OK, {1}, {-1, 0}},
    {"nothing is asked for", 2, 0, 0, {0}, {0, 0}, {0}, {0}, {0}, {0}, RBD_QP_OK, {0, 0}, {0}},
    {"y falls for ever beside walls",
     2,
     2,
     0,
     {1, 0, 0, 0},
     {-3, -1},
     {0},
     {0, 0},
     {1, INF},
     {0},
     RBD_QP_UNBOUNDED,
     {0},
     {0}},
    {"an arrow",
     3,
     0,
     1,
     {2, 0, 1, 0, 1, 0, 1, 0, 2},
     {0, 0, 0},
     {1, 1, 1},
     {5},
     {5},
     {0},
     RBD_QP_OK,
     {1, 3, 1},
     {-3}},
    {"a row of one block of H",
     3,
     0,
     1,
     {2, 0, 0, 0, 2, 1, 0, 1, 2},
     {0, 0, 0},
     {1, 0, 0},
     {1},
     {1},
     {0},
     RBD_QP_OK,
     {1, 0, 0},
     {-2}},
    {"any point will do", 2, 0, 1, {0}, {0, 0}, {1, 1}, {2}, {INF}, {0}, RBD_QP_OK, {1, 1}, {0}},
    {"without rows", 2, 0, 0, {2, 1, 1, 2}, {-3, -3}, {0}, {0}, {0}, {0}, RBD_QP_OK, {1, 1}, {0}},
};

START_TEST(known_answers_come_out) {
    const known *k = &answers[_i];
    rbd_qp_problem p = problem_of(k->n, k->bounds, k->rows);
    const int all = k->bounds + k->rows;
    int is_soft = 0;

    set(H, k->H, k->n * k->n);
    set(f, k->f, k->n);
    set(C, k->C, k->rows * k->n);
    set(lower, k->lower, all);
    set(upper, k->upper, all);
    set(soft, k->soft, all);
    for (int row = 0; row < all; row++) is_soft |= k->soft[row] > 0;
    if (is_soft) p.soft = soft;

    ck_assert_msg(solve(&p) == k->status, "%s", k->name);
    if (k->status == RBD_QP_OK)
        for (int i = 0; i < k->n; i++)
            ck_assert_msg(fabs((double)x[i] - k->x[i]) <= tight * 10, "%s: x[%d] = %.17g", k->name, i,
                          (double)x[i]);
    if (k->status == RBD_QP_OK || k->status == RBD_QP_INFEASIBLE)
        for (int row = 0; row < all; row++)
            ck_assert_msg(fabs((double)lambda[row] - k->lambda[row]) <= tight * 10, "%s: lambda[%d] = %.17g",
                          k->name, row, (double)lambda[row]);
    if (k->status == RBD_QP_INFEASIBLE) check_proof(&p, k->name, 0);
}
END_TEST

START_TEST(random_problems_satisfy_their_conditions) {
    const kind of = (kind)_i;
    const int is_float = sizeof(rbd_real) == 4;
    int solved = 0;

    seed = 100 + (uint64_t)_i;
    for (int k = 0; k < 1000 / PART_OF_PROBLEMS; k++) {
        rbd_qp_problem p = random_problem(of);
        rbd_qp_status status;
        if (of == SCALED) scale(&p);
        status = solve(&p);
        /* In float a row may depend on others to rounding: then INACCURATE says so. */
        if (!is_float) ck_assert_msg(status == RBD_QP_OK, "%s %d: status %d", kind_names[of], k, status);
        if (status != RBD_QP_OK) continue;
        solved++;
        check_kkt(&p,
                  is_float                             ? 3 * loose
                  : of == SEMIDEFINITE || of == LINEAR ? loose
                                                       : tight,
                  kind_names[of], k);
        ck_assert(result.primal <= 10 * RBDI_QP_ACCURACY && result.dual <= 10 * RBDI_QP_ACCURACY);
    }
    ck_assert_int_ge(solved, 970 / PART_OF_PROBLEMS);
}
END_TEST

START_TEST(contradictions_are_found_and_proven) {
    int proven = 0;
    seed = 7;
    for (int k = 0; k < 300; k++) {
        if (k == 299) seed = 2557007672; /* in float its rows join, with multipliers of 1e13 that cancel */
        const rbd_qp_problem p = contradiction();
        const rbd_qp_status status = solve(&p);
        if (sizeof(rbd_real) == 4 && status == RBD_QP_INACCURATE) continue; /* not proven */
        ck_assert_msg(status == RBD_QP_INFEASIBLE, "problem %d: status %d", k, status);
        proven++;
        ck_assert(result.at >= 0 && result.field && lambda[result.at] != 0);
        check_proof(&p, "contradiction", k);
    }
    ck_assert_int_ge(proven, 280);
}
END_TEST

/* Two rows at an angle of 1/2 to 1e-6, and 1e-11 in double: their multipliers grow as 1 over it, and cancel.
   Where rounding of these is as large as the gradient, an answer is not called exact; far from there it
   is. */
START_TEST(multipliers_that_cancel_hide_no_gradient) {
    const double epsilon = sizeof(rbd_real) == 4 ? 6e-8 : 1.1e-16;
    const double least = sizeof(rbd_real) == 4 ? 1e-6 : 1e-11;
    int inexact = 0;
    seed = 17;
    for (double angle = .5; angle > least; angle /= 2) {
        for (int k = 0; k < 20; k++) {
            const int n = between(2, 9);
            const rbd_qp_problem p = problem_of(n, 0, 2);
            double inside[MOST_N];
            rbd_qp_status status;

            for (int i = 0; i < n; i++) {
                for (int j = 0; j < n; j++) H[i * n + j] = i == j;
                inside[i] = normal();
                f[i] = (rbd_real)normal();
                C[i] = (rbd_real)normal();
                C[n + i] = C[i] + (rbd_real)(angle * normal());
            }
            for (int row = 0; row < 2; row++) {
                double value = 0;
                for (int j = 0; j < n; j++) value += entry(&p, row, j) * inside[j];
                lower[row] = upper[row] = (rbd_real)value;
            }

            status = solve(&p);
            if (angle > 10 * epsilon / RBDI_QP_ACCURACY)
                ck_assert_msg(status == RBD_QP_OK, "angle %g: %d", angle, status);
            if (status != RBD_QP_OK)
                inexact++;
            else
                ck_assert_msg(gradient_share(&p) <= 20 * RBDI_QP_ACCURACY, "angle %g: %g of the gradient",
                              angle, gradient_share(&p));
        }
    }
    ck_assert_int_gt(inexact, 0);
}
END_TEST

/* ---- corrections ---- */

/* H, whose eigenvalues lie so many decades apart, with equalities and rows that pass by a point. */
static rbd_qp_problem stiff_problem(double decades) {
    const int n = between(4, 20), equalities = between(1, n / 2), others = between(0, 10);
    const rbd_qp_problem p = problem_of(n, 0, equalities + others);
    double B[20][20], inside[20];

    for (int i = 0; i < n; i++) { /* orthonormal, by Gram and Schmidt, twice */
        for (int j = 0; j < n; j++) B[i][j] = normal();
        for (int k = 0; k < 2 * i; k++) {
            double along = 0;
            for (int j = 0; j < n; j++) along += B[i][j] * B[k % i][j];
            for (int j = 0; j < n; j++) B[i][j] -= along * B[k % i][j];
        }
        double square = 0;
        for (int j = 0; j < n; j++) square += B[i][j] * B[i][j];
        for (int j = 0; j < n; j++) B[i][j] /= sqrt(square);
    }
    for (int i = 0; i < n; i++) {
        inside[i] = normal();
        f[i] = (rbd_real)normal();
        for (int j = 0; j <= i; j++) {
            double sum = 0;
            for (int r = 0; r < n; r++) sum += pow(10, -decades * r / (n - 1)) * B[r][i] * B[r][j];
            H[i * n + j] = H[j * n + i] = (rbd_real)sum;
        }
    }
    for (int row = 0; row < p.rows; row++) {
        double value = 0;
        for (int j = 0; j < n; j++) C[row * n + j] = (rbd_real)normal();
        for (int j = 0; j < n; j++) value += entry(&p, row, j) * inside[j];
        lower[row] = row < equalities ? (rbd_real)value : -NONE;
        upper[row] = (rbd_real)(row < equalities ? value : value + fabs(normal()));
    }
    return p;
}

/* x and lambda to rounding: active rows hold as shares of their length and x, the gradient of its largest
   term, and the values that the solver keeps of all rows are those of this x. */
static void check_to_rounding(const rbdi_qp *s, const rbd_qp_problem *p, int number) {
    const long double epsilon = sizeof(rbd_real) == 4 ? 0x1p-23L : 0x1p-52L;
    const long double far = (long double)largest_of(x, p->n);
    long double bound = 0, worst = 0;

    for (int row = 0; row < p->rows; row++) {
        long double value = 0, terms = 0, square = 0;
        for (int j = 0; j < p->n; j++) {
            const long double c = (long double)p->C[row * p->n + j], term = c * (long double)x[j];
            value += term;
            terms += fabsl(term);
            square += c * c;
        }
        const long double length = sqrtl(square), push = fabsl((long double)lambda[row]) * length;
        bound = fmaxl(bound, push);

        const long double kept = fabsl(value - (long double)s->value[row]);
        ck_assert_msg(kept <= 4 * epsilon * terms, "problem %d: value of row %d, by %Lg", number, row, kept);
        if (lambda[row] == 0) continue;
        const long double missed = fabsl(value - (long double)p->upper[row]) / length;
        ck_assert_msg(missed <= 32 * epsilon * far, "problem %d: row %d, by %Lg", number, row, missed);
    }

    for (int i = 0; i < p->n; i++) {
        long double sum = (long double)p->f[i], terms = fabsl(sum);
        for (int j = 0; j < p->n; j++) {
            const long double term = (long double)p->H[i * p->n + j] * (long double)x[j];
            sum += term;
            terms += fabsl(term);
        }
        for (int row = 0; row < p->rows; row++)
            sum += (long double)p->C[row * p->n + i] * (long double)lambda[row];
        bound = fmaxl(bound, terms);
        worst = (long double)larger((double)worst, (double)fabsl(sum));
    }
    ck_assert_msg(worst <= 32 * epsilon * bound, "problem %d: gradient %Lg of %Lg", number, worst, bound);
}

/* Of H whose eigenvalues lie far apart factors alone leave a thousand roundings: corrections mend them, after
   steps, and before any where the guess is right. */
START_TEST(corrections_leave_nothing_but_rounding) {
    int without_steps = 0;
    seed = 5;
    for (int k = 0; k < 200; k++) {
        const rbd_qp_problem p = stiff_problem(sizeof(rbd_real) == 4 ? 3 : 8);
        const rbdi_qp_shape any = {0, p.n, 0, 0, 0};
        for (int warm = 0; warm < 2; warm++) {
            const rbd_qp_options options = {.warm = warm};
            rbdi_qp s;
            const rbd_qp_status status =
                rbdi_qp_solve(&s, &p, &options, &any, memory, sizeof memory, x, lambda, side);
            ck_assert_msg(status == RBD_QP_OK, "problem %d: status %d", k, status);
            check_to_rounding(&s, &p, k);
            without_steps += s.result.steps == 0 && s.q > 0;
        }
    }
    ck_assert_int_gt(without_steps, 100);
}
END_TEST

/* ---- a second method ---- */

/* Solves A y = b in place with column pivots; 0 if it is singular. */
static int gauss(double *A, double *b, int n) {
    for (int k = 0; k < n; k++) {
        int pivot = k;
        for (int i = k + 1; i < n; i++)
            if (fabs(A[i * n + k]) > fabs(A[pivot * n + k])) pivot = i;
        if (fabs(A[pivot * n + k]) < 1e-9) return 0;
        for (int j = 0; j < n; j++) {
            const double swap = A[k * n + j];
            A[k * n + j] = A[pivot * n + j];
            A[pivot * n + j] = swap;
        }
        const double swap = b[k];
        b[k] = b[pivot];
        b[pivot] = swap;
        for (int i = 0; i < n; i++) {
            const double share = A[i * n + k] / A[k * n + k];
            if (i == k) continue;
            for (int j = k; j < n; j++) A[i * n + j] -= share * A[k * n + j];
            b[i] -= share * b[k];
        }
    }
    for (int k = 0; k < n; k++) b[k] /= A[k * n + k];
    return 1;
}

static double value_of(const rbd_qp_problem *p, const double *at) {
    double value = 0;
    for (int i = 0; i < p->n; i++) {
        value += (double)p->f[i] * at[i];
        for (int j = 0; j < p->n; j++) value += at[i] * (double)p->H[i * p->n + j] * at[j] / 2;
    }
    return value;
}

static int keeps_rows(const rbd_qp_problem *p, const double *at) {
    for (int row = 0; row < p->bounds + p->rows; row++) {
        double value = 0;
        for (int j = 0; j < p->n; j++) value += entry(p, row, j) * at[j];
        if (value < (double)p->lower[row] - 1e-9 || value > (double)p->upper[row] + 1e-9) return 0;
    }
    return 1;
}

/* The least value over all choices of a side for each row, 3^rows of them; 1e300 if none keeps all rows. */
static double least_by_choice(const rbd_qp_problem *p, double *best) {
    const int n = p->n, all = p->bounds + p->rows;
    int choices = 1;
    double least = 1e300;

    for (int row = 0; row < all; row++) choices *= 3;
    for (int choice = 0; choice < choices; choice++) {
        int active[8], q = 0, usable = 1;
        double A[121], b[11];
        for (int row = 0, rest = choice; row < all; row++, rest /= 3) {
            const int at = rest % 3;
            if (at == 0) continue;
            usable &= fabs((double)(at == 1 ? p->lower[row] : p->upper[row])) < RBD_QP_NONE && q < n;
            if (usable) {
                active[q] = row;
                b[n + q] = (double)(at == 1 ? p->lower[row] : p->upper[row]);
                q++;
            }
        }
        if (!usable) continue;
        for (int i = 0; i < n + q; i++)
            for (int j = 0; j < n + q; j++)
                A[i * (n + q) + j] = i < n && j < n ? (double)p->H[i * n + j]
                                     : i < n        ? entry(p, active[j - n], i)
                                     : j < n        ? entry(p, active[i - n], j)
                                                    : 0;
        for (int i = 0; i < n; i++) b[i] = -(double)p->f[i];
        if (!gauss(A, b, n + q) || !keeps_rows(p, b) || !(value_of(p, b) < least)) continue;
        least = value_of(p, b);
        memcpy(best, b, (size_t)n * sizeof *best);
    }
    return least;
}

START_TEST(small_problems_agree_with_all_choices_of_sides) {
    seed = 11;
    for (int k = 0; k < 400; k++) {
        const int n = between(1, 3), rows = between(1, 4), bounds = between(0, n);
        const rbd_qp_problem p = problem_of(n, bounds, rows);
        double best[11], least;
        rbd_qp_status status;

        for (int i = 0; i < n; i++)
            for (int j = 0; j <= i; j++)
                H[i * n + j] = H[j * n + i] = i == j ? (rbd_real)(3 + uniform()) : (rbd_real)uniform();
        for (int i = 0; i < n; i++) f[i] = (rbd_real)(4 * uniform());
        for (int i = 0; i < rows * n; i++) C[i] = (rbd_real)between(-2, 2);
        for (int row = 0; row < bounds + rows; row++) {
            const rbd_real middle = (rbd_real)uniform(), half = (rbd_real)(.1 + fabs(uniform()));
            lower[row] = between(0, 3) ? middle - half : -NONE;
            upper[row] = between(0, 3) ? middle + half : NONE;
        }
        if (bounds + rows > 7) continue;
        status = solve(&p);
        least = least_by_choice(&p, best);
        if (least > 1e299) {
            ck_assert_msg(status == RBD_QP_INFEASIBLE, "problem %d: status %d", k, status);
            continue;
        }
        if (sizeof(rbd_real) == 4 && status != RBD_QP_OK) continue;
        ck_assert_msg(status == RBD_QP_OK, "problem %d: status %d", k, status);
        for (int i = 0; i < n; i++)
            ck_assert_msg(fabs((double)x[i] - best[i]) <= 100 * tight * (1 + fabs(best[i])),
                          "problem %d: x[%d] = %g, not %g", k, i, (double)x[i], best[i]);
    }
}
END_TEST

/* A soft row is a hard one with a variable more. */
START_TEST(soft_rows_are_slacks) {
    static rbd_real H2[MOST_N * MOST_N], f2[MOST_N], C2[MOST_ROWS * MOST_N], x1[MOST_N], lambda1[MOST_ROWS];
    seed = 13;
    for (int k = 0; k < 200; k++) {
        const int n = between(1, 8), rows = between(1, 12), wide = n + rows;
        rbd_qp_problem p = problem_of(n, 0, rows), q;

        for (int i = 0; i < n; i++)
            for (int j = 0; j <= i; j++)
                H[i * n + j] = H[j * n + i] = i == j ? (rbd_real)(n + uniform()) : (rbd_real)uniform();
        for (int i = 0; i < n; i++) f[i] = (rbd_real)(4 * uniform());
        memset(H2, 0, sizeof H2);
        memset(f2, 0, sizeof f2);
        memset(C2, 0, sizeof C2);
        for (int i = 0; i < rows * n; i++) C[i] = (rbd_real)normal();
        for (int row = 0; row < rows; row++) {
            const rbd_real middle = (rbd_real)(2 * normal());
            lower[row] = middle;
            upper[row] = between(0, 3) ? middle + (rbd_real)fabs(uniform()) : middle;
            soft[row] = (rbd_real)pow(10, between(-1, 3));
        }
        p.soft = soft;
        ck_assert_int_eq(solve(&p), RBD_QP_OK);
        memcpy(x1, x, sizeof x1);
        memcpy(lambda1, lambda, sizeof lambda1);

        /* C x - e within the sides, e a variable of weight w */
        for (int i = 0; i < n; i++) {
            f2[i] = f[i];
            for (int j = 0; j < n; j++) H2[i * wide + j] = H[i * n + j];
        }
        for (int row = 0; row < rows; row++) {
            H2[(n + row) * wide + n + row] = soft[row];
            for (int j = 0; j < n; j++) C2[row * wide + j] = C[row * n + j];
            C2[row * wide + n + row] = -1;
        }
        q = problem_of(wide, 0, rows);
        q.H = H2;
        q.f = f2;
        q.C = C2;
        ck_assert_int_eq(solve(&q), RBD_QP_OK);
        for (int i = 0; i < n; i++)
            ck_assert_msg(fabs((double)(x[i] - x1[i])) <= 100 * tight * (1 + largest_of(x1, n)),
                          "problem %d, x[%d]", k, i);
        for (int row = 0; row < rows; row++)
            ck_assert_msg(
                fabs((double)(lambda[row] - lambda1[row])) <= 100 * tight * (1 + largest_of(lambda1, rows)),
                "problem %d, lambda[%d]: %g, %g", k, row, (double)lambda[row], (double)lambda1[row]);
    }
}
END_TEST

/* ---- starts and forms ---- */

START_TEST(any_guess_leads_to_the_same_solution) {
    rbd_qp_options warm = {0, 0, 0, 0};
    rbd_real x1[MOST_N];
    warm.warm = 1;
    seed = 17;
    for (int k = 0; k < 200; k++) {
        rbd_qp_problem p = random_problem(k % 2 ? CONVEX : SOFT);
        int steps;
        if (solve(&p) != RBD_QP_OK) continue;
        memcpy(x1, x, sizeof x1);
        steps = result.steps;

        /* its own solution: nothing is left to do */
        ck_assert_int_eq(rbd_qp_solve(&p, &warm, memory, sizeof memory, x, lambda, side, &result), RBD_QP_OK);
        ck_assert_int_le(result.steps, sizeof(rbd_real) == 4 ? steps : 2);
        for (int guess = 0; guess < 2; guess++) {
            for (int row = 0; row < p.bounds + p.rows; row++) side[row] = (signed char)between(-1, 1);
            ck_assert_int_eq(rbd_qp_solve(&p, &warm, memory, sizeof memory, x, lambda, side, &result),
                             RBD_QP_OK);
            check_kkt(&p, tight, "guess", k);
            for (int i = 0; i < p.n; i++)
                ck_assert(fabs((double)(x[i] - x1[i])) <= 1e5 * tight * (1 + largest_of(x1, p.n)));
        }
    }
}
END_TEST

/* Rounds from a guess that is far off, along which H does not bend, end near the rows. What x was on the way
   excuses no miss. */
START_TEST(a_guess_far_off_excuses_no_miss) {
    const double far = sizeof(rbd_real) == 4 ? 1e6 : 1e14;
    rbd_qp_options warm = {0, 0, 0, 0};
    int solved = 0;
    warm.warm = 1;
    seed = 2711;
    for (int k = 0; k < 600; k++) {
        const rbd_qp_problem p = random_problem(SEMIDEFINITE);
        for (int i = 0; i < p.n; i++) x[i] = (rbd_real)(far * uniform());
        for (int row = 0; row < p.bounds + p.rows; row++) side[row] = (signed char)between(-1, 1);
        if (rbd_qp_solve(&p, &warm, memory, sizeof memory, x, lambda, side, &result) != RBD_QP_OK) continue;

        ++solved;
        for (int row = 0; row < p.bounds + p.rows; row++) {
            double value = 0, terms = 0, miss;
            for (int j = 0; j < p.n; j++) {
                value += entry(&p, row, j) * (double)x[j];
                terms += fabs(entry(&p, row, j)) * largest_of(x, p.n);
            }
            miss = larger((double)lower[row] - value, value - (double)upper[row]);
            ck_assert_msg(!(miss > loose * (terms + fabs(value))), "problem %d, row %d: missed by %g of %g",
                          k, row, miss, terms);
        }
    }
    ck_assert_int_ge(solved, 300);
}
END_TEST

START_TEST(a_problem_that_drifts_is_solved_ten_thousand_times) {
    rbd_qp_options warm = {0, 0, 0, 0};
    rbd_qp_problem p;
    rbd_real f0[MOST_N];
    warm.warm = 1;
    seed = 19;
    do p = random_problem(CONVEX);
    while (p.n < 8 || p.n > 14 || p.rows < 10);
    memcpy(f0, f, sizeof f0);
    memset(side, 0, sizeof side);
    for (int k = 0; k < 10000; k++) {
        for (int i = 0; i < p.n; i++) f[i] = f0[i] + (rbd_real)(4 * sin(1e-2 * k + i));
        ck_assert_int_eq(rbd_qp_solve(&p, &warm, memory, sizeof memory, x, lambda, side, &result), RBD_QP_OK);
        if (k % 50 == 0) check_kkt(&p, tight, "tick", k);
    }
}
END_TEST

/* After one step of two x is (1, 3): the second variable is 2 above its limit, a share of 1 + 3. */
START_TEST(an_unfinished_x_is_judged_where_it_is) {
    const rbd_real square[4] = {1, 0, 0, 1}, slope[2] = {-6, -3}, below[2] = {-RBD_QP_NONE, -RBD_QP_NONE};
    const rbd_real above[2] = {1, 1};
    const rbd_qp_problem p = {.n = 2, .bounds = 2, .H = square, .f = slope, .lower = below, .upper = above};
    const rbd_qp_options one = {.steps = 1};
    ck_assert_int_eq(rbd_qp_solve(&p, &one, memory, sizeof memory, x, lambda, side, &result),
                     RBD_QP_ITERATIONS);
    ck_assert(fabs((double)result.primal - 0.5) < 1e-6);
    ck_assert(result.dual < tight);
}
END_TEST

/* Stopped on the way, or after the last round of a semidefinite H: result.dual is that of x and lambda. */
START_TEST(an_unfinished_gradient_is_told) {
    static const kind kinds[3] = {CONVEX, SEMIDEFINITE, LINEAR};
    const double rounding = sizeof(rbd_real) == 4 ? 1e-5 : 1e-14;
    int unfinished = 0;
    seed = 31;
    for (int k = 0; k < 600; k++) {
        const rbd_qp_problem p = random_problem(kinds[k % 3]);
        const rbd_qp_options few = {.steps = 1 + k % 20, .rounds = 1 + k % 5};
        const rbd_qp_status status = rbd_qp_solve(&p, &few, memory, sizeof memory, x, lambda, side, &result);
        const double share = gradient_share(&p), dual = (double)result.dual;
        if (status == RBD_QP_INFEASIBLE) continue;
        ck_assert_msg(fabs(dual - share) <= 1e-2 * share + rounding, "problem %d: %g, not %g", k, dual,
                      share);
        unfinished += status == RBD_QP_ITERATIONS && share > 1e-3;
    }
    ck_assert_int_gt(unfinished, 50);
}
END_TEST

START_TEST(order_and_units_do_not_matter) {
    seed = 23;
    for (int k = 0; k < 100; k++) {
        rbd_qp_problem p = random_problem(CONVEX);
        rbd_real x1[MOST_N], row[MOST_N];
        const int n = p.n, bounds = p.bounds;
        if (solve(&p) != RBD_QP_OK) continue;
        memcpy(x1, x, sizeof x1);

        /* the rows of C the other way round, each by a power of two */
        for (int i = 0; i < p.rows / 2; i++) {
            const int a = i, b = p.rows - 1 - i;
            rbd_real swap;
            memcpy(row, C + a * n, (size_t)n * sizeof *row);
            memcpy(C + a * n, C + b * n, (size_t)n * sizeof *row);
            memcpy(C + b * n, row, (size_t)n * sizeof *row);
            swap = lower[bounds + a];
            lower[bounds + a] = lower[bounds + b];
            lower[bounds + b] = swap;
            swap = upper[bounds + a];
            upper[bounds + a] = upper[bounds + b];
            upper[bounds + b] = swap;
        }
        for (int i = 0; i < p.rows; i++) {
            const rbd_real by = (rbd_real)ldexp(1, between(-6, 6));
            for (int j = 0; j < n; j++) C[i * n + j] *= by;
            if (lower[bounds + i] > -NONE) lower[bounds + i] *= by;
            if (upper[bounds + i] < NONE) upper[bounds + i] *= by;
        }
        ck_assert_int_eq(solve(&p), RBD_QP_OK);
        for (int i = 0; i < n; i++)
            ck_assert(fabs((double)(x[i] - x1[i])) <= 1e4 * tight * (1 + largest_of(x1, n)));
    }
}
END_TEST

/* ---- slips ---- */

static rbd_qp_problem small_problem(void) {
    static const double H0[] = {2, .5, .5, 1}, f0[] = {-1, 1}, C0[] = {1, 1, 1, -1},
                        lower0[] = {-1, -1, 0, -2}, upper0[] = {1, 1, 1, 2};
    rbd_qp_problem p = problem_of(2, 2, 2);
    set(H, H0, 4);
    set(f, f0, 2);
    set(C, C0, 4);
    set(lower, lower0, 4);
    set(upper, upper0, 4);
    set(soft, (const double[]){0, 0, 0, 0}, 4);
    p.soft = soft;
    return p;
}

static void check_refused(const rbd_qp_problem *p, rbd_qp_status status, int at, const char *field) {
    const rbd_qp_status found = solve(p);
    ck_assert_msg(found == status, "%s: status %d, not %d", field, found, status);
    ck_assert_msg(result.at == at, "%s: at %d, not %d", field, result.at, at);
    ck_assert_str_eq(result.field, field);
    if (status != RBD_QP_NULL && status != RBD_QP_RANGE)
        for (int i = 0; i < p->n; i++) ck_assert(fabs((double)x[i]) < RBD_QP_NONE);
}

START_TEST(not_a_number_is_named) {
    const rbd_real bad[3] = {(rbd_real)NAN, (rbd_real)INFINITY, (rbd_real)-INFINITY};
    rbd_qp_problem p = small_problem();
    ck_assert_int_eq(solve(&p), RBD_QP_OK);
    for (int k = 0; k < 3; k++) {
        for (int i = 0; i < 4; i++) {
            small_problem();
            H[i] = bad[k];
            check_refused(&p, RBD_QP_NAN, i / 2, "H");
            small_problem();
            C[i] = bad[k];
            check_refused(&p, RBD_QP_NAN, 2 + i / 2, "C");
            small_problem();
            soft[i] = bad[k];
            check_refused(&p, RBD_QP_RANGE, i, "soft");
        }
        for (int i = 0; i < 2; i++) {
            small_problem();
            f[i] = bad[k];
            check_refused(&p, RBD_QP_NAN, i, "f");
        }
    }
    for (int i = 0; i < 4; i++) {
        small_problem();
        lower[i] = (rbd_real)NAN;
        check_refused(&p, RBD_QP_NAN, i, "lower");
        small_problem();
        upper[i] = (rbd_real)NAN;
        check_refused(&p, RBD_QP_NAN, i, "upper");
        small_problem();
        lower[i] = NONE;
        check_refused(&p, RBD_QP_NAN, i, "lower");
        small_problem();
        upper[i] = -NONE;
        check_refused(&p, RBD_QP_NAN, i, "upper");
        small_problem();
        lower[i] = (rbd_real)-INFINITY; /* none */
        upper[i] = (rbd_real)INFINITY;
        ck_assert_int_eq(solve(&p), RBD_QP_OK);
    }
}
END_TEST

START_TEST(slips_are_named) {
    static rbd_real many[20000];
    rbd_qp_problem p = small_problem(), q = p;
    rbd_qp_options o = {0, 0, 0, 0};

    lower[2] = 3;
    check_refused(&p, RBD_QP_SIDES, 2, "lower");
    small_problem();
    H[1] = (rbd_real)0.25;
    check_refused(&p, RBD_QP_SYMMETRIC, 1, "H");
    small_problem();
    H[3] = -1;
    check_refused(&p, RBD_QP_CONVEX, 1, "H");
    small_problem();
    soft[3] = -1;
    check_refused(&p, RBD_QP_RANGE, 3, "soft");
    for (int i = 0; i < LENGTH(many); i++) many[i] = 1;
    q = problem_of(1, 0, LENGTH(many));
    q.soft = many;
    check_refused(&q, RBD_QP_RANGE, -1, "soft");
    small_problem();

    q = p;
    q.n = 0;
    check_refused(&q, RBD_QP_RANGE, -1, "n");
    q = p;
    q.n = 1 << 20;
    check_refused(&q, RBD_QP_RANGE, -1, "n");
    q = p;
    q.bounds = 3;
    check_refused(&q, RBD_QP_RANGE, -1, "bounds");
    q = p;
    q.bounds = -1;
    check_refused(&q, RBD_QP_RANGE, -1, "bounds");
    q = p;
    q.rows = -1;
    check_refused(&q, RBD_QP_RANGE, -1, "rows");
    q = p;
    q.rows = 1 << 20;
    check_refused(&q, RBD_QP_RANGE, -1, "rows");
    q = p;
    q.H = NULL;
    check_refused(&q, RBD_QP_NULL, -1, "H");
    q = p;
    q.f = NULL;
    check_refused(&q, RBD_QP_NULL, -1, "f");
    q = p;
    q.C = NULL;
    check_refused(&q, RBD_QP_NULL, -1, "C");
    q = p;
    q.lower = NULL;
    check_refused(&q, RBD_QP_NULL, -1, "lower");
    q = p;
    q.upper = NULL;
    check_refused(&q, RBD_QP_NULL, -1, "upper");

    o.steps = -1;
    ck_assert_int_eq(rbd_qp_solve(&p, &o, memory, sizeof memory, x, lambda, side, &result), RBD_QP_RANGE);
    ck_assert(result.at == -1 && !strcmp(result.field, "steps"));
    o.steps = 0;
    o.rounds = -1;
    ck_assert_int_eq(rbd_qp_solve(&p, &o, memory, sizeof memory, x, lambda, side, &result), RBD_QP_RANGE);
    ck_assert(result.at == -1 && !strcmp(result.field, "rounds"));
    o.rounds = 0;
    o.accuracy = (rbd_real)NAN;
    ck_assert_int_eq(rbd_qp_solve(&p, &o, memory, sizeof memory, x, lambda, side, &result), RBD_QP_RANGE);
    ck_assert(result.at == -1 && !strcmp(result.field, "accuracy"));

    o.accuracy = 1;
    ck_assert_int_eq(rbd_qp_solve(&p, &o, memory, sizeof memory, x, lambda, side, &result), RBD_QP_RANGE);
    o.accuracy = (rbd_real)1e-4;
    o.rounds = 3;
    o.steps = 100;
    ck_assert_int_eq(rbd_qp_solve(&p, &o, memory, sizeof memory, x, lambda, side, &result), RBD_QP_OK);

    ck_assert_int_eq(rbd_qp_solve(NULL, NULL, memory, sizeof memory, x, lambda, side, &result), RBD_QP_NULL);
    ck_assert_int_eq(rbd_qp_solve(&p, NULL, NULL, sizeof memory, x, lambda, side, &result), RBD_QP_NULL);
    ck_assert_int_eq(rbd_qp_solve(&p, NULL, memory, sizeof memory, NULL, lambda, side, &result), RBD_QP_NULL);
    ck_assert_int_eq(rbd_qp_solve(&p, NULL, memory, sizeof memory, x, NULL, side, &result), RBD_QP_NULL);
    ck_assert_int_eq(rbd_qp_solve(&p, NULL, memory, sizeof memory, x, lambda, NULL, &result), RBD_QP_NULL);
    ck_assert_int_eq(rbd_qp_solve(&p, NULL, memory, sizeof memory, x, lambda, side, NULL), RBD_QP_OK);
}
END_TEST

/* H_01 and H_10 may differ by a share of the sum of H_00 and H_11. */
START_TEST(a_slight_asymmetry_is_rounding) {
    const rbd_qp_problem p = problem_of(2, 0, 0);
    for (int k = 0; k < 4; k++) {
        const double small = 1, large = 4, share = k < 2 ? .9 : 1.1;
        H[0] = (rbd_real)(k % 2 ? small : large);
        H[3] = (rbd_real)(k % 2 ? large : small);
        H[1] = (rbd_real)0.5;
        H[2] = (rbd_real)(.5 + share * (double)RBDI_QP_ASYMMETRY * (small + large));
        f[0] = f[1] = 1;
        ck_assert_int_eq(solve(&p), k < 2 ? RBD_QP_OK : RBD_QP_SYMMETRIC);
        if (k >= 2) ck_assert(result.at == 1 && !strcmp(result.field, "H"));
    }
}
END_TEST

/* The row that is missed most joins first: here no other is missed then. */
START_TEST(the_row_that_is_missed_most_joins) {
    const rbd_qp_problem p = problem_of(1, 0, 3);
    H[0] = 1;
    f[0] = 0;
    for (int most = 0; most < 3; most++) {
        for (int row = 0; row < 3; row++) {
            C[row] = 1;
            lower[row] = row == most ? 2 : 1;
            upper[row] = NONE;
        }
        ck_assert_int_eq(solve(&p), RBD_QP_OK);
        ck_assert(result.steps == 1 && side[most] == -1 && fabs((double)x[0] - 2) < tight);
    }
}
END_TEST

START_TEST(steps_and_rounds_are_bounded) {
    rbd_qp_problem p;
    rbd_qp_options o = {0, 0, 0, 0};
    int stopped = 0;
    seed = 29;
    for (int k = 0; k < 200; k++) {
        p = random_problem(CONVEX);
        o.steps = 1 + k / 4;
        if (rbd_qp_solve(&p, &o, memory, sizeof memory, x, lambda, side, &result) != RBD_QP_ITERATIONS)
            continue;
        stopped++;
        ck_assert_int_le(result.steps, o.steps);
        for (int i = 0; i < p.n; i++) ck_assert(fabs((double)x[i]) < RBD_QP_NONE);
    }
    ck_assert_int_gt(stopped, 50);

    /* a guess of which all is wrong */
    p = problem_of(20, 20, 0);
    memset(H, 0, sizeof H);
    for (int i = 0; i < 20; i++) {
        H[i * 21] = 1;
        f[i] = -1;
        lower[i] = 0;
        upper[i] = 2;
        side[i] = 1;
    }
    o.warm = 1;
    o.steps = 3;
    ck_assert_int_eq(rbd_qp_solve(&p, &o, memory, sizeof memory, x, lambda, side, &result),
                     RBD_QP_ITERATIONS);
    ck_assert_int_le(result.steps, 3);
    o.steps = 21;
    ck_assert_int_eq(rbd_qp_solve(&p, &o, memory, sizeof memory, x, lambda, side, &result), RBD_QP_OK);
}
END_TEST

/* x = 1 and x = 1 + a little: a contradiction, but for rounding if it is little enough. */
START_TEST(slight_contradictions_are_inaccurate) {
    const double little = sizeof(rbd_real) == 4 ? 1e-4 : 1e-9;
    rbd_qp_problem p = problem_of(2, 0, 2);
    set(H, (const double[]){1, 0, 0, 1}, 4);
    set(f, (const double[]){0, 0}, 2);
    set(C, (const double[]){1, 0, 1, 0}, 4);
    set(lower, (const double[]){1, 1 + little}, 2);
    memcpy(upper, lower, 2 * sizeof *upper);
    ck_assert_int_eq(solve(&p), RBD_QP_INACCURATE);
    ck_assert(result.primal > 0.1 * little && result.primal < little);
    ck_assert_msg(result.dual < tight, "lambda of a proof that did not hold: dual %g", (double)result.dual);
    lower[1] = upper[1] = (rbd_real)(1 + 100 * little);
    ck_assert_int_eq(solve(&p), RBD_QP_INFEASIBLE);
    check_proof(&p, "contradiction", 0);
}
END_TEST

/* x0 >= gap and x0 + angle x1 <= 0 meet at x1 = -gap / angle, which is nearer than the optimum without rows.
   The rows are too nearly parallel to be solved; but that is no contradiction. */
START_TEST(rows_that_meet_within_reach_contradict_nothing) {
    const rbd_qp_problem p = problem_of(2, 0, 2);
    const double angle = (double)RBDI_QP_DEPENDENT / 2, far = 1e4, gap = angle * far / 5;
    set(H, (const double[]){1, 0, 0, 1}, 4);
    set(f, (const double[]){0, -far}, 2);
    set(C, (const double[]){1, 0, 1, angle}, 4);
    set(lower, (const double[]){gap, -INF}, 2);
    set(upper, (const double[]){INF, 0}, 2);
    ck_assert_int_eq(solve(&p), RBD_QP_INACCURATE);
}
END_TEST

/* A variable, whichever, that others set to 0, but for rounding, keeps a bound of 0. */
START_TEST(a_bound_of_zero_holds_but_for_rounding) {
    seed = 41;
    for (int k = 0; k < 200; k++) {
        const int n = between(2, 4), zero = between(0, n - 1);
        const rbd_qp_problem p = problem_of(n, n, 1);
        double sum = 0;
        for (int i = 0; i < n; i++) {
            for (int j = 0; j < n; j++) H[i * n + j] = i == j;
            f[i] = (rbd_real)normal();
            C[i] = (rbd_real)(1 + fabs(normal()));
            lower[i] = upper[i] = i == zero ? 0 : (rbd_real)normal();
            if (i == zero) upper[i] = NONE;
            sum += (double)C[i] * (double)lower[i];
        }
        lower[n] = upper[n] = (rbd_real)sum;
        ck_assert_msg(solve(&p) == RBD_QP_OK, "problem %d", k);
    }
}
END_TEST

/* Without a value to lower, x is the nearest place to 0, to rounding. */
START_TEST(rows_alone_are_met) {
    const double row[3] = {0.1, 0.7, 1. / 3}, square = 0.01 + 0.49 + 1. / 9;
    rbd_qp_problem p = problem_of(3, 0, 1);
    rbd_qp_options o = {0, 1, 0, 0};
    set(H, (const double[9]){0}, 9);
    set(f, (const double[3]){0}, 3);
    set(C, row, 3);
    set(lower, (const double[]){0.3}, 1);
    upper[0] = NONE;
    ck_assert_int_eq(solve(&p), RBD_QP_OK);
    for (int i = 0; i < 3; i++) ck_assert(fabs((double)x[i] - 0.3 * row[i] / square) < tight);

    /* where it begins, if it begins warm within the rows; 0 in place of what is no number */
    x[0] = 2;
    x[1] = (rbd_real)NAN;
    x[2] = 1;
    ck_assert_int_eq(rbd_qp_solve(&p, &o, memory, sizeof memory, x, lambda, side, NULL), RBD_QP_OK);
    ck_assert(fabs((double)x[0] - 2) < tight && fabs((double)x[1]) < tight && fabs((double)x[2] - 1) < tight);

    seed = 37;
    for (int k = 0; k < 100; k++) {
        p = random_problem(CONVEX);
        memset(H, 0, sizeof H);
        memset(f, 0, sizeof f);
        ck_assert_int_eq(solve(&p), RBD_QP_OK);
        for (int r = 0; r < p.bounds + p.rows; r++) lambda[r] = 0; /* they are rounding */
        check_kkt(&p, loose, "rows alone", k);

        const int rounds = result.rounds;
        const rbd_real unit = k % 2 ? 1 << 20 : (rbd_real)1 / (1 << 20); /* exact */
        for (int r = 0; r < p.bounds + p.rows; r++) {
            if (lower[r] > -NONE) lower[r] *= unit;
            if (upper[r] < NONE) upper[r] *= unit;
        }
        ck_assert_int_eq(solve(&p), RBD_QP_OK);
        ck_assert_int_eq(result.rounds, rounds);
    }
}
END_TEST

/* Where the optimum is 0, and rows pass through it, nothing but rounding is left of x. */
START_TEST(an_optimum_at_0_is_ok) {
    rbd_qp_problem p = problem_of(2, 0, 1);
    set(H, (const double[]){2, 2, 2, 9}, 4);
    set(f, (const double[]){-1, 1}, 2);
    set(C, (const double[]){1, -1}, 2);
    lower[0] = -NONE;
    upper[0] = 0;
    ck_assert_int_eq(solve(&p), RBD_QP_OK);
    ck_assert(fabs((double)x[0]) < tight && fabs((double)x[1]) < tight);
    ck_assert(fabs((double)lambda[0] - 1) < tight);

    p = problem_of(2, 1, 1);
    set(H, (const double[]){5, 4, 4, 6}, 4);
    set(f, (const double[]){2, 1}, 2);
    set(C, (const double[]){-1, 0}, 2);
    set(lower, (const double[]){0, 0}, 2);
    set(upper, (const double[]){0, 1}, 2);
    ck_assert_int_eq(solve(&p), RBD_QP_OK);
    ck_assert(fabs((double)x[0]) < tight && fabs((double)x[1] + 1. / 6) < tight);
}
END_TEST

/* Sums of squares have a least value, whatever their weights: H of 1e3 and 1e-3 is no way without end. */
START_TEST(weighted_squares_are_not_unbounded) {
    seed = 43;
    for (int k = 0; k < 500; k++) {
        const int n = 3, tasks = between(2, 3);
        const rbd_qp_problem p = problem_of(n, 0, 0);
        memset(H, 0, sizeof H);
        memset(f, 0, sizeof f);
        for (int t = 0; t < tasks; t++) {
            const double weight = pow(10, between(-2, 2));
            double row[3], wanted = between(-3, 3);
            for (int i = 0; i < n; i++) row[i] = between(-2, 2);
            for (int i = 0; i < n; i++) {
                f[i] -= (rbd_real)(weight * wanted * row[i]);
                for (int j = 0; j < n; j++) H[i * n + j] += (rbd_real)(weight * row[i] * row[j]);
            }
        }
        ck_assert_int_ne(solve(&p), RBD_QP_UNBOUNDED);
        if (result.dual < 1e-6) check_kkt(&p, sizeof(rbd_real) == 4 ? 1e-2 : 1e-6, "weighted squares", k);
    }
}
END_TEST

/* The same with weights that are so far apart that rounding of H, in float, may be more than the weak ones:
   nothing without end is seen in it. */
START_TEST(weights_far_apart_are_not_unbounded) {
    seed = 7;
    for (int k = 0; k < 14000; k++) {
        const int n = between(3, 8), tasks = between(1, n - 1), decades = 2 + k / 2000;
        const rbd_qp_problem p = problem_of(n, 0, 0);
        double squares[64] = {0}, slope[8] = {0};
        for (int t = 0; t < tasks; t++) {
            const double share = t == 0 ? 0 : t == 1 ? 1 : .5 * (1 + uniform()), wanted = normal();
            const double weight = pow(10, -decades * share);
            double row[8];
            for (int i = 0; i < n; i++) row[i] = normal();
            for (int i = 0; i < n; i++) {
                slope[i] -= weight * wanted * row[i];
                for (int j = 0; j < n; j++) squares[i * n + j] += weight * row[i] * row[j];
            }
        }
        set(H, squares, n * n);
        set(f, slope, n);
        ck_assert_int_ne(solve(&p), RBD_QP_UNBOUNDED);
    }
}
END_TEST

/* x falls without end while another is held: whatever is said of it, results are numbers. */
START_TEST(results_are_finite_whatever_happens) {
    const rbd_qp_problem p = problem_of(2, 2, 0);
    memset(H, 0, sizeof H);
    f[0] = 0;
    f[1] = (rbd_real)0.9;
    lower[0] = upper[0] = (rbd_real)-0.7;
    lower[1] = -RBD_QP_NONE;
    upper[1] = (rbd_real)0.3;
    ck_assert_int_ne(solve(&p), RBD_QP_OK);
    ck_assert(isfinite(x[0]) && isfinite(x[1]) && isfinite(lambda[0]) && isfinite(lambda[1]));
    ck_assert(isfinite(result.primal) && isfinite(result.dual));
}
END_TEST

/* Soft rows give way: whatever their weights, they are no contradiction. */
START_TEST(soft_rows_contradict_nothing) {
    const int first = sizeof(rbd_real) == 4 ? 2 : 8, step = sizeof(rbd_real) == 4 ? 3 : 2;
    for (int decade = first; decade <= 20; decade += step) {
        seed = 7;
        for (int k = 0; k < 400 / PART_OF_PROBLEMS; k++) {
            const rbd_qp_problem p = random_problem(SOFT);
            rbd_qp_status status;
            for (int row = 0; row < p.bounds + p.rows; row++)
                if (soft[row] > 0) soft[row] = (rbd_real)pow(10, decade + uniform());
            status = solve(&p);
            ck_assert_msg(status != RBD_QP_INFEASIBLE, "weights of 1e%d, problem %d", decade, k);
            if (decade == first && sizeof(rbd_real) == 8) ck_assert_int_eq(status, RBD_QP_OK);
        }
    }
}
END_TEST

/* The cube of Klee and Minty (1972), a linear program whose vertices lie far apart: its last one, or
   ITERATIONS with an x that keeps the rows. */
START_TEST(long_ways_end_or_say_so) {
    for (int n = 1; n <= 14; n++) {
        const rbd_qp_problem p = problem_of(n, n, n);
        rbd_qp_status status;
        memset(H, 0, sizeof H);
        memset(C, 0, sizeof C);
        for (int i = 0; i < n; i++) {
            f[i] = -(rbd_real)pow(2, n - 1 - i);
            lower[i] = 0;
            upper[i] = NONE;
            for (int j = 0; j < i; j++) C[i * n + j] = (rbd_real)pow(2, i - j + 1);
            C[i * n + i] = 1;
            lower[n + i] = -NONE;
            upper[n + i] = (rbd_real)pow(5, i + 1);
        }
        status = solve(&p);
        if (n <= 4) ck_assert_int_eq(status, RBD_QP_OK);
        if (status == RBD_QP_OK)
            ck_assert(fabs((double)x[n - 1] / pow(5, n) - 1) < tight);
        else
            ck_assert(status == RBD_QP_ITERATIONS && result.primal < tight);
    }
}
END_TEST

/* OK is said of what x and lambda satisfy, however far x has been on the way: the misses of rows, as shares
   of their sides and of the entries times the largest x. */
START_TEST(ok_is_said_of_the_solution_alone) {
    seed = 19;
    for (int k = 0; k < 4000 / PART_OF_PROBLEMS; k++) {
        rbd_qp_problem p = random_problem(k % 2 ? LINEAR : SCALED);
        double far;
        if (k % 2 == 0) scale(&p);
        if (solve(&p) != RBD_QP_OK) continue;
        far = largest_of(x, p.n);
        for (int row = 0; row < p.bounds + p.rows; row++) {
            double value = 0, terms = 0, below, above;
            for (int j = 0; j < p.n; j++) {
                value += entry(&p, row, j) * (double)x[j];
                terms += fabs(entry(&p, row, j)) * far;
            }
            below = (double)p.lower[row] - value - 2 * tight * fabs((double)p.lower[row]);
            above = value - (double)p.upper[row] - 2 * tight * fabs((double)p.upper[row]);
            ck_assert_msg(larger(below, above) <= 2 * tight * terms, "problem %d, row %d", k, row);
        }
    }
}
END_TEST

/* However slowly the value falls, OK is said at the end of the way alone. */
START_TEST(slow_ways_are_gone_to_their_end) {
    static const struct {
        double H, f, end;
    } ways[] = {{1e6, -1, 1000}, {1, -1e-3, 1e6}, {0, -1, 1e9}};
    for (int k = 0; k < LENGTH(ways); k++) {
        const rbd_qp_problem p = problem_of(2, 2, 0);
        set(H, (const double[]){ways[k].H, 0, 0, 0}, 4);
        set(f, (const double[]){0, ways[k].f}, 2);
        lower[0] = lower[1] = upper[0] = -NONE;
        upper[0] = NONE;
        upper[1] = (rbd_real)ways[k].end;
        if (solve(&p) == RBD_QP_OK)
            ck_assert(fabs((double)x[1] / ways[k].end - 1) < tight);
        else
            ck_assert(sizeof(rbd_real) == 4);
    }
}
END_TEST

/* Rows of zeros: a hard one asks for nothing or contradicts itself, a soft one costs what it costs. */
START_TEST(rows_of_zeros_move_nothing) {
    rbd_qp_problem p = problem_of(1, 0, 2);
    set(H, (const double[]){1}, 1);
    set(f, (const double[]){-3}, 1);
    set(C, (const double[]){0, 0}, 2);
    set(lower, (const double[]){1, -2}, 2);
    set(upper, (const double[]){1, 2}, 2);
    set(soft, (const double[]){1e15, 0}, 2);
    p.soft = soft;
    ck_assert_int_eq(solve(&p), RBD_QP_OK);
    ck_assert(x[0] == 3 && fabs((double)lambda[0] / -1e15 - 1) < tight && lambda[1] == 0);
    ck_assert(side[0] == -1 && side[1] == 0);
}
END_TEST

/* Indefinite by two variables alone, whatever f is. */
START_TEST(saddles_are_refused) {
    static const double slopes[3] = {0, 1, 1000};
    for (int k = 0; k < 3; k++) {
        const rbd_qp_problem p = problem_of(2, 0, 0);
        set(H, (const double[]){0, .9, .9, 0}, 4);
        set(f, (const double[]){slopes[k], 0}, 2);
        check_refused(&p, RBD_QP_CONVEX, 1, "H");
        set(H, (const double[]){1, 0, 0, -1e-8}, 4);
        check_refused(&p, RBD_QP_CONVEX, 1, "H");
    }

    /* by three alone */
    const rbd_qp_problem p = problem_of(3, 0, 0);
    set(H, (const double[]){1, .9, -.9, .9, 1, .9, -.9, .9, 1}, 9);
    set(f, (const double[]){1, 0, 0}, 3);
    check_refused(&p, RBD_QP_CONVEX, 2, "H");
}
END_TEST

/* H of low rank, and an f that has a part outside of its range: nothing holds x. */
START_TEST(ways_without_end_are_found) {
    seed = 41;
    for (int k = 0; k < 300; k++) {
        const int n = between(2, 12), rank = between(1, n - 1);
        const rbd_qp_problem p = problem_of(n, 0, 0);
        double B[12 * 12];
        int unbounded;
        for (int i = 0; i < rank * n; i++) B[i] = normal();
        for (int i = 0; i < n; i++) {
            f[i] = (rbd_real)normal();
            for (int j = 0; j < n; j++) {
                double sum = 0;
                for (int r = 0; r < rank; r++) sum += B[r * n + i] * B[r * n + j];
                H[i * n + j] = (rbd_real)sum;
            }
        }
        unbounded = solve(&p) == RBD_QP_UNBOUNDED;
        ck_assert_msg(unbounded || sizeof(rbd_real) == 4, "problem %d of rank %d of %d: dual %g", k, rank, n,
                      (double)result.dual);
    }
}
END_TEST

/* Draws a problem without H that a ray, of which no row ends any, makes unbounded: rows and bounds with sides
   only where the ray leads away from them. */
static rbd_qp_problem draw_ray(int softly) {
    const int n = between(2, 9), bounds = between(0, n);
    rbd_qp_problem p = problem_of(n, bounds, between(0, 2 * n));
    double ray[9], down = 0;
    memset(H, 0, sizeof H);
    for (int i = 0; i < n; i++) {
        ray[i] = normal();
        f[i] = (rbd_real)normal();
        down += ray[i] * (double)f[i];
    }
    for (int i = 0; i < n && down > 0; i++) f[i] = -f[i];

    for (int i = 0; i < p.rows * n; i++) C[i] = (rbd_real)normal();
    for (int row = 0; row < bounds + p.rows; row++) {
        double along = 0;
        for (int i = 0; i < n; i++) along += entry(&p, row, i) * ray[i];
        lower[row] = along > 0 ? (rbd_real)-fabs(uniform()) : -NONE;
        upper[row] = along > 0 ? NONE : (rbd_real)fabs(uniform());
        soft[row] = (rbd_real)exp(3 * normal());
    }
    if (softly) p.soft = soft;
    return p;
}

/* Without H: nearly all are found, and of the others nothing wrong is said. */
START_TEST(ways_without_end_are_found_without_h) {
    const int softly = _i, most_missed = softly ? 100 : 20;
    int missed = 0;
    seed = 43;
    for (int k = 0; k < 1000; k++) {
        const rbd_qp_problem p = draw_ray(softly);
        const rbd_qp_status status = solve(&p);
        missed += status != RBD_QP_UNBOUNDED;
        ck_assert_msg(status != RBD_QP_OK && status != RBD_QP_INFEASIBLE, "problem %d: status %d", k, status);
        for (int i = 0; i < p.n; i++) ck_assert(fabs((double)x[i]) < RBD_QP_NONE);
    }
    ck_assert_int_lt(missed, most_missed);
}
END_TEST

/* The optimum without rows is far away, the solution next to 0: rows hold as a share of x all the same. */
START_TEST(rows_hold_as_a_share_of_a_small_solution) {
    const double small = sizeof(rbd_real) == 4 ? 1e-3 : 1e-7;
    seed = 47;
    for (int k = 0; k < 500; k++) {
        rbd_qp_problem p = random_problem(CONVEX);
        p.bounds = p.n;
        p.rows = 0;
        for (int i = 0; i < p.n; i++) {
            f[i] = (rbd_real)(50 * normal());
            lower[i] = (rbd_real)(-small * (1 + uniform() / 2));
            upper[i] = (rbd_real)(small * (1 + uniform() / 2));
        }
        const rbd_qp_status status = solve(&p);
        ck_assert_msg(status == RBD_QP_OK, "problem %d: status %d, primal %g", k, status,
                      (double)result.primal);
    }
}
END_TEST

/* Sums of products beside sums in long double, of every length, as each is made of fours and a rest. */
START_TEST(sums_of_products_are_right) {
    enum { MOST = 21 };
    rbd_real a[MOST], b[MOST], t[MOST], u[MOST];
    seed = 97;
    for (int n = 0; n <= MOST; n++) {
        long double sum = 0, terms = 0;
        rbd_real size, with_a, with_b;
        for (int i = 0; i < n; i++) {
            a[i] = (rbd_real)normal();
            b[i] = (rbd_real)normal();
            t[i] = (rbd_real)normal();
            u[i] = t[i];
            sum += (long double)a[i] * (long double)b[i];
            terms += fabsl((long double)a[i] * (long double)b[i]);
        }
        const double rounding = 8 * RBDI_EPS * (1 + (double)terms);
        ck_assert(fabs((double)(rbdi_qp_dot(a, b, n) - (rbd_real)sum)) <= rounding);
        ck_assert(fabs((double)(rbdi_qp_dot_and_terms(a, b, n, &size) - (rbd_real)sum)) <= rounding);
        ck_assert_msg(fabs((double)(size - (rbd_real)terms)) <= rounding, "%d terms", n);
        rbdi_qp_dots(a, b, b, n, &with_a, &with_b);
        ck_assert(fabs((double)(with_a - (rbd_real)sum)) <= rounding && (n == 0 || with_b > 0));

        rbdi_qp_adds(2, a, -3, b, t, n);
        rbdi_qp_add(-2, a, t, n);
        for (int i = 0; i < n; i++) ck_assert(fabs((double)(t[i] - (u[i] - 3 * b[i]))) <= 32 * RBDI_EPS * 10);
        rbdi_qp_rotate(a, b, n, (rbd_real)0.6, (rbd_real)0.8);
        for (int i = 0; i < n; i++) u[i] = (rbd_real)0.6 * a[i] - (rbd_real)0.8 * b[i];
        rbdi_qp_rotate(a, b, n, (rbd_real)0.6, (rbd_real)-0.8); /* back */
        for (int i = 0; i < n; i++) ck_assert(fabs((double)(u[i] - a[i])) <= 32 * RBDI_EPS * 10);
    }
}
END_TEST

/* A row ends a way however little it changes along it: x <= 1e6 (float: 1e4) is written as 1e-8 x <= 0.01. */
START_TEST(rows_of_large_units_end_a_way) {
    const double end = sizeof(rbd_real) == 4 ? 1e4 : 1e6;

    for (int upwards = 0; upwards < 2; upwards++) {
        const rbd_qp_problem p = problem_of(1, 0, 1);
        H[0] = 0;
        f[0] = -1;
        C[0] = (rbd_real)((upwards ? .01 : -.01) / end);
        lower[0] = upwards ? -NONE : (rbd_real)-1e-2;
        upper[0] = upwards ? (rbd_real)1e-2 : NONE;
        ck_assert_int_eq(solve(&p), RBD_QP_OK);
        ck_assert(fabs((double)x[0] / end - 1) < loose);
    }
}
END_TEST

/* Rows in units that are powers of two are the same problem, bit for bit: x, steps and lambda times the row,
   from any guess, as all tolerances are shares. */
START_TEST(units_of_rows_change_no_bit) {
    enum { ALL = 140 };
    seed = 83;
    for (int k = 0; k < 300; k++) {
        const rbd_qp_options warm = {0, 1, 0, 0};
        const kind of = k % 3 == 0 ? CONVEX : k % 3 == 1 ? DEGENERATE : SOFT;
        rbd_qp_problem p = random_problem(of);
        const int all = p.bounds + p.rows;
        rbd_real first[MOST_N], multipliers[ALL];
        signed char guess[ALL];
        rbd_qp_result found;
        for (int row = 0; row < all; row++) side[row] = guess[row] = (signed char)between(-1, 1);
        const rbd_qp_status status =
            rbd_qp_solve(&p, &warm, memory, sizeof memory, first, multipliers, side, &found);

        for (int row = p.bounds; row < all; row++) {
            const int by = between(-20, 20);
            for (int j = 0; j < p.n; j++) {
                rbd_real *c = &C[(row - p.bounds) * p.n + j];
                *c = (rbd_real)ldexp((double)*c, by);
            }
            if (lower[row] > -NONE) lower[row] = (rbd_real)ldexp((double)lower[row], by);
            if (upper[row] < NONE) upper[row] = (rbd_real)ldexp((double)upper[row], by);
            soft[row] = (rbd_real)ldexp((double)soft[row], -2 * by);
            multipliers[row] = (rbd_real)ldexp((double)multipliers[row], -by);
        }
        ck_assert(rbd_qp_solve(&p, &warm, memory, sizeof memory, x, lambda, guess, &result) == status);
        ck_assert_msg(result.steps == found.steps && result.active == found.active, "problem %d", k);
        for (int i = 0; i < p.n; i++)
            ck_assert_msg(fabs((double)(x[i] - first[i])) <= 0, "problem %d", k); /* not a number fails */
        for (int row = 0; row < all && status == RBD_QP_OK; row++)
            ck_assert(fabs((double)(lambda[row] - multipliers[row])) <= 0);
    }
}
END_TEST

/* x >= 2 s and x <= s contradict each other however small or large s is. */
START_TEST(contradictions_have_no_unit) {
    const int most = sizeof(rbd_real) == 4 ? 10 : 25;

    for (int power = -most; power <= most; power++) {
        const rbd_qp_problem p = problem_of(2, 0, 2);
        const double s = pow(10, power);
        set(H, (const double[]){1, 0, 0, 1}, 4);
        set(f, (const double[]){0, 0}, 2);
        set(C, (const double[]){1, 0, 1, 0}, 4);
        set(lower, (const double[]){2 * s, -INF}, 2);
        set(upper, (const double[]){INF, s}, 2);
        ck_assert_msg(solve(&p) == RBD_QP_INFEASIBLE, "1e%d", power);
        check_proof(&p, "power", power);
    }
}
END_TEST

/* What stands behind x, lambda and side is another's. */
START_TEST(nothing_behind_the_arrays_is_touched) {
    seed = 89;
    for (int k = 0; k < 40; k++) {
        const rbd_qp_problem p = random_problem((kind)(k % KINDS));
        const int all = p.bounds + p.rows;
        if (p.n == MOST_N || all == MOST_ROWS) continue;
        x[p.n] = (rbd_real)NAN;
        lambda[all] = (rbd_real)NAN;
        side[all] = 77;
        ck_assert(solve(&p) != RBD_QP_NAN);
        ck_assert(isnan((double)x[p.n]) && isnan((double)lambda[all]) && side[all] == 77);
    }
}
END_TEST

/* H is so small beside f that the optimum without rows is 1e20 (float: 1e8) times as far away as the limits.
   What rounding leaves of so long a way is no excuse for a miss: any OK keeps the rows to ten accuracies. */
START_TEST(limits_hold_however_far_the_optimum_is) {
    const int solved = sizeof(rbd_real) == 4 ? 8 : 20;

    for (int power = 0; power <= 28; power++) {
        for (int kind = 0; kind < 3; kind++) {
            const rbd_qp_problem p = problem_of(3, 3, 2);
            for (int i = 0; i < 9; i++) H[i] = i % 4 ? 0 : (rbd_real)pow(10, -power);
            set(f, (const double[]){1, -1, .3}, 3);
            set(C, (const double[]){1, 1, 1, 1, -2, 3}, 6);
            set(lower, (const double[]){-1, -1, -1, -.5, -INF}, 5);
            set(upper, (const double[]){1, 1, 1, .5, .7}, 5);
            if (kind == 1) lower[3] = upper[3];
            if (kind == 2) lower[0] = upper[0] = (rbd_real).5;

            const rbd_qp_status status = solve(&p);
            ck_assert_msg(status == RBD_QP_OK || (status == RBD_QP_INACCURATE && power > solved),
                          "H 1e-%d, problem %d: status %d", power, kind, status);
            if (status == RBD_QP_OK) check_kkt(&p, 10 * RBDI_QP_ACCURACY, "power", power);
        }
    }
}
END_TEST

/* Soft rows are all of the cost: their units decide how far a round of the proximal method goes, so that a
   weight of any size is met at once. With f: x = 1 - f/w. */
START_TEST(soft_rows_alone_are_met) {
    rbd_qp_problem p = problem_of(2, 1, 1);
    p.soft = soft;
    for (int i = 0; i < 4; i++) H[i] = 0;
    set(C, (const double[]){0, 1}, 2);
    set(upper, (const double[]){INF, 3}, 2);

    for (int power = -25; power <= 25; power++) {
        const double weight = pow(10, power);
        for (int kind = 0; kind < 3; kind++) { /* the second row is soft too, and weaker; f too */
            const double slope = kind == 2 ? weight / 8 : 0;
            f[0] = (rbd_real)slope;
            f[1] = 0;
            lower[0] = 1;
            lower[1] = 3;
            soft[0] = (rbd_real)weight;
            soft[1] = kind ? (rbd_real)(weight / 1000) : 0;
            ck_assert_msg(solve(&p) == RBD_QP_OK && result.rounds <= 10, "weight 1e%d: %d rounds", power,
                          result.rounds);
            ck_assert(fabs((double)x[0] - 1 + slope / weight) < loose && fabs((double)x[1] - 3) < loose);
        }
    }
}
END_TEST

/* A soft row of zeros that misses its side by 1e25, at a weight of 1e25: its multiplier is too large in
   float, and what is said of it is a number in any case. */
START_TEST(multipliers_that_overflow_are_named) {
    rbd_qp_problem p = problem_of(1, 0, 1);
    H[0] = 1;
    f[0] = -1;
    C[0] = 0;
    lower[0] = (rbd_real)1e25;
    upper[0] = NONE;
    soft[0] = (rbd_real)1e25;
    p.soft = soft;
    const rbd_qp_status status = solve(&p);
    ck_assert(fabs((double)lambda[0]) < 1e60 && fabs((double)x[0]) < RBD_QP_NONE);
    if (sizeof(rbd_real) == 8) return;
    ck_assert_int_eq(status, RBD_QP_NAN);
    ck_assert(lambda[0] == 0 && result.at == 0 && !strcmp(result.field, "lambda"));
}
END_TEST

/* In float squares of 1e18 |x| overflow: no answer may be OK then. */
START_TEST(sums_that_overflow_are_not_ok) {
    const double large = sizeof(rbd_real) == 4 ? 1e18 : 1e153;
    rbd_qp_problem p = problem_of(1, 0, 1);
    set(H, (const double[]){1}, 1);
    set(f, (const double[]){-1e21}, 1);
    set(C, (const double[]){0}, 1);
    C[0] = (rbd_real)large;
    lower[0] = -NONE;
    upper[0] = 5;
    if (solve(&p) == RBD_QP_OK) ck_assert((double)C[0] * (double)x[0] <= 5 + 1e-6 * (double)C[0]);

    p = problem_of(1, 1, 0);
    set(H, (const double[]){1e20}, 1);
    set(f, (const double[]){0}, 1);
    set(lower, (const double[]){1e15}, 1);
    upper[0] = NONE;
    ck_assert_int_eq(solve(&p), RBD_QP_OK);
    ck_assert(fabs((double)x[0] / 1e15 - 1) < tight);
}
END_TEST

/* x = (-1, 1, 1) needs two steps. One of them leaves the equality the multiplier of where x is then, whatever
   was in the memory. */
START_TEST(an_unfinished_x_has_multipliers_of_equalities) {
    const rbd_real square[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, slope[3] = {0, -6, -3}, sum[3] = {1, 1, 0};
    const rbd_real below[4] = {-RBD_QP_NONE, -RBD_QP_NONE, -RBD_QP_NONE, 0},
                   above[4] = {RBD_QP_NONE, 1, 1, 0};
    const rbd_qp_problem p = {
        .n = 3, .bounds = 3, .rows = 1, .H = square, .f = slope, .C = sum, .lower = below, .upper = above};
    const rbd_qp_options once = {.steps = 1};
    memset(memory, 0xff, sizeof memory);
    ck_assert_int_eq(rbd_qp_solve(&p, &once, memory, sizeof memory, x, lambda, side, &result),
                     RBD_QP_ITERATIONS);
    ck_assert(fabs((double)(x[0] + lambda[3])) <= tight);
}
END_TEST

START_TEST(results_that_are_too_large_are_none) {
    char text[100];
    rbd_qp_problem p = problem_of(2, 0, 0);
    set(H, (const double[]){1, 0, 0, 1e-10}, 4);
    set(f, (const double[]){-1, -1e25}, 2);
    ck_assert_int_eq(solve(&p), RBD_QP_NAN);
    ck_assert_int_eq(result.at, 1);
    ck_assert_ptr_null(result.field);
    ck_assert(x[0] == 1 && x[1] == 0);
    ck_assert_str_eq(rbd_qp_text(RBD_QP_NAN, &result, text, sizeof text),
                     "variable 1, not a number, not finite, or too large");
}
END_TEST

/* RBD_QP_SIZE is enough at every alignment, and no byte behind it is touched; one byte less is refused. */
START_TEST(the_memory_is_enough) {
    static unsigned char bytes[sizeof memory + 64];
    seed = 31;
    for (int k = 0; k < 100; k++) {
        rbd_qp_problem p = random_problem(k % 2 ? SOFT : DEGENERATE);
        int softs = 0;
        for (int row = 0; row < p.bounds + p.rows && p.soft; row++) softs += soft[row] > 0;
        const size_t size = RBD_QP_SIZE(p.n, p.bounds, p.rows, softs);
        unsigned char *at = bytes + k % 17;
        memset(bytes, 0x5a, sizeof bytes);
        if (sizeof(rbd_real) == 8)
            ck_assert_int_eq(rbd_qp_solve(&p, NULL, at, size, x, lambda, side, &result), RBD_QP_OK);
        else
            (void)rbd_qp_solve(&p, NULL, at, size, x, lambda, side, &result);
        for (unsigned char *b = bytes; b < at; b++) ck_assert_int_eq(*b, 0x5a);
        for (unsigned char *b = at + size; b < bytes + sizeof bytes; b++) ck_assert_int_eq(*b, 0x5a);
        ck_assert_int_eq(rbd_qp_solve(&p, NULL, at, size - 1, x, lambda, side, &result), RBD_QP_MEMORY);
    }
}
END_TEST

START_TEST(what_was_found_is_a_sentence) {
    rbd_qp_problem p = small_problem();
    char text[120], cut[10];

    lower[2] = 3;
    ck_assert_ptr_eq(rbd_qp_text(solve(&p), &result, text, sizeof text), text);
    ck_assert_msg(strstr(text, "row 2, field 'lower': above upper") == text, "%s", text);
    small_problem();
    f[1] = (rbd_real)NAN;
    rbd_qp_text(solve(&p), &result, text, sizeof text);
    ck_assert_msg(strstr(text, "variable 1, field 'f': not a number") == text, "%s", text);

    rbd_qp_text(RBD_QP_MEMORY, NULL, cut, sizeof cut);
    ck_assert_str_eq(cut, "the memor");
    ck_assert_ptr_null(rbd_qp_text(RBD_QP_OK, NULL, NULL, 10));
    ck_assert_ptr_eq(rbd_qp_text(RBD_QP_OK, NULL, cut, 0), cut);
    ck_assert_str_eq(cut, "the memor");
    result.at = -1;
    result.field = "H";
    rbd_qp_text(RBD_QP_NULL, &result, text, sizeof text);
    ck_assert_str_eq(text, "field 'H': a required pointer is NULL");
    result.at = 1;
    rbd_qp_text(RBD_QP_SYMMETRIC, &result, text, sizeof text);
    ck_assert_str_eq(text, "variable 1, field 'H': H is not symmetric");
    result.at = 120;
    result.field = "C";
    rbd_qp_text(RBD_QP_NAN, &result, text, sizeof text);
    ck_assert_msg(strstr(text, "row 120, field 'C': ") == text, "%s", text);
    for (int status = RBD_QP_SIDES; status <= RBD_QP_OK; status++) {
        rbd_qp_text((rbd_qp_status)status, NULL, text, sizeof text);
        ck_assert_msg(strcmp(text, "unknown status") != 0 && strlen(text) > 5, "status %d", status);
    }
    rbd_qp_text((rbd_qp_status)5, NULL, text, sizeof text);
    ck_assert_str_eq(text, "unknown status");
}
END_TEST

int main(void) {
    Suite *suite = suite_create("qp");
    TCase *c = tcase_create("qp");
    SRunner *runner = srunner_create(suite);
    int failed;

    tcase_set_timeout(c, 0);
    tcase_add_loop_test(c, known_answers_come_out, 0, LENGTH(answers));
    tcase_add_loop_test(c, random_problems_satisfy_their_conditions, 0, KINDS);
    tcase_add_test(c, contradictions_are_found_and_proven);
    tcase_add_test(c, multipliers_that_cancel_hide_no_gradient);
    tcase_add_test(c, corrections_leave_nothing_but_rounding);
    tcase_add_test(c, small_problems_agree_with_all_choices_of_sides);
    tcase_add_test(c, soft_rows_are_slacks);
    tcase_add_test(c, any_guess_leads_to_the_same_solution);
    tcase_add_test(c, a_guess_far_off_excuses_no_miss);
    tcase_add_test(c, a_problem_that_drifts_is_solved_ten_thousand_times);
    tcase_add_test(c, an_unfinished_gradient_is_told);
    tcase_add_test(c, order_and_units_do_not_matter);
    tcase_add_test(c, not_a_number_is_named);
    tcase_add_test(c, slips_are_named);
    tcase_add_test(c, a_slight_asymmetry_is_rounding);
    tcase_add_test(c, the_row_that_is_missed_most_joins);
    tcase_add_test(c, steps_and_rounds_are_bounded);
    tcase_add_test(c, slight_contradictions_are_inaccurate);
    tcase_add_test(c, rows_that_meet_within_reach_contradict_nothing);
    tcase_add_test(c, a_bound_of_zero_holds_but_for_rounding);
    tcase_add_test(c, rows_alone_are_met);
    tcase_add_test(c, an_optimum_at_0_is_ok);
    tcase_add_test(c, weighted_squares_are_not_unbounded);
    tcase_add_test(c, weights_far_apart_are_not_unbounded);
    tcase_add_test(c, results_are_finite_whatever_happens);
    tcase_add_test(c, soft_rows_contradict_nothing);
    tcase_add_test(c, long_ways_end_or_say_so);
    tcase_add_test(c, ok_is_said_of_the_solution_alone);
    tcase_add_test(c, slow_ways_are_gone_to_their_end);
    tcase_add_test(c, rows_of_zeros_move_nothing);
    tcase_add_test(c, saddles_are_refused);
    tcase_add_test(c, ways_without_end_are_found);
    tcase_add_loop_test(c, ways_without_end_are_found_without_h, 0, 2);
    tcase_add_test(c, rows_hold_as_a_share_of_a_small_solution);
    tcase_add_test(c, sums_of_products_are_right);
    tcase_add_test(c, rows_of_large_units_end_a_way);
    tcase_add_test(c, units_of_rows_change_no_bit);
    tcase_add_test(c, contradictions_have_no_unit);
    tcase_add_test(c, nothing_behind_the_arrays_is_touched);
    tcase_add_test(c, limits_hold_however_far_the_optimum_is);
    tcase_add_test(c, soft_rows_alone_are_met);
    tcase_add_test(c, multipliers_that_overflow_are_named);
    tcase_add_test(c, sums_that_overflow_are_not_ok);
    tcase_add_test(c, an_unfinished_x_is_judged_where_it_is);
    tcase_add_test(c, an_unfinished_x_has_multipliers_of_equalities);
    tcase_add_test(c, results_that_are_too_large_are_none);
    tcase_add_test(c, the_memory_is_enough);
    tcase_add_test(c, what_was_found_is_a_sentence);
    suite_add_tcase(suite, c);
    srunner_run_all(runner, CK_NORMAL);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}
