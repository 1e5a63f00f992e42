#ifndef RBDI_CONSTRAINTS_RANK_H
#define RBDI_CONSTRAINTS_RANK_H
#include "dynamics/row_sums.h"
#include "dynamics/pivots.h"
#include "constraints/kinematics.h"
#include "constraints/factor.h"

/* ---- rank [rank] ----
   If a pivot of Delta = Z'Z, Z = D^-1/2 Y, is in doubt, Z is factored instead. Its condition number is the
   square root of Delta's:

       Z P = Q R,    Delta = P R' R P'

   by Householder's reflections with column pivoting (Golub and Van Loan, Matrix Computations, section 5.4.2).
   A row of a constraint is a column of Z. Each step takes the row with the largest share that is independent
   of the rows taken before, and P exchanges it with the row in its place. So the state decides the order, not
   the caller. Once the largest share is rounding ([tolerances]), all remaining rows depend on those taken:
   they are dropped, 1/R_tt = 0.

   Q is not needed. R' beta = b and R lambda = beta give lambda, 0 for dropped rows. The equation of motion
   then holds to rounding whatever the rank is, and so do the rows taken. For a dropped row j, R n = 0 with
   n_j = 1 gives a null vector n: J' n = 0. The rows agree only if n' b = 0. The null vectors are made
   orthogonal to each other (Gram and Schmidt); lambda less its components along them has the least norm.

   Lanes may differ in order and rank, so no branch depends on one lane alone. */

RBDI_LOCAL rbdi_mask rbdi_is_index(rbd_real x, int k) {
    return rbdi_and(rbdi_less(rbdi_set(RBD_C(k) - RBD_C(0.5)), x),
                    rbdi_less(x, rbdi_set(RBD_C(k) + RBD_C(0.5))));
}

RBDI_LOCAL rbdi_mask rbdi_dropped(const rbd_constraint_set *c, int t) {
    return rbdi_not(rbdi_less(rbdi_zero(), rbdi_abs(c->R_inverse[t])));
}

/* Exchanges entry t of x with that of row pivot_row[t]. Entries of x are `step` apart. Does so for `count`
   vectors x, `next` apart. */
RBDI_LOCAL void rbdi_exchange(const rbd_constraint_set *c, int t, rbd_real *x, int step, int count,
                              int next) {
    for (int j = t + 1; j < c->rows; ++j) {
        const rbdi_mask here = rbdi_is_index(c->pivot_row[t], j);
        if (!rbdi_any(here)) continue;

        for (int i = 0; i < count; ++i) {
            rbd_real *one = x + t * step + i * next, *two = x + j * step + i * next;
            const rbd_real old = *one;
            *one = rbdi_select(here, *two, old);
            *two = rbdi_select(here, old, *two);
        }
    }
}

/* P' X or, if `back`, P X. X: rows x columns. */
RBDI_LOCAL void rbdi_permute(const rbd_constraint_set *c, rbd_real *X, int columns, int back) {
    for (int t = 0; c->pivoted && t < c->rows; ++t)
        rbdi_exchange(c, back ? c->rows - 1 - t : t, X, columns, columns, 1);
}

/* c->square of the rows from t on: of column j of Z, after t reflections, the sum of Z_kj^2 from k = t on. */
RBDI_LOCAL void rbdi_independent_squares(const rbd_constraint_set *c, int nv, int t) {
    for (int j = t; j < c->rows; j += RBDI_BATCH) {
        rbdi_batch sum = rbdi_all_lanes(rbdi_zero());

        for (int k = t; k < nv; ++k) {
            const rbdi_batch z = *(const rbdi_batch *)&c->R[k * c->stride + j];
            sum = sum + z * z;
        }

        *(rbdi_batch *)&c->square[j] = sum;
    }
}

