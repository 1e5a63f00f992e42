/* held.h - rbd_constrained_id without a search for the rank. Included behind algorithms.h by those who record
   it and by those who compare it with rbd.h. SPDX-License-Identifier: MIT

   A' lambda = t, where A is J of the joints without motors, and t what inverse dynamics wants of them. Of its
   solutions, or nearest ones, A (A'A)^+ t is the least. A'A = L L' by Cholesky. L has no columns where a
   joint moves as others say in every state, and then (A'A)^+ = L (L'L)^-2 L'. */

typedef std::vector<rbd_real> column;

/* at(0) + at(1) + ...; 0 if n is 0. */
template <class entry> rbd_real sum_of(size_t n, entry at) {
    rbd_real sum = n > 0 ? at(0) : rbd_real(0);
    for (size_t k = 1; k < n; k++) sum = sum + at(k);
    return sum;
}

/* Columns of L, G = L L', of which keeps(k, pivot, entry of G) says whether row k makes one. */
template <class function> std::vector<column> factor_of(const std::vector<column> &G, function keeps) {
    std::vector<column> L;
    std::vector<bool> is_done(G.size(), false);
    for (size_t k = 0; k < G.size(); k++) {
        column x = G[k];
        for (size_t i = 0; i < x.size(); i++)
            for (size_t t = 0; t < L.size() && !is_done[i]; t++) x[i] = x[i] - L[t][i] * L[t][k];
        if (!keeps(k, x[k], G[k][k])) continue;
        const rbd_real scale = rbd_real(1) / rbdi_sqrt(x[k]);
        for (size_t i = 0; i < x.size(); i++) x[i] = is_done[i] ? rbd_real(0) : x[i] * scale;
        is_done[k] = true;
        L.push_back(x);
    }
    return L;
}

/* x = (L L')^-1 x. */
static inline void solve_by(const std::vector<column> &L, column *x) {
    column &y = *x;
    for (size_t k = 0; k < L.size(); k++) {
        y[k] = y[k] / L[k][k];
        for (size_t i = k + 1; i < L.size(); i++) y[i] = y[i] - L[k][i] * y[k];
    }
    for (size_t k = L.size(); k-- > 0;) {
        for (size_t i = k + 1; i < L.size(); i++) y[k] = y[k] - L[k][i] * y[i];
        y[k] = y[k] / L[k][k];
    }
}

static inline std::vector<column> products_of(const std::vector<column> &A) { /* A'A */
    std::vector<column> G(A.size(), column(A.size()));
    for (size_t k = 0; k < A.size(); k++)
        for (size_t i = k; i < A.size(); i++)
            G[k][i] = G[i][k] = sum_of(A[k].size(), [&](size_t r) { return A[k][r] * A[i][r]; });
    return G;
}

/* A of the joints without motors, from J. */
static inline std::vector<column> passive_columns(const call &c, const column &J) {
    const size_t nv = size_t(rbd_nv(c.m));
    std::vector<column> A;
    for (size_t k = 0; k < nv; k++) {
        if (!rbdi_is_passive(c.m, c.actuated, int(k))) continue;
        A.push_back({});
        for (size_t r = 0; r < J.size() / nv; r++) A.back().push_back(J[r * nv + k]);
    }
    return A;
}

static inline column jacobian_of(const call &c) {
    column J(size_t(rbd_constraint_rows(c.set) * rbd_nv(c.m)));
    (void)rbd_constraint_jacobian(c.m, c.set, c.q, NULL, J.data(), NULL, NULL);
    return J;
}

/* keeps as in factor_of; checks(k, of the entry of G what the kept rows leave, entry of G). */
template <class function, class check>
rbd_status run_without_rank(const call &c, function keeps, check checks) {
    const size_t nv = size_t(rbd_nv(c.m)), rows = size_t(rbd_constraint_rows(c.set));
    rbd_real *tau = c.out[0], *lambda = c.out[1];
    const column J = jacobian_of(c);
    const std::vector<column> A = passive_columns(c, J), G = products_of(A), L = factor_of(G, keeps);
    column t, y;
    for (size_t k = 0; k < A.size(); k++)
        checks(k, G[k][k] - sum_of(L.size(), [&](size_t i) { return L[i][k] * L[i][k]; }), G[k][k]);
    const rbd_status status = rbd_rnea(c.m, c.w, c.q, c.v, c.a, c.f_ext, tau);
    for (size_t k = 0; k < nv; k++)
        if (rbdi_is_passive(c.m, c.actuated, int(k))) t.push_back(tau[k]);
    if (L.size() < A.size()) {
        const std::vector<column> F =
            factor_of(products_of(L), [](size_t, rbd_real, rbd_real) { return true; });
        for (const column &l : L) y.push_back(sum_of(t.size(), [&](size_t k) { return l[k] * t[k]; }));
        solve_by(F, &y), solve_by(F, &y);
        for (size_t k = 0; k < t.size(); k++)
            t[k] = sum_of(L.size(), [&](size_t i) { return L[i][k] * y[i]; });
    } else {
        solve_by(L, &t);
    }
    for (size_t r = 0; r < rows; r++) lambda[r] = sum_of(A.size(), [&](size_t k) { return A[k][r] * t[k]; });
    for (size_t k = 0; k < nv; k++)
        for (size_t r = 0; r < rows; r++) tau[k] = tau[k] - J[r * nv + k] * lambda[r];
    return status;
}
