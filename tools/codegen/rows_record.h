/* rows_record.h - what rbd.h does to rows, as calls instead of scalars. Included behind rbd.h by record.cpp.
   SPDX-License-Identifier: MIT */

/* Where a factor stands: the rows of L, and 1/D. */
struct row_factor {
    std::vector<int> row;
    int inverse;
};
static std::unordered_map<const number *, row_factor> factors;

/* The memory of rows while a function is recorded. */
static class row_recorder {
  public:
    bool is_on;

    void begin(function *to, bool on) {
        f = to, is_on = on;
        f->rows = 0;
        numbers.clear(), factors.clear();
    }

    /* Places for so many scalars, in whole fours, or for a matrix in what the largest registers hold. */
    int take(int size, int whole = FOUR) {
        const int at = (f->rows + whole - 1) / whole * whole;
        f->rows = at + (size + FOUR - 1) / FOUR * FOUR;
        numbers.resize(size_t(f->rows));
        return at;
    }
    static int fours(int columns) { return (columns + FOUR - 1) / FOUR; }

    void put(row_call *c, int at, number y) {
        c->stores.push_back({at, record(y.x)});
        numbers[size_t(at)] = y;
    }
    void finish(row_call c) {
        c.node = int(tape->nodes.size());
        for (int at : places_written(c))
            numbers[size_t(at)] = number::of(write(LOADED, at, int(f->calls.size())));
        f->calls.push_back(std::move(c));
    }
    /* The value at a place after all recorded calls. */
    number load(int at) const { return numbers[size_t(at)]; }

  private:
    function *f;
    std::vector<number> numbers; /* at each place */
} recorder;

/* ---- packed matrices, see rbd.h's [packed matrix] ---- */

/* As many sums as registers demand. */
static void add_sum(row_call *c, const row_sum &all) {
    if (all.fours() == 0) c->sums.push_back(all);
    for (int i = 0; all.fours() >> i; i += MOST_FOURS) {
        const auto part = [i](unsigned fours) { return fours >> i & ((1u << MOST_FOURS) - 1); };
        row_sum s = all;
        s.to += FOUR * i, s.from += FOUR * i, s.own = part(s.own);
        s.terms.clear();
        for (row_sum::multiple t : all.terms) {
            t.fours = part(t.fours), t.row += FOUR * i;
            if (t.fours) s.terms.push_back(t);
        }
        if (s.fours()) c->sums.push_back(s);
    }
}
/* The fours of so many columns. */
static unsigned first_fours(int columns) { return (1u << row_recorder::fours(columns)) - 1; }

/* Rows of U = D L, then those of L. */
template <class model, class work> bool rows_factor(const model *m, work *w, number *H) {
    if (!recorder.is_on || m->nv > MOST_COLUMNS) return false;
    row_call c = {};
    std::vector<int> U;
    row_factor L;
    for (int k = 0; k < m->nv; k++) {
        const int n = m->dof[k].depth + 1;
        U.push_back(recorder.take(n));
        for (int t = 0; t < FOUR * row_recorder::fours(n); t++)
            recorder.put(&c, U.back() + t, t < n ? H[m->dof[k].row + t] : number(0));
    }
    for (int k = 0; k < m->nv; k++) L.row.push_back(recorder.take(m->dof[k].depth));
    L.inverse = recorder.take(m->nv);
    for (int s = m->nv - 1; s >= 0; s--) {
        const int k = m->node[s].dof, d = m->dof[k].depth;
        const int u = U[size_t(k)];
        row_sum sum = {u, u, NOWHERE, first_fours(d + 1), {}};
        for (int t = s + m->node[s].descendants; t > s; t--) {
            const size_t i = size_t(m->node[t].dof);
            sum.terms.push_back({L.row[i] + d, U[i], first_fours(d + 1)});
        }
        if (!sum.terms.empty()) add_sum(&c, sum);
        add_sum(&c, {L.inverse + k, u + d, NOWHERE, 0, {}});
        if (d > 0) add_sum(&c, {L.row[size_t(k)], u, L.inverse + k, first_fours(d), {}});
    }
    recorder.finish(c);
    for (int k = 0; k < m->nv; k++) {
        const int d = m->dof[k].depth;
        w->pivot[k] = recorder.load(U[size_t(k)] + d);
        for (int t = 0; t < d; t++) H[m->dof[k].row + t] = recorder.load(L.row[size_t(k)] + t);
        H[m->dof[k].row + d] = recorder.load(L.inverse + k);
    }
    factors[H] = L;
    return true;
}