/* Exchanges row t with the row that has the largest independent share. */
RBDI_LOCAL void rbdi_choose_row(rbd_constraint_set *c, int nv, int t) {
    rbd_real best = c->square[t] * c->of_rows.inverse_square[t], at = rbdi_set(RBD_C(t));

    for (int j = t + 1; j < c->rows; ++j) {
        const rbd_real share = c->square[j] * c->of_rows.inverse_square[j];
        const rbdi_mask more = rbdi_less(best * RBDI_CLEARLY_MORE, share);
        best = rbdi_select(more, share, best);
        at = rbdi_select(more, rbdi_set(RBD_C(j)), at);
    }

    c->pivot_row[t] = at;
    rbdi_exchange(c, t, c->R, 1, nv, c->stride);
    rbdi_exchange(c, t, c->square, 1, 1, 0);
    rbdi_exchange(c, t, c->of_rows.inverse_square, 1, 1, 0);
}

/* Householder's reflection that leaves R_tt as the last entry of column t other than 0. For each column z
   from row t on, with x that of column t:

       h = x - R e_1,   R = -sign(x_1) |x|,   z -= h (h'z) / (|x| (|x| + |x_1|)) */
RBDI_LOCAL void rbdi_reflect(rbd_constraint_set *c, int nv, int t) {
    const int stride = c->stride;
    rbd_real *Z = c->R, *h = c->of_dofs.reflection;
    rbdi_mask none = rbdi_less(rbdi_zero(), rbdi_zero());
    const rbd_real head = Z[t * stride + t], length = rbdi_sqrt(c->square[t]),
                   R = rbdi_select(rbdi_less(head, rbdi_zero()), length, -length),
                   scale = rbdi_reciprocal(length * (length + rbdi_abs(head)), RBDI_TINY, &none);

    for (int k = t; k < nv; ++k) h[k] = Z[k * stride + t];
    h[t] = head - R;

    for (int j = t + 1; j < c->rows; j += RBDI_BATCH) {
        rbdi_batch sum = rbdi_all_lanes(rbdi_zero());
        for (int k = t; k < nv; ++k) sum = sum + *(const rbdi_batch *)&Z[k * stride + j] * h[k];

        sum = sum * scale;
        for (int k = t; k < nv; ++k) {
            rbdi_batch *z = (rbdi_batch *)&Z[k * stride + j];
            *z = *z - sum * h[k];
        }
    }

    Z[t * stride + t] = R;
}

/* Writes Z = D^-1/2 Y to c->R, and the squares of its columns. No row is taken yet. */
RBDI_LOCAL void rbdi_start_ranking(rbd_constraint_set *c, int nv) {
    const rbd_real noise = c->noise * (1 / RBDI_RANK), one = rbdi_set(RBD_C(1));

    for (int k = 0; k < nv; ++k) {
        const rbd_real root = rbdi_sqrt(c->D_inverse[k]);
        for (int j = 0; j < c->stride; j += RBDI_BATCH)
            *(rbdi_batch *)&c->R[k * c->stride + j] = *(const rbdi_batch *)&c->Y[k * c->stride + j] * root;
    }
    if (c->rows > nv) rbdi_clear(&c->R[nv * c->stride], (c->rows - nv) * c->stride);

    rbdi_independent_squares(c, nv, 0);
    for (int r = 0; r < c->rows; ++r) {
        rbdi_mask none = rbdi_less(one, rbdi_zero());
        c->of_rows.inverse_square[r] = rbdi_reciprocal(c->square[r] + noise, RBDI_TINY, &none);
        c->R_inverse[r] = rbdi_zero();
        c->pivot_row[r] = rbdi_set(RBD_C(r));
    }
}

/* R of all rows, and 1/R_tt, which is 0 if row t depends on those before it. */
RBDI_LOCAL void rbdi_orthogonalise(const rbd_model *m, rbd_constraint_set *c) {
    const rbd_real one = rbdi_set(RBD_C(1));
    const int nv = m->nv, steps = c->rows < nv ? c->rows : nv;
    rbdi_mask taken = rbdi_less(rbdi_zero(), one);

    rbdi_start_ranking(c, nv);
    for (int t = 0; t < steps; ++t) {
        if (t > 0) rbdi_independent_squares(c, nv, t);
        rbdi_choose_row(c, nv, t);
        taken = rbdi_and(
            taken, rbdi_not(rbdi_less(c->square[t] * c->of_rows.inverse_square[t], rbdi_set(RBDI_RANK))));
        if (!rbdi_any(taken)) return;

        rbdi_reflect(c, nv, t);
        c->R_inverse[t] =
            rbdi_select(taken, one / rbdi_select(taken, c->R[t * c->stride + t], one), rbdi_zero());
    }
}

