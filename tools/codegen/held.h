/* held.h - rbd_constrained_id without a search for the rank: A'A and its factor. Included behind algorithms.h
   by record.cpp, and by compute.cpp, which chooses columns. SPDX-License-Identifier: MIT

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
