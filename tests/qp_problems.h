/* qp_problems.h - random quadratic programs for rbd_qp.h, and judges of what it answers, which compute in
   double from the problem alone. For files that implement rbd_qp.h, of either scalar. */
#ifndef QP_PROBLEMS_H
#define QP_PROBLEMS_H

#include <math.h>
#include <string.h>

#include "larger.h"
#include "rbd_qp.h"

#define NONE ((rbd_real)RBD_QP_NONE)

enum { MOST_N = 40, MOST_ROWS = 140 };

static rbd_real H[MOST_N * MOST_N], f[MOST_N], C[MOST_ROWS * MOST_N], lower[MOST_ROWS], upper[MOST_ROWS],
    soft[MOST_ROWS];
static rbd_real x[MOST_N], lambda[MOST_ROWS];
static signed char side[MOST_ROWS];
static unsigned char memory[RBD_QP_SIZE(MOST_N, MOST_N, MOST_ROWS, MOST_ROWS)];
static rbd_qp_result result;

/* ---- random numbers ---- */

static uint64_t seed;

static uint64_t draw(void) {
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    return seed >> 11;
}
static double uniform(void) { return (double)draw() * 0x1p-52 - 1; }
static double normal(void) {
    double sum = 0;
    for (int i = 0; i < 12; i++) sum += uniform();
    return sum / 2;
}
static int between(int low, int high) { return low + (int)(draw() % (uint64_t)(high - low + 1)); }

/* ---- solving and judging ---- */

static rbd_qp_problem problem_of(int n, int bounds, int rows) {
    rbd_qp_problem p;
    p.n = n;
    p.bounds = bounds;
    p.rows = rows;
    p.H = H;
    p.f = f;
    p.C = C;
    p.lower = lower;
    p.upper = upper;
    p.soft = NULL;
    return p;
}

static rbd_qp_status solve(const rbd_qp_problem *p) {
    return rbd_qp_solve(p, NULL, memory, sizeof memory, x, lambda, side, &result);
}

static double entry(const rbd_qp_problem *p, int row, int j) {
    return row < p->bounds ? row == j : (double)p->C[(row - p->bounds) * p->n + j];
}
static double largest_of(const rbd_real *v, int n) {
    double largest = 0;
    for (int i = 0; i < n; i++) largest = larger(largest, fabs((double)v[i]));
    return largest;
}

/* A condition, how far it is from holding as a share of its terms, and the row or component. */
typedef struct judgement {
    double share;
    const char *condition;
    int at;
} judgement;

static void note(judgement *worst, const char *condition, int at, double by, double terms) {
    const double share = by > 0 ? larger(0, by / terms) : by == by ? 0 : HUGE_VAL;
    if (!(share > worst->share)) return;
    worst->share = share;
    worst->condition = condition;
    worst->at = at;
}

/* How well x and lambda satisfy the conditions of Karush, Kuhn and Tucker. */
static judgement judge_solution(const rbd_qp_problem *p) {
    const int n = p->n, all = p->bounds + p->rows;
    const double far = largest_of(x, n);
    judgement worst = {0, "none", -1};

    for (int i = 0; i < n; i++) {
        double sum = (double)p->f[i], terms = fabs(sum);
        for (int j = 0; j < n; j++) {
            sum += (double)p->H[i * n + j] * (double)x[j];
            terms += fabs((double)p->H[i * n + j] * (double)x[j]);
        }
        for (int row = 0; row < all; row++) {
            sum += entry(p, row, i) * (double)lambda[row];
            terms += fabs(entry(p, row, i) * (double)lambda[row]);
        }
        note(&worst, "the gradient is 0", i, fabs(sum), terms);
    }
    for (int row = 0; row < all; row++) {
        const double weight = p->soft ? (double)p->soft[row] : 0,
                     miss = weight > 0 ? (double)lambda[row] / weight : 0;
        double value = -miss, terms = fabs(miss), below, above;
        for (int j = 0; j < n; j++) {
            value += entry(p, row, j) * (double)x[j];
            terms += fabs(entry(p, row, j)) * far;
        }
        if (lambda[row] > 0) terms += fabs((double)p->upper[row]);
        if (lambda[row] < 0) terms += fabs((double)p->lower[row]);
        below = (double)p->lower[row] - value;
        above = value - (double)p->upper[row];
        note(&worst, "the lower side is kept", row, below, terms);
        note(&worst, "the upper side is kept", row, above, terms);
        if (lambda[row] > 0) note(&worst, "what pushes is at its upper side", row, fabs(above), terms);
        if (lambda[row] < 0) note(&worst, "what pushes is at its lower side", row, fabs(below), terms);
        if (p->lower[row] < p->upper[row])
            note(&worst, "nothing pulls", row, -side[row] * (double)lambda[row], largest_of(lambda, all));
    }
    return worst;
}