/* The null vector of a dropped row t, 0 in lanes that took the row. Its t + 1 entries replace row t of c->R
   up to the diagonal, which is no longer needed. */
RBDI_LOCAL rbd_real *rbdi_null_vector(const rbd_constraint_set *c, int t) { return &c->R[t * c->stride]; }

/* x -= n (n'x) / n'n where `mask`, n the null vector of dropped row t. */
RBDI_LOCAL void rbdi_project_along(const rbd_constraint_set *c, int t, rbdi_mask mask, rbd_real *x) {
    const rbd_real *null = rbdi_null_vector(c, t);
    rbdi_mask none = rbdi_less(null[0], null[0]); /* its length is 0, or at least 1 */
    rbd_real factor = rbdi_rows_product(null, x, t + 1) *
                      rbdi_reciprocal(rbdi_rows_product(null, null, t + 1), RBD_C(0.5), &none);

    factor = rbdi_select(mask, factor, rbdi_zero());
    for (int i = 0; i <= t; ++i) x[i] = x[i] - factor * null[i];
}

/* x loses its components along the null vectors of the rows before row `end`. */
RBDI_LOCAL void rbdi_project(const rbd_constraint_set *c, int end, rbd_real *x) {
    for (int t = 0; t < end; ++t) {
        const rbdi_mask dropped = rbdi_dropped(c, t);
        if (rbdi_any(dropped)) rbdi_project_along(c, t, dropped, x);
    }
}

/* The null vectors of all dropped rows, orthogonal to each other: R n = 0, n_t = 1. */
RBDI_LOCAL void rbdi_null_space(const rbd_constraint_set *c) {
    for (int t = 0; t < c->rows; ++t) {
        rbd_real *null = rbdi_null_vector(c, t);
        if (!rbdi_any(rbdi_dropped(c, t))) continue;

        null[t] = rbdi_select(rbdi_dropped(c, t), rbdi_set(RBD_C(1)), rbdi_zero());
        for (int i = t - 1; i >= 0; --i)
            null[i] = -c->R_inverse[i] * rbdi_rows_product(&c->R[i * c->stride + i + 1], &null[i + 1], t - i);
        rbdi_project(c, t, null);
    }
}

RBDI_LOCAL rbd_real rbdi_sum_abs(rbdi_v3 x) { return rbdi_abs(x.x) + rbdi_abs(x.y) + rbdi_abs(x.z); }

/* A bound on the terms of a constraint's target. J v, gamma and e in it are differences, so they may be far
   smaller than their terms:

       alpha + acc + v (w + 1 + kd) + p (w^2 + alpha + kp)

   p: of the places in the world, whose rounding is that of the lever arms. */
RBDI_LOCAL rbd_real rbdi_motion_size(const rbd_constraint_set *c, const rbdi_constraint *con) {
    const rbdi_relative_motion relative = rbdi_relative_motion_of(c, con);
    const rbdi_station one = relative.body[0], two = relative.body[1];
    const rbd_real w = rbdi_sum_abs(one.omega) + rbdi_sum_abs(two.omega),
                   v = w + rbdi_sum_abs(one.v) + rbdi_sum_abs(two.v),
                   p = rbdi_sum_abs(one.p) + rbdi_sum_abs(rbdi_frame_origin(c, con, 1)) + RBD_C(1);
    const rbd_real turning = rbdi_sum_abs(one.omega_dot) + rbdi_sum_abs(two.omega_dot),
                   moving = rbdi_sum_abs(one.acc) + rbdi_sum_abs(two.acc);

    return turning + moving + v * (w + (RBD_C(1) + con->kd)) + p * (w * w + turning + con->kp);
}