/* X = L'^-1 X of the identity: rows that have the columns of the descendants alone. */
static void add_inverse_up(row_call *c, const rbd_model *m, const row_factor &L, int X, int pitch) {
    std::vector<unsigned> filled(size_t(m->nv), 0);
    for (int s = m->nv - 1; s >= 0; s--) {
        const int k = m->node[s].dof, row = X + k * pitch;
        row_sum sum = {row, row, NOWHERE, 1u << k / FOUR, {}};
        for (int t = s + m->node[s].descendants; t > s; t--) {
            const int i = m->node[t].dof;
            sum.terms.push_back({L.row[size_t(i)] + m->dof[k].depth, X + i * pitch, filled[size_t(i)]});
        }
        if (!sum.terms.empty()) add_sum(c, sum);
        filled[size_t(k)] = sum.fours();
    }
}

/* X = sign M^-1 X for matrices with rows a stride apart and n columns, here side by side, each in whole
   fours. */
static void solve_rows(const rbd_model *m, const row_factor &L, int sign, ptrdiff_t stride, int n,
                       const std::vector<number *> &all, bool is_identity) {
    std::vector<number *> columns; /* NULL: zeros */
    for (number *X : all) {
        for (int j = 0; j < n; j++) columns.push_back(X + j);
        columns.resize(size_t(row_recorder::fours(int(columns.size())) * FOUR));
    }
    const int fours = int(columns.size()) / FOUR;
    columns.resize((columns.size() + WHOLE - 1) / WHOLE * WHOLE);
    const int pitch = int(columns.size()), X = recorder.take(m->nv * pitch, WHOLE);
    row_call c = {};
    c.solution = {{}, X, fours, sign, is_identity};
    for (int s = 0; s < m->nv; s++) {
        const int k = m->node[s].dof;
        c.solution.dofs.push_back(
            {k * pitch, m->dof[k].depth, L.row[size_t(k)], L.inverse + k, m->node[s].descendants});
    }
    for (int i = 0; i < m->nv * pitch; i++) {
        const number *x = columns[size_t(i % pitch)];
        recorder.put(&c, X + i, x ? x[i / pitch * stride] : number(0));
    }
    if (is_identity) add_inverse_up(&c, m, L, X, pitch);
    recorder.finish(c);
    for (int i = 0; i < m->nv * pitch; i++) {
        number *x = columns[size_t(i % pitch)];
        if (x) x[i / pitch * stride] = recorder.load(X + i);
    }
}

template <class model>
bool rows_solve(const model *m, const number *L, int sign, ptrdiff_t stride, int n, number *X, number *Y) {
    if (!recorder.is_on || !factors.count(L)) return false;
    std::vector<number *> all = {X};
    if (Y) all.push_back(Y);
    solve_rows(m, factors[L], sign, stride, n, all, false);
    return true;
}

template <class model> bool rows_invert(const model *m, const number *L, number *Z) {
    if (!recorder.is_on || !factors.count(L)) return false;
    for (int i = 0; i < m->nv * m->nv; i++) Z[i] = number(i % (m->nv + 1) ? 0 : 1);
    solve_rows(m, factors[L], 1, m->nv, m->nv, {Z}, true);
    return true;
}