/* The largest component of Hx + f + C'lambda, as a share of the largest term of the cost: what result.dual
   states. Not of lambda of hard rows, whose terms may cancel. */
static double gradient_share(const rbd_qp_problem *p) {
    double worst = 0, largest = 0;

    for (int i = 0; i < p->n; i++) {
        long double sum = (long double)p->f[i], terms = fabsl(sum);
        for (int j = 0; j < p->n; j++) {
            const long double term = (long double)p->H[i * p->n + j] * (long double)x[j];
            sum += term;
            terms += fabsl(term);
        }
        for (int row = 0; row < p->bounds + p->rows; row++) {
            const long double term = (long double)entry(p, row, i) * (long double)lambda[row];
            sum += term;
            if (p->soft && p->soft[row] > 0) terms += fabsl(term);
        }
        worst = larger(worst, (double)fabsl(sum));
        largest = larger(largest, (double)terms);
    }
    return largest > 0 ? worst / largest : worst;
}

/* How well lambda proves a contradiction: lambda' rows = 0, and lambda' sides < 0. */
static judgement judge_proof(const rbd_qp_problem *p) {
    const int n = p->n, all = p->bounds + p->rows;
    double sides = 0, largest = 0;
    judgement worst = {0, "none", -1};

    for (int j = 0; j < n; j++) {
        double terms = 0;
        for (int row = 0; row < all; row++) terms += fabs(entry(p, row, j) * (double)lambda[row]);
        largest = larger(largest, terms);
    }
    for (int j = 0; j < n; j++) {
        double sum = 0;
        for (int row = 0; row < all; row++) sum += entry(p, row, j) * (double)lambda[row];
        note(&worst, "the rows add up to 0", j, fabs(sum), largest);
    }
    for (int row = 0; row < all; row++)
        if (lambda[row] != 0)
            sides += (double)lambda[row] * (double)(lambda[row] > 0 ? p->upper[row] : p->lower[row]);
    if (!(sides < 0)) note(&worst, "the sides add up to less than 0", -1, 1, 1);
    return worst;
}

/* ---- random problems ---- */

typedef enum kind { CONVEX, DEGENERATE, SEMIDEFINITE, SCALED, SOFT, LINEAR, KINDS } kind;
static const char *const kind_names[] = {"convex", "degenerate", "semidefinite", "scaled", "soft", "linear"};

/* Rows of C: two thirds of the entries are random; of a degenerate problem many are multiples and sums of
   others. */
static void random_rows(kind of, int n, int rows) {
    for (int i = 0; i < rows * n; i++) C[i] = between(0, 2) ? (rbd_real)normal() : 0;
    for (int i = 1; i < rows && of == DEGENERATE; i++) {
        const int a = between(0, i - 1), b = between(0, i - 1);
        const rbd_real share = between(0, 1)   ? 1
                               : between(0, 1) ? -2
                                               : (rbd_real)0.5,
                       other = (rbd_real)between(0, 1);
        if (between(0, 2)) continue;
        for (int j = 0; j < n; j++) C[i * n + j] = share * C[a * n + j] + other * C[b * n + j];
    }
}