/* Makes c->slack the error of b by rounding and drift, and permutes it. */
RBDI_LOCAL void rbdi_set_slack(rbd_constraint_set *c) {
    for (const rbdi_constraint *con = c->constraint; con < c->constraint + c->n; ++con) {
        const rbd_real noise = rbdi_motion_size(c, con) * RBDI_NOISE;
        for (int r = con->row; r < con->row + con->rows; ++r)
            c->slack[r] = rbdi_sqrt(c->slack[r]) * RBDI_FEASIBLE + noise;
    }

    rbdi_permute(c, c->slack, 1, 0);
}

/* Notes the first dropped row, in the caller's order, that contradicts the rows it depends on: the targets
   have a component along its null vector n, |n' target| > |n|' slack. (J x of any x has none.) */
RBDI_LOCAL void rbdi_check_rows(rbd_constraint_set *c) {
    rbd_real *bad = c->of_rows.contradicts;
    const rbd_real one = rbdi_set(RBD_C(1));

    rbdi_set_slack(c);
    rbdi_permute(c, c->target, 1, 0);
    rbdi_clear(bad, c->rows);
    for (int t = 0; t < c->rows; ++t) {
        const rbd_real *null = rbdi_null_vector(c, t);
        rbd_real bound = rbdi_zero();
        if (!rbdi_any(rbdi_dropped(c, t))) continue;

        for (int j = 0; j <= t; ++j) bound = bound + rbdi_abs(null[j]) * c->slack[j];
        bad[t] = rbdi_select(rbdi_less(bound, rbdi_abs(rbdi_rows_product(null, c->target, t + 1))), one,
                             rbdi_zero());
    }

    rbdi_permute(c, c->target, 1, 1);
    rbdi_permute(c, bad, 1, 1);
    for (int r = c->rows - 1; r >= 0; --r)
        if (rbdi_any(rbdi_less(rbdi_zero(), bad[r]))) c->infeasible = r;
}

/* The columns of X lose their components along the null vectors. X: rows x columns. */
RBDI_LOCAL void rbdi_project_columns(const rbd_constraint_set *c, rbd_real *X, int columns) {
    rbd_real *x = c->square;
    for (int j = 0; c->pivoted && j < columns; ++j) {
        for (int i = 0; i < c->rows; ++i) x[i] = X[i * columns + j];
        rbdi_project(c, c->rows, x);
        for (int i = 0; i < c->rows; ++i) X[i * columns + j] = x[i];
    }
}

/* X = Delta^-1 X, of least norm. X: rows x columns. If rows depend on each other, the right-hand sides lose
   their components along the null vectors, too: with them the equations would contradict each other. */
RBDI_LOCAL void rbdi_delta_solve(const rbd_constraint_set *c, rbd_real *X, int columns) {
    rbd_real *x = c->square; /* a column of R */
    rbdi_permute(c, X, columns, 0);
    rbdi_project_columns(c, X, columns);

    /* R' beta = X */
    for (int t = 0; t < c->rows; ++t) {
        for (int i = 0; i < t; ++i) x[i] = c->R[i * c->stride + t];
        rbdi_subtract_product(x, X, t, columns, &X[t * columns]);
        rbdi_multiply(&X[t * columns], c->R_inverse[t], columns);
    }

    /* R X = beta */
    for (int t = c->rows - 1; t >= 0; --t) {
        rbdi_subtract_product(&c->R[t * c->stride + t + 1], &X[(t + 1) * columns], c->rows - t - 1, columns,
                              &X[t * columns]);
        rbdi_multiply(&X[t * columns], c->R_inverse[t], columns);
    }

    rbdi_project_columns(c, X, columns);
    rbdi_permute(c, X, columns, 1);
}

/* Gives lambda to the caller. Returns the status of a call from that of the pivots of M. */
RBDI_LOCAL rbd_status rbdi_constrained_status(const rbd_model *m, rbd_constraint_set *c, rbd_status status,
                                              rbd_real *lambda) {
    if (status) {
        (void)rbdi_pivot_status(m, c->w, c->lambda, c->rows);
        c->infeasible = -1;
    }
    for (int r = 0; lambda && r < c->rows; ++r) lambda[r] = c->lambda[r];
    if (status) return status;
    return c->infeasible < 0 ? RBD_OK : RBD_ERR_INFEASIBLE;
}

#endif