/* H of this rank, f, and sides about a point that keeps them all. */
static rbd_qp_problem random_problem(kind of) {
    const int n = between(1, MOST_N), rows = between(1, 100), bounds = of == LINEAR || between(0, 1) ? n : 0;
    const int rank = of == SEMIDEFINITE ? between(1, n) : n;
    int equalities = between(0, of == SEMIDEFINITE ? n / 3 : n / 2);
    rbd_qp_problem p = problem_of(n, bounds, rows);
    static double B[MOST_N * MOST_N];
    double inside[MOST_N], centre[MOST_N];

    for (int i = 0; i < n * n; i++) B[i] = normal();
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) {
            double sum = of == SEMIDEFINITE || i != j ? 0 : 1e-3;
            for (int r = 0; r < rank; r++) sum += B[r * n + i] * B[r * n + j];
            H[i * n + j] = of == LINEAR ? 0 : (rbd_real)sum;
        }
    for (int i = 0; i < n; i++) {
        inside[i] = normal();
        centre[i] = normal();
        f[i] = (rbd_real)(3 * normal());
    }
    for (int i = 0; i < n && of == SEMIDEFINITE; i++) { /* an optimum without rows, so that none is needed */
        double sum = 0;
        for (int j = 0; j < n; j++) sum += (double)H[i * n + j] * centre[j];
        f[i] = (rbd_real)sum;
    }

    random_rows(of, n, rows);
    if (equalities > rows) equalities = rows;
    for (int i = 0; i < bounds + rows; i++) {
        double value = 0, below;
        for (int j = 0; j < n; j++) value += entry(&p, i, j) * inside[j];
        below = of == DEGENERATE && between(0, 1) ? 0 : fabs(normal()) * .3;
        lower[i] = between(0, 1) ? -NONE : (rbd_real)(value - below);
        upper[i] = between(0, 1) ? NONE : (rbd_real)(value + fabs(normal()) * .3);
        if (of == LINEAR && i < bounds) {
            lower[i] = (rbd_real)(value - 2);
            upper[i] = (rbd_real)(value + 2);
        }
        if (i >= bounds && i < bounds + equalities && of != LINEAR) lower[i] = upper[i] = (rbd_real)value;
        soft[i] = 0;
        if (of == SOFT && lower[i] < upper[i] && between(0, 1)) {
            const rbd_real shift = (rbd_real)(2 * normal());
            soft[i] = (rbd_real)pow(10, between(-2, 4));
            if (lower[i] > -NONE) lower[i] += shift;
            if (upper[i] < NONE) upper[i] += shift;
        }
    }
    if (of == SOFT) p.soft = soft;
    return p;
}

/* x by 10^+-3, rows by 10^+-4. */
static void scale(const rbd_qp_problem *p) {
    const int n = p->n;
    double by[MOST_N];

    for (int i = 0; i < n; i++) by[i] = pow(10, 3 * uniform());
    for (int i = 0; i < n; i++) {
        f[i] *= (rbd_real)by[i];
        for (int j = 0; j < n; j++)
            H[i * n + j] = (rbd_real)((double)H[i * n + j] * (i < j ? by[i] * by[j] : by[j] * by[i]));
        if (i >= p->bounds) continue;
        if (lower[i] > -NONE) lower[i] /= (rbd_real)by[i];
        if (upper[i] < NONE) upper[i] /= (rbd_real)by[i];
    }
    for (int i = 0; i < p->rows; i++) {
        const int row = p->bounds + i;
        const double s = pow(10, 4 * uniform());
        const int equal = lower[row] == upper[row];
        for (int j = 0; j < n; j++) C[i * n + j] *= (rbd_real)(s * by[j]);
        if (lower[row] > -NONE) lower[row] *= (rbd_real)s;
        if (equal)
            upper[row] = lower[row];
        else if (upper[row] < NONE)
            upper[row] *= (rbd_real)s;
    }
}

/* One whose last row, the sum of others, is asked for more than they allow, by 1e-3, in float by 0.1. */
static rbd_qp_problem contradiction(void) {
    const double more = sizeof(rbd_real) == 4 ? .1 : 1e-3;
    double sum = 0;
    rbd_qp_problem p;
    int n, last, others;

    do p = random_problem(CONVEX);
    while (p.rows < 3 || p.n < 2);
    n = p.n;
    last = p.bounds + p.rows - 1;
    others = between(1, p.rows - 2 < n - 1 ? p.rows - 2 : n - 1);
    for (int j = 0; j < n; j++) C[(p.rows - 1) * n + j] = 0;
    for (int i = 0; i < others; i++) {
        const int row = p.bounds + i;
        const double share = fabs(normal()) + .01;
        if (upper[row] >= NONE) upper[row] = lower[row] > -NONE ? lower[row] + 1 : 1;
        for (int j = 0; j < n; j++) C[(p.rows - 1) * n + j] += (rbd_real)share * C[i * n + j];
        sum += share * (double)upper[row];
    }
    lower[last] = (rbd_real)(sum + more * (1 + fabs(sum)));
    upper[last] = NONE;
    return p;
}

#endif
